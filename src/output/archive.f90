! SPDX-License-Identifier: MIT
!> Visitor that writes components into an HDF5 file of named arrays in folders, or reads them.
!> Arrays that are not allocated are distinguished from missing ones.
!>
!> A component that is read must have the shape that the variable has before, and must be absent
!> where that is not allocated: the reader starts from a state of the same model. The first failure
!> stays and ends the work; later variables stay unchanged.
module archive_m
  use, intrinsic :: iso_c_binding, only : c_char, c_int, c_null_char, c_null_ptr, c_ptr
  use hdf5, only : hid_t, hsize_t, size_t, H5S_NULL_F, H5S_SIMPLE_F, &
    H5D_CHUNKED_F, H5D_COMPACT_F, H5D_CONTIGUOUS_F, h5dclose_f, &
    h5dget_create_plist_f, h5dget_space_f, h5dget_storage_size_f, h5dget_type_f, h5dopen_f, &
    h5dread_f, h5lexists_f, h5pclose_f, h5pget_external_count_f, h5pget_layout_f, &
    h5sclose_f, h5screate_f, h5screate_simple_f, h5sget_simple_extent_dims_f, &
    h5sget_simple_extent_ndims_f, h5sget_simple_extent_type_f, h5tclose_f, h5tequal_f
  use errors_m, only : status_input
  use packed_buffer_m, only : memory_release_t
  use hdf5_writing_m, only : read_text, memory_type, file_type, make_group, &
    write_dataset, write_text
  use kinds_m, only : wp
  use log_m, only : to_text
  use visitor_m, only : visitor_t, item_t, absent, any_length, as_integer, whole, &
    new_chunks
  implicit none
  private
  public :: archive_t, is_hard, own_layout

  !> Largest number of dimensions in HDF5.
  integer, parameter :: most_dims = 32

  !> The `as_` constants in words.
  character(13), parameter :: content_names(3) = [character(13) :: 'reals', 'integers', &
    'long integers']

  !> An open archive.
  type, extends(visitor_t) :: archive_t
    integer(hid_t) :: id = -1              !! open file
    logical :: is_read = .false.           !! read, else write
    type(memory_release_t), allocatable :: releases(:) !! release the memory of other processes
  contains
    procedure :: find => find_extents
    procedure :: pass => exchange
    procedure :: enter => enter_folder
    procedure :: text
  end type archive_t

  !> Property list H5P_DEFAULT of C.
  integer(hid_t), parameter :: default_list = 0

  interface
    !> What a soft or external link points to; < 0 for a hard link, which has no value. The Fortran
    !> interface to the kind of a link (h5lget_info_f) differs between HDF5 1.10 and 1.12.
    function c_get_link_value(id, name, text, size, list) bind(c, name='H5Lget_val') result(status)
      import :: c_char, c_int, hid_t, size_t
      integer(hid_t), value :: id, list
      character(kind=c_char), intent(in) :: name(*) !! ends with a null
      character(kind=c_char), intent(out) :: text   !! the first `size` characters
      integer(size_t), value :: size
      integer(c_int) :: status
    end function c_get_link_value
  end interface

