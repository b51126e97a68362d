! SPDX-License-Identifier: MIT
!> A slave segment over its candidates: the master segments below its ends, the closest one; and how
!> much of the side next to a convex vertex of a closed boundary counts (doc/theory/contact.md,
!> section 3.5).
module slave_segments_m
  use contact_state_m, only : contact_state_t, active
  use contacts_m, only : contact_t
  use geometry_m, only : local_coordinates_t, closest_distance, separation
  use kinds_m, only : wp
  use projection_m, only : projection_t, closest_projection, side_on, side_share, gentle_vertex, &
    slave_side, master_side, local_coordinates, vector_of, turns_gently
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: slave_segment_t, start_segment, closest_candidate, is_opposed_to_contact, sides_part, &
    near_node

  !> Part of a segment within which a projection is on its node.
  real(wp), parameter :: near_node = 1.0e-9_wp

  !> A slave segment. Without default values, which would be written before each use.
  type :: slave_segment_t
    integer :: number
    integer :: ends(2)       !! nodes
    logical :: is_active(2)  !! its ends
    real(wp) :: margins(2)   !! parts of it next to its ends where master nodes are no breakpoints
    integer :: below(2)      !! master segments that its ends have their projections on, 0: none
    real(wp) :: start(4)     !! position of its first end
    real(wp) :: t(2)         !! its vector, m
    real(wp) :: square       !! of its length, m^2
  end type slave_segment_t

