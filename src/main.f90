! SPDX-License-Identifier: MIT
!> slideline: arguments in, exit status out.
program slideline
  use, intrinsic :: iso_c_binding, only : c_int
  use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
  use check_m, only : check_deck
  use arguments_m, only : arguments_t, read_arguments, help_text
  use build_info_m, only : version, build_type, compiler, flags, solvers
  use endings_m, only : watch_end, announce_end
  use errors_m, only : error_t
  use files_m, only : fill_standard_streams
  use progress_m, only : error_ending
  use run_m, only : run_deck
  use signals_m, only : ignore_closed_pipes
  use source_version_m, only : source_version
  implicit none

  interface
    !> C library: end the process with a status that is known only now.
    subroutine c_exit(status) bind(c, name='exit')
      import :: c_int
      integer(c_int), value :: status
    end subroutine c_exit
  end interface

  type(arguments_t) :: arguments
  type(error_t), allocatable :: error
  integer(c_int) :: status
  integer :: ignored
  logical :: has_ended = .true. !! no end is left to be told

  call watch_end()
  call fill_standard_streams()
  call ignore_closed_pipes()
  call read_arguments(arguments, error)
  if (.not. allocated(error)) then
    if (arguments%help) then
      write (output_unit, '(a)', iostat=ignored) help_text()
    else if (arguments%version) then
      write (output_unit, '(a)', iostat=ignored) 'slideline '//version//' (source ' &
        //source_version//')', 'build '//build_type//', '//compiler, 'flags '//flags, &
        'linear solvers '//solvers
    else if (arguments%check) then
      call check_deck(arguments, error)
    else
      call run_deck(arguments, has_ended, error)
    end if
  end if
  call announce_end()
  if (allocated(error)) then
    write (error_unit, '(a)', iostat=ignored) error%message
    flush (error_unit, iostat=ignored)
    if (.not. has_ended) write (output_unit, '(a)', iostat=ignored) error_ending
    flush (output_unit, iostat=ignored)
    status = int(error%status, c_int)
    deallocate (error)
    call c_exit(status)
  end if
end program slideline
