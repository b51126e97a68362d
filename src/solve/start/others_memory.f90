! SPDX-License-Identifier: MIT
!> Nodes and elements of other processes, whose state this one does not keep.
module others_memory_m
  use block_state_m, only : block_state_t
  use pages_m, only : forget_reals
  use state_m, only : state_t
  implicit none
  private
  public :: others_t, forget_nodes, forget_slots

  !> Two ranges of each: before and behind those of this process.
  type :: others_t
    integer :: nodes(4) = 0, slots(4) = 0
  end type others_t

contains

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

  !> What elements of others keep slot by slot.
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
    if (allocated(elements%damping_stress)) &
      call forget_reals(others%slots, 16, elements%damping_stress)
  end subroutine forget_slots

end module others_memory_m
