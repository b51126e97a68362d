! SPDX-License-Identifier: MIT
!> Constraints that no inverse mass of x or y can express: nodes that do not move along a skew
!> direction, and nodes that move alike.
module skew_motion_m
  use common_motion_m, only : common_drive, common_velocity
  use kinds_m, only : wp
  use model_m, only : model_t
  use node_motion_m, only : leap_t, find_factors
  use state_m, only : state_t
  implicit none
  private
  public :: hold_skew_nodes, remember_common, move_common

contains

  !> Add the forces of skew supports to the special nodes first .. last, whose other forces are
  !> known, before they move: v(n+1/2) has no part along the normal.
  subroutine hold_skew_nodes(model, leap, first, last, state)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    integer, intent(in) :: first, last
    type(state_t), intent(inout) :: state
    real(wp) :: half(2), keep(2), mobility(2), velocity(2), gain
    integer :: i

    do i = 1, size(model%conditions%skew_supports)
      associate (node => model%conditions%skew_supports(i)%node, &
        normal => model%conditions%skew_supports(i)%normal)
        if (node < first .or. node > last) cycle
        call find_factors(leap, state, node, half, keep)
        mobility = half*state%inverse_mass(:, node)
        velocity = keep*state%motion(3:4, node) + half*merge(leap%body, 0.0_wp, &
          state%inverse_mass(:, node) > 0.0_wp) + mobility*(state%force_special(:, node) &
          - state%internal_force(:, node))
        gain = dot_product(normal**2, mobility)
        if (gain > 0.0_wp) state%force_special(:, node) = state%force_special(:, node) &
          - dot_product(normal, velocity)/gain*normal
      end associate
    end do
  end subroutine hold_skew_nodes

  !> v(n-1/2) of the sets of nodes that move alike, before the nodes move.
  subroutine remember_common(model, state, velocity)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), allocatable, intent(inout) :: velocity(:, :) !! (2, n_set)
    integer :: i

    associate (sets => model%conditions%common_motions)
      if (.not. allocated(velocity)) allocate (velocity(2, size(sets)))
      do i = 1, size(sets)
        velocity(:, i) = common_velocity(model, i, state)
      end do
    end associate
  end subroutine remember_common

  !> Put them where the sum of their forces takes them; they have moved as nodes without force.
  subroutine move_common(model, leap, damping, before, state)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    real(wp), intent(in) :: damping(2)     !! D per direction
    real(wp), intent(in) :: before(:, :)   !! (2, n_set) v(n-1/2)
    type(state_t), intent(inout) :: state
    real(wp) :: push, rate, next
    integer :: i, k

    do i = 1, size(model%conditions%common_motions)
      associate (nodes => model%conditions%common_motions(i)%nodes)
        do k = 1, 2
          if (.not. model%conditions%common_motions(i)%along(k)) cycle
          call common_drive(model, i, k, state, damping, push, rate)
          next = ((1.0_wp - 0.5_wp*rate*leap%mean)*before(k, i) + leap%mean*push) &
            /(1.0_wp + 0.5_wp*rate*leap%mean)
          state%motion(k, nodes) = state%motion(k, nodes) + leap%dt*(next &
            - state%motion(2 + k, nodes))
          state%motion(2 + k, nodes) = next
        end do
      end associate
    end do
  end subroutine move_common

end module skew_motion_m
