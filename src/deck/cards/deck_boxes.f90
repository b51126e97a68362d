! SPDX-License-Identifier: MIT
!> *DEFINE_BOX, and the nodes in a box.
module deck_boxes_m
  use kinds_m, only : wp
  use model_m, only : model_t
  use deck_cards_m, only : cursor_t, first_card, check_rest, report_field
  use deck_fields_m, only : card_t, field_text
  use deck_ids_m, only : a_box
  use deck_lines_m, only : deck_t, blocks_of
  use deck_values_m, only : reals_of, define, map_defined
  implicit none
  private
  public :: read_boxes, mark_box

contains

  !> Read all boxes into `deck%boxes`: (2, 2, n_box) least and largest x and y.
  subroutine read_boxes(deck)
    type(deck_t), intent(inout) :: deck
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer, allocatable :: blocks(:)
    character(3), parameter :: names(2, 2) = reshape(['XMN', 'YMN', 'XMX', 'YMX'], [2, 2])
    real(wp) :: bounds(4)
    integer :: i, k, n

    blocks = blocks_of(deck, 'DEFINE_BOX')
    allocate (deck%boxes(2, 2, size(blocks)))
    do i = 1, size(blocks)
      call first_card(deck, blocks(i), cursor, card)
      call check_rest(deck, cursor)
      call define(deck, a_box, card, n)
      bounds = reals_of(card, 'XMN', 'YMX')
      do k = 1, 2
        if (bounds(2*k) < bounds(2*k - 1)) call report_field(deck, card, names(k, 2), &
          'is below '//names(k, 1)//' "'//field_text(deck, card, 2*k)//'"')
      end do
      if (n > 0) deck%boxes(:, :, n) = reshape(bounds, [2, 2], order=[2, 1])
    end do
    call map_defined(deck, a_box, 'BOXID')
  end subroutine read_boxes

  !> (n_node) Whether a node is in a box, or on its edge.
  pure function mark_box(deck, box, model) result(is_inside)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: box
    type(model_t), intent(in) :: model
    logical :: is_inside(model%mesh%n_node)
    integer :: i

    associate (x => model%mesh%coordinates)
      do i = 1, model%mesh%n_node
        is_inside(i) = all(x(:, i) >= deck%boxes(:, 1, box) .and. x(:, i) <= deck%boxes(:, 2, box))
      end do
    end associate
  end function mark_box

end module deck_boxes_m
