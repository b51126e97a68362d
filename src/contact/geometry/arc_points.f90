! SPDX-License-Identifier: MIT
!> Contact points between arcs in place of between their secants (doc/theory/contact.md, section
!> 5.9). Forces still go to the two nodes of a segment by linear functions.
module arc_points_m
  use arcs_m, only : form_shapes, present_shape, is_flat, steepest
  use contact_state_m, only : arcs_t, arc_shape_t, flat_arc, contact_state_t, contact_points_t, &
    n_side
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  use projection_block_m, only : n_block
  implicit none
  private
  public :: curve_points, offset_by_arc, last_of_virtual_node

  !> Points over segments of the other surface, one of which at least is curved, many at a time.
  !> Without default values, which would be written before each use.
  type :: arc_block_t
    integer :: n
    integer :: points(2, n_block)      !! on the list: the first and the last of a virtual node
    real(wp) :: bend(n_block), skew(n_block)         !! of the segment
    integer :: nodes(4, n_block)       !! of its own segment, or one twice, and of the segment
    real(wp) :: own_bend(n_block), own_skew(n_block) !! of its own segment
    real(wp) :: own_xi(n_block)        !! on that
    real(wp) :: xi(n_block)            !! on the segment: where the force acts
    real(wp) :: gap(n_block)           !! m, between arcs
    real(wp) :: offset(n_block)        !! of that from the gap of the secants, m
    real(wp) :: normal(n_block, 2)     !! of the arc, outward
  end type arc_block_t

