! SPDX-License-Identifier: MIT
!> The names of all results of a run and of the files that it reads, looked at before anything is
!> touched.
module result_names_m
  use errors_m, only : error_t, raise, status_files
  use files_m, only : file_facts_t, facts_of_name, facts_of_target, is_same_file, what_hinders, &
    join_path, unfinished
  use history_tables_m, only : history_tables
  use requests_m, only : switch_path
  use restart_plan_m, only : restarts_t, dump_path, running_path
  implicit none
  private
  public :: check_names

  !> Numbered restart files that are looked at in any case where the deck asks for some: those with
  !> two digits.
  integer, parameter :: least_numbers = 99

  !> A file that the run has read.
  type :: input_t
    character(:), allocatable :: path
    type(file_facts_t) :: facts
  end type input_t

contains

  !> Refuse names of results under which something else stands than a file: a directory, a pipe, a
  !> device, a symbolic link; and those of files that the run reads, by whatever path. Other files
  !> are replaced. Numbered restart files have no last number: beyond the least, or where only a
  !> request can ask for one, they are looked at while they follow without a gap. The restart file
  !> that a run goes on from may have the name of the running one, or of one that it does not
  !> write any more.
  subroutine check_names(restarts, keeps_files, inputs_only, error)
    type(restarts_t), intent(in) :: restarts !! its directory, job, prefix, inputs and source
    logical, intent(in) :: keeps_files       !! the deck asks for numbered restart files
    logical, intent(in) :: inputs_only       !! only files that the run reads are looked for
    type(error_t), allocatable, intent(out) :: error
    character(12), parameter :: kinds(4) = [character(12) :: '.log', '.effective.k', '.vtkhdf', &
      '.timing.csv']
    type(input_t) :: inputs(size(restarts%inputs) + 1) !! the last one: the restart file, if any
    integer :: i, n_deck

    n_deck = size(restarts%inputs)
    do i = 1, n_deck
      inputs(i)%path = trim(restarts%inputs(i))
      inputs(i)%facts = facts_of_target(inputs(i)%path)
    end do
    if (restarts%goes_on) then
      inputs(n_deck + 1)%path = restarts%source%path
      inputs(n_deck + 1)%facts = facts_of_target(restarts%source%path)
    end if
    call check_name(switch_path(restarts%directory), inputs, .true., error)
    do i = 1, size(kinds)
      call look(restarts%prefix//trim(kinds(i)), size(inputs))
    end do
    do i = 1, size(history_tables)
      call look(restarts%prefix//'.'//trim(history_tables(i)%name), size(inputs))
      call look(restarts%prefix//'.'//trim(history_tables(i)%name)//'.csv', size(inputs))
    end do
    call look(join_path(restarts%directory, 'status.out'), size(inputs))
    call look(join_path(restarts%directory, restarts%job//'.status.out'), size(inputs))
    call look(running_path(restarts), n_deck)
    i = 1
    do
      if (i > least_numbers .or. .not. keeps_files) then
        if (.not. is_taken(dump_path(restarts, i))) exit
      end if
      call look(dump_path(restarts, i), merge(n_deck, size(inputs), i <= restarts%n_dump))
      i = i + 1
    end do

  contains

    !> Look at one name and at that which the file has before it is complete.
    subroutine look(path, n)
      character(*), intent(in) :: path
      integer, intent(in) :: n !! inputs whose name it may not have, the first ones

      call check_name(path, inputs(:n), inputs_only, error)
      call check_name(path//unfinished, inputs(:n), inputs_only, error)
    end subroutine look

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

  !> Refuse one name; the first failure stays.
  subroutine check_name(path, inputs, inputs_only, error)
    character(*), intent(in) :: path
    type(input_t), intent(in) :: inputs(:)
    logical, intent(in) :: inputs_only !! whatever else stands there
    type(error_t), allocatable, intent(inout) :: error
    type(file_facts_t) :: facts
    integer :: i

    if (allocated(error)) return
    facts = facts_of_name(path)
    if (.not. facts%is_there) return
    if (.not. (facts%is_regular .or. inputs_only)) then
      call raise(error, 'cannot write '//path//': '//what_hinders(path), status_files)
      return
    end if
    do i = 1, size(inputs)
      if (.not. is_same_file(facts, inputs(i)%facts)) cycle
      call raise(error, 'cannot write '//path//': it is the file '//inputs(i)%path//', which ' &
        //'this run reads; give the run another name (jobid=) or folder (d=)', status_files)
      return
    end do
  end subroutine check_name

end module result_names_m
