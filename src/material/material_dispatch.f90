! SPDX-License-Identifier: MIT
!> Selection of the material law.
module material_dispatch_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use parts_m, only : material_t, law_elastic, law_plastic, law_piecewise, law_johnson_cook, &
    law_hot_johnson_cook, law_null, has_memory_of_heat, law_mooney_rivlin, law_blatz_ko, &
    law_crushable_foam, law_viscoelastic, law_ogden
  use stress_chunk_m, only : stress_chunk_t, stress_point_t
  use material_crushable_foam_m, only : update_crushable_foam
  use material_elastic_m, only : update_elastic, update_null
  use material_j2_m, only : update_j2_isotropic, update_j2_mixed, tangent_of_return
  use material_johnson_cook_m, only : update_johnson_cook
  use material_ogden_m, only : update_ogden
  use material_piecewise_m, only : update_piecewise, tangent_piecewise
  use material_rubber_m, only : update_mooney_rivlin, update_blatz_ko
  use material_viscoelastic_m, only : update_viscoelastic
  implicit none
  private
  public :: update_stress, form_tangent, history_size, find_failed, &
    column_temperature, column_damage, has_plastic_strain, &
    is_elastic, returns_radially, law_name, has_mean_dilatation

  !> Columns of the history of the heated Johnson-Cook law: temperature rise, damage.
  integer, parameter :: column_temperature = 2, column_damage = 3

