! SPDX-License-Identifier: MIT
!> Cross sections and force transducers: nodes and elements in place of their sets.
module deck_resolve_sections_m
  use controls_m, only : cross_section_t, find_edges
  use log_m, only : to_text
  use model_m, only : model_t
  use deck_cards_m, only : reject_field
  use deck_ids_m, only : a_node_set, a_shell_set
  use deck_lines_m, only : deck_t, place_t, line_warning
  use deck_maps_m, only : resolve_id
  use deck_raw_m, only : raw_t, raw_section_t
  use deck_resolve_sets_m, only : keep_first
  use deck_resolve_sides_m, only : require_side, side_parts, side_nodes, side_segments
  implicit none
  private
  public :: resolve_cross_sections, resolve_transducers

contains

  !> All of the deck. Called with the sets and the mesh known.
  subroutine resolve_cross_sections(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
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
        if (cut%nodes > 0) call resolve_id(deck, a_node_set, cut%nodes, &
          place_t(cut%line, 1, 'NSID'), nodes)
        if (cut%shells > 0) call resolve_id(deck, a_shell_set, cut%shells, &
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

  !> Of each surface the nodes that interfaces have: no others carry contact forces. Called with the
  !> interfaces of the model known.
  subroutine resolve_transducers(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model
    logical, allocatable :: touches(:), is_on(:)
    integer :: i, k

    if (size(raw%transducers) == 0) return
    allocate (model%transducers(size(raw%transducers)))
    allocate (touches(model%mesh%n_node), source=.false.)
    allocate (is_on(model%mesh%n_node))
    do i = 1, size(model%contacts)
      touches(model%contacts(i)%slave%nodes) = .true.
      touches(model%contacts(i)%master%nodes) = .true.
    end do
    do i = 1, size(raw%transducers)
      call mark_surface(deck, raw, i, model, is_on)
      associate (transducer => model%transducers(i), entry => raw%transducers(i))
        transducer%id = entry%contact%id
        transducer%title = entry%contact%title
        transducer%nodes = pack([(k, k=1, size(is_on))], is_on .and. touches)
        if (size(transducer%nodes) == 0) call line_warning(deck, deck%blocks(entry%block)%keyword, &
          'transducer'//to_text(entry%contact%id), 'no interface has nodes of the surface of ' &
          //'transducer '//to_text(entry%contact%id)//': it measures nothing')
      end associate
    end do
  end subroutine resolve_transducers

  !> The nodes of one surface; of parts all, since the inner ones carry no contact.
  subroutine mark_surface(deck, raw, i, model, is_on)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    integer, intent(in) :: i
    type(model_t), intent(in) :: model
    logical, intent(inout) :: is_on(:)
    logical :: is_of_part(size(model%parts))
    integer :: kind, found, k

    is_on = .false.
    call require_side(deck, raw%transducers(i), 1, kind, found)
    select case (kind)
    case (side_parts)
      is_of_part = .false.
      is_of_part(model%part_sets(found)%parts) = .true.
      do k = 1, model%mesh%n_element
        if (is_of_part(model%mesh%element_part(k))) is_on(model%mesh%element_nodes(:, k)) = .true.
      end do
    case (side_nodes)
      is_on(model%node_sets(found)%nodes) = .true.
    case (side_segments)
      is_on(model%segment_sets(found)%nodes(1, :)) = .true.
      is_on(model%segment_sets(found)%nodes(2, :)) = .true.
    end select
  end subroutine mark_surface

end module deck_resolve_sections_m
