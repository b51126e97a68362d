! SPDX-License-Identifier: MIT
!> Surfaces of an interface from the sets SURFA and SURFB: parts, nodes or segments. Surfaces that
!> cross or overlap themselves at time zero are errors, and bodies that overlap by more than contact
!> of closed boundaries resolves.
module deck_contact_sides_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use surfaces_m, only : surface_t, has_closed_chain
  use model_m, only : model_t, segment_set_t
  use units_m, only : in_units
  use element_finder_m, only : body_view_t, view_body
  use initial_overlap_m, only : overlap_t, find_crossing, find_overlap
  use boundary_m, only : boundary_t, find_boundary, find_edge
  use surface_building_m, only : boundary_surface, chain_surface, chain_turned, chain_ordered, &
    chain_broken, chain_repeated, chain_short
  use deck_ids_m, only : index_of, kind_names, a_node_set, a_part, a_part_set, a_segment_set, &
    a_shell_set
  use deck_lines_m, only : deck_t, location_t, line_warning
  use deck_cards_m, only : reject_field
  use deck_contact_m, only : contact_cards_t, side_fields
  use deck_values_m, only : resolve_id, location_of
  use sorting_m, only : distinct, index_among
  implicit none
  private
  public :: mesh_boundary_t, elements_of, find_side, set_nodes, mark_surface, find_surface, &
    check_overlap

  !> Boundary data of the mesh. Surfaces without nodes of refused elements are built even where some
  !> elements are refused, so that independent errors are reported in the same pass.
  type :: mesh_boundary_t
    type(boundary_t) :: outside
    logical :: is_sound = .true.        !! no element is refused
    logical, allocatable :: is_uncertain(:) !! (n_node) nodes of refused elements
    logical, allocatable :: is_whole(:) !! (node sets) all nodes of the set exist
    integer, allocatable :: elements(:) !! (n_element) sorted by part, then increasing
    integer, allocatable :: ends(:)     !! (0:parts) end of each part in `elements`
  end type mesh_boundary_t

  !> Kind of set of a side.
  integer, parameter :: side_none = 0, side_parts = 1, side_nodes = 2, side_segments = 3
  !> Names of the two sides in messages.
  character(6), parameter :: side_names(2) = ['slave ', 'master']

