! SPDX-License-Identifier: MIT
!> Linear complementarity problem: forces within bounds, low <= x <= high, with slacks s = r + W x
!> that are zero between the bounds, not negative at the lower and not positive at the upper bound.
!> W = B + V V^T is symmetric and positive semidefinite, with a band B and a few columns V. An
!> active set is assumed, the other forces are solved for, and the set is updated until nothing
!> changes; where it cycles, projected Gauss-Seidel sweeps follow. Memory is reused from one problem
!> to the next. Cholesky factors have the storage of a symmetric band (0:width, n), B(j + i, j) in
!> row i of column j; of dependent rows the later ones are left out. (LAPACK's dpbtrf stops at the
!> first such pivot, and the bits of OpenBLAS depend on the number of threads in wide bands.)
module complementarity_m
  use kinds_m, only : wp
  implicit none
  private
  public :: problem_t, outcome_t, set_size, solve_complementarity, is_low, is_between, is_high

  !> Position of a force: lower bound, between the bounds, upper bound.
  integer, parameter :: is_low = -1, is_between = 0, is_high = 1

  !> A problem, its solution and work arrays; arrays may be longer than needed.
  type :: problem_t
    integer :: n = 0                       !! forces
    integer :: width = 0                   !! bandwidth of B
    integer :: n_column = 0
    real(wp), allocatable :: band(:)       !! (0:width, n) B(j + i, j) in row i of column j
    real(wp), allocatable :: column(:)     !! (n, n_column) V
    real(wp), allocatable :: r(:)          !! (n)
    real(wp), allocatable :: low(:)        !! (n) <= 0
    real(wp), allocatable :: high(:)       !! (n) >= 0
    integer, allocatable :: at(:)          !! (n) position of each force: assumed in (not between
                                           !! where the bounds are equal), found out
    real(wp), allocatable :: x(:)          !! (n) forces out
    integer, allocatable :: free_rows(:)   !! (n) rows between the bounds; work arrays from here on
    integer :: n_bound = 0 !! rows at a bound, and dependent rows
    integer, allocatable :: bound_rows(:)  !! (n_bound) these rows
    logical, allocatable :: is_dependent(:) !! (n) rows with zero pivots
    real(wp), allocatable :: factor(:)     !! (0:width, n)
    real(wp), allocatable :: diagonal(:)   !! (n) diagonal before factorisation
    real(wp), allocatable :: solved(:)     !! (n, n_column + 1)
    real(wp), allocatable :: slack(:)      !! (n)
  end type problem_t

  !> Cost of a solution.
  type :: outcome_t
    integer :: n_pass = 0     !! active sets solved
    integer :: n_sweep = 0    !! Gauss-Seidel sweeps
    integer :: n_dependent = 0 !! dependent rows left out of the last active set
  end type outcome_t

  integer, parameter :: most_passes = 25
  integer, parameter :: most_sweeps = 2000
  !> Round-off of slacks, as a share of the largest term.
  real(wp), parameter :: round_off = 1.0e-13_wp
  !> Change of forces, as a share of the largest, at which sweeps have converged.
  real(wp), parameter :: convergence = 1.0e-13_wp

  !> Band entries up to which a loop is not worth vectors.
  integer, parameter :: few = 8
  !> Share of the diagonal below which a pivot counts as zero.
  real(wp), parameter :: least_pivot = 1.0e-10_wp