contains

  !> A slave segment at the present positions.
  pure subroutine start_segment(contact, memory, s, least_part, own)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s           !! its number
    real(wp), intent(in) :: least_part !! margins next to active ends
    type(slave_segment_t), intent(out) :: own
    integer :: k

    own%number = s
    own%ends = contact%slave%segments(:, s)
    own%is_active = memory%slave_status%state(own%ends) == active
    own%margins = merge(least_part, 0.0_wp, own%is_active)
    own%start = memory%positions(:, own%ends(1))
    own%t = separation(memory%positions(:, own%ends(2)), own%start)
    own%square = max(own%t(1)**2 + own%t(2)**2, tiny(1.0_wp))
    do k = 1, 2
      own%below(k) = segment_below(contact, memory, own, k)
    end do
  end subroutine start_segment

  !> Master segment on which the k-th end of a slave segment has its projection: of an active end
  !> that of its status, else the closest of the candidates if it is over that; 0: none. Of two that
  !> meet where the projection is the outer one, so that their node lies between both ends.
  pure function segment_below(contact, memory, own, k) result(segment)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(slave_segment_t), intent(in) :: own
    integer, intent(in) :: k
    integer :: segment, outer
    real(wp) :: at

    if (own%is_active(k)) then
      segment = memory%slave_status%segment(own%ends(k))
      at = memory%slave_status%xi(own%ends(k))
    else
      call search_below(contact, memory, own%number, own%ends(k), segment, at)
    end if
    if (segment == 0) return
    outer = 0
    if (k == 1 .and. abs(at - 1.0_wp) <= near_node) outer = contact%master%next(segment)
    if (k == 2 .and. abs(at) <= near_node) outer = contact%master%previous(segment)
    if (outer > 0) segment = outer
  end function segment_below

  !> The same of an end that is not active, and where on the segment.
  pure subroutine search_below(contact, memory, s, node, segment, at)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, node
    integer, intent(out) :: segment
    real(wp), intent(out) :: at !! 0 to 1
    type(projection_t) :: projection
    integer :: beside

    at = 0.5_wp
    segment = closest_candidate(contact, memory, s, memory%positions(:, node), .true.)
    if (segment == 0) return
    associate (polyline => memory%positions(:, memory%n_slave + 1:), point => &
      memory%positions(:, node))
      projection = closest_projection(contact%master, polyline, point, segment)
      segment = merge(projection%segment, 0, projection%is_on)
      if (projection%is_on .and. abs(projection%xi - 0.5_wp) >= 0.5_wp) then
        ! At a vertex: below the end of the slave segment only if the master goes on gently there.
        beside = merge(contact%master%previous(segment), contact%master%next(segment), &
          projection%xi < 0.5_wp)
        if (beside > 0) then
          if (.not. turns_gently(vector_of(contact%master, polyline, segment), &
            vector_of(contact%master, polyline, beside))) segment = 0
        end if
      end if
      at = projection%xi
    end associate
  end subroutine search_below

  !> The candidate of a slave segment that is closest to a position on it; 0: none.
  pure function closest_candidate(contact, memory, s, point, is_opposed) result(closest)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    real(wp), intent(in) :: point(4)
    logical, intent(in) :: is_opposed !! only those that are opposed to the segment
    integer :: closest
    real(wp) :: own(2), square, least
    type(local_coordinates_t) :: local
    integer :: j, m

    closest = 0
    least = huge(1.0_wp)
    own = vector_of(contact%slave, memory%positions, s)
    do j = memory%candidates%first(s), memory%candidates%first(s + 1) - 1
      m = memory%candidates%items(j)
      local = local_coordinates(contact%master, memory%positions(:, memory%n_slave + 1:), point, m)
      square = closest_distance(local)
      if (square >= least) cycle
      if (is_opposed) then
        if (.not. looks_against(own, local%t)) cycle
      end if
      least = square
      closest = m
    end do
  end function closest_candidate

  !> Whether two segments are opposed: their vectors have the cosine of their normals.
  pure function looks_against(own, other) result(opposed)
    real(wp), intent(in) :: own(2), other(2) !! m
    logical :: opposed
    real(wp) :: product

    product = own(1)*other(1) + own(2)*other(2)
    opposed = product < 0.0_wp .and. product*product > side_on**2*((own(1)*own(1) &
      + own(2)*own(2))*(other(1)*other(1) + other(2)*other(2)))
  end function looks_against

  !> Whether a slave segment is opposed to the face that one of its ends is active on.
  pure function is_opposed_to_contact(memory, own) result(opposed)
    type(contact_state_t), intent(in) :: memory
    type(slave_segment_t), intent(in) :: own
    logical :: opposed
    integer :: k

    opposed = .false.
    do k = 1, 2
      if (.not. own%is_active(k)) cycle
      associate (normal => memory%slave_status%normal(:, own%ends(k)))
        opposed = opposed .or. own%t(2)*normal(1) - own%t(1)*normal(2) < side_on*sqrt(own%square)
      end associate
    end do
  end function is_opposed_to_contact

  !> How much of a slave segment counts opposite to a master segment, 0 to 1, where either may be
  !> the side next to a convex vertex of a closed boundary.
  pure function sides_part(contact, memory, s, m) result(part)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, m !! slave and master segment
    real(wp) :: part

    associate (master => memory%positions(:, memory%n_slave + 1:))
      part = side_part(contact%slave, memory%positions, s, vector_of(contact%master, master, m), &
        slave_side)
      if (part > 0.0_wp) part = part*side_part(contact%master, master, m, &
        vector_of(contact%slave, memory%positions, s), master_side)
    end associate
  end function sides_part

  !> How much of a segment counts, 0 to 1: less the more a segment next to it at a sharp convex
  !> vertex is opposed to the segment of the other surface than it is itself (see `side_share`).
  pure function side_part(surface, positions, segment, other, range) result(part)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, at least n_node) from this surface on
    integer, intent(in) :: segment
    real(wp), intent(in) :: other(2)                 !! segment of the other surface, m
    real(wp), intent(in) :: range(2)                 !! see `side_share`
    real(wp) :: part
    real(wp) :: own(2), beside(2), turn, squares(2)
    integer :: k, next

    part = 1.0_wp
    own = vector_of(surface, positions, segment)
    squares(1) = own(1)**2 + own(2)**2
    do k = 1, 2
      next = merge(surface%previous(segment), surface%next(segment), k == 1)
      if (next == 0) cycle
      beside = vector_of(surface, positions, next)
      if (merge(-1.0_wp, 1.0_wp, k == 1)*(own(1)*beside(2) - own(2)*beside(1)) <= 0.0_wp) cycle
      squares(2) = beside(1)**2 + beside(2)**2
      turn = (own(1)*beside(1) + own(2)*beside(2))/sqrt(squares(1)*squares(2))
      if (turn >= 1.0_wp - gentle_vertex) cycle
      part = part*side_share(turn, dot_product(own/sqrt(squares(1)) - beside/sqrt(squares(2)), &
        other)/sqrt(other(1)**2 + other(2)**2), range)
    end do
  end function side_part

end module slave_segments_m
