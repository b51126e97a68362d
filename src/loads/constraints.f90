! SPDX-License-Identifier: MIT
!> Fixed and prescribed degrees of freedom, and the motion at time zero. Both have no inverse mass,
!> so that forces do not move them; prescribed ones are then set from their curves.
module constraints_m
  use kinds_m, only : wp
  use conditions_m, only : prescribed_motion_t, motion_velocity, motion_acceleration, &
    motion_displacement
  use curves_m, only : curve_value
  use model_m, only : model_t
  implicit none
  private
  public :: start_motion, fix_nodes, update_activity, next_velocity, is_active

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

  !> Take the inverse mass of fixed degrees of freedom away, and of those that move with others.
  subroutine fix_nodes(model, inverse_mass)
    type(model_t), intent(in) :: model
    real(wp), intent(inout) :: inverse_mass(:, :) !! (2, n_node)
    integer :: i

    do i = 1, size(model%conditions%fixed_nodes)
      inverse_mass(model%conditions%fixed_directions(i), model%conditions%fixed_nodes(i)) = 0.0_wp
    end do
    if (.not. allocated(model%conditions%common_motions)) return
    do i = 1, size(model%conditions%common_motions)
      associate (common => model%conditions%common_motions(i))
        if (common%along(1)) inverse_mass(1, common%nodes) = 0.0_wp
        if (common%along(2)) inverse_mass(2, common%nodes) = 0.0_wp
      end associate
    end do
  end subroutine fix_nodes

  !> Whether a prescribed motion holds at `time`.
  elemental function is_active(prescribed, time) result(active)
    type(prescribed_motion_t), intent(in) :: prescribed
    real(wp), intent(in) :: time
    logical :: active

    active = time >= prescribed%birth .and. time < prescribed%death
  end function is_active

  !> Give prescribed degrees of freedom their inverse mass while their motion does not hold. Deaths
  !> first, so that a motion that takes over in the same step keeps its node.
  subroutine update_activity(model, time, mass, inverse_mass)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: time
    real(wp), intent(in) :: mass(:)               !! (n_node)
    real(wp), intent(inout) :: inverse_mass(:, :) !! (2, n_node)
    integer :: i

    associate (motions => model%conditions%motions)
      do i = 1, size(motions)
        if (.not. is_active(motions(i), time) .and. mass(motions(i)%node) > 0.0_wp) &
          inverse_mass(motions(i)%direction, motions(i)%node) = 1.0_wp/mass(motions(i)%node)
      end do
      do i = 1, size(motions)
        if (is_active(motions(i), time)) inverse_mass(motions(i)%direction, motions(i)%node) &
          = 0.0_wp
      end do
    end associate
  end subroutine update_activity

  !> v(n+1/2) of a prescribed degree of freedom: the curve at t(n+1/2); the integral of the curve;
  !> or what leads to the curve's position at t(n+1).
  pure function next_velocity(model, prescribed, time, dt, dt_before, displacement, velocity) &
    result(next)
    type(model_t), intent(in) :: model
    type(prescribed_motion_t), intent(in) :: prescribed
    real(wp), intent(in) :: time         !! t(n)
    real(wp), intent(in) :: dt           !! t(n+1) - t(n)
    real(wp), intent(in) :: dt_before    !! t(n) - t(n-1), 0 at the start
    real(wp), intent(in) :: displacement !! u(n)
    real(wp), intent(in) :: velocity     !! v(n-1/2), v(0) at the start
    real(wp) :: next

    associate (curve => model%curves(prescribed%curve))
      select case (prescribed%kind)
      case (motion_velocity)
        next = prescribed%scale*curve_value(curve, time + 0.5_wp*dt)
      case (motion_acceleration)
        next = velocity + 0.5_wp*(dt + dt_before)*prescribed%scale*curve_value(curve, time)
      case (motion_displacement)
        next = (prescribed%scale*curve_value(curve, time + dt) - displacement)/dt
      case default
        next = velocity
      end select
    end associate
  end function next_velocity

end module constraints_m
