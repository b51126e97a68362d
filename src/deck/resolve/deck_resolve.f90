! SPDX-License-Identifier: MIT
!> Raw deck to model: every id becomes an index, every set its nodes.
module deck_resolve_m
  use kinds_m, only : wp, long
  use log_m, only : to_text
  use sorting_m, only : sorted_order
  use controls_m, only : interval_t, is_asked
  use deck_implicit_m, only : settle_scheme, check_scheme
  use history_tables_m, only : history_tables, n_table, table_nodout, table_elout, table_nodfor, &
    table_secforc
  use model_m, only : model_t
  use contacts_m, only : is_tied, penalty_share, penalty_implicit
  use deck_cards_m, only : reject_field, warn_of_field
  use eos_m, only : eos_t
  use hardenings_m, only : depends_on_rate
  use deck_curves_m, only : table_t, read_curves, read_systems
  use deck_erosion_m, only : read_erosions
  use deck_material_m, only : read_materials, read_equations, settle_pressures
  use deck_part_m, only : read_parts, read_sections, make_rigids
  use deck_damping_m, only : read_damping
  use deck_ids_m, only : a_part, a_material, a_curve
  use deck_ends_m, only : read_ends
  use deck_mesh_m, only : read_mesh
  use deck_sections_m, only : read_cross_sections
  use deck_sets_m, only : read_sets, read_histories
  use deck_resolve_transducers_m, only : resolve_transducers
  use deck_unsound_m, only : check_unsound_mesh
  use deck_lines_m, only : deck_t, blocks_of, line_error, line_warning
  use deck_loads_m, only : read_nodal_loads, read_rigid_loads, read_body_loads, read_pressures, &
    read_masses, warn_of_bores
  use deck_raw_m, only : raw_t, raw_contact_t, history_t, output_plot
  use deck_resolve_contacts_m, only : resolve_contacts, check_implicit_penalties
  use deck_supports_m, only : read_supports, read_motions, read_common_motions
  use deck_velocity_m, only : read_velocities
  use deck_wall_m, only : read_walls
  use deck_values_m, only : resolve_id, refuse_again
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
          call line_error(deck, deck%maps(a_part)%lines(i), 'part '//to_text(part%id)//' has ' &
          //'bulk viscosity (*CONTROL_BULK_VISCOSITY or *HOURGLASS), which the implicit method ' &
          //'does not have')
      end associate
    end do
    call check_implicit_laws(deck, model)
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

  !> Laws with rates, heat, energy or failure have no tangent.
  subroutine check_implicit_laws(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    character(:), allocatable :: reason
    integer :: i

    do i = 1, size(model%materials)
      associate (material => model%materials(i))
        reason = ''
        if (allocated(material%flow)) then
          reason = 'a flow stress of Johnson and Cook'
        else if (material%failure_strain < huge(1.0_wp)) then
          reason = 'a plastic strain at failure'
        else if (allocated(material%crush)) then
          reason = 'the law of a crushable foam'
        else if ((allocated(material%eos) .or. material%needs_eos) .and. .not. &
          allocated(material%rubber)) then
          reason = 'an equation of state'
        end if
        if (len(reason) > 0) call refuse(reason)
        if (.not. allocated(material%curve)) cycle
        if (depends_on_rate(material%curve)) call refuse( &
          'a yield stress that depends on the strain rate (C, LCSR or a table)')
      end associate
    end do

  contains

    !> One error.
    subroutine refuse(what)
      character(*), intent(in) :: what

      call line_error(deck, deck%maps(a_material)%lines(i), 'material ' &
        //to_text(model%materials(i)%id)//' has '//what &
        //', which the implicit method does not have')
    end subroutine refuse

  end subroutine check_implicit_laws

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
    type(table_t), allocatable :: tables(:)
    type(eos_t), allocatable :: equations(:)
    logical, allocatable :: is_sound(:), fixed(:, :) !! (n_element), (2, n_node)
    integer, allocatable :: codes(:), owner(:)
    logical :: sound
    integer :: i

    call check_numbers(deck, raw)
    model%controls = raw%controls
    if (model%controls%implicit%is_on) call settle_scheme(raw%newmark, raw%hht, &
      raw%spectral_radius, model%controls%implicit)
    call check_scheme(deck, raw%newmark_line, model%controls%implicit)
    call read_curves(deck, model, tables)
    call read_systems(deck)
    call read_materials(deck, tables, model)
    call read_equations(deck, equations)
    call read_sections(deck, model)
    call read_parts(deck, raw%hourglass_default, equations, model)
    call read_erosions(deck, raw%erodes_by_step, raw%step_line, model)
    call settle_pressures(deck, equations, model)
    call read_mesh(deck, model, codes, is_sound, sound)
    call read_sets(deck, model, raw%is_whole)
    call read_histories(deck, model)
    call read_cross_sections(deck, model)
    call settle_step_curve(deck, raw, model)
    associate (output => model%controls%output)
      call take_interval(deck, raw%outputs(output_plot), model, output%plot)
      do i = 1, n_table
        call take_interval(deck, raw%outputs(i), model, output%histories(i))
      end do
    end associate
    call warn_of_empty(deck, raw, model)
    if (model%controls%implicit%is_on) call check_implicit(deck, raw, model)
    call make_rigids(deck, model, owner)
    call read_supports(deck, codes, owner, model, fixed)
    call read_motions(deck, owner, fixed, model)
    call read_nodal_loads(deck, model)
    call read_rigid_loads(deck, model)
    call read_body_loads(deck, model)
    call read_pressures(deck, model, raw%pressure_places)
    call read_masses(deck, model)
    call read_common_motions(deck, model)
    call read_damping(deck, model)
    call read_velocities(deck, model)
    call read_walls(deck, model)
    call warn_of_bores(deck, model)
    call settle_relaxation(deck, raw, model)
    allocate (model%mesh%deck_node(model%mesh%n_node))
    model%mesh%deck_node = [(i, i=1, model%mesh%n_node)]
    if (sound) then
      call resolve_contacts(deck, raw, model)
      call check_eroding_contacts(deck, raw, model)
      call resolve_transducers(deck, raw, model)
      if (model%is_round) call mark_round_contacts(model)
    else
      call check_unsound_mesh(deck, raw, is_sound, model)
    end if
    call check_implicit_penalties(deck, raw, model, sound)
    call read_ends(deck, model, sound)
  end subroutine resolve_model

  !> The curve that caps the time step.
  subroutine settle_step_curve(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model

    if (raw%dt_curve < 1) return
    associate (k => model%controls%dt_curve)
      call resolve_id(deck, a_curve, raw%dt_curve, raw%dt_curve_place, k)
      if (k == 0) return
      if (minval(model%curves(k)%ordinate) <= 0.0_wp) call line_error(deck, &
        deck%maps(a_curve)%lines(k), 'curve '//to_text(raw%dt_curve) &
        //' caps the time step (LCTM) and must be above 0 everywhere')
    end associate
  end subroutine settle_step_curve

  !> Numbers of interfaces and transducers are those of one thing each.
  subroutine check_numbers(deck, raw)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    character(*), parameter :: position = ' (without a number it is the position in the deck)'
    integer, allocatable :: ids(:), lines(:), order(:)

    ids = [raw%contacts%contact%id, raw%transducers%contact%id]
    lines = deck%blocks([raw%contacts%block, raw%transducers%block])%keyword
    order = sorted_order(int(lines, long))
    call refuse_again(deck, [ids(order)], [lines(order)], 'interface number ', &
      'interface'//position)
  end subroutine check_numbers

  !> Whether the run begins with dynamic relaxation, and what may not be in it.
  subroutine settle_relaxation(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model
    integer :: i, line

    associate (relaxation => model%controls%relaxation, conditions => model%conditions)
      do i = 1, size(model%curves)
        if (model%curves(i)%phase > 0 .and. .not. raw%never_relaxes) relaxation%is_on = .true.
      end do
      if (.not. relaxation%is_on) return
      line = raw%relaxation_line
      if (line == 0) line = deck%maps(a_curve)%lines(findloc(model%curves%phase > 0, .true., &
        dim=1))
      if (model%controls%implicit%is_on) call refuse('with the implicit method')
      if (size(raw%contacts) > 0) call refuse('with contact')
      if (model%erodes) call refuse('with elements that may leave the mesh')
      if (allocated(model%walls)) call refuse('with rigid walls')
      if (size(model%rigids) > 0) call refuse('with rigid bodies')
      if (size(conditions%motions) > 0) call refuse('with prescribed motion')
      if (allocated(conditions%common_motions)) call refuse('with *CONSTRAINED_NODE_SET')
    end associate

  contains

    !> One error.
    subroutine refuse(what)
      character(*), intent(in) :: what

      call line_error(deck, line, 'asks for dynamic relaxation '//what &
        //', which this version does not have')
    end subroutine refuse

  end subroutine settle_relaxation

  !> Contacts of an axisymmetric deck know it, and which of their nodes are on the axis.
  pure subroutine mark_round_contacts(model)
    type(model_t), intent(inout) :: model
    integer :: i

    model%contacts%is_round = .true.
    do i = 1, size(model%contacts)
      associate (slave => model%contacts(i)%slave, master => model%contacts(i)%master, &
        radii => model%mesh%coordinates(1, :))
        slave%is_on_axis = .not. radii(slave%nodes) > 0.0_wp
        master%is_on_axis = .not. radii(master%nodes) > 0.0_wp
      end associate
    end do
  end subroutine mark_round_contacts

  !> Ties and initial overlaps do not follow surfaces that change.
  subroutine check_eroding_contacts(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    logical :: may_go(size(model%materials))
    integer :: i, m

    if (.not. model%erodes) return
    do m = 1, size(model%materials)
      may_go(m) = allocated(model%materials(m)%erosion)
    end do
    do i = 1, size(raw%contacts)
      associate (contact => model%contacts(i))
        if (.not. (is_tied(contact) .or. allocated(contact%interference))) cycle
        if (.not. (touches(contact%slave%segment_element) &
          .or. touches(contact%master%segment_element))) cycle
        call line_error(deck, deck%blocks(raw%contacts(i)%block)%keyword, trim(merge( &
          'ties                  ', 'has an overlap (LCINT)', is_tied(contact)))//' on elements ' &
          //'that may leave the mesh, which this version does not have')
      end associate
    end do

  contains

    !> Whether some of the elements may leave.
    pure function touches(elements)
      integer, intent(in) :: elements(:)
      logical :: touches

      touches = any(may_go(model%parts(model%mesh%element_part(elements))%material))
    end function touches

  end subroutine check_eroding_contacts

  !> Histories that are asked for and have no file, for want of a keyword that says of what.
  subroutine warn_of_empty(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model

    call look_at(table_nodout, 'HISTORY_NODE')
    call look_at(table_elout, 'HISTORY_SHELL')
    call look_at(table_nodfor, 'NODAL_FORCE_GROUP')
    call look_at(table_secforc, 'CROSS_SECTION_SET')

  contains

    !> One file.
    subroutine look_at(table, needed)
      integer, intent(in) :: table
      character(*), intent(in) :: needed !! end of the keyword

      if (size(blocks_of(deck, 'DATABASE_'//needed)) > 0 .or. deck%incomplete) return
      if (.not. is_asked(model%controls%output%histories(table))) return
      call line_warning(deck, raw%outputs(table)%place%line, 'empty '//history_tables(table)%name, &
        'asks for a history and the deck has no *DATABASE_'//needed//': no file is written')
    end subroutine look_at

  end subroutine warn_of_empty

  !> Interval of one output file.
  subroutine take_interval(deck, history, model, interval)
    type(deck_t), intent(inout) :: deck
    type(history_t), intent(in) :: history
    type(model_t), intent(in) :: model
    type(interval_t), intent(out) :: interval

    interval%dt = history%dt
    interval%is_text = history%is_text
    interval%is_binout = history%is_binout
    if (history%n_state > 0) interval%dt = model%controls%end_time/real(history%n_state, wp)
    if (history%curve == 0) return
    call resolve_id(deck, a_curve, history%curve, history%place, interval%curve)
    if (interval%curve == 0) return
    if (.not. minval(model%curves(interval%curve)%ordinate) > 0.0_wp) call line_error(deck, &
      history%place%line, 'curve '//to_text(history%curve) &
      //' is an output interval and must be above 0 everywhere')
  end subroutine take_interval

end module deck_resolve_m
