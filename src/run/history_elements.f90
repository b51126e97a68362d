! SPDX-License-Identifier: MIT
!> Elements of the histories (elout).
module history_elements_m
  use controls_m, only : is_asked
  use element_state_m, only : stress_of_slot, plastic_strain_of_slot, is_gone
  use history_tables_m, only : table_elout
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use model_m, only : model_t
  use snapshot_m, only : snapshot_t
  use state_m, only : state_t
  implicit none
  private
  public :: find_history_elements, fill_history_elements

contains

  !> Room for the elements of *DATABASE_HISTORY_SHELL, where the deck asks for elout, and their
  !> parts.
  subroutine find_history_elements(model, snapshot)
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(inout) :: snapshot
    integer :: i

    if (.not. is_asked(model%controls%output%histories(table_elout))) return
    associate (chosen => model%controls%output%history_elements)
      allocate (snapshot%history_elements(size(chosen)))
      do i = 1, size(chosen)
        snapshot%history_elements(i)%part = &
          model%parts(slot_part(model%layout, model%layout%element_slot(chosen(i))))%id
      end do
    end associate
  end subroutine find_history_elements

  !> Their stresses and plastic strains.
  subroutine fill_history_elements(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    integer :: i

    if (.not. allocated(snapshot%history_elements)) return
    do i = 1, size(snapshot%history_elements)
      associate (slot => model%layout%element_slot(model%controls%output%history_elements(i)), &
        element => snapshot%history_elements(i))
        element%is_gone = is_gone(state%elements, slot)
        element%stress = 0.0_wp
        if (.not. element%is_gone) element%stress = stress_of_slot(model, state%motion, &
          state%elements, slot)
        element%plastic_strain = plastic_strain_of_slot(model, state%elements, slot)
      end associate
    end do
  end subroutine fill_history_elements

end module history_elements_m
