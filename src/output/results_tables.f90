! SPDX-License-Identifier: MIT
!> The parts of the results file that are our own: what is known of the run, and the histories.
module results_tables_m
  use archive_m, only : archive_t
  use kinds_m, only : wp
  use history_file_m, only : histories_t
  use history_tables_m, only : history_tables, n_table
  use csv_table_m, only : kind_real
  use hdf5_writing_m, only : text_attribute, write_text
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
