! SPDX-License-Identifier: MIT
!> Interfaces and transducers of a deck: their cards, their surfaces, and checks against the
!> implicit method, eroding elements and implicit penalties.
module deck_contacts_m
  use kinds_m, only : long, wp
  use log_m, only : to_text
  use contacts_m, only : contact_t, contact_kind_t, is_tied, &
    penalty_implicit, penalty_share
  use surfaces_m, only : surface_t, part_at_axis
  use model_m, only : model_t
  use boundary_m, only : find_boundary
  use deck_lines_m, only : deck_t, location_t, blocks_of, line_error, line_warning
  use deck_fields_m, only : card_t, field_number
  use deck_cards_m, only : reject_field, warn_of_field
  use deck_choose_type_m, only : choose_type
  use deck_contact_m, only : contact_cards_t, transducer, read_contact
  use deck_contact_sides_m, only : mesh_boundary_t, find_side, set_nodes, mark_surface, &
    find_surface, check_overlap
  use deck_control_m, only : control_cards, warn_of_explicit
  use deck_friction_m, only : default_friction_t, read_friction_rule, warn_of_unused
  use deck_loads_m, only : orient_pressures
  use deck_plane_stress_m, only : set_contact_thickness
  use deck_overrides_m, only : check_words
  use deck_values_m, only : integer_of, real_of, has_field, location_of, refuse_duplicates
  use sorting_m, only : index_among, sorted_order
  implicit none
  private
  public :: read_contacts

