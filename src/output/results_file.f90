! SPDX-License-Identifier: MIT
!> The results file `<job>.vtkhdf`: states that VTK, ParaView and PyVista read (VTKHDF 2.0, transient
!> unstructured grid), the histories and what is known of the run. The layout is described in
!> doc/results.md; this file, hdf5_writing.f90 and the reader of the Python tools are the only
!> places that know it.
!>
!> The mesh is stored once; each state appends rows to the arrays. What a viewer trusts is the
!> number of rows below Steps and the attribute NSteps, so these change last, by themselves, after all else of
!> the state has reached the file: whenever the process is killed, the file opens with the states before.
module results_file_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use hdf5
  use kinds_m, only : wp, long
  use errors_m, only : error_t, raise, status_files
  use files_m, only : remove_file, rename_file
  use model_m, only : model_t
  use controls_m, only : controls_t
  use snapshot_m, only : snapshot_t
  use history_file_m, only : histories_t, n_table
  use results_mesh_m, only : write_mesh, deck_order
  use csv_table_m, only : csv_table_t, column_name, n_columns, kind_real
  use hdf5_writing_m, only : growing_t, as_real, as_integer, as_index, create_growing, &
    link_growing, append_rows, close_growing, make_group, write_rows, &
    allow_reading, write_string_attribute, write_index_attribute, write_text, check_status
  implicit none
  private
  public :: results_file_t, run_info_t, open_results, append_state, finish_results


  !> Fields, in the order in which `append_state` writes them, and their numbers of columns.
  integer, parameter :: n_point_field = 6, n_cell_field = 4
  character(16), parameter :: point_names(n_point_field) = [character(16) :: 'Points', &
    'displacement', 'velocity', 'contact_force', 'contact_pressure', 'gap']
  integer, parameter :: point_columns(n_point_field) = [3, 3, 3, 3, 0, 0]
  character(16), parameter :: cell_names(n_cell_field) = [character(16) :: 'stress', &
    'plastic_strain', 'pressure', 'mises']
  integer, parameter :: cell_columns(n_cell_field) = [6, 0, 0, 0]
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
  !> Bound on the number of states that is planned for.
  integer, parameter :: most_planned = 4096
  !> Behind the name of a file without a state.
  character(*), parameter :: unfinished = '.part'

  !> What the file says of the run.
  type :: run_info_t
    character(:), allocatable :: title          !! of the deck
    character(:), allocatable :: deck           !! file name of the deck
    character(:), allocatable :: version        !! of the program
    character(:), allocatable :: build          !! compiler and options
    character(:), allocatable :: options        !! command line
    character(:), allocatable :: effective_deck !! the deck as run
  end type run_info_t

  !> An open results file.
  type :: results_file_t
    character(:), allocatable :: path
    logical :: is_named = .false.               !! it has its own name
    integer(hid_t) :: id = -1                   !! open file
    integer(hid_t) :: n_steps = -1              !! open attribute NSteps
    integer(long) :: n_state = 0                !! states in the file
    type(growing_t) :: point_fields(n_point_field)
    type(growing_t) :: cell_fields(n_cell_field)
    type(growing_t) :: steps(n_step_array)
    real(wp), allocatable :: point_rows(:, :)   !! (3, n_node) work space
    real(wp), allocatable :: point_values(:)    !! (n_node) work space
    real(wp), allocatable :: cell_rows(:, :)    !! (6, n_element) work space
    real(wp), allocatable :: cell_values(:)     !! (n_element) work space
  end type results_file_t

