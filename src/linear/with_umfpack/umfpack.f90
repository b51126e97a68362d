! SPDX-License-Identifier: MIT
!> Sparse LU factorisation by UMFPACK (SuiteSparse). This file is compiled where CMake finds the
!> library; `without_umfpack` holds its counterpart.
!>
!> UMFPACK stores columns, sparse_t rows: UMFPACK gets the transpose and solves with the transpose
!> of that.
module umfpack_m
  use, intrinsic :: iso_c_binding, only : c_double, c_int, c_null_ptr, c_ptr
  use kinds_m, only : long, wp
  use memory_m, only : available_bytes
  use sparse_m, only : sparse_t
  implicit none
  private
  public :: umfpack_t, has_umfpack, factor_umfpack, solve_umfpack, free_umfpack

  !> UMFPACK is available.
  logical, parameter :: has_umfpack = .true.

  !> Lengths of UMFPACK's arrays of settings and results, and the indices used: the numbers in
  !> umfpack.h plus one.
  integer, parameter :: n_control = 20, n_info = 90
  integer, parameter :: control_strategy = 6, control_refinement = 8, control_ordering = 11, &
    control_scale = 17
  integer, parameter :: info_lower_entries = 24, info_upper_entries = 25, &
    info_factor_entries = 37, info_smallest_pivot = 72
  !> Settings: pivots on the diagonal where they are good; minimum degree or nested dissection; no
  !> scaling.
  real(c_double), parameter :: strategy_symmetric = 3, ordering_amd = 1, ordering_metis = 3, &
    scale_none = 0
  !> Equations from which nested dissection pays. Seconds for square meshes of quads, minimum
  !> degree/nested dissection: 20,000 equations 0.13/0.18, 45,000 0.49/0.52, 99,000 1.6/1.4 (factors
  !> 153/129 MB).
  integer, parameter :: n_dissected = 60000
  !> Systems of umfpack_di_solve.
  integer(c_int), parameter :: as_given = 0, transposed_system = 1
  integer(c_int), parameter :: status_good = 0, status_singular = 1
  !> Bytes per entry of the factors. Observed peak: 9 to 13.
  real(wp), parameter :: bytes_per_entry = 14.0_wp

  !> Sparse LU factors in memory of the C library, to be freed by free_umfpack.
  type :: umfpack_t
    type(c_ptr) :: numeric = c_null_ptr            !! the factors
    integer(c_int), allocatable :: start(:)        !! (n + 1) where each row starts, from 0
    integer(c_int), allocatable :: index(:)        !! columns, from 0
    real(c_double), allocatable :: entry(:)        !! entries
    real(c_double) :: control(n_control) = 0.0_wp  !! settings
    real(wp) :: smallest_pivot = 0.0_wp            !! absolute value
    logical :: is_negative = .false.               !! the determinant
    integer(long) :: bytes = 0                     !! memory of the factors, estimated beforehand
  end type umfpack_t

  interface
    !> Default settings.
    subroutine umfpack_di_defaults(control) bind(c, name='umfpack_di_defaults')
      import :: c_double
      real(c_double), intent(out) :: control(*)
    end subroutine umfpack_di_defaults

    !> Ordering and symbolic factorisation.
    function umfpack_di_symbolic(n_row, n_column, start, index, entry, symbolic, control, info) &
      result(status) bind(c, name='umfpack_di_symbolic')
      import :: c_double, c_int, c_ptr
      integer(c_int), value :: n_row, n_column
      integer(c_int), intent(in) :: start(*), index(*)
      real(c_double), intent(in) :: entry(*), control(*)
      type(c_ptr), intent(out) :: symbolic
      real(c_double), intent(out) :: info(*)
      integer(c_int) :: status
    end function umfpack_di_symbolic

    !> Numerical factorisation.
    function umfpack_di_numeric(start, index, entry, symbolic, numeric, control, info) &
      result(status) bind(c, name='umfpack_di_numeric')
      import :: c_double, c_int, c_ptr
      integer(c_int), intent(in) :: start(*), index(*)
      real(c_double), intent(in) :: entry(*), control(*)
      type(c_ptr), value :: symbolic
      type(c_ptr), intent(out) :: numeric
      real(c_double), intent(inout) :: info(*)
      integer(c_int) :: status
    end function umfpack_di_numeric

    !> Solve with the factors.
    function umfpack_di_solve(system, start, index, entry, x, b, numeric, control, info) &
      result(status) bind(c, name='umfpack_di_solve')
      import :: c_double, c_int, c_ptr
      integer(c_int), value :: system
      integer(c_int), intent(in) :: start(*), index(*)
      real(c_double), intent(in) :: entry(*), b(*), control(*)
      real(c_double), intent(out) :: x(*)
      type(c_ptr), value :: numeric
      real(c_double), intent(inout) :: info(*)
      integer(c_int) :: status
    end function umfpack_di_solve

    !> The determinant, mantissa*10**exponent.
    function umfpack_di_get_determinant(mantissa, exponent, numeric, info) result(status) &
      bind(c, name='umfpack_di_get_determinant')
      import :: c_double, c_int, c_ptr
      real(c_double), intent(out) :: mantissa, exponent
      type(c_ptr), value :: numeric
      real(c_double), intent(out) :: info(*)
      integer(c_int) :: status
    end function umfpack_di_get_determinant

    !> Free a symbolic factorisation.
    subroutine umfpack_di_free_symbolic(symbolic) bind(c, name='umfpack_di_free_symbolic')
      import :: c_ptr
      type(c_ptr), intent(inout) :: symbolic
    end subroutine umfpack_di_free_symbolic

    !> Free a numerical factorisation.
    subroutine umfpack_di_free_numeric(numeric) bind(c, name='umfpack_di_free_numeric')
      import :: c_ptr
      type(c_ptr), intent(inout) :: numeric
    end subroutine umfpack_di_free_numeric
  end interface

