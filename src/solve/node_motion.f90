! SPDX-License-Identifier: MIT
!> Sums of nodal forces and the leap-frog motion of the nodes:
!> v(n+1/2) = [(1 - D h/2) v(n-1/2) + h a]/(1 + D h/2), u(n+1) = u(n) + dt v(n+1/2),
!> with h the mean of the two steps. The damping acts on the mean of the two velocities,
!> so it never limits the step.
module node_motion_m
  use kinds_m, only : wp
  use layout_m, only : layout_t, tile_t
  use state_m, only : state_t
  implicit none
  private
  public :: leap_t, make_leap, share_tile_forces, keep_tile_forces, move_tile_nodes, &
    sum_special_forces, move_special_nodes

  !> Factors of one leap, the same for all nodes.
  type :: leap_t
    real(wp) :: dt = 0.0_wp        !! t(n+1) - t(n)
    real(wp) :: half(2) = 0.0_wp   !! what an acceleration counts in the velocity
    real(wp) :: keep(2) = 1.0_wp   !! what the old velocity counts
    real(wp) :: body(2) = 0.0_wp   !! acceleration of every free node
  end type leap_t

contains

  !> Factors from the steps before and after, damping and body acceleration.
  pure function make_leap(dt_before, dt, damping, body) result(leap)
    real(wp), intent(in) :: dt_before, dt
    real(wp), intent(in) :: damping(2) !! D per direction
    real(wp), intent(in) :: body(2)    !! acceleration per direction
    type(leap_t) :: leap
    real(wp) :: mean

    mean = 0.5_wp*(dt_before + dt)
    leap%dt = dt
    leap%half = mean/(1.0_wp + 0.5_wp*damping*mean)
    leap%keep = (1.0_wp - 0.5_wp*damping*mean)/(1.0_wp + 0.5_wp*damping*mean)
    leap%body = body
  end function make_leap

  !> A tile's forces on its special nodes into its force slots.
  subroutine share_tile_forces(tile, force, force_slots)
    type(tile_t), intent(in) :: tile
    real(wp), intent(in) :: force(2, *)          !! of the tile's local nodes
    real(wp), intent(inout) :: force_slots(2, *)
    integer :: n_interior, i

    n_interior = tile%last_node - tile%first_node + 1
    do i = tile%first_special, tile%last_special
      force_slots(1, i) = force(1, n_interior + i - tile%first_special + 1)
      force_slots(2, i) = force(2, n_interior + i - tile%first_special + 1)
    end do
  end subroutine share_tile_forces

  !> A tile's forces on its interior nodes into the nodal array, for a cycle that writes.
  subroutine keep_tile_forces(tile, force, internal_force)
    type(tile_t), intent(in) :: tile
    real(wp), intent(in) :: force(2, *)
    real(wp), intent(inout) :: internal_force(2, *) !! of all nodes

    internal_force(:, tile%first_node:tile%last_node) = &
      force(:, 1:tile%last_node - tile%first_node + 1)
  end subroutine keep_tile_forces

  !> Move the interior nodes first .. last.
  subroutine move_tile_nodes(leap, first, last, force, inverse_mass, motion)
    type(leap_t), intent(in) :: leap
    integer, intent(in) :: first, last
    real(wp), intent(in) :: force(2, first:*)        !! internal force of those nodes
    real(wp), intent(in) :: inverse_mass(2, *)       !! of all nodes
    real(wp), intent(inout) :: motion(4, *)          !! of all nodes
    integer :: i, k

    do i = first, last
      !$omp simd simdlen(2)
      do k = 1, 2
        motion(2 + k, i) = leap%keep(k)*motion(2 + k, i) + leap%half(k) &
          *(merge(leap%body(k), 0.0_wp, inverse_mass(k, i) > 0.0_wp) &
          - force(k, i)*inverse_mass(k, i))
        motion(k, i) = motion(k, i) + leap%dt*motion(2 + k, i)
      end do
    end do
  end subroutine move_tile_nodes

  !> Internal forces of the special nodes first .. last: their slots in their fixed order.
  subroutine sum_special_forces(layout, force_slots, first, last, force)
    type(layout_t), intent(in) :: layout
    real(wp), intent(in) :: force_slots(2, *)
    integer, intent(in) :: first, last
    real(wp), intent(inout) :: force(2, *)   !! of all nodes

    call sum_slots(first, last, layout%node_slots, layout%slot_list, force_slots, force)
  end subroutine sum_special_forces

  !> On arrays of known shape: through the layout each access costs its stride.
  subroutine sum_slots(first, last, node_slots, slot_list, force_slots, force)
    integer, intent(in) :: first, last, node_slots(*), slot_list(*)
    real(wp), intent(in) :: force_slots(2, *)
    real(wp), intent(inout) :: force(2, *)
    real(wp) :: fx, fy
    integer :: node, i

    do node = first, last
      fx = 0.0_wp
      fy = 0.0_wp
      do i = node_slots(node), node_slots(node + 1) - 1
        fx = fx + force_slots(1, slot_list(i))
        fy = fy + force_slots(2, slot_list(i))
      end do
      force(1, node) = fx
      force(2, node) = fy
    end do
  end subroutine sum_slots

  !> Move the special nodes first .. last; their internal forces stand in state%internal_force.
  subroutine move_special_nodes(leap, first, last, state)
    type(leap_t), intent(in) :: leap
    integer, intent(in) :: first, last
    type(state_t), intent(inout) :: state

    call move_each(leap, first, last, state%force_special, state%internal_force, &
      state%inverse_mass, state%motion)
  end subroutine move_special_nodes

  !> The same for arrays of known shape.
  subroutine move_each(leap, first, last, special, internal, inverse_mass, motion)
    type(leap_t), intent(in) :: leap
    integer, intent(in) :: first, last
    real(wp), intent(in) :: special(2, *), internal(2, *) !! forces
    real(wp), intent(in) :: inverse_mass(2, *)
    real(wp), intent(inout) :: motion(4, *)
    integer :: i, k

    do i = first, last
      !$omp simd simdlen(2)
      do k = 1, 2
        motion(2 + k, i) = leap%keep(k)*motion(2 + k, i) + leap%half(k) &
          *(merge(leap%body(k), 0.0_wp, inverse_mass(k, i) > 0.0_wp) &
          + (special(k, i) - internal(k, i))*inverse_mass(k, i))
        motion(k, i) = motion(k, i) + leap%dt*motion(2 + k, i)
      end do
    end do
  end subroutine move_each

end module node_motion_m
