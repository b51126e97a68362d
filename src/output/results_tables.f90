! SPDX-License-Identifier: MIT
!> The parts of the results file that are written once: mesh and ids, in deck order; what is known
!> of the run; the histories.
module results_tables_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use, intrinsic :: iso_fortran_env, only : int8
  use archive_m, only : archive_t
  use kinds_m, only : wp, long
  use history_file_m, only : histories_t, kind_real
  use history_tables_m, only : history_tables, n_table
  use hdf5_writing_m, only : text_attribute, write_text
  use mesh_m, only : mesh_t
  use model_m, only : model_t
  use text_m, only : text_of, utf8_length
  use visitor_m, only : as_bytes, item_t
  implicit none
  private
  public :: run_info_t, write_mesh, write_run, write_histories, deck_order, deck_nodes, &
    cell_nodes, cell_starts, utf8_text

  !> VTK's numbers of the cell types.
  integer(int8), parameter :: vtk_triangle = 5, vtk_quad = 9

  !> What the file says of the run.
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

  !> Index of the node that came k-th in the deck; the order of the mesh when it was not renumbered.
  pure function deck_order(mesh) result(order)
    type(mesh_t), intent(in) :: mesh
    integer :: order(mesh%n_node)

    order = deck_nodes(mesh, 1, mesh%n_node)
  end function deck_order

  !> The same of `n` nodes from the k-th on.
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

  !> Where the nodes of each cell start in the list of `cell_nodes`, from zero, and its length at
  !> the end. A triangle repeats its third node in the mesh and has three entries in the list.
  pure function cell_starts(element_nodes) result(starts)
    integer, intent(in) :: element_nodes(:, :)   !! (4, n_element)
    integer :: starts(size(element_nodes, 2) + 1)
    integer :: i

    starts(1) = 0
    do i = 1, size(element_nodes, 2)
      starts(i + 1) = starts(i) + merge(3, 4, element_nodes(4, i) == element_nodes(3, i))
    end do
  end function cell_starts

  !> Points of all cells, one cell after the other, counted from zero in the order of the deck.
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

  !> The text in UTF-8: characters of UTF-8 pass, and a byte that belongs to none is taken for
  !> Latin-1 (decks are either).
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

  !> Write all tables below /history, which is there, one dataset a column; nothing of one that was
  !> never planned. Columns that no CSV file has go below /dyna.
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

end module results_tables_m
