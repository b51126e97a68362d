! SPDX-License-Identifier: MIT
!> Consistent mass: rho times the integral of N_a N_b over the initial shape, which 2x2 Gauss points
!> integrate exactly for quads and triangles; of N_a N_b r in round bodies, of one degree more than
!> 2x2 points hold: 3x3.
module element_mass_m
  use kinds_m, only : wp
  use model_m, only : model_t
  use quad_points_m, only : n_point, point_areas, shape_at_points
  use round_state_m, only : round_mass
  use sparse_m, only : sparse_t, add_block
  implicit none
  private
  public :: add_mass, mass_times, sum_part_motion

contains

  !> Add `factor` times the mass matrix, or that of damping by mass.
  pure subroutine add_mass(model, factor, equation, matrix, rates)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: factor
    integer, intent(in) :: equation(:, :)   !! (2, n_node) equation numbers, 0 = none
    type(sparse_t), intent(inout) :: matrix !! started, not compressed
    real(wp), intent(in), optional :: rates(:, :) !! (2, n_part + 1) D of each part and of masses on
                                            !! nodes, 1/s; absent: 1
    real(wp) :: mass(4, 4), weights(2, size(model%parts) + 1)
    integer :: i, k

    weights = 1.0_wp
    if (present(rates)) weights = rates

    do i = 1, model%mesh%n_element
      mass = factor*element_mass(model, i)
      associate (nodes => model%mesh%element_nodes(:, i))
        do k = 1, 2
          call add_block(matrix, equation(k, nodes), equation(k, nodes), &
            weights(k, model%mesh%element_part(i))*mass)
        end do
      end associate
    end do
    if (.not. allocated(model%conditions%lumped_masses)) return
    do i = 1, size(model%conditions%lumped_masses)
      associate (lump => model%conditions%lumped_masses(i))
        do k = 1, 2
          call add_block(matrix, equation(k, [lump%node]), equation(k, [lump%node]), &
            reshape([weights(k, size(weights, 2))*factor*lump%mass], [1, 1]))
        end do
      end associate
    end do
  end subroutine add_mass

  !> The mass matrix, or that of damping by mass, times a nodal vector.
  pure function mass_times(model, vector, rates) result(product)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: vector(:, :) !! (2, n_node)
    real(wp), intent(in), optional :: rates(:, :) !! as above
    real(wp) :: product(2, size(vector, 2))
    real(wp) :: mass(4, 4), part(2, 4), weights(2, size(model%parts) + 1)
    integer :: i, k

    weights = 1.0_wp
    if (present(rates)) weights = rates
    product = 0.0_wp
    do i = 1, model%mesh%n_element
      mass = element_mass(model, i)
      associate (nodes => model%mesh%element_nodes(:, i), &
        weight => weights(:, model%mesh%element_part(i)))
        part = matmul(vector(:, nodes), mass)
        do k = 1, 4
          product(:, nodes(k)) = product(:, nodes(k)) + weight*part(:, k)
        end do
      end associate
    end do
    if (.not. allocated(model%conditions%lumped_masses)) return
    do i = 1, size(model%conditions%lumped_masses)
      associate (lump => model%conditions%lumped_masses(i))
        product(:, lump%node) = product(:, lump%node) + weights(:, size(weights, 2))*lump%mass &
          *vector(:, lump%node)
      end associate
    end do
  end function mass_times

  !> Kinetic energy and momentum of each part.
  pure subroutine sum_part_motion(model, velocity, kinetic, momentum)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: velocity(:, :)  !! (2, n_node)
    real(wp), intent(out) :: kinetic(:)     !! (n_part) J/m, or J per radian
    real(wp), intent(out) :: momentum(:, :) !! (2, n_part) kg/s
    real(wp) :: v(2, 4), p(2, 4)
    integer :: i, part

    kinetic = 0.0_wp
    momentum = 0.0_wp
    do i = 1, model%mesh%n_element
      part = model%mesh%element_part(i)
      v = velocity(:, model%mesh%element_nodes(:, i))
      p = matmul(v, element_mass(model, i))
      kinetic(part) = kinetic(part) + 0.5_wp*sum(v*p)
      momentum(:, part) = momentum(:, part) + sum(p, 2)
    end do
  end subroutine sum_part_motion

  !> Mass matrix of one element, one direction.
  pure function element_mass(model, i) result(mass)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    real(wp) :: mass(4, 4)
    real(wp) :: x(2, 4), areas(n_point)
    integer :: b, k

    x = model%mesh%coordinates(:, model%mesh%element_nodes(:, i))
    if (model%is_round) then
      mass = round_mass(x)
    else
      areas = point_areas(x)
      mass = 0.0_wp
      do k = 1, n_point
        do b = 1, 4
          mass(:, b) = mass(:, b) + areas(k)*shape_at_points(b, k)*shape_at_points(:, k)
        end do
      end do
    end if
    mass = model%materials(model%parts(model%mesh%element_part(i))%material)%density*mass
  end function element_mass

end module element_mass_m
