! SPDX-License-Identifier: MIT
!> Interfaces and transducers of a deck: their cards, then their surfaces. Surfaces that can not be
!> right as the bodies stand at time zero are refused: one that crosses or overlaps itself, and
!> bodies that overlap deeper than contact between whole outlines takes up.
module deck_contacts_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use contacts_m, only : contact_t, contact_kind_t, friction_rule_t, breaks, tie_none
  use controls_m, only : controls_t
  use surfaces_m, only : surface_t, has_closed_chain
  use model_m, only : model_t
  use boundary_m, only : find_boundary
  use deck_lines_m, only : deck_t, place_t, blocks_of, line_warning
  use deck_fields_m, only : card_t
  use deck_cards_m, only : reject_field
  use deck_choose_type_m, only : choose_type
  use deck_contact_m, only : contact_cards_t, transducer, side_fields, read_contact
  use deck_contact_rules_m, only : check_implicit_method, check_implicit_penalties, &
    check_eroding_contacts
  use deck_contact_sides_m, only : outline_t, find_side, mark_set, mark_surface, find_surface
  use deck_control_m, only : control_cards, warn_of_explicit
  use deck_friction_m, only : default_friction_t, take_default_friction, warn_of_unused
  use deck_loads_m, only : settle_pressures
  use deck_overrides_m, only : check_words
  use units_m, only : in_units
  use element_finder_m, only : body_view_t, view_body
  use initial_overlap_m, only : overlap_t, find_crossing, find_overlap
  use deck_values_m, only : integer_of, real_of, place_of, refuse_again
  implicit none
  private
  public :: read_contacts

