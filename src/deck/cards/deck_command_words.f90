! SPDX-License-Identifier: MIT
!> Words of the command line that a deck may hold too, in COMMANDS of *CASE.
module deck_command_words_m
  use deck_overrides_m, only : is_override, override_mistake, contact_names, run_names
  use deck_lines_m, only : shown_text
  use deck_spelling_m, only : first_too_far, keep_nearer
  implicit none
  private
  public :: lower_case, next_word, command_mistake, control_mistake, meant_word, is_memory, &
    is_without_effect, read_threads, read_thread_share, read_count

contains

  !> The text with letters A to Z made lower case, in which words of the command line are told.
  pure function lower_case(text) result(lower)
    character(*), intent(in) :: text
    character(len(text)) :: lower
    integer :: i

    lower = text
    do i = 1, len(text)
      if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') lower(i:i) = achar(iachar(text(i:i)) + 32)
    end do
  end function lower_case

  !> Take the first word of a text away.
  pure subroutine next_word(rest, word)
    character(:), allocatable, intent(inout) :: rest !! begins with a word
    character(:), allocatable, intent(out) :: word
    integer :: n

    n = index(rest//' ', ' ') - 1
    word = rest(:n)
    rest = trim(adjustl(rest(n + 1:)))
  end subroutine next_word

  !> What is wrong with a word that has control characters, which would make lines of their own in
  !> logs and status.out, or act on terminals; empty where nothing is.
  pure function control_mistake(word) result(mistake)
    character(*), intent(in) :: word
    character(:), allocatable :: mistake
    integer :: i

    mistake = ''
    do i = 1, len(word)
      if (iachar(word(i:i)) >= 32 .and. iachar(word(i:i)) /= 127) cycle
      mistake = '"'//trim(shown_text(word))//'" has a control character (line feed, escape or ' &
        //'the like) where ? stands: expected none'
      return
    end do
  end function control_mistake

  !> What is wrong with a word of COMMANDS; empty where nothing is.
  pure function command_mistake(word) result(mistake)
    character(*), intent(in) :: word
    character(:), allocatable :: mistake
    character(:), allocatable :: name, value
    integer :: n, unused

    n = index(word, '=')
    name = lower_case(word(:max(n - 1, 0)))
    value = word(n + 1:)
    unused = 1
    mistake = control_mistake(word)
    if (len(mistake) > 0) then
      return
    else if (name == 'ncpu') then
      call read_threads(value, unused, mistake)
    else if (name == 'perthread') then
      call read_thread_share(value, unused, mistake)
    else if (is_override(name)) then
      mistake = override_mistake(word)
    else if (.not. (is_memory(name) .or. is_without_effect(name))) then
      mistake = '"'//word//'" may not stand there: expected ncpu=, perthread= or an override' &
        //meant_word(word)
    end if
  end function command_mistake

  !> `; did you mean NAME=?`, NAME one of the words that change a run or of others; nothing where
  !> none is near.
  pure function meant_word(word, others) result(text)
    character(*), intent(in) :: word                !! that is not known
    character(*), intent(in), optional :: others(:) !! with their =, lower case
    character(:), allocatable :: text
    character(:), allocatable :: given
    character(20) :: nearest
    integer :: i, least

    given = lower_case(word(:scan(word//'=.', '=.') - 1))
    if (len(given) < len(word)) given = given//'='
    nearest = ''
    least = first_too_far(given)
    do i = 1, size(run_names)
      call keep_nearer(lower_case(trim(run_names(i)))//'=', given, least, nearest)
    end do
    do i = 1, size(contact_names)
      call keep_nearer(lower_case(trim(contact_names(i)))//'=', given, least, nearest)
    end do
    call keep_nearer('ncpu=', given, least, nearest)
    call keep_nearer('perthread=', given, least, nearest)
    if (present(others)) then
      do i = 1, size(others)
        call keep_nearer(trim(others(i)), given, least, nearest)
      end do
    end if
    text = ''
    if (len_trim(nearest) > 0) text = '; did you mean '//trim(nearest)//'?'
  end function meant_word

  !> Whether a word of LS-DYNA asks for memory, which is taken as it is needed.
  pure function is_memory(name) result(yes)
    character(*), intent(in) :: name !! before the =, lower case
    logical :: yes

    yes = any([character(7) :: 'memory', 'memory2'] == name)
  end function is_memory

  !> Whether a word of LS-DYNA means nothing here.
  pure function is_without_effect(name) result(yes)
    character(*), intent(in) :: name !! before the =, lower case
    logical :: yes

    yes = any([character(4) :: 'o', 'g', 's', 'f', 'a', 'x', 'para'] == name)
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
