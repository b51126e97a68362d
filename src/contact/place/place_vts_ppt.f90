! SPDX-License-Identifier: MIT
!> Type 4, VTS-PPT (virtual-slave-node-to-segment): the gap of a virtual slave node in the middle of
!> each half of a slave segment, its force handed to the master by the portions that the half
!> covers, at the centre of each (Zavarise & De Lorenzis 2009; doc/theory/contact.md, section 5.4).
!> All portions have the gap and the normal of the virtual node, so P2 holds for directions only in
!> parallel: the net moment is not exactly zero on a kinked master.
module place_vts_ppt_m
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use foot_block_m, only : n_block
  use foot_m, only : mark_t, walk_to_mark, gentle_turn, round_off
  use geometry_m, only : segment_length
  use kinds_m, only : wp
  use point_list_m, only : place_block_t, append_points
  use radii_m, only : centroid, radius_between
  implicit none
  private
  public :: place_vts_ppt, end_of_half

  !> Half segments and where their ends are on the master segment below their virtual nodes. Without
  !> default values, which would be written before each use.
  type :: halves_t
    integer :: n
    integer :: spot(n_block)      !! virtual node
    integer :: ends(2, n_block)   !! nodes of its slave segment
    integer :: nodes(2, n_block)  !! local numbers of those of its master segment
    integer :: master(n_block)    !! segment below it
    real(wp) :: own(2, n_block)   !! vector of the slave segment, m
    real(wp) :: t(2, n_block)     !! vector of the master segment, m
    real(wp) :: d(2, n_block)     !! from that one's first node to the virtual node, m
    real(wp) :: low(n_block)      !! where the later end is on it: the slave runs against the master
    real(wp) :: high(n_block)     !! where the earlier end is
    real(wp) :: length(n_block)   !! of the master segment, m
    real(wp) :: half(n_block)     !! of the slave segment's length, m
    real(wp) :: xi(n_block)       !! place of the virtual node on its slave segment
    real(wp) :: gap(n_block)      !! its gap, m
    real(wp) :: normal(2, n_block) !! its normal
  end type halves_t

