! SPDX-License-Identifier: MIT
!> Type 6, mortar: Gauss points on each whole slave segment, pressure from the slave nodes
!> (doc/theory/contact.md, section 5.6).
module place_mortar_m
  use contact_state_m, only : contact_state_t, tracking_t, is_touching
  use contacts_m, only : contact_t
  use foot_m, only : foot_t, near_foot
  use geometry_m, only : segment_length
  use kinds_m, only : wp
  use overlaps_m, only : closest_candidate
  use point_list_m, only : add_point, finish_segment_points
  use tips_m, only : has_folds, find_tips, belongs_to
  implicit none
  private
  public :: place_mortar

contains

  !> Place the points of all segments that share a node with one in contact: these decide on nodal
  !> pressures.
  pure subroutine place_mortar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer :: s, near, first

    if (memory%slave_tracking%n_touching == 0) return
    if (has_folds(contact)) call find_tips(contact%slave, memory)
    call mark_ends(memory%slave_tracking, size(memory%spot_xi), contact%slave%segments, &
      memory%scratch%segment_near)
    do s = 1, contact%slave%n_segment
      near = max(memory%scratch%segment_near(contact%slave%segments(1, s)), &
        memory%scratch%segment_near(contact%slave%segments(2, s)))
      if (near == 0) cycle
      first = memory%points%n + 1
      call add_segment(contact, s, near, memory)
      if (has_folds(contact)) call move_to_ends(first, memory)
    end do
    call finish_segment_points(memory%places, contact%is_round, 1, memory%points)
    memory%scratch%segment_near = 0
  end subroutine place_mortar

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

  !> The Gauss points of a segment, with areas as if it were opposed to the master entirely: below
  !> zero of those that are let go or have no projection.
  pure subroutine add_segment(contact, s, near, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: s
    integer, intent(in) :: near !! a master segment close by
    type(contact_state_t), intent(inout) :: memory
    type(foot_t) :: foot
    real(wp) :: length
    integer :: ends(2), nodes(2), q, i

    ends = contact%slave%segments(:, s)
    length = segment_length(memory%places(:, ends(1)), memory%places(:, ends(2)))
    do q = 1, size(memory%spot_xi)
      i = (s - 1)*size(memory%spot_xi) + q
      associate (tracking => memory%slave_tracking)
        if (tracking%status(i) == is_touching) then
          foot%segment = tracking%segment(i)
          foot%is_on = .true.
          foot%xi = tracking%xi(i)
          foot%gap = tracking%gap(i)
          foot%normal = tracking%normal(:, i)
        else
          foot = find_foot(contact, memory, s, near, memory%spots(:, i))
        end if
      end associate
      nodes = memory%n_slave + contact%master%segments(:, foot%segment)
      call add_point(memory%points, ends, memory%spot_xi(q), nodes, foot, &
        merge(memory%spot_share(q)*length, -1.0_wp, foot%is_on), memory%slave_penalty)
    end do
  end subroutine add_segment

  !> Projection of a separated point: it stands in front of what it is over, if at all.
  pure function find_foot(contact, memory, s, near, point) result(foot)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s          !! slave segment
    integer, intent(in) :: near       !! master segment to start from where there is no candidate
    real(wp), intent(in) :: point(4)
    type(foot_t) :: foot
    integer :: closest

    closest = closest_candidate(contact, memory, s, point, .false.)
    if (closest == 0) closest = near
    foot = near_foot(contact%master, memory%places(:, memory%n_slave + 1:), point, closest)
    foot%is_on = foot%is_on .and. .not. foot%gap < 0.0_wp
  end function find_foot

  !> At the tip of a fold the points at the nodes of a segment take over what the others are to give
  !> way, as far as they have a projection.
  pure subroutine move_to_ends(first, memory)
    integer, intent(in) :: first !! of the points of the segment, the last ones on the list
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: part(2), length
    integer :: k, p

    associate (points => memory%points, ends => memory%points%slave_nodes(:, first))
      part = maxval(memory%scratch%nodal(1, ends))
      if (.not. part(1) > 0.0_wp) return
      do k = 1, 2
        p = merge(first, points%n, k == 1)
        if (points%slave_weights(k, p) < 1.0_wp .or. points%area(p) < 0.0_wp &
          .or. belongs_to(memory%nodes, ends(k), points%master_nodes(:, p))) part(k) = 0.0_wp
      end do
      do p = first, points%n
        points%area(p) = points%area(p)*(1.0_wp - dot_product(part, points%slave_weights(:, p)))
      end do
      length = segment_length(memory%places(:, ends(1)), memory%places(:, ends(2)))
      if (part(1) > 0.0_wp) points%area(first) = 0.5_wp*part(1)*length
      if (part(2) > 0.0_wp) points%area(points%n) = 0.5_wp*part(2)*length
    end associate
  end subroutine move_to_ends

end module place_mortar_m
