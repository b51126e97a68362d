! SPDX-License-Identifier: MIT
!> Id maps of every kind of thing in a deck; ids given twice are errors.
module deck_maps_m
  use kinds_m, only : long
  use log_m, only : to_text
  use sorting_m, only : sorted_order
  use deck_lines_m, only : deck_t, place_t, line_error, where_text
  use deck_cards_m, only : reject_field
  use deck_ids_m, only : id_map_t, map_ids, index_of
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: maps_t, make_maps, resolve_id

  !> Maps from user id to index.
  type :: maps_t
    type(id_map_t) :: nodes, elements, parts, sections, materials, equations, hourglasses, &
      curves, tables, node_sets, part_sets, segment_sets, shell_sets, systems
  end type maps_t

contains

  !> Make all maps.
  subroutine make_maps(deck, raw, maps)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(out) :: maps
    logical :: all_lost

    call map_kind(deck, 'node', raw%node_id(:raw%n_node), raw%node_line(:raw%n_node), &
      'NID', maps%nodes)
    call map_kind(deck, 'element', raw%element_id(:raw%n_element), &
      raw%element_line(:raw%n_element), 'EID', maps%elements)
    call map_kind(deck, 'part', [raw%parts%id], [raw%parts%line], 'PID', maps%parts)
    call map_kind(deck, 'section', [raw%sections%id], raw%section_line, 'SECID', maps%sections)
    call map_kind(deck, 'material', [raw%materials%id], raw%material_line, 'MID', maps%materials)
    call map_kind(deck, 'equation of state', [raw%equations%id], raw%equation_line, 'EOSID', &
      maps%equations)
    call map_kind(deck, 'hourglass control', [raw%hourglasses%id], raw%hourglass_line, 'HGID', &
      maps%hourglasses)
    call map_kind(deck, 'curve', [raw%curves%id], raw%curve_line, 'LCID', maps%curves)
    call map_kind(deck, 'table', [raw%tables%id], [raw%tables%line], 'TBID', maps%tables)
    call map_kind(deck, 'node set', [raw%node_sets(:raw%n_node_set)%id], &
      [raw%node_sets(:raw%n_node_set)%line], 'SID', maps%node_sets, &
      [raw%node_sets(:raw%n_node_set)%of_beams])
    call map_kind(deck, 'part set', [raw%part_sets(:raw%n_part_set)%id], &
      [raw%part_sets(:raw%n_part_set)%line], 'SID', maps%part_sets)
    call map_kind(deck, 'segment set', [raw%segment_sets(:raw%n_segment_set)%id], &
      [raw%segment_sets(:raw%n_segment_set)%line], 'SID', maps%segment_sets, &
      [raw%segment_sets(:raw%n_segment_set)%of_beams])
    call map_kind(deck, 'shell set', [raw%shell_sets(:raw%n_shell_set)%id], &
      [raw%shell_sets(:raw%n_shell_set)%line], 'SID', maps%shell_sets)
    call map_kind(deck, 'coordinate system', [raw%systems%id], [raw%systems%line], 'CID', &
      maps%systems)
    call check_numbers(deck, raw)
    all_lost = deck%incomplete
    maps%nodes%incomplete = raw%lost%nodes .or. raw%n_node == 0 .or. all_lost
    maps%parts%incomplete = raw%lost%parts .or. all_lost
    maps%sections%incomplete = raw%lost%sections .or. all_lost
    maps%materials%incomplete = raw%lost%materials .or. all_lost
    maps%equations%incomplete = raw%lost%equations .or. all_lost
    maps%hourglasses%incomplete = raw%lost%hourglasses .or. all_lost
    maps%curves%incomplete = raw%lost%curves .or. all_lost
    maps%tables%incomplete = raw%lost%tables .or. all_lost
    maps%systems%incomplete = raw%lost%curves .or. all_lost
    maps%node_sets%incomplete = raw%lost%sets .or. all_lost
    maps%part_sets%incomplete = raw%lost%sets .or. all_lost
    maps%segment_sets%incomplete = raw%lost%sets .or. all_lost
    maps%shell_sets%incomplete = raw%lost%sets .or. all_lost
    maps%elements%incomplete = raw%lost%elements .or. raw%n_element == 0 .or. all_lost
  end subroutine make_maps

  !> Numbers of interfaces and transducers, walls and cross sections, which nothing refers to by id.
  subroutine check_numbers(deck, raw)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    character(*), parameter :: position = ' (without a number it is the position in the deck)'
    integer, allocatable :: ids(:), lines(:), order(:)
    logical, allocatable :: has_number(:)

    ids = [raw%contacts%contact%id, raw%transducers%contact%id]
    lines = deck%blocks([raw%contacts%block, raw%transducers%block])%keyword
    order = sorted_order(int(lines, long))
    call refuse_again(deck, [ids(order)], [lines(order)], 'interface number ', &
      'interface'//position)
    ids = raw%cuts%id
    lines = raw%cuts%line
    call refuse_again(deck, ids, lines, 'number ', 'cross section'//position)
    ids = raw%walls%wall%id
    lines = raw%walls%line
    has_number = ids > 0
    call refuse_again(deck, pack(ids, has_number), pack(lines, has_number), 'wall number ', 'wall')
  end subroutine check_numbers

  !> An error of the line of each number that has come before.
  subroutine refuse_again(deck, ids, lines, what, owner)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: ids(:), lines(:)   !! in the order of the deck
    character(*), intent(in) :: what, owner   !! kind of number, what it is the number of
    type(id_map_t) :: map
    integer, allocatable :: twice(:)
    integer :: i

    call map_ids(ids, map, twice)
    do i = 1, size(twice)
      call line_error(deck, lines(twice(i)), 'the '//what//to_text(ids(twice(i))) &
        //' belongs to an earlier '//owner)
    end do
  end subroutine refuse_again

  !> One map, with an error for each id that comes again.
  subroutine map_kind(deck, what, ids, lines, field, map, of_beams)
    type(deck_t), intent(inout) :: deck
    character(*), intent(in) :: what
    integer, intent(in) :: ids(:)
    integer, intent(in) :: lines(:) !! where each stands
    character(*), intent(in) :: field
    type(id_map_t), intent(out) :: map
    logical, intent(in), optional :: of_beams(:) !! the number of a set is that of a part
    integer, allocatable :: twice(:)
    character(5) :: name
    integer :: i, first

    call map_ids(ids, map, twice)
    do i = 1, size(twice)
      first = index_of(map, ids(twice(i)))
      name = field
      if (present(of_beams)) name = merge('PID  ', name, of_beams(twice(i)))
      call reject_field(deck, place_t(lines(twice(i)), merge(2, 1, what == 'part'), trim(name)), &
        'is the number of another '//what//' ('//where_text(deck, lines(first))//')')
    end do
  end subroutine map_kind

  !> Index of an id that a field refers to; an error of that field when there is none.
  subroutine resolve_id(deck, map, id, what, place, found, hint)
    type(deck_t), intent(inout) :: deck
    type(id_map_t), intent(in) :: map
    integer, intent(in) :: id
    character(*), intent(in) :: what  !! `node`, `curve`, ...
    type(place_t), intent(in) :: place
    integer, intent(out) :: found
    character(*), intent(in), optional :: hint !! how the message goes on
    character(:), allocatable :: message

    found = index_of(map, id)
    if (found > 0 .or. map%incomplete) return
    message = 'is no '//what//' of this deck'
    if (present(hint)) message = message//hint
    call reject_field(deck, place, message)
  end subroutine resolve_id

end module deck_maps_m
