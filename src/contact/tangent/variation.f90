! SPDX-License-Identifier: MIT
!> Contact points with the derivatives of all that they consist of: the parts from which the
!> tangents of the formulations are made (doc/theory/contact.md, section 9). The placements decide
!> which segments and nodes a point depends on; here the same geometry is gone through once more in
!> dual numbers.
module variation_m
  use contact_state_m, only : contact_state_t
  use dual_m, only : dual_t, n_partial, constant, variable, operator(+), operator(-), operator(*), &
    operator(/), sqrt
  use foot_m, only : side_on, face_on, least_excess, most_excess
  use geometry_m, only : separation
  use kinds_m, only : wp
  use overlap_m, only : overlap_t
  use radii_m, only : radius_of
  implicit none
  private
  public :: between, varied_point_t, varied_foot_t, n_slot, round_off, apart, length_between, project, &
    spot_foot, put_foot, see_from, take_overlap, overlap_ends, vary_share, share_of, &
    side_share_of, cosine_of, &
    vary_radius, vary_end_radius, vary_centroid

  !> Nodes that a point depends on, at most.
  integer, parameter :: n_slot = n_partial/2
  !> A place no farther beyond a segment than this part of it is over it: at a node round-off
  !> decides.
  real(wp), parameter :: round_off = 1.0e-12_wp

  !> A point. Its forces act on the nodes in slots 1, 2 (slave side of the record) and 3, 4 (master
  !> side); it may depend on those in the other slots too. A node may stand in several slots;
  !> variable 2 i - 1 is u_x of slot i, 2 i its u_y.
  type :: varied_point_t
    integer :: nodes(n_slot) = 0   !! local numbers, 0 = slot not used
    type(dual_t) :: slave_xi       !! weights of slots 1, 2 are (1 - xi, xi)
    type(dual_t) :: master_xi      !! the same of slots 3, 4
    type(dual_t) :: normal(2)
    type(dual_t) :: gap
    type(dual_t) :: left           !! added to the gap before a law sees it: entry offset, m
    type(dual_t) :: area
  end type varied_point_t

  !> A foot on a segment.
  type :: varied_foot_t
    type(dual_t) :: xi
    type(dual_t) :: gap
    type(dual_t) :: normal(2)
  end type varied_foot_t

