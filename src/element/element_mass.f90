! SPDX-License-Identifier: MIT
!> Masses. Lumped: a quarter of each quad, a third of each triangle to its nodes; in axisymmetric
!> bodies the row sums of the consistent mass. Consistent: rho times the integral of N_a N_b over
!> the initial shape, which 2x2 Gauss points integrate exactly for quads and triangles; of N_a N_b r
!> in axisymmetric bodies, of one degree more than 2x2 points hold: 3x3. Elements with nodes of a
!> rigid body are lumped, since the masses of those nodes are the body's.
module element_mass_m
  use hanging_nodes_m, only : share_hanging_forces
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use mesh_m, only : mesh_t
  use model_m, only : model_t
  use rigids_m, only : rigid_t, mark_rigid_nodes
  use quad_points_m, only : n_point, point_areas, shape_at_points
  use sparse_m, only : sparse_t, add_block
  implicit none
  private
  public :: add_mass, mass_times, sum_part_motion, lump_mass, element_shares, node_volumes, &
    element_volume

contains

  !> Add `factor` times the mass matrix, or the matrix of mass damping.
  pure subroutine add_mass(model, factor, equation, matrix, rates)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: factor
    integer, intent(in) :: equation(:, :)   !! (2, n_node) equation numbers, 0 = none
    type(sparse_t), intent(inout) :: matrix !! started, not compressed
    real(wp), intent(in), optional :: rates(:, :) !! (2, n_part + 1) D of each part and of lumped
                                                  !! masses, 1/s; absent: 1
    real(wp) :: mass(4, 4), weights(2, size(model%parts) + 1)
    logical :: is_rigid(model%mesh%n_node)
    integer :: i, k

    weights = 1.0_wp
    if (present(rates)) weights = rates
    is_rigid = mark_rigid_nodes(model%rigids, model%mesh%n_node)
    do i = 1, model%mesh%n_element
      mass = factor*element_mass(model, i, is_rigid)
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

  !> Product of the mass matrix, or the matrix of mass damping, and a nodal vector; that of hanging
  !> nodes is shared by their parents.
  pure function mass_times(model, lumped, vector, rates) result(product)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: lumped(:)    !! (n_node) lumped masses, for the nodes of rigid bodies
    real(wp), intent(in) :: vector(:, :) !! (2, n_node)
    real(wp), intent(in), optional :: rates(:, :) !! (2, n_part + 1) D of each part and of lumped
                                                  !! masses, 1/s; absent: 1
    real(wp) :: product(2, size(vector, 2))
    real(wp) :: mass(4, 4), part(2, 4), weights(2, size(model%parts) + 1)
    logical :: is_rigid(model%mesh%n_node)
    integer :: i, k

    weights = 1.0_wp
    if (present(rates)) weights = rates
    product = 0.0_wp
    is_rigid = mark_rigid_nodes(model%rigids, model%mesh%n_node)
    do i = 1, model%mesh%n_element
      mass = element_mass(model, i, is_rigid)
      associate (nodes => model%mesh%element_nodes(:, i), &
        weight => weights(:, model%mesh%element_part(i)))
        part = matmul(vector(:, nodes), mass)
        do k = 1, 4
          product(:, nodes(k)) = product(:, nodes(k)) + weight*part(:, k)
        end do
      end associate
    end do
    if (allocated(model%conditions%lumped_masses)) then
      do i = 1, size(model%conditions%lumped_masses)
        associate (lump => model%conditions%lumped_masses(i))
          product(:, lump%node) = product(:, lump%node) + weights(:, size(weights, 2))*lump%mass &
            *vector(:, lump%node)
        end associate
      end do
    end if
    do i = 1, size(model%rigids)
      associate (nodes => model%rigids(i)%nodes, weight => weights(:, model%rigids(i)%part))
        product(:, nodes) = spread(weight, 2, size(nodes))*spread(lumped(nodes), 1, 2) &
          *vector(:, nodes)
      end associate
    end do
    call share_hanging_forces(model%mesh, product)
  end function mass_times

  !> Kinetic energy and momentum of each part.
  pure subroutine sum_part_motion(model, velocity, kinetic, momentum)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: velocity(:, :)  !! (2, n_node)
    real(wp), intent(out) :: kinetic(:)     !! (n_part) J/m, or J per radian
    real(wp), intent(out) :: momentum(:, :) !! (2, n_part) kg/s
    real(wp) :: v(2, 4), p(2, 4)
    logical :: is_rigid(model%mesh%n_node)
    integer :: i, part

    kinetic = 0.0_wp
    momentum = 0.0_wp
    is_rigid = mark_rigid_nodes(model%rigids, model%mesh%n_node)
    do i = 1, model%mesh%n_element
      part = model%mesh%element_part(i)
      v = velocity(:, model%mesh%element_nodes(:, i))
      p = matmul(v, element_mass(model, i, is_rigid))
      kinetic(part) = kinetic(part) + 0.5_wp*sum(v*p)
      momentum(:, part) = momentum(:, part) + sum(p, 2)
    end do
  end subroutine sum_part_motion

  !> Mass matrix of one element, one direction.
  pure function element_mass(model, i, is_rigid) result(mass)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    logical, intent(in) :: is_rigid(:) !! (n_node) nodes of rigid bodies
    real(wp) :: mass(4, 4)
    real(wp) :: x(2, 4), areas(n_point)
    integer :: b, k

    if (any(is_rigid(model%mesh%element_nodes(:, i)))) then
      areas = lumped_shares(model, model%mesh%element_part(i), model%mesh%element_nodes(:, i))
      mass = 0.0_wp
      do k = 1, 4
        mass(k, k) = areas(k)
      end do
      return
    end if
    x = model%mesh%coordinates(:, model%mesh%element_nodes(:, i))
    if (model%is_axisymmetric) then
      mass = axisym_mass(x)
    else
      areas = point_areas(x)
      mass = 0.0_wp
      do k = 1, n_point
        do b = 1, 4
          mass(:, b) = mass(:, b) + areas(k)*shape_at_points(b, k)*shape_at_points(:, k)
        end do
      end do
    end if
    associate (part => model%parts(model%mesh%element_part(i)))
      mass = model%materials(part%material)%density*model%sections(part%section)%thickness*mass
    end associate
  end function element_mass

  !> Lumped masses of all nodes.
  subroutine lump_mass(model, mass)
    type(model_t), intent(in) :: model
    real(wp), allocatable, intent(out) :: mass(:) !! (n_node) kg per metre of depth or per radian
    real(wp) :: shares(4)
    integer :: i, k

    allocate (mass(model%mesh%n_node), source=0.0_wp)
    if (allocated(model%conditions%lumped_masses)) then
      do i = 1, size(model%conditions%lumped_masses)
        associate (lump => model%conditions%lumped_masses(i))
          mass(lump%node) = mass(lump%node) + lump%mass
        end associate
      end do
    end if
    do i = 1, model%mesh%n_element
      associate (nodes => model%mesh%element_nodes(:, i))
        shares = lumped_shares(model, model%mesh%element_part(i), nodes)
        do k = 1, 4
          mass(nodes(k)) = mass(nodes(k)) + shares(k)
        end do
      end associate
    end do
    if (.not. allocated(model%rigids)) return
    do i = 1, size(model%rigids)
      if (.not. model%rigids(i)%has_inertia) cycle
      associate (body => model%rigids(i))
        mass(body%nodes) = given_masses(body, model%mesh%coordinates(:, body%nodes), &
          mass(body%nodes))
      end associate
    end do
  end subroutine lump_mass

  !> Masses m_a (w_1 + w_2 x_a + w_3 y_a + w_4 r_a^2) at the nodes of a rigid body, x and y from the
  !> centre of mass, that have its mass, centre of mass and moment of inertia; -1 where there are
  !> none.
  pure function given_masses(body, positions, mass) result(given)
    type(rigid_t), intent(in) :: body
    real(wp), intent(in) :: positions(:, :), mass(:) !! (2, n), (n) of its nodes
    real(wp) :: given(size(mass))
    real(wp) :: terms(4, size(mass)), gram(4, 5), length, largest
    integer :: i, k

    terms(1, :) = 1.0_wp
    terms(2:3, :) = positions - spread(body%given_centre, 2, size(mass))
    length = maxval(abs(terms(2:3, :)))
    terms(2:3, :) = terms(2:3, :)/length
    terms(4, :) = terms(2, :)**2 + terms(3, :)**2
    do i = 1, 4
      do k = 1, 4
        gram(k, i) = sum(mass*terms(i, :)*terms(k, :))
      end do
    end do
    gram(:, 5) = [body%given_mass, 0.0_wp, 0.0_wp, body%given_moment/length**2]
    largest = gram(1, 1)
    given = -1.0_wp
    ! Elimination: the matrix is symmetric and positive definite.
    do i = 1, 4
      if (.not. gram(i, i) > 1.0e-10_wp*largest) return
      gram(i, :) = gram(i, :)/gram(i, i)
      do k = 1, 4
        if (k /= i) gram(k, :) = gram(k, :) - gram(k, i)*gram(i, :)
      end do
    end do
    given = mass*matmul(gram(:, 5), terms)
  end function given_masses

  !> Masses at the four nodes of the element in a slot, from its density; 0 at the fourth node of a
  !> triangle.
  pure function element_shares(model, slot) result(shares)
    type(model_t), intent(in) :: model
    integer, intent(in) :: slot
    real(wp) :: shares(4) !! kg per metre of depth or per radian

    shares = lumped_shares(model, slot_part(model%layout, slot), model%layout%slot_nodes(:, slot))
  end function element_shares

  !> Masses at the four nodes of an element of a part; 0 at the fourth node of a triangle.
  pure function lumped_shares(model, part, nodes) result(shares)
    type(model_t), intent(in) :: model
    integer, intent(in) :: part, nodes(4)
    real(wp) :: shares(4)
    real(wp) :: x(2, 4)
    integer :: corners

    x = model%mesh%coordinates(:, nodes)
    corners = merge(3, 4, nodes(4) == nodes(3))
    associate (density => model%materials(model%parts(part)%material)%density)
      if (model%is_axisymmetric) then
        shares = density*node_volumes(x, corners == 3)
      else
        shares = density*(0.5_wp*((x(1, 3) - x(1, 1))*(x(2, 4) - x(2, 2)) &
          - (x(1, 4) - x(1, 2))*(x(2, 3) - x(2, 1))))/corners
        shares = model%sections(model%parts(part)%section)%thickness*shares
        shares(corners + 1:) = 0.0_wp
      end if
    end associate
  end function lumped_shares

  !> Integrals of N_a r over one quad or triangle, per radian: its volume by nodes. 2x2 Gauss points
  !> are exact. A triangle's third node gets the shares of both its positions, its fourth none.
  pure function node_volumes(x, is_triangle) result(volumes)
    real(wp), intent(in) :: x(2, 4) !! corners, x(1, :) the radii
    logical, intent(in) :: is_triangle
    real(wp) :: volumes(4)

    volumes = matmul(shape_at_points, point_areas(x)*matmul(x(1, :), shape_at_points))
    if (.not. is_triangle) return
    volumes(3) = volumes(3) + volumes(4)
    volumes(4) = 0.0_wp
  end function node_volumes

  !> Integrals of N_a N_b r over one quad or triangle, per radian: 3x3 Gauss points are exact.
  pure function axisym_mass(x) result(mass)
    real(wp), intent(in) :: x(2, 4) !! corners, x(1, :) the radii
    real(wp) :: mass(4, 4)
    real(wp), parameter :: outer = sqrt(0.15_wp)
    real(wp), parameter :: at(3) = [0.5_wp - outer, 0.5_wp, 0.5_wp + outer], &
      weight(3) = [5.0_wp, 8.0_wp, 5.0_wp]/18.0_wp
    real(wp) :: shape(4), along(2), across(2), factor
    integer :: b, i, j

    mass = 0.0_wp
    do i = 1, 3
      do j = 1, 3
        shape = [(1.0_wp - at(i))*(1.0_wp - at(j)), at(i)*(1.0_wp - at(j)), at(i)*at(j), &
          (1.0_wp - at(i))*at(j)]
        along = (1.0_wp - at(j))*(x(:, 2) - x(:, 1)) + at(j)*(x(:, 3) - x(:, 4))
        across = (1.0_wp - at(i))*(x(:, 4) - x(:, 1)) + at(i)*(x(:, 3) - x(:, 2))
        factor = weight(i)*weight(j)*dot_product(shape, x(1, :))*(along(1)*across(2) &
          - along(2)*across(1))
        do b = 1, 4
          mass(:, b) = mass(:, b) + factor*shape(b)*shape
        end do
      end do
    end do
  end function axisym_mass

  !> Initial volume of element i, per radian, and its first moments.
  pure function element_volume(mesh, i) result(moments)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: i
    real(wp) :: moments(3)
    real(wp) :: x(2, 4), volumes(4)

    associate (nodes => mesh%element_nodes(:, i))
      x = mesh%coordinates(:, nodes)
      volumes = node_volumes(x, nodes(4) == nodes(3))
    end associate
    moments = [sum(volumes), sum(volumes*x(1, :)), sum(volumes*x(2, :))]
  end function element_volume

end module element_mass_m
