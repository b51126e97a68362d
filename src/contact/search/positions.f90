! SPDX-License-Identifier: MIT
!> Positions of an interface in each step: of its nodes, with a bound on their relative motion; of
!> points at fixed positions of every slave segment, which move with the segment's nodes (point
!> number (segment - 1)*(points per segment) + position); and gaps below which points are contact
!> although they are not penetrated: touching bodies at the first tangent of an implicit step, and
!> what may touch before the step ahead ends (doc/theory/contact.md, sections 6.6 and 9.6).
module positions_m
  use candidates_m, only : mean_length
  use contact_state_m, only : contact_state_t
  use search_state_m, only : segment_points_t
  use contacts_m, only : contact_t
  use geometry_m, only : segment_length
  use kinds_m, only : wp
  use quadrature_m, only : gauss_rule
  use surfaces_m, only : surface_t
  use tributary_lengths_m, only : centroid
  implicit none
  private
  public :: gather_positions, points_at_nodes, points_at_quarters, points_at_gauss_points, &
    start_segment_points, move_segment_points, closed_gap_of, gap_ahead

  !> Rules for the positions of points.
  integer, parameter :: points_at_nodes = 0, points_at_quarters = 1, points_at_gauss_points = 2
  !> Gaps smaller than this part of the mean slave segment are closed.
  real(wp), parameter :: closed_part = 1.0e-8_wp
  !> Largest gap that counts for the step ahead, as a part of the mean slave segment: a node moves
  !> by less in a stable step.
  real(wp), parameter :: most_ahead = 0.5_wp
  !> Least: a strain of that much in one step.
  real(wp), parameter :: least_ahead = 0.02_wp
  !> Times what nodes have moved in the last step is added to that.
  real(wp), parameter :: ahead_factor = 2.0_wp

