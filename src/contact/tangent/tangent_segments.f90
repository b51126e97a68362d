! SPDX-License-Identifier: MIT
!> Linearised points on slave segments (doc/theory/contact.md, sections 9.4 and 9.5): those of types
!> 5 and 7 move with the breakpoints of the overlaps of their segments, those of type 6 stand at
!> fixed sites. Half of each overlap is the area of a point of its own at either of its ends for
!> type 5, so that each depends on few nodes.
module tangent_segments_m
  use assembly_m, only : nodal_share
  use contact_state_m, only : contact_state_t, contact_points_t, site_at
  use search_state_m, only : active, segment_point_at
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, constant, operator(+), operator(-), operator(*)
  use projection_m, only : slave_side, master_side, round_off, on_bisector
  use kinds_m, only : wp
  use linearisation_m, only : linearised_point_t, linearised_list_t, linearised_projection_t, &
    append_point, difference, length_between, project, project_point, project_on_arcs, &
    cosine_between, share_of, side_share_of, radius_at
  use overlaps_m, only : overlap_t, find_overlaps, n_most_overlaps
  use points_nts_m, only : is_sharp_vertex
  use points_mortar_m, only : gauss_xi, least_part, resolves_vertices
  use surfaces_m, only : surface_t
  use tangent_nodes_m, only : linearise_node, linearise_length
  use slave_segments_m, only : sides_part
  implicit none
  private
  public :: linearise_overlap_ends, linearise_gauss_points

