! SPDX-License-Identifier: MIT
!> An HDF5 file of named arrays in folders, that is written or read. Arrays that are not allocated
!> are told apart from missing ones.
!>
!> The first failure stays in the archive and ends its work: one question at the end is enough.
module archive_file_m
  use, intrinsic :: iso_c_binding, only : c_ptr
  use hdf5, only : hid_t, hsize_t, haddr_t, size_t, H5S_NULL_F, H5S_SIMPLE_F, &
    H5D_CHUNKED_F, H5D_COMPACT_F, H5D_CONTIGUOUS_F, H5L_TYPE_HARD_F, h5dclose_f, h5dcreate_f, &
    h5dget_create_plist_f, h5dget_space_f, h5dget_storage_size_f, h5dget_type_f, h5dopen_f, &
    h5dread_f, h5dwrite_f, h5lexists_f, h5lget_info_f, h5pclose_f, h5pget_external_count_f, &
    h5pget_layout_f, h5sclose_f, h5screate_f, h5screate_simple_f, h5sget_simple_extent_dims_f, &
    h5sget_simple_extent_ndims_f, h5sget_simple_extent_type_f, h5tclose_f, h5tequal_f
  use errors_m, only : error_t, raise, status_files, status_input
  use hdf5_writing_m, only : as_integer, memory_type, file_type, make_group
  use kinds_m, only : wp
  use log_m, only : to_text
  implicit none
  private
  public :: archive_t, enter, leave, fail_archive, refuse, put_array, open_array, &
    get_values, close_array, is_hard, is_stored_within

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
  type :: archive_t
    integer(hid_t) :: id = -1              !! open file
    logical :: is_read = .false.           !! read, else written
    character(:), allocatable :: path      !! for messages
    character(:), allocatable :: folder    !! where the next component goes, ends with / or is empty
    type(error_t), allocatable :: error    !! first failure
  end type archive_t

contains

  !> Go into a folder of the archive.
  subroutine enter(archive, name)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name

    if (.not. archive%is_read) then
      call make_group(archive%id, archive%folder//name, archive%error)
    else if (.not. allocated(archive%error)) then
      if (.not. is_hard(archive, name)) call fail_archive(archive, 'the restart file ' &
        //archive%path//' lacks '//archive%folder//name, status_input)
    end if
    archive%folder = archive%folder//name//'/'
  end subroutine enter

  !> Back to the folder above.
  subroutine leave(archive)
    type(archive_t), intent(inout) :: archive
    integer :: last

    last = len(archive%folder) - 1
    archive%folder = archive%folder(:index(archive%folder(:last), '/', back=.true.))
  end subroutine leave

  !> Note a failure, unless there is one already.
  subroutine fail_archive(archive, message, status)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: message
    integer, intent(in) :: status          !! exit status

    if (.not. allocated(archive%error)) call raise(archive%error, message, status)
  end subroutine fail_archive

  !> Write an array of given extents; null when there is none.
  subroutine put_array(archive, name, content, is_there, extents, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, intent(in) :: content         !! one of the `as_` constants
    logical, intent(in) :: is_there        !! the component is allocated
    integer, intent(in) :: extents(:)
    type(c_ptr), intent(in) :: values      !! the first value
    integer(hid_t) :: space, dataset
    integer :: status(4)

    if (allocated(archive%error)) return
    status = 0
    if (is_there) then
      call h5screate_simple_f(size(extents), int(extents, hsize_t), space, status(1))
    else
      call h5screate_f(H5S_NULL_F, space, status(1))
    end if
    call h5dcreate_f(archive%id, archive%folder//name, file_type(content), space, dataset, &
      status(2))
    if (status(2) >= 0) then
      if (is_there .and. product(extents) > 0) &
        call h5dwrite_f(dataset, memory_type(content), values, status(3))
      call h5dclose_f(dataset, status(4))
    end if
    if (minval(status) < 0) call fail_archive(archive, 'cannot write '//archive%path &
      //' (is the disk full, or a quota used up?)', status_files)
    call h5sclose_f(space, status(1))
  end subroutine put_array

  !> Open an array of the file and compare it with what is expected: kind of numbers, shape, and
  !> whether there is one. What differs is refused by name. The dataset stays open for `get_values`,
  !> but where there is nothing to read. A file that comes from elsewhere may hold anything: nothing
  !> of it is believed.
  subroutine open_array(archive, name, content, expected, grows, extents, dataset)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, intent(in) :: content         !! one of the `as_` constants
    integer, intent(in) :: expected(:)     !! extents; -1: no array is expected, or where it
                                           !! grows any extent
    logical, intent(in) :: grows           !! the last extent may be another, and there may be none
    integer, intent(out) :: extents(:)     !! that were found
    integer(hid_t), intent(out) :: dataset !! -1: nothing to read
    type(found_t) :: found
    logical :: fits

    extents = 0
    dataset = -1
    if (allocated(archive%error)) return
    call open_hard(archive, name, dataset)
    if (allocated(archive%error)) return
    call look_at(dataset, content, found)
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
    if (.not. fits) call refuse(archive, name, found%text//', and '//expected_text() &
      //' is expected here')
    call close_array(dataset)

  contains

    !> What is expected, in words.
    pure function expected_text() result(text)
      character(:), allocatable :: text

      text = 'nothing'
      if (any(expected(:size(expected) - merge(1, 0, grows)) < 0)) return
      text = content_names(content)
      if (size(expected) == 2) text = text//' in columns of '//to_text(expected(1))
      if (.not. grows) text = text//', '//to_text(product(expected))//' in all'
    end function expected_text

  end subroutine open_array

  !> Open a dataset under its own name; links to other places or files are not followed.
  subroutine open_hard(archive, name, dataset)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer(hid_t), intent(out) :: dataset !! -1 after a failure
    integer :: status

    dataset = -1
    if (is_hard(archive, name)) call h5dopen_f(archive%id, archive%folder//name, dataset, status)
    if (dataset >= 0) return
    dataset = -1
    call fail_archive(archive, 'the restart file '//archive%path//' lacks '//archive%folder &
      //name//': it was written by another version of the program, or by hand', status_input)
  end subroutine open_hard

  !> Whether there is a name in the present folder that is no link to elsewhere.
  function is_hard(archive, name)
    type(archive_t), intent(in) :: archive
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
        >= real(bytes_of(content), wp)*product(real(found%dims(:found%rank), wp))
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

  !> Bytes of a number.
  pure function bytes_of(content) result(n)
    integer, intent(in) :: content         !! one of the `as_` constants
    integer :: n

    n = merge(4, 8, content == as_integer)
  end function bytes_of

  !> Refuse the file for one of its components.
  subroutine refuse(archive, name, what)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    character(*), intent(in) :: what       !! is wrong with it

    call fail_archive(archive, 'the restart file '//archive%path//' is refused: its ' &
      //archive%folder//name//' has '//what, status_input)
  end subroutine refuse

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
    type(archive_t), intent(inout) :: archive
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
    if (status < 0) call fail_archive(archive, 'cannot read the restart file '//archive%path, &
      status_input)
  end subroutine get_values

end module archive_file_m
