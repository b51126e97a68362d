! SPDX-License-Identifier: MIT
!> Type 6, mortar: Gauss points on each whole slave segment, pressure from the slave nodes
!> (doc/theory/contact.md, section 5.6).
module points_mortar_m
  use contact_overlap_m, only : face_on
  use contact_spot_list_m, only : spot_list_t, list_spots, put_spots
  use contact_state_m, only : contact_state_t, contact_points_t, make_room, n_side, is_touching
  use contacts_m, only : contact_t
  use geometry_m, only : separation
  use kinds_m, only : wp
  implicit none
  private
  public :: place_mortar

contains

  !> Place the points of all segments that share a node with one in contact: these decide on nodal
  !> pressures.
  pure subroutine place_mortar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(spot_list_t) :: list
    integer :: s, near

    if (memory%slave_tracking%n_touching == 0) return
    call mark_ends(memory%slave_tracking%n_touching, memory%slave_tracking%touching, &
      memory%slave_tracking%segment, size(memory%spot_xi), contact%slave%segments, memory%mark)
    list%n = 0
    list%is_full = .false.
    s = 1
    do while (s <= contact%slave%n_segment)
      near = max(memory%mark(contact%slave%segments(1, s)), &
        memory%mark(contact%slave%segments(2, s)))
      if (near > 0) then
        call add_segments(contact, memory, near, list, s)
      else
        s = s + 1
      end if
    end do
    call put_spots(contact, memory, list)
    memory%mark = 0
  end subroutine place_mortar

  !> Note at both ends of each segment with a spot in contact the master segment of the first of
  !> these spots.
  pure subroutine mark_ends(n, touching, segment, n_per_segment, ends, mark)
    integer, intent(in) :: n, touching(n)  !! spots in contact
    integer, intent(in) :: segment(*)      !! of the master below each spot
    integer, intent(in) :: n_per_segment   !! spots
    integer, intent(in) :: ends(n_side, *) !! of the slave
    integer, intent(inout) :: mark(*)
    integer :: k, s, first, last

    first = 1
    last = 0
    do k = 1, n
      if (touching(k) >= first .and. touching(k) <= last) cycle
      s = 1 + (touching(k) - 1)/n_per_segment
      last = s*n_per_segment
      first = last - n_per_segment + 1
      mark(ends(1, s)) = segment(touching(k))
      mark(ends(2, s)) = segment(touching(k))
    end do
  end subroutine mark_ends

  !> The points of a segment and of those behind it, as long as all their Gauss points are in
  !> contact; s is then the next segment. A segment that touches in part, or does not face the
  !> master entirely, goes on the list. `near` is a master segment close by.
  pure subroutine add_segments(contact, memory, near, list, s)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: near
    type(spot_list_t), intent(inout) :: list
    integer, intent(inout) :: s
    integer :: n, m, k
    logical :: all_face

    m = size(memory%spot_xi)
    n = count_touching(m, contact%slave%n_segment - s + 1, &
      memory%slave_tracking%status((s - 1)*m + 1:))
    all_face = n > 0
    if (all_face) then
      if (list%n > 0) call put_spots(contact, memory, list)
      if (memory%points%n + n*m > size(memory%points%gap)) call make_room(memory%points, n*m)
      call add_touching(contact, memory, s, n, all_face)
    end if
    if (.not. all_face) then
      n = max(1, n)
      do k = s, s + n - 1
        if (list%is_full) call put_spots(contact, memory, list)
        call list_spots(m, k, contact%slave%segments(:, k), &
          memory%slave_tracking%status((k - 1)*m + 1), &
          memory%slave_tracking%segment((k - 1)*m + 1), near, list)
      end do
    end if
    s = s + n
  end subroutine add_segments

  !> How many of the first of some segments have all their spots in contact.
  pure function count_touching(m, n, status) result(run)
    integer, intent(in) :: m, n, status(m, n)
    integer :: run

    run = 0
    do while (run < n)
      if (any(status(:, run + 1) /= is_touching)) exit
      run = run + 1
    end do
  end function count_touching

  !> The points of n segments from s on with all Gauss points in contact, written array by array.
  pure subroutine add_touching(contact, memory, s, n, all_face)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s, n
    logical, intent(out) :: all_face !! the master entirely; otherwise nothing is done
    integer :: m

    m = size(memory%spot_xi)
    associate (points => memory%points, p => memory%points%n + 1, &
      tracking => memory%slave_tracking, i => (s - 1)*m + 1)
      call put_areas(m, n, contact%slave%segments(1, s), memory%places, tracking%normal(1, i), &
        memory%spot_share, points%area(p), points%normal(1, p), all_face)
      if (.not. all_face) return
      if (.not. is_known(m*n, contact%slave%segments(1, s), contact%slave%segments(1, s + n - 1), &
        memory%slave_penalty, points)) then
        call put_sides(m, n, contact%slave%segments(1, s), memory%spot_xi, &
          points%slave_nodes(1, p), points%slave_weights(1, p))
        points%stiffness(p:points%n + m*n) = memory%slave_penalty
      end if
      call put_master_side(m*n, tracking%segment(i), tracking%xi(i), contact%master%segments, &
        memory%n_slave, points%master_nodes(1, p), points%master_weights(1, p), tracking%gap(i), &
        points%gap(p))
      points%n = points%n + m*n
    end associate
  end subroutine add_touching

  !> Whether the next n points were those of the same segments at the last placement, so that their
  !> slave side and stiffness stand there. A segment has a point at each of its Gauss points at
  !> most, and segments are placed in order: where the first and the last point are those of the
  !> first and the last segment, so are all between.
  pure function is_known(n, first, last, stiffness, points)
    integer, intent(in) :: n
    integer, intent(in) :: first(n_side), last(n_side) !! nodes of the first and the last segment
    real(wp), intent(in) :: stiffness
    type(contact_points_t), intent(in) :: points
    logical :: is_known

    is_known = points%n + n <= points%n_former
    if (.not. is_known) return
    associate (p => points%n + 1, q => points%n + n)
      is_known = all(points%slave_nodes(:, p) == first) &
        .and. all(points%slave_nodes(:, q) == last) &
        .and. .not. abs(points%stiffness(p) - stiffness) > 0.0_wp
    end associate
  end function is_known

  !> Areas and normals of the Gauss points of some segments, if all of them face the master
  !> entirely.
  pure subroutine put_areas(m, n, ends, places, normals, shares, areas, point_normals, all_face)
    integer, intent(in) :: m, n, ends(2, n)
    real(wp), intent(in) :: places(4, *)
    real(wp), intent(in) :: normals(2, m, n)   !! of the master
    real(wp), intent(in) :: shares(m)          !! of a segment's length
    real(wp), intent(inout) :: areas(m, n)     !! m
    real(wp), intent(inout) :: point_normals(2, m, n)
    logical, intent(out) :: all_face
    real(wp) :: t(2), length, worst
    integer :: k, q

    all_face = .true.
    do k = 1, n
      t = separation(places(:, ends(2, k)), places(:, ends(1, k)))
      length = sqrt(t(1)*t(1) + t(2)*t(2))
      worst = -huge(1.0_wp)
      do q = 1, m
        worst = max(worst, t(2)*normals(1, q, k) - t(1)*normals(2, q, k))
        areas(q, k) = shares(q)*length
        point_normals(1, q, k) = normals(1, q, k)
        point_normals(2, q, k) = normals(2, q, k)
      end do
      all_face = all_face .and. worst <= face_on*length
    end do
  end subroutine put_areas

  !> Slave side of all points of some segments.
  pure subroutine put_sides(m, n, ends, xi, nodes, weights)
    integer, intent(in) :: m, n, ends(n_side, n)
    real(wp), intent(in) :: xi(m) !! places on a segment, 0 to 1
    integer, intent(inout) :: nodes(n_side, m, n)
    real(wp), intent(inout) :: weights(n_side, m, n)
    integer :: k, q

    do k = 1, n
      do q = 1, m
        nodes(1, q, k) = ends(1, k)
        nodes(2, q, k) = ends(2, k)
        weights(1, q, k) = 1.0_wp - xi(q)
        weights(2, q, k) = xi(q)
      end do
    end do
  end subroutine put_sides

  !> Master side and gaps of some points.
  pure subroutine put_master_side(n, segment, xi, segments, n_slave, nodes, weights, gap, gaps)
    integer, intent(in) :: n, segment(n), segments(n_side, *)
    real(wp), intent(in) :: xi(n)
    integer, intent(in) :: n_slave !! local number before the first master node
    integer, intent(inout) :: nodes(n_side, n)
    real(wp), intent(inout) :: weights(n_side, n)
    real(wp), intent(in) :: gap(n)   !! m
    real(wp), intent(inout) :: gaps(n)
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      nodes(1, k) = n_slave + segments(1, segment(k))
      nodes(2, k) = n_slave + segments(2, segment(k))
      weights(1, k) = 1.0_wp - xi(k)
      weights(2, k) = xi(k)
      gaps(k) = gap(k)
    end do
  end subroutine put_master_side

end module points_mortar_m
