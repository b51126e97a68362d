! SPDX-License-Identifier: MIT
!> Restart plan: when restart files are written, the file that a run restarts from, and the names of
!> all results, which are checked before any file is written.
module restart_plan_m
  use archive_m, only : archive_t
  use errors_m, only : error_t, raise, status_files
  use files_m, only : file_facts_t, facts_of_name, facts_of_target, is_same_file, write_obstacle, &
    join_path, unfinished
  use history_tables_m, only : history_tables
  use kinds_m, only : wp, long
  use log_m, only : to_text
  use state_m, only : state_t
  implicit none
  private
  public :: restarts_t, dump_path, running_path, place_text, wanted_files, &
    numbered_file, running_file, is_poll_due, switch_path, check_names

  !> Kinds of restart files: numbered ones, which stay, and the running one, which is replaced.
  integer, parameter :: numbered_file = 1, running_file = 2

  !> Numbered restart files whose names are always checked where the deck asks for some: those of
  !> two digits.
  integer, parameter :: least_numbers = 99

  !> Seconds between two polls of d3kil, and cycles between polls where the clock is not read
  !> otherwise.
  real(wp), parameter :: poll_interval = 0.5_wp
  integer, parameter :: poll_cycles = 64

  !> Restart files of a run.
  type :: restarts_t
    character(:), allocatable :: directory !! of the results and of d3kil
    character(:), allocatable :: job       !! stem of the result files
    character(:), allocatable :: prefix    !! directory and job name
    character(:), allocatable :: deck      !! file name of the deck
    character(:), allocatable :: inputs(:) !! paths of the deck and its includes
    character(:), allocatable :: program   !! version and build
    character(:), allocatable :: effective_deck_checksum !! of the file `<prefix>.effective.k`
    logical :: is_implicit = .false.       !! method of the run
    integer :: dump_cycles = -1            !! as in output_plan_t
    integer :: running_cycles = 0
    integer :: n_dump = 0                  !! numbered files so far
    integer(long) :: next_poll = 0         !! clock tick of the next poll of d3kil
    logical :: is_restart = .false.        !! the run restarts from `source`
    type(archive_t) :: source
    real(wp), allocatable :: state_times(:) !! times of the states in the results file at the
                                            !! restart
    logical :: finds_states = .false.      !! these states are still there
  end type restarts_t