contains

  !> Factorise a compressed matrix without empty rows. `factored` is false where memory does not
  !> suffice. A zero pivot is no failure, but the factors cannot be used then.
  subroutine factor_umfpack(matrix, factor, factored)
    type(sparse_t), intent(in) :: matrix
    type(umfpack_t), intent(inout) :: factor !! earlier factors in it are freed
    logical, intent(out) :: factored
    real(c_double) :: info(n_info), mantissa, exponent, entries
    type(c_ptr) :: symbolic
    integer(c_int) :: status

    call free_umfpack(factor)
    factored = .false.
    call umfpack_di_defaults(factor%control)
    factor%control(control_strategy) = strategy_symmetric
    factor%control(control_ordering) = merge(ordering_metis, ordering_amd, matrix%n >= n_dissected)
    factor%control(control_scale) = scale_none
    factor%control(control_refinement) = 0
    factor%start = matrix%first - 1
    factor%index = matrix%column - 1
    factor%entry = matrix%value
    status = umfpack_di_symbolic(matrix%n, matrix%n, factor%start, factor%index, factor%entry, &
      symbolic, factor%control, info)
    if (status /= status_good .and. status /= status_singular) return
    ! Entries of the factors: as counted for diagonal pivots; else an upper bound.
    entries = info(info_factor_entries)
    if (entries < 0.0_wp) entries = info(info_lower_entries) + info(info_upper_entries)
    factor%bytes = int(bytes_per_entry*entries, long)
    if (factor%bytes < available_bytes()) then
      status = umfpack_di_numeric(factor%start, factor%index, factor%entry, symbolic, &
        factor%numeric, factor%control, info)
      factored = status == status_good .or. status == status_singular
      factor%smallest_pivot = info(info_smallest_pivot)
      if (factored .and. umfpack_di_get_determinant(mantissa, exponent, factor%numeric, info) &
        == status_good) factor%is_negative = mantissa < 0.0_c_double
    end if
    call umfpack_di_free_symbolic(symbolic)
  end subroutine factor_umfpack

  !> x := A^-1 b, or A^-T b.
  subroutine solve_umfpack(factor, transposed, b, x)
    type(umfpack_t), intent(in) :: factor
    logical, intent(in) :: transposed !! solve with the transpose
    real(wp), intent(in) :: b(:)      !! (n)
    real(wp), intent(out) :: x(:)     !! (n)
    real(c_double) :: info(n_info)
    integer(c_int) :: status

    status = umfpack_di_solve(merge(as_given, transposed_system, transposed), factor%start, &
      factor%index, factor%entry, x, b, factor%numeric, factor%control, info)
    if (status /= status_good) x = 0.0_wp
  end subroutine solve_umfpack

  !> Free the factors.
  subroutine free_umfpack(factor)
    type(umfpack_t), intent(inout) :: factor

    call umfpack_di_free_numeric(factor%numeric)
    factor%numeric = c_null_ptr
  end subroutine free_umfpack

end module umfpack_m
