! SPDX-License-Identifier: MIT
!> Equations of the implicit driver: free degrees of freedom first, then prescribed ones, nodes
!> before rigid bodies; fixed ones and nodes without elements have none, nodes of rigid bodies the
!> numbers after all. Prescribed displacement, velocity and acceleration over one
!> step (doc/theory/implicit.md, section 1).
module equations_m
  use conditions_m, only : prescribed_motion_t, motion_velocity, motion_acceleration, &
    motion_displacement
  use loads_m, only : is_active
  use curves_m, only : curve_t, curve_value, curve_integral
  use element_mass_m, only : add_mass
  use kinds_m, only : wp
  use mesh_m, only : mesh_t
  use model_m, only : model_t
  use rigid_state_m, only : body_scales
  use sparse_m, only : sparse_t, add_block
  use state_m, only : state_t
  implicit none
  private
  public :: equations_t, number_equations, parent_equations, condense, add_free_mass, &
    move_prescribed, free_entries, prescribed_step_t, &
    prescribe_step, prescribe_start, put_prescribed, list_changes, mean_slope, curve_moment

  !> Numbering for one step.
  type :: equations_t
    integer :: n_free = 0
    integer :: n = 0                        !! free and prescribed ones
    integer, allocatable :: number(:, :)    !! (2, n_node), 0 = none
    integer, allocatable :: bodies(:, :)    !! (3, n_body) of rigid bodies: x, y and turn
    integer, allocatable :: collected(:, :) !! (2, n_node) as `number`; hanging nodes and, after
                                            !! them, nodes of rigid bodies have numbers above n
                                            !! until the matrix is condensed
    integer, allocatable :: motion_of(:)    !! (n - n_free) index of the prescribed motion; those of
                                            !! rigid bodies follow those of nodes
  end type equations_t

  !> Share of a step below which two times are equal.
  real(wp), parameter :: same_time = 1.0e-6_wp

  !> Change of slope of a corner of a curve, as a share of the steeper side.
  real(wp), parameter :: corner = 0.5_wp
  !> Largest number of plot states for which steps are cut.
  real(wp), parameter :: most_plots = 1.0e4_wp

  !> Prescribed degrees of freedom of one step, in the order of their equations.
  type :: prescribed_step_t
    real(wp), allocatable :: increment(:)    !! u(n+1) - u(n) of the unknown
    real(wp), allocatable :: velocity(:)     !! v(n+1)
    real(wp), allocatable :: acceleration(:) !! a(n+1)
    real(wp), allocatable :: mean(:)         !! (v(n+1) - v(n))/dt, for the inertia force of the
                                             !! step
  end type prescribed_step_t

