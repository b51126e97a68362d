! SPDX-License-Identifier: MIT
!> Nodes, elements, parts and sets with indices in place of ids, and the checks of the mesh, also of
!> one some elements of which are refused: mistakes that do not follow from theirs are told in the
!> same pass. What assumed strain and the implicit method ask of parts of one-point quads.
module deck_resolve_mesh_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use mesh_m, only : mesh_t
  use model_m, only : model_t
  use deck_ids_m, only : a_node, an_element, a_part
  use deck_lines_m, only : deck_t, place_t, line_error, line_warning
  use deck_cards_m, only : reject_field
  use deck_maps_m, only : resolve_id
  use deck_raw_m, only : raw_t
  use boundary_m, only : boundary_t, find_boundary
  use deck_interference_m, only : resolve_interference
  use deck_resolve_contacts_m, only : check_common_nodes
  use deck_loads_m, only : settle_pressures
  use deck_resolve_sides_m, only : find_side, require_side, resolve_side, side_nodes, side_segments
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: resolve_mesh, check_unsound_mesh, settle_axis

  !> Fields of the coordinates and of the first three nodes.
  !> Radii below this share of the largest are the axis.
  real(wp), parameter :: axis_share = 1.0e-10_wp
  character(1), parameter :: axes(2) = ['X', 'Y']
  character(2), parameter :: node_fields(3) = ['N1', 'N2', 'N3']

