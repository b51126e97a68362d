! SPDX-License-Identifier: MIT
!> Gauss points of type 7 on pieces of slave segments, many at a time (doc/theory/contact.md,
!> section 3.5).
module contact_piece_list_m
  use contact_overlap_m, only : facing_share
  use contact_piece_points_m, only : plain_points_t, tell_foot
  use contact_pieces_m, only : slave_t, n_gauss, add_local
  use contact_placing_m, only : add_plain_point
  use contact_plain_cover_m, only : plain_cover_t, note_plain_contact
  use contact_state_m, only : contact_state_t, contact_points_t, make_room, n_side
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: look_at_segments, put_points, put_pieces

contains

  !> Smallest gaps of the segments on a list, and whether all of their pieces are plain. Most
  !> segments have besides both ends in contact: these stay, whatever their gaps, and are noted
  !> here. Judging each of them later took 3 % of the whole contact.
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
      associate (s => cover%slave(i))
        call note_plain_contact(deepest < memory%closed_gap, memory%travel, &
          memory%cover%status(s), memory%cover%wake(s))
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
      call put_odd(contact, memory, cover, found, k)
      first = k + 1
    end do
    call put_points(memory, cover, found, first, cover%last(i))
  end subroutine put_pieces

  !> Append the points of a piece that are not both on its master segment.
  pure subroutine put_odd(contact, memory, cover, found, k)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t), intent(in) :: cover
    type(plain_points_t), intent(in) :: found
    integer, intent(in) :: k
    type(slave_t) :: slave
    real(wp) :: foot, gap, normal(2), share
    logical :: is_told
    integer :: q

    slave = slave_of_piece(cover, k)
    do q = 1, n_gauss
      call tell_foot(cover, found, k, q, is_told, foot, gap, normal)
      if (is_told) then
        share = facing_share(dot_product(slave%normal, normal))
        if (.not. share > 0.0_wp) cycle
        call make_room(memory%points, 1)
        call add_plain_point(slave%ends, found%xi(q, k), cover%nodes(:, k), foot, normal, gap, &
          memory%points)
        memory%points%area(memory%points%n) = share*found%area(k)
        memory%points%stiffness(memory%points%n) = memory%slave_penalty
      else
        call add_local(contact, memory, slave, cover%master(k), found%xi(q, k), found%area(k))
      end if
    end do
  end subroutine put_odd

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
      if (points%n + n_gauss*n > points%n_former) &
        points%stiffness(p:points%n + n_gauss*n) = memory%slave_penalty
      points%n = points%n + n_gauss*n
    end associate
  end subroutine put_points

  !> Nodes and weights of the points on `n` pieces, written out for both: a loop over them takes
  !> twice as long.
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
