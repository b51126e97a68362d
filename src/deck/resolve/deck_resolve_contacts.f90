! SPDX-License-Identifier: MIT
!> Surfaces of the interfaces and edges of the pressure loads of sound meshes. Surfaces that can not
!> be right as the bodies stand at time zero are refused: one that crosses or overlaps itself, and
!> bodies that overlap deeper than contact between whole outlines takes up.
module deck_resolve_contacts_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use contacts_m, only : contact_t, friction_rule_t, breaks, tie_none, is_tied, penalty_implicit
  use surfaces_m, only : surface_t, has_closed_chain
  use model_m, only : model_t
  use boundary_m, only : boundary_t, find_boundary
  use deck_lines_m, only : deck_t, line_warning
  use deck_cards_m, only : reject_field
  use deck_choose_type_m, only : choose_type
  use deck_loads_m, only : settle_pressures
  use deck_resolve_sides_m, only : find_side, resolve_side, side_nodes, side_segments
  use deck_raw_m, only : raw_t, raw_contact_t
  use units_m, only : in_units
  use element_finder_m, only : body_view_t, view_body
  use initial_overlap_m, only : overlap_t, find_crossing, find_overlap
  use deck_ids_m, only : a_curve
  use deck_values_m, only : resolve_id
  implicit none
  private
  public :: resolve_contacts, check_common_nodes, resolve_interference, check_implicit_penalties

  !> How near to 0 and 1 the ends of a curve of interference must be: that is round-off of factors.
  real(wp), parameter :: round_off = 1.0e-12_wp

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

  !> Give the interface its curve, which must lead from 0 to 1.
  subroutine resolve_interference(deck, entry, model, contact)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    type(model_t), intent(in) :: model
    type(contact_t), intent(inout) :: contact
    integer :: found, n

    found = 0
    if (entry%interference > 0) call resolve_id(deck, a_curve, entry%interference, &
      entry%interference_place, found)
    if (found == 0) return
    associate (curve => model%curves(found))
      n = size(curve%ordinate)
      if (n == 0) return
      if (abs(curve%ordinate(1)) > round_off) call refuse_curve('begins at ' &
        //to_text(curve%ordinate(1))//', not at 0')
      if (abs(curve%ordinate(n) - 1.0_wp) > round_off) call refuse_curve('ends at ' &
        //to_text(curve%ordinate(n))//', not at 1')
      if (minval(curve%ordinate) < -round_off .or. maxval(curve%ordinate) > 1.0_wp + round_off) &
        call refuse_curve('leaves the range from 0 to 1')
      if (curve%abscissa(1) < 0.0_wp) call refuse_curve('begins at the time ' &
        //to_text(curve%abscissa(1))//', before the run')
      if (curve%abscissa(n) > model%controls%end_time) call line_warning(deck, &
        entry%interference_place%line, 'interference'//to_text(contact%id), 'interface ' &
        //to_text(contact%id)//': the curve of its interference ends at '//to_text( &
        curve%abscissa(n))//in_units(model%controls%units, 'T') &
        //', after the run; the overlap does not act in full')
      contact%interference = curve
    end associate

  contains

    !> What is wrong with the curve.
    subroutine refuse_curve(what)
      character(*), intent(in) :: what

      call reject_field(deck, entry%interference_place, 'is a curve of interference that '//what)
    end subroutine refuse_curve

  end subroutine resolve_interference

  !> What implicit penalties (PUNIT 4) do not have: refused by name.
  subroutine check_implicit_penalties(deck, raw, model, sound)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    logical, intent(in) :: sound !! the interfaces have their surfaces
    integer :: i

    if (.not. any(raw%contacts%contact%penalty_unit == penalty_implicit)) return
    do i = 1, size(raw%contacts)
      associate (entry => raw%contacts(i), contact => raw%contacts(i)%contact)
        if (contact%penalty_unit /= penalty_implicit) cycle
        if (contact%is_self) call refuse(deck, entry, 'do not act between a surface and itself')
        if (is_tied(contact)) call refuse(deck, entry, 'only push: a tie (TIE) has other springs')
        if (contact%damping > 0.0_wp) call refuse(deck, entry, 'have no damping of their own (VDC)')
        if (entry%interference > 0) call refuse(deck, entry, &
          'have no initial overlap that grows (LCINT)')
        if (model%erodes) call refuse(deck, entry, 'do not act where elements may leave the mesh')
      end associate
    end do
    if (sound) call check_shared_nodes(deck, raw, model)
    if (sound) call check_shared_bodies(deck, raw, model)
  end subroutine check_implicit_penalties

  !> One error for each interface, rigid wall, set of nodes that move alike and skew support that
  !> has nodes of such an interface too.
  subroutine check_shared_nodes(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    integer, parameter :: most = 4 !! owners of a node that are known
    integer, allocatable :: owners(:, :), told(:), nodes(:)
    integer :: i, k, n, n_wall, n_alike

    allocate (owners(most, model%mesh%n_node), source=0)
    n = size(raw%contacts)
    n_wall = 0
    n_alike = 0
    do i = 1, n
      call own(i, [model%contacts(i)%slave%nodes, model%contacts(i)%master%nodes])
    end do
    if (allocated(model%walls)) n_wall = size(model%walls)
    do i = 1, n_wall
      call own(n + i, model%walls(i)%nodes)
    end do
    if (allocated(model%conditions%common_motions)) n_alike = size(model%conditions%common_motions)
    do i = 1, n_alike
      call own(n + n_wall + i, model%conditions%common_motions(i)%nodes)
    end do
    if (allocated(model%conditions%skew_supports)) call own(n + n_wall + n_alike + 1, &
      [model%conditions%skew_supports%node])
    do i = 1, n
      if (raw%contacts(i)%contact%penalty_unit /= penalty_implicit) cycle
      told = [0, i]
      nodes = [model%contacts(i)%slave%nodes, model%contacts(i)%master%nodes]
      do k = 0, most*size(nodes) - 1
        associate (node => nodes(1 + k/most), owner => owners(1 + modulo(k, most), &
          nodes(1 + k/most)))
          if (any(told == owner)) cycle
          told = [told, owner]
          call refuse(deck, raw%contacts(i), 'share no nodes with others: node ' &
            //to_text(model%mesh%node_id(node))//' belongs to '//name_of(owner)//' too')
        end associate
      end do
    end do

  contains

    !> Nodes of an owner.
    subroutine own(owner, nodes)
      integer, intent(in) :: owner, nodes(:)
      integer :: j, free

      do j = 1, size(nodes)
        free = findloc(owners(:, nodes(j)), 0, 1)
        if (free > 0) owners(free, nodes(j)) = owner
      end do
    end subroutine own

    !> An owner in words.
    function name_of(owner) result(name)
      integer, intent(in) :: owner
      character(:), allocatable :: name

      if (owner <= n) then
        name = 'interface '//to_text(model%contacts(owner)%id)
      else if (owner <= n + n_wall) then
        name = 'rigid wall '//to_text(model%walls(owner - n)%id)
      else if (owner <= n + n_wall + n_alike) then
        name = 'a set of nodes that move alike'
      else
        name = 'a support along neither x nor y'
      end if
    end function name_of

  end subroutine check_shared_nodes

  !> One error for each rigid body, free to move, that another such interface presses too: the
  !> pressures of both would depend on each other.
  subroutine check_shared_bodies(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    integer, allocatable :: body_of(:), n_press(:), last(:)
    integer :: i, k, pass

    allocate (body_of(model%mesh%n_node), n_press(0:size(model%rigids)), last(0:size(model%rigids)))
    body_of = 0
    n_press = 0
    do k = 1, size(model%rigids)
      if (.not. all(model%rigids(k)%is_fixed)) body_of(model%rigids(k)%nodes) = k
    end do
    do pass = 1, 2
      last = 0
      do i = 1, size(raw%contacts)
        if (raw%contacts(i)%contact%penalty_unit /= penalty_implicit) cycle
        last(0) = i
        associate (nodes => [model%contacts(i)%slave%nodes, model%contacts(i)%master%nodes])
          do k = 1, size(nodes)
            associate (body => body_of(nodes(k)))
              if (last(body) == i) cycle
              last(body) = i
              if (pass == 1) n_press(body) = n_press(body) + 1
              if (pass == 2 .and. n_press(body) > 1) call refuse(deck, raw%contacts(i), &
                'share no rigid body that may move: part ' &
                //to_text(model%parts(model%rigids(body)%part)%id) &
                //' is pressed by another interface of PUNIT 4 too')
            end associate
          end do
        end associate
      end do
    end do
  end subroutine check_shared_bodies

  !> An error of an interface with implicit penalties.
  subroutine refuse(deck, entry, message)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    character(*), intent(in) :: message

    call reject_field(deck, entry%unit_place, 'asks for implicit springs, which in this version ' &
      //message)
  end subroutine refuse

end module deck_resolve_contacts_m
