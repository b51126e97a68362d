! SPDX-License-Identifier: MIT
!> Central differences in leap-frog form: v lives at half steps. One parallel region spans the whole
!> run. A cycle has three parts with a barrier after each: elements, tile by tile, whose interior
!> nodes move at once; special nodes; the end of the cycle with contact and loads on the special
!> nodes for the next cycle (one thread). A cycle that writes stores the forces and moves the nodes
!> after writing, so that the output belongs to one instant.
module explicit_m
  use clock_m, only : lap, phase_elements, phase_nodes, phase_output
  use explicit_contact_m, only : report_contact_energies, add_implicit_penalties
  use contact_reports_m, only : report_contact_end
  use element_dispatch_m, only : add_tile_forces, scatter_tile_forces, store_tile_forces, &
    sum_special_forces
  use eroding_tiles_m, only : add_eroding_tile_forces
  use element_erosion_m, only : report_erosion, report_failures
  use errors_m, only : error_t
  use explicit_cycle_m, only : explicit_cycle_t, start_cycles, begin_cycle, exchange_tiles, &
    end_cycle
  use explicit_report_m, only : report_cycle
  use hanging_nodes_m, only : add_hanging_forces
  use health_m, only : check_tile, warn_of_energies, energy_unaccounted
  use kinds_m, only : wp
  use mass_scaling_m, only : refine_limits
  use model_m, only : model_t
  use load_work_m, only : sum_motion
  use monitor_m, only : monitor_t
  use node_motion_m, only : leap_t, move_tile_nodes, move_special_nodes, move_damped_nodes
  use rank_exchange_m, only : report_exchange
  use ranks_m, only : share_error
  use quiescent_tiles_m, only : tile_active, tile_translating, save_tile, test_tile, &
    check_translation, report_tile_states
  use node_constraints_m, only : apply_skew_supports, apply_walls
  use state_m, only : state_t
  implicit none
  private
  public :: advance_explicit

