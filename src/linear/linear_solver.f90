! SPDX-License-Identifier: MIT
!> Solution of A x = b for a sparse matrix with a nearly symmetric pattern, symmetric in value or
!> not, with a measure of its accuracy. The matrix is equilibrated to row and column maxima of about
!> one (Ruiz 2001), so that a penalty a million times stiffer than the elements does not hide soft
!> modes. LU factors are banded for small bandwidths, else sparse. Theory: doc/theory/implicit.md,
!> "Linear systems".
module linear_solver_m
  use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
  use sparse_m, only : banded_lu_t, bandwidth, factor_banded, reverse_cuthill_mckee, solve_banded, &
    multiply, sparse_t
  use kinds_m, only : long, wp
  use log_m, only : to_text
  use memory_m, only : available_bytes
  use umfpack_m, only : has_umfpack, factor_umfpack, free_umfpack, solve_umfpack, umfpack_t
  implicit none
  private
  public :: report_t, solve_linear, method_banded, method_sparse, equilibrate

  !> Ratio of the norms of A z and |A||z| (A equilibrated) below which A is singular. Observed:
  !> 0.4e-16 to 7e-16 for rigid motions of up to 100,000 equations; 4e-15 for two blocks in contact
  !> with a penalty 1e12 times their stiffness, 6e-14 for a cantilever of 2000 x 2 quads.
  real(wp), parameter :: singular_tolerance = 1.5e-15_wp
  !> Ratio up to which errors of the factors may dominate A z, so that z is corrected.
  real(wp), parameter :: doubtful = 1.0e3_wp*singular_tolerance
  !> Largest number of corrections of z.
  integer, parameter :: n_correction = 2
  !> Largest residual of a solution.
  real(wp), parameter :: residual_tolerance = 1.0e-10_wp
  !> Largest number of refinement steps.
  integer, parameter :: n_refinement = 5

  !> Report on a solution.
  type :: report_t
    logical :: is_solved = .false.        !! x is a solution; else `message` says why not
    character(:), allocatable :: method   !! in words
    integer :: bandwidth = 0              !! on either side of the diagonal, equations reordered
    integer(long) :: bytes = 0            !! memory of the factors
    logical :: is_negative = .false.      !! the determinant: an odd number of negative eigenvalues
    real(wp) :: residual = huge(1.0_wp)   !! max |b - A x| / max(|A||x| + |b|), A equilibrated
    integer :: n_refinement = 0           !! steps of iterative refinement
    logical :: is_singular = .false.      !! a motion has no stiffness to round-off, ...
    integer :: equation = 0               !! ... largest at this equation (0: unknown); or an entry
                                          !! is not finite
    real(wp) :: stiffness = 0.0_wp        !! norm of A z / norm of |A||z|, z the motion of least
                                          !! stiffness
    logical :: out_of_memory = .false.    !! the factors do not fit
    character(:), allocatable :: message  !! fault in words
  end type report_t

  !> Methods.
  integer, parameter :: method_banded = 1, method_sparse = 2

  !> Largest bandwidth for LAPACK where UMFPACK is available. Seconds to factorise on one core
  !> (gfortran 12, reference BLAS), quads with two equations a node, banded/sparse:
  !>    square meshes          20 x 20 (bandwidth 79)  0.003/0.002,  40 x 40 (159)  0.041/0.012,
  !>                           100 x 100 (399)  1.35/0.13
  !>    slender meshes         4000 x 10 (45)  0.06/0.47,  500 x 20 (85)  0.09/0.11
  integer, parameter :: widest_band = 80

  !> Smallest pivot used in a solution, for entries of about one: far below the round-off of a zero
  !> pivot, but large enough to avoid overflow.
  real(wp), parameter :: least_pivot = 1.0e-3_wp*epsilon(1.0_wp)

  !> Factors; one of the two is allocated. The sparse one must be freed.
  type :: factor_t
    integer :: method = method_banded  !! method used
    type(banded_lu_t) :: banded        !! ordered also for the other method
    type(umfpack_t) :: sparse
    logical :: is_negative = .false.   !! the determinant
    logical :: has_tiny_pivot = .false. !! sparse: cannot be solved with, not even for a perturbed
                                        !! matrix
  end type factor_t

  !> Each sweep halves the exponent of what is left to scale.
  integer, parameter :: n_sweep = 5

