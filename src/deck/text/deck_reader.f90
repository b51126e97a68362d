! SPDX-License-Identifier: MIT
!> Reads files into keyword blocks: lines without comments, included files in place, keyword lines
!> parsed.
module deck_reader_m
  use, intrinsic :: iso_fortran_env, only : int8
  use kinds_m, only : line_length, long
  use files_m, only : is_directory, is_endless
  use log_m, only : to_text
  use text_m, only : upper_case
  use deck_lines_m, only : deck_t, block_t, line_text, line_error, block_of_line, shown_text, &
    max_source, flag_comma, flag_parameter, flag_blank, format_standard, format_long, format_i10
  implicit none
  private
  public :: read_file, cut_deck, scan_line, open_block, add_line, file_options

  !> Maximum nesting of includes.
  integer, parameter :: max_depth = 32
  !> Maximum number of characters of all files of a deck.
  integer, parameter :: max_character = 2000000000

contains

  !> Split the text of a deck and its includes into blocks.
  subroutine cut_deck(path, text, deck)
    character(*), intent(in) :: path
    character(:), allocatable, intent(inout) :: text !! moved into the deck
    type(deck_t), intent(inout) :: deck
    character(:), allocatable :: folders

    allocate (deck%sources(0:max_source), deck%blocks(64))
    deck%n_source = 1
    deck%sources(1)%path = path
    call move_alloc(text, deck%sources(1)%text)
    folders = ''
    call cut_source(deck, 1, folders)
  end subroutine cut_deck

  !> Split a file and its includes into lines and blocks.
  recursive subroutine cut_source(deck, source, folders)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: source
    character(:), allocatable, intent(inout) :: folders !! of *INCLUDE_PATH so far, one line each;
                                                        !! unchanged on return
    integer :: start, last, next, number, n_stray_lines, n_above
    integer(int8) :: flags
    logical :: in_block

    call reserve_lines(deck, len(deck%sources(source)%text)/60 + 64)
    n_above = len(folders)
    start = 1
    number = 0
    n_stray_lines = 0
    in_block = .false.
    if (index(deck%sources(source)%text(:min(3, len(deck%sources(source)%text))), &
      char(239)//char(187)//char(191)) == 1) start = 4
    do while (start <= len(deck%sources(source)%text))
      call scan_line(deck%sources(source)%text, start, last, next, flags)
      number = number + 1
      if (deck%sources(source)%text(start:start) == '*' .and. last >= start) then
        if (in_block) call close_block(deck, source, folders)
        call add_line(deck, start, last, number, flags)
        call open_block(deck, source, deck%sources(source)%text(start + 1:min(last, &
          start + line_length - 1)))
        call limit_line(deck)
        in_block = .true.
        if (deck%blocks(deck%n_block)%name == 'KEYWORD') then
          call file_options(deck%blocks(deck%n_block)%rest, deck%sources(source)%layout)
        else if (deck%blocks(deck%n_block)%name == 'END') then
          exit
        end if
      else if (deck%sources(source)%text(start:start) == '$' .and. last >= start) then
        continue
      else if (in_block) then
        if (deck%blocks(deck%n_block)%name /= 'COMMENT') then
          call add_line(deck, start, last, number, flags)
          deck%blocks(deck%n_block)%last = deck%n_line
          call limit_line(deck)
        end if
      else if (last >= start) then
        if (len_trim(deck%sources(source)%text(start:last)) > 0) n_stray_lines = n_stray_lines + 1
      end if
      start = next
    end do
    if (in_block) call close_block(deck, source, folders)
    folders = folders(:n_above)
    if (n_stray_lines > 0) call line_error(deck, 0, 'in '//deck%sources(source)%path//': ' &
      //'lines before the first keyword (a line that starts with *): '//to_text(n_stray_lines))
  end subroutine cut_source

  !> Report the last line if it is too long.
  subroutine limit_line(deck)
    type(deck_t), intent(inout) :: deck

    associate (first => deck%first(deck%n_line), last => deck%last(deck%n_line))
      if (last - first + 1 <= line_length) return
      if (len_trim(deck%sources(deck%blocks(deck%n_block)%source)%text(first:last)) <= &
        line_length) return
      call line_error(deck, deck%n_line, 'the line is longer than '//to_text(line_length) &
        //' columns')
      deck%last(deck%n_line) = first + line_length - 1
    end associate
  end subroutine limit_line

  !> Complete a block: read the files of an include.
  recursive subroutine close_block(deck, source, folders)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: source
    character(:), allocatable, intent(inout) :: folders
    character(:), allocatable :: name
    integer :: i_block, line

    i_block = deck%n_block
    if (deck%blocks(i_block)%source /= source .or. deck%blocks(i_block)%dropped) return
    if (all(deck%blocks(i_block)%name /= ['INCLUDE              ', 'INCLUDE_PATH         ', &
      'INCLUDE_PATH_RELATIVE', 'INCLUDE_TRANSFORM    '])) return
    deck%blocks(i_block)%dropped = .true.
    line = deck%blocks(i_block)%first
    if (deck%blocks(i_block)%last < line) call line_error(deck, line - 1, 'a file name is missing')
    do while (line <= deck%blocks(i_block)%last)
      call join_name(deck, i_block, line, name)
      if (len(name) == 0) cycle
      if (index(deck%blocks(i_block)%name, 'INCLUDE_PATH') == 0) then
        call include_file(deck, source, folders, name, line - 1)
        if (deck%blocks(i_block)%name /= 'INCLUDE') exit ! the rest are cards
      else
        folders = folders//name//new_line('a')
      end if
    end do
  end subroutine close_block

  !> A file name on one or several lines (continued by ` +`); `line` is moved past it.
  subroutine join_name(deck, i_block, line, name)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: i_block
    integer, intent(inout) :: line
    character(:), allocatable, intent(out) :: name
    character(:), allocatable :: text
    integer :: n

    name = ''
    do while (line <= deck%blocks(i_block)%last)
      text = trim(adjustl(line_text(deck, line)))
      line = line + 1
      n = max(len(text), 2) - 2
      if (text(n + 1:) /= ' +') exit
      name = name//trim(text(:n))
      text = ''
    end do
    if (allocated(text)) name = name//text
  end subroutine join_name

  !> Read an included file into the deck.
  recursive subroutine include_file(deck, source, folders, name, line)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: source
    character(:), allocatable, intent(inout) :: folders
    character(*), intent(in) :: name
    integer, intent(in) :: line !! where it is included
    character(:), allocatable :: path, reason
    integer :: above, i, depth

    call find_file(deck%sources(1)%path, deck%sources(source)%path, folders, name, path)
    if (len(path) == 0) then
      call line_error(deck, line, 'the file "'//trim(shown_text(name))//'" was not found; ' &
        //'references to nodes, elements and so on are not checked without it')
      deck%incomplete = .true.
      return
    end if
    above = source
    depth = 0
    do while (above > 0)
      depth = depth + 1
      if (deck%sources(above)%path == path) then
        call line_error(deck, line, 'the file "'//name//'" includes itself')
        return
      end if
      above = deck%sources(above)%parent
    end do
    if (depth >= max_depth .or. deck%n_source >= max_source) then
      call line_error(deck, line, 'more than '//to_text(max_source)//' included files, or ' &
        //to_text(max_depth)//' inside each other')
      deck%incomplete = .true.
      return
    end if
    i = deck%n_source + 1
    deck%n_source = i
    deck%sources(i)%path = path
    deck%sources(i)%parent = source
    deck%sources(i)%block = block_of_line(deck, line)
    deck%sources(i)%layout = deck%sources(source)%layout
    call read_file(path, deck%sources(i)%text, reason)
    if (.not. allocated(reason)) then
      ! A real, since the sum may exceed the largest integer.
      if (sum([(real(len(deck%sources(above)%text)), above=1, i)]) > max_character) &
        reason = 'the deck is larger than 2 GB'
    end if
    if (allocated(reason)) then
      deck%sources(i)%text = ''
      call line_error(deck, line, 'cannot read "'//name//'": '//reason)
      deck%incomplete = .true.
      return
    end if
    call cut_source(deck, i, folders)
  end subroutine include_file

  !> Path of an included file: as given, in the *INCLUDE_PATH folders (also relative to the deck),
  !> or in the folder of the including file.
  subroutine find_file(main, including, folders, name, path)
    character(*), intent(in) :: main       !! the deck itself
    character(*), intent(in) :: including
    character(*), intent(in) :: folders    !! each with its line end
    character(*), intent(in) :: name
    character(:), allocatable, intent(out) :: path !! empty when there is none
    integer :: start, next

    if (is_there(name)) return
    if (name(1:1) /= '/') then
      start = 1
      do while (start <= len(folders))
        next = start + index(folders(start:), new_line('a'))
        if (is_there(folders(start:next - 2)//'/'//name)) return
        if (is_there(main(:index(main, '/', back=.true.))//folders(start:next - 2)//'/'//name)) &
          return
        start = next
      end do
      if (is_there(including(:index(including, '/', back=.true.))//name)) return
    end if
    path = ''

  contains

    !> Whether a file exists; sets `path`.
    function is_there(candidate) result(exists)
      character(*), intent(in) :: candidate
      logical :: exists

      path = candidate
      inquire (file=candidate, exist=exists)
    end function is_there

  end subroutine find_file

  !> Read the bytes of a file; `reason` is allocated on failure.
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
      reason = 'it is empty, a pipe or a device'
    end if
    if (allocated(reason)) return
    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
      action='read', iostat=status, iomsg=why)
    if (status /= 0) then
      ! Without the library's "Cannot open file 'PATH': ": the caller names the file.
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

  !> Scan the line that starts at `start`: its last character, the start of the next line, and its
  !> flags. Tabs are replaced by blanks.
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

  !> Reserve `n_more` lines.
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

  !> Append a line.
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

  !> Append a block for a keyword line, which is the last line of the deck.
  subroutine open_block(deck, source, text)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: source
    character(*), intent(in) :: text !! the line without its asterisk
    type(block_t) :: unset
    integer :: n_name

    if (deck%n_block == size(deck%blocks)) deck%blocks = [deck%blocks, deck%blocks]
    deck%n_block = deck%n_block + 1
    deck%blocks(deck%n_block) = unset
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

  !> Length of the keyword at the start of a line that ends with a blank. A hyphen between two
  !> letters is part of the name (MAT_BLATZ-KO_RUBBER); after the name it marks the layout.
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

  !> Layout options of a *KEYWORD line: LONG=Y|S|K|N and I10=Y.
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

end module deck_reader_m
