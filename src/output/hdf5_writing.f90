! SPDX-License-Identifier: MIT
!> HDF5 helpers for restart files and the results file, and the set-up of the library.
!>
!> `error` is passed along: a procedure that receives an error does nothing, so that a sequence of
!> calls needs one test at its end.
module hdf5_writing_m
  use, intrinsic :: iso_c_binding, only : c_ptr, c_loc, c_associated, c_char, c_int, c_null_char, &
    c_size_t
  use hdf5, only : haddr_t, hid_t, hsize_t, size_t, H5_INTEGER_KIND, H5P_DATASET_CREATE_F, &
    H5S_SCALAR_F, H5S_SELECT_SET_F, H5S_UNLIMITED_F, H5D_FILL_TIME_NEVER_F, H5T_CSET_UTF8_F, &
    H5T_STR_NULLTERM_F, H5T_FORTRAN_S1, H5T_STRING, H5T_NATIVE_DOUBLE, H5T_NATIVE_INTEGER, &
    H5T_IEEE_F64LE, H5T_STD_I32LE, H5T_STD_I64LE, H5T_STD_U8LE, h5kind_to_type, h5aclose_f, &
    h5acreate_by_name_f, h5awrite_f, h5dclose_f, h5dcreate_anon_f, h5dcreate_f, h5dget_space_f, &
    h5dset_extent_f, h5dwrite_f, h5gclose_f, h5gcreate_f, h5olink_f, h5pclose_f, h5pcreate_f, &
    h5pset_chunk_f, h5pset_fill_time_f, h5sclose_f, h5screate_f, h5screate_simple_f, &
    h5sselect_hyperslab_f, h5tclose_f, h5tcopy_f, h5tset_cset_f, h5tset_size_f, h5tset_strpad_f, &
    H5T_STRING_F, H5T_STR_SPACEPAD_F, h5dont_atexit_f, h5open_f, h5eset_auto_f, h5dopen_f, &
    h5dget_storage_size_f, h5dget_type_f, h5dread_f, h5sget_simple_extent_type_f, &
    h5sget_simple_extent_dims_f, h5sget_simple_extent_ndims_f, h5tget_class_f, h5tget_size_f, &
    h5tget_strpad_f, h5tis_variable_str_f
  use kinds_m, only : long
  use errors_m, only : error_t, raise, status_files
  use system_m, only : require_memory
  use visitor_m, only : as_real, as_integer, as_index, as_bytes
  implicit none
  private
  public :: growing_t, hid_t, as_real, as_index, create_growing, link_growing, append_rows, &
    open_growing, read_rows, close_growing, make_group, write_dataset, write_attribute, &
    text_attribute, write_text, read_text, check_status, memory_type, file_type, open_library, &
    end_of_file

  !> Dataset that grows by whole rows.
  type :: growing_t
    integer(hid_t) :: id = -1                !! open dataset
    character(:), allocatable :: name        !! for messages
    integer :: content = as_real             !! one of the `as_` constants
    integer :: n_column = 0                  !! 0: one-dimensional
    integer(long) :: n_row = 0               !! rows so far
  end type growing_t

  !> Memory that HDF5 needs for itself and a small file, bytes. HDF5 1.10.8 crashes if memory is
  !> refused while it is opened or creates a file.
  integer(c_size_t), parameter :: own_memory = 4*1024**2

  interface
    !> POSIX setenv; 0 on success.
    function c_setenv(name, text, overwrite) bind(c, name='setenv') result(status)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: name(*), text(*) !! end with a null
      integer(c_int), value :: overwrite   !! 0: what the user has set stays
      integer(c_int) :: status
    end function c_setenv

    !> Length of a file once all of it is written (no Fortran interface exists); < 0 on failure.
    function c_get_eoa(id, length) bind(c, name='H5Fget_eoa') result(status)
      import :: c_int, haddr_t, hid_t
      integer(hid_t), value :: id
      integer(haddr_t), intent(out) :: length !! bytes
      integer(c_int) :: status
    end function c_get_eoa
  end interface

