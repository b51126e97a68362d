! SPDX-License-Identifier: MIT
!> Tangents of types 1, 2 and 3, whose points are nodes of one surface over segments of the other
!> (doc/theory/contact.md, section 9.2).
module tangent_nts_m
  use assembly_m, only : add_pressed_point
  use contact_state_m, only : contact_state_t
  use variation_m, only : varied_point_t, spot_foot, put_foot, length_between, &
    apart, share_of, side_share_of, cosine_of, vary_end_radius
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, constant, operator(+), operator(-), operator(*), operator(/)
  use kinds_m, only : wp
  use sparse_m, only : sparse_t
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: add_nts_tangent, add_nts_ar_tangent, vary_node, vary_competence

contains

  !> Type 1. A largest friction stress counts times the competence length, which changes; in
  !> axisymmetry so does the mean radius.
  pure subroutine add_nts_tangent(contact, memory, equations, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(varied_point_t) :: point
    type(dual_t) :: length
    integer :: p

    length = constant(1.0_wp)
    do p = 1, memory%points%n
      if (.not. memory%points%gap(p) < memory%closed_gap) cycle
      point = vary_node(memory, p)
      if (contact%friction%most > 0.0_wp .or. contact%is_round) then
        call vary_tributary(contact%slave, 0, .false., memory, point)
        length = point%area
        point%area = constant(1.0_wp)
        if (contact%is_round) then
          call vary_tributary(contact%slave, 0, .true., memory, point)
          point%area = point%area/length
        end if
      end if
      call add_pressed_point(contact%friction, memory, point%nodes(1), point, &
        memory%points%stiffness(p), equations, matrix, length)
    end do
  end subroutine add_nts_tangent

  !> Types 2 and 3: the area changes with the segments beside the node.
  pure subroutine add_nts_ar_tangent(contact, memory, equations, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    type(varied_point_t) :: point
    integer :: p

    do p = 1, memory%points%n
      if (.not. memory%points%gap(p) < memory%closed_gap) cycle
      point = vary_node(memory, p)
      if (point%nodes(1) <= memory%n_slave) then
        call vary_tributary(contact%slave, 0, contact%is_round, memory, point)
      else
        call vary_tributary(contact%master, memory%n_slave, contact%is_round, memory, point)
      end if
      call add_pressed_point(contact%friction, memory, point%nodes(1), point, &
        memory%points%stiffness(p), equations, matrix)
    end do
  end subroutine add_nts_ar_tangent

  !> The p-th point, which stands at a node, with a constant area of 1.
  pure function vary_node(memory, p) result(point)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: p
    type(varied_point_t) :: point

    point%nodes(1) = memory%points%slave_nodes(1, p)
    point%nodes(3:4) = memory%points%master_nodes(:, p)
    point%slave_xi = constant(0.0_wp)
    point%area = constant(1.0_wp)
    call put_foot(point, spot_foot(memory%places, point, 3, memory%points%master_weights(2, p), &
      memory%points%gap(p), memory%closed_gap))
  end function vary_node

  !> Let the area of a point at a node be the node's tributary length; on a closed boundary its
  !> segments count as far as they are opposed to the face.
  pure subroutine vary_tributary(surface, offset, by_radius, memory, point)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: offset !! local number before the first node of the surface
    logical, intent(in) :: by_radius
    type(contact_state_t), intent(in) :: memory
    type(varied_point_t), intent(inout) :: point
    type(dual_t) :: halves(2), shares(2), cosines(2), t(2), along(2)
    integer :: k

    call vary_competence(surface, offset, by_radius, memory, point)
    if (offset == 0 .and. .not. memory%slave_tracking%pass%is_closed) return
    if (offset > 0 .and. .not. memory%master_tracking%pass%is_closed) return
    halves = constant(0.0_wp)
    shares = constant(0.0_wp)
    along = constant(0.0_wp)
    cosines = constant(0.0_wp)
    do k = 1, 2
      if (point%nodes(4 + k) == 0) cycle
      halves(k) = half_of(memory, by_radius, k, point)
      t = apart(memory%places, point%nodes, merge(1, 6, k == 1), merge(5, 1, k == 1))
      shares(k) = share_of(t, point%normal)
      cosines(k) = cosine_of(t, point%normal)
      along(k) = t(1)*point%normal(1) + t(2)*point%normal(2)
    end do
    k = merge(1, 2, cosines(1)%value >= cosines(2)%value)
    shares(k) = shares(k)*side_share_of(cosines(k), cosines(3 - k))
    point%area = halves(1)*shares(1) + halves(2)*shares(2)
    if (max(shares(1)%value, shares(2)%value) >= 1.0_wp .or. any(point%nodes(5:6) == 0)) return
    k = merge(1, 2, shares(1)%value >= shares(2)%value)
    if (along(1)%value < 0.0_wp .and. along(2)%value > 0.0_wp) &
      point%area = point%area + (1.0_wp - shares(k))*(halves(1) + halves(2))
  end subroutine vary_tributary

  !> Half of the k-th segment at a node, the other end of which is in slot 4 + k.
  pure function half_of(memory, by_radius, k, point) result(half)
    type(contact_state_t), intent(in) :: memory
    logical, intent(in) :: by_radius
    integer, intent(in) :: k
    type(varied_point_t), intent(in) :: point
    type(dual_t) :: half

    half = 0.5_wp*length_between(memory%places, point%nodes, 1, 4 + k)
    if (by_radius) half = half*vary_end_radius(memory%places, point%nodes, 1, 4 + k, &
      constant(0.0_wp), constant(1.0_wp))
  end function half_of

  !> Let the area of a point at a node be the node's competence length, weighted with the radius or
  !> not; its neighbours go into slots 5 and 6.
  pure subroutine vary_competence(surface, offset, by_radius, memory, point)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: offset !! local number before the first node of the surface
    logical, intent(in) :: by_radius
    type(contact_state_t), intent(in) :: memory
    type(varied_point_t), intent(inout) :: point
    integer :: segments(2), k

    segments = [surface%incoming(point%nodes(1) - offset), &
      surface%outgoing(point%nodes(1) - offset)]
    point%area = constant(0.0_wp)
    do k = 1, 2
      if (segments(k) == 0) cycle
      point%nodes(4 + k) = offset + surface%segments(k, segments(k))
      point%area = point%area + half_of(memory, by_radius, k, point)
    end do
  end subroutine vary_competence

end module tangent_nts_m
