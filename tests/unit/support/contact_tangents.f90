! SPDX-License-Identifier: MIT
!> Further contact problems, for tangents: what the common scenes do not have (corner projections, overhang, steep slopes,
!> closed surfaces).
module contact_tangents_m
  use contact_factories_m, only : problem_t, make_problem, line, polygon
  use kinds_m, only : wp
  use surfaces_m, only : surface_t, link_segments
  implicit none
  private
  public :: n_site, first_closed, positions, make_place, valley, needle, solve_dense

  integer, parameter :: n_site = 20, valley = 1, needle = 6, first_closed = 14
  character(16), parameter :: positions(n_site) = [character(16) :: 'valley', 'ridge', 'overhang', &
    'one end', 'steep tip', 'needle', 'disc on plane', 'plane on disc', 'disc in ring', 'two chains', &
    'overlapped', 'chain at end', 'backwards', 'block on block', 'block at 30', 'block at 45', 'face on tip', &
    'over an edge', 'two blocks', 'wedge']

contains

  !> Position k: slave and master surfaces, loaded into each other by displacement.
  subroutine make_place(problem, k)
    type(problem_t), intent(out) :: problem
    integer, intent(in) :: k
    real(wp), allocatable :: slave(:, :), master(:, :)
    real(wp) :: down
    integer :: n, i

    down = 0.02_wp
    ! gfortran looks at the bounds of what it is to allocate anew: these are numbers.
    allocate (slave(2, 0), master(2, 0))
    select case (positions(k))
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
      if (positions(k) == 'overlapped') master(1, 4:5) = [0.55_wp, 0.63_wp]
      if (positions(k) == 'overlapped') master(2, 5:) = -0.002_wp
    case ('chain at end')
      ! The second surface begins below the end of a slave segment, just outside its projection.
      slave = line([0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp], 4)
      slave(2, :) = -0.2_wp*abs(slave(1, :) - 0.5_wp)
      master = line([1.1_wp, 0.0_wp], [-0.1_wp, 0.0_wp], 6)
      master(1, 4) = 0.499_wp
      master(2, :) = -0.2_wp*abs(master(1, :) - 0.5_wp)
    case ('backwards')
      ! The last slave segment runs as the master does and faces away from it, below its surface for a part.
      slave = reshape([0.1_wp, 0.0_wp, 0.5_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.7_wp, 0.03_wp], [2, 4])
      master = line([1.3_wp, 0.0_wp], [-0.3_wp, 0.0_wp], 7)
    case ('block on block')
      slave = block([0.5_wp, 0.5_wp], 1.0_wp, 0.03_wp, 3)
      master = block([0.45_wp, -0.75_wp], 1.5_wp, 0.0_wp, 5)
    case ('block at 30')
      slave = block([0.5_wp, 0.683_wp], 1.0_wp, 0.53_wp, 3)
      master = block([0.45_wp, -0.75_wp], 1.5_wp, 0.0_wp, 5)
      down = 0.11_wp
    case ('block at 45')
      slave = block([0.5_wp, 0.7071_wp], 1.0_wp, 0.8_wp, 3)
      master = block([0.45_wp, -0.75_wp], 1.5_wp, 0.0_wp, 5)
      down = 0.14_wp
    case ('face on tip')
      slave = block([0.64_wp, 0.75_wp], 1.5_wp, 0.0_wp, 5)
      master = block([0.5_wp, -0.7071_wp], 1.0_wp, 0.75_wp, 3)
      down = 0.14_wp
    case ('over an edge')
      slave = block([0.0_wp, 0.5_wp], 1.0_wp, 0.0_wp, 3)
      master = block([0.83_wp, -0.75_wp], 1.5_wp, 0.02_wp, 4)
    case ('two blocks')
      slave = block([0.5_wp, 0.5_wp], 1.0_wp, 0.0_wp, 2)
      master = block([-0.07_wp, -0.5_wp], 1.0_wp, 0.0_wp, 3)
    case ('wedge')
      slave = reshape([0.52_wp, 0.0_wp, 0.67_wp, 0.34_wp, 0.8_wp, 0.66_wp, 0.5_wp, 0.7_wp, 0.22_wp, 0.66_wp, &
        0.36_wp, 0.31_wp], [2, 6])
      master = block([0.45_wp, -0.75_wp], 1.5_wp, 0.0_wp, 5)
      down = 0.14_wp
    end select
    call make_problem(problem, slave, master, 0.3_wp, slave_is_closed=k == 7 .or. k == 9 .or. k >= first_closed, &
      master_is_closed=k == 8 .or. k == 9 .or. k >= first_closed)
    if (k > 9 .and. k < 13) call cut_chain(problem%contact%master, 4)
    n = size(slave, 2)
    do i = 1, n
      problem%motion(1:2, i) = [0.0_wp, -down] + 0.05_wp*down*[sin(3.0_wp*i), cos(5.0_wp*i)]
    end do
  end subroutine make_place

  !> Nodes of a square block, counter-clockwise from its lower left corner, turned by an angle about its centre.
  pure function block(centre, side, angle, n) result(x)
    real(wp), intent(in) :: centre(2), side, angle
    integer, intent(in) :: n !! segments of a side
    real(wp) :: x(2, 4*n)
    real(wp) :: along, part(2), swap
    integer :: i, k

    do i = 1, n
      along = (i - 1.0_wp)/n - 0.5_wp
      part = [along, -0.5_wp]
      do k = 0, 3
        x(:, k*n + i) = centre + side*[cos(angle)*part(1) - sin(angle)*part(2), sin(angle)*part(1) + cos(angle)*part(2)]
        swap = part(1)
        part = [-part(2), swap]
      end do
    end do
  end function block

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
