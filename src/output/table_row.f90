! SPDX-License-Identifier: MIT
!> One row of a table, put together value by value: name, kind and value of a column stand in one
!> line, so that the header of a table and its rows can not differ.
module table_row_m
  use csv_table_m, only : kind_real, kind_integer, kind_side
  use kinds_m, only : wp
  implicit none
  private
  public :: row_t, put, put_side, end_csv, value_of, vector_of

  !> Columns of a row at most.
  integer, parameter :: most_column = 32

  !> A row.
  type :: row_t
    logical :: is_named = .false.           !! names and kinds are collected as well
    integer :: n = 0                        !! columns so far
    logical :: is_beside = .false.          !! further columns are not in the CSV file
    real(wp) :: values(most_column)         !! integers are exact
    integer :: kinds(most_column)           !! `kind_` of each column
    character(:), allocatable :: header     !! names with commas between
    character(:), allocatable :: further    !! those that are not in the CSV file
  end type row_t

  !> One more column; of a vector one for each component, whose names have commas between.
  interface put
    module procedure put_real
    module procedure put_integer
    module procedure put_vector
  end interface put

contains

  !> A real.
  pure subroutine put_real(row, name, value)
    type(row_t), intent(inout) :: row
    character(*), intent(in) :: name
    real(wp), intent(in) :: value

    call put_columns(row, name, kind_real, [value])
  end subroutine put_real

  !> An integer.
  pure subroutine put_integer(row, name, value)
    type(row_t), intent(inout) :: row
    character(*), intent(in) :: name
    integer, intent(in) :: value

    call put_columns(row, name, kind_integer, [real(value, wp)])
  end subroutine put_integer

  !> A vector.
  pure subroutine put_vector(row, names, values)
    type(row_t), intent(inout) :: row
    character(*), intent(in) :: names
    real(wp), intent(in) :: values(:)

    call put_columns(row, names, kind_real, values)
  end subroutine put_vector

  !> A side of an interface.
  pure subroutine put_side(row, name, side)
    type(row_t), intent(inout) :: row
    character(*), intent(in) :: name
    integer, intent(in) :: side     !! 1 = slave, 2 = master

    call put_columns(row, name, kind_side, [real(side, wp)])
  end subroutine put_side

  !> The columns that follow are not in the CSV file; the results file and DYNA's text have them.
  pure subroutine end_csv(row)
    type(row_t), intent(inout) :: row

    row%is_beside = .true.
  end subroutine end_csv

  !> Columns of one kind.
  pure subroutine put_columns(row, names, kind, values)
    type(row_t), intent(inout) :: row
    character(*), intent(in) :: names
    integer, intent(in) :: kind
    real(wp), intent(in) :: values(:)
    integer :: last

    last = row%n + size(values)
    row%values(row%n + 1:last) = values
    if (row%is_named) then
      row%kinds(row%n + 1:last) = kind
      if (row%is_beside) then
        call join(row%further, names)
      else
        call join(row%header, names)
      end if
    end if
    row%n = last
  end subroutine put_columns

  !> Append names to others, with a comma between.
  pure subroutine join(list, names)
    character(:), allocatable, intent(inout) :: list
    character(*), intent(in) :: names

    if (allocated(list)) then
      list = list//','//names
    else
      list = names
    end if
  end subroutine join

  !> One value; 0 of an array that is not there, in the row of nothing.
  pure function value_of(values, i) result(value)
    real(wp), allocatable, intent(in) :: values(:)
    integer, intent(in) :: i
    real(wp) :: value

    value = 0.0_wp
    if (allocated(values)) value = values(i)
  end function value_of

  !> One vector; 0 of an array that is not there, in the row of nothing.
  pure function vector_of(values, i) result(value)
    real(wp), allocatable, intent(in) :: values(:, :)
    integer, intent(in) :: i
    real(wp) :: value(2)

    value = 0.0_wp
    if (allocated(values)) value = values(:, i)
  end function vector_of

end module table_row_m
