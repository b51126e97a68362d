! SPDX-License-Identifier: MIT
!> Energy of the springs of an interface, of those whose points are on the list.
module contact_springs_m
  use contact_state_m, only : contact_points_t, contact_state_t
  use contact_watch_m, only : contact_watch_t
  use kinds_m, only : wp
  use nodal_average_m, only : average_gaps
  implicit none
  private
  public :: stored_energy, begin_look, add_springs, end_look

contains

  !> Energy of the springs of all points as pressed, J/m; holds for both rules of pressure.
  pure function stored_energy(points) result(energy)
    type(contact_points_t), intent(in) :: points
    real(wp) :: energy
    integer :: n

    n = points%n
    energy = -0.5_wp*sum(points%area(:n)*points%pressure(:n)*points%gap(:n))
  end function stored_energy

  !> Before the points are placed: springs are looked at when that is due, and in the first call
  !> with contact.
  pure subroutine begin_look(had_force, watch)
    logical, intent(in) :: had_force !! the call before had
    type(contact_watch_t), intent(inout) :: watch

    watch%is_due = watch%is_due .or. .not. had_force
    if (.not. watch%is_due) return
    watch%stored = 0.0_wp
    watch%load = 0.0_wp
  end subroutine begin_look

  !> Add the energy of the springs on the list, without what damping adds to their pressure, and
  !> note where the largest force is.
  pure subroutine add_springs(memory)
    type(contact_state_t), intent(inout) :: memory
    integer :: i

    associate (watch => memory%watch, points => memory%points)
      if (allocated(memory%node_pressure)) then
        call average_gaps(points, memory%n_slave, memory%scratch%nodal)
        do i = 1, memory%n_slave
          call add_spring(memory%slave_penalty*memory%scratch%nodal(2, i), &
            max(0.0_wp, -memory%scratch%nodal(1, i)), memory%nodes(i), watch)
        end do
      else
        do i = 1, points%n
          call add_spring(points%stiffness(i)*points%area(i), max(0.0_wp, -points%gap(i)), &
            memory%nodes(points%slave_nodes(maxloc(points%slave_weights(:, i), 1), i)), watch)
        end do
      end if
    end associate
  end subroutine add_springs

  !> One spring.
  pure subroutine add_spring(stiffness, depth, node, watch)
    real(wp), intent(in) :: stiffness !! N/m, of 1 m of thickness
    real(wp), intent(in) :: depth     !! m
    integer, intent(in) :: node       !! at it, by place in the mesh
    type(contact_watch_t), intent(inout) :: watch

    watch%stored = watch%stored + 0.5_wp*stiffness*depth**2
    if (.not. stiffness*depth > watch%load) return
    watch%load = stiffness*depth
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
