! SPDX-License-Identifier: MIT
!> Components of an archive: `keep` puts one into an archive that is written and takes it from one
!> that is read, so that no list of components exists twice.
!>
!> A component that is read must have the shape that the variable has before, and must be missing
!> where that is not allocated: the reader starts from a state of the same model. Reals must be
!> finite. After a failure nothing is read any more, and variables stay as they are.
module archive_m
  use, intrinsic :: iso_c_binding, only : c_loc, c_ptr, c_null_ptr
  use hdf5, only : hid_t
  use archive_file_m, only : archive_t, refuse, fail_archive, is_hard, put_array, open_array, &
    get_values, close_array
  use errors_m, only : status_input
  use hdf5_library_m, only : read_text
  use hdf5_writing_m, only : as_real, as_integer, as_index, write_text
  use kinds_m, only : wp, long
  use log_m, only : to_text
  implicit none
  private
  public :: keep, keep_fixed, keep_same, keep_growing, keep_text, expect

  !> Write a component into the archive, or read it.
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

  !> The same for integers that follow from the model: those of the file must be the same.
  interface keep_same
    module procedure keep_same_integer
    module procedure keep_same_integers
    module procedure keep_same_table
    module procedure keep_same_logical
  end interface keep_same

  !> The same for arrays whose last extent comes from the file.
  interface keep_growing
    module procedure keep_growing_reals
    module procedure keep_growing_table
    module procedure keep_growing_integers
  end interface keep_growing

  !> Extent of what is not allocated.
  integer, parameter :: absent = -1
  character(*), parameter :: not_finite = 'values that are no finite numbers'
  character(*), parameter :: other_numbers = 'other numbers than follow from the deck'

