! SPDX-License-Identifier: MIT
!> Overrides put into what was read, and into the text of the effective deck at the same time.
module deck_override_apply_m
  use kinds_m, only : wp
  use number_text_m, only : shortest
  use log_m, only : to_text
  use curves_m, only : curve_t
  use contacts_m, only : friction_rule_t, is_tied, breaks
  use deck_lines_m, only : deck_t, place_t, line_text, line_error, line_warning, layout_mark
  use deck_fields_m, only : card_t, cut_card, field_text
  use deck_cards_m, only : cursor_t, open_cursor, find_keyword_field
  use deck_overrides_m, only : overrides_t, contact_names, override_text, override_real
  use deck_raw_m, only : raw_t, raw_contact_t
  implicit none
  private
  public :: apply_overrides, contact_text

contains

  !> Apply all overrides (interfaces have theirs from when they were read); `tail` is what the
  !> effective deck says besides its blocks.
  subroutine apply_overrides(deck, overrides, raw, tail)
    type(deck_t), intent(inout) :: deck
    type(overrides_t), intent(in) :: overrides
    type(raw_t), intent(inout) :: raw
    character(:), allocatable, intent(out) :: tail
    integer :: i
    logical :: changed

    tail = ''
    changed = .false.
    call override_real(overrides, 'ENDTIM', 0, raw%controls%end_time, changed)
    if (changed) call replace_field(deck, 'CONTROL_TERMINATION', 'ENDTIM', &
      override_text(overrides, 'ENDTIM', 0), tail)
    changed = .false.
    call override_real(overrides, 'TSSFAC', 0, raw%controls%dt_scale, changed)
    if (changed) call replace_field(deck, 'CONTROL_TIMESTEP', 'TSSFAC', &
      override_text(overrides, 'TSSFAC', 0), tail)
    call override_step(deck, overrides, raw, tail)
    do i = 1, size(raw%contacts)
      associate (entry => raw%contacts(i))
        if (entry%overridden) deck%blocks(entry%block)%replacement = contact_text(entry)
      end associate
    end do
    call check_interfaces(deck, overrides, raw)
  end subroutine apply_overrides

  !> What is meant for one interface must find it; what is meant for all says so where there is
  !> none.
  subroutine check_interfaces(deck, overrides, raw)
    type(deck_t), intent(inout) :: deck
    type(overrides_t), intent(in) :: overrides
    type(raw_t), intent(in) :: raw
    integer :: i

    do i = 1, size(overrides%items)
      associate (item => overrides%items(i))
        if (.not. any(contact_names == item%name)) cycle
        if (item%interface /= 0) then
          if (deck%incomplete .or. any(raw%contacts%contact%id == item%interface)) cycle
          call line_error(deck, 0, item%phrase//' changes interface ' &
            //to_text(item%interface)//', which the deck does not have')
        else if (size(raw%contacts) == 0) then
          call line_warning(deck, 0, 'override '//item%name, item%phrase//' changes ' &
            //item%name//' of all interfaces, but the deck has none')
        end if
      end associate
    end do
  end subroutine check_interfaces

  !> dt=: a constant curve, named as LCTM; DT0 where the deck is implicit.
  subroutine override_step(deck, overrides, raw, tail)
    type(deck_t), intent(inout) :: deck
    type(overrides_t), intent(in) :: overrides
    type(raw_t), intent(inout) :: raw
    character(:), allocatable, intent(inout) :: tail
    type(curve_t) :: curve
    real(wp) :: dt
    logical :: changed
    character(:), allocatable :: text

    changed = .false.
    call override_real(overrides, 'DT', 0, dt, changed)
    if (.not. changed) return
    text = override_text(overrides, 'DT', 0)
    if (raw%controls%implicit%is_on) then
      raw%controls%implicit%dt = dt
      call replace_field(deck, 'CONTROL_IMPLICIT_GENERAL', 'DT0', text, tail)
      return
    end if
    curve%id = unused_number(deck)
    allocate (curve%abscissa(2), curve%ordinate(2))
    curve%abscissa = [0.0_wp, 1.0e20_wp]
    curve%ordinate = dt
    raw%step_curve = curve
    raw%dt_curve = curve%id
    raw%dt_curve_place = place_t(line=0, card=1, name='LCTM')
    call replace_field(deck, 'CONTROL_TIMESTEP', 'LCTM', to_text(curve%id), tail)
    tail = tail//'*DEFINE_CURVE'//new_line('a')//to_text(curve%id)//','//new_line('a') &
      //'0.0,'//text//new_line('a')//'1.0e20,'//text//new_line('a')
  end subroutine override_step

  !> A number for one more curve: one whose digits stand nowhere in the deck, so that a reference to
  !> nothing stays one. It starts high, so that the deck of changes that a restart may have does not
  !> meet it by chance either.
  pure function unused_number(deck) result(number)
    type(deck_t), intent(in) :: deck
    integer :: number
    integer :: i

    number = 90000001
    do while (any([(index(deck%sources(i)%text, to_text(number)) > 0, i=1, deck%n_source)]))
      number = number + 1
    end do
  end function unused_number

  !> Give a field of card 1 of the last keyword of a name a new text; a new keyword goes to the tail
  !> when there is none.
  subroutine replace_field(deck, name, field_name, text, tail)
    type(deck_t), intent(inout) :: deck
    character(*), intent(in) :: name, field_name
    character(*), intent(in) :: text
    character(:), allocatable, intent(inout) :: tail
    character(:), allocatable :: line
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer :: i, k, at, i_block, field

    field = find_keyword_field(name, field_name)
    i_block = 0
    do i = 1, deck%n_block
      if (deck%blocks(i)%name == name .and. .not. deck%blocks(i)%dropped) i_block = i
    end do
    at = index(tail, '*'//name)
    if (i_block == 0 .and. at > 0) then
      call replace_in_tail(tail, at, field, text)
      return
    end if
    line = repeat(',', field - 1)//text//','
    if (i_block == 0) then
      tail = tail//'*'//name//new_line('a')//line//new_line('a')
      return
    end if
    call open_cursor(deck, i_block, cursor)
    if (allocated(deck%blocks(i_block)%replacement)) then
      at = 1
      call replace_in_tail(deck%blocks(i_block)%replacement, at, field, text)
      return
    end if
    if (cursor%line <= cursor%last) then
      call cut_card(deck, cursor%specs(1), cursor%source, cursor%line, card)
      line = ''
      do k = 1, cursor%specs(1)%n
        if (k == field) then
          line = line//text//','
        else
          line = line//field_text(deck, card, k)//','
        end if
      end do
    end if
    line = '*'//name//layout_mark(deck%blocks(i_block)%layout)//new_line('a')//line//new_line('a')
    do i = cursor%line + 1, cursor%last
      line = line//line_text(deck, i)//new_line('a')
    end do
    deck%blocks(i_block)%replacement = line
  end subroutine replace_field

  !> Replace a field of the free-format card that follows the keyword at `at`.
  subroutine replace_in_tail(tail, at, field, text)
    character(:), allocatable, intent(inout) :: tail
    integer, intent(in) :: at
    integer, intent(in) :: field
    character(*), intent(in) :: text
    integer :: first, last, k

    first = at + index(tail(at:), new_line('a'))
    do k = 1, field - 1
      last = first + index(tail(first:), new_line('a')) - 2
      if (index(tail(first:last), ',') == 0) tail = tail(:last)//','//tail(last + 1:)
      first = first + index(tail(first:), ',')
    end do
    last = first + scan(tail(first:), ','//new_line('a')) - 2
    tail = tail(:first - 1)//text//tail(last + 1:)
  end subroutine replace_in_tail

  !> An interface as *CONTACT_2D_SLIDELINE in free format.
  function contact_text(entry) result(text)
    type(raw_contact_t), intent(in) :: entry
    character(:), allocatable :: text
    character(10) :: id

    write (id, '(ss,i10)') entry%contact%id
    associate (c => entry%contact)
      text = '*CONTACT_2D_SLIDELINE_TITLE'//new_line('a')//id//c%title//new_line('a') &
        //to_text(entry%sides(1))//','//to_text(entry%sides(2))//','//to_text(c%contact_type) &
        //','//to_text(c%n_gauss)//','//shortest(c%penalty)//friction(1)//new_line('a') &
        //shortest(c%birth)//','//shortest(c%death)//','//to_text(c%penalty_unit)//',' &
        //shortest(max(c%master_penalty, 0.0_wp))//','//shortest(entry%per_cent)//',' &
        //to_text(merge(1, 0, c%strict))//','//to_text(c%search_interval)//',' &
        //shortest(merge(c%tie_reach, c%search_depth, is_tied(c)))//new_line('a')//friction(2)
    end associate

  contains

    !> What card 1 ends with (1), and card 3 (2); nothing where all is as without them.
    function friction(k) result(text)
      integer, intent(in) :: k
      character(:), allocatable :: text
      type(friction_rule_t) :: default
      integer, parameter :: before_target = 6 !! fields of card 3
      integer :: i

      text = ''
      associate (rule => entry%contact%friction)
        if (k == 1) then
          if (max(rule%at_rest, rule%sliding, rule%decay) > 0.0_wp) text = ',' &
            //shortest(rule%at_rest)//','//shortest(rule%sliding)//','//shortest(rule%decay)
        else if (breaks(entry%contact)) then
          text = shortest(rule%most)//','//shortest(rule%stiffness)//',' &
            //to_text(entry%contact%tie)//','//shortest(entry%contact%strength(1))//',' &
            //shortest(entry%contact%strength(2))
        else if (is_tied(entry%contact)) then
          text = '0,1,'//to_text(entry%contact%tie)
        else if (rule%most > 0.0_wp .or. abs(rule%stiffness - default%stiffness) > 0.0_wp &
          .or. entry%interference > 0) then
          text = shortest(rule%most)//','//shortest(rule%stiffness)
          if (entry%interference > 0) text = text//',0,,,'//to_text(entry%interference)
        end if
      end associate
      if (k == 1) return
      if (entry%contact%target > 0.0_wp) text = text//repeat(',', before_target &
        - count([(text(i:i) == ',', i=1, len(text))]))//shortest(entry%contact%target)
      if (len(text) > 0) text = text//new_line('a')
    end function friction

  end function contact_text

end module deck_override_apply_m
