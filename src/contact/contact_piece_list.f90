! SPDX-License-Identifier: MIT
!> Gauss points of type 7 on pieces of slave segments, many at a time (doc/theory/contact.md, section 3.5).
module contact_piece_list_m
  use contact_pieces_m, only : n_gauss, gauss_xi
  use contact_placing_m, only : place_on_segment
  use contact_plain_cover_m, only : plain_cover_t, n_room
  use contact_plain_foot_m, only : is_plainly_behind, is_plainly_over, well_inside
  use contact_state_m, only : contact_state_t, n_side
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, sight_of_segment, separation
  use kinds_m, only : wp
  implicit none
  private
  public :: plain_points_t, find_points, look_over, is_plain, put_points

  !> One by one is faster where no more than one piece in so many has to be looked at.
  integer, parameter :: n_seldom = 4

  !> Gauss points of the pieces on a list. Without default values, which would be written before each use.
  type :: plain_points_t
    real(wp) :: xi(n_gauss, n_room)        !! place on the slave segment
    real(wp) :: foot(n_gauss, n_room)      !! place on the master segment
    real(wp) :: gap(n_gauss, n_room)       !! m
    real(wp) :: normal(2, n_room)          !! of the master
    real(wp) :: area(n_room)               !! of each, m
    real(wp) :: depth(n_room)              !! more than 0 where both are behind the master segment and nearer to it than
                                           !! to its ends, or over it and no neighbour of it
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

  !> What `is_surely_over` tells, for all pieces of a list at a time, where many of them need it.
  pure subroutine look_over(contact, memory, cover, found)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(plain_cover_t), intent(in) :: cover
    type(plain_points_t), intent(inout) :: found
    real(wp), dimension(2, n_room) :: before, after

    if (n_seldom*count(.not. found%depth(:cover%n_piece) > 0.0_wp) <= cover%n_piece) return
    call see_neighbours(cover%n_piece, cover%master, cover%nodes, contact%master%segments, &
      contact%master%previous, contact%master%next, memory%n_slave, memory%places, before, after)
    call raise_depths(cover%n_piece, cover%own, cover%other, cover%way, before, after, found%xi, &
      found%foot, found%depth)
  end subroutine look_over

  !> Vectors of the neighbours of the pieces' master segments, both towards these; zero where one is missing.
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
      if (a == 0 .or. b == 0) then
        before(:, k) = 0.0_wp
        after(:, k) = 0.0_wp
        cycle
      end if
      t = places(:, nodes(1, k)) - places(:, n_slave + segments(1, a))
      before(:, k) = t(1:2) + t(3:4)
      t = places(:, nodes(2, k)) - places(:, n_slave + segments(2, b))
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

  !> Whether all points of a listed segment are where the list has them: on the master segment of their piece. A
  !> Gauss point that is nearer to a neighbour of that has its foot there (as contact_projection has it).
  pure function is_plain(contact, memory, cover, found, i)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(plain_cover_t), intent(in) :: cover
    type(plain_points_t), intent(in) :: found
    integer, intent(in) :: i !! of the list
    logical :: is_plain
    type(sight_t) :: sight
    integer :: k, q

    is_plain = cover%is_plain(i)
    do k = cover%last(i - 1) + 1, cover%last(i)
      if (.not. is_plain) return
      if (found%depth(k) > 0.0_wp) cycle
      if (is_surely_over(contact, memory, cover, found, k)) cycle
      associate (chain => memory%places(:, memory%n_slave + 1:), ends => contact%master%segments(:, cover%master(k)))
        do q = 1, n_gauss
          sight = sight_of_segment(place_on_segment(memory%places, cover%ends(:, k), found%xi(q, k)), &
            chain(:, ends(1)), chain(:, ends(2)))
          if (is_plainly_behind(sight)) cycle
          is_plain = is_plain .and. is_plainly_over(contact%master, chain, sight, cover%master(k))
        end do
      end associate
    end do
  end function is_plain

  !> Whether the Gauss points of a piece are over its master segment and no neighbour of it, and so far from being nearer to
  !> another that round-off has no part in it.
  pure function is_surely_over(contact, memory, cover, found, k)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(plain_cover_t), intent(in) :: cover
    type(plain_points_t), intent(in) :: found
    integer, intent(in) :: k !! of the list
    logical :: is_surely_over
    real(wp) :: low, high, margin, t(2)

    low = minval(found%foot(:, k))
    high = maxval(found%foot(:, k))
    is_surely_over = low > 2.0_wp*well_inside .and. high < 1.0_wp - 2.0_wp*well_inside
    if (.not. is_surely_over) return
    associate (master => contact%master, segment => cover%master(k), way => cover%way(:, k), &
      own => cover%own(:, k), other => cover%other(:, k), places => memory%places(:, memory%n_slave + 1:))
      margin = well_inside*(sum(way**2) + sum(own**2) + sum(other**2))
      if (master%previous(segment) > 0) then
        t = separation(places(:, master%segments(1, segment)), &
          places(:, master%segments(1, master%previous(segment))))
        is_surely_over = least_product(way, own, found%xi(:, k), t) > margin + well_inside*sum(t**2)
      end if
      if (.not. is_surely_over .or. master%next(segment) == 0) return
      t = separation(places(:, master%segments(2, segment)), &
        places(:, master%segments(2, master%next(segment))))
      is_surely_over = least_product(way - other, own, found%xi(:, k), t) > margin + well_inside*sum(t**2)
    end associate
  end function is_surely_over

  !> Least product of the ways to the Gauss points with a vector.
  pure function least_product(way, own, xi, t) result(product)
    real(wp), intent(in) :: way(2), own(2) !! to the first end of the slave segment, and along it, m
    real(wp), intent(in) :: xi(n_gauss)
    real(wp), intent(in) :: t(2)
    real(wp) :: product

    product = dot_product(way, t) + minval(xi*dot_product(own, t))
  end function least_product

  !> Append the points of the pieces from one to another.
  pure subroutine put_points(memory, cover, found, first, last)
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t), intent(in) :: cover
    type(plain_points_t), intent(in) :: found
    integer, intent(in) :: first, last
    integer :: n

    n = last - first + 1
    if (n == 0) return
    associate (points => memory%points, p => memory%points%n + 1)
      call put_sides(n, cover%ends(1, first), cover%nodes(1, first), found%xi(1, first), &
        found%foot(1, first), points%slave_nodes(1, p), points%slave_weights(1, p), &
        points%master_nodes(1, p), points%master_weights(1, p))
      call put_springs(n, found%gap(1, first), found%normal(1, first), found%area(first), &
        memory%slave_penalty, points%gap(p), points%normal(1, p), points%area(p), points%stiffness(p))
      points%n = points%n + n_gauss*n
    end associate
  end subroutine put_points

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

  !> Their gaps, normals, areas and stiffness.
  pure subroutine put_springs(n, gap, normal, area, stiffness, gaps, normals, areas, stiffnesses)
    integer, intent(in) :: n
    real(wp), intent(in) :: gap(n_gauss, n), normal(2, n), area(n), stiffness
    real(wp), dimension(n_gauss, n), intent(inout) :: gaps, areas, stiffnesses
    real(wp), intent(inout) :: normals(2, n_gauss, n)
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      gaps(:, k) = gap(:, k)
      normals(:, 1, k) = normal(:, k)
      normals(:, 2, k) = normal(:, k)
      areas(:, k) = area(k)
      stiffnesses(:, k) = stiffness
    end do
  end subroutine put_springs

end module contact_piece_list_m