contains

  !> History values per element of a law: 0, 1 (plastic strain), 3 (and temperature rise, damage) or
  !> 4 (and back stress xx, yy, xy). The first value is the plastic strain, for foam the mean stress
  !> (`has_plastic_strain`).
  pure function history_size(material) result(n)
    type(material_t), intent(in) :: material
    integer :: n

    select case (material%law)
    case (law_plastic)
      n = merge(1, 4, has_no_back_stress(material))
    case (law_piecewise, law_johnson_cook, law_crushable_foam)
      n = 1
    case (law_hot_johnson_cook, law_viscoelastic)
      n = 3
    case default
      n = 0
    end select
  end function history_size

  !> Name of a law in reports.
  pure function law_name(material) result(name)
    type(material_t), intent(in) :: material
    character(:), allocatable :: name
    character(24), parameter :: names(*) = [character(24) :: 'elastic', 'elastic-plastic', &
      'piecewise linear plastic', 'Johnson-Cook', 'crushable foam', 'heated Johnson-Cook', &
      'fluid', 'Mooney-Rivlin rubber', 'Blatz-Ko rubber', 'viscoelastic', &
      'Ogden rubber']
    integer, parameter :: laws(*) = [law_elastic, law_plastic, law_piecewise, law_johnson_cook, &
      law_crushable_foam, law_hot_johnson_cook, law_null, law_mooney_rivlin, law_blatz_ko, &
      law_viscoelastic, law_ogden]

    name = 'rigid'
    if (.not. material%is_rigid) name = trim(names(findloc(laws, material%law, dim=1)))
  end function law_name

  !> Whether fully integrated elements have mean dilatation, against volumetric locking: where the
  !> material is or becomes nearly incompressible.
  pure function has_mean_dilatation(material) result(yes)
    type(material_t), intent(in) :: material
    logical :: yes

    yes = material%poisson > 0.4_wp .or. history_size(material) > 0 .or. allocated(material%eos)
  end function has_mean_dilatation

  !> Whether the history of a law starts with a plastic strain; that of foam has the mean stress,
  !> that of viscoelasticity the overstress.
  pure function has_plastic_strain(material) result(yes)
    type(material_t), intent(in) :: material
    logical :: yes

    yes = history_size(material) > 0 .and. all(material%law /= [law_crushable_foam, &
      law_viscoelastic])
  end function has_plastic_strain

  !> Whether a law is linear elasticity with the pressure K ln(J).
  pure function is_elastic(material) result(yes)
    type(material_t), intent(in) :: material
    logical :: yes

    yes = material%law == law_elastic .and. .not. allocated(material%eos)
  end function is_elastic

  !> Whether a law is `update_j2_isotropic` with the pressure K ln(J), without failure.
  pure function returns_radially(material) result(yes)
    type(material_t), intent(in) :: material
    logical :: yes

    yes = material%law == law_plastic .and. .not. allocated(material%eos)
    if (yes) yes = has_no_back_stress(material) .and. .not. material%failure_strain < huge(1.0_wp)
  end function returns_radially

  !> Update the deviator of one chunk by its law.
  pure subroutine update_stress(material, chunk, history)
    type(material_t), intent(in) :: material
    type(stress_chunk_t), intent(inout) :: chunk
    real(wp), intent(inout), optional :: history(chunk_size, *) !! history_size(material) columns;
                                                                !! absent for a law without history
    real(wp) :: before(chunk_size)
    logical :: may_break

    may_break = material%failure_strain < huge(1.0_wp)
    if (may_break) before = history(:, 1)
    select case (material%law)
    case (law_elastic)
      call update_elastic(material%shear, chunk)
    case (law_plastic)
      if (has_no_back_stress(material)) then
        call update_j2_isotropic(material, chunk, history(:, 1))
      else
        call update_j2_mixed(material, chunk, history(:, 1), history(:, 2), history(:, 3), &
          history(:, 4))
      end if
    case (law_piecewise)
      call update_piecewise(material%shear, material%curve, chunk, history(:, 1))
    case (law_johnson_cook)
      call update_johnson_cook(material%shear, material%flow, chunk, history(:, 1))
    case (law_hot_johnson_cook)
      call update_johnson_cook(material%shear, material%flow, chunk, history(:, 1), &
        history(:, column_temperature), history(:, column_damage))
    case (law_null)
      call update_null(material%viscosity, chunk)
    case (law_mooney_rivlin)
      call update_mooney_rivlin(material%rubber, chunk)
    case (law_blatz_ko)
      call update_blatz_ko(material%rubber, chunk)
    case (law_ogden)
      call update_ogden(material%rubber, chunk)
    case (law_crushable_foam)
      call update_crushable_foam(material, chunk, history(:, 1))
    case (law_viscoelastic)
      call update_viscoelastic(material, chunk, history(:, 1), history(:, 2), history(:, 3))
    end select
    if (may_break) call fail(material%failure_strain, before, chunk, history(:, 1))
  end subroutine update_stress

  !> Set the stress of failed points to zero; their plastic strain stays.
  pure subroutine fail(limit, before, chunk, plastic_strain)
    real(wp), intent(in) :: limit
    real(wp), intent(in) :: before(chunk_size) !! plastic strain at the start of the step
    type(stress_chunk_t), intent(inout) :: chunk
    real(wp), intent(inout) :: plastic_strain(chunk_size)
    real(wp) :: keep
    integer :: i

    !$omp simd private(keep)
    do i = 1, chunk_size
      keep = merge(0.0_wp, 1.0_wp, plastic_strain(i) >= limit)
      ! The stress at the end of the step does no work then.
      chunk%work(i) = chunk%work(i) - 0.5_wp*(1.0_wp - keep)*(chunk%sxx(i)*chunk%dxx(i) &
        + chunk%syy(i)*chunk%dyy(i) + 2.0_wp*chunk%sxy(i)*chunk%dxy(i))
      chunk%sxx(i) = keep*chunk%sxx(i)
      chunk%syy(i) = keep*chunk%syy(i)
      chunk%sxy(i) = keep*chunk%sxy(i)
      plastic_strain(i) = merge(before(i), plastic_strain(i), before(i) >= limit)
    end do
  end subroutine fail

  !> Failed points, and whether they keep their pressure.
  pure subroutine find_failed(material, history, failed, keeps_pressure)
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: history(chunk_size, *)
    logical, intent(out) :: failed(chunk_size)
    logical, intent(out) :: keeps_pressure

    keeps_pressure = has_memory_of_heat(material)
    if (keeps_pressure) then
      failed = history(:, column_damage) >= 1.0_wp
    else
      failed = history(:, 1) >= material%failure_strain
    end if
  end subroutine find_failed

  !> Deviator at the end of a step and its derivative, at one point.
  pure subroutine form_tangent(material, point)
    type(material_t), intent(in) :: material
    type(stress_point_t), intent(inout) :: point !! back stress 0 for a law without

    select case (material%law)
    case (law_elastic)
      ! Infinite yield stress.
      call tangent_of_return(material%shear, huge(1.0_wp), 0.0_wp, point)
    case (law_plastic)
      call tangent_of_return(material%shear, material%yield + material%beta*material%hardening &
        *point%plastic_strain, material%hardening, point)
    case (law_piecewise)
      call tangent_piecewise(material%shear, material%curve, point)
    end select
  end subroutine form_tangent

  !> Whether the yield surface does not move: isotropic or perfect plasticity.
  pure function has_no_back_stress(material) result(none)
    type(material_t), intent(in) :: material
    logical :: none

    none = material%beta >= 1.0_wp .or. material%hardening <= 0.0_wp
  end function has_no_back_stress

end module material_dispatch_m
