! SPDX-License-Identifier: MIT
!> What the implicit driver remembers from step to step besides the state, and its part of a restart
!> file.
module implicit_memory_m
  use archive_m, only : keep, expect
  use archive_file_m, only : archive_t, enter, leave
  use clock_m, only : lap, phase_nodes, phase_output
  use errors_m, only : error_t
  use implicit_forces_m, only : trial_t, start_trial, net_force, cut_sections
  use implicit_tangent_m, only : step_t
  use kinds_m, only : wp
  use model_m, only : model_t
  use monitor_m, only : monitor_t, due_t
  use restart_file_m, only : close_restart
  use restart_m, only : begin_file, end_file
  use state_m, only : state_t
  use step_control_m, only : step_control_t
  implicit none
  private
  public :: implicit_memory_t, write_restarts, check_memory, take_up_memory

  !> What one step remembers of those before.
  type :: implicit_memory_t
    type(step_control_t) :: control
    type(step_t) :: step
    type(trial_t) :: trial     !! forces of the state
    type(due_t) :: written     !! of the state that was reported last
    real(wp) :: ratio = 1.0_wp !! last energy ratio known
  end type implicit_memory_t

contains

  !> Write restart files after a step. The memory is that of the state, its
  !> next step not planned yet.
  subroutine write_restarts(model, wanted, state, monitor, memory, error)
    type(model_t), intent(in) :: model
    logical, intent(in) :: wanted(:)   !! numbered_file, running_file
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(implicit_memory_t), intent(inout) :: memory
    type(error_t), allocatable, intent(out) :: error
    type(archive_t) :: archive
    integer :: kind

    if (.not. any(wanted)) return
    call lap(monitor%clock, phase_nodes)
    call cut_sections(model, memory%trial, state)
    do kind = 1, size(wanted)
      if (.not. wanted(kind) .or. allocated(error)) cycle
      call begin_file(kind, state, monitor, archive)
      call keep_memory(archive, memory%control, memory%step, memory%trial, memory%ratio)
      call end_file(kind, state, monitor, archive, error)
    end do
    call lap(monitor%clock, phase_output)
  end subroutine write_restarts

  !> Write or read what the next step has to know of those before.
  subroutine keep_memory(archive, control, step, trial, ratio)
    type(archive_t), intent(inout) :: archive
    type(step_control_t), intent(inout) :: control
    type(step_t), intent(inout) :: step
    type(trial_t), intent(inout) :: trial
    real(wp), intent(inout) :: ratio

    call enter(archive, 'steps')
    call keep(archive, 'dt', control%dt)
    call keep(archive, 'target', control%target)
    call expect(archive, 'dt', control%dt > 0.0_wp, 'a step that is not positive')
    call keep(archive, 'searches', step%searches)
    call keep(archive, 'began_negative', step%began_negative)
    call keep(archive, 'internal', trial%internal)
    call keep(archive, 'contact', trial%contact)
    call keep(archive, 'external', trial%external)
    call keep(archive, 'damping', trial%damping)
    call keep(archive, 'ratio', ratio)
    call leave(archive)
  end subroutine keep_memory

  !> Whether it can be taken up; the first thing that is wrong is told as an error of the archive.
  subroutine check_memory(model, state, source)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(archive_t), intent(inout) :: source
    type(implicit_memory_t) :: memory

    call start_trial(model, state, memory%trial)
    call keep_memory(source, memory%control, memory%step, memory%trial, memory%ratio)
  end subroutine check_memory

  !> Read it into a memory that is set up from the deck, and close the file.
  subroutine take_up_memory(model, state, source, memory, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(archive_t), intent(inout) :: source
    type(implicit_memory_t), intent(inout) :: memory
    type(error_t), allocatable, intent(out) :: error

    call start_trial(model, state, memory%trial)
    call keep_memory(source, memory%control, memory%step, memory%trial, memory%ratio)
    call close_restart(source, error)
    if (allocated(error)) return
    memory%step%old_force = net_force(memory%trial)
    ! The end may have come nearer while a whole step is under way.
    memory%control%target = min(memory%control%target, memory%control%end_time)
  end subroutine take_up_memory

end module implicit_memory_m
