! SPDX-License-Identifier: MIT
!> Values of load curves at a time: nodal forces, edge pressures, base acceleration, mass damping
!> (*DAMPING_GLOBAL and *DAMPING_PART_MASS), prescribed motion, time step limit. Fixed and
!> prescribed degrees of freedom have zero inverse mass, so that forces do not accelerate them;
!> prescribed velocities are then set from their curves.
module loads_m
  use conditions_m, only : conditions_t, prescribed_motion_t, motion_velocity, &
    motion_acceleration, motion_displacement
  use curves_m, only : curve_t, curve_value, curve_is_constant
  use kinds_m, only : wp
  use model_m, only : model_t
  implicit none
  private
  public :: form_external_force, add_nodal_loads, add_pressures, body_acceleration, damping_rate, &
    part_damping_rate, damping_rates, start_motion, fix_nodes, update_activity, next_velocity, &
    is_active, scaled_step

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

  !> Add pressures at `time` on the present geometry, against the outward normal (t_y, -t_x), half
  !> of the force of an edge to each node. Axisymmetric, per radian: pressure, edge length and (2
  !> r_a + r_b)/6 to node a.
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
        if (model%is_axisymmetric) then
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

  !> Acceleration of all nodes by *LOAD_BODY: minus the base acceleration.
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

  !> D per direction of the global damping f = -D m v, 1/s.
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

  !> D per direction at `time` of each part; in the last column that of lumped masses, by
  !> *DAMPING_GLOBAL only.
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

  !> D per direction of a part at `time` by *DAMPING_PART_MASS, the sum of its cards, 1/s.
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

  !> Motion at time zero: displacement zero, initial velocity of the deck; zero velocity of fixed
  !> degrees of freedom, the value of the curve at time zero of prescribed velocities.
  subroutine start_motion(model, known, motion)
    type(model_t), intent(in) :: model
    integer, intent(in) :: known(:, :) !! (2, n) first and last node of ranges that are set
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

  !> Set the inverse mass of fixed and of constrained degrees of freedom to zero.
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

  !> Whether a prescribed motion is active at `time`.
  elemental function is_active(prescribed, time) result(active)
    type(prescribed_motion_t), intent(in) :: prescribed
    real(wp), intent(in) :: time
    logical :: active

    active = time >= prescribed%birth .and. time < prescribed%death
  end function is_active

  !> Set the inverse mass of prescribed degrees of freedom: zero while their motion is active.
  !> Inactive motions first, so that a motion that becomes active in the same step prevails.
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

  !> v(n+1/2) of a prescribed degree of freedom: the curve at t(n+1/2); the integral of an
  !> acceleration; or the velocity that reaches the prescribed displacement at t(n+1).
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

  !> Time step at `time`, s: TSSFAC times the stability limit, at most the curve LCTM. A curve above
  !> the limit has no effect; a constant one below it replaces TSSFAC.
  pure function scaled_step(model, limit, time) result(dt)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: limit, time
    real(wp) :: dt, cap

    dt = model%controls%dt_scale*limit
    if (model%controls%dt_curve == 0) return
    associate (curve => model%curves(model%controls%dt_curve))
      cap = curve_value(curve, time)
      if (cap > limit) return
      if (.not. curve_is_constant(curve)) cap = min(cap, dt)
      dt = cap
    end associate
  end function scaled_step

end module loads_m
