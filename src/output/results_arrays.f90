! SPDX-License-Identifier: MIT
!> The results file as a whole: the HDF5 file, its growing arrays and their layout.
!>
!> The layout keeps the file readable whenever the process is killed. What a viewer trusts is the
!> number of rows below Steps and the attribute NSteps: their headers lie side by side within a
!> page, so that HDF5 changes all of them with one write. Everything else of a state reaches the
!> file before, into rows that nobody looks at yet; tables of chunks lie within a page each and do
!> not split as long as no more states come than the deck plans.
module results_arrays_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use hdf5, only : hid_t, hsize_t, size_t, H5P_FILE_CREATE_F, H5P_FILE_ACCESS_F, H5F_ACC_TRUNC_F, &
    H5S_SCALAR_F, H5T_STD_I64LE, H5_INTEGER_KIND, h5kind_to_type, h5pcreate_f, h5pclose_f, &
    h5pset_sym_k_f, h5pset_cache_f, h5pset_alignment_f, &
    h5pset_meta_block_size_f, h5fcreate_f, h5gopen_f, h5gclose_f, h5screate_f, h5sclose_f, &
    h5acreate_f, h5awrite_f
  use kinds_m, only : wp, long
  use errors_m, only : error_t, raise, status_files
  use file_facts_m, only : file_facts_t, what_hinders
  use files_m, only : remove_file, unfinished
  use mesh_m, only : mesh_t
  use controls_m, only : controls_t
  use hdf5_library_m, only : open_library
  use hdf5_writing_m, only : growing_t, as_real, as_index, create_growing, link_growing, &
    make_group, check_status
  implicit none
  private
  public :: results_file_t, create_file, create_steps, create_fields, planned_states, &
    states_per_chunk, block_rows, n_point_field, n_cell_field, n_step_array, &
    point_names, point_columns, cell_names, cell_columns, plane_fields, round_field, heat_fields, &
    eroded_field, &
    step_values, step_points, step_ones

  !> Fields, in the order in which `append_state` writes them, and their numbers of columns.
  integer, parameter :: n_point_field = 9, n_cell_field = 8
  character(16), parameter :: point_names(n_point_field) = [character(16) :: 'Points', &
    'displacement', 'velocity', 'contact_force', 'contact_pressure', 'gap', 'contact_traction', &
    'contact_slip', 'contact_state']
  integer, parameter :: point_columns(n_point_field) = [3, 3, 3, 3, 0, 0, 0, 0, 0]
  !> Without friction the fields from that one on are left out.
  integer, parameter :: n_plain_field = 6
  character(16), parameter :: cell_names(n_cell_field) = [character(16) :: 'stress', &
    'plastic_strain', 'pressure', 'mises', 'hoop_strain', 'temperature', 'damage', &
    'eroded']
  integer, parameter :: cell_columns(n_cell_field) = [6, 0, 0, 0, 0, 0, 0, 0]
  !> What every file has of them, what round bodies have, what bodies that keep heat have, and what
  !> those have whose elements may leave the mesh.
  integer, parameter :: plane_fields(4) = [1, 2, 3, 4], round_field = 5, heat_fields(2) = [6, 7], &
    eroded_field = 8
  !> Arrays below Steps: times, first point of a state, first cell, zeros and ones.
  integer, parameter :: n_step_array = 5, step_values = 1, step_points = 2, step_cells = 3, &
    step_zeros = 4, step_ones = 5

  !> Chunks that the planned states fill of the 64 in one table of HDF5, and a size that a table
  !> is not below.
  integer, parameter :: chunks_per_table = 52
  integer(hsize_t), parameter :: table_size = 2048, page_size = 4096
  !> Bytes that a chunk reaches where the states allow, and that it cannot exceed in HDF5.
  integer(long), parameter :: small_chunk = 65536, large_chunk = 2_long**32 - 1
  !> Rows per chunk of the arrays below Steps, at least: a row that needs a new chunk appears with
  !> several writes.
  integer, parameter :: least_step_rows = 1024
  !> Rows of a field that are put together for one write: they stay in the cache until then.
  integer, parameter :: block_rows = 16384
  !> Bound on the number of states that is planned for.
  integer, parameter :: most_planned = 4096

  !> An open results file.
  type :: results_file_t
    character(:), allocatable :: path
    logical :: is_named = .false.               !! it has its own name
    logical :: is_broken = .false.              !! a write failed: left as it is, never closed
    type(file_facts_t) :: facts                 !! as the last flush left it
    integer(hid_t) :: id = -1                   !! open file
    integer(hid_t) :: n_steps = -1              !! open attribute NSteps
    integer(long) :: n_state = 0                !! states in the file
    real(wp), allocatable :: times(:)           !! (n_state or more) their times
    integer :: n_point_field = n_plain_field    !! of those above that the file has
    integer, allocatable :: cells(:)            !! which of the cell fields
    type(growing_t) :: point_fields(n_point_field)
    type(growing_t) :: cell_fields(n_cell_field)
    type(growing_t) :: steps(n_step_array)
    real(wp), allocatable :: rows(:)            !! (3*rows, at most block_rows) of one write
  end type results_file_t

