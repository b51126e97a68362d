! SPDX-License-Identifier: MIT
!> What a freight carries besides pieces of arrays: single values, texts, and lists that are not
!> there until it is unloaded. As they lie in memory: who loads and who unloads are programs of one
!> build.
module freight_lists_m
  use, intrinsic :: iso_c_binding, only : c_loc, c_ptr, c_size_t
  use c_files_m, only : c_memcpy
  use freight_m, only : freight_t
  use kinds_m, only : wp
  implicit none
  private
  public :: pass, pass_text, pass_plain, absent

  !> Some single values of one kind, or a list or a table that may not be there.
  interface pass
    module procedure pass_some_integers
    module procedure pass_some_reals
    module procedure pass_some_logicals
    module procedure pass_integer_list
    module procedure pass_real_list
    module procedure pass_logical_list
    module procedure pass_integer_table
    module procedure pass_real_table
    module procedure pass_logical_table
  end interface pass

  integer, parameter :: real_bytes = storage_size(1.0_wp)/8
  !> Extent of what is not there.
  integer, parameter :: absent = -1

contains

  !> Items that lie side by side, of any type without allocatable components.
  subroutine pass_plain(freight, place, n_bit, n)
    type(freight_t), intent(inout), target :: freight
    type(c_ptr), intent(in) :: place  !! of the first one
    integer, intent(in) :: n_bit      !! storage size of an item
    integer, intent(in) :: n          !! items, one at least
    integer(c_size_t) :: n_byte
    type(c_ptr) :: ignored

    n_byte = int(n_bit/8, c_size_t)*n
    if (allocated(freight%values)) then
      if (freight%unloads) then
        ignored = c_memcpy(place, c_loc(freight%values(freight%n + 1)), n_byte)
      else
        ignored = c_memcpy(c_loc(freight%values(freight%n + 1)), place, n_byte)
      end if
    end if
    freight%n = freight%n + int((n_byte + real_bytes - 1)/real_bytes)
  end subroutine pass_plain

  !> Single integers.
  subroutine pass_some_integers(freight, a, b, c, d, e, f, g)
    type(freight_t), intent(inout) :: freight
    integer, intent(inout), target :: a
    integer, intent(inout), optional, target :: b, c, d, e, f, g

    call pass_plain(freight, c_loc(a), storage_size(a), 1)
    if (present(b)) call pass_plain(freight, c_loc(b), storage_size(b), 1)
    if (present(c)) call pass_plain(freight, c_loc(c), storage_size(c), 1)
    if (present(d)) call pass_plain(freight, c_loc(d), storage_size(d), 1)
    if (present(e)) call pass_plain(freight, c_loc(e), storage_size(e), 1)
    if (present(f)) call pass_plain(freight, c_loc(f), storage_size(f), 1)
    if (present(g)) call pass_plain(freight, c_loc(g), storage_size(g), 1)
  end subroutine pass_some_integers

  !> Single reals.
  subroutine pass_some_reals(freight, a, b, c, d, e, f, g)
    type(freight_t), intent(inout) :: freight
    real(wp), intent(inout), target :: a
    real(wp), intent(inout), optional, target :: b, c, d, e, f, g

    call pass_plain(freight, c_loc(a), storage_size(a), 1)
    if (present(b)) call pass_plain(freight, c_loc(b), storage_size(b), 1)
    if (present(c)) call pass_plain(freight, c_loc(c), storage_size(c), 1)
    if (present(d)) call pass_plain(freight, c_loc(d), storage_size(d), 1)
    if (present(e)) call pass_plain(freight, c_loc(e), storage_size(e), 1)
    if (present(f)) call pass_plain(freight, c_loc(f), storage_size(f), 1)
    if (present(g)) call pass_plain(freight, c_loc(g), storage_size(g), 1)
  end subroutine pass_some_reals

  !> Single logical values.
  subroutine pass_some_logicals(freight, a, b, c, d)
    type(freight_t), intent(inout) :: freight
    logical, intent(inout), target :: a
    logical, intent(inout), optional, target :: b, c, d

    call pass_plain(freight, c_loc(a), storage_size(a), 1)
    if (present(b)) call pass_plain(freight, c_loc(b), storage_size(b), 1)
    if (present(c)) call pass_plain(freight, c_loc(c), storage_size(c), 1)
    if (present(d)) call pass_plain(freight, c_loc(d), storage_size(d), 1)
  end subroutine pass_some_logicals

  !> A text that may not be there.
  subroutine pass_text(freight, text)
    type(freight_t), intent(inout) :: freight
    character(:), allocatable, intent(inout), target :: text
    integer :: n

    n = absent
    if (allocated(text)) n = len(text)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (character(n) :: text)
    if (n > 0) call pass_plain(freight, c_loc(text), 8, n)
  end subroutine pass_text

  !> A list of integers.
  subroutine pass_integer_list(freight, values)
    type(freight_t), intent(inout) :: freight
    integer, allocatable, intent(inout), target :: values(:)
    integer :: n

    n = absent
    if (allocated(values)) n = size(values)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (values(n))
    if (n > 0) call pass_plain(freight, c_loc(values(1)), storage_size(values), n)
  end subroutine pass_integer_list

  !> A list of reals.
  subroutine pass_real_list(freight, values)
    type(freight_t), intent(inout) :: freight
    real(wp), allocatable, intent(inout), target :: values(:)
    integer :: n

    n = absent
    if (allocated(values)) n = size(values)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (values(n))
    if (n > 0) call pass_plain(freight, c_loc(values(1)), storage_size(values), n)
  end subroutine pass_real_list

  !> A list of logical values.
  subroutine pass_logical_list(freight, values)
    type(freight_t), intent(inout) :: freight
    logical, allocatable, intent(inout), target :: values(:)
    integer :: n

    n = absent
    if (allocated(values)) n = size(values)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (values(n))
    if (n > 0) call pass_plain(freight, c_loc(values(1)), storage_size(values), n)
  end subroutine pass_logical_list

  !> A table of integers.
  subroutine pass_integer_table(freight, values)
    type(freight_t), intent(inout) :: freight
    integer, allocatable, intent(inout), target :: values(:, :)
    integer :: n(2)

    n = absent
    if (allocated(values)) n = shape(values)
    call pass(freight, n(1), n(2))
    if (freight%unloads .and. n(1) /= absent) allocate (values(n(1), n(2)))
    if (product(n) > 0 .and. n(1) /= absent) &
      call pass_plain(freight, c_loc(values(1, 1)), storage_size(values), product(n))
  end subroutine pass_integer_table

  !> A table of reals.
  subroutine pass_real_table(freight, values)
    type(freight_t), intent(inout) :: freight
    real(wp), allocatable, intent(inout), target :: values(:, :)
    integer :: n(2)

    n = absent
    if (allocated(values)) n = shape(values)
    call pass(freight, n(1), n(2))
    if (freight%unloads .and. n(1) /= absent) allocate (values(n(1), n(2)))
    if (product(n) > 0 .and. n(1) /= absent) &
      call pass_plain(freight, c_loc(values(1, 1)), storage_size(values), product(n))
  end subroutine pass_real_table

  !> A table of logical values.
  subroutine pass_logical_table(freight, values)
    type(freight_t), intent(inout) :: freight
    logical, allocatable, intent(inout), target :: values(:, :)
    integer :: n(2)

    n = absent
    if (allocated(values)) n = shape(values)
    call pass(freight, n(1), n(2))
    if (freight%unloads .and. n(1) /= absent) allocate (values(n(1), n(2)))
    if (product(n) > 0 .and. n(1) /= absent) &
      call pass_plain(freight, c_loc(values(1, 1)), storage_size(values), product(n))
  end subroutine pass_logical_table

end module freight_lists_m
