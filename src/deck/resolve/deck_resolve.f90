! SPDX-License-Identifier: MIT
!> Raw deck to model: every id becomes an index, every set its nodes.
module deck_resolve_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use controls_m, only : interval_t, is_asked
  use deck_implicit_m, only : settle_scheme, check_scheme
  use history_tables_m, only : history_tables, n_table, table_nodout, table_elout, table_nodfor, &
    table_secforc
  use model_m, only : model_t
  use conditions_m, only : motion_acceleration
  use contacts_m, only : penalty_share, penalty_implicit
  use deck_cards_m, only : reject_field, warn_of_field
  use deck_implicit_penalty_m, only : check_implicit_penalties
  use deck_lines_m, only : deck_t, place_t, line_error, line_warning
  use deck_maps_m, only : maps_t, make_maps, resolve_id
  use deck_raw_m, only : raw_t, raw_contact_t, history_t, row_damping, row_motion_node, &
    row_motion_set, row_velocity, row_velocity_generation, output_plot
  use deck_resolve_mesh_m, only : resolve_parts, resolve_mesh, settle_points, check_unsound_mesh
  use deck_resolve_eos_m, only : resolve_equations, check_implicit_laws
  use deck_resolve_erosion_m, only : resolve_erosion, check_erosion_points, check_eroding_contacts
  use deck_resolve_hardenings_m, only : resolve_hardenings, check_no_rates, resolve_foams
  use deck_resolve_sets_m, only : resolve_sets, resolve_history
  use deck_resolve_conditions_m, only : resolve_conditions
  use deck_resolve_sections_m, only : resolve_cross_sections, resolve_transducers
  use deck_resolve_damping_m, only : resolve_damping, refuse_static, settle_relaxation
  use deck_resolve_rigids_m, only : resolve_rigids
  use deck_resolve_round_m, only : settle_form, settle_axis, mark_round_contacts, &
    check_loads_of_round, check_velocities_of_round
  use deck_resolve_velocity_m, only : resolve_velocity
  use deck_resolve_ends_m, only : resolve_ends
  use deck_resolve_contacts_m, only : resolve_contacts
  use deck_resolve_walls_m, only : resolve_walls
  implicit none
  private
  public :: resolve_model

