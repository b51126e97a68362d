! SPDX-License-Identifier: MIT
!> Rigid bodies in the equations of the implicit driver (doc/theory/implicit.md, section 1). Their
!> nodes follow three unknowns: displacement of the centre of mass, and the turn times the radius of
!> gyration, so that all unknowns are lengths. Rows and columns of the nodes are condensed into
!> those of the body.
module rigid_equations_m
  use curves_m, only : curve_value
  use equations_m, only : equations_t
  use kinds_m, only : wp
  use model_m, only : model_t
  use rigid_state_m, only : rigid_state_t, rotation_terms, rotation_shift, velocity_of, body_scales
  use sparse_m, only : sparse_t, add_block
  implicit none
  private
  public :: place_rigids, spread_rates, resultants, form_rigid_loads, &
    condense_rigids, add_rigid_diagonal

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

  !> Condense the nodes of all bodies out of the collected entries of a stiffness: T^T K T and, by
  !> the turn of T, minus arm times force on the turn's diagonal.
  pure subroutine condense_rigids(model, rigids, displacement, force, equations, matrix)
    type(model_t), intent(in) :: model
    type(rigid_state_t), intent(in) :: rigids(:)
    real(wp), intent(in) :: displacement(:, :) !! (3, n_body)
    real(wp), intent(in) :: force(:, :)        !! (2, n_node) whose derivative K is
    type(equations_t), intent(in) :: equations
    type(sparse_t), intent(inout) :: matrix    !! not compressed
    real(wp) :: arm(2), scales(3, size(rigids)), spring, weights(2, 2)
    real(wp), allocatable :: turns(:), values(:)
    integer, allocatable :: to(:, :), dependent(:), rows(:), columns(:)
    integer :: i, k, n, pair(2, 2)

    if (size(rigids) == 0) return
    n = 2*sum([(size(model%rigids(i)%nodes), i=1, size(rigids))])
    allocate (turns(n), to(2, n)) ! of each dependent number: by the turn; equations of its body
    scales = body_scales(rigids)
    n = 0
    ! Entries of nodes leave the list, the others move up.
    associate (last => matrix%n_entry)
      dependent = pack([(i, i=1, last)], max(matrix%rows(:last), matrix%columns(:last)) &
        > equations%n)
      rows = matrix%rows(dependent)
      columns = matrix%columns(dependent)
      values = matrix%values(dependent)
      do i = 1, last
        if (max(matrix%rows(i), matrix%columns(i)) > equations%n) cycle
        n = n + 1
        matrix%rows(n) = matrix%rows(i)
        matrix%columns(n) = matrix%columns(i)
        matrix%values(n) = matrix%values(i)
      end do
      last = n
    end associate
    n = 0
    do i = 1, size(rigids)
      spring = 0.0_wp
      do k = 1, size(model%rigids(i)%nodes)
        arm = arm_at(rigids(i), displacement(3, i), k)/scales(3, i)
        turns(n + 1:n + 2) = [-arm(2), arm(1)]
        to(:, n + 1) = equations%bodies([1, 3], i)
        to(:, n + 2) = equations%bodies([2, 3], i)
        spring = spring - dot_product(arm, force(:, model%rigids(i)%nodes(k)))/scales(3, i)
        n = n + 2
      end do
      call add_block(matrix, equations%bodies([3], i), equations%bodies([3], i), &
        reshape([spring], [1, 1]))
    end do
    do i = 1, size(values)
      call expand(rows(i), pair(:, 1), weights(:, 1))
      call expand(columns(i), pair(:, 2), weights(:, 2))
      weights = values(i)*reshape([weights(:, 1)*weights(1, 2), weights(:, 1)*weights(2, 2)], &
        [2, 2])
      call add_block(matrix, pair(:, 1), pair(:, 2), weights)
    end do

  contains

    !> Equations of a collected number and their weights.
    pure subroutine expand(number, at, weight)
      integer, intent(in) :: number
      integer, intent(out) :: at(2)
      real(wp), intent(out) :: weight(2)

      at = [number, 0]
      weight = 1.0_wp
      if (number <= equations%n) return
      at = to(:, number - equations%n)
      weight(2) = turns(number - equations%n)
    end subroutine expand

  end subroutine condense_rigids

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