contains

  !> The elements of some parts, in increasing order.
  pure function elements_of(body, parts) result(elements)
    type(mesh_boundary_t), intent(in) :: body
    integer, intent(in) :: parts(:)
    integer, allocatable :: elements(:)
    integer :: i, n

    allocate (elements(sum(body%ends(parts) - body%ends(parts - 1))))
    n = 0
    do i = 1, size(parts)
      associate (first => body%ends(parts(i) - 1) + 1, last => body%ends(parts(i)))
        elements(n + 1:n + last - first + 1) = body%elements(first:last)
        n = n + last - first + 1
      end associate
    end do
    elements = distinct(elements)
  end function elements_of

  !> The set of one side: a part set (more than 0) or a node set (less than 0), else the segment set
  !> of this number.
  subroutine find_side(deck, entry, side, kind, found)
    type(deck_t), intent(in) :: deck
    type(contact_cards_t), intent(in) :: entry
    integer, intent(in) :: side
    integer, intent(out) :: kind  !! one of the `side_` constants
    integer, intent(out) :: found !! index of the set, 0 for none

    associate (id => entry%sides(side))
      kind = merge(side_parts, side_nodes, id > 0)
      found = 0
      if (id > 0) found = index_of(deck%maps(a_part_set), id)
      if (id < 0) found = index_of(deck%maps(a_node_set), -id)
      if (found > 0) return
      kind = side_segments
      if (id /= 0) found = index_of(deck%maps(a_segment_set), abs(id))
      if (found == 0) kind = side_none
    end associate
  end subroutine find_side

  !> Mark the nodes of a transducer (of parts all nodes), or report that its set does not exist.
  !> None are marked where they belong to refused elements.
  subroutine mark_surface(deck, entry, body, model, is_on)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: entry
    type(mesh_boundary_t), intent(in) :: body
    type(model_t), intent(in) :: model
    logical, intent(out) :: is_on(:)  !! (n_node)
    logical :: is_of_part(size(model%parts))
    integer :: kind, found

    is_on = .false.
    call find_side(deck, entry, 1, kind, found)
    if (kind == side_none) then
      call refuse_side(deck, entry, 1)
    else if (.not. is_known_surface(body, model, kind, found)) then
      return
    else if (kind == side_parts) then
      is_of_part = .false.
      is_of_part(model%part_sets(found)%parts) = .true.
      is_on(pack(model%mesh%element_nodes, spread(is_of_part(model%mesh%element_part), 1, 4))) &
        = .true.
    else
      is_on(set_nodes(model, kind, found)) = .true.
    end if
  end subroutine mark_surface

  !> Nodes of a node or segment set; none of parts.
  pure function set_nodes(model, kind, found) result(nodes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: kind, found
    integer, allocatable :: nodes(:)

    allocate (nodes(0))
    if (kind == side_nodes) nodes = model%node_sets(found)%nodes
    if (kind == side_segments) nodes = [model%segment_sets(found)%nodes]
  end function set_nodes

  !> Report a side whose set does not exist, and other entities with its number.
  subroutine refuse_side(deck, entry, side)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: entry
    integer, intent(in) :: side
    integer, parameter :: kinds(4) = [a_node_set, a_part_set, a_shell_set, a_part]
    character(:), allocatable :: same_ids
    integer :: found, k

    same_ids = ''
    associate (id => entry%sides(side))
      do k = 1, size(kinds)
        if (index_of(deck%maps(kinds(k)), abs(id)) > 0) same_ids = same_ids//', ' &
          //trim(kind_names(kinds(k)))//' '//to_text(abs(id))//' exists'
      end do
      if (len(same_ids) > 0) same_ids(1:1) = ';'
      if (id /= 0) call resolve_id(deck, merge(a_part_set, a_node_set, id > 0), abs(id), &
        location_of(entry%cards(1), side_fields(side)), found, same_ids)
    end associate
  end subroutine refuse_side

  !> The surface of one side of an interface; without nodes where errors of the set or of its
  !> elements have been reported.
  subroutine find_surface(deck, entry, side, body, model, surface)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: entry
    integer, intent(in) :: side
    type(mesh_boundary_t), intent(in) :: body
    type(model_t), intent(in) :: model
    type(surface_t), intent(out) :: surface
    type(location_t) :: location
    integer :: kind, found

    location = location_of(entry%cards(1), side_fields(side))
    call find_side(deck, entry, side, kind, found)
    if (kind == side_none) then
      call refuse_side(deck, entry, side)
    else if (is_known_surface(body, model, kind, found)) then
      select case (kind)
      case (side_parts)
        call surface_of_parts(deck, model%part_sets(found)%parts, location, body, model, surface)
      case (side_nodes)
        if (body%is_whole(found)) call surface_of_nodes(deck, model%node_sets(found)%nodes, side, &
          location, body%outside, model, surface)
      case (side_segments)
        if (allocated(model%segment_sets(found)%parts)) then
          call surface_of_parts(deck, model%segment_sets(found)%parts, location, body, model, &
            surface)
        else
          call surface_of_segments(deck, model%segment_sets(found), location, body%outside, model, &
            surface)
          if (entry%contact%is_self .and. allocated(surface%previous)) then
            if (any(surface%previous == 0)) call reject_field(deck, location, 'is a segment set ' &
              //'with an open chain; self contact needs closed boundaries')
          end if
        end if
      end select
    end if
    if (.not. allocated(surface%nodes)) &
      allocate (surface%nodes(0), surface%segments(2, 0), surface%segment_element(0))
  end subroutine find_surface

  !> Whether no refused element has nodes of the surface.
  pure function is_known_surface(body, model, kind, found)
    type(mesh_boundary_t), intent(in) :: body
    type(model_t), intent(in) :: model
    integer, intent(in) :: kind, found
    logical :: is_known_surface

    is_known_surface = body%is_sound
    if (is_known_surface .or. kind == side_parts) return
    if (kind == side_segments) then
      if (allocated(model%segment_sets(found)%parts)) return
    end if
    is_known_surface = .not. any(body%is_uncertain(set_nodes(model, kind, found)))
  end function is_known_surface

  !> Surface of a segment set, with edges in any order and direction.
  subroutine surface_of_segments(deck, set, location, outside, model, surface)
    type(deck_t), intent(inout) :: deck
    type(segment_set_t), intent(in) :: set
    type(location_t), intent(in) :: location
    type(boundary_t), intent(in) :: outside
    type(model_t), intent(in) :: model
    type(surface_t), intent(out) :: surface
    logical, allocatable :: is_chosen(:)
    integer :: i, edge, crossing

    allocate (is_chosen(outside%n_edge), source=.false.)
    do i = 1, size(set%nodes, 2)
      edge = find_edge(outside, set%nodes(1, i), set%nodes(2, i))
      if (edge == 0) edge = find_edge(outside, set%nodes(2, i), set%nodes(1, i))
      if (edge == 0) then
        call reject_field(deck, location, 'is a set with the edge between nodes ' &
          //to_text(model%mesh%node_id(set%nodes(1, i)))//' and ' &
          //to_text(model%mesh%node_id(set%nodes(2, i)))//', which is no outer edge of the mesh')
        return
      end if
      is_chosen(edge) = .true.
    end do
    call boundary_surface(outside, is_chosen, surface, crossing)
    if (crossing > 0) call reject_field(deck, location, &
      'is a set whose edges touch each other at ' &
      //'node '//to_text(model%mesh%node_id(crossing))//'; give the surface as a node set')
  end subroutine surface_of_segments

  !> Surface of a set of parts: their exterior boundary.
  subroutine surface_of_parts(deck, parts, location, body, model, surface)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: parts(:)
    type(location_t), intent(in) :: location
    type(mesh_boundary_t), intent(in) :: body
    type(model_t), intent(in) :: model
    type(surface_t), intent(out) :: surface
    type(boundary_t) :: boundary
    integer, allocatable :: elements(:), element_nodes(:, :), nodes(:), order(:), hanging(:, :)
    integer :: crossing, i, k

    elements = elements_of(body, parts)
    if (size(elements) == 0) then
      call reject_field(deck, location, 'has no boundary: its parts have no elements')
      return
    end if
    element_nodes = model%mesh%element_nodes(:, elements)
    nodes = distinct(reshape(element_nodes, [size(element_nodes)]))
    order = [(i, i=1, size(nodes))]
    do i = 1, size(elements)
      do k = 1, 4
        element_nodes(k, i) = index_among(nodes, order, element_nodes(k, i))
      end do
    end do
    if (allocated(model%mesh%hanging)) then
      hanging = model%mesh%hanging
      do i = 1, size(hanging, 2)
        do k = 1, 3
          hanging(k, i) = index_among(nodes, order, hanging(k, i))
        end do
      end do
    end if
    call find_boundary(element_nodes, spread(.true., 1, size(elements)), &
      spread(.true., 1, size(nodes)), boundary, hanging)
    call boundary_surface(boundary, spread(.true., 1, boundary%n_edge), surface, crossing)
    if (crossing > 0) then
      call reject_field(deck, location, 'has a boundary that touches itself at node ' &
        //to_text(model%mesh%node_id(nodes(crossing)))//'; give the surface as a node set')
      return
    end if
    surface%nodes = nodes(surface%nodes)
    surface%segment_element = elements(surface%segment_element)
    if (model%erodes) surface%parts = parts
  end subroutine surface_of_parts

  !> Surface of a node set: a chain.
  subroutine surface_of_nodes(deck, nodes, side, location, outside, model, surface)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: nodes(:)
    integer, intent(in) :: side
    type(location_t), intent(in) :: location
    type(boundary_t), intent(in) :: outside
    type(model_t), intent(in) :: model
    type(surface_t), intent(out) :: surface
    integer :: outcome, bad_nodes(2)

    call chain_surface(outside, nodes, surface, outcome, bad_nodes)
    select case (outcome)
    case (chain_turned)
      call line_warning(deck, location%line, 'turned'//to_text(location%line)//side_names(side), &
        'the '//trim(side_names(side))//' surface is numbered clockwise about its body and has ' &
        //'been reversed')
    case (chain_ordered)
      call line_warning(deck, location%line, 'ordered'//to_text(location%line)//side_names(side), &
        'the nodes of the '//trim(side_names(side))//' surface are not in walking order and ' &
        //'have been sorted')
    case (chain_short)
      call reject_field(deck, location, 'is a set with fewer than two nodes, which is no surface')
    case (chain_repeated)
      call reject_field(deck, location, 'is a set with node ' &
        //to_text(model%mesh%node_id(bad_nodes(1)))//' in it twice')
    case (chain_broken)
      call reject_field(deck, location, 'is a set whose nodes do not follow an outer edge of the ' &
        //'mesh: the first break is between nodes ' &
        //to_text(model%mesh%node_id(bad_nodes(1)))//' and ' &
        //to_text(model%mesh%node_id(bad_nodes(2))))
    end select
  end subroutine surface_of_nodes

  !> Check the surfaces of an interface for crossings and overlaps. Overlaps are not checked with a
  !> birth time after zero, nor between open chains.
  subroutine check_overlap(deck, entry, sides, body, model)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: entry
    type(surface_t), intent(in) :: sides(2)
    type(mesh_boundary_t), intent(in) :: body
    type(model_t), intent(in) :: model
    type(body_view_t) :: views(2)
    type(overlap_t) :: found(2)
    integer :: k, n_side, pair(2)
    logical :: crosses

    if (min(sides(1)%n_segment, sides(2)%n_segment) == 0) return
    crosses = .false.
    n_side = merge(1, 2, entry%contact%is_self)
    do k = 1, n_side
      call view_body(model, sides(k), sides(3 - k), views(k), elements_of(body, &
        distinct(model%mesh%element_part(sides(k)%segment_element))))
      call find_crossing(model, sides(k), views(k), pair)
      if (pair(1) == 0) cycle
      crosses = .true.
      call reject_field(deck, location_of(entry%cards(1), side_fields(k)), 'is a surface that ' &
        //'crosses itself: the segment between '//ends_text(model, sides(k), pair(1)) &
        //' crosses the one between '//ends_text(model, sides(k), pair(2)))
    end do
    if (crosses .or. entry%contact%birth > 0.0_wp) return
    if (.not. (has_closed_chain(sides(1)) .or. has_closed_chain(sides(2)))) return
    do k = 1, n_side
      call find_overlap(model, sides(k), sides(k), views(k), .true., found(k))
      if (found(k)%segment > 0) call reject_field(deck, location_of(entry%cards(1), &
        side_fields(k)), &
        'is a surface that overlaps itself: '//depth_text(model, sides(k), found(k)))
    end do
    if (n_side == 1) return
    ! Each side in the bodies of the other; the deeper one relative to the allowed depth is
    ! reported.
    do k = 1, 2
      call find_overlap(model, sides(k), sides(3 - k), views(3 - k), .false., found(k))
    end do
    if (all(found%segment == 0)) return
    k = 1
    if (found(2)%depth*found(1)%allowed > found(1)%depth*found(2)%allowed &
      .or. found(1)%segment == 0) k = 2
    call reject_field(deck, location_of(entry%cards(1), 'SURFB'), 'overlaps the slave surface at ' &
      //'the start: '//depth_text(model, sides(3 - k), found(k)))
  end subroutine check_overlap

  !> Text of an overlap: position, segment, depth and allowed depth.
  function depth_text(model, other, found) result(text)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: other
    type(overlap_t), intent(in) :: found
    character(:), allocatable :: text

    text = 'node '//to_text(model%mesh%node_id(found%nodes(1)))
    if (found%nodes(1) /= found%nodes(2)) text = 'a point between nodes ' &
      //to_text(model%mesh%node_id(found%nodes(1)))//' and ' &
      //to_text(model%mesh%node_id(found%nodes(2)))
    text = text//' lies '//to_text(found%depth)//in_units(model%controls%units, 'L') &
      //' deep behind the segment between ' &
      //ends_text(model, other, found%segment)//'; contact resolves less than ' &
      //to_text(found%allowed)//in_units(model%controls%units, 'L') &
      //' there, half of the element behind it'
  end function depth_text

  !> `nodes a and b`, the ends of a segment.
  function ends_text(model, surface, segment) result(text)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: segment
    character(:), allocatable :: text

    associate (ends => surface%nodes(surface%segments(:, segment)))
      text = 'nodes '//to_text(model%mesh%node_id(ends(1)))//' and ' &
        //to_text(model%mesh%node_id(ends(2)))
    end associate
  end function ends_text

end module deck_contact_sides_m
