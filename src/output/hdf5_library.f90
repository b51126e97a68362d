! SPDX-License-Identifier: MIT
!> HDF5 as a whole: how this program opens the library, and texts read back.
module hdf5_library_m
  use, intrinsic :: iso_c_binding, only : c_char, c_int, c_loc, c_ptr, c_size_t, &
    c_null_char
  use hdf5, only : haddr_t, hid_t, hsize_t, size_t, H5S_SCALAR_F, H5T_STRING_F, &
    H5T_STR_SPACEPAD_F, h5dont_atexit_f, h5open_f, h5eset_auto_f, h5dopen_f, h5dclose_f, &
    h5dget_space_f, h5dget_storage_size_f, h5dget_type_f, h5dread_f, h5sclose_f, &
    h5sget_simple_extent_type_f, &
    h5tclose_f, h5tget_class_f, h5tget_size_f, h5tget_strpad_f, h5tis_variable_str_f
  use refused_memory_m, only : need_memory
  implicit none
  private
  public :: open_library, end_of_file, read_text

  !> Bytes that HDF5 takes for itself and a small file. It crashes while it is opened, and while it
  !> makes a file, where memory is refused (1.10.8).
  integer(c_size_t), parameter :: own_memory = 4*1024**2

  interface
    !> POSIX setenv; 0 on success.
    function c_setenv(name, text, overwrite) bind(c, name='setenv') result(status)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: name(*), text(*) !! end with a null
      integer(c_int), value :: overwrite   !! 0: what the user has set stays
      integer(c_int) :: status
    end function c_setenv

    !> How long a file is once all of it is written (there is no Fortran name for it); < 0 on
    !> failure.
    function c_get_eoa(id, length) bind(c, name='H5Fget_eoa') result(status)
      import :: c_int, haddr_t, hid_t
      integer(hid_t), value :: id
      integer(haddr_t), intent(out) :: length !! bytes
      integer(c_int) :: status
    end function c_get_eoa
  end interface

contains

  !> Open the library; harmless when it is open.
  subroutine open_library(status)
    integer, intent(out) :: status !! < 0 on failure
    integer :: ignored, second

    call need_memory(own_memory)
    call allow_reading()
    call h5dont_atexit_f(ignored) ! HDF5's own clean-up crashes after a full disk
    call h5open_f(status)
    call h5eset_auto_f(0, second) ! statuses become errors here; HDF5 itself stays quiet
    status = min(status, second)
  end subroutine open_library

  !> How long an open file will be when all that waits is written, bytes; 0 where HDF5 can not tell.
  function end_of_file(id) result(length)
    integer(hid_t), intent(in) :: id
    integer(haddr_t) :: length

    if (c_get_eoa(id, length) < 0) length = 0
  end function end_of_file

  !> Let viewers open files while the run still writes them, and let them live on network file
  !> systems without locks: switches HDF5's lock off unless the user's environment says otherwise.
  !> To be called before HDF5 is.
  subroutine allow_reading()
    integer(c_int) :: status

    status = c_setenv('HDF5_USE_FILE_LOCKING'//c_null_char, 'FALSE'//c_null_char, 0_c_int)
  end subroutine allow_reading

  !> Read a text of any size from a scalar string dataset, whose bytes must all be stored.
  subroutine read_text(parent, name, text, is_good)
    integer(hid_t), intent(in) :: parent
    character(*), intent(in) :: name                   !! path below `parent`
    character(:), allocatable, intent(out), target :: text
    logical, intent(out) :: is_good                    !! it is a text of that kind
    integer(hid_t) :: dataset, type_id, space
    integer(size_t) :: length
    integer(hsize_t) :: stored
    type(c_ptr) :: first
    integer :: status(9), kind_of_space, class, padding, i
    logical :: varies

    text = ''
    is_good = .false.
    call h5dopen_f(parent, name, dataset, status(1))
    if (status(1) < 0) return
    call h5dget_type_f(dataset, type_id, status(1))
    call h5tget_class_f(type_id, class, status(2))
    call h5tget_size_f(type_id, length, status(3))
    call h5dget_space_f(dataset, space, status(4))
    call h5sget_simple_extent_type_f(space, kind_of_space, status(5))
    call h5dget_storage_size_f(dataset, stored, status(6))
    is_good = minval(status(:6)) >= 0 .and. class == H5T_STRING_F &
      .and. kind_of_space == H5S_SCALAR_F
    varies = .true.
    if (is_good) call h5tis_variable_str_f(type_id, varies, status(7))
    if (is_good) call h5tget_strpad_f(type_id, padding, status(8))
    is_good = is_good .and. .not. varies
    if (is_good) is_good = length > 0 .and. int(length, hsize_t) <= stored &
      .and. padding == H5T_STR_SPACEPAD_F
    if (is_good) then
      deallocate (text)
      allocate (character(length) :: text)
      first = c_loc(text)
      call h5dread_f(dataset, type_id, first, status(9))
      is_good = status(9) >= 0
    end if
    call h5tclose_f(type_id, i)
    call h5sclose_f(space, i)
    call h5dclose_f(dataset, i)
  end subroutine read_text

end module hdf5_library_m