contains

  !> Path of the numbered file `i`.
  pure function dump_path(restarts, i) result(path)
    type(restarts_t), intent(in) :: restarts
    integer, intent(in) :: i
    character(:), allocatable :: path
    character(12) :: number

    write (number, '(ss,i0.2)') i
    path = restarts%prefix//'.dump'//trim(number)//'.h5'
  end function dump_path

  !> Path of the running file.
  pure function running_path(restarts) result(path)
    type(restarts_t), intent(in) :: restarts
    character(:), allocatable :: path

    path = restarts%prefix//'.runrsf.h5'
  end function running_path

  !> Time and cycle in words.
  pure function place_text(state) result(text)
    type(state_t), intent(in) :: state
    character(:), allocatable :: text

    text = ' at time '//to_text(state%time)//', cycle '//to_text(state%cycle)
    if (state%relaxation%n > 0) text = ' in dynamic relaxation, after ' &
      //to_text(state%relaxation%n)//' cycles'
  end function place_text

  !> Restart files due before a cycle: at their intervals; before the last cycle the numbered one;
  !> before a stop by a signal each kind that the deck asks for.
  pure function wanted_files(restarts, cycle, is_requested, is_last, stops) result(wanted)
    type(restarts_t), intent(in) :: restarts
    integer, intent(in) :: cycle
    logical, intent(in) :: is_requested    !! the user asks for a numbered one
    logical, intent(in) :: is_last  !! the cycle is the last one
    logical, intent(in) :: stops    !! a signal requests a stop
    logical :: wanted(2)            !! numbered_file, running_file

    wanted(numbered_file) = is_requested .or. (restarts%dump_cycles >= 0 .and. (is_last .or. &
      stops)) .or. ends_interval(cycle, restarts%dump_cycles)
    wanted(running_file) = (restarts%running_cycles > 0 .and. stops) &
      .or. ends_interval(cycle, restarts%running_cycles)
  end function wanted_files

  !> Whether a file is due at its interval; none at the start, nor without an interval.
  pure function ends_interval(cycle, interval) result(ends)
    integer, intent(in) :: cycle, interval
    logical :: ends

    ends = .false.
    if (interval > 0 .and. cycle > 0) ends = mod(cycle, interval) == 0
  end function ends_interval

  !> Whether d3kil is to be polled. `tick` is the last known clock tick; where no clock runs, it is
  !> read every `poll_cycles` cycles.
  subroutine is_poll_due(restarts, ticks_run, tick, cycle, wanted)
    type(restarts_t), intent(inout) :: restarts
    logical, intent(in) :: ticks_run
    integer(long), intent(in) :: tick
    integer, intent(in) :: cycle
    logical, intent(out) :: wanted
    integer(long) :: now, rate

    now = tick
    if (.not. ticks_run .and. mod(cycle, poll_cycles) == 0) call system_clock(now)
    wanted = now >= restarts%next_poll
    if (.not. wanted) return
    call system_clock(now, rate)
    restarts%next_poll = now + int(poll_interval*real(rate, wp), long)
  end subroutine is_poll_due

  !> Path of the file of requests.
  pure function switch_path(directory) result(path)
    character(*), intent(in) :: directory !! of the results
    character(:), allocatable :: path

    path = join_path(directory, 'd3kil')
  end function switch_path

  !> Refuse result names under which something other than a file exists (directory, pipe, device,
  !> symbolic link), and names of files that the run reads. Other files are replaced. Numbered
  !> restart files have no last number: beyond the least, or where only a request can ask for one,
  !> consecutive existing files are checked. The restart file that a run reads may have the name of
  !> the running one, or of one that is no longer written.
  subroutine check_names(restarts, has_numbered, inputs_only, error)
    type(restarts_t), intent(in) :: restarts !! directory, job, prefix, inputs and source
    logical, intent(in) :: has_numbered       !! the deck asks for numbered restart files
    logical, intent(in) :: inputs_only       !! check against the inputs only
    type(error_t), allocatable, intent(out) :: error
    character(12), parameter :: kinds(4) = [character(12) :: '.log', '.effective.k', '.vtkhdf', &
      '.timing.csv']
    type(file_facts_t) :: inputs(size(restarts%inputs) + 1) !! last the restart file, if any
    integer :: i, n_deck

    n_deck = size(restarts%inputs)
    do i = 1, n_deck
      inputs(i) = facts_of_target(trim(restarts%inputs(i)))
    end do
    if (restarts%is_restart) inputs(n_deck + 1) = facts_of_target(restarts%source%path)
    call check_name(switch_path(restarts%directory), size(inputs), .true.)
    do i = 1, size(kinds)
      call check_with_unfinished(restarts%prefix//trim(kinds(i)), size(inputs))
    end do
    do i = 1, size(history_tables)
      call check_with_unfinished(restarts%prefix//'.'//trim(history_tables(i)%name), size(inputs))
      call check_with_unfinished(restarts%prefix//'.'//trim(history_tables(i)%name)//'.csv', &
        size(inputs))
    end do
    call check_with_unfinished(join_path(restarts%directory, 'status.out'), size(inputs))
    call check_with_unfinished(join_path(restarts%directory, restarts%job//'.status.out'), &
      size(inputs))
    call check_with_unfinished(running_path(restarts), n_deck)
    i = 1
    do
      if (i > least_numbers .or. .not. has_numbered) then
        if (.not. is_taken(dump_path(restarts, i))) exit
      end if
      call check_with_unfinished(dump_path(restarts, i), merge(n_deck, size(inputs), i &
        <= restarts%n_dump))
      i = i + 1
    end do

  contains

    !> Check a name and the name of the unfinished file.
    subroutine check_with_unfinished(path, n)
      character(*), intent(in) :: path
      integer, intent(in) :: n !! number of inputs that it must not equal, the first ones

      call check_name(path, n, inputs_only)
      call check_name(path//unfinished, n, inputs_only)
    end subroutine check_with_unfinished

    !> Refuse one name; the first failure stays.
    subroutine check_name(path, n, may_be_any)
      character(*), intent(in) :: path
      integer, intent(in) :: n
      logical, intent(in) :: may_be_any !! any kind of file is allowed
      character(:), allocatable :: input
      type(file_facts_t) :: facts
      integer :: i

      if (allocated(error)) return
      facts = facts_of_name(path)
      if (.not. facts%is_there) return
      if (.not. (facts%is_regular .or. may_be_any)) then
        call raise(error, 'cannot write '//path//': '//write_obstacle(path), status_files)
        return
      end if
      do i = 1, n
        if (.not. is_same_file(facts, inputs(i))) cycle
        if (i > n_deck) input = restarts%source%path
        if (i <= n_deck) input = trim(restarts%inputs(i))
        call raise(error, 'cannot write '//path//': it is the file '//input//', which this run ' &
          //'reads; give the run another name (jobid=) or folder (d=)', status_files)
        return
      end do
    end subroutine check_name

  end subroutine check_names

  !> Whether a complete or unfinished file of this name exists.
  function is_taken(path)
    character(*), intent(in) :: path
    logical :: is_taken
    type(file_facts_t) :: whole, part

    whole = facts_of_name(path)
    part = facts_of_name(path//unfinished)
    is_taken = whole%is_there .or. part%is_there
  end function is_taken

end module restart_plan_m
