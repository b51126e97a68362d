! SPDX-License-Identifier: MIT
!> One history: its rows, and the CSV file that grows by them (comma between values, no blanks,
!> reals as the shortest decimals that read back as the same numbers). The values are kept: the
!> results file takes them over at the end. A text file in DYNA's layout may grow beside it.
module csv_table_m
  use dyna_text_m, only : dyna_text_t, add_dyna_row
  use errors_m, only : error_t
  use history_tables_m, only : history_tables
  use kinds_m, only : wp
  use text_m, only : real_size, put_real, put_integer
  use text_files_m, only : line_file_t, open_lines, put_lines, keep_up, flush_lines
  use visitor_m, only : visitor_t, any_length
  implicit none
  private
  public :: csv_table_t, plan_table, open_table, add_row, row_text, visit_rows, kind_real, &
    kind_integer, kind_side

  !> Kinds of columns: a real, an integer, a side of an interface (1 = slave, 2 = master).
  integer, parameter :: kind_real = 1, kind_integer = 2, kind_side = 3

  !> One table.
  type :: csv_table_t
    logical :: tells_mass = .false.         !! masses are scaled
    logical, allocatable :: is_kept(:)      !! (columns of `history_tables`) those that this run has
    character(20), allocatable :: names(:)  !! (n_column)
    integer, allocatable :: kinds(:)        !! (n_column) `kind_` of each
    integer :: n_csv = 0                    !! columns of the CSV file, the first ones
    integer :: n_row = 0                    !! rows so far
    real(wp), allocatable :: values(:, :)   !! (n_column, capacity) all rows; integers are exact
    type(line_file_t) :: file               !! rows are taken only while it is open
    type(dyna_text_t) :: text               !! the file in DYNA's layout, where the deck asks for it
  end type csv_table_t

contains

  !> The columns of a table, which has no rows and no file yet.
  subroutine plan_table(table, i_table, tells_mass, erodes)
    type(csv_table_t), intent(out) :: table
    integer, intent(in) :: i_table    !! one of `table_`
    logical, intent(in) :: tells_mass !! masses are scaled
    logical, intent(in) :: erodes     !! elements may leave the mesh
    character(len(history_tables%columns) + 1) :: left
    integer :: i, n, last
    logical :: is_beside

    left = trim(history_tables(i_table)%columns)//','
    table%tells_mass = tells_mass
    n = count([(scan(left(i:i), ',;') == 1, i=1, len(left))])
    allocate (table%is_kept(n), table%names(n), table%kinds(n))
    is_beside = .false.
    do i = 1, n
      last = scan(left, ',;') - 1
      table%is_kept(i) = (tells_mass .or. left(1:1) /= '+') .and. (erodes .or. left(1:1) /= '-')
      if (table%is_kept(i) .and. .not. is_beside) table%n_csv = table%n_csv + 1
      table%kinds(i) = kind_real
      if (index(left(:last), '#') > 0) table%kinds(i) = kind_integer
      if (index(left(:last), '@') > 0) table%kinds(i) = kind_side
      table%names(i) = left(verify(left, '+-#@'):last)
      is_beside = is_beside .or. left(last + 1:last + 1) == ';'
      left = left(last + 2:)
    end do
    table%names = pack(table%names, table%is_kept)
    table%kinds = pack(table%kinds, table%is_kept)
    allocate (table%values(size(table%kinds), 64))
  end subroutine plan_table

  !> Make the CSV file of a planned table and write its header.
  subroutine open_table(table, path, error)
    type(csv_table_t), intent(inout) :: table
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: header
    integer :: i

    header = trim(table%names(1))
    do i = 2, table%n_csv
      header = header//','//trim(table%names(i))
    end do
    call open_lines(table%file, path, error)
    if (allocated(error)) return
    call put_lines(table%file, header//new_line('a'))
    call flush_lines(table%file, error)
  end subroutine open_table

  !> Take one row; nothing happens to a table that is not open.
  subroutine add_row(table, values)
    type(csv_table_t), intent(inout) :: table
    real(wp), intent(in) :: values(:)   !! of all columns of `history_tables`
    real(wp), allocatable :: larger(:, :)

    if (.not. table%file%is_open) return
    if (table%n_row == size(table%values, 2)) then
      allocate (larger(size(table%values, 1), 2*table%n_row))
      larger(:, :table%n_row) = table%values
      call move_alloc(larger, table%values)
    end if
    table%n_row = table%n_row + 1
    table%values(:, table%n_row) = pack(values, table%is_kept)
    call put_lines(table%file, row_text(table%values(:table%n_csv, table%n_row), table%kinds))
    call keep_up(table%file)
    call add_dyna_row(table%text, values)
  end subroutine add_row

  !> One row as text, with its line end.
  pure function row_text(values, kinds) result(text)
    real(wp), intent(in) :: values(:)
    integer, intent(in) :: kinds(:)   !! `kind_` of each value
    character(:), allocatable :: text
    character((real_size + 1)*size(values)) :: buffer
    character(real_size) :: word
    integer :: i, n, length

    n = 0
    do i = 1, size(values)
      select case (kinds(i))
      case (kind_integer)
        call put_integer(nint(values(i)), word, length)
      case (kind_side)
        word = merge('slave ', 'master', nint(values(i)) == 1)
        length = len_trim(word)
      case default
        call put_real(values(i), word, length)
      end select
      buffer(n + 1:n + length + 1) = word(:length)//','
      n = n + length + 1
    end do
    text = buffer(:n - 1)//new_line('a')
  end function row_text

  !> Rows as a restart file has them. Those of a table that the run no longer writes are left out.
  subroutine visit_rows(table, name, visitor)
    type(csv_table_t), intent(inout) :: table
    character(*), intent(in) :: name
    class(visitor_t), intent(inout) :: visitor
    real(wp), allocatable :: rows(:, :)
    integer :: i

    if (allocated(table%values)) rows = table%values(:, :table%n_row)
    call visitor%visit(name, rows, any_length)
    if (.not. visitor%judges .or. .not. allocated(rows) .or. .not. table%file%is_open) return
    do i = 1, size(rows, 2)
      call add_row(table, unpack(rows(:, i), table%is_kept, 0.0_wp))
    end do
  end subroutine visit_rows

end module csv_table_m
