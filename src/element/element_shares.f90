! SPDX-License-Identifier: MIT
!> Lumped mass of one element at its nodes.
module element_shares_m
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use model_m, only : model_t
  use round_chunk_m, only : node_volumes
  implicit none
  private
  public :: element_shares

contains

  !> Masses at the four nodes of the element in a slot, by its density; 0 at the fourth of a
  !> triangle.
  pure function element_shares(model, slot) result(shares)
    type(model_t), intent(in) :: model
    integer, intent(in) :: slot
    real(wp) :: shares(4) !! kg per metre of depth or per radian
    real(wp) :: x(2, 4)
    integer :: corners

    associate (nodes => model%layout%slot_nodes(:, slot), material => &
      model%materials(model%parts(slot_part(model%layout, slot))%material))
      x = model%mesh%coordinates(:, nodes)
      corners = merge(3, 4, nodes(4) == nodes(3))
      if (model%is_round) then
        shares = material%density*node_volumes(x, corners == 3)
        return
      end if
      shares = material%density/corners*0.5_wp*((x(1, 3) - x(1, 1))*(x(2, 4) - x(2, 2)) &
        - (x(1, 4) - x(1, 2))*(x(2, 3) - x(2, 1)))
      shares(corners + 1:) = 0.0_wp
    end associate
  end function element_shares

end module element_shares_m
