! SPDX-License-Identifier: MIT
!> A file read in one go and cut into lines; keyword lines taken apart.
module deck_source_m
  use, intrinsic :: iso_fortran_env, only : int8
  use kinds_m, only : long
  use files_m, only : is_directory, is_endless
  use text_m, only : upper_case
  use deck_lines_m, only : deck_t, flag_comma, flag_parameter, flag_blank, &
    format_standard, format_long, format_i10
  implicit none
  private
  public :: read_file, scan_line, open_block, add_line, file_options, reserve_lines

contains

  !> The bytes of a file; `reason` is set when that fails.
  subroutine read_file(path, text, reason)
    character(*), intent(in) :: path
    character(:), allocatable, intent(out) :: text
    character(:), allocatable, intent(out) :: reason
    integer :: unit, status, n
    integer(long) :: n_byte
    character(len(path) + 200) :: why

    if (is_directory(path)) then
      reason = 'it is a directory'
    else if (is_endless(path)) then
      reason = 'it is empty, or a pipe or a device and no file'
    end if
    if (allocated(reason)) return
    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
      action='read', iostat=status, iomsg=why)
    if (status /= 0) then
      ! Whoever asks names the file: the library's "Cannot open file 'PATH': " would be the second.
      n = index(why, "': ", back=.true.)
      if (n > 0) n = n + 2
      reason = trim(why(n + 1:))
      return
    end if
    inquire (unit=unit, size=n_byte)
    if (n_byte > huge(unit) - 1024) then
      reason = 'the file is larger than 2 GB'
    else
      allocate (character(max(n_byte, 0_long)) :: text)
      if (n_byte > 0) then
        read (unit, iostat=status, iomsg=why) text
        if (status /= 0) reason = trim(why)
      end if
    end if
    close (unit, iostat=status)
  end subroutine read_file

  !> Find the line that starts at `start`: its last character, the start of the next line, and its
  !> flags. Tabs become blanks on the way.
  pure subroutine scan_line(text, start, last, next, flags)
    character(*), intent(inout) :: text
    integer, intent(in) :: start
    integer, intent(out) :: last !! without end-of-line characters
    integer, intent(out) :: next
    integer(int8), intent(out) :: flags
    integer :: i

    flags = flag_blank
    do i = start, len(text)
      select case (text(i:i))
      case (' ', achar(13))
        cycle
      case (achar(10))
        exit
      case (achar(9))
        text(i:i) = ' '
      case (',')
        flags = iand(ior(flags, flag_comma), not(flag_blank))
      case ('&')
        flags = iand(ior(flags, flag_parameter), not(flag_blank))
      case default
        flags = iand(flags, not(flag_blank))
      end select
    end do
    next = i + 1
    last = i - 1
    do while (last >= start)
      if (text(last:last) /= achar(13)) exit
      last = last - 1
    end do
  end subroutine scan_line

  !> Make room for `n_more` lines.
  subroutine reserve_lines(deck, n_more)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: n_more
    integer, allocatable :: more(:)
    integer :: n

    if (.not. allocated(deck%first)) then
      allocate (deck%first(n_more), deck%last(n_more), deck%number(n_more), deck%flags(n_more))
      return
    end if
    if (deck%n_line + n_more <= size(deck%first)) return
    n = deck%n_line
    allocate (more(max(n_more, n/2)), source=0)
    deck%first = [deck%first(:n), more]
    deck%last = [deck%last(:n), more]
    deck%number = [deck%number(:n), more]
    deck%flags = [deck%flags(:n), int(more, int8)]
  end subroutine reserve_lines

  !> One more line.
  subroutine add_line(deck, first, last, number, flags)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: first, last, number
    integer(int8), intent(in) :: flags

    if (deck%n_line == size(deck%first)) call reserve_lines(deck, 64)
    deck%n_line = deck%n_line + 1
    deck%first(deck%n_line) = first
    deck%last(deck%n_line) = last
    deck%number(deck%n_line) = number
    deck%flags(deck%n_line) = flags
  end subroutine add_line

  !> A new block from its keyword line (already the last line of the deck).
  subroutine open_block(deck, source, text)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: source
    character(*), intent(in) :: text !! the line without its asterisk
    integer :: n_name

    if (deck%n_block == size(deck%blocks)) deck%blocks = [deck%blocks, deck%blocks]
    deck%n_block = deck%n_block + 1
    n_name = length_of_name(upper_case(text)//' ')
    associate (block => deck%blocks(deck%n_block))
      block%given = upper_case(text(:n_name))
      block%name = block%given
      block%rest = trim(adjustl(text(n_name + 1:)))//' '
      block%source = source
      block%keyword = deck%n_line
      block%first = deck%n_line + 1
      block%last = deck%n_line
      block%layout = deck%sources(source)%layout
      if (index(block%rest, '+ ') == 1) block%layout = format_long
      if (index(block%rest, '- ') == 1) block%layout = format_standard
      if (index(block%rest, '% ') == 1) block%layout = format_i10
    end associate
  end subroutine open_block

  !> Characters of the keyword at the start of a line that ends with a blank. A hyphen between two
  !> letters is part of a name (MAT_BLATZ-KO_RUBBER); behind a name it marks its layout.
  pure function length_of_name(text) result(n)
    character(*), intent(in) :: text !! upper case
    integer :: n
    character(*), parameter :: letters = 'ABCDEFGHIJKLMNOPQRSTUVWXYZ'

    n = 0
    do
      n = n + verify(text(n + 1:), letters//'0123456789_') - 1
      if (n == 0 .or. text(n + 1:n + 1) /= '-') return
      if (verify(text(n:n), letters) > 0 .or. verify(text(n + 2:n + 2), letters) > 0) return
      n = n + 1
    end do
  end function length_of_name

  !> Options of a *KEYWORD line: LONG=Y|S|K|N and I10=Y; the others say nothing about the deck.
  pure subroutine file_options(rest, layout)
    character(*), intent(in) :: rest
    integer, intent(inout) :: layout
    character(len(rest) + 1) :: upper
    integer :: at

    upper = upper_case(rest)
    at = index(upper, 'LONG=')
    if (at > 0) then
      layout = format_standard
      if (scan(upper(at + 5:at + 5), 'YK') == 1) layout = format_long
    end if
    at = index(upper, 'I10=')
    if (at > 0) then
      if (upper(at + 4:at + 4) == 'Y') layout = format_i10
    end if
  end subroutine file_options

end module deck_source_m
