! SPDX-License-Identifier: MIT
!> What every restart file holds besides the state: what is known of the run,
!> and how far its outputs are.
module restart_run_m
  use archive_m, only : keep, keep_text, expect
  use archive_file_m, only : archive_t, enter, leave
  use history_tables_m, only : history_tables, n_table, asked_by_states
  use kinds_m, only : wp
  use monitor_m, only : monitor_t
  use restart_history_m, only : keep_schedule, keep_histories, keep_times
  use restart_plan_m, only : restarts_t
  implicit none
  private
  public :: keep_run, keep_outputs

  !> Bounds on numbered files and on the length of a job's name.
  integer, parameter :: most_dumps = 1000000000, longest_name = 4096

contains

  !> What is known of the run.
  subroutine keep_run(archive, restarts, effective_deck)
    type(archive_t), intent(inout) :: archive
    type(restarts_t), intent(inout) :: restarts
    character(:), allocatable, intent(inout) :: effective_deck

    call enter(archive, 'run')
    call keep_text(archive, 'effective_deck', effective_deck)
    call keep_text(archive, 'job', restarts%job)
    call keep_text(archive, 'deck', restarts%deck)
    call keep_text(archive, 'program', restarts%program)
    call keep(archive, 'n_dump', restarts%n_dump)
    call keep(archive, 'is_implicit', restarts%is_implicit)
    call expect(archive, 'n_dump', restarts%n_dump >= 0 .and. restarts%n_dump < most_dumps, &
      'a number that no run reaches')
    if (.not. allocated(archive%error)) call expect(archive, 'job', is_stem(restarts%job), &
      'a name that no file can have')
    call leave(archive)
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

  !> How far the outputs are.
  subroutine keep_outputs(archive, time, dt, monitor)
    type(archive_t), intent(inout) :: archive
    real(wp), intent(in) :: time, dt    !! of the state before, and the step within which it was
                                        !! early for an output
    type(monitor_t), intent(inout) :: monitor
    real(wp), allocatable :: times(:)
    integer :: k

    call enter(archive, 'outputs')
    call keep_schedule(archive, 'plot', time, dt, monitor%plot)
    do k = 1, n_table
      if (history_tables(k)%asked /= asked_by_states) call keep_schedule(archive, &
        trim(history_tables(k)%name), time, dt, monitor%tables(k))
    end do
    call keep_histories(archive, 'histories', monitor%histories)
    if (.not. archive%is_read) call keep_times(archive, 'state_times', monitor%results, times)
    call leave(archive)
  end subroutine keep_outputs

end module restart_run_m
