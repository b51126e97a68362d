! SPDX-License-Identifier: MIT
!> Files to keyword blocks: comments left out, includes put in their place.
module deck_reader_m
  use, intrinsic :: iso_fortran_env, only : int8
  use kinds_m, only : line_length
  use log_m, only : to_text
  use errors_m, only : error_t, raise, status_input
  use deck_lines_m, only : deck_t, line_text, line_error, shown_text, max_source
  use deck_source_m, only : read_file, scan_line, open_block, add_line, file_options, reserve_lines
  implicit none
  private
  public :: read_blocks, cut_deck

  !> Includes inside includes.
  integer, parameter :: max_depth = 32
  !> Characters of all files of a deck together.
  integer, parameter :: max_character = 2000000000

contains

  !> Read a deck and all that it includes. `error` is set when the deck itself cannot be read;
  !> everything else goes to the deck's report.
  subroutine read_blocks(path, deck, error)
    character(*), intent(in) :: path
    type(deck_t), intent(inout) :: deck
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: reason, text

    call read_file(path, text, reason)
    if (allocated(reason)) then
      call raise(error, 'cannot read the deck '//path//': '//reason, status_input)
      return
    end if
    call cut_deck(path, text, deck)
  end subroutine read_blocks

  !> Cut the text of a deck into blocks, its includes in their place.
  subroutine cut_deck(path, text, deck)
    character(*), intent(in) :: path
    character(:), allocatable, intent(inout) :: text !! moves into the deck
    type(deck_t), intent(inout) :: deck
    character(:), allocatable :: folders

    allocate (deck%sources(0:max_source), deck%blocks(64))
    deck%n_source = 1
    deck%sources(1)%path = path
    call move_alloc(text, deck%sources(1)%text)
    folders = ''
    call cut_source(deck, 1, folders)
  end subroutine cut_deck

  !> Cut a file into lines and blocks, its includes in their place.
  recursive subroutine cut_source(deck, source, folders)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: source
    character(:), allocatable, intent(inout) :: folders !! of *INCLUDE_PATH so far, a line each; as
                                                        !! before behind the file
    integer :: start, last, next, number, n_stray, n_above
    integer(int8) :: flags
    logical :: in_block

    call reserve_lines(deck, len(deck%sources(source)%text)/60 + 64)
    n_above = len(folders)
    start = 1
    number = 0
    n_stray = 0
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
        if (len_trim(deck%sources(source)%text(start:last)) > 0) n_stray = n_stray + 1
      end if
      start = next
    end do
    if (in_block) call close_block(deck, source, folders)
    folders = folders(:n_above)
    if (n_stray > 0) call line_error(deck, 0, 'in '//deck%sources(source)%path//', ' &
      //to_text(n_stray)//' line(s) before the first keyword (a line that starts with *)')
  end subroutine cut_source

  !> The last line may not be too long.
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

  !> The block is complete: an include puts its files here.
  recursive subroutine close_block(deck, source, folders)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: source
    character(:), allocatable, intent(inout) :: folders
    character(:), allocatable :: name
    integer :: i_block, line

    i_block = deck%n_block
    if (deck%blocks(i_block)%source /= source .or. deck%blocks(i_block)%dropped) return
    if (all(deck%blocks(i_block)%name /= ['INCLUDE              ', 'INCLUDE_PATH         ', &
      'INCLUDE_PATH_RELATIVE'])) return
    deck%blocks(i_block)%dropped = .true.
    line = deck%blocks(i_block)%first
    if (deck%blocks(i_block)%last < line) call line_error(deck, line - 1, 'a file name is missing')
    do while (line <= deck%blocks(i_block)%last)
      call join_name(deck, i_block, line, name)
      if (len(name) == 0) cycle
      if (deck%blocks(i_block)%name == 'INCLUDE') then
        call include_file(deck, source, folders, name, line - 1)
      else
        folders = folders//name//new_line('a')
      end if
    end do
  end subroutine close_block

  !> A file name that may go on over several lines (each ends with ` +`); `line` moves past it.
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
      call line_error(deck, line, 'the file "'//trim(shown_text(name))//'" was not found; what ' &
        //'refers to nodes, elements and so on is not judged without it')
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
    deck%sources(i)%layout = deck%sources(source)%layout
    call read_file(path, deck%sources(i)%text, reason)
    if (.not. allocated(reason)) then
      ! A real, since the sum may pass the largest integer.
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

  !> Where an included file is: as given, in the *INCLUDE_PATH folders (which may be meant from
  !> where the deck is), beside the including file.
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

    !> Whether there is a file, whose path is kept.
    function is_there(candidate) result(exists)
      character(*), intent(in) :: candidate
      logical :: exists

      path = candidate
      inquire (file=candidate, exist=exists)
    end function is_there

  end subroutine find_file

end module deck_reader_m
