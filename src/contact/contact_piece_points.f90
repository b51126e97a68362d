! SPDX-License-Identifier: MIT
!> Where the Gauss points of type 7 stand, many pieces at a time, and which of them are surely there
!> (doc/theory/contact.md, section 3.5).
module contact_piece_points_m
  use contact_pieces_m, only : n_gauss, gauss_xi
  use contact_plain_cover_m, only : plain_cover_t, n_room
  use contact_plain_foot_m, only : well_inside
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: plain_points_t, find_points, look_over, tell_foot

  !> Gauss points of the pieces on a list. Without default values, which would be written before
  !> each use.
  type :: plain_points_t
    real(wp) :: xi(n_gauss, n_room)        !! place on the slave segment
    real(wp) :: foot(n_gauss, n_room)      !! place on the master segment
    real(wp) :: gap(n_gauss, n_room)       !! m
    real(wp) :: normal(2, n_room)          !! of the master
    real(wp) :: area(n_room)               !! of each, m
    real(wp) :: depth(n_room)              !! more than 0 (only its sign counts) where both are
                                           !! behind the master segment and nearer to it than to its
                                           !! ends, or over it and no neighbour of it
    real(wp) :: deepest(n_room)            !! smallest gap of each segment, m
    real(wp) :: before(2, n_room)          !! vectors of the neighbours of the master segments, both
                                           !! towards these, m;
    real(wp) :: after(2, n_room)           !! only where one of the list is not deep
    logical :: is_plain(n_room)            !! all points of the segment are on the master segments
                                           !! of their pieces
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

  !> Tell the pieces apart whose Gauss points may not be on their master segment. A point that is
  !> nearer to a neighbour of that has its foot there (as contact_projection has it).
  pure subroutine look_over(contact, memory, cover, found)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(plain_cover_t), intent(in) :: cover
    type(plain_points_t), intent(inout) :: found

    if (minval(found%depth(:cover%n_piece)) > 0.0_wp) return
    call see_neighbours(cover%n_piece, cover%master, cover%nodes, contact%master%segments, &
      contact%master%previous, contact%master%next, memory%n_slave, memory%places, found%before, &
      found%after)
    call raise_depths(cover%n_piece, cover%own, cover%other, cover%way, found%before, found%after, &
      found%xi, found%foot, found%depth)
  end subroutine look_over

  !> Vectors of the neighbours of the pieces' master segments, both towards these. Where one is
  !> missing the chain may as well go straight on.
  pure subroutine see_neighbours(n, master, nodes, segments, previous, next, n_slave, places, &
      before, after)
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
      squares = way(1, k)*way(1, k) + way(2, k)*way(2, k) + own(1, k)*own(1, k) &
        + own(2, k)*own(2, k) + other(1, k)*other(1, k) + other(2, k)*other(2, k)
      slope = own(1, k)*before(1, k) + own(2, k)*before(2, k)
      past(1) = way(1, k)*before(1, k) + way(2, k)*before(2, k) &
        + min(xi(1, k)*slope, xi(2, k)*slope) - well_inside*(squares + before(1, k)*before(1, k) &
        + before(2, k)*before(2, k))
      slope = own(1, k)*after(1, k) + own(2, k)*after(2, k)
      past(2) = (way(1, k) - other(1, k))*after(1, k) + (way(2, k) - other(2, k))*after(2, k) &
        + min(xi(1, k)*slope, xi(2, k)*slope) &
        - well_inside*(squares + after(1, k)*after(1, k) + after(2, k)*after(2, k))
      inside = min(foot(1, k), foot(2, k), 1.0_wp - foot(1, k), 1.0_wp - foot(2, k)) &
        - 2.0_wp*well_inside
      depth(k) = max(depth(k), min(past(1), past(2), inside))
    end do
  end subroutine raise_depths

  !> Foot of a point that is surely over its master segment and no neighbour, or surely behind the
  !> node between both and over neither. In a valley most odd points are of the latter kind.
  pure subroutine tell_foot(cover, found, k, q, is_told, foot, gap, normal)
    type(plain_cover_t), intent(in) :: cover
    type(plain_points_t), intent(in) :: found
    integer, intent(in) :: k, q
    logical, intent(out) :: is_told
    real(wp), intent(out) :: foot, gap, normal(2)
    real(wp) :: d(2), from_second(2), rounding, past(2)

    associate (own => cover%own(:, k), other => cover%other(:, k), before => found%before(:, k), &
      after => found%after(:, k))
      d = cover%way(:, k) + found%xi(q, k)*own
      from_second = d - other
      rounding = well_inside*(dot_product(d, d) + dot_product(own, own) &
        + dot_product(other, other) + dot_product(before, before) + dot_product(after, after))
      past = [dot_product(d, before), dot_product(from_second, after)] - rounding
      foot = found%foot(q, k)
      gap = found%gap(q, k)
      normal = found%normal(:, k)
      is_told = min(foot, 1.0_wp - foot) > 2.0_wp*well_inside .and. minval(past) > 0.0_wp
      if (is_told) return
      if (foot < -2.0_wp*well_inside .and. past(1) > 0.0_wp) then
        is_told = max(across(d, other), across(d, before)) < 0.0_wp
        foot = 0.0_wp
      else if (foot > 1.0_wp + 2.0_wp*well_inside .and. past(2) > 0.0_wp) then
        d = from_second
        is_told = max(across(d, other), -across(d, after)) < 0.0_wp
        foot = 1.0_wp
      end if
    end associate
    gap = -sqrt(max(dot_product(d, d), tiny(1.0_wp)))
    normal = d/gap

  contains

    !> Gap over a segment times the length of that.
    pure function across(d, t)
      real(wp), intent(in) :: d(2), t(2)
      real(wp) :: across

      across = d(1)*t(2) - d(2)*t(1)
    end function across

  end subroutine tell_foot

end module contact_piece_points_m
