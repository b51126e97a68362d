! SPDX-License-Identifier: MIT
!> Gauss points of slave segments that touch in part, listed first and then seen many at a time, so
!> that the roots and quotients of a list are formed together (one by one, they took a third of the
!> time of type 6). What is found is what `local_foot` finds; spots that are not plainly over one
!> master segment are left to that.
module contact_spot_list_m
  use contact_local_foot_m, only : local_foot
  use contact_overlap_m, only : facing_share, face_on
  use contact_plain_foot_m, only : well_inside
  use contact_projection_m, only : foot_t
  use contact_state_m, only : contact_state_t, make_room, n_side, is_touching, is_behind
  use contacts_m, only : contact_t, most_gauss
  use kinds_m, only : wp
  implicit none
  private
  public :: spot_list_t, list_spots, put_spots

  !> Spots of a list.
  integer, parameter :: n_room = 64
  !> Cosine below which a point surely faces the master entirely, whatever round-off decides.
  real(wp), parameter :: surely_facing = face_on - 1.0e-9_wp

  !> The list. Without default values, which would be written before each use.
  type :: spot_list_t
    integer :: n
    logical :: is_full               !! no other segment may fit
    integer :: spot(n_room)
    integer :: place(n_room)         !! which of its segment
    integer :: ends(2, n_room)       !! nodes of that
    integer :: master(n_room)        !! segment, 0: no point
    logical :: touches(n_room)
    real(wp) :: own(2, n_room)       !! vector of the slave segment, m
    real(wp) :: t(2, n_room)         !! vector of the master segment, m
    real(wp) :: before(2, n_room)    !! vectors of its neighbours, 0 where there is none, m
    real(wp) :: after(2, n_room)
    real(wp) :: d(2, n_room)         !! from the master segment's first node to the spot, m
    real(wp) :: xi(n_room)           !! foot on the master segment
    real(wp) :: gap(n_room)          !! m
    real(wp) :: normal(2, n_room)    !! of the master
    real(wp) :: length(n_room)       !! of the slave segment, m
    real(wp) :: inside(n_room)       !! more than 0 where the spot is well inside this master
                                     !! segment, m^2
    real(wp) :: past(n_room)         !! not less than 0 where it is over no neighbour of that, m^2
    real(wp) :: facing(n_room)       !! more than 0 where the segments surely face each other
                                     !! entirely
  end type spot_list_t

