! SPDX-License-Identifier: MIT
!> *DAMPING_GLOBAL, *DAMPING_PART_MASS (with a second card where FLAG asks for it) and
!> *DAMPING_PART_STIFFNESS.
module deck_damping_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use conditions_m, only : damping_t, part_damping_t
  use model_m, only : model_t
  use parts_m, only : gives_pressure
  use deck_cards_m, only : cursor_t, open_cursor, next_card, next_row, next_of, &
    row_comes, check_rest, report_field
  use deck_fields_m, only : card_t
  use deck_ids_m, only : a_part, a_part_set, a_curve
  use deck_lines_m, only : deck_t, blocks_of, line_text, line_error
  use deck_values_m, only : integer_of, real_of, reals_of, has_field, find_id
  implicit none
  private
  public :: read_damping

contains

  !> All of these; conditions and rigid bodies have been read.
  subroutine read_damping(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model

    call read_global(deck, model)
    call read_mass_damping(deck, model)
    call read_stiffness_damping(deck, model)
  end subroutine read_damping

  !> *DAMPING_GLOBAL.
  subroutine read_global(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(damping_t) :: damping
    integer, allocatable :: blocks(:)
    integer :: i
    logical :: found

    blocks = blocks_of(deck, 'DAMPING_GLOBAL')
    do i = 1, size(blocks)
      call open_cursor(deck, blocks(i), cursor)
      found = next_row(deck, cursor, 1, card)
      call check_rest(deck, cursor)
      if (any(card%bad)) cycle
      call refuse_static(deck, model, card%line, '*DAMPING_GLOBAL')
      if (allocated(model%conditions%damping)) call line_error(deck, card%line, &
        'is given a second time')
      damping = damping_t(coefficient=real_of(card, 'VALDMP'))
      ! All six factors zero mean one everywhere.
      if (any(abs(reals_of(card, 'STX', 'SRZ')) > 0.0_wp)) damping%factor = &
        reals_of(card, 'STX', 'STY')
      if (integer_of(card, 'LCID') > 0) call find_curve(deck, card, model, damping%curve)
      model%conditions%damping = damping
    end do
  end subroutine read_global

  !> *DAMPING_PART_MASS.
  subroutine read_mass_damping(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(cursor_t) :: cursor
    type(card_t) :: card, factors
    type(part_damping_t) :: damping
    integer, allocatable :: parts(:)
    integer :: k
    logical :: found

    do while (next_of(deck, 'DAMPING_PART_MASS', cursor, card))
      damping%factor = 1.0_wp
      if (integer_of(card, 'FLAG') == 1) then
        call next_card(deck, cursor, 2, factors)
        damping%factor = reals_of(factors, 'STX', 'STY')
      else
        ! A second card of zeros, which common writers put where FLAG is 0 too, is no row: there is
        ! no part 0.
        found = row_comes(deck, cursor)
        if (found) found = verify(line_text(deck, cursor%line), ' 0.,+-eEdD') == 0
        if (found) cursor%line = cursor%line + 1
      end if
      if (any(card%bad)) cycle
      call refuse_static(deck, model, card%line, '*DAMPING_PART_MASS')
      call card_parts(deck, card, model, parts)
      call find_curve(deck, card, model, damping%curve)
      if (damping%curve == 0) cycle
      if (.not. allocated(model%conditions%part_damping)) &
        allocate (model%conditions%part_damping(0))
      damping%scale = real_of(card, 'SF')
      do k = 1, size(parts)
        damping%part = parts(k)
        model%conditions%part_damping = [model%conditions%part_damping, damping]
      end do
    end do
  end subroutine read_mass_damping

  !> *DAMPING_PART_STIFFNESS.
  subroutine read_stiffness_damping(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer, allocatable :: parts(:)
    integer :: k

    do while (next_of(deck, 'DAMPING_PART_STIFFNESS', cursor, card))
      if (any(card%bad)) cycle
      if (model%controls%implicit%is_on) call line_error(deck, card%line, &
        '*DAMPING_PART_STIFFNESS is damping that the implicit method does not have')
      call card_parts(deck, card, model, parts)
      do k = 1, size(parts)
        associate (part => model%parts(parts(k)))
          if (part%material == 0) cycle
          if (allocated(model%materials(part%material)%eos) .or. &
            gives_pressure(model%materials(part%material))) call report_field(deck, card, 1, &
            ': part '//to_text(part%id)//' has an equation of state, or is a rubber or a law ' &
            //'whose points may fail, for which there is no damping by stiffness')
          if (abs(part%stiffness_damping) > 0.0_wp) call report_field(deck, card, 1, &
            ': part '//to_text(part%id)//' is damped by stiffness by another card too')
          if (model%materials(part%material)%is_rigid) cycle
          part%stiffness_damping = real_of(card, 'COEF')
        end associate
      end do
    end do
  end subroutine read_stiffness_damping

  !> The part of a card, or those of its part set; none where the id is wrong.
  subroutine card_parts(deck, card, model, parts)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(in) :: model
    integer, allocatable, intent(out) :: parts(:)
    integer :: found

    allocate (parts(0))
    if (has_field(card, 'PSID')) then
      call find_id(deck, a_part_set, card, 'PSID', found)
      if (found > 0) parts = model%part_sets(found)%parts
    else
      call find_id(deck, a_part, card, 'PID', found)
      if (found > 0) parts = [found]
    end if
  end subroutine card_parts

  !> The curve of damping over time, which may not push.
  subroutine find_curve(deck, card, model, curve)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(in) :: model
    integer, intent(out) :: curve

    call find_id(deck, a_curve, card, 'LCID', curve)
    if (curve == 0) return
    if (minval(model%curves(curve)%ordinate) < 0.0_wp) call report_field(deck, card, 'LCID', &
      'is a curve with values below 0: forces that push along with the velocity would feed energy')
  end subroutine find_curve

  !> Damping by mass acts on velocities.
  subroutine refuse_static(deck, model, line, name)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    integer, intent(in) :: line
    character(*), intent(in) :: name

    associate (implicit => model%controls%implicit)
      if (implicit%is_on .and. .not. implicit%is_dynamic) call line_error(deck, line, name &
        //' damps velocities, which statics do not have (IMASS 1 of *CONTROL_IMPLICIT_DYNAMICS)')
    end associate
  end subroutine refuse_static

end module deck_damping_m
