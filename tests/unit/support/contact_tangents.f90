! SPDX-License-Identifier: MIT
!> Further contact problems, for tangents: what the common scenes do not have (corner feet, overhang, steep slopes,
!> closed chains).
module contact_tangents_m
  use contact_factories_m, only : problem_t, make_problem, line, polygon
  use kinds_m, only : wp
  use surfaces_m, only : surface_t, link_segments
  implicit none
  private
  public :: n_place, places, make_place, valley, needle, solve_dense

  integer, parameter :: n_place = 13, valley = 1, needle = 6
  character(16), parameter :: places(n_place) = [character(16) :: 'valley', 'ridge', 'overhang', &
    'one end', 'steep tip', 'needle', 'disc on plane', 'plane on disc', 'disc in ring', 'two chains', &
    'overlapped', 'chain at end', 'backwards']

contains

  !> Place k: slave and master chains, pressed into each other by displacement.
  subroutine make_place(problem, k)
    type(problem_t), intent(out) :: problem
    integer, intent(in) :: k
    real(wp), allocatable :: slave(:, :), master(:, :)
    real(wp) :: down
    integer :: n, i

    down = 0.02_wp
    ! gfortran looks at the bounds of what it is to allocate anew: these are numbers.
    allocate (slave(2, 0), master(2, 0))
    select case (places(k))
    case ('valley')
      slave = reshape([0.0_wp, 0.15_wp, 0.25_wp, 0.075_wp, 0.4985_wp, 0.003_wp, 0.509_wp, 0.0036_wp, &
        0.75_wp, 0.075_wp, 1.0_wp, 0.15_wp], [2, 6])
      master = reshape([1.1_wp, 0.18_wp, 0.8_wp, 0.09_wp, 0.5_wp, 0.0_wp, 0.2_wp, 0.09_wp, -0.1_wp, &
        0.18_wp], [2, 5])
    case ('ridge')
      slave = line([0.013_wp, 0.0_wp], [1.013_wp, 0.0_wp], 7)
      slave(2, :) = -0.15_wp*abs(slave(1, :) - 0.5_wp)
      master = line([1.1_wp, 0.0_wp], [-0.1_wp, 0.0_wp], 6)
      master(2, :) = -0.15_wp*abs(master(1, :) - 0.5_wp)
      down = 0.003_wp
    case ('overhang')
      slave = line([0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp], 3)
      master = line([0.72_wp, 0.0_wp], [0.4_wp, 0.0_wp], 3)
    case ('one end')
      slave = line([0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp], 4)
      master = line([0.63_wp, 0.0_wp], [-0.2_wp, 0.0_wp], 5)
    case ('steep tip')
      slave = reshape([0.3_wp, 0.6_wp, 0.49_wp, 0.025_wp, 0.5_wp, 0.0_wp, 0.51_wp, 0.022_wp, 0.7_wp, &
        0.6_wp], [2, 5])
      master = line([1.0_wp, 0.0_wp], [0.0_wp, 0.0_wp], 5)
    case ('needle')
      slave = reshape([0.48_wp, 0.6_wp, 0.5_wp, 0.0_wp, 0.52_wp, 0.6_wp], [2, 3])
      master = line([1.0_wp, 0.0_wp], [0.0_wp, 0.0_wp], 5)
    case ('disc on plane')
      slave = polygon([0.5_wp, 0.5_wp], 0.5_wp, 26)
      master = line([1.0_wp, 0.0_wp], [0.0_wp, 0.0_wp], 23)
    case ('plane on disc')
      slave = line([0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp], 23)
      master = polygon([0.5_wp, -0.5_wp], 0.5_wp, 26)
    case ('disc in ring')
      slave = polygon([0.5_wp, 0.5_wp], 0.5_wp, 19)
      master = polygon([0.5_wp, 0.5_wp], 0.51_wp, 26)
      master = master(:, 26:1:-1)
    case ('two chains', 'overlapped')
      slave = line([0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp], 4)
      slave(1, 3) = 0.45_wp
      master = line([1.1_wp, 0.0_wp], [-0.1_wp, 0.0_wp], 7)
      master(1, 4:5) = [0.63_wp, 0.55_wp]
      if (places(k) == 'overlapped') master(1, 4:5) = [0.55_wp, 0.63_wp]
      if (places(k) == 'overlapped') master(2, 5:) = -0.002_wp
    case ('chain at end')
      ! The second chain begins below the end of a slave segment, just outside its projection.
      slave = line([0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp], 4)
      slave(2, :) = -0.2_wp*abs(slave(1, :) - 0.5_wp)
      master = line([1.1_wp, 0.0_wp], [-0.1_wp, 0.0_wp], 6)
      master(1, 4) = 0.499_wp
      master(2, :) = -0.2_wp*abs(master(1, :) - 0.5_wp)
    case ('backwards')
      ! The last slave segment runs as the master does and faces away from it, below its surface for a part.
      slave = reshape([0.1_wp, 0.0_wp, 0.5_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.7_wp, 0.03_wp], [2, 4])
      master = line([1.3_wp, 0.0_wp], [-0.3_wp, 0.0_wp], 7)
    end select
    call make_problem(problem, slave, master, 0.3_wp, slave_is_closed=k == 7 .or. k == 9, &
      master_is_closed=k == 8 .or. k == 9)
    if (k > 9 .and. k < 13) call cut_chain(problem%contact%master, 4)
    n = size(slave, 2)
    do i = 1, n
      problem%motion(1:2, i) = [0.0_wp, -down] + 0.05_wp*down*[sin(3.0_wp*i), cos(5.0_wp*i)]
    end do
  end subroutine make_place

  !> Take a segment out of a surface.
  subroutine cut_chain(surface, segment)
    type(surface_t), intent(inout) :: surface
    integer, intent(in) :: segment

    associate (n => surface%n_segment)
      surface%segment_element = [surface%segment_element(:segment - 1), surface%segment_element(segment + 1:n)]
      surface%segments = reshape([surface%segments(:, :segment - 1), &
        surface%segments(:, segment + 1:n)], [2, n - 1])
    end associate
    call link_segments(surface)
  end subroutine cut_chain

  !> Solution of a small dense system, by elimination with row exchange.
  subroutine solve_dense(matrix, x)
    real(wp), intent(inout) :: matrix(:, :) !! overwritten
    real(wp), intent(inout) :: x(:)         !! right side, then solution
    real(wp) :: row(size(x)), value
    integer :: i, k, pivot

    do k = 1, size(x)
      pivot = k - 1 + maxloc(abs(matrix(k:, k)), 1)
      row = matrix(k, :)
      matrix(k, :) = matrix(pivot, :)
      matrix(pivot, :) = row
      value = x(k)
      x(k) = x(pivot)
      x(pivot) = value
      do i = k + 1, size(x)
        value = matrix(i, k)/matrix(k, k)
        matrix(i, k:) = matrix(i, k:) - value*matrix(k, k:)
        x(i) = x(i) - value*x(k)
      end do
    end do
    do k = size(x), 1, -1
      x(k) = (x(k) - dot_product(matrix(k, k + 1:), x(k + 1:)))/matrix(k, k)
    end do
  end subroutine solve_dense

end module contact_tangents_m
