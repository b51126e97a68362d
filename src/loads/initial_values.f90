! SPDX-License-Identifier: MIT
!> Motion at time zero.
module initial_values_m
  use kinds_m, only : wp
  use constraints_m, only : is_active
  use conditions_m, only : motion_velocity
  use curves_m, only : curve_value
  use model_m, only : model_t
  implicit none
  private
  public :: start_motion

contains

  !> Displacement zero, velocity as the deck gives it; fixed degrees of freedom rest, and those
  !> with a prescribed velocity start with the curve's first value (a body that is driven from the
  !> start moves from the start).
  subroutine start_motion(model, known, motion)
    type(model_t), intent(in) :: model
    integer, intent(in) :: known(:, :) !! (2, n) first and last node of those that are asked for
    real(wp), allocatable, intent(out) :: motion(:, :) !! (4, n_node)
    integer :: i

    allocate (motion(4, model%mesh%n_node))
    associate (conditions => model%conditions)
      do i = 1, size(known, 2)
        associate (first => known(1, i), last => known(2, i))
          motion(:, first:last) = 0.0_wp
          if (allocated(conditions%initial_velocity)) &
            motion(3:4, first:last) = conditions%initial_velocity(:, first:last)
        end associate
      end do
      do i = 1, size(conditions%fixed_nodes)
        motion(2 + conditions%fixed_directions(i), conditions%fixed_nodes(i)) = 0.0_wp
      end do
      if (allocated(conditions%skew_supports)) then
        do i = 1, size(conditions%skew_supports)
          associate (normal => conditions%skew_supports(i)%normal, &
            velocity => motion(3:4, conditions%skew_supports(i)%node))
            velocity = velocity - dot_product(normal, velocity)*normal
          end associate
        end do
      end if
      do i = 1, size(conditions%motions)
        associate (prescribed => conditions%motions(i))
          if (.not. is_active(prescribed, 0.0_wp) .or. prescribed%kind /= motion_velocity) cycle
          motion(2 + prescribed%direction, prescribed%node) = prescribed%scale &
            *curve_value(model%curves(prescribed%curve), 0.0_wp)
        end associate
      end do
    end associate
  end subroutine start_motion

end module initial_values_m
