! SPDX-License-Identifier: MIT
!> *INCLUDE_TRANSFORM: offsets and transformations of included files; *DEFINE_TRANSFORMATION.
module deck_transforms_m
  use kinds_m, only : wp, pi
  use text_m, only : upper_case
  use deck_cards_m, only : cursor_t, open_cursor, first_card, next_card, next_row, next_text, &
    check_rest, report_field
  use deck_fields_m, only : card_t, field_text
  use deck_ids_m, only : a_transformation
  use deck_lines_m, only : deck_t, location_t, blocks_of, line_error
  use deck_schema_ids_m, only : n_offset
  use deck_values_m, only : integer_of, real_of, reals_of, location_of, define, map_defined, &
    resolve_id
  implicit none
  private
  public :: read_transforms

  !> Keywords with positions, which are not moved, and with directions, which are not turned.
  character(30), parameter :: with_positions(*) = [character(30) :: 'DEFINE_BOX', &
    'DEFINE_COORDINATE_SYSTEM', 'RIGIDWALL_', 'INITIAL_VELOCITY_GENERATION', &
    'PART_INERTIA'], &
    with_directions(*) = [character(30) :: 'BOUNDARY_', 'INITIAL_VELOCITY', 'LOAD_NODE_', &
    'LOAD_RIGID_', 'LOAD_BODY_', 'CONSTRAINED_', 'MAT_RIGID']

