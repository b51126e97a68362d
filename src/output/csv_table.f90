! SPDX-License-Identifier: MIT
!> One CSV file that grows by rows: comma between values, no blanks, reals as the shortest decimals
!> that read back as the same numbers. Rows are kept in a buffer of whole lines and reach the file
!> with one system call, at the latest a second after they came. The values are kept: the results
!> file takes them over at the end. A text file in DYNA's layout may grow beside it from the same
!> rows; columns that it alone needs are not in the CSV file.
module csv_table_m
  use kinds_m, only : wp, long
  use number_text_m, only : real_size, put_real, put_integer
  use dyna_text_m, only : dyna_text_t, add_dyna_row, flush_dyna_text, close_dyna_text
  use errors_m, only : error_t
  use text_files_m, only : text_file_t, create_text_file, append_text, close_text_file
  use visitor_m, only : visitor_t, any_length
  implicit none
  private
  public :: csv_table_t, plan_table, open_table, add_row, check_table, flush_table, close_table, &
    column_name, column_names, n_columns, row_text, visit_rows, kind_real, kind_integer, kind_side

  !> Kinds of columns: a real, an integer, a side of an interface (1 = slave, 2 = master).
  integer, parameter :: kind_real = 1, kind_integer = 2, kind_side = 3
  !> Bytes of the buffer of lines.
  integer, parameter :: buffer_size = 65536
  !> Bytes of the longest value with its comma.
  integer, parameter :: value_size = real_size + 1

  !> One table.
  type :: csv_table_t
    logical :: is_open = .false.            !! rows are taken only while open
    character(:), allocatable :: name       !! glstat, rcforc and so on
    character(:), allocatable :: header     !! column names with commas between
    integer, allocatable :: kinds(:)        !! (n_column) `kind_` of each column
    integer :: n_csv = 0                    !! columns of the CSV file, the first ones
    integer :: n_row = 0                    !! rows so far
    real(wp), allocatable :: values(:, :)   !! (n_column, capacity) all rows; integers are exact
    type(text_file_t) :: file
    type(dyna_text_t) :: text               !! the file in DYNA's layout, where the deck asks for it
    character(:), allocatable :: buffer     !! lines that wait
    integer :: n_waiting = 0                !! bytes of them
    integer(long) :: flushed = 0            !! clock tick of the last write
    type(error_t), allocatable :: trouble   !! first failure; reported by the next check or flush
  end type csv_table_t

