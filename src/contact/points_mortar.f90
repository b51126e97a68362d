! SPDX-License-Identifier: MIT
!> Type 6, mortar: Gauss points on each whole slave segment, pressure from the slave nodes
!> (doc/theory/contact.md, section 5.6).
module points_mortar_m
  use contact_overlap_m, only : local_foot, facing_share
  use contact_placing_m, only : add_segment_point, add_plain_point
  use contact_plain_foot_m, only : is_plainly_over
  use contact_projection_m, only : foot_t, see_segment
  use contact_state_m, only : contact_state_t, make_room, n_side, is_touching, is_behind
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, sight_of_segment, sight_gap, sight_normal
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
    do s = 1, contact%slave%n_segment
      near = max(memory%mark(contact%slave%segments(1, s)), memory%mark(contact%slave%segments(2, s)))
      if (near > 0) call add_gauss_points(contact, memory, s, near)
    end do
    memory%mark = 0
  end subroutine place_mortar

  !> The points of one segment that have a master: those in contact where the tracking has them, others
  !> where they are closest. `near` is a master segment close by.
  pure subroutine add_gauss_points(contact, memory, s, near)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s, near
    type(sight_t) :: sight
    real(wp) :: length, normal(2)
    integer :: q, i, first, n, ends(2)

    n = size(memory%spot_xi)
    first = (s - 1)*n
    if (memory%points%n + n > size(memory%points%gap)) call make_room(memory%points, n)
    ends = contact%slave%segments(:, s)
    sight = sight_of_segment(memory%places(:, ends(2)), memory%places(:, ends(1)), &
      memory%places(:, ends(2)))
    length = sqrt(sight%square)
    normal = sight_normal(sight)
    q = 1
    do while (q <= n)
      i = first + q
      if (memory%slave_tracking%status(i) == is_touching) then
        call add_spots(contact, memory, ends, normal, length, first, q)
        cycle
      end if
      if (memory%slave_tracking%status(i) /= is_behind) &
        call add_free_spot(contact, memory, ends, normal, length, q, i, near)
      q = q + 1
    end do
  end subroutine add_gauss_points

  !> Points at the Gauss points in contact from q to the last one or the first that is not: q is then behind these. A
  !> run of them is written at once.
  pure subroutine add_spots(contact, memory, ends, normal, length, first, q)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: ends(2)   !! nodes of the slave segment
    real(wp), intent(in) :: normal(2), length !! of the slave segment
    integer, intent(in) :: first     !! spot before the segment's first one
    integer, intent(inout) :: q      !! which Gauss point of the segment
    integer :: n, i
    logical :: all_count

    associate (points => memory%points, tracking => memory%slave_tracking, p => memory%points%n + 1)
      i = first + q
      n = count_touching(size(memory%spot_xi) - q + 1, tracking%status(i))
      call share_length(n, normal, length, tracking%normal(1, i), memory%spot_share(q), &
        points%area(p), all_count)
      if (.not. all_count .and. n > 1) then
        n = 1
        call share_length(n, normal, length, tracking%normal(1, i), memory%spot_share(q), &
          points%area(p), all_count)
      end if
      if (all_count) then
        call put_slave_side(n, ends, memory%spot_xi(q), points%slave_nodes(1, p), &
          points%slave_weights(1, p))
        call put_master_side(n, tracking%segment(i), tracking%xi(i), contact%master%segments, &
          memory%n_slave, points%master_nodes(1, p), points%master_weights(1, p))
        call put_gaps(n, tracking%gap(i), tracking%normal(1, i), memory%slave_penalty, &
          points%gap(p), points%normal(1, p), points%stiffness(p))
        points%n = points%n + n
      end if
      q = q + n
    end associate
  end subroutine add_spots

  !> How many of the first of these are in contact.
  pure function count_touching(n, status) result(run)
    integer, intent(in) :: n, status(n)
    integer :: run

    run = 0
    do while (run < n)
      if (status(run + 1) /= is_touching) exit
      run = run + 1
    end do
  end function count_touching

  !> Areas of some Gauss points of a segment, and whether all of them face the master.
  pure subroutine share_length(n, normal, length, normals, shares, areas, all_count)
    integer, intent(in) :: n
    real(wp), intent(in) :: normal(2), length       !! of the segment
    real(wp), intent(in) :: normals(2, n)           !! of the master at the points
    real(wp), intent(in) :: shares(n)               !! of the segment's length
    real(wp), intent(inout) :: areas(n)             !! m
    logical, intent(out) :: all_count
    real(wp) :: share, least
    integer :: k

    least = 1.0_wp
    do k = 1, n
      share = facing_share(normal(1)*normals(1, k) + normal(2)*normals(2, k))
      least = min(least, share)
      areas(k) = share*shares(k)*length
    end do
    all_count = least > 0.0_wp
  end subroutine share_length

  !> Slave side of some points of one segment.
  pure subroutine put_slave_side(n, ends, xi, nodes, weights)
    integer, intent(in) :: n, ends(n_side)
    real(wp), intent(in) :: xi(n)
    integer, intent(inout) :: nodes(n_side, n)
    real(wp), intent(inout) :: weights(n_side, n)
    integer :: k

    do k = 1, n
      nodes(1, k) = ends(1)
      nodes(2, k) = ends(2)
      weights(1, k) = 1.0_wp - xi(k)
      weights(2, k) = xi(k)
    end do
  end subroutine put_slave_side

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

  !> Gap, normal and stiffness of some points.
  pure subroutine put_gaps(n, gap, normal, penalty, gaps, normals, stiffness)
    integer, intent(in) :: n
    real(wp), intent(in) :: gap(n), normal(2, n), penalty
    real(wp), intent(inout) :: gaps(n), normals(2, n), stiffness(n)
    integer :: k

    do k = 1, n
      gaps(k) = gap(k)
      normals(1, k) = normal(1, k)
      normals(2, k) = normal(2, k)
      stiffness(k) = penalty
    end do
  end subroutine put_gaps

  !> A point at any other Gauss point.
  pure subroutine add_free_spot(contact, memory, ends, normal, length, q, i, near)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: ends(2)
    real(wp), intent(in) :: normal(2), length
    integer, intent(in) :: q, i !! which of the segment, and which spot
    integer, intent(in) :: near
    type(foot_t) :: foot
    type(sight_t) :: sight
    real(wp) :: share
    integer :: start

    start = memory%slave_tracking%segment(i)
    if (start == 0) start = near
    associate (points => memory%points, chain => memory%places(:, memory%n_slave + 1:))
      sight = see_segment(contact%master, chain, memory%spots(:, i), start)
      if (is_plainly_over(contact%master, chain, sight, start)) then
        call add_plain_point(ends, memory%spot_xi(q), memory%n_slave + contact%master%segments(:, start), &
          sight%along/sight%square, sight_normal(sight), sight_gap(sight), points)
      else
        foot = local_foot(contact, memory, memory%spots(:, i), start)
        if (.not. foot%is_on) return
        call add_segment_point(contact%master, memory%n_slave, ends, memory%spot_xi(q), foot, points)
      end if
      share = facing_share(normal(1)*points%normal(1, points%n) + normal(2)*points%normal(2, points%n))
      points%area(points%n) = share*memory%spot_share(q)*length
      points%stiffness(points%n) = memory%slave_penalty
      if (.not. share > 0.0_wp) points%n = points%n - 1
    end associate
  end subroutine add_free_spot

end module points_mortar_m