contains

  !> What the implicit method asks of the rest of the deck.
  subroutine check_implicit(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    integer :: i

    do i = 1, size(model%parts)
      associate (part => model%parts(i))
        if (part%hourglass%quadratic > 0.0_wp .or. part%hourglass%linear > 0.0_wp) &
          call line_error(deck, raw%parts(i)%line, 'part '//to_text(part%id)//' has bulk ' &
          //'viscosity (*CONTROL_BULK_VISCOSITY or *HOURGLASS), which the implicit method ' &
          //'does not have')
      end associate
    end do
    call check_no_rates(deck, raw, model)
    call check_implicit_laws(deck, raw, model)
    do i = 1, raw%n_row
      associate (row => raw%rows(i))
        if (row%kind == row_damping) call refuse_static(deck, model, row%line, '*DAMPING_GLOBAL')
        if ((row%kind == row_motion_node .or. row%kind == row_motion_set) &
          .and. row%motion == motion_acceleration .and. .not. model%controls%implicit%is_dynamic) &
          call reject_field(deck, place_t(row%line, 1, 'VAD'), &
          'is an acceleration, which has no meaning in statics ' &
          //'(0 velocity or 2 displacement, or IMASS 1 of *CONTROL_IMPLICIT_DYNAMICS)')
      end associate
    end do
    do i = 1, deck%n_block
      if (deck%blocks(i)%name == 'CONTROL_TERMINATION' .and. raw%controls%dt_floor > 0.0_wp) &
        call line_warning(deck, deck%blocks(i)%keyword, 'implicit step floor', &
        'DTMIN has no effect with the implicit method; DTMIN of *CONTROL_IMPLICIT_AUTO is its ' &
        //'shortest step')
    end do
    do i = 1, size(raw%contacts)
      if (raw%contacts(i)%contact%damping > 0.0_wp) call line_warning(deck, &
        deck%blocks(raw%contacts(i)%block)%keyword, 'implicit contact damping', &
        'contact damping (VDC) has no effect with the implicit method')
      call check_penalty_unit(deck, raw%contacts(i))
    end do
    call warn_of_explicit(deck, raw)
  end subroutine check_implicit

  !> What the deck and its words give for an explicit run alone: one warning for each.
  subroutine warn_of_explicit(deck, raw)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    character(*), parameter :: no_effect = 'has no effect with the implicit method'
    integer :: i

    do i = 1, size(raw%explicit_only)
      call warn_of_field(deck, raw%explicit_only(i), no_effect)
    end do
    do i = 1, size(raw%contacts)
      if (raw%contacts(i)%contact%search_interval > 0) call warn_of_field(deck, &
        raw%contacts(i)%search_place, no_effect)
    end do
    if (raw%controls%implicit%is_dynamic) return
    do i = 1, raw%n_row
      if (all(raw%rows(i)%kind /= [row_velocity, row_velocity_generation])) cycle
      call line_warning(deck, raw%rows(i)%line, 'static velocity', &
        'an initial velocity has no effect in statics')
    end do
    if (raw%n_node_velocity > 0) call line_warning(deck, raw%node_velocities(1)%line, &
      'static velocity', 'an initial velocity has no effect in statics')
  end subroutine warn_of_explicit

  !> Automatic and implicit penalties are made for explicit steps.
  subroutine check_penalty_unit(deck, entry)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    character(:), allocatable :: reason

    select case (entry%contact%penalty_unit)
    case (penalty_share)
      reason = 'asks for a share of the largest stable penalty of an explicit step'
    case (penalty_implicit)
      reason = 'asks for the implicit springs of explicit steps'
    case default
      return
    end select
    call reject_field(deck, entry%unit_place, reason//', which the implicit method does not ' &
      //'have (0, 1 or 2)')
  end subroutine check_penalty_unit

  !> Fill the model.
  subroutine resolve_model(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(inout) :: raw
    type(model_t), intent(inout) :: model
    type(maps_t) :: maps
    logical, allocatable :: is_sound(:) !! (n_element)
    logical :: sound
    integer :: i

    call make_maps(deck, raw, maps)
    model%controls = raw%controls
    if (model%controls%implicit%is_on) call settle_scheme(raw%newmark, raw%hht, &
      raw%spectral_radius, model%controls%implicit)
    call check_scheme(deck, raw%newmark_line, model%controls%implicit)
    call resolve_parts(deck, raw, maps, model)
    call settle_form(deck, raw, model)
    call settle_points(deck, raw, model)
    call resolve_hardenings(deck, raw, maps, model)
    call resolve_foams(deck, raw, maps, model)
    call resolve_erosion(deck, raw, maps, model)
    call check_erosion_points(deck, raw, model)
    call resolve_equations(deck, raw, maps, model)
    call resolve_mesh(deck, raw, maps, model, is_sound, sound)
    call settle_axis(deck, raw, model)
    call resolve_sets(deck, raw, maps, model)
    call resolve_history(deck, raw, maps, model)
    if (size(raw%cuts) > 0) call resolve_cross_sections(deck, raw, maps, model)
    if (raw%dt_curve > 0) call resolve_id(deck, maps%curves, raw%dt_curve, 'curve', &
      raw%dt_curve_place, model%controls%dt_curve)
    if (model%controls%dt_curve > 0) then
      if (minval(model%curves(model%controls%dt_curve)%ordinate) <= 0.0_wp) call line_error(deck, &
        raw%curve_line(model%controls%dt_curve), 'curve '//to_text(raw%dt_curve) &
        //' caps the time step (LCTM) and must be above 0 everywhere')
    end if
    associate (output => model%controls%output)
      call take_interval(deck, maps, raw%outputs(output_plot), model, output%plot)
      do i = 1, n_table
        call take_interval(deck, maps, raw%outputs(i), model, output%histories(i))
      end do
    end associate
    call warn_of_empty(deck, raw, model)
    if (model%controls%implicit%is_on) call check_implicit(deck, raw, model)
    call resolve_conditions(deck, raw, maps, model)
    call resolve_rigids(deck, raw, maps, model)
    call resolve_damping(deck, raw, maps, model)
    call settle_relaxation(deck, raw, model)
    call resolve_velocity(deck, raw, maps, model)
    call check_loads_of_round(deck, raw, model)
    call check_velocities_of_round(deck, raw, model)
    call resolve_walls(deck, raw, maps, model)
    allocate (model%mesh%deck_node(model%mesh%n_node))
    model%mesh%deck_node = [(i, i=1, model%mesh%n_node)]
    if (sound) then
      call resolve_contacts(deck, raw, maps, model)
      call check_eroding_contacts(deck, raw, model)
      call resolve_transducers(deck, raw, maps, model)
      if (model%is_round) call mark_round_contacts(model)
    else
      call check_unsound_mesh(deck, raw, maps, is_sound, model)
    end if
    call check_implicit_penalties(deck, raw, model, sound)
    call resolve_ends(deck, raw, maps, model, sound)
  end subroutine resolve_model

  !> Histories that are asked for and have no file, for want of a keyword that says of what.
  subroutine warn_of_empty(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model

    call look_at(table_nodout, raw%history_nodes%n + raw%history_node_sets%n, 'HISTORY_NODE')
    call look_at(table_elout, raw%history_shells%n + raw%history_shell_sets%n, 'HISTORY_SHELL')
    call look_at(table_nodfor, raw%force_groups%n, 'NODAL_FORCE_GROUP')
    call look_at(table_secforc, size(raw%cuts), 'CROSS_SECTION_SET')

  contains

    !> One file.
    subroutine look_at(table, n, needed)
      integer, intent(in) :: table
      integer, intent(in) :: n           !! what it would tell of
      character(*), intent(in) :: needed !! end of the keyword

      if (n > 0 .or. deck%incomplete .or. .not. is_asked(model%controls%output%histories(table))) &
        return
      call line_warning(deck, raw%outputs(table)%place%line, 'empty '//history_tables(table)%name, &
        'asks for a history and the deck has no *DATABASE_'//needed//': no file is written')
    end subroutine look_at

  end subroutine warn_of_empty

  !> Interval of one output file.
  subroutine take_interval(deck, maps, history, model, interval)
    type(deck_t), intent(inout) :: deck
    type(maps_t), intent(in) :: maps
    type(history_t), intent(in) :: history
    type(model_t), intent(in) :: model
    type(interval_t), intent(out) :: interval

    interval%dt = history%dt
    interval%is_text = history%is_text
    interval%is_binout = history%is_binout
    if (history%n_state > 0) interval%dt = model%controls%end_time/real(history%n_state, wp)
    if (history%curve == 0) return
    call resolve_id(deck, maps%curves, history%curve, 'curve', history%place, interval%curve)
    if (interval%curve == 0) return
    if (.not. minval(model%curves(interval%curve)%ordinate) > 0.0_wp) call line_error(deck, &
      history%place%line, 'curve '//to_text(history%curve) &
      //' is an output interval and must be above 0 everywhere')
  end subroutine take_interval

end module deck_resolve_m
