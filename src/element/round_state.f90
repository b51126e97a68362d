! SPDX-License-Identifier: MIT
!> Round elements beside the step: reference shape, row-sum masses, volume ratios.
module round_state_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use mesh_m, only : mesh_t
  use model_m, only : model_t
  use round_chunk_m, only : node_volumes, reference_inverse, reference_mass, &
    reference_sum
  use volumetric_m, only : log_ratio
  implicit none
  private
  public :: fill_round_reference, add_round_masses, round_mass, round_ratios, &
    element_volume, hoop_strains

contains

  !> Sum of the radii, 1/V and density over nodal mass of slots; padding is its chunk's first
  !> element, larger by the factor that its diagonals are.
  subroutine fill_round_reference(model, from, to, reference)
    type(model_t), intent(in) :: model
    integer, intent(in) :: from, to            !! slots
    real(wp), intent(inout) :: reference(:, :) !! (n_slot, n_round_reference)
    real(wp) :: x(2, 4), volumes(4), factor
    integer :: i, first

    do i = from, to
      first = i - mod(i - 1, chunk_size)
      if (model%layout%slot_element(i) == 0) then
        factor = maxval(abs(reference(i, 1:4)))/maxval(abs(reference(first, 1:4)))
        reference(i, reference_sum) = factor*reference(first, reference_sum)
        reference(i, reference_inverse:) = reference(first, reference_inverse:)/factor**3
        cycle
      end if
      associate (nodes => model%layout%slot_nodes(:, i))
        x = model%mesh%coordinates(:, nodes)
        volumes = node_volumes(x, nodes(4) == nodes(3))
        reference(i, reference_sum) = sum(x(1, :))
        reference(i, reference_inverse) = 1.0_wp/sum(volumes)
        reference(i, reference_mass:) = 0.0_wp
        where (volumes > 0.0_wp) reference(i, reference_mass:) = 1.0_wp/volumes
      end associate
    end do
  end subroutine fill_round_reference

  !> Add rho times the integral of N_a r over the initial shapes.
  subroutine add_round_masses(model, mass)
    type(model_t), intent(in) :: model
    real(wp), intent(inout) :: mass(:) !! (n_node) kg per radian
    real(wp) :: x(2, 4), volumes(4)
    integer :: i, k

    do i = 1, model%mesh%n_element
      associate (nodes => model%mesh%element_nodes(:, i), &
        material => model%materials(model%parts(model%mesh%element_part(i))%material))
        x = model%mesh%coordinates(:, nodes)
        volumes = node_volumes(x, nodes(4) == nodes(3))
        do k = 1, 4
          mass(nodes(k)) = mass(nodes(k)) + material%density*volumes(k)
        end do
      end associate
    end do
  end subroutine add_round_masses

  !> Integrals of N_a N_b r over one quad or triangle, per radian: 3x3 Gauss points are exact.
  pure function round_mass(x) result(mass)
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
  end function round_mass

  !> V/V0 - 1 and V0 of the element in a slot, to the digits of the displacement.
  pure subroutine round_ratios(model, slot, u, stretch, start)
    type(model_t), intent(in) :: model
    integer, intent(in) :: slot
    real(wp), intent(in) :: u(2, 4)            !! displacement of the nodes
    real(wp), intent(out) :: stretch, start    !! start per radian
    real(wp), dimension(2) :: a, b, h, da, db, dh
    real(wp) :: x(2, 4), s, ds

    x = model%mesh%coordinates(:, model%layout%slot_nodes(:, slot))
    call patterns(x, a, b, h, s)
    call patterns(u, da, db, dh, ds)
    start = 0.25_wp*s*area(a, b) + (h(1)*cross(a, b) - 2.0_wp*a(1)*b(1)*h(2))/24.0_wp
    stretch = 0.25_wp*(s*(area(a, db) + area(da, b + db)) + ds*area(a + da, b + db)) &
      + (h(1)*(cross(a, db) + cross(da, b + db)) + dh(1)*cross(a + da, b + db) &
      - 2.0_wp*(a(1)*b(1)*dh(2) + (a(1)*db(1) + da(1)*(b(1) + db(1)))*(h(2) + dh(2))))/24.0_wp
    stretch = stretch/start
  end subroutine round_ratios

  !> Logarithmic hoop strain of all elements in deck order: ln of the mean radius, over the initial
  !> area, that the motion gives, over that of the start.
  subroutine hoop_strains(model, motion, strain)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: motion(:, :)     !! (4, n_node)
    real(wp), intent(inout) :: strain(:)     !! (n_element)
    real(wp) :: x(2, 4), u(2, 4)
    integer :: i, slot

    do slot = 1, model%layout%n_slot
      i = model%layout%slot_element(slot)
      if (i == 0) cycle
      x = model%mesh%coordinates(:, model%layout%slot_nodes(:, slot))
      u = motion(1:2, model%layout%slot_nodes(:, slot))
      strain(i) = log_ratio(area_integral(x, u)/area_integral(x, x))
    end do
  end subroutine hoop_strains

  !> Integral over a quad of the bilinear field through the first components of `values`: the sum
  !> of M_a times them.
  pure real(wp) function area_integral(x, values)
    real(wp), intent(in) :: x(2, 4)      !! corners
    real(wp), intent(in) :: values(2, 4)
    real(wp) :: a(2), b(2), h(2), da(2), db(2), dh(2), s, ds

    call patterns(x, a, b, h, s)
    call patterns(values, da, db, dh, ds)
    area_integral = 0.25_wp*ds*area(a, b) + (da(1)*(h(1)*b(2) - h(2)*b(1)) &
      + db(1)*(h(1)*a(2) - h(2)*a(1)))/24.0_wp
  end function area_integral

  !> Diagonals, h and the sum of the first components.
  pure subroutine patterns(x, a, b, h, s)
    real(wp), intent(in) :: x(2, 4)
    real(wp), intent(out) :: a(2), b(2), h(2), s

    a = x(:, 3) - x(:, 1)
    b = x(:, 4) - x(:, 2)
    h = (x(:, 1) - x(:, 2)) + (x(:, 3) - x(:, 4))
    s = sum(x(1, :))
  end subroutine patterns

  !> Half of a_r b_z - b_r a_z.
  pure real(wp) function area(a, b)
    real(wp), intent(in) :: a(2), b(2)

    area = 0.5_wp*(a(1)*b(2) - b(1)*a(2))
  end function area

  !> a_r b_z + b_r a_z.
  pure real(wp) function cross(a, b)
    real(wp), intent(in) :: a(2), b(2)

    cross = a(1)*b(2) + b(1)*a(2)
  end function cross

  !> Volume of element i at the start, per radian, and its first moments.
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

end module round_state_m
