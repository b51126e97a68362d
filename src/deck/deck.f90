! SPDX-License-Identifier: MIT
!> Deck in, model out: the one dispatch on keywords.
!>
!> The file is cut into keyword blocks, parameters are read, then each block is read by the
!> procedure of its keyword into `raw_t` (user ids), then ids become indices and surfaces are built.
!> All mistakes on the way are collected and come back as one error, in deck order.
module deck_m
  use errors_m, only : error_t
  use log_m, only : log_t, write_log
  use contacts_m, only : contact_kind_t
  use model_m, only : model_t
  use deck_findings_m, only : list_findings
  use deck_report_m, only : emit_warnings, emit_errors
  use deck_ids_m, only : a_node, an_element, a_part, a_section, a_material, an_eos, a_curve, &
    a_system, a_node_set, a_part_set, a_segment_set, a_shell_set
  use deck_lines_m, only : deck_t, line_error, line_warning, shown_text, file_paths, &
    flag_blank
  use deck_reader_m, only : read_blocks, cut_deck
  use deck_schema_m, only : nearest_keyword, find_keyword, known_honoured, known_ignored, &
    known_refused
  use deck_parameters_m, only : read_parameters
  use deck_overrides_m, only : read_words, edit_controls, check_words
  use deck_cards_m, only : cursor_t, open_cursor, next_text, row_comes
  use deck_raw_m, only : raw_t
  use deck_control_m, only : read_control, read_database, check_step
  use deck_contact_m, only : read_contact
  use deck_friction_m, only : warn_of_unused
  use deck_resolve_m, only : resolve_model
  use deck_effective_m, only : forget_places, write_effective
  use deck_echo_m, only : echo_model
  use text_m, only : upper_case
  use deck_values_m, only : lose
  implicit none
  private
  public :: deck_request_t, read_deck, interpret_deck

  !> What is to be read.
  type :: deck_request_t
    character(:), allocatable :: path
    character(:), allocatable :: overrides(:) !! `name=value`, `name.interface=value`,
                                              !! `p:NAME=value`
    character(:), allocatable :: text         !! of the deck where it is no file; `path` names it
                                              !! then
    character(:), allocatable :: files(:)     !! that have been read: the deck, what it includes
  end type deck_request_t

  !> What takes the place of *CASE, behind its refusals.
  character(*), parameter :: instead_of_cases = ' not available in slideline: run the deck once ' &
    //'for each, in a shell loop or by tools/batch/sweep.sh, with ctype=, p:NAME=VALUE of a ' &
    //'*PARAMETER and the like, and *INCLUDE what several decks share'

  !> All kinds of sets.
  integer, parameter :: sets(4) = [a_node_set, a_part_set, a_segment_set, a_shell_set]

