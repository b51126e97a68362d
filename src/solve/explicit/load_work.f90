! SPDX-License-Identifier: MIT
!> External actions of an explicit cycle and their work: loads, body loads, damping, prescribed
!> motion of nodes and rigid bodies. Forces on boundaries and of groups of nodes, and their work
!> (trapezoidal rule), for bndout and nodfor. The work of body loads and global damping needs sums
!> over all nodes; the team forms them tile by tile while a tile's nodes are in cache, before they
!> move. Damping acts on the mean of two half-step velocities, so its work is added one cycle later.
!> Partial sums are added in a fixed order, so that the bits do not depend on the number of threads.
module load_work_m
  use conditions_m, only : motion_displacement, motion_velocity, prescribed_motion_t
  use controls_m, only : boundary_load, boundary_body_load, boundary_pressure, group_nodes
  use curves_m, only : curve_value
  use history_filling_m, only : form_loads
  use kinds_m, only : wp
  use layout_m, only : layout_t
  use loads_m, only : form_external_force, body_acceleration, damping_rate, is_active, &
    next_velocity, part_damping_rate
  use model_m, only : model_t
  use rigid_state_m, only : damping_of
  use snapshot_filling_m, only : damping_at
  use state_m, only : state_t
  implicit none
  private
  public :: apply_loads, motion_sums_t, plan_sums, sum_motion, add_work_of_sums, &
    find_prescribed_velocities, impose_prescribed, add_motion_work, add_body_motion_work, &
    add_load_work, add_group_work

  !> Nodes in one partial sum outside of tiles.
  integer, parameter :: block_size = 512

  !> Partial sums of one cycle and their factors.
  type :: motion_sums_t
    integer, allocatable :: blocks(:, :) !! (2, blocks) first and last node
    integer :: n_special = 0             !! number of blocks of special nodes, the first ones
    integer :: first = 1, last = 0       !! blocks that this process sums
    integer, allocatable :: starts(:)    !! (processes + 1) first block of each process, with
                                         !! several processes
    real(wp), allocatable :: parts(:, :) !! (4, tiles, then blocks) m v_x, m v_y, and the values of
                                         !! `sum_drag`; allocated where the deck has body loads or
                                         !! damping
    real(wp) :: share(4) = 0.0_wp        !! factors of the sums: two of external work, two of
                                         !! damping work
  end type motion_sums_t

