! SPDX-License-Identifier: MIT
!> How far to go along the way of one Newton iteration (doc/theory/implicit.md, section 3).
module line_search_m
  use kinds_m, only : wp
  use clock_m, only : clock_t
  use equations_m, only : equations_t, take_free
  use implicit_forces_m, only : trial_t, assemble_forces, trouble_of
  use implicit_tangent_m, only : step_t, assemble_residual
  use model_m, only : model_t
  use state_m, only : state_t
  implicit none
  private
  public :: way_t, move_nodes

  !> Halvings of an iteration that leaves the range of sound elements, and steps of a line search.
  integer, parameter :: most_halvings = 8, most_searches = 6
  !> Least part of what is left that a step of the search may take.
  real(wp), parameter :: least_part = 0.1_wp

  !> The way of one iteration.
  type :: way_t
    real(wp), allocatable :: x(:)     !! dU of the free degrees of freedom
    real(wp), allocatable :: b(:)     !! right-hand side, minus the residual at its start
    real(wp), allocatable :: moved(:) !! displacement of the prescribed degrees of freedom
    real(wp) :: factor = 1.0_wp       !! part of x that was gone
    character(:), allocatable :: trouble !! why it can not be gone; empty
  end type way_t

contains

  !> Move the trial by `way%x`, shortened where elements would turn inside out or where the residual
  !> along x would not fall. The first iteration of a step, which moves prescribed degrees of
  !> freedom, is gone to its end.
  subroutine move_nodes(model, state, step, clock, trial, way)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    type(clock_t), intent(inout) :: clock
    type(trial_t), intent(inout) :: trial
    type(way_t), intent(inout) :: way
    real(wp), allocatable :: start(:, :)
    logical :: is_straight
    integer :: i

    start = trial%motion(1:2, :)
    way%factor = 1.0_wp
    is_straight = .not. any(abs(way%moved) > 0.0_wp)
    do i = 0, most_halvings
      call go_part(model, state, step, clock, start, trial, way)
      if (len(way%trouble) == 0 .or. .not. is_straight) exit
      if (i < most_halvings) way%factor = 0.5_wp*way%factor
    end do
    if (is_straight .and. step%searches .and. len(way%trouble) == 0) &
      call search_line(model, state, step, clock, start, trial, way)
  end subroutine move_nodes

  !> Shorten the way by secants until the slope dU.R at its end is no longer uphill. A way that does
  !> not lead downhill at its start says nothing and is gone to the end.
  subroutine search_line(model, state, step, clock, start, trial, way)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    type(clock_t), intent(inout) :: clock
    real(wp), intent(in) :: start(:, :)
    type(trial_t), intent(inout) :: trial
    type(way_t), intent(inout) :: way
    real(wp) :: slope_start, slope, sound_factor
    integer :: i

    slope_start = -dot_product(way%x, way%b)
    if (.not. slope_start < 0.0_wp) return
    do i = 1, most_searches
      slope = dot_product(way%x, take_free(step%equations, &
        assemble_residual(model, state, step, trial)))
      if (slope <= model%controls%implicit%search_tolerance*abs(slope_start)) return
      sound_factor = way%factor
      way%factor = way%factor*max(least_part, slope_start/(slope_start - slope))
      call go_part(model, state, step, clock, start, trial, way)
      if (len(way%trouble) == 0) cycle
      way%factor = sound_factor
      call go_part(model, state, step, clock, start, trial, way)
      return
    end do
  end subroutine search_line

  !> The trial at `way%factor`, and whether it is sound.
  subroutine go_part(model, state, step, clock, start, trial, way)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    type(clock_t), intent(inout) :: clock
    real(wp), intent(in) :: start(:, :)
    type(trial_t), intent(inout) :: trial
    type(way_t), intent(inout) :: way

    call put_nodes(step%equations, start, way, trial%motion)
    call assemble_forces(model, state, step%time, .false., clock, trial)
    way%trouble = trouble_of(trial)
  end subroutine go_part

  !> Displacements at a part of the way.
  pure subroutine put_nodes(equations, start, way, motion)
    type(equations_t), intent(in) :: equations
    real(wp), intent(in) :: start(:, :)      !! (2, n_node) displacement where the way begins
    type(way_t), intent(in) :: way
    real(wp), intent(inout) :: motion(:, :)  !! (4, n_node)
    integer :: j, k, n

    do j = 1, size(start, 2)
      do k = 1, 2
        n = equations%number(k, j)
        if (n == 0) cycle
        if (n <= equations%n_free) then
          motion(k, j) = start(k, j) + way%factor*way%x(n)
        else
          motion(k, j) = start(k, j) + way%moved(n - equations%n_free)
        end if
      end do
    end do
  end subroutine put_nodes

end module line_search_m
