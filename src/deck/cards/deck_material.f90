! SPDX-License-Identifier: MIT
!> *MAT_ with their curves and tables, and *EOS_.
module deck_material_m
  use kinds_m, only : wp
  use model_m, only : model_t
  use parts_m, only : material_t, law_elastic, law_plastic, law_null, law_crushable_foam, &
    law_mooney_rivlin, law_blatz_ko, law_viscoelastic, law_ogden, &
    rubber_t, mooney_rivlin, blatz_ko, blatz_ko_poisson
  use log_m, only : to_text
  use deck_lines_m, only : deck_t, blocks_of, line_error, line_warning
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, first_card, next_card, check_rest, report_field
  use deck_curves_m, only : table_t
  use deck_hardening_m, only : read_piecewise, read_hydro, read_tangent_modulus, &
    read_johnson_cook, read_simplified_johnson_cook, read_failure, read_cutoff
  use deck_ids_m, only : a_material, a_curve, an_eos
  use deck_values_m, only : integer_of, real_of, is_bad, has_field, define, map_defined, find_id, &
    reals_of, along_axes
  use eos_m, only : eos_t, eos_by_law, initial_stiffness, initial_pressure, asymptote, &
    eos_gruneisen, eos_linear_polynomial, eos_logarithmic
  implicit none
  private
  public :: read_materials, read_equations, assign_equation, set_pressure_moduli

