! SPDX-License-Identifier: MIT
!> Rigid bodies in implicit penalties (PUNIT 4; doc/theory/contact.md, section 6.6): how their nodes
!> would move in the step ahead, and how a force at one moves all others.
module rigid_pressing_m
  use constraints_m, only : is_active
  use kinds_m, only : wp
  use model_m, only : model_t
  use pressing_m, only : pressing_t
  use rigid_state_m, only : turn_of, shift_by_turn, velocity_of
  use state_m, only : state_t
  implicit none
  private
  public :: list_riders, ride

contains

  !> Which nodes of an interface belong to which body.
  subroutine list_riders(model, local, n_own, step)
    type(model_t), intent(in) :: model
    integer, intent(in) :: local(:) !! (n_node) number in the interface, 0: not of it
    integer, intent(in) :: n_own    !! nodes of the interface
    type(pressing_t), intent(inout) :: step
    integer :: riders(3, n_own), i, k, n

    n = 0
    do i = 1, size(model%rigids)
      associate (body => model%rigids(i)%nodes)
        do k = 1, size(body)
          if (local(body(k)) == 0) cycle
          n = n + 1
          riders(:, n) = [i, k, local(body(k))]
        end do
      end associate
    end do
    allocate (step%riders(3, n), step%modes(2, n_own, 3*count_bodies(riders(1, :n))))
    step%riders(:, :) = riders(:, :n)
  end subroutine list_riders

  !> How many bodies there are on a list that rises.
  pure integer function count_bodies(bodies)
    integer, intent(in) :: bodies(:)
    integer :: i

    count_bodies = 0
    do i = 1, size(bodies)
      if (i == 1) then
        count_bodies = 1
      else if (bodies(i) /= bodies(i - 1)) then
        count_bodies = count_bodies + 1
      end if
    end do
  end function count_bodies

  !> Velocities of the nodes of bodies whose v(n+1/2) without the interface is known, and the modes
  !> by which these are free to move, times the root of what a unit force along them makes.
  subroutine ride(model, half, state, step)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: half(:, :)       !! (3, n_body) what an acceleration counts, s
    type(state_t), intent(in) :: state
    type(pressing_t), intent(inout) :: step
    real(wp) :: speed(3), arm(2), unit(3), root
    logical :: is_free(3)
    integer :: i, k, body

    step%n_mode = 0
    body = 0
    do i = 1, size(step%riders, 2)
      if (step%riders(1, i) /= body) then
        if (body > 0) step%n_mode = step%n_mode + count(is_free)
        body = step%riders(1, i)
        is_free = are_free(model, body, state%time)
        do k = 1, count(is_free)
          step%modes(:, :, step%n_mode + k) = 0.0_wp
        end do
      end if
      associate (rigid => state%rigids(body), node => step%riders(3, i))
        speed = rigid%next_velocity
        arm = rigid%arms(:, step%riders(2, i))
        arm = arm + shift_by_turn(turn_of(rigid%place(3) + 0.5_wp*step%dt*speed(3)), arm)
        speed(3) = 2.0_wp*sin(0.5_wp*step%dt*speed(3))/step%dt
        step%velocity(:, node) = velocity_of(speed, arm)
        do k = 1, 3
          if (.not. is_free(k)) cycle
          unit = 0.0_wp
          unit(k) = 1.0_wp
          root = sqrt(half(k, body)/rigid%inertia(k))
          step%modes(:, node, step%n_mode + count(is_free(:k))) = root*velocity_of(unit, arm)
        end do
      end associate
    end do
    if (body > 0) step%n_mode = step%n_mode + count(is_free)
  end subroutine ride

  !> Which of x, y and the turn of a body are neither held nor led.
  pure function are_free(model, body, time) result(is_free)
    type(model_t), intent(in) :: model
    integer, intent(in) :: body
    real(wp), intent(in) :: time !! s
    logical :: is_free(3)
    integer :: i

    is_free = .not. model%rigids(body)%is_fixed
    do i = 1, size(model%conditions%rigid_motions)
      associate (motion => model%conditions%rigid_motions(i))
        if (motion%node == body .and. is_active(motion, time)) is_free(motion%direction) = .false.
      end associate
    end do
  end function are_free

end module rigid_pressing_m
