! SPDX-License-Identifier: MIT
!> *RIGIDWALL_PLANAR: the card.
module deck_wall_m
  use kinds_m, only : wp
  use walls_m, only : wall_t, friction_sticks
  use deck_cards_m, only : cursor_t, open_cursor, next_card, next_heading, check_rest, &
    report_field
  use deck_values_m, only : integer_of, real_of, reals_of, refuse_negative, take_life
  use deck_fields_m, only : card_t
  use deck_lines_m, only : deck_t
  use deck_raw_m, only : raw_t, raw_wall_t
  implicit none
  private
  public :: read_wall

contains

  !> *RIGIDWALL_PLANAR.
  subroutine read_wall(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, place
    type(raw_wall_t) :: entry
    character(:), allocatable :: title

    call open_cursor(deck, i_block, cursor)
    entry%line = deck%blocks(i_block)%keyword
    if (deck%blocks(i_block)%titled) call next_heading(deck, cursor, entry%wall%id, title)
    call next_card(deck, cursor, 1, card)
    call next_card(deck, cursor, 2, place)
    call check_rest(deck, cursor)
    if (integer_of(card, 'NSID') < 0) call report_field(deck, cursor, card, 'NSID', &
      'is not a node set, nor 0 (all nodes)')
    if (integer_of(card, 'NSIDEX') < 0) call report_field(deck, cursor, card, 'NSIDEX', &
      'is not a node set')
    call refuse_negative(deck, cursor, card, 'OFFSET')
    call take_life(deck, card, ['BIRTH', 'DEATH'], entry%wall%birth, entry%wall%death)
    entry%sets = [integer_of(card, 'NSID'), integer_of(card, 'NSIDEX')]
    entry%card_line = card%line
    entry%reach = real_of(card, 'OFFSET')
    call take_plane(deck, cursor, place, entry%wall)
    call take_friction(deck, cursor, place, entry%wall)
    raw%n_wall = raw%n_wall + 1
    raw%walls(raw%n_wall) = entry
  end subroutine read_wall

  !> Tail and head: a point of the wall, and its normal.
  subroutine take_plane(deck, cursor, card, wall)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(wall_t), intent(inout) :: wall
    real(wp) :: arrow(2)

    wall%foot = reals_of(card, 'XT', 'YT')
    arrow = reals_of(card, 'XH', 'YH') - wall%foot
    if (abs(real_of(card, 'ZH') - real_of(card, 'ZT')) > 0.0_wp) then
      call report_field(deck, cursor, card, 'ZH', &
        'is not ZT: the normal of the wall must lie in the plane of the mesh')
    else if (.not. maxval(abs(arrow)) > 0.0_wp) then
      call report_field(deck, cursor, card, 'XH', &
        'with YH gives the tail again: the normal points from tail (XT, YT) to head (XH, YH)')
    else
      arrow = arrow/maxval(abs(arrow))
      wall%normal = arrow/norm2(arrow)
    end if
  end subroutine take_plane

  !> FRIC: 2 and 3 weld nodes that hit the wall fast enough.
  subroutine take_friction(deck, cursor, card, wall)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(wall_t), intent(inout) :: wall
    real(wp), parameter :: welds(2) = [2.0_wp, 3.0_wp]

    wall%friction = real_of(card, 'FRIC')
    if (any(.not. abs(wall%friction - welds) > 0.0_wp)) then
      call report_field(deck, cursor, card, 'FRIC', &
        'asks for welding of nodes to the wall, which this version does not have ' &
        //'(0 none, 1 sticks, between: coefficient of friction)')
    else if (wall%friction < 0.0_wp .or. wall%friction > friction_sticks) then
      call report_field(deck, cursor, card, 'FRIC', &
        'is not the friction of a wall (0 none, 1 sticks, between: coefficient of friction)')
    end if
  end subroutine take_friction

end module deck_wall_m
