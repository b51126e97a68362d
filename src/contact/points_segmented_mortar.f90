! SPDX-License-Identifier: MIT
!> Type 7, segmented mortar: two Gauss points on each piece of slave segment that faces one master
!> segment, pressure from the slave nodes (doc/theory/contact.md, section 5.7).
module points_segmented_mortar_m
  use contact_admission_m, only : all_asleep, is_asleep, judge_segment, note_next_wake
  use contact_overlap_m, only : cover_t, piece_t, find_cover, first_piece, next_piece, &
    local_foot, facing_share
  use contact_plain_cover_m, only : plain_cover_t, n_room, clear_list, list_touching, list_segment, &
    list_other, cut_segments, note_plain_contact
  use contact_placing_m, only : add_segment_point, place_on_segment
  use contact_plain_foot_m, only : is_plainly_behind, is_plainly_over, well_inside
  use contact_projection_m, only : foot_t
  use contact_state_m, only : contact_state_t, make_room, n_side, is_touching
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, sight_of_segment, sight_normal, separation
  use kinds_m, only : wp
  implicit none
  private
  public :: place_segmented_mortar, gauss_xi

  !> Gauss points of a piece.
  integer, parameter :: n_gauss = 2
  !> Where they are on 0 .. 1; both have weight one half. They integrate the product of shape
  !> functions and a linear gap exactly up to the curvature of the chain.
  real(wp), parameter :: gauss_xi(n_gauss) = [0.5_wp - sqrt(1.0_wp/12.0_wp), &
    0.5_wp + sqrt(1.0_wp/12.0_wp)]

  !> Gauss points of the pieces on a list. Without default values, which would be written before each use.
  type :: plain_points_t
    real(wp) :: xi(n_gauss, n_room)        !! place on the slave segment
    real(wp) :: foot(n_gauss, n_room)      !! place on the master segment
    real(wp) :: gap(n_gauss, n_room)       !! m
    real(wp) :: normal(2, n_room)          !! of the master
    real(wp) :: area(n_room)               !! of each, m
    real(wp) :: depth(n_room)              !! more than 0 where both are behind the master segment and nearer to it than
                                           !! to its ends
  end type plain_points_t

  !> A slave segment.
  type :: slave_t
    integer :: ends(2)       !! its nodes
    real(wp) :: normal(2)
    real(wp) :: length       !! m
  end type slave_t

