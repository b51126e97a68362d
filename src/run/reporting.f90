! SPDX-License-Identifier: MIT
!> What is due of an instant: the part of it that both drivers do.
module reporting_m
  use contact_judging_m, only : judge_contacts, follow_softness
  use snapshot_m, only : total_energy
  use errors_m, only : error_t
  use history_filling_m, only : fill_boundaries, fill_history_elements, fill_sections
  use history_tables_m, only : table_rcforc, table_sleout, table_contact, table_elout, &
    table_bndout, table_nodfor, table_secforc
  use kinds_m, only : wp
  use model_m, only : model_t
  use monitor_m, only : monitor_t, due_t, write_due
  use progress_m, only : show_progress
  use snapshot_filling_m, only : fill_interfaces, fill_plot
  use state_m, only : state_t
  implicit none
  private
  public :: note_energies, write_instant

contains

  !> Energies of the snapshot are known: those at time zero are the initial ones; contact springs
  !> beside the bodies.
  subroutine note_energies(model, knows_parts, state, monitor)
    type(model_t), intent(in) :: model
    logical, intent(in) :: knows_parts !! internal energies of parts too
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor

    if (state%cycle == 0) then
      state%initial_energy = total_energy(monitor%snapshot%energies)
      monitor%snapshot%energies%initial = state%initial_energy
    end if
    if (knows_parts) call follow_softness(model, monitor%snapshot%parts, monitor%bodies, state)
  end subroutine note_energies

  !> Fill the rest of a snapshot, of which the driver has filled what it has its own way with, and
  !> write what is due of it.
  subroutine write_instant(model, due, dt, ratio, state, monitor, error)
    type(model_t), intent(in) :: model
    type(due_t), intent(in) :: due
    real(wp), intent(in) :: dt    !! reach of the outputs, s
    real(wp), intent(in) :: ratio !! last energy ratio known
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(inout) :: error

    associate (shot => monitor%snapshot)
      if (any(due%tables([table_rcforc, table_sleout, table_contact]))) &
        call fill_interfaces(model, state, shot)
      if (due%tables(table_elout)) call fill_history_elements(model, state, shot)
      if (any(due%tables([table_bndout, table_nodfor]))) call fill_boundaries(state, shot)
      if (due%tables(table_secforc)) call fill_sections(model, state, shot)
      if (due%plot) call fill_plot(model, state, shot)
      if (any(due%tables([table_sleout, table_contact]))) &
        call judge_contacts(model, state, due%plot, monitor%rows, shot)
    end associate
    call write_due(model, due, dt, monitor, error)
    if (due%plot .and. .not. allocated(error)) call show_progress(monitor%progress, monitor%clock, &
      state%cycle, state%time, state%dt, ratio, 'write vtkhdf state')
  end subroutine write_instant

end module reporting_m
