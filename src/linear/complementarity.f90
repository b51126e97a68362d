! SPDX-License-Identifier: MIT
!> Forces that only push: x >= 0 and s = r + W x >= 0, of each pair one being zero, with W a
!> symmetric band without negative eigenvalues. Which forces act is guessed, solved for and mended
!> until nothing is left to mend; where that goes round in circles, sweeps of Gauss-Seidel settle
!> it. Factors of this file's own: of rows that depend on others the later ones are left out while
!> the band is factorised, and no library can change the bits.
module complementarity_m
  use kinds_m, only : wp
  implicit none
  private
  public :: solve_complementarity, outcome_t, most_passes

  !> What a solution has taken.
  type :: outcome_t
    integer :: n_pass = 0     !! guesses solved for
    integer :: n_sweep = 0    !! sweeps, where the guesses did not settle
    integer :: n_dropped = 0  !! forces left out of the last guess: the others do what they would
  end type outcome_t

  integer, parameter :: most_passes = 25
  integer, parameter :: most_sweeps = 2000
  !> Pivots below this part of their own diagonal are zero.
  real(wp), parameter :: least_pivot = 1.0e-10_wp
  !> Slacks are known to this part of the largest of their terms.
  real(wp), parameter :: round_off = 1.0e-13_wp
  !> Change of forces, as part of the largest, at which sweeps have settled.
  real(wp), parameter :: settled = 1.0e-13_wp

contains

  !> Solve for x. `acts` is the guess, and comes back as the forces that act.
  pure subroutine solve_complementarity(n, width, band, r, acts, x, outcome)
    integer, intent(in) :: n, width
    real(wp), intent(in) :: band(0:width, n) !! W(j + i, j) in row i of column j
    real(wp), intent(in) :: r(n)
    logical, intent(inout) :: acts(n)
    real(wp), intent(out) :: x(n)
    type(outcome_t), intent(out) :: outcome
    real(wp) :: slack(n)
    logical :: drops(n), was(n)
    integer :: pass

    do pass = 1, most_passes
      outcome%n_pass = pass
      call solve_guess(n, width, band, r, acts, x, drops)
      outcome%n_dropped = count(drops)
      slack = slacks(n, width, band, r, x)
      was = acts
      acts = (was .and. .not. drops .and. x >= 0.0_wp) .or. (.not. was .and. slack < 0.0_wp)
      ! What depends on forces that act goes with them.
      where (drops) acts = slack < 0.0_wp
      if (all(acts .or. drops .eqv. was)) then
        x = max(x, 0.0_wp)
        return
      end if
    end do
    x = max(x, 0.0_wp)
    call sweep(n, width, band, r, x, outcome%n_sweep)
    acts = x > 0.0_wp
  end subroutine solve_complementarity

  !> All forces of the guess that make their slacks zero; the others are zero.
  pure subroutine solve_guess(n, width, band, r, acts, x, drops)
    integer, intent(in) :: n, width
    real(wp), intent(in) :: band(0:width, n), r(n)
    logical, intent(in) :: acts(n)
    real(wp), intent(out) :: x(n)
    logical, intent(out) :: drops(n) !! forces of the guess that depend on others
    real(wp) :: factor(0:width, n), y(n)
    logical :: is_zero(n)
    integer :: place(n), i, j, m

    m = 0
    do i = 1, n
      if (.not. acts(i)) cycle
      m = m + 1
      place(m) = i
      y(m) = -r(i)
    end do
    do j = 1, m
      factor(:, j) = 0.0_wp
      do i = j, min(j + width, m)
        if (place(i) - place(j) > width) exit
        factor(i - j, j) = band(place(i) - place(j), place(j))
      end do
    end do
    call factorise(m, width, factor, is_zero)
    call substitute(m, width, factor, is_zero, y)
    x = 0.0_wp
    drops = .false.
    do j = 1, m
      x(place(j)) = y(j)
      drops(place(j)) = is_zero(j)
    end do
  end subroutine solve_guess

  !> Cholesky factors of a band. A row whose pivot is zero takes no part.
  pure subroutine factorise(n, width, factor, is_zero)
    integer, intent(in) :: n, width
    real(wp), intent(inout) :: factor(0:width, *)
    logical, intent(out) :: is_zero(*)
    real(wp) :: diagonal(n)
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
      factor(1:, j) = factor(1:, j)/factor(0, j)
      do k = 1, min(width, n - j)
        factor(0:width - k, j + k) = factor(0:width - k, j + k) - factor(k, j)*factor(k:width, j)
      end do
    end do
  end subroutine factorise

  !> Solve with the factors, in place.
  pure subroutine substitute(n, width, factor, is_zero, y)
    integer, intent(in) :: n, width
    real(wp), intent(in) :: factor(0:width, *)
    logical, intent(in) :: is_zero(*)
    real(wp), intent(inout) :: y(*)
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

  !> r + W x; 0 where that is nothing but round-off.
  pure function slacks(n, width, band, r, x) result(slack)
    integer, intent(in) :: n, width
    real(wp), intent(in) :: band(0:width, n), r(n), x(n)
    real(wp) :: slack(n)
    real(wp) :: terms(n)
    integer :: j, k

    slack = r
    terms = abs(r)
    do j = 1, n
      if (.not. abs(x(j)) > 0.0_wp) cycle
      call add(band(0, j)*x(j), slack(j), terms(j))
      do k = 1, min(width, n - j)
        call add(band(k, j)*x(j), slack(j + k), terms(j + k))
      end do
      do k = 1, min(width, j - 1)
        call add(band(k, j - k)*x(j), slack(j - k), terms(j - k))
      end do
    end do
    where (abs(slack) <= round_off*maxval([terms, 0.0_wp])) slack = 0.0_wp
  end function slacks

  !> Add a term to a sum and to that of magnitudes.
  pure subroutine add(term, total, magnitude)
    real(wp), intent(in) :: term
    real(wp), intent(inout) :: total, magnitude

    total = total + term
    magnitude = magnitude + abs(term)
  end subroutine add

  !> Force by force, each as the others stand, until none changes.
  pure subroutine sweep(n, width, band, r, x, n_sweep)
    integer, intent(in) :: n, width
    real(wp), intent(in) :: band(0:width, n), r(n)
    real(wp), intent(inout) :: x(n)
    integer, intent(out) :: n_sweep
    real(wp) :: change, wanted, total
    integer :: j, k

    do n_sweep = 1, most_sweeps
      change = 0.0_wp
      do j = 1, n
        if (.not. band(0, j) > 0.0_wp) cycle
        total = r(j)
        do k = 1, min(width, n - j)
          total = total + band(k, j)*x(j + k)
        end do
        do k = 1, min(width, j - 1)
          total = total + band(k, j - k)*x(j - k)
        end do
        wanted = max(0.0_wp, -total/band(0, j))
        change = max(change, abs(wanted - x(j)))
        x(j) = wanted
      end do
      if (change <= settled*maxval(x)) exit
    end do
    n_sweep = min(n_sweep, most_sweeps)
  end subroutine sweep

end module complementarity_m
