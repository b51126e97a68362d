! SPDX-License-Identifier: MIT
!> Surfaces of the interfaces and edges of the pressure loads of sound meshes. Surfaces that can not
!> be right as the bodies stand at time zero are refused: one that crosses or overlaps itself, and
!> bodies that overlap deeper than contact between whole outlines takes up.
module deck_resolve_contacts_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use contacts_m, only : contact_t, friction_rule_t, breaks, tie_none
  use surfaces_m, only : surface_t, has_closed_chain
  use model_m, only : model_t
  use boundary_m, only : boundary_t, find_boundary
  use deck_lines_m, only : deck_t
  use deck_cards_m, only : reject_field
  use deck_choose_type_m, only : choose_type
  use deck_loads_m, only : settle_pressures
  use deck_resolve_sides_m, only : find_side, resolve_side, side_nodes, side_segments
  use deck_interference_m, only : resolve_interference
  use deck_raw_m, only : raw_t, raw_contact_t
  use units_m, only : in_units
  use element_finder_m, only : body_view_t, view_body
  use initial_overlap_m, only : overlap_t, find_crossing, find_overlap
  implicit none
  private
  public :: resolve_contacts, check_common_nodes

contains

  !> Interfaces and pressure loads.
  subroutine resolve_contacts(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model
    type(boundary_t) :: outside
    type(surface_t) :: sides(2)
    logical, allocatable :: among(:), all_elements(:)
    integer :: i, k, n_error

    allocate (among(model%mesh%n_node), source=.false.)
    allocate (all_elements(model%mesh%n_element), source=.true.)
    call mark_nodes(deck, raw, model, among)
    call find_boundary(model%mesh%element_nodes, all_elements, among, outside)
    call settle_pressures(deck, raw%pressure_places, outside, model)
    allocate (model%contacts(size(raw%contacts)))
    do i = 1, size(raw%contacts)
      n_error = deck%report%n_error
      do k = 1, merge(1, 2, raw%contacts(i)%contact%is_self)
        call resolve_side(deck, raw, i, k, outside, model, sides(k))
      end do
      if (raw%contacts(i)%contact%is_self) sides(2) = sides(1)
      model%contacts(i) = raw%contacts(i)%contact
      model%contacts(i)%slave = sides(1)
      model%contacts(i)%master = sides(2)
      call resolve_interference(deck, raw%contacts(i), model, model%contacts(i))
      if (.not. raw%contacts(i)%contact%is_self) &
        call check_common_nodes(deck, raw%contacts(i), sides, model)
      if (deck%report%n_error > n_error) cycle
      call check_overlap(deck, raw%contacts(i), sides, model)
      ! The choice looks at conditions and materials: they have to be sound as well.
      if (deck%report%n_error == 0) call choose_type(deck, raw%contacts(i)%block, model, &
        model%contacts(i))
    end do
    call append_behind(model%contacts)
  end subroutine resolve_contacts

  !> Contact behind each tie that breaks, with what the tie has no use for.
  subroutine append_behind(contacts)
    type(contact_t), allocatable, intent(inout) :: contacts(:)
    type(contact_t) :: behind
    integer :: i

    do i = 1, size(contacts)
      if (.not. breaks(contacts(i))) cycle
      behind = contacts(i)
      behind%behind = i
      behind%tie = tie_none
      behind%tie_reach = 0.0_wp
      behind%target = 0.0_wp
      contacts(i)%friction = friction_rule_t()
      contacts(i)%damping = 0.0_wp
      contacts(i)%search_interval = 0
      contacts = [contacts, behind]
    end do
  end subroutine append_behind

  !> Nodes of contact node and segment sets and of pressure edges: only their edges are looked for.
  subroutine mark_nodes(deck, raw, model, among)
    type(deck_t), intent(in) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    logical, intent(inout) :: among(:)
    integer :: i, k, kind, found

    do i = 1, size(raw%contacts)
      do k = 1, 2
        call find_side(deck, raw%contacts(i), k, kind, found)
        if (kind == side_nodes) then
          among(model%node_sets(found)%nodes) = .true.
        else if (kind == side_segments) then
          among(model%segment_sets(found)%nodes(1, :)) = .true.
          among(model%segment_sets(found)%nodes(2, :)) = .true.
        end if
      end do
    end do
    do i = 1, size(model%conditions%pressures)
      among(model%conditions%pressures(i)%nodes) = .true.
    end do
  end subroutine mark_nodes

  !> A node may stand on one side of an interface only.
  subroutine check_common_nodes(deck, entry, sides, model)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    type(surface_t), intent(in) :: sides(2)
    type(model_t), intent(in) :: model
    logical, allocatable :: on_slave(:)
    character(:), allocatable :: names
    integer :: i, n

    if (size(sides(1)%nodes) == 0 .or. size(sides(2)%nodes) == 0) return
    allocate (on_slave(model%mesh%n_node), source=.false.)
    on_slave(sides(1)%nodes) = .true.
    n = 0
    names = ''
    do i = 1, size(sides(2)%nodes)
      if (.not. on_slave(sides(2)%nodes(i))) cycle
      n = n + 1
      if (n <= 5) names = names//' '//to_text(model%mesh%node_id(sides(2)%nodes(i)))
    end do
    if (n > 5) names = names//' and '//to_text(n - 5)//' more'
    if (n > 0) call reject_field(deck, entry%places(2), &
      'shares nodes with the slave surface:'//names)
  end subroutine check_common_nodes

  !> Check one interface. With a birth time after zero bodies may be anywhere before it; between
  !> open chains penetrations are taken as they are, however deep.
  subroutine check_overlap(deck, entry, sides, model)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    type(surface_t), intent(in) :: sides(2)
    type(model_t), intent(in) :: model
    type(body_view_t) :: views(2)
    type(overlap_t) :: found
    integer :: k, n_side, pair(2)
    logical :: crosses

    if (min(sides(1)%n_segment, sides(2)%n_segment) == 0) return
    crosses = .false.
    n_side = merge(1, 2, entry%contact%is_self)
    do k = 1, n_side
      call view_body(model, sides(k), sides(3 - k), views(k))
      call find_crossing(model, sides(k), views(k), pair)
      if (pair(1) == 0) cycle
      crosses = .true.
      call reject_field(deck, entry%places(k), 'is a surface that crosses itself: the segment ' &
        //'between '//ends_text(model, sides(k), pair(1))//' crosses the one between ' &
        //ends_text(model, sides(k), pair(2)))
    end do
    if (crosses .or. entry%contact%birth > 0.0_wp) return
    if (.not. (has_closed_chain(sides(1)) .or. has_closed_chain(sides(2)))) return
    do k = 1, n_side
      call find_overlap(model, sides(k), sides(k), views(k), .true., found)
      if (found%segment > 0) call reject_field(deck, entry%places(k), 'is a surface that ' &
        //'overlaps itself: '//depth_text(model, sides(k), found))
    end do
    if (n_side == 2) call check_between(deck, entry, sides, views, model)
  end subroutine check_overlap

  !> Either side in the bodies of the other: the deeper one by the depth allowed is told.
  subroutine check_between(deck, entry, sides, views, model)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    type(surface_t), intent(in) :: sides(2)
    type(body_view_t), intent(in) :: views(2)
    type(model_t), intent(in) :: model
    type(overlap_t) :: found(2)
    character(*), parameter :: what = 'overlaps the slave surface at the start: '
    integer :: k

    do k = 1, 2
      call find_overlap(model, sides(k), sides(3 - k), views(3 - k), .false., found(k))
    end do
    if (all(found%segment == 0)) return
    k = 1
    if (found(2)%depth*found(1)%allowed > found(1)%depth*found(2)%allowed &
      .or. found(1)%segment == 0) k = 2
    call reject_field(deck, entry%places(2), what//depth_text(model, sides(3 - k), found(k)))
  end subroutine check_between

  !> Which place lies how deep, behind what, and how deep it may.
  function depth_text(model, other, found) result(text)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: other
    type(overlap_t), intent(in) :: found
    character(:), allocatable :: text

    text = 'node '//to_text(model%mesh%node_id(found%nodes(1)))
    if (found%nodes(1) /= found%nodes(2)) text = 'a place between nodes ' &
      //to_text(model%mesh%node_id(found%nodes(1)))//' and ' &
      //to_text(model%mesh%node_id(found%nodes(2)))
    text = text//' lies '//to_text(found%depth)//in_units(model%controls%units, 'L') &
      //' deep behind the segment between ' &
      //ends_text(model, other, found%segment)//'; contact takes up less than ' &
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

end module deck_resolve_contacts_m
