! SPDX-License-Identifier: MIT
!> *DATABASE_CROSS_SECTION_SET: a node set and a shell set in each row, with an optional heading.
module deck_sections_m
  use controls_m, only : cross_section_t, set_edges
  use log_m, only : to_text
  use model_m, only : model_t
  use deck_cards_m, only : cursor_t, open_cursor, next_card, next_heading, row_comes, report_field
  use deck_fields_m, only : card_t
  use deck_ids_m, only : a_node_set, a_shell_set
  use deck_lines_m, only : deck_t, blocks_of, count_rows
  use deck_sets_m, only : remove_duplicates
  use deck_values_m, only : integer_of, find_id, refuse_duplicates
  implicit none
  private
  public :: read_cross_sections

contains

  !> Read all cross sections. Mesh and sets have been read.
  subroutine read_cross_sections(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(cross_section_t), allocatable :: sections(:)
    type(cross_section_t) :: section
    type(cursor_t) :: cursor
    integer, allocatable :: blocks(:), ids(:), lines(:)
    integer :: i, n, n_row
    logical :: is_sound

    blocks = blocks_of(deck, 'DATABASE_CROSS_SECTION_SET')
    if (size(blocks) == 0) return
    n = count_rows(deck, 'DATABASE_CROSS_SECTION_SET')
    allocate (sections(n), ids(n), lines(n))
    n = 0
    n_row = 0
    do i = 1, size(blocks)
      call open_cursor(deck, blocks(i), cursor)
      do while (row_comes(deck, cursor))
        section%id = 0
        section%title = ''
        if (deck%blocks(blocks(i))%titled) call next_heading(deck, cursor, section%id, &
          section%title)
        n_row = n_row + 1
        if (section%id == 0) section%id = n_row
        ids(n_row) = section%id
        lines(n_row) = cursor%line
        call read_section(deck, cursor, model, section, is_sound)
        if (is_sound) n = n + 1
        if (is_sound) sections(n) = section
      end do
    end do
    call refuse_duplicates(deck, ids(:n_row), lines(:n_row), 'number ', 'cross section ' &
      //'(without a number it is the position in the deck)')
    model%controls%output%cross_sections = sections(:n)
  end subroutine read_cross_sections

  !> Read one row.
  subroutine read_section(deck, cursor, model, section, is_sound)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(model_t), intent(in) :: model
    type(cross_section_t), intent(inout) :: section
    logical, intent(out) :: is_sound
    type(card_t) :: card
    integer :: nodes, shells

    is_sound = .false.
    call next_card(deck, cursor, 1, card)
    call find_id(deck, a_node_set, card, 'NSID', nodes)
    call find_id(deck, a_shell_set, card, 'SSID', shells)
    if (nodes == 0 .or. shells == 0) return
    call remove_duplicates(model%node_sets(nodes)%nodes, model%mesh%n_node, section%nodes)
    call remove_duplicates(model%shell_sets(shells)%elements, model%mesh%n_element, &
      section%elements)
    ! Errors of the mesh and empty sets have been reported.
    if (any(model%mesh%element_nodes < 1)) return
    if (size(section%nodes) == 0 .or. size(section%elements) == 0) return
    call check_section(deck, card, model, section)
    call set_edges(model%mesh%element_nodes, section)
    is_sound = .true.
  end subroutine read_section

  !> Report nodes without an element of the section, and rigid elements.
  subroutine check_section(deck, card, model, section)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(in) :: model
    type(cross_section_t), intent(in) :: section
    logical, allocatable :: is_held(:)
    integer :: i, part, material

    allocate (is_held(model%mesh%n_node), source=.false.)
    do i = 1, size(section%elements)
      is_held(model%mesh%element_nodes(:, section%elements(i))) = .true.
    end do
    do i = 1, size(section%nodes)
      if (is_held(section%nodes(i))) cycle
      call report_field(deck, card, 'NSID', 'has node ' &
        //to_text(model%mesh%node_id(section%nodes(i)))//', which is a corner of no element of ' &
        //'shell set '//to_text(integer_of(card, 'SSID')))
      exit
    end do
    do i = 1, size(section%elements)
      part = model%mesh%element_part(section%elements(i))
      if (part < 1) cycle
      material = model%parts(part)%material
      if (material < 1) cycle
      if (.not. model%materials(material)%is_rigid) cycle
      call report_field(deck, card, 'SSID', 'has element ' &
        //to_text(model%mesh%element_id(section%elements(i)))//' of a rigid part: it has no ' &
        //'internal force')
      exit
    end do
  end subroutine check_section

end module deck_sections_m
