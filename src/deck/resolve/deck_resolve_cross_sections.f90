! SPDX-License-Identifier: MIT
!> Cross sections: nodes and elements in place of their sets.
module deck_resolve_cross_sections_m
  use cross_sections_m, only : cross_section_t, find_edges
  use log_m, only : to_text
  use model_m, only : model_t
  use deck_cards_m, only : reject_field
  use deck_lines_m, only : deck_t, place_t
  use deck_maps_m, only : maps_t, resolve_id
  use deck_raw_m, only : raw_t, raw_section_t
  use deck_resolve_sets_m, only : keep_first
  implicit none
  private
  public :: resolve_cross_sections

contains

  !> All of the deck. Called with the sets and the mesh known.
  subroutine resolve_cross_sections(deck, raw, maps, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    type(cross_section_t), allocatable :: sections(:)
    type(cross_section_t) :: section
    logical :: is_whole !! no node of an element is missing
    integer :: i, n, nodes, shells

    is_whole = all(model%mesh%element_nodes > 0)
    allocate (sections(size(raw%cuts)))
    n = 0
    do i = 1, size(raw%cuts)
      associate (cut => raw%cuts(i))
        nodes = 0
        shells = 0
        if (cut%nodes > 0) call resolve_id(deck, maps%node_sets, cut%nodes, 'node set', &
          place_t(cut%line, 1, 'NSID'), nodes)
        if (cut%shells > 0) call resolve_id(deck, maps%shell_sets, cut%shells, 'shell set', &
          place_t(cut%line, 1, 'SSID'), shells)
        if (nodes == 0 .or. shells == 0) cycle
        section%id = cut%id
        section%title = ''
        if (allocated(cut%title)) section%title = cut%title
        call keep_first(model%node_sets(nodes)%nodes, model%mesh%n_node, section%nodes)
        call keep_first(model%shell_sets(shells)%elements, model%mesh%n_element, section%elements)
        ! Of a mesh with mistakes only these are told; a set of none is told where it stands.
        if (.not. is_whole) exit
        if (size(section%nodes) == 0 .or. size(section%elements) == 0) cycle
        call check_section(deck, cut, model, section)
        call find_edges(model%mesh%element_nodes, section)
        n = n + 1
        sections(n) = section
      end associate
    end do
    model%controls%output%cross_sections = sections(:n)
  end subroutine resolve_cross_sections

  !> Each node has an element of the section, and no element is rigid.
  subroutine check_section(deck, cut, model, section)
    type(deck_t), intent(inout) :: deck
    type(raw_section_t), intent(in) :: cut
    type(model_t), intent(in) :: model
    type(cross_section_t), intent(in) :: section
    logical, allocatable :: is_held(:)
    integer :: i, material

    allocate (is_held(model%mesh%n_node), source=.false.)
    do i = 1, size(section%elements)
      is_held(model%mesh%element_nodes(:, section%elements(i))) = .true.
    end do
    do i = 1, size(section%nodes)
      if (is_held(section%nodes(i))) cycle
      call reject_field(deck, place_t(cut%line, 1, 'NSID'), 'has node ' &
        //to_text(model%mesh%node_id(section%nodes(i)))//', which is a corner of no element of ' &
        //'shell set '//to_text(cut%shells))
      exit
    end do
    do i = 1, size(section%elements)
      material = model%parts(model%mesh%element_part(section%elements(i)))%material
      if (material < 1) cycle
      if (.not. model%materials(material)%is_rigid) cycle
      call reject_field(deck, place_t(cut%line, 1, 'SSID'), 'has element ' &
        //to_text(model%mesh%element_id(section%elements(i)))//' of a rigid part: it has no ' &
        //'internal force')
      exit
    end do
  end subroutine check_section

end module deck_resolve_cross_sections_m
