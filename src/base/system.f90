! SPDX-License-Identifier: MIT
!> What the program asks of the system (system.cpp): requests from outside (SIGTERM, SIGINT and
!> SIGHUP: stop, SIGUSR1: restart file, SIGUSR2: plot state), how the program ends, and memory.
module system_m
  use, intrinsic :: iso_c_binding, only : c_bool, c_char, c_int, c_ptr, c_size_t
  implicit none
  private
  public :: catch_requests, catch_stops, limit_processor, stop_requested, is_requested, &
    request_dump, request_plot, output_is_terminal, guard_exit, allow_exit, exit_with, &
    expect_allocation_failure, require_memory, release_memory, release_pages, fill_standard_streams

  !> What may be asked for time and again.
  integer(c_int), parameter :: request_dump = 1, request_plot = 2

  interface
    !> From now on SIGUSR1 and SIGUSR2 only ask for something; a pipe whose reader has gone
    !> (SIGPIPE) and a file that reaches the largest size allowed (SIGXFSZ) are failed writes.
    subroutine catch_requests() bind(c)
    end subroutine catch_requests

    !> From now on SIGTERM, SIGINT, SIGHUP and a used up processor time (SIGXCPU) ask for a stop;
    !> SIGINT and SIGHUP only where they were not ignored.
    subroutine catch_stops() bind(c)
    end subroutine catch_stops

    !> After so much processor time the system asks for a stop (SIGXCPU); a lower limit that is set
    !> already stays.
    subroutine limit_processor(seconds) bind(c)
      import :: c_int
      integer(c_int), value :: seconds
    end subroutine limit_processor

    !> Whether a stop was asked for.
    function stop_requested() bind(c) result(requested)
      import :: c_bool
      logical(c_bool) :: requested
    end function stop_requested

    !> Whether a restart file or a plot state has been asked for since the last question.
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

    !> From now on an end that is not announced, as by the Fortran library when the system refuses
    !> memory, has this status and this line on standard output: of its own accord the status would
    !> be 1, that of refused input.
    subroutine guard_exit(line, status) bind(c)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: line(*) !! ends with a null
      integer(c_int), value :: status
    end subroutine guard_exit

    !> The program ends, by itself.
    subroutine allow_exit() bind(c)
    end subroutine allow_exit

    !> End the process with a status.
    subroutine exit_with(status) bind(c, name='exit')
      import :: c_int
      integer(c_int), value :: status
    end subroutine exit_with

    !> From now on, until told otherwise, an `allocate` with a status gets it; else memory that the
    !> system refuses ends the program, whatever asks for it.
    subroutine expect_allocation_failure(yes) bind(c)
      import :: c_bool
      logical(c_bool), value :: yes
    end subroutine expect_allocation_failure

    !> End the program here unless so much memory is to be had: before calls of a library that does
    !> not look at the answer.
    subroutine require_memory(n_byte) bind(c)
      import :: c_size_t
      integer(c_size_t), value :: n_byte
    end subroutine require_memory

    !> Hand back what has been deallocated: the C library keeps arrays of up to 32 MB for later.
    subroutine release_memory() bind(c)
    end subroutine release_memory

    !> Hand back the pages that lie within a part of an array whose values nobody asks for any more.
    !> The part stays allocated, without values, and takes memory again where it is written to.
    subroutine release_pages(start, n_byte) bind(c)
      import :: c_ptr, c_size_t
      type(c_ptr), value :: start        !! of the part
      integer(c_size_t), value :: n_byte
    end subroutine release_pages

    !> Open the null device in place of standard streams that the caller has closed: a result file
    !> would take their number otherwise, and what is meant for the screen would go into it.
    subroutine fill_standard_streams() bind(c)
    end subroutine fill_standard_streams
  end interface

end module system_m