contains

  !> Place the points: of all segments that may touch, then of their neighbours that can not, since these have a
  !> part in the averaged gaps of common nodes.
  pure subroutine place_segmented_mortar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t) :: cover
    integer :: s, first

    if (all_asleep(memory)) return
    call clear_list(cover)
    s = 1
    do while (s <= contact%slave%n_segment)
      first = s
      call list_touching(contact, memory, s, cover)
      memory%cover%is_placed(first:s - 1) = .true.
      if (cover%is_full) then
        call place_list(contact, memory, .true., cover)
      else if (s <= contact%slave%n_segment) then
        memory%cover%is_placed(s) = .not. is_asleep(memory, s, contact%slave%segments(:, s))
        if (memory%cover%is_placed(s)) call take_segment(contact, memory, s, .true., cover)
        s = s + 1
      end if
    end do
    call place_list(contact, memory, .true., cover)
    call note_next_wake(memory)
    if (.not. any(memory%mark > 0)) then
      memory%points%n = 0
      return
    end if
    do s = 1, contact%slave%n_segment
      if (memory%cover%is_placed(s)) cycle
      if (memory%mark(contact%slave%segments(1, s)) == 0 &
        .and. memory%mark(contact%slave%segments(2, s)) == 0) cycle
      call take_segment(contact, memory, s, .false., cover)
    end do
    call place_list(contact, memory, .false., cover)
    memory%mark = 0
  end subroutine place_segmented_mortar

  !> Put a segment on the list, and place its points with the list when that is full.
  pure subroutine take_segment(contact, memory, s, may_touch, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s
    logical, intent(in) :: may_touch
    type(plain_cover_t), intent(inout) :: cover
    logical :: is_listed

    call list_segment(contact, memory, s, cover, is_listed)
    if (.not. is_listed) call list_other(s, cover)
    if (cover%is_full) call place_list(contact, memory, may_touch, cover)
  end subroutine take_segment

  !> The points of one segment; one that may touch is judged by them.
  pure subroutine place_segment(contact, memory, s, may_touch)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s
    logical, intent(in) :: may_touch
    type(cover_t) :: cover
    integer :: n_before

    n_before = memory%points%n
    call find_cover(contact, memory, s, cover)
    call add_pieces(contact, memory, cover)
    if (may_touch) call judge_last(contact, memory, s, n_before)
  end subroutine place_segment

  !> The same for a segment on the list whose points are not all where the list has them.
  pure subroutine place_listed(contact, memory, cover, i, may_touch)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t), intent(in) :: cover
    integer, intent(in) :: i !! of the list
    logical, intent(in) :: may_touch
    integer :: n_before

    if (.not. cover%is_plain(i)) then
      call place_segment(contact, memory, cover%slave(i), may_touch)
      return
    end if
    n_before = memory%points%n
    call add_listed_pieces(contact, memory, contact%slave%segments(:, cover%slave(i)), &
      cover%master(cover%last(i - 1) + 1:cover%last(i)))
    if (may_touch) call judge_last(contact, memory, cover%slave(i), n_before)
  end subroutine place_listed

  !> Judge a segment by the points that have been appended last, and drop them if they do not count.
  pure subroutine judge_last(contact, memory, s, n_before)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s, n_before
    logical :: counts

    call judge_points(contact, memory, s, .false., minval(memory%points%gap(n_before + 1:memory%points%n)), &
      counts)
    if (.not. counts) memory%points%n = n_before
  end subroutine judge_last

  !> Whether the points of a segment count; marks its nodes if one of them is in contact. Where neither they nor an end of it
  !> is in contact they are left to the second round, like those of a segment that sleeps: so sums over the points
  !> of a node do not depend on who sleeps.
  pure subroutine judge_points(contact, memory, s, touches, deepest, counts)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s
    logical, intent(in) :: touches  !! the common case, and both ends are in contact
    real(wp), intent(in) :: deepest !! smallest gap of its points, m
    logical, intent(out) :: counts
    integer :: ends(2)

    counts = .true.
    ends = contact%slave%segments(:, s)
    if (touches) then
      call note_plain_contact(memory, s, deepest < memory%closed_gap)
    else
      call judge_segment(contact, memory, s, ends, deepest, counts)
    end if
    if (counts .and. deepest < memory%closed_gap) then
      memory%mark(ends(1)) = 1
      memory%mark(ends(2)) = 1
    else if (counts .and. .not. touches) then
      counts = any(memory%slave_tracking%status(ends) == is_touching)
      memory%cover%is_placed(s) = counts
    end if
  end subroutine judge_points

  !> Place the points of the segments on a list, and clear it.
  pure subroutine place_list(contact, memory, may_touch, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    logical, intent(in) :: may_touch
    type(plain_cover_t), intent(inout) :: cover
    type(plain_points_t) :: found
    integer :: i, first, last
    logical :: counts

    call cut_segments(contact, memory, cover)
    call find_points(cover%n_piece, cover%own, cover%other, cover%way, cover%low, cover%high, &
      cover%length, found)
    if (memory%points%n + n_gauss*cover%n_piece > size(memory%points%gap)) &
      call make_room(memory%points, n_gauss*cover%n_piece)
    first = 1
    do i = 1, cover%n_segment
      last = cover%last(i)
      if (.not. is_plain(contact, memory, cover, found, i)) then
        call put_points(memory, cover, found, first, cover%last(i - 1))
        call place_listed(contact, memory, cover, i, may_touch)
        if (memory%points%n + n_gauss*(cover%n_piece - last) > size(memory%points%gap)) &
          call make_room(memory%points, n_gauss*(cover%n_piece - last))
        first = last + 1
      else if (may_touch) then
        call judge_points(contact, memory, cover%slave(i), cover%touches(i), &
          minval(found%gap(:, cover%last(i - 1) + 1:last)), counts)
        if (counts) cycle
        call put_points(memory, cover, found, first, cover%last(i - 1))
        first = last + 1
      end if
    end do
    call put_points(memory, cover, found, first, cover%n_piece)
    call clear_list(cover)
  end subroutine place_list

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

  !> The points of one segment.
  pure subroutine add_pieces(contact, memory, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(cover_t), intent(in) :: cover
    type(piece_t) :: piece
    type(slave_t) :: slave

    if (.not. cover%exists) return
    slave = slave_of(memory, cover%ends)
    call first_piece(contact, memory, cover, piece)
    do while (.not. piece%is_last)
      call next_piece(contact, memory, cover, piece)
      if (piece%high > piece%low .and. piece%share > 0.0_wp) &
        call add_piece(contact, memory, slave, piece%segment, piece%low, piece%high)
    end do
  end subroutine add_pieces

  !> The points of one segment whose pieces are known to be over these master segments and to face them: what
  !> `add_pieces` comes to.
  pure subroutine add_listed_pieces(contact, memory, ends, master)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: ends(2)    !! nodes of the slave segment
    integer, intent(in), contiguous :: master(:)  !! segment of each piece
    type(slave_t) :: slave
    type(sight_t) :: sight
    real(wp) :: low, high
    integer :: k

    slave = slave_of(memory, ends)
    low = 0.0_wp
    do k = 1, size(master)
      high = 1.0_wp
      if (k < size(master)) then
        sight = sight_of_segment(memory%places(:, memory%n_slave + contact%master%segments(1, master(k))), &
          memory%places(:, ends(1)), memory%places(:, ends(2)))
        high = sight%along/sight%square
      end if
      call add_piece(contact, memory, slave, master(k), low, high)
      low = high
    end do
  end subroutine add_listed_pieces

  !> What the points of a slave segment have in common.
  pure function slave_of(memory, ends) result(slave)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    type(slave_t) :: slave
    type(sight_t) :: sight

    sight = sight_of_segment(memory%places(:, ends(2)), memory%places(:, ends(1)), memory%places(:, ends(2)))
    slave%ends = ends
    slave%normal = sight_normal(sight)
    slave%length = sqrt(sight%square)
  end function slave_of

  !> The Gauss points on a piece, each over whatever master segment is closest there.
  pure subroutine add_piece(contact, memory, slave, segment, low, high)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(slave_t), intent(in) :: slave
    integer, intent(in) :: segment    !! master segment of the piece
    real(wp), intent(in) :: low, high !! where it starts and ends on the slave segment
    type(foot_t) :: foot
    real(wp) :: share, xi, weight
    integer :: q

    if (memory%points%n + n_gauss > size(memory%points%gap)) call make_room(memory%points, n_gauss)
    weight = 0.5_wp*(high - low)
    do q = 1, n_gauss
      xi = low + gauss_xi(q)*(high - low)
      foot = local_foot(contact, memory, place_on_segment(memory%places, slave%ends, xi), segment)
      if (.not. foot%is_on) cycle
      share = facing_share(dot_product(slave%normal, foot%normal))
      if (.not. share > 0.0_wp) cycle
      call add_segment_point(contact%master, memory%n_slave, slave%ends, xi, foot, memory%points)
      associate (p => memory%points%n)
        memory%points%area(p) = weight*share*slave%length
        memory%points%stiffness(p) = memory%slave_penalty
      end associate
    end do
  end subroutine add_piece

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

end module points_segmented_mortar_m
