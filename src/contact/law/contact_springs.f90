! SPDX-License-Identifier: MIT
!> Energy of the springs of an interface, of those whose points are on the list.
module contact_springs_m
  use tie_handover_m, only : is_held_by_tie
  use contact_law_m, only : find_gaps, spring_t, n_springs, spring_at
  use contact_state_m, only : contact_state_t
  use law_state_m, only : contact_monitor_t
  use kinds_m, only : wp
  use ties_m, only : tie_energy
  implicit none
  private
  public :: begin_sampling, measure_springs, end_sampling

contains

  !> Before the points are generated: springs are looked at when that is due, and in the first call
  !> with contact.
  pure subroutine begin_sampling(had_force, monitor)
    logical, intent(in) :: had_force !! the call before had
    type(contact_monitor_t), intent(inout) :: monitor

    monitor%is_due = monitor%is_due .or. .not. had_force
  end subroutine begin_sampling

  !> What all springs on the list store, without what damping adds to their pressure, and where the
  !> largest force is. What broken ties held counts as theirs.
  pure subroutine measure_springs(memory)
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: gaps(max(memory%points%n, memory%n_slave))
    type(spring_t) :: spring
    integer :: i

    memory%monitor%stored = 0.0_wp
    memory%monitor%load = 0.0_wp
    if (memory%has%ties) then
      call tie_energy(memory, memory%monitor%stored, memory%monitor%load, memory%monitor%node)
      memory%monitor%stored = memory%monitor%stored + memory%ties%spent
      return
    end if
    call find_gaps(memory, gaps)
    associate (monitor => memory%monitor)
      do i = 1, n_springs(memory)
        spring = spring_at(memory, gaps(i), i)
        if (is_held_by_tie(memory, spring%site)) cycle
        monitor%stored = monitor%stored + spring%energy
        if (.not. spring%load > monitor%load) cycle
        monitor%load = spring%load
        monitor%node = memory%nodes(spring%node)
      end do
    end associate
  end subroutine measure_springs

  !> After the forces are known: whether there has been a look. Contact that has opened stores
  !> nothing.
  pure subroutine end_sampling(had_force, has_force, monitor)
    logical, intent(in) :: had_force, has_force !! the call before, and this one
    type(contact_monitor_t), intent(inout) :: monitor

    monitor%has_sampled = (has_force .and. monitor%is_due) .or. (had_force .and. .not. has_force)
    if (.not. has_force) monitor%stored = 0.0_wp
    monitor%is_due = .false.
  end subroutine end_sampling

end module contact_springs_m
