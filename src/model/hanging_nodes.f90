! SPDX-License-Identifier: MIT
!> Hanging nodes (*CONSTRAINED_ADAPTIVITY): u is the mean of the two parents, forces and lumped
!> masses go half to each. The half masses are the row sums of the condensed mass matrix, and
!> v_p^2/2 + v_q^2/2 >= ((v_p + v_q)/2)^2: no frequency rises, so that the bound of the elements on
!> the step holds (doc/theory/time_integration.md, hanging nodes).
module hanging_nodes_m
  use kinds_m, only : wp
  use layout_m, only : layout_t
  use mesh_m, only : mesh_t
  implicit none
  private
  public :: move_hanging_nodes, share_hanging_masses, share_hanging_forces, add_hanging_forces

contains

  !> Set a nodal field at hanging nodes to the mean of their parents.
  pure subroutine move_hanging_nodes(mesh, field)
    type(mesh_t), intent(in) :: mesh
    real(wp), intent(inout) :: field(:, :) !! (any, n_node)
    integer :: i

    if (.not. allocated(mesh%hanging)) return
    do i = 1, size(mesh%hanging, 2)
      field(:, mesh%hanging(1, i)) = 0.5_wp*(field(:, mesh%hanging(2, i)) &
        + field(:, mesh%hanging(3, i)))
    end do
  end subroutine move_hanging_nodes

  !> Move the masses of hanging nodes to their parents.
  pure subroutine share_hanging_masses(mesh, mass)
    type(mesh_t), intent(in) :: mesh
    real(wp), intent(inout) :: mass(:) !! (n_node)
    integer :: i

    if (.not. allocated(mesh%hanging)) return
    do i = 1, size(mesh%hanging, 2)
      associate (node => mesh%hanging(1, i), parents => mesh%hanging(2:3, i))
        mass(parents) = mass(parents) + 0.5_wp*mass(node)
        mass(node) = 0.0_wp
      end associate
    end do
  end subroutine share_hanging_masses

  !> Move forces at hanging nodes to their parents.
  pure subroutine share_hanging_forces(mesh, force)
    type(mesh_t), intent(in) :: mesh
    real(wp), intent(inout) :: force(:, :) !! (any, n_node)
    integer :: k, i

    if (.not. allocated(mesh%hanging)) return
    do i = 1, size(mesh%hanging, 2)
      associate (node => mesh%hanging(1, i))
        do k = 2, 3
          force(:, mesh%hanging(k, i)) = force(:, mesh%hanging(k, i)) + 0.5_wp*force(:, node)
        end do
        force(:, node) = 0.0_wp
      end associate
    end do
  end subroutine share_hanging_forces

  !> Add half of the forces at hanging nodes to the internal forces of their parents among the
  !> special nodes first .. last, from the slots, so that no other sum need be known.
  pure subroutine add_hanging_forces(mesh, layout, slots, special, range, internal)
    type(mesh_t), intent(in) :: mesh
    type(layout_t), intent(in) :: layout
    real(wp), intent(in), contiguous :: slots(:, :)       !! (2, slots) internal forces of tiles
    real(wp), intent(in), contiguous :: special(:, :)     !! (2, n_special) other forces
    integer, intent(in) :: range(2)                       !! first and last node
    real(wp), intent(inout), contiguous :: internal(:, :) !! (2, n_node)
    real(wp) :: force(2)
    integer :: first, i, k, above

    if (.not. allocated(mesh%dependents)) return
    ! First parent in the range.
    first = 1
    above = size(mesh%dependents, 2) + 1
    do while (first < above)
      k = (first + above)/2
      if (mesh%dependents(1, k) < range(1)) then
        first = k + 1
      else
        above = k
      end if
    end do
    do i = first, size(mesh%dependents, 2)
      associate (parent => mesh%dependents(1, i), node => mesh%dependents(2, i))
        if (parent > range(2)) exit
        force = -special(:, node)
        do k = layout%node_slots(node), layout%node_slots(node + 1) - 1
          force = force + slots(:, layout%slot_list(k))
        end do
        internal(:, parent) = internal(:, parent) + 0.5_wp*force
      end associate
    end do
  end subroutine add_hanging_forces

end module hanging_nodes_m