contains

  !> An array of reals.
  subroutine keep_reals(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    real(wp), allocatable, intent(inout), target :: values(:)

    if (allocated(values)) then
      call exchange(archive, name, as_real, shape(values), c_loc(values))
      if (archive%is_read) call expect(archive, name, all(is_finite(values)), not_finite)
    else
      call exchange(archive, name, as_real, [absent], c_null_ptr)
    end if
  end subroutine keep_reals

  !> A table of reals.
  subroutine keep_real_table(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    real(wp), allocatable, intent(inout), target :: values(:, :)

    if (allocated(values)) then
      call exchange(archive, name, as_real, shape(values), c_loc(values))
      if (archive%is_read) call expect(archive, name, all(is_finite(values)), not_finite)
    else
      call exchange(archive, name, as_real, [absent, absent], c_null_ptr)
    end if
  end subroutine keep_real_table

  !> An array of integers.
  subroutine keep_integers(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, allocatable, intent(inout), target :: values(:)

    if (allocated(values)) then
      call exchange(archive, name, as_integer, shape(values), c_loc(values))
    else
      call exchange(archive, name, as_integer, [absent], c_null_ptr)
    end if
  end subroutine keep_integers

  !> A table of integers.
  subroutine keep_integer_table(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, allocatable, intent(inout), target :: values(:, :)

    if (allocated(values)) then
      call exchange(archive, name, as_integer, shape(values), c_loc(values))
    else
      call exchange(archive, name, as_integer, [absent, absent], c_null_ptr)
    end if
  end subroutine keep_integer_table

  !> Write an array of given extents, or read it; `absent` where it is not allocated.
  subroutine exchange(archive, name, content, expected, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, intent(in) :: content     !! one of the `as_` constants
    integer, intent(in) :: expected(:) !! extents
    type(c_ptr), intent(in) :: values  !! the first one
    integer(hid_t) :: dataset
    integer :: extents(size(expected))

    if (archive%is_read) then
      call open_array(archive, name, content, expected, .false., extents, dataset)
      if (dataset >= 0) call get_values(archive, content, dataset, extents, values)
    else
      call put_array(archive, name, content, expected(1) /= absent, expected, values)
    end if
  end subroutine exchange

  !> An array of reals of any length.
  subroutine keep_growing_reals(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    real(wp), allocatable, intent(inout), target :: values(:)
    integer :: extents(1)

    if (archive%is_read) then
      extents = absent
      if (allocated(values)) extents = shape(values)
      call find_extents(archive, name, as_real, extents)
      if (allocated(archive%error)) return
      if (allocated(values)) deallocate (values)
      if (extents(1) /= absent) allocate (values(extents(1)))
    end if
    call keep_reals(archive, name, values)
  end subroutine keep_growing_reals

  !> A table of reals with any number of columns.
  subroutine keep_growing_table(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    real(wp), allocatable, intent(inout), target :: values(:, :)
    integer :: extents(2)

    if (archive%is_read) then
      extents = absent
      if (allocated(values)) extents = shape(values)
      call find_extents(archive, name, as_real, extents)
      if (allocated(archive%error)) return
      if (allocated(values)) deallocate (values)
      if (extents(1) /= absent) allocate (values(extents(1), extents(2)))
    end if
    call keep_real_table(archive, name, values)
  end subroutine keep_growing_table

  !> A table of integers with any number of columns.
  subroutine keep_growing_integers(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, allocatable, intent(inout), target :: values(:, :)
    integer :: extents(2)

    if (archive%is_read) then
      extents = absent
      if (allocated(values)) extents = shape(values)
      call find_extents(archive, name, as_integer, extents)
      if (allocated(archive%error)) return
      if (allocated(values)) deallocate (values)
      if (extents(1) /= absent) allocate (values(extents(1), extents(2)))
    end if
    call keep_integer_table(archive, name, values)
  end subroutine keep_growing_integers

  !> Extents of an array in the file, the last of which may be any; `absent` where there is none.
  subroutine find_extents(archive, name, content, extents)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, intent(in) :: content       !! one of the `as_` constants
    integer, intent(inout) :: extents(:) !! what the component has, then what was found
    integer(hid_t) :: dataset
    integer :: expected(size(extents))

    expected = extents
    call open_array(archive, name, content, expected, .true., extents, dataset)
    if (dataset < 0) then
      extents = absent
    else
      call close_array(dataset)
    end if
  end subroutine find_extents

  !> An array of truths, as 0 and 1.
  subroutine keep_logicals(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    logical, allocatable, intent(inout) :: values(:)
    integer, allocatable :: numbers(:)

    if (allocated(values)) allocate (numbers, source=merge(1, 0, values))
    call keep_integers(archive, name, numbers)
    if (.not. archive%is_read .or. allocated(archive%error) .or. .not. allocated(values)) return
    call expect(archive, name, all(numbers == 0 .or. numbers == 1), 'truths other than 0 and 1')
    values = numbers == 1
  end subroutine keep_logicals

  !> An array of fixed size.
  subroutine keep_fixed(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    real(wp), intent(inout) :: values(:)
    real(wp), allocatable :: copy(:)

    copy = values
    call keep_reals(archive, name, copy)
    if (archive%is_read .and. .not. allocated(archive%error)) values = copy
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
    if (.not. allocated(archive%error)) value = values(1)
  end subroutine keep_integer

  !> A long integer.
  subroutine keep_long(archive, name, value)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer(long), intent(inout) :: value
    integer(long), target :: copy

    copy = value
    call exchange(archive, name, as_index, [1], c_loc(copy))
    if (.not. allocated(archive%error)) value = copy
  end subroutine keep_long

  !> A truth.
  subroutine keep_logical(archive, name, value)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    logical, intent(inout) :: value
    integer :: number

    number = merge(1, 0, value)
    call keep_integer(archive, name, number)
    call expect(archive, name, number == 0 .or. number == 1, 'a truth other than 0 and 1')
    if (.not. allocated(archive%error)) value = number == 1
  end subroutine keep_logical

  !> An integer that follows from the model.
  subroutine keep_same_integer(archive, name, value)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, intent(in) :: value
    integer :: found

    found = value
    call keep_integer(archive, name, found)
    call expect(archive, name, found == value, 'the number '//to_text(found)//', and '&
      //to_text(value)//' is expected here')
  end subroutine keep_same_integer

  !> A truth that follows from the model.
  subroutine keep_same_logical(archive, name, value)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    logical, intent(in) :: value

    call keep_same_integer(archive, name, merge(1, 0, value))
  end subroutine keep_same_logical

  !> An array of integers that follow from the model.
  subroutine keep_same_integers(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, allocatable, intent(in) :: values(:)
    integer, allocatable :: found(:)

    if (allocated(values)) allocate (found, source=values)
    call keep_integers(archive, name, found)
    if (allocated(archive%error) .or. .not. allocated(values)) return
    call expect(archive, name, all(found == values), other_numbers)
  end subroutine keep_same_integers

  !> A table of integers that follow from the model.
  subroutine keep_same_table(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, allocatable, intent(in) :: values(:, :)
    integer, allocatable :: found(:, :)

    if (allocated(values)) allocate (found, source=values)
    call keep_integer_table(archive, name, found)
    if (allocated(archive%error) .or. .not. allocated(values)) return
    call expect(archive, name, all(found == values), other_numbers)
  end subroutine keep_same_table

  !> A text; one that is not allocated comes back empty.
  subroutine keep_text(archive, name, text)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    character(:), allocatable, intent(inout) :: text
    logical :: is_good

    if (allocated(archive%error)) return
    if (archive%is_read) then
      is_good = is_hard(archive, name)
      if (is_good) call read_text(archive%id, archive%folder//name, text, is_good)
      if (.not. is_good) call fail_archive(archive, 'the restart file '//archive%path &
        //' is refused: its '//archive%folder//name//' is missing or no text', status_input)
    else if (allocated(text)) then
      call write_text(archive%id, archive%folder//name, text, archive%error)
    end if
  end subroutine keep_text

  !> Refuse the file that is read unless a component of it is sound.
  subroutine expect(archive, name, is_sound, what)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    logical, intent(in) :: is_sound
    character(*), intent(in) :: what !! it has where it is not

    if (archive%is_read .and. .not. is_sound) call refuse(archive, name, what)
  end subroutine expect

  !> Whether a real is a finite number, by its bits: a comparison could trap.
  elemental function is_finite(value)
    real(wp), intent(in) :: value
    logical :: is_finite
    integer(long), parameter :: exponent_bits = 2047

    is_finite = ibits(transfer(value, 0_long), 52, 11) /= exponent_bits
  end function is_finite

end module archive_m
