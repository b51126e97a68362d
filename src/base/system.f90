! SPDX-License-Identifier: MIT
!> System calls (system.cpp): signals (SIGTERM, SIGINT and SIGHUP: stop, SIGUSR1: restart file,
!> SIGUSR2: plot state), exit status, and memory.
module system_m
  use, intrinsic :: iso_c_binding, only : c_bool, c_char, c_int, c_ptr, c_size_t
  implicit none
  private
  public :: catch_requests, catch_stops, limit_processor, stop_requested, is_requested, &
    request_dump, request_plot, output_is_terminal, guard_exit, allow_exit, exit_with, &
    expect_allocation_failure, require_memory, release_memory, release_pages, fill_standard_streams

  !> Requests that may come repeatedly.
  integer(c_int), parameter :: request_dump = 1, request_plot = 2

  interface
    !> Record SIGUSR1 and SIGUSR2 as requests; turn a pipe without reader (SIGPIPE) and a file at
    !> its size limit (SIGXFSZ) into failed writes.
    subroutine catch_requests() bind(c)
    end subroutine catch_requests

    !> Record SIGTERM, SIGXCPU, and SIGINT and SIGHUP unless ignored, as requests to stop.
    subroutine catch_stops() bind(c)
    end subroutine catch_stops

    !> Limit the processor time: the system then sends SIGXCPU. A lower existing limit is kept.
    subroutine limit_processor(seconds) bind(c)
      import :: c_int
      integer(c_int), value :: seconds
    end subroutine limit_processor

    !> Whether a stop has been requested.
    function stop_requested() bind(c) result(requested)
      import :: c_bool
      logical(c_bool) :: requested
    end function stop_requested

    !> Whether a restart file or a plot state has been requested since the last call.
    function is_requested(request) bind(c) result(requested)
      import :: c_bool, c_int
      integer(c_int), value :: request !! one of the `request_` constants
      logical(c_bool) :: requested
    end function is_requested

    !> Whether standard output is a terminal.
    function output_is_terminal() bind(c) result(terminal)
      import :: c_bool
      logical(c_bool) :: terminal
    end function output_is_terminal

    !> Set exit status and last output line of an exit before `allow_exit`, as by the Fortran
    !> library when memory runs out; by default its status would be 1, that of refused input.
    subroutine guard_exit(line, status) bind(c)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: line(*) !! ends with a null
      integer(c_int), value :: status
    end subroutine guard_exit

    !> Mark the end of the program as regular.
    subroutine allow_exit() bind(c)
    end subroutine allow_exit

    !> Exit with a status.
    subroutine exit_with(status) bind(c, name='exit')
      import :: c_int
      integer(c_int), value :: status
    end subroutine exit_with

    !> Whether a failed allocation returns to its caller, which has a status (yes), or ends the
    !> program (no, the default).
    subroutine expect_allocation_failure(yes) bind(c)
      import :: c_bool
      logical(c_bool), value :: yes
    end subroutine expect_allocation_failure

    !> End the program unless `n_byte` bytes are available: before calls of a library that does not
    !> check its allocations.
    subroutine require_memory(n_byte) bind(c)
      import :: c_size_t
      integer(c_size_t), value :: n_byte
    end subroutine require_memory

    !> Return deallocated memory to the system: the C library retains arrays of up to 32 MB.
    subroutine release_memory() bind(c)
    end subroutine release_memory

    !> Return the memory pages within a part of an array whose values are not needed any more. The
    !> part stays allocated with undefined values.
    subroutine release_pages(start, n_byte) bind(c)
      import :: c_ptr, c_size_t
      type(c_ptr), value :: start        !! of the part
      integer(c_size_t), value :: n_byte
    end subroutine release_pages

    !> Open the null device in place of closed standard streams: otherwise a result file would get
    !> their descriptor, and with it the screen output.
    subroutine fill_standard_streams() bind(c)
    end subroutine fill_standard_streams
  end interface

end module system_m
