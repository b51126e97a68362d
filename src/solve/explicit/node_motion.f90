! SPDX-License-Identifier: MIT
!> Leap-frog motion of the nodes: v(n+1/2) = [(1 - D h/2) v(n-1/2) + h a]/(1 + D h/2), u(n+1) = u(n)
!> + dt v(n+1/2), with h the mean of the two steps. Damping acts on the mean of the two velocities
!> and never limits the step. With *DAMPING_PART_MASS the D of a node is the mean over the masses of
!> its elements; lumped masses have the global damping, nodes of a rigid body the damping of its
!> part. Rigid bodies: resultants, leap-frog of centre and angle, then their nodes
!> (doc/theory/rigid_bodies.md), by one thread in the order of the nodes.
module node_motion_m
  use conditions_m, only : motion_displacement
  use element_mass_m, only : element_shares
  use hanging_nodes_m, only : share_hanging_forces
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use loads_m, only : damping_rates, is_active, next_velocity, part_damping_rate
  use model_m, only : model_t
  use rigid_state_m, only : rotation_terms, rotation_shift, velocity_of, damping_of
  use snapshot_m, only : snapshot_t
  use state_m, only : state_t
  implicit none
  private
  public :: leap_t, make_leap, motion_factors, predict_velocity, move_tile_nodes, &
    move_special_nodes, &
    move_damped_nodes, update_damping, solve_rigids, move_rigids, fill_rigids

  !> Factors of one leap-frog step, common to all nodes.
  type :: leap_t
    real(wp) :: dt = 0.0_wp        !! t(n+1) - t(n)
    real(wp) :: mean = 0.0_wp      !! mean of the steps before and after
    real(wp) :: half(2) = 0.0_wp   !! factor of an acceleration in the velocity
    real(wp) :: keep(2) = 1.0_wp   !! factor of the old velocity
    real(wp) :: body(2) = 0.0_wp   !! acceleration of every free node
  end type leap_t

