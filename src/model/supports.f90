! SPDX-License-Identifier: MIT
!> Nodes that the deck supports.
module supports_m
  use model_m, only : model_t
  implicit none
  private
  public :: mark_meshed_nodes, mark_supports

contains

  !> (n_node) nodes that some element has, so that they have mass.
  pure function mark_meshed_nodes(model) result(is_meshed)
    type(model_t), intent(in) :: model
    logical :: is_meshed(model%mesh%n_node)
    integer :: i, k

    is_meshed = .false.
    do i = 1, model%mesh%n_element
      do k = 1, 4
        if (model%mesh%element_nodes(k, i) > 0) is_meshed(model%mesh%element_nodes(k, i)) = .true.
      end do
    end do
  end function mark_meshed_nodes

  !> (n_node) nodes with mass and a fixed degree of freedom, or held along an axis that is neither x
  !> nor y.
  pure function mark_supports(model) result(is_support)
    type(model_t), intent(in) :: model
    logical :: is_support(model%mesh%n_node)

    is_support = .false.
    associate (conditions => model%conditions)
      if (allocated(conditions%fixed_nodes)) is_support(conditions%fixed_nodes) = .true.
      if (allocated(conditions%skew_supports)) &
        is_support(conditions%skew_supports%node) = .true.
    end associate
    if (any(is_support)) is_support = is_support .and. mark_meshed_nodes(model)
  end function mark_supports

end module supports_m
