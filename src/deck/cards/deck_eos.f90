! SPDX-License-Identifier: MIT
!> *EOS_LINEAR_POLYNOMIAL and _GRUNEISEN, and the pressures of materials.
module deck_eos_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use eos_m, only : eos_t, initial_stiffness, initial_pressure, asymptote, eos_gruneisen, &
    eos_linear_polynomial, eos_logarithmic
  use model_m, only : model_t
  use parts_m, only : material_t
  use deck_cards_m, only : cursor_t, first_card, next_card, check_rest, report_field
  use deck_fields_m, only : card_t
  use deck_ids_m, only : a_material, an_eos
  use deck_lines_m, only : deck_t, blocks_of, line_error, line_warning
  use deck_values_m, only : integer_of, real_of, reals_of, define, map_defined, find_id
  implicit none
  private
  public :: read_equations, take_equation, settle_pressures

contains

  !> All equations of state. Bodies start with the density of their material.
  subroutine read_equations(deck, equations)
    type(deck_t), intent(inout) :: deck
    type(eos_t), allocatable, intent(out) :: equations(:)
    type(cursor_t) :: cursor
    type(card_t) :: card, start
    integer, allocatable :: blocks(:)
    integer :: i, n

    blocks = blocks_of(deck, 'EOS_')
    allocate (equations(size(blocks)))
    do i = 1, size(blocks)
      call first_card(deck, blocks(i), cursor, card)
      call next_card(deck, cursor, 2, start)
      call check_rest(deck, cursor)
      call define(deck, an_eos, card, 'EOSID', n)
      if (n == 0) cycle
      associate (eos => equations(n))
        eos%id = integer_of(card, 'EOSID')
        if (deck%blocks(blocks(i))%name == 'EOS_GRUNEISEN') then
          eos%kind = eos_gruneisen
          eos%speed = real_of(card, 'C')
          eos%s = reals_of(card, 'S1', 'S3')
          eos%gamma = real_of(card, 'GAMAO')
          eos%correction = real_of(card, 'A')
          eos%energy = real_of(card, 'E0')
        else
          eos%kind = eos_linear_polynomial
          eos%c = reals_of(card, 'C0', 'C6')
          eos%energy = real_of(start, 'E0')
        end if
      end associate
    end do
    equations = equations(:deck%maps(an_eos)%n)
    call map_defined(deck, an_eos, 'EOSID')
  end subroutine read_equations

  !> EOSID of a part: its material gets the equation of state. A material whose parts name different
  !> ones becomes as many materials.
  subroutine take_equation(deck, card, equations, model, taken, material)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card      !! of the part
    type(eos_t), intent(in) :: equations(:)
    type(model_t), intent(inout) :: model
    integer, allocatable, intent(inout) :: taken(:) !! equation of state of each material, 0 none,
                                             !! -1 not known yet
    integer, intent(inout) :: material       !! index, of a copy in the end
    integer :: k, m

    k = 0
    associate (given => model%materials(material))
      if (integer_of(card, 'EOSID') > 0 .and. given%takes_eos) then
        call find_id(deck, an_eos, card, 'EOSID', k)
        if (k == 0) return
      else if (integer_of(card, 'EOSID') > 0) then
        call report_field(deck, card, 'EOSID', 'is an equation of state, but material ' &
          //to_text(given%id)//' has a pressure of its own; leave it 0')
        return
      else if (integer_of(card, 'EOSID') == 0 .and. given%needs_eos) then
        call line_error(deck, card%line, 'part '//to_text(integer_of(card, 'PID')) &
          //' names no equation of state (EOSID), from which its material '//to_text(given%id) &
          //' gets its pressure')
        return
      end if
    end associate
    if (taken(material) < 0) taken(material) = k
    do m = size(taken), 1, -1
      if (model%materials(m)%id == model%materials(material)%id .and. taken(m) == k) exit
    end do
    if (m == 0) then
      model%materials = [model%materials, model%materials(material)]
      associate (map => deck%maps(a_material))
        map%lines = [map%lines, map%lines(material)]
      end associate
      taken = [taken, k]
      m = size(taken)
      if (allocated(model%materials(m)%eos)) deallocate (model%materials(m)%eos)
    end if
    material = m
    if (k > 0) model%materials(m)%eos = equations(k)
  end subroutine take_equation

  !> Moduli that follow from the pressure; where points may fail, one that can be lost.
  subroutine settle_pressures(deck, equations, model)
    type(deck_t), intent(inout) :: deck
    type(eos_t), intent(in) :: equations(:)
    type(model_t), intent(inout) :: model
    integer :: m, k
    logical :: is_named

    do m = 1, size(model%materials)
      call settle_pressure(deck, deck%maps(a_material)%lines(m), model%materials(m))
    end do
    do k = 1, size(equations)
      is_named = .false.
      do m = 1, size(model%materials)
        if (allocated(model%materials(m)%eos)) is_named = is_named &
          .or. model%materials(m)%eos%id == equations(k)%id
      end do
      if (.not. is_named) call line_warning(deck, deck%maps(an_eos)%lines(k), 'unused', &
        'no part names equation of state '//to_text(equations(k)%id)//' (EOSID of *PART)')
    end do
  end subroutine settle_pressures

  !> One material.
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

end module deck_eos_m
