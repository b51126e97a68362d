! SPDX-License-Identifier: MIT
!> Cards of a file of *INCLUDE_TRANSFORM: offsets of their numbers and positions of their nodes, put
!> into the text of the line.
module deck_offsets_m
  use, intrinsic :: iso_fortran_env, only : int8
  use kinds_m, only : wp, long
  use log_m, only : to_text
  use text_m, only : upper_case, read_integer, read_real, shortest, number_good
  use deck_fields_m, only : card_spec_t, card_t, cut_card, field_text, field_error
  use deck_lines_m, only : deck_t, line_text, line_error, replace_line, flag_moved, format_long
  use deck_schema_ids_m, only : offset_kind, offset_node, offset_part, offset_set, offset_define, &
    offset_other, offset_by_option
  implicit none
  private
  public :: move_card, move_heading

contains

  !> Add the offsets to the numbers of a card that has been cut, move the node of *NODE, and cut the
  !> card again. Each line is moved once.
  subroutine move_card(deck, spec, keyword, source, card)
    type(deck_t), intent(inout) :: deck
    type(card_spec_t), intent(in) :: spec
    character(*), intent(in) :: keyword
    integer, intent(in) :: source
    type(card_t), intent(inout) :: card
    character(:), allocatable :: field, text, position(:)
    logical :: bad(size(card%bad)), is_changed
    integer :: k, last, line, value, status

    line = card%line
    if (iand(deck%flags(line), flag_moved) /= 0) return
    last = findloc(card%blank(:spec%n), .false., 1, back=.true.)
    if (keyword == 'NODE') call move_node(deck, spec, source, card, position)
    is_changed = allocated(position)
    if (is_changed) last = max(last, 3)
    text = ''
    do k = 1, last
      field = field_text(deck, card, k)
      if (spec%kinds(k) == 'i' .and. len(field) > 0) then
        call read_integer(field, value, status)
        if (status == number_good .and. value /= 0) call add_offset()
        if (spec%names(k) == 'TC' .and. value /= 0 .and. deck%sources(source)%is_turned) call &
          field_error(deck, card, k, 'is a direction, which *DEFINE_TRANSFORMATION does not turn ' &
          //'with the node; use *BOUNDARY_SPC_ outside of this file')
      end if
      if (allocated(position) .and. (k == 2 .or. k == 3)) field = trim(position(k - 1))
      text = text//field
      if (k < last .or. last == 1) text = text//','
    end do
    if (is_changed) then
      bad = card%bad
      call replace_line(deck, line, text)
      call cut_card(deck, spec, source, line, card)
      card%bad = bad
    end if
    deck%flags(line) = ior(deck%flags(line), flag_moved)

  contains

    !> Add the offset of its kind to the field; the sign of a number stays (node sets of contact).
    subroutine add_offset()
      integer(long) :: moved
      integer :: kind

      kind = offset_kind(keyword, spec%names(k))
      if (kind == offset_by_option) kind = kind_of_option(deck, spec, card)
      if (kind == 0) return
      if (deck%sources(source)%offsets(kind) == 0) return
      moved = abs(int(value, long)) + deck%sources(source)%offsets(kind)
      if (moved < 1 .or. moved > huge(value)) then
        call field_error(deck, card, k, 'with the offset ' &
          //to_text(deck%sources(source)%offsets(kind))//' of *INCLUDE_TRANSFORM is no number ' &
          //'of 1 to 2147483647')
        return
      end if
      is_changed = .true.
      field = to_text(int(sign(moved, int(value, long))))
    end subroutine add_offset

  end subroutine move_card

  !> Add its offset to the number in columns 1 to 10 (long layout: 20) of a title line.
  subroutine move_heading(deck, i_block, line)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block, line
    character(:), allocatable :: text
    character(20) :: moved
    integer :: number, offset, status, width

    text = line_text(deck, line)
    width = merge(20, 10, deck%blocks(i_block)%layout == format_long)
    associate (source => deck%sources(deck%blocks(i_block)%source))
      offset = source%offsets(merge(offset_other, offset_part, &
        index(deck%blocks(i_block)%name, 'CONTACT_') == 1))
    end associate
    call read_integer(text(:min(width, len(text))), number, status)
    if (iand(deck%flags(line), flag_moved) /= 0 .or. offset == 0 .or. status /= number_good) return
    if (number < 1) return
    if (number > huge(number) - offset) then
      call line_error(deck, line, 'the number with its offset '//to_text(offset) &
        //' of *INCLUDE_TRANSFORM is too large')
      return
    end if
    moved = to_text(number + offset)
    call replace_line(deck, line, moved(:width)//text(min(width, len(text)) + 1:))
    deck%flags(line) = ior(deck%flags(line), flag_moved)
  end subroutine move_heading

  !> Kind of the numbers of a row that begins with an option, or of the set of STYP (1 part set, 2
  !> part, 3 node set).
  function kind_of_option(deck, spec, card) result(kind)
    type(deck_t), intent(in) :: deck
    type(card_spec_t), intent(in) :: spec
    type(card_t), intent(in) :: card
    integer :: kind
    character(:), allocatable :: option

    if (spec%names(2) == 'STYP') then
      kind = merge(offset_part, offset_set, field_text(deck, card, 2) == '2')
      return
    end if
    option = upper_case(field_text(deck, card, 1))
    kind = offset_node
    if (index(option, 'PART') > 0) kind = offset_part
    if (index(option, 'BOX') > 0) kind = offset_define
  end function kind_of_option

  !> Coordinates of a node after the transformation of its file; not allocated where nothing moves
  !> or the card is wrong.
  subroutine move_node(deck, spec, source, card, position)
    type(deck_t), intent(in) :: deck
    type(card_spec_t), intent(in) :: spec
    integer, intent(in) :: source
    type(card_t), intent(in) :: card
    character(:), allocatable, intent(out) :: position(:)
    real(wp) :: x(2)
    integer :: k, status(2)

    if (.not. deck%sources(source)%is_transformed) return
    x = 0.0_wp
    status = number_good
    do k = 1, 2
      if (.not. card%blank(k + 1)) call read_real(field_text(deck, card, k + 1), x(k), status(k))
    end do
    if (any(status /= number_good) .or. spec%names(2) /= 'X') return
    x = matmul(deck%sources(source)%turn, x) + deck%sources(source)%shift
    allocate (character(24) :: position(2))
    position = [character(24) :: shortest(x(1)), shortest(x(2))]
  end subroutine move_node

end module deck_offsets_m
