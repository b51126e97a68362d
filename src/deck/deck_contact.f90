! SPDX-License-Identifier: MIT
!> *CONTACT_2D_ cards. Contact types are numbers and names handed in by the caller; the stock
!> keywords stand for fixed numbers, which must be among them.
module deck_contact_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use contacts_m, only : contact_kind_t, kind_text, penalty_factor
  use deck_lines_m, only : deck_t, place_t, line_error
  use deck_fields_m, only : card_t
  use deck_parameter_table_m, only : parameters_t
  use deck_cards_m, only : cursor_t, open_cursor, next_card, next_heading, check_rest, &
    report_field
  use deck_contact_values_m, only : origins_t, find_commanded, take_overrides, check_values, &
    kind_names, of_type, of_gauss, of_penalty, of_unit, of_master_penalty, of_damping
  use deck_raw_m, only : raw_t, raw_contact_t
  use deck_overrides_m, only : overrides_t
  implicit none
  private
  public :: read_contact

contains

  !> One interface.
  subroutine read_contact(deck, parameters, i_block, kinds, overrides, raw)
    type(deck_t), intent(inout) :: deck
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: i_block
    type(contact_kind_t), intent(in) :: kinds(:)
    type(overrides_t), intent(in) :: overrides
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: cards(4)
    type(raw_contact_t) :: entry
    type(origins_t) :: origins
    integer :: k

    call open_cursor(deck, i_block, cursor)
    entry%contact%title = ''
    if (deck%blocks(i_block)%titled) call next_heading(deck, cursor, entry%contact%id, &
      entry%contact%title)
    if (entry%contact%id == 0) entry%contact%id = size(raw%contacts) + 1
    if (any(raw%contacts%contact%id == entry%contact%id)) call line_error(deck, &
      deck%blocks(i_block)%keyword, 'the interface number '//to_text(entry%contact%id) &
      //' belongs to an earlier interface (without a number it is the position in the deck)')
    do k = 1, cursor%n_card
      call next_card(deck, parameters, cursor, k, cards(k))
    end do
    call check_rest(deck, cursor)
    call take_sides(deck, cursor, cards(1), entry)
    entry%block = i_block
    origins%commanded = find_commanded(overrides, entry%contact%id)
    entry%contact%contact_type = stock_type(trim(deck%blocks(i_block)%name))
    select case (deck%blocks(i_block)%name)
    case ('CONTACT_2D_SLIDELINE')
      call take_slideline(deck, cursor, cards, kinds, origins, entry)
    case ('CONTACT_2D_PENALTY')
      call take_penalty(deck, cursor, cards, origins, entry)
    case default
      call take_automatic(deck, cursor, cards, origins, entry)
    end select
    call take_overrides(overrides, entry)
    call check_values(deck, cursor, cards, kinds, overrides, origins, entry)
    if (entry%contact%chosen_by_keyword) then
      if (.not. any(kinds%number == entry%contact%contact_type)) call line_error(deck, &
        deck%blocks(i_block)%keyword, 'stands for contact type ' &
        //to_text(entry%contact%contact_type)//', which this version does not have' &
        //kind_names(kinds))
    end if
    if (entry%contact%search_interval > 0) raw%explicit_only = [raw%explicit_only, &
      entry%search_place]
    raw%contacts = [raw%contacts, entry]
  end subroutine read_contact

  !> The type that a stock keyword stands for; 0 for our own.
  pure function stock_type(name) result(contact_type)
    character(*), intent(in) :: name
    integer :: contact_type

    select case (name)
    case ('CONTACT_2D_AUTOMATIC_NODE_TO_SURFACE')
      contact_type = 1
    case ('CONTACT_2D_AUTOMATIC_ONE_WAY_SURFACE_TO_SURFACE')
      contact_type = 2
    case ('CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE', 'CONTACT_2D_PENALTY')
      contact_type = 3
    case ('CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE_MORTAR')
      contact_type = 7
    case default
      contact_type = 0
    end select
  end function stock_type

  !> SURFA and SURFB.
  subroutine take_sides(deck, cursor, card, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_contact_t), intent(inout) :: entry
    integer :: k

    do k = 1, 2
      if (card%i(k) == 0) call report_field(deck, cursor, card, k, &
        'is not a surface (more than 0: part set, less than 0: node set)')
      entry%places(k) = place_t(line=card%line, card=1, field=k)
      if (.not. card%bad(k)) entry%sides(k) = card%i(k)
    end do
  end subroutine take_sides

  !> *CONTACT_2D_SLIDELINE.
  subroutine take_slideline(deck, cursor, cards, kinds, origins, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: cards(:)
    type(contact_kind_t), intent(in) :: kinds(:)
    type(origins_t), intent(inout) :: origins
    type(raw_contact_t), intent(inout) :: entry

    associate (contact => entry%contact)
      contact%contact_type = cards(1)%i(3)
      contact%n_gauss = cards(1)%i(4)
      if (cards(1)%blank(4) .or. cards(1)%i(4) == 0) contact%n_gauss = 2
      contact%penalty = cards(1)%r(5)
      contact%penalty_unit = cards(2)%i(3)
      entry%unit_place = place_t(line=cards(2)%line, card=2, field=3)
      contact%master_penalty = contact%penalty
      if (abs(cards(2)%r(4)) > 0.0_wp) contact%master_penalty = cards(2)%r(4)
      if (cards(2)%r(4) < 0.0_wp .and. .not. origins%commanded(of_master_penalty)) &
        call report_field(deck, cursor, cards(2), 4, 'is not a penalty (more than 0)')
      call take_times(deck, cursor, cards(2), 1, entry)
      entry%per_cent = cards(2)%r(5)
      if (cards(2)%i(6) < 0 .or. cards(2)%i(6) > 1) call report_field(deck, cursor, cards(2), 6, &
        'is not 0 or 1'//strict_names(kinds))
      contact%strict = cards(2)%i(6) == 1
      call take_search(deck, cursor, cards(2), 7, entry)
      if (cards(2)%r(8) < 0.0_wp) call report_field(deck, cursor, cards(2), 8, 'is negative')
      contact%search_depth = cards(2)%r(8)
    end associate
    origins%card([of_type, of_gauss, of_penalty]) = 1
    origins%field([of_type, of_gauss, of_penalty]) = [3, 4, 5]
    origins%card([of_unit, of_damping]) = 2
    origins%field([of_unit, of_damping]) = [3, 5]
  end subroutine take_slideline

  !> What IPF = 1 asks for: `: the strict rule of name (type n)`.
  pure function strict_names(kinds) result(text)
    type(contact_kind_t), intent(in) :: kinds(:)
    character(:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(kinds)
      if (kinds(i)%has_strict_rule) text = text//trim(merge(': the strict rule of', &
        ',                   ', len(text) == 0))//' '//kind_text(kinds(i))
    end do
  end function strict_names

  !> *CONTACT_2D_AUTOMATIC_: penalty as a factor on the built-in estimate.
  subroutine take_automatic(deck, cursor, cards, origins, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: cards(:)
    type(origins_t), intent(inout) :: origins
    type(raw_contact_t), intent(inout) :: entry

    associate (contact => entry%contact)
      contact%chosen_by_keyword = .true.
      contact%penalty_unit = penalty_factor
      contact%penalty = 1.0_wp
      if (cards(1)%r(3) < 0.0_wp .and. .not. origins%commanded(of_penalty)) &
        call report_field(deck, cursor, cards(1), 3, 'is negative')
      if (cards(1)%r(3) > 0.0_wp) contact%penalty = cards(1)%r(3)
      contact%master_penalty = contact%penalty
      call take_search(deck, cursor, cards(1), 4, entry)
      call take_times(deck, cursor, cards(2), 1, entry)
      entry%per_cent = cards(3)%r(2)
    end associate
    origins%card(of_damping) = 3
    origins%field(of_damping) = 2
  end subroutine take_automatic

  !> *CONTACT_2D_PENALTY: node sets, written with a positive number there; PEN is the factor on the
  !> built-in estimate that the others multiply from SFACT and SLSFAC.
  subroutine take_penalty(deck, cursor, cards, origins, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: cards(:)
    type(origins_t), intent(in) :: origins
    type(raw_contact_t), intent(inout) :: entry
    integer :: k

    associate (contact => entry%contact)
      contact%chosen_by_keyword = .true.
      contact%penalty_unit = penalty_factor
      do k = 1, 2
        if (entry%sides(k) < 0) call report_field(deck, cursor, cards(1), k, &
          'is not a node set number (1 or more)')
        entry%sides(k) = -abs(entry%sides(k))
      end do
      if (cards(2)%r(5) < 0.0_wp .and. .not. origins%commanded(of_penalty)) &
        call report_field(deck, cursor, cards(2), 5, 'is negative')
      contact%penalty = 1.0_wp
      if (cards(2)%r(5) > 0.0_wp) contact%penalty = cards(2)%r(5)/0.1_wp
      contact%master_penalty = contact%penalty
      call take_times(deck, cursor, cards(1), 3, entry)
    end associate
  end subroutine take_penalty

  !> FREQ in field `k`: cycles between two searches. Their sum with the cycle of a run must stay a
  !> whole number.
  subroutine take_search(deck, cursor, card, k, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k
    type(raw_contact_t), intent(inout) :: entry
    integer, parameter :: most_cycles = 1000000000

    if (card%i(k) < 0) call report_field(deck, cursor, card, k, 'is negative')
    if (card%i(k) > most_cycles) call report_field(deck, cursor, card, k, &
      'is not a number of cycles between two searches (at most 1000000000)')
    if (card%bad(k)) return
    entry%contact%search_interval = card%i(k)
    entry%search_place = place_t(line=card%line, card=card%number, field=k)
  end subroutine take_search

  !> TBIRTH in field `k` and TDEATH after it; a death time of 0 means never.
  subroutine take_times(deck, cursor, card, k, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k
    type(raw_contact_t), intent(inout) :: entry

    entry%contact%birth = card%r(k)
    entry%contact%death = card%r(k + 1)
    if (.not. abs(card%r(k + 1)) > 0.0_wp) entry%contact%death = 1.0e20_wp
    if (entry%contact%death <= entry%contact%birth) then
      call report_field(deck, cursor, card, k + 1, 'is not after TBIRTH "'//to_text(card%r(k))//'"')
    else if (entry%contact%death <= 0.0_wp) then
      call report_field(deck, cursor, card, k + 1, 'is before the run begins (0 means never)')
    end if
  end subroutine take_times

end module deck_contact_m