contains

  !> Heights of arcs over their secants as parts of the lengths of these, and sine and cosine of
  !> their angles to them. Beyond the ends both arcs of a node go on along its tangent.
  pure subroutine find_heights(n, bend, skew, xi, height, sine, cosine)
    integer, intent(in) :: n
    real(wp), intent(in), dimension(n) :: bend, skew, xi
    real(wp), intent(out), dimension(n) :: height, sine, cosine
    real(wp) :: x, circle, end_sine
    integer :: k

    !$omp simd private(x, circle, end_sine)
    do k = 1, n
      x = max(0.0_wp, min(1.0_wp, xi(k)))
      circle = bend(k)*(0.5_wp - x)
      end_sine = min(0.5_wp*abs(bend(k)), steepest)
      sine(k) = max(-steepest, min(steepest, circle + skew(k)*(1.0_wp - 6.0_wp*x*(1.0_wp - x))))
      cosine(k) = sqrt(1.0_wp - sine(k)**2)
      height(k) = x*(1.0_wp - x)*(bend(k)/(sqrt(1.0_wp - min(circle**2, steepest**2)) &
        + sqrt(1.0_wp - end_sine**2)) + skew(k)*(1.0_wp - 2.0_wp*x)) &
        + (xi(k) - x)*sine(k)/cosine(k)
    end do
  end subroutine find_heights

  !> Project the points of a block on the arcs over their secants t of length L, each from its
  !> projection on the secant, at the distance d and xi: by one Newton step, no longer than for a
  !> point at half the radius of curvature, to where the normal n of the arc, at the angle beta to
  !> that of the secant, goes through the point. The force acts along n, for the point on its own
  !> secant at xi + d tan(beta)/L, so that it has no moment. Both arcs of a node so have the same
  !> normal there. A circle has sin(beta) = kappa L (1/2 - xi).
  pure subroutine project_block(positions, block)
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    type(arc_block_t), intent(inout) :: block
    real(wp), dimension(n_block, 2) :: t, d, own !! secants, from their first nodes to the points on
                                                 !! their own secants, these secants, m
    real(wp), dimension(n_block) :: length, across, above, xi, shift, height, sine, cosine
    real(wp) :: unit(2), off(2), gap, fall
    integer :: k

    associate (n => block%n, bend => block%bend, skew => block%skew)
      call gather_block(n, block%nodes, block%own_xi, positions, t, d, own)
      call find_heights(n, block%own_bend, block%own_skew, block%own_xi, height, sine, cosine)
      !$omp simd private(unit, off)
      do k = 1, n
        length(k) = sqrt(t(k, 1)**2 + t(k, 2)**2)
        unit(1) = t(k, 1)/length(k)
        unit(2) = t(k, 2)/length(k)
        off(1) = height(k)*own(k, 2)
        off(2) = -height(k)*own(k, 1)
        across(k) = d(k, 1)*unit(2) - d(k, 2)*unit(1)
        above(k) = across(k) + (off(1)*unit(2) - off(2)*unit(1))
        xi(k) = ((d(k, 1) + off(1))*unit(1) + (d(k, 2) + off(2))*unit(2))/length(k)
      end do
      call find_heights(n, bend, skew, xi, height, sine, cosine)
      !$omp simd private(gap, fall)
      do k = 1, n
        gap = (above(k)/length(k) - height(k))*cosine(k)
        fall = bend(k) + 6.0_wp*skew(k)*(1.0_wp - 2.0_wp*xi(k))
        fall = merge(0.0_wp, fall, abs(xi(k) - 0.5_wp) > 0.5_wp)
        shift(k) = gap*sine(k)/max(0.5_wp, 1.0_wp + gap*fall)
        xi(k) = xi(k) + shift(k)
      end do
      call find_heights(n, bend, skew, xi, height, sine, cosine)
      !$omp simd private(unit)
      do k = 1, n
        unit(1) = t(k, 1)/length(k)
        unit(2) = t(k, 2)/length(k)
        block%gap(k) = (above(k) - height(k)*length(k))*cosine(k) + shift(k)*length(k)*sine(k)
        block%offset(k) = block%gap(k) - across(k)
        block%normal(k, 1) = unit(2)*cosine(k) - unit(1)*sine(k)
        block%normal(k, 2) = -unit(1)*cosine(k) - unit(2)*sine(k)
        block%xi(k) = (d(k, 1)*unit(1) + d(k, 2)*unit(2) + across(k)*sine(k)/cosine(k))/length(k)
      end do
    end associate
  end subroutine project_block

  !> Vectors of the points of a block, m.
  pure subroutine gather_block(n, nodes, own_xi, positions, t, d, own)
    integer, intent(in) :: n, nodes(4, n)
    real(wp), intent(in) :: own_xi(n), positions(4, *)
    real(wp), intent(inout), dimension(n_block, 2) :: t, d, own
    real(wp), dimension(4) :: along, difference, secant
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      along = positions(:, nodes(2, k)) - positions(:, nodes(1, k))
      difference = (positions(:, nodes(1, k)) - positions(:, nodes(3, k))) + own_xi(k)*along
      secant = positions(:, nodes(4, k)) - positions(:, nodes(3, k))
      own(k, :) = along(1:2) + along(3:4)
      d(k, :) = difference(1:2) + difference(3:4)
      t(k, :) = secant(1:2) + secant(3:4)
    end do
  end subroutine gather_block

  !> Let all points of an interface stand between arcs: gaps, normals and where forces act on the
  !> segments that have the normals; of type 4 the virtual nodes, for all of their sub-segments.
  !> Points between flat segments keep their bits.
  pure subroutine curve_points(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory !! out: present shapes of the points' segments
    type(contact_points_t), intent(inout) :: points
    type(arc_block_t) :: block
    integer :: below(n_side), p, v, last

    if (points%n == 0) return
    call form_present_shapes(contact, memory, points)
    p = 0
    v = 0
    do while (p < points%n)
      block%n = 0
      if (memory%has%virtual_nodes) then
        do while (p < points%n .and. block%n < n_block)
          v = v + 1
          p = p + 1
          last = last_of_virtual_node(points, p)
          below = nodes_below(contact, memory, memory%slave_status%active_points(v))
          call append_to_block(memory%arcs%shape, points%slave_nodes(:, p), &
            points%slave_weights(2, p), below, [p, last], block)
          p = last
        end do
        call project_block(memory%positions, block)
        call store_virtual_nodes(memory%positions, block, points)
      else
        last = min(p + n_block, points%n)
        call append_points(p + 1, last, points%slave_nodes, points%slave_weights, &
          points%master_nodes, memory%arcs%shape, block)
        call project_block(memory%positions, block)
        call store_points(block, points%master_nodes, points%slave_weights, points%master_weights, &
          points%gap, points%normal)
        p = last
      end if
    end do
  end subroutine curve_points

  !> Append points of the list. Bounds are explicit: descriptors would be read for each point.
  pure subroutine append_points(first, last, slave_nodes, slave_weights, master_nodes, shape, block)
    integer, intent(in) :: first, last
    integer, intent(in) :: slave_nodes(n_side, *), master_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *)
    type(arc_shape_t), intent(in) :: shape(*)
    type(arc_block_t), intent(inout) :: block
    integer :: p

    do p = first, last
      if (master_nodes(1, p) /= master_nodes(2, p)) then
        call append_to_block(shape, slave_nodes(:, p), slave_weights(2, p), master_nodes(:, p), &
          [p, p], block)
      else
        call append_to_block(shape, master_nodes(:, p), 0.0_wp, slave_nodes(:, p), [p, p], block)
      end if
    end do
  end subroutine append_points

  !> Form the shapes of all segments that points are on, once each.
  pure subroutine form_present_shapes(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(contact_points_t), intent(in) :: points
    integer :: listed(n_block), below(n_side), n, p

    n = 0
    associate (arcs => memory%arcs, status => memory%slave_status)
      arcs%call = arcs%call + 1
      do p = 1, points%n
        associate (slave => points%slave_nodes(:, p), master => points%master_nodes(:, p))
          if (arcs%formed_in(master(1)) < arcs%call .and. master(1) /= master(2)) &
            call list_segment(master(1), memory%positions, arcs, listed, n)
          if (arcs%formed_in(slave(1)) < arcs%call .and. slave(1) /= slave(2)) &
            call list_segment(slave(1), memory%positions, arcs, listed, n)
        end associate
      end do
      if (memory%has%virtual_nodes) then
        do p = 1, status%n_active
          below = nodes_below(contact, memory, status%active_points(p))
          if (arcs%formed_in(below(1)) < arcs%call) &
            call list_segment(below(1), memory%positions, arcs, listed, n)
        end do
      end if
      call form_listed(listed(:n), memory%positions, arcs)
    end associate
  end subroutine form_present_shapes

  !> List a segment; form the shapes of a full list.
  pure subroutine list_segment(first, positions, arcs, listed, n)
    integer, intent(in) :: first !! node where it starts, local number
    real(wp), intent(in), contiguous :: positions(:, :)
    type(arcs_t), intent(inout) :: arcs
    integer, intent(inout) :: listed(n_block), n

    if (n == n_block) then
      call form_listed(listed, positions, arcs)
      n = 0
    end if
    n = n + 1
    listed(n) = first
    arcs%formed_in(first) = arcs%call
  end subroutine list_segment

  !> Form the shapes of some segments and keep them.
  pure subroutine form_listed(listed, positions, arcs)
    integer, intent(in), contiguous :: listed(:)
    real(wp), intent(in), contiguous :: positions(:, :)
    type(arcs_t), intent(inout) :: arcs
    type(arc_shape_t) :: shapes(size(listed))
    integer :: k

    call form_shapes(listed, positions, arcs, shapes)
    do k = 1, size(listed)
      arcs%shape(listed(k)) = shapes(k)
    end do
  end subroutine form_listed

  !> Nodes of the master segment that a virtual node is over.
  pure function nodes_below(contact, memory, virtual_node) result(nodes)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: virtual_node
    integer :: nodes(n_side)

    nodes = memory%n_slave + contact%master%segments(:, memory%slave_status%segment(virtual_node))
  end function nodes_below

  !> The last of the sub-segments of a virtual node, which follow each other; other points stand
  !> alone.
  pure function last_of_virtual_node(points, first) result(last)
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: first
    integer :: last

    last = first
    do while (last < points%n)
      if (points%slave_nodes(1, last + 1) /= points%slave_nodes(1, first) &
        .or. points%slave_nodes(2, last + 1) /= points%slave_nodes(2, first) &
        .or. abs(points%slave_weights(2, last + 1) - points%slave_weights(2, first)) > 0.0_wp) exit
      last = last + 1
    end do
  end function last_of_virtual_node

  !> Append a point at xi between two nodes of its own surface, over a segment of the other one,
  !> unless both are flat. Nodes are on their arcs.
  pure subroutine append_to_block(shape, own, own_xi, other, points, block)
    type(arc_shape_t), intent(in) :: shape(*)         !! by the nodes where segments start
    integer, intent(in) :: own(n_side), other(n_side) !! local numbers; own: one node twice, or both
                                                      !! of a segment
    real(wp), intent(in) :: own_xi
    integer, intent(in) :: points(2)                  !! its numbers, first and last
    type(arc_block_t), intent(inout) :: block
    real(wp) :: bend, skew
    integer :: n

    bend = 0.0_wp
    skew = 0.0_wp
    if (own(1) /= own(2) .and. own_xi*(1.0_wp - own_xi) > 0.0_wp) then
      bend = shape(own(1))%bend
      skew = shape(own(1))%skew
    end if
    if (is_flat(arc_shape_t(bend, skew)) .and. is_flat(shape(other(1)))) return
    n = block%n + 1
    block%n = n
    block%points(:, n) = points
    block%nodes(1:2, n) = own
    block%nodes(3:4, n) = other
    block%own_xi(n) = own_xi
    block%own_bend(n) = bend
    block%own_skew(n) = skew
    block%bend(n) = shape(other(1))%bend
    block%skew(n) = shape(other(1))%skew
  end subroutine append_to_block

  !> Store the projections of points.
  pure subroutine store_points(block, master_nodes, slave_weights, master_weights, gap, normal)
    type(arc_block_t), intent(in) :: block
    integer, intent(in) :: master_nodes(n_side, *)
    real(wp), intent(inout), dimension(n_side, *) :: slave_weights, master_weights
    real(wp), intent(inout) :: gap(*), normal(2, *)
    integer :: k

    do k = 1, block%n
      associate (p => block%points(1, k))
        gap(p) = block%gap(k)
        if (master_nodes(1, p) /= master_nodes(2, p)) then
          master_weights(:, p) = [1.0_wp - block%xi(k), block%xi(k)]
          normal(:, p) = block%normal(k, :)
        else
          slave_weights(:, p) = [1.0_wp - block%xi(k), block%xi(k)]
          normal(:, p) = -block%normal(k, :)
        end if
      end associate
    end do
  end subroutine store_points

  !> Type 4: the sub-segments of a virtual node have its gap and normal, and move along the master
  !> together until their resultant acts along the normal.
  pure subroutine store_virtual_nodes(positions, block, points)
    real(wp), intent(in), contiguous :: positions(:, :)
    type(arc_block_t), intent(in) :: block
    type(contact_points_t), intent(inout) :: points
    real(wp), dimension(4) :: own, difference, master
    real(wp) :: normal(2), d(2), t(2), lever, along, area
    integer :: k, p, first, last

    do k = 1, block%n
      normal = block%normal(k, :)
      first = block%points(1, k)
      last = block%points(2, k)
      lever = 0.0_wp
      along = 0.0_wp
      associate (a => points%slave_nodes(1, first), b => points%slave_nodes(2, first))
        own = positions(:, a) + points%slave_weights(2, first)*(positions(:, b) - positions(:, a))
      end associate
      do p = first, last
        associate (a => points%master_nodes(1, p), b => points%master_nodes(2, p))
          master = positions(:, b) - positions(:, a)
          difference = own - positions(:, a) - points%master_weights(2, p)*master
        end associate
        t = master(1:2) + master(3:4)
        d = difference(1:2) + difference(3:4)
        points%gap(p) = block%gap(k)
        points%normal(:, p) = normal
        ! Kept here until the lever is known: how far xi changes for a unit of it.
        points%master_weights(1, p) = 1.0_wp/sqrt(t(1)**2 + t(2)**2)
        area = points%area(p)
        lever = lever + area*(normal(1)*d(2) - normal(2)*d(1))
        along = along + area*(normal(1)*t(2) - normal(2)*t(1))*points%master_weights(1, p)
      end do
      lever = lever/along
      do p = first, last
        points%master_weights(2, p) = points%master_weights(2, p) &
          + lever*points%master_weights(1, p)
        points%master_weights(1, p) = 1.0_wp - points%master_weights(2, p)
      end do
    end do
  end subroutine store_virtual_nodes

  !> Gap of a node to the arc over a segment of the other surface less that to the segment, m.
  pure function offset_by_arc(memory, node, other) result(offset)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: node, other(n_side) !! local numbers
    real(wp) :: offset
    type(arc_block_t) :: block
    type(arc_shape_t) :: shape

    offset = 0.0_wp
    shape = present_shape(memory, other(1))
    if (is_flat(shape)) return
    block%n = 1
    block%nodes(:, 1) = [node, node, other]
    block%own_xi(1) = 0.0_wp
    block%own_bend(1) = 0.0_wp
    block%own_skew(1) = 0.0_wp
    block%bend(1) = shape%bend
    block%skew(1) = shape%skew
    call project_block(memory%positions, block)
    offset = block%offset(1)
  end function offset_by_arc

end module arc_points_m
