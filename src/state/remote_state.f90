! SPDX-License-Identifier: MIT
!> Nodes and elements of other processes, whose state this one does not keep, and those whose state
!> it has; and what only the first process can tell the others.
module remote_state_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use packed_buffer_m, only : memory_release_t, choose_slots
  use visitor_m, only : of_nodes
  implicit none
  private
  public :: remote_t, known_nodes, known_slots, remote_forgetters, inside_tests_t

  !> Two ranges of each: before and behind those of this process.
  type :: remote_t
    integer :: nodes(4) = 0, slots(4) = 0
    real(wp), allocatable :: mass(:) !! (n_node) lumped masses, of nodes that this process knows,
                                     !! until the state takes them
    real(wp), allocatable :: penalties(:, :) !! (3, interfaces) of slave, master and nodes, that the
                                     !! first process has found
  end type remote_t

  !> Those of all interfaces.
  type :: inside_tests_t
    logical :: are_given = .false.
    integer :: n = 0                     !! asked for so far
    logical, allocatable :: is_inside(:) !! with room for more where they are kept
  end type inside_tests_t

contains

  !> Ranges of nodes whose state a process has: all, but for those of others.
  pure function known_nodes(model, remote) result(ranges)
    type(model_t), intent(in) :: model
    type(remote_t), intent(in), optional :: remote
    integer :: ranges(2, 3)

    ranges = reshape([1, 0, 1, model%mesh%n_node, 1, 0], [2, 3])
    if (present(remote)) ranges = reshape([1, remote%nodes(1) - 1, remote%nodes(2) + 1, &
      remote%nodes(3) - 1, remote%nodes(4) + 1, model%mesh%n_node], [2, 3])
  end function known_nodes

  !> The same of slots.
  pure function known_slots(model, remote) result(ranges)
    type(model_t), intent(in) :: model
    type(remote_t), intent(in), optional :: remote
    integer :: ranges(2, 3)

    ranges = reshape([1, 0, 1, model%layout%n_slot, 1, 0], [2, 3])
    if (present(remote)) ranges = reshape([1, remote%slots(1) - 1, remote%slots(2) + 1, &
      remote%slots(3) - 1, remote%slots(4) + 1, model%layout%n_slot], [2, 3])
  end function known_slots

  !> Who gives up the memory of others' nodes and slots: before and behind those of this process.
  pure function remote_forgetters(remote) result(releases)
    type(remote_t), intent(in) :: remote
    type(memory_release_t) :: releases(2)
    integer :: k

    ! Results of functions do not get their default values from gfortran 12.
    releases = memory_release_t()
    do k = 1, 2
      releases(k)%ranges(:, of_nodes) = remote%nodes(2*k - 1:2*k)
      call choose_slots(releases(k), (remote%slots(2*k - 1:2*k) + [chunk_size - 1, 0]) &
        /chunk_size, chunk_size, .true., .false.)
    end do
  end function remote_forgetters

end module remote_state_m
