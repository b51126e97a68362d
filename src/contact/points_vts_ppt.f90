! SPDX-License-Identifier: MIT
!> Type 4, VTS-PPT (virtual-slave-node-to-segment): the gap of a virtual slave node in the middle of each half of a slave
!> segment, its force handed to the master by the portions that the half covers, at the centre of each
!> (Zavarise & De Lorenzis 2009; doc/theory/contact.md, section 5.4).
!> All portions have the gap and the normal of the virtual node, so P2 holds for directions only in parallel: the net
!> moment is not exactly zero on a kinked master.
module points_vts_ppt_m
  use contact_placing_m, only : add_plain_point, place_on_segment
  use contact_halves_m, only : halves_t, take_half, see_halves
  use contact_plain_cover_m, only : n_room
  use contact_portions_m, only : mark_t, walk_to_mark
  use contact_projection_m, only : gentle_turn
  use contact_state_m, only : contact_state_t, make_room, n_side
  use contacts_m, only : contact_t
  use geometry_m, only : segment_length
  use kinds_m, only : wp
  implicit none
  private
  public :: place_vts_ppt

  !> Portions of half segments.
  type :: parts_t
    integer :: n
    integer :: spot(2*n_room)       !! virtual node
    integer :: ends(2, 2*n_room)    !! nodes of its slave segment
    integer :: nodes(2, 2*n_room)   !! local numbers of the nodes of the master segment
    real(wp) :: foot(2*n_room)      !! centre of the portion on that
    real(wp) :: area(2*n_room)      !! m
  end type parts_t

