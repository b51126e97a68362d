! SPDX-License-Identifier: MIT
!> slideline: arguments in, exit status out.
program slideline
  use, intrinsic :: iso_c_binding, only : c_int, c_null_char
  use check_m, only : check_deck
  use arguments_m, only : arguments_t, read_arguments, help
  use build_info_m, only : version, build_type, compiler, flags, solvers
  use errors_m, only : error_t, status_run
  use ranks_m, only : ranks_t, join_ranks, leave_ranks
  use run_m, only : run_deck
  use text_files_m, only : show, complain, error_ending
  use source_version_m, only : source_version
  use system_m, only : catch_requests, watch_end, announce_end, exit_with, fill_standard_streams
  implicit none

  type(arguments_t) :: arguments
  type(ranks_t) :: ranks
  type(error_t), allocatable :: error
  integer(c_int) :: status
  integer :: i
  logical :: has_ended = .true. !! no end is left to be told

  call join_ranks(ranks)
  call catch_requests()
  call watch_end(new_line('a')//error_ending//new_line('a')//c_null_char, int(status_run, c_int))
  call fill_standard_streams()
  call read_arguments(arguments, error)
  if (.not. allocated(error)) then
    if (ranks%mine > 0 .and. (arguments%help .or. arguments%version .or. arguments%check)) then
      continue ! the first process answers
    else if (arguments%help) then
      do i = 1, size(help)
        call show(trim(help(i)))
      end do
    else if (arguments%version) then
      call show('slideline '//version//' (source '//source_version//')')
      call show('build '//build_type//', '//compiler)
      call show('flags '//flags)
      call show('linear solvers '//solvers)
    else if (arguments%check) then
      call check_deck(arguments, error)
    else
      call run_deck(arguments, ranks, has_ended, error)
    end if
  end if
  call announce_end()
  if (allocated(error) .and. ranks%mine == 0) then
    call complain(error%message)
    if (.not. has_ended) call show(error_ending)
  end if
  call leave_ranks()
  if (allocated(error)) then
    status = int(error%status, c_int)
    deallocate (error)
    call exit_with(status)
  end if
end program slideline
