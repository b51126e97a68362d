! SPDX-License-Identifier: MIT
!> What the implicit driver remembers from step to step besides the state, and its part of a restart
!> file.
module implicit_memory_m
  use archive_m, only : archive_t
  use errors_m, only : error_t
  use implicit_forces_m, only : trial_t, start_trial, net_force, cut_sections
  use implicit_tangent_m, only : step_t
  use kinds_m, only : wp
  use model_m, only : model_t
  use monitor_m, only : monitor_t, due_t
  use restart_file_m, only : close_restart
  use restart_m, only : write_restarts
  use state_m, only : state_t
  use step_control_m, only : step_control_t
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: implicit_memory_t, write_files, read_memory, take_up_memory

  !> What one step remembers of those before.
  type, extends(visited_t) :: implicit_memory_t
    type(step_control_t) :: control
    type(step_t) :: step
    type(trial_t) :: trial     !! forces of the state
    type(due_t) :: written     !! of the state that was reported last
    real(wp) :: ratio = 1.0_wp !! last energy ratio known
  contains
    procedure :: visit => visit_memory
  end type implicit_memory_t

contains

  !> What the next step has to know of those before.
  subroutine visit_memory(self, visitor)
    class(implicit_memory_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%part('control', self%control)
    call visitor%part('step', self%step)
    call visitor%part('trial', self%trial)
    call visitor%visit('ratio', self%ratio)
  end subroutine visit_memory

  !> Write restart files after a step. The memory is that of the state, its
  !> next step not planned yet.
  subroutine write_files(model, wanted, state, monitor, memory, error)
    type(model_t), intent(in) :: model
    logical, intent(in) :: wanted(:)   !! numbered_file, running_file
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(implicit_memory_t), intent(inout) :: memory
    type(error_t), allocatable, intent(out) :: error

    if (any(wanted)) call cut_sections(model, memory%trial, state)
    call write_restarts(wanted, state, monitor, error, memory)
  end subroutine write_files

  !> Read it from a restart file; the first thing that is wrong is an error of the archive.
  subroutine read_memory(model, state, source, memory)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(archive_t), intent(inout) :: source
    type(implicit_memory_t), intent(inout) :: memory

    call start_trial(model, state, memory%trial)
    call source%part('driver', memory)
  end subroutine read_memory

  !> Read it into a memory that is set up from the deck, and close the file.
  subroutine take_up_memory(model, state, source, memory, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(archive_t), intent(inout) :: source
    type(implicit_memory_t), intent(inout) :: memory
    type(error_t), allocatable, intent(out) :: error

    call read_memory(model, state, source, memory)
    call close_restart(source, error)
    if (allocated(error)) return
    memory%step%old_force = net_force(memory%trial)
    ! The end may have come nearer while a whole step is under way.
    memory%control%target = min(memory%control%target, memory%control%end_time)
  end subroutine take_up_memory

end module implicit_memory_m
