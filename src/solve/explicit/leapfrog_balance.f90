! SPDX-License-Identifier: MIT
!> What the energies of an explicit run lack at an instant so that their sum is what leap-frog
!> keeps: v(n-1/2).M v(n+1/2)/2 + U with equal steps (doc/theory/time_integration.md). Formed only
!> when something is written, by one thread.
module leapfrog_balance_m
  use common_motion_m, only : common_drive, common_velocity
  use constraints_m, only : is_active
  use kinds_m, only : wp
  use model_m, only : model_t
  use snapshot_m, only : snapshot_t
  use snapshot_filling_m, only : find_motion, damping_at
  use state_m, only : state_t
  use walls_m, only : wall_tangent
  implicit none
  private
  public :: complete_balance

contains

  !> Complete the energies of the snapshot, which must be filled: the leap-frog part of the kinetic
  !> energy, from m a^2 of all degrees of freedom, and what the damping of this instant takes over
  !> the half step behind.
  subroutine complete_balance(model, state, damping, velocity_next, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2)       !! D per direction
    real(wp), intent(in) :: velocity_next(:) !! (n_motion) v(n+1/2) of prescribed motions
    type(snapshot_t), intent(inout) :: snapshot
    real(wp) :: dt, mean, inertia, led, work, velocity(2), acceleration(2)
    integer :: i

    ! Time zero has no step behind: that of equal steps stands for it.
    dt = merge(state%dt_before, state%dt, state%dt_before > 0.0_wp)
    mean = 0.5_wp*(state%dt + state%dt_before)
    led = 0.0_wp
    do i = 1, size(velocity_next)
      associate (prescribed => model%conditions%motions(i))
        if (is_active(prescribed, state%time) .and. state%dt > 0.0_wp) led = led &
          + state%mass(prescribed%node)*((velocity_next(i) - state%prescribed_velocity(i))/mean)**2
      end associate
    end do
    inertia = free_inertia(model, state, damping) + led
    led = 0.0_wp
    do i = 1, size(state%rigids)
      associate (rigid => state%rigids(i))
        led = led + sum(rigid%inertia*((rigid%next_velocity - rigid%velocity)/mean)**2)
      end associate
    end do
    inertia = inertia + led
    if (allocated(model%conditions%common_motions)) &
      inertia = inertia + common_inertia(model, state, damping)
    if (allocated(state%walls) .and. .not. state%dt_before > 0.0_wp) &
      inertia = inertia - wall_power(model, state, damping)
    snapshot%energies%leapfrog = -0.125_wp*dt**2*inertia
    if (.not. allocated(state%former_velocity)) return
    ! Work that the damping forces D m v(n) take over the half step behind.
    work = 0.0_wp
    do i = 1, model%mesh%n_node
      if (allocated(snapshot%velocity)) then
        velocity = snapshot%velocity(:, i)
      else
        call find_motion(model%layout%n_special, state, damping, i, velocity, acceleration)
      end if
      work = work + state%mass(i)*sum(damping_at(state, damping, i)*velocity*state%motion(3:4, i))
    end do
    snapshot%energies%damping = snapshot%energies%damping + 0.5_wp*state%dt_before*work
  end subroutine complete_balance

  !> Sum of m a^2 over degrees of freedom that move freely, with a = (v(n+1/2) - v(n-1/2))/h.
  pure function free_inertia(model, state, damping) result(total)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2)
    real(wp) :: total
    real(wp) :: velocity(2), a(2), late(2)
    integer :: i, k

    total = 0.0_wp
    ! At time zero damping acts on the mean of v(0) and v(1/2).
    late = 1.0_wp
    if (.not. state%dt_before > 0.0_wp) late = 1.0_wp + 0.25_wp*damping*state%dt
    do i = 1, model%mesh%n_node
      if (allocated(state%node_damping) .and. .not. state%dt_before > 0.0_wp) late = 1.0_wp &
        + 0.25_wp*state%node_damping(:, i)*state%dt
      call find_motion(model%layout%n_special, state, damping, i, velocity, a)
      do k = 1, 2
        if (state%inverse_mass(k, i) > 0.0_wp) total = total + state%mass(i)*(a(k)/late(k))**2
      end do
    end do
  end function free_inertia

  !> The same over nodes that move alike.
  pure function common_inertia(model, state, damping) result(total)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2)
    real(wp) :: total
    real(wp) :: push, rate, a, before(2)
    integer :: i, k

    total = 0.0_wp
    do i = 1, size(model%conditions%common_motions)
      before = common_velocity(model, i, state)
      associate (common => model%conditions%common_motions(i))
        do k = 1, 2
          if (.not. common%along(k)) cycle
          call common_drive(model, i, k, state, damping, push, rate)
          a = (push - rate*before(k))/(1.0_wp &
            + 0.5_wp*rate*merge(state%dt_before, 0.5_wp*state%dt, state%dt_before > 0.0_wp))
          total = total + sum(state%mass(common%nodes))*a**2
        end do
      end associate
    end do
  end function common_inertia

  !> Sum of F.a of the forces of rigid walls: their work at time zero is that of the mean of v(0)
  !> and v(1/2), not that of v(1/2) as for all other forces.
  pure function wall_power(model, state, damping) result(total)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2)
    real(wp) :: total
    real(wp) :: velocity(2), a(2), push(2)
    integer :: i, k

    total = 0.0_wp
    do i = 1, size(state%walls)
      do k = 1, size(model%walls(i)%nodes)
        if (.not. state%walls(i)%force(k) > 0.0_wp) cycle
        call find_motion(model%layout%n_special, state, damping, model%walls(i)%nodes(k), &
          velocity, a)
        push = state%walls(i)%force(k)*model%walls(i)%normal
        if (size(state%walls(i)%friction) > 0) push = push + state%walls(i)%friction(k) &
          *wall_tangent(model%walls(i))
        total = total + dot_product(push, a/(1.0_wp + 0.25_wp*damping_at(state, damping, &
          model%walls(i)%nodes(k))*state%dt))
      end do
    end do
  end function wall_power

end module leapfrog_balance_m
