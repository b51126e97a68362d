! SPDX-License-Identifier: MIT
!> Nodes and elements of other processes, whose state this one does not keep, and those whose state
!> it has; and what only the first process can tell the others.
module others_memory_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use packed_buffer_m, only : forgetter_t, choose_slots
  use visitor_m, only : of_nodes
  implicit none
  private
  public :: others_t, known_nodes, known_slots, forgetters_of, answers_t

  !> Two ranges of each: before and behind those of this process.
  type :: others_t
    integer :: nodes(4) = 0, slots(4) = 0
    real(wp), allocatable :: mass(:) !! (n_node) lumped masses, of nodes that this process knows,
                                     !! until the state takes them
    real(wp), allocatable :: penalties(:, :) !! (3, interfaces) of slave, master and nodes, that the
                                     !! first process has found
  end type others_t

  !> Those of all interfaces.
  type :: answers_t
    logical :: are_given = .false.
    integer :: n = 0                     !! asked for so far
    logical, allocatable :: is_inside(:) !! with room for more where they are kept
  end type answers_t

contains

  !> Ranges of nodes whose state a process has: all, but for those of others.
  pure function known_nodes(model, others) result(ranges)
    type(model_t), intent(in) :: model
    type(others_t), intent(in), optional :: others
    integer :: ranges(2, 3)

    ranges = reshape([1, 0, 1, model%mesh%n_node, 1, 0], [2, 3])
    if (present(others)) ranges = reshape([1, others%nodes(1) - 1, others%nodes(2) + 1, &
      others%nodes(3) - 1, others%nodes(4) + 1, model%mesh%n_node], [2, 3])
  end function known_nodes

  !> The same of slots.
  pure function known_slots(model, others) result(ranges)
    type(model_t), intent(in) :: model
    type(others_t), intent(in), optional :: others
    integer :: ranges(2, 3)

    ranges = reshape([1, 0, 1, model%layout%n_slot, 1, 0], [2, 3])
    if (present(others)) ranges = reshape([1, others%slots(1) - 1, others%slots(2) + 1, &
      others%slots(3) - 1, others%slots(4) + 1, model%layout%n_slot], [2, 3])
  end function known_slots

  !> Who gives up the memory of others' nodes and slots: before and behind those of this process.
  pure function forgetters_of(others) result(forgetters)
    type(others_t), intent(in) :: others
    type(forgetter_t) :: forgetters(2)
    integer :: k

    ! Results of functions do not get their default values from gfortran 12.
    forgetters = forgetter_t()
    do k = 1, 2
      forgetters(k)%ranges(:, of_nodes) = others%nodes(2*k - 1:2*k)
      call choose_slots(forgetters(k), (others%slots(2*k - 1:2*k) + [chunk_size - 1, 0]) &
        /chunk_size, chunk_size, .true., .false.)
    end do
  end function forgetters_of

end module others_memory_m