contains

  !> Read a deck. `error` holds every mistake of it, one after the other; warnings and the echo of
  !> what was understood go to the log.
  subroutine read_deck(request, kinds, log, model, effective, error, findings)
    type(deck_request_t), intent(inout) :: request
    type(contact_kind_t), intent(in) :: kinds(:)             !! contact types that exist
    type(log_t), intent(inout) :: log
    type(model_t), intent(out) :: model
    character(:), allocatable, intent(out) :: effective      !! the deck as run
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable, intent(out), optional :: findings !! all messages, see list_findings
    type(deck_t) :: deck
    character(:), allocatable :: text

    if (allocated(request%text)) then
      text = request%text
      call cut_deck(request%path, text, deck)
    else
      call read_blocks(request%path, deck, error)
      if (present(findings)) findings = ''
      if (allocated(error)) return
    end if
    if (.not. allocated(request%text)) request%files = file_paths(deck)
    call interpret_deck(deck, request, kinds, log, model, effective, error)
    if (present(findings)) call list_findings(deck%report, findings)
  end subroutine read_deck

  !> As `read_deck`, of a deck that has been cut into blocks.
  subroutine interpret_deck(deck, request, kinds, log, model, effective, error)
    type(deck_t), intent(inout) :: deck
    type(deck_request_t), intent(in) :: request
    type(contact_kind_t), intent(in) :: kinds(:)
    type(log_t), intent(inout) :: log
    type(model_t), intent(out) :: model
    character(:), allocatable, intent(out) :: effective
    type(error_t), allocatable, intent(out) :: error
    type(raw_t), allocatable :: raw
    integer :: i, n, pass

    allocate (raw, deck%words(0))
    call know_blocks(deck, raw)
    if (deck%n_block == 0) then
      call emit_errors(deck%report, request%path, error)
      return
    end if
    if (allocated(request%overrides)) call read_words(request%overrides, deck)
    call read_parameters(deck)
    call edit_controls(deck)
    n = count([(index(deck%blocks(i)%name, 'CONTACT_') == 1, i=1, deck%n_block)])
    allocate (raw%contacts(n), raw%transducers(n), raw%explicit_only(0))
    raw%controls%title = ''
    do i = 1, deck%n_block
      if (deck%blocks(i)%is_honoured) call check_empty(deck, i)
      if (deck%blocks(i)%is_empty) call note_lost(deck, i, raw)
    end do
    ! Interfaces come last: friction of *CONTROL_CONTACT is known then.
    do pass = 1, 2
      do i = 1, deck%n_block
        if (.not. deck%blocks(i)%is_honoured) cycle
        if ((index(deck%blocks(i)%name, 'CONTACT_') == 1) .eqv. pass == 2) &
          call read_block(deck, i, kinds, raw)
      end do
    end do
    raw%contacts = raw%contacts(:raw%n_contact)
    raw%transducers = raw%transducers(:raw%n_transducer)
    call warn_of_unused(deck, raw)
    call check_words(deck, [raw%contacts%contact%id])
    call check_step(deck, raw)
    if (.not. (raw%terminated .or. deck%incomplete)) call line_error(deck, 0, &
      'the deck has no end time (*CONTROL_TERMINATION)')
    call resolve_model(deck, raw, model)
    deallocate (raw) ! before the effective deck takes its place
    call emit_warnings(deck%report, log)
    call emit_errors(deck%report, request%path, error)
    if (allocated(error)) return
    call echo_model(model, request%path, log)
    if (allocated(deck%default_zeros)) call write_log(log, 'a 0 in these fields stands for the ' &
      //'default, as in LS-DYNA: '//deck%default_zeros)
    if (allocated(deck%kept_zeros)) call write_log(log, 'a 0 in these fields is kept, where ' &
      //'LS-DYNA takes the default: '//deck%kept_zeros)
    call forget_places(deck)
    call write_effective(deck, effective)
  end subroutine interpret_deck

  !> Look every keyword up: canonical names, options taken off; unknown and refused ones are errors,
  !> those without effect one warning each.
  subroutine know_blocks(deck, raw)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(inout) :: raw
    character(:), allocatable :: reason
    character(100) :: name
    logical :: has_beams     !! beams are bodies, not the edges of a mesh
    integer :: i, known

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
          reason = 'with beams as bodies (*SECTION_BEAM) this element is'
        end if
        select case (known)
        case (known_honoured)
          block%is_honoured = .true.
          block%name = name(:len(block%name))
          select case (block%name)
          case ('KEYWORD', 'END', 'COMMENT', 'INCLUDE', 'INCLUDE_PATH')
            block%dropped = .true.
          end select
        case (known_ignored)
          call line_warning(deck, block%keyword, 'ignored'//block%given, 'has no effect here')
        case (known_refused)
          if (index(block%given, 'CASE') == 1) then
            call line_error(deck, block%keyword, reason//instead_of_cases)
          else
            call line_error(deck, block%keyword, reason//' not available in slideline' &
              //meant(block%given))
          end if
          call note_lost(deck, i, raw)
        case default
          call line_error(deck, block%keyword, 'is not a keyword that this version knows' &
            //meant(block%given))
          call note_lost(deck, i, raw)
        end select
        if (block%name /= 'COMMENT' .and. index(' '//upper_case(block%rest), ' CID=') > 0) &
          call line_error(deck, block%keyword, 'keywords of one of several runs (CID=) are' &
          //instead_of_cases)
      end associate
    end do
  end subroutine know_blocks

  !> A block without its first card, which is an error and not read. A blank line is a card where a
  !> keyword has one card, and none where it has rows.
  subroutine check_empty(deck, i_block)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(cursor_t) :: cursor
    character(:), allocatable :: fields
    integer :: k

    associate (block => deck%blocks(i_block))
      if (block%dropped) return
      call open_cursor(deck, i_block, cursor)
      if (index(cursor%options, 'o') > 0) return
      if (any(iand(deck%flags(block%first:block%last), flag_blank) == 0)) return
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

  !> What a name that is not known may have been meant for, for a message.
  function meant(given) result(text)
    character(*), intent(in) :: given
    character(:), allocatable :: text

    text = trim(nearest_keyword(trim(given)))
    if (len(text) > 0) text = '; did you mean *'//text//'?'
  end function meant

  !> What a refused keyword would have defined, by its name and by what that may have been meant
  !> for.
  subroutine note_lost(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    character(:), allocatable :: name
    integer :: i

    name = deck%blocks(i_block)%given
    do i = 1, 2
      if (index(name, 'NODE') == 1 .or. index(name, 'INCLUDE') == 1) call lose(deck, [a_node])
      if (index(name, 'ELEMENT') == 1) call lose(deck, [an_element])
      if (index(name, 'PART') == 1) call lose(deck, [a_part])
      if (index(name, 'SECTION') == 1) call lose(deck, [a_section])
      if (index(name, 'MAT') == 1) call lose(deck, [a_material])
      if (index(name, 'EOS') == 1) call lose(deck, [an_eos])
      if (index(name, 'DEFINE') == 1) call lose(deck, [a_curve, a_system])
      if (index(name, 'SET') == 1) call lose(deck, sets)
      raw%terminated = raw%terminated .or. name == 'CONTROL_TERMINATION'
      name = trim(nearest_keyword(deck%blocks(i_block)%given))
    end do
  end subroutine note_lost

  !> Read one block by its family. What is not named here is read when the model is made.
  subroutine read_block(deck, i, kinds, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i
    type(contact_kind_t), intent(in) :: kinds(:)
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    character(:), allocatable :: text
    logical :: found

    associate (name => deck%blocks(i)%name)
      if (name == 'TITLE') then
        call open_cursor(deck, i, cursor)
        call row_comes(deck, cursor, found)
        call next_text(deck, cursor, text)
        raw%controls%title = trim(adjustl(shown_text(text)))
      else if (index(name, 'CONTROL_') == 1) then
        call read_control(deck, i, raw)
      else if (index(name, 'DATABASE_') == 1) then
        if (all([index(name, '_HISTORY'), index(name, '_NODAL'), index(name, '_CROSS')] == 0)) &
          call read_database(deck, i, raw)
      else if (index(name, 'CONTACT_') == 1) then
        call read_contact(deck, i, kinds, raw)
      end if
    end associate
  end subroutine read_block

end module deck_m
