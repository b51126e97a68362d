! SPDX-License-Identifier: MIT
!> Linearised points of type 6, which stand at fixed sites of their segments
!> (doc/theory/contact.md, section 9.5).
module tangent_mortar_m
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use dual_m, only : constant, operator(*)
  use linearisation_m, only : linearised_point_t, linearised_list_t, append_point, difference, &
    project_point, length_between, share_of, radius_at
  use kinds_m, only : wp
  use overlap_m, only : overlap_t
  use overlaps_m, only : sides_part
  use point_tangent_m, only : parts_left
  use tangent_overlaps_m, only : append_share
  implicit none
  private
  public :: linearise_fixed_points

contains

  !> All points. Of the area only what changes has to be gone through again.
  pure subroutine linearise_fixed_points(contact, memory, list)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(linearised_list_t), intent(inout) :: list
    type(linearised_point_t) :: point
    type(overlap_t) :: sides
    real(wp) :: remaining(memory%points%n)
    integer :: s, p

    remaining = parts_left(memory)
    associate (points => memory%points, positions => memory%positions)
      do p = 1, points%n
        point%nodes(:4) = [points%slave_nodes(:, p), points%master_nodes(:, p)]
        point%slave_xi = constant(points%slave_weights(2, p))
        call project_point(memory, points%master_weights(2, p), points%gap(p), point)
        point%remaining = constant(remaining(p))
        point%area = length_between(positions, point%nodes, 1, 2) &
          *share_of(difference(positions, point%nodes, 2, 1), point%normal)
        if (contact%is_round) &
          point%area = point%area*radius_at(positions, point%nodes, 1, 2, point%slave_xi)
        point%area = (points%area(p)/point%area%value)*point%area
        s = contact%slave%outgoing(points%slave_nodes(1, p))
        sides%master = contact%master%outgoing(points%master_nodes(1, p) - memory%n_slave)
        sides%part = 1.0_wp
        if (memory%slave_status%pass%is_closed) &
          sides%part = sides_part(contact, memory, s, sides%master)
        if (sides%part < 1.0_wp) then
          point%area = (1.0_wp/sides%part)*point%area
          call append_share(contact, memory, s, sides, .false., point, list)
        else
          call append_point(list, point)
        end if
      end do
    end associate
  end subroutine linearise_fixed_points

end module tangent_mortar_m