contains

  !> All interfaces and transducers, and the edges of pressure loads. All else but ends is known.
  subroutine read_contacts(deck, kinds, places, is_sound, body, model)
    type(deck_t), intent(inout) :: deck
    type(contact_kind_t), intent(in) :: kinds(:)          !! contact types that exist
    type(place_t), intent(in) :: places(:)                !! where each pressure load stands
    logical, intent(in) :: is_sound(:)                    !! (n_element) elements not refused
    type(outline_t), intent(inout) :: body                !! gets the outer edges
    type(model_t), intent(inout) :: model
    type(contact_cards_t), allocatable :: contacts(:), transducers(:)
    type(default_friction_t) :: default
    integer :: i

    call read_default(deck, model%controls, default)
    call read_all(deck, kinds, default, model, contacts, transducers)
    if (model%controls%implicit%is_on) then
      do i = 1, size(contacts)
        call check_implicit_method(deck, contacts(i))
      end do
    end if
    call look_outside(deck, contacts, is_sound, model, body)
    call settle_pressures(deck, places, body%outside, body%in_doubt, model)
    allocate (model%contacts(size(contacts)))
    do i = 1, size(contacts)
      call take_surfaces(deck, body, model, contacts(i))
      model%contacts(i) = contacts(i)%contact
    end do
    if (body%is_sound) then
      call append_behind(model%contacts)
      if (model%erodes) call check_eroding_contacts(deck, contacts, model)
    end if
    call take_transducers(deck, transducers, body, model)
    if (body%is_sound .and. model%is_round) call mark_round_contacts(model)
    call check_implicit_penalties(deck, contacts, model, body%is_sound)
  end subroutine read_contacts

  !> *CONTROL_CONTACT.
  subroutine read_default(deck, controls, default)
    type(deck_t), intent(inout) :: deck
    type(controls_t), intent(inout) :: controls
    type(default_friction_t), intent(out) :: default
    type(card_t) :: cards(6)
    integer, allocatable :: blocks(:)
    integer :: i

    blocks = blocks_of(deck, 'CONTROL_CONTACT')
    do i = 1, size(blocks)
      call control_cards(deck, blocks(i), cards)
      controls%penalty_scale = real_of(cards(1), 'SLSFAC')
      controls%contact_step = integer_of(cards(2), 'ECDT')
      if (controls%implicit%is_on) call warn_of_explicit(deck, cards(2), 'ECDT')
      call take_default_friction(cards(3), default)
    end do
  end subroutine read_default

  !> The cards, each number that of one thing.
  subroutine read_all(deck, kinds, default, model, contacts, transducers)
    type(deck_t), intent(inout) :: deck
    type(contact_kind_t), intent(in) :: kinds(:)
    type(default_friction_t), intent(inout) :: default
    type(model_t), intent(in) :: model
    type(contact_cards_t), allocatable, intent(out) :: contacts(:), transducers(:)
    type(contact_cards_t) :: entry
    integer, allocatable :: blocks(:), ids(:)
    logical, allocatable :: measures(:)
    integer :: i, n

    blocks = blocks_of(deck, 'CONTACT_')
    measures = deck%blocks(blocks)%name == transducer
    allocate (contacts(count(.not. measures)), transducers(count(measures)))
    allocate (ids(size(blocks)))
    n = 0
    do i = 1, size(blocks)
      entry = contact_cards_t(block=blocks(i), position=i)
      call read_contact(deck, entry, kinds, model, default)
      if (measures(i)) then
        transducers(i - n) = entry
      else
        n = n + 1
        contacts(n) = entry
      end if
      ids(i) = entry%contact%id
    end do
    call refuse_again(deck, ids, [deck%blocks(blocks)%keyword], 'interface number ', &
      'interface (without a number it is the position in the deck)')
    call warn_of_unused(deck, default)
    call check_words(deck, pack(ids, .not. measures))
  end subroutine read_all

  !> The outer edges between nodes of contact node and segment sets and of pressure loads, and the
  !> nodes of refused elements.
  subroutine look_outside(deck, contacts, is_sound, model, body)
    type(deck_t), intent(in) :: deck
    type(contact_cards_t), intent(in) :: contacts(:)
    logical, intent(in) :: is_sound(:)
    type(model_t), intent(in) :: model
    type(outline_t), intent(inout) :: body
    logical, allocatable :: among(:)
    integer :: i, k, n, kind, found

    allocate (among(model%mesh%n_node), source=.false.)
    do i = 1, size(contacts)
      do k = 1, 2
        call find_side(deck, contacts(i), k, kind, found)
        call mark_set(model, kind, found, among)
      end do
    end do
    do i = 1, size(model%conditions%pressures)
      among(model%conditions%pressures(i)%nodes) = .true.
    end do
    allocate (body%in_doubt(model%mesh%n_node), source=.not. (body%is_sound .or. any(is_sound)))
    do i = 1, size(is_sound)
      if (body%is_sound .or. is_sound(i)) cycle
      do k = 1, 4
        n = model%mesh%element_nodes(k, i)
        if (n > 0) body%in_doubt(n) = .true.
      end do
    end do
    call find_boundary(model%mesh%element_nodes, is_sound, among, body%outside)
  end subroutine look_outside

  !> Give an interface its surfaces, with what is wrong with them and the type that the program
  !> chooses.
  subroutine take_surfaces(deck, body, model, entry)
    type(deck_t), intent(inout) :: deck
    type(outline_t), intent(in) :: body
    type(model_t), intent(in) :: model
    type(contact_cards_t), intent(inout) :: entry
    type(surface_t) :: sides(2)
    integer :: k, n_error

    n_error = deck%report%n_error
    do k = 1, merge(1, 2, entry%contact%is_self)
      call find_surface(deck, entry, k, body, model, sides(k))
    end do
    if (entry%contact%is_self) then
      sides(2) = sides(1)
    else
      call check_common_nodes(deck, entry, sides, model)
    end if
    if (.not. body%is_sound) return
    entry%contact%slave = sides(1)
    entry%contact%master = sides(2)
    if (deck%report%n_error > n_error) return
    call check_overlap(deck, entry, sides, model)
    ! The choice looks at conditions and materials: they have to be sound as well.
    if (deck%report%n_error == 0) call choose_type(deck, entry%block, model, entry%contact)
  end subroutine take_surfaces

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

  !> A node may stand on one side of an interface only.
  subroutine check_common_nodes(deck, entry, sides, model)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: entry
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
    if (n > 0) call reject_field(deck, place_of(entry%cards(1), 'SURFB'), &
      'shares nodes with the slave surface:'//names)
  end subroutine check_common_nodes

  !> Check one interface. With a birth time after zero bodies may be anywhere before it; between
  !> open chains penetrations are taken as they are, however deep.
  subroutine check_overlap(deck, entry, sides, model)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: entry
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
      call reject_field(deck, place_of(entry%cards(1), side_fields(k)), 'is a surface that ' &
        //'crosses itself: the segment between '//ends_text(model, sides(k), pair(1)) &
        //' crosses the one between '//ends_text(model, sides(k), pair(2)))
    end do
    if (crosses .or. entry%contact%birth > 0.0_wp) return
    if (.not. (has_closed_chain(sides(1)) .or. has_closed_chain(sides(2)))) return
    do k = 1, n_side
      call find_overlap(model, sides(k), sides(k), views(k), .true., found)
      if (found%segment > 0) call reject_field(deck, place_of(entry%cards(1), side_fields(k)), &
        'is a surface that overlaps itself: '//depth_text(model, sides(k), found))
    end do
    if (n_side == 2) call check_between(deck, entry, sides, views, model)
  end subroutine check_overlap

  !> Either side in the bodies of the other: the deeper one by the depth allowed is told.
  subroutine check_between(deck, entry, sides, views, model)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: entry
    type(surface_t), intent(in) :: sides(2)
    type(body_view_t), intent(in) :: views(2)
    type(model_t), intent(in) :: model
    type(overlap_t) :: found(2)
    integer :: k

    do k = 1, 2
      call find_overlap(model, sides(k), sides(3 - k), views(3 - k), .false., found(k))
    end do
    if (all(found%segment == 0)) return
    k = 1
    if (found(2)%depth*found(1)%allowed > found(1)%depth*found(2)%allowed &
      .or. found(1)%segment == 0) k = 2
    call reject_field(deck, place_of(entry%cards(1), 'SURFB'), 'overlaps the slave surface at ' &
      //'the start: '//depth_text(model, sides(3 - k), found(k)))
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

  !> Of each transducer the nodes that interfaces have: no others carry contact forces.
  subroutine take_transducers(deck, entries, body, model)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: entries(:)
    type(outline_t), intent(in) :: body
    type(model_t), intent(inout) :: model
    logical, allocatable :: touches(:), is_on(:) !! (n_node)
    integer :: i, k

    if (size(entries) == 0) return
    allocate (touches(model%mesh%n_node), is_on(model%mesh%n_node), source=.false.)
    if (body%is_sound) then
      do i = 1, size(model%contacts)
        touches(model%contacts(i)%slave%nodes) = .true.
        touches(model%contacts(i)%master%nodes) = .true.
      end do
    end if
    allocate (model%transducers(size(entries)))
    do i = 1, size(entries)
      call mark_surface(deck, entries(i), body, model, is_on)
      associate (transducer => model%transducers(i), entry => entries(i))
        transducer%id = entry%contact%id
        transducer%title = entry%contact%title
        transducer%nodes = pack([(k, k=1, size(is_on))], is_on .and. touches)
        if (size(transducer%nodes) == 0 .and. body%is_sound) call line_warning(deck, &
          deck%blocks(entry%block)%keyword, 'transducer'//to_text(transducer%id), 'no interface ' &
          //'has nodes of the surface of transducer '//to_text(transducer%id) &
          //': it measures nothing')
      end associate
    end do
  end subroutine take_transducers

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

end module deck_contacts_m
