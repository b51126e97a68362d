! SPDX-License-Identifier: MIT
!> Nodes and elements of other processes, whose state this one does not keep, and those whose state
!> it has.
module others_memory_m
  use block_state_m, only : block_state_t, stream_starts
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use pages_m, only : forget_reals
  use state_m, only : state_t
  implicit none
  private
  public :: others_t, known_nodes, known_slots, forget_nodes, forget_slots

  !> Two ranges of each: before and behind those of this process.
  type :: others_t
    integer :: nodes(4) = 0, slots(4) = 0
    real(wp), allocatable :: mass(:) !! (n_node) lumped masses, of nodes that this process knows,
                                     !! until the state takes them
    real(wp), allocatable :: penalties(:, :) !! (3, interfaces) of slave, master and nodes, that the
                                     !! first process has found
  end type others_t

contains

  !> Ranges of nodes whose state a process has: all, but for those of others.
  pure function known_nodes(model, others) result(ranges)
    type(model_t), intent(in) :: model
    type(others_t), intent(in), optional :: others
    integer :: ranges(2, 3)

    ranges = whole(model%mesh%n_node)
    if (present(others)) ranges = between(others%nodes, model%mesh%n_node)
  end function known_nodes

  !> The same of slots.
  pure function known_slots(model, others) result(ranges)
    type(model_t), intent(in) :: model
    type(others_t), intent(in), optional :: others
    integer :: ranges(2, 3)

    ranges = whole(model%layout%n_slot)
    if (present(others)) ranges = between(others%slots, model%layout%n_slot)
  end function known_slots

  !> One range of all items and two that are empty.
  pure function whole(n) result(ranges)
    integer, intent(in) :: n
    integer :: ranges(2, 3)

    ranges = reshape([1, n, 1, 0, 1, 0], [2, 3])
  end function whole

  !> What two ranges leave of n items.
  pure function between(items, n) result(ranges)
    integer, intent(in) :: items(4), n
    integer :: ranges(2, 3)

    ranges = reshape([1, items(1) - 1, items(2) + 1, items(3) - 1, items(4) + 1, n], [2, 3])
  end function between

  !> Interior nodes of others.
  subroutine forget_nodes(others, state)
    type(others_t), intent(in) :: others
    type(state_t), intent(inout) :: state

    call forget_reals(others%nodes, 4, state%motion)
    call forget_reals(others%nodes, 1, state%mass)
    call forget_reals(others%nodes, 2, state%inverse_mass)
    if (allocated(state%internal_force)) call forget_reals(others%nodes, 2, state%internal_force)
    if (allocated(state%former_velocity)) call forget_reals(others%nodes, 2, state%former_velocity)
  end subroutine forget_nodes

  !> What elements of others keep, slot by slot and in streams.
  subroutine forget_slots(others, elements)
    type(others_t), intent(in) :: others
    type(block_state_t), intent(inout) :: elements
    integer :: k

    do k = 1, size(elements%reference, 2)
      call forget_reals(others%slots, 1, elements%reference(:, k))
    end do
    do k = 1, size(elements%deviator, 2)
      call forget_reals(others%slots, 1, elements%deviator(:, k))
    end do
    if (allocated(elements%mass_ratio)) call forget_reals(others%slots, 1, elements%mass_ratio)
    if (allocated(elements%retardation)) call forget_reals(others%slots, 1, elements%retardation)
    if (allocated(elements%viscous_pressure)) &
      call forget_reals(others%slots, 1, elements%viscous_pressure)
    if (allocated(elements%damping_stress)) &
      call forget_reals(others%slots, 16, elements%damping_stress)
    call forget_stream(elements%point_start, elements%point_deviator)
    call forget_stream(elements%history_start, elements%history)
    call forget_stream(elements%eos_start, elements%eos_state)
    call forget_stream(elements%hourglass_start, elements%hourglass_strain)

  contains

    !> What only some chunks keep.
    subroutine forget_stream(starts, values)
      integer, intent(in) :: starts(:) !! of chunks, 0 where one has none
      real(wp), intent(inout), contiguous :: values(:)

      integer :: own(2)

      if (size(values) == 0) return
      own = stream_starts([others%slots(2), others%slots(3) - 1]/chunk_size + 1, starts, &
        size(values))
      call forget_reals([1, own(1) - 1, own(2), size(values)], 1, values)
    end subroutine forget_stream

  end subroutine forget_slots

end module others_memory_m
