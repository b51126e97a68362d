! SPDX-License-Identifier: MIT
!> *MAT_RIGID.
module deck_rigid_m
  use parts_m, only : material_t
  use deck_lines_m, only : deck_t, line_warning
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, open_cursor, skip_title, next_card, check_rest, report_field
  use deck_values_m, only : integer_of, is_bad
  use deck_checks_m, only : refuse_outside
  use deck_material_m, only : elastic_constants, append_material
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: read_rigid

  !> Codes of CON1 and CON2: 0 none, 1 x, 2 y, 3 z, 4 xy, 5 yz, 6 zx, 7 xyz.
  logical, parameter :: has_x(0:7) = [.false., .true., .false., .false., .true., .false., .true., &
    .true.]
  logical, parameter :: has_y(0:7) = [.false., .false., .true., .false., .true., .true., .false., &
    .true.]
  logical, parameter :: has_z(0:7) = [.false., .false., .false., .true., .false., .true., .true., &
    .true.]

contains

  !> *MAT_RIGID.
  subroutine read_rigid(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, constraints, axes
    type(material_t) :: material

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, cursor, 1, card)
    call elastic_constants(deck, cursor, card, material)
    material%is_rigid = .true.
    call next_card(deck, cursor, 2, constraints)
    call read_constraints(deck, cursor, constraints, material)
    call next_card(deck, cursor, 3, axes)
    call append_material(raw, material, card)
    call check_rest(deck, cursor)
  end subroutine read_rigid

  !> CMO, CON1 and CON2.
  subroutine read_constraints(deck, cursor, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material
    character(*), parameter :: no_code = 'is not a code of constraints (0 to 7)'
    integer :: codes(2)

    if (integer_of(card, 'CMO') == -1) then
      call report_field(deck, cursor, card, 'CMO', 'asks for constraints in local axes, which ' &
        //'this version does not have; 1 takes the global ones')
      return
    else if (integer_of(card, 'CMO') /= 0 .and. integer_of(card, 'CMO') /= 1) then
      call report_field(deck, cursor, card, 'CMO', &
        'is not 0 (no constraints) or 1 (constraints in global axes)')
      return
    end if
    call refuse_outside(deck, cursor, card, 'CON1', 0, 7, no_code)
    call refuse_outside(deck, cursor, card, 'CON2', 0, 7, no_code)
    if (is_bad(card, 'CON1') .or. is_bad(card, 'CON2')) return
    codes = [integer_of(card, 'CON1'), integer_of(card, 'CON2')]
    if (integer_of(card, 'CMO') == 1) then
      material%is_fixed = [has_x(codes(1)), has_y(codes(1)), has_z(codes(2))]
    else if (any(codes > 0)) then
      call line_warning(deck, card%line, 'CMO 0', &
        'CON1 and CON2 have no effect while CMO is 0; 1 makes them constraints')
    end if
  end subroutine read_constraints

end module deck_rigid_m
