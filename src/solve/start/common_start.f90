! SPDX-License-Identifier: MIT
!> Nodes that move alike (*CONSTRAINED_NODE_SET) at time zero.
module common_start_m
  use kinds_m, only : wp
  use model_m, only : model_t
  use state_m, only : state_t
  implicit none
  private
  public :: start_common

contains

  !> Mean over the masses of a set.
  pure function common_mean(nodes, mass, values) result(mean)
    integer, intent(in) :: nodes(:)
    real(wp), intent(in) :: mass(:), values(:)  !! of all nodes
    real(wp) :: mean

    mean = values(nodes(1)) + sum(mass(nodes)*(values(nodes) - values(nodes(1))))/sum(mass(nodes))
  end function common_mean

  !> Velocities at time zero: momentum stays.
  subroutine start_common(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    integer :: i, k

    if (.not. allocated(model%conditions%common_motions)) return
    do i = 1, size(model%conditions%common_motions)
      associate (common => model%conditions%common_motions(i))
        do k = 1, 2
          if (common%along(k)) state%motion(2 + k, common%nodes) = &
            common_mean(common%nodes, state%mass, state%motion(2 + k, :))
        end do
      end associate
    end do
  end subroutine start_common

end module common_start_m
