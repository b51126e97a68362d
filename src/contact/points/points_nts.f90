! SPDX-License-Identifier: MIT
!> Points at nodes in contact: types 1 to 3, classical NTS, NTS-AR and two-pass NTS-AR, and type 5,
!> NTS-mAR, which is type 2 with a modified tributary length, and in addition the master nodes
!> between the projections of the two ends of a slave segment, projected on that segment
!> (doc/theory/contact.md, sections 5.1 to 5.3 and 5.5).
module points_nts_m
  use contact_state_m, only : contact_state_t, contact_points_t
  use contacts_m, only : contact_t
  use projection_m, only : projection_t, vector_of, opposed_share, on_bisector
  use geometry_m, only : separation
  use kinds_m, only : wp
  use overlaps_m, only : overlap_t, find_overlaps, room_for_overlaps
  use point_list_m, only : add_point, append_active, finish_segment_points
  use slave_segments_m, only : none_due, search_segments, update_segment_states, &
    note_earliest_search
  use surfaces_m, only : surface_t
  use tributary_lengths_m, only : nodal_area, find_nodal_areas, end_radius, radius_between
  implicit none
  private
  public :: points_nts, points_nts_ar, points_at_slave_nodes, points_nts_mar, finish_nts_mar, &
    is_sharp_vertex

