! SPDX-License-Identifier: MIT
!> Type 6, mortar: Gauss points on each whole slave segment, pressure from the slave nodes
!> (doc/theory/contact.md, section 5.6).
module points_mortar_m
  use contact_overlap_m, only : local_foot, facing_share, face_on
  use contact_placing_m, only : add_segment_point, tracked_foot
  use contact_plain_foot_m, only : is_plainly_over
  use contact_projection_m, only : foot_t, see_segment, face_foot
  use contact_state_m, only : contact_state_t, make_room, n_side, is_touching, is_behind
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, sight_of_segment, sight_normal, separation
  use kinds_m, only : wp
  implicit none
  private
  public :: place_mortar

contains

  !> Place the points of all segments that share a node with one in contact: these decide on nodal pressures.
  pure subroutine place_mortar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer :: k, s, n_per_segment, near, before

    if (memory%slave_tracking%n_touching == 0) return
    n_per_segment = size(memory%spot_xi)
    before = 0
    do k = 1, memory%slave_tracking%n_touching
      s = 1 + (memory%slave_tracking%touching(k) - 1)/n_per_segment
      if (s == before) cycle
      before = s
      near = memory%slave_tracking%segment(memory%slave_tracking%touching(k))
      memory%mark(contact%slave%segments(1, s)) = near
      memory%mark(contact%slave%segments(2, s)) = near
    end do
    s = 1
    do while (s <= contact%slave%n_segment)
      near = max(memory%mark(contact%slave%segments(1, s)), memory%mark(contact%slave%segments(2, s)))
      if (near > 0) then
        call add_segments(contact, memory, near, s)
      else
        s = s + 1
      end if
    end do
    memory%mark = 0
  end subroutine place_mortar

  !> The points of a segment and of those behind it, as long as all their Gauss points are in contact; s is then the next
  !> segment. `near` is a master segment close by.
  pure subroutine add_segments(contact, memory, near, s)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: near
    integer, intent(inout) :: s
    integer :: n, k
    logical :: all_face

    n = count_touching(size(memory%spot_xi), contact%slave%n_segment - s + 1, &
      memory%slave_tracking%status((s - 1)*size(memory%spot_xi) + 1:))
    call make_room(memory%points, max(1, n)*size(memory%spot_xi))
    all_face = n > 0
    if (all_face) call add_touching(contact, memory, s, n, all_face)
    if (.not. all_face) then
      n = max(1, n)
      do k = s, s + n - 1
        call add_gauss_points(contact, memory, k, near)
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
    associate (points => memory%points, p => memory%points%n + 1, tracking => memory%slave_tracking, &
      i => (s - 1)*m + 1)
      call put_areas(m, n, contact%slave%segments(1, s), memory%places, tracking%normal(1, i), &
        memory%spot_share, points%area(p), all_face)
      if (.not. all_face) return
      call put_sides(m, n, contact%slave%segments(1, s), memory%spot_xi, points%slave_nodes(1, p), &
        points%slave_weights(1, p))
      call put_master_side(m*n, tracking%segment(i), tracking%xi(i), contact%master%segments, &
        memory%n_slave, points%master_nodes(1, p), points%master_weights(1, p))
      call copy(m*n, tracking%gap(i), points%gap(p))
      call copy(2*m*n, tracking%normal(1, i), points%normal(1, p))
      points%stiffness(p:points%n + m*n) = memory%slave_penalty
      points%n = points%n + m*n
    end associate
  end subroutine add_touching

  !> Areas of the Gauss points of some segments, if all of them face the master entirely.
  pure subroutine put_areas(m, n, ends, places, normals, shares, areas, all_face)
    integer, intent(in) :: m, n, ends(2, n)
    real(wp), intent(in) :: places(4, *)
    real(wp), intent(in) :: normals(2, m, n)   !! of the master
    real(wp), intent(in) :: shares(m)          !! of a segment's length
    real(wp), intent(inout) :: areas(m, n)     !! m
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

  !> Copy in one piece.
  pure subroutine copy(n, from, to)
    integer, intent(in) :: n
    real(wp), intent(in) :: from(n)
    real(wp), intent(inout) :: to(n)

    to = from
  end subroutine copy

  !> Master side of some points.
  pure subroutine put_master_side(n, segment, xi, segments, n_slave, nodes, weights)
    integer, intent(in) :: n, segment(n), segments(n_side, *)
    real(wp), intent(in) :: xi(n)
    integer, intent(in) :: n_slave !! local number before the first master node
    integer, intent(inout) :: nodes(n_side, n)
    real(wp), intent(inout) :: weights(n_side, n)
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      nodes(1, k) = n_slave + segments(1, segment(k))
      nodes(2, k) = n_slave + segments(2, segment(k))
      weights(1, k) = 1.0_wp - xi(k)
      weights(2, k) = xi(k)
    end do
  end subroutine put_master_side

  !> The points of one segment that have a master: those in contact where the tracking has them, others
  !> where they are closest. `near` is a master segment close by.
  pure subroutine add_gauss_points(contact, memory, s, near)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s, near
    type(sight_t) :: sight
    real(wp) :: share
    integer :: q, i, n_before, ends(2)

    ends = contact%slave%segments(:, s)
    sight = sight_of_segment(memory%places(:, ends(2)), memory%places(:, ends(1)), &
      memory%places(:, ends(2)))
    associate (points => memory%points, tracking => memory%slave_tracking)
      call make_room(points, size(memory%spot_xi))
      do q = 1, size(memory%spot_xi)
        i = (s - 1)*size(memory%spot_xi) + q
        n_before = points%n
        select case (tracking%status(i))
        case (is_touching)
          call add_segment_point(contact%master, memory%n_slave, ends, memory%spot_xi(q), &
            tracked_foot(tracking, i), points)
        case (is_behind)
        case default
          call add_free_spot(contact, memory, ends, q, i, near)
        end select
        if (points%n == n_before) cycle
        share = facing_share(dot_product(sight_normal(sight), points%normal(:, points%n)))
        points%area(points%n) = share*memory%spot_share(q)*sqrt(sight%square)
        points%stiffness(points%n) = memory%slave_penalty
        if (.not. share > 0.0_wp) points%n = n_before
      end do
    end associate
  end subroutine add_gauss_points

  !> A point at a Gauss point that is not in contact, where it has a foot.
  pure subroutine add_free_spot(contact, memory, ends, q, i, near)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: ends(2)
    integer, intent(in) :: q, i !! which of the segment, and which spot
    integer, intent(in) :: near
    type(foot_t) :: foot
    type(sight_t) :: sight
    integer :: start

    start = memory%slave_tracking%segment(i)
    if (start == 0) start = near
    associate (points => memory%points, chain => memory%places(:, memory%n_slave + 1:))
      sight = see_segment(contact%master, chain, memory%spots(:, i), start)
      if (is_plainly_over(contact%master, chain, sight, start)) then
        foot = face_foot(sight, start)
      else
        foot = local_foot(contact, memory, memory%spots(:, i), start)
        if (.not. foot%is_on) return
      end if
      call add_segment_point(contact%master, memory%n_slave, ends, memory%spot_xi(q), foot, points)
    end associate
  end subroutine add_free_spot

end module points_mortar_m
