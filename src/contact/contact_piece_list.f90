! SPDX-License-Identifier: MIT
!> Gauss points of type 7 on pieces of slave segments, many at a time (doc/theory/contact.md, section 3.5).
module contact_piece_list_m
  use contact_pieces_m, only : slave_t, n_gauss, gauss_xi, add_piece
  use contact_plain_cover_m, only : plain_cover_t, n_room
  use contact_plain_foot_m, only : well_inside
  use contact_state_m, only : contact_state_t, contact_points_t, make_room, n_side, is_free, is_touching
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: plain_points_t, find_points, look_over, look_at_segments, put_points, put_pieces

  !> Gauss points of the pieces on a list. Without default values, which would be written before each use.
  type :: plain_points_t
    real(wp) :: xi(n_gauss, n_room)        !! place on the slave segment
    real(wp) :: foot(n_gauss, n_room)      !! place on the master segment
    real(wp) :: gap(n_gauss, n_room)       !! m
    real(wp) :: normal(2, n_room)          !! of the master
    real(wp) :: area(n_room)               !! of each, m
    real(wp) :: depth(n_room)              !! more than 0 (only its sign counts) where both are behind the master segment
                                           !! and nearer to it than to its ends, or over it and no neighbour of it
    real(wp) :: deepest(n_room)            !! smallest gap of each segment, m
    logical :: is_plain(n_room)            !! all points of the segment are on the master segments of their pieces
    logical :: stays(n_room)               !! besides, both ends of it are in contact
  end type plain_points_t

