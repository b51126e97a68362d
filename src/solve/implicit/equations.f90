! SPDX-License-Identifier: MIT
!> Equations of the implicit driver: free degrees of freedom first, then those with a prescribed
!> motion; fixed ones, and nodes that no element has, get none.
module equations_m
  use kinds_m, only : wp
  use constraints_m, only : is_active
  use model_m, only : model_t
  use sparse_m, only : sparse_t
  use state_m, only : state_t
  implicit none
  private
  public :: equations_t, number_equations, find_equation, move_prescribed, take_free, put_prescribed

  !> Numbering for one step.
  type :: equations_t
    integer :: n_free = 0
    integer :: n = 0                        !! with the prescribed ones
    integer, allocatable :: number(:, :)    !! (2, n_node), 0 = none
    integer, allocatable :: motion_of(:)    !! (n - n_free) which prescribed motion
  end type equations_t

contains

  !> Number the equations for a step; `time` lies inside it (no motion is born or dies there).
  pure subroutine number_equations(model, state, time, equations)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: time
    type(equations_t), intent(out) :: equations
    logical :: is_free(2, model%mesh%n_node)
    integer :: i

    allocate (equations%number(2, model%mesh%n_node), source=0)
    do i = 1, model%mesh%n_node
      if (state%mass(i) > 0.0_wp) equations%number(:, i) = 1
    end do
    do i = 1, size(model%conditions%fixed_nodes)
      equations%number(model%conditions%fixed_directions(i), model%conditions%fixed_nodes(i)) = 0
    end do
    do i = 1, size(model%conditions%motions)
      associate (prescribed => model%conditions%motions(i))
        if (is_active(prescribed, time) .and. equations%number(prescribed%direction, &
          prescribed%node) /= 0) equations%number(prescribed%direction, prescribed%node) = -i
      end associate
    end do
    is_free = equations%number > 0
    equations%motion_of = -pack(equations%number, equations%number < 0)
    equations%n_free = count(is_free)
    equations%n = equations%n_free + size(equations%motion_of)
    associate (number => equations%number, n_free => equations%n_free, n => equations%n)
      number = unpack([(i, i=n_free + 1, n)], number < 0, number)
      number = unpack([(i, i=1, n_free)], is_free, number)
    end associate
  end subroutine number_equations

  !> Node and direction of an equation.
  pure subroutine find_equation(equations, number, node, direction)
    type(equations_t), intent(in) :: equations
    integer, intent(in) :: number
    integer, intent(out) :: node, direction !! 0 when there is none
    integer :: place(2)

    place = findloc(equations%number, number)
    direction = place(1)
    node = place(2)
  end subroutine find_equation

  !> Move prescribed columns of the collected matrix to the right-hand side: b(free) -= K(free,
  !> prescribed) * increments. What is left in the matrix are the free rows and columns.
  pure subroutine move_prescribed(n_free, increments, matrix, b)
    integer, intent(in) :: n_free
    real(wp), intent(in) :: increments(:)
    type(sparse_t), intent(inout) :: matrix
    real(wp), intent(inout) :: b(:) !! (n_free)
    integer :: i, n

    n = 0
    do i = 1, matrix%n_entry
      if (matrix%rows(i) > n_free) cycle
      if (matrix%columns(i) > n_free) then
        b(matrix%rows(i)) = b(matrix%rows(i)) - matrix%values(i) &
          *increments(matrix%columns(i) - n_free)
        cycle
      end if
      n = n + 1
      matrix%rows(n) = matrix%rows(i)
      matrix%columns(n) = matrix%columns(i)
      matrix%values(n) = matrix%values(i)
    end do
    matrix%n_entry = n
    matrix%n = n_free
  end subroutine move_prescribed

  !> The free entries of a nodal field.
  pure function take_free(equations, field) result(vector)
    type(equations_t), intent(in) :: equations
    real(wp), intent(in) :: field(:, :) !! (2, n_node)
    real(wp) :: vector(equations%n_free)

    vector = pack(field, equations%number > 0 .and. equations%number <= equations%n_free)
  end function take_free

  !> Give the prescribed entries of a nodal field their values.
  pure subroutine put_prescribed(equations, values, field)
    type(equations_t), intent(in) :: equations
    real(wp), intent(in) :: values(:)       !! (n - n_free)
    real(wp), intent(inout) :: field(:, :)  !! (2, n_node)

    field = unpack(values, equations%number > equations%n_free, field)
  end subroutine put_prescribed

end module equations_m
