! SPDX-License-Identifier: MIT
!> Points that open and points that close, told apart and scaled apart: the first return energy, the
!> others take it (doc/theory/contact.md, section 6.1).
module point_scaling_m
  use contact_scatter_m, only : scatter_forces, scatter_friction
  use contact_state_m, only : contact_points_t, contact_state_t, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: sum_closing, scale_points

contains

  !> Nodal forces of the springs, without damping, at points that close.
  pure subroutine sum_closing(points, velocity, force)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in), contiguous :: velocity(:, :) !! (2, n) by local node, m/s
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, n) set here, N/m
    real(wp) :: push(2)
    integer :: p, k

    force = 0.0_wp
    do p = 1, points%n
      if (opens(points, velocity, p)) cycle
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

  !> Whether the gap of a point grows.
  pure function opens(points, velocity, p)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in), contiguous :: velocity(:, :)
    integer, intent(in) :: p
    logical :: opens
    real(wp) :: speed(2)

    speed = matmul(velocity(:, points%slave_nodes(:, p)), points%slave_weights(:, p)) &
      - matmul(velocity(:, points%master_nodes(:, p)), points%master_weights(:, p))
    opens = dot_product(speed, points%normal(:, p)) > 0.0_wp
  end function opens

  !> Scale all that acts in this cycle, point by point: pairs of forces stay pairs. What a law
  !> remembers stays as it is.
  pure subroutine scale_points(factors, velocity, memory)
    real(wp), intent(in) :: factors(2) !! of points that open and that close
    real(wp), intent(in), contiguous :: velocity(:, :) !! (2, n_slave + n_master)
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: factor
    integer :: p, n_active

    n_active = memory%n_active
    associate (points => memory%points)
      if (allocated(memory%node_pressure)) call scale_nodal(factors, velocity, memory)
      do p = 1, points%n
        factor = merge(factors(1), factors(2), opens(points, velocity, p))
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
  pure subroutine scale_nodal(factors, velocity, memory)
    real(wp), intent(in) :: factors(2) !! of points that open and that close
    real(wp), intent(in), contiguous :: velocity(:, :) !! (2, n_slave + n_master)
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
            sums(2, node) = sums(2, node) &
              + push*merge(factors(1), factors(2), opens(points, velocity, p))
          end associate
        end do
      end do
      where (sums(1, :n) > 0.0_wp) memory%node_pressure = memory%node_pressure &
        *(sums(2, :n)/sums(1, :n))
    end associate
  end subroutine scale_nodal

end module point_scaling_m
