! SPDX-License-Identifier: MIT
!> Materials and the equations of state that their parts name.
module deck_resolve_eos_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use eos_m, only : eos_t, initial_stiffness, initial_pressure, asymptote, eos_gruneisen, &
    eos_logarithmic
  use model_m, only : model_t
  use parts_m, only : material_t
  use deck_cards_m, only : reject_field
  use deck_ids_m, only : an_eos
  use deck_lines_m, only : deck_t, place_t, line_error, line_warning
  use deck_maps_m, only : resolve_id
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: resolve_equations, check_implicit_laws

contains

  !> Give every material its pressure. A material whose parts name different equations of state
  !> becomes as many materials.
  subroutine resolve_equations(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(inout) :: raw
    type(model_t), intent(inout) :: model
    integer, allocatable :: base(:), taken(:) !! of each material: whose copy it is; its equation of
                                              !! state, 0 none, -1 not known yet
    logical, allocatable :: is_named(:)       !! of each equation of state
    integer :: i, k, m

    base = [(i, i=1, size(model%materials))]
    taken = [(-1, i=1, size(model%materials))]
    do i = 1, size(model%parts)
      m = model%parts(i)%material
      if (m == 0) cycle
      call find_equation_of_state(deck, raw, model%materials(m), i, k)
      if (k < 0) cycle
      if (taken(m) < 0) then
        taken(m) = k
      else if (taken(m) /= k) then
        m = find_copy(base, taken, m, k)
        if (m == 0) then
          m = model%parts(i)%material
          model%materials = [model%materials, model%materials(m)]
          raw%material_line = [raw%material_line, raw%material_line(m)]
          base = [base, m]
          taken = [taken, k]
          m = size(base)
        end if
        model%parts(i)%material = m
      end if
    end do
    do m = 1, size(taken)
      if (taken(m) > 0) model%materials(m)%eos = raw%equations(taken(m))
      call settle_pressure(deck, raw%material_line(m), model%materials(m))
    end do
    allocate (is_named(size(raw%equations)), source=.false.)
    is_named(pack(taken, taken > 0)) = .true.
    do k = 1, size(raw%equations)
      if (.not. is_named(k)) call line_warning(deck, raw%equation_line(k), 'unused', &
        'no part names equation of state '//to_text(raw%equations(k)%id)//' (EOSID of *PART)')
    end do
  end subroutine resolve_equations

  !> The equation of state of a part, 0 for none, -1 where there is a mistake.
  subroutine find_equation_of_state(deck, raw, material, i_part, found)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(material_t), intent(in) :: material
    integer, intent(in) :: i_part
    integer, intent(out) :: found
    type(place_t) :: place

    found = 0
    associate (part => raw%parts(i_part))
      place = place_t(part%line, 2, 'EOSID')
      if (part%eos > 0) then
        if (material%takes_eos) then
          call resolve_id(deck, an_eos, part%eos, place, found)
        else
          call reject_field(deck, place, 'is an equation of state, but material ' &
            //to_text(material%id)//' has a pressure of its own; leave it 0')
        end if
        if (found == 0) found = -1
      else if (part%eos == 0 .and. material%needs_eos) then
        call line_error(deck, part%line, 'part '//to_text(part%id)//' names no equation of ' &
          //'state (EOSID), from which its material '//to_text(material%id)//' gets its pressure')
        found = -1
      end if
    end associate
  end subroutine find_equation_of_state

  !> The copy of a material with an equation of state, 0 where there is none.
  pure function find_copy(base, taken, material, equation) result(found)
    integer, intent(in) :: base(:), taken(:), material, equation
    integer :: found

    do found = size(base), 1, -1
      if (base(found) == material .and. taken(found) == equation) return
    end do
    found = 0
  end function find_copy

  !> Moduli that follow from the pressure; where points may fail, one that can be lost.
  subroutine settle_pressure(deck, line, material)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line
    type(material_t), intent(inout) :: material

    if (material%is_rigid) return
    if (allocated(material%eos)) then
      if (material%eos%kind == eos_gruneisen) then
        material%eos%stiffness = material%density*material%eos%speed**2
        material%eos%least_ratio = asymptote(material%eos%s)
      end if
      material%bulk = initial_stiffness(material%eos)
      if (.not. material%bulk > 0.0_wp) call line_error(deck, line, 'material ' &
        //to_text(material%id)//' is not stiff under pressure at the start: the bulk modulus of ' &
        //'its equation of state '//to_text(material%eos%id)//' is '//to_text(material%bulk))
      if (material%bulk > 0.0_wp) material%eos%datum = max(0.0_wp, &
        0.5_wp*initial_pressure(material%eos)**2/material%bulk - material%eos%energy)
    else if (allocated(material%erosion) .or. material%takes_eos) then
      if (.not. material%bulk > 0.0_wp) return
      material%eos = eos_t(kind=eos_logarithmic, stiffness=material%bulk)
    else
      return
    end if
    if (.not. (material%bulk > 0.0_wp .and. material%density > 0.0_wp)) return
    associate (k => material%bulk, g => material%shear)
      material%young = 9.0_wp*k*g/(3.0_wp*k + g)
      material%poisson = (3.0_wp*k - 2.0_wp*g)/(2.0_wp*(3.0_wp*k + g))
      material%sound_speed = sqrt((k + 4.0_wp*g/3.0_wp)/material%density)
    end associate
  end subroutine settle_pressure

  !> Laws with rates, heat, energy or failure have no tangent.
  subroutine check_implicit_laws(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    integer :: i
    character(:), allocatable :: reason

    do i = 1, size(model%materials)
      associate (material => model%materials(i))
        if (allocated(material%flow)) then
          reason = 'a flow stress of Johnson and Cook'
        else if (material%failure_strain < huge(1.0_wp)) then
          reason = 'a plastic strain at failure'
        else if (allocated(material%rubber)) then
          cycle
        else if (allocated(material%crush)) then
          reason = 'the law of a crushable foam'
        else if (allocated(material%eos) .or. material%needs_eos) then
          reason = 'an equation of state'
        else
          cycle
        end if
        call line_error(deck, raw%material_line(i), 'material '//to_text(material%id)//' has ' &
          //reason//', which the implicit method does not have')
      end associate
    end do
  end subroutine check_implicit_laws

end module deck_resolve_eos_m