contains

  !> Copy the present displacements into the memory, and what each node has moved, and let its
  !> travel grow by a bound on how far any two nodes have moved relative to each other since the
  !> last call.
  pure subroutine gather_positions(motion, memory)
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory

    call gather(size(memory%nodes), memory%nodes, motion, memory%positions, &
      memory%scratch%increment, memory%advance)
    memory%travel = memory%travel + memory%advance
    ! That of a pause is not that of a step.
    if (memory%is_stale) memory%advance = 0.0_wp
  end subroutine gather_positions

  !> Copy u of all nodes; what it has changed by, and the diagonal of the box of these changes: it
  !> bounds the relative motion.
  pure subroutine gather(n, nodes, motion, positions, changes, diagonal)
    integer, intent(in) :: n, nodes(n)
    real(wp), intent(in) :: motion(4, *)
    real(wp), intent(inout) :: positions(4, n), changes(2, n) !! m
    real(wp), intent(out) :: diagonal !! m
    real(wp), dimension(2) :: low, high, change
    integer :: i

    low = huge(1.0_wp)
    high = -huge(1.0_wp)
    !GCC$ NOVECTOR
    do i = 1, n
      change = motion(1:2, nodes(i)) - positions(3:4, i)
      positions(3:4, i) = motion(1:2, nodes(i))
      changes(:, i) = change
      low = merge(change, low, change < low)
      high = merge(change, high, change > high)
    end do
    diagonal = sqrt((high(1) - low(1))**2 + (high(2) - low(2))**2)
  end subroutine gather

  !> Positions on each segment and the part of its length that each stands for; nothing is allocated
  !> for points at nodes.
  pure subroutine start_segment_points(rule, n_gauss, is_axisymmetric, has_ends, slave, positions, &
      points)
    integer, intent(in) :: rule    !! one of the constants above
    integer, intent(in) :: n_gauss !! Gauss points of a segment
    logical, intent(in) :: is_axisymmetric
    logical, intent(in) :: has_ends !! beside Gauss points both nodes of each segment
    type(surface_t), intent(in) :: slave
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    type(segment_points_t), intent(inout) :: points
    integer :: s, q, n

    select case (rule)
    case (points_at_quarters); n = 2
    case (points_at_gauss_points); n = n_gauss + merge(2, 0, has_ends)
    case default; return
    end select
    allocate (points%xi(n), points%share(n), points%positions(4, n*slave%n_segment))
    select case (rule)
    case (points_at_quarters)
      points%xi(:) = [0.25_wp, 0.75_wp]
      points%share = 0.5_wp
      if (is_axisymmetric) points%spread = 0.5_wp
    case (points_at_gauss_points)
      points%xi([1, n]) = [0.0_wp, 1.0_wp]
      points%share([1, n]) = 0.0_wp
      q = merge(1, 0, has_ends)
      call gauss_rule(points%xi(1 + q:n - q), points%share(1 + q:n - q))
    end select
    do s = 1, slave%n_segment
      associate (a => positions(:, slave%segments(1, s)), b => positions(:, slave%segments(2, s)))
        do q = 1, n
          points%positions(:, (s - 1)*n + q) = (1.0_wp - points%xi(q))*a + points%xi(q)*b
        end do
      end associate
    end do
    call move_segment_points(slave, positions, points)
  end subroutine start_segment_points

  !> Displacements of the points from those of the nodes. Where they stand at centres by radius,
  !> these move on their segments: how far at most is added to `travel`.
  pure subroutine move_segment_points(slave, positions, points, travel)
    type(surface_t), intent(in) :: slave
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    type(segment_points_t), intent(inout) :: points
    real(wp), intent(inout), optional :: travel         !! m
    real(wp) :: slid

    if (points%spread > 0.0_wp) then
      call move_by_radius(slave, positions, points, slid)
      if (present(travel)) travel = travel + slid
    else
      call move_on_segments(slave%n_segment, slave%segments, size(points%xi), points%xi, &
        positions, points%positions)
    end if
  end subroutine move_segment_points

  !> Put the points at the centres by radius of their parts of the segments.
  pure subroutine move_by_radius(slave, positions, points, slid)
    type(surface_t), intent(in) :: slave
    real(wp), intent(in), contiguous :: positions(:, :)
    type(segment_points_t), intent(inout) :: points
    real(wp), intent(out) :: slid !! the longest way of one on its segment, m
    real(wp) :: before(2), xi
    integer :: s, q

    slid = 0.0_wp
    do s = 1, slave%n_segment
      associate (a => positions(:, slave%segments(1, s)), b => positions(:, slave%segments(2, s)))
        do q = 1, size(points%xi)
          xi = centroid(a, b, points%xi(q) - 0.5_wp*points%spread, points%xi(q) &
            + 0.5_wp*points%spread)
          associate (position => points%positions(:, (s - 1)*size(points%xi) + q))
            before = position(1:2)
            position = (1.0_wp - xi)*a + xi*b
            ! Of the reference, in which nodes rest; stretched as the segment is.
            slid = max(slid, norm2(position(1:2) - before)*segment_length(a, b) &
              /max(norm2(b(1:2) - a(1:2)), tiny(1.0_wp)))
          end associate
        end do
      end associate
    end do
  end subroutine move_by_radius

  !> Move points on segments, on arrays of known shape. Both components of a point are formed
  !> together: vectors over the few points of a segment take 2 to 4 % more of the contact of type 4.
  pure subroutine move_on_segments(n, segments, n_xi, xi, positions, segment_points)
    integer, intent(in) :: n, segments(2, n), n_xi
    real(wp), intent(in) :: xi(n_xi), positions(4, *)
    real(wp), intent(inout) :: segment_points(4, n_xi, n)
    real(wp), dimension(2) :: one, two
    integer :: s, q

    !GCC$ NOVECTOR
    do s = 1, n
      one = positions(3:4, segments(1, s))
      two = positions(3:4, segments(2, s))
      !GCC$ NOVECTOR
      !GCC$ UNROLL 1
      do q = 1, n_xi
        segment_points(3:4, q, s) = xi(q)*two + (1.0_wp - xi(q))*one
      end do
    end do
  end subroutine move_on_segments

  !> The gap of an interface below which bodies touch, m.
  pure function closed_gap_of(contact, memory) result(gap)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp) :: gap

    gap = closed_part*mean_length(contact%slave, memory%positions(:, :memory%n_slave))
  end function closed_gap_of

  !> The gap that may close in the step ahead, m.
  pure function gap_ahead(contact, is_first, memory) result(gap)
    type(contact_t), intent(in) :: contact
    logical, intent(in) :: is_first !! nothing is known of a step before
    type(contact_state_t), intent(in) :: memory
    real(wp) :: gap, segment

    segment = mean_length(contact%slave, memory%positions(:, :memory%n_slave))
    gap = most_ahead*segment
    if (.not. is_first) gap = min(gap, least_ahead*segment + ahead_factor*memory%advance)
  end function gap_ahead

end module positions_m