contains

  !> Advance from the initial state to the end of the run.
  subroutine advance_explicit(model, n_thread, state, monitor, reason, error)
    type(model_t), intent(in) :: model
    integer, intent(in) :: n_thread
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    character(:), allocatable, intent(out) :: reason  !! reason of the end
    type(error_t), allocatable, intent(out) :: error  !! fault that ended the run, if any
    type(explicit_cycle_t) :: cycle

    call start_cycles(model, state, monitor, cycle)
    call share_error(monitor%ranks, cycle%error)
    if (allocated(cycle%error)) then
      reason = cycle%error%message
      call move_alloc(cycle%error, error)
      return
    end if
    if (n_thread == 1) then
      ! No parallel region: in a team of one every barrier is still a system call.
      call run_cycles(model, state, monitor, cycle)
    else
      !$omp parallel num_threads(n_thread) default(none) shared(model, state, monitor, cycle)
      call run_cycles(model, state, monitor, cycle)
      !$omp end parallel
    end if
    reason = cycle%reason
    if (allocated(cycle%error)) call move_alloc(cycle%error, error)
    call report_contact_end(model, state, monitor%log)
    call report_contact_energies(model, state, monitor%log)
    call report_failures(model, state, cycle%failures, monitor%log)
    if (model%erodes) call report_erosion(model, state, monitor%log)
    if (monitor%ranks%n > 1) call report_exchange(cycle%halo, monitor%ranks, monitor%log)
    call report_tile_states(monitor%ranks, cycle%tile_states, monitor%log)
    if (allocated(error)) return
    call warn_of_energies(monitor%snapshot%energies, 0.0_wp, energy_unaccounted, monitor%log)
  end subroutine advance_explicit

  !> Run the cycles, in every thread of the team. The end of a cycle and the beginning of the next
  !> are one serial section, after which `cycle` belongs to the next cycle; values that other
  !> threads still need are copied before.
  subroutine run_cycles(model, state, monitor, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(explicit_cycle_t), intent(inout) :: cycle
    real(wp), allocatable :: force(:, :)
    logical :: writes

    allocate (force(2, model%layout%n_local))
    !$omp master
    call begin_cycle(model, state, monitor, cycle)
    !$omp end master
    !$omp barrier
    do
      writes = cycle%writes
      call advance_tiles(model, state, cycle, force)
      !$omp master
      call lap(monitor%clock, phase_elements)
      if (monitor%ranks%n > 1) call exchange_tiles(model, state, monitor, cycle)
      !$omp end master
      if (monitor%ranks%n > 1) then
        !$omp barrier
      end if
      if (cycle%has_pressures) call solve_pressures(model, state, monitor, cycle)
      call advance_special_nodes(model, state, cycle)
      if (writes) then
        !$omp master
        call lap(monitor%clock, phase_nodes)
        call report_cycle(model, state, monitor, cycle)
        call lap(monitor%clock, phase_output)
        !$omp end master
        !$omp barrier
        if (.not. cycle%finished) call move_all_nodes(model, state, cycle)
      end if
      !$omp master
      call end_cycle(model, state, monitor, cycle)
      if (.not. cycle%finished) call begin_cycle(model, state, monitor, cycle)
      !$omp end master
      !$omp barrier
      if (cycle%finished) exit
    end do
  end subroutine run_cycles

  !> Element forces; interior nodes move at once unless this cycle writes. Quiescent tiles come
  !> before the others, so that the team shares each kind evenly.
  subroutine advance_tiles(model, state, cycle, force)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(explicit_cycle_t), intent(inout) :: cycle
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, n_local) private to this thread
    integer :: i, i_tile

    if (allocated(cycle%sums%parts)) then
      ! Nodes of blocks do not move here, so no barrier is needed.
      !$omp do schedule(static)
      do i = cycle%sums%first, size(cycle%sums%blocks, 2)
        if (i > cycle%sums%last .and. i <= cycle%sums%n_special) cycle
        call sum_motion(cycle%sums%blocks(1, i), cycle%sums%blocks(2, i), state, &
          cycle%sums%parts(:, size(model%layout%tiles) + i))
      end do
      !$omp end do nowait
    end if
    if (size(cycle%tile_states%monitored) > 0) then
      !$omp do schedule(static)
      do i = 1, size(cycle%tile_states%monitored)
        i_tile = cycle%tile_states%monitored(i)
        call check_translation(model%layout, i_tile, state%motion, cycle%tile_states)
        if (cycle%tile_states%status(i_tile) < tile_active) then
          associate (tile => model%layout%tiles(i_tile))
            if (allocated(cycle%sums%parts)) call sum_motion(tile%first_node, tile%last_node, &
              state, cycle%sums%parts(:, i_tile))
            if (cycle%tile_states%status(i_tile) == tile_translating .and. .not. cycle%writes) &
              call move_tile_nodes(cycle%leap, tile%first_node, tile%last_node, &
              cycle%tile_states%zero_force, state%inverse_mass, state%motion)
          end associate
        else
          call step_tile(model, i_tile, state, cycle, force)
        end if
      end do
      !$omp end do nowait
    end if
    !$omp do schedule(static)
    do i = 1, size(cycle%tile_states%stepped)
      call step_tile(model, cycle%tile_states%stepped(i), state, cycle, force)
    end do
    !$omp end do
  end subroutine advance_tiles

  !> Advance the elements of one tile.
  subroutine step_tile(model, i_tile, state, cycle, force)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_tile
    type(state_t), intent(inout) :: state
    type(explicit_cycle_t), intent(inout) :: cycle
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, n_local)
    real(wp), allocatable :: before(:) !! element values before the step, where the tile may become
                                       !! quiescent

    associate (tile => model%layout%tiles(i_tile))
      if (cycle%tile_states%status(i_tile) > tile_active) &
        call save_tile(model, i_tile, state, cycle%tile_states, before)
      if (model%erodes) then
        call add_eroding_tile_forces(model, tile, state%motion, [state%time, state%dt_before], &
          state%elements, force)
      else
        call add_tile_forces(model, tile, state%motion, state%dt_before, state%elements, force)
      end if
      if (cycle%refines) call refine_limits(model, tile, state%motion, state%dt_before, &
        state%elements)
      cycle%checks(i_tile) = check_tile(tile, state%elements)
      call scatter_tile_forces(tile, force, state%force_slots)
      if (allocated(before)) call test_tile(model, i_tile, before, force, state, cycle%tile_states)
      if (allocated(cycle%sums%parts)) call sum_motion(tile%first_node, tile%last_node, state, &
        cycle%sums%parts(:, i_tile))
      if (cycle%writes) then
        call store_tile_forces(tile, force, state%internal_force)
      else if (allocated(state%node_damping)) then
        call move_damped_nodes(cycle%leap, 0, tile%first_node, tile%last_node, force, state)
      else
        call move_tile_nodes(cycle%leap, tile%first_node, tile%last_node, force, &
          state%inverse_mass, state%motion)
      end if
    end associate
  end subroutine step_tile

  !> Forces of implicit penalties, after all other forces.
  subroutine solve_pressures(model, state, monitor, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(explicit_cycle_t), intent(inout) :: cycle
    integer :: i

    !$omp do schedule(static)
    do i = 1, size(cycle%tile_states%summed)
      associate (run => cycle%partition%runs(:, cycle%tile_states%summed(i)))
        call sum_special_forces(model%layout, state%force_slots, run(1), run(2), &
          state%internal_force)
        call add_hanging_forces(model%mesh, model%layout, state%force_slots, &
          state%force_special, run, state%internal_force)
      end associate
    end do
    !$omp end do
    !$omp master
    ! The step of cycle zero is not known yet.
    if (state%cycle > 0 .or. cycle%leap%dt > 0.0_wp) call add_implicit_penalties(model, &
      cycle%leap, cycle%damping, cycle%velocity, monitor%clock, monitor%log, state, &
      cycle%pressure_steps)
    !$omp end master
    !$omp barrier
  end subroutine solve_pressures

  !> Sum the forces of special nodes, unless the implicit penalties did, and move them unless this
  !> cycle writes. Each thread has the nodes of its own tiles, whose forces it has mostly written
  !> itself.
  subroutine advance_special_nodes(model, state, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(explicit_cycle_t), intent(in) :: cycle
    integer :: i

    !$omp do schedule(static)
    do i = 1, size(cycle%tile_states%summed)
      associate (first => cycle%partition%runs(1, cycle%tile_states%summed(i)), &
        last => cycle%partition%runs(2, cycle%tile_states%summed(i)))
        if (.not. cycle%has_pressures) then
          call sum_special_forces(model%layout, state%force_slots, first, last, &
            state%internal_force)
          call add_hanging_forces(model%mesh, model%layout, state%force_slots, &
            state%force_special, [first, last], state%internal_force)
        end if
        if (.not. cycle%writes) then
          if (allocated(state%walls)) call apply_walls(model, cycle%leap, first, last, state)
          if (allocated(model%conditions%skew_supports)) call apply_skew_supports(model, &
            cycle%leap, first, last, state)
          call move_run(model, cycle%leap, first, last, state)
        end if
      end associate
    end do
    !$omp end do
  end subroutine advance_special_nodes

  !> Move the special nodes first .. last; their internal forces are in the nodal array.
  subroutine move_run(model, leap, first, last, state)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    integer, intent(in) :: first, last
    type(state_t), intent(inout) :: state

    if (allocated(state%node_damping)) then
      if (last >= first) call move_damped_nodes(leap, model%layout%n_special, first, last, &
        state%internal_force(:, first:last), state)
    else
      call move_special_nodes(leap, first, last, state)
    end if
  end subroutine move_run

  !> Move all nodes after a cycle that wrote.
  subroutine move_all_nodes(model, state, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(explicit_cycle_t), intent(in) :: cycle
    integer :: i

    !$omp do schedule(static)
    do i = cycle%partition%first_tile, cycle%partition%last_tile
      associate (tile => model%layout%tiles(i))
        if (allocated(state%node_damping)) then
          call move_run(model, cycle%leap, tile%first_node, tile%last_node, state)
        else if (tile%last_node >= tile%first_node) then
          call move_tile_nodes(cycle%leap, tile%first_node, tile%last_node, &
            state%internal_force(1, tile%first_node), state%inverse_mass, state%motion)
        end if
      end associate
    end do
    !$omp end do
    !$omp do schedule(static)
    do i = 1, size(cycle%tile_states%summed)
      associate (run => cycle%partition%runs(:, cycle%tile_states%summed(i)))
        call move_run(model, cycle%leap, run(1), run(2), state)
      end associate
    end do
    !$omp end do
  end subroutine move_all_nodes

end module explicit_m
