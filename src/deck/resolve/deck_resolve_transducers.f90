! SPDX-License-Identifier: MIT
!> Force transducers: nodes in place of their sets.
module deck_resolve_transducers_m
  use log_m, only : to_text
  use model_m, only : model_t
  use deck_lines_m, only : deck_t, line_warning
  use deck_raw_m, only : raw_t
  use deck_resolve_sides_m, only : require_side, side_parts, side_nodes, side_segments
  implicit none
  private
  public :: resolve_transducers

contains

  !> Of each surface the nodes that interfaces have: no others carry contact forces. Called with the
  !> interfaces of the model known.
  subroutine resolve_transducers(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model
    logical, allocatable :: touches(:), is_on(:)
    integer :: i, k

    if (size(raw%transducers) == 0) return
    allocate (model%transducers(size(raw%transducers)))
    allocate (touches(model%mesh%n_node), source=.false.)
    allocate (is_on(model%mesh%n_node))
    do i = 1, size(model%contacts)
      touches(model%contacts(i)%slave%nodes) = .true.
      touches(model%contacts(i)%master%nodes) = .true.
    end do
    do i = 1, size(raw%transducers)
      call mark_surface(deck, raw, i, model, is_on)
      associate (transducer => model%transducers(i), entry => raw%transducers(i))
        transducer%id = entry%contact%id
        transducer%title = entry%contact%title
        transducer%nodes = pack([(k, k=1, size(is_on))], is_on .and. touches)
        if (size(transducer%nodes) == 0) call line_warning(deck, deck%blocks(entry%block)%keyword, &
          'transducer'//to_text(entry%contact%id), 'no interface has nodes of the surface of ' &
          //'transducer '//to_text(entry%contact%id)//': it measures nothing')
      end associate
    end do
  end subroutine resolve_transducers

  !> The nodes of one surface; of parts all, since the inner ones carry no contact.
  subroutine mark_surface(deck, raw, i, model, is_on)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    integer, intent(in) :: i
    type(model_t), intent(in) :: model
    logical, intent(inout) :: is_on(:)
    logical :: is_of_part(size(model%parts))
    integer :: kind, found, k

    is_on = .false.
    call require_side(deck, raw%transducers(i), 1, kind, found)
    select case (kind)
    case (side_parts)
      is_of_part = .false.
      is_of_part(model%part_sets(found)%parts) = .true.
      do k = 1, model%mesh%n_element
        if (is_of_part(model%mesh%element_part(k))) is_on(model%mesh%element_nodes(:, k)) = .true.
      end do
    case (side_nodes)
      is_on(model%node_sets(found)%nodes) = .true.
    case (side_segments)
      is_on(model%segment_sets(found)%nodes(1, :)) = .true.
      is_on(model%segment_sets(found)%nodes(2, :)) = .true.
    end select
  end subroutine mark_surface

end module deck_resolve_transducers_m
