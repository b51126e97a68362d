! SPDX-License-Identifier: MIT
!> Loads from outside: nodal forces, pressure on edges, base acceleration; rates of damping by mass
!> (*DAMPING_GLOBAL and *DAMPING_PART_MASS).
module external_force_m
  use conditions_m, only : conditions_t
  use curves_m, only : curve_t, curve_value
  use kinds_m, only : wp
  use model_m, only : model_t
  implicit none
  private
  public :: form_external_force, add_nodal_loads, add_pressures, body_acceleration, damping_rate, &
    part_damping_rate, damping_rates

contains

  !> Nodal loads and pressures at `time` on the present geometry.
  subroutine form_external_force(model, motion, time, force)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: motion(:, :)    !! (4, n_node)
    real(wp), intent(in) :: time
    real(wp), intent(inout) :: force(:, :)  !! (2, n_special), set here

    force = 0.0_wp
    call add_nodal_loads(model, time, force)
    call add_pressures(model, motion, time, force)
  end subroutine form_external_force

  !> Nodal loads at `time`.
  subroutine add_nodal_loads(model, time, force)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: time
    real(wp), intent(inout) :: force(:, :)
    integer :: i

    associate (loads => model%conditions%nodal_loads)
      do i = 1, size(loads)
        force(loads(i)%direction, loads(i)%node) = force(loads(i)%direction, loads(i)%node) &
          + loads(i)%scale*curve_value(model%curves(loads(i)%curve), time)
      end do
    end associate
  end subroutine add_nodal_loads

  !> Pressures at `time` on the present geometry, half of that on an edge to each node: against the
  !> outward normal (t_y, -t_x). On a round body per radian: with the edge times (2 r_a + r_b)/6 to
  !> node a.
  subroutine add_pressures(model, motion, time, force)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: motion(:, :)    !! (4, n_node)
    real(wp), intent(in) :: time
    real(wp), intent(inout) :: force(:, :)
    real(wp) :: edge(2), half(2), radii(2)
    integer :: i

    do i = 1, size(model%conditions%pressures)
      associate (load => model%conditions%pressures(i), x => model%mesh%coordinates, &
        a => model%conditions%pressures(i)%nodes(1), b => model%conditions%pressures(i)%nodes(2))
        if (time < load%arrival) cycle
        edge = (x(:, b) - x(:, a)) + (motion(1:2, b) - motion(1:2, a))
        half = 0.5_wp*load%scale*curve_value(model%curves(load%curve), time - load%arrival) &
          *[-edge(2), edge(1)]
        if (model%is_round) then
          radii = x(1, load%nodes) + motion(1, load%nodes)
          force(:, a) = force(:, a) + half*(2.0_wp*radii(1) + radii(2))/3.0_wp
          force(:, b) = force(:, b) + half*(radii(1) + 2.0_wp*radii(2))/3.0_wp
        else
          force(:, a) = force(:, a) + half
          force(:, b) = force(:, b) + half
        end if
      end associate
    end do
  end subroutine add_pressures

  !> Acceleration that *LOAD_BODY gives every node: minus the base acceleration.
  pure function body_acceleration(conditions, curves, time) result(acceleration)
    type(conditions_t), intent(in) :: conditions
    type(curve_t), intent(in) :: curves(:)
    real(wp), intent(in) :: time
    real(wp) :: acceleration(2)
    integer :: i

    acceleration = 0.0_wp
    do i = 1, size(conditions%body_loads)
      associate (load => conditions%body_loads(i))
        acceleration(load%direction) = acceleration(load%direction) &
          - load%scale*curve_value(curves(load%curve), time)
      end associate
    end do
  end function body_acceleration

  !> D per direction of the global damping f = -D m v.
  pure function damping_rate(conditions, curves, time) result(rate)
    type(conditions_t), intent(in) :: conditions
    type(curve_t), intent(in) :: curves(:)
    real(wp), intent(in) :: time
    real(wp) :: rate(2)

    rate = 0.0_wp
    if (.not. allocated(conditions%damping)) return
    associate (damping => conditions%damping)
      rate = damping%coefficient*damping%factor
      if (damping%curve > 0) rate = curve_value(curves(damping%curve), time)*damping%factor
    end associate
  end function damping_rate

  !> D per direction at `time` of each part, and in the last column of masses on nodes, which belong
  !> to no part: that of *DAMPING_GLOBAL.
  pure function damping_rates(model, time) result(rates)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: time
    real(wp) :: rates(2, size(model%parts) + 1) !! 1/s
    integer :: i

    rates = spread(damping_rate(model%conditions, model%curves, time), 2, size(rates, 2))
    do i = 1, size(model%parts)
      rates(:, i) = rates(:, i) + part_damping_rate(model, i, time)
    end do
  end function damping_rates

  !> D per direction that the masses of a part have at `time`; cards of one part add up.
  pure function part_damping_rate(model, part, time) result(rate)
    type(model_t), intent(in) :: model
    integer, intent(in) :: part
    real(wp), intent(in) :: time
    real(wp) :: rate(2)
    integer :: i

    rate = 0.0_wp
    if (.not. allocated(model%conditions%part_damping)) return
    do i = 1, size(model%conditions%part_damping)
      associate (damping => model%conditions%part_damping(i))
        if (damping%part == part) rate = rate + damping%scale*damping%factor &
          *curve_value(model%curves(damping%curve), time)
      end associate
    end do
  end function part_damping_rate

end module external_force_m
