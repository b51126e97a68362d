! SPDX-License-Identifier: MIT
!> A deck as text: files, lines and keyword blocks, and messages that point into them.
!>
!> Files stay in memory as they were read. A line is a range of characters of its file. Where
!> parameters or the command line change a line, its new text is that of source 0 and the line
!> points there (its `first` is negative), so that what is parsed is what the effective deck shows.
module deck_lines_m
  use, intrinsic :: iso_fortran_env, only : int8
  use deck_report_m, only : report_t, finding_t, add_error, add_warning
  use deck_ids_m, only : id_map_t, n_kind
  use deck_parameter_table_m, only : parameters_t
  use kinds_m, only : wp
  use log_m, only : to_text
  implicit none
  private
  public :: deck_t, blocks_of, count_rows, source_t, block_t, location_t, file_paths, &
    line_text, order_line, block_of_line, where_text, line_error, &
    line_warning, replace_line, written_text, line_finding, shown_text, marked_line, &
    layout_marks, word_t, made_line_t, given_by, words_of, format_standard, format_long, &
    format_i10, flag_comma, flag_parameter, flag_blank, max_source, max_field

  !> Column layout of a block.
  integer, parameter :: format_standard = 0, format_long = 1, format_i10 = 2
  !> What a keyword line has of them.
  character(2), parameter :: layout_marks(0:2) = ['  ', ' +', ' %']
  !> Bits of `flags`.
  integer(int8), parameter :: flag_comma = 1_int8, flag_parameter = 2_int8, flag_blank = 4_int8
  !> Files in one deck, fields of one card.
  integer, parameter :: max_source = 1000, max_field = 16

  !> One file.
  type :: source_t
    character(:), allocatable :: path
    character(:), allocatable :: text
    integer :: parent = 0                !! the file that includes it, 0 for the deck itself
    integer :: layout = format_standard  !! from its *KEYWORD line, or from the including file
  end type source_t

  !> One keyword with its data lines (comments left out, blank lines kept).
  type :: block_t
    character(80) :: name = ''           !! upper case, without asterisk, options and marks; longer
                                         !! than all that are known, so a cut one is not known
    character(:), allocatable :: given   !! the same with the options, never cut but where the line
                                         !! is too long, which is an error
    character(:), allocatable :: rest    !! what follows the name on its line
    integer :: source = 0
    integer :: keyword = 0               !! line of the keyword
    integer :: first = 1, last = 0       !! data lines
    integer :: layout = format_standard
    logical :: titled = .false.          !! _TITLE or _ID: a text line comes first
    logical :: dropped = .false.         !! not part of the effective deck
    logical :: is_honoured = .false.     !! its cards are read
    logical :: is_empty = .false.        !! it lacks the card that it needs
  end type block_t

  !> A field of a card, for messages after the card has been left.
  type :: location_t
    integer :: line = 0
    integer :: card = 1
    character(12) :: name = ''  !! of the field
    integer :: field = 0        !! its position, where there is no name: members of sets
  end type location_t

  !> A word of the command line that changes the deck.
  type :: word_t
    character(:), allocatable :: name   !! upper case
    integer :: interface = 0            !! 0 = all
    character(:), allocatable :: text   !! value
    character(:), allocatable :: phrase !! `"WORD" on the command line`, for messages
  end type word_t

  !> A line that the program made in place of those of a block.
  type :: made_line_t
    integer :: block = 0
    integer :: words(max_field) = 0     !! the word that gives each field, 0 = none
  end type made_line_t

  !> The whole deck.
  type :: deck_t
    type(source_t), allocatable :: sources(:) !! from 0 on, the text of changed lines
    integer :: n_source = 0
    integer, allocatable :: first(:), last(:) !! characters of each line; first < 0: of source 0
    integer, allocatable :: number(:)         !! line number in its file
    integer(int8), allocatable :: flags(:)
    integer :: n_line = 0
    integer :: n_written = huge(1)            !! lines of the files; those behind are `made`
    type(made_line_t), allocatable :: made(:)
    type(word_t), allocatable :: words(:)
    type(block_t), allocatable :: blocks(:)
    integer :: n_block = 0
    integer :: n_changed = 0                  !! characters of source 0 in use
    integer, allocatable :: replaced(:, :)    !! (3, n) changed lines, and where their file has them
    integer :: n_replaced = 0
    logical :: incomplete = .false.           !! an included file could not be read
    character(:), allocatable :: default_zeros, kept_zeros !! fields with a 0 that means their
                                              !! default, and of which a 0 is 0 all the same
    type(parameters_t) :: parameters
    type(id_map_t) :: maps(n_kind)            !! from user ids to indices, by kind
    real(wp), allocatable :: axes(:, :, :)    !! (2, 2, n) x and y axis of each coordinate system
    type(report_t) :: report
  end type deck_t

