! SPDX-License-Identifier: MIT
!> HDF5 as a whole: how this program opens the library, and texts read back.
module hdf5_library_m
  use, intrinsic :: iso_c_binding, only : c_char, c_int, c_loc, c_ptr, c_null_char
  use hdf5, only : hid_t, size_t, h5dont_atexit_f, h5open_f, h5eset_auto_f, h5dopen_f, h5dclose_f, &
    h5dget_type_f, h5dread_f, h5lexists_f, h5tclose_f, h5tget_size_f
  implicit none
  private
  public :: open_library, read_text

  interface
    !> POSIX setenv; 0 on success.
    function c_setenv(name, text, overwrite) bind(c, name='setenv') result(status)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: name(*), text(*) !! end with a null
      integer(c_int), value :: overwrite   !! 0: what the user has set stays
      integer(c_int) :: status
    end function c_setenv
  end interface

contains

  !> Open the library; harmless when it is open.
  subroutine open_library(status)
    integer, intent(out) :: status !! < 0 on failure
    integer :: ignored, second

    call allow_reading()
    call h5dont_atexit_f(ignored) ! HDF5's own clean-up crashes after a full disk
    call h5open_f(status)
    call h5eset_auto_f(0, second) ! statuses become errors here; HDF5 itself stays quiet
    status = min(status, second)
  end subroutine open_library

  !> Let viewers open files while the run still writes them, and let them live on network file
  !> systems without locks: switches HDF5's lock off unless the user's environment says otherwise.
  !> To be called before HDF5 is.
  subroutine allow_reading()
    integer(c_int) :: status

    status = c_setenv('HDF5_USE_FILE_LOCKING'//c_null_char, 'FALSE'//c_null_char, 0_c_int)
  end subroutine allow_reading

  !> Read a text of any size from a scalar string dataset; empty when there is none.
  subroutine read_text(parent, name, text)
    integer(hid_t), intent(in) :: parent
    character(*), intent(in) :: name                   !! path below `parent`
    character(:), allocatable, intent(out), target :: text
    integer(hid_t) :: dataset, type_id
    integer(size_t) :: length
    type(c_ptr) :: first
    integer :: status
    logical :: found

    call h5lexists_f(parent, name, found, status)
    if (.not. found .or. status < 0) then
      text = ''
      return
    end if
    call h5dopen_f(parent, name, dataset, status)
    call h5dget_type_f(dataset, type_id, status)
    call h5tget_size_f(type_id, length, status)
    allocate (character(length) :: text)
    first = c_loc(text)
    call h5dread_f(dataset, type_id, first, status)
    call h5tclose_f(type_id, status)
    call h5dclose_f(dataset, status)
  end subroutine read_text

end module hdf5_library_m
