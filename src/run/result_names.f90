! SPDX-License-Identifier: MIT
!> The names of all results of a run, looked at before anything is touched.
module result_names_m
  use errors_m, only : error_t, raise, status_files
  use file_facts_m, only : file_facts_t, facts_of_name, what_hinders
  use files_m, only : join_path, unfinished
  use history_tables_m, only : history_tables
  use restart_plan_m, only : restarts_t, dump_path, running_path
  implicit none
  private
  public :: check_names

  !> Numbered restart files that are looked at in any case where the deck asks for some: those with
  !> two digits.
  integer, parameter :: least_numbers = 99

contains

  !> Refuse names of results under which something else stands than a file: a directory, a pipe, a
  !> device, a symbolic link. Other files are replaced. Numbered restart files have no last number:
  !> beyond the least, or where only a request can ask for one, they are looked at while they follow
  !> without a gap.
  subroutine check_names(restarts, keeps_files, error)
    type(restarts_t), intent(in) :: restarts !! its directory, job and prefix
    logical, intent(in) :: keeps_files       !! the deck asks for numbered restart files
    type(error_t), allocatable, intent(out) :: error
    character(12), parameter :: kinds(4) = [character(12) :: '.log', '.effective.k', '.vtkhdf', &
      '.timing.csv']
    integer :: i

    do i = 1, size(kinds)
      call check_name(restarts%prefix//trim(kinds(i)), error)
    end do
    do i = 1, size(history_tables)
      call check_name(restarts%prefix//'.'//trim(history_tables(i)%name), error)
      call check_name(restarts%prefix//'.'//trim(history_tables(i)%name)//'.csv', error)
    end do
    call check_name(join_path(restarts%directory, 'status.out'), error)
    call check_name(join_path(restarts%directory, restarts%job//'.status.out'), error)
    call check_name(running_path(restarts), error)
    i = 1
    do
      if (i > least_numbers .or. .not. keeps_files) then
        if (.not. is_taken(dump_path(restarts, i))) exit
      end if
      call check_name(dump_path(restarts, i), error)
      i = i + 1
    end do
  end subroutine check_names

  !> Whether a file of this name stands there, whole or not.
  function is_taken(path)
    character(*), intent(in) :: path
    logical :: is_taken
    type(file_facts_t) :: whole, part

    whole = facts_of_name(path)
    part = facts_of_name(path//unfinished)
    is_taken = whole%is_there .or. part%is_there
  end function is_taken

  !> Refuse one name, or that which the file has before it is complete; the first failure stays.
  subroutine check_name(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: name

    if (allocated(error)) return
    name = path
    if (len(what_hinders(name)) == 0) name = path//unfinished
    if (len(what_hinders(name)) > 0) call raise(error, 'cannot write '//name//': ' &
      //what_hinders(name), status_files)
  end subroutine check_name

end module result_names_m