contains

  !> Put the spots of a slave segment on the list; those that are let go have no point.
  pure subroutine list_spots(m, s, ends, status, segment, near, list)
    integer, intent(in) :: m, s        !! spots of a segment, and which segment
    integer, intent(in) :: ends(2)     !! its nodes
    integer, intent(in) :: status(m), segment(m)
    integer, intent(in) :: near        !! a master segment close by
    type(spot_list_t), intent(inout) :: list
    integer :: q, k

    k = list%n
    do q = 1, m
      if (status(q) == is_behind) cycle
      k = k + 1
      list%spot(k) = (s - 1)*m + q
      list%place(k) = q
      list%ends(1, k) = ends(1)
      list%ends(2, k) = ends(2)
      list%master(k) = merge(segment(q), near, segment(q) > 0)
      list%touches(k) = status(q) == is_touching
    end do
    list%n = k
    list%is_full = k > n_room - most_gauss
  end subroutine list_spots

  !> Append the points of the spots on the list, and clear it.
  pure subroutine put_spots(contact, memory, list)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(spot_list_t), intent(inout) :: list
    integer :: n_before

    list%is_full = .false.
    if (list%n == 0) return
    associate (tracking => memory%slave_tracking, points => memory%points)
      call see_spots(list%n, memory%places, memory%n_slave, memory%spots, contact%master%segments, &
        contact%master%previous, contact%master%next, list)
      call project_spots(list%n, list%t, list%d, list%before, list%after, list%xi, list%gap, &
        list%normal, list%inside, list%past)
      call hold_spots(tracking%xi, tracking%gap, tracking%normal, list)
      call face_spots(list%n, list%own, list%normal, list%length, list%facing)
      call finish_spots(contact, memory, list)
      if (points%n + list%n > size(points%gap)) call make_room(points, list%n)
      n_before = points%n
      call emit_sides(list, memory%n_slave, memory%spot_xi, contact%master%segments, &
        points%slave_nodes(1, n_before + 1), points%slave_weights(1, n_before + 1), &
        points%master_nodes(1, n_before + 1), points%master_weights(1, n_before + 1))
      call emit_springs(list, memory%spot_share, points%gap(n_before + 1), &
        points%normal(1, n_before + 1), points%area(n_before + 1))
      points%stiffness(n_before + 1:n_before + list%n) = memory%slave_penalty
      points%n = n_before + list%n
    end associate
    list%n = 0
  end subroutine put_spots

  !> Vectors of the spots on the list.
  pure subroutine see_spots(n, places, n_slave, spots, segments, previous, next, list)
    integer, intent(in) :: n
    real(wp), intent(in) :: places(4, *), spots(4, *)
    integer, intent(in) :: n_slave !! local number before the first master node
    integer, intent(in) :: segments(2, *), previous(*), next(*) !! of the master
    type(spot_list_t), intent(inout) :: list
    real(wp), dimension(4) :: own, t, before, after, d
    integer :: k, a, b

    !GCC$ NOVECTOR
    do k = 1, n
      a = n_slave + segments(1, list%master(k))
      b = n_slave + segments(2, list%master(k))
      own = places(:, list%ends(2, k)) - places(:, list%ends(1, k))
      t = places(:, b) - places(:, a)
      d = spots(:, list%spot(k)) - places(:, a)
      before = 0.0_wp
      after = 0.0_wp
      ! The neighbours' nodes in common are those of this segment.
      if (previous(list%master(k)) > 0) before = places(:, a) &
        - places(:, n_slave + segments(1, previous(list%master(k))))
      if (next(list%master(k)) > 0) after = places(:, n_slave + segments(2, next(list%master(k)))) &
        - places(:, b)
      list%own(:, k) = own(1:2) + own(3:4)
      list%t(:, k) = t(1:2) + t(3:4)
      list%d(:, k) = d(1:2) + d(3:4)
      list%before(:, k) = before(1:2) + before(3:4)
      list%after(:, k) = after(1:2) + after(3:4)
    end do
  end subroutine see_spots

  !> Project them. The second product of a sum is in parentheses, rounded first, since that is how
  !> `sight_of_segment` comes out where products and sums are fused: one by one or on a list, the
  !> bits are the same.
  pure subroutine project_spots(n, t, d, before, after, xi, gap, normal, inside, past)
    integer, intent(in) :: n
    real(wp), dimension(2, n_room), intent(in) :: t, d, before, after
    real(wp), intent(inout) :: xi(n_room), gap(n_room), normal(2, n_room), inside(n_room), &
      past(n_room)
    real(wp) :: square, length, along
    integer :: k

    !$omp simd private(square, length, along)
    do k = 1, n
      square = max(t(1, k)*t(1, k) + (t(2, k)*t(2, k)), tiny(1.0_wp))
      along = d(1, k)*t(1, k) + (d(2, k)*t(2, k))
      length = sqrt(square)
      xi(k) = along/square
      gap(k) = (d(1, k)*t(2, k) - (d(2, k)*t(1, k)))/length
      normal(1, k) = t(2, k)/length
      normal(2, k) = -t(1, k)/length
      ! Numbers, since a loop that keeps logicals is not vectorized.
      inside(k) = min(along - (well_inside*square), ((1.0_wp - well_inside)*square) - along)
      past(k) = min(d(1, k)*before(1, k) + d(2, k)*before(2, k), &
        -((d(1, k) - t(1, k))*after(1, k) + (d(2, k) - t(2, k))*after(2, k)))
    end do
  end subroutine project_spots

  !> Feet of the spots in contact as the tracking knows them.
  pure subroutine hold_spots(xi, gap, normal, list)
    real(wp), intent(in) :: xi(*), gap(*), normal(2, *)
    type(spot_list_t), intent(inout) :: list
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, list%n
      if (.not. list%touches(k)) cycle
      list%xi(k) = xi(list%spot(k))
      list%gap(k) = gap(list%spot(k))
      list%normal(1, k) = normal(1, list%spot(k))
      list%normal(2, k) = normal(2, list%spot(k))
    end do
  end subroutine hold_spots

  !> How the slave segments face the master there.
  pure subroutine face_spots(n, own, normal, length, facing)
    integer, intent(in) :: n
    real(wp), dimension(2, n_room), intent(in) :: own, normal
    real(wp), dimension(n_room), intent(inout) :: length, facing
    real(wp) :: square
    integer :: k

    !$omp simd private(square)
    do k = 1, n
      square = max(own(1, k)*own(1, k) + (own(2, k)*own(2, k)), tiny(1.0_wp))
      length(k) = sqrt(square)
      facing(k) = own(1, k)*normal(2, k) - own(2, k)*normal(1, k) + surely_facing*length(k)
    end do
  end subroutine face_spots

  !> Feet that need a decision; spots that are beyond an end of the master or do not face it leave
  !> the list.
  pure subroutine finish_spots(contact, memory, list)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(spot_list_t), intent(inout) :: list
    type(foot_t) :: foot
    logical :: is_lost
    integer :: k

    is_lost = .false.
    do k = 1, list%n
      if (.not. (list%touches(k) .or. (list%inside(k) > 0.0_wp .and. list%past(k) >= 0.0_wp))) then
        foot = local_foot(contact, memory, memory%spots(:, list%spot(k)), list%master(k))
        list%xi(k) = foot%xi
        list%gap(k) = foot%gap
        list%normal(:, k) = foot%normal
        list%master(k) = merge(foot%segment, 0, foot%is_on)
        list%facing(k) = 0.0_wp
      end if
      if (.not. list%facing(k) > 0.0_wp) then
        if (.not. share_of(list, k) > 0.0_wp) list%master(k) = 0
      end if
      is_lost = is_lost .or. list%master(k) == 0
    end do
    if (is_lost) call close_ranks(list)
  end subroutine finish_spots

  !> How much of a spot's length counts.
  pure function share_of(list, k) result(share)
    type(spot_list_t), intent(in) :: list
    integer, intent(in) :: k
    real(wp) :: share

    share = facing_share(dot_product([list%own(2, k), -list%own(1, k)]/list%length(k), &
      list%normal(:, k)))
  end function share_of

  !> Drop the spots without a master.
  pure subroutine close_ranks(list)
    type(spot_list_t), intent(inout) :: list
    integer :: k, n

    n = 0
    do k = 1, list%n
      if (list%master(k) == 0) cycle
      n = n + 1
      list%place(n) = list%place(k)
      list%ends(:, n) = list%ends(:, k)
      list%master(n) = list%master(k)
      list%own(:, n) = list%own(:, k)
      list%xi(n) = list%xi(k)
      list%gap(n) = list%gap(k)
      list%normal(:, n) = list%normal(:, k)
      list%length(n) = list%length(k)
      list%facing(n) = list%facing(k)
    end do
    list%n = n
  end subroutine close_ranks

  !> Nodes and weights of the points on the list.
  pure subroutine emit_sides(list, n_slave, spot_xi, segments, slave_nodes, slave_weights, &
      master_nodes, master_weights)
    type(spot_list_t), intent(in) :: list
    integer, intent(in) :: n_slave              !! local number before the first master node
    real(wp), intent(in) :: spot_xi(*)
    integer, intent(in) :: segments(n_side, *)  !! of the master
    integer, dimension(n_side, *), intent(inout) :: slave_nodes, master_nodes
    real(wp), dimension(n_side, *), intent(inout) :: slave_weights, master_weights
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, list%n
      slave_nodes(1, k) = list%ends(1, k)
      slave_nodes(2, k) = list%ends(2, k)
      slave_weights(1, k) = 1.0_wp - spot_xi(list%place(k))
      slave_weights(2, k) = spot_xi(list%place(k))
      master_nodes(1, k) = n_slave + segments(1, list%master(k))
      master_nodes(2, k) = n_slave + segments(2, list%master(k))
      master_weights(1, k) = 1.0_wp - list%xi(k)
      master_weights(2, k) = list%xi(k)
    end do
  end subroutine emit_sides

  !> Their gaps (m), normals, and areas (m).
  pure subroutine emit_springs(list, spot_share, gap, normal, area)
    type(spot_list_t), intent(in) :: list
    real(wp), intent(in) :: spot_share(*) !! part of a segment's length
    real(wp), intent(inout) :: gap(*), normal(2, *), area(*)
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, list%n
      gap(k) = list%gap(k)
      normal(1, k) = list%normal(1, k)
      normal(2, k) = list%normal(2, k)
      area(k) = spot_share(list%place(k))*list%length(k)
      if (.not. list%facing(k) > 0.0_wp) &
        area(k) = share_of(list, k)*spot_share(list%place(k))*list%length(k)
    end do
  end subroutine emit_springs

end module contact_spot_list_m
