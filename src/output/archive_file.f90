! SPDX-License-Identifier: MIT
!> An HDF5 file of named arrays in folders, that is written or read. Arrays that are not allocated
!> are told apart from missing ones.
!>
!> The first failure stays in the archive and ends its work: one question at the end is enough.
module archive_file_m
  use, intrinsic :: iso_c_binding, only : c_ptr, c_loc
  use hdf5, only : hid_t, hsize_t, H5S_NULL_F, h5dclose_f, h5dcreate_f, &
    h5dget_space_f, h5dopen_f, h5dread_f, h5dwrite_f, h5lexists_f, h5sclose_f, h5screate_f, &
    h5screate_simple_f, h5sget_simple_extent_dims_f, h5sget_simple_extent_ndims_f, &
    h5sget_simple_extent_type_f
  use errors_m, only : error_t, raise, status_files, status_input
  use hdf5_writing_m, only : memory_type, file_type, make_group
  implicit none
  private
  public :: archive_t, enter, leave, fail_archive, put_array, put_null, get_extents, get_values

  !> Most dimensions of an array.
  integer, parameter :: max_rank = 2

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

    if (.not. archive%is_read) call make_group(archive%id, archive%folder//name, archive%error)
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

  !> A component that is not allocated.
  subroutine put_null(archive, name, content)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, intent(in) :: content         !! one of the `as_` constants
    integer, target :: nothing

    nothing = 0
    call put_array(archive, name, content, .false., [0], c_loc(nothing))
  end subroutine put_null

  !> Extents of an array in the file; `is_there` is false for one that was not allocated. The
  !> dataset stays open for `get_values`, but where there is nothing to read.
  subroutine get_extents(archive, name, extents, is_there, dataset)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    integer, intent(out) :: extents(:)
    logical, intent(out) :: is_there
    integer(hid_t), intent(out) :: dataset !! -1: nothing to read
    integer(hsize_t) :: dims(max_rank), most(max_rank)
    integer(hid_t) :: space
    integer :: status, kind_of_space, rank
    logical :: found

    extents = 0
    is_there = .false.
    dataset = -1
    if (allocated(archive%error)) return
    call h5lexists_f(archive%id, archive%folder//name, found, status)
    if (status >= 0 .and. found) call h5dopen_f(archive%id, archive%folder//name, dataset, status)
    if (status < 0 .or. .not. found .or. dataset < 0) then
      call fail_archive(archive, 'the restart file '//archive%path//' lacks '//archive%folder &
        //name//': it was written by another version of the program', status_input)
      return
    end if
    call h5dget_space_f(dataset, space, status)
    kind_of_space = H5S_NULL_F
    call h5sget_simple_extent_type_f(space, kind_of_space, status)
    is_there = kind_of_space /= H5S_NULL_F
    rank = size(extents)
    if (is_there) call h5sget_simple_extent_ndims_f(space, rank, status)
    if (rank == size(extents)) then
      if (is_there) call h5sget_simple_extent_dims_f(space, dims(:rank), most(:rank), status)
      if (is_there) extents = int(dims(:rank))
    else
      call fail_archive(archive, 'the restart file '//archive%path//' has '//archive%folder &
        //name//' of another shape: it was written by another version of the program', status_input)
    end if
    call h5sclose_f(space, status)
    if (is_there .and. .not. allocated(archive%error)) return
    call h5dclose_f(dataset, status)
    dataset = -1
  end subroutine get_extents

  !> Read the values of an open dataset and close it.
  subroutine get_values(archive, content, dataset, n, values)
    type(archive_t), intent(inout) :: archive
    integer, intent(in) :: content         !! one of the `as_` constants
    integer(hid_t), intent(in) :: dataset  !! -1: nothing happens
    integer, intent(in) :: n               !! how many values
    type(c_ptr), intent(in) :: values      !! the first value
    type(c_ptr) :: first
    integer :: status(2)

    if (dataset < 0) return
    status = 0
    first = values
    if (n > 0) call h5dread_f(dataset, memory_type(content), first, status(1))
    call h5dclose_f(dataset, status(2))
    if (minval(status) < 0) call fail_archive(archive, 'cannot read the restart file ' &
      //archive%path, status_input)
  end subroutine get_values

end module archive_file_m
