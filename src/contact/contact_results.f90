! SPDX-License-Identifier: MIT
!> Results of an interface for the writers: resultants, and values of its nodes.
module contact_results_m
  use arc_points_m, only : offset_by_arc
  use contact_state_m, only : contact_state_t, contact_points_t, n_side
  use search_state_m, only : candidates_t, active
  use contacts_m, only : contact_t
  use projection_m, only : projection_t, nearest_projection, follow_contact, turns_gently, vector_of
  use geometry_m, only : segment_length, coordinates_on_segment, closest_distance
  use kinds_m, only : wp
  use law_state_m, only : is_open, is_held, is_broken
  use tributary_lengths_m, only : find_half
  use nodal_forces_m, only : average_values
  use snapshot_m, only : interface_result_t, slave_result_t, friction_result_t
  use surfaces_m, only : surface_t
  use ties_m, only : tie_spring_t, tie_spring, tied_nodes
  implicit none
  private
  public :: interface_resultants, sides_of_corners, slave_rows

contains

  !> Resultants of both sides and energies.
  pure subroutine interface_resultants(memory, resultants)
    type(contact_state_t), intent(in) :: memory
    type(interface_result_t), intent(out) :: resultants

    resultants%slave_force = sum(memory%force(:, :memory%n_slave), 2)
    resultants%master_force = sum(memory%force(:, memory%n_slave + 1:), 2)
    resultants%n_active = memory%n_active + memory%ties%n_held
    associate (friction => memory%friction)
      resultants%energy = memory%energy + friction%stored
      resultants%friction = friction%work - friction%stored
      resultants%damping = memory%damping_work
      resultants%stored = memory%monitor%stored - memory%ties%spent + friction%stored
    end associate
  end subroutine interface_resultants

  !> Rows of all slave nodes in walking order.
  pure subroutine slave_rows(contact, motion, memory, rows)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node) u, v
    type(contact_state_t), intent(in) :: memory
    type(slave_result_t), intent(inout) :: rows
    real(wp), dimension(memory%n_slave + memory%n_master) :: share, lengths
    real(wp) :: positions(4, memory%n_slave + memory%n_master)
    logical :: carries(memory%n_slave + memory%n_master)
    integer :: i, n

    n = memory%n_slave
    if (.not. allocated(rows%node)) then
      rows%node = contact%slave%nodes
      allocate (rows%arc_length(n), rows%gap(n), rows%offset(n), rows%pressure(n), &
        rows%force(2, n), rows%length(n), rows%master_pressure(memory%n_master))
      if (memory%has%friction .or. memory%has%ties) allocate (rows%friction_result(size(share)))
    end if
    positions(1:2, :) = memory%positions(1:2, :)
    positions(3:4, :) = motion(1:2, memory%nodes)
    rows%force = memory%force(:, :n)
    call fill_arc_lengths(contact%slave, positions(:, :n), rows%arc_length)
    share = nodal_sums(contact%is_self, memory, memory%points, memory%points%pressure)
    if (memory%has%ties) share = share + nodal_sums(.false., memory, memory%tie_points, &
      memory%tie_points%pressure)
    carries = abs(share) > 0.0_wp
    if (memory%has%ties) carries = carries .or. tied_nodes(memory, [is_held, is_broken])
    rows%length = lengths_in_contact(contact%slave, positions(:, :n), contact%is_axisymmetric, &
      carries(:n))
    lengths = contact%thickness*max(tiny(1.0_wp), [rows%length, lengths_in_contact( &
      contact%master, positions(:, n + 1:), contact%is_axisymmetric, carries(n + 1:))])
    rows%pressure = share(:n)/lengths(:n)
    rows%master_pressure = share(n + 1:)/lengths(n + 1:)
    rows%gap = 0.0_wp
    rows%offset = 0.0_wp
    do i = 1, merge(n, 0, memory%has%contact)
      rows%gap(i) = present_gap(contact, positions(:, n + 1:), positions(:, i), memory, i)
      rows%offset(i) = offset_at(contact, memory, i)
    end do
    if (.not. (memory%has%friction .or. memory%has%ties)) return
    share = 0.0_wp
    if (memory%has%friction) &
      share = nodal_sums(contact%is_self, memory, memory%points, memory%points%traction)
    if (memory%has%ties) share = share + nodal_sums(.false., memory, memory%tie_points, &
      memory%tie_points%traction)
    rows%friction_result = [(friction_result_t(traction=share(i)/lengths(i)), i=1, size(share))]
    do i = 1, merge(size(share), 0, memory%has%friction)
      call find_state(contact, i, memory, rows%friction_result(i))
    end do
    if (memory%has%ties) call fill_ties(memory, rows)
  end subroutine slave_rows

  !> What ties have at nodes: gaps and slips as means of their springs, by area, and states. The gap
  !> of contact stands where they do not hold.
  pure subroutine fill_ties(memory, rows)
    type(contact_state_t), intent(in) :: memory
    type(slave_result_t), intent(inout) :: rows
    real(wp) :: nodal(2, memory%n_slave + memory%n_master), slip(size(nodal, 2))
    logical, dimension(size(nodal, 2)) :: holds, held
    integer :: i

    if (memory%tie_points%n == 0) return
    call average_values(memory%tie_points, memory%tie_points%gap, size(nodal, 2), nodal)
    slip = mean_slips(memory)
    holds = tied_nodes(memory, [is_held])
    held = tied_nodes(memory, [is_held, is_broken])
    do i = 1, size(held)
      if (.not. held(i)) cycle
      rows%friction_result(i)%slip = slip(i)
      rows%friction_result(i)%state = merge(is_held, is_broken, holds(i))
    end do
    where (holds(:memory%n_slave)) rows%gap = nodal(1, :memory%n_slave)
  end subroutine fill_ties

  !> How far nodes have moved along their surfaces over the other side, against the reference
  !> geometry and whether they still are held or not, m. Springs measure the slave along the
  !> master's surface, which runs the other way.
  pure function mean_slips(memory) result(slip)
    type(contact_state_t), intent(in) :: memory
    real(wp) :: slip(memory%n_slave + memory%n_master)
    real(wp) :: area(memory%n_slave + memory%n_master), along(memory%tie_points%n)
    type(tie_spring_t) :: spring
    integer :: s

    slip = 0.0_wp
    do s = 1, size(memory%ties%side)
      spring = tie_spring(memory%ties, memory%tie_points, memory%positions, s)
      along(memory%ties%first(s):memory%ties%first(s + 1) - 1) = memory%ties%offset(2, s) &
        - dot_product(spring%d, spring%t)
    end do
    associate (points => memory%tie_points)
      area = nodal_sums(.false., memory, points, spread(1.0_wp, 1, points%n))
      where (area > 0.0_wp) slip = nodal_sums(.false., memory, points, along)/area
    end associate
  end function mean_slips

  !> Distance along each surface from its first node, in the present shape.
  pure subroutine fill_arc_lengths(surface, positions, arc_length)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :)
    real(wp), intent(out) :: arc_length(:)
    integer :: i

    arc_length = 0.0_wp
    do i = 2, surface%n_node
      if (surface%incoming(i) == 0) cycle
      associate (before => surface%segments(1, surface%incoming(i)))
        if (before == i - 1) arc_length(i) = arc_length(before) &
          + segment_length(positions(:, before), positions(:, i))
      end associate
    end do
  end subroutine fill_arc_lengths

  !> Which segments are the side next to a sharp corner without contact of its own: of their nodes
  !> that of the corner alone carries contact, and of the other segment there both do.
  pure function sides_of_corners(surface, positions, carries) result(is_side)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of this surface
    logical, intent(in) :: carries(:)                !! (n_node) has contact force, or is tied
    logical :: is_side(surface%n_segment)
    integer :: s, next, k

    is_side = .false.
    do s = 1, surface%n_segment
      associate (ends => surface%segments(:, s))
        if (carries(ends(1)) .eqv. carries(ends(2))) cycle
        k = merge(1, 2, carries(ends(1)))
        next = merge(surface%previous(s), surface%next(s), k == 1)
        if (next == 0) cycle
        if (.not. carries(surface%segments(k, next))) cycle
        is_side(s) = .not. turns_gently(vector_of(surface, positions, s), &
          vector_of(surface, positions, next))
      end associate
    end do
  end function sides_of_corners

  !> Tributary lengths of the nodes of a surface, m, in axisymmetry m^2 per radian: half of both
  !> segments; at a sharp vertex half of the one under contact alone.
  pure function lengths_in_contact(surface, positions, is_axisymmetric, carries) result(lengths)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of this surface
    logical, intent(in) :: is_axisymmetric
    logical, intent(in) :: carries(:)                !! (n_node) has contact force, or is tied
    real(wp) :: lengths(surface%n_node)
    real(wp) :: t(2), half
    logical :: is_side(surface%n_segment)
    integer :: i, k

    lengths = 0.0_wp
    is_side = sides_of_corners(surface, positions, carries)
    do i = 1, surface%n_node
      do k = 1, 2
        associate (s => merge(surface%incoming(i), surface%outgoing(i), k == 1))
          if (s == 0) cycle
          if (carries(i) .and. is_side(s)) cycle
        end associate
        call find_half(surface, positions, is_axisymmetric, i, k, t, half)
        lengths(i) = lengths(i) + half
      end do
    end do
  end function lengths_in_contact

  !> Slip and state of a node, where friction has any. With virtual nodes: of those next to it, the
  !> mean slip, and slip if one slips.
  pure subroutine find_state(contact, i, memory, found)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: i !! number in the interface
    type(contact_state_t), intent(in) :: memory
    type(friction_result_t), intent(inout) :: found
    integer :: near(2)

    near = i
    if (memory%has%virtual_nodes) then
      if (i > memory%n_slave) return
      near = points_beside(contact%slave, size(memory%segment_points%xi), i)
      if (near(1) == 0) return
    end if
    ! Slips are those of the slave side along the master's surface, which runs the other way.
    ! At a corner the side next to it has no contact.
    if (count(memory%friction%state(near) == is_open) == 1) &
      near = near(maxloc(memory%friction%state(near), 1))
    found%slip = -0.5_wp*(memory%friction%slip(near(1)) + memory%friction%slip(near(2)))
    found%state = maxval(memory%friction%state(near))
  end subroutine find_state

  !> Values of points times their areas, shared out to the nodes on both sides: the normal forces on
  !> them of pressures, N/m, forces along their surfaces of tractions. All of a surface with itself
  !> is on the slave.
  pure function nodal_sums(is_self, memory, points, values) result(share)
    logical, intent(in) :: is_self
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in), contiguous :: values(:) !! of the points, N/m^2
    real(wp) :: share(memory%n_slave + memory%n_master)
    real(wp) :: total
    integer :: p, k

    share = 0.0_wp
    do p = 1, points%n
      total = values(p)*points%area(p)
      do k = 1, n_side
        share(points%slave_nodes(k, p)) = share(points%slave_nodes(k, p)) &
          + points%slave_weights(k, p)*total
        share(points%master_nodes(k, p)) = share(points%master_nodes(k, p)) &
          + points%master_weights(k, p)*total
      end do
    end do
    if (.not. is_self) return
    associate (n => memory%n_slave)
      share(:n) = share(:n) + share(n + 1:)
      share(n + 1:) = 0.0_wp
    end associate
  end function nodal_sums

  !> Gap of a slave node at the present positions; 0 when it is unpaired: no candidate of its
  !> segments is within the search radius.
  pure function present_gap(contact, polyline, position, memory, i) result(gap)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: polyline(:, :) !! (4, n_master) present positions
    real(wp), intent(in) :: position(4)             !! of the node
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: i                        !! node of the slave surface
    real(wp) :: gap
    type(projection_t) :: projection
    integer :: point, segment

    gap = 0.0_wp
    if (memory%is_stale) return
    if (contact%slave%incoming(i) == 0 .and. contact%slave%outgoing(i) == 0) return
    point = point_at_node(contact%slave, memory, i)
    associate (status => memory%slave_status)
      if (status%state(point) /= active) then
        segment = nearest_candidate(contact, polyline, position, memory%candidates, i)
        if (segment == 0) return
        projection = nearest_projection(contact%master, polyline, position, segment)
        if (projection%distance > status%reach) return
      else if (memory%has%segment_points) then
        projection = follow_contact(contact%master, polyline, position, status%segment(point))
      else
        gap = status%gap(point)
        return
      end if
      if (projection%is_on) gap = projection%gap
    end associate
  end function present_gap

  !> What arcs and entries add to the gap of a slave node in contact, m.
  pure function offset_at(contact, memory, i) result(offset)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: i !! node of the slave surface
    real(wp) :: offset
    integer :: point

    offset = 0.0_wp
    if (memory%is_stale .or. max(contact%slave%incoming(i), contact%slave%outgoing(i)) == 0) return
    point = point_at_node(contact%slave, memory, i)
    associate (status => memory%slave_status)
      if (status%state(point) /= active) return
      offset = status%offset(point)
      if (.not. memory%has%arcs) return
      offset = offset + offset_by_arc(memory, i, memory%n_slave &
        + contact%master%segments(:, status%segment(point)))
    end associate
  end function offset_at

  !> The candidate of the segments at a slave node that is next to it, 0: none.
  pure function nearest_candidate(contact, polyline, position, candidates, i) result(nearest)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: polyline(:, :) !! (4, n_master) present positions
    real(wp), intent(in) :: position(4)
    type(candidates_t), intent(in) :: candidates
    integer, intent(in) :: i
    integer :: nearest
    real(wp) :: square, least
    integer :: j, k, own(2)

    nearest = 0
    least = huge(1.0_wp)
    own = [contact%slave%incoming(i), contact%slave%outgoing(i)]
    do k = 1, 2
      if (own(k) == 0) cycle
      do j = candidates%first(own(k)), candidates%first(own(k) + 1) - 1
        associate (ends => contact%master%segments(:, candidates%items(j)))
          if (contact%is_self .and. any(ends == i)) cycle
          square = closest_distance(coordinates_on_segment(position, polyline(:, ends(1)), &
            polyline(:, ends(2))))
        end associate
        if (.not. square < least) cycle
        least = square
        nearest = candidates%items(j)
      end do
    end do
  end function nearest_candidate

  !> Points of the search on the segments before and behind a slave node that are next to it, the
  !> same twice where there is one segment; 0: none.
  pure function points_beside(slave, n, i) result(near)
    type(surface_t), intent(in) :: slave
    integer, intent(in) :: n !! points of a segment
    integer, intent(in) :: i
    integer :: near(2)

    near = [n*slave%incoming(i), n*(slave%outgoing(i) - 1) + 1]
    if (slave%outgoing(i) == 0) near(2) = near(1)
    if (slave%incoming(i) == 0) near(1) = near(2)
  end function points_beside

  !> The point at a slave node, or of those on its segments the one next to it that is in contact,
  !> if any.
  pure function point_at_node(slave, memory, i) result(point)
    type(surface_t), intent(in) :: slave
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: i
    integer :: point, near(2)

    point = i
    if (.not. memory%has%segment_points) return
    near = points_beside(slave, size(memory%segment_points%xi), i)
    point = merge(near(2), near(1), memory%slave_status%state(near(2)) == active)
  end function point_at_node

end module contact_results_m
