! SPDX-License-Identifier: MIT
!> Energy of the springs of an interface, of those whose points are on the list.
module contact_springs_m
  use behind_ties_m, only : is_left_to_tie
  use contact_law_m, only : find_gaps, density_of
  use contact_state_m, only : contact_state_t, place_at
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
    integer :: i

    memory%watch%stored = 0.0_wp
    memory%watch%load = 0.0_wp
    if (memory%has%ties) then
      call tie_energy(memory, memory%watch%stored, memory%watch%load, memory%watch%node)
      memory%watch%stored = memory%watch%stored + memory%ties%spent
      return
    end if
    call find_gaps(memory, gaps)
    associate (watch => memory%watch, points => memory%points, nodal => memory%scratch%nodal)
      if (memory%has%nodal_pressure) then
        do i = 1, memory%n_slave
          if (is_left_to_tie(memory, i)) cycle
          call add_spring(nodal(2, i)*density_of(memory%contact_law, memory%slave_penalty, &
            gaps(i)), nodal(2, i)*memory%node_pressure(i), memory%nodes(i), watch)
        end do
      else
        do i = 1, points%n
          if (is_left_to_tie(memory, place_at(memory, i))) cycle
          call add_spring(points%area(i)*density_of(memory%contact_law, points%stiffness(i), &
            gaps(i)), points%area(i)*points%pressure(i), &
            memory%nodes(points%slave_nodes(maxloc(points%slave_weights(:, i), 1), i)), watch)
        end do
      end if
    end associate
  end subroutine measure_springs

  !> One spring.
  pure subroutine add_spring(energy, load, node, watch)
    real(wp), intent(in) :: energy !! J/m
    real(wp), intent(in) :: load   !! N/m
    integer, intent(in) :: node    !! at it, by place in the mesh
    type(contact_watch_t), intent(inout) :: watch

    watch%stored = watch%stored + energy
    if (.not. load > watch%load) return
    watch%load = load
    watch%node = node
  end subroutine add_spring

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
