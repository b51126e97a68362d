! SPDX-License-Identifier: MIT
!> Averages over a slave segment at the tip of a fold (types 6 and 7 of a surface with itself): the
!> tip comes first, and its flanks, which are still open, would hold it off the sum. There the
!> points of the segment give their areas to its two nodes (doc/theory/contact.md, section 5.7).
module sharp_vertices_m
  use contact_state_m, only : contact_state_t, make_room, active
  use contacts_m, only : contact_t, is_tied
  use projection_m, only : projection_t, nearby_projection
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: has_folds, find_sharp_vertices, weight_sharp_vertices, belongs_to

  !> Cosines of the turn at a node up to which nothing changes, and from which on all gives way.
  real(wp), parameter :: gentle = 0.99026806874157036_wp, sharp = 0.95105651629515353_wp

contains

  !> Whether tips of folds count as such, where averages do: a surface in contact with itself.
  elemental function has_folds(contact)
    type(contact_t), intent(in) :: contact
    logical :: has_folds

    has_folds = contact%is_self .and. .not. is_tied(contact)
  end function has_folds

  !> Let the points of segments at tips of folds give their areas to their nodes.
  pure subroutine weight_sharp_vertices(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: part(2)
    integer :: first, last, n

    n = memory%points%n
    last = 0
    do while (last < n)
      first = last + 1
      last = first
      associate (ends => memory%points%slave_nodes)
        do while (last < n)
          if (ends(1, last + 1) /= ends(1, first) .or. ends(2, last + 1) /= ends(2, first)) exit
          last = last + 1
        end do
        part = maxval(memory%scratch%nodal(1, ends(:, first)))
      end associate
      if (part(1) > 0.0_wp) call shift_to_nodes(contact, first, last, part, memory)
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

  !> The same for the ways along the surface to a node and from it on, at the start and now: the
  !> turn outwards, as far as it has come since the start.
  pure function sharpness(previous, ways) result(part)
    real(wp), intent(in), dimension(2, 2) :: previous, ways !! (x and y, to and from the node) m
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
  pure subroutine shift_to_nodes(contact, first, last, part, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: first, last !! points of the segment
    real(wp), intent(inout) :: part(2) !! at either end
    type(contact_state_t), intent(inout) :: memory
    type(projection_t) :: projections(2)
    real(wp) :: content(2)
    integer :: k, p

    do k = 1, 2
      call find_projection(contact, memory, first, last, k, projections(k))
      if (projections(k)%is_on) projections(k)%is_on = .not. belongs_to(contact%master, &
        memory%points%slave_nodes(k, first), projections(k)%segment, projections(k)%xi)
      if (.not. projections(k)%is_on) part(k) = 0.0_wp
      content(k) = sum(memory%points%slave_weights(k, first:last)*memory%points%area(first:last))
    end do
    call make_room(memory%points, 2)
    associate (points => memory%points)
      do p = first, last
        points%area(p) = points%area(p)*(1.0_wp - dot_product(part, points%slave_weights(:, p)))
      end do
      do k = 1, 2
        if (.not. part(k) > 0.0_wp) cycle
        p = points%n + 1
        points%n = p
        points%slave_nodes(:, p) = points%slave_nodes(:, first)
        points%slave_weights(:, p) = 0.0_wp
        points%slave_weights(k, p) = 1.0_wp
        points%master_nodes(:, p) = memory%n_slave + contact%master%segments(:, &
          projections(k)%segment)
        points%master_weights(:, p) = [1.0_wp - projections(k)%xi, projections(k)%xi]
        points%normal(:, p) = projections(k)%normal
        points%gap(p) = projections(k)%gap
        points%area(p) = part(k)*content(k)
        points%stiffness(p) = points%stiffness(first)
      end do
    end associate
  end subroutine shift_to_nodes

  !> Projection of an end of a segment: that which is followed, or from the nearest of its points
  !> on.
  pure subroutine find_projection(contact, memory, first, last, k, projection)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: first, last, k
    type(projection_t), intent(out) :: projection
    integer :: node, nearest

    node = memory%points%slave_nodes(k, first)
    if (.not. memory%has%segment_points) then
      associate (status => memory%slave_status)
        if (status%state(node) == active) then
          projection%segment = status%segment(node)
          projection%is_on = .true.
          projection%xi = status%xi(node)
          projection%gap = status%gap(node)
          projection%normal = status%normal(:, node)
          return
        end if
      end associate
    end if
    nearest = first - 1 + maxloc(memory%points%slave_weights(k, first:last), 1)
    projection = nearby_projection(contact%master, memory%positions(:, memory%n_slave + 1:), &
      memory%positions(:, node), contact%master%outgoing(memory%points%master_nodes(1, nearest) &
      - memory%n_slave))
  end subroutine find_projection

end module sharp_vertices_m
