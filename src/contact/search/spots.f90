! SPDX-License-Identifier: MIT
!> Where the followed spots of the slave side are: at its nodes, or at fixed places of every
!> segment. Spots of segments move with the segment's nodes; spot number (segment - 1)*(spots per
!> segment) + position.
module spots_m
  use contact_state_m, only : contact_state_t
  use geometry_m, only : segment_length
  use kinds_m, only : wp
  use quadrature_m, only : gauss_rule
  use radii_m, only : centroid
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: spots_at_nodes, spots_at_quarters, spots_at_gauss_points, start_spots, move_spots

  !> Rules for the places of spots.
  integer, parameter :: spots_at_nodes = 0, spots_at_quarters = 1, spots_at_gauss_points = 2

contains

  !> Places on each segment and the part of its length that each stands for; nothing is allocated
  !> for spots at nodes, which are in `memory%places` already.
  pure subroutine start_spots(rule, n_gauss, is_round, has_ends, slave, memory)
    integer, intent(in) :: rule    !! one of the constants above
    integer, intent(in) :: n_gauss !! Gauss points of a segment
    logical, intent(in) :: is_round
    logical, intent(in) :: has_ends !! beside Gauss points both nodes of each segment
    type(surface_t), intent(in) :: slave
    type(contact_state_t), intent(inout) :: memory
    integer :: s, q, n

    select case (rule)
    case (spots_at_quarters); n = 2
    case (spots_at_gauss_points); n = n_gauss + merge(2, 0, has_ends)
    case default; return
    end select
    allocate (memory%spot_xi(n), memory%spot_share(n), memory%spots(4, n*slave%n_segment))
    select case (rule)
    case (spots_at_quarters)
      memory%spot_xi(:) = [0.25_wp, 0.75_wp]
      memory%spot_share = 0.5_wp
      if (is_round) memory%spot_spread = 0.5_wp
    case (spots_at_gauss_points)
      memory%spot_xi([1, n]) = [0.0_wp, 1.0_wp]
      memory%spot_share([1, n]) = 0.0_wp
      q = merge(1, 0, has_ends)
      call gauss_rule(memory%spot_xi(1 + q:n - q), memory%spot_share(1 + q:n - q))
    end select
    do s = 1, slave%n_segment
      associate (a => memory%places(:, slave%segments(1, s)), &
        b => memory%places(:, slave%segments(2, s)))
        do q = 1, n
          memory%spots(:, (s - 1)*n + q) = (1.0_wp - memory%spot_xi(q))*a + memory%spot_xi(q)*b
        end do
      end associate
    end do
    call move_spots(slave, memory%places, memory%spot_xi, memory%spot_spread, memory%spots)
  end subroutine start_spots

  !> Displacements of the spots from those of the nodes. Where they stand at centres by radius,
  !> these move on their segments: how far at most is added to `travel`.
  pure subroutine move_spots(slave, places, spot_xi, spot_spread, spots, travel)
    type(surface_t), intent(in) :: slave
    real(wp), intent(in), contiguous :: places(:, :)   !! (4, n_node) of the interface
    real(wp), intent(in), contiguous :: spot_xi(:)
    real(wp), intent(in) :: spot_spread
    real(wp), intent(inout), contiguous :: spots(:, :) !! (4, n_spot)
    real(wp), intent(inout), optional :: travel        !! m
    real(wp) :: slid

    if (spot_spread > 0.0_wp) then
      call lean_on_segments(slave, places, spot_xi, spot_spread, spots, slid)
      if (present(travel)) travel = travel + slid
    else
      call move_on_segments(slave%n_segment, slave%segments, size(spot_xi), spot_xi, places, &
        spots)
    end if
  end subroutine move_spots

  !> Put the spots at the centres by radius of their parts of the segments.
  pure subroutine lean_on_segments(slave, places, spot_xi, spot_spread, spots, slid)
    type(surface_t), intent(in) :: slave
    real(wp), intent(in), contiguous :: places(:, :), spot_xi(:)
    real(wp), intent(in) :: spot_spread
    real(wp), intent(inout), contiguous :: spots(:, :)
    real(wp), intent(out) :: slid !! the longest way of one on its segment, m
    real(wp) :: before(2), xi
    integer :: s, q, i

    slid = 0.0_wp
    do s = 1, slave%n_segment
      associate (a => places(:, slave%segments(1, s)), b => places(:, slave%segments(2, s)))
        do q = 1, size(spot_xi)
          i = (s - 1)*size(spot_xi) + q
          xi = centroid(a, b, spot_xi(q) - 0.5_wp*spot_spread, spot_xi(q) + 0.5_wp*spot_spread)
          before = spots(1:2, i)
          spots(:, i) = (1.0_wp - xi)*a + xi*b
          ! Of the reference, in which nodes rest; stretched as the segment is.
          slid = max(slid, norm2(spots(1:2, i) - before)*segment_length(a, b) &
            /max(norm2(b(1:2) - a(1:2)), tiny(1.0_wp)))
        end do
      end associate
    end do
  end subroutine lean_on_segments

  !> The same on arrays of known shape. Both components of a spot are formed together: vectors over
  !> the few spots of a segment take 2 to 4 % more of the contact of type 4.
  pure subroutine move_on_segments(n, segments, n_xi, xi, places, spots)
    integer, intent(in) :: n, segments(2, n), n_xi
    real(wp), intent(in) :: xi(n_xi), places(4, *)
    real(wp), intent(inout) :: spots(4, n_xi, n)
    real(wp), dimension(2) :: one, two
    real(wp) :: weights(n_xi)
    integer :: s, q

    weights = 1.0_wp - xi
    !GCC$ NOVECTOR
    do s = 1, n
      one = places(3:4, segments(1, s))
      two = places(3:4, segments(2, s))
      !GCC$ NOVECTOR
      !GCC$ UNROLL 1
      do q = 1, n_xi
        spots(3:4, q, s) = xi(q)*two + weights(q)*one
      end do
    end do
  end subroutine move_on_segments

end module spots_m
