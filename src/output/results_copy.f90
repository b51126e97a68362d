! SPDX-License-Identifier: MIT
!> A restart takes the states before it over from the results file that the run has left: into a new
!> file, which then replaces the old one in one step. So the old file stays whole whatever happens.
module results_copy_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use hdf5, only : hid_t, H5F_ACC_RDONLY_F, h5fclose_f, h5fopen_f, h5lexists_f
  use archive_m, only : archive_t, is_hard, own_layout
  use errors_m, only : error_t, raise, status_files, status_input
  use files_m, only : file_exists
  use hdf5_writing_m, only : growing_t, open_library, open_growing, read_rows, append_rows, &
    close_growing
  use kinds_m, only : wp, long
  use model_m, only : model_t
  use results_arrays_m, only : results_file_t, fields
  use results_file_m, only : append_instant, take_name, note_failure
  implicit none
  private
  public :: check_old_results, copy_states

contains

  !> Whether there is a results file to take states over from. One that does not hold the states of
  !> these times is an error: it is of another run, and would be lost.
  subroutine check_old_results(path, n_node, times, found, error)
    character(*), intent(in) :: path
    integer, intent(in) :: n_node
    real(wp), intent(in) :: times(:)
    logical, intent(out) :: found
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: unread
    type(growing_t) :: array
    character(len(fields%name)) :: names(2 + size(fields))
    real(wp), target :: stored(max(size(times), 1))
    integer(hid_t) :: id
    integer :: status, i
    logical :: fits

    found = file_exists(path)
    if (.not. found) return
    names = [character(len(names)) :: 'Steps/Values', 'PointData/node_id', fields%name]
    call open_library(status)
    call h5fopen_f(path, H5F_ACC_RDONLY_F, id, status)
    fits = status >= 0
    do i = 1, size(names)
      if (allocated(error) .or. .not. fits) exit
      call open_own(id, 'VTKHDF/'//trim(names(i)), path, array, error)
      if (allocated(error)) exit
      if (i == 1) then
        fits = array%id >= 0 .and. array%n_row >= size(times)
        if (fits .and. size(times) > 0) then
          call read_rows(array, 0_long, size(times), c_loc(stored), unread)
          fits = .not. allocated(unread)
          if (fits) fits = all(.not. abs(stored(:size(times)) - times) > 0.0_wp)
        end if
      else if (i == 2) then
        fits = array%id >= 0 .and. array%n_row == n_node
      end if
      call close_growing(array, error)
    end do
    if (status >= 0) call h5fclose_f(id, status)
    if (.not. (fits .or. allocated(error))) call raise(error, path//' does not hold the states ' &
      //'before the restart: it is of another run, or damaged; move it away, or give another ' &
      //'folder by d=', status_input)
  end subroutine check_old_results

  !> Open an array of a results file, if it is there. One that lies elsewhere is refused: in another
  !> file, by a link or as a virtual dataset, or in outer storage. It would get into the results of
  !> this run.
  subroutine open_own(id, name, path, array, error)
    integer(hid_t), intent(in) :: id       !! open file
    character(*), intent(in) :: name, path !! of the array; of the file, for messages
    type(growing_t), intent(out) :: array
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: ignored
    type(archive_t) :: file
    integer :: n, status
    logical :: is_own, found

    file%id = id
    file%folder = ''
    is_own = .true.
    found = .true.
    n = 0
    do while (n <= len(name) .and. found .and. is_own) ! the groups that it lies in, and itself
      n = n + index(name(n + 1:)//'/', '/')
      call h5lexists_f(id, name(:n - 1), found, status)
      if (found) is_own = is_hard(file, name(:n - 1))
    end do
    if (found .and. is_own) call open_growing(id, name, 0, array)
    if (array%id >= 0) is_own = own_layout(array%id) >= 0
    if (is_own) return
    call close_growing(array, ignored)
    call raise(error, path//' is refused: its '//name//' is not stored in it, but a link, a ' &
      //'virtual dataset or outer storage; move it away, or give another folder by d=', &
      status_input)
  end subroutine open_own

  !> Copy the states of these times from the file under the name of the new one, which then takes
  !> the name. The old file must have passed `check_old_results`.
  subroutine copy_states(file, model, times, error)
    type(results_file_t), intent(inout) :: file
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: times(:)
    type(error_t), allocatable, intent(out) :: error
    type(growing_t) :: array
    real(wp), allocatable, target :: rows(:)
    integer(hid_t) :: old
    integer :: status, i, k, n

    if (size(times) == 0) return
    call h5fopen_f(file%path, H5F_ACC_RDONLY_F, old, status)
    if (status < 0) then
      call raise(error, 'cannot read '//file%path, status_files)
      return
    end if
    do k = 1, size(times)
      do i = 1, size(file%which)
        associate (field => fields(file%which(i)))
          n = merge(model%mesh%n_element, model%mesh%n_node, field%of_cells)
          allocate (rows(n*max(field%n_column, 1)))
          call open_growing(old, 'VTKHDF/'//trim(field%name), field%n_column, array)
          call read_rows(array, (k - 1)*int(n, long), n, c_loc(rows), error)
          call close_growing(array, error)
        end associate
        call append_rows(file%fields(file%which(i)), n, c_loc(rows), error)
        deallocate (rows)
      end do
      call append_instant(file, model, times(k), error)
    end do
    call h5fclose_f(old, status)
    call take_name(file, error)
    call note_failure(file, error)
  end subroutine copy_states

end module results_copy_m