contains

  !> Enter a folder of the archive.
  subroutine enter_folder(visitor, name)
    class(archive_t), intent(inout) :: visitor
    character(*), intent(in) :: name

    if (.not. visitor%is_read) then
      call make_group(visitor%id, visitor%folder//name, visitor%error)
    else if (.not. allocated(visitor%error)) then
      if (.not. is_hard(visitor, name)) call visitor%fail('the restart file ' &
        //visitor%path//' lacks '//visitor%folder//name, status_input)
    end if
    visitor%folder = visitor%folder//name//'/'
  end subroutine enter_folder

  !> Extents of an array in the file whose last extent may vary; `absent` where there is none.
  subroutine find_extents(visitor, item)
    class(archive_t), intent(inout) :: visitor
    type(item_t), intent(inout) :: item
    integer(hid_t) :: dataset
    integer :: extents(item%rank), ignored

    if (.not. visitor%is_read .or. item%of /= any_length) return
    call open_array(visitor, item, extents, dataset)
    if (allocated(visitor%error)) return
    item%is_new = .true.
    item%extents(:item%rank) = extents
    if (dataset < 0) item%extents = absent
    if (dataset >= 0) call h5dclose_f(dataset, ignored)
  end subroutine find_extents

  !> Write or read an array. Memory of other processes is released before the next one.
  subroutine exchange(visitor, item, address, starts)
    class(archive_t), intent(inout) :: visitor
    type(item_t), intent(in) :: item
    type(c_ptr), intent(in) :: address
    integer, intent(in), optional :: starts(:)
    integer :: k

    if (item%of == new_chunks .or. allocated(visitor%error)) return
    if (.not. visitor%is_read) then
      call put_array(visitor, item, address)
      return
    end if
    call get_array(visitor, item, address)
    if (.not. allocated(visitor%releases) .or. item%extents(1) == absent) return
    do k = 1, size(visitor%releases)
      call visitor%releases(k)%pass(item, address, starts)
    end do
  end subroutine exchange

  !> Write or read a text; one that is not allocated is read as empty.
  subroutine text(archive, name, value)
    class(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    character(:), allocatable, intent(inout) :: value
    logical :: is_good

    if (allocated(archive%error)) return
    if (archive%is_read) then
      is_good = is_hard(archive, name)
      if (is_good) call read_text(archive%id, archive%folder//name, value, is_good)
      if (.not. is_good) call archive%fail('the restart file '//archive%path &
        //' is refused: its '//archive%folder//name//' is missing or no text', status_input)
    else if (allocated(value)) then
      call write_text(archive%id, archive%folder//name, value, archive%error)
    end if
  end subroutine text

  !> Write an array; a null dataspace where it is not allocated.
  subroutine put_array(archive, item, values)
    class(archive_t), intent(inout) :: archive
    type(item_t), intent(in) :: item
    type(c_ptr), intent(in) :: values      !! the first value
    type(c_ptr) :: first
    integer(hid_t) :: space
    integer :: status

    first = values
    if (any(item%extents(:item%rank) <= 0)) first = c_null_ptr
    if (item%extents(1) /= absent) then
      call h5screate_simple_f(item%rank, int(item%extents, hsize_t), space, status)
    else
      call h5screate_f(H5S_NULL_F, space, status)
    end if
    call write_dataset(archive%id, archive%folder//trim(item%name), [memory_type(item%content), &
      file_type(item%content)], space, first, archive%error)
  end subroutine put_array

  !> Read an array of known extents. HDF5 gets the memory shape and refuses a dataset of another
  !> shape.
  subroutine get_array(archive, item, values)
    class(archive_t), intent(inout) :: archive
    type(item_t), intent(in) :: item
    type(c_ptr), intent(in) :: values      !! the first value
    type(item_t) :: same
    type(c_ptr) :: first
    integer(hid_t) :: memory, dataset
    integer :: extents(item%rank), status(2), ignored

    same = item
    if (item%of == any_length) same%of = whole
    call open_array(archive, same, extents, dataset)
    if (dataset < 0) return
    first = values
    status = 0
    if (minval(extents) > 0) then
      call h5screate_simple_f(size(extents), int(extents, hsize_t), memory, status(1))
      call h5dread_f(dataset, memory_type(item%content), first, status(2), memory)
      call h5sclose_f(memory, ignored)
    end if
    call h5dclose_f(dataset, ignored)
    if (minval(status) < 0) call archive%fail('cannot read the restart file '//archive%path, &
      status_input)
  end subroutine get_array

  !> Open an array of the file and check type, shape and presence. Deviations are refused by name;
  !> links to other files are not followed, since a file from elsewhere may contain anything.
  subroutine open_array(archive, item, extents, dataset)
    class(archive_t), intent(inout) :: archive
    type(item_t), intent(in) :: item       !! with the expected extents; absent: no array, or any
                                           !! extent where it may vary
    integer, intent(out) :: extents(:)     !! found
    integer(hid_t), intent(out) :: dataset !! open; -1: nothing to read
    character(:), allocatable :: name
    integer(hsize_t) :: dims(most_dims)
    integer :: expected(size(extents)), rank, i
    logical :: fits, may_differ(size(extents)), may_lack

    extents = 0
    dataset = -1
    if (allocated(archive%error)) return
    name = trim(item%name)
    if (is_hard(archive, name)) call h5dopen_f(archive%id, archive%folder//name, dataset, i)
    if (dataset < 0) then
      call archive%fail('the restart file '//archive%path//' lacks '//archive%folder//name &
        //': it was written by another version of the program or edited', status_input)
      return
    end if
    call look_at(dataset, item%content, rank, dims)
    ! The last extent of a variable array may differ, and the array may be absent.
    expected = item%extents(:item%rank)
    may_lack = item%of == any_length .or. any(expected < 0)
    may_differ = item%of == any_length .and. (expected < 0 .or. &
      [(i == item%rank, i=1, item%rank)])
    fits = rank == item%rank
    if (fits) fits = all(dims(:rank) <= huge(1) .and. (may_differ .or. dims(:rank) == expected))
    if (fits) then
      extents = int(dims(:rank))
      return
    end if
    if (rank /= 0 .or. .not. may_lack) call archive%expect(name, .false., &
      'not what is expected here: '//expected_text())
    call h5dclose_f(dataset, i)
    dataset = -1

  contains

    !> The expected array in words.
    pure function expected_text() result(text)
      character(:), allocatable :: text

      text = 'nothing'
      if (any(expected < 0 .and. .not. may_differ)) return
      text = trim(content_names(item%content))
      if (item%rank == 2) text = text//' in columns of '//to_text(expected(1))
      if (item%of /= any_length) text = text//', '//to_text(product(expected))//' in all'
      text = text//', stored in the file'
    end function expected_text

  end subroutine open_array

  !> Whether a name in the current folder exists and is a hard link.
  function is_hard(archive, name)
    class(archive_t), intent(in) :: archive
    character(*), intent(in) :: name
    logical :: is_hard
    integer :: status
    character(kind=c_char) :: first

    call h5lexists_f(archive%id, archive%folder//name, is_hard, status)
    is_hard = is_hard .and. status >= 0
    if (is_hard) is_hard = c_get_link_value(archive%id, archive%folder//name//c_null_char, first, &
      1_size_t, default_list) < 0
  end function is_hard

  !> Layout of an open dataset stored in the file itself; -1: external storage or a virtual dataset.
  function own_layout(dataset) result(layout)
    integer(hid_t), intent(in) :: dataset
    integer :: layout
    integer(hid_t) :: creation
    integer :: status(3), n_outside, ignored

    call h5dget_create_plist_f(dataset, creation, status(1))
    call h5pget_layout_f(creation, layout, status(2))
    call h5pget_external_count_f(creation, n_outside, status(3))
    if (minval(status) < 0 .or. n_outside /= 0 .or. &
      all(layout /= [H5D_COMPACT_F, H5D_CONTIGUOUS_F, H5D_CHUNKED_F])) layout = -1
    call h5pclose_f(creation, ignored)
  end function own_layout

  !> Rank and extents of an open dataset of the expected number type, stored in the file; rank 0:
  !> empty, -1: anything else.
  subroutine look_at(dataset, content, rank, dims)
    integer(hid_t), intent(in) :: dataset
    integer, intent(in) :: content         !! one of the `as_` constants
    integer, intent(out) :: rank
    integer(hsize_t), intent(out) :: dims(most_dims)
    integer(hid_t) :: space, type_id
    integer(hsize_t) :: most(most_dims), stored
    integer :: status(4), kind_of_space, i
    logical :: is_alike

    rank = -1
    dims = 0
    kind_of_space = -1
    call h5dget_type_f(dataset, type_id, status(1))
    call h5tequal_f(type_id, file_type(content), is_alike, status(2))
    call h5dget_space_f(dataset, space, status(3))
    call h5sget_simple_extent_type_f(space, kind_of_space, status(4))
    if (minval(status) >= 0 .and. is_alike) then
      if (kind_of_space == H5S_NULL_F .and. own_layout(dataset) >= 0) rank = 0
      if (kind_of_space == H5S_SIMPLE_F .and. own_layout(dataset) == H5D_CONTIGUOUS_F) then
        call h5sget_simple_extent_ndims_f(space, rank, i)
        call h5sget_simple_extent_dims_f(space, dims(:rank), most(:rank), i)
        call h5dget_storage_size_f(dataset, stored, i)
        if (i < 0) stored = 0 ! an empty array: some releases of HDF5 call that a failure
        if (rank == 0 .or. real(stored, wp) < merge(4.0_wp, 8.0_wp, content == as_integer) &
          *product(real(dims(:rank), wp))) rank = -1
      end if
    end if
    call h5tclose_f(type_id, i)
    call h5sclose_f(space, i)
  end subroutine look_at

end module archive_m
