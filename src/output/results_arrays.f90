! SPDX-License-Identifier: MIT
!> The HDF5 results file, its growing arrays and their layout, and data written once: mesh and ids
!> in deck order, run data, histories.
!>
!> The layout keeps the file readable whenever the process is killed. A viewer relies on the number
!> of rows below Steps and the attribute NSteps: their headers lie within one page, so that HDF5
!> changes all of them with one write. All other data of a state reach the file before, in rows that
!> are not yet counted; chunk tables lie within a page each and do not split as long as no more
!> states come than planned.
module results_arrays_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use, intrinsic :: iso_fortran_env, only : int8
  use archive_m, only : archive_t
  use hdf5, only : hid_t, hsize_t, size_t, H5P_FILE_CREATE_F, H5P_FILE_ACCESS_F, H5F_ACC_TRUNC_F, &
    H5S_SCALAR_F, H5T_STD_I64LE, h5pcreate_f, h5pclose_f, h5pset_sym_k_f, h5pset_cache_f, &
    h5pset_alignment_f, h5pset_meta_block_size_f, h5fcreate_f, h5screate_f, h5sclose_f, &
    h5acreate_by_name_f, h5awrite_f
  use kinds_m, only : wp, long
  use errors_m, only : error_t, raise, status_files
  use files_m, only : file_facts_t, write_obstacle, remove_file, unfinished
  use mesh_m, only : mesh_t
  use controls_m, only : controls_t
  use hdf5_writing_m, only : open_library, growing_t, as_real, as_index, create_growing, &
    link_growing, make_group, check_status, memory_type, text_attribute, write_text
  use history_file_m, only : histories_t, kind_real
  use history_tables_m, only : history_tables, n_table
  use model_m, only : model_t
  use text_m, only : text_of, utf8_length
  use visitor_m, only : as_bytes, item_t
  implicit none
  private
  public :: results_file_t, create_file, create_steps, create_fields, planned_states, &
    states_per_chunk, block_rows, fields, n_step_array, step_values, step_points, step_ones, &
    run_info_t, write_mesh, write_run, write_histories, deck_order, deck_nodes, cell_nodes, &
    cell_starts, utf8_text

  !> Condition for a field in the file: none; friction or ties; axisymmetric; a material with
  !> temperature; erosion; plane stress; errors asked for.
  integer, parameter :: of_all = 1, of_shear = 2, of_axisym = 3, of_heat = 4, of_erosion = 5, &
    of_sheet = 6, of_error = 7

  !> A field of points or cells.
  type :: field_t
    character(26) :: name     !! below /VTKHDF
    integer :: n_column       !! 0: one number
    logical :: of_cells
    integer :: needs          !! one of the conditions above
  end type field_t

  !> Fields, in the order in which a state writes them.
  integer, parameter :: n_field = 19
  !> Fields, in the order of writing.
  type(field_t), parameter :: fields(n_field) = [ &
    field_t('Points', 3, .false., of_all), &
    field_t('PointData/displacement', 3, .false., of_all), &
    field_t('PointData/velocity', 3, .false., of_all), &
    field_t('PointData/contact_force', 3, .false., of_all), &
    field_t('PointData/contact_pressure', 0, .false., of_all), &
    field_t('PointData/gap', 0, .false., of_all), &
    field_t('PointData/contact_traction', 0, .false., of_shear), &
    field_t('PointData/contact_slip', 0, .false., of_shear), &
    field_t('PointData/contact_state', 0, .false., of_shear), &
    field_t('CellData/stress', 6, .true., of_all), &
    field_t('CellData/plastic_strain', 0, .true., of_all), &
    field_t('CellData/pressure', 0, .true., of_all), &
    field_t('CellData/mises', 0, .true., of_all), &
    field_t('CellData/hoop_strain', 0, .true., of_axisym), &
    field_t('CellData/thickness_strain', 0, .true., of_sheet), &
    field_t('CellData/error', 0, .true., of_error), &
    field_t('CellData/temperature', 0, .true., of_heat), &
    field_t('CellData/damage', 0, .true., of_heat), &
    field_t('CellData/eroded', 0, .true., of_erosion)]
  !> Arrays below Steps: times, first point of a state, first cell, zeros and ones.
  integer, parameter :: n_step_array = 5, step_values = 1, step_points = 2, step_cells = 3, &
    step_zeros = 4, step_ones = 5

  !> Chunks of the planned states in one HDF5 table of 64, and the least size of a table.
  integer, parameter :: chunks_per_table = 52
  integer(hsize_t), parameter :: table_size = 2048, page_size = 4096
  !> Bytes that a chunk reaches where the number of states allows, and the limit of HDF5.
  integer(long), parameter :: small_chunk = 65536, large_chunk = 2_long**32 - 1
  !> Least rows per chunk of the arrays below Steps: a row that needs a new chunk takes several
  !> writes.
  integer, parameter :: least_step_rows = 1024
  !> Rows of a field per write, which stay in the cache.
  integer, parameter :: block_rows = 16384
  !> Largest number of planned states.
  integer, parameter :: most_planned = 4096

  !> An open results file.
  type :: results_file_t
    character(:), allocatable :: path
    logical :: is_named = .false.               !! it has its final name
    logical :: is_broken = .false.              !! a write failed: left as it is, never closed
    type(file_facts_t) :: facts                 !! state of the file after the last flush
    integer(hid_t) :: id = -1                   !! open file
    integer(hid_t) :: n_steps = -1              !! open attribute NSteps
    integer(long) :: n_state = 0                !! states in the file
    real(wp), allocatable :: times(:)           !! (n_state or more) their times
    integer, allocatable :: which(:)            !! fields of this run
    type(growing_t) :: fields(n_field)
    type(growing_t) :: steps(n_step_array)
    real(wp), allocatable :: rows(:)            !! (3*rows, at most block_rows) of one write
  end type results_file_t

  !> VTK's numbers of the cell types.
  integer(int8), parameter :: vtk_triangle = 5, vtk_quad = 9

  !> Data of the run.
  type :: run_info_t
    character(:), allocatable :: title          !! of the deck
    character(:), allocatable :: deck           !! file name of the deck
    character(:), allocatable :: version        !! of the program
    character(:), allocatable :: build          !! compiler and options
    character(:), allocatable :: options        !! command line
    character(:), allocatable :: source         !! commit that the program was built from
    character(:), allocatable :: machine        !! processor
    character(:), allocatable :: checksum       !! CRC-32 of the deck as run
    character(:), allocatable :: effective_deck !! the deck as run
  end type run_info_t

