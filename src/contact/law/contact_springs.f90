! SPDX-License-Identifier: MIT
!> Energy of the springs of an interface, of those whose points are on the list.
module contact_springs_m
  use contact_law_m, only : find_gaps, spring_t, n_springs, spring_at
  use contact_state_m, only : contact_state_t
  use law_state_m, only : contact_monitor_t
  use kinds_m, only : wp
  use tiebreak_m, only : is_tied_site
  use ties_m, only : tie_energy
  implicit none
  private
  public :: begin_sampling, measure_springs, end_sampling, take_over_energy

contains

  !> Before the points are generated: springs are looked at when that is due, and in the first call
  !> with contact.
  pure subroutine begin_sampling(had_force, monitor)
    logical, intent(in) :: had_force !! the call before had
    type(contact_monitor_t), intent(inout) :: monitor

    monitor%is_due = monitor%is_due .or. .not. had_force
  end subroutine begin_sampling

  !> What all springs store, those of contact without what damping adds to their pressure, and where
  !> the largest force is. What broken ties held counts as theirs.
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
    end if
    if (memory%points%n == 0) return
    call find_gaps(memory, gaps)
    associate (monitor => memory%monitor)
      do i = 1, n_springs(memory)
        spring = spring_at(memory, gaps(i), i)
        if (memory%has%breaks) then
          if (is_tied_site(memory%ties%state(spring%site))) cycle
        end if
        monitor%stored = monitor%stored + spring%energy
        if (.not. spring%load > monitor%load) cycle
        monitor%load = spring%load
        monitor%node = memory%nodes(spring%node)
      end do
    end associate
  end subroutine measure_springs

  !> What springs of contact hold at sites that have just been freed while loaded: the ties have
  !> taken it in, and give it up. What they hold beyond that, of surfaces that lay within each other
  !> from the start, nobody has put in: it may be returned.
  pure subroutine take_over_energy(memory)
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: gaps(max(memory%points%n, memory%n_slave)), held, given
    type(spring_t) :: spring
    integer :: i

    held = 0.0_wp
    call find_gaps(memory, gaps)
    do i = 1, n_springs(memory)
      spring = spring_at(memory, gaps(i), i)
      if (memory%scratch%is_freed(spring%site)) held = held + spring%energy
    end do
    associate (ties => memory%ties, limit => memory%limit)
      given = min(held, max(0.0_wp, ties%spent))
      ties%spent = ties%spent - given
      ties%energy = ties%energy - given
      limit%admissible = limit%admissible + (held - given)
    end associate
  end subroutine take_over_energy

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
