! SPDX-License-Identifier: MIT
!> Words of the command line that a deck may hold too, in COMMANDS of *CASE.
module deck_command_words_m
  use text_m, only : upper_case
  use deck_overrides_m, only : is_override, override_mistake
  implicit none
  private
  public :: next_word, command_mistake, is_memory, is_without_effect, read_threads, &
    read_thread_share, read_count

contains

  !> Take the first word of a text away.
  pure subroutine next_word(rest, word)
    character(:), allocatable, intent(inout) :: rest !! begins with a word
    character(:), allocatable, intent(out) :: word
    integer :: n

    n = index(rest//' ', ' ') - 1
    word = rest(:n)
    rest = trim(adjustl(rest(n + 1:)))
  end subroutine next_word

  !> What is wrong with a word of COMMANDS; empty where nothing is.
  pure function command_mistake(word) result(mistake)
    character(*), intent(in) :: word
    character(:), allocatable :: mistake
    character(:), allocatable :: name, value
    integer :: n, unused

    n = index(word, '=')
    name = upper_case(word(:max(n - 1, 0)))
    value = word(n + 1:)
    unused = 1
    mistake = ''
    if (name == 'NCPU') then
      call read_threads(value, unused, mistake)
    else if (name == 'PERTHREAD') then
      call read_thread_share(value, unused, mistake)
    else if (is_override(name)) then
      mistake = override_mistake(word)
    else if (.not. (is_memory(name) .or. is_without_effect(name))) then
      mistake = '"'//word//'" may not stand there: expected ncpu=, perthread= or an override'
    end if
  end function command_mistake

  !> Whether a word of LS-DYNA asks for memory, which is taken as it is needed.
  pure function is_memory(name) result(yes)
    character(*), intent(in) :: name !! before the =, upper case
    logical :: yes

    yes = any([character(7) :: 'MEMORY', 'MEMORY2'] == name)
  end function is_memory

  !> Whether a word of LS-DYNA means nothing here.
  pure function is_without_effect(name) result(yes)
    character(*), intent(in) :: name !! before the =, upper case
    logical :: yes

    yes = any([character(4) :: 'O', 'G', 'S', 'F', 'A', 'X', 'PARA'] == name)
  end function is_without_effect

  !> Understand the value of ncpu=; a minus before it is LS-DYNA's.
  pure subroutine read_threads(value, n_thread, mistake)
    character(*), intent(in) :: value
    integer, intent(inout) :: n_thread
    character(:), allocatable, intent(out) :: mistake

    call read_count('ncpu', value(1 + index(value(:min(1, len(value))), '-'):), 1024, n_thread, &
      mistake)
  end subroutine read_threads

  !> Understand the value of perthread=.
  pure subroutine read_thread_share(value, share, mistake)
    character(*), intent(in) :: value
    integer, intent(inout) :: share
    character(:), allocatable, intent(out) :: mistake

    call read_count('perthread', value, 1000000000, share, mistake)
  end subroutine read_thread_share

  !> Understand a number from 1 to `most`.
  pure subroutine read_count(name, value, most, count, mistake)
    character(*), intent(in) :: name, value
    integer, intent(in) :: most
    integer, intent(inout) :: count !! kept where the value is wrong
    character(:), allocatable, intent(out) :: mistake !! empty: none
    character(12) :: limit
    integer :: number, status

    mistake = ''
    number = 0
    status = verify(value, '0123456789')
    if (status == 0) read (value, *, iostat=status) number
    if (status == 0 .and. number >= 1 .and. number <= most) then
      count = number
      return
    end if
    write (limit, '(ss,i0)') most
    mistake = name//'="'//value//'": expected a number from 1 to '//trim(limit)
  end subroutine read_count

end module deck_command_words_m
