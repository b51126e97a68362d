! SPDX-License-Identifier: MIT
!> What every restart file holds besides the state: what is known of the run,
!> and how far its outputs are.
module restart_run_m
  use archive_m, only : keep, keep_text
  use archive_file_m, only : archive_t, enter, leave
  use kinds_m, only : wp
  use monitor_m, only : monitor_t
  use restart_history_m, only : keep_schedule, keep_histories, keep_times
  use restart_plan_m, only : restarts_t
  implicit none
  private
  public :: keep_run, keep_outputs

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
    call leave(archive)
  end subroutine keep_run

  !> How far the outputs are.
  subroutine keep_outputs(archive, time, dt, monitor)
    type(archive_t), intent(inout) :: archive
    real(wp), intent(in) :: time, dt    !! of the state before, and the step within which it was
                                        !! early for an output
    type(monitor_t), intent(inout) :: monitor
    real(wp), allocatable :: times(:)

    call enter(archive, 'outputs')
    call keep_schedule(archive, 'plot', time, dt, monitor%plot)
    call keep_schedule(archive, 'glstat', time, dt, monitor%glstat)
    call keep_schedule(archive, 'rcforc', time, dt, monitor%rcforc)
    call keep_schedule(archive, 'nodout', time, dt, monitor%nodout)
    call keep_schedule(archive, 'matsum', time, dt, monitor%matsum)
    call keep_schedule(archive, 'rwforc', time, dt, monitor%rwforc)
    call keep_schedule(archive, 'sleout', time, dt, monitor%sleout)
    call keep_schedule(archive, 'spcforc', time, dt, monitor%spcforc)
    call keep_histories(archive, 'histories', monitor%histories)
    if (.not. archive%is_read) call keep_times(archive, 'state_times', monitor%results, times)
    call leave(archive)
  end subroutine keep_outputs

end module restart_run_m
