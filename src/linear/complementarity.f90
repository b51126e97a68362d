! SPDX-License-Identifier: MIT
!> Forces within bounds, low <= x <= high, with slacks s = r + W x: zero where x lies between its
!> bounds, not below zero where x is low, not above zero where it is high. W is symmetric without
!> negative eigenvalues: a band, and what a few columns couple, B + V V^T. Which forces are at a
!> bound is guessed, the others are solved for, and the guess is mended until nothing is left to
!> mend; where that goes round in circles, sweeps of Gauss-Seidel settle it. Factors of this file's
!> own: of rows that depend on others the later ones are left out while the band is factorised.
!> LAPACK's dpbtrf gives up at the first such pivot, and in OpenBLAS its bits depend on the number
!> of threads where the band is wide. The room is kept from one problem to the next.
module complementarity_m
  use kinds_m, only : wp
  implicit none
  private
  public :: problem_t, outcome_t, set_size, solve_complementarity, is_low, is_between, is_high

  !> Where a force is.
  integer, parameter :: is_low = -1, is_between = 0, is_high = 1

  !> A problem, its solution and room to solve it; arrays may be longer than they have to be.
  type :: problem_t
    integer :: n = 0                       !! forces
    integer :: width = 0                   !! of the band
    integer :: n_column = 0
    real(wp), allocatable :: band(:)       !! (0:width, n) B(j + i, j) in row i of column j
    real(wp), allocatable :: column(:)     !! (n, n_column) V
    real(wp), allocatable :: r(:)          !! (n)
    real(wp), allocatable :: low(:)        !! (n) <= 0
    real(wp), allocatable :: high(:)       !! (n) >= 0
    integer, allocatable :: at(:)          !! (n) in: guess, not between like bounds; out: where
                                           !! each force is
    real(wp), allocatable :: x(:)          !! (n) out: the forces
    integer, allocatable :: place(:)       !! from here on room: (n) rows between bounds
    logical, allocatable :: drops(:)       !! (n) of those, pivots that are zero
    real(wp), allocatable :: factor(:)     !! (0:width, n)
    real(wp), allocatable :: diagonal(:)   !! (n) before the band is factorised
    real(wp), allocatable :: solved(:)     !! (n, n_column + 1)
    real(wp), allocatable :: slack(:)      !! (n)
    real(wp), allocatable :: terms(:)      !! (n)
  end type problem_t

  !> What a solution has taken.
  type :: outcome_t
    integer :: n_pass = 0     !! guesses solved for
    integer :: n_sweep = 0    !! sweeps, where the guesses did not settle
    integer :: n_dropped = 0  !! forces left out of the last guess: the others do what they would
  end type outcome_t

  !> Entries of a band up to which a loop over them is not worth vectors.
  integer, parameter :: few = 8
  integer, parameter :: most_passes = 25
  integer, parameter :: most_sweeps = 2000
  !> Pivots below this part of their own diagonal are zero.
  real(wp), parameter :: least_pivot = 1.0e-10_wp
  !> Slacks are known to this part of the largest of their terms.
  real(wp), parameter :: round_off = 1.0e-13_wp
  !> Change of forces, as part of the largest, at which sweeps have settled.
  real(wp), parameter :: settled = 1.0e-13_wp

