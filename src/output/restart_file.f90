! SPDX-License-Identifier: MIT
!> Restart file: an HDF5 archive after a head of 512 bytes of text, which HDF5 skips:
!>
!>    slideline restart <format>
!>    length 123456
!>    checksum 89ABCDEF
!>
!> Length and CRC-32 are those of the bytes after the head. They are checked before HDF5 opens the
!> file, so that HDF5 never reads a damaged one. The file is written as `<path>.part`, its head
!> last, forced onto the disk, and then renamed in one step: a file of the final name is always
!> complete, also after a power failure.
module restart_file_m
  use hdf5, only : hid_t, hsize_t, H5P_FILE_CREATE_F, H5F_ACC_TRUNC_F, H5F_ACC_RDONLY_F, &
    H5F_SCOPE_LOCAL_F, h5fcreate_f, h5fopen_f, h5fclose_f, h5fflush_f, h5pcreate_f, h5pclose_f, &
    h5pset_userblock_f
  use archive_m, only : archive_t
  use checksum_m, only : add_bytes, checksum_text
  use errors_m, only : error_t, raise, status_files, status_input
  use files_m, only : write_obstacle, rename_file, remove_file, force_to_disk, is_endless, &
    folder_of, unfinished
  use hdf5_writing_m, only : open_library
  use kinds_m, only : long
  use log_m, only : to_text
  use text_files_m, only : overwrite_start
  implicit none
  private
  public :: create_restart, finish_restart, open_restart, close_restart

  !> Format of the file. To be raised when a component of the state is added, removed or changes its
  !> meaning, and when nodes or elements get another order.
  integer, parameter :: format_version = 27
  character(*), parameter :: mark = 'slideline restart '
  !> Bytes of the head, and of a block that is read.
  integer, parameter :: head_size = 512, block_size = 65536

