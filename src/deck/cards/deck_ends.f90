! SPDX-License-Identifier: MIT
!> *TERMINATION_: what ends a run before its end time.
module deck_ends_m
  use kinds_m, only : wp
  use end_conditions_m, only : end_condition_t, end_node_place, end_node_touch, end_body_place, &
    end_body_way, end_contact
  use deck_lines_m, only : deck_t
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, open_cursor, next_row, report_field
  use deck_checks_m, only : refuse_negative, refuse_outside
  use deck_values_m, only : integer_of, real_of, is_blank, is_bad, place_of
  use deck_raw_m, only : raw_t, raw_end_t
  implicit none
  private
  public :: read_ends

contains

  !> The rows of one keyword.
  subroutine read_ends(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(raw_end_t) :: entry
    logical :: found

    call open_cursor(deck, i_block, cursor)
    do
      call next_row(deck, cursor, 1, card, found)
      if (.not. found) exit
      entry = raw_end_t()
      select case (deck%blocks(i_block)%name)
      case ('TERMINATION_CONTACT')
        call take_contact(deck, cursor, card, entry)
      case ('TERMINATION_NODE')
        call take_bounds(deck, cursor, card, 'NID', end_node_place, end_node_touch, entry)
      case default
        call take_bounds(deck, cursor, card, 'PID', end_body_place, end_body_way, entry)
      end select
      if (any(card%bad)) cycle
      raw%n_end = raw%n_end + 1
      raw%ends(raw%n_end) = entry
    end do
  end subroutine read_ends

  !> Bounds of a node or a rigid body. A bound that is blank, of bodies also 0, does not count.
  subroutine take_bounds(deck, cursor, card, name, along, other, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name         !! of the field of what is bounded
    integer, intent(in) :: along, other      !! kind of STOP 1 and 2, of STOP 4
    type(raw_end_t), intent(inout) :: entry
    logical :: is_open(2)

    entry%id_place = place_of(card, name)
    if (integer_of(card, name) < 1) call report_field(deck, cursor, card, name, &
      'is not a number of 1 or more')
    entry%condition%id = integer_of(card, name)
    select case (integer_of(card, 'STOP'))
    case (1, 2)
      entry%condition%kind = along
      entry%condition%direction = integer_of(card, 'STOP')
    case (4)
      entry%condition%kind = other
    case default
      call report_field(deck, cursor, card, 'STOP', 'is none of 1 (x), 2 (y) and 4 (' &
        //trim(merge('contact     ', 'displacement', other == end_node_touch))//')')
      return
    end select
    if (other == end_node_touch .and. entry%condition%kind == other) return
    is_open = [is_blank(card, 'MAXC'), is_blank(card, 'MINC')]
    if (along == end_body_place) is_open = is_open .or. [abs(real_of(card, 'MAXC')), &
      abs(real_of(card, 'MINC'))] <= 0.0_wp
    if (entry%condition%kind == end_body_way) is_open(2) = .true.
    if (all(is_open)) call report_field(deck, cursor, card, 'MAXC', 'is no bound, nor is MINC: ' &
      //'nothing would end the run')
    if (.not. is_open(1)) entry%condition%most = real_of(card, 'MAXC')
    if (.not. is_open(2)) entry%condition%least = real_of(card, 'MINC')
    if (entry%condition%least >= entry%condition%most) call report_field(deck, cursor, card, &
      'MINC', 'is not below MAXC')
  end subroutine take_bounds

  !> An interface without force.
  subroutine take_contact(deck, cursor, card, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_end_t), intent(inout) :: entry

    entry%id_place = place_of(card, 'CID')
    if (integer_of(card, 'CID') < 1) call report_field(deck, cursor, card, 'CID', &
      'is not a number of 1 or more')
    call refuse_negative(deck, cursor, card, 'ACTIM')
    call refuse_negative(deck, cursor, card, 'DUR')
    call refuse_negative(deck, cursor, card, 'THRES')
    call refuse_outside(deck, cursor, card, 'DOF', 0, 2, 'is none of 0 (both), 1 (x) and 2 (y)')
    entry%condition = end_condition_t(kind=end_contact, id=integer_of(card, 'CID'), &
      direction=integer_of(card, 'DOF'), start=real_of(card, 'ACTIM'), &
      duration=real_of(card, 'DUR'), threshold=real_of(card, 'THRES'))
  end subroutine take_contact

end module deck_ends_m
