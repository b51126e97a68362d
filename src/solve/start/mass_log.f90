! SPDX-License-Identifier: MIT
!> What is said of mass scaling: added mass in all and part by part, and the end of a run by ENDMAS.
module mass_log_m
  use block_state_m, only : block_state_t
  use errors_m, only : error_t, raise, status_run
  use kinds_m, only : wp
  use log_m, only : log_t, write_log, to_text
  use mass_scaling_m, only : added_masses
  use model_m, only : model_t
  implicit none
  private
  public :: log_added_mass, check_added_mass

contains

  !> Tell the added mass; an error where it is more than ENDMAS allows.
  subroutine log_added_mass(model, elements, log, error)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    type(log_t), intent(inout) :: log
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: added(size(model%parts)), own(size(model%parts))
    integer :: i

    call added_masses(model, elements, added, own)
    call write_log(log, 'mass scaling (DT2MS '//to_text(model%controls%mass_step) &
      //'): added mass '//share_text(sum(added), sum(own)))
    do i = 1, size(added)
      if (abs(added(i)) > 0.0_wp) call write_log(log, 'part '//to_text(model%parts(i)%id) &
        //': added mass '//share_text(added(i), own(i)))
    end do
    call check_added_mass(model, elements, error)
  end subroutine log_added_mass

  !> An amount and its share in words.
  pure function share_text(added, own) result(text)
    real(wp), intent(in) :: added, own
    character(:), allocatable :: text

    text = to_text(added)
    if (own > 0.0_wp) text = text//' ('//to_text(100.0_wp*added/own)//' per cent)'
  end function share_text

  !> An error where the added mass is more than ENDMAS allows.
  subroutine check_added_mass(model, elements, error)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: added(size(model%parts)), own(size(model%parts))

    if (.not. model%controls%most_added > 0.0_wp) return
    call added_masses(model, elements, added, own)
    if (100.0_wp*sum(added) <= model%controls%most_added*sum(own)) return
    call raise(error, 'mass scaling has added '//share_text(sum(added), sum(own)) &
      //', more than the '//to_text(model%controls%most_added)//' per cent of ENDMAS', status_run)
  end subroutine check_added_mass

end module mass_log_m