contains

  !> Number the equations of a step; `time` lies inside it (no motion starts or ends there).
  pure subroutine number_equations(model, state, time, equations)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: time
    type(equations_t), intent(out) :: equations
    integer :: at(2*model%mesh%n_node + 3*size(model%rigids)), i, k, n

    allocate (equations%number(2, model%mesh%n_node), source=0)
    allocate (equations%bodies(3, size(model%rigids)), source=1)
    do i = 1, model%mesh%n_node
      if (state%mass(i) > 0.0_wp) equations%number(:, i) = 1
    end do
    do i = 1, size(model%conditions%fixed_nodes)
      equations%number(model%conditions%fixed_directions(i), model%conditions%fixed_nodes(i)) = 0
    end do
    do i = 1, size(model%rigids)
      equations%number(:, model%rigids(i)%nodes) = 0
      where (model%rigids(i)%is_fixed) equations%bodies(:, i) = 0
    end do
    n = size(model%conditions%motions)
    call mark_motions(model%conditions%motions, 0, equations%number)
    call mark_motions(model%conditions%rigid_motions, n, equations%bodies)
    at = [equations%number, equations%bodies]
    equations%motion_of = -pack(at, at < 0)
    equations%n_free = count(at > 0)
    equations%n = equations%n_free + size(equations%motion_of)
    associate (n_free => equations%n_free, n_nodal => size(equations%number))
      at = unpack([(i, i=n_free + 1, equations%n)], at < 0, unpack([(i, i=1, n_free)], at > 0, at))
      equations%number = reshape(at(:n_nodal), [2, model%mesh%n_node])
      equations%bodies = reshape(at(n_nodal + 1:), [3, size(model%rigids)])
    end associate
    equations%collected = equations%number
    n = equations%n
    if (allocated(model%mesh%hanging)) then
      do i = 1, size(model%mesh%hanging, 2)
        equations%collected(:, model%mesh%hanging(1, i)) = [n + 1, n + 2]
        n = n + 2
      end do
    end if
    do i = 1, size(model%rigids)
      do k = 1, size(model%rigids(i)%nodes)
        equations%collected(:, model%rigids(i)%nodes(k)) = [n + 1, n + 2]
        n = n + 2
      end do
    end do

  contains

    !> Mark degrees of freedom whose motion is active by minus its index.
    pure subroutine mark_motions(motions, before, numbers)
      type(prescribed_motion_t), intent(in) :: motions(:)
      integer, intent(in) :: before          !! motions before these
      integer, intent(inout) :: numbers(:, :)
      integer :: j

      do j = 1, size(motions)
        associate (number => numbers(motions(j)%direction, motions(j)%node))
          if (is_active(motions(j), time) .and. number /= 0) number = -before - j
        end associate
      end do
    end subroutine mark_motions

  end subroutine number_equations

  !> Equations of both parents of each hanging degree of freedom.
  pure function parent_equations(mesh, numbers) result(to)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: numbers(:, :) !! (2, n_node)
    integer, allocatable :: to(:, :)     !! (2, 2 n_hanging)
    integer :: i, k

    allocate (to(2, 0))
    if (allocated(mesh%hanging)) to = reshape([((numbers(k, mesh%hanging(2:3, i)), k=1, 2), i=1, &
      size(mesh%hanging, 2))], [2, 2*size(mesh%hanging, 2)])
  end function parent_equations

  !> Condense dependent degrees of freedom, the numbers above n, out of the collected entries of a
  !> matrix: each is the sum of two others times their shares.
  pure subroutine condense(n, to, shares, matrix)
    integer, intent(in) :: n
    integer, intent(in) :: to(:, :)         !! (2, dependent) their equations, 0 = none
    real(wp), intent(in) :: shares(:, :)    !! (2, dependent)
    type(sparse_t), intent(inout) :: matrix !! not compressed
    real(wp), allocatable :: values(:)
    integer, allocatable :: dependent(:), rows(:), columns(:)
    integer :: i, pair(2, 2), n_left
    real(wp) :: weights(2, 2)

    ! Entries of dependent ones leave the list, the others move up.
    associate (last => matrix%n_entry)
      dependent = pack([(i, i=1, last)], max(matrix%rows(:last), matrix%columns(:last)) > n)
      rows = matrix%rows(dependent)
      columns = matrix%columns(dependent)
      values = matrix%values(dependent)
      n_left = 0
      do i = 1, last
        if (max(matrix%rows(i), matrix%columns(i)) > n) cycle
        n_left = n_left + 1
        matrix%rows(n_left) = matrix%rows(i)
        matrix%columns(n_left) = matrix%columns(i)
        matrix%values(n_left) = matrix%values(i)
      end do
      last = n_left
    end associate
    do i = 1, size(values)
      call expand(rows(i), pair(:, 1), weights(:, 1))
      call expand(columns(i), pair(:, 2), weights(:, 2))
      weights = values(i)*reshape([weights(:, 1)*weights(1, 2), weights(:, 1)*weights(2, 2)], &
        [2, 2])
      call add_block(matrix, pair(:, 1), pair(:, 2), weights)
    end do

  contains

    !> Equations of a collected number and their weights.
    pure subroutine expand(number, at, weight)
      integer, intent(in) :: number
      integer, intent(out) :: at(2)
      real(wp), intent(out) :: weight(2)

      at = [number, 0]
      weight = 1.0_wp
      if (number <= n) return
      at = to(:, number - n)
      weight = shares(:, number - n)
    end subroutine expand

  end subroutine condense

  !> Add a mass matrix, or that of mass damping, of the free degrees of freedom.
  pure subroutine add_free_mass(model, factor, equations, matrix, rates)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: factor
    type(equations_t), intent(in) :: equations
    type(sparse_t), intent(inout) :: matrix       !! not compressed
    real(wp), intent(in), optional :: rates(:, :) !! as of `add_mass`
    integer :: columns(2, model%mesh%n_node)
    integer, allocatable :: to(:, :)

    columns = merge(equations%number, 0, equations%number <= equations%n_free)
    to = parent_equations(model%mesh, columns)
    if (allocated(model%mesh%hanging)) columns(:, model%mesh%hanging(1, :)) &
      = equations%collected(:, model%mesh%hanging(1, :))
    call add_mass(model, factor, columns, matrix, rates)
    if (size(to) > 0) call condense(equations%n, to, spread(spread(0.5_wp, 1, 2), 2, &
      size(to, 2)), matrix)
  end subroutine add_free_mass

  !> Move prescribed columns of the matrix to the right-hand side: b(free) -= K(free, prescribed) *
  !> increments. The matrix keeps the free rows and columns.
  pure subroutine move_prescribed(n_free, increments, matrix, b)
    integer, intent(in) :: n_free
    real(wp), intent(in) :: increments(:)
    type(sparse_t), intent(inout) :: matrix
    real(wp), intent(inout) :: b(:) !! (n_free)
    integer :: i, n

    n = 0
    do i = 1, matrix%n_entry
      if (matrix%rows(i) > n_free) cycle
      if (matrix%columns(i) > n_free) then
        b(matrix%rows(i)) = b(matrix%rows(i)) - matrix%values(i) &
          *increments(matrix%columns(i) - n_free)
        cycle
      end if
      n = n + 1
      matrix%rows(n) = matrix%rows(i)
      matrix%columns(n) = matrix%columns(i)
      matrix%values(n) = matrix%values(i)
    end do
    matrix%n_entry = n
    matrix%n = n_free
  end subroutine move_prescribed

  !> Free entries of a nodal field and of values of the rigid bodies.
  pure function free_entries(equations, field, bodies) result(vector)
    type(equations_t), intent(in) :: equations
    real(wp), intent(in) :: field(:, :)  !! (2, n_node)
    real(wp), intent(in) :: bodies(:, :) !! (3, n_body)
    real(wp) :: vector(equations%n_free)

    vector = [pack(field, equations%number > 0 .and. equations%number <= equations%n_free), &
      pack(bodies, equations%bodies > 0 .and. equations%bodies <= equations%n_free)]
  end function free_entries

  !> Put values of the prescribed degrees of freedom into a field.
  pure subroutine put_prescribed(numbers, n_free, values, field)
    integer, intent(in) :: numbers(:, :) !! equations of the field
    integer, intent(in) :: n_free
    real(wp), intent(in) :: values(:)
    real(wp), intent(inout) :: field(:, :)
    integer :: i, k

    do i = 1, size(numbers, 2)
      do k = 1, size(numbers, 1)
        if (numbers(k, i) > n_free) field(k, i) = values(numbers(k, i) - n_free)
      end do
    end do
  end subroutine put_prescribed

  !> Prescribed motion from `state` to `time`. No motion starts or ends inside the step.
  pure subroutine prescribe_step(model, state, time, equations, prescribed)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: time
    type(equations_t), intent(in) :: equations
    type(prescribed_step_t), intent(out) :: prescribed
    real(wp) :: path(3), before(2) !! displacement and velocity at the start
    real(wp) :: scales(3, size(state%rigids)), scale
    integer :: i, n, n_nodal

    n = size(equations%motion_of)
    n_nodal = size(model%conditions%motions)
    scales = body_scales(state%rigids)
    allocate (prescribed%increment(n), prescribed%velocity(n), prescribed%acceleration(n), &
      prescribed%mean(n))
    do i = 1, n
      associate (k => equations%motion_of(i))
        if (k <= n_nodal) then
          associate (motion => model%conditions%motions(k))
            scale = 1.0_wp
            before = state%motion([motion%direction, 2 + motion%direction], motion%node)
            path = follow_curve(model, motion, [state%time, time], before(1), before(2))
          end associate
        else
          associate (motion => model%conditions%rigid_motions(k - n_nodal))
            scale = scales(motion%direction, motion%node)
            before = [state%rigids(motion%node)%displacement(motion%direction), &
              state%rigids(motion%node)%velocity(motion%direction)]
            path = follow_curve(model, motion, [state%time, time], before(1), before(2))
          end associate
        end if
      end associate
      prescribed%increment(i) = scale*path(1)
      prescribed%velocity(i) = path(2)
      prescribed%acceleration(i) = path(3)
      prescribed%mean(i) = (path(2) - before(2))/(time - state%time)
    end do
  end subroutine prescribe_step

  !> Velocity and acceleration of prescribed motions at time zero. (Velocity curves have set their
  !> velocity before.)
  pure subroutine prescribe_start(model, dt, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: dt !! first step
    type(state_t), intent(inout) :: state
    integer :: i

    do i = 1, size(model%conditions%motions)
      associate (motion => model%conditions%motions(i))
        call start_path(motion, state%motion(2 + motion%direction, motion%node), &
          state%acceleration(motion%direction, motion%node))
      end associate
    end do
    do i = 1, size(model%conditions%rigid_motions)
      associate (motion => model%conditions%rigid_motions(i))
        call start_path(motion, state%rigids(motion%node)%velocity(motion%direction), &
          state%rigids(motion%node)%acceleration(motion%direction))
      end associate
    end do

  contains

    !> Velocity and acceleration of one motion.
    pure subroutine start_path(motion, velocity, acceleration)
      type(prescribed_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: velocity, acceleration
      real(wp) :: slope

      if (.not. is_active(motion, 0.0_wp)) return
      associate (curve => model%curves(motion%curve))
        slope = motion%scale*mean_slope(curve, 0.0_wp, dt, [0.0_wp, motion%death])
        select case (motion%kind)
        case (motion_velocity)
          acceleration = slope
        case (motion_acceleration)
          acceleration = motion%scale*curve_value(curve, 0.0_wp)
        case (motion_displacement)
          velocity = slope
        end select
      end associate
    end subroutine start_path

  end subroutine prescribe_start

  !> Displacement over the step, velocity and acceleration at its end. Velocity and acceleration
  !> curves are integrated exactly; derivatives are central differences over a step.
  pure function follow_curve(model, motion, times, displacement, velocity) result(path)
    type(model_t), intent(in) :: model
    type(prescribed_motion_t), intent(in) :: motion
    real(wp), intent(in) :: times(2)               !! start and end of the step
    real(wp), intent(in) :: displacement, velocity !! at the start of the step
    real(wp) :: path(3)
    real(wp) :: dt, active_times(2)

    dt = times(2) - times(1)
    active_times = [max(motion%birth, 0.0_wp), min(motion%death, model%controls%end_time)]
    path = 0.0_wp
    associate (curve => model%curves(motion%curve))
      select case (motion%kind)
      case (motion_velocity)
        path = [curve_integral(curve, times(1), times(2)), curve_value(curve, times(2)), &
          mean_slope(curve, times(2), dt, active_times)]
      case (motion_acceleration)
        path = [curve_moment(curve, times(1), times(2)), &
          curve_integral(curve, times(1), times(2)), curve_value(curve, times(2))]
      case (motion_displacement)
        path = [curve_value(curve, times(2)), mean_slope(curve, times(2), dt, active_times), 0.0_wp]
        ! Second difference; zero where one side lies outside the active time of the motion.
        if (times(2) - dt >= active_times(1) - same_time*dt .and. times(2) + dt <= active_times(2) &
          + same_time*dt) path(3) = ((curve_value(curve, times(2) + dt) - path(1)) &
          - (path(1) - curve_value(curve, times(2) - dt)))/dt**2
      end select
    end associate
    path = motion%scale*path
    if (motion%kind == motion_acceleration) path(1:2) = path(1:2) + [dt*velocity, velocity]
    if (motion%kind == motion_displacement) path(1) = path(1) - displacement
  end function follow_curve

  !> Slope at `time`: central difference over `dt`, or one-sided over the present segment where one
  !> side lies outside the active time. 0 for an active time close to zero.
  pure function mean_slope(curve, time, dt, active_times) result(slope)
    type(curve_t), intent(in) :: curve
    real(wp), intent(in) :: time
    real(wp), intent(in) :: dt
    real(wp), intent(in) :: active_times(2) !! first and last time that count
    real(wp) :: slope
    real(wp) :: x(2)
    logical :: is_past, is_future

    is_past = time - dt >= active_times(1) - same_time*dt
    is_future = time + dt <= active_times(2) + same_time*dt
    x = [time - dt, time + dt]
    if (.not. is_future) then
      x = [max(time - dt, active_times(1), maxval(curve%abscissa, mask=curve%abscissa < time &
        - same_time*dt)), time]
    else if (.not. is_past) then
      x = [time, min(time + dt, minval(curve%abscissa, mask=curve%abscissa > time + same_time*dt))]
    end if
    slope = 0.0_wp
    if (x(2) > x(1)) slope = (curve_value(curve, x(2)) - curve_value(curve, x(1)))/(x(2) - x(1))
  end function mean_slope

  !> Integral of (b - s) f(s) from a to b, the displacement from an acceleration. Exact by Simpson's
  !> rule from point to point, since the integrand is of second degree.
  pure function curve_moment(curve, a, b) result(total)
    type(curve_t), intent(in) :: curve
    real(wp), intent(in) :: a, b !! a <= b
    real(wp) :: total
    real(wp) :: x, next
    integer :: i

    total = 0.0_wp
    x = a
    do i = 1, size(curve%abscissa) + 1
      next = b
      if (i <= size(curve%abscissa)) next = min(curve%abscissa(i), b)
      if (next <= x) cycle
      total = total + (next - x)/6.0_wp*((b - x)*curve_value(curve, x) &
        + 4.0_wp*(b - 0.5_wp*(x + next))*curve_value(curve, 0.5_wp*(x + next)) &
        + (b - next)*curve_value(curve, next))
      x = next
    end do
  end function curve_moment

  !> Times at which a step must end: start and end of prescribed motions, where the equations
  !> change; with automatic steps also corners of curves in use, start and end of forces, and plot
  !> states.
  pure subroutine list_changes(model, changes)
    type(model_t), intent(in) :: model
    real(wp), allocatable, intent(out) :: changes(:)
    integer, allocatable :: used(:)
    integer :: i

    associate (conditions => model%conditions)
      changes = [conditions%motions%birth, conditions%motions%death, &
        conditions%rigid_motions%birth, conditions%rigid_motions%death]
      if (.not. model%controls%implicit%is_automatic) return
      changes = [changes, conditions%pressures%arrival, model%contacts%birth, &
        model%contacts%death]
      ! Plot states at intervals not below the first step.
      associate (controls => model%controls, interval => model%controls%output%plot%dt)
        if (controls%output%plot%curve == 0 .and. interval >= controls%implicit%dt &
          .and. controls%end_time < most_plots*interval) &
          changes = [changes, [(i*interval, i=1, int(controls%end_time/interval))]]
      end associate
      used = [conditions%motions%curve, conditions%rigid_motions%curve, &
        conditions%nodal_loads%curve, conditions%body_loads%curve]
      if (allocated(conditions%rigid_loads)) used = [used, conditions%rigid_loads%curve]
      if (allocated(conditions%damping)) used = [used, conditions%damping%curve]
      if (allocated(conditions%part_damping)) used = [used, conditions%part_damping%curve]
      do i = 1, size(model%curves)
        if (any(used == i)) changes = [changes, turning_points(model%curves(i))]
      end do
      ! Curves of pressures start at their arrival; one entry for equal consecutive loads.
      do i = 1, size(conditions%pressures)
        associate (load => conditions%pressures(i), before => conditions%pressures(max(1, i - 1)))
          if (i > 1 .and. load%curve == before%curve .and. abs(load%arrival - before%arrival) &
            <= 0.0_wp) cycle
          changes = [changes, load%arrival + turning_points(model%curves(load%curve))]
        end associate
      end do
    end associate
  end subroutine list_changes

  !> Corners of a curve: where its slope changes sign, or by more than half of the steeper side.
  !> (Points of a finely sampled smooth curve are none.)
  pure function turning_points(curve) result(times)
    type(curve_t), intent(in) :: curve
    real(wp), allocatable :: times(:)
    real(wp) :: slope(0:size(curve%abscissa)) !! before and after each point
    integer :: n

    n = size(curve%abscissa)
    slope = 0.0_wp
    slope(1:n - 1) = (curve%ordinate(2:) - curve%ordinate(:n - 1))/(curve%abscissa(2:) &
      - curve%abscissa(:n - 1))
    times = pack(curve%abscissa, abs(slope(1:n) - slope(0:n - 1)) &
      > corner*max(abs(slope(1:n)), abs(slope(0:n - 1))))
  end function turning_points

end module equations_m