contains

  !> Vector from the node in slot j to that in slot i.
  pure function apart(places, nodes, i, j) result(d)
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node)
    integer, intent(in) :: nodes(n_slot)
    integer, intent(in) :: i, j
    type(dual_t) :: d(2)

    d = constant(separation(places(:, nodes(i)), places(:, nodes(j))))
    d(1)%slope(2*i - 1) = 1.0_wp
    d(2)%slope(2*i) = 1.0_wp
    d(1)%slope(2*j - 1) = d(1)%slope(2*j - 1) - 1.0_wp
    d(2)%slope(2*j) = d(2)%slope(2*j) - 1.0_wp
  end function apart

  !> Distance between the nodes in slots i and j.
  pure function length_between(places, nodes, i, j) result(length)
    real(wp), intent(in), contiguous :: places(:, :)
    integer, intent(in) :: nodes(n_slot)
    integer, intent(in) :: i, j
    type(dual_t) :: length, d(2)

    d = apart(places, nodes, i, j)
    length = sqrt(d(1)*d(1) + d(2)*d(2))
  end function length_between

  !> Foot on the line of a segment t of a place at d from its first node.
  pure function project(d, t) result(foot)
    type(dual_t), intent(in) :: d(2), t(2)
    type(varied_foot_t) :: foot
    type(dual_t) :: square, length

    square = t(1)*t(1) + t(2)*t(2)
    length = sqrt(square)
    foot%xi = (d(1)*t(1) + d(2)*t(2))/square
    foot%gap = (d(1)*t(2) - d(2)*t(1))/length
    foot%normal = [t(2)/length, -(t(1)/length)]
  end function project

  !> Foot like a known one: on the line of the segment, or at its node at a corner, where the normal
  !> points along the connection. A corner foot so close that its normal means nothing stands on the
  !> line.
  pure function vary_foot(d, t, xi, gap, closed_gap) result(foot)
    type(dual_t), intent(in) :: d(2)      !! from the segment's first node to the place
    type(dual_t), intent(in) :: t(2)      !! the segment
    real(wp), intent(in) :: xi, gap       !! of the known foot
    real(wp), intent(in) :: closed_gap    !! gaps that count as none, m
    type(varied_foot_t) :: foot
    type(dual_t) :: from_node(2)
    logical :: is_corner

    foot = project(d, t)
    is_corner = .not. (abs(xi) > 0.0_wp .and. abs(xi - 1.0_wp) > 0.0_wp)
    if (is_corner) is_corner = abs(foot%xi%value - 0.5_wp) > 0.5_wp + round_off
    if (.not. is_corner .or. abs(gap) <= max(closed_gap, tiny(1.0_wp))) return
    foot%xi = constant(xi)
    from_node = d - xi*t
    foot%gap = sign(1.0_wp, gap)*sqrt(from_node(1)*from_node(1) + from_node(2)*from_node(2))
    foot%normal = [from_node(1)/foot%gap, from_node(2)/foot%gap]
  end function vary_foot

  !> Foot of the point's spot, at slave_xi between slots 1 and 2 (at slot 1 where 2 is not used), on
  !> the segment in slots i and i + 1, like a known one.
  pure function spot_foot(places, point, i, xi, gap, closed_gap) result(foot)
    real(wp), intent(in), contiguous :: places(:, :)
    type(varied_point_t), intent(in) :: point
    integer, intent(in) :: i
    real(wp), intent(in) :: xi, gap    !! of the known foot
    real(wp), intent(in) :: closed_gap
    type(varied_foot_t) :: foot

    foot = vary_foot(see_from(places, point, i), apart(places, point%nodes, i + 1, i), xi, gap, &
      closed_gap)
  end function spot_foot

  !> Vector from the node in slot i to the point's spot.
  pure function see_from(places, point, i) result(d)
    real(wp), intent(in), contiguous :: places(:, :)
    type(varied_point_t), intent(in) :: point
    integer, intent(in) :: i
    type(dual_t) :: d(2)

    d = apart(places, point%nodes, 1, i)
    if (point%nodes(2) > 0) d = d + point%slave_xi*apart(places, point%nodes, 2, 1)
  end function see_from

  !> Let a foot on slots 3, 4 be that of the point.
  pure subroutine put_foot(point, foot)
    type(varied_point_t), intent(inout) :: point
    type(varied_foot_t), intent(in) :: foot

    point%master_xi = foot%xi
    point%gap = foot%gap
    point%left = constant(0.0_wp)
    point%normal = foot%normal
  end subroutine put_foot

  !> A value at xi between those of both nodes of a segment.
  pure function between(ends, xi) result(value)
    real(wp), intent(in) :: ends(2)
    type(dual_t), intent(in) :: xi
    type(dual_t) :: value

    value = (ends(2) - ends(1))*xi + ends(1)
  end function between

  !> Put a slave segment into slots 1, 2 and the nodes at the breakpoints of an overlap of it into
  !> slots 5 and 6; where there is room, those that the overlaps before and behind it have there
  !> into 7 and 8.
  pure subroutine take_overlap(memory, ends, overlaps, k, has_room, point)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)  !! nodes of the slave segment
    type(overlap_t), intent(in) :: overlaps(:)
    integer, intent(in) :: k        !! overlap
    logical, intent(in) :: has_room !! nothing else stands in slots 7 and 8
    type(varied_point_t), intent(out) :: point
    integer :: cuts(4)

    cuts = [overlaps(k)%first, overlaps(k)%last, 0, 0]
    if (has_room) cuts(3:4) = [cut_beside(overlaps, k, -1), cut_beside(overlaps, k, 1)]
    point%nodes(1:2) = ends
    where (cuts > 0) point%nodes(5:8) = memory%n_slave + cuts
  end subroutine take_overlap

  !> Master node at the near end of the next overlap that is not empty, one way or the other; 0:
  !> none.
  pure function cut_beside(overlaps, k, way) result(cut)
    type(overlap_t), intent(in) :: overlaps(:)
    integer, intent(in) :: k   !! overlap
    integer, intent(in) :: way !! -1: before it, 1: behind it
    integer :: cut, i

    cut = 0
    i = k + way
    do while (i >= 1 .and. i <= size(overlaps))
      if (overlaps(i)%high > overlaps(i)%low) then
        cut = merge(overlaps(i)%last, overlaps(i)%first, way < 0)
        return
      end if
      i = i + way
    end do
  end function cut_beside

  !> Where a piece of the slave segment in slots 1, 2 starts and ends on it; its cuts are the nodes
  !> in slots 5 and 6, where there are any. Where another chain begins before one ends that is half
  !> way between both nodes, if that of the other piece has a slot; else it is held.
  pure function overlap_ends(places, nodes, range) result(xi)
    real(wp), intent(in), contiguous :: places(:, :)
    integer, intent(in) :: nodes(n_slot)
    real(wp), intent(in) :: range(2) !! the same, without derivatives
    type(dual_t) :: xi(2)
    type(varied_foot_t) :: cut, other
    integer :: k

    xi = constant(range)
    do k = 1, 2
      if (nodes(4 + k) == 0) cycle
      cut = project(apart(places, nodes, 4 + k, 1), apart(places, nodes, 2, 1))
      other = cut
      if (nodes(6 + k) > 0) &
        other = project(apart(places, nodes, 6 + k, 1), apart(places, nodes, 2, 1))
      if (abs(cut%xi%value - range(k)) <= round_off) then
        xi(k) = cut%xi
      else if (abs(0.5_wp*(cut%xi%value + other%xi%value) - range(k)) <= round_off) then
        xi(k) = 0.5_wp*(cut%xi + other%xi)
      end if
    end do
  end function overlap_ends

  !> Share of the slave segment in slots i, i + 1 that counts as facing a foot with the given
  !> normal.
  pure function vary_share(places, nodes, i, normal) result(share)
    real(wp), intent(in), contiguous :: places(:, :)
    integer, intent(in) :: nodes(n_slot)
    integer, intent(in) :: i
    type(dual_t), intent(in) :: normal(2)
    type(dual_t) :: share

    share = share_of(apart(places, nodes, i + 1, i), normal)
  end function vary_share

  !> Share of a segment with the vector t that counts as opposed to a face with the given normal.
  pure function share_of(t, normal) result(share)
    type(dual_t), intent(in) :: t(2), normal(2)
    type(dual_t) :: share

    share = cosine_of(t, normal)
    share = smooth_step((1.0_wp/(side_on - face_on))*(side_on - share))
  end function share_of

  !> Share of the less opposed of both segments at a vertex, by its cosine and that of the other.
  pure function side_share_of(less, more) result(share)
    type(dual_t), intent(in) :: less, more
    type(dual_t) :: share

    share = smooth_step((1.0_wp/(most_excess - least_excess))*(most_excess - (less - more)))
  end function side_share_of

  !> Cosine between the outward normals of a segment with the vector t and of a face.
  pure function cosine_of(t, normal) result(cosine)
    type(dual_t), intent(in) :: t(2), normal(2)
    type(dual_t) :: cosine

    cosine = (t(2)*normal(1) - t(1)*normal(2))/sqrt(t(1)*t(1) + t(2)*t(2))
  end function cosine_of

  !> A step from 0 to 1 with slopes of zero.
  pure function smooth_step(along) result(share)
    type(dual_t), intent(in) :: along
    type(dual_t) :: share

    share = along
    if (share%value >= 1.0_wp) then
      share = constant(1.0_wp)
    else if (share%value <= 0.0_wp) then
      share = constant(0.0_wp)
    else
      share = share*share*(3.0_wp - 2.0_wp*share)
    end if
  end function smooth_step

  !> In axisymmetry: radius at xi of the segment in slots i, j.
  pure function vary_radius(places, nodes, i, j, xi) result(radius)
    real(wp), intent(in), contiguous :: places(:, :)
    integer, intent(in) :: nodes(n_slot)
    integer, intent(in) :: i, j
    type(dual_t), intent(in) :: xi
    type(dual_t) :: radius, t(2)

    radius = variable(radius_of(places(:, nodes(i))), 2*i - 1)
    t = apart(places, nodes, j, i)
    radius = radius + xi*t(1)
  end function vary_radius

  !> Mean radius of a stretch of the segment in slots i, j as its end at `near` has it.
  pure function vary_end_radius(places, nodes, i, j, near, far) result(radius)
    real(wp), intent(in), contiguous :: places(:, :)
    integer, intent(in) :: nodes(n_slot)
    integer, intent(in) :: i, j
    type(dual_t), intent(in) :: near, far !! places of its ends
    type(dual_t) :: radius

    radius = vary_radius(places, nodes, i, j, (1.0_wp/3.0_wp)*(2.0_wp*near + far))
  end function vary_end_radius

  !> Centre by radius of a stretch of the segment in slots i, j; the middle where nothing has
  !> weight.
  pure function vary_centroid(places, nodes, i, j, low, high) result(xi)
    real(wp), intent(in), contiguous :: places(:, :)
    integer, intent(in) :: nodes(n_slot)
    integer, intent(in) :: i, j
    type(dual_t), intent(in) :: low, high !! places of its ends
    type(dual_t) :: xi, first, last

    xi = 0.5_wp*(low + high)
    first = vary_radius(places, nodes, i, j, low)
    last = vary_radius(places, nodes, i, j, high)
    if (first%value + last%value > tiny(1.0_wp)) &
      xi = xi + (1.0_wp/6.0_wp)*((high - low)*(last - first)/(first + last))
  end function vary_centroid

end module variation_m