contains

  !> All materials of the deck.
  subroutine read_materials(deck, tables, model)
    type(deck_t), intent(inout) :: deck
    type(table_t), intent(in) :: tables(:)
    type(model_t), intent(inout) :: model
    type(material_t), allocatable :: materials(:)
    type(material_t) :: material, unset
    type(cursor_t) :: cursor
    type(card_t) :: card, more
    integer, allocatable :: blocks(:)
    integer :: i, n

    blocks = blocks_of(deck, 'MAT_')
    allocate (materials(size(blocks)))
    do i = 1, size(blocks)
      if (deck%blocks(blocks(i))%name == 'MAT_ADD_EROSION') cycle
      call first_card(deck, blocks(i), cursor, card)
      material = unset
      call read_moduli(card, material)
      select case (deck%blocks(blocks(i))%name)
      case ('MAT_ELASTIC')
        material%law = law_elastic
      case ('MAT_PLASTIC_KINEMATIC')
        material%law = law_plastic
        call read_tangent_modulus(deck, card, material%hardening)
        material%yield = real_of(card, 'SIGY')
        material%beta = real_of(card, 'BETA')
        call next_card(deck, cursor, 2, more)
        call read_failure(more, 'FS', material)
      case ('MAT_PIECEWISE_LINEAR_PLASTICITY')
        call read_piecewise(deck, cursor, card, tables, model, material)
      case ('MAT_NULL')
        ! A fluid, which needs an equation of state.
        material%law = law_null
        material%takes_eos = .true.
        material%needs_eos = .true.
        material%viscosity = real_of(card, 'MU')
        call read_cutoff(card, material)
      case ('MAT_ELASTIC_PLASTIC_HYDRO')
        call read_hydro(deck, cursor, card, material)
      case ('MAT_JOHNSON_COOK')
        call read_johnson_cook(deck, cursor, card, material)
      case ('MAT_SIMPLIFIED_JOHNSON_COOK')
        call read_simplified_johnson_cook(deck, cursor, card, material)
      case ('MAT_MOONEY-RIVLIN_RUBBER')
        call read_mooney_rivlin(deck, cursor, card, material)
      case ('MAT_BLATZ-KO_RUBBER')
        material%law = law_blatz_ko
        if (.not. any(card%bad)) then
          material%rubber = blatz_ko(material%shear)
          call set_moduli(blatz_ko_poisson, material)
        end if
      case ('MAT_CRUSHABLE_FOAM')
        call read_crushable_foam(deck, card, model, material)
      case ('MAT_OGDEN_RUBBER')
        call read_ogden(deck, cursor, card, material)
      case ('MAT_VISCOELASTIC')
        call read_viscoelastic(deck, card, material)
      case ('MAT_RIGID')
        call read_rigid(deck, cursor, material)
      end select
      call check_rest(deck, cursor)
      call define(deck, a_material, card, n)
      if (n > 0) materials(n) = material
    end do
    model%materials = materials(:deck%maps(a_material)%n)
    call map_defined(deck, a_material, 'MID')
  end subroutine read_materials

  !> Number, density, and moduli from G or from E and PR.
  subroutine read_moduli(card, material)
    type(card_t), intent(in) :: card
    type(material_t), intent(inout) :: material

    material%id = integer_of(card, 'MID')
    material%density = real_of(card, 'RO')
    if (has_field(card, 'G')) material%shear = real_of(card, 'G')
    if (has_field(card, 'G') .or. .not. has_field(card, 'E')) return
    material%young = real_of(card, 'E')
    material%poisson = real_of(card, 'PR')
    if (is_bad(card, 'RO') .or. is_bad(card, 'E') .or. is_bad(card, 'PR')) return
    associate (young => material%young, poisson => material%poisson)
      material%bulk = young/(3.0_wp*(1.0_wp - 2.0_wp*poisson))
      material%shear = young/(2.0_wp*(1.0_wp + poisson))
    end associate
    material%sound_speed = sqrt((material%bulk + 4.0_wp*material%shear/3.0_wp)/material%density)
  end subroutine read_moduli

  !> *MAT_CRUSHABLE_FOAM: a yield stress curve, which must not fall, and TSC in tension.
  subroutine read_crushable_foam(deck, card, model, material)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(inout) :: model
    type(material_t), intent(inout) :: material
    character(:), allocatable :: name
    integer :: k

    material%law = law_crushable_foam
    material%tension = real_of(card, 'TSC')
    if (material%bulk > 0.0_wp) material%eos = eos_t(kind=eos_by_law, stiffness=material%bulk)
    call find_id(deck, a_curve, card, 'LCID', k)
    if (k == 0) return
    model%curves(k)%is_of_time = .false.
    associate (curve => model%curves(k), line => deck%maps(a_curve)%lines(k))
      material%crush = curve
      if (deck%maps(a_curve)%has_refused) return
      name = 'curve '//to_text(curve%id)//' is a yield stress against volumetric strain (LCID)'
      if (.not. minval(curve%ordinate) >= 0.0_wp .or. .not. maxval(curve%ordinate) > 0.0_wp) then
        call line_error(deck, line, name//' and must not be negative, nor 0 everywhere')
      else if (any(curve%ordinate(2:) < curve%ordinate(:size(curve%ordinate) - 1))) then
        call line_error(deck, line, name &
          //', which must not fall: foams harden as they are crushed')
      end if
      if (curve%abscissa(1) < 0.0_wp) call report_field(deck, card, 'LCID', &
        'is a curve that starts at the volumetric strain '//to_text(curve%abscissa(1)) &
        //', which is below 0: 1 - V/V0 counts compression')
    end associate
  end subroutine read_crushable_foam

  !> *MAT_MOONEY-RIVLIN_RUBBER.
  subroutine read_mooney_rivlin(deck, cursor, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material
    type(card_t) :: fit

    call next_card(deck, cursor, 2, fit)
    material%law = law_mooney_rivlin
    associate (a => real_of(card, 'A'), b => real_of(card, 'B'), poisson => real_of(card, 'PR'))
      if (.not. max(a, b) > 0.0_wp) call report_field(deck, card, 'A', &
        'is 0 as B is: 2 (A + B) is the shear modulus')
      if (any(card%bad)) return
      material%rubber = mooney_rivlin(a, b, poisson)
      material%shear = 2.0_wp*(a + b)
      call set_moduli(poisson, material)
    end associate
  end subroutine read_mooney_rivlin

  !> Set the moduli of small strain.
  pure subroutine set_moduli(poisson, material)
    real(wp), intent(in) :: poisson
    type(material_t), intent(inout) :: material

    material%poisson = poisson
    material%young = 2.0_wp*material%shear*(1.0_wp + poisson)
    material%bulk = material%young/(3.0_wp*(1.0_wp - 2.0_wp*poisson))
    material%eos = eos_t(kind=eos_by_law, stiffness=material%bulk)
    material%sound_speed = sqrt((material%bulk + 4.0_wp*material%shear/3.0_wp)/material%density)
  end subroutine set_moduli

  !> *MAT_OGDEN_RUBBER: pairs of MU and ALPHA, sum MU ALPHA = 2G.
  subroutine read_ogden(deck, cursor, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material
    type(card_t) :: mu, alpha, prony
    type(rubber_t) :: rubber
    integer :: k

    call next_card(deck, cursor, 2, mu)
    call next_card(deck, cursor, 3, alpha)
    call next_card(deck, cursor, 4, prony)
    material%law = law_ogden
    do k = 1, 8
      if (.not. abs(mu%r(k)) > 0.0_wp) cycle
      if (.not. abs(alpha%r(k)) > 0.0_wp) call report_field(deck, alpha, k, &
        'is no exponent of its MU, which is not 0')
      rubber%n_term = rubber%n_term + 1
      rubber%mu(rubber%n_term) = mu%r(k)
      rubber%alpha(rubber%n_term) = alpha%r(k)
    end do
    material%shear = 0.5_wp*dot_product(rubber%mu, rubber%alpha)
    if (.not. material%shear > 0.0_wp) call report_field(deck, mu, 'MU1', 'to MU8 times ALPHA1 ' &
      //'to ALPHA8 add up to '//to_text(2.0_wp*material%shear)//'; the sum is 2 G, above 0')
    if (any(card%bad) .or. any(mu%bad) .or. any(alpha%bad)) return
    material%rubber = rubber
    call set_moduli(real_of(card, 'PR'), material)
    material%rubber%bulk = material%bulk
  end subroutine read_ogden

  !> *MAT_VISCOELASTIC: bulk modulus, shear moduli at first and after a long time, decay constant.
  subroutine read_viscoelastic(deck, card, material)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material

    material%law = law_viscoelastic
    material%bulk = real_of(card, 'BULK')
    material%shear = real_of(card, 'G0')
    material%long_shear = real_of(card, 'GI')
    material%decay = real_of(card, 'BETA')
    if (material%long_shear > material%shear) call report_field(deck, card, 'GI', &
      'is above G0 "'//to_text(material%shear)//'": the modulus falls from G0 to GI')
    if (any(card%bad)) return
    associate (bulk => material%bulk, shear => material%shear)
      material%poisson = (3.0_wp*bulk - 2.0_wp*shear)/(2.0_wp*(3.0_wp*bulk + shear))
      material%young = 9.0_wp*bulk*shear/(3.0_wp*bulk + shear)
      material%sound_speed = sqrt((bulk + 4.0_wp*shear/3.0_wp)/material%density)
    end associate
  end subroutine read_viscoelastic

  !> *MAT_RIGID: CMO, CON1 and CON2.
  subroutine read_rigid(deck, cursor, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(material_t), intent(inout) :: material
    type(card_t) :: card, axes
    integer :: codes(2)

    material%is_rigid = .true.
    call next_card(deck, cursor, 2, card)
    call next_card(deck, cursor, 3, axes)
    codes = [integer_of(card, 'CON1'), integer_of(card, 'CON2')]
    if (integer_of(card, 'CMO') == -1) then
      call report_field(deck, card, 'CMO', 'asks for constraints in local axes, which this ' &
        //'version does not have; 1 takes the global ones')
    else if (any(codes < 0 .or. codes > 7)) then
      call report_field(deck, card, merge('CON1', 'CON2', codes(1) < 0 .or. codes(1) > 7), &
        'is not a code of constraints (0 to 7)')
    end if
    if (any(card%bad)) return
    if (integer_of(card, 'CMO') == 1) then
      material%is_fixed = [along_axes(:2, codes(1)), along_axes(3, codes(2))]
    else if (any(codes > 0)) then
      call line_warning(deck, card%line, 'CMO 0', &
        'CON1 and CON2 have no effect while CMO is 0; 1 makes them constraints')
    end if
  end subroutine read_rigid

  !> Read all equations of state.
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
      call define(deck, an_eos, card, n)
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

  !> Assign the equation of state of a part (EOSID) to its material. A material of parts with
  !> different equations of state is copied.
  subroutine assign_equation(deck, card, equations, model, equation_of, material)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card      !! of the part
    type(eos_t), intent(in) :: equations(:)
    type(model_t), intent(inout) :: model
    integer, allocatable, intent(inout) :: equation_of(:) !! equation of state of each material, 0
                                                          !! none, -1 unknown
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
    if (equation_of(material) < 0) equation_of(material) = k
    do m = size(equation_of), 1, -1
      if (model%materials(m)%id == model%materials(material)%id .and. equation_of(m) == k) exit
    end do
    if (m == 0) then
      model%materials = [model%materials, model%materials(material)]
      associate (map => deck%maps(a_material))
        map%lines = [map%lines, map%lines(material)]
      end associate
      equation_of = [equation_of, k]
      m = size(equation_of)
      if (allocated(model%materials(m)%eos)) deallocate (model%materials(m)%eos)
    end if
    material = m
    if (k > 0) model%materials(m)%eos = equations(k)
  end subroutine assign_equation

  !> Set the moduli of materials with an equation of state, and the internal one of materials that
  !> may erode.
  subroutine set_pressure_moduli(deck, equations, model)
    type(deck_t), intent(inout) :: deck
    type(eos_t), intent(in) :: equations(:)
    type(model_t), intent(inout) :: model
    integer :: m, k
    logical :: is_named

    do m = 1, size(model%materials)
      call set_pressure_modulus(deck, deck%maps(a_material)%lines(m), model%materials(m))
    end do
    do k = 1, size(equations)
      is_named = .false.
      do m = 1, size(model%materials)
        if (allocated(model%materials(m)%eos)) is_named = is_named &
          .or. model%materials(m)%eos%id == equations(k)%id
      end do
      if (.not. is_named) call line_warning(deck, deck%maps(an_eos)%lines(k), 'unused', &
        'no part uses equation of state '//to_text(equations(k)%id)//' (EOSID of *PART)')
    end do
  end subroutine set_pressure_moduli

  !> Set the moduli of one material.
  subroutine set_pressure_modulus(deck, line, material)
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
        //to_text(material%id)//' has no initial stiffness: the bulk modulus of its equation of ' &
        //'state '//to_text(material%eos%id)//' is '//to_text(material%bulk))
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
  end subroutine set_pressure_modulus

end module deck_material_m
