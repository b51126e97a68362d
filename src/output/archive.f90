! SPDX-License-Identifier: MIT
!> A visitor that writes components into an HDF5 file of named arrays in folders, or reads them.
!> Arrays that are not allocated are told apart from missing ones.
!>
!> A component that is read must have the shape that the variable has before, and must be missing
!> where that is not allocated: the reader starts from a state of the same model. The first failure
!> stays and ends the work; variables that would follow stay as they are.
module archive_m
  use, intrinsic :: iso_c_binding, only : c_ptr
  use hdf5, only : hid_t, hsize_t, haddr_t, size_t, H5S_NULL_F, H5S_SIMPLE_F, &
    H5D_CHUNKED_F, H5D_COMPACT_F, H5D_CONTIGUOUS_F, H5L_TYPE_HARD_F, h5dclose_f, h5dcreate_f, &
    h5dget_create_plist_f, h5dget_space_f, h5dget_storage_size_f, h5dget_type_f, h5dopen_f, &
    h5dread_f, h5dwrite_f, h5lexists_f, h5lget_info_f, h5pclose_f, h5pget_external_count_f, &
    h5pget_layout_f, h5sclose_f, h5screate_f, h5screate_simple_f, h5sget_simple_extent_dims_f, &
    h5sget_simple_extent_ndims_f, h5sget_simple_extent_type_f, h5tclose_f, h5tequal_f
  use errors_m, only : status_files, status_input
  use packed_buffer_m, only : forgetter_t
  use hdf5_writing_m, only : read_text, memory_type, file_type, make_group, write_text
  use kinds_m, only : wp
  use log_m, only : to_text
  use visitor_m, only : visitor_t, item_t, absent, any_length, as_integer, whole, &
    new_chunks
  implicit none
  private
  public :: archive_t, is_hard, is_stored_within

  !> Most dimensions that an array has in HDF5.
  integer, parameter :: most_dims = 32

  !> What the `as_` constants stand for, for messages.
  character(13), parameter :: content_names(3) = [character(13) :: 'reals', 'integers', &
    'long integers']

  !> What a dataset turns out to be.
  type :: found_t
    logical :: is_there = .false.          !! it is an array, if perhaps an empty one
    logical :: is_readable = .false.
    integer :: rank = 0
    integer(hsize_t) :: dims(most_dims) = 0
    character(:), allocatable :: text      !! in words
  end type found_t

  !> An open archive.
  type, extends(visitor_t) :: archive_t
    integer(hid_t) :: id = -1              !! open file
    logical :: is_read = .false.           !! read, else written
    type(forgetter_t), allocatable :: forgetters(:) !! of what other processes have
  contains
    procedure :: find => find_extents
    procedure :: pass => exchange
    procedure :: enter => enter_folder
    procedure :: text
  end type archive_t