contains

  !> Set the factors from the steps before and after t(n), damping and body acceleration.
  pure function make_leap(dt_before, dt, damping, body) result(leap)
    real(wp), intent(in) :: dt_before, dt
    real(wp), intent(in) :: damping(2) !! D per direction
    real(wp), intent(in) :: body(2)    !! acceleration per direction
    type(leap_t) :: leap
    real(wp) :: mean

    mean = 0.5_wp*(dt_before + dt)
    leap%dt = dt
    leap%mean = mean
    leap%half = mean/(1.0_wp + 0.5_wp*damping*mean)
    leap%keep = (1.0_wp - 0.5_wp*damping*mean)/(1.0_wp + 0.5_wp*damping*mean)
    leap%body = body
  end function make_leap

  !> Factors of one node, with its own D where parts are damped.
  pure subroutine motion_factors(leap, state, node, half, keep)
    type(leap_t), intent(in) :: leap
    type(state_t), intent(in) :: state
    integer, intent(in) :: node
    real(wp), intent(out) :: half(2), keep(2)

    half = leap%half
    keep = leap%keep
    if (.not. allocated(state%node_damping)) return
    half = leap%mean/(1.0_wp + 0.5_wp*state%node_damping(:, node)*leap%mean)
    keep = (1.0_wp - 0.5_wp*state%node_damping(:, node)*leap%mean) &
      /(1.0_wp + 0.5_wp*state%node_damping(:, node)*leap%mean)
  end subroutine motion_factors

  !> v(n+1/2) of a special node by the forces known so far, and its mobility dv/df.
  subroutine predict_velocity(leap, state, node, mobility, velocity)
    type(leap_t), intent(in) :: leap
    type(state_t), intent(in) :: state
    integer, intent(in) :: node
    real(wp), intent(out) :: mobility(2), velocity(2)
    real(wp) :: half(2), keep(2)

    call motion_factors(leap, state, node, half, keep)
    mobility = half*state%inverse_mass(:, node)
    velocity = keep*state%motion(3:4, node) + half*merge(leap%body, 0.0_wp, &
      state%inverse_mass(:, node) > 0.0_wp) + mobility*(state%force_special(:, node) &
      - state%internal_force(:, node))
  end subroutine predict_velocity

  !> Move the nodes first .. last with nodal damping.
  subroutine move_damped_nodes(leap, n_special, first, last, force, state)
    type(leap_t), intent(in) :: leap
    integer, intent(in) :: n_special
    integer, intent(in) :: first, last
    real(wp), intent(in) :: force(2, first:*)        !! internal force of those nodes
    type(state_t), intent(inout) :: state
    real(wp) :: half(2), keep(2), push(2)
    integer :: i

    do i = first, last
      call motion_factors(leap, state, i, half, keep)
      push = -force(:, i)
      if (i <= n_special) push = state%force_special(:, i) + push
      state%motion(3:4, i) = keep*state%motion(3:4, i) + half*(merge(leap%body, 0.0_wp, &
        state%inverse_mass(:, i) > 0.0_wp) + push*state%inverse_mass(:, i))
      state%motion(1:2, i) = state%motion(1:2, i) + leap%dt*state%motion(3:4, i)
    end do
  end subroutine move_damped_nodes

  !> Move the interior nodes first .. last.
  subroutine move_tile_nodes(leap, first, last, force, inverse_mass, motion)
    type(leap_t), intent(in) :: leap
    integer, intent(in) :: first, last
    real(wp), intent(in) :: force(2, first:*)        !! internal force of those nodes
    real(wp), intent(in) :: inverse_mass(2, *)       !! of all nodes
    real(wp), intent(inout) :: motion(4, *)          !! of all nodes
    integer :: i, k

    if (all(leap%body == 0.0_wp .and. leap%keep == 1.0_wp)) then
      associate (mean => leap%half(1), dt => leap%dt)
        do i = first, last
          !$omp simd simdlen(2)
          do k = 1, 2
            motion(2 + k, i) = motion(2 + k, i) - mean*(force(k, i)*inverse_mass(k, i))
            motion(k, i) = motion(k, i) + dt*motion(2 + k, i)
          end do
        end do
      end associate
      return
    end if
    do i = first, last
      !$omp simd simdlen(2)
      do k = 1, 2
        motion(2 + k, i) = leap%keep(k)*motion(2 + k, i) + leap%half(k) &
          *(merge(leap%body(k), 0.0_wp, inverse_mass(k, i) > 0.0_wp) &
          - force(k, i)*inverse_mass(k, i))
        motion(k, i) = motion(k, i) + leap%dt*motion(2 + k, i)
      end do
    end do
  end subroutine move_tile_nodes

  !> Move the special nodes first .. last; their internal forces are in state%internal_force.
  subroutine move_special_nodes(leap, first, last, state)
    type(leap_t), intent(in) :: leap
    integer, intent(in) :: first, last
    type(state_t), intent(inout) :: state
    integer :: i, k

    associate (special => state%force_special, internal => state%internal_force, &
      inverse_mass => state%inverse_mass, motion => state%motion)
      do i = first, last
        !$omp simd simdlen(2)
        do k = 1, 2
          motion(2 + k, i) = leap%keep(k)*motion(2 + k, i) + leap%half(k) &
            *(merge(leap%body(k), 0.0_wp, inverse_mass(k, i) > 0.0_wp) &
            + (special(k, i) - internal(k, i))*inverse_mass(k, i))
          motion(k, i) = motion(k, i) + leap%dt*motion(2 + k, i)
        end do
      end do
    end associate
  end subroutine move_special_nodes

  !> Update the nodal damping if the rates of parts have changed, or if `rates` is not allocated.
  subroutine update_damping(model, rates, state)
    type(model_t), intent(in) :: model
    real(wp), allocatable, intent(inout) :: rates(:, :)  !! (2, n_part + 1) as from `damping_rates`
    type(state_t), intent(inout) :: state
    real(wp) :: now(2, size(model%parts) + 1), shares(4)
    integer :: i, k, slot

    now = damping_rates(model, state%time)
    if (allocated(rates)) then
      if (all(abs(now - rates) <= 0.0_wp)) return
    end if
    rates = now
    state%node_damping = 0.0_wp
    if (allocated(model%conditions%lumped_masses)) then
      do k = 1, size(model%conditions%lumped_masses)
        associate (lump => model%conditions%lumped_masses(k))
          state%node_damping(:, lump%node) = state%node_damping(:, lump%node) &
            + lump%mass*rates(:, size(rates, 2))
        end associate
      end do
    end if
    do slot = 1, model%layout%n_slot
      if (model%layout%slot_element(slot) == 0) cycle
      shares = element_shares(model, slot)
      if (allocated(state%elements%mass_ratio)) shares = state%elements%mass_ratio(slot)*shares
      do k = 1, 4
        associate (node => model%layout%slot_nodes(k, slot))
          state%node_damping(:, node) = state%node_damping(:, node) &
            + shares(k)*rates(:, slot_part(model%layout, slot))
        end associate
      end do
    end do
    call share_hanging_forces(model%mesh, state%node_damping)
    do k = 1, size(state%mass)
      if (state%mass(k) > 0.0_wp) state%node_damping(:, k) = state%node_damping(:, k)/state%mass(k)
    end do
    do i = 1, size(model%rigids)
      state%node_damping(1, model%rigids(i)%nodes) = rates(1, model%rigids(i)%part)
      state%node_damping(2, model%rigids(i)%nodes) = rates(2, model%rigids(i)%part)
    end do
  end subroutine update_damping

  !> Accelerations and v(n+1/2) of all rigid bodies from the forces on their nodes.
  subroutine solve_rigids(model, damping, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: damping(2)     !! D per direction
    type(state_t), intent(inout) :: state
    real(wp) :: mean, rate(3), free(3), total(3), force(2), turn(2), arm(2)
    integer :: i, k

    mean = 0.5_wp*(state%dt_before + state%dt)
    do i = 1, size(state%rigids)
      associate (body => model%rigids(i), rigid => state%rigids(i))
        ! Resultants; nodes without forces come after the special ones.
        total = 0.0_wp
        turn = rotation_terms(rigid%displacement(3))
        do k = 1, size(body%nodes)
          if (body%nodes(k) > model%layout%n_special) exit
          force = state%force_special(:, body%nodes(k)) - state%internal_force(:, body%nodes(k))
          arm = rigid%arms(:, k) + rotation_shift(turn, rigid%arms(:, k))
          total = total + [force, arm(1)*force(2) - arm(2)*force(1)]
        end do
        rigid%force = total + rigid%load
        rate = damping_of(rigid, rigid%displacement(3), damping + part_damping_rate(model, &
          body%part, state%time))
        free = rigid%force/rigid%inertia + [state%body_acceleration, 0.0_wp]
        rigid%acceleration = (free - rate*rigid%velocity)/(1.0_wp + 0.5_wp*rate*state%dt_before)
        rigid%next_velocity = ((1.0_wp - 0.5_wp*rate*mean)*rigid%velocity + mean*free) &
          /(1.0_wp + 0.5_wp*rate*mean)
        where (body%is_fixed)
          rigid%acceleration = 0.0_wp
          rigid%next_velocity = 0.0_wp
        end where
      end associate
    end do
    do i = 1, size(model%conditions%rigid_motions)
      associate (motion => model%conditions%rigid_motions(i))
        associate (rigid => state%rigids(motion%node), along => motion%direction)
          if (.not. is_active(motion, state%time)) cycle
          rigid%next_velocity(along) = next_velocity(model, motion, state%time, state%dt, &
            state%dt_before, rigid%displacement(along), rigid%velocity(along))
          ! On a displacement curve a body starts with the velocity of its first step, as nodes do.
          if (motion%kind == motion_displacement .and. .not. state%dt_before > 0.0_wp) &
            rigid%velocity(along) = rigid%next_velocity(along)
          rigid%acceleration(along) = (rigid%next_velocity(along) - rigid%velocity(along))/mean
        end associate
      end associate
    end do
  end subroutine solve_rigids

  !> Move all rigid bodies to u(n+1), and those of their nodes that the next cycle needs. The
  !> velocity of a node is its displacement over the step, as for all nodes: work is force times
  !> displacement.
  subroutine move_rigids(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp) :: turn(2), half_rotation(2), speed(3)
    logical :: sums_all
    integer :: i, k

    ! Gravity and damping need the momentum of all nodes.
    sums_all = size(model%conditions%body_loads) > 0 .or. allocated(model%conditions%damping) &
      .or. allocated(model%conditions%part_damping)
    do i = 1, size(state%rigids)
      associate (nodes => model%rigids(i)%nodes, rigid => state%rigids(i), dt => state%dt)
        speed = rigid%next_velocity
        half_rotation = rotation_terms(rigid%displacement(3) + 0.5_wp*dt*speed(3))
        rigid%velocity = speed
        rigid%displacement = rigid%displacement + dt*speed
        turn = rotation_terms(rigid%displacement(3))
        ! The chord is a little shorter than the arc.
        speed(3) = 2.0_wp*sin(0.5_wp*dt*speed(3))/dt
        do k = 1, size(nodes)
          if (nodes(k) > model%layout%n_special .and. .not. sums_all) exit
          associate (arm => rigid%arms(:, k))
            state%motion(1:2, nodes(k)) = rigid%displacement(1:2) + rotation_shift(turn, arm)
            state%motion(3:4, nodes(k)) = velocity_of(speed, arm + rotation_shift(half_rotation, &
              arm))
          end associate
        end do
      end associate
    end do
  end subroutine move_rigids

  !> Motion of all nodes of rigid bodies at t(n).
  subroutine fill_rigids(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    real(wp) :: turn(2), velocity(3), arm(2)
    integer :: i, k, node

    do i = 1, size(state%rigids)
      associate (rigid => state%rigids(i))
        turn = rotation_terms(rigid%displacement(3))
        velocity = rigid%velocity + 0.5_wp*state%dt_before*rigid%acceleration
        do k = 1, size(model%rigids(i)%nodes)
          node = model%rigids(i)%nodes(k)
          snapshot%displacement(:, node) = rigid%displacement(1:2) + rotation_shift(turn, &
            rigid%arms(:, k))
          arm = rigid%arms(:, k) + rotation_shift(turn, rigid%arms(:, k))
          snapshot%velocity(:, node) = velocity_of(velocity, arm)
          snapshot%acceleration(:, node) = velocity_of(rigid%acceleration, arm) - velocity(3)**2*arm
        end do
      end associate
    end do
  end subroutine fill_rigids

end module node_motion_m
