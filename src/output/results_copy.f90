! SPDX-License-Identifier: MIT
!> A restart takes the states before it over from the results file that the run has left: into a new
!> file, which then replaces the old one in one step. So the old file stays whole whatever happens.
module results_copy_m
  use, intrinsic :: iso_c_binding, only : c_ptr, c_loc
  use hdf5, only : hid_t, hsize_t, H5F_ACC_RDONLY_F, H5S_SELECT_SET_F, h5dclose_f, h5dget_space_f, &
    h5dopen_f, h5dread_f, h5fclose_f, h5fopen_f, h5lexists_f, h5sclose_f, h5screate_simple_f, &
    h5sget_simple_extent_dims_f, h5sget_simple_extent_ndims_f, h5sselect_hyperslab_f
  use archive_m, only : archive_t, is_hard, is_stored_within
  use errors_m, only : error_t, raise, status_files, status_input
  use files_m, only : file_exists
  use hdf5_writing_m, only : open_library, append_rows, as_real, memory_type
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
    real(wp), target :: stored(max(size(times), 1))
    integer(hid_t) :: id
    integer(long) :: n_state, n_point
    integer :: status
    logical :: fits

    found = file_exists(path)
    if (.not. found) return
    call open_library(status)
    call h5fopen_f(path, H5F_ACC_RDONLY_F, id, status)
    fits = status >= 0
    if (fits) then
      call check_own_arrays(id, path, error)
      if (allocated(error)) then
        call h5fclose_f(id, status)
        return
      end if
      n_state = row_count(id, 'VTKHDF/Steps/Values')
      n_point = row_count(id, 'VTKHDF/PointData/node_id')
      fits = n_state >= size(times) .and. n_point == n_node
      if (fits .and. size(times) > 0) then
        call read_rows(id, 'VTKHDF/Steps/Values', 0, 0_long, size(times), c_loc(stored), error)
        fits = .not. allocated(error)
        if (fits) fits = all(.not. abs(stored(:size(times)) - times) > 0.0_wp)
      end if
      call h5fclose_f(id, status)
    end if
    if (.not. fits) call raise(error, path//' does not hold the states before the restart: it is ' &
      //'of another run, or damaged; move it away, or give another folder by d=', status_input)
  end subroutine check_old_results

  !> Refuse a file of which an array lies elsewhere: in another file, by a link or as a virtual
  !> dataset, or in outer storage. It would get into the results of this run.
  subroutine check_own_arrays(id, path, error)
    integer(hid_t), intent(in) :: id       !! open file
    character(*), intent(in) :: path       !! for messages
    type(error_t), allocatable, intent(out) :: error
    character(len(fields%name)) :: names(2 + size(fields))
    integer :: i

    names = [character(len(names)) :: 'Steps/Values', 'PointData/node_id', fields%name]
    do i = 1, size(names)
      if (is_own(id, 'VTKHDF/'//trim(names(i)))) cycle
      call raise(error, path//' is refused: its VTKHDF/'//trim(names(i))//' is not stored in it, ' &
        //'but a link, a virtual dataset or outer storage; move it away, or give another folder ' &
        //'by d=', status_input)
      return
    end do
  end subroutine check_own_arrays

  !> Whether an array is stored in the file itself, as are the groups that it lies in; an array that
  !> is not there at all is.
  function is_own(id, path)
    integer(hid_t), intent(in) :: id       !! open file
    character(*), intent(in) :: path
    logical :: is_own
    type(archive_t) :: file
    integer(hid_t) :: dataset
    integer :: i, n, status
    logical :: found

    file%id = id
    file%folder = ''
    is_own = .true.
    n = 0
    do
      i = index(path(n + 1:)//'/', '/')
      n = n + i
      call h5lexists_f(id, path(:n - 1), found, status)
      if (status < 0 .or. .not. found) return
      is_own = is_hard(file, path(:n - 1))
      if (n > len(path) .or. .not. is_own) exit
    end do
    if (.not. is_own) return
    call h5dopen_f(id, path, dataset, status)
    if (status < 0) return
    is_own = is_stored_within(dataset)
    call h5dclose_f(dataset, status)
  end function is_own

  !> Rows of a dataset, -1 when there is none.
  function row_count(id, name) result(n)
    integer(hid_t), intent(in) :: id       !! open file
    character(*), intent(in) :: name
    integer(long) :: n
    integer(hid_t) :: dataset, space
    integer(hsize_t) :: dims(2), most(2)
    integer :: status, rank

    n = -1
    call h5dopen_f(id, name, dataset, status)
    if (status < 0) return
    call h5dget_space_f(dataset, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    if (rank == 1 .or. rank == 2) then
      call h5sget_simple_extent_dims_f(space, dims(:rank), most(:rank), status)
      n = int(dims(rank), long)
    end if
    call h5sclose_f(space, status)
    call h5dclose_f(dataset, status)
  end function row_count

  !> Copy the states of these times from the file under the name of the new one, which then takes
  !> the name. The old file must have passed `check_old_results`.
  subroutine copy_states(file, model, times, error)
    type(results_file_t), intent(inout) :: file
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: times(:)
    type(error_t), allocatable, intent(out) :: error
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
          call read_rows(old, 'VTKHDF/'//trim(field%name), field%n_column, (k - 1)*int(n, long), &
            n, c_loc(rows), error)
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

  !> Read rows of a dataset of reals.
  subroutine read_rows(id, name, n_column, first, n_row, values, error)
    integer(hid_t), intent(in) :: id       !! open file
    character(*), intent(in) :: name
    integer, intent(in) :: n_column        !! 0: one-dimensional
    integer(long), intent(in) :: first     !! rows before
    integer, intent(in) :: n_row
    type(c_ptr), intent(in) :: values      !! the first value
    type(error_t), allocatable, intent(inout) :: error
    integer(hsize_t) :: counts(2), start(2)
    type(c_ptr) :: place
    integer(hid_t) :: dataset, space, memory
    integer :: status(4), ignored, rank

    if (allocated(error)) return
    rank = merge(1, 2, n_column == 0)
    counts = int(n_column, hsize_t)
    start = 0
    counts(rank) = n_row
    start(rank) = first
    status = 0
    place = values
    call h5dopen_f(id, name, dataset, status(1))
    if (status(1) >= 0) then
      call h5dget_space_f(dataset, space, status(2))
      call h5sselect_hyperslab_f(space, H5S_SELECT_SET_F, start(:rank), counts(:rank), status(3))
      call h5screate_simple_f(rank, counts(:rank), memory, ignored)
      if (minval(status) >= 0) call h5dread_f(dataset, memory_type(as_real), place, status(4), &
        memory, space)
      call h5sclose_f(memory, ignored)
      call h5sclose_f(space, ignored)
      call h5dclose_f(dataset, ignored)
    end if
    if (minval(status) < 0) call raise(error, 'cannot read '//name//' of the results file before ' &
      //'the restart', status_files)
  end subroutine read_rows

end module results_copy_m
