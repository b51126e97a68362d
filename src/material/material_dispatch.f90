! SPDX-License-Identifier: MIT
!> The one place that asks for the material law.
module material_dispatch_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use parts_m, only : material_t, law_elastic, law_plastic, law_piecewise
  use stress_chunk_m, only : stress_chunk_t
  use stress_point_m, only : stress_point_t
  use material_elastic_m, only : update_elastic, tangent_elastic
  use material_j2_m, only : update_j2_isotropic, update_j2_mixed, tangent_j2
  use material_piecewise_m, only : update_piecewise, tangent_piecewise
  implicit none
  private
  public :: update_stress, form_tangent, history_size

contains

  !> History values per element of a law: 0, 1 (plastic strain) or 4 (and back stress xx, yy, xy).
  !> The first one is always the plastic strain.
  pure function history_size(material) result(n)
    type(material_t), intent(in) :: material
    integer :: n

    select case (material%law)
    case (law_plastic)
      n = merge(1, 4, has_no_back_stress(material))
    case (law_piecewise)
      n = 1
    case default
      n = 0
    end select
  end function history_size

  !> Advance the deviator of one chunk by its law.
  pure subroutine update_stress(material, chunk, history)
    type(material_t), intent(in) :: material
    type(stress_chunk_t), intent(inout) :: chunk
    real(wp), intent(inout), optional :: history(chunk_size, *) !! history_size(material) columns;
                                                                !! absent for a law without history

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
    end select
  end subroutine update_stress

  !> Deviator at the end of a step and its derivative, at one point.
  pure subroutine form_tangent(material, point)
    type(material_t), intent(in) :: material
    type(stress_point_t), intent(inout) :: point !! back stress 0 for a law without

    select case (material%law)
    case (law_elastic)
      call tangent_elastic(material%shear, point)
    case (law_plastic)
      call tangent_j2(material, point)
    case (law_piecewise)
      call tangent_piecewise(material%shear, material%curve, point)
    end select
  end subroutine form_tangent

  !> Isotropic or perfect plasticity moves no yield surface.
  pure function has_no_back_stress(material) result(none)
    type(material_t), intent(in) :: material
    logical :: none

    none = material%beta >= 1.0_wp .or. material%hardening <= 0.0_wp
  end function has_no_back_stress

end module material_dispatch_m
