! SPDX-License-Identifier: MIT
!> Energy of the springs of an interface, of those whose points are on the list.
module contact_springs_m
  use behind_ties_m, only : is_left_to_tie
  use contact_law_m, only : find_gaps, spring_t, n_springs, spring_at
  use contact_state_m, only : contact_state_t
  use law_state_m, only : contact_watch_t
  use kinds_m, only : wp
  use ties_m, only : tie_energy
  implicit none
  private
  public :: begin_look, measure_springs, end_look

contains

  !> Before the points are placed: springs are looked at when that is due, and in the first call
  !> with contact.
  pure subroutine begin_look(had_force, watch)
    logical, intent(in) :: had_force !! the call before had
    type(contact_watch_t), intent(inout) :: watch

    watch%is_due = watch%is_due .or. .not. had_force
  end subroutine begin_look

  !> What all springs on the list store, without what damping adds to their pressure, and where the
  !> largest force is. What broken ties held counts as theirs.
  pure subroutine measure_springs(memory)
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: gaps(max(memory%points%n, memory%n_slave))
    type(spring_t) :: spring
    integer :: i

    memory%watch%stored = 0.0_wp
    memory%watch%load = 0.0_wp
    if (memory%has%ties) then
      call tie_energy(memory, memory%watch%stored, memory%watch%load, memory%watch%node)
      memory%watch%stored = memory%watch%stored + memory%ties%spent
      return
    end if
    call find_gaps(memory, gaps)
    associate (watch => memory%watch)
      do i = 1, n_springs(memory)
        spring = spring_at(memory, gaps(i), i)
        if (is_left_to_tie(memory, spring%place)) cycle
        watch%stored = watch%stored + spring%energy
        if (.not. spring%load > watch%load) cycle
        watch%load = spring%load
        watch%node = memory%nodes(spring%node)
      end do
    end associate
  end subroutine measure_springs

  !> After the forces are known: whether there has been a look. Contact that has opened stores
  !> nothing.
  pure subroutine end_look(had_force, has_force, watch)
    logical, intent(in) :: had_force, has_force !! the call before, and this one
    type(contact_watch_t), intent(inout) :: watch

    watch%has_looked = (has_force .and. watch%is_due) .or. (had_force .and. .not. has_force)
    if (.not. has_force) watch%stored = 0.0_wp
    watch%is_due = .false.
  end subroutine end_look

end module contact_springs_m