contains

  !> Go into a folder of the archive.
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

  !> Extents of an array in the file, the last of which may be any; `absent` where there is none.
  subroutine find_extents(visitor, item)
    class(archive_t), intent(inout) :: visitor
    type(item_t), intent(inout) :: item
    integer(hid_t) :: dataset
    integer :: extents(item%rank)

    if (.not. visitor%is_read .or. item%of /= any_length) return
    call open_array(visitor, item, extents, dataset)
    if (allocated(visitor%error)) return
    item%is_new = .true.
    item%extents(:item%rank) = extents
    if (dataset < 0) then
      item%extents = absent
    else
      call close_array(dataset)
    end if
  end subroutine find_extents

  !> Write an array, or read it; what belongs to others is given up before the next one.
  subroutine exchange(visitor, item, place, starts)
    class(archive_t), intent(inout) :: visitor
    type(item_t), intent(in) :: item
    type(c_ptr), intent(in) :: place
    integer, intent(in), optional :: starts(:)
    type(item_t) :: same
    integer(hid_t) :: dataset
    integer :: extents(item%rank), k

    if (item%of == new_chunks) return
    if (.not. visitor%is_read) then
      call put_array(visitor, item, place)
      return
    end if
    same = item
    if (item%of == any_length) same%of = whole
    call open_array(visitor, same, extents, dataset)
    if (dataset >= 0) call get_values(visitor, item%content, dataset, extents, place)
    if (.not. allocated(visitor%forgetters) .or. item%extents(1) == absent) return
    do k = 1, size(visitor%forgetters)
      call visitor%forgetters(k)%pass(item, place, starts)
    end do
  end subroutine exchange

  !> A text; one that is not allocated comes back empty.
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

  !> Write an array; null when there is none.
  subroutine put_array(archive, item, values)
    class(archive_t), intent(inout) :: archive
    type(item_t), intent(in) :: item
    type(c_ptr), intent(in) :: values      !! the first value
    integer(hid_t) :: space, dataset
    integer :: status(4)

    if (allocated(archive%error)) return
    status = 0
    if (item%extents(1) /= absent) then
      call h5screate_simple_f(item%rank, int(item%extents, hsize_t), space, status(1))
    else
      call h5screate_f(H5S_NULL_F, space, status(1))
    end if
    call h5dcreate_f(archive%id, archive%folder//trim(item%name), file_type(item%content), space, &
      dataset, status(2))
    if (status(2) >= 0) then
      if (product(item%extents(:item%rank)) > 0 .and. item%extents(1) > 0) &
        call h5dwrite_f(dataset, memory_type(item%content), values, status(3))
      call h5dclose_f(dataset, status(4))
    end if
    if (minval(status) < 0) call archive%fail('cannot write '//archive%path &
      //' (is the disk full, or a quota used up?)', status_files)
    call h5sclose_f(space, status(1))
  end subroutine put_array

  !> Open an array of the file and compare it with what is expected: kind of numbers, shape, and
  !> whether there is one. What differs is refused by name. The dataset stays open for `get_values`,
  !> but where there is nothing to read. A file that comes from elsewhere may hold anything: nothing
  !> of it is believed.
  subroutine open_array(archive, item, extents, dataset)
    class(archive_t), intent(inout) :: archive
    type(item_t), intent(in) :: item       !! with the extents that are expected; absent: no array,
                                           !! or where it grows any extent
    integer, intent(out) :: extents(:)     !! that were found
    integer(hid_t), intent(out) :: dataset !! -1: nothing to read
    type(found_t) :: found
    integer :: expected(size(extents))
    logical :: fits, grows

    extents = 0
    dataset = -1
    if (allocated(archive%error)) return
    call open_hard(archive, trim(item%name), dataset)
    if (allocated(archive%error)) return
    call look_at(dataset, item%content, found)
    ! The last extent may be another, and there may be none.
    grows = item%of == any_length
    expected = item%extents(:item%rank)
    fits = found%is_readable
    if (found%is_there) then
      fits = fits .and. found%rank == size(extents)
      if (fits) fits = all(found%dims(:found%rank) <= huge(1)) &
        .and. (grows .or. all(found%dims(:found%rank) == expected))
      if (fits .and. grows) fits = all(found%dims(:found%rank - 1) == expected(:found%rank - 1) &
        .or. expected(:found%rank - 1) < 0)
    else
      fits = fits .and. (grows .or. any(expected < 0))
    end if
    if (fits .and. found%is_there) then
      extents = int(found%dims(:found%rank))
      return
    end if
    if (.not. fits) call archive%expect(trim(item%name), .false., found%text//', and ' &
      //expected_text()//' is expected here')
    call close_array(dataset)

  contains

    !> What is expected, in words.
    pure function expected_text() result(text)
      character(:), allocatable :: text

      text = 'nothing'
      if (any(expected(:size(expected) - merge(1, 0, grows)) < 0)) return
      text = content_names(item%content)
      if (size(expected) == 2) text = text//' in columns of '//to_text(expected(1))
      if (.not. grows) text = text//', '//to_text(product(expected))//' in all'
    end function expected_text

  end subroutine open_array

  !> Open a dataset under its own name; links to other places or files are not followed.
  subroutine open_hard(archive, name, dataset)
    class(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer(hid_t), intent(out) :: dataset !! -1 after a failure
    integer :: status

    dataset = -1
    if (is_hard(archive, name)) call h5dopen_f(archive%id, archive%folder//name, dataset, status)
    if (dataset >= 0) return
    dataset = -1
    call archive%fail('the restart file '//archive%path//' lacks '//archive%folder &
      //name//': it was written by another version of the program, or by hand', status_input)
  end subroutine open_hard

  !> Whether there is a name in the present folder that is no link to elsewhere.
  function is_hard(archive, name)
    class(archive_t), intent(in) :: archive
    character(*), intent(in) :: name
    logical :: is_hard
    integer :: status, kind_of_link, encoding, token
    integer(haddr_t) :: address
    integer(size_t) :: length
    logical :: has_order

    call h5lexists_f(archive%id, archive%folder//name, is_hard, status)
    is_hard = is_hard .and. status >= 0
    if (.not. is_hard) return
    call h5lget_info_f(archive%id, archive%folder//name, encoding, token, has_order, &
      kind_of_link, address, length, status)
    is_hard = status >= 0 .and. kind_of_link == H5L_TYPE_HARD_F
  end function is_hard

  !> Whether the values of an open dataset lie in the file itself: no outer storage, and no virtual
  !> dataset, which has those of others.
  function is_stored_within(dataset)
    integer(hid_t), intent(in) :: dataset
    logical :: is_stored_within
    integer(hid_t) :: creation
    integer :: status(3), layout, n_outside, ignored

    call h5dget_create_plist_f(dataset, creation, status(1))
    call h5pget_layout_f(creation, layout, status(2))
    call h5pget_external_count_f(creation, n_outside, status(3))
    is_stored_within = minval(status) >= 0 .and. n_outside == 0 .and. &
      any(layout == [H5D_COMPACT_F, H5D_CONTIGUOUS_F, H5D_CHUNKED_F])
    call h5pclose_f(creation, ignored)
  end function is_stored_within

  !> What an open dataset is: readable when it holds numbers of this kind as this program writes
  !> them, all of them within the file.
  subroutine look_at(dataset, content, found)
    integer(hid_t), intent(in) :: dataset
    integer, intent(in) :: content         !! one of the `as_` constants
    type(found_t), intent(out) :: found
    integer(hid_t) :: space, type_id, creation
    integer(hsize_t) :: most(most_dims), stored
    integer :: status(8), kind_of_space, layout, n_outside, i
    logical :: is_alike

    status = 0
    is_alike = .false.
    call h5dget_type_f(dataset, type_id, status(1))
    if (status(1) >= 0) call h5tequal_f(type_id, file_type(content), is_alike, status(2))
    call h5dget_create_plist_f(dataset, creation, status(3))
    layout = -1
    n_outside = 1
    if (status(3) >= 0) call h5pget_layout_f(creation, layout, status(4))
    if (status(3) >= 0) call h5pget_external_count_f(creation, n_outside, status(5))
    call h5dget_space_f(dataset, space, status(6))
    kind_of_space = -1
    if (status(6) >= 0) call h5sget_simple_extent_type_f(space, kind_of_space, status(7))
    found%is_there = kind_of_space /= H5S_NULL_F
    if (kind_of_space == H5S_SIMPLE_F) &
      call h5sget_simple_extent_ndims_f(space, found%rank, status(8))
    if (found%rank > 0 .and. minval(status) >= 0) &
      call h5sget_simple_extent_dims_f(space, found%dims(:found%rank), most(:found%rank), i)
    call h5dget_storage_size_f(dataset, stored, i)
    if (i < 0) stored = 0 ! an empty array: some releases of HDF5 call that a failure
    found%is_readable = minval(status) >= 0 .and. is_alike .and. n_outside == 0 .and. &
      (kind_of_space == H5S_NULL_F .or. kind_of_space == H5S_SIMPLE_F)
    found%text = 'other values than '//trim(content_names(content))
    if (is_alike) found%text = trim(content_names(content))//found_shape(kind_of_space, found)
    if (found%is_readable .and. found%is_there) then
      found%is_readable = layout == H5D_CONTIGUOUS_F .and. real(stored, wp) &
        >= merge(4.0_wp, 8.0_wp, content == as_integer)*product(real(found%dims(:found%rank), wp))
      if (.not. found%is_readable) found%text = found%text//' that are not stored in it as they ' &
        //'should be'
    end if
    if (status(1) >= 0) call h5tclose_f(type_id, i)
    if (status(3) >= 0) call h5pclose_f(creation, i)
    if (status(6) >= 0) call h5sclose_f(space, i)
  end subroutine look_at

  !> A shape in words, behind the name of what has it.
  pure function found_shape(kind_of_space, found) result(text)
    integer, intent(in) :: kind_of_space
    type(found_t), intent(in) :: found
    character(:), allocatable :: text
    character(20) :: digits
    integer :: i

    text = ', none at all'
    if (kind_of_space == H5S_NULL_F) return
    text = ', a single one'
    if (kind_of_space /= H5S_SIMPLE_F) return
    text = ' in a shape of '
    do i = 1, found%rank
      write (digits, '(ss,i0)') found%dims(i)
      text = text//trim(digits)//trim(merge(' x', '  ', i < found%rank))//' '
    end do
    text = trim(text)
  end function found_shape

  !> Close a dataset.
  subroutine close_array(dataset)
    integer(hid_t), intent(inout) :: dataset
    integer :: status

    call h5dclose_f(dataset, status)
    dataset = -1
  end subroutine close_array

  !> Read the values of an open dataset and close it. The memory is described to HDF5, which
  !> refuses a dataset of another shape.
  subroutine get_values(archive, content, dataset, extents, values)
    class(archive_t), intent(inout) :: archive
    integer, intent(in) :: content         !! one of the `as_` constants
    integer(hid_t), intent(inout) :: dataset !! -1: nothing happens
    integer, intent(in) :: extents(:)
    type(c_ptr), intent(in) :: values      !! the first value
    type(c_ptr) :: first
    integer(hid_t) :: memory
    integer :: status, ignored

    if (dataset < 0) return
    first = values
    status = 0
    if (minval(extents) > 0) then
      call h5screate_simple_f(size(extents), int(extents, hsize_t), memory, status)
      if (status >= 0) then
        call h5dread_f(dataset, memory_type(content), first, status, memory)
        call h5sclose_f(memory, ignored)
      end if
    end if
    call close_array(dataset)
    if (status < 0) call archive%fail('cannot read the restart file '//archive%path, &
      status_input)
  end subroutine get_values

end module archive_m