contains

  !> The columns of a table, which has no rows and no file yet.
  subroutine plan_table(table, name, header, kinds, further)
    type(csv_table_t), intent(out) :: table
    character(*), intent(in) :: name
    character(*), intent(in) :: header   !! column names with commas between
    integer, intent(in) :: kinds(:)      !! `kind_` of each column
    character(*), intent(in), optional :: further !! names of the columns that the CSV file leaves
                                                  !! out
    integer :: i

    table%name = name
    table%n_csv = count([(header(i:i) == ',', i=1, len(header))]) + 1
    table%header = header
    if (present(further)) table%header = header//','//further
    table%kinds = kinds
    allocate (table%values(size(kinds), 64))
  end subroutine plan_table

  !> Make the file `<prefix>.<name>.csv` of a planned table and write its header.
  subroutine open_table(table, prefix, error)
    type(csv_table_t), intent(inout) :: table
    character(*), intent(in) :: prefix   !! directory and job name
    type(error_t), allocatable, intent(out) :: error
    integer :: i, last

    call create_text_file(table%file, prefix//'.'//table%name//'.csv', error)
    if (allocated(error)) return
    last = len(table%header)
    do i = size(table%kinds), table%n_csv + 1, -1
      last = index(table%header(:last), ',', back=.true.) - 1
    end do
    call append_text(table%file, table%header(:last)//new_line('a'), error)
    if (allocated(error)) return
    table%is_open = .true.
    allocate (character(buffer_size) :: table%buffer)
    call system_clock(table%flushed)
  end subroutine open_table

  !> Number of columns.
  pure function n_columns(table) result(n)
    type(csv_table_t), intent(in) :: table
    integer :: n

    n = size(table%kinds)
  end function n_columns

  !> Names of all columns, with commas between.
  pure function column_names(table) result(names)
    type(csv_table_t), intent(in) :: table
    character(:), allocatable :: names

    names = table%header
  end function column_names

  !> Name of a column.
  pure function column_name(table, i_column) result(name)
    type(csv_table_t), intent(in) :: table
    integer, intent(in) :: i_column
    character(:), allocatable :: name
    integer :: i, comma

    name = table%header//','
    do i = 1, i_column - 1
      comma = index(name, ',')
      name = name(comma + 1:)
    end do
    name = name(:index(name, ',') - 1)
  end function column_name

  !> Take one row; nothing happens to a table that is not open.
  subroutine add_row(table, values)
    type(csv_table_t), intent(inout) :: table
    real(wp), intent(in) :: values(:)   !! (n_column)
    real(wp), allocatable :: larger(:, :)
    integer(long) :: now, rate

    if (.not. table%is_open) return
    if (table%n_row == size(table%values, 2)) then
      allocate (larger(size(table%values, 1), 2*table%n_row))
      larger(:, :table%n_row) = table%values
      call move_alloc(larger, table%values)
    end if
    table%n_row = table%n_row + 1
    table%values(:, table%n_row) = values
    if (table%n_waiting + value_size*table%n_csv > buffer_size) call write_waiting(table)
    call append_line(table%buffer, table%n_waiting, values(:table%n_csv), table%kinds(:table%n_csv))
    call add_dyna_row(table%text, values)
    call system_clock(now, rate)
    if (now - table%flushed > rate) call write_waiting(table)
  end subroutine add_row

  !> One row as text, with its line end.
  pure function row_text(values, kinds) result(text)
    real(wp), intent(in) :: values(:)
    integer, intent(in) :: kinds(:)   !! `kind_` of each value
    character(:), allocatable :: text
    character(value_size*size(values)) :: buffer
    integer :: n

    n = 0
    call append_line(buffer, n, values, kinds)
    text = buffer(:n)
  end function row_text

  !> Append a row and its line end behind `n` bytes of the buffer.
  pure subroutine append_line(buffer, n, values, kinds)
    character(*), intent(inout) :: buffer
    integer, intent(inout) :: n        !! bytes in use
    real(wp), intent(in) :: values(:)
    integer, intent(in) :: kinds(:)
    character(real_size) :: word
    integer :: i, length

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
    buffer(n:n) = new_line('a') ! in place of the last comma
  end subroutine append_line

  !> Write the waiting lines. The first failure is remembered and ends the writing.
  subroutine write_waiting(table)
    type(csv_table_t), intent(inout) :: table
    type(error_t), allocatable :: error

    if (table%n_waiting > 0 .and. .not. allocated(table%trouble)) then
      call append_text(table%file, table%buffer(:table%n_waiting), error)
      if (allocated(error)) call move_alloc(error, table%trouble)
    end if
    table%n_waiting = 0
    call system_clock(table%flushed)
  end subroutine write_waiting

  !> The failure that the table or its text file has had, if any.
  pure subroutine check_table(table, error)
    type(csv_table_t), intent(in) :: table
    type(error_t), allocatable, intent(out) :: error

    if (allocated(table%text%trouble)) error = table%text%trouble
    if (allocated(table%trouble)) error = table%trouble
  end subroutine check_table

  !> Bring all rows into the file.
  subroutine flush_table(table, error)
    type(csv_table_t), intent(inout) :: table
    type(error_t), allocatable, intent(out) :: error

    if (.not. table%is_open) return
    call flush_dyna_text(table%text, error)
    call write_waiting(table)
    if (allocated(table%trouble)) error = table%trouble
  end subroutine flush_table

  !> Bring all rows into the file and close it; the values stay.
  subroutine close_table(table, error)
    type(csv_table_t), intent(inout) :: table
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: closing

    if (.not. table%is_open) return
    call flush_table(table, error)
    call close_text_file(table%file, closing)
    table%is_open = .false.
    if (allocated(closing) .and. .not. allocated(error)) call move_alloc(closing, error)
    call close_dyna_text(table%text, closing)
    if (allocated(closing) .and. .not. allocated(error)) call move_alloc(closing, error)
  end subroutine close_table

  !> Rows as a restart file has them. Those of a table that the run no longer writes are left out.
  subroutine visit_rows(table, name, visitor)
    type(csv_table_t), intent(inout) :: table
    character(*), intent(in) :: name
    class(visitor_t), intent(inout) :: visitor
    real(wp), allocatable :: rows(:, :)
    integer :: i

    if (allocated(table%values)) rows = table%values(:, :table%n_row)
    call visitor%visit(name, rows, any_length)
    if (.not. visitor%judges .or. .not. allocated(rows) .or. .not. table%is_open) return
    do i = 1, size(rows, 2)
      call add_row(table, rows(:, i))
    end do
  end subroutine visit_rows

end module csv_table_m
