! SPDX-License-Identifier: MIT
!> Type 6, mortar: Gauss points on each whole slave segment, pressure from the slave nodes
!> (doc/theory/contact.md, section 5.6).
module place_mortar_m
  use contact_state_m, only : contact_state_t, tracking_t, is_touching
  use contacts_m, only : contact_t
  use foot_block_m, only : n_block, project_block, settle_odd
  use foot_m, only : foot_t, near_foot, facing_share, face_on
  use geometry_m, only : separation
  use kinds_m, only : wp
  use overlaps_m, only : closest_candidate
  use point_list_m, only : place_block_t, append_points, drop_places, weigh_points
  use tips_m, only : has_folds, find_tips, belongs_to
  implicit none
  private
  public :: place_mortar

contains

  !> Place the points of all segments that share a node with one in contact: these decide on nodal
  !> pressures. A spot that is not in contact is looked for from a master segment close by.
  pure subroutine place_mortar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(place_block_t) :: block, others
    integer :: s, n, m, near

    if (memory%slave_tracking%n_touching == 0) return
    m = size(memory%spot_xi)
    if (has_folds(contact)) call find_tips(contact%slave, memory)
    call mark_ends(memory%slave_tracking, m, contact%slave%segments, memory%scratch%point_at)
    block%n = 0
    others%n = 0
    s = 1
    do while (s <= contact%slave%n_segment)
      near = max(memory%scratch%point_at(contact%slave%segments(1, s)), &
        memory%scratch%point_at(contact%slave%segments(2, s)))
      n = 0
      if (near > 0) then
        if (block%n + m > n_block) call append_points(block, memory%slave_penalty, memory%points)
        n = count_touching(m, min((n_block - block%n)/m, contact%slave%n_segment - s + 1), &
          memory%slave_tracking%status((s - 1)*m + 1))
        if (n > 0) then
          call add_touching(contact, memory, s, n, m, block)
        else
          call add_others(contact, memory, s, m, near, others)
          call append_points(block, memory%slave_penalty, memory%points)
          call append_points(others, memory%slave_penalty, memory%points)
        end if
      end if
      s = s + max(1, n)
    end do
    call append_points(block, memory%slave_penalty, memory%points)
    if (contact%is_round) call weigh_points(memory%places, memory%points)
    memory%scratch%point_at = 0
  end subroutine place_mortar

  !> How many of the first of some segments have all their spots in contact.
  pure function count_touching(m, n, status) result(n_touching)
    integer, intent(in) :: m, n, status(m, n)
    integer :: n_touching, q

    n_touching = 0
    do while (n_touching < n)
      !GCC$ UNROLL 1
      do q = 1, m
        if (status(q, n_touching + 1) /= is_touching) return
      end do
      n_touching = n_touching + 1
    end do
  end function count_touching

  !> Note at both ends of each segment with a spot in contact the master segment of the first of
  !> these spots.
  pure subroutine mark_ends(tracking, m, ends, near)
    type(tracking_t), intent(in) :: tracking
    integer, intent(in) :: m          !! spots of a segment
    integer, intent(in) :: ends(2, *) !! of the slave
    integer, intent(inout) :: near(*) !! (n_slave)
    integer :: k, s, last

    last = 0
    do k = 1, tracking%n_touching
      if (tracking%touching(k) <= last) cycle
      s = 1 + (tracking%touching(k) - 1)/m
      last = s*m
      near(ends(1, s)) = tracking%segment(tracking%touching(k))
      near(ends(2, s)) = tracking%segment(tracking%touching(k))
    end do
  end subroutine mark_ends

  !> The points of n segments from s on with all spots in contact, array by array.
  pure subroutine add_touching(contact, memory, s, n, m, block)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, n, m !! first segment, segments, spots of each
    type(place_block_t), intent(inout) :: block
    integer :: place
    logical :: all_face

    associate (tracking => memory%slave_tracking, k => block%n + 1, i => (s - 1)*m + 1, &
      feet => block%feet)
      feet%xi(k:k + m*n - 1) = tracking%xi(i:i + m*n - 1)
      feet%gap(k:k + m*n - 1) = tracking%gap(i:i + m*n - 1)
      feet%normal(:, k:k + m*n - 1) = tracking%normal(:, i:i + m*n - 1)
      call put_sides(m, n, contact%slave%segments(1, s), tracking%segment(i), &
        contact%master%segments, memory%n_slave, block%ends(1, k), block%nodes(1, k))
      call put_areas(m, n, contact%slave%segments(1, s), memory%places, memory%spot_xi, &
        memory%spot_share, feet%normal(1, k), block%xi(k), block%area(k), all_face)
    end associate
    block%n = block%n + m*n
    if (has_folds(contact)) then
      all_face = .false.
      do place = block%n - m*n + 1, block%n, m
        call move_to_ends(memory, place, place + m - 1, block)
      end do
    end if
    if (.not. all_face) call take_shares(memory, block%n - m*n + 1, block)
  end subroutine add_touching

  !> Nodes of all places of some segments.
  pure subroutine put_sides(m, n, ends, segment, segments, n_slave, slave_nodes, master_nodes)
    integer, intent(in) :: m, n, ends(2, n), segment(m, n), segments(2, *)
    integer, intent(in) :: n_slave !! local number before the first master node
    integer, intent(inout) :: slave_nodes(2, m, n), master_nodes(2, m, n)
    integer :: k, q

    do k = 1, n
      !GCC$ NOVECTOR
      !GCC$ UNROLL 1
      do q = 1, m
        slave_nodes(:, q, k) = ends(:, k)
        master_nodes(:, q, k) = n_slave + segments(:, segment(q, k))
      end do
    end do
  end subroutine put_sides

  !> Where they are and their areas, if all of them face the master entirely.
  pure subroutine put_areas(m, n, ends, places, spot_xi, spot_share, normals, xi, areas, all_face)
    integer, intent(in) :: m, n, ends(2, n)
    real(wp), intent(in) :: places(4, *), spot_xi(m)
    real(wp), intent(in) :: spot_share(m)     !! of a segment's length
    real(wp), intent(in) :: normals(2, m, n)  !! of the master
    real(wp), intent(inout) :: xi(m, n), areas(m, n) !! m
    logical, intent(out) :: all_face
    real(wp) :: t(2), length, worst
    integer :: k, q

    all_face = .true.
    do k = 1, n
      t = separation(places(:, ends(2, k)), places(:, ends(1, k)))
      length = sqrt(t(1)*t(1) + t(2)*t(2))
      worst = -huge(1.0_wp)
      !GCC$ NOVECTOR
      !GCC$ UNROLL 1
      do q = 1, m
        worst = max(worst, t(2)*normals(1, q, k) - t(1)*normals(2, q, k))
        xi(q, k) = spot_xi(q)
        areas(q, k) = spot_share(q)*length
      end do
      all_face = all_face .and. worst <= face_on*length
    end do
  end subroutine put_areas

  !> The places at the nodes of a segment take over what the others are to
  !> give way, as far as they have a foot.
  pure subroutine move_to_ends(memory, first, last, block)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: first, last !! places of the segment
    type(place_block_t), intent(inout) :: block
    real(wp) :: part(2), length

    associate (ends => block%ends(:, first), xi => block%xi, area => block%area)
      part = maxval(memory%scratch%nodal(1, ends))
      if (.not. part(1) > 0.0_wp) return
      if (xi(first) > 0.0_wp .or. area(first) < 0.0_wp &
        .or. belongs_to(memory%nodes, ends(1), block%nodes(:, first))) part(1) = 0.0_wp
      if (xi(last) < 1.0_wp .or. area(last) < 0.0_wp &
        .or. belongs_to(memory%nodes, ends(2), block%nodes(:, last))) part(2) = 0.0_wp
      area(first:last) = area(first:last)*(1.0_wp - part(1)*(1.0_wp - xi(first:last)) &
        - part(2)*xi(first:last))
      length = norm2(separation(memory%places(:, ends(2)), memory%places(:, ends(1))))
      if (part(1) > 0.0_wp) area(first) = 0.5_wp*part(1)*length
      if (part(2) > 0.0_wp) area(last) = 0.5_wp*part(2)*length
    end associate
  end subroutine move_to_ends

  !> Reduce the areas of the places from one on to what faces the master; drop those without.
  pure subroutine take_shares(memory, first, block)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: first
    type(place_block_t), intent(inout) :: block
    real(wp) :: own(2)
    integer :: k

    do k = first, block%n
      own = separation(memory%places(:, block%ends(2, k)), memory%places(:, block%ends(1, k)))
      block%area(k) = block%area(k)*facing_share((own(2)*block%feet%normal(1, k) &
        - own(1)*block%feet%normal(2, k))/sqrt(own(1)*own(1) + own(2)*own(2)))
    end do
    call drop_places(block)
  end subroutine take_shares

  !> The points of a segment that touches in part: of all spots that are not let go and have a foot.
  pure subroutine add_others(contact, memory, s, m, near, block)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, m !! segment, spots of it
    integer, intent(in) :: near !! a master segment close by
    type(place_block_t), intent(inout) :: block
    type(foot_t) :: foot
    real(wp) :: own(2), length
    integer :: k, q, i, spots(n_block)
    logical :: is_lost(n_block) !! within reach of nothing

    associate (tracking => memory%slave_tracking, ends => contact%slave%segments(:, s), &
      chain => memory%places(:, memory%n_slave + 1:), feet => block%feet)
      own = separation(memory%places(:, ends(2)), memory%places(:, ends(1)))
      length = sqrt(own(1)*own(1) + own(2)*own(2))
      k = 0
      do q = 1, m
        i = (s - 1)*m + q
        k = k + 1
        spots(k) = i
        block%ends(:, k) = ends
        block%xi(k) = memory%spot_xi(q)
        block%area(k) = memory%spot_share(q)*length
        feet%segment(k) = tracking%segment(i)
        if (tracking%status(i) /= is_touching) &
          feet%segment(k) = closest_candidate(contact, memory, s, memory%spots(:, i), .false.)
        is_lost(k) = feet%segment(k) == 0
        if (is_lost(k)) feet%segment(k) = near
        associate (nodes => contact%master%segments(:, feet%segment(k)))
          feet%t(:, k) = separation(chain(:, nodes(2)), chain(:, nodes(1)))
          feet%d(:, k) = separation(memory%spots(:, i), chain(:, nodes(1)))
        end associate
      end do
      block%n = k
      feet%n = k
      call project_block(feet)
      if (feet%n_odd > 0) call settle_odd(contact%master, chain, feet)
      do k = 1, block%n
        if (tracking%status(spots(k)) == is_touching) then
          feet%xi(k) = tracking%xi(spots(k))
          feet%gap(k) = tracking%gap(spots(k))
          feet%normal(:, k) = tracking%normal(:, spots(k))
        else if (feet%odd(k) > 0.0_wp) then
          foot = near_foot(contact%master, chain, memory%spots(:, spots(k)), feet%segment(k))
          feet%segment(k) = foot%segment
          feet%xi(k) = foot%xi
          feet%gap(k) = foot%gap
          feet%normal(:, k) = foot%normal
          if (.not. foot%is_on) block%area(k) = -1.0_wp
        end if
        ! A separated point stands in front of what it is over, if at all.
        if (tracking%status(spots(k)) /= is_touching .and. feet%gap(k) < 0.0_wp) &
          block%area(k) = -1.0_wp
        block%nodes(:, k) = memory%n_slave + contact%master%segments(:, feet%segment(k))
      end do
    end associate
    if (has_folds(contact) .and. block%n > 1) call move_to_ends(memory, 1, block%n, block)
    call take_shares(memory, 1, block)
  end subroutine add_others

end module place_mortar_m