contains

  !> Apply loads with their work (trapezoidal rule), body acceleration and damping; the work of the
  !> latter two is added once the sums over all nodes are complete.
  subroutine apply_loads(model, state, damping, sums)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp), intent(inout) :: damping(2) !! D per direction: of the previous cycle in, of this one
                                          !! out
    type(motion_sums_t), intent(inout) :: sums
    real(wp) :: half, body(2)
    integer :: i

    half = 0.5_wp*state%dt_before
    if (allocated(state%external)) then
      state%external_work = state%external_work + half*power(state%external, state%motion)
      call form_external_force(model, state%motion, state%time, state%external)
      state%external_work = state%external_work + half*power(state%external, state%motion)
      state%force_special = state%external
    else
      ! Zero the forces at nodes of interfaces and walls. Other nodes never have one; writing there
      ! would only invalidate the caches of other threads.
      do i = 1, size(state%contacts)
        state%force_special(:, state%contacts(i)%nodes) = 0.0_wp
      end do
      if (allocated(model%conditions%skew_supports)) &
        state%force_special(:, model%conditions%skew_supports%node) = 0.0_wp
      if (allocated(state%walls)) then
        do i = 1, size(model%walls)
          state%force_special(:, model%walls(i)%nodes) = 0.0_wp
        end do
      end if
    end if
    if (allocated(model%conditions%rigid_loads)) call apply_rigid_loads(model, half, state)
    if (size(model%conditions%body_loads) > 0) then
      body = body_acceleration(model%conditions, model%curves, state%time)
      sums%share(1:2) = half*(body + state%body_acceleration)
      state%body_acceleration = body
    end if
    if (allocated(model%conditions%damping)) then
      sums%share(3:4) = damping ! the sums belong to the cycle before
      damping = damping_rate(model%conditions, model%curves, state%time)
    end if
    if (allocated(state%node_damping)) sums%share(3:4) = 1.0_wp ! they hold the rates
  end subroutine apply_loads

  !> Apply loads on rigid bodies with their work.
  subroutine apply_rigid_loads(model, half, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: half     !! half of the previous step, s
    type(state_t), intent(inout) :: state
    integer :: i

    do i = 1, size(state%rigids)
      associate (rigid => state%rigids(i))
        state%external_work = state%external_work + half*sum(rigid%load*rigid%velocity)
        rigid%load = 0.0_wp
      end associate
    end do
    do i = 1, size(model%conditions%rigid_loads)
      associate (load => model%conditions%rigid_loads(i))
        associate (force => state%rigids(load%node)%load(load%direction))
          force = force + load%scale*curve_value(model%curves(load%curve), state%time)
        end associate
      end associate
    end do
    do i = 1, size(state%rigids)
      associate (rigid => state%rigids(i))
        state%external_work = state%external_work + half*sum(rigid%load*rigid%velocity)
      end associate
    end do
  end subroutine apply_rigid_loads

  !> Power of forces on the first nodes.
  pure function power(force, motion)
    real(wp), intent(in), contiguous :: force(:, :)  !! (2, n)
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n or more)
    real(wp) :: power
    integer :: i

    power = 0.0_wp
    do i = 1, size(force, 2)
      power = power + (force(1, i)*motion(3, i) + force(2, i)*motion(4, i))
    end do
  end function power

  !> Set up the sums that a model needs: over its tiles and over blocks of the nodes outside tiles,
  !> special ones and those inside rigid bodies.
  pure subroutine plan_sums(model, sums)
    type(model_t), intent(in) :: model
    type(motion_sums_t), intent(out) :: sums
    integer :: n_tile, n_special, n_moved

    if (size(model%conditions%body_loads) == 0 .and. .not. allocated(model%conditions%damping) &
      .and. .not. allocated(model%conditions%part_damping)) return
    n_tile = size(model%layout%tiles)
    n_special = model%layout%n_special
    n_moved = n_special
    if (n_tile > 0) n_moved = model%layout%tiles(n_tile)%last_node
    associate (own => blocks_of(1, n_special), rest => blocks_of(n_moved + 1, model%mesh%n_node))
      sums%n_special = size(own, 2)
      sums%last = size(own, 2)
      sums%blocks = reshape([own, rest], [2, size(own, 2) + size(rest, 2)])
    end associate
    allocate (sums%parts(4, n_tile + size(sums%blocks, 2)), source=0.0_wp)
  end subroutine plan_sums

  !> Nodes first .. last in blocks.
  pure function blocks_of(first, last) result(blocks)
    integer, intent(in) :: first, last
    integer :: blocks(2, (last - first + block_size)/block_size) !! first and last node of each
    integer :: i

    blocks(1, :) = [(i, i=first, last, block_size)]
    blocks(2, :) = min(blocks(1, :) + block_size - 1, last)
  end function blocks_of

  !> Sums over the nodes first .. last; with damping the previous velocities are replaced by the
  !> present ones. With nodal damping the sums contain D.
  subroutine sum_motion(first, last, state, sums)
    integer, intent(in) :: first, last
    type(state_t), intent(inout) :: state
    real(wp), intent(out) :: sums(4) !! m v_x, m v_y, and the values of `sum_drag`
    real(wp) :: v(2)
    integer :: i

    sums(1:2) = sum_momentum(first, last, state%mass, state%motion)
    sums(3:4) = 0.0_wp
    if (allocated(state%previous_damping)) then
      do i = first, last
        v = state%motion(3:4, i)
        associate (previous => state%previous_velocity(:, i))
          sums(3:4) = sums(3:4) + 0.25_wp*state%mass(i)*state%previous_damping(:, i)*((previous + &
            v) *(state%previous_dt*previous + state%dt_before*v))
        end associate
        state%previous_velocity(:, i) = v
        state%previous_damping(:, i) = state%node_damping(:, i)
      end do
    else if (allocated(state%previous_velocity)) then
      call sum_drag(first, last, state%mass, state%motion, [state%previous_dt, state%dt_before], &
        state%previous_velocity, sums(3:4))
    end if
  end subroutine sum_motion

  !> Momentum of the nodes first .. last. Two partial sums, so that an addition need not wait for
  !> the previous one.
  pure function sum_momentum(first, last, mass, motion) result(sums)
    integer, intent(in) :: first, last
    real(wp), intent(in) :: mass(*)      !! of all nodes
    real(wp), intent(in) :: motion(4, *) !! of all nodes
    real(wp) :: sums(2)                  !! m v_x, m v_y
    real(wp) :: odd(2), even(2)
    integer :: i

    odd = 0.0_wp
    even = 0.0_wp
    do i = first, last - 1, 2
      odd = odd + mass(i)*motion(3:4, i)
      even = even + mass(i + 1)*motion(3:4, i + 1)
    end do
    if (i == last) odd = odd + mass(i)*motion(3:4, i)
    sums = odd + even
  end function sum_momentum

  !> Damping work with D = 1 in the previous cycle on the nodes first .. last: forces m w with the
  !> mean w of previous and present velocity act over half of either step.
  pure subroutine sum_drag(first, last, mass, motion, steps, previous, sums)
    integer, intent(in) :: first, last
    real(wp), intent(in) :: mass(*)         !! of all nodes
    real(wp), intent(in) :: motion(4, *)    !! of all nodes
    real(wp), intent(in) :: steps(2)        !! previous and present step, s
    real(wp), intent(inout) :: previous(2, *) !! velocities of the step before; then the present
                                              !! ones
    real(wp), intent(out) :: sums(2)        !! J/m over D, along x and y
    real(wp) :: v(2)
    integer :: i

    sums = 0.0_wp
    do i = first, last
      v = motion(3:4, i)
      sums = sums + 0.25_wp*mass(i)*((previous(:, i) + v)*(steps(1)*previous(:, i) + steps(2)*v))
      previous(:, i) = v
    end do
  end subroutine sum_drag

  !> Add the work since the last instant, once the sums are complete.
  pure subroutine add_work_of_sums(sums, external_work, damping_work)
    type(motion_sums_t), intent(in) :: sums
    real(wp), intent(inout) :: external_work, damping_work
    real(wp) :: work(4)

    if (.not. allocated(sums%parts)) return
    work = sums%share*sum(sums%parts, 2)
    external_work = external_work + (work(1) + work(2))
    damping_work = damping_work + (work(3) + work(4))
  end subroutine add_work_of_sums

  !> v(n+1/2) of all prescribed degrees of freedom, from u(n) and v(n-1/2). Nodes of one set follow
  !> one curve, looked up once: a look-up per node took 11 % of the sliding example. A node on a
  !> displacement curve starts with the velocity of its first step; a start from rest would add an
  !> impact of half its kinetic energy.
  subroutine find_prescribed_velocities(model, state, velocity)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp), intent(inout) :: velocity(:) !! (n_motion)
    integer :: i, before

    do i = 1, size(model%conditions%motions)
      before = max(1, i - 1)
      associate (prescribed => model%conditions%motions(i), &
        other => model%conditions%motions(before))
        if (i > before .and. prescribed%kind == motion_velocity .and. other%kind &
          == motion_velocity .and. prescribed%curve == other%curve &
          .and. abs(prescribed%scale - other%scale) <= 0.0_wp) then
          velocity(i) = velocity(before)
        else
          velocity(i) = next_velocity(model, prescribed, state%time, state%dt, state%dt_before, &
            state%motion(prescribed%direction, prescribed%node), state%prescribed_velocity(i))
        end if
      end associate
    end do
    if (state%dt_before > 0.0_wp) return
    do i = 1, size(model%conditions%motions)
      associate (prescribed => model%conditions%motions(i))
        if (prescribed%kind /= motion_displacement .or. .not. is_active(prescribed, state%time)) &
          cycle
        state%motion(2 + prescribed%direction, prescribed%node) = velocity(i)
        state%prescribed_velocity(i) = velocity(i)
        if (allocated(state%previous_velocity)) &
          state%previous_velocity(prescribed%direction, prescribed%node) = velocity(i)
      end associate
    end do
  end subroutine find_prescribed_velocities

  !> Reactions R = m a + f_int - f_special - m g + D m v(n) of prescribed nodal motions, and their
  !> work.
  subroutine add_motion_work(model, velocity, damping, due, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: velocity(:)    !! (n_motion) v(n+1/2)
    real(wp), intent(in) :: damping(2)     !! D per direction
    logical, intent(in) :: due(2)          !! the half steps before and after t(n)
    type(state_t), intent(inout) :: state
    real(wp) :: reactions(size(velocity)), d(2)
    integer :: i

    do i = 1, size(velocity)
      associate (node => model%conditions%motions(i)%node, &
        k => model%conditions%motions(i)%direction, next => velocity(i), &
        old => state%prescribed_velocity(i))
        d = damping_at(state, damping, node)
        reactions(i) = state%mass(node)*((next - old)/(0.5_wp*(state%dt + state%dt_before)) &
          - state%body_acceleration(k) + 0.5_wp*d(k)*(next + old)) &
          + state%internal_force(k, node) - state%force_special(k, node)
      end associate
    end do
    call add_reaction_work(model%conditions%motions, reactions, state%prescribed_velocity, &
      velocity, due, model%controls%output%boundaries%motion_rows, state)
  end subroutine add_motion_work

  !> Reactions of prescribed motions of rigid bodies, and their work.
  subroutine add_body_motion_work(model, damping, due, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: damping(2)     !! D per direction
    logical, intent(in) :: due(2)          !! the half steps before and after t(n)
    type(state_t), intent(inout) :: state
    real(wp), dimension(size(model%conditions%rigid_motions)) :: reactions, old, next
    real(wp) :: rate(3), body(3)
    integer :: i

    body = [state%body_acceleration, 0.0_wp]
    do i = 1, size(reactions)
      associate (rigid => state%rigids(model%conditions%rigid_motions(i)%node), &
        part => model%rigids(model%conditions%rigid_motions(i)%node)%part, &
        k => model%conditions%rigid_motions(i)%direction)
        old(i) = rigid%velocity(k)
        next(i) = rigid%next_velocity(k)
        rate = damping_of(rigid, rigid%displacement(3), damping + part_damping_rate(model, part, &
          state%time))
        reactions(i) = rigid%inertia(k)*((next(i) - old(i))/(0.5_wp*(state%dt + state%dt_before)) &
          - body(k) + 0.5_wp*rate(k)*(next(i) + old(i))) - rigid%force(k)
      end associate
    end do
    call add_reaction_work(model%conditions%rigid_motions, reactions, old, next, due, &
      model%controls%output%boundaries%body_motion_rows, state)
  end subroutine add_body_motion_work

  !> Add the work R.v dt/2 of reactions over half steps to the external work and to the rows of
  !> bndout.
  subroutine add_reaction_work(motions, reactions, old, next, due, rows, state)
    type(prescribed_motion_t), intent(in) :: motions(:)
    real(wp), intent(in) :: reactions(:), old(:), next(:) !! R, v(n-1/2), v(n+1/2)
    logical, intent(in) :: due(2)
    integer, allocatable, intent(in) :: rows(:)           !! row of each motion; not allocated
                                                          !! without bndout
    type(state_t), intent(inout) :: state
    real(wp) :: half_steps(2), work
    integer :: i

    half_steps = merge(0.5_wp*[state%dt_before, state%dt], 0.0_wp, due)
    work = 0.0_wp
    do i = 1, size(motions)
      if (is_active(motions(i), state%time)) &
        work = work + reactions(i)*(half_steps(1)*old(i) + half_steps(2)*next(i))
    end do
    state%external_work = state%external_work + work
    if (.not. allocated(state%boundary_work)) return
    ! The work of boundaries may begin at this instant.
    if (state%cycle == state%boundary_since) half_steps(1) = 0.0_wp
    do i = 1, size(motions)
      state%boundary_force(motions(i)%direction, rows(i)) = 0.0_wp
    end do
    do i = 1, size(motions)
      if (.not. is_active(motions(i), state%time)) cycle
      state%boundary_force(motions(i)%direction, rows(i)) = reactions(i)
      state%boundary_work(rows(i)) = state%boundary_work(rows(i)) + reactions(i) &
        *(half_steps(1)*old(i) + half_steps(2)*next(i))
    end do
  end subroutine add_reaction_work

  !> Impose prescribed motions on the nodes.
  subroutine impose_prescribed(model, velocity, displacement, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: velocity(:)     !! (n_motion) v(n+1/2)
    real(wp), intent(in) :: displacement(:) !! (n_motion) u(n), from before the nodes moved
    type(state_t), intent(inout) :: state
    integer :: i

    do i = 1, size(model%conditions%motions)
      associate (prescribed => model%conditions%motions(i))
        associate (node => prescribed%node, k => prescribed%direction)
          if (is_active(prescribed, state%time)) then
            state%motion(2 + k, node) = velocity(i)
            state%motion(k, node) = displacement(i) + state%dt*velocity(i)
          end if
          state%prescribed_velocity(i) = state%motion(2 + k, node)
        end associate
      end associate
    end do
  end subroutine impose_prescribed

  !> Add the work of loads in the rows of bndout at the beginning of a cycle, once the loads of the
  !> cycle are known.
  subroutine add_load_work(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp) :: previous(3, size(state%boundary_work)), velocity(3), half
    integer :: i

    half = merge(0.0_wp, 0.5_wp*state%dt_before, state%cycle == state%boundary_since)
    previous = state%boundary_force
    call form_loads(model, state%motion, state%time, state%boundary_force)
    associate (rows => model%controls%output%boundaries)
      do i = 1, size(rows%where)
        select case (rows%condition(i))
        case (boundary_load, boundary_pressure)
          velocity = [state%motion(3:4, rows%where(i)), 0.0_wp]
        case (boundary_body_load)
          state%boundary_force(:, i) = state%rigids(rows%where(i))%load
          velocity = state%rigids(rows%where(i))%velocity
        case default
          cycle
        end select
        state%boundary_work(i) = state%boundary_work(i) &
          + half*sum((previous(:, i) + state%boundary_force(:, i))*velocity)
      end do
    end associate
  end subroutine add_load_work

  !> Internal forces of node groups, and their work over the half steps before and after t(n), the
  !> latter once the nodes have moved.
  subroutine add_group_work(model, due, state)
    type(model_t), intent(in) :: model
    logical, intent(in) :: due(2)          !! the half steps before and after t(n)
    type(state_t), intent(inout) :: state

    associate (nodes => group_nodes(model%controls%output%force_groups))
      state%group_force = state%internal_force(:, nodes)
      if (due(1)) state%group_work = state%group_work + 0.5_wp*state%dt_before &
        *sum(state%group_force*state%group_velocity, 1)
      if (.not. due(2)) return
      state%group_velocity = state%motion(3:4, nodes)
      state%group_work = state%group_work + 0.5_wp*state%dt &
        *sum(state%group_force*state%group_velocity, 1)
    end associate
  end subroutine add_group_work

end module load_work_m
