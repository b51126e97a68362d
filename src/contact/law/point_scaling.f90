! SPDX-License-Identifier: MIT
!> Points that open and points that close, told apart and scaled apart: the first return energy, the
!> others take it (doc/theory/contact.md, section 6.1).
module point_scaling_m
  use contact_scatter_m, only : scatter_forces, scatter_friction
  use contact_state_m, only : contact_points_t, contact_state_t, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: split_t, find_closing, sum_closing, scale_points

  !> Points of a cycle told apart.
  type :: split_t
    real(wp) :: factors(2) = 1.0_wp   !! of points that do not close, and of points that do
    logical, allocatable :: closes(:) !! (n) of each point; only where a factor is below 1
  end type split_t

contains

  !> The points whose gap falls, with the velocities behind and with those to come: stiff springs
  !> turn round within a step, and such a point already returns what it takes.
  pure subroutine find_closing(points, behind, ahead, closes)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in), contiguous :: behind(:, :), ahead(:, :) !! (2, n) by local node, m/s
    logical, intent(inout) :: closes(:)                           !! (points%n)
    integer :: p

    do p = 1, points%n
      closes(p) = max(opening_rate(points, behind, p), opening_rate(points, ahead, p)) <= 0.0_wp
    end do
  end subroutine find_closing

  !> How fast the gap of a point grows.
  pure function opening_rate(points, velocity, p) result(rate)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in), contiguous :: velocity(:, :)
    integer, intent(in) :: p
    real(wp) :: rate !! m/s

    rate = dot_product(points%normal(:, p), matmul(velocity(:, points%slave_nodes(:, p)), &
      points%slave_weights(:, p)) - matmul(velocity(:, points%master_nodes(:, p)), &
      points%master_weights(:, p)))
  end function opening_rate

  !> Nodal forces of the springs, without damping, at points that close.
  pure subroutine sum_closing(points, closes, force)
    type(contact_points_t), intent(in) :: points
    logical, intent(in) :: closes(:)                   !! (points%n)
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, n) set here, N/m
    real(wp) :: push(2)
    integer :: p, k

    force = 0.0_wp
    do p = 1, points%n
      if (.not. closes(p)) cycle
      push = points%pressure(p)*points%area(p)*points%normal(:, p)
      if (allocated(points%load)) push = push - points%load(3:4, p)
      do k = 1, n_side
        associate (a => points%slave_nodes(k, p), b => points%master_nodes(k, p))
          force(:, a) = force(:, a) + points%slave_weights(k, p)*push
          force(:, b) = force(:, b) - points%master_weights(k, p)*push
        end associate
      end do
    end do
  end subroutine sum_closing

  !> Scale all that acts in this cycle, point by point: pairs of forces stay pairs. What a law
  !> remembers stays as it is.
  pure subroutine scale_points(split, memory)
    type(split_t), intent(in) :: split
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: factor
    integer :: p, n_active

    n_active = memory%n_active
    associate (points => memory%points)
      if (allocated(memory%node_pressure)) call scale_nodal(split, memory)
      do p = 1, points%n
        factor = factor_of(split, p)
        points%pressure(p) = factor*points%pressure(p)
        if (allocated(points%load)) points%load(:, p) = factor*points%load(:, p)
        if (allocated(points%traction)) points%traction(p) = factor*points%traction(p)
      end do
    end associate
    memory%force = 0.0_wp
    if (allocated(memory%damping_force)) memory%damping_force = 0.0_wp
    call scatter_forces(memory)
    if (allocated(memory%friction%force)) then
      memory%friction%force = 0.0_wp
      call scatter_friction(memory)
    end if
    memory%n_active = n_active
  end subroutine scale_points

  !> Nodal pressures by the mean factor of their points.
  pure subroutine scale_nodal(split, memory)
    type(split_t), intent(in) :: split
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: push
    integer :: p, k

    associate (points => memory%points, n => memory%n_slave, sums => memory%scratch%nodal)
      sums(:, :n) = 0.0_wp
      do p = 1, points%n
        do k = 1, n_side
          push = points%slave_weights(k, p)*points%pressure(p)*points%area(p)
          associate (node => points%slave_nodes(k, p))
            sums(1, node) = sums(1, node) + push
            sums(2, node) = sums(2, node) + push*factor_of(split, p)
          end associate
        end do
      end do
      where (sums(1, :n) > 0.0_wp) memory%node_pressure = memory%node_pressure &
        *(sums(2, :n)/sums(1, :n))
    end associate
  end subroutine scale_nodal

  !> The factor of a point.
  pure function factor_of(split, p) result(factor)
    type(split_t), intent(in) :: split
    integer, intent(in) :: p
    real(wp) :: factor

    factor = split%factors(merge(2, 1, split%closes(p)))
  end function factor_of

end module point_scaling_m
