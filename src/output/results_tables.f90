! SPDX-License-Identifier: MIT
!> The parts of the results file that are our own: what is known of the run, and the histories.
module results_tables_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use hdf5, only : hid_t, h5gopen_f, h5gclose_f
  use kinds_m, only : wp
  use errors_m, only : error_t
  use history_file_m, only : histories_t, n_table
  use csv_table_m, only : csv_table_t, column_name, n_columns, kind_real
  use hdf5_writing_m, only : as_real, as_integer, make_group, write_rows, &
    write_string_attribute, write_text
  implicit none
  private
  public :: run_info_t, write_run, write_histories

  !> What the file says of the run.
  type :: run_info_t
    character(:), allocatable :: title          !! of the deck
    character(:), allocatable :: deck           !! file name of the deck
    character(:), allocatable :: version        !! of the program
    character(:), allocatable :: build          !! compiler and options
    character(:), allocatable :: options        !! command line
    character(:), allocatable :: effective_deck !! the deck as run
  end type run_info_t

contains

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

  !> Write all tables below /history, which is there.
  subroutine write_histories(id, histories, error)
    integer(hid_t), intent(in) :: id                   !! open file
    type(histories_t), intent(in) :: histories
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    do i = 1, n_table
      call write_table(id, histories%tables(i), error)
    end do
  end subroutine write_histories

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

end module results_tables_m