contains

  !> Radii must not be below zero; those that are none are made exactly zero.
  subroutine settle_axis(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    real(wp) :: reach
    integer :: i

    if (.not. model%is_round .or. model%mesh%n_node == 0) return
    reach = axis_share*maxval(model%mesh%coordinates(1, :))
    associate (x => model%mesh%coordinates)
      do i = 1, model%mesh%n_node
        if (x(1, i) < -reach) then
          call reject_field(deck, place_t(deck%maps(a_node)%lines(i), 1, 'X'), ': node ' &
            //to_text(model%mesh%node_id(i))//' lies at a radius below 0 (an axisymmetric deck ' &
            //'turns about x = 0, and x is the radius)')
        else if (x(1, i) <= reach) then
          x(1, i) = 0.0_wp
        end if
      end do
    end associate
  end subroutine settle_axis

  !> Nodes and elements. `sound` tells whether the elements may be looked at further.
  subroutine resolve_mesh(deck, raw, model, is_sound, sound)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(inout) :: raw   !! its node and element arrays move into the model
    type(model_t), intent(inout) :: model
    logical, allocatable, intent(out) :: is_sound(:) !! (n_element) of each whether its edges are
                                                     !! those that were meant
    logical, intent(out) :: sound
    integer :: i, n_before
    logical :: has_place

    sound = .false.
    n_before = deck%report%n_error
    if (raw%n_node == 0 .and. .not. deck%maps(a_node)%lost) &
      call line_error(deck, 0, 'the deck has no nodes (*NODE)')
    if (raw%n_element == 0 .and. .not. deck%maps(an_element)%lost) call &
      line_error(deck, 0, 'the deck has no elements (*ELEMENT_SHELL)')
    call check_plane(deck, raw)
    has_place = deck%report%n_error == n_before
    model%mesh%n_node = raw%n_node
    model%mesh%n_element = raw%n_element
    model%mesh%node_id = raw%node_id(:raw%n_node)
    model%mesh%coordinates = raw%coordinates(:, :raw%n_node)
    model%mesh%element_id = raw%element_id(:raw%n_element)
    deallocate (raw%node_id, raw%coordinates, raw%element_id)
    call resolve_elements(deck, raw, model%mesh)
    allocate (is_sound(raw%n_element))
    do i = 1, raw%n_element
      is_sound(i) = all(model%mesh%element_nodes(:, i) > 0)
    end do
    if (has_place) call check_shapes(deck, raw, model%mesh, is_sound)
    ! A part or node that was lost with its own mistake is not told again where it is named.
    if (.not. has_place .or. deck%maps(a_node)%lost .or. deck%maps(an_element)%lost) &
      is_sound = .false.
    sound = deck%report%n_error == n_before .and. raw%n_node > 0 .and. raw%n_element > 0 &
      .and. all(is_sound) .and. all(model%mesh%element_part > 0)
  end subroutine resolve_mesh

  !> Coordinates within reach and in one plane.
  subroutine check_plane(deck, raw)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    integer :: i, k

    do i = 1, raw%n_node
      do k = 1, 2
        if (abs(raw%coordinates(k, i)) > 1.0e30_wp) call reject_field(deck, &
          place_t(raw%node_line(i), 1, axes(k)), 'is out of reach (1e30)')
      end do
    end do
    if (raw%z_line > 0) then
      call reject_field(deck, place_t(raw%z_line, 1, 'Z'), &
        'is not the z of the first node: the mesh must lie in one plane z = constant')
    else if (raw%n_node > 0 .and. abs(raw%z_first) > 0.0_wp) then
      call line_warning(deck, raw%node_line(1), 'z', 'z is the same for all nodes and is ignored')
    end if
  end subroutine check_plane

  !> Node and part indices of the elements.
  subroutine resolve_elements(deck, raw, mesh)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(inout) :: raw
    type(mesh_t), intent(inout) :: mesh
    integer :: i, k, n, line, ids(4)

    n = raw%n_element
    if (n == size(raw%element_part)) then
      call move_alloc(raw%element_part, mesh%element_part)
      call move_alloc(raw%element_nodes, mesh%element_nodes)
    else
      mesh%element_part = raw%element_part(:n)
      mesh%element_nodes = raw%element_nodes(:, :n)
      deallocate (raw%element_part, raw%element_nodes)
    end if
    do i = 1, n
      line = raw%element_line(i)
      call resolve_id(deck, a_part, mesh%element_part(i), place_t(line, 1, 'PID'), k)
      mesh%element_part(i) = k
      ids = mesh%element_nodes(:, i)
      do k = 1, 3
        call resolve_id(deck, a_node, ids(k), place_t(line, 1, node_fields(k)), &
          mesh%element_nodes(k, i))
      end do
      mesh%element_nodes(4, i) = mesh%element_nodes(3, i)
      if (ids(4) /= ids(3)) call resolve_id(deck, a_node, ids(4), &
        place_t(line, 1, 'N4'), mesh%element_nodes(4, i))
    end do
  end subroutine resolve_elements

  !> Elements must have area, be convex and run counter-clockwise; clockwise ones are turned. Those
  !> with a node that does not exist have been refused.
  subroutine check_shapes(deck, raw, mesh, is_sound)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(mesh_t), intent(inout) :: mesh
    logical, intent(inout) :: is_sound(:) !! (n_element) what is refused here is not
    integer :: i, n_turned, first_turned
    real(wp) :: corners(4), area, tolerance

    n_turned = 0
    first_turned = 0
    do i = 1, mesh%n_element
      if (.not. is_sound(i)) cycle
      corners = corner_areas(mesh, i)
      if (mesh%element_nodes(4, i) == mesh%element_nodes(3, i)) then
        area = 2.0_wp*corners(1)
      else
        area = corners(1) + corners(3)
      end if
      tolerance = 1.0e-10_wp*maxval(abs(corners))
      is_sound(i) = .false.
      if (repeated(mesh%element_nodes(:, i))) then
        call reject_field(deck, place_t(raw%element_line(i), 1, 'EID'), 'uses a node twice ' &
          //'(a triangle repeats its third node, and no other)')
      else if (minval(corners) < -tolerance .and. maxval(corners) > tolerance) then
        call reject_field(deck, place_t(raw%element_line(i), 1, 'EID'), &
          'is not convex: its edges cross or a corner points inwards')
      else if (.not. abs(area) > 2.0_wp*tolerance) then
        call reject_field(deck, place_t(raw%element_line(i), 1, 'EID'), 'has no area')
      else
        is_sound(i) = .true.
        if (area > 0.0_wp) cycle
        mesh%element_nodes(:, i) = mesh%element_nodes([1, 4, 3, 2], i)
        if (mesh%element_nodes(2, i) == mesh%element_nodes(3, i)) &
          mesh%element_nodes(3:4, i) = mesh%element_nodes(4, i)
        n_turned = n_turned + 1
        if (n_turned == 1) first_turned = i
      end if
    end do
    if (n_turned > 0) call line_warning(deck, raw%element_line(first_turned), 'clockwise', &
      to_text(n_turned)//' element(s) were numbered clockwise and have been turned; the first is ' &
      //to_text(mesh%element_id(first_turned)))
  end subroutine check_shapes

  !> Twice the signed area of the triangle at each corner of an element.
  pure function corner_areas(mesh, i) result(areas)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: i
    real(wp) :: areas(4)
    real(wp) :: x(2, 4), before(2), after(2)
    integer :: k

    x = mesh%coordinates(:, mesh%element_nodes(:, i))
    if (mesh%element_nodes(4, i) == mesh%element_nodes(3, i)) x(:, 4) = x(:, 1)
    do k = 1, 4
      before = x(:, k) - x(:, mod(k + 2, 4) + 1)
      after = x(:, mod(k, 4) + 1) - x(:, k)
      if (mesh%element_nodes(4, i) == mesh%element_nodes(3, i)) then
        before = x(:, 2) - x(:, 1)
        after = x(:, 3) - x(:, 2)
      end if
      areas(k) = before(1)*after(2) - before(2)*after(1)
    end do
  end function corner_areas

  !> Whether a node comes twice, other than as the fourth node of a triangle.
  pure function repeated(nodes) result(twice)
    integer, intent(in) :: nodes(4)
    logical :: twice

    twice = nodes(1) == nodes(2) .or. nodes(1) == nodes(3) .or. nodes(2) == nodes(3) &
      .or. nodes(4) == nodes(1) .or. nodes(4) == nodes(2)
  end function repeated

  !> Wrong numbers always; edges where no refused element has their nodes.
  subroutine check_unsound_mesh(deck, raw, is_sound, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    logical, intent(in) :: is_sound(:)    !! (n_element)
    type(model_t), intent(inout) :: model !! gets interfaces without surfaces
    type(boundary_t) :: outside
    logical, allocatable :: in_doubt(:), all_nodes(:)
    integer :: i, k, n, kind, found

    allocate (in_doubt(model%mesh%n_node), source=.not. any(is_sound))
    do i = 1, size(is_sound)
      if (is_sound(i)) cycle
      do k = 1, 4
        n = model%mesh%element_nodes(k, i)
        if (n > 0) in_doubt(n) = .true.
      end do
    end do
    allocate (all_nodes(model%mesh%n_node), source=.true.)
    call find_boundary(model%mesh%element_nodes, is_sound, all_nodes, outside)
    call settle_pressures(deck, raw%pressure_places, outside, model, in_doubt)
    allocate (model%contacts(size(raw%contacts)))
    do i = 1, size(raw%contacts)
      call check_sides(deck, raw, i, outside, in_doubt, model)
      model%contacts(i) = raw%contacts(i)%contact
      call resolve_interference(deck, raw%contacts(i), model, model%contacts(i))
    end do
    do i = 1, size(raw%transducers)
      call require_side(deck, raw%transducers(i), 1, kind, found)
    end do
  end subroutine check_unsound_mesh

  !> Sides of nodes or segments without doubt as in a sound mesh, of others whether they exist.
  subroutine check_sides(deck, raw, i, outside, in_doubt, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    integer, intent(in) :: i
    type(boundary_t), intent(in) :: outside
    logical, intent(in) :: in_doubt(:)
    type(model_t), intent(in) :: model
    type(surface_t) :: sides(2)
    integer :: k, kind, found, n_known

    n_known = 0
    do k = 1, merge(1, 2, raw%contacts(i)%contact%is_self)
      call find_side(deck, raw%contacts(i), k, kind, found)
      if (is_certain(kind, found)) then
        call resolve_side(deck, raw, i, k, outside, model, sides(k))
        n_known = n_known + 1
      else
        call require_side(deck, raw%contacts(i), k, kind, found)
      end if
    end do
    if (n_known == 2) call check_common_nodes(deck, raw%contacts(i), sides, model)

  contains

    !> Whether no refused element has nodes of the surface.
    pure function is_certain(kind, found)
      integer, intent(in) :: kind, found
      logical :: is_certain

      is_certain = .false.
      if (kind == side_nodes) then
        is_certain = .not. any(in_doubt(model%node_sets(found)%nodes))
      else if (kind == side_segments) then
        if (allocated(model%segment_sets(found)%parts)) return
        is_certain = .not. any(in_doubt([model%segment_sets(found)%nodes]))
      end if
    end function is_certain

  end subroutine check_sides

end module deck_resolve_mesh_m
