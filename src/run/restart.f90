! SPDX-License-Identifier: MIT
!> Writing restart files between two cycles or steps.
!>
!> There a run is its state, what its driver hands from cycle to cycle besides, how far its
!> outputs are, and the deck. All of that is written, so that the run that goes on makes the same
!> bits as one that was not interrupted.
module restart_m
  use archive_m, only : archive_t
  use checksum_m, only : add_bytes, checksum_text
  use clock_m, only : lap, phase_nodes, phase_output
  use errors_m, only : error_t, status_files
  use files_m, only : file_exists, remove_file, unfinished
  use history_tables_m, only : history_tables, n_table, asked_by_states
  use kinds_m, only : wp, long
  use log_m, only : write_log
  use monitor_m, only : monitor_t
  use output_schedule_m, only : schedule_t, go_on_with
  use progress_m, only : show_note
  use restart_file_m, only : create_restart, finish_restart
  use restart_plan_m, only : restarts_t, dump_path, running_path, place_text, numbered_file
  use state_m, only : state_t
  use text_files_m, only : read_whole
  use visitor_m, only : visited_t, any_length
  implicit none
  private
  public :: write_restarts, forget_files, keep_run, keep_outputs

  !> Bounds on numbered files and on the length of a job's name.
  integer, parameter :: most_dumps = 1000000000, longest_name = 4096

contains

  !> Write restart files: the next numbered one, or the running one in place of the one before.
  subroutine write_restarts(wanted, state, monitor, error, driver)
    logical, intent(in) :: wanted(:)   !! numbered_file, running_file
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(out) :: error
    class(visited_t), intent(inout), optional :: driver !! what it remembers besides the state
    type(archive_t) :: archive
    character(:), allocatable :: effective_deck, path, line
    integer :: kind

    if (.not. any(wanted)) return
    if (present(driver)) call lap(monitor%clock, phase_nodes)
    do kind = 1, size(wanted)
      if (.not. wanted(kind) .or. allocated(error)) cycle
      if (kind == numbered_file) monitor%restarts%n_dump = monitor%restarts%n_dump + 1
      path = running_path(monitor%restarts)
      if (kind == numbered_file) path = dump_path(monitor%restarts, monitor%restarts%n_dump)
      call create_restart(path, archive)
      call read_effective_deck(monitor%restarts, archive, effective_deck)
      call keep_run(archive, monitor%restarts, effective_deck)
      if (allocated(effective_deck)) deallocate (effective_deck)
      call keep_outputs(archive, state%time, state%dt_before, monitor)
      call archive%part('state', state)
      if (present(driver)) call archive%part('driver', driver)
      call finish_restart(archive, error)
      if (allocated(error)) cycle
      line = 'restart file '//path//place_text(state)
      if (kind == numbered_file) call show_note(monitor%progress, monitor%log, line)
      if (kind /= numbered_file) call write_log(monitor%log, line)
    end do
    if (present(driver)) call lap(monitor%clock, phase_output)
  end subroutine write_restarts

  !> The deck as run, from the file that the run has written at its start: a large one is not kept
  !> in memory.
  subroutine read_effective_deck(restarts, archive, text)
    type(restarts_t), intent(in) :: restarts
    type(archive_t), intent(inout) :: archive
    character(:), allocatable, intent(out) :: text
    character(:), allocatable :: path, reason
    integer(long) :: checksum
    logical :: is_read

    if (allocated(archive%error)) return
    path = restarts%prefix//'.effective.k'
    call read_whole(path, text, is_read)
    if (is_read) then
      checksum = 0
      call add_bytes(checksum, text)
      if (checksum_text(checksum) /= restarts%effective_deck_checksum) &
        reason = 'it has been changed'
    else
      reason = 'it can not be read'
    end if
    if (allocated(reason)) call archive%fail('no restart file can be written, since it ' &
      //'would hold the deck as run, '//path//': '//reason, status_files)
  end subroutine read_effective_deck

  !> Write or read what is known of the run.
  subroutine keep_run(archive, restarts, effective_deck)
    type(archive_t), intent(inout) :: archive
    type(restarts_t), intent(inout) :: restarts
    character(:), allocatable, intent(inout) :: effective_deck

    call archive%enter('run')
    call archive%text('effective_deck', effective_deck)
    call archive%text('job', restarts%job)
    call archive%text('deck', restarts%deck)
    call archive%text('program', restarts%program)
    call archive%visit('n_dump', restarts%n_dump, 0, most_dumps - 1, 'a number that no run reaches')
    call archive%visit('is_implicit', restarts%is_implicit)
    if (archive%judges) call archive%expect('job', is_stem(restarts%job), &
      'a name that no file can have')
    call archive%leave()
  end subroutine keep_run

  !> Whether a text may begin the names of files in the folder of the results.
  pure function is_stem(text)
    character(*), intent(in) :: text
    logical :: is_stem
    integer :: i

    is_stem = len(text) > 0 .and. len(text) <= longest_name .and. index(text, '/') == 0
    do i = 1, len(text)
      is_stem = is_stem .and. iachar(text(i:i)) >= 32
    end do
  end function is_stem

  !> Write or read how far the outputs are.
  subroutine keep_outputs(archive, time, dt, monitor)
    type(archive_t), intent(inout) :: archive
    real(wp), intent(in) :: time, dt    !! of the state before, and the step within which it was
                                        !! early for an output
    type(monitor_t), intent(inout) :: monitor
    real(wp), allocatable :: times(:)
    integer :: k

    call archive%enter('outputs')
    call keep_schedule('plot', monitor%plot)
    do k = 1, n_table
      if (history_tables(k)%asked /= asked_by_states) &
        call keep_schedule(trim(history_tables(k)%name), monitor%tables(k))
    end do
    call archive%part('histories', monitor%histories)
    if (.not. archive%is_read) then
      allocate (times(0))
      if (allocated(monitor%results%times)) times = monitor%results%times(:monitor%results%n_state)
      call archive%visit('state_times', times, any_length)
    end if
    call archive%leave()

  contains

    !> One of them.
    subroutine keep_schedule(name, schedule)
      character(*), intent(in) :: name
      type(schedule_t), intent(inout) :: schedule !! planned from the deck
      type(schedule_t) :: kept

      kept = schedule
      call archive%part(name, kept)
      if (archive%judges) call go_on_with(kept, time, dt, schedule)
    end subroutine keep_schedule

  end subroutine keep_outputs

  !> Remove what an earlier run of this name has left, the running file and the numbered ones that
  !> follow without a gap: files that it has not finished, and whole ones too unless the run goes
  !> on.
  subroutine forget_files(restarts, error)
    type(restarts_t), intent(in) :: restarts
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: path
    logical :: found
    integer :: i

    i = 0
    path = running_path(restarts)
    do
      found = file_exists(path)
      if (.not. found) found = file_exists(path//unfinished)
      if (found) call remove_file(path//unfinished, error)
      if (found .and. .not. (restarts%goes_on .or. allocated(error))) call remove_file(path, error)
      if (allocated(error) .or. .not. (found .or. i == 0)) exit
      i = i + 1
      path = dump_path(restarts, i)
    end do
  end subroutine forget_files

end module restart_m