contains

  !> Paths of the files that a deck has been read from.
  pure function file_paths(deck) result(paths)
    type(deck_t), intent(in) :: deck
    character(:), allocatable :: paths(:)
    integer :: i

    allocate (character(maxval([(len(deck%sources(i)%path), i=1, deck%n_source)])) :: &
      paths(deck%n_source))
    do i = 1, deck%n_source
      paths(i) = deck%sources(i)%path
    end do
  end function file_paths

  !> Text of a line.
  pure function line_text(deck, line) result(text)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: line
    character(:), allocatable :: text
    integer :: source

    source = 0
    if (deck%first(line) > 0) source = deck%blocks(block_of_line(deck, line))%source
    text = deck%sources(source)%text(abs(deck%first(line)):deck%last(line))
  end function line_text

  !> Blocks whose cards are read and whose keyword begins so, in the order of the deck.
  pure function blocks_of(deck, head) result(blocks)
    type(deck_t), intent(in) :: deck
    character(*), intent(in) :: head
    integer, allocatable :: blocks(:)
    integer :: i

    blocks = pack([(i, i=1, deck%n_block)], [(deck%blocks(i)%is_honoured &
      .and. deck%blocks(i)%name(:len(head)) == head, i=1, deck%n_block)])
  end function blocks_of

  !> Rows that the keywords that begin so may have.
  pure function count_rows(deck, head) result(n)
    type(deck_t), intent(in) :: deck
    character(*), intent(in) :: head
    integer :: n

    associate (which => blocks_of(deck, head))
      n = sum(max(deck%blocks(which)%last - deck%blocks(which)%first + 1, 0))
    end associate
  end function count_rows

  !> The block that holds a line (keyword line or data line); 0 before the first.
  pure function block_of_line(deck, line) result(i_block)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: line
    integer :: i_block
    integer :: low, high

    if (line > deck%n_written) then
      i_block = deck%made(line - deck%n_written)%block
      return
    end if
    low = 0
    high = deck%n_block + 1
    do while (high - low > 1)
      i_block = (low + high)/2
      if (deck%blocks(i_block)%keyword <= line) then
        low = i_block
      else
        high = i_block
      end if
    end do
    i_block = low
  end function block_of_line

  !> `file:number: *KEYWORD` of a line, the head of every message.
  pure function where_text(deck, line) result(text)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: line
    character(:), allocatable :: text
    integer :: i_block

    i_block = block_of_line(deck, line)
    if (line < 1 .or. i_block < 1) then
      text = deck%sources(1)%path
      return
    end if
    text = deck%sources(deck%blocks(i_block)%source)%path
    if (deck%number(line) > 0) text = text//':'//to_text(deck%number(line))
    text = text//': *'//deck%blocks(i_block)%given
  end function where_text

  !> The word that gives field `k` of a line, `"ctype.2=5" on the command line`; empty where the
  !> deck does.
  pure function given_by(deck, line, k) result(phrase)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: line, k
    character(:), allocatable :: phrase

    phrase = ''
    if (line <= deck%n_written) return
    associate (word => deck%made(line - deck%n_written)%words(k))
      if (word > 0) phrase = deck%words(word)%phrase
    end associate
  end function given_by

  !> The words that change the block of a line, a line of a message each.
  pure function words_of(deck, line) result(text)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: line
    character(:), allocatable :: text
    integer :: i, k

    text = ''
    if (line <= deck%n_written) return
    associate (block => deck%blocks(block_of_line(deck, line)))
      do i = block%first, block%last
        do k = 1, max_field
          if (len(given_by(deck, i, k)) > 0) text = text//new_line('a')//'  | with ' &
            //given_by(deck, i, k)
        end do
      end do
    end associate
  end function words_of

  !> The line of a message that stands for one that was made, for the order of messages.
  pure function order_line(deck, line)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: line
    integer :: order_line

    order_line = line
    if (line > deck%n_written) order_line = deck%blocks(block_of_line(deck, line))%keyword
    if (order_line > deck%n_written) order_line = deck%n_written
  end function order_line

  !> An error of a whole line, with the line under it; 0: of the deck as a whole, or of the command
  !> line.
  subroutine line_error(deck, line, message)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line
    character(*), intent(in) :: message
    character(:), allocatable :: text

    text = where_text(deck, line)//': '//message
    if (line > 0) text = text//new_line('a')//'  | '//trim(shown_text(line_text(deck, line)))
    call add_error(deck%report, order_line(deck, line), text, line_finding(deck, line, message))
  end subroutine line_error

  !> A warning of a line; the same `key` is told once.
  subroutine line_warning(deck, line, key, message)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line
    character(*), intent(in) :: key
    character(*), intent(in) :: message

    call add_warning(deck%report, order_line(deck, line), key, &
      where_text(deck, line)//': '//message, line_finding(deck, line, message))
  end subroutine line_warning

  !> A message that belongs to a line as a whole.
  pure function line_finding(deck, line, message) result(finding)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: line
    character(*), intent(in) :: message
    type(finding_t) :: finding
    integer :: i_block

    finding%message = message
    i_block = block_of_line(deck, line)
    if (line < 1 .or. i_block < 1) return
    finding%file = deck%sources(deck%blocks(i_block)%source)%path
    finding%line = deck%number(line)
    finding%keyword = deck%blocks(i_block)%given
  end function line_finding

  !> Give a line a new text (free format).
  subroutine replace_line(deck, line, text)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line
    character(*), intent(in) :: text
    integer :: n

    if (deck%first(line) > 0) then
      ! Messages tell the line as its file has it too.
      if (.not. allocated(deck%replaced)) allocate (deck%replaced(3, 64))
      n = size(deck%replaced, 2)
      if (deck%n_replaced == n) deck%replaced = reshape([deck%replaced, deck%replaced], [3, 2*n])
      deck%n_replaced = deck%n_replaced + 1
      deck%replaced(:, deck%n_replaced) = [line, deck%first(line), deck%last(line)]
    end if
    associate (changed => deck%sources(0))
      if (.not. allocated(changed%text)) changed%text = repeat(' ', 4096)
      n = deck%n_changed + len(text)
      if (n > len(changed%text)) changed%text = changed%text//repeat(' ', n)
      changed%text(deck%n_changed + 1:n) = text
    end associate
    deck%first(line) = -(deck%n_changed + 1)
    deck%last(line) = n
    deck%n_changed = n
    deck%flags(line) = 0_int8
    if (index(text, ',') > 0) deck%flags(line) = flag_comma
    if (index(text, '&') > 0) deck%flags(line) = ior(deck%flags(line), flag_parameter)
    if (len_trim(text) == 0) deck%flags(line) = flag_blank
  end subroutine replace_line

  !> A line as its file has it where something replaced it, otherwise nothing.
  pure function written_text(deck, line) result(text)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: line
    character(:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, deck%n_replaced
      if (deck%replaced(1, i) /= line) cycle
      text = deck%sources(deck%blocks(block_of_line(deck, line))%source)%text( &
        deck%replaced(2, i):deck%replaced(3, i))
    end do
  end function written_text

  !> The text fit for a terminal: other than printable ASCII becomes a question mark.
  pure function shown_text(text) result(shown)
    character(*), intent(in) :: text
    character(min(len(text), 240)) :: shown
    integer :: i

    do i = 1, len(shown)
      if (iachar(text(i:i)) >= 32 .and. iachar(text(i:i)) < 127) then
        shown(i:i) = text(i:i)
      else
        shown(i:i) = '?'
      end if
    end do
  end function shown_text

  !> The line and under it a mark from character `first` to `last`.
  pure function marked_line(text, first, last) result(marked)
    character(*), intent(in) :: text
    integer, intent(in) :: first, last
    character(:), allocatable :: marked
    integer :: from, to

    from = min(max(first, 1), 230)
    to = min(max(last, from), 240)
    marked = '  | '//trim(shown_text(text))//new_line('a')//'  | '//repeat(' ', from - 1) &
      //repeat('^', to - from + 1)
  end function marked_line

end module deck_lines_m
