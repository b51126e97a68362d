! SPDX-License-Identifier: MIT
!> The exit status where the Fortran library ends the program, as it does when the system refuses
!> memory: of its own accord it would be 1, that of refused input. A handler of exits has no
!> argument to carry a state, so that it is saved here.
module endings_m
  use, intrinsic :: iso_c_binding, only : c_funptr, c_funloc, c_int, c_loc, c_size_t
  use c_files_m, only : c_write
  use errors_m, only : status_run
  implicit none
  private
  public :: watch_end, announce_end, normal_ending, error_ending

  !> How a run says that it ended.
  character(*), parameter :: normal_ending = ' N o r m a l    t e r m i n a t i o n', &
    error_ending = ' E r r o r    t e r m i n a t i o n'

  !> Whether the program ends by itself.
  logical, save :: is_announced = .false.

  interface
    !> C library: a procedure to be called when the process ends.
    function c_atexit(handler) bind(c, name='atexit') result(status)
      import :: c_funptr, c_int
      type(c_funptr), value :: handler
      integer(c_int) :: status
    end function c_atexit

    !> POSIX: end the process without further handlers.
    subroutine c_exit_now(status) bind(c, name='_exit')
      import :: c_int
      integer(c_int), value :: status
    end subroutine c_exit_now
  end interface

contains

  !> From now on an end that is not announced has the status of an error in the run, and its
  !> line on standard output.
  subroutine watch_end()
    integer(c_int) :: ignored

    ignored = c_atexit(c_funloc(judge_end))
  end subroutine watch_end

  !> The program ends, by itself.
  subroutine announce_end()
    is_announced = .true.
  end subroutine announce_end

  !> The handler. Fortran's own units may be busy with what has failed.
  subroutine judge_end() bind(c)
    character(*), parameter :: text = 'slideline could not go on, for the reason above' &
      //' (error termination)'//new_line('a')
    character(len(text)), target :: line
    character(len(error_ending) + 2), target :: ending
    integer(c_size_t) :: ignored

    if (is_announced) return
    line = text
    ending = new_line('a')//error_ending//new_line('a')
    ignored = c_write(2_c_int, c_loc(line), len(line, c_size_t))
    ignored = c_write(1_c_int, c_loc(ending), len(ending, c_size_t))
    call c_exit_now(int(status_run, c_int))
  end subroutine judge_end

end module endings_m
