! SPDX-License-Identifier: MIT
!> Where a place stands on a chain: its foot, with corners and ends. Two ways to find it:
!> `closest_foot` knows nothing of the past; `follow_contact` keeps a place that is in contact on
!> the face through which it came (doc/theory/contact.md, section 3). Many places at a time go
!> through foot_block, which leaves to this module what needs a decision.
module foot_m
  use geometry_m, only : sight_t, sight_of_segment, closest_distance, sight_normal
  use kinds_m, only : wp
  use surfaces_m, only : surface_t, meets_axis
  implicit none
  private
  public :: foot_t, mark_t, see_segment, closest_foot, near_foot, stays_over, vector_of, &
    face_foot, follow_contact, walk_to_closest, walk_to_mark, is_over_segment, turns_gently, &
    facing_share, side_share, end_tolerance, gentle_turn, side_on, face_on, least_excess, &
    most_excess, round_off

  !> Overshoot accepted beyond the end of a chain, as a part of the segment; not clamped.
  real(wp), parameter :: end_tolerance = 0.01_wp
  !> Cosine of the turn between two segments up to which their corner is gentle: a spot in contact
  !> changes over to the nearer one. At sharper corners it stays on its face until the face ends.
  real(wp), parameter :: gentle_turn = 0.5_wp
  !> Cosine of the angle between two outward normals from which on surfaces do not face each other
  !> (a block's side that stands on a surface has no part in its contact).
  real(wp), parameter :: side_on = -0.1_wp
  !> Cosine of that angle up to which surfaces face each other entirely (60 degrees between the
  !> surfaces). From there to `side_on` the share falls smoothly: a jump would create energy when a
  !> body turns.
  real(wp), parameter :: face_on = -0.5_wp
  !> By how much the cosine of the more opposed of both segments at a vertex exceeds that of the
  !> other where all of the other counts, and from where on nothing of it does: a side that stands
  !> at 70 degrees on a face is no part of a contact that the next one is in at 20 (0.598).
  real(wp), parameter :: least_excess = 0.1_wp, most_excess = 0.59_wp
  !> Part of a segment next to its ends where round-off decides on which side of a node a place is.
  real(wp), parameter :: round_off = 1.0e-12_wp

  !> The foot of a spot: the place weights (1 - xi, xi) on `segment`; spot - foot = gap * normal.
  type :: foot_t
    integer :: segment = 0
    logical :: is_on = .false.        !! false: beyond the end of a chain
    real(wp) :: xi = 0.0_wp
    real(wp) :: gap = 0.0_wp          !! m
    real(wp) :: normal(2) = 0.0_wp
    real(wp) :: distance = 0.0_wp     !! to the closest point, m
  end type foot_t

  !> A place on a chain reached by walking.
  type :: mark_t
    integer :: segment = 0
    integer :: n_step = 0    !! segments walked to it, negative backwards
    real(wp) :: xi = 0.0_wp
  end type mark_t

contains

  !> A spot seen from a segment of a chain.
  pure function see_segment(surface, chain, spot, segment) result(sight)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :) !! (4, n_node) places
    real(wp), intent(in) :: spot(4)
    integer, intent(in) :: segment
    type(sight_t) :: sight

    sight = sight_of_segment(spot, chain(:, surface%segments(1, segment)), &
      chain(:, surface%segments(2, segment)))
  end function see_segment

  !> Whether the spot is over the segment or within the tolerance beyond its ends.
  pure function is_over_segment(sight) result(is_over)
    type(sight_t), intent(in) :: sight
    logical :: is_over

    is_over = sight%along >= -end_tolerance*sight%square &
      .and. sight%along <= (1.0_wp + end_tolerance)*sight%square
  end function is_over_segment

  !> Segment closest to the spot, found by walking along the chain while that brings it nearer.
  pure function walk_to_closest(surface, chain, spot, start) result(segment)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4)
    integer, intent(in) :: start
    integer :: segment
    real(wp) :: square, nearer
    integer :: candidates(2), i, best

    segment = start
    square = closest_distance(see_segment(surface, chain, spot, segment))
    do
      candidates = [surface%previous(segment), surface%next(segment)]
      best = 0
      do i = 1, 2
        if (candidates(i) == 0) cycle
        nearer = closest_distance(see_segment(surface, chain, spot, candidates(i)))
        if (.not. nearer < square) cycle
        square = nearer
        best = candidates(i)
      end do
      if (best == 0) then
        best = beyond_node(segment)
        if (best == 0) exit
        square = closest_distance(see_segment(surface, chain, spot, best))
      end if
      segment = best
    end do

  contains

    !> The segment behind a neighbour, if it is nearer than the node that both share.
    pure integer function beyond_node(segment) result(beyond)
      integer, intent(in) :: segment
      type(sight_t) :: sight

      sight = see_segment(surface, chain, spot, segment)
      beyond = 0
      if (sight%along < 0.0_wp) then
        beyond = surface%previous(segment)
        if (beyond > 0) beyond = surface%previous(beyond)
      else if (sight%along > sight%square) then
        beyond = surface%next(segment)
        if (beyond > 0) beyond = surface%next(beyond)
      end if
      if (beyond == 0) return
      sight = see_segment(surface, chain, spot, beyond)
      if (.not. closest_distance(sight) < square*(1.0_wp - round_off)) beyond = 0
    end function beyond_node

  end function walk_to_closest

  !> Foot of a spot whose closest segment is known.
  pure function closest_foot(surface, chain, spot, segment) result(foot)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4)
    integer, intent(in) :: segment
    type(foot_t) :: foot
    type(sight_t) :: sight
    integer :: neighbour

    sight = see_segment(surface, chain, spot, segment)
    neighbour = 0
    if (sight%along < 0.0_wp) neighbour = surface%previous(segment)
    if (sight%along > sight%square) neighbour = surface%next(segment)
    if (neighbour == 0) then
      foot = end_foot(surface, sight, segment)
    else
      foot = corner_foot(sight, see_segment(surface, chain, spot, neighbour), [segment, neighbour])
    end if
  end function closest_foot

  !> Closest foot of a place, found by walking from a segment near it. Where the closest points of
  !> both neighbours are the nodes in common there is no need to walk.
  pure function nearest_foot(surface, chain, spot, start) result(foot)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4)
    integer, intent(in) :: start
    type(foot_t) :: foot
    type(sight_t) :: sight

    sight = see_segment(surface, chain, spot, start)
    if (stays_over(surface, chain, sight%t, sight%d, start)) then
      foot = face_foot(sight, start)
    else
      foot = closest_foot(surface, chain, spot, walk_to_closest(surface, chain, spot, start))
    end if
  end function nearest_foot

  !> Whether a place is over a segment and no nearer to a neighbour: over neither, or farther from
  !> its line.
  pure function stays_over(surface, chain, t, d, segment) result(stays)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
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
      real(wp), intent(in) :: from_node(2) !! from the node in common to the place, m
      real(wp), intent(in) :: way          !! 1: the neighbour lies before, -1: behind
      logical :: is
      real(wp) :: beside(2)

      beside = vector_of(surface, chain, neighbour)
      is = way*(from_node(1)*beside(1) + from_node(2)*beside(2)) >= 0.0_wp
      if (.not. is) is = (from_node(1)*beside(2) - from_node(2)*beside(1))**2*square &
        >= (d(1)*t(2) - d(2)*t(1))**2*(beside(1)**2 + beside(2)**2)
    end function is_no_nearer

  end function stays_over

  !> Vector of a segment, m.
  pure function vector_of(surface, chain, segment) result(t)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    integer, intent(in) :: segment
    real(wp) :: t(2)

    associate (a => surface%segments(1, segment), b => surface%segments(2, segment))
      t = (chain(1:2, b) - chain(1:2, a)) + (chain(3:4, b) - chain(3:4, a))
    end associate
  end function vector_of

  !> Foot of a place that is not followed, near a known segment: behind the surface it belongs to
  !> the face that it came through, outside to the closest one.
  pure function near_foot(surface, chain, spot, start) result(foot)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4)
    integer, intent(in) :: start
    type(foot_t) :: foot, closest
    type(sight_t) :: sight
    integer :: neighbour
    logical :: backwards

    sight = see_segment(surface, chain, spot, start)
    if (sight%along > 0.0_wp .and. sight%along < sight%square) then
      ! Behind the face by less than it is away from its ends: nothing else is nearer.
      if (sight%across < 0.0_wp .and. -sight%across <= min(sight%along, sight%square &
        - sight%along)) then
        foot = face_foot(sight, start)
        return
      end if
    else
      backwards = sight%along < 0.0_wp
      neighbour = merge(surface%previous(start), surface%next(start), backwards)
      if (neighbour > 0) then
        associate (other => see_segment(surface, chain, spot, neighbour))
          if (is_before(other, backwards)) then
            ! Over neither of two faces, on the same side of both: the node between them. Behind it
            ! that is what is found first in a valley.
            foot = corner_foot(sight, other, [start, neighbour])
            if (foot%gap < 0.0_wp .or. min(sight%across, other%across) > 0.0_wp) return
          else if (other%across >= 0.0_wp .or. (sight%across < 0.0_wp .and. turns_gently(sight%t, &
            other%t))) then
            if (stays_over(surface, chain, other%t, other%d, neighbour)) then
              foot = face_foot(other, neighbour)
              return
            end if
          end if
        end associate
      end if
    end if
    closest = nearest_foot(surface, chain, spot, start)
    foot = closest
    if (closest%is_on .and. closest%gap >= 0.0_wp) return
    foot = follow_contact(surface, chain, spot, start)
    if (.not. (foot%is_on .and. foot%gap < 0.0_wp)) foot = closest
  end function near_foot

  !> Foot on the line of a segment; beyond the tolerance it is not on the chain.
  pure function face_foot(sight, segment) result(foot)
    type(sight_t), intent(in) :: sight
    integer, intent(in) :: segment
    type(foot_t) :: foot

    real(wp) :: length

    length = sqrt(sight%square)
    foot%segment = segment
    foot%is_on = is_over_segment(sight)
    foot%xi = sight%along/sight%square
    foot%gap = sight%across/length
    foot%normal(1) = sight%t(2)/length
    foot%normal(2) = -sight%t(1)/length
    if (sight%along >= 0.0_wp .and. sight%along <= sight%square) then
      foot%distance = abs(foot%gap)
    else
      foot%distance = sqrt(closest_distance(sight))
    end if
  end function face_foot

  !> Foot on a segment, or beyond it at a chain's end. On the axis of a body of revolution the
  !> surface has none: the place is behind a dish, and its foot stays on the line.
  pure function end_foot(surface, sight, segment) result(foot)
    type(surface_t), intent(in) :: surface
    type(sight_t), intent(in) :: sight
    integer, intent(in) :: segment
    type(foot_t) :: foot

    foot = face_foot(sight, segment)
    if (.not. foot%is_on) foot%is_on = meets_axis(surface, segment, sight%along < 0.0_wp)
  end function end_foot

  !> Foot at the node between two segments, neither of which has the spot over it. Outside of a
  !> convex corner the gap is the distance. Inside of a re-entrant one it is minus the distance and
  !> the normal points from the spot to the node, so that P2 holds. The sides are told apart by the
  !> mean normal. The foot is that of the segment to whose normal its own is nearer, whose line is
  !> farther away: either has the node.
  pure function corner_foot(sight, other, segments) result(foot)
    type(sight_t), intent(in) :: sight !! from a segment
    type(sight_t), intent(in) :: other !! from its neighbour at the corner
    integer, intent(in) :: segments(2) !! these
    type(foot_t) :: foot
    real(wp) :: d(2), mean_normal(2), side

    foot%segment = segments(1)
    foot%is_on = .true.
    foot%xi = merge(0.0_wp, 1.0_wp, sight%along < 0.0_wp)
    d = sight%d - foot%xi*sight%t
    if (other%across**2*sight%square > sight%across**2*other%square) then
      foot%segment = segments(2)
      foot%xi = 1.0_wp - foot%xi
    end if
    foot%distance = norm2(d)
    mean_normal = sight_normal(sight) + sight_normal(other)
    side = dot_product(d, mean_normal)
    if (foot%distance > tiny(1.0_wp)) then
      foot%gap = sign(foot%distance, side)
      foot%normal = d/foot%gap
    else
      foot%gap = 0.0_wp
      foot%normal = mean_normal/max(norm2(mean_normal), tiny(1.0_wp))
    end if
  end function corner_foot

  !> Foot of a spot in contact, starting from the segment it was on: stays on the face until it
  !> ends, goes on to the next one there, changes to a nearer face across gentle corners. When the
  !> contact has ended the foot is not on the chain or its gap is not negative.
  pure function follow_contact(surface, chain, spot, start) result(foot)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4)
    integer, intent(in) :: start
    type(foot_t) :: foot
    type(sight_t) :: sight, other
    integer :: segment, neighbour, i_step

    segment = start
    do i_step = 1, surface%n_segment
      sight = see_segment(surface, chain, spot, segment)
      if (sight%along >= 0.0_wp .and. sight%along <= sight%square) then
        neighbour = nearer_face(surface, chain, spot, segment, sight)
        foot = face_foot(sight, segment)
        if (neighbour == 0) return
        segment = neighbour
        cycle
      end if
      neighbour = merge(surface%previous(segment), surface%next(segment), sight%along < 0.0_wp)
      if (neighbour == 0) then
        foot = end_foot(surface, sight, segment)
        return
      end if
      other = see_segment(surface, chain, spot, neighbour)
      if (is_before(other, sight%along < 0.0_wp)) then
        foot = corner_foot(sight, other, [segment, neighbour])
        return
      else if (.not. turns_gently(sight%t, other%t) .and. &
        (other%across >= 0.0_wp .or. is_over_segment(sight))) then
        foot = face_foot(sight, segment)
        return
      end if
      segment = neighbour
    end do
  end function follow_contact

  !> Whether two segments meet at a gentle corner: they turn by 60 degrees at most.
  pure function turns_gently(one, two)
    real(wp), intent(in) :: one(2), two(2) !! vectors of the segments, m
    logical :: turns_gently
    real(wp) :: product

    product = one(1)*two(1) + one(2)*two(2)
    turns_gently = product >= 0.0_wp .and. product*product >= gentle_turn**2*((one(1)*one(1) &
      + one(2)*one(2))*(two(1)*two(1) + two(2)*two(2)))
  end function turns_gently

  !> Whether the spot has not yet reached the segment it is walking to (backwards or forwards).
  pure function is_before(sight, backwards) result(before)
    type(sight_t), intent(in) :: sight
    logical, intent(in) :: backwards
    logical :: before

    before = merge(sight%along > sight%square, sight%along < 0.0_wp, backwards)
  end function is_before

  !> Neighbour across a gentle corner that a penetrating spot is nearer to, or 0. Such a neighbour
  !> can only be nearer when the gap exceeds the distance to the end of the segment.
  pure function nearer_face(surface, chain, spot, segment, sight) result(neighbour)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4)
    integer, intent(in) :: segment
    type(sight_t), intent(in) :: sight
    integer :: neighbour
    type(sight_t) :: other
    integer :: candidates(2), i

    neighbour = 0
    if (-sight%across <= min(sight%along, sight%square - sight%along)) return
    candidates = [surface%previous(segment), surface%next(segment)]
    do i = 1, 2
      if (candidates(i) == 0) cycle
      other = see_segment(surface, chain, spot, candidates(i))
      if (other%along < 0.0_wp .or. other%along > other%square) cycle
      if (other%across >= 0.0_wp) cycle
      if (.not. turns_gently(sight%t, other%t)) cycle
      if (other%across**2*sight%square >= sight%across**2*other%square) cycle
      neighbour = candidates(i)
      return
    end do
  end function nearer_face

  !> Project a place on a chain, starting at a segment and going on to the neighbour where it runs
  !> over a node. It stops at the chain's end (with the usual overshoot), at a sharp corner, and at
  !> a node that no neighbour sees it beyond.
  pure function walk_to_mark(surface, chain, place, start) result(mark)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :) !! (4, n_node) places
    real(wp), intent(in) :: place(4)
    integer, intent(in) :: start
    type(mark_t) :: mark
    type(sight_t) :: sight, other
    logical :: backwards
    integer :: neighbour, i_step

    mark%segment = start
    sight = see_segment(surface, chain, place, start)
    backwards = sight%along < 0.0_wp
    do i_step = 1, surface%n_segment
      mark%xi = sight%along/sight%square
      if (sight%along >= 0.0_wp .and. sight%along <= sight%square) return
      if (backwards .neqv. sight%along < 0.0_wp) exit
      neighbour = merge(surface%previous(mark%segment), surface%next(mark%segment), backwards)
      if (neighbour == 0) then
        if (.not. is_over_segment(sight)) exit
        return
      end if
      other = see_segment(surface, chain, place, neighbour)
      if (.not. turns_gently(sight%t, other%t)) then
        ! At a sharp convex vertex the face ends as at the end of an open surface.
        if (is_over_segment(sight) .and. merge(-1.0_wp, 1.0_wp, backwards)*(sight%t(1)*other%t(2) &
          - sight%t(2)*other%t(1)) > 0.0_wp) return
        exit
      end if
      sight = other
      mark%segment = neighbour
      mark%n_step = mark%n_step + merge(-1, 1, backwards)
    end do
    mark%xi = max(0.0_wp, min(1.0_wp, mark%xi))
  end function walk_to_mark

  !> How much of the side next to a vertex counts, 0 to 1, where the segment on the other side of
  !> the vertex is opposed to the same face by a cosine that is so much larger.
  pure function side_share(excess) result(share)
    real(wp), intent(in) :: excess
    real(wp) :: share

    share = max(0.0_wp, min(1.0_wp, (most_excess - excess)/(most_excess - least_excess)))
    share = share*share*(3.0_wp - 2.0_wp*share)
  end function side_share

  !> How much of a surface counts where its outward normal and that of the other side have this
  !> cosine, 0 to 1.
  pure function facing_share(cosine) result(share)
    real(wp), intent(in) :: cosine
    real(wp) :: share

    share = 1.0_wp
    if (cosine <= face_on) return
    share = max(0.0_wp, min(1.0_wp, (side_on - cosine)/(side_on - face_on)))
    share = share*share*(3.0_wp - 2.0_wp*share)
  end function facing_share

end module foot_m