contains

  !> Read all interfaces and transducers, and orient the edges of pressure loads. Everything else
  !> except termination conditions has been read.
  subroutine read_contacts(deck, kinds, locations, is_sound, body, model)
    type(deck_t), intent(inout) :: deck
    type(contact_kind_t), intent(in) :: kinds(:)          !! contact types that exist
    type(location_t), intent(in) :: locations(:)          !! of the pressure loads
    logical, intent(in) :: is_sound(:)                    !! (n_element) elements not refused
    type(mesh_boundary_t), intent(inout) :: body          !! its outer edges are set here
    type(model_t), intent(inout) :: model
    type(contact_cards_t), allocatable :: contacts(:), transducers(:)
    integer :: i

    call read_all(deck, kinds, model, contacts, transducers)
    if (model%controls%implicit%is_on) then
      do i = 1, size(contacts)
        call check_implicit_method(deck, contacts(i))
      end do
    end if
    call set_outer_edges(deck, contacts, is_sound, model, body)
    call orient_pressures(deck, locations, body%outside, body%is_uncertain, model)
    allocate (model%contacts(size(contacts)))
    do i = 1, size(contacts)
      call build_surfaces(deck, body, model, contacts(i))
      model%contacts(i) = contacts(i)%contact
      if (body%is_sound) call set_contact_thickness(deck, &
        deck%blocks(contacts(i)%block)%keyword, model, model%contacts(i))
    end do
    if (body%is_sound) then
      if (model%erodes) call check_eroding_contacts(deck, contacts, model)
    end if
    call build_transducers(deck, transducers, body, model)
    if (body%is_sound .and. model%is_axisymmetric) then
      model%contacts%is_axisymmetric = .true.
      do i = 1, size(model%contacts)
        associate (slave => model%contacts(i)%slave, master => model%contacts(i)%master, &
          radii => model%mesh%coordinates(1, :))
          slave%is_on_axis = .not. radii(slave%nodes) > 0.0_wp
          master%is_on_axis = .not. radii(master%nodes) > 0.0_wp
          call part_at_axis(slave)
          call part_at_axis(master)
        end associate
      end do
    end if
    call check_implicit_penalties(deck, contacts, model, body%is_sound)
  end subroutine read_contacts

  !> Read the cards, those of *CONTROL_CONTACT first; numbers must be unique.
  subroutine read_all(deck, kinds, model, contacts, transducers)
    type(deck_t), intent(inout) :: deck
    type(contact_kind_t), intent(in) :: kinds(:)
    type(model_t), intent(inout) :: model
    type(contact_cards_t), allocatable, intent(out) :: contacts(:), transducers(:)
    type(contact_cards_t) :: entry
    type(default_friction_t) :: default
    type(card_t) :: cards(6)
    integer, allocatable :: blocks(:), ids(:)
    logical, allocatable :: measures(:)
    integer :: i, n

    blocks = blocks_of(deck, 'CONTROL_CONTACT')
    do i = 1, size(blocks)
      call control_cards(deck, blocks(i), cards)
      model%controls%penalty_scale = real_of(cards(1), 'SLSFAC')
      model%controls%contact_step = integer_of(cards(2), 'ECDT')
      if (model%controls%implicit%is_on) call warn_of_explicit(deck, cards(2), 'ECDT')
      call read_friction_rule(cards(3), cards(3), ['SFRIC', 'DFRIC', 'EDC  ', 'VFC  '], &
        default%rule, default%location)
    end do
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
    call refuse_duplicates(deck, ids, [deck%blocks(blocks)%keyword], 'interface number ', &
      'interface (without a number it is the position in the deck)')
    call warn_of_unused(deck, default)
    call check_words(deck, pack(ids, .not. measures))
  end subroutine read_all

  !> Find the outer edges between nodes of contact sets and of pressure loads, and the nodes of
  !> refused elements.
  subroutine set_outer_edges(deck, contacts, is_sound, model, body)
    type(deck_t), intent(in) :: deck
    type(contact_cards_t), intent(in) :: contacts(:)
    logical, intent(in) :: is_sound(:)
    type(model_t), intent(in) :: model
    type(mesh_boundary_t), intent(inout) :: body
    logical, allocatable :: among(:)
    integer :: i, k, n, kind, found

    allocate (among(model%mesh%n_node), source=.false.)
    do i = 1, size(contacts)
      do k = 1, 2
        call find_side(deck, contacts(i), k, kind, found)
        among(set_nodes(model, kind, found)) = .true.
      end do
    end do
    do i = 1, size(model%conditions%pressures)
      among(model%conditions%pressures(i)%nodes) = .true.
    end do
    allocate (body%is_uncertain(model%mesh%n_node), source=.not. (body%is_sound .or. any(is_sound)))
    do i = 1, size(is_sound)
      if (body%is_sound .or. is_sound(i)) cycle
      do k = 1, 4
        n = model%mesh%element_nodes(k, i)
        if (n > 0) body%is_uncertain(n) = .true.
      end do
    end do
    call find_boundary(model%mesh%element_nodes, is_sound, among, body%outside, &
      model%mesh%hanging)
    call sort_by_part(model, body)
  end subroutine set_outer_edges

  !> Sort the elements by part, so that an interface visits its own elements only. Part 0: refused.
  subroutine sort_by_part(model, body)
    type(model_t), intent(in) :: model
    type(mesh_boundary_t), intent(inout) :: body
    integer :: i

    allocate (body%ends(0:size(model%parts)), source=0)
    if (model%mesh%n_element == 0) then
      allocate (body%elements(0))
      return
    end if
    body%elements = sorted_order(int(model%mesh%element_part, long))
    do i = 1, model%mesh%n_element
      associate (n => body%ends(model%mesh%element_part(i)))
        n = n + 1
      end associate
    end do
    do i = 1, size(model%parts)
      body%ends(i) = body%ends(i) + body%ends(i - 1)
    end do
  end subroutine sort_by_part

  !> Build and check the surfaces of an interface, and choose its type where CTYPE is 0.
  subroutine build_surfaces(deck, body, model, entry)
    type(deck_t), intent(inout) :: deck
    type(mesh_boundary_t), intent(in) :: body
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
    call check_overlap(deck, entry, sides, body, model)
    ! The choice depends on conditions and materials, which must be free of errors.
    if (deck%report%n_error == 0) call choose_type(deck, entry%block, model, entry%contact)
  end subroutine build_surfaces

  !> Report nodes that both sides of an interface share.
  subroutine check_common_nodes(deck, entry, sides, model)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: entry
    type(surface_t), intent(in) :: sides(2)
    type(model_t), intent(in) :: model
    integer, allocatable :: shared(:), order(:)
    character(:), allocatable :: names
    integer :: i, n

    if (size(sides(1)%nodes) == 0 .or. size(sides(2)%nodes) == 0) return
    order = sorted_order(int(sides(1)%nodes, long))
    shared = pack(sides(2)%nodes, [(index_among(sides(1)%nodes, order, sides(2)%nodes(i)) > 0, &
      i=1, size(sides(2)%nodes))])
    n = size(shared)
    names = ''
    do i = 1, min(n, 5)
      names = names//' '//to_text(model%mesh%node_id(shared(i)))
    end do
    if (n > 5) names = names//' and '//to_text(n - 5)//' more'
    if (n > 0) call reject_field(deck, location_of(entry%cards(1), 'SURFB'), &
      'shares nodes with the slave surface:'//names)
  end subroutine check_common_nodes

  !> Build the transducers: the nodes of each that belong to interfaces.
  subroutine build_transducers(deck, entries, body, model)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: entries(:)
    type(mesh_boundary_t), intent(in) :: body
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
          deck%blocks(entry%block)%keyword, 'transducer'//to_text(transducer%id), &
          'transducer '//to_text(transducer%id)//' has no nodes of an interface: its forces are 0')
      end associate
    end do
  end subroutine build_transducers

  !> Report fields of an interface that the implicit method does not support.
  subroutine check_implicit_method(deck, entry)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: entry
    character(*), parameter :: no_effect = 'has no effect with the implicit method'
    character(:), allocatable :: reason
    integer :: k

    ! Stock cards have damping by default, which is no choice of the user's.
    if (entry%contact%damping > 0.0_wp) then
      k = merge(2, 3, has_field(entry%cards(2), 'VDC'))
      if (.not. entry%cards(k)%blank(field_number(entry%cards(k)%names, 'VDC'))) &
        call line_warning(deck, deck%blocks(entry%block)%keyword, 'implicit contact damping', &
        'contact damping (VDC) '//no_effect)
    end if
    if (entry%contact%search_interval > 0) call warn_of_field(deck, &
      location_of(entry%cards(merge(1, 2, has_field(entry%cards(1), 'FREQ'))), 'FREQ'), no_effect)
    select case (entry%contact%penalty_unit)
    case (penalty_share)
      reason = 'asks for a share of the largest stable penalty of an explicit step'
    case (penalty_implicit)
      reason = 'asks for the implicit springs of explicit steps'
    case default
      return
    end select
    call reject_field(deck, location_of(entry%cards(2), 'PUNIT'), reason//', which the implicit ' &
      //'method does not have (0, 1 or 2)')
  end subroutine check_implicit_method

  !> Report ties and interference curves on surfaces that may erode.
  subroutine check_eroding_contacts(deck, contacts, model)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: contacts(:)
    type(model_t), intent(in) :: model
    logical :: may_erode(size(model%materials))
    integer :: i, m

    do m = 1, size(model%materials)
      may_erode(m) = allocated(model%materials(m)%erosion)
    end do
    do i = 1, size(contacts)
      associate (contact => contacts(i)%contact)
        if (.not. (is_tied(contact) .or. allocated(contact%interference))) cycle
        if (.not. (touches(contact%slave%segment_element) &
          .or. touches(contact%master%segment_element))) cycle
        call line_error(deck, deck%blocks(contacts(i)%block)%keyword, trim(merge( &
          'ties                             ', 'has an interference curve (LCINT)', &
          is_tied(contact)))//' on elements that may erode, which this version does not have')
      end associate
    end do

  contains

    !> Whether some of the elements may erode.
    pure function touches(elements)
      integer, intent(in) :: elements(:)
      logical :: touches

      touches = any(may_erode(model%parts(model%mesh%element_part(elements))%material))
    end function touches

  end subroutine check_eroding_contacts

  !> Report fields that implicit penalties (PUNIT 4) do not support.
  subroutine check_implicit_penalties(deck, contacts, model, sound)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: contacts(:)
    type(model_t), intent(in) :: model
    logical, intent(in) :: sound !! the interfaces have their surfaces
    integer :: i

    if (.not. any(contacts%contact%penalty_unit == penalty_implicit)) return
    do i = 1, size(contacts)
      associate (entry => contacts(i), contact => contacts(i)%contact)
        if (contact%penalty_unit /= penalty_implicit) cycle
        if (contact%is_self) call refuse(deck, entry, 'do not support self contact')
        if (is_tied(contact)) call refuse(deck, entry, 'do not support ties (TIE)')
        if (contact%damping > 0.0_wp) call refuse(deck, entry, 'have no damping (VDC)')
        if (allocated(contact%interference)) call refuse(deck, entry, &
          'do not support interference curves (LCINT)')
        if (model%erodes) call refuse(deck, entry, 'do not support eroding elements')
      end associate
    end do
    if (sound) call check_shared_nodes(deck, contacts, model)
    if (sound) call check_shared_bodies(deck, contacts, model)
  end subroutine check_implicit_penalties

  !> Report nodes of implicit penalties that another interface, a rigid wall, a
  !> *CONSTRAINED_NODE_SET or a skew support has too, one error for each.
  subroutine check_shared_nodes(deck, contacts, model)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: contacts(:)
    type(model_t), intent(in) :: model
    integer, parameter :: most = 4 !! maximum number of owners of a node
    integer, allocatable :: owners(:, :), reported(:), nodes(:), others(:)
    character(:), allocatable :: name
    integer :: i, k, n, free, n_contact, n_wall

    n_contact = size(contacts)
    n_wall = 0
    if (allocated(model%walls)) n_wall = size(model%walls)
    n = n_contact + n_wall + 1
    if (allocated(model%conditions%common_motions)) n = n + size(model%conditions%common_motions)
    allocate (owners(most, model%mesh%n_node), source=0)
    do i = 1, n
      call get_owner(i, nodes, name)
      do k = 1, size(nodes)
        free = findloc(owners(:, nodes(k)), 0, 1)
        if (free > 0) owners(free, nodes(k)) = i
      end do
    end do
    do i = 1, size(contacts)
      if (contacts(i)%contact%penalty_unit /= penalty_implicit) cycle
      reported = [0, i]
      call get_owner(i, nodes, name)
      do k = 0, most*size(nodes) - 1
        associate (node => nodes(1 + k/most), owner => owners(1 + modulo(k, most), &
          nodes(1 + k/most)))
          if (any(reported == owner)) cycle
          reported = [reported, owner]
          call get_owner(owner, others, name)
          call refuse(deck, contacts(i), 'cannot share nodes: node ' &
            //to_text(model%mesh%node_id(node))//' belongs to '//name//' too')
        end associate
      end do
    end do

  contains

    !> Nodes and name of an owner: interfaces, then walls, *CONSTRAINED_NODE_SET, skew supports.
    subroutine get_owner(owner, nodes, name)
      integer, intent(in) :: owner
      integer, allocatable, intent(out) :: nodes(:)
      character(:), allocatable, intent(out) :: name

      allocate (nodes(0))
      if (owner <= n_contact) then
        nodes = [contacts(owner)%contact%slave%nodes, contacts(owner)%contact%master%nodes]
        name = 'interface '//to_text(contacts(owner)%contact%id)
      else if (owner <= n_contact + n_wall) then
        nodes = model%walls(owner - n_contact)%nodes
        name = 'rigid wall '//to_text(model%walls(owner - n_contact)%id)
      else if (owner < n) then
        nodes = model%conditions%common_motions(owner - n_contact - n_wall)%nodes
        name = 'a *CONSTRAINED_NODE_SET'
      else
        if (allocated(model%conditions%skew_supports)) nodes = model%conditions%skew_supports%node
        name = 'a support along an axis of a coordinate system'
      end if
    end subroutine get_owner

  end subroutine check_shared_nodes

  !> Report free rigid bodies in several interfaces with implicit penalties, one error for each:
  !> their pressures would be coupled.
  subroutine check_shared_bodies(deck, contacts, model)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: contacts(:)
    type(model_t), intent(in) :: model
    integer, allocatable :: body_of(:), n_interface(:), last(:), nodes(:)
    integer :: i, k, pass

    allocate (body_of(model%mesh%n_node), n_interface(0:size(model%rigids)), &
      last(0:size(model%rigids)))
    body_of = 0
    n_interface = 0
    do k = 1, size(model%rigids)
      if (.not. all(model%rigids(k)%is_fixed)) body_of(model%rigids(k)%nodes) = k
    end do
    do pass = 1, 2
      last = 0
      do i = 1, size(contacts)
        if (contacts(i)%contact%penalty_unit /= penalty_implicit) cycle
        last(0) = i
        nodes = [contacts(i)%contact%slave%nodes, contacts(i)%contact%master%nodes]
        do k = 1, size(nodes)
          associate (body => body_of(nodes(k)))
            if (last(body) == i) cycle
            last(body) = i
            if (pass == 1) n_interface(body) = n_interface(body) + 1
            if (pass == 2 .and. n_interface(body) > 1) call refuse(deck, contacts(i), &
              'cannot share a free rigid body: part ' &
              //to_text(model%parts(model%rigids(body)%part)%id) &
              //' is in another interface with PUNIT 4 too')
          end associate
        end do
      end do
    end do
  end subroutine check_shared_bodies

  !> Report an error of an interface with implicit penalties.
  subroutine refuse(deck, entry, message)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: entry
    character(*), intent(in) :: message

    call reject_field(deck, location_of(entry%cards(2), 'PUNIT'), &
      'asks for implicit springs, which '//'in this version '//message)
  end subroutine refuse

end module deck_contacts_m