contains

  !> Make the file with the mesh and without a state. It has its own name from the first state on, and
  !> `<path>.part` before, so that what stands under the name always opens. A file
  !> of that name from an earlier run is removed.
  subroutine open_results(file, path, model, run_info, error)
    type(results_file_t), intent(out) :: file
    character(*), intent(in) :: path
    type(model_t), intent(in) :: model
    type(run_info_t), intent(in) :: run_info
    type(error_t), allocatable, intent(out) :: error
    integer(hid_t) :: group
    integer :: status

    file%path = path
    call remove_file(path, error)
    if (allocated(error)) return
    call create_file(file, error)
    if (allocated(error)) return
    call make_group(file%id, 'VTKHDF', error)
    if (.not. allocated(error)) call h5gopen_f(file%id, 'VTKHDF', group, status)
    call create_steps(file, group, planned_states(model%controls), error)
    call create_fields(file, group, model, error)
    call write_string_attribute(group, 'Type', 'UnstructuredGrid', .true., error)
    call write_index_attribute(group, 'Version', [2_long, 0_long], error)
    call write_mesh(group, model, error)
    call write_run(file%id, run_info, error)
    call make_group(file%id, 'history', error)
    call publish(file, error)
    call h5gclose_f(group, status)
    allocate (file%point_rows(3, model%mesh%n_node), file%cell_rows(6, model%mesh%n_element), &
      source=0.0_wp)
    allocate (file%point_values(model%mesh%n_node), file%cell_values(model%mesh%n_element))
    call name_file(file, error)
  end subroutine open_results

  !> Number of states that the deck asks for; a guess when the interval varies. It only sizes the pieces of
  !> the file: more states fit.
  pure function planned_states(controls) result(n)
    type(controls_t), intent(in) :: controls
    integer :: n

    n = chunks_per_table
    associate (plot => controls%output%plot)
      if (plot%curve == 0 .and. plot%dt > 0.0_wp) &
        n = int(min(controls%end_time/plot%dt, real(most_planned, wp))) + 3
    end associate
  end function planned_states

  !> States that share a chunk of a field: the planned ones fit into one table of chunks, and the chunks of
  !> a small mesh are no crumbs.
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
  !> chunks lies within a page, so that it changes with one write; tables of groups are small, so that
  !> all of Steps lies within a page.
  subroutine create_file(file, error)
    type(results_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(out) :: error
    integer(hid_t) :: creation, access
    integer :: status(9)

    call allow_reading()
    call h5open_f(status(1))
    call h5eset_auto_f(0, status(2)) ! statuses become errors here; HDF5 itself stays quiet
    call h5pcreate_f(H5P_FILE_CREATE_F, creation, status(3))
    call h5pset_sym_k_f(creation, 4, 4, status(4))
    call h5pcreate_f(H5P_FILE_ACCESS_F, access, status(5))
    call h5pset_cache_f(access, 0, 0_size_t, 0_size_t, 0.0, status(6))
    call h5pset_alignment_f(access, table_size, page_size, status(7))
    call h5pset_meta_block_size_f(access, 4*page_size, status(8))
    call h5fcreate_f(file%path//unfinished, H5F_ACC_TRUNC_F, file%id, status(9), creation, access)
    if (minval(status) < 0) then
      file%id = -1
      call raise(error, 'cannot write '//file%path//' (no directory, no permission or no space)', &
        status_files)
    end if
    call h5pclose_f(creation, status(1))
    call h5pclose_f(access, status(2))
  end subroutine create_file

  !> Make the arrays of points and fields.
  subroutine create_fields(file, group, model, error)
    type(results_file_t), intent(inout) :: file
    integer(hid_t), intent(in) :: group                !! the open group /VTKHDF
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: name
    integer :: i, n_planned, point_rows, cell_rows

    n_planned = planned_states(model%controls)
    point_rows = model%mesh%n_node*states_per_chunk(model%mesh%n_node, n_planned)
    cell_rows = model%mesh%n_element*states_per_chunk(2*model%mesh%n_element, n_planned)
    call make_group(group, 'PointData', error)
    call make_group(group, 'CellData', error)
    do i = 1, n_point_field
      name = trim(point_names(i))
      if (i > 1) name = 'PointData/'//name
      call create_growing(file%id, name, as_real, point_columns(i), point_rows, &
        file%point_fields(i), error)
      call link_growing(file%point_fields(i), group, name, error)
    end do
    do i = 1, n_cell_field
      name = 'CellData/'//trim(cell_names(i))
      call create_growing(file%id, name, as_real, cell_columns(i), cell_rows, &
        file%cell_fields(i), error)
      call link_growing(file%cell_fields(i), group, name, error)
    end do
  end subroutine create_fields

  !> Make the group Steps with its arrays and the attribute NSteps, which stays open. Arrays of equal
  !> content are one dataset with many names. The five headers and the attribute are made
  !> in one go before anything is linked: so they lie side by side within the first page of the file and
  !> HDF5 brings them out with one write, which is what makes the appearance of a state atomic.
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
    do i = 2, n_point_field
      call link_growing(file%steps(step_points), group, &
        'Steps/PointDataOffsets/'//trim(point_names(i)), error)
    end do
    do i = 1, n_cell_field
      call link_growing(file%steps(step_cells), group, &
        'Steps/CellDataOffsets/'//trim(cell_names(i)), error)
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

  !> Write the group /run.
  subroutine write_run(id, run_info, error)
    integer(hid_t), intent(in) :: id                   !! open file
    type(run_info_t), intent(in) :: run_info
    type(error_t), allocatable, intent(inout) :: error
    integer(hid_t) :: group
    integer :: status

    call make_group(id, 'run', error)
    if (allocated(error)) return
    call h5gopen_f(id, 'run', group, status)
    call write_string_attribute(group, 'deck', text_of(run_info%deck), .false., error)
    call write_string_attribute(group, 'title', text_of(run_info%title), .false., error)
    call write_string_attribute(group, 'version', text_of(run_info%version), .false., error)
    call write_string_attribute(group, 'build', text_of(run_info%build), .false., error)
    call write_string_attribute(group, 'options', text_of(run_info%options), .false., error)
    call write_text(group, 'effective_deck', text_of(run_info%effective_deck), error)
    call h5gclose_f(group, status)
  end subroutine write_run

  !> A text that may be missing.
  pure function text_of(text) result(known)
    character(:), allocatable, intent(in) :: text
    character(:), allocatable :: known

    known = ''
    if (allocated(text)) known = text
  end function text_of

  !> Append one state and bring it into the file whole.
  subroutine append_state(file, model, snapshot, error)
    type(results_file_t), intent(inout), target :: file
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    type(error_t), allocatable, intent(out) :: error
    real(wp), target :: time(1)
    integer(long), target :: numbers(4)
    integer :: i

    call append_point_fields(file, model, snapshot, error)
    call append_cell_fields(file, snapshot, error)
    call flush_file(file, error)
    time = snapshot%time
    numbers = [file%n_state*model%mesh%n_node, file%n_state*model%mesh%n_element, 0_long, 1_long]
    call append_rows(file%steps(step_values), 1, c_loc(time), error)
    do i = step_points, step_ones
      call append_rows(file%steps(i), 1, c_loc(numbers(i - 1)), error)
    end do
    if (.not. allocated(error)) file%n_state = file%n_state + 1
    call publish(file, error)
    if (file%n_state == 1) call take_name(file, error)
    call name_file(file, error)
  end subroutine append_state

  !> Give the file its own name.
  subroutine take_name(file, error)
    type(results_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error) .or. file%is_named) return
    call rename_file(file%path//unfinished, file%path, error)
    file%is_named = .not. allocated(error)
  end subroutine take_name

  !> Append the fields of the nodes, in deck order.
  subroutine append_point_fields(file, model, snapshot, error)
    type(results_file_t), intent(inout), target :: file
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    type(error_t), allocatable, intent(inout) :: error
    integer :: order(model%mesh%n_node)

    order = deck_order(model%mesh)
    file%point_rows(:2, :) = model%mesh%coordinates(:, order) + snapshot%displacement(:, order)
    call append_rows(file%point_fields(1), size(order), c_loc(file%point_rows), error)
    call append_vectors(2, snapshot%displacement)
    call append_vectors(3, snapshot%velocity)
    call append_vectors(4, snapshot%contact_force)
    call append_scalars(5, snapshot%contact_pressure)
    call append_scalars(6, snapshot%gap)

  contains

    subroutine append_vectors(i_field, vectors)
      integer, intent(in) :: i_field
      real(wp), allocatable, intent(in) :: vectors(:, :)   !! zero where missing

      file%point_rows(:2, :) = 0.0_wp
      if (allocated(vectors)) file%point_rows(:2, :) = vectors(:, order)
      call append_rows(file%point_fields(i_field), size(order), c_loc(file%point_rows), error)
    end subroutine append_vectors

    subroutine append_scalars(i_field, values)
      integer, intent(in) :: i_field
      real(wp), allocatable, intent(in) :: values(:)   !! zero where missing

      file%point_values = 0.0_wp
      if (allocated(values)) file%point_values = values(order)
      call append_rows(file%point_fields(i_field), size(order), c_loc(file%point_values), error)
    end subroutine append_scalars

  end subroutine append_point_fields

  !> Append the fields of the elements: stress (xx yy zz xy yz xz), plastic strain, pressure, mises.
  subroutine append_cell_fields(file, snapshot, error)
    type(results_file_t), intent(inout), target :: file
    type(snapshot_t), intent(in) :: snapshot
    type(error_t), allocatable, intent(inout) :: error
    integer :: n

    n = size(file%cell_values)
    file%cell_rows(:4, :) = snapshot%stress
    call append_rows(file%cell_fields(1), n, c_loc(file%cell_rows), error)
    file%cell_values = 0.0_wp
    if (allocated(snapshot%plastic_strain)) file%cell_values = snapshot%plastic_strain
    call append_rows(file%cell_fields(2), n, c_loc(file%cell_values), error)
    file%cell_values = -sum(snapshot%stress(:3, :), 1)/3.0_wp
    call append_rows(file%cell_fields(3), n, c_loc(file%cell_values), error)
    file%cell_values = mises_stress(snapshot%stress(1, :), snapshot%stress(2, :), &
      snapshot%stress(3, :), snapshot%stress(4, :))
    call append_rows(file%cell_fields(4), n, c_loc(file%cell_values), error)
  end subroutine append_cell_fields

  !> Von Mises stress of a plane-strain state: sqrt(3/2 s:s).
  elemental function mises_stress(xx, yy, zz, xy) result(mises)
    real(wp), intent(in) :: xx, yy, zz, xy   !! Pa
    real(wp) :: mises

    mises = sqrt(0.5_wp*((xx - yy)**2 + (yy - zz)**2 + (zz - xx)**2) + 3.0_wp*xy**2)
  end function mises_stress

  !> Say how many states the file has, and bring that into the file.
  subroutine publish(file, error)
    type(results_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(inout) :: error
    integer(long), target :: number
    integer :: status

    if (allocated(error)) return
    number = file%n_state
    call h5awrite_f(file%n_steps, h5kind_to_type(long, H5_INTEGER_KIND), c_loc(number), status)
    call check_status(status, 'NSteps', error)
    call flush_file(file, error)
  end subroutine publish

  !> Hand all that waits to the system.
  subroutine flush_file(file, error)
    type(results_file_t), intent(in) :: file
    type(error_t), allocatable, intent(inout) :: error
    integer :: status

    if (allocated(error)) return
    call h5fflush_f(file%id, H5F_SCOPE_LOCAL_F, status)
    call check_status(status, 'a state', error)
  end subroutine flush_file

  !> Put the file's name before the message of an error.
  subroutine name_file(file, error)
    type(results_file_t), intent(in) :: file
    type(error_t), allocatable, intent(inout) :: error

    if (allocated(error)) error%message = file%path//': '//error%message
  end subroutine name_file

  !> Write the histories, and close the file; nothing happens when it is not open.
  subroutine finish_results(file, histories, error)
    type(results_file_t), intent(inout) :: file
    type(histories_t), intent(in) :: histories
    type(error_t), allocatable, intent(out) :: error
    integer :: i, status

    if (file%id < 0) return
    do i = 1, n_table
      call write_table(file%id, histories%tables(i), error)
    end do
    call h5aclose_f(file%n_steps, status)
    do i = 1, n_point_field
      call close_growing(file%point_fields(i), error)
    end do
    do i = 1, n_cell_field
      call close_growing(file%cell_fields(i), error)
    end do
    do i = 1, n_step_array
      call close_growing(file%steps(i), error)
    end do
    call h5fclose_f(file%id, status)
    file%id = -1
    call check_status(status, 'the end of the file', error)
    call h5close_f(status)
    call take_name(file, error)
    call name_file(file, error)
  end subroutine finish_results

  !> Write one table below /history, one dataset per column; nothing for one that was never open.
  subroutine write_table(id, table, error)
    integer(hid_t), intent(in) :: id                   !! open file
    type(csv_table_t), intent(in) :: table
    type(error_t), allocatable, intent(inout) :: error
    real(wp), allocatable, target :: reals(:)
    integer, allocatable, target :: integers(:)
    integer :: i

    if (.not. allocated(table%name)) return
    call make_group(id, 'history/'//table%name, error)
    do i = 1, n_columns(table)
      reals = table%values(i, :table%n_row)
      if (table%kinds(i) == kind_real) then
        call write_rows(id, 'history/'//table%name//'/'//column_name(table, i), as_real, &
          size(reals), c_loc(reals), error)
      else
        integers = nint(reals)
        call write_rows(id, 'history/'//table%name//'/'//column_name(table, i), as_integer, &
          size(integers), c_loc(integers), error)
      end if
    end do
  end subroutine write_table

end module results_file_m
