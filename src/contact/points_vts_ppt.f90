! SPDX-License-Identifier: MIT
!> Type 4, VTS-PPT (virtual-slave-node-to-segment): the gap of a virtual slave node in the middle of each half of a slave
!> segment, its force handed to the master by the portions that the half covers, at the centre of each
!> (Zavarise & De Lorenzis 2009; doc/theory/contact.md, section 5.4).
!> All portions have the gap and the normal of the virtual node, so P2 holds for directions only in parallel: the net
!> moment is not exactly zero on a kinked master.
module points_vts_ppt_m
  use contact_placing_m, only : add_plain_point, place_on_segment
  use contact_portions_m, only : mark_t, walk_from
  use contact_state_m, only : contact_state_t, make_room
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, sight_of_segment, segment_length
  use kinds_m, only : wp
  implicit none
  private
  public :: place_vts_ppt

contains

  !> Place the points.
  pure subroutine place_vts_ppt(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer :: k

    do k = 1, memory%slave_tracking%n_touching
      call add_portions(contact, memory, memory%slave_tracking%touching(k))
    end do
  end subroutine place_vts_ppt

  !> The points of one virtual node.
  pure subroutine add_portions(contact, memory, spot)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: spot
    type(mark_t) :: marks(2)
    type(sight_t) :: sights(2)
    real(wp) :: xi, half, low, high
    integer :: ends(2), start, segment, n_before, k

    ends = contact%slave%segments(:, (spot + 1)/2)
    xi = memory%spot_xi(2 - mod(spot, 2))
    half = 0.5_wp*segment_length(memory%places(:, ends(1)), memory%places(:, ends(2)))
    start = memory%slave_tracking%segment(spot)
    call see_ends(contact, memory, ends, xi, start, sights)
    if (all(sights%along >= 0.0_wp .and. sights%along <= sights%square) .and. &
      sights(2)%along > sights(1)%along) then
      call add_part(contact, memory, spot, ends, start, 0.5_wp*(sights(1)%along + sights(2)%along) &
        /sights(1)%square, half)
      return
    end if
    do k = 1, 2
      marks(k) = walk_from(contact%master, memory%places(:, memory%n_slave + 1:), &
        place_on_segment(memory%places, ends, end_of_half(xi, k)), start, sights(k))
    end do
    n_before = memory%points%n
    segment = marks(1)%segment
    do k = 0, marks(2)%n_step - marks(1)%n_step
      low = merge(marks(1)%xi, 0.0_wp, k == 0)
      high = merge(marks(2)%xi, 1.0_wp, segment == marks(2)%segment)
      if (high > low) call add_portion(contact, memory, spot, ends, segment, low, high)
      segment = contact%master%next(segment)
    end do
    if (memory%points%n == n_before) call add_portion(contact, memory, spot, ends, start, &
      memory%slave_tracking%xi(spot) - 0.5_wp, memory%slave_tracking%xi(spot) + 0.5_wp)
    associate (area => memory%points%area(n_before + 1:memory%points%n))
      area = area*(half/sum(area))
    end associate
  end subroutine add_portions

  !> Ends of a half segment, the later one first: the slave runs against the master.
  pure function end_of_half(xi, k)
    real(wp), intent(in) :: xi !! of the virtual node
    integer, intent(in) :: k
    real(wp) :: end_of_half

    end_of_half = xi + (1.5_wp - k)*0.5_wp
  end function end_of_half

  !> Both ends of a half segment, seen from a master segment.
  pure subroutine see_ends(contact, memory, ends, xi, segment, sights)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)   !! nodes of the slave segment
    real(wp), intent(in) :: xi       !! of the virtual node
    integer, intent(in) :: segment   !! of the master
    type(sight_t), intent(out) :: sights(2)
    integer :: k, a, b

    a = memory%n_slave + contact%master%segments(1, segment)
    b = memory%n_slave + contact%master%segments(2, segment)
    do k = 1, 2
      sights(k) = sight_of_segment(place_on_segment(memory%places, ends, end_of_half(xi, k)), &
        memory%places(:, a), memory%places(:, b))
    end do
  end subroutine see_ends

  !> One portion: from `low` to `high` on a master segment, whose centre takes the force; area = its length until all are known.
  pure subroutine add_portion(contact, memory, spot, ends, segment, low, high)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: spot, ends(2)
    integer, intent(in) :: segment     !! of the master
    real(wp), intent(in) :: low, high
    real(wp) :: length

    associate (nodes => contact%master%segments(:, segment))
      length = segment_length(memory%places(:, memory%n_slave + nodes(1)), &
        memory%places(:, memory%n_slave + nodes(2)))
    end associate
    call add_part(contact, memory, spot, ends, segment, 0.5_wp*(low + high), (high - low)*length)
  end subroutine add_portion

  !> A point with the gap and the normal of the virtual node and a place of its own on the master.
  pure subroutine add_part(contact, memory, spot, ends, segment, master_xi, area)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: spot            !! the virtual node
    integer, intent(in) :: ends(2)         !! nodes of its slave segment
    integer, intent(in) :: segment         !! of the master
    real(wp), intent(in) :: master_xi      !! place on that
    real(wp), intent(in) :: area           !! m
    integer :: nodes(2)

    if (memory%points%n == size(memory%points%gap)) call make_room(memory%points, 1)
    nodes = memory%n_slave + contact%master%segments(:, segment)
    associate (tracking => memory%slave_tracking, points => memory%points)
      call add_plain_point(ends, memory%spot_xi(2 - mod(spot, 2)), nodes, master_xi, &
        tracking%normal(:, spot), tracking%gap(spot), points)
      points%area(points%n) = area
      points%stiffness(points%n) = memory%slave_penalty
    end associate
  end subroutine add_part

end module points_vts_ppt_m
