! SPDX-License-Identifier: MIT
!> *DEFINE_COORDINATE_SYSTEM: axes in the plane.
module deck_systems_m
  use kinds_m, only : wp
  use deck_cards_m, only : cursor_t, open_cursor, skip_title, next_card, check_rest, report_field
  use deck_checks_m, only : require_id
  use deck_fields_m, only : card_t
  use deck_lines_m, only : deck_t
  use deck_raw_m, only : raw_t, raw_system_t
  use deck_values_m, only : integer_of, real_of, reals_of, is_bad
  implicit none
  private
  public :: read_system

contains

  !> The x axis goes from the origin to the point L; the point P is on the side of the y axis.
  subroutine read_system(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    character(*), parameter :: leaves = 'takes the axes out of the plane of the model'
    type(cursor_t) :: cursor
    type(card_t) :: cards(2)
    type(raw_system_t) :: system
    real(wp) :: origin(2), to_p(2), across
    logical :: in_plane

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, cursor, 1, cards(1))
    call next_card(deck, cursor, 2, cards(2))
    call check_rest(deck, cursor)
    call require_id(deck, cursor, cards(1), 'CID')
    if (is_bad(cards(1), 'CID')) raw%lost%curves = .true.
    if (is_bad(cards(1), 'CID')) return
    system%id = integer_of(cards(1), 'CID')
    system%line = cards(1)%line
    in_plane = .not. abs(real_of(cards(1), 'ZL') - real_of(cards(1), 'ZO')) > 0.0_wp
    if (.not. in_plane) call report_field(deck, cursor, cards(1), 'ZL', leaves)
    if (abs(real_of(cards(2), 'ZP') - real_of(cards(1), 'ZO')) > 0.0_wp) &
      call report_field(deck, cursor, cards(2), 'ZP', leaves)
    origin = reals_of(cards(1), 'XO', 'YO')
    system%axes(:, 1) = reals_of(cards(1), 'XL', 'YL') - origin
    to_p = reals_of(cards(2), 'XP', 'YP') - origin
    across = system%axes(1, 1)*to_p(2) - system%axes(2, 1)*to_p(1)
    if (.not. norm2(system%axes(:, 1)) > 0.0_wp) then
      if (in_plane) call report_field(deck, cursor, cards(1), 'XL', &
        ': the point on the x axis is the origin')
      system%axes(:, 1) = [1.0_wp, 0.0_wp]
    else if (.not. abs(across) > 0.0_wp) then
      call report_field(deck, cursor, cards(2), 'XP', &
        ': the point in the plane of the axes lies on the x axis')
    end if
    system%axes(:, 1) = system%axes(:, 1)/norm2(system%axes(:, 1))
    system%axes(:, 2) = sign(1.0_wp, across)*[-system%axes(2, 1), system%axes(1, 1)]
    raw%n_system = raw%n_system + 1
    raw%systems(raw%n_system) = system
  end subroutine read_system

end module deck_systems_m
