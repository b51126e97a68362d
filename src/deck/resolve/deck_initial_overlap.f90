! SPDX-License-Identifier: MIT
!> Surfaces of an interface that can not be right as the bodies stand at time zero: one that crosses
!> or overlaps itself, and bodies that overlap deeper than contact between whole outlines takes up.
module deck_initial_overlap_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use surfaces_m, only : surface_t, has_closed_chain
  use model_m, only : model_t
  use units_m, only : in_units
  use body_view_m, only : body_view_t, view_body
  use initial_overlap_m, only : overlap_t, find_crossing, find_overlap
  use deck_lines_m, only : deck_t
  use deck_cards_m, only : reject_field
  use deck_raw_m, only : raw_contact_t
  implicit none
  private
  public :: check_overlap

contains

  !> Check one interface. With a birth time after zero bodies may be anywhere before it; between
  !> open chains penetrations are taken as they are, however deep.
  subroutine check_overlap(deck, entry, sides, model)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    type(surface_t), intent(in) :: sides(2)
    type(model_t), intent(in) :: model
    type(body_view_t) :: views(2)
    type(overlap_t) :: found
    integer :: k, n_side, pair(2)
    logical :: crosses

    if (min(sides(1)%n_segment, sides(2)%n_segment) == 0) return
    crosses = .false.
    n_side = merge(1, 2, entry%contact%is_self)
    do k = 1, n_side
      call view_body(model, sides(k), views(k))
      call find_crossing(model, sides(k), views(k), pair)
      if (pair(1) == 0) cycle
      crosses = .true.
      call reject_field(deck, entry%places(k), 'is a surface that crosses itself: the segment ' &
        //'between '//ends_text(model, sides(k), pair(1))//' crosses the one between ' &
        //ends_text(model, sides(k), pair(2)))
    end do
    if (crosses .or. entry%contact%birth > 0.0_wp) return
    if (.not. (has_closed_chain(sides(1)) .or. has_closed_chain(sides(2)))) return
    do k = 1, n_side
      call find_overlap(model, sides(k), sides(k), views(k), .true., found)
      if (found%segment > 0) call reject_field(deck, entry%places(k), 'is a surface that ' &
        //'overlaps itself: '//depth_text(model, sides(k), found))
    end do
    if (n_side == 2) call check_between(deck, entry, sides, views, model)
  end subroutine check_overlap

  !> Either side in the bodies of the other: the deeper one by the depth allowed is told.
  subroutine check_between(deck, entry, sides, views, model)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    type(surface_t), intent(in) :: sides(2)
    type(body_view_t), intent(in) :: views(2)
    type(model_t), intent(in) :: model
    type(overlap_t) :: found(2)
    character(*), parameter :: what = 'overlaps the slave surface at the start: '
    integer :: k

    do k = 1, 2
      call find_overlap(model, sides(k), sides(3 - k), views(3 - k), .false., found(k))
    end do
    if (all(found%segment == 0)) return
    k = 1
    if (found(2)%depth*found(1)%allowed > found(1)%depth*found(2)%allowed &
      .or. found(1)%segment == 0) k = 2
    call reject_field(deck, entry%places(2), what//depth_text(model, sides(3 - k), found(k)))
  end subroutine check_between

  !> Which place lies how deep, behind what, and how deep it may.
  function depth_text(model, other, found) result(text)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: other
    type(overlap_t), intent(in) :: found
    character(:), allocatable :: text

    text = 'node '//to_text(model%mesh%node_id(found%nodes(1)))
    if (found%nodes(1) /= found%nodes(2)) text = 'a place between nodes ' &
      //to_text(model%mesh%node_id(found%nodes(1)))//' and ' &
      //to_text(model%mesh%node_id(found%nodes(2)))
    text = text//' lies '//to_text(found%depth)//in_units(model%controls%units, 'L') &
      //' deep behind the segment between ' &
      //ends_text(model, other, found%segment)//'; contact takes up less than ' &
      //to_text(found%allowed)//in_units(model%controls%units, 'L') &
      //' there, half of the element behind it'
  end function depth_text

  !> `nodes a and b`, the ends of a segment.
  function ends_text(model, surface, segment) result(text)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: segment
    character(:), allocatable :: text

    associate (ends => surface%nodes(surface%segments(:, segment)))
      text = 'nodes '//to_text(model%mesh%node_id(ends(1)))//' and ' &
        //to_text(model%mesh%node_id(ends(2)))
    end associate
  end function ends_text

end module deck_initial_overlap_m
