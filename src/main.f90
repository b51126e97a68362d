! SPDX-License-Identifier: MIT
!> Main program of slideline.
program slideline
  use, intrinsic :: iso_c_binding, only : c_int, c_null_char
  use check_m, only : check_deck
  use arguments_m, only : arguments_t, read_arguments, help
  use build_info_m, only : version, build_type, compiler, flags, solvers
  use errors_m, only : error_t, status_run
  use ranks_m, only : ranks_t, join_ranks, leave_ranks
  use run_m, only : run_deck
  use text_files_m, only : print_line, print_error, error_ending
  use source_version_m, only : source_version
  use system_m, only : catch_requests, guard_exit, allow_exit, exit_with, fill_standard_streams
  implicit none

  type(arguments_t) :: arguments
  type(ranks_t) :: ranks
  type(error_t), allocatable :: error
  integer(c_int) :: status
  integer :: i
  logical :: has_ended = .true. !! the last line has been printed

  call join_ranks(ranks)
  call catch_requests()
  call guard_exit(new_line('a')//error_ending//new_line('a')//c_null_char, int(status_run, c_int))
  call fill_standard_streams()
  call read_arguments(arguments, error)
  if (.not. allocated(error)) then
    if (ranks%mine > 0 .and. (arguments%help .or. arguments%version .or. arguments%check)) then
      continue ! the first process answers
    else if (arguments%help) then
      do i = 1, size(help)
        call print_line(trim(help(i)))
      end do
    else if (arguments%version) then
      call print_line('slideline '//version//' (source '//source_version//')')
      call print_line('build '//build_type//', '//compiler)
      call print_line('flags '//flags)
      call print_line('linear solvers '//solvers)
    else if (arguments%check) then
      call check_deck(arguments, error)
    else
      call run_deck(arguments, ranks, has_ended, error)
    end if
  end if
  call allow_exit()
  if (allocated(error) .and. ranks%mine == 0) then
    call print_error(error%message)
    if (.not. has_ended) call print_line(error_ending)
  end if
  call leave_ranks()
  if (allocated(error)) then
    status = int(error%status, c_int)
    deallocate (error)
    call exit_with(status)
  end if
end program slideline
