! SPDX-License-Identifier: MIT
!> Ranges of nodes and element slots whose state other processes hold, and data that the first
!> process computes for all.
module remote_state_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use packed_buffer_m, only : memory_release_t, choose_slots
  use visitor_m, only : of_nodes
  implicit none
  private
  public :: remote_t, known_nodes, known_slots, remote_releases, inside_tests_t

  !> Remote nodes and slots in two ranges each: below and above those of this process.
  type :: remote_t
    integer :: nodes(4) = 0, slots(4) = 0 !! first and last node of the lower, then of the upper
                                          !! range; slots likewise
    real(wp), allocatable :: mass(:) !! (n_node) lumped masses of the nodes of this process, until
                                     !! they are moved into the state
    real(wp), allocatable :: penalties(:, :) !! (3, interfaces) penalties of slave, master and
                                             !! nodes, from the first process
  end type remote_t

  !> Results of the point-in-body tests of the first search, of all interfaces, in the order of the
  !> tests.
  type :: inside_tests_t
    logical :: are_given = .false. !! the results come from the first process
    integer :: n = 0                     !! tests so far
    logical, allocatable :: is_inside(:) !! (n or more) whether the point lies inside
  end type inside_tests_t

contains

  !> Ranges of nodes whose state this process holds: all nodes except the remote ones, (first and
  !> last; 3 ranges).
  pure function known_nodes(model, remote) result(ranges)
    type(model_t), intent(in) :: model
    type(remote_t), intent(in), optional :: remote
    integer :: ranges(2, 3)

    ranges = reshape([1, 0, 1, model%mesh%n_node, 1, 0], [2, 3])
    if (present(remote)) ranges = reshape([1, remote%nodes(1) - 1, remote%nodes(2) + 1, &
      remote%nodes(3) - 1, remote%nodes(4) + 1, model%mesh%n_node], [2, 3])
  end function known_nodes

  !> Ranges of element slots whose state this process holds: all slots except the remote ones,
  !> (first and last; 3 ranges).
  pure function known_slots(model, remote) result(ranges)
    type(model_t), intent(in) :: model
    type(remote_t), intent(in), optional :: remote
    integer :: ranges(2, 3)

    ranges = reshape([1, 0, 1, model%layout%n_slot, 1, 0], [2, 3])
    if (present(remote)) ranges = reshape([1, remote%slots(1) - 1, remote%slots(2) + 1, &
      remote%slots(3) - 1, remote%slots(4) + 1, model%layout%n_slot], [2, 3])
  end function known_slots

  !> Visitors that release the memory of remote nodes and slots: one for the range below, one for
  !> the range above.
  pure function remote_releases(remote) result(releases)
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
  end function remote_releases

end module remote_state_m
