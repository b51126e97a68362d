! SPDX-License-Identifier: MIT
!> Changes of a deck at a restart: end time and outputs. Decks are plain text here, split at lines
!> that start with an asterisk.
module deck_restart_m
  use checksum_m, only : add_bytes, checksum_text
  use kinds_m, only : long
  use errors_m, only : error_t, raise, status_input
  use log_m, only : to_text
  use text_m, only : upper_case
  implicit none
  private
  public :: merge_decks, is_whole_deck, deck_identity

contains

  !> The deck of a run with the changes of a small deck, whose keywords replace all keywords of the
  !> same name. All keywords that may not change are reported in one error.
  subroutine merge_decks(deck, changes, path, merged, error)
    character(*), intent(in) :: deck         !! as run
    character(*), intent(in) :: changes      !! text of the small deck
    character(*), intent(in) :: path         !! of the small deck, for messages
    character(:), allocatable, intent(out) :: merged
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: problems, kept, changed, names, name
    integer :: start, next, line, i, n

    problems = ''
    changed = ''
    names = ' '
    start = 1
    line = 1
    do while (start <= len(changes))
      call next_block(changes, start, name, next)
      if (.not. may_change(name)) then
        problems = problems//path//':'//to_text(line)//': *'//name//' cannot change at a ' &
          //'restart; *CONTROL_TERMINATION and the intervals of *DATABASE_ can'//new_line('a')
      else if (name /= 'END' .and. len(name) > 0) then
        changed = changed//changes(start:next - 1)
        if (changes(next - 1:next - 1) /= new_line('a')) changed = changed//new_line('a')
        if (name /= 'KEYWORD') names = names//name//' '
      end if
      do i = start, next - 1
        if (changes(i:i) == new_line('a')) line = line + 1
      end do
      start = next
      if (name == 'END') exit
    end do
    if (len(problems) > 0) then
      call raise(error, problems(:len(problems) - 1), status_input)
      return
    end if
    allocate (character(len(deck)) :: kept)
    n = 0
    start = 1
    do while (start <= len(deck))
      call next_block(deck, start, name, next)
      if (name /= 'END' .and. index(names, ' '//name//' ') == 0) then
        kept(n + 1:n + next - start) = deck(start:next - 1)
        n = n + next - start
      end if
      start = next
    end do
    merged = kept(:n)//changed//'*END'//new_line('a')
  end subroutine merge_decks

  !> The keyword of the block at `start`, empty before the first keyword, and the start of the next
  !> block.
  pure subroutine next_block(text, start, name, next)
    character(*), intent(in) :: text
    integer, intent(in) :: start
    character(:), allocatable, intent(out) :: name !! upper case, without asterisk and options
    integer, intent(out) :: next
    integer :: last

    name = ''
    next = start
    if (text(start:start) == '*') then
      last = verify(upper_case(text(start + 1:min(start + 80, len(text))))//' ', &
        'ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_') - 1
      name = upper_case(text(start + 1:start + last))
    end if
    next = len(text) + 1
    last = index(text(start:), new_line('a')//'*')
    if (last > 0) next = start + last
  end subroutine next_block

  !> Whether a keyword may change at a restart.
  pure function may_change(name) result(may)
    character(*), intent(in) :: name
    logical :: may

    select case (name)
    case ('', 'KEYWORD', 'END', 'TITLE', 'COMMENT', 'CONTROL_TERMINATION')
      may = .true.
    case default
      may = index(name, 'DATABASE_') == 1 .and. index(name, 'DATABASE_HISTORY') == 0
    end select
  end function may_change

  !> Whether a text is a deck with a mesh, not only changes.
  function is_whole_deck(text) result(whole)
    character(*), intent(in) :: text
    logical :: whole
    character(:), allocatable :: name
    integer :: start, next

    whole = .false.
    start = 1
    do while (start <= len(text) .and. .not. whole)
      call next_block(text, start, name, next)
      whole = name == 'NODE' .or. name == 'ELEMENT_SHELL' .or. name == 'INCLUDE'
      start = next
    end do
  end function is_whole_deck

  !> Checksum of the keywords of an effective deck that may not change, without comments.
  function deck_identity(deck) result(identity)
    character(*), intent(in) :: deck         !! as run
    character(8) :: identity
    integer(long) :: checksum
    character(:), allocatable :: name
    integer :: start, next, first, last

    checksum = 0
    start = 1
    do while (start <= len(deck))
      call next_block(deck, start, name, next)
      first = start
      do while (first < next .and. .not. may_change(name))
        last = index(deck(first:next - 1), new_line('a'))
        if (last == 0) last = next - first
        if (deck(first:first) /= '$') call add_bytes(checksum, deck(first:first + last - 1))
        first = first + last
      end do
      start = next
    end do
    identity = checksum_text(checksum)
  end function deck_identity

end module deck_restart_m