contains

  !> Place the points.
  pure subroutine place_vts_ppt(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(halves_t) :: halves
    integer :: first, k, spot

    do first = 1, memory%slave_tracking%n_touching, n_room
      halves%n = min(n_room, memory%slave_tracking%n_touching - first + 1)
      do k = 1, halves%n
        spot = memory%slave_tracking%touching(first + k - 1)
        call take_half(contact, memory, spot, memory%slave_tracking%segment(spot), halves, k)
      end do
      call see_halves(contact, memory, halves)
      call add_halves(contact, memory, halves)
    end do
  end subroutine place_vts_ppt

  !> The points of these half segments: one where both ends are over the same master segment, two where a master node lies
  !> between them; whatever else needs a decision goes through `add_portions`.
  pure subroutine add_halves(contact, memory, halves)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(halves_t), intent(in) :: halves
    type(halves_t) :: befores, afters
    type(parts_t) :: parts
    integer :: k, before, after

    parts%n = 0
    befores%n = 0
    do k = 1, halves%n
      if (halves%low(k) >= 0.0_wp .and. halves%high(k) <= 1.0_wp &
        .and. halves%high(k) > halves%low(k)) then
        parts%n = parts%n + 1
        call put_part(halves, k, 0.5_wp*(halves%low(k) + halves%high(k)), halves%half(k), parts%n, parts)
        cycle
      end if
      before = 0
      after = 0
      if (halves%low(k) < 0.0_wp .and. halves%high(k) > 0.0_wp .and. halves%high(k) < 1.0_wp) then
        after = halves%master(k)
        before = contact%master%previous(after)
      else if (halves%high(k) > 1.0_wp .and. halves%low(k) > 0.0_wp .and. halves%low(k) < 1.0_wp) then
        before = halves%master(k)
        after = contact%master%next(before)
      end if
      if (before > 0 .and. after > 0) then
        befores%n = befores%n + 1
        call take_half(contact, memory, halves%spot(k), before, befores, befores%n)
        call take_half(contact, memory, halves%spot(k), after, afters, befores%n)
        befores%part(befores%n) = parts%n + 1
        parts%n = parts%n + 2
      else
        call add_portions(contact, memory, halves%spot(k))
      end if
    end do
    afters%n = befores%n
    call see_halves(contact, memory, befores)
    call see_halves(contact, memory, afters)
    call take_pairs(contact, memory, befores, afters, parts)
    call add_parts(memory, parts)
  end subroutine add_halves

  !> Two portions for each half segment with a master node between its ends.
  pure subroutine take_pairs(contact, memory, befores, afters, parts)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(halves_t), intent(in) :: befores, afters !! the halves, seen from the segments on either side of the node
    type(parts_t), intent(inout) :: parts
    real(wp) :: one, two, scale, product
    integer :: k, n_lost

    n_lost = 0
    do k = 1, befores%n
      one = (1.0_wp - befores%low(k))*befores%length(k)
      two = afters%high(k)*afters%length(k)
      product = befores%other(1, k)*afters%other(1, k) + befores%other(2, k)*afters%other(2, k)
      if (min(befores%low(k), 1.0_wp - befores%low(k), afters%high(k), 1.0_wp - afters%high(k)) > 0.0_wp &
        .and. product >= gentle_turn*befores%length(k)*afters%length(k)) then
        scale = befores%half(k)/(one + two)
        call put_part(befores, k, 0.5_wp*(befores%low(k) + 1.0_wp), one*scale, befores%part(k), parts)
        call put_part(afters, k, 0.5_wp*afters%high(k), two*scale, befores%part(k) + 1, parts)
      else
        parts%spot(befores%part(k):befores%part(k) + 1) = 0
        n_lost = n_lost + 1
        call add_portions(contact, memory, befores%spot(k))
      end if
    end do
    if (n_lost > 0) call close_ranks(parts)
  end subroutine take_pairs

  !> Drop the portions without a spot.
  pure subroutine close_ranks(parts)
    type(parts_t), intent(inout) :: parts
    integer, allocatable :: kept(:)
    integer :: p, n

    kept = pack([(p, p=1, parts%n)], parts%spot(:parts%n) > 0)
    n = size(kept)
    parts%n = n
    parts%spot(:n) = parts%spot(kept)
    parts%ends(:, :n) = parts%ends(:, kept)
    parts%nodes(:, :n) = parts%nodes(:, kept)
    parts%foot(:n) = parts%foot(kept)
    parts%area(:n) = parts%area(kept)
  end subroutine close_ranks

  !> Put a portion at a place of the list.
  pure subroutine put_part(halves, k, foot, area, p, parts)
    type(halves_t), intent(in) :: halves
    integer, intent(in) :: k
    real(wp), intent(in) :: foot, area
    integer, intent(in) :: p
    type(parts_t), intent(inout) :: parts

    parts%spot(p) = halves%spot(k)
    parts%ends(1, p) = halves%ends(1, k)
    parts%ends(2, p) = halves%ends(2, k)
    parts%nodes(1, p) = halves%nodes(1, k)
    parts%nodes(2, p) = halves%nodes(2, k)
    parts%foot(p) = foot
    parts%area(p) = area
  end subroutine put_part

  !> Append the points of the portions on a list.
  pure subroutine add_parts(memory, parts)
    type(contact_state_t), intent(inout) :: memory
    type(parts_t), intent(in) :: parts

    if (parts%n == 0) return
    call make_room(memory%points, parts%n)
    associate (points => memory%points, tracking => memory%slave_tracking, p => memory%points%n + 1)
      call put_sides(parts, memory%spot_xi, points%slave_nodes(1, p), points%slave_weights(1, p), &
        points%master_nodes(1, p), points%master_weights(1, p))
      call put_springs(parts, tracking%normal, tracking%gap, points%normal(1, p), points%gap(p), &
        points%area(p))
      points%stiffness(p:points%n + parts%n) = memory%slave_penalty
      points%n = points%n + parts%n
    end associate
  end subroutine add_parts

  !> Both sides of these points.
  pure subroutine put_sides(parts, spot_xi, slave_nodes, slave_weights, master_nodes, master_weights)
    type(parts_t), intent(in) :: parts
    real(wp), intent(in) :: spot_xi(2)
    integer, dimension(n_side, parts%n), intent(inout) :: slave_nodes, master_nodes
    real(wp), dimension(n_side, parts%n), intent(inout) :: slave_weights, master_weights
    real(wp) :: xi
    integer :: p

    !GCC$ NOVECTOR
    do p = 1, parts%n
      xi = spot_xi(2 - mod(parts%spot(p), 2))
      slave_nodes(1, p) = parts%ends(1, p)
      slave_nodes(2, p) = parts%ends(2, p)
      slave_weights(1, p) = 1.0_wp - xi
      slave_weights(2, p) = xi
      master_nodes(1, p) = parts%nodes(1, p)
      master_nodes(2, p) = parts%nodes(2, p)
      master_weights(1, p) = 1.0_wp - parts%foot(p)
      master_weights(2, p) = parts%foot(p)
    end do
  end subroutine put_sides

  !> Normals and gaps (m), which are those of the virtual nodes, and areas (m).
  pure subroutine put_springs(parts, normals, gaps, normal, gap, area)
    type(parts_t), intent(in) :: parts
    real(wp), intent(in) :: normals(2, *), gaps(*)
    real(wp), intent(inout) :: normal(2, parts%n), gap(parts%n), area(parts%n)
    integer :: p

    !GCC$ NOVECTOR
    do p = 1, parts%n
      normal(1, p) = normals(1, parts%spot(p))
      normal(2, p) = normals(2, parts%spot(p))
      gap(p) = gaps(parts%spot(p))
      area(p) = parts%area(p)
    end do
  end subroutine put_springs

  !> The points of one virtual node.
  pure subroutine add_portions(contact, memory, spot)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: spot
    type(mark_t) :: marks(2)
    real(wp) :: xi, half, low, high
    integer :: ends(2), start, segment, n_before, k

    ends = contact%slave%segments(:, (spot + 1)/2)
    xi = memory%spot_xi(2 - mod(spot, 2))
    half = 0.5_wp*segment_length(memory%places(:, ends(1)), memory%places(:, ends(2)))
    start = memory%slave_tracking%segment(spot)
    do k = 1, 2
      marks(k) = walk_to_mark(contact%master, memory%places(:, memory%n_slave + 1:), &
        place_on_segment(memory%places, ends, end_of_half(xi, k)), start)
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
