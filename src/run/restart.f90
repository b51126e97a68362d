! SPDX-License-Identifier: MIT
!> Writing restart files between two cycles or steps.
!>
!> There a run is its state, what its driver hands from cycle to cycle besides, how far its
!> outputs are, and the deck. All of that is written, so that the run that goes on makes the same
!> bits as one that was not interrupted. The driver's part is written by the driver, between
!> `begin_file` and `end_file`.
module restart_m
  use archive_file_m, only : archive_t, fail_archive
  use errors_m, only : error_t, status_files
  use files_m, only : file_exists, remove_file, unfinished
  use kinds_m, only : long
  use log_m, only : write_log
  use monitor_m, only : monitor_t
  use progress_m, only : show_note
  use restart_file_m, only : create_restart, finish_restart, file_checksum
  use restart_plan_m, only : restarts_t, dump_path, running_path, place_text, numbered_file
  use restart_run_m, only : keep_run, keep_outputs
  use restart_state_m, only : keep_state
  use state_m, only : state_t
  implicit none
  private
  public :: begin_file, end_file, forget_files

contains

  !> Begin a restart file: the next numbered one, or the running one in place of the one before.
  subroutine begin_file(kind, state, monitor, archive)
    integer, intent(in) :: kind                  !! numbered_file or running_file
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(archive_t), intent(out) :: archive
    character(:), allocatable :: effective_deck

    if (kind == numbered_file) monitor%restarts%n_dump = monitor%restarts%n_dump + 1
    call create_restart(path_of(kind, monitor%restarts), archive)
    call read_effective_deck(monitor%restarts, archive, effective_deck)
    call keep_run(archive, monitor%restarts, effective_deck)
    if (allocated(effective_deck)) deallocate (effective_deck)
    call keep_outputs(archive, state%time, state%dt_before, monitor)
    call keep_state(archive, state)
  end subroutine begin_file

  !> Complete it, and say so.
  subroutine end_file(kind, state, monitor, archive, error)
    integer, intent(in) :: kind                  !! numbered_file or running_file
    type(state_t), intent(in) :: state
    type(monitor_t), intent(inout) :: monitor
    type(archive_t), intent(inout) :: archive
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: line

    call finish_restart(archive, error)
    if (allocated(error)) return
    line = 'restart file '//path_of(kind, monitor%restarts)//place_text(state)
    if (kind == numbered_file) then
      call show_note(monitor%progress, monitor%log, line)
    else
      call write_log(monitor%log, line)
    end if
  end subroutine end_file

  !> Path of the file of a kind that is written now.
  pure function path_of(kind, restarts) result(path)
    integer, intent(in) :: kind
    type(restarts_t), intent(in) :: restarts
    character(:), allocatable :: path

    if (kind == numbered_file) then
      path = dump_path(restarts, restarts%n_dump)
    else
      path = running_path(restarts)
    end if
  end function path_of

  !> The deck as run, from the file that the run has written at its start: a large one is not kept
  !> in memory.
  subroutine read_effective_deck(restarts, archive, text)
    type(restarts_t), intent(in) :: restarts
    type(archive_t), intent(inout) :: archive
    character(:), allocatable, intent(out) :: text
    character(:), allocatable :: path, checksum, reason
    integer(long) :: length
    integer :: unit, status

    if (allocated(archive%error)) return
    path = restarts%prefix//'.effective.k'
    call file_checksum(path, 0, length, checksum, reason)
    if (.not. allocated(reason)) then
      if (checksum /= restarts%effective_deck_checksum) reason = 'it has been changed'
    end if
    if (.not. allocated(reason)) then
      allocate (character(length) :: text)
      open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
        action='read', iostat=status)
      if (status == 0) read (unit, iostat=status) text
      if (status == 0) close (unit)
      if (status /= 0) reason = 'it can not be read'
    end if
    if (allocated(reason)) call fail_archive(archive, 'no restart file can be written, since it ' &
      //'would hold the deck as run, '//path//': '//reason, status_files)
  end subroutine read_effective_deck

  !> Remove what an earlier run of this name has left: files that it has not finished, and whole
  !> ones too unless the run goes on.
  subroutine forget_files(restarts, error)
    type(restarts_t), intent(in) :: restarts
    type(error_t), allocatable, intent(out) :: error
    logical :: found
    integer :: i

    call forget_file(running_path(restarts), .not. restarts%goes_on, found, error)
    i = 0
    do while (found .or. i == 0)
      i = i + 1
      if (.not. allocated(error)) &
        call forget_file(dump_path(restarts, i), .not. restarts%goes_on, found, error)
    end do
  end subroutine forget_files

  !> Remove an unfinished file, and a whole one if asked.
  subroutine forget_file(path, whole_too, found, error)
    character(*), intent(in) :: path
    logical, intent(in) :: whole_too
    logical, intent(out) :: found       !! there was one, and nothing stood in the way
    type(error_t), allocatable, intent(out) :: error

    found = file_exists(path)
    if (.not. found) found = file_exists(path//unfinished)
    if (.not. found) return
    call remove_file(path//unfinished, error)
    if (whole_too .and. .not. allocated(error)) call remove_file(path, error)
    found = found .and. .not. allocated(error)
  end subroutine forget_file

end module restart_m
