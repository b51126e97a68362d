! SPDX-License-Identifier: MIT
!> Components of an archive: `keep` puts one into an archive that is written and takes it from one
!> that is read, so that no list of components exists twice.
module archive_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use hdf5, only : hid_t
  use archive_file_m, only : archive_t, put_array, put_null, get_extents, get_values
  use hdf5_library_m, only : read_text
  use hdf5_writing_m, only : as_real, as_integer, as_index, write_text
  use kinds_m, only : wp, long
  implicit none
  private
  public :: keep, keep_fixed, keep_text

  !> Write a component into the archive, or read it. Arrays take their shape from the file.
  interface keep
    module procedure keep_real
    module procedure keep_integer
    module procedure keep_long
    module procedure keep_logical
    module procedure keep_reals
    module procedure keep_real_table
    module procedure keep_integers
    module procedure keep_integer_table
    module procedure keep_logicals
  end interface keep

contains

  !> An array of reals.
  subroutine keep_reals(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    real(wp), allocatable, intent(inout), target :: values(:)
    integer(hid_t) :: dataset
    integer :: extents(1)
    logical :: is_there

    if (archive%is_read) then
      if (allocated(values)) deallocate (values)
      call get_extents(archive, name, extents, is_there, dataset)
      if (.not. is_there) return
      allocate (values(extents(1)))
      call get_values(archive, as_real, dataset, size(values), c_loc(values))
    else if (allocated(values)) then
      call put_array(archive, name, as_real, .true., shape(values), c_loc(values))
    else
      call put_null(archive, name, as_real)
    end if
  end subroutine keep_reals

  !> A table of reals.
  subroutine keep_real_table(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    real(wp), allocatable, intent(inout), target :: values(:, :)
    integer(hid_t) :: dataset
    integer :: extents(2)
    logical :: is_there

    if (archive%is_read) then
      if (allocated(values)) deallocate (values)
      call get_extents(archive, name, extents, is_there, dataset)
      if (.not. is_there) return
      allocate (values(extents(1), extents(2)))
      call get_values(archive, as_real, dataset, size(values), c_loc(values))
    else if (allocated(values)) then
      call put_array(archive, name, as_real, .true., shape(values), c_loc(values))
    else
      call put_null(archive, name, as_real)
    end if
  end subroutine keep_real_table

  !> An array of integers.
  subroutine keep_integers(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, allocatable, intent(inout), target :: values(:)
    integer(hid_t) :: dataset
    integer :: extents(1)
    logical :: is_there

    if (archive%is_read) then
      if (allocated(values)) deallocate (values)
      call get_extents(archive, name, extents, is_there, dataset)
      if (.not. is_there) return
      allocate (values(extents(1)))
      call get_values(archive, as_integer, dataset, size(values), c_loc(values))
    else if (allocated(values)) then
      call put_array(archive, name, as_integer, .true., shape(values), c_loc(values))
    else
      call put_null(archive, name, as_integer)
    end if
  end subroutine keep_integers

  !> A table of integers.
  subroutine keep_integer_table(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, allocatable, intent(inout), target :: values(:, :)
    integer(hid_t) :: dataset
    integer :: extents(2)
    logical :: is_there

    if (archive%is_read) then
      if (allocated(values)) deallocate (values)
      call get_extents(archive, name, extents, is_there, dataset)
      if (.not. is_there) return
      allocate (values(extents(1), extents(2)))
      call get_values(archive, as_integer, dataset, size(values), c_loc(values))
    else if (allocated(values)) then
      call put_array(archive, name, as_integer, .true., shape(values), c_loc(values))
    else
      call put_null(archive, name, as_integer)
    end if
  end subroutine keep_integer_table

  !> An array of truths, as 0 and 1.
  subroutine keep_logicals(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    logical, allocatable, intent(inout) :: values(:)
    integer, allocatable :: numbers(:)

    if (allocated(values)) numbers = merge(1, 0, values)
    call keep_integers(archive, name, numbers)
    if (.not. archive%is_read) return
    if (allocated(values)) deallocate (values)
    if (allocated(numbers)) values = numbers == 1
  end subroutine keep_logicals

  !> An array of fixed size.
  subroutine keep_fixed(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    real(wp), intent(inout) :: values(:)
    real(wp), allocatable :: copy(:)

    copy = values
    call keep_reals(archive, name, copy)
    if (.not. archive%is_read .or. allocated(archive%error)) return
    if (allocated(copy)) then
      if (size(copy) == size(values)) values = copy
    end if
  end subroutine keep_fixed

  !> A real.
  subroutine keep_real(archive, name, value)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    real(wp), intent(inout) :: value
    real(wp) :: values(1)

    values = value
    call keep_fixed(archive, name, values)
    value = values(1)
  end subroutine keep_real

  !> An integer.
  subroutine keep_integer(archive, name, value)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, intent(inout) :: value
    integer, allocatable :: values(:)

    values = [value]
    call keep_integers(archive, name, values)
    if (allocated(archive%error) .or. .not. allocated(values)) return
    if (size(values) == 1) value = values(1)
  end subroutine keep_integer

  !> A long integer.
  subroutine keep_long(archive, name, value)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer(long), intent(inout) :: value
    integer(long), target :: copy
    integer(hid_t) :: dataset
    integer :: extents(1)
    logical :: is_there

    copy = value
    if (archive%is_read) then
      call get_extents(archive, name, extents, is_there, dataset)
      call get_values(archive, as_index, dataset, extents(1), c_loc(copy))
      value = copy
    else
      call put_array(archive, name, as_index, .true., [1], c_loc(copy))
    end if
  end subroutine keep_long

  !> A truth.
  subroutine keep_logical(archive, name, value)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    logical, intent(inout) :: value
    integer :: number

    number = merge(1, 0, value)
    call keep_integer(archive, name, number)
    value = number == 1
  end subroutine keep_logical

  !> A text; one that is not allocated comes back empty.
  subroutine keep_text(archive, name, text)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    character(:), allocatable, intent(inout) :: text

    if (allocated(archive%error)) return
    if (archive%is_read) then
      call read_text(archive%id, archive%folder//name, text)
    else if (allocated(text)) then
      call write_text(archive%id, archive%folder//name, text, archive%error)
    end if
  end subroutine keep_text

end module archive_m