contains

  !> Open the library; harmless if it is open. HDF5's file locks are switched off unless the
  !> environment sets them: viewers may open files while the run writes them, also on network file
  !> systems without locks.
  subroutine open_library(status)
    integer, intent(out) :: status !! < 0 on failure
    integer :: ignored, second
    integer(c_int) :: lock

    call require_memory(own_memory)
    lock = c_setenv('HDF5_USE_FILE_LOCKING'//c_null_char, 'FALSE'//c_null_char, 0_c_int)
    call h5dont_atexit_f(ignored) ! HDF5's own clean-up crashes after a full disk
    call h5open_f(status)
    call h5eset_auto_f(0, second) ! statuses become errors here; HDF5 itself stays quiet
    status = min(status, second)
  end subroutine open_library

  !> Length of an open file once all buffers are written, bytes; 0 where HDF5 gives none.
  function end_of_file(id) result(length)
    integer(hid_t), intent(in) :: id
    integer(haddr_t) :: length

    if (c_get_eoa(id, length) < 0) length = 0
  end function end_of_file

  !> Turn an HDF5 status into an error that names the file operation.
  subroutine check_status(status, what, error)
    integer, intent(in) :: status                       !! of the call, < 0 on failure
    character(*), intent(in) :: what                    !! file and dataset
    type(error_t), allocatable, intent(inout) :: error  !! kept if there is one already

    if (status >= 0 .or. allocated(error)) return
    call raise(error, 'cannot write '//what//' (is the disk full, or a quota used up?)', &
      status_files)
  end subroutine check_status

  !> HDF5 type in memory of a kind of content.
  function memory_type(content) result(type_id)
    integer, intent(in) :: content
    integer(hid_t) :: type_id

    select case (content)
    case (as_real); type_id = H5T_NATIVE_DOUBLE
    case (as_integer); type_id = H5T_NATIVE_INTEGER
    case (as_bytes); type_id = H5T_STD_U8LE
    case default; type_id = h5kind_to_type(long, H5_INTEGER_KIND)
    end select
  end function memory_type

  !> HDF5 type in the file of a kind of content, the same on every machine.
  function file_type(content) result(type_id)
    integer, intent(in) :: content
    integer(hid_t) :: type_id

    select case (content)
    case (as_real); type_id = H5T_IEEE_F64LE
    case (as_integer); type_id = H5T_STD_I32LE
    case (as_bytes); type_id = H5T_STD_U8LE
    case default; type_id = H5T_STD_I64LE
    end select
  end function file_type

  !> Make a group and close it again.
  subroutine make_group(parent, name, error)
    integer(hid_t), intent(in) :: parent
    character(*), intent(in) :: name
    type(error_t), allocatable, intent(inout) :: error
    integer(hid_t) :: group
    integer :: status

    if (allocated(error)) return
    call h5gcreate_f(parent, name, group, status)
    call check_status(status, name, error)
    if (allocated(error)) return
    call h5gclose_f(group, status)
    call check_status(status, name, error)
  end subroutine make_group

  !> Create an empty growing dataset; a chunk holds `chunk_rows` rows. It has no name in the file
  !> before `link_growing`.
  subroutine create_growing(file, name, content, n_column, chunk_rows, dataset, error)
    integer(hid_t), intent(in) :: file
    character(*), intent(in) :: name                   !! for messages
    integer, intent(in) :: content                     !! one of the `as_` constants
    integer, intent(in) :: n_column                    !! 0: one-dimensional
    integer, intent(in) :: chunk_rows                  !! rows per chunk
    type(growing_t), intent(out) :: dataset
    type(error_t), allocatable, intent(inout) :: error
    integer(hsize_t) :: dims(2), most(2), chunk(2)
    integer(hid_t) :: space, creation
    integer :: status(6), rank

    if (allocated(error)) return
    dataset%name = name
    dataset%content = content
    dataset%n_column = n_column
    rank = merge(1, 2, n_column == 0)
    dims = int(n_column, hsize_t) ! Fortran counts the columns first
    most = dims
    chunk = dims
    dims(rank) = 0
    most(rank) = H5S_UNLIMITED_F
    chunk(rank) = max(chunk_rows, 1)
    call h5screate_simple_f(rank, dims, space, status(1), most)
    call h5pcreate_f(H5P_DATASET_CREATE_F, creation, status(2))
    call h5pset_chunk_f(creation, rank, chunk, status(3))
    call h5pset_fill_time_f(creation, H5D_FILL_TIME_NEVER_F, status(4))
    call h5dcreate_anon_f(file, file_type(content), space, dataset%id, status(5), creation)
    call h5pclose_f(creation, status(6))
    call check_status(minval(status), name, error)
    call h5sclose_f(space, status(1))
    call check_status(status(1), name, error)
  end subroutine create_growing

  !> Link a growing dataset under a name, or under one more: equal arrays are stored once.
  subroutine link_growing(dataset, parent, name, error)
    type(growing_t), intent(in) :: dataset
    integer(hid_t), intent(in) :: parent
    character(*), intent(in) :: name                   !! path below `parent`
    type(error_t), allocatable, intent(inout) :: error
    integer :: status

    if (allocated(error)) return
    call h5olink_f(dataset%id, parent, name, status)
    call check_status(status, name, error)
  end subroutine link_growing

  !> Append rows; the dataset stays open.
  subroutine append_rows(dataset, n_row, values, error)
    type(growing_t), intent(inout) :: dataset
    integer, intent(in) :: n_row                       !! rows to append
    type(c_ptr), intent(in) :: values                  !! the rows, one after the other
    type(error_t), allocatable, intent(inout) :: error
    integer(hsize_t) :: dims(2)
    integer(hid_t) :: space, memory
    integer :: status(3), rank

    if (allocated(error) .or. n_row == 0) return
    rank = merge(1, 2, dataset%n_column == 0)
    dims = int(dataset%n_column, hsize_t)
    dims(rank) = dataset%n_row + n_row
    call h5dset_extent_f(dataset%id, dims, status(1))
    call select_rows(dataset, dataset%n_row, n_row, space, memory, status(2))
    call h5dwrite_f(dataset%id, memory_type(dataset%content), values, status(3), memory, space)
    call check_status(minval(status), dataset%name, error)
    call h5sclose_f(space, status(1))
    call h5sclose_f(memory, status(2))
    if (.not. allocated(error)) dataset%n_row = dataset%n_row + n_row
  end subroutine append_rows

  !> Select rows of a growing dataset, in the file and in memory.
  subroutine select_rows(dataset, first, n_row, space, memory, status)
    type(growing_t), intent(in) :: dataset
    integer(long), intent(in) :: first                 !! rows before
    integer, intent(in) :: n_row
    integer(hid_t), intent(out) :: space, memory
    integer, intent(out) :: status                     !! < 0 on failure
    integer(hsize_t) :: counts(2), start(2)
    integer :: each(3), rank

    rank = merge(1, 2, dataset%n_column == 0)
    counts = int(dataset%n_column, hsize_t)
    start = 0
    counts(rank) = n_row
    start(rank) = first
    call h5dget_space_f(dataset%id, space, each(1))
    call h5sselect_hyperslab_f(space, H5S_SELECT_SET_F, start(:rank), counts(:rank), each(2))
    call h5screate_simple_f(rank, counts, memory, each(3))
    status = minval(each)
  end subroutine select_rows

  !> Open a growing dataset of reals of an earlier run; closed and without rows where there is none.
  subroutine open_growing(file, name, n_column, dataset)
    integer(hid_t), intent(in) :: file
    character(*), intent(in) :: name                   !! path
    integer, intent(in) :: n_column                    !! expected columns
    type(growing_t), intent(out) :: dataset
    integer(hsize_t) :: dims(2), most(2)
    integer(hid_t) :: space
    integer :: status, rank

    dataset%name = name
    dataset%n_column = n_column
    call h5dopen_f(file, name, dataset%id, status)
    if (status < 0) then
      dataset%id = -1
      return
    end if
    call h5dget_space_f(dataset%id, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    if (rank == 1 .or. rank == 2) then
      call h5sget_simple_extent_dims_f(space, dims(:rank), most(:rank), status)
      dataset%n_row = int(dims(rank), long)
    end if
    call h5sclose_f(space, status)
  end subroutine open_growing

  !> Read rows of an open dataset.
  subroutine read_rows(dataset, first, n_row, values, error)
    type(growing_t), intent(in) :: dataset
    integer(long), intent(in) :: first                 !! rows before
    integer, intent(in) :: n_row
    type(c_ptr), intent(in) :: values                  !! the first value
    type(error_t), allocatable, intent(inout) :: error
    type(c_ptr) :: place
    integer(hid_t) :: space, memory
    integer :: status, ignored

    if (allocated(error)) return
    status = -1
    place = values
    if (dataset%id >= 0 .and. first + n_row <= dataset%n_row) then
      call select_rows(dataset, first, n_row, space, memory, status)
      if (status >= 0) call h5dread_f(dataset%id, memory_type(dataset%content), place, status, &
        memory, space)
      call h5sclose_f(memory, ignored)
      call h5sclose_f(space, ignored)
    end if
    if (status < 0) call raise(error, 'cannot read '//dataset%name//' of the results file before ' &
      //'the restart', status_files)
  end subroutine read_rows

  !> Close a growing dataset, if it is open.
  subroutine close_growing(dataset, error)
    type(growing_t), intent(inout) :: dataset
    type(error_t), allocatable, intent(inout) :: error
    integer :: status

    if (dataset%id < 0) return
    call h5dclose_f(dataset%id, status)
    dataset%id = -1
    call check_status(status, dataset%name, error)
  end subroutine close_growing

  !> Make a dataset of fixed size, write its values and close it.
  subroutine write_dataset(parent, name, types, space, values, error)
    integer(hid_t), intent(in) :: parent
    character(*), intent(in) :: name                   !! path below `parent`
    integer(hid_t), intent(in) :: types(2)             !! of a value in memory and in the file
    integer(hid_t), intent(in) :: space                !! its shape, which is closed
    type(c_ptr), intent(in) :: values                  !! the first value; null: nothing to write
    type(error_t), allocatable, intent(inout) :: error
    integer(hid_t) :: dataset
    integer :: status(3)

    status = 0
    call h5dcreate_f(parent, name, types(2), space, dataset, status(1))
    if (status(1) >= 0) then
      if (c_associated(values)) call h5dwrite_f(dataset, types(1), values, status(2))
      call h5dclose_f(dataset, status(3))
    end if
    call check_status(minval(status), name, error)
    call h5sclose_f(space, status(1))
  end subroutine write_dataset

  !> Write an attribute of a group.
  subroutine write_attribute(file, group, name, types, space, values, error)
    integer(hid_t), intent(in) :: file
    character(*), intent(in) :: group, name
    integer(hid_t), intent(in) :: types(2)             !! of a value in memory and in the file
    integer(hid_t), intent(in) :: space                !! its shape, which is closed
    type(c_ptr), intent(in) :: values                  !! the first value
    type(error_t), allocatable, intent(inout) :: error
    integer(hid_t) :: attribute
    integer :: status(3)

    call h5acreate_by_name_f(file, group, name, types(2), space, attribute, status(1))
    call h5awrite_f(attribute, types(1), values, status(2))
    call h5aclose_f(attribute, status(3))
    call check_status(minval(status), name, error)
    call h5sclose_f(space, status(1))
  end subroutine write_attribute

  !> Write a text as an attribute of a group: of fixed length in ASCII (for VTK), or of variable
  !> length in UTF-8 (`str` in Python).
  subroutine text_attribute(file, group, name, text, fixed, error)
    integer(hid_t), intent(in) :: file
    character(*), intent(in) :: group, name
    character(*), intent(in) :: text
    logical, intent(in) :: fixed                       !! exact length; not for an empty text
    type(error_t), allocatable, intent(inout) :: error
    character(kind=c_char, len=:), allocatable, target :: bytes
    type(c_ptr), target :: reference
    type(c_ptr) :: values
    integer(hid_t) :: space, type_id
    integer :: status(4)

    if (allocated(error)) return
    bytes = text//c_null_char
    reference = c_loc(bytes)
    values = c_loc(reference)
    if (fixed) values = reference
    call h5screate_f(H5S_SCALAR_F, space, status(1))
    if (fixed) then
      status(4) = 0
      call h5tcopy_f(H5T_FORTRAN_S1, type_id, status(2))
      call h5tset_size_f(type_id, int(len(text), size_t), status(3))
    else
      call h5tcopy_f(H5T_STRING, type_id, status(2))
      call h5tset_cset_f(type_id, H5T_CSET_UTF8_F, status(3))
      call h5tset_strpad_f(type_id, H5T_STR_NULLTERM_F, status(4))
    end if
    call check_status(minval(status), name, error)
    call write_attribute(file, group, name, [type_id, type_id], space, values, error)
    call h5tclose_f(type_id, status(1))
  end subroutine text_attribute

  !> Write a text of any size as a scalar string dataset.
  subroutine write_text(parent, name, text, error)
    integer(hid_t), intent(in) :: parent
    character(*), intent(in) :: name                   !! path below `parent`
    character(*), intent(in), target :: text
    type(error_t), allocatable, intent(inout) :: error
    integer(hid_t) :: space, type_id
    integer :: status(3)

    if (allocated(error) .or. len(text) == 0) return
    call h5tcopy_f(H5T_FORTRAN_S1, type_id, status(1))
    call h5tset_size_f(type_id, int(len(text), size_t), status(2))
    call h5screate_f(H5S_SCALAR_F, space, status(3))
    call check_status(minval(status), name, error)
    call write_dataset(parent, name, [type_id, type_id], space, c_loc(text), error)
    call h5tclose_f(type_id, status(1))
  end subroutine write_text

  !> Read a text from a scalar string dataset, whose bytes must all be stored.
  subroutine read_text(parent, name, text, is_good)
    integer(hid_t), intent(in) :: parent
    character(*), intent(in) :: name                   !! path below `parent`
    character(:), allocatable, intent(out), target :: text
    logical, intent(out) :: is_good                    !! the dataset is a text of this kind
    integer(hid_t) :: dataset, type_id, space
    integer(size_t) :: length
    integer(hsize_t) :: stored
    type(c_ptr) :: first
    integer :: status(8), kind_of_space, class, padding, i
    logical :: varies

    text = ''
    is_good = .false.
    call h5dopen_f(parent, name, dataset, status(1))
    if (status(1) < 0) return
    class = -1
    padding = -1
    kind_of_space = -1
    length = 0
    varies = .true.
    call h5dget_type_f(dataset, type_id, status(1))
    call h5tget_class_f(type_id, class, status(2))
    call h5tget_size_f(type_id, length, status(3))
    call h5tis_variable_str_f(type_id, varies, status(4))
    call h5tget_strpad_f(type_id, padding, status(5))
    call h5dget_space_f(dataset, space, status(6))
    call h5sget_simple_extent_type_f(space, kind_of_space, status(7))
    call h5dget_storage_size_f(dataset, stored, status(8))
    is_good = minval(status) >= 0 .and. class == H5T_STRING_F .and. padding == H5T_STR_SPACEPAD_F &
      .and. kind_of_space == H5S_SCALAR_F .and. length > 0 .and. .not. varies
    if (is_good) is_good = int(length, hsize_t) <= stored
    if (is_good) then
      deallocate (text)
      allocate (character(length) :: text)
      first = c_loc(text)
      call h5dread_f(dataset, type_id, first, i)
      is_good = i >= 0
    end if
    call h5tclose_f(type_id, i)
    call h5sclose_f(space, i)
    call h5dclose_f(dataset, i)
  end subroutine read_text

end module hdf5_writing_m
