! SPDX-License-Identifier: MIT
!> What acts from outside in an explicit cycle, and its work.
module cycle_loads_m
  use curves_m, only : curve_value
  use external_force_m, only : form_external_force, body_acceleration, damping_rate
  use kinds_m, only : wp
  use model_m, only : model_t
  use motion_sums_m, only : motion_sums_t
  use state_m, only : state_t
  implicit none
  private
  public :: apply_loads

contains

  !> Loads from outside and their work (trapezoidal rule), body acceleration and damping; the work
  !> of these two is counted once the sums over all nodes are there.
  subroutine apply_loads(model, state, damping, sums)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp), intent(inout) :: damping(2) !! D per direction: that before in, that of now out
    type(motion_sums_t), intent(inout) :: sums
    real(wp) :: half, body(2), former(2)

    half = 0.5_wp*state%dt_before
    if (allocated(state%external)) then
      state%external_work = state%external_work + half*power(state%external, state%motion)
      call form_external_force(model, state%motion, state%time, state%external)
      state%external_work = state%external_work + half*power(state%external, state%motion)
      state%force_special = state%external
    else
      call clear_forces(model, state)
    end if
    if (allocated(model%conditions%rigid_loads)) call apply_rigid_loads(model, half, state)
    if (size(model%conditions%body_loads) > 0) then
      body = body_acceleration(model%conditions, model%curves, state%time)
      sums%share(1:2) = half*(body + state%body_acceleration)
      state%body_acceleration = body
    end if
    if (allocated(model%conditions%damping)) then
      former = damping
      damping = damping_rate(model%conditions, model%curves, state%time)
      sums%share(3:4) = former ! the sums belong to the cycle before
    end if
    if (allocated(state%node_damping)) sums%share(3:4) = 1.0_wp ! they hold the rates
  end subroutine apply_loads

  !> Loads on rigid bodies and their work.
  subroutine apply_rigid_loads(model, half, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: half     !! of the step behind
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

  !> No force yet on the nodes of interfaces and walls. On the others there never is one: to write
  !> zeros there would only take them out of the caches of other threads.
  subroutine clear_forces(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    integer :: i

    do i = 1, size(state%contacts)
      call clear(state%contacts(i)%nodes)
    end do
    if (allocated(model%conditions%skew_supports)) then
      do i = 1, size(model%conditions%skew_supports)
        call clear([model%conditions%skew_supports(i)%node])
      end do
    end if
    if (.not. allocated(state%walls)) return
    do i = 1, size(model%walls)
      call clear(model%walls(i)%nodes)
    end do

  contains

    subroutine clear(nodes)
      integer, intent(in), contiguous :: nodes(:)
      integer :: k

      do k = 1, size(nodes)
        state%force_special(:, nodes(k)) = 0.0_wp
      end do
    end subroutine clear

  end subroutine clear_forces

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

end module cycle_loads_m