contains

  !> Offsets and transformations of all files. A file has those of the file that includes it too.
  subroutine read_transforms(deck)
    type(deck_t), intent(inout) :: deck
    type(location_t) :: locations(deck%n_source)
    integer :: tranid(deck%n_source), s, found
    real(wp), allocatable :: turns(:, :, :), shifts(:, :)

    tranid = 0
    do s = 2, deck%n_source
      associate (above => deck%sources(deck%sources(s)%parent))
        deck%sources(s)%offsets = above%offsets
        deck%sources(s)%is_moved = above%is_moved
      end associate
      associate (block => deck%sources(s)%block)
        if (deck%blocks(block)%name /= 'INCLUDE_TRANSFORM') cycle
        call read_include(deck, block, s, tranid(s), locations(s))
      end associate
    end do
    call read_transformations(deck, turns, shifts)
    do s = 2, deck%n_source
      associate (source => deck%sources(s), above => deck%sources(deck%sources(s)%parent))
        source%turn = above%turn
        source%shift = above%shift
        source%is_transformed = above%is_transformed
        source%is_turned = above%is_turned
        if (tranid(s) == 0) cycle
        call resolve_id(deck, a_transformation, tranid(s), locations(s), found)
        if (found == 0) cycle
        source%is_transformed = .true.
        source%shift = matmul(above%turn, shifts(:, found)) + above%shift
        source%turn = matmul(above%turn, turns(:, :, found))
        source%is_turned = any(abs(source%turn - reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], &
          [2, 2])) > 0.0_wp)
      end associate
    end do
    call check_keywords(deck)
  end subroutine read_transforms

  !> Cards of one *INCLUDE_TRANSFORM after the name of its file.
  subroutine read_include(deck, i_block, source, tranid, location)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block, source
    integer, intent(out) :: tranid
    type(location_t), intent(out) :: location !! of TRANID
    type(cursor_t) :: cursor
    type(card_t) :: cards(2:5)
    character(:), allocatable :: text
    integer :: k

    call open_cursor(deck, i_block, cursor)
    do
      call next_text(deck, cursor, text)
      if (index(text//'.', ' +.') == 0) exit
    end do
    do k = 2, 5
      call next_card(deck, cursor, k, cards(k))
    end do
    call check_rest(deck, cursor)
    associate (offsets => deck%sources(source)%offsets)
      offsets(:n_offset - 1) = offsets(:n_offset - 1) + cards(2)%i(:n_offset - 1)
      offsets(n_offset) = offsets(n_offset) + integer_of(cards(3), 'IDROFF')
    end associate
    tranid = integer_of(cards(5), 'TRANID')
    location = location_of(cards(5), 'TRANID')
    deck%sources(source)%is_moved = .true.
  end subroutine read_include

  !> *DEFINE_TRANSFORMATION: its rows one after another, x -> turn x + shift.
  subroutine read_transformations(deck, turns, shifts)
    type(deck_t), intent(inout) :: deck
    real(wp), allocatable, intent(out) :: turns(:, :, :), shifts(:, :) !! (2, 2, n), (2, n)
    type(cursor_t) :: cursor
    type(card_t) :: head, card
    real(wp) :: turn(2, 2), shift(2)
    integer, allocatable :: blocks(:)
    integer :: i, n

    blocks = blocks_of(deck, 'DEFINE_TRANSFORMATION')
    allocate (turns(2, 2, size(blocks)), shifts(2, size(blocks)))
    do i = 1, size(blocks)
      call first_card(deck, blocks(i), cursor, head)
      call define(deck, a_transformation, head, n)
      turn = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])
      shift = 0.0_wp
      do while (next_row(deck, cursor, 2, card))
        call add_option(deck, card, turn, shift)
      end do
      if (n == 0) cycle
      turns(:, :, n) = turn
      shifts(:, n) = shift
    end do
    call map_defined(deck, a_transformation, 'TRANID')
  end subroutine read_transformations

  !> Apply one row after the rows before it.
  subroutine add_option(deck, card, turn, shift)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    real(wp), intent(inout) :: turn(2, 2), shift(2)
    character(*), parameter :: in_plane = 'leaves the plane of the mesh'
    real(wp) :: a(7), more(2, 2), centre(2), angle

    a = reals_of(card, 'A1', 'A7')
    centre = a(4:5)
    select case (upper_case(field_text(deck, card, 1)))
    case ('TRANSL')
      if (abs(a(3)) > 0.0_wp) call report_field(deck, card, 'A3', in_plane)
      shift = shift + a(1:2)
      return
    case ('SCALE')
      where (.not. abs(a) > 0.0_wp) a = 1.0_wp
      more = reshape([a(1), 0.0_wp, 0.0_wp, a(2)], [2, 2])
      centre = 0.0_wp
    case ('ROTATE')
      if (any(abs(a(1:2)) > 0.0_wp) .or. .not. abs(a(3)) > 0.0_wp) call report_field(deck, card, &
        'A1', 'to A3 are no axis along z (0, 0, 1), about which a mesh in the plane turns')
      angle = sign(a(7), a(3)*a(7))*pi/180.0_wp
      more = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
    case ('MIRROR')
      if (abs(a(6) - a(3)) > 0.0_wp) call report_field(deck, card, 'A6', in_plane)
      if (abs(a(7)) > 0.0_wp) call report_field(deck, card, 'A7', 'asks for local axes as well, ' &
        //'which this version does not have; leave it 0')
      centre = a(1:2)
      a(1:2) = a(4:5) - a(1:2)
      if (.not. norm2(a(1:2)) > 0.0_wp) call report_field(deck, card, 'A4', &
        'with A5 gives A1 and A2 again; the line of the mirror is across from one to the other')
      if (.not. norm2(a(1:2)) > 0.0_wp) return
      a(1:2) = a(1:2)/norm2(a(1:2))
      more = reshape([1.0_wp - 2.0_wp*a(1)**2, -2.0_wp*a(1)*a(2), -2.0_wp*a(1)*a(2), &
        1.0_wp - 2.0_wp*a(2)**2], [2, 2])
    case default
      call report_field(deck, card, 'OPTION', 'is not TRANSL, SCALE, ROTATE or MIRROR')
      return
    end select
    turn = matmul(more, turn)
    shift = matmul(more, shift - centre) + centre
  end subroutine add_option

  !> Report keywords with positions or directions in files whose nodes move or turn.
  subroutine check_keywords(deck)
    type(deck_t), intent(inout) :: deck
    integer :: i

    do i = 1, deck%n_block
      associate (block => deck%blocks(i), source => deck%sources(deck%blocks(i)%source))
        if (.not. block%is_honoured .or. .not. source%is_transformed) cycle
        if (is_one_of(block%name, with_positions) .or. (source%is_turned &
          .and. is_one_of(block%name, with_directions))) call line_error(deck, block%keyword, &
          'stands in a file that *DEFINE_TRANSFORMATION moves, but only nodes are moved; put it ' &
          //'outside of this file')
      end associate
    end do

  contains

    !> Whether a keyword begins with one of some names.
    pure function is_one_of(name, heads) result(yes)
      character(*), intent(in) :: name, heads(:)
      logical :: yes
      integer :: k

      yes = any([(index(name, trim(heads(k))) == 1, k=1, size(heads))])
    end function is_one_of

  end subroutine check_keywords

end module deck_transforms_m
