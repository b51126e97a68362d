! SPDX-License-Identifier: MIT
!> Linearised points of types 1, 2 and 3, which are nodes of one surface over segments of the other
!> (doc/theory/contact.md, section 9.2).
module tangent_nts_m
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, constant, operator(+), operator(-), operator(*), operator(/)
  use kinds_m, only : wp
  use projection_m, only : slave_side
  use linearisation_m, only : linearised_point_t, linearised_list_t, append_point, project_point, &
    difference, length_between, cosine_between, share_of, side_share_of, radius_at
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: linearise_nodes, linearise_node, linearise_length

contains

  !> All points. The area of type 1 is 1, in axisymmetry the mean radius of the tributary length,
  !> which a largest traction counts times; that of types 2 and 3 is the tributary length.
  pure subroutine linearise_nodes(contact, has_unit_area, memory, list)
    type(contact_t), intent(in) :: contact
    logical, intent(in) :: has_unit_area !! type 1
    type(contact_state_t), intent(in) :: memory
    type(linearised_list_t), intent(inout) :: list
    type(linearised_point_t) :: point, plane
    integer :: p

    do p = 1, memory%points%n
      point = linearise_node(memory, p)
      associate (is_closed => memory%slave_status%pass%is_closed, is_round => contact%is_round)
        if (point%site > memory%n_slave) then
          call linearise_length(contact%master, memory%n_slave, is_round, &
            memory%master_status%pass%is_closed, memory, point)
        else if (is_round .or. .not. has_unit_area) then
          call linearise_length(contact%slave, 0, is_round, is_closed, memory, point)
        end if
        plane = point
        if (has_unit_area .and. is_round) then
          call linearise_length(contact%slave, 0, .false., is_closed, memory, plane)
          point%area = point%area/plane%area
        end if
        if (has_unit_area .and. contact%friction%most > 0.0_wp) then
          call linearise_length(contact%slave, 0, .false., .false., memory, plane)
          point%nodes = plane%nodes
          point%length = plane%area
        end if
      end associate
      call append_point(list, point)
    end do
  end subroutine linearise_nodes

  !> The p-th point of the list, which stands at a node, with an area of 1.
  pure function linearise_node(memory, p) result(point)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: p
    type(linearised_point_t) :: point

    associate (points => memory%points)
      point%site = points%slave_nodes(1, p)
      point%nodes(1) = point%site
      point%nodes(3:4) = points%master_nodes(:, p)
      point%stiffness = points%stiffness(p)
      point%slave_xi = constant(0.0_wp)
      point%area = constant(1.0_wp)
      call project_point(memory, points%master_weights(2, p), points%gap(p), point)
    end associate
  end function linearise_node

  !> Let the area of a point at a node be the node's tributary length, the neighbours of which go
  !> into slots 5 and 6; on a closed boundary its segments count as far as they are opposed to the
  !> face.
  pure subroutine linearise_length(surface, offset, by_radius, is_closed, memory, point)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: offset !! local number before the first node of the surface
    logical, intent(in) :: by_radius, is_closed
    type(contact_state_t), intent(in) :: memory
    type(linearised_point_t), intent(inout) :: point
    type(dual_t) :: halves(2), shares(2), parts(2), cosines(2), t(2, 2), turn
    integer :: segments(2), k

    segments = [surface%incoming(point%nodes(1) - offset), &
      surface%outgoing(point%nodes(1) - offset)]
    halves = constant(0.0_wp)
    do k = 1, 2
      if (segments(k) == 0) cycle
      point%nodes(4 + k) = offset + surface%segments(k, segments(k))
      halves(k) = 0.5_wp*length_between(memory, point, 1, 4 + k)
      if (by_radius) halves(k) = halves(k)*radius_at(memory, point, 1, 4 + k, &
        constant(1.0_wp/3.0_wp))
    end do
    point%area = halves(1) + halves(2)
    if (.not. is_closed .or. any(segments == 0)) return
    do k = 1, 2
      t(:, k) = difference(memory, point, merge(1, 6, k == 1), merge(5, 1, k == 1))
      cosines(k) = cosine_between(t(:, k), [-point%normal(2), point%normal(1)])
      shares(k) = share_of(cosines(k))
    end do
    parts = constant(1.0_wp)
    if (t(1, 1)%value*t(2, 2)%value - t(2, 1)%value*t(1, 2)%value > 0.0_wp) then
      turn = cosine_between(t(:, 1), t(:, 2))
      parts = [side_share_of(turn, cosines(1) - cosines(2), slave_side), &
        side_share_of(turn, cosines(2) - cosines(1), slave_side)]
    end if
    point%area = halves(1)*shares(1)*parts(1) + halves(2)*shares(2)*parts(2)
    if (maxval(shares%value) >= 1.0_wp) return
    if (dot_product(t(:, 1)%value, point%normal%value) < 0.0_wp .and. &
      dot_product(t(:, 2)%value, point%normal%value) > 0.0_wp) &
      point%area = point%area + 0.5_wp*(1.0_wp - shares(maxloc(shares%value, 1)))*(parts(1) &
      + parts(2))*(halves(1) + halves(2))
  end subroutine linearise_length

end module tangent_nts_m
