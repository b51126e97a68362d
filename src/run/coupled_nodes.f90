! SPDX-License-Identifier: MIT
!> Coupled nodes (*CONSTRAINED_NODE_SET): all nodes of a set have the acceleration sum of forces
!> over sum of masses.
module coupled_nodes_m
  use kinds_m, only : wp
  use model_m, only : model_t
  use state_m, only : state_t
  implicit none
  private
  public :: coupled_acceleration, coupled_velocity, fill_coupled_nodes

contains

  !> Velocity of a set. Nodes that lost their mass with their last element are at rest and do not
  !> count.
  pure function coupled_velocity(model, i_set, state) result(velocity)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_set
    type(state_t), intent(in) :: state
    real(wp) :: velocity(2)
    integer :: i

    velocity = 0.0_wp
    associate (nodes => model%conditions%common_motions(i_set)%nodes)
      do i = 1, size(nodes)
        if (.not. state%mass(nodes(i)) > 0.0_wp) cycle
        velocity = state%motion(3:4, nodes(i))
        return
      end do
    end associate
  end function coupled_velocity

  !> Acceleration of a set along one direction without damping, and the mass-weighted mean of D.
  !> Both are zero for a set without mass.
  pure subroutine coupled_acceleration(model, i_set, k, state, damping, push, rate)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_set, k
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2)     !! D per direction
    real(wp), intent(out) :: push, rate
    real(wp) :: mass
    integer :: i

    push = 0.0_wp
    rate = 0.0_wp
    mass = 0.0_wp
    associate (nodes => model%conditions%common_motions(i_set)%nodes)
      do i = 1, size(nodes)
        push = push + (state%force_special(k, nodes(i)) - state%internal_force(k, nodes(i)))
        mass = mass + state%mass(nodes(i))
        if (allocated(state%node_damping)) &
          rate = rate + state%mass(nodes(i))*state%node_damping(k, nodes(i))
      end do
    end associate
    if (.not. mass > 0.0_wp) then
      push = 0.0_wp
      rate = 0.0_wp
      return
    end if
    push = push/mass + state%body_acceleration(k)
    rate = rate/mass
    if (.not. allocated(state%node_damping)) rate = damping(k)
  end subroutine coupled_acceleration

  !> Acceleration and velocity of coupled nodes at t(n).
  pure subroutine fill_coupled_nodes(model, state, damping, velocity, acceleration)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2)
    real(wp), intent(inout) :: velocity(:, :), acceleration(:, :) !! (2, n_node)
    real(wp) :: push, rate, a, before(2)
    integer :: i, k

    do i = 1, size(model%conditions%common_motions)
      before = coupled_velocity(model, i, state)
      associate (nodes => model%conditions%common_motions(i)%nodes)
        do k = 1, 2
          if (.not. model%conditions%common_motions(i)%along(k)) cycle
          call coupled_acceleration(model, i, k, state, damping, push, rate)
          a = (push - rate*before(k))/(1.0_wp + 0.5_wp*rate*state%dt_before)
          acceleration(k, nodes) = a
          velocity(k, nodes) = before(k) + 0.5_wp*state%dt_before*a
        end do
      end associate
    end do
  end subroutine fill_coupled_nodes

end module coupled_nodes_m