contains

  !> Solve. For a singular matrix x is the solution of the factors, with a large free motion; zero
  !> without factors.
  subroutine solve_linear(matrix, b, x, report, method)
    type(sparse_t), intent(in) :: matrix    !! compressed
    real(wp), intent(in) :: b(:)            !! (n)
    real(wp), intent(out) :: x(:)           !! (n)
    type(report_t), intent(out) :: report
    integer, intent(in), optional :: method !! one of `method_`; absent: the best
    type(sparse_t) :: scaled, magnitudes
    type(factor_t) :: factor
    real(wp), allocatable :: row_scale(:), column_scale(:)
    logical :: factored

    x = 0.0_wp
    report%message = ''
    report%method = 'none'
    call check_entries(matrix, b, report)
    if (report%equation > 0) return
    if (matrix%n == 0) then
      report%is_solved = .true.
      report%residual = 0.0_wp
      return
    end if
    allocate (row_scale(matrix%n), column_scale(matrix%n))
    call equilibrate(matrix, row_scale, column_scale, scaled)
    call factor_matrix(scaled, factor, factored, method)
    report%bandwidth = factor%banded%width
    report%is_negative = factor%is_negative
    report%method = 'banded LU (LAPACK)'
    report%bytes = factor%banded%bytes
    if (factor%method == method_sparse) then
      report%method = 'sparse LU (UMFPACK)'
      report%bytes = factor%sparse%bytes
    end if
    if (.not. factored) then
      ! Memory needed, and remedy.
      report%out_of_memory = .true.
      report%message = 'the factors of '//to_text(matrix%n)//' equations ('//report%method &
        //', bandwidth '//to_text(report%bandwidth)//') need ' &
        //to_text(nint(1.0e-6_wp*report%bytes))//' MB, but ' &
        //to_text(nint(1.0e-6_wp*available_bytes()))//' MB are free'
      if (factor%method == method_sparse .and. .not. has_umfpack) then
        report%message = 'this program was built without UMFPACK'
      else if (.not. has_umfpack) then
        report%message = report%message//'; a program built with UMFPACK (libsuitesparse-dev on ' &
          //'Debian and Ubuntu) needs far less'
      end if
    else
      magnitudes = scaled
      magnitudes%value = abs(magnitudes%value)
      call find_free_motion(scaled, magnitudes, factor, column_scale, report)
      if (.not. factor%has_tiny_pivot) then
        call solve_refined(scaled, magnitudes, factor, row_scale*b, x, report)
        x = column_scale*x
      end if
    end if
    call free_umfpack(factor%sparse)
  end subroutine solve_linear

  !> Check that every entry is finite and no row or column is zero.
  pure subroutine check_entries(matrix, b, report)
    type(sparse_t), intent(in) :: matrix
    real(wp), intent(in) :: b(:)
    type(report_t), intent(inout) :: report
    real(wp), allocatable :: ones(:), row_largest(:), column_largest(:)
    integer :: i

    do i = 1, matrix%n
      associate (entries => matrix%value(matrix%first(i):matrix%first(i + 1) - 1))
        if (.not. (all(ieee_is_finite(entries)) .and. ieee_is_finite(b(i)))) then
          report%equation = i
          report%message = 'an entry of the linear system is not finite'
          return
        end if
      end associate
    end do
    allocate (ones(matrix%n), source=1.0_wp)
    allocate (row_largest(matrix%n), column_largest(matrix%n))
    call find_largest(matrix, ones, ones, row_largest, column_largest)
    report%equation = findloc(min(row_largest, column_largest) <= 0.0_wp, .true., dim=1)
    report%is_singular = report%equation > 0
    if (report%is_singular) report%message = 'the matrix is singular: a row or column of it is zero'
  end subroutine check_entries

  !> Motion z of least stiffness: one step of inverse iteration for the smallest singular value, z =
  !> A^-1 A^-T s. For a singular matrix both solutions grow along the free motion, and A z is
  !> round-off.
  subroutine find_free_motion(scaled, magnitudes, factor, column_scale, report)
    type(sparse_t), intent(in) :: scaled, magnitudes !! A and |A|
    type(factor_t), intent(in) :: factor
    real(wp), intent(in) :: column_scale(:) !! (n)
    type(report_t), intent(inout) :: report
    real(wp), allocatable :: s(:), z(:)
    real(wp) :: least
    integer :: i

    if (factor%has_tiny_pivot) then
      report%is_singular = .true.
      report%message = 'the matrix is singular'
      return
    end if
    ! Irregular, so that it is not orthogonal to a free motion, and reproducible.
    s = [(1.0_wp + modulo(0.618033988749895_wp*real(i, wp)**2, 1.0_wp), i=1, scaled%n)]
    allocate (z(scaled%n))
    call solve_factored(factor, .true., s, z)
    s = z/maxval(abs(z))
    call solve_factored(factor, .false., s, z)
    z = z/maxval(abs(z))
    report%stiffness = stiffness_met(scaled, magnitudes, z)
    do i = 1, n_correction
      if (report%stiffness <= singular_tolerance .or. report%stiffness > doubtful) exit
      ! With exact factors z - A^-1 A z would vanish; with factors of A + E, z is a free motion of A
      ! + E, and this removes the part of A z due to E.
      call solve_factored(factor, .false., multiply(scaled, z), s)
      s = z - s
      if (.not. maxval(abs(s)) > 0.0_wp) exit
      s = s/maxval(abs(s))
      least = stiffness_met(scaled, magnitudes, s)
      if (.not. least < report%stiffness) exit
      report%stiffness = least
      z = s
    end do
    report%is_singular = report%stiffness <= singular_tolerance
    if (.not. report%is_singular) return
    report%equation = maxloc(abs(column_scale*z), dim=1)
    report%message = 'the matrix is singular: a motion meets no stiffness'
  end subroutine find_free_motion

  !> |A z| / ||A||z||, Euclidean norms.
  pure function stiffness_met(scaled, magnitudes, z) result(stiffness)
    type(sparse_t), intent(in) :: scaled, magnitudes !! A and |A|
    real(wp), intent(in) :: z(:) !! (n), not zero
    real(wp) :: stiffness

    stiffness = norm2(multiply(scaled, z))/norm2(multiply(magnitudes, abs(z)))
  end function stiffness_met

  !> Solve and refine until no equation improves (as LAPACK's dgerfs).
  subroutine solve_refined(scaled, magnitudes, factor, b, x, report)
    type(sparse_t), intent(in) :: scaled, magnitudes !! A and |A|
    type(factor_t), intent(in) :: factor
    real(wp), intent(in) :: b(:)    !! (n)
    real(wp), intent(out) :: x(:)   !! (n)
    type(report_t), intent(inout) :: report
    real(wp), allocatable :: residual(:), magnitude(:), change(:)
    real(wp) :: error, last_error

    allocate (change(scaled%n))
    call solve_factored(factor, .false., b, x)
    last_error = huge(last_error)
    do
      residual = b - multiply(scaled, x)
      magnitude = multiply(magnitudes, abs(x)) + abs(b)
      ! Equation by equation, with a floor for equations with small terms.
      error = maxval(abs(residual)/(magnitude + tiny(1.0_wp) + epsilon(1.0_wp)*maxval(magnitude)))
      report%residual = maxval(abs(residual))/max(maxval(magnitude), tiny(1.0_wp))
      if (error <= epsilon(1.0_wp) .or. error > 0.5_wp*last_error) exit
      if (report%n_refinement == n_refinement) exit
      last_error = error
      call solve_factored(factor, .false., residual, change)
      x = x + change
      report%n_refinement = report%n_refinement + 1
    end do
    report%is_solved = report%residual <= residual_tolerance .and. .not. report%is_singular
    if (.not. (report%is_solved .or. report%is_singular)) &
      report%message = 'the linear system could not be solved accurately'
  end subroutine solve_refined

  !> Factorise a compressed, equilibrated matrix. `factored` is false where memory does not suffice.
  !> A matrix with a zero pivot in its sparse factors is factorised again with a perturbed diagonal
  !> (last digit of one): still singular, but solvable.
  subroutine factor_matrix(matrix, factor, factored, method)
    type(sparse_t), intent(in) :: matrix
    type(factor_t), intent(inout) :: factor
    logical, intent(out) :: factored
    integer, intent(in), optional :: method
    type(sparse_t) :: shifted
    integer :: i, k

    factor%banded%order = reverse_cuthill_mckee(matrix)
    factor%banded%width = bandwidth(matrix, factor%banded%order)
    factor%banded%bytes = 8_long*(3_long*factor%banded%width + 1)*matrix%n
    factor%method = merge(method_sparse, method_banded, has_umfpack &
      .and. factor%banded%width > widest_band)
    if (present(method)) factor%method = method
    if (factor%method /= method_sparse) then
      call factor_banded(matrix, least_pivot, factor%banded, factored)
      factor%is_negative = factor%banded%is_negative
      return
    end if
    call factor_umfpack(matrix, factor%sparse, factored)
    if (factored .and. factor%sparse%smallest_pivot < least_pivot) then
      shifted = matrix
      do i = 1, matrix%n
        do k = matrix%first(i), matrix%first(i + 1) - 1
          if (matrix%column(k) == i) shifted%value(k) = matrix%value(k) + 2.0_wp*epsilon(1.0_wp)
        end do
      end do
      call factor_umfpack(shifted, factor%sparse, factored)
      factor%has_tiny_pivot = factor%sparse%smallest_pivot < least_pivot
    end if
    factor%is_negative = factor%sparse%is_negative
  end subroutine factor_matrix

  !> x := A^-1 b, or A^-T b.
  subroutine solve_factored(factor, transposed, b, x)
    type(factor_t), intent(in) :: factor
    logical, intent(in) :: transposed !! solve with the transpose
    real(wp), intent(in) :: b(:)      !! (n)
    real(wp), intent(out) :: x(:)     !! (n)

    if (factor%method == method_sparse) then
      call solve_umfpack(factor%sparse, transposed, b, x)
    else
      call solve_banded(factor%banded, transposed, b, x)
    end if
  end subroutine solve_factored

  !> Scaled matrix row_scale(i)*matrix(i, j)*column_scale(j) with row and column maxima from 1/4 to
  !> about 1. The scales are powers of two, so that nothing is rounded. No row or column may be
  !> empty or zero.
  pure subroutine equilibrate(matrix, row_scale, column_scale, scaled)
    type(sparse_t), intent(in) :: matrix
    real(wp), intent(out) :: row_scale(:)    !! (n)
    real(wp), intent(out) :: column_scale(:) !! (n)
    type(sparse_t), intent(out) :: scaled    !! compressed
    real(wp), allocatable :: row_largest(:), column_largest(:)
    integer :: sweep, i, k

    allocate (row_largest(matrix%n), column_largest(matrix%n))
    row_scale = 1.0_wp
    column_scale = 1.0_wp
    do sweep = 1, n_sweep
      call find_largest(matrix, row_scale, column_scale, row_largest, column_largest)
      row_scale = row_scale/sqrt(row_largest)
      column_scale = column_scale/sqrt(column_largest)
    end do
    row_scale = scale(1.0_wp, exponent(row_scale) - 1)
    column_scale = scale(1.0_wp, exponent(column_scale) - 1)
    scaled%n = matrix%n
    scaled%first = matrix%first
    scaled%column = matrix%column
    allocate (scaled%value(size(matrix%value)))
    do i = 1, matrix%n
      do k = matrix%first(i), matrix%first(i + 1) - 1
        scaled%value(k) = row_scale(i)*matrix%value(k)*column_scale(matrix%column(k))
      end do
    end do
  end subroutine equilibrate

  !> Largest scaled entry of each row and column.
  pure subroutine find_largest(matrix, row_scale, column_scale, row_largest, column_largest)
    type(sparse_t), intent(in) :: matrix
    real(wp), intent(in) :: row_scale(:)       !! (n)
    real(wp), intent(in) :: column_scale(:)    !! (n)
    real(wp), intent(out) :: row_largest(:)    !! (n)
    real(wp), intent(out) :: column_largest(:) !! (n)
    real(wp) :: entry
    integer :: i, j, k

    row_largest = 0.0_wp
    column_largest = 0.0_wp
    do i = 1, matrix%n
      do k = matrix%first(i), matrix%first(i + 1) - 1
        j = matrix%column(k)
        entry = abs(matrix%value(k))*row_scale(i)*column_scale(j)
        row_largest(i) = max(row_largest(i), entry)
        column_largest(j) = max(column_largest(j), entry)
      end do
    end do
  end subroutine find_largest

end module linear_solver_m