contains

  !> Gauss points of pieces. On a piece the foot and the gap are linear along the slave segment.
  pure subroutine find_points(n, own, other, way, low, high, length, found)
    integer, intent(in) :: n
    real(wp), dimension(2, n_room), intent(in) :: own, other, way
    real(wp), dimension(n_room), intent(in) :: low, high, length
    type(plain_points_t), intent(inout) :: found
    real(wp) :: square, inverse, along, across, slope, turn, xi, x, y
    integer :: k, q

    !$omp simd private(square, inverse, along, across, slope, turn, xi, x, y, q)
    do k = 1, n
      square = max(other(1, k)*other(1, k) + other(2, k)*other(2, k), tiny(1.0_wp))
      slope = own(1, k)*other(1, k) + own(2, k)*other(2, k)
      turn = own(1, k)*other(2, k) - own(2, k)*other(1, k)
      along = way(1, k)*other(1, k) + way(2, k)*other(2, k)
      across = way(1, k)*other(2, k) - way(2, k)*other(1, k)
      inverse = 1.0_wp/sqrt(square)
      found%depth(k) = huge(1.0_wp)
      do q = 1, n_gauss
        xi = low(k) + gauss_xi(q)*(high(k) - low(k))
        x = along + xi*slope
        y = across + xi*turn
        found%depth(k) = min(found%depth(k), -y, y + x, y + (square - x))
        found%xi(q, k) = xi
        found%foot(q, k) = x*(inverse*inverse)
        found%gap(q, k) = y*inverse
      end do
      found%normal(1, k) = other(2, k)*inverse
      found%normal(2, k) = -other(1, k)*inverse
      found%area(k) = 0.5_wp*(high(k) - low(k))*length(k)
    end do
  end subroutine find_points

  !> Tell the pieces apart whose Gauss points may not be on their master segment. A point that is nearer to a neighbour of
  !> that has its foot there (as contact_projection has it).
  pure subroutine look_over(contact, memory, cover, found)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(plain_cover_t), intent(in) :: cover
    type(plain_points_t), intent(inout) :: found
    real(wp), dimension(2, n_room) :: before, after

    if (minval(found%depth(:cover%n_piece)) > 0.0_wp) return
    call see_neighbours(cover%n_piece, cover%master, cover%nodes, contact%master%segments, &
      contact%master%previous, contact%master%next, memory%n_slave, memory%places, before, after)
    call raise_depths(cover%n_piece, cover%own, cover%other, cover%way, before, after, found%xi, &
      found%foot, found%depth)
  end subroutine look_over

  !> Vectors of the neighbours of the pieces' master segments, both towards these. Where one is missing the chain may as
  !> well go straight on.
  pure subroutine see_neighbours(n, master, nodes, segments, previous, next, n_slave, places, before, after)
    integer, intent(in) :: n, master(*), nodes(2, *), segments(2, *), previous(*), next(*)
    integer, intent(in) :: n_slave !! local number before the first master node
    real(wp), intent(in) :: places(4, *)
    real(wp), dimension(2, n_room), intent(inout) :: before, after
    real(wp) :: t(4)
    integer :: k, a, b

    !GCC$ NOVECTOR
    do k = 1, n
      a = previous(master(k))
      b = next(master(k))
      if (a > 0) then
        t = places(:, nodes(1, k)) - places(:, n_slave + segments(1, a))
      else
        t = places(:, nodes(2, k)) - places(:, nodes(1, k))
      end if
      before(:, k) = t(1:2) + t(3:4)
      if (b > 0) then
        t = places(:, nodes(2, k)) - places(:, n_slave + segments(2, b))
      else
        t = places(:, nodes(1, k)) - places(:, nodes(2, k))
      end if
      after(:, k) = t(1:2) + t(3:4)
    end do
  end subroutine see_neighbours

  !> Make the depth of pieces positive whose Gauss points are surely over their master segments.
  pure subroutine raise_depths(n, own, other, way, before, after, xi, foot, depth)
    integer, intent(in) :: n
    real(wp), dimension(2, n_room), intent(in) :: own, other, way, before, after
    real(wp), dimension(n_gauss, n_room), intent(in) :: xi, foot
    real(wp), intent(inout) :: depth(n_room)
    real(wp) :: squares, slope, past(2), inside
    integer :: k

    !$omp simd private(squares, slope, past, inside)
    do k = 1, n
      squares = way(1, k)*way(1, k) + way(2, k)*way(2, k) + own(1, k)*own(1, k) + own(2, k)*own(2, k) &
        + other(1, k)*other(1, k) + other(2, k)*other(2, k)
      slope = own(1, k)*before(1, k) + own(2, k)*before(2, k)
      past(1) = way(1, k)*before(1, k) + way(2, k)*before(2, k) + min(xi(1, k)*slope, xi(2, k)*slope) &
        - well_inside*(squares + before(1, k)*before(1, k) + before(2, k)*before(2, k))
      slope = own(1, k)*after(1, k) + own(2, k)*after(2, k)
      past(2) = (way(1, k) - other(1, k))*after(1, k) + (way(2, k) - other(2, k))*after(2, k) &
        + min(xi(1, k)*slope, xi(2, k)*slope) &
        - well_inside*(squares + after(1, k)*after(1, k) + after(2, k)*after(2, k))
      inside = min(foot(1, k), foot(2, k), 1.0_wp - foot(1, k), 1.0_wp - foot(2, k)) - 2.0_wp*well_inside
      depth(k) = max(depth(k), min(past(1), past(2), inside))
    end do
  end subroutine raise_depths

  !> Smallest gaps of the segments on a list, and whether all of their pieces are plain. Most segments have besides both ends
  !> in contact: these stay, whatever their gaps, and are noted here (as `note_plain_contact` has it). Judging each of them in
  !> a call of its own took 3 % of the whole contact.
  pure subroutine look_at_segments(cover, memory, found)
    type(plain_cover_t), intent(in) :: cover
    type(contact_state_t), intent(inout) :: memory
    type(plain_points_t), intent(inout) :: found
    real(wp) :: deepest, least
    integer :: i, k

    do i = 1, cover%n_segment
      deepest = huge(1.0_wp)
      least = huge(1.0_wp)
      do k = cover%last(i - 1) + 1, cover%last(i)
        deepest = min(deepest, found%gap(1, k), found%gap(2, k))
        least = min(least, found%depth(k))
      end do
      found%deepest(i) = deepest
      found%is_plain(i) = cover%is_plain(i) .and. least > 0.0_wp
      found%stays(i) = found%is_plain(i) .and. cover%touches(i)
      if (.not. found%stays(i)) cycle
      associate (s => cover%slave(i), is_deep => deepest < memory%closed_gap)
        memory%cover%status(s) = merge(is_touching, is_free, is_deep)
        memory%cover%wake(s) = merge(-huge(1.0_wp), memory%travel, is_deep)
      end associate
    end do
  end subroutine look_at_segments

  !> Append the points of a segment some of which are not on the master segment of their piece.
  pure subroutine put_pieces(contact, memory, cover, found, i)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t), intent(in) :: cover
    type(plain_points_t), intent(in) :: found
    integer, intent(in) :: i !! of the list
    integer :: k, first

    first = cover%last(i - 1) + 1
    do k = first, cover%last(i)
      if (found%depth(k) > 0.0_wp) cycle
      call put_points(memory, cover, found, first, k - 1)
      call add_piece(contact, memory, slave_of_piece(cover, k), cover%master(k), cover%low(k), &
        cover%high(k))
      first = k + 1
    end do
    call put_points(memory, cover, found, first, cover%last(i))
  end subroutine put_pieces

  !> The slave segment of a piece.
  pure function slave_of_piece(cover, k) result(slave)
    type(plain_cover_t), intent(in) :: cover
    integer, intent(in) :: k
    type(slave_t) :: slave

    slave%ends = cover%ends(:, k)
    slave%normal(1) = cover%own(2, k)*cover%inverse(k)
    slave%normal(2) = -cover%own(1, k)*cover%inverse(k)
    slave%length = cover%length(k)
  end function slave_of_piece

  !> Append the points of the pieces from one to another.
  pure subroutine put_points(memory, cover, found, first, last)
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t), intent(in) :: cover
    type(plain_points_t), intent(in) :: found
    integer, intent(in) :: first, last
    integer :: n

    n = last - first + 1
    if (n == 0) return
    call make_room(memory%points, n_gauss*n)
    associate (points => memory%points, p => memory%points%n + 1)
      call put_sides(n, cover%ends(1, first), cover%nodes(1, first), found%xi(1, first), &
        found%foot(1, first), points%slave_nodes(1, p), points%slave_weights(1, p), &
        points%master_nodes(1, p), points%master_weights(1, p))
      call put_springs(n, found%gap(1, first), found%normal(1, first), found%area(first), &
        points%gap(p), points%normal(1, p), points%area(p))
      if (.not. has_stiffness(points, n_gauss*n, memory%slave_penalty)) &
        points%stiffness(p:points%n + n_gauss*n) = memory%slave_penalty
      points%n = points%n + n_gauss*n
    end associate
  end subroutine put_points

  !> Whether the stiffness of the next `n` points stands from the last placement. All points have the same.
  pure function has_stiffness(points, n, stiffness)
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: n
    real(wp), intent(in) :: stiffness
    logical :: has_stiffness

    has_stiffness = points%n + n <= points%n_former
    if (has_stiffness) has_stiffness = .not. abs(points%stiffness(points%n + 1) - stiffness) > 0.0_wp
  end function has_stiffness

  !> Nodes and weights of the points on `n` pieces, written out for both: a loop over them takes twice as long.
  pure subroutine put_sides(n, ends, nodes, xi, foot, slave_nodes, slave_weights, master_nodes, &
      master_weights)
    integer, intent(in) :: n, ends(2, n), nodes(2, n)  !! of the slave and of the master segments
    real(wp), dimension(n_gauss, n), intent(in) :: xi, foot !! places on them, 0 to 1
    integer, dimension(n_side, n_gauss, n), intent(inout) :: slave_nodes, master_nodes
    real(wp), dimension(n_side, n_gauss, n), intent(inout) :: slave_weights, master_weights
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      slave_nodes(:, 1, k) = ends(:, k)
      slave_nodes(:, 2, k) = ends(:, k)
      master_nodes(:, 1, k) = nodes(:, k)
      master_nodes(:, 2, k) = nodes(:, k)
      slave_weights(1, 1, k) = 1.0_wp - xi(1, k)
      slave_weights(2, 1, k) = xi(1, k)
      slave_weights(1, 2, k) = 1.0_wp - xi(2, k)
      slave_weights(2, 2, k) = xi(2, k)
      master_weights(1, 1, k) = 1.0_wp - foot(1, k)
      master_weights(2, 1, k) = foot(1, k)
      master_weights(1, 2, k) = 1.0_wp - foot(2, k)
      master_weights(2, 2, k) = foot(2, k)
    end do
  end subroutine put_sides

  !> Their gaps, normals and areas.
  pure subroutine put_springs(n, gap, normal, area, gaps, normals, areas)
    integer, intent(in) :: n
    real(wp), intent(in) :: gap(n_gauss, n), normal(2, n), area(n)
    real(wp), dimension(n_gauss, n), intent(inout) :: gaps, areas
    real(wp), intent(inout) :: normals(2, n_gauss, n)
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      gaps(:, k) = gap(:, k)
      normals(:, 1, k) = normal(:, k)
      normals(:, 2, k) = normal(:, k)
      areas(:, k) = area(k)
    end do
  end subroutine put_springs

end module contact_piece_list_m
