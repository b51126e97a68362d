! SPDX-License-Identifier: MIT
!> Status of contact points at time zero, and what the search knows from the initial mesh. Initial
!> penetrations are taken as they are, however deep, but only where the point lies inside the body
!> behind the segments: points beyond the far side of a body are no penetrations
!> (doc/theory/contact.md, section 3.4).
module initial_status_m
  use contact_state_m, only : contact_state_t
  use search_state_m, only : contact_status_t, allocate_status, active
  use contact_status_m, only : list_active
  use contacts_m, only : contact_t, is_tied, breaks
  use element_finder_m, only : element_finder_t, start_finder, is_inside_body, initial_length, &
    half_thickness
  use projection_m, only : projection_t, closest_projection, local_coordinates
  use geometry_m, only : local_coordinates_t, closest_distance, local_gap, local_normal
  use entry_m, only : is_opposed, segments_of
  use kinds_m, only : wp
  use model_m, only : model_t
  use near_segments_m, only : near_segments_t, cursor_t, sort_segments, start_near, next_near
  use remote_state_m, only : inside_tests_t
  use surfaces_m, only : surface_t, has_closed_chain
  implicit none
  private
  public :: allocate_slave_status, allocate_master_status, activate_deep_points, &
    activate_deep_segments

contains

  !> Status of the points of the slave side before the first search.
  subroutine allocate_slave_status(contact, model, memory)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory
    integer :: n

    associate (status => memory%slave_status)
      n = contact%slave%n_node
      if (allocated(memory%segment_points%xi)) then
        status%pass%xi = memory%segment_points%xi
        status%pass%segment_at = contact%slave%outgoing
        status%pass%n_on_segment = size(memory%segment_points%xi)
        n = status%pass%n_on_segment*contact%slave%n_segment
      end if
      status%pass%other_at = memory%n_slave
      status%pass%is_self = contact%is_self
      status%pass%is_closed = has_closed_chain(contact%slave)
      call allocate_status(status, n, contact%master%n_segment)
      call set_depths(status, contact, model, contact%slave, contact%master)
    end associate
  end subroutine allocate_slave_status

  !> Status of the master nodes of the second pass before the first search.
  subroutine allocate_master_status(contact, model, memory)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory

    associate (status => memory%master_status)
      status%pass%own_at = memory%n_slave
      status%pass%is_closed = has_closed_chain(contact%master)
      call allocate_status(status, contact%master%n_node, contact%slave%n_segment)
      call set_depths(status, contact, model, contact%master, contact%slave)
    end associate
  end subroutine allocate_master_status

  !> Deepest first contact: SRCH, or half of the shortest of the point's own segments, the segment
  !> that it meets, and the thickness of the element behind that. All from the initial mesh. The
  !> search radius also is the longest segment of both sides: what is opposed to any part of a
  !> segment is within reach of one of its ends.
  subroutine set_depths(status, contact, model, own, other)
    type(contact_status_t), intent(inout) :: status
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: own, other
    real(wp) :: length, longest
    integer :: i, k, segments(2)

    status%point_depth = huge(1.0_wp)
    longest = 0.0_wp
    do i = 1, status%n
      segments = segments_of(own, status%pass%n_on_segment, i)
      do k = 1, 2
        if (segments(k) == 0) cycle
        length = initial_length(model, own, segments(k))
        longest = max(longest, length)
        status%point_depth(i) = min(status%point_depth(i), 0.5_wp*length)
      end do
    end do
    do i = 1, other%n_segment
      length = initial_length(model, other, i)
      longest = max(longest, length)
      status%segment_depth(i) = min(0.5_wp*length, half_thickness(model, other, i))
    end do
    if (contact%search_depth > 0.0_wp) then
      status%point_depth = contact%search_depth
      status%segment_depth = contact%search_depth
    end if
    status%reach = max(longest, 2.0_wp*maxval(status%segment_depth))
    if (is_tied(contact) .and. .not. breaks(contact)) then
      ! What is tied its reach says alone, at whatever depth.
      status%reach = max(status%reach, contact%tie_distance, -0.01_wp*contact%tie_distance*longest)
      status%point_depth = status%reach
      status%segment_depth = status%reach
    end if
    status%shallowest = min(minval(status%point_depth), minval(status%segment_depth))
  end subroutine set_depths

  !> Points deeper than a first contact may be that lie inside an element behind the other surface
  !> are active on the closest face that is opposed to them; on a closed boundary no deeper than the
  !> element behind that face is thick, else it is the far side of the body.
  subroutine activate_deep_points(status, model, own, other, positions, points, inside_tests)
    type(contact_status_t), intent(inout) :: status
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: own, other
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    real(wp), intent(in), contiguous :: points(:, :) !! (4, n) positions of the points
    type(inside_tests_t), intent(inout), optional :: inside_tests
    type(element_finder_t) :: finder
    type(projection_t) :: projection
    logical :: inside
    type(near_segments_t) :: near
    integer :: i, segments(2), at

    at = status%pass%other_at
    call begin_asking(model, other%segment_element, own%nodes, finder, inside_tests)
    do i = 1, status%n
      segments = segments_of(own, status%pass%n_on_segment, i)
      if (status%state(i) == active .or. maxval(segments) == 0) cycle
      call ask_inside(finder, model, model%mesh%coordinates(:, other%nodes(1)) &
        + (points(1:2, i) - positions(1:2, at + 1)), own%nodes(carriers(own, segments)), inside, &
        inside_tests)
      if (.not. inside) cycle
      if (.not. allocated(near%at)) call sort_segments(other, positions(:, at + 1:), near)
      projection = closest_opposed(status, model, own, other, near, positions, points(:, i), i)
      if (projection%segment == 0) cycle
      status%segment(i) = projection%segment
      status%xi(i) = projection%xi
      status%gap(i) = projection%gap
      status%normal(:, i) = projection%normal
      status%state(i) = active
      status%next_search(i) = huge(1.0_wp)
    end do
    call list_active(status)
  end subroutine activate_deep_points

  !> Projection of a point on the closest of all segments that it is behind and that are opposed to
  !> it; segment 0: none.
  pure function closest_opposed(status, model, own, other, near, positions, point, i) &
    result(projection)
    type(contact_status_t), intent(in) :: status
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: own, other
    type(near_segments_t), intent(in) :: near !! of the other surface
    real(wp), intent(in), contiguous :: positions(:, :)
    real(wp), intent(in) :: point(4)
    integer, intent(in) :: i
    type(projection_t) :: projection
    type(local_coordinates_t) :: local
    type(cursor_t) :: cursor
    real(wp) :: square, least
    integer :: m, closest

    closest = 0
    least = huge(1.0_wp)
    cursor = start_near(near, point)
    associate (polyline => positions(:, status%pass%other_at + 1:))
      do
        call next_near(near, sqrt(least), cursor, m)
        if (m == 0) exit
        if (status%pass%is_self .and. status%pass%n_on_segment == 0) then
          if (any(other%segments(:, m) == i)) cycle
        end if
        local = local_coordinates(other, polyline, point, m)
        square = closest_distance(local)
        if (local%across >= 0.0_wp .or. square > least) cycle
        if (.not. square < least .and. m > closest) cycle
        if (.not. is_opposed(status%pass, own, positions, i, local_normal(local))) cycle
        if (near%is_closed .and. -local_gap(local) > 2.0_wp*half_thickness(model, other, m)) cycle
        closest = m
        least = square
      end do
      if (closest > 0) projection = closest_projection(other, polyline, point, closest)
    end associate
    if (.not. projection%is_on .or. projection%gap >= 0.0_wp) projection%segment = 0
  end function closest_opposed

  !> Slave segments with a master node deep inside the body behind them are in contact from the
  !> start: of these the closest one of which the node is behind.
  subroutine activate_deep_segments(contact, model, positions, state, inside_tests)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    integer, intent(inout) :: state(:)                  !! (n_segment) of the slave segments
    type(inside_tests_t), intent(inout), optional :: inside_tests
    type(element_finder_t) :: finder
    logical :: inside
    type(near_segments_t) :: near
    type(cursor_t) :: cursor
    integer :: i, s, nearest
    real(wp) :: square, least

    call begin_asking(model, contact%slave%segment_element, contact%master%nodes, finder, &
      inside_tests)
    do i = 1, contact%master%n_node
      associate (node => contact%master%nodes(i), point => positions(:, contact%slave%n_node + i))
        call ask_inside(finder, model, model%mesh%coordinates(:, node), [node], inside, &
          inside_tests)
        if (.not. inside) cycle
        if (.not. allocated(near%at)) call sort_segments(contact%slave, positions, near)
        nearest = 0
        least = huge(1.0_wp)
        cursor = start_near(near, point)
        do
          call next_near(near, sqrt(least), cursor, s)
          if (s == 0) exit
          if (any(contact%slave%nodes(contact%slave%segments(:, s)) == node)) cycle
          square = closest_distance(local_coordinates(contact%slave, positions, point, s))
          if (square > least .or. (.not. square < least .and. s > nearest)) cycle
          least = square
          nearest = s
        end do
      end associate
      if (nearest > 0) state(nearest) = active
    end do
  end subroutine activate_deep_segments

  !> Nodes that carry a point: those of its segment, or the node between two.
  pure function carriers(own, segments) result(nodes)
    type(surface_t), intent(in) :: own
    integer, intent(in) :: segments(2)
    integer :: nodes(2)

    if (segments(1) == segments(2)) then
      nodes = own%segments(:, segments(1))
    else if (segments(1) > 0) then
      nodes = own%segments(2, segments(1))
    else
      nodes = own%segments(1, segments(2))
    end if
  end function carriers

  !> Know the bodies behind a surface, unless the inside_tests are.
  pure subroutine begin_asking(model, members, nodes, finder, inside_tests)
    type(model_t), intent(in) :: model
    integer, intent(in) :: members(:) !! elements behind the surface
    integer, intent(in) :: nodes(:)   !! of the surface whose positions are asked about
    type(element_finder_t), intent(out) :: finder
    type(inside_tests_t), intent(in), optional :: inside_tests

    if (present(inside_tests)) then
      if (inside_tests%are_given) return
    end if
    call start_finder(model, members, nodes, finder)
  end subroutine begin_asking

  !> The next answer (`is_inside_body`).
  pure subroutine ask_inside(finder, model, x, carriers, inside, inside_tests)
    type(element_finder_t), intent(in) :: finder
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: x(2)
    integer, intent(in) :: carriers(:)
    logical, intent(out) :: inside
    type(inside_tests_t), intent(inout), optional :: inside_tests
    logical, allocatable :: more(:)

    if (.not. present(inside_tests)) then
      inside = is_inside_body(finder, model, x, carriers)
      return
    end if
    inside_tests%n = inside_tests%n + 1
    if (inside_tests%are_given) then
      inside = inside_tests%is_inside(inside_tests%n)
      return
    end if
    inside = is_inside_body(finder, model, x, carriers)
    if (.not. allocated(inside_tests%is_inside)) allocate (inside_tests%is_inside(64), &
      source=.false.)
    if (inside_tests%n > size(inside_tests%is_inside)) then
      allocate (more(2*inside_tests%n), source=.false.)
      more(:inside_tests%n - 1) = inside_tests%is_inside
      call move_alloc(more, inside_tests%is_inside)
    end if
    inside_tests%is_inside(inside_tests%n) = inside
  end subroutine ask_inside

end module initial_status_m
