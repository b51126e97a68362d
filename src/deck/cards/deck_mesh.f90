! SPDX-License-Identifier: MIT
!> *NODE and *ELEMENT_SHELL, and checks of the mesh. Independent errors are reported in the same
!> pass even where some elements are refused.
module deck_mesh_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use mesh_m, only : mesh_t
  use model_m, only : model_t
  use deck_lines_m, only : deck_t, location_t, count_rows, line_error, line_warning
  use deck_fields_m, only : field_number, card_t
  use deck_cards_m, only : cursor_t, next_of, report_field, reject_field
  use deck_ids_m, only : a_node, an_element, a_part
  use deck_values_m, only : define, map_defined, note_refused, find_id
  implicit none
  private
  public :: read_mesh

  !> Fraction of the largest radius below which a node lies on the axis.
  real(wp), parameter :: axis_share = 1.0e-10_wp
  !> Fraction of the size of the mesh below which z is that of the first node.
  real(wp), parameter :: flatness = 1.0e-6_wp

contains

  !> Read nodes and elements. Parts have been read. `sound`: the mesh has no errors.
  subroutine read_mesh(deck, model, codes, is_sound, sound)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    integer, allocatable, intent(out) :: codes(:)    !! (n_node) TC
    logical, allocatable, intent(out) :: is_sound(:) !! (n_element) no errors of element and nodes
    logical, intent(out) :: sound
    integer :: n_before
    logical :: has_coordinates

    n_before = deck%report%n_error
    call read_nodes(deck, model%mesh, codes)
    has_coordinates = deck%report%n_error == n_before
    call read_elements(deck, model%mesh)
    allocate (is_sound(model%mesh%n_element))
    if (size(is_sound) > 0) is_sound = all(model%mesh%element_nodes > 0, dim=1)
    if (has_coordinates) call check_shapes(deck, model%mesh, is_sound)
    ! References to refused parts and nodes are not reported.
    if (.not. has_coordinates .or. deck%maps(a_node)%has_refused &
      .or. deck%maps(an_element)%has_refused) is_sound = .false.
    sound = deck%report%n_error == n_before .and. model%mesh%n_node > 0 &
      .and. model%mesh%n_element > 0 .and. all(is_sound) .and. all(model%mesh%element_part > 0)
    if (model%is_axisymmetric .and. model%mesh%n_node > 0) call snap_to_axis(deck, model%mesh)
  end subroutine read_mesh

  !> *NODE: id, coordinates in one plane, and boundary code.
  subroutine read_nodes(deck, mesh, codes)
    type(deck_t), intent(inout) :: deck
    type(mesh_t), intent(inout) :: mesh
    integer, allocatable, intent(out) :: codes(:)
    type(cursor_t) :: cursor
    type(card_t) :: card
    real(wp), allocatable :: coordinates(:, :)
    integer :: n, x, y, z, code
    real(wp) :: plane, farthest
    type(card_t) :: far_card
    logical :: is_flat

    n = count_rows(deck, 'NODE')
    allocate (codes(n), coordinates(2, n))
    farthest = 0.0_wp
    do while (next_of(deck, 'NODE', cursor, card))
      if (deck%maps(a_node)%n == 0) then
        x = field_number(card%names, 'X')
        y = field_number(card%names, 'Y')
        z = field_number(card%names, 'Z')
        code = field_number(card%names, 'TC')
      end if
      call define(deck, a_node, card, n)
      if (n == 0) cycle
      codes(n) = card%i(code)
      coordinates(1, n) = card%r(x)
      coordinates(2, n) = card%r(y)
      if (n == 1) plane = card%r(z)
      if (abs(card%r(z) - plane) <= farthest) cycle
      farthest = abs(card%r(z) - plane)
      far_card = card
    end do
    call map_defined(deck, a_node, 'NID')
    n = deck%maps(a_node)%n
    mesh%n_node = n
    call move_alloc(deck%maps(a_node)%ids, mesh%node_id)
    codes = codes(:n)
    mesh%coordinates = coordinates(:, :n)
    ! Programs that make meshes leave round-off of their own in z.
    is_flat = .not. farthest > 0.0_wp
    if (.not. is_flat) is_flat = .not. farthest > flatness*maxval(maxval(mesh%coordinates, 2) &
      - minval(mesh%coordinates, 2))
    if (.not. is_flat) call report_field(deck, far_card, z, &
      'is not the z of the first node: the mesh must lie in one plane z = constant')
    if (n == 0) then
      if (.not. deck%maps(a_node)%has_refused) call line_error(deck, 0, &
        'the deck has no nodes (*NODE)')
    else if (is_flat .and. abs(plane) > 0.0_wp) then
      call line_warning(deck, deck%maps(a_node)%lines(1), 'z', &
        'z is the same for all nodes and is ignored')
    end if
  end subroutine read_nodes

  !> *ELEMENT_SHELL: id, part and corner nodes; N4 = 0 or N3 is a triangle.
  subroutine read_elements(deck, mesh)
    type(deck_t), intent(inout) :: deck
    type(mesh_t), intent(inout) :: mesh
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer, allocatable :: parts(:), nodes(:, :)
    integer :: n, k, part, first

    n = count_rows(deck, 'ELEMENT_SHELL')
    allocate (parts(n), nodes(4, n))
    do while (next_of(deck, 'ELEMENT_SHELL', cursor, card))
      if (deck%maps(an_element)%n == 0) then
        part = field_number(card%names, 'PID')
        first = field_number(card%names, 'N1')
      end if
      if (any(card%bad)) call note_refused(deck, [an_element])
      if (any(card%bad)) cycle
      call define(deck, an_element, card, n)
      call find_id(deck, a_part, card, part, parts(n))
      do k = 1, 3
        call find_id(deck, a_node, card, first + k - 1, nodes(k, n))
      end do
      nodes(4, n) = nodes(3, n)
      if (all(card%i(first + 3) /= [0, card%i(first + 2)])) &
        call find_id(deck, a_node, card, first + 3, nodes(4, n))
    end do
    call map_defined(deck, an_element, 'EID')
    n = deck%maps(an_element)%n
    mesh%n_element = n
    call move_alloc(deck%maps(an_element)%ids, mesh%element_id)
    mesh%element_part = parts(:n)
    if (n == size(parts)) call move_alloc(nodes, mesh%element_nodes)
    if (n < size(parts)) mesh%element_nodes = nodes(:, :n)
    if (n == 0 .and. .not. deck%maps(an_element)%has_refused) call line_error(deck, 0, &
      'the deck has no elements (*ELEMENT_SHELL)')
  end subroutine read_elements

  !> Report negative radii, and set radii at round-off to zero.
  subroutine snap_to_axis(deck, mesh)
    type(deck_t), intent(inout) :: deck
    type(mesh_t), intent(inout) :: mesh
    real(wp) :: tolerance
    integer :: i

    tolerance = axis_share*maxval(mesh%coordinates(1, :))
    associate (x => mesh%coordinates)
      do i = 1, mesh%n_node
        if (x(1, i) < -tolerance) then
          call reject_field(deck, location_t(deck%maps(a_node)%lines(i), 1, 'X'), ': node ' &
            //to_text(mesh%node_id(i))//' has a negative radius (the axis of an axisymmetric ' &
            //'deck is x = 0)')
        else if (x(1, i) <= tolerance) then
          x(1, i) = 0.0_wp
        end if
      end do
    end associate
  end subroutine snap_to_axis

  !> Report elements without area and non-convex elements, and reverse clockwise ones. Elements with
  !> missing nodes have been reported.
  subroutine check_shapes(deck, mesh, is_sound)
    type(deck_t), intent(inout) :: deck
    type(mesh_t), intent(inout) :: mesh
    logical, intent(inout) :: is_sound(:) !! (n_element) false for elements refused here
    character(:), allocatable :: problem
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
      problem = ''
      associate (nodes => mesh%element_nodes(:, i))
        if (any(nodes(1:2) == nodes([2, 3])) .or. nodes(1) == nodes(3) &
          .or. any(nodes(1:2) == nodes(4))) then
          problem = 'uses a node twice (a triangle repeats its third node, and no other)'
        else if (minval(corners) < -tolerance .and. maxval(corners) > tolerance) then
          problem = 'is not convex: its edges cross or a corner points inwards'
        else if (.not. abs(area) > 2.0_wp*tolerance) then
          problem = 'has no area'
        end if
      end associate
      is_sound(i) = len(problem) == 0
      if (.not. is_sound(i)) then
        call reject_field(deck, location_t(deck%maps(an_element)%lines(i), 1, 'EID'), problem)
      else if (area <= 0.0_wp) then
        mesh%element_nodes(:, i) = mesh%element_nodes([1, 4, 3, 2], i)
        if (mesh%element_nodes(2, i) == mesh%element_nodes(3, i)) &
          mesh%element_nodes(3:4, i) = mesh%element_nodes(4, i)
        n_turned = n_turned + 1
        if (n_turned == 1) first_turned = i
      end if
    end do
    if (n_turned > 0) call line_warning(deck, deck%maps(an_element)%lines(first_turned), &
      'clockwise', 'elements that are numbered clockwise and have been reversed: ' &
      //to_text(n_turned)//', the first '//to_text(mesh%element_id(first_turned)))
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

end module deck_mesh_m
