! SPDX-License-Identifier: MIT
!> From stage to stage: *INITIAL_STRESS_SHELL, *INITIAL_STRAIN_SHELL, *INTERFACE_SPRINGBACK_LSDYNA
!> and _EXCLUDE.
module deck_stage_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use parts_m, only : hourglass_viscous
  use stages_m, only : n_stage_value, n_stage_strain, most_points, stage_stress, stage_plastic, &
    stage_law, stage_thickness, stage_hourglass, n_law_history, stage_fault
  use text_m, only : upper_case
  use deck_cards_m, only : cursor_t, open_cursor, next_card, next_row, next_text, row_comes, &
    report_field
  use deck_fields_m, only : card_t
  use deck_ids_m, only : an_element, a_part_set, a_node
  use deck_lines_m, only : deck_t, blocks_of, line_error, line_warning, line_text
  use deck_values_m, only : integer_of, reals_of, find_id
  implicit none
  private
  public :: read_stage, read_springback

  character(*), parameter :: springback = 'INTERFACE_SPRINGBACK_LSDYNA', &
    exclude = 'INTERFACE_SPRINGBACK_EXCLUDE'

contains

  !> Read stresses and strains of the stage before. Mesh, parts and plane stress have been read.
  subroutine read_stage(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model

    call read_tables(deck, 'INITIAL_STRESS_SHELL', n_stage_value, model, model%stage%stresses, &
      model%stage%n_element)
    call read_tables(deck, 'INITIAL_STRAIN_SHELL', n_stage_strain, model, model%stage%strains)
  end subroutine read_stage

  !> Read the elements of one keyword, each once.
  subroutine read_tables(deck, name, n_value, model, table, n_element)
    type(deck_t), intent(inout) :: deck
    character(*), intent(in) :: name
    integer, intent(in) :: n_value                       !! values of a point
    type(model_t), intent(in) :: model
    real(wp), allocatable, intent(inout) :: table(:, :)  !! (n_value*most_points, n_element)
    integer, intent(inout), optional :: n_element        !! elements with cards
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer, allocatable :: blocks(:)
    logical, allocatable :: is_given(:)
    real(wp) :: values(n_value, most_points)
    integer :: i, k, element, n_history

    blocks = blocks_of(deck, name)
    if (size(blocks) == 0) return
    allocate (table(n_value*most_points, model%mesh%n_element), source=0.0_wp)
    allocate (is_given(model%mesh%n_element), source=.false.)
    do i = 1, size(blocks)
      call open_cursor(deck, blocks(i), cursor)
      if (deck%sources(cursor%source)%is_turned) call line_error(deck, deck%blocks(blocks(i)) &
        %keyword, 'is in a file that *INCLUDE_TRANSFORM turns, which does not turn stresses')
      do while (next_row(deck, cursor, 1, card))
        if (any(card%bad)) exit ! the number of its cards is not known
        call find_id(deck, an_element, card, 'EID', element)
        if (element > 0) then
          if (is_given(element)) call report_field(deck, card, 'EID', 'has another card of *'//name)
          is_given(element) = .true.
        end if
        n_history = 0
        if (n_value == n_stage_value) n_history = integer_of(card, 'NHISV')
        if (cursor%last - cursor%line + 1 < integer_of(card, 'NPLANE') &
          *cards_of_point(integer_of(card, 'LARGE') == 1, n_history)) then
          call report_field(deck, card, 'EID', 'has fewer cards than its points and history ' &
            //'values need: the file is not complete')
          exit
        end if
        values = 0.0_wp
        do k = 1, integer_of(card, 'NPLANE')
          call read_point(deck, cursor, integer_of(card, 'LARGE') == 1, n_history, values(:, k))
        end do
        if (element == 0) cycle
        call check_element(deck, model, element, card)
        if (n_value == n_stage_value) call sort_history(deck, model, element, card, values)
        table(:, element) = reshape(values, [size(table, 1)])
      end do
    end do
    if (present(n_element)) n_element = count(is_given)
  end subroutine read_tables

  !> Cards of a point.
  pure function cards_of_point(is_large, n_history) result(n)
    logical, intent(in) :: is_large
    integer, intent(in) :: n_history
    integer :: n

    n = merge(2 + (n_history/5 + min(1, mod(n_history, 5))), &
      1 + (n_history/8 + min(1, mod(n_history, 8))), is_large)
  end function cards_of_point

  !> Read the values of a point: stress, plastic strain and history as in the file, or strain.
  subroutine read_point(deck, cursor, is_large, n_history, values)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    logical, intent(in) :: is_large
    integer, intent(in) :: n_history
    real(wp), intent(inout) :: values(:) !! of more history the rest is skipped
    type(card_t) :: card
    integer :: number, first, n, each

    ! Cards of the two widths: stresses 2 and 4, 5; strains 2 and 3, 4.
    number = merge(merge(4, 3, size(values) == n_stage_value), 2, is_large)
    call next_card(deck, cursor, number, card)
    if (size(values) == n_stage_strain) then
      values = reals_of(card, 'EPSXX', 'EPSXY')
      if (is_large) call next_card(deck, cursor, 4, card)
      return
    end if
    values(stage_stress:stage_plastic - 1) = reals_of(card, 'SIGXX', 'SIGXY')
    if (is_large) call next_card(deck, cursor, 5, card)
    values(stage_plastic:stage_plastic) = reals_of(card, 'EPS', 'EPS')
    if (values(stage_plastic) < 0.0_wp) call report_field(deck, card, 'EPS', 'is negative')
    each = merge(5, 8, is_large)
    do first = 0, n_history - 1, each
      call next_card(deck, cursor, merge(6, 3, is_large), card)
      n = min(each, size(values) - stage_plastic - first)
      if (n > 0) values(stage_plastic + first + 1:stage_plastic + first + n) = card%r(:n)
    end do
  end subroutine read_point

  !> Check the number of points, and refuse laws whose points do not go from stage to stage.
  subroutine check_element(deck, model, element, card)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    integer, intent(in) :: element
    type(card_t), intent(inout) :: card
    character(:), allocatable :: reason
    integer :: n_points

    associate (i => model%mesh%element_part(element))
      if (i == 0) return
      if (min(model%parts(i)%section, model%parts(i)%material) == 0) return
      associate (material => model%materials(model%parts(i)%material))
        n_points = merge(most_points, 1, model%sections(model%parts(i)%section)%is_full)
        if (material%is_rigid) then
          call line_warning(deck, card%line, 'rigid stage', 'belongs to a rigid part (the first ' &
            //'is '//to_text(model%parts(i)%id)//'), which has no stress: it is ignored')
        else if (integer_of(card, 'NPLANE') /= n_points) then
          call report_field(deck, card, 'NPLANE', 'is not the number of points of the element: ' &
            //to_text(n_points)//' (NIP of its section)')
        end if
        reason = stage_fault(material)
        if (len(reason) > 0) call report_field(deck, card, 'EID', 'belongs to material ' &
          //to_text(material%id)//', '//reason//': it does not go from stage to stage')
      end associate
    end associate
  end subroutine check_element

  !> Sort the history of the file into the values of the points: of the law, of the thickness, of
  !> the hourglass. Without any it is zero; the hourglass may be left out.
  subroutine sort_history(deck, model, element, card, values)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    integer, intent(in) :: element
    type(card_t), intent(inout) :: card
    real(wp), intent(inout) :: values(:, :) !! (n_stage_value, most_points)
    real(wp) :: given(n_stage_value - stage_plastic, most_points)
    integer :: n, needed

    associate (i => model%mesh%element_part(element))
      if (i == 0) return
      if (min(model%parts(i)%section, model%parts(i)%material) == 0) return
      given = values(stage_law:, :)
      values(stage_law:, :) = 0.0_wp
      associate (material => model%materials(model%parts(i)%material))
        if (material%is_rigid) values = 0.0_wp
        if (material%is_rigid) return
        n = n_law_history(material)
        needed = n + merge(1, 0, material%is_plane_stress)
        if (integer_of(card, 'NHISV') == 0) return
        if (integer_of(card, 'NHISV') < needed) then
          call report_field(deck, card, 'NHISV', 'is not the number of history values of the ' &
            //'element: '//to_text(needed)//' or more, or 0')
          return
        end if
        values(stage_law:stage_law + n - 1, :) = given(:n, :)
        if (material%is_plane_stress) values(stage_thickness, :) = given(needed, :)
        if (any(values(stage_thickness, :) <= -1.0_wp)) call report_field(deck, card, 'NHISV', &
          'gives a thickness that is not positive (t/t0 - 1 stands behind the values of the law)')
        if (integer_of(card, 'NPLANE') > 1 .or. integer_of(card, 'NHISV') < needed + 2) return
        values(stage_hourglass:, 1) = given(needed + 1:needed + 2, 1)
      end associate
      if (model%parts(i)%hourglass%form == hourglass_viscous .and. &
        any(abs(values(stage_hourglass:, 1)) > 0.0_wp)) call line_warning(deck, card%line, &
        'hourglass of a stage', 'has hourglass forces of another form of control (the first ' &
        //'element is '//to_text(model%mesh%element_id(element))//'), which the viscous form ' &
        //'does not keep; give IHQ 4 or 6 as in the stage before')
    end associate
  end subroutine sort_history

  !> Read what the file for the next stage has. Sets have been read.
  subroutine read_springback(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer, allocatable :: blocks(:)
    character(:), allocatable :: text
    integer :: i, k

    model%springback%excluded = ' '
    blocks = blocks_of(deck, exclude)
    do i = 1, size(blocks)
      call open_cursor(deck, blocks(i), cursor)
      do while (row_comes(deck, cursor))
        call next_text(deck, cursor, text)
        text = upper_case(trim(adjustl(text)))
        if (text(1:1) == '*') text = text(2:)
        if (all(text /= [character(20) :: 'NODE', 'ELEMENT_SHELL', 'INITIAL_STRESS_SHELL', &
          'INITIAL_STRAIN_SHELL'])) call line_warning(deck, cursor%line - 1, 'excluded '//text, &
          '*'//text//' has no effect here: the file has *NODE, *ELEMENT_SHELL, ' &
          //'*INITIAL_STRESS_SHELL and *INITIAL_STRAIN_SHELL alone')
        model%springback%excluded = model%springback%excluded//text//' '
      end do
    end do
    blocks = blocks_of(deck, springback)
    do i = 2, size(blocks)
      call line_error(deck, deck%blocks(blocks(i))%keyword, 'is there twice: a run has one file ' &
        //'for the next stage; give its part set all parts')
    end do
    if (size(blocks) == 0) return
    call open_cursor(deck, blocks(1), cursor)
    call next_card(deck, cursor, 1, card)
    associate (plan => model%springback)
      plan%is_on = .true.
      plan%n_history = integer_of(card, 'NSHV')
      allocate (plan%is_part(size(model%parts)), source=integer_of(card, 'PSID') == 0)
      if (integer_of(card, 'PSID') > 0) then
        call find_id(deck, a_part_set, card, 'PSID', k)
        if (k > 0) plan%is_part(model%part_sets(k)%parts) = .true.
      end if
    end associate
    call check_parts(deck, model, card)
    call read_options(deck, cursor, model)
  end subroutine read_springback

  !> Report parts whose law does not go from stage to stage.
  subroutine check_parts(deck, model, card)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    type(card_t), intent(inout) :: card
    character(:), allocatable :: reason
    integer :: i

    do i = 1, size(model%parts)
      if (.not. model%springback%is_part(i) .or. model%parts(i)%material == 0) cycle
      reason = stage_fault(model%materials(model%parts(i)%material))
      if (len(reason) == 0) cycle
      call report_field(deck, card, 'PSID', 'has part '//to_text(model%parts(i)%id)//', ' &
        //reason//': it does not go from stage to stage; leave it out')
      return
    end do
  end subroutine check_parts

  !> Optional cards: OPTCARD, and nodes with a boundary code.
  subroutine read_options(deck, cursor, model)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(model_t), intent(inout) :: model
    type(card_t) :: card
    integer :: node

    associate (plan => model%springback)
      allocate (plan%nodes(0), plan%codes(0))
      if (.not. row_comes(deck, cursor)) return
      if (index(adjustl(upper_case(line_text(deck, cursor%line))), 'OPTC') == 1) then
        call next_card(deck, cursor, 2, card)
        plan%all_nodes = integer_of(card, 'NDFLAG') == 1
      end if
      do while (next_row(deck, cursor, 3, card))
        if (any(card%bad)) cycle
        call find_id(deck, a_node, card, 'NID', node)
        plan%nodes = [plan%nodes, integer_of(card, 'NID')]
        plan%codes = [plan%codes, integer_of(card, 'TC')]
      end do
    end associate
  end subroutine read_options

end module deck_stage_m
