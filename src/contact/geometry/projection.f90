! SPDX-License-Identifier: MIT
!> Where a position stands on a surface: its projection, with corners and ends. Two ways to find it:
!> `closest_projection` knows nothing of the past; `follow_contact` keeps a position that is in
!> contact on the face through which it came (doc/theory/contact.md, section 3). Many positions at a
!> time go through projection_block, which leaves to this module what needs a decision.
module projection_m
  use geometry_m, only : local_coordinates_t, coordinates_on_segment, closest_distance, &
    local_normal, separation
  use kinds_m, only : wp
  use projection_block_m, only : round_off, on_bisector, bisector_width
  use surfaces_m, only : surface_t, meets_axis
  implicit none
  private
  public :: projection_t, local_coordinates, closest_projection, nearest_projection, &
    nearby_projection, stays_over, vector_of, face_projection, is_over_segment, follow_contact, &
    find_closest_segment, turns_gently, opposed_share, side_share, end_tolerance, gentle_turn, &
    side_on, face_on, gentle_vertex, sharp_vertex, slave_side, master_side, round_off, &
    on_bisector, penetrated_projection

  !> Overshoot accepted beyond the end of a surface, as a part of the segment; not clamped.
  real(wp), parameter :: end_tolerance = 0.01_wp
  !> Cosine of the turn between two segments up to which their corner is gentle: a point in contact
  !> changes over to the nearer one. At sharper corners it stays on its face until the face ends.
  real(wp), parameter :: gentle_turn = 0.5_wp
  !> Cosine of the angle between two outward normals from which on surfaces are not opposed
  !> (a block's side that stands on a surface has no part in its contact).
  real(wp), parameter :: side_on = -0.1_wp
  !> Cosine of that angle up to which surfaces are opposed entirely (60 degrees between the
  !> surfaces). From there to `side_on` the share falls smoothly: a jump would create energy when a
  !> body turns.
  real(wp), parameter :: face_on = -0.5_wp
  !> One minus the cosine of the turn at a convex vertex up to which both of its segments count, and
  !> from which on one counts as far as the other does not: a side at 70 degrees to a face has no
  !> part in a contact that the next one is in at 20.
  real(wp), parameter :: gentle_vertex = 0.1_wp, sharp_vertex = 0.59_wp
  !> Excess of the cosine of a segment at a sharp vertex over that of the other, up to which it
  !> counts and from which on it does not. Of a slave's two segments the more opposed one counts:
  !> the spring of a corner that rolls on a face stays as stiff as it is. Those of a master lie over
  !> different parts of the slave.
  real(wp), parameter :: slave_side(2) = [-0.1_wp, 0.1_wp], master_side(2) = [0.1_wp, 0.59_wp]

  !> The projection of a point: weights (1 - xi, xi) on `segment`; point - projection = gap *
  !> normal.
  type :: projection_t
    integer :: segment = 0
    logical :: is_on = .false.        !! false: beyond the end of a surface
    real(wp) :: xi = 0.0_wp
    real(wp) :: gap = 0.0_wp          !! m
    real(wp) :: normal(2) = 0.0_wp
    real(wp) :: distance = 0.0_wp     !! to the closest point, m
  end type projection_t

contains

  !> A point seen from a segment of a surface.
  pure function local_coordinates(surface, polyline, point, segment) result(local)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :) !! (4, n_node) positions
    real(wp), intent(in) :: point(4)
    integer, intent(in) :: segment
    type(local_coordinates_t) :: local

    local = coordinates_on_segment(point, polyline(:, surface%segments(1, segment)), &
      polyline(:, surface%segments(2, segment)))
  end function local_coordinates

  !> Whether the point is over the segment or within the tolerance beyond its ends.
  pure function is_over_segment(local) result(is_over)
    type(local_coordinates_t), intent(in) :: local
    logical :: is_over

    is_over = local%along >= -end_tolerance*local%square &
      .and. local%along <= (1.0_wp + end_tolerance)*local%square
  end function is_over_segment

  !> Segment closest to the point, found by walking along the surface while that brings it nearer.
  pure function find_closest_segment(surface, polyline, point, start) result(segment)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :)
    real(wp), intent(in) :: point(4)
    integer, intent(in) :: start
    integer :: segment
    real(wp) :: square, nearer
    integer :: candidates(2), i, best

    segment = start
    square = closest_distance(local_coordinates(surface, polyline, point, segment))
    do
      candidates = [surface%previous(segment), surface%next(segment)]
      best = 0
      do i = 1, 2
        if (candidates(i) == 0) cycle
        nearer = closest_distance(local_coordinates(surface, polyline, point, candidates(i)))
        if (.not. nearer < square) cycle
        square = nearer
        best = candidates(i)
      end do
      if (best == 0) then
        best = beyond_node(segment)
        if (best == 0) exit
        square = closest_distance(local_coordinates(surface, polyline, point, best))
      end if
      segment = best
    end do

  contains

    !> The segment behind a neighbour, if it is nearer than the node that both share.
    pure integer function beyond_node(segment) result(beyond)
      integer, intent(in) :: segment
      type(local_coordinates_t) :: local

      local = local_coordinates(surface, polyline, point, segment)
      beyond = 0
      if (local%along < 0.0_wp) then
        beyond = surface%previous(segment)
        if (beyond > 0) beyond = surface%previous(beyond)
      else if (local%along > local%square) then
        beyond = surface%next(segment)
        if (beyond > 0) beyond = surface%next(beyond)
      end if
      if (beyond == 0) return
      local = local_coordinates(surface, polyline, point, beyond)
      if (.not. closest_distance(local) < square*(1.0_wp - round_off)) beyond = 0
    end function beyond_node

  end function find_closest_segment

  !> Projection of a point whose closest segment is known.
  pure function closest_projection(surface, polyline, point, segment) result(projection)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :)
    real(wp), intent(in) :: point(4)
    integer, intent(in) :: segment
    type(projection_t) :: projection
    type(local_coordinates_t) :: local
    integer :: neighbour

    local = local_coordinates(surface, polyline, point, segment)
    neighbour = 0
    if (local%along < 0.0_wp) neighbour = surface%previous(segment)
    if (local%along > local%square) neighbour = surface%next(segment)
    if (neighbour == 0) then
      projection = end_projection(surface, local, segment)
    else
      projection = vertex_projection(local, local_coordinates(surface, polyline, point, &
        neighbour), [segment, neighbour])
    end if
  end function closest_projection

  !> Closest projection of a position, found by walking from a segment near it. Where the closest
  !> points of both neighbours are the nodes in common there is no need to walk.
  pure function nearest_projection(surface, polyline, point, start) result(projection)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :)
    real(wp), intent(in) :: point(4)
    integer, intent(in) :: start
    type(projection_t) :: projection
    type(local_coordinates_t) :: local

    local = local_coordinates(surface, polyline, point, start)
    if (stays_over(surface, polyline, local%t, local%d, start)) then
      projection = face_projection(local, start)
    else
      projection = closest_projection(surface, polyline, point, &
        find_closest_segment(surface, polyline, point, start))
    end if
  end function nearest_projection

  !> Whether a position is over a segment and no nearer to a neighbour: over neither, or farther
  !> from its line.
  pure function stays_over(surface, polyline, t, d, segment) result(stays)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :)
    real(wp), intent(in) :: t(2), d(2) !! vector of the segment, and from its first node, m
    integer, intent(in) :: segment
    logical :: stays
    real(wp) :: along, square

    along = d(1)*t(1) + d(2)*t(2)
    square = t(1)*t(1) + t(2)*t(2)
    stays = along > 0.0_wp .and. along < square
    if (stays .and. surface%previous(segment) > 0) stays = is_no_nearer(surface%previous(segment), &
      d, 1.0_wp)
    if (stays .and. surface%next(segment) > 0) stays = is_no_nearer(surface%next(segment), d - t, &
      -1.0_wp)

  contains

    !> Whether a neighbour is no nearer.
    pure function is_no_nearer(neighbour, from_node, way) result(is)
      integer, intent(in) :: neighbour
      real(wp), intent(in) :: from_node(2) !! from the node in common to the position, m
      real(wp), intent(in) :: way          !! 1: the neighbour lies before, -1: behind
      logical :: is
      real(wp) :: beside(2)

      beside = vector_of(surface, polyline, neighbour)
      is = way*(from_node(1)*beside(1) + from_node(2)*beside(2)) >= 0.0_wp
      if (.not. is) is = (from_node(1)*beside(2) - from_node(2)*beside(1))**2*square &
        >= (d(1)*t(2) - d(2)*t(1))**2*(beside(1)**2 + beside(2)**2)
    end function is_no_nearer

  end function stays_over

  !> Vector of a segment, m.
  pure function vector_of(surface, polyline, segment) result(t)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :)
    integer, intent(in) :: segment
    real(wp) :: t(2)

    associate (a => surface%segments(1, segment), b => surface%segments(2, segment))
      t = separation(polyline(:, b), polyline(:, a))
    end associate
  end function vector_of

  !> Projection of a position that is not followed, near a known segment: behind the surface it
  !> belongs to the face that it came through, outside to the closest one.
  pure function nearby_projection(surface, polyline, point, start) result(projection)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :)
    real(wp), intent(in) :: point(4)
    integer, intent(in) :: start
    type(projection_t) :: projection, closest
    type(local_coordinates_t) :: local

    local = local_coordinates(surface, polyline, point, start)
    ! Behind the face by less than it is away from its ends: nothing else is nearer.
    if (local%across < 0.0_wp .and. -local%across <= min(local%along, local%square &
      - local%along)) then
      projection = face_projection(local, start)
      return
    end if
    closest = nearest_projection(surface, polyline, point, start)
    projection = closest
    if (closest%is_on .and. closest%gap >= 0.0_wp) return
    projection = follow_contact(surface, polyline, point, start)
    if (.not. (projection%is_on .and. projection%gap < 0.0_wp)) projection = closest
  end function nearby_projection

  !> Projection on the line of a segment; beyond the tolerance it is not on the surface.
  pure function face_projection(local, segment) result(projection)
    type(local_coordinates_t), intent(in) :: local
    integer, intent(in) :: segment
    type(projection_t) :: projection
    real(wp) :: length

    length = sqrt(local%square)
    projection%segment = segment
    projection%is_on = is_over_segment(local)
    projection%xi = local%along/local%square
    projection%gap = local%across/length
    projection%normal = [local%t(2), -local%t(1)]/length
    if (local%along >= 0.0_wp .and. local%along <= local%square) then
      projection%distance = abs(projection%gap)
    else
      projection%distance = sqrt(closest_distance(local))
    end if
  end function face_projection

  !> Projection on a segment, or beyond it at a surface's end. On the axis of a body of revolution
  !> the surface has none: the position is behind a dish, and its projection stays on the line.
  pure function end_projection(surface, local, segment) result(projection)
    type(surface_t), intent(in) :: surface
    type(local_coordinates_t), intent(in) :: local
    integer, intent(in) :: segment
    type(projection_t) :: projection

    projection = face_projection(local, segment)
    if (.not. projection%is_on) projection%is_on = meets_axis(surface, segment, local%along &
      < 0.0_wp)
  end function end_projection

  !> Projection at the node between two segments: neither has the point over it, or both have and
  !> are as near. Outside of a convex corner the gap is the distance. Inside of a corner it is minus
  !> the distance and the normal points from the point to the node, so that P2 holds. The mean
  !> normal separates both sides. The projection is that of the segment to whose normal its own is
  !> nearer, whose line is farther away: either has the node. On the bisector it stays.
  pure function vertex_projection(local, other, segments) result(projection)
    type(local_coordinates_t), intent(in) :: local !! from a segment
    type(local_coordinates_t), intent(in) :: other !! from its neighbour at the corner
    integer, intent(in) :: segments(2) !! these
    type(projection_t) :: projection
    real(wp) :: d(2), mean_normal(2), side

    projection%segment = segments(1)
    projection%is_on = .true.
    projection%xi = merge(0.0_wp, 1.0_wp, local%along < 0.5_wp*local%square)
    d = local%d - projection%xi*local%t
    if (excess_of(local, other) > width_of(local, other)) then
      projection%segment = segments(2)
      projection%xi = 1.0_wp - projection%xi
    end if
    projection%distance = norm2(d)
    mean_normal = local_normal(local) + local_normal(other)
    side = dot_product(d, mean_normal)
    projection%gap = sign(projection%distance, side)
    if (projection%distance > on_bisector*sqrt(local%square)) then
      projection%normal = d/projection%gap
    else
      projection%normal = mean_normal/max(norm2(mean_normal), tiny(1.0_wp))
    end if
  end function vertex_projection

  !> Projection of a point in contact, starting from the segment it was on: stays on the face until
  !> it ends, moves to the next one there, changes to a nearer face across gentle corners. When
  !> the contact has ended the projection is not on the surface or its gap is not negative.
  pure function follow_contact(surface, polyline, point, start) result(projection)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :)
    real(wp), intent(in) :: point(4)
    integer, intent(in) :: start
    type(projection_t) :: projection
    type(local_coordinates_t) :: local, other
    integer :: segment, neighbour, i_step

    segment = start
    do i_step = 1, surface%n_segment
      local = local_coordinates(surface, polyline, point, segment)
      if (local%along >= 0.0_wp .and. local%along <= local%square) then
        neighbour = nearer_face(surface, polyline, point, segment, local)
        projection = penetrated_projection(surface, polyline, point, segment)
        if (neighbour == 0) return
        segment = neighbour
        cycle
      end if
      neighbour = merge(surface%previous(segment), surface%next(segment), local%along < 0.0_wp)
      if (neighbour == 0) then
        projection = end_projection(surface, local, segment)
        return
      end if
      other = local_coordinates(surface, polyline, point, neighbour)
      ! Over neither of both.
      if (merge(other%along > other%square, other%along < 0.0_wp, local%along < 0.0_wp)) then
        projection = vertex_projection(local, other, [segment, neighbour])
        return
      else if (.not. turns_gently(local%t, other%t) .and. &
        (other%across >= 0.0_wp .or. is_over_segment(local))) then
        projection = face_projection(local, segment)
        return
      end if
      segment = neighbour
    end do
  end function follow_contact

  !> Projection of a position over a segment. On the bisector of a gentle convex corner, behind both
  !> of its segments, it is that on the node, with a normal between theirs: else round-off would
  !> choose between the two.
  pure function penetrated_projection(surface, polyline, point, segment) result(projection)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :)
    real(wp), intent(in) :: point(4)
    integer, intent(in) :: segment
    type(projection_t) :: projection
    type(local_coordinates_t) :: local, other
    integer :: neighbour

    local = local_coordinates(surface, polyline, point, segment)
    projection = face_projection(local, segment)
    if (on_bisector*local%square - local%across < min(local%along, local%square - local%along)) &
      return
    neighbour = merge(surface%previous(segment), surface%next(segment), &
      local%along < 0.5_wp*local%square)
    if (neighbour == 0) return
    other = local_coordinates(surface, polyline, point, neighbour)
    if (other%across > on_bisector*other%square .or. .not. turns_gently(local%t, other%t)) return
    if (abs(excess_of(local, other)) < width_of(local, other)) &
      projection = vertex_projection(local, other, [segment, neighbour])
  end function penetrated_projection

  !> Square of the gap to a neighbour less that of the gap to a segment, times the squares of their
  !> lengths, m^6.
  pure function excess_of(local, other) result(excess)
    type(local_coordinates_t), intent(in) :: local, other !! from the segment and from its neighbour
    real(wp) :: excess

    excess = other%across**2*local%square - local%across**2*other%square
  end function excess_of

  !> Largest excess on the bisector of the corner between both; zero on a line.
  pure function width_of(local, other) result(width)
    type(local_coordinates_t), intent(in) :: local, other
    real(wp) :: width

    width = bisector_width(dot_product(local%t, other%t), local%square, other%square, local%across)
  end function width_of

  !> Whether two segments meet at a gentle corner: they turn by 60 degrees at most.
  pure function turns_gently(one, two)
    real(wp), intent(in) :: one(2), two(2) !! vectors of the segments, m
    logical :: turns_gently
    real(wp) :: product

    product = one(1)*two(1) + one(2)*two(2)
    turns_gently = product >= 0.0_wp .and. product*product >= gentle_turn**2*((one(1)*one(1) &
      + one(2)*one(2))*(two(1)*two(1) + two(2)*two(2)))
  end function turns_gently

  !> Neighbour across a gentle corner that a point is nearer to, or 0: none unless the distance to
  !> the segment exceeds that to its end.
  pure function nearer_face(surface, polyline, point, segment, local) result(neighbour)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :)
    real(wp), intent(in) :: point(4)
    integer, intent(in) :: segment
    type(local_coordinates_t), intent(in) :: local
    integer :: neighbour
    type(local_coordinates_t) :: other
    integer :: candidates(2), i

    neighbour = 0
    if (abs(local%across) <= min(local%along, local%square - local%along)) return
    candidates = [surface%previous(segment), surface%next(segment)]
    do i = 1, 2
      if (candidates(i) == 0) cycle
      other = local_coordinates(surface, polyline, point, candidates(i))
      if (other%along < 0.0_wp .or. other%along > other%square) cycle
      if (.not. turns_gently(local%t, other%t)) cycle
      if (excess_of(local, other) >= -width_of(local, other)) cycle
      neighbour = candidates(i)
      return
    end do
  end function nearer_face

  !> How much of a segment next to a convex vertex counts, 0 to 1.
  pure function side_share(turn, excess, range) result(share)
    real(wp), intent(in) :: turn     !! cosine of the turn at the vertex
    real(wp), intent(in) :: excess   !! cosine of the normals of the segment and of a face less that
                                     !! of the other segment and the face
    real(wp), intent(in) :: range(2) !! of the excess: all counts, nothing does if the turn is sharp
    real(wp) :: share

    share = 1.0_wp
    if (turn < 1.0_wp - gentle_vertex) share = 1.0_wp - smooth_step((1.0_wp - turn &
      - gentle_vertex)/(sharp_vertex - gentle_vertex))*smooth_step((excess - range(1)) &
      /(range(2) - range(1)))
  end function side_share

  !> How much of a surface counts where its outward normal and that of the other side have this
  !> cosine, 0 to 1.
  pure function opposed_share(cosine) result(share)
    real(wp), intent(in) :: cosine
    real(wp) :: share

    share = 1.0_wp
    if (cosine > face_on) share = smooth_step((side_on - cosine)/(side_on - face_on))
  end function opposed_share

  !> A step from 0 to 1 with slopes of zero.
  pure function smooth_step(along) result(share)
    real(wp), intent(in) :: along
    real(wp) :: share

    share = max(0.0_wp, min(1.0_wp, along))
    share = share*share*(3.0_wp - 2.0_wp*share)
  end function smooth_step

end module projection_m
