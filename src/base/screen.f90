! SPDX-License-Identifier: MIT
!> Standard output and standard error. Lines go to the system by themselves and at once: through
!> Fortran's units they could fail unnoticed, and GFORTRAN_STDOUT_UNIT or GFORTRAN_DEFAULT_RECL
!> in the environment would send them to a file or cut them.
module screen_m
  use errors_m, only : error_t
  use text_files_m, only : text_file_t, append_text
  implicit none
  private
  public :: show, show_part, complain, normal_ending, error_ending

  !> How a run says that it ended.
  character(*), parameter :: normal_ending = ' N o r m a l    t e r m i n a t i o n', &
    error_ending = ' E r r o r    t e r m i n a t i o n'

contains

  !> A line (or several, separated by new_line) on standard output.
  subroutine show(text, error)
    character(*), intent(in) :: text
    type(error_t), allocatable, intent(out), optional :: error !! absent: a failure is no matter

    call show_part(text//new_line('a'), error)
  end subroutine show

  !> Text on standard output, without a line end.
  subroutine show_part(text, error)
    character(*), intent(in) :: text
    type(error_t), allocatable, intent(out), optional :: error !! absent: a failure is no matter
    type(error_t), allocatable :: failure
    type(text_file_t) :: screen

    screen = text_file_t('standard output', 1)
    call append_text(screen, text, failure)
    if (present(error) .and. allocated(failure)) call move_alloc(failure, error)
  end subroutine show_part

  !> A line (or several) on standard error.
  subroutine complain(text)
    character(*), intent(in) :: text
    type(error_t), allocatable :: ignored
    type(text_file_t) :: screen

    screen = text_file_t('standard error', 2)
    call append_text(screen, text//new_line('a'), ignored)
  end subroutine complain

end module screen_m
