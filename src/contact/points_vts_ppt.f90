! SPDX-License-Identifier: MIT
!> Type 4, VTS-PPT (virtual-slave-node-to-segment): the gap of a virtual slave node in the middle of
!> each half of a slave segment, its force handed to the master by the portions that the half
!> covers, at the centre of each (Zavarise & De Lorenzis 2009; doc/theory/contact.md, section 5.4).
!> All portions have the gap and the normal of the virtual node, so P2 holds for directions only in
!> parallel: the net moment is not exactly zero on a kinked master.
module points_vts_ppt_m
  use contact_placing_m, only : add_plain_point, place_on_segment
  use contact_halves_m, only : halves_t, sights_t, list_halves, see_segments, place_halves, &
    find_sight
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

contains

  !> Place the points of the virtual nodes `start` to `last` of those in contact: one portion for a
  !> half with both ends over the same master segment, two where a master node lies between them;
  !> whatever else needs a decision goes through `add_portions`.
  pure subroutine place_vts_ppt(contact, start, last, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: start, last !! on the list of those in contact
    type(contact_state_t), intent(inout) :: memory
    type(halves_t) :: halves
    type(sights_t) :: sights
    integer :: first, n_pair, pairs(n_room)

    do first = start, last, n_room
      call list_halves(min(n_room, last - first + 1), &
        memory%slave_tracking%touching(first:), memory%slave_tracking%segment, &
        contact%slave%segments, halves, sights)
      call see_segments(contact, memory, sights)
      call place_halves(sights, halves)
      call list_pairs(contact, memory, halves, sights, n_pair, pairs)
      call see_segments(contact, memory, sights)
      call take_pairs(contact, memory, sights, n_pair, pairs, halves)
      call add_halves(memory, halves, sights)
    end do
  end subroutine place_vts_ppt

  !> List the halves that cover two master segments.
  pure subroutine list_pairs(contact, memory, halves, sights, n_pair, pairs)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(halves_t), intent(inout) :: halves
    type(sights_t), intent(inout) :: sights
    integer, intent(out) :: n_pair, pairs(n_room)
    integer :: i, k, n, side, segment, odd(n_room + 1)

    n = 0
    do k = 1, halves%n
      odd(n + 1) = k
      n = n + merge(0, 1, halves%lies_on_one(k) > 0.0_wp)
    end do
    n_pair = 0
    do i = 1, n
      k = odd(i)
      segment = 0
      associate (j => halves%sight(k, 1), low => halves%low(k), high => halves%high(k))
        side = 0
        if (low < 0.0_wp .and. high > 0.0_wp .and. high < 1.0_wp) then
          segment = contact%master%previous(sights%master(j))
          side = 1
        else if (high > 1.0_wp .and. low > 0.0_wp .and. low < 1.0_wp) then
          segment = contact%master%next(sights%master(j))
          side = 2
        end if
      end associate
      if (segment > 0) then
        n_pair = n_pair + 1
        pairs(n_pair) = k
        associate (j => halves%sight(k, 3 - side))
          call find_sight(j, segment, j + 3 - 2*side, sights, halves%sight(k, side))
        end associate
      else
        halves%n_part(k) = 0
        call add_portions(contact, memory, halves%spot(k))
      end if
    end do
  end subroutine list_pairs

  !> Two portions for each half with a master node between its ends.
  pure subroutine take_pairs(contact, memory, sights, n_pair, pairs, halves)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(sights_t), intent(in) :: sights
    integer, intent(in) :: n_pair, pairs(n_pair)
    type(halves_t), intent(inout) :: halves
    real(wp) :: low, high, one, two, scale, product
    integer :: i, k

    do i = 1, n_pair
      k = pairs(i)
      associate (before => halves%sight(k, 1), after => halves%sight(k, 2))
        low = sights%place(before, halves%side(k) + 1)
        high = sights%place(after, halves%side(k))
        one = (1.0_wp - low)*sights%length(before)
        two = high*sights%length(after)
        product = sights%other(1, before)*sights%other(1, after) &
          + sights%other(2, before)*sights%other(2, after)
        if (min(low, 1.0_wp - low, high, 1.0_wp - high) > 0.0_wp &
          .and. product >= gentle_turn*sights%length(before)*sights%length(after)) then
          scale = halves%area(k, 1)/(one + two)
          halves%n_part(k) = 2
          halves%foot(k, 1) = 0.5_wp*(low + 1.0_wp)
          halves%foot(k, 2) = 0.5_wp*high
          halves%area(k, 1) = one*scale
          halves%area(k, 2) = two*scale
        else
          halves%n_part(k) = 0
          call add_portions(contact, memory, halves%spot(k))
        end if
      end associate
    end do
  end subroutine take_pairs

  !> Append the points of the portions.
  pure subroutine add_halves(memory, halves, sights)
    type(contact_state_t), intent(inout) :: memory
    type(halves_t), intent(in) :: halves
    type(sights_t), intent(in) :: sights
    integer :: n

    n = sum(halves%n_part(:halves%n))
    ! Two more: `put_sides` and `put_springs` write two for each half, also for a last one that has
    ! none.
    call make_room(memory%points, n + 2)
    associate (points => memory%points, tracking => memory%slave_tracking, p => memory%points%n + 1)
      call put_sides(halves, sights, memory%spot_xi, points%slave_nodes(1, p), &
        points%slave_weights(1, p), points%master_nodes(1, p), points%master_weights(1, p))
      call put_springs(halves, tracking%normal, tracking%gap, points%normal(1, p), points%gap(p), &
        points%area(p))
      points%stiffness(p:points%n + n) = memory%slave_penalty
      points%n = points%n + n
    end associate
  end subroutine add_halves

  !> Both sides of these points. Two are written for each half, and the next half starts where those
  !> that count end: a decision at each half costs more.
  pure subroutine put_sides(halves, sights, spot_xi, slave_nodes, slave_weights, master_nodes, &
    master_weights)
    type(halves_t), intent(in) :: halves
    type(sights_t), intent(in) :: sights
    real(wp), intent(in) :: spot_xi(2)
    integer, dimension(n_side, *), intent(inout) :: slave_nodes, master_nodes
    real(wp), dimension(n_side, *), intent(inout) :: slave_weights, master_weights
    real(wp) :: weights(2, 2)
    integer :: p, k, q

    weights(1, :) = 1.0_wp - spot_xi
    weights(2, :) = spot_xi
    p = 1
    do k = 1, halves%n
      do q = 0, 1
        associate (own => halves%sight(k, 1), j => halves%sight(k, 1 + q), side => halves%side(k))
          slave_nodes(1, p + q) = sights%ends(1, own)
          slave_nodes(2, p + q) = sights%ends(2, own)
          slave_weights(1, p + q) = weights(1, side)
          slave_weights(2, p + q) = weights(2, side)
          master_nodes(1, p + q) = sights%nodes(1, j)
          master_nodes(2, p + q) = sights%nodes(2, j)
          master_weights(1, p + q) = 1.0_wp - halves%foot(k, 1 + q)
          master_weights(2, p + q) = halves%foot(k, 1 + q)
        end associate
      end do
      p = p + halves%n_part(k)
    end do
  end subroutine put_sides

  !> Normals and gaps (m), which are those of the virtual nodes, and areas (m).
  pure subroutine put_springs(halves, normals, gaps, normal, gap, area)
    type(halves_t), intent(in) :: halves
    real(wp), intent(in) :: normals(2, *), gaps(*)
    real(wp), intent(inout) :: normal(2, *), gap(*), area(*)
    integer :: p, k, q

    p = 1
    do k = 1, halves%n
      do q = 1, 2
        normal(1, p + q - 1) = normals(1, halves%spot(k))
        normal(2, p + q - 1) = normals(2, halves%spot(k))
        gap(p + q - 1) = gaps(halves%spot(k))
        area(p + q - 1) = halves%area(k, q)
      end do
      p = p + halves%n_part(k)
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

  !> One portion: from `low` to `high` on a master segment, whose centre takes the force; area = its
  !> length until all are known.
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
