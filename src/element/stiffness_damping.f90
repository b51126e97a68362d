! SPDX-License-Identifier: MIT
!> Damping in proportion to stiffness (*DAMPING_PART_STIFFNESS): the elastic law with the rate of
!> deformation in place of the strain, times a retardation time of each element, beside the stress
!> (doc/theory/elements.md, "Stiffness damping").
module stiffness_damping_m
  use block_state_m, only : block_state_t
  use element_steps_m, only : chunk_steps
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use model_m, only : model_t
  implicit none
  private
  public :: start_retardation

contains

  !> Retardation times at time zero: a share of critical damping of the fastest mode of the element,
  !> of omega = 2/step, is that share times the step.
  subroutine start_retardation(model, motion, elements)
    type(model_t), intent(in) :: model
    real(wp), intent(in), contiguous :: motion(:, :)  !! (4, n_node)
    type(block_state_t), intent(inout) :: elements
    real(wp), allocatable :: retardation(:)
    real(wp) :: steps(chunk_size)
    integer :: i_chunk, first

    allocate (retardation(model%layout%n_slot), source=0.0_wp)
    do i_chunk = 1, size(elements%time_limit)
      first = (i_chunk - 1)*chunk_size + 1
      associate (share => model%parts(model%layout%chunk_part(i_chunk))%stiffness_damping, &
        times => retardation(first:first + chunk_size - 1))
        if (share < 0.0_wp) times = -share
        if (.not. share > 0.0_wp) cycle
        call chunk_steps(model, elements, i_chunk, motion, 0.0_wp, steps)
        times = share*steps
        times(model%layout%chunk_elements(i_chunk) + 1:) = 0.0_wp
      end associate
    end do
    call move_alloc(retardation, elements%retardation)
    allocate (elements%damping_stress(16*model%layout%n_slot), source=0.0_wp)
    allocate (elements%damping_work(size(elements%time_limit)), source=0.0_wp)
  end subroutine start_retardation

end module stiffness_damping_m
