! SPDX-License-Identifier: MIT
!> The parts of the results file that are our own: what is known of the run, and the histories.
module results_tables_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use hdf5, only : hid_t, h5gopen_f, h5gclose_f
  use kinds_m, only : wp
  use errors_m, only : error_t
  use history_file_m, only : histories_t
  use history_tables_m, only : history_tables, n_table
  use csv_table_m, only : kind_real
  use hdf5_writing_m, only : as_real, as_integer, make_group, write_rows, &
    write_string_attribute, write_text
  use text_m, only : text_of
  implicit none
  private
  public :: run_info_t, write_run, write_histories, utf8_text

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
    call write_known(group, 'deck', run_info%deck, error)
    call write_known(group, 'title', run_info%title, error)
    call write_known(group, 'version', run_info%version, error)
    call write_known(group, 'build', run_info%build, error)
    call write_known(group, 'options', run_info%options, error)
    call write_known(group, 'source', run_info%source, error)
    call write_known(group, 'machine', run_info%machine, error)
    call write_known(group, 'effective_deck_crc32', run_info%checksum, error)
    if (allocated(run_info%effective_deck)) &
      call write_text(group, 'effective_deck', run_info%effective_deck, error)
    call h5gclose_f(group, status)
  end subroutine write_run

  !> Write a text that may be missing as an attribute.
  subroutine write_known(group, name, text, error)
    integer(hid_t), intent(in) :: group                !! open group
    character(*), intent(in) :: name
    character(:), allocatable, intent(in) :: text
    type(error_t), allocatable, intent(inout) :: error

    call write_string_attribute(group, name, utf8_text(text_of(text)), .false., error)
  end subroutine write_known

  !> The text in UTF-8: as it is, or taken for Latin-1 where it is not UTF-8 (decks are either).
  pure function utf8_text(text) result(utf8)
    character(*), intent(in) :: text
    character(:), allocatable :: utf8
    integer :: i, code

    if (is_utf8(text)) then
      utf8 = text
      return
    end if
    utf8 = ''
    do i = 1, len(text)
      code = ichar(text(i:i))
      if (code < 128) then
        utf8 = utf8//text(i:i)
      else
        utf8 = utf8//char(192 + code/64)//char(128 + mod(code, 64))
      end if
    end do
  end function utf8_text

  !> Whether the bytes form UTF-8: every leading byte has its number of continuation bytes.
  pure function is_utf8(text) result(valid)
    character(*), intent(in) :: text
    logical :: valid
    integer :: i, code, n_to_come

    valid = .true.
    n_to_come = 0
    do i = 1, len(text)
      code = ichar(text(i:i))
      if (n_to_come > 0) then
        valid = valid .and. code/64 == 2
        n_to_come = n_to_come - 1
      else if (code >= 128) then
        valid = valid .and. code >= 194 .and. code < 245
        n_to_come = merge(1, merge(2, 3, code < 240), code < 224)
      end if
    end do
    valid = valid .and. n_to_come == 0
  end function is_utf8

  !> Write all tables below /history, which is there, one dataset a column; nothing of one that was
  !> never planned. Columns that no CSV file has go below /dyna.
  subroutine write_histories(id, histories, error)
    integer(hid_t), intent(in) :: id                   !! open file
    type(histories_t), intent(in) :: histories
    type(error_t), allocatable, intent(inout) :: error
    real(wp), allocatable, target :: reals(:)
    integer, allocatable, target :: integers(:)
    character(:), allocatable :: folder
    integer :: k, i

    call make_group(id, 'dyna', error)
    do k = 1, n_table
      associate (table => histories%tables(k))
        if (.not. allocated(table%names)) cycle
        folder = 'history/'//trim(history_tables(k)%name)
        call make_group(id, folder, error)
        if (size(table%names) > table%n_csv) &
          call make_group(id, 'dyna/'//trim(history_tables(k)%name), error)
        do i = 1, size(table%names)
          if (i > table%n_csv) folder = 'dyna/'//trim(history_tables(k)%name)
          reals = table%values(i, :table%n_row)
          if (table%kinds(i) == kind_real) then
            call write_rows(id, folder//'/'//trim(table%names(i)), as_real, size(reals), &
              c_loc(reals), error)
          else
            integers = nint(reals)
            call write_rows(id, folder//'/'//trim(table%names(i)), as_integer, size(integers), &
              c_loc(integers), error)
          end if
        end do
      end associate
    end do
  end subroutine write_histories

end module results_tables_m
