! SPDX-License-Identifier: MIT
!> Reads a deck into a model.
!>
!> The file is split into keyword blocks, parameters are read, then each family of keywords in an
!> order in which its references are known. All errors are collected and returned as one, in deck
!> order.
module deck_m
  use errors_m, only : error_t, raise, status_input
  use log_m, only : log_t, write_log
  use contacts_m, only : contact_kind_t
  use model_m, only : model_t
  use eos_m, only : eos_t
  use parts_m, only : hourglass_t
  use deck_boxes_m, only : read_boxes
  use deck_contact_sides_m, only : mesh_boundary_t
  use deck_contacts_m, only : read_contacts
  use deck_control_m, only : read_controls, read_outputs, read_relaxation, read_ends
  use deck_curves_m, only : table_t, read_curves, read_systems
  use deck_erosion_m, only : read_erosions
  use deck_functions_m, only : check_functions
  use deck_hanging_m, only : read_hanging_nodes, check_hanging_nodes
  use deck_implicit_m, only : read_implicit, check_implicit
  use deck_inertia_m, only : inertia_t, set_inertias
  use deck_loads_m, only : read_nodal_loads, read_rigid_loads, read_body_loads, read_pressures, &
    read_masses, read_global_damping, read_mass_damping, read_stiffness_damping, warn_of_bores
  use deck_material_m, only : read_materials, read_equations, set_pressure_moduli
  use deck_mesh_m, only : read_mesh
  use deck_part_m, only : read_parts, read_sections, make_rigids
  use deck_plane_stress_m, only : set_plane_stress
  use deck_sections_m, only : read_cross_sections
  use deck_sets_m, only : read_sets, read_histories
  use deck_stage_m, only : read_stage, read_springback
  use deck_supports_m, only : read_supports, read_motions, read_common_motions
  use deck_velocity_m, only : read_velocities
  use deck_transforms_m, only : read_transforms
  use deck_wall_m, only : read_walls
  use deck_report_m, only : emit_warnings, emit_errors, list_findings
  use deck_ids_m, only : a_node, an_element, a_part, a_section, a_material, an_eos, a_curve, &
    a_system, a_box, a_node_set, a_part_set, a_segment_set, a_shell_set
  use deck_lines_m, only : deck_t, location_t, line_error, line_warning, file_paths, flag_blank
  use deck_reader_m, only : read_file, cut_deck
  use deck_schema_m, only : nearest_keyword, find_keyword, known_honoured, known_ignored, &
    known_refused
  use deck_parameters_m, only : read_parameters
  use deck_overrides_m, only : read_words, edit_controls
  use deck_cards_m, only : cursor_t, open_cursor, check_heading
  use deck_echo_m, only : echo_model, write_effective
  use text_m, only : upper_case
  use deck_values_m, only : note_refused
  implicit none
  private
  public :: deck_request_t, read_deck, interpret_deck

  !> The deck to read, and changes of the command line.
  type :: deck_request_t
    character(:), allocatable :: path
    character(:), allocatable :: overrides(:) !! `name=value`, `name.interface=value`,
                                              !! `p:NAME=value`
    character(:), allocatable :: text         !! of the deck instead of a file; `path` is its name
    character(:), allocatable :: files(:)     !! files read: the deck and its includes
  end type deck_request_t

  !> Advice in errors of *CASE.
  character(*), parameter :: instead_of_cases = ': run the deck once for each case, in a shell ' &
    //'loop or by tools/batch/sweep.sh, with ctype= or p:NAME=VALUE for a *PARAMETER, and ' &
    //'*INCLUDE what several decks share'

