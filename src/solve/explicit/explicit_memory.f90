! SPDX-License-Identifier: MIT
!> What the explicit driver remembers from cycle to cycle besides the state, in a restart file.
module explicit_memory_m
  use archive_m, only : keep, keep_fixed, keep_same, expect
  use archive_file_m, only : archive_t, enter, leave
  use clock_m, only : lap, phase_nodes, phase_output
  use contact_step_limit_m, only : spring_bound_t
  use errors_m, only : error_t
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use monitor_m, only : monitor_t
  use restart_file_m, only : close_restart
  use restart_m, only : begin_file, end_file
  use state_m, only : state_t
  use time_step_m, only : step_plan_t, cycles_in, has_springs
  implicit none
  private
  public :: write_restarts, check_steps, take_up_steps

contains

  !> Write restart files between two cycles.
  subroutine write_restarts(wanted, state, monitor, steps, damping, ratio, error)
    logical, intent(in) :: wanted(:)        !! numbered_file, running_file
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(step_plan_t), intent(inout) :: steps
    real(wp), intent(inout) :: damping(2)   !! D per direction of the last cycle
    real(wp), intent(inout) :: ratio        !! last energy ratio known
    type(error_t), allocatable, intent(out) :: error
    type(archive_t) :: archive
    integer :: kind

    if (.not. any(wanted)) return
    call lap(monitor%clock, phase_nodes)
    do kind = 1, size(wanted)
      if (.not. wanted(kind) .or. allocated(error)) cycle
      call begin_file(kind, state, monitor, archive)
      call keep_steps(archive, size(state%motion, 2), state%cycle, steps, damping, ratio)
      call end_file(kind, state, monitor, archive, error)
    end do
    call lap(monitor%clock, phase_output)
  end subroutine write_restarts

  !> The plan of the steps, and what a cycle hands to the next besides the state.
  subroutine keep_steps(archive, n_node, cycle, steps, damping, ratio)
    type(archive_t), intent(inout) :: archive
    integer, intent(in) :: n_node
    integer, intent(in) :: cycle  !! of the state
    type(step_plan_t), intent(inout) :: steps
    real(wp), intent(inout) :: damping(2)
    real(wp), intent(inout) :: ratio

    call enter(archive, 'steps')
    call keep(archive, 'first_dt', steps%first_dt)
    call keep(archive, 'constant', steps%constant)
    call keep(archive, 'start_time', steps%start_time)
    call keep(archive, 'start_cycle', steps%start_cycle)
    call keep(archive, 'n_cycle', steps%n_cycle)
    call keep(archive, 'end_cycle', steps%end_cycle)
    call keep(archive, 'end_time', steps%end_time)
    call keep(archive, 'warned', steps%warned)
    call keep(archive, 'warned_approach', steps%warned_approach)
    call keep_springs(archive, 'springs', n_node, steps%springs)
    call expect(archive, 'first_dt', steps%first_dt > 0.0_wp, 'a step that is not positive')
    call expect(archive, 'constant', steps%constant >= 0.0_wp, 'a step below zero')
    call expect(archive, 'start_cycle', steps%start_cycle >= 0, 'a cycle below zero')
    call expect(archive, 'start_cycle', steps%start_cycle <= cycle, 'a cycle after the present one')
    call keep_fixed(archive, 'damping', damping)
    call keep(archive, 'ratio', ratio)
    call leave(archive)
  end subroutine keep_steps

  !> Bounds of the contact springs.
  subroutine keep_springs(archive, name, n_node, springs)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, intent(in) :: n_node   !! nodes of the mesh
    type(spring_bound_t), allocatable, intent(inout) :: springs(:)
    integer :: i, n

    n = -1
    if (allocated(springs)) n = size(springs)
    call enter(archive, name)
    call keep_same(archive, 'n', n)
    do i = 1, n
      call enter(archive, to_text(i))
      call keep(archive, 'rate', springs(i)%rate)
      call keep(archive, 'damping', springs(i)%damping)
      call keep(archive, 'node', springs(i)%node)
      call keep(archive, 'closed_rate', springs(i)%closed_rate)
      call expect(archive, 'node', springs(i)%node >= 0 .and. springs(i)%node <= n_node, &
        'a number that no node has')
      call leave(archive)
    end do
    call leave(archive)
  end subroutine keep_springs

  !> Whether the plan of the steps can be taken up; the first thing that is wrong is told as an
  !> error of the archive.
  subroutine check_steps(model, state, source)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(archive_t), intent(inout) :: source
    type(step_plan_t) :: steps
    real(wp) :: damping(2), ratio

    damping = 0.0_wp
    ratio = 1.0_wp
    call read_steps(model, state, source, steps, damping, ratio)
  end subroutine check_steps

  !> Read the plan of the steps into one that is set up from the deck.
  subroutine read_steps(model, state, source, steps, damping, ratio)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(archive_t), intent(inout) :: source
    type(step_plan_t), intent(inout) :: steps
    real(wp), intent(inout) :: damping(2)
    real(wp), intent(inout) :: ratio

    if (has_springs(model, state%contacts)) &
      allocate (steps%springs(size(model%contacts)))
    call keep_steps(source, size(state%motion, 2), state%cycle, steps, damping, ratio)
  end subroutine read_steps

  !> Read the plan of the steps, with the end that the deck gives now, and close the file.
  subroutine take_up_steps(model, state, source, steps, damping, ratio, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(archive_t), intent(inout) :: source
    type(step_plan_t), intent(inout) :: steps
    real(wp), intent(inout) :: damping(2)
    real(wp), intent(inout) :: ratio
    type(error_t), allocatable, intent(out) :: error

    call read_steps(model, state, source, steps, damping, ratio)
    steps%end_time = model%controls%end_time
    steps%end_cycle = model%controls%end_cycle
    if (steps%constant > 0.0_wp) steps%n_cycle = &
      cycles_in(steps%end_time - steps%start_time, steps%constant)
    call close_restart(source, error)
  end subroutine take_up_steps

end module explicit_memory_m
