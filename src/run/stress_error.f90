! SPDX-License-Identifier: MIT
!> Error of each element by Zienkiewicz & Zhu (1987): the elastic energy of the difference between
!> its stress and the field that interpolates the means at the nodes, over the elements of the same
!> part. Hanging nodes have the mean of their parents.
module stress_error_m
  use element_state_m, only : is_eroded
  use hanging_nodes_m, only : share_hanging_forces, move_hanging_nodes
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use parts_m, only : material_t
  use quad_points_m, only : n_point, point_areas, shape_at_points
  use state_m, only : state_t
  implicit none
  private
  public :: estimate_errors, energy_density

contains

  !> Errors of all elements; 0 where they are rigid or eroded.
  subroutine estimate_errors(model, state, stress, errors)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: stress(:, :) !! (6, n_element) xx yy zz xy yz xz, Pa
    real(wp), intent(out) :: errors(:)   !! (n_element) J per metre of depth or per radian
    real(wp), allocatable :: means(:, :) !! (5, n_node) four stresses times volume, and volume
    real(wp) :: volumes(n_point), at_points(4, n_point)
    integer :: part, slot, i, k

    errors = 0.0_wp
    allocate (means(5, model%mesh%n_node))
    do part = 1, size(model%parts)
      associate (material => model%materials(model%parts(part)%material))
        if (material%is_rigid .or. .not. any(model%layout%chunk_part == part)) cycle
        means = 0.0_wp
        do slot = 1, model%layout%n_slot
          if (.not. counts(slot)) cycle
          i = model%layout%slot_element(slot)
          volumes = volumes_of(slot)
          do k = 1, merge(3, 4, is_triangle(slot))
            associate (node => model%layout%slot_nodes(k, slot))
              means(:, node) = means(:, node) + sum(volumes)*[stress(1:4, i), 1.0_wp]
            end associate
          end do
        end do
        call share_hanging_forces(model%mesh, means)
        do k = 1, size(means, 2)
          if (means(5, k) > 0.0_wp) means(1:4, k) = means(1:4, k)/means(5, k)
        end do
        call move_hanging_nodes(model%mesh, means)
        do slot = 1, model%layout%n_slot
          if (.not. counts(slot)) cycle
          i = model%layout%slot_element(slot)
          at_points = matmul(means(1:4, model%layout%slot_nodes(:, slot)), shape_at_points)
          volumes = volumes_of(slot)
          do k = 1, n_point
            errors(i) = errors(i) + volumes(k)*energy_density(material, at_points(:, k) &
              - stress(1:4, i))
          end do
        end do
      end associate
    end do

  contains

    !> Whether the slot has an element of the part that has not eroded.
    logical function counts(slot)
      integer, intent(in) :: slot

      counts = model%layout%slot_element(slot) > 0 &
        .and. model%layout%chunk_part((slot - 1)/chunk_size + 1) == part
      if (counts) counts = .not. is_eroded(state%elements, slot)
    end function counts

    !> Whether the element repeats its third node.
    logical function is_triangle(slot)
      integer, intent(in) :: slot

      associate (nodes => model%layout%slot_nodes(:, slot))
        is_triangle = nodes(4) == nodes(3)
      end associate
    end function is_triangle

    !> Volumes of the points of an element, m^2, times thickness or radius.
    function volumes_of(slot) result(volumes)
      integer, intent(in) :: slot
      real(wp) :: volumes(n_point)
      real(wp) :: x(2, 4)

      associate (nodes => model%layout%slot_nodes(:, slot))
        x = model%mesh%coordinates(:, nodes) + state%motion(1:2, nodes)
      end associate
      volumes = point_areas(x)*model%sections(model%parts(part)%section)%thickness
      if (model%is_axisymmetric) volumes = volumes*matmul(x(1, :), shape_at_points)
    end function volumes_of

  end subroutine estimate_errors

  !> Elastic energy of a stress from the moduli K and G of the material, J/m^3.
  pure function energy_density(material, stress) result(density)
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: stress(4) !! xx yy zz xy
    real(wp) :: density
    real(wp) :: mean

    mean = sum(stress(1:3))/3.0_wp
    density = 0.0_wp
    if (material%bulk > 0.0_wp) density = 0.5_wp*mean**2/material%bulk
    if (material%shear > 0.0_wp) density = density + 0.25_wp*(sum((stress(1:3) - mean)**2) &
      + 2.0_wp*stress(4)**2)/material%shear
  end function energy_density

end module stress_error_m