contains

  !> Read a deck. `error` has the messages of all errors; warnings and the echo of the model are
  !> written to the log.
  subroutine read_deck(request, kinds, log, model, effective, error, findings)
    type(deck_request_t), intent(inout) :: request
    type(contact_kind_t), intent(in) :: kinds(:)             !! contact types that exist
    type(log_t), intent(inout) :: log
    type(model_t), intent(out) :: model
    character(:), allocatable, intent(out) :: effective      !! the deck as run
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable, intent(out), optional :: findings !! all messages, see list_findings
    type(deck_t) :: deck
    character(:), allocatable :: text, reason

    if (present(findings)) findings = ''
    if (allocated(request%text)) then
      text = request%text
    else
      call read_file(request%path, text, reason)
      if (allocated(reason)) then
        call raise(error, 'cannot read the deck '//request%path//': '//reason, status_input)
        return
      end if
    end if
    call cut_deck(request%path, text, deck)
    if (.not. allocated(request%text)) request%files = file_paths(deck)
    call interpret_deck(deck, request, kinds, log, model, effective, error)
    if (present(findings)) call list_findings(deck%report, findings)
  end subroutine read_deck

  !> Read a deck that has been split into blocks (see `read_deck`).
  subroutine interpret_deck(deck, request, kinds, log, model, effective, error)
    type(deck_t), intent(inout) :: deck
    type(deck_request_t), intent(in) :: request
    type(contact_kind_t), intent(in) :: kinds(:)
    type(log_t), intent(inout) :: log
    type(model_t), intent(out) :: model
    character(:), allocatable, intent(out) :: effective
    type(error_t), allocatable, intent(out) :: error
    logical :: is_ended                !! it has *CONTROL_TERMINATION, possibly misspelt
    integer :: i

    allocate (deck%words(0))
    is_ended = .false.
    call identify_keywords(deck, is_ended)
    if (deck%n_block == 0) then
      call emit_errors(deck%report, request%path, error)
      return
    end if
    if (allocated(request%overrides)) call read_words(request%overrides, deck)
    call read_parameters(deck)
    call read_transforms(deck)
    call edit_controls(deck)
    do i = 1, deck%n_block
      if (deck%blocks(i)%is_honoured) call check_empty(deck, i)
      if (deck%blocks(i)%is_honoured) call check_heading(deck, i)
      if (deck%blocks(i)%is_empty) call note_refused_keyword(deck, i, is_ended)
    end do
    is_ended = is_ended .or. any(deck%blocks(:deck%n_block)%name == 'CONTROL_TERMINATION')
    if (.not. (is_ended .or. deck%incomplete)) call line_error(deck, 0, &
      'the deck has no end time (*CONTROL_TERMINATION)')
    call read_model(deck, kinds, model)
    call emit_warnings(deck%report, log)
    call emit_errors(deck%report, request%path, error)
    if (allocated(error)) return
    call echo_model(model, request%path, log)
    if (allocated(deck%default_zeros)) call write_log(log, 'a 0 in these fields means the ' &
      //'default, as in LS-DYNA: '//deck%default_zeros)
    if (allocated(deck%kept_zeros)) call write_log(log, 'a 0 in these fields means 0, where ' &
      //'LS-DYNA takes the default: '//deck%kept_zeros)
    call write_effective(deck, effective)
  end subroutine interpret_deck

  !> Read all families of keywords, in an order in which their references are known.
  subroutine read_model(deck, kinds, model)
    type(deck_t), intent(inout) :: deck
    type(contact_kind_t), intent(in) :: kinds(:)     !! contact types that exist
    type(model_t), intent(inout) :: model
    type(table_t), allocatable :: tables(:)
    type(eos_t), allocatable :: equations(:)
    type(inertia_t), allocatable :: inertias(:)
    logical, allocatable :: is_sound(:), fixed(:, :) !! (n_element), (2, n_node)
    integer, allocatable :: codes(:), owner(:), hanging_lines(:)
    type(hourglass_t) :: hourglass
    logical :: erodes
    type(location_t), allocatable :: locations(:)          !! of pressure loads
    type(mesh_boundary_t) :: body
    integer :: i, step_line

    call read_curves(deck, model, tables)
    call read_implicit(deck, model%controls%implicit)
    call read_controls(deck, model, hourglass, erodes, step_line)
    call read_outputs(deck, model)
    call read_systems(deck)
    call read_boxes(deck)
    call read_materials(deck, tables, model)
    call read_equations(deck, equations)
    call read_sections(deck, model)
    call read_parts(deck, hourglass, equations, model, inertias)
    call read_erosions(deck, erodes, step_line, model)
    call set_pressure_moduli(deck, equations, model)
    call set_plane_stress(deck, model)
    call read_mesh(deck, model, codes, is_sound, body%is_sound)
    call read_hanging_nodes(deck, model, hanging_lines)
    call read_stage(deck, model)
    call read_sets(deck, model, body%is_whole)
    call read_springback(deck, model)
    call read_histories(deck, model)
    call read_cross_sections(deck, model)
    if (model%controls%implicit%is_on) call check_implicit(deck, model)
    call make_rigids(deck, model, owner)
    call read_supports(deck, codes, owner, model, fixed)
    call read_motions(deck, owner, fixed, model)
    call read_nodal_loads(deck, model)
    call read_rigid_loads(deck, model)
    call read_body_loads(deck, model)
    call read_pressures(deck, model, locations)
    call read_masses(deck, model)
    call set_inertias(deck, inertias, model)
    call read_common_motions(deck, model)
    call read_global_damping(deck, model)
    call read_mass_damping(deck, model)
    call read_stiffness_damping(deck, model)
    call read_velocities(deck, model)
    call read_walls(deck, model)
    call warn_of_bores(deck, model)
    allocate (model%mesh%deck_node(model%mesh%n_node))
    model%mesh%deck_node = [(i, i=1, model%mesh%n_node)]
    call read_contacts(deck, kinds, locations, is_sound, body, model)
    call check_hanging_nodes(deck, hanging_lines, owner, model)
    call check_functions(deck, model)
    call read_relaxation(deck, model)
    call read_ends(deck, model, body%is_sound)
  end subroutine read_model

  !> Identify all keywords: canonical names without options; unknown and refused ones are errors,
  !> each one without effect is a warning.
  subroutine identify_keywords(deck, is_ended)
    type(deck_t), intent(inout) :: deck
    logical, intent(inout) :: is_ended
    character(:), allocatable :: reason
    character(100) :: name
    character(:), allocatable :: advice !! on *CASE, in its first error only
    logical :: has_beams     !! *ELEMENT_BEAM are elements, not edges of a mesh
    integer :: i, known

    advice = instead_of_cases
    has_beams = any([(index(deck%blocks(i)%name, 'SECTION_BEAM') == 1, i=1, deck%n_block)])
    if (deck%n_block == 0) call line_error(deck, 0, 'holds no keyword (a line that starts with *)')
    do i = 1, deck%n_block
      associate (block => deck%blocks(i))
        if (block%name == 'COMMENT') then
          name = block%name
          known = known_honoured
        else
          call find_keyword(block%given, name, known, block%titled, reason)
        end if
        if (has_beams .and. name == 'ELEMENT_BEAM') then
          known = known_refused
          reason = 'beam elements (*SECTION_BEAM) are'
        end if
        select case (known)
        case (known_honoured)
          block%is_honoured = .true.
          block%name = name(:len(block%name))
          select case (block%name)
          case ('KEYWORD', 'END', 'COMMENT', 'INCLUDE', 'INCLUDE_PATH', 'INCLUDE_TRANSFORM', &
            'DEFINE_TRANSFORMATION')
            block%dropped = .true.
          end select
        case (known_ignored)
          call line_warning(deck, block%keyword, 'ignored'//block%given, 'has no effect here')
        case (known_refused)
          if (index(block%given, 'CASE') == 1) then
            call line_error(deck, block%keyword, reason//' not available in slideline'//advice)
            advice = ''
          else
            call line_error(deck, block%keyword, reason//' not available in slideline' &
              //suggestion(block%given))
          end if
          call note_refused_keyword(deck, i, is_ended)
        case default
          call line_error(deck, block%keyword, 'is not a keyword that this version knows' &
            //suggestion(block%given))
          call note_refused_keyword(deck, i, is_ended)
        end select
        if (block%name /= 'COMMENT' .and. index(' '//upper_case(block%rest), ' CID=') > 0) then
          call line_error(deck, block%keyword, 'keywords of one *CASE (CID=) are not available ' &
            //'in slideline'//advice)
          advice = ''
        end if
      end associate
    end do
  end subroutine identify_keywords

  !> Report a block without its first card, which is then not read. A blank line is a card, except
  !> in keywords with rows.
  subroutine check_empty(deck, i_block)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(cursor_t) :: cursor
    character(:), allocatable :: fields
    integer :: k

    associate (block => deck%blocks(i_block))
      if (block%dropped .or. &
        any(iand(deck%flags(block%first:block%last), flag_blank) == 0)) return
      call open_cursor(deck, i_block, cursor)
      if (index(cursor%options, 'o') > 0) return
      if (block%last >= block%first .and. index(cursor%options, 'r') == 0) return
      fields = ''
      do k = 1, cursor%specs(1)%n
        if (cursor%specs(1)%names(k) /= '-') fields = fields//', '//trim(cursor%specs(1)%names(k))
      end do
      call line_error(deck, block%keyword, 'has no card; expected one with '//fields(3:))
      block%is_honoured = .false.
      block%is_empty = .true.
    end associate
  end subroutine check_empty

  !> `; did you mean *NAME?` for an unknown keyword, or nothing.
  function suggestion(given) result(text)
    character(*), intent(in) :: given
    character(:), allocatable :: text

    text = trim(nearest_keyword(trim(given)))
    if (len(text) > 0) text = '; did you mean *'//text//'?'
  end function suggestion

  !> Note the kinds of entities that a refused keyword, or the one most similar to it, would have
  !> defined.
  subroutine note_refused_keyword(deck, i_block, is_ended)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    logical, intent(inout) :: is_ended
    character(:), allocatable :: name
    integer :: i

    name = deck%blocks(i_block)%given
    do i = 1, 2
      if (index(name, 'NODE') == 1 .or. index(name, 'INCLUDE') == 1) call note_refused(deck, &
        [a_node])
      if (index(name, 'ELEMENT') == 1) call note_refused(deck, [an_element])
      if (index(name, 'PART') == 1) call note_refused(deck, [a_part])
      if (index(name, 'SECTION') == 1) call note_refused(deck, [a_section])
      if (index(name, 'MAT') == 1) call note_refused(deck, [a_material])
      if (index(name, 'EOS') == 1) call note_refused(deck, [an_eos])
      if (index(name, 'DEFINE') == 1) call note_refused(deck, [a_curve, a_system, a_box])
      if (index(name, 'SET') == 1) call note_refused(deck, [a_node_set, a_part_set, a_segment_set, &
        a_shell_set])
      is_ended = is_ended .or. name == 'CONTROL_TERMINATION'
      name = trim(nearest_keyword(deck%blocks(i_block)%given))
    end do
  end subroutine note_refused_keyword

end module deck_m
