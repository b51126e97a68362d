! SPDX-License-Identifier: MIT
!> Type 4, VTS-PPT (virtual-slave-node-to-segment): the gap of a virtual slave node in the middle of
!> each half of a slave segment, its force handed to the master by the portions that the half
!> covers, at the centre of each (Zavarise & De Lorenzis 2009; doc/theory/contact.md, section 5.4).
!> All portions have the gap and the normal of the virtual node, so P2 holds for directions only in
!> parallel: the net moment is not exactly zero on a kinked master.
module place_vts_ppt_m
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use foot_m, only : foot_t, mark_t, see_segment, walk_to_mark, round_off
  use geometry_m, only : sight_t, segment_length, separation
  use kinds_m, only : wp
  use point_list_m, only : add_point
  use radii_m, only : centroid, radius_between
  implicit none
  private
  public :: place_vts_ppt, end_of_half

contains

  !> Place the points of all virtual nodes in contact.
  pure subroutine place_vts_ppt(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer :: k

    do k = 1, memory%slave_tracking%n_touching
      call add_portions(contact, memory%slave_tracking%touching(k), memory)
    end do
  end subroutine place_vts_ppt

  !> The portions of a virtual node, from the master segment below the later end of its half to that
  !> below the earlier one; they share the half by their lengths, in axisymmetry by their areas.
  pure subroutine add_portions(contact, spot, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: spot !! virtual node
    type(contact_state_t), intent(inout) :: memory
    type(mark_t) :: marks(2)
    type(foot_t) :: foot
    real(wp) :: a(4), b(4), at, xi, half
    integer :: ends(2), segment, first, i

    ends = contact%slave%segments(:, (spot + 1)/2)
    a = memory%places(:, ends(1))
    b = memory%places(:, ends(2))
    at = memory%spot_xi(2 - mod(spot, 2))
    marks = marks_of_half(contact, memory, spot, a, b, at)
    xi = at
    half = 0.5_wp*segment_length(a, b)
    if (contact%is_round) then
      xi = centroid(a, b, end_of_half(at, 2), end_of_half(at, 1))
      half = half*radius_between(a, b, at)
    end if
    foot%gap = memory%slave_tracking%gap(spot)
    foot%normal = memory%slave_tracking%normal(:, spot)
    first = memory%points%n + 1
    segment = marks(1)%segment
    do i = marks(1)%n_step, marks(2)%n_step
      call add_portion(contact, ends, xi, segment, [merge(marks(1)%xi, 0.0_wp, &
        i == marks(1)%n_step), merge(marks(2)%xi, 1.0_wp, i == marks(2)%n_step)], foot, memory)
      segment = contact%master%next(segment)
      ! Marks of displacements beyond all bounds need not lie on one chain.
      if (segment == 0) exit
    end do
    associate (points => memory%points)
      if (points%n < first) then
        foot%xi = memory%slave_tracking%xi(spot)
        call add_point(points, ends, xi, memory%n_slave + contact%master%segments(:, &
          memory%slave_tracking%segment(spot)), foot, half, memory%slave_penalty)
      else
        half = half/sum(points%area(first:points%n))
        do i = first, points%n
          points%area(i) = half*points%area(i)
        end do
      end if
    end associate
  end subroutine add_portions

  !> Where both ends of the half of a virtual node are on the master: on the segment below the
  !> virtual node, or where a walk from there leads.
  pure function marks_of_half(contact, memory, spot, a, b, at) result(marks)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: spot
    real(wp), intent(in) :: a(4), b(4) !! ends of the slave segment
    real(wp), intent(in) :: at         !! where the virtual node is on that
    type(mark_t) :: marks(2)
    type(sight_t) :: sight
    real(wp) :: slope
    integer :: k

    associate (segment => memory%slave_tracking%segment(spot), &
      chain => memory%places(:, memory%n_slave + 1:))
      sight = see_segment(contact%master, chain, (1.0_wp - at)*a + at*b, segment)
      slope = dot_product(separation(b, a), sight%t)
      do k = 1, 2
        marks(k)%segment = segment
        marks(k)%xi = (sight%along + (end_of_half(at, k) - at)*slope)/sight%square
      end do
      if (all(abs(marks%xi - 0.5_wp) <= 0.5_wp)) return
      do k = 1, 2
        slope = end_of_half(at, k)
        marks(k) = walk_to_mark(contact%master, chain, (1.0_wp - slope)*a + slope*b, segment)
      end do
    end associate
  end function marks_of_half

  !> Append a portion of a half with its own length as area: it has the gap and the normal of the
  !> virtual node, and its place on the master is its centre, in axisymmetry by radius.
  pure subroutine add_portion(contact, ends, xi, segment, range, foot, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: ends(2)        !! nodes of the slave segment
    real(wp), intent(in) :: xi            !! place of the virtual node on that
    integer, intent(in) :: segment        !! of the master
    real(wp), intent(in) :: range(2)      !! of that
    type(foot_t), intent(inout) :: foot   !! gap and normal
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: length
    integer :: nodes(2)

    if (.not. range(2) - range(1) > round_off) return
    nodes = memory%n_slave + contact%master%segments(:, segment)
    associate (a => memory%places(:, nodes(1)), b => memory%places(:, nodes(2)))
      foot%xi = 0.5_wp*(range(1) + range(2))
      length = (range(2) - range(1))*segment_length(a, b)
      if (contact%is_round) then
        length = length*radius_between(a, b, foot%xi)
        foot%xi = centroid(a, b, range(1), range(2))
      end if
    end associate
    call add_point(memory%points, ends, xi, nodes, foot, length, memory%slave_penalty)
  end subroutine add_portion

  !> Ends of a half segment, the later one first: the slave runs against the master.
  pure function end_of_half(xi, k)
    real(wp), intent(in) :: xi !! of the virtual node
    integer, intent(in) :: k
    real(wp) :: end_of_half

    end_of_half = xi + (1.5_wp - k)*0.5_wp
  end function end_of_half

end module place_vts_ppt_m