contains

  !> Create the restart file that becomes `path`.
  subroutine create_restart(path, archive)
    character(*), intent(in) :: path
    type(archive_t), intent(out) :: archive
    integer(hid_t) :: creation
    integer :: status(4), ignored

    archive%path = path
    archive%folder = ''
    if (len(write_obstacle(path//unfinished)) > 0) then
      call archive%fail('cannot write '//path//unfinished//': ' &
        //write_obstacle(path//unfinished), status_files)
      return
    end if
    call remove_file(path//unfinished, archive%error)
    if (allocated(archive%error)) return
    call open_library(status(1))
    call h5pcreate_f(H5P_FILE_CREATE_F, creation, status(2))
    call h5pset_userblock_f(creation, int(head_size, hsize_t), status(3))
    call h5fcreate_f(path//unfinished, H5F_ACC_TRUNC_F, archive%id, status(4), creation)
    call h5pclose_f(creation, ignored)
    if (minval(status) < 0) call archive%fail('cannot write '//path &
      //' (no directory, no permission or no space)', status_files)
  end subroutine create_restart

  !> Force the file to the disk, write its head and rename it. After a failure an existing file of
  !> that name stays.
  subroutine finish_restart(archive, error)
    type(archive_t), intent(inout) :: archive
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: ignored
    integer :: status

    if (.not. allocated(archive%error)) then
      call h5fflush_f(archive%id, H5F_SCOPE_LOCAL_F, status)
      ! A file that could not be flushed stays open: closing it would make HDF5 try again and crash.
      if (status >= 0) call h5fclose_f(archive%id, status)
      if (status < 0) call archive%fail('cannot write '//archive%path &
        //' (is the disk full, or a quota used up?)', status_files)
    end if
    if (.not. allocated(archive%error)) call write_head(archive%path//unfinished, archive%error)
    if (.not. allocated(archive%error)) call force_to_disk(archive%path//unfinished, archive%error)
    if (.not. allocated(archive%error)) &
      call rename_file(archive%path//unfinished, archive%path, archive%error)
    if (.not. allocated(archive%error)) then
      ! The directory entry too; file systems without this have the file all the same.
      call force_to_disk(folder_of(archive%path), ignored)
      return
    end if
    call move_alloc(archive%error, error)
    error%status = status_files
    if (index(error%message, archive%path) == 0) error%message = archive%path//': '//error%message
    call remove_file(archive%path//unfinished, ignored)
  end subroutine finish_restart

  !> Write the head with length and checksum, and read it back.
  subroutine write_head(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    character(head_size) :: head, found
    character(:), allocatable :: checksum, reason
    integer(long) :: length, n_byte
    integer :: unit, status

    call file_checksum(path, length, checksum, reason)
    if (.not. allocated(reason)) then
      head = head_text(length, checksum)
      call overwrite_start(path, head, error)
      if (allocated(error)) return
      call open_bytes(path, unit, n_byte, reason)
    end if
    if (.not. allocated(reason)) then
      read (unit, iostat=status) found
      if (status /= 0 .or. n_byte /= length + head_size .or. found /= head) &
        reason = 'its head cannot be read back'
      close (unit, iostat=status)
    end if
    if (allocated(reason)) call raise(error, 'cannot write '//path//': '//reason, status_files)
  end subroutine write_head

  !> The head of a file.
  pure function head_text(length, checksum) result(head)
    integer(long), intent(in) :: length     !! bytes behind the head
    character(*), intent(in) :: checksum
    character(head_size) :: head
    character(20) :: digits
    character(1), parameter :: n = new_line('a')

    write (digits, '(ss,i0)') length
    head = mark//to_text(format_version)//n//'length '//trim(digits)//n//'checksum '//checksum//n
  end function head_text

  !> Checksum of a file after its head; `reason` is set if it cannot be read.
  subroutine file_checksum(path, length, checksum, reason)
    character(*), intent(in) :: path
    integer(long), intent(out) :: length    !! bytes after the head
    character(:), allocatable, intent(out) :: checksum
    character(:), allocatable, intent(out) :: reason
    integer(long) :: sum_of_bytes
    character(block_size), allocatable :: block
    integer(long) :: n_byte, start
    integer :: unit, status, n

    length = 0
    call open_bytes(path, unit, n_byte, reason)
    if (allocated(reason)) return
    length = max(n_byte - head_size, 0_long)
    allocate (block)
    sum_of_bytes = 0
    start = head_size
    status = 0
    do while (start < n_byte .and. status == 0)
      n = int(min(int(block_size, long), n_byte - start))
      read (unit, pos=start + 1, iostat=status) block(:n)
      call add_bytes(sum_of_bytes, block(:n))
      start = start + n
    end do
    if (status /= 0) reason = 'it cannot be read'
    close (unit, iostat=status)
    checksum = checksum_text(sum_of_bytes)
  end subroutine file_checksum

  !> Open a file to read its bytes; `reason` is set if it cannot be opened.
  subroutine open_bytes(path, unit, n_byte, reason)
    character(*), intent(in) :: path
    integer, intent(out) :: unit
    integer(long), intent(out) :: n_byte    !! length of the file
    character(:), allocatable, intent(out) :: reason
    integer :: status

    n_byte = 0
    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
      action='read', iostat=status)
    if (status /= 0) then
      reason = 'it cannot be opened'
    else
      inquire (unit=unit, size=n_byte)
    end if
  end subroutine open_bytes

  !> Open a restart file for reading; an incomplete or foreign file is refused with the reason.
  subroutine open_restart(path, archive, error)
    character(*), intent(in) :: path
    type(archive_t), intent(out) :: archive
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: reason
    integer :: status

    archive%path = path
    archive%folder = ''
    archive%is_read = .true.
    archive%validates = .true.
    call check_file(path, reason)
    if (.not. allocated(reason)) then
      call open_library(status)
      if (status >= 0) call h5fopen_f(path, H5F_ACC_RDONLY_F, archive%id, status)
      if (status < 0) reason = 'HDF5 cannot open it'
    end if
    if (allocated(reason)) call raise(error, 'the restart file '//path//' is refused: '//reason, &
      status_input)
  end subroutine open_restart

  !> Why a file is no valid restart file; `reason` stays unset if it is one.
  subroutine check_file(path, reason)
    character(*), intent(in) :: path
    character(:), allocatable, intent(out) :: reason
    character(head_size) :: head
    character(:), allocatable :: checksum
    integer(long) :: length, expected, n_byte
    integer :: unit, status, version, i

    head = ''
    if (is_endless(path)) then
      reason = 'it is empty, or not a regular file'
      return
    end if
    call open_bytes(path, unit, n_byte, reason)
    if (allocated(reason)) then
      reason = reason//'; restart files are called <job>.dump01.h5 and on, or <job>.runrsf.h5'
      return
    end if
    status = 0
    if (n_byte > 0) read (unit, iostat=status) head(:min(n_byte, int(head_size, long)))
    close (unit)
    if (status /= 0 .or. n_byte == 0) then
      reason = 'it is empty or cannot be read'
    else if (index(head, mark) /= 1) then
      reason = 'it is not a restart file of slideline'
      if (head(2:4) == 'HDF') reason = reason//', but another HDF5 file'
    end if
    if (allocated(reason)) return
    i = index(head, new_line('a'))
    read (head(len(mark) + 1:max(i - 1, len(mark) + 1)), *, iostat=status) version
    if (status /= 0) then
      reason = 'its head is damaged'
    else if (version /= format_version) then
      reason = 'it has format '//to_text(version)//' and was written by '//trim(merge('an older', &
        'a newer ', version < format_version))//' version; this program reads format ' &
        //to_text(format_version)
    else
      call file_checksum(path, length, checksum, reason)
      if (allocated(reason) .or. head == head_text(length, checksum)) return
      reason = 'it is damaged (its checksum '//checksum//' differs from that in its head)'
      i = index(head, 'length ')
      if (i == 0) return
      read (head(i + 7:), *, iostat=status) expected
      if (status /= 0 .or. expected == length) return
      reason = 'it is damaged (its length differs from that in its head)'
      if (length < expected) reason = 'it is truncated'
    end if
  end subroutine check_file

  !> Close a file that was read.
  subroutine close_restart(archive, error)
    type(archive_t), intent(inout) :: archive
    type(error_t), allocatable, intent(out) :: error
    integer :: status

    if (archive%id >= 0) call h5fclose_f(archive%id, status)
    archive%id = -1
    if (allocated(archive%error)) call move_alloc(archive%error, error)
  end subroutine close_restart

end module restart_file_m