contains

  !> Type 5: the ends of all overlaps; then the nodes at sharp vertices, which have none.
  pure subroutine linearise_overlap_ends(contact, memory, list)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(linearised_list_t), intent(inout) :: list
    type(linearised_point_t) :: point
    logical :: has_area(memory%n_slave)
    integer :: s, p

    has_area = .false.
    do s = 1, contact%slave%n_segment
      if (memory%segments%state(s) == active .or. any(memory%slave_status%state( &
        contact%slave%segments(:, s)) == active)) &
        call linearise_ends_on(contact, memory, s, has_area, list)
    end do
    do p = 1, memory%slave_status%n_active
      associate (node => memory%slave_status%active_points(p))
        if (has_area(node)) cycle
        if (.not. is_sharp_vertex(contact%slave, memory%positions, &
          memory%slave_status%normal(:, node), node)) cycle
        point = linearise_node(contact, memory, p)
        call linearise_length(contact%slave, 0, contact%is_axisymmetric, .false., &
          memory%positions, point)
        call append_point(list, point)
      end associate
    end do
  end subroutine linearise_overlap_ends

  !> Type 5: the points of one slave segment.
  pure subroutine linearise_ends_on(contact, memory, s, has_area, list)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    logical, intent(inout) :: has_area(:) !! (n_slave) slave nodes with points
    type(linearised_list_t), intent(inout) :: list
    type(overlap_t) :: overlaps(n_most_overlaps(memory%candidates, s))
    type(linearised_point_t) :: point
    type(dual_t) :: xi(2), half
    integer :: breakpoints(2), n, k, i

    call find_overlaps(contact, memory, s, contact%strict, on_bisector, overlaps, n)
    do k = 1, n
      if (.not. overlaps(k)%high > overlaps(k)%low) cycle
      if (.not. contact%strict .and. .not. overlaps(k)%share > 0.0_wp) cycle
      call start_on_overlap(contact, memory, s, overlaps(k), point, xi)
      half = 0.5_wp*(xi(2) - xi(1))*length_between(memory%positions, point, 1, 2)
      breakpoints = [overlaps(k)%first, overlaps(k)%last]
      do i = 1, 2
        point%area = half
        if (contact%is_axisymmetric) point%area = half*radius_at(memory%positions, point, 1, 2, &
          (1.0_wp/3.0_wp)*(2.0_wp*xi(i) + xi(3 - i)))
        associate (node => contact%slave%segments(i, s))
          if (breakpoints(i) > 0) then
            if (memory%segments%state(s) /= active) cycle
            call move_to_breakpoint(memory, memory%n_slave + breakpoints(i), point)
          else
            if (memory%slave_status%state(node) /= active) cycle
            call move_to_end(contact, memory, node, i, point)
            has_area(node) = .true.
          end if
        end associate
        call append_share(contact, memory%positions, s, overlaps(k), .not. contact%strict, point, &
          list)
      end do
    end do
  end subroutine linearise_ends_on

  !> Type 5: let the point stand at a master node behind the slave segment, with the normal of that.
  pure subroutine move_to_breakpoint(memory, node, point)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: node !! local number
    type(linearised_point_t), intent(inout) :: point
    type(linearised_projection_t) :: projection
    type(dual_t) :: d(2), t(2)

    point%nodes(3:4) = [node, 0]
    point%is_on_vertex = .false.
    point%site = node
    d = difference(memory%positions, point, 3, 1)
    t = difference(memory%positions, point, 2, 1)
    projection = project(d, t)
    point%distance = projection%gap
    if (memory%has%arcs) call project_on_arcs(memory, point, 1, d, t, projection)
    point%slave_xi = projection%xi
    point%master_xi = constant(0.0_wp)
    point%gap = projection%gap
    point%normal = -projection%normal
    point%length = constant(1.0_wp)
  end subroutine move_to_breakpoint

  !> Type 5: let the point stand at a node that is in contact, the k-th end of the slave segment.
  pure subroutine move_to_end(contact, memory, node, k, point)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: node, k
    type(linearised_point_t), intent(inout) :: point

    associate (status => memory%slave_status)
      point%nodes(3:4) = memory%n_slave + contact%master%segments(:, status%segment(node))
      point%site = node
      point%slave_xi = constant(k - 1.0_wp)
      call project_point(contact, memory, status%xi(node), status%gap(node), &
        status%normal(:, node), point)
    end associate
  end subroutine move_to_end

  !> Types 6 and 7: all points, which follow each other on the list slave segment by slave segment;
  !> at the end of the list are points at nodes.
  pure subroutine linearise_gauss_points(contact, memory, list)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(linearised_list_t), intent(inout) :: list
    integer :: s, p, first, node

    p = 1
    do while (p <= memory%points%n)
      if (maxval(memory%points%slave_weights(:, p)) >= 1.0_wp) exit
      node = memory%points%slave_nodes(1, p)
      s = contact%slave%outgoing(node)
      first = list%n + 1
      if (memory%has%overlaps) then
        call linearise_on_overlaps(contact, memory, s, p, list)
        ! Where an iteration diverges, bodies far away, round-off of the overlaps may leave points.
        do while (p <= memory%points%n)
          if (memory%points%slave_nodes(1, p) /= node) exit
          if (maxval(memory%points%slave_weights(:, p)) >= 1.0_wp) exit
          p = p + 1
        end do
      else
        call linearise_on_whole_segment(contact, memory, s, p, list)
      end if
      if (resolves_vertices(contact)) call linearise_vertices(contact, memory, &
        contact%slave%segments(:, s), first, list)
    end do
  end subroutine linearise_gauss_points

  !> Type 6: the points of one slave segment that are on the list.
  pure subroutine linearise_on_whole_segment(contact, memory, s, p, list)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    integer, intent(inout) :: p !! first point of the segment on the list; then of the next one
    type(linearised_list_t), intent(inout) :: list
    type(linearised_point_t) :: point
    type(overlap_t) :: sides
    integer :: q

    point%nodes(:2) = contact%slave%segments(:, s)
    associate (points => memory%points)
      do while (p <= points%n)
        if (points%slave_nodes(1, p) /= point%nodes(1)) exit
        if (maxval(points%slave_weights(:, p)) >= 1.0_wp) exit
        point%slave_xi = constant(points%slave_weights(2, p))
        point%site = site_at(memory, memory%points, p)
        q = segment_point_at(points%slave_weights(2, p), memory%segment_points%xi)
        call move_over_segment(contact, memory, p, &
          memory%segment_points%share(q)*length_between(memory%positions, point, 1, 2), point)
        sides%master = contact%master%outgoing(points%master_nodes(1, p) - memory%n_slave)
        sides%part = 1.0_wp
        if (memory%slave_status%pass%is_closed) &
          sides%part = sides_part(contact, memory%positions, s, sides%master)
        sides%share = sides%part
        call append_share(contact, memory%positions, s, sides, .false., point, list)
        p = p + 1
      end do
    end associate
  end subroutine linearise_on_whole_segment

  !> Type 7: those of one slave segment that are on the list.
  pure subroutine linearise_on_overlaps(contact, memory, s, p, list)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    integer, intent(inout) :: p !! first point of the segment on the list; then of the next one
    type(linearised_list_t), intent(inout) :: list
    type(overlap_t) :: overlaps(n_most_overlaps(memory%candidates, s))
    type(linearised_point_t) :: point
    type(dual_t) :: xi(2), length
    integer :: n, k, q

    call find_overlaps(contact, memory, s, .false., least_part, overlaps, n)
    do k = 1, n
      if (.not. overlaps(k)%share > 0.0_wp) cycle
      call start_on_overlap(contact, memory, s, overlaps(k), point, xi)
      length = 0.5_wp*(xi(2) - xi(1))*length_between(memory%positions, point, 1, 2)
      do q = 1, size(gauss_xi)
        if (p > memory%points%n) return
        point%slave_xi = xi(1) + gauss_xi(q)*(xi(2) - xi(1))
        if (memory%points%slave_nodes(1, p) /= point%nodes(1)) return
        if (abs(memory%points%slave_weights(2, p) - point%slave_xi%value) > round_off) cycle
        call move_over_segment(contact, memory, p, length, point)
        call append_share(contact, memory%positions, s, overlaps(k), .false., point, list)
        p = p + 1
      end do
    end do
  end subroutine linearise_on_overlaps

  !> Types 6 and 7: let the point stand over the master segment that it has on the list; its area is
  !> this length as far as it is opposed to that.
  pure subroutine move_over_segment(contact, memory, p, length, point)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: p           !! number on the list
    type(dual_t), intent(in) :: length !! m
    type(linearised_point_t), intent(inout) :: point

    associate (points => memory%points)
      point%nodes(3:4) = points%master_nodes(:, p)
      call project_point(contact, memory, points%master_weights(2, p), points%gap(p), &
        points%normal(:, p), point)
    end associate
    point%area = length*share_of(cosine_between(difference(memory%positions, point, 2, 1), &
      [-point%normal(2), point%normal(1)]))
    if (contact%is_axisymmetric) &
      point%area = point%area*radius_at(memory%positions, point, 1, 2, point%slave_xi)
  end subroutine move_over_segment

  !> Types 6 and 7: the points at the nodes of a segment at a sharp vertex, one for each point that
  !> shifts area to them. The share is held, and so is what the area of such a point owes to
  !> its own projection.
  pure subroutine linearise_vertices(contact, memory, ends, first, list)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2) !! nodes of the segment
    integer, intent(in) :: first   !! of its points, the last ones on the list
    type(linearised_list_t), intent(inout) :: list
    type(linearised_point_t) :: point
    type(dual_t) :: shares(2)
    real(wp) :: part(2)
    integer :: at_end(2), last, p, k

    at_end = points_at_ends(memory%points, ends)
    last = list%n
    part = 0.0_wp
    do k = 1, 2
      if (at_end(k) == 0) cycle
      do p = first, last
        shares(k) = nodal_share(list%points(p), k)
        part(k) = part(k) + shares(k)%value
      end do
      part(k) = memory%points%area(at_end(k))/part(k)
    end do
    do p = first, last
      do k = 1, 2
        shares(k) = part(k)*nodal_share(list%points(p), k)
        if (at_end(k) == 0) cycle
        point = list%points(p)
        point%area = shares(k)
        if (any(point%nodes(3:4) /= memory%points%master_nodes(:, at_end(k)))) &
          point%area%slope(5:8) = 0.0_wp
        point%nodes(3:4) = memory%points%master_nodes(:, at_end(k))
        point%slave_xi = constant(real(k - 1, wp))
        call project_point(contact, memory, memory%points%master_weights(2, at_end(k)), &
          memory%points%gap(at_end(k)), memory%points%normal(:, at_end(k)), point)
        call append_point(list, point)
      end do
      list%points(p)%area = list%points(p)%area - (shares(1) + shares(2))
    end do
  end subroutine linearise_vertices

  !> Points of the list at the nodes of a segment, 0: none.
  pure function points_at_ends(points, ends) result(at_end)
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: ends(2)
    integer :: at_end(2)
    integer :: p, k

    at_end = 0
    do p = 1, points%n
      if (any(points%slave_nodes(:, p) /= ends)) cycle
      do k = 1, 2
        if (points%slave_weights(k, p) >= 1.0_wp) at_end(k) = p
      end do
    end do
  end function points_at_ends

  !> Append a point of whose area the share of an overlap counts: itself at a constant share, and
  !> the change of the share at a constant area as a point without area, for it depends on further
  !> nodes. The master segment goes into slots 5, 6, the segments next to both at convex vertices
  !> into 7 and 8.
  pure subroutine append_share(contact, positions, s, overlap, is_by_master, point, list)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    integer, intent(in) :: s              !! slave segment
    type(overlap_t), intent(in) :: overlap
    logical, intent(in) :: is_by_master   !! opposed to the master segment, not at the point itself
    type(linearised_point_t), intent(in) :: point
    type(linearised_list_t), intent(inout) :: list
    type(linearised_point_t) :: change
    type(dual_t) :: share, own(2), other(2)

    change = point
    if (merge(overlap%share, overlap%part, is_by_master) < 1.0_wp) then
      change%nodes(5:8) = [contact%slave%n_node + contact%master%segments(:, overlap%master), 0, 0]
      own = difference(positions, change, 2, 1)
      other = difference(positions, change, 6, 5)
      share = constant(1.0_wp)
      if (is_by_master) share = share_of(cosine_between(own, other))
      if (overlap%part < 1.0_wp) then
        call linearise_side(contact%slave, s, [0, 1, 7], slave_side, positions, other, change, &
          share)
        call linearise_side(contact%master, overlap%master, [contact%slave%n_node, 5, 8], &
          master_side, positions, own, change, share)
      end if
      change%area%value = 0.0_wp
      change%area%slope = point%area%value*share%slope
      call append_point(list, change)
      change = point
      change%area = share%value*point%area
    end if
    call append_point(list, change)
  end subroutine append_share

  !> Reduce a share by what segments next to a segment take at convex vertices.
  pure subroutine linearise_side(surface, segment, at, range, positions, other, point, share)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: segment
    integer, intent(in) :: at(3)         !! local number before the surface's first node; slots: of
                                         !! the segment's first node, of a node next to it
    real(wp), intent(in) :: range(2)     !! see `side_share`
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    type(dual_t), intent(in) :: other(2) !! segment of the other surface
    type(linearised_point_t), intent(inout) :: point
    type(dual_t), intent(inout) :: share
    type(dual_t) :: own(2), beside(2), part
    integer :: next, held, k

    own = difference(positions, point, at(2) + 1, at(2))
    do k = 1, 2
      next = merge(surface%previous(segment), surface%next(segment), k == 1)
      if (next == 0) cycle
      held = point%nodes(at(3))
      point%nodes(at(3)) = at(1) + surface%segments(k, next)
      beside = difference(positions, point, merge(at(2), at(3), k == 1), &
        merge(at(3), at(2) + 1, k == 1))
      part = constant(1.0_wp)
      if (merge(-1.0_wp, 1.0_wp, k == 1)*(own(1)%value*beside(2)%value &
        - own(2)%value*beside(1)%value) > 0.0_wp) &
        part = side_share_of(cosine_between(own, beside), cosine_between(own, other) &
        - cosine_between(beside, other), range)
      ! One slot: of two such nodes, at both ends, the second is held.
      if (held > 0) part%slope(2*at(3) - 1:2*at(3)) = 0.0_wp
      if (held > 0 .or. part%value >= 1.0_wp) point%nodes(at(3)) = held
      share = share*part
    end do
  end subroutine linearise_side

  !> A point on an overlap of a slave segment, which goes into slots 1, 2; the master nodes at the
  !> breakpoints go into slots 5 and 6.
  pure subroutine start_on_overlap(contact, memory, s, overlap, point, xi)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s        !! slave segment
    type(overlap_t), intent(in) :: overlap
    type(linearised_point_t), intent(out) :: point
    type(dual_t), intent(out) :: xi(2) !! where it starts and ends
    type(linearised_projection_t) :: own
    integer :: breakpoints(2), i

    point%nodes(1:2) = contact%slave%segments(:, s)
    point%stiffness = memory%slave_penalty
    xi = constant([overlap%low, overlap%high])
    breakpoints = [overlap%first, overlap%last]
    do i = 1, 2
      if (breakpoints(i) == 0) cycle
      point%nodes(4 + i) = memory%n_slave + breakpoints(i)
      own = project(difference(memory%positions, point, 4 + i, 1), &
        difference(memory%positions, point, 2, 1))
      if (abs(own%xi%value - xi(i)%value) <= round_off) xi(i) = own%xi
    end do
  end subroutine start_on_overlap

end module tangent_segments_m
