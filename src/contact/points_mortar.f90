! SPDX-License-Identifier: MIT
!> Type 6, mortar: Gauss points on each whole slave segment, pressure from the slave nodes
!> (doc/theory/contact.md, section 5.6).
module points_mortar_m
  use contact_overlap_m, only : local_foot, facing_share
  use contact_placing_m, only : add_segment_point
  use contact_projection_m, only : foot_t
  use contact_state_m, only : contact_state_t, make_room, is_touching, is_behind
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, sight_of_segment, sight_normal
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
    type(foot_t) :: foot
    type(sight_t) :: sight
    real(wp) :: length, normal(2)
    integer :: q, i, ends(2)

    call make_room(memory%points, size(memory%spot_xi))
    ends = contact%slave%segments(:, s)
    sight = sight_of_segment(memory%places(:, ends(2)), memory%places(:, ends(1)), &
      memory%places(:, ends(2)))
    length = sqrt(sight%square)
    normal = sight_normal(sight)
    do q = 1, size(memory%spot_xi)
      i = (s - 1)*size(memory%spot_xi) + q
      associate (tracking => memory%slave_tracking)
        if (tracking%status(i) == is_touching) then
          call add_spot(contact, memory, ends, q, i, normal, length)
          cycle
        end if
        if (tracking%status(i) == is_behind) cycle
        foot = local_foot(contact, memory, memory%spots(:, i), &
          merge(tracking%segment(i), near, tracking%segment(i) > 0))
      end associate
      if (foot%is_on) call add_foot(contact, memory, ends, q, foot, normal, length)
    end do
  end subroutine add_gauss_points

  !> A point at a Gauss point in contact.
  pure subroutine add_spot(contact, memory, ends, q, i, normal, length)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: ends(2)   !! nodes of the slave segment
    integer, intent(in) :: q         !! which Gauss point of the segment
    integer, intent(in) :: i         !! which spot
    real(wp), intent(in) :: normal(2), length !! of the slave segment
    real(wp) :: share

    associate (points => memory%points, tracking => memory%slave_tracking)
      share = facing_share(normal(1)*tracking%normal(1, i) + normal(2)*tracking%normal(2, i))
      if (.not. share > 0.0_wp) return
      points%n = points%n + 1
      associate (p => points%n, segment => tracking%segment(i))
        points%slave_nodes(1, p) = ends(1)
        points%slave_nodes(2, p) = ends(2)
        points%slave_weights(1, p) = 1.0_wp - memory%spot_xi(q)
        points%slave_weights(2, p) = memory%spot_xi(q)
        points%master_nodes(1, p) = memory%n_slave + contact%master%segments(1, segment)
        points%master_nodes(2, p) = memory%n_slave + contact%master%segments(2, segment)
        points%master_weights(1, p) = 1.0_wp - tracking%xi(i)
        points%master_weights(2, p) = tracking%xi(i)
        points%normal(1, p) = tracking%normal(1, i)
        points%normal(2, p) = tracking%normal(2, i)
        points%gap(p) = tracking%gap(i)
        points%area(p) = share*memory%spot_share(q)*length
        points%stiffness(p) = memory%slave_penalty
      end associate
    end associate
  end subroutine add_spot

  !> A point at any other Gauss point.
  pure subroutine add_foot(contact, memory, ends, q, foot, normal, length)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: ends(2), q
    type(foot_t), intent(in) :: foot
    real(wp), intent(in) :: normal(2), length
    real(wp) :: share

    share = facing_share(dot_product(normal, foot%normal))
    if (.not. share > 0.0_wp) return
    call add_segment_point(contact%master, memory%n_slave, ends, memory%spot_xi(q), foot, &
      memory%points)
    memory%points%area(memory%points%n) = share*memory%spot_share(q)*length
    memory%points%stiffness(memory%points%n) = memory%slave_penalty
  end subroutine add_foot

end module points_mortar_m