contains

  !> Make room. What was in it is lost where it was too small.
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
    if (size(problem%x) == size_of(problem%r)) return
    if (allocated(problem%r)) deallocate (problem%r, problem%low, problem%high, problem%at, &
      problem%place, problem%drops, problem%diagonal, problem%slack, problem%terms)
    associate (m => size(problem%x))
      allocate (problem%r(m), problem%low(m), problem%high(m), problem%diagonal(m), &
        problem%slack(m), problem%terms(m), problem%at(m), problem%place(m), problem%drops(m))
    end associate
  end subroutine set_size

  !> A list with room for so many numbers, and some more where it has to be made.
  pure subroutine provide(list, n)
    real(wp), allocatable, intent(inout) :: list(:)
    integer, intent(in) :: n

    if (size_of(list) >= n .and. allocated(list)) return
    if (allocated(list)) deallocate (list)
    allocate (list(n + n/2))
  end subroutine provide

  !> Size of a list, 0 of none.
  pure integer function size_of(list)
    real(wp), allocatable, intent(in) :: list(:)

    size_of = 0
    if (allocated(list)) size_of = size(list)
  end function size_of

  !> Solve for x.
  pure subroutine solve_complementarity(problem, outcome)
    type(problem_t), intent(inout) :: problem
    type(outcome_t), intent(out) :: outcome
    logical :: is_settled
    integer :: pass

    if (problem%n == 0) return
    do pass = 1, most_passes
      outcome%n_pass = pass
      call solve_guess(problem, outcome%n_dropped)
      call find_slacks(problem)
      call mend_guess(problem, is_settled)
      if (is_settled) exit
    end do
    associate (n => problem%n)
      problem%x(:n) = min(max(problem%x(:n), problem%low(:n)), problem%high(:n))
      if (is_settled) return
      call sweep(problem, outcome%n_sweep)
      call find_slacks(problem)
      problem%at(:n) = is_between
      where (problem%x(:n) <= problem%low(:n)) problem%at(:n) = is_low
      where (problem%x(:n) >= problem%high(:n) .and. problem%high(:n) > problem%low(:n)) &
        problem%at(:n) = is_high
    end associate
  end subroutine solve_complementarity

  !> The forces between their bounds that make their slacks zero; the others are at their bounds.
  pure subroutine solve_guess(problem, n_dropped)
    type(problem_t), intent(inout) :: problem
    integer, intent(out) :: n_dropped !! forces of the guess that depend on others
    integer :: i, m
    logical :: has_bounds

    m = 0
    has_bounds = .false.
    do i = 1, problem%n
      problem%drops(i) = .false.
      select case (problem%at(i))
      case (is_low)
        problem%x(i) = problem%low(i)
      case (is_high)
        problem%x(i) = problem%high(i)
      case default
        problem%x(i) = 0.0_wp
        m = m + 1
        problem%place(m) = i
      end select
      has_bounds = has_bounds .or. abs(problem%x(i)) > 0.0_wp
    end do
    n_dropped = 0
    if (m == 0) return
    if (has_bounds) call find_slacks(problem)
    do i = 1, m
      associate (j => problem%place(i))
        problem%solved(i) = -problem%r(j)
        if (has_bounds) problem%solved(i) = -problem%slack(j)
      end associate
    end do
    call take_rows(m, problem%width, problem%place, problem%band, problem%factor)
    call factorise(m, problem%width, problem%factor, problem%diagonal, problem%drops)
    call substitute(m, problem%width, problem%factor, problem%drops, problem%solved)
    if (problem%n_column > 0) call add_columns(m, problem)
    do i = m, 1, -1
      problem%x(problem%place(i)) = problem%solved(i)
      if (problem%drops(i)) n_dropped = n_dropped + 1
      if (problem%place(i) == i) cycle
      problem%drops(problem%place(i)) = problem%drops(i)
      problem%drops(i) = .false.
    end do
  end subroutine solve_guess

  !> The band of some rows.
  pure subroutine take_rows(m, width, place, band, factor)
    integer, intent(in) :: m, width, place(m)
    real(wp), intent(in) :: band(0:width, *)
    real(wp), intent(inout) :: factor(0:width, m)
    integer :: i, j

    if (place(m) == m) then
      ! All so far are in their places.
      factor = band(:, :m)
      return
    end if
    do j = 1, m
      factor(:, j) = 0.0_wp
      do i = j, min(j + width, m)
        if (place(i) - place(j) > width) exit
        factor(i - j, j) = band(place(i) - place(j), place(j))
      end do
    end do
  end subroutine take_rows

  !> Cholesky factors of a band. A row whose pivot is zero takes no part.
  pure subroutine factorise(n, width, factor, diagonal, is_zero)
    integer, intent(in) :: n, width
    real(wp), intent(inout) :: factor(0:width, n)
    real(wp), intent(inout) :: diagonal(n)
    logical, intent(inout) :: is_zero(n)
    integer :: j, k

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
      factor(1:, j) = factor(1:, j)*(1.0_wp/factor(0, j))
      do k = 1, min(width, n - j)
        call take_off(width - k + 1, factor(k, j), factor(k, j), factor(0, j + k))
      end do
    end do
  end subroutine factorise

  !> Take a multiple of numbers off others. Few are cheaper one by one.
  pure subroutine take_off(n, multiple, these, others)
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
  end subroutine take_off

  !> Solve with the factors, in place.
  pure subroutine substitute(n, width, factor, is_zero, y)
    integer, intent(in) :: n, width
    real(wp), intent(in) :: factor(0:width, n)
    logical, intent(in) :: is_zero(n)
    real(wp), intent(inout) :: y(n)
    integer :: j, k

    do j = 1, n
      if (is_zero(j)) y(j) = 0.0_wp
      y(j) = y(j)/factor(0, j)
      do k = 1, min(width, n - j)
        y(j + k) = y(j + k) - factor(k, j)*y(j)
      end do
    end do
    do j = n, 1, -1
      do k = 1, min(width, n - j)
        y(j) = y(j) - factor(k, j)*y(j + k)
      end do
      y(j) = y(j)/factor(0, j)
      if (is_zero(j)) y(j) = 0.0_wp
    end do
  end subroutine substitute

  !> What the columns change in a solution with the band alone: y - Z (1 + V^T Z)^-1 V^T y with
  !> Z = B^-1 V (Woodbury).
  pure subroutine add_columns(m, problem)
    integer, intent(in) :: m !! rows between bounds
    type(problem_t), intent(inout) :: problem
    real(wp) :: core(problem%n_column**2), pushed(problem%n_column), diagonal(problem%n_column)
    logical :: none(problem%n_column)
    real(wp) :: total
    integer :: i, k, l

    associate (n => problem%n, width => problem%n_column - 1, column => problem%column, &
      solved => problem%solved, place => problem%place)
      do k = 1, problem%n_column
        do i = 1, m
          solved(k*m + i) = column((k - 1)*n + place(i))
        end do
        call substitute(m, problem%width, problem%factor, problem%drops, solved(k*m + 1:(k + 1)*m))
      end do
      core = 0.0_wp
      do k = 1, problem%n_column
        do l = 0, problem%n_column
          if (l > 0 .and. l < k) cycle
          total = 0.0_wp
          do i = 1, m
            if (.not. problem%drops(i)) total = total + column((k - 1)*n + place(i))*solved(l*m + i)
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

  !> Forces beyond a bound stay there, those that their slacks draw off one are freed. What depends
  !> on others goes with them.
  pure subroutine mend_guess(problem, is_settled)
    type(problem_t), intent(inout) :: problem
    logical, intent(out) :: is_settled
    integer :: i, former

    is_settled = .true.
    do i = 1, problem%n
      associate (at => problem%at(i), x => problem%x(i), slack => problem%slack(i))
        if (.not. problem%high(i) > problem%low(i)) cycle
        former = at
        if (problem%drops(i)) then
          if (slack > 0.0_wp .or. .not. (slack < 0.0_wp .or. problem%low(i) < 0.0_wp)) at = is_low
          if (slack < 0.0_wp .and. problem%high(i) < huge(1.0_wp)) at = is_high
          is_settled = is_settled .and. at /= is_high &
            .and. .not. (at == is_low .and. problem%low(i) < 0.0_wp)
          cycle
        end if
        select case (former)
        case (is_low)
          if (slack < 0.0_wp) at = is_between
        case (is_high)
          if (slack > 0.0_wp) at = is_between
        case default
          if (x < problem%low(i)) at = is_low
          if (x > problem%high(i)) at = is_high
        end select
        is_settled = is_settled .and. at == former
      end associate
    end do
  end subroutine mend_guess

  !> r + W x; 0 where that is nothing but round-off.
  pure subroutine find_slacks(problem)
    type(problem_t), intent(inout) :: problem
    real(wp) :: total
    integer :: i, k

    associate (n => problem%n)
      do i = 1, n
        problem%slack(i) = problem%r(i)
        problem%terms(i) = abs(problem%r(i))
      end do
      call add_band(n, problem%width, problem%band, problem%x, problem%slack, problem%terms)
      do k = 1, problem%n_column
        associate (column => problem%column((k - 1)*n + 1:k*n))
          total = dot_product(column, problem%x(:n))
          problem%slack(:n) = problem%slack(:n) + total*column
          problem%terms(:n) = problem%terms(:n) + abs(total*column)
        end associate
      end do
      total = 0.0_wp
      do i = 1, n
        total = max(total, problem%terms(i))
      end do
      total = round_off*total
      do i = 1, n
        if (abs(problem%slack(i)) <= total) problem%slack(i) = 0.0_wp
      end do
    end associate
  end subroutine find_slacks

  !> What the band makes of the forces, and the sum of the magnitudes of all terms.
  pure subroutine add_band(n, width, band, x, slack, terms)
    integer, intent(in) :: n, width
    real(wp), intent(in) :: band(0:width, n), x(n)
    real(wp), intent(inout) :: slack(n), terms(n)
    integer :: j, k

    do j = 1, n
      slack(j) = slack(j) + band(0, j)*x(j)
      terms(j) = terms(j) + abs(band(0, j)*x(j))
      do k = 1, min(width, n - j)
        slack(j + k) = slack(j + k) + band(k, j)*x(j)
        terms(j + k) = terms(j + k) + abs(band(k, j)*x(j))
        slack(j) = slack(j) + band(k, j)*x(j + k)
        terms(j) = terms(j) + abs(band(k, j)*x(j + k))
      end do
    end do
  end subroutine add_band

  !> Force by force, each as the others stand, until none changes.
  pure subroutine sweep(problem, n_sweep)
    type(problem_t), intent(inout) :: problem
    integer, intent(out) :: n_sweep
    real(wp) :: change, wanted, diagonal
    integer :: j

    do n_sweep = 1, most_sweeps
      change = 0.0_wp
      do j = 1, problem%n
        associate (x => problem%x(j))
          diagonal = diagonal_at(problem, j)
          if (.not. diagonal > 0.0_wp) cycle
          wanted = min(max(x - slack_at(problem, j)/diagonal, problem%low(j)), problem%high(j))
          change = max(change, abs(wanted - x))
          x = wanted
        end associate
      end do
      if (change <= settled*maxval(abs(problem%x(:problem%n)))) exit
    end do
    n_sweep = min(n_sweep, most_sweeps)
  end subroutine sweep

  !> W(j, j).
  pure function diagonal_at(problem, j) result(diagonal)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: j
    real(wp) :: diagonal
    integer :: k

    diagonal = problem%band((problem%width + 1)*(j - 1) + 1)
    do k = 0, problem%n_column - 1
      diagonal = diagonal + problem%column(k*problem%n + j)**2
    end do
  end function diagonal_at

  !> The slack of one force.
  pure function slack_at(problem, j) result(slack)
    type(problem_t), intent(in) :: problem
    integer, intent(in) :: j
    real(wp) :: slack
    integer :: k

    slack = problem%r(j)
    associate (n => problem%n, width => problem%width, x => problem%x)
      do k = max(1, j - width), j - 1
        slack = slack + problem%band((width + 1)*(k - 1) + j - k + 1)*x(k)
      end do
      do k = j, min(n, j + width)
        slack = slack + problem%band((width + 1)*(j - 1) + k - j + 1)*x(k)
      end do
      do k = 0, problem%n_column - 1
        slack = slack + problem%column(k*n + j) &
          *dot_product(problem%column(k*n + 1:(k + 1)*n), x(:n))
      end do
    end associate
  end function slack_at

end module complementarity_m