contains

  !> Place the points of all virtual nodes in contact.
  pure subroutine place_vts_ppt(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(halves_t) :: halves
    type(place_block_t) :: block
    integer :: first, n, k

    block%n = 0
    if (contact%is_round) then
      call place_by_radius(contact, memory, block)
      return
    end if
    do first = 1, memory%slave_tracking%n_touching, n_block
      n = min(n_block, memory%slave_tracking%n_touching - first + 1)
      halves%n = n
      halves%spot(:n) = memory%slave_tracking%touching(first:first + n - 1)
      call see_halves(n, halves%spot, memory%slave_tracking%segment, contact%slave%segments, &
        contact%master%segments, memory%n_slave, memory%places, memory%spots, halves)
      associate (tracking => memory%slave_tracking)
        call take_feet(n, halves%spot, tracking%gap, tracking%normal, memory%spot_xi, halves)
      end associate
      call project_ends(n, halves%own, halves%t, halves%d, halves%low, halves%high, halves%length, &
        halves%half)
      do k = 1, n
        if (block%n + 2 > n_block) &
          call append_points(block, memory%slave_penalty, memory%points)
        if (halves%low(k) >= -round_off .and. halves%high(k) <= 1.0_wp + round_off &
          .and. halves%high(k) > halves%low(k)) then
          call put_portion(halves, k, halves%nodes(:, k), 0.5_wp*(halves%low(k) &
            + halves%high(k)), halves%half(k), block)
        else
          call add_portions(contact, memory, halves, k, block)
        end if
      end do
    end do
    call append_points(block, memory%slave_penalty, memory%points)
  end subroutine place_vts_ppt

  !> The same in axisymmetry: weights by radius, virtual nodes and points of portions at centres by
  !> radius.
  pure subroutine place_by_radius(contact, memory, block)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(place_block_t), intent(inout) :: block
    type(halves_t) :: halves
    integer :: first, n, k

    do first = 1, memory%slave_tracking%n_touching, n_block
      n = min(n_block, memory%slave_tracking%n_touching - first + 1)
      halves%n = n
      halves%spot(:n) = memory%slave_tracking%touching(first:first + n - 1)
      call see_halves(n, halves%spot, memory%slave_tracking%segment, contact%slave%segments, &
        contact%master%segments, memory%n_slave, memory%places, memory%spots, halves)
      associate (tracking => memory%slave_tracking)
        call take_feet(n, halves%spot, tracking%gap, tracking%normal, memory%spot_xi, halves)
      end associate
      do k = 1, n
        if (block%n + 2 > n_block) &
          call append_points(block, memory%slave_penalty, memory%points)
        halves%xi(k) = spot_xi(memory, halves%spot(k), halves%ends(:, k))
        associate (a => memory%places(:, halves%ends(1, k)), &
          b => memory%places(:, halves%ends(2, k)))
          halves%half(k) = 0.5_wp*segment_length(a, b) &
            *radius_between(a, b, memory%spot_xi(2 - mod(halves%spot(k), 2)))
        end associate
        call walk_portions(contact, memory, halves, k, block)
      end do
    end do
    call append_points(block, memory%slave_penalty, memory%points)
  end subroutine place_by_radius

  !> Vectors of some halves.
  pure subroutine see_halves(n, spot, segment, ends, segments, n_slave, places, spots, halves)
    integer, intent(in) :: n, spot(n), segment(*)
    integer, intent(in) :: ends(2, *), segments(2, *) !! of the slave and of the master
    integer, intent(in) :: n_slave                    !! local number before the first master node
    real(wp), intent(in) :: places(4, *), spots(4, *)
    type(halves_t), intent(inout) :: halves
    real(wp), dimension(4) :: own, t, d
    integer :: k, s, a, b

    !GCC$ NOVECTOR
    do k = 1, n
      s = (spot(k) + 1)/2
      halves%master(k) = segment(spot(k))
      a = n_slave + segments(1, halves%master(k))
      b = n_slave + segments(2, halves%master(k))
      halves%ends(:, k) = ends(:, s)
      halves%nodes(1, k) = a
      halves%nodes(2, k) = b
      own = places(:, ends(2, s)) - places(:, ends(1, s))
      t = places(:, b) - places(:, a)
      d = spots(:, spot(k)) - places(:, a)
      halves%own(:, k) = own(1:2) + own(3:4)
      halves%t(:, k) = t(1:2) + t(3:4)
      halves%d(:, k) = d(1:2) + d(3:4)
    end do
  end subroutine see_halves

  !> Places, gaps and normals of the virtual nodes of some halves.
  pure subroutine take_feet(n, spot, gap, normal, spot_xi, halves)
    integer, intent(in) :: n, spot(n)
    real(wp), intent(in) :: gap(*), normal(2, *) !! of all virtual nodes
    real(wp), intent(in) :: spot_xi(2)           !! where they are on each slave segment
    type(halves_t), intent(inout) :: halves
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      halves%xi(k) = spot_xi(2 - iand(spot(k), 1))
      halves%gap(k) = gap(spot(k))
      halves%normal(:, k) = normal(:, spot(k))
    end do
  end subroutine take_feet

  !> Both ends of the halves on their master segments.
  pure subroutine project_ends(n, own, t, d, low, high, length, half)
    integer, intent(in) :: n
    real(wp), intent(in) :: own(2, n), t(2, n), d(2, n)
    real(wp), intent(inout), dimension(n) :: low, high, length, half
    real(wp) :: square, slope, middle
    integer :: k

    !$omp simd private(square, slope, middle)
    do k = 1, n
      square = max(t(1, k)*t(1, k) + t(2, k)*t(2, k), tiny(1.0_wp))
      length(k) = sqrt(square)
      half(k) = 0.5_wp*sqrt(own(1, k)*own(1, k) + own(2, k)*own(2, k))
      slope = 0.25_wp*(own(1, k)*t(1, k) + own(2, k)*t(2, k))/square
      middle = (d(1, k)*t(1, k) + d(2, k)*t(2, k))/square
      low(k) = middle + slope
      high(k) = middle - slope
    end do
  end subroutine project_ends

  !> The portions of a half with ends over different master segments: two where one master node at a
  !> gentle corner lies between them; else those that a walk finds.
  pure subroutine add_portions(contact, memory, halves, k, block)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(halves_t), intent(in) :: halves
    integer, intent(in) :: k
    type(place_block_t), intent(inout) :: block
    real(wp) :: low, high, share
    integer :: other, nodes(2)
    logical :: is_found

    low = halves%low(k)
    high = halves%high(k)
    is_found = .false.
    if (low < 0.0_wp .and. high > 0.0_wp .and. high < 1.0_wp) then
      other = contact%master%previous(halves%master(k))
      if (other > 0) call see_other(contact, memory, halves, k, other, 1.0_wp, is_found, low, share)
      if (is_found) then
        share = share/(share + high*halves%length(k))
        nodes = memory%n_slave + contact%master%segments(:, other)
        call put_portion(halves, k, nodes, 0.5_wp*(low + 1.0_wp), share*halves%half(k), &
          block)
        call put_portion(halves, k, halves%nodes(:, k), 0.5_wp*high, &
          (1.0_wp - share)*halves%half(k), block)
      end if
    else if (high > 1.0_wp .and. low > 0.0_wp .and. low < 1.0_wp) then
      other = contact%master%next(halves%master(k))
      if (other > 0) call see_other(contact, memory, halves, k, other, -1.0_wp, is_found, high, &
        share)
      if (is_found) then
        share = share/(share + (1.0_wp - low)*halves%length(k))
        nodes = memory%n_slave + contact%master%segments(:, other)
        call put_portion(halves, k, halves%nodes(:, k), 0.5_wp*(low + 1.0_wp), &
          (1.0_wp - share)*halves%half(k), block)
        call put_portion(halves, k, nodes, 0.5_wp*high, share*halves%half(k), block)
      end if
    end if
    if (.not. is_found) call walk_portions(contact, memory, halves, k, block)
  end subroutine add_portions

  !> Where the end of a half beyond its master segment is on the neighbour of that.
  pure subroutine see_other(contact, memory, halves, k, other, way, is_found, xi, length)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(halves_t), intent(in) :: halves
    integer, intent(in) :: k
    integer, intent(in) :: other      !! the neighbour
    real(wp), intent(in) :: way       !! 1: for the later end, -1: for the earlier one
    logical, intent(out) :: is_found  !! it is on that, across a gentle corner
    real(wp), intent(inout) :: xi     !! place on the neighbour
    real(wp), intent(out) :: length   !! of the portion, m
    real(wp) :: t(2), d(2), square, product, along(4), part

    associate (a => memory%places(:, memory%n_slave + contact%master%segments(1, other)), &
      b => memory%places(:, memory%n_slave + contact%master%segments(2, other)))
      along = b - a
      t = along(1:2) + along(3:4)
      ! From the neighbour's first node: the node in common is its second one, or the second node of
      ! the segment below.
      d = halves%d(:, k) + (0.25_wp*way)*halves%own(:, k)
      if (way > 0.0_wp) then
        d = d + t
      else
        d = d - halves%t(:, k)
      end if
    end associate
    square = max(t(1)*t(1) + t(2)*t(2), tiny(1.0_wp))
    part = (d(1)*t(1) + d(2)*t(2))/square
    product = halves%t(1, k)*t(1) + halves%t(2, k)*t(2)
    is_found = part > 0.0_wp .and. part < 1.0_wp &
      .and. product >= gentle_turn*halves%length(k)*sqrt(square)
    if (.not. is_found) return
    xi = part
    length = merge(1.0_wp - part, part, way > 0.0_wp)*sqrt(square)
  end subroutine see_other

  !> The portions from the mark of the later end to that of the earlier one; in axisymmetry by
  !> radius.
  pure subroutine walk_portions(contact, memory, halves, k, block)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(halves_t), intent(in) :: halves
    integer, intent(in) :: k
    type(place_block_t), intent(inout) :: block
    type(mark_t) :: marks(2)
    real(wp) :: total, low, high, xi, length
    integer :: segment, i, i_pass, ends(2), nodes(2)

    associate (spot => halves%spot(k), chain => memory%places(:, memory%n_slave + 1:))
      ends = contact%slave%segments(:, (spot + 1)/2)
      do i = 1, 2
        xi = end_of_half(memory%spot_xi(2 - mod(spot, 2)), i)
        marks(i) = walk_to_mark(contact%master, chain, (1.0_wp - xi)*memory%places(:, ends(1)) &
          + xi*memory%places(:, ends(2)), halves%master(k))
      end do
      total = 0.0_wp
      ! First their lengths, then, with the sum of these known, the points.
      do i_pass = 1, 2
        segment = marks(1)%segment
        do i = 0, marks(2)%n_step - marks(1)%n_step
          low = merge(marks(1)%xi, 0.0_wp, i == 0)
          high = merge(marks(2)%xi, 1.0_wp, segment == marks(2)%segment)
          if (high > low) then
            nodes = memory%n_slave + contact%master%segments(:, segment)
            xi = 0.5_wp*(low + high)
            length = (high - low)*segment_length(memory%places(:, nodes(1)), &
              memory%places(:, nodes(2)))
            if (contact%is_round) call weigh_portion(memory, nodes, low, high, xi, length)
            if (i_pass == 1) total = total + length
            if (i_pass == 2 .and. block%n == n_block) &
              call append_points(block, memory%slave_penalty, memory%points)
            if (i_pass == 2) call put_portion(halves, k, nodes, xi, halves%half(k)*(length/total), &
              block)
          end if
          segment = contact%master%next(segment)
          ! Marks of displacements beyond all bounds need not lie on one chain.
          if (segment == 0) exit
        end do
        if (total > 0.0_wp) cycle
        call put_portion(halves, k, halves%nodes(:, k), memory%slave_tracking%xi(spot), &
          halves%half(k), block)
        return
      end do
    end associate
  end subroutine walk_portions

  !> In axisymmetry: weight of a portion, and its centre by radius.
  pure subroutine weigh_portion(memory, nodes, low, high, xi, length)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: nodes(2)       !! local numbers of those of the master segment
    real(wp), intent(in) :: low, high     !! range of that
    real(wp), intent(inout) :: xi         !! in: its middle
    real(wp), intent(inout) :: length     !! m, then m^2 per radian

    associate (a => memory%places(:, nodes(1)), b => memory%places(:, nodes(2)))
      length = length*radius_between(a, b, xi)
      xi = centroid(a, b, low, high)
    end associate
  end subroutine weigh_portion

  !> In axisymmetry: where a virtual node is on its slave segment.
  pure function spot_xi(memory, spot, ends) result(xi)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: spot, ends(2)  !! nodes of its segment
    real(wp) :: xi

    associate (middle => memory%spot_xi(2 - mod(spot, 2)))
      xi = centroid(memory%places(:, ends(1)), memory%places(:, ends(2)), &
        end_of_half(middle, 2), end_of_half(middle, 1))
    end associate
  end function spot_xi

  !> Ends of a half segment, the later one first: the slave runs against the master.
  pure function end_of_half(xi, k)
    real(wp), intent(in) :: xi !! of the virtual node
    integer, intent(in) :: k
    real(wp) :: end_of_half

    end_of_half = xi + (1.5_wp - k)*0.5_wp
  end function end_of_half

  !> A point with the gap and the normal of the virtual node and a place of its own on the master,
  !> in a block that has room for it.
  pure subroutine put_portion(halves, k, nodes, xi, area, block)
    type(halves_t), intent(in) :: halves
    integer, intent(in) :: k
    integer, intent(in) :: nodes(2)        !! local numbers of those of the master segment
    real(wp), intent(in) :: xi             !! place on that
    real(wp), intent(in) :: area           !! m
    type(place_block_t), intent(inout) :: block
    integer :: n

    n = block%n + 1
    block%n = n
    block%ends(:, n) = halves%ends(:, k)
    block%xi(n) = halves%xi(k)
    block%nodes(:, n) = nodes
    block%feet%xi(n) = xi
    block%feet%gap(n) = halves%gap(k)
    block%feet%normal(:, n) = halves%normal(:, k)
    block%area(n) = area
  end subroutine put_portion

end module place_vts_ppt_m
