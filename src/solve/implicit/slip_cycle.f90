! SPDX-License-Identifier: MIT
!> Whether Newton's method goes to and fro between the same states of stick and slip
!> (doc/theory/contact.md, section 9.8): an attempt that does finds no equilibrium, however many
!> iterations it may take.
module slip_cycle_m
  use contact_state_m, only : contact_state_t
  use law_state_m, only : slips
  use kinds_m, only : wp
  implicit none
  private
  public :: slip_cycle_t, watch_slips

  !> Part of the residual two iterations ago above which it has not fallen.
  real(wp), parameter :: fallen = 0.999_wp
  !> Iterations in a row that have to repeat what was two before.
  integer, parameter :: most_repeats = 3

  !> States of all places of friction and residuals, of the last two iterations.
  type :: slip_cycle_t
    integer, allocatable :: last(:), before(:)
    real(wp) :: residual_last = huge(1.0_wp), residual_before = huge(1.0_wp)
    integer :: n_repeat = 0      !! iterations in a row that repeated
    logical :: is_found = .false.
  end type slip_cycle_t

contains

  !> After an iteration. States that stay as they are make no cycle.
  pure subroutine watch_slips(contacts, residual, cycle)
    type(contact_state_t), intent(in) :: contacts(:)
    real(wp), intent(in) :: residual !! norm of the forces out of balance
    type(slip_cycle_t), intent(inout) :: cycle
    integer, allocatable :: states(:)
    logical :: repeats

    call gather_states(contacts, states)
    if (size(states) == 0) return
    repeats = .false.
    if (allocated(cycle%before)) then
      ! Runs of outlines that change have other places.
      if (size(states) == size(cycle%before) .and. size(states) == size(cycle%last)) &
        repeats = all(states == cycle%before) .and. any(states /= cycle%last) &
        .and. residual > fallen*cycle%residual_before
    end if
    cycle%n_repeat = merge(cycle%n_repeat + 1, 0, repeats)
    cycle%is_found = cycle%n_repeat >= most_repeats
    call move_alloc(cycle%last, cycle%before)
    call move_alloc(states, cycle%last)
    cycle%residual_before = cycle%residual_last
    cycle%residual_last = residual
  end subroutine watch_slips

  !> States of the places of all interfaces with friction; those that slip backwards are another.
  pure subroutine gather_states(contacts, states)
    type(contact_state_t), intent(in) :: contacts(:)
    integer, allocatable, intent(out) :: states(:)
    integer :: i, n, first

    n = 0
    do i = 1, size(contacts)
      if (allocated(contacts(i)%friction%state)) n = n + size(contacts(i)%friction%state)
    end do
    allocate (states(n))
    first = 1
    do i = 1, size(contacts)
      if (.not. allocated(contacts(i)%friction%state)) cycle
      associate (friction => contacts(i)%friction)
        n = size(friction%state)
        states(first:first + n - 1) = merge(-friction%state, friction%state, &
          friction%state == slips .and. friction%traction < 0.0_wp)
        first = first + n
      end associate
    end do
  end subroutine gather_states

end module slip_cycle_m