contains

  !> Allocate a problem. Its content is lost where the arrays were too small.
  pure subroutine set_size(problem, n, width, n_column)
    type(problem_t), intent(inout) :: problem
    integer, intent(in) :: n, width, n_column

    problem%n = n
    problem%width = width
    problem%n_column = n_column
    call provide(problem%band, (width + 1)*n)
    call provide(problem%factor, (width + 1)*n)
    call provide(problem%column, n*n_column)
    call provide(problem%solved, n*(n_column + 1))
    call provide(problem%x, n)
    if (allocated(problem%r)) then
      if (size(problem%r) == size(problem%x)) return
      deallocate (problem%r, problem%low, problem%high, problem%at, problem%free_rows, &
        problem%is_dependent, problem%bound_rows, problem%diagonal, problem%slack)
    end if
    associate (m => size(problem%x))
      allocate (problem%r(m), problem%low(m), problem%high(m), problem%diagonal(m), &
        problem%slack(m), problem%at(m), problem%free_rows(m), problem%bound_rows(m), &
        problem%is_dependent(m))
    end associate
  end subroutine set_size

  !> Allocate a list of at least n values, with a reserve when it has to grow.
  pure subroutine provide(list, n)
    real(wp), allocatable, intent(inout) :: list(:)
    integer, intent(in) :: n

    if (allocated(list)) then
      if (size(list) >= n) return
      deallocate (list)
    end if
    allocate (list(n + n/2))
  end subroutine provide

  !> Solve for x.
  pure subroutine solve_complementarity(problem, outcome)
    type(problem_t), intent(inout) :: problem
    type(outcome_t), intent(out) :: outcome
    logical :: is_converged
    integer :: pass, i

    if (problem%n == 0) return
    do pass = 1, most_passes
      outcome%n_pass = pass
      call solve_active_set(problem, outcome%n_dependent)
      call find_slacks(problem%n_bound, problem%bound_rows, problem)
      call update_active_set(problem, is_converged)
      if (is_converged) return
    end do
    associate (n => problem%n)
      problem%x(:n) = min(max(problem%x(:n), problem%low(:n)), problem%high(:n))
      call sweep(problem, outcome%n_sweep)
      problem%at(:n) = is_between
      where (problem%x(:n) <= problem%low(:n)) problem%at(:n) = is_low
      where (problem%x(:n) >= problem%high(:n) .and. problem%high(:n) > problem%low(:n)) &
        problem%at(:n) = is_high
      problem%bound_rows(:n) = [(i, i=1, n)]
      call find_slacks(n, problem%bound_rows, problem)
    end associate
  end subroutine solve_complementarity

  !> Forces between the bounds that make their slacks zero; the others are at their bounds.
  pure subroutine solve_active_set(problem, n_dependent)
    type(problem_t), intent(inout) :: problem
    integer, intent(out) :: n_dependent !! dependent rows
    integer :: i, m
    logical :: has_bounds

    m = 0
    problem%n_bound = 0
    has_bounds = .false.
    do i = 1, problem%n
      problem%is_dependent(i) = .false.
      if (problem%at(i) == is_between) then
        problem%x(i) = 0.0_wp
        m = m + 1
        problem%free_rows(m) = i
      else
        problem%x(i) = problem%low(i)
        if (problem%at(i) == is_high) problem%x(i) = problem%high(i)
        has_bounds = has_bounds .or. abs(problem%x(i)) > 0.0_wp
        problem%n_bound = problem%n_bound + 1
        problem%bound_rows(problem%n_bound) = i
      end if
    end do
    n_dependent = 0
    if (m == 0) return
    if (has_bounds) call find_slacks(m, problem%free_rows, problem)
    do i = 1, m
      associate (j => problem%free_rows(i))
        problem%solved(i) = -problem%r(j)
        if (has_bounds) problem%solved(i) = -problem%slack(j)
      end associate
    end do
    call gather_band_rows(m, problem%width, problem%free_rows, problem%band, problem%factor)
    call factorise(m, problem%width, problem%factor, problem%diagonal, problem%is_dependent)
    call substitute(m, problem%width, problem%factor, problem%is_dependent, problem%solved)
    if (problem%n_column > 0) call add_columns(m, problem)
    do i = m, 1, -1
      problem%x(problem%free_rows(i)) = problem%solved(i)
      if (.not. problem%is_dependent(i)) cycle
      n_dependent = n_dependent + 1
      problem%bound_rows(problem%n_bound + n_dependent) = problem%free_rows(i)
      problem%is_dependent(i) = .false.
      problem%is_dependent(problem%free_rows(i)) = .true.
    end do
    problem%n_bound = problem%n_bound + n_dependent
  end subroutine solve_active_set

  !> Correction of a solution with the band alone for the columns: y - Z (1 + V^T Z)^-1 V^T y with Z
  !> = B^-1 V (Woodbury).
  pure subroutine add_columns(m, problem)
    integer, intent(in) :: m !! rows between bounds
    type(problem_t), intent(inout) :: problem
    real(wp) :: core(problem%n_column**2), pushed(problem%n_column), diagonal(problem%n_column)
    logical :: none(problem%n_column)
    real(wp) :: total
    integer :: i, k, l

    associate (n => problem%n, width => problem%n_column - 1, column => problem%column, &
      solved => problem%solved, free_rows => problem%free_rows)
      do k = 1, problem%n_column
        do i = 1, m
          solved(k*m + i) = column((k - 1)*n + free_rows(i))
        end do
        call substitute(m, problem%width, problem%factor, problem%is_dependent, solved(k*m + 1:(k &
          + 1)*m))
      end do
      core = 0.0_wp
      do k = 1, problem%n_column
        do l = 0, problem%n_column
          if (l > 0 .and. l < k) cycle
          total = 0.0_wp
          do i = 1, m
            if (.not. problem%is_dependent(i)) total = total + column((k - 1)*n + &
              free_rows(i))*solved(l*m + i)
          end do
          if (l == 0) pushed(k) = total
          if (l == k) total = 1.0_wp + total
          if (l > 0) core((k - 1)*(width + 1) + l - k + 1) = total
        end do
      end do
      call factorise(problem%n_column, width, core, diagonal, none)
      call substitute(problem%n_column, width, core, none, pushed)
      do k = 1, problem%n_column
        solved(:m) = solved(:m) - pushed(k)*solved(k*m + 1:(k + 1)*m)
      end do
    end associate
  end subroutine add_columns

  !> Put forces beyond a bound to that bound, and free forces whose slack points away from it.
  !> Dependent rows follow their slack.
  pure subroutine update_active_set(problem, is_converged)
    type(problem_t), intent(inout) :: problem
    logical, intent(out) :: is_converged
    integer :: i, previous

    is_converged = .true.
    do i = 1, problem%n
      associate (at => problem%at(i), x => problem%x(i), slack => problem%slack(i))
        if (.not. problem%high(i) > problem%low(i)) cycle
        previous = at
        if (problem%is_dependent(i)) then
          if (slack > 0.0_wp .or. .not. (slack < 0.0_wp .or. problem%low(i) < 0.0_wp)) at = is_low
          if (slack < 0.0_wp .and. problem%high(i) < huge(1.0_wp)) at = is_high
          is_converged = is_converged .and. at /= is_high &
            .and. .not. (at == is_low .and. problem%low(i) < 0.0_wp)
          cycle
        end if
        select case (previous)
        case (is_low)
          if (slack < 0.0_wp) at = is_between
        case (is_high)
          if (slack > 0.0_wp) at = is_between
        case default
          if (x < problem%low(i)) at = is_low
          if (x > problem%high(i)) at = is_high
        end select
        is_converged = is_converged .and. at == previous
      end associate
    end do
  end subroutine update_active_set

  !> Slacks r + W x of some forces, 0 where that is round-off; 0 for the others.
  pure subroutine find_slacks(m, list, problem)
    integer, intent(in) :: m
    integer, intent(in) :: list(:) !! (m) the rows
    type(problem_t), intent(inout) :: problem
    real(wp) :: largest, total
    integer :: k

    associate (n => problem%n)
      problem%slack(:n) = 0.0_wp
      call add_rows(m, list, n, problem%width, problem%band, problem%x, problem%r, problem%slack)
      largest = max(maxval(abs(problem%r(:n))), &
        maxval(abs(problem%band(1:(problem%width + 1)*n:problem%width + 1)*problem%x(:n))))
      do k = 1, problem%n_column
        associate (column => problem%column((k - 1)*n + 1:k*n))
          total = dot_product(column, problem%x(:n))
          problem%slack(list(:m)) = problem%slack(list(:m)) + total*column(list(:m))
          largest = max(largest, maxval(abs(total*column)))
        end associate
      end do
      do k = 1, m
        if (abs(problem%slack(list(k))) <= round_off*largest) problem%slack(list(k)) = 0.0_wp
      end do
    end associate
  end subroutine find_slacks

  !> r + B x of some rows.
  pure subroutine add_rows(m, list, n, width, band, x, r, slack)
    integer, intent(in) :: m, list(m), n, width
    real(wp), intent(in) :: band(0:width, n), x(n), r(n)
    real(wp), intent(inout) :: slack(n)
    real(wp) :: total
    integer :: i, k

    do i = 1, m
      associate (row => list(i))
        total = r(row)
        !GCC$ UNROLL 1
        do k = max(1, row - width), row - 1
          total = total + band(row - k, k)*x(k)
        end do
        !GCC$ UNROLL 1
        do k = 0, min(n - row, width)
          total = total + band(k, row)*x(row + k)
        end do
        slack(row) = total
      end associate
    end do
  end subroutine add_rows

  !> Projected Gauss-Seidel sweeps until the forces converge.
  pure subroutine sweep(problem, n_sweep)
    type(problem_t), intent(inout) :: problem
    integer, intent(out) :: n_sweep
    real(wp) :: change, wanted, diagonal, pushed
    integer :: j, k

    do n_sweep = 1, most_sweeps
      change = 0.0_wp
      do j = 1, problem%n
        associate (x => problem%x(j), slack => problem%slack(j))
          diagonal = problem%band((problem%width + 1)*(j - 1) + 1)
          do k = 0, problem%n_column - 1
            diagonal = diagonal + problem%column(k*problem%n + j)**2
          end do
          if (.not. diagonal > 0.0_wp) cycle
          call add_rows(1, [j], problem%n, problem%width, problem%band, problem%x, problem%r, &
            problem%slack)
          pushed = 0.0_wp
          do k = 0, problem%n_column - 1
            pushed = pushed + problem%column(k*problem%n + j)*dot_product( &
              problem%column(k*problem%n + 1:(k + 1)*problem%n), problem%x(:problem%n))
          end do
          slack = slack + pushed
          wanted = min(max(x - slack/diagonal, problem%low(j)), problem%high(j))
          change = max(change, abs(wanted - x))
          x = wanted
        end associate
      end do
      if (change <= convergence*maxval(abs(problem%x(:problem%n)))) exit
    end do
    n_sweep = min(n_sweep, most_sweeps)
  end subroutine sweep

  !> Gather the band of some rows.
  pure subroutine gather_band_rows(m, width, free_rows, band, factor)
    integer, intent(in) :: m, width, free_rows(m)
    real(wp), intent(in) :: band(0:width, *)
    real(wp), intent(inout) :: factor(0:width, m)
    integer :: i, j

    if (free_rows(m) - free_rows(1) == m - 1) then
      ! Consecutive rows.
      factor = band(:, free_rows(1):free_rows(m))
      return
    end if
    do j = 1, m
      do i = j, min(j + width, m)
        if (free_rows(i) - free_rows(j) > width) then
          factor(i - j, j) = 0.0_wp
        else
          factor(i - j, j) = band(free_rows(i) - free_rows(j), free_rows(j))
        end if
      end do
    end do
  end subroutine gather_band_rows

  !> Cholesky factors of a band. Rows with zero pivots are left out.
  pure subroutine factorise(n, width, factor, diagonal, is_zero)
    integer, intent(in) :: n, width
    real(wp), intent(inout) :: factor(0:width, n)
    real(wp), intent(inout) :: diagonal(n)
    logical, intent(inout) :: is_zero(n)
    real(wp) :: inverse
    integer :: j, k, last

    do j = 1, n
      diagonal(j) = factor(0, j)
    end do
    do j = 1, n
      is_zero(j) = .not. factor(0, j) > least_pivot*diagonal(j)
      if (is_zero(j)) then
        factor(:, j) = 0.0_wp
        factor(0, j) = 1.0_wp
        cycle
      end if
      factor(0, j) = sqrt(factor(0, j))
      inverse = 1.0_wp/factor(0, j)
      last = min(width, n - j)
      do k = 1, last
        factor(k, j) = factor(k, j)*inverse
      end do
      do k = 1, last
        call subtract_multiple(last - k + 1, factor(k, j), factor(k, j), factor(0, j + k))
      end do
    end do
  end subroutine factorise

  !> Subtract a multiple of some numbers from others; short lists one by one.
  pure subroutine subtract_multiple(n, multiple, these, others)
    integer, intent(in) :: n
    real(wp), intent(in) :: multiple, these(n)
    real(wp), intent(inout) :: others(n)
    integer :: m

    if (n > few) then
      others = others - multiple*these
    else
      !GCC$ NOVECTOR
      !GCC$ UNROLL 1
      do m = 1, n
        others(m) = others(m) - multiple*these(m)
      end do
    end if
  end subroutine subtract_multiple

  !> Solve with the factors, in place.
  pure subroutine substitute(n, width, factor, is_zero, y)
    integer, intent(in) :: n, width
    real(wp), intent(in) :: factor(0:width, n)
    logical, intent(in) :: is_zero(n)
    real(wp), intent(inout) :: y(n)
    real(wp) :: value
    integer :: j, k

    do j = 1, n
      if (is_zero(j)) y(j) = 0.0_wp
      value = y(j)/factor(0, j)
      y(j) = value
      !GCC$ NOVECTOR
      !GCC$ UNROLL 1
      do k = 1, min(width, n - j)
        y(j + k) = y(j + k) - factor(k, j)*value
      end do
    end do
    do j = n, 1, -1
      value = y(j)
      !GCC$ UNROLL 1
      do k = 1, min(width, n - j)
        value = value - factor(k, j)*y(j + k)
      end do
      y(j) = value/factor(0, j)
      if (is_zero(j)) y(j) = 0.0_wp
    end do
  end subroutine substitute

end module complementarity_m
