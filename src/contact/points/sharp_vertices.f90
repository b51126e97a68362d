! SPDX-License-Identifier: MIT
!> Averages over a slave segment at the tip of a fold (types 6 and 7 of a surface with itself): the
!> tip comes first, and its flanks, which are still open, would hold it off the sum. There the
!> points of the segment give their areas to its two nodes (doc/theory/contact.md, section 5.7).
module sharp_vertices_m
  use contact_state_m, only : contact_state_t, contact_points_t, active
  use contacts_m, only : contact_t, is_tied
  use projection_m, only : projection_t, nearby_projection
  use kinds_m, only : wp
  use point_list_m, only : add_point, known_projection
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: has_folds, find_sharp_vertices, weight_sharp_vertices, belongs_to

  !> Cosines of the turn at a node up to which nothing changes, and from which on all gives way.
  real(wp), parameter :: gentle = 0.99026806874157036_wp, sharp = 0.95105651629515353_wp

contains

  !> Whether sharp vertices count as such, where averages do: a surface in contact with itself.
  elemental function has_folds(contact)
    type(contact_t), intent(in) :: contact
    logical :: has_folds

    has_folds = contact%is_self .and. .not. is_tied(contact)
  end function has_folds

  !> Let the points of segments at sharp vertices give their areas to their nodes: all points of a
  !> segment follow each other on the list.
  pure subroutine weight_sharp_vertices(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(contact_points_t), intent(inout) :: points
    real(wp) :: part
    integer :: first, last, n

    call find_sharp_vertices(contact%slave, memory)
    n = points%n
    last = 0
    do while (last < n)
      first = last + 1
      associate (ends => points%slave_nodes)
        do last = first, n - 1
          if (any(ends(:, last + 1) /= ends(:, first))) exit
        end do
        part = maxval(memory%scratch%nodal(1, ends(:, first)))
      end associate
      if (part > 0.0_wp) call shift_to_nodes(contact, memory, first, last, part, points)
    end do
  end subroutine weight_sharp_vertices

  !> Whether a node of a surface in contact with itself is an end of the segment that it stands
  !> upon, or, where it stands on a node of that, of the next segment there: on which of both a node
  !> of a fold stands is a matter of round-off.
  pure function belongs_to(surface, node, segment, xi) result(belongs)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: node, segment
    real(wp), intent(in) :: xi !! position on the segment, 0 to 1
    logical :: belongs
    integer :: beside

    belongs = any(surface%segments(:, segment) == node)
    if (abs(xi - 0.5_wp) < 0.5_wp) return
    beside = merge(surface%previous(segment), surface%next(segment), xi < 0.5_wp)
    if (beside > 0) belongs = belongs .or. any(surface%segments(:, beside) == node)
  end function belongs_to

  !> How much gives way at each slave node, 0 to 1: kept where averages come later. In a trial of an
  !> implicit step that of the start of the step, so that it is no part of the tangent.
  pure subroutine find_sharp_vertices(slave, memory)
    type(surface_t), intent(in) :: slave
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: previous(2, 2), moved(2, 2)
    integer :: node, ends(3), k

    memory%scratch%nodal(1, :memory%n_slave) = 0.0_wp
    do node = 1, memory%n_slave
      if (slave%incoming(node) == 0 .or. slave%outgoing(node) == 0) cycle
      ends = [slave%segments(1, slave%incoming(node)), node, &
        slave%segments(2, slave%outgoing(node))]
      do k = 1, 2
        previous(:, k) = memory%positions(1:2, ends(k + 1)) - memory%positions(1:2, ends(k))
        moved(:, k) = memory%positions(3:4, ends(k + 1)) - memory%positions(3:4, ends(k))
        if (memory%slave_status%pass%is_trial) moved(:, k) = moved(:, k) &
          - (memory%scratch%increment(:, ends(k + 1)) - memory%scratch%increment(:, ends(k)))
      end do
      memory%scratch%nodal(1, node) = sharpness(previous, previous + moved)
    end do
  end subroutine find_sharp_vertices

  !> How much gives way at a node, by the segments before and behind it at the start and now: the
  !> turn outwards, as far as it has come since the start.
  pure function sharpness(previous, ways) result(part)
    real(wp), intent(in), dimension(2, 2) :: previous, ways !! (x and y, before and behind) m
    real(wp) :: part
    real(wp) :: turn(2), turn_before(2), cosine ! cosine and sine, times lengths

    part = 0.0_wp
    turn = turn_of(ways)
    if (.not. turn(2) > 0.0_wp) return
    turn_before = turn_of(previous)
    if (turn_before(2) > 0.0_wp) turn = turn_of(reshape([turn_before, turn], [2, 2]))
    if (.not. turn(2) > 0.0_wp) return
    cosine = turn(1)/norm2(turn)
    part = min(1.0_wp, max(0.0_wp, (gentle - cosine)/(gentle - sharp)))
    part = part**2*(3.0_wp - 2.0_wp*part)
  end function sharpness

  !> Cosine and sine of the turn from one vector to another, times their lengths.
  pure function turn_of(vectors) result(turn)
    real(wp), intent(in) :: vectors(2, 2)
    real(wp) :: turn(2)

    turn = [dot_product(vectors(:, 1), vectors(:, 2)), &
      vectors(1, 1)*vectors(2, 2) - vectors(2, 1)*vectors(1, 2)]
  end function turn_of

  !> Points at the nodes of a segment take a part of the areas of its points, as these weigh there,
  !> as far as the nodes have a projection.
  pure subroutine shift_to_nodes(contact, memory, first, last, part, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: first, last !! points of the segment
    real(wp), intent(in) :: part
    type(contact_points_t), intent(inout) :: points
    type(projection_t) :: projections(2)
    real(wp) :: parts(2), content(2)
    integer :: ends(2), k, p

    ends = points%slave_nodes(:, first)
    do k = 1, 2
      projections(k) = end_projection(contact, memory, points, [first, last], k)
      parts(k) = 0.0_wp
      if (projections(k)%is_on .and. .not. belongs_to(contact%master, ends(k), &
        projections(k)%segment, projections(k)%xi)) parts(k) = part
      content(k) = sum(points%slave_weights(k, first:last)*points%area(first:last))
    end do
    do p = first, last
      points%area(p) = points%area(p)*(1.0_wp - dot_product(parts, points%slave_weights(:, p)))
    end do
    do k = 1, 2
      if (parts(k) > 0.0_wp) call add_point(points, ends, real(k - 1, wp), memory%n_slave &
        + contact%master%segments(:, projections(k)%segment), projections(k), &
        parts(k)*content(k), memory%slave_penalty)
    end do
  end subroutine shift_to_nodes

  !> Projection of the k-th end of a segment: that which is followed, or from the nearest of its
  !> points on.
  pure function end_projection(contact, memory, points, range, k) result(projection)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: range(2) !! of the points of the segment
    integer, intent(in) :: k
    type(projection_t) :: projection
    integer :: node, i, nearest

    node = points%slave_nodes(k, range(1))
    i = node
    ! The first and the last of the points that type 6 follows on a segment are its ends.
    if (memory%has%segment_points) i = merge(1, size(memory%segment_xi), k == 1) &
      + size(memory%segment_xi)*(contact%slave%outgoing(points%slave_nodes(1, range(1))) - 1)
    if (memory%slave_status%state(i) == active) then
      projection = known_projection(memory%slave_status, i)
    else
      nearest = range(1) - 1 + maxloc(points%slave_weights(k, range(1):range(2)), 1)
      projection = nearby_projection(contact%master, memory%positions(:, memory%n_slave + 1:), &
        memory%positions(:, node), contact%master%outgoing(points%master_nodes(1, nearest) &
        - memory%n_slave))
      ! What has been let go stands behind the face.
      if (memory%has%segment_points) &
        projection%is_on = projection%is_on .and. .not. projection%gap < 0.0_wp
    end if
  end function end_projection

end module sharp_vertices_m
