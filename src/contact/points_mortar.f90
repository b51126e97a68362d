! SPDX-License-Identifier: MIT
!> Type 6, mortar: Gauss points on each whole slave segment, pressure from the slave nodes
!> (doc/theory/contact.md, section 5.6).
module points_mortar_m
  use contact_overlap_m, only : local_foot, facing_share
  use contact_placing_m, only : add_segment_point, tracked_foot
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
    integer :: k, s, n_per_segment, near

    if (memory%slave_tracking%n_touching == 0) return
    n_per_segment = size(memory%spot_xi)
    do k = 1, memory%slave_tracking%n_touching
      s = 1 + (memory%slave_tracking%touching(k) - 1)/n_per_segment
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
    real(wp) :: share
    integer :: q, i, start, ends(2)

    call make_room(memory%points, size(memory%spot_xi))
    ends = contact%slave%segments(:, s)
    do q = 1, size(memory%spot_xi)
      i = (s - 1)*size(memory%spot_xi) + q
      sight = sight_of_segment(memory%spots(:, i), memory%places(:, ends(1)), &
        memory%places(:, ends(2)))
      associate (tracking => memory%slave_tracking)
        if (tracking%status(i) == is_behind) cycle
        if (tracking%status(i) == is_touching) then
          foot = tracked_foot(tracking, i)
        else
          start = tracking%segment(i)
          if (start == 0) start = near
          foot = local_foot(contact, memory, memory%spots(:, i), start)
        end if
      end associate
      if (.not. foot%is_on) cycle
      share = facing_share(dot_product(sight_normal(sight), foot%normal))
      if (.not. share > 0.0_wp) cycle
      call add_segment_point(contact%master, memory%n_slave, ends, memory%spot_xi(q), foot, &
        memory%points)
      memory%points%area(memory%points%n) = share*memory%spot_share(q)*sqrt(sight%square)
      memory%points%stiffness(memory%points%n) = memory%slave_penalty
    end do
  end subroutine add_gauss_points

end module points_mortar_m