contains

  !> Type 1: a spring of eps [N/m] at each slave node, whatever the mesh; in axisymmetry times the
  !> mean radius of its tributary length.
  pure subroutine points_nts(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(inout) :: points
    real(wp), allocatable :: lengths(:)

    call append_active(memory%slave_status, contact%master, [0, memory%n_slave], 1.0_wp, &
      memory%node_penalty, points)
    if (.not. contact%is_axisymmetric) return
    allocate (lengths(points%n))
    associate (slave_positions => memory%positions(:, :memory%n_slave), &
      areas => points%area(:points%n))
      call find_nodal_areas(contact%slave, slave_positions, .true., memory%slave_status, areas)
      call find_nodal_areas(contact%slave, slave_positions, .false., memory%slave_status, lengths)
      areas = areas/max(lengths, tiny(1.0_wp))
    end associate
  end subroutine points_nts

  !> Types 2 and 3: the tributary length of each node as area. Where master nodes are tracked too
  !> these have points over the slave surface; nothing is halved.
  pure subroutine points_nts_ar(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(inout) :: points
    integer :: first

    call points_at_slave_nodes(contact, memory, points)
    call find_nodal_areas(contact%slave, memory%positions(:, :memory%n_slave), &
      contact%is_axisymmetric, memory%slave_status, points%area(:points%n))
    if (memory%master_status%n == 0) return
    first = points%n + 1
    call append_active(memory%master_status, contact%slave, [memory%n_slave, 0], 0.0_wp, &
      memory%master_penalty, points)
    call find_nodal_areas(contact%master, memory%positions(:, memory%n_slave + 1:), &
      contact%is_axisymmetric, memory%master_status, points%area(first:points%n))
  end subroutine points_nts_ar

  !> A point at each slave node in contact, whose area follows.
  pure subroutine points_at_slave_nodes(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(inout) :: points

    call append_active(memory%slave_status, contact%master, [0, memory%n_slave], 0.0_wp, &
      memory%slave_penalty, points)
  end subroutine points_at_slave_nodes

  !> Type 5: the points at master nodes of a range of slave segments. What a segment leaves to its
  !> ends is in scratch%nodal, by number of the segment.
  pure subroutine points_nts_mar(contact, memory, first, last, points, n_released)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: first, last
    type(contact_points_t), intent(inout) :: points
    integer, intent(inout) :: n_released !! first contacts deeper than the limit
    type(overlap_t), allocatable :: overlaps(:)
    real(wp) :: of_ends(2)
    integer :: s, n

    if (none_due(memory)) return
    allocate (overlaps(room_for_overlaps(memory%candidates, first, last)))
    n = points%n
    call search_segments(contact, first, last, memory)
    do s = first, last
      of_ends = 0.0_wp
      if (memory%segments%has_points(s)) &
        call points_on_segment(contact, memory, s, overlaps, of_ends, points)
      memory%scratch%nodal(:, s) = of_ends
    end do
    call update_segment_states(contact, [first, last], n, memory, points, n_released)
    call finish_segment_points(memory%positions, .false., n + 1, points)
  end subroutine points_nts_mar

  !> Type 5: areas of the slave nodes, from the segments before and behind; nodes at a sharp
  !> vertex keep their whole tributary length.
  pure subroutine finish_nts_mar(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(contact_points_t), intent(inout) :: points
    integer :: p

    if (none_due(memory)) return
    call note_earliest_search(memory)
    do p = 1, memory%slave_status%n_active
      associate (node => memory%slave_status%active_points(p), slave => contact%slave, &
        of_ends => memory%scratch%nodal)
        if (slave%incoming(node) > 0) points%area(p) = of_ends(2, slave%incoming(node))
        if (slave%outgoing(node) > 0) points%area(p) = points%area(p) &
          + of_ends(1, slave%outgoing(node))
        if (points%area(p) > 0.0_wp) cycle
        if (is_sharp_vertex(slave, memory%positions, memory%slave_status%normal(:, node), node)) &
          points%area(p) = nodal_area(slave, &
          memory%positions(:, :memory%n_slave), contact%is_axisymmetric, node)
      end associate
    end do
  end subroutine finish_nts_mar

  !> Divide a slave segment among its ends and the master nodes at its breakpoints: each has half of
  !> the overlap before it and half of the one behind it.
  pure subroutine points_on_segment(contact, memory, s, overlaps, of_ends, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    type(overlap_t), intent(inout), contiguous :: overlaps(:) !! room
    real(wp), intent(inout) :: of_ends(2) !! areas of its ends, m
    type(contact_points_t), intent(inout) :: points
    real(wp) :: t(2), half_lengths(2), area, length
    integer :: ends(2), at(2), node, n, k, i

    ends = contact%slave%segments(:, s)
    call find_overlaps(contact, memory, s, contact%strict, on_bisector, overlaps, n)
    t = separation(memory%positions(:, ends(2)), memory%positions(:, ends(1)))
    length = sqrt(t(1)**2 + t(2)**2)
    node = 0
    area = 0.0_wp
    do k = 1, n
      if (.not. overlaps(k)%high > overlaps(k)%low) cycle
      half_lengths = half_lengths_of(contact, memory%positions(:, ends(1)), &
        memory%positions(:, ends(2)), length, overlaps(k))
      at = [overlaps(k)%first, overlaps(k)%last]
      do i = 1, 2
        if (at(i) == 0) then
          of_ends(i) = of_ends(i) + half_lengths(i)
        else if (at(i) == node) then
          area = area + half_lengths(i)
        else
          call add_breakpoint(memory, ends, t, node, area, points)
          node = at(i)
          area = half_lengths(i)
        end if
      end do
    end do
    call add_breakpoint(memory, ends, t, node, area, points)
  end subroutine points_on_segment

  !> Half of an overlap, as far as it counts, for either of its ends, m; in axisymmetry weighted
  !> by the radius, so that they differ. With the strict rule all but sides of corners counts.
  pure function half_lengths_of(contact, a, b, length, overlap) result(half_lengths)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: a(4), b(4)     !! ends of the slave segment
    real(wp), intent(in) :: length         !! of that, m
    type(overlap_t), intent(in) :: overlap
    real(wp) :: half_lengths(2)
    real(wp) :: low, high

    half_lengths = 0.5_wp*(overlap%high - overlap%low)*length
    half_lengths = half_lengths*merge(overlap%part, overlap%share, contact%strict)
    if (.not. contact%is_axisymmetric) return
    low = radius_between(a, b, overlap%low)
    high = radius_between(a, b, overlap%high)
    half_lengths(1) = half_lengths(1)*end_radius(low, high)
    half_lengths(2) = half_lengths(2)*end_radius(high, low)
  end function half_lengths_of

  !> Append a point at a master node with a gap that is closed.
  pure subroutine add_breakpoint(memory, ends, t, node, area, points)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)     !! nodes of the slave segment
    real(wp), intent(in) :: t(2)       !! vector of that, m
    integer, intent(in) :: node        !! of the master, 0: none
    real(wp), intent(in) :: area       !! m
    type(contact_points_t), intent(inout) :: points
    type(projection_t) :: projection
    real(wp) :: d(2), square, closed_gap

    if (node == 0 .or. .not. area > 0.0_wp) return
    associate (positions => memory%positions, at => memory%n_slave + node)
      d = separation(positions(:, at), positions(:, ends(1)))
      square = max(t(1)**2 + t(2)**2, tiny(1.0_wp))
      projection%gap = (d(1)*t(2) - d(2)*t(1))/sqrt(square)
      closed_gap = memory%closed_gap
      if (memory%has%arcs) closed_gap = closed_gap + memory%arcs%height(ends(1))
      if (.not. projection%gap < closed_gap) return
      projection%normal = [-t(2), t(1)]/sqrt(square)
      call add_point(points, ends, (d(1)*t(1) + d(2)*t(2))/square, [at, at], projection, area, &
        memory%slave_penalty)
    end associate
  end subroutine add_breakpoint

  !> Whether none of the segments at an active slave node faces the master at its projection.
  pure function is_sharp_vertex(slave, positions, normal, node)
    type(surface_t), intent(in) :: slave
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, at least n_slave)
    real(wp), intent(in) :: normal(2) !! at its projection
    integer, intent(in) :: node
    logical :: is_sharp_vertex
    real(wp) :: t(2)
    integer :: segments(2), k

    is_sharp_vertex = .true.
    segments = [slave%incoming(node), slave%outgoing(node)]
    do k = 1, 2
      if (segments(k) == 0) cycle
      t = vector_of(slave, positions, segments(k))
      is_sharp_vertex = is_sharp_vertex .and. .not. opposed_share((t(2)*normal(1) &
        - t(1)*normal(2))/sqrt(t(1)**2 + t(2)**2)) > 0.0_wp
    end do
  end function is_sharp_vertex

end module points_nts_m