contains

  !> Number of states that the deck asks for; a guess when the interval varies. It only sizes the
  !> pieces of the file: more states fit.
  pure function planned_states(controls) result(n)
    type(controls_t), intent(in) :: controls
    integer :: n

    n = chunks_per_table
    associate (plot => controls%output%plot)
      if (plot%curve == 0 .and. plot%dt > 0.0_wp) &
        n = int(min(controls%end_time/plot%dt, real(most_planned, wp))) + 3
    end associate
  end function planned_states

  !> States that share a chunk of a field: the planned ones fit into one table of chunks, and the
  !> chunks of a small mesh are no crumbs.
  pure function states_per_chunk(n_row, n_planned) result(n)
    integer, intent(in) :: n_row       !! nodes or elements
    integer, intent(in) :: n_planned   !! states
    integer :: n
    integer(long) :: state_size

    state_size = 8_long*3*max(n_row, 1)
    n = int(min(int(n_planned, long), small_chunk/state_size + 1))
    n = max(n, (n_planned + chunks_per_table - 1)/chunks_per_table)
    n = int(max(1_long, min(int(n, long), large_chunk/state_size)))
  end function states_per_chunk

  !> Make the HDF5 file. What keeps it whole at every instant: no chunk waits in a cache; a table of
  !> chunks lies within a page, so that it changes with one write; tables of groups are small, so
  !> that all of Steps lies within a page.
  subroutine create_file(file, error)
    type(results_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(out) :: error
    integer(hid_t) :: creation, access
    integer :: status(8)

    call refuse_name(file%path, error)
    if (.not. allocated(error)) call refuse_name(file%path//unfinished, error)
    if (allocated(error)) return
    call remove_file(file%path//unfinished, error)
    if (allocated(error)) return
    call open_library(status(1))
    call h5pcreate_f(H5P_FILE_CREATE_F, creation, status(2))
    call h5pset_sym_k_f(creation, 4, 4, status(3))
    call h5pcreate_f(H5P_FILE_ACCESS_F, access, status(4))
    call h5pset_cache_f(access, 0, 0_size_t, 0_size_t, 0.0, status(5))
    call h5pset_alignment_f(access, table_size, page_size, status(6))
    call h5pset_meta_block_size_f(access, 4*page_size, status(7))
    call h5fcreate_f(file%path//unfinished, H5F_ACC_TRUNC_F, file%id, status(8), creation, access)
    if (minval(status) < 0) then
      file%id = -1
      call raise(error, 'cannot write '//file%path//' (no directory, no permission or no space)', &
        status_files)
    end if
    call h5pclose_f(creation, status(1))
    call h5pclose_f(access, status(2))
  end subroutine create_file

  !> Refuse a name under which something else than a file stands.
  subroutine refuse_name(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error

    if (len(what_hinders(path)) > 0) call raise(error, 'cannot write '//path//': ' &
      //what_hinders(path), status_files)
  end subroutine refuse_name

  !> Make the arrays of points and fields.
  subroutine create_fields(file, group, mesh, n_planned, error)
    type(results_file_t), intent(inout) :: file
    integer(hid_t), intent(in) :: group                !! the open group /VTKHDF
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: n_planned                   !! states
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: name
    integer :: i, point_rows, cell_rows

    point_rows = mesh%n_node*states_per_chunk(mesh%n_node, n_planned)
    cell_rows = mesh%n_element*states_per_chunk(2*mesh%n_element, n_planned)
    call make_group(group, 'PointData', error)
    call make_group(group, 'CellData', error)
    do i = 1, file%n_point_field
      name = trim(point_names(i))
      if (i > 1) name = 'PointData/'//name
      call create_growing(file%id, name, as_real, point_columns(i), point_rows, &
        file%point_fields(i), error)
      call link_growing(file%point_fields(i), group, name, error)
    end do
    do i = 1, size(file%cells)
      name = 'CellData/'//trim(cell_names(file%cells(i)))
      call create_growing(file%id, name, as_real, cell_columns(file%cells(i)), cell_rows, &
        file%cell_fields(i), error)
      call link_growing(file%cell_fields(i), group, name, error)
    end do
  end subroutine create_fields

  !> Make the group Steps with its arrays and the attribute NSteps, which stays open. Arrays of
  !> equal content are one dataset with many names. The five headers and the attribute are made in
  !> one go before anything is linked: so they lie side by side within the first page of the file
  !> and HDF5 brings them out with one write, which is what makes the appearance of a state atomic.
  subroutine create_steps(file, group, n_planned, error)
    type(results_file_t), intent(inout) :: file
    integer(hid_t), intent(in) :: group                !! the open group /VTKHDF
    integer, intent(in) :: n_planned                   !! states
    type(error_t), allocatable, intent(inout) :: error
    integer :: i, content

    call make_group(group, 'Steps', error)
    do i = 1, n_step_array
      content = merge(as_real, as_index, i == step_values)
      call create_growing(file%id, 'Steps', content, 0, max(least_step_rows, 2*n_planned), &
        file%steps(i), error)
    end do
    call create_n_steps(file, group, error)
    call make_group(group, 'Steps/PointDataOffsets', error)
    call make_group(group, 'Steps/CellDataOffsets', error)
    call link_growing(file%steps(step_values), group, 'Steps/Values', error)
    call link_growing(file%steps(step_ones), group, 'Steps/NumberOfParts', error)
    call link_growing(file%steps(step_zeros), group, 'Steps/PartOffsets', error)
    call link_growing(file%steps(step_zeros), group, 'Steps/CellOffsets', error)
    call link_growing(file%steps(step_zeros), group, 'Steps/ConnectivityIdOffsets', error)
    call link_growing(file%steps(step_zeros), group, 'Steps/PointDataOffsets/node_id', error)
    call link_growing(file%steps(step_zeros), group, 'Steps/CellDataOffsets/element_id', error)
    call link_growing(file%steps(step_zeros), group, 'Steps/CellDataOffsets/part_id', error)
    call link_growing(file%steps(step_points), group, 'Steps/PointOffsets', error)
    do i = 2, file%n_point_field
      call link_growing(file%steps(step_points), group, &
        'Steps/PointDataOffsets/'//trim(point_names(i)), error)
    end do
    do i = 1, size(file%cells)
      call link_growing(file%steps(step_cells), group, &
        'Steps/CellDataOffsets/'//trim(cell_names(file%cells(i))), error)
    end do
  end subroutine create_steps

  !> Make the attribute NSteps of the group Steps, zero, and keep it open.
  subroutine create_n_steps(file, group, error)
    type(results_file_t), intent(inout) :: file
    integer(hid_t), intent(in) :: group                !! the open group /VTKHDF
    type(error_t), allocatable, intent(inout) :: error
    integer(hid_t) :: steps, space
    integer(long), target :: zero
    integer :: status(6)

    if (allocated(error)) return
    zero = 0
    call h5gopen_f(group, 'Steps', steps, status(1))
    call h5screate_f(H5S_SCALAR_F, space, status(2))
    call h5acreate_f(steps, 'NSteps', H5T_STD_I64LE, space, file%n_steps, status(3))
    call h5awrite_f(file%n_steps, h5kind_to_type(long, H5_INTEGER_KIND), c_loc(zero), status(4))
    call h5sclose_f(space, status(5))
    call h5gclose_f(steps, status(6))
    call check_status(minval(status), 'Steps', error)
  end subroutine create_n_steps

end module results_arrays_m
