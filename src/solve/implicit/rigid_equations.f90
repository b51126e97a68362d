! SPDX-License-Identifier: MIT
!> Rigid bodies in the equations of the implicit driver (doc/theory/implicit.md, section 1). Their
!> nodes follow three unknowns: displacement of the centre of mass, and the turn times the radius of
!> gyration, so that all unknowns are lengths. Rows and columns of the nodes are condensed into
!> those of the body.
module rigid_equations_m
  use curves_m, only : curve_value
  use equations_m, only : equations_t, parent_equations, condense
  use kinds_m, only : wp
  use model_m, only : model_t
  use rigid_state_m, only : rigid_state_t, rotation_terms, rotation_shift, velocity_of, body_scales
  use sparse_m, only : sparse_t, add_block
  implicit none
  private
  public :: place_rigids, spread_rates, resultants, form_rigid_loads, &
    condense_nodes, add_rigid_diagonal

contains

  !> Place the nodes of all bodies.
  pure subroutine place_rigids(model, rigids, displacement, motion)
    type(model_t), intent(in) :: model
    type(rigid_state_t), intent(in) :: rigids(:)
    real(wp), intent(in) :: displacement(:, :) !! (3, n_body)
    real(wp), intent(inout) :: motion(:, :)    !! (4, n_node)
    integer :: i, k

    do i = 1, size(rigids)
      do k = 1, size(model%rigids(i)%nodes)
        motion(1:2, model%rigids(i)%nodes(k)) = displacement(1:2, i) &
          + rotation_shift(rotation_terms(displacement(3, i)), rigids(i)%arms(:, k))
      end do
    end do
  end subroutine place_rigids

  !> Velocity and acceleration of the nodes of all bodies.
  pure subroutine spread_rates(model, rigids, displacement, speed, gain, velocity, acceleration)
    type(model_t), intent(in) :: model
    type(rigid_state_t), intent(in) :: rigids(:)
    real(wp), intent(in) :: displacement(:, :)    !! (3, n_body)
    real(wp), intent(in) :: speed(:, :), gain(:, :) !! (3, n_body) velocity, acceleration
    real(wp), intent(inout) :: velocity(:, :)     !! (2, n_node)
    real(wp), intent(inout) :: acceleration(:, :) !! (2, n_node)
    real(wp) :: arm(2)
    integer :: i, k

    do i = 1, size(rigids)
      do k = 1, size(model%rigids(i)%nodes)
        arm = arm_at(rigids(i), displacement(3, i), k)
        associate (node => model%rigids(i)%nodes(k))
          velocity(:, node) = velocity_of(speed(:, i), arm)
          acceleration(:, node) = velocity_of(gain(:, i), arm) - speed(3, i)**2*arm
        end associate
      end do
    end do
  end subroutine spread_rates

  !> Sums and moments of nodal forces over each body; for the round-off the same of magnitudes.
  pure function resultants(model, rigids, displacement, force, of_magnitudes) result(total)
    type(model_t), intent(in) :: model
    type(rigid_state_t), intent(in) :: rigids(:)
    real(wp), intent(in) :: displacement(:, :) !! (3, n_body)
    real(wp), intent(in) :: force(:, :)        !! (2, n_node)
    logical, intent(in), optional :: of_magnitudes
    real(wp) :: total(3, size(rigids))
    real(wp) :: arm(2)
    integer :: i, k

    total = 0.0_wp
    do i = 1, size(rigids)
      do k = 1, size(model%rigids(i)%nodes)
        arm = arm_at(rigids(i), displacement(3, i), k)
        if (present(of_magnitudes)) arm = [abs(arm(1)), -abs(arm(2))]
        associate (f => force(:, model%rigids(i)%nodes(k)))
          total(:, i) = total(:, i) + [f, arm(1)*f(2) - arm(2)*f(1)]
        end associate
      end do
    end do
  end function resultants

  !> *LOAD_RIGID_BODY at `time`.
  pure function form_rigid_loads(model, time) result(load)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: time
    real(wp) :: load(3, size(model%rigids))
    integer :: i

    load = 0.0_wp
    if (.not. allocated(model%conditions%rigid_loads)) return
    do i = 1, size(model%conditions%rigid_loads)
      associate (given => model%conditions%rigid_loads(i))
        load(given%direction, given%node) = load(given%direction, given%node) &
          + given%scale*curve_value(model%curves(given%curve), time)
      end associate
    end do
  end function form_rigid_loads

  !> Condense hanging nodes and the nodes of all bodies out of the collected entries of a stiffness:
  !> T^T K T and, by the turn of T, minus arm times force on the turn's diagonal.
  pure subroutine condense_nodes(model, rigids, displacement, force, equations, matrix)
    type(model_t), intent(in) :: model
    type(rigid_state_t), intent(in) :: rigids(:)
    real(wp), intent(in) :: displacement(:, :) !! (3, n_body)
    real(wp), intent(in) :: force(:, :)        !! (2, n_node) whose derivative K is
    type(equations_t), intent(in) :: equations
    type(sparse_t), intent(inout) :: matrix    !! not compressed
    real(wp) :: arm(2), scales(3, size(rigids)), spring
    real(wp), allocatable :: shares(:, :)
    integer, allocatable :: to(:, :), hanging(:, :)
    integer :: i, k, n

    n = max(equations%n, maxval(equations%collected)) - equations%n
    if (n == 0) return
    allocate (shares(2, n), to(2, n)) ! of each dependent number: two equations with their shares
    hanging = parent_equations(model%mesh, equations%number)
    n = size(hanging, 2)
    to(:, :n) = hanging
    shares(:, :n) = 0.5_wp
    shares(1, n + 1:) = 1.0_wp
    scales = body_scales(rigids)
    do i = 1, size(rigids)
      spring = 0.0_wp
      do k = 1, size(model%rigids(i)%nodes)
        arm = arm_at(rigids(i), displacement(3, i), k)/scales(3, i)
        shares(2, n + 1:n + 2) = [-arm(2), arm(1)]
        to(:, n + 1) = equations%bodies([1, 3], i)
        to(:, n + 2) = equations%bodies([2, 3], i)
        spring = spring - dot_product(arm, force(:, model%rigids(i)%nodes(k)))/scales(3, i)
        n = n + 2
      end do
      call add_block(matrix, equations%bodies([3], i), equations%bodies([3], i), &
        reshape([spring], [1, 1]))
    end do
    call condense(equations%n, to, shares, matrix)
  end subroutine condense_nodes

  !> Add factors times inertia to the diagonal of the free degrees of freedom of bodies.
  pure subroutine add_rigid_diagonal(rigids, factors, equations, matrix)
    type(rigid_state_t), intent(in) :: rigids(:)
    real(wp), intent(in) :: factors(:, :) !! (3, n_body)
    type(equations_t), intent(in) :: equations
    type(sparse_t), intent(inout) :: matrix
    integer :: i, k

    do i = 1, size(rigids)
      do k = 1, 3
        ! The turn's unknown has the radius of gyration in it, so that its inertia is the mass.
        if (equations%bodies(k, i) <= equations%n_free) call add_block(matrix, &
          equations%bodies([k], i), equations%bodies([k], i), &
          reshape([factors(k, i)*rigids(i)%inertia(1)], [1, 1]))
      end do
    end do
  end subroutine add_rigid_diagonal

  !> Position of a node relative to the centre of mass after a turn.
  pure function arm_at(rigid, angle, k) result(arm)
    type(rigid_state_t), intent(in) :: rigid
    real(wp), intent(in) :: angle
    integer, intent(in) :: k
    real(wp) :: arm(2)

    arm = rigid%arms(:, k) + rotation_shift(rotation_terms(angle), rigid%arms(:, k))
  end function arm_at

end module rigid_equations_m