contains

  !> Number of states that the deck asks for, estimated for a varying interval. It sizes the chunks;
  !> more states fit.
  pure function planned_states(controls) result(n)
    type(controls_t), intent(in) :: controls
    integer :: n

    n = chunks_per_table
    associate (plot => controls%output%plot)
      if (plot%curve == 0 .and. plot%dt > 0.0_wp) &
        n = int(min(controls%end_time/plot%dt, real(most_planned, wp))) + 3
    end associate
  end function planned_states

  !> States per chunk of a field: the planned ones fit into one chunk table, and chunks of a small
  !> mesh are not too small.
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

  !> Create the HDF5 file. To stay valid at every instant no chunk is cached, a chunk table lies
  !> within a page and changes with one write, and group tables are small, so that all of Steps lies
  !> within a page.
  subroutine create_file(file, error)
    type(results_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: path
    integer(hid_t) :: creation, access
    integer :: status(8), i

    do i = 1, 2
      path = file%path//repeat(unfinished, i - 1)
      if (len(write_obstacle(path)) > 0) then
        call raise(error, 'cannot write '//path//': '//write_obstacle(path), status_files)
        return
      end if
    end do
    call remove_file(path, error)
    if (allocated(error)) return
    call open_library(status(1))
    call h5pcreate_f(H5P_FILE_CREATE_F, creation, status(2))
    call h5pset_sym_k_f(creation, 4, 4, status(3))
    call h5pcreate_f(H5P_FILE_ACCESS_F, access, status(4))
    call h5pset_cache_f(access, 0, 0_size_t, 0_size_t, 0.0, status(5))
    call h5pset_alignment_f(access, table_size, page_size, status(6))
    call h5pset_meta_block_size_f(access, 4*page_size, status(7))
    call h5fcreate_f(path, H5F_ACC_TRUNC_F, file%id, status(8), creation, access)
    if (minval(status) < 0) then
      file%id = -1
      call raise(error, 'cannot write '//file%path//' (no directory, no permission or no space)', &
        status_files)
    end if
    call h5pclose_f(creation, status(1))
    call h5pclose_f(access, status(2))
  end subroutine create_file

  !> Create the arrays of points and fields.
  subroutine create_fields(file, tree, mesh, n_planned)
    type(results_file_t), intent(inout) :: file
    type(archive_t), intent(inout) :: tree             !! the file in the group /VTKHDF
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: n_planned                   !! states
    integer :: k, i, chunk_rows

    call make_group(file%id, tree%folder//'PointData', tree%error)
    call make_group(file%id, tree%folder//'CellData', tree%error)
    do k = 1, size(file%which)
      i = file%which(k)
      chunk_rows = mesh%n_node*states_per_chunk(mesh%n_node, n_planned)
      if (fields(i)%of_cells) &
        chunk_rows = mesh%n_element*states_per_chunk(2*mesh%n_element, n_planned)
      call create_growing(file%id, trim(fields(i)%name), as_real, fields(i)%n_column, chunk_rows, &
        file%fields(i), tree%error)
      call link_growing(file%fields(i), file%id, tree%folder//trim(fields(i)%name), tree%error)
    end do
  end subroutine create_fields

  !> Create the group Steps with its arrays and the attribute NSteps, which stays open. Equal arrays
  !> are one dataset with several names. The five headers and the attribute are created before
  !> anything is linked, so that they lie within the first page and HDF5 writes them at once: a
  !> state appears atomically.
  subroutine create_steps(file, tree, n_planned)
    type(results_file_t), intent(inout) :: file
    type(archive_t), intent(inout) :: tree             !! the file in the group /VTKHDF
    integer, intent(in) :: n_planned                   !! states
    character(26), parameter :: names(9) = [character(26) :: 'Values', 'NumberOfParts', &
      'PartOffsets', 'CellOffsets', 'ConnectivityIdOffsets', 'PointDataOffsets/node_id', &
      'CellDataOffsets/element_id', 'CellDataOffsets/part_id', 'PointOffsets']
    integer, parameter :: arrays(9) = [step_values, step_ones, step_zeros, step_zeros, &
      step_zeros, step_zeros, step_zeros, step_zeros, step_points]
    character(len(fields%name)) :: name
    integer(hid_t) :: space
    integer(long), target :: zero
    integer :: status(4), i, content

    call tree%enter('Steps')
    do i = 1, n_step_array
      content = merge(as_real, as_index, i == step_values)
      call create_growing(file%id, 'Steps', content, 0, max(least_step_rows, 2*n_planned), &
        file%steps(i), tree%error)
    end do
    if (.not. allocated(tree%error)) then
      zero = 0
      call h5screate_f(H5S_SCALAR_F, space, status(1))
      call h5acreate_by_name_f(file%id, 'VTKHDF/Steps', 'NSteps', H5T_STD_I64LE, space, &
        file%n_steps, status(2))
      call h5awrite_f(file%n_steps, memory_type(as_index), c_loc(zero), status(3))
      call h5sclose_f(space, status(4))
      call check_status(minval(status), 'Steps', tree%error)
    end if
    call make_group(file%id, tree%folder//'PointDataOffsets', tree%error)
    call make_group(file%id, tree%folder//'CellDataOffsets', tree%error)
    do i = 1, size(names)
      call link_growing(file%steps(arrays(i)), file%id, tree%folder//trim(names(i)), tree%error)
    end do
    do i = 2, size(file%which)
      name = fields(file%which(i))%name
      content = merge(step_cells, step_points, fields(file%which(i))%of_cells)
      call link_growing(file%steps(content), file%id, tree%folder//name(:index(name, '/') - 1) &
        //'Offsets'//trim(name(index(name, '/'):)), tree%error)
    end do
    call tree%leave()
  end subroutine create_steps

  !> Write counts, connectivity, cell types and the ids of nodes, elements and parts.
  subroutine write_mesh(file, model)
    type(archive_t), intent(inout) :: file             !! in the group /VTKHDF
    type(model_t), intent(in) :: model
    integer, allocatable :: starts(:), nodes(:), ids(:)
    integer(int8), allocatable, target :: kinds(:)
    integer :: n_cell

    n_cell = model%mesh%n_element
    starts = cell_starts(model%mesh%element_nodes)
    nodes = cell_nodes(model%mesh)
    allocate (kinds(n_cell))
    kinds = merge(vtk_triangle, vtk_quad, starts(2:) - starts(:n_cell) == 3)
    call write_count('NumberOfPoints', model%mesh%n_node)
    call write_count('NumberOfCells', n_cell)
    call write_count('NumberOfConnectivityIds', size(nodes))
    call file%visit('Connectivity', nodes)
    call file%visit('Offsets', starts)
    call file%pass(item_t('Types', as_bytes, 1, [n_cell, 1]), c_loc(kinds))
    ids = model%mesh%node_id(deck_order(model%mesh))
    call file%visit('PointData/node_id', ids)
    ids = model%mesh%element_id
    call file%visit('CellData/element_id', ids)
    ids = model%parts(model%mesh%element_part)%id
    call file%visit('CellData/part_id', ids)

  contains

    !> Write a dataset of one number.
    subroutine write_count(name, count)
      character(*), intent(in) :: name
      integer, intent(in) :: count
      integer(long) :: number

      number = count
      call file%visit(name, number, 0_long, '')
    end subroutine write_count

  end subroutine write_mesh

  !> Node in deck position k; the mesh order if it was not renumbered.
  pure function deck_order(mesh) result(order)
    type(mesh_t), intent(in) :: mesh
    integer :: order(mesh%n_node)

    order = deck_nodes(mesh, 1, mesh%n_node)
  end function deck_order

  !> Nodes in the `n` deck positions from `k` on.
  pure function deck_nodes(mesh, k, n) result(nodes)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: k, n
    integer :: nodes(n)
    integer :: i

    if (allocated(mesh%deck_node)) then
      nodes = mesh%deck_node(k:k + n - 1)
    else
      nodes = [(i, i=k, k + n - 1)]
    end if
  end function deck_nodes

  !> Start of the nodes of each cell in the list of `cell_nodes`, from zero, and its length at the
  !> end. A triangle repeats its third node in the mesh and has three entries in the list.
  pure function cell_starts(element_nodes) result(starts)
    integer, intent(in) :: element_nodes(:, :)   !! (4, n_element)
    integer :: starts(size(element_nodes, 2) + 1)
    integer :: i

    starts(1) = 0
    do i = 1, size(element_nodes, 2)
      starts(i + 1) = starts(i) + merge(3, 4, element_nodes(4, i) == element_nodes(3, i))
    end do
  end function cell_starts

  !> Points of all cells, cell by cell, counted from zero in deck order.
  pure function cell_nodes(mesh) result(points)
    type(mesh_t), intent(in) :: mesh
    integer, allocatable :: points(:)
    integer :: starts(mesh%n_element + 1), point_of_node(mesh%n_node)
    integer :: i, n

    point_of_node(deck_order(mesh)) = [(i - 1, i=1, mesh%n_node)]
    starts = cell_starts(mesh%element_nodes)
    allocate (points(starts(mesh%n_element + 1)))
    do i = 1, mesh%n_element
      n = starts(i + 1) - starts(i)
      points(starts(i) + 1:starts(i + 1)) = point_of_node(mesh%element_nodes(:n, i))
    end do
  end function cell_nodes

  !> Write the group /run.
  subroutine write_run(file, run_info)
    type(archive_t), intent(inout) :: file             !! open, at its root
    type(run_info_t), intent(in) :: run_info

    call file%enter('run')
    call write_known('deck', run_info%deck)
    call write_known('title', run_info%title)
    call write_known('version', run_info%version)
    call write_known('build', run_info%build)
    call write_known('options', run_info%options)
    call write_known('source', run_info%source)
    call write_known('machine', run_info%machine)
    call write_known('effective_deck_crc32', run_info%checksum)
    if (allocated(run_info%effective_deck)) &
      call write_text(file%id, 'run/effective_deck', run_info%effective_deck, file%error)
    call file%leave()

  contains

    !> Write a text that may be missing as an attribute.
    subroutine write_known(name, text)
      character(*), intent(in) :: name
      character(:), allocatable, intent(in) :: text

      call text_attribute(file%id, 'run', name, utf8_text(text_of(text)), .false., file%error)
    end subroutine write_known

  end subroutine write_run

  !> The text in UTF-8; bytes that are no UTF-8 are read as Latin-1.
  pure function utf8_text(text) result(utf8)
    character(*), intent(in) :: text
    character(:), allocatable :: utf8
    character(:), allocatable :: buffer
    integer :: i, n, n_byte

    allocate (character(2*len(text)) :: buffer)
    n_byte = 0
    i = 1
    do while (i <= len(text))
      n = utf8_length(text(i:))
      if (n > 0) then
        buffer(n_byte + 1:n_byte + n) = text(i:i + n - 1)
      else
        n = 2
        buffer(n_byte + 1:n_byte + 2) = char(192 + ichar(text(i:i))/64)//char(128 &
          + mod(ichar(text(i:i)), 64))
        i = i - 1
      end if
      n_byte = n_byte + n
      i = i + n
    end do
    utf8 = buffer(:n_byte)
  end function utf8_text

  !> Write all planned tables below /history, one dataset per column; columns without CSV go below
  !> /dyna.
  subroutine write_histories(file, histories)
    type(archive_t), intent(inout) :: file             !! open, at its root
    type(histories_t), intent(in) :: histories
    real(wp), allocatable :: reals(:)
    integer, allocatable :: integers(:)
    character(:), allocatable :: name
    integer :: k, i

    call file%enter('dyna')
    do k = 1, n_table
      associate (table => histories%tables(k))
        if (.not. allocated(table%names)) cycle
        file%folder = 'history/'
        call file%enter(trim(history_tables(k)%name))
        do i = 1, size(table%names)
          if (i == table%n_csv + 1) then
            file%folder = 'dyna/'
            call file%enter(trim(history_tables(k)%name))
          end if
          name = trim(table%names(i))
          reals = table%values(i, :table%n_row)
          if (table%kinds(i) == kind_real) then
            call file%visit(name, reals)
          else
            integers = nint(reals)
            call file%visit(name, integers)
          end if
        end do
      end associate
    end do
  end subroutine write_histories

end module results_arrays_m
