! SPDX-License-Identifier: MIT
!> Pressure loads on outer edges of the mesh.
module deck_resolve_pressures_m
  use boundary_m, only : boundary_t, find_edge
  use conditions_m, only : pressure_load_t
  use deck_cards_m, only : reject_field
  use deck_lines_m, only : deck_t, place_t
  use deck_maps_m, only : maps_t, resolve_id
  use deck_raw_m, only : raw_t, row_t, row_pressure, row_pressure_set, id_fields, id_place
  use log_m, only : to_text
  use model_m, only : model_t
  implicit none
  private
  public :: resolve_pressures

  !> Fields of the ends of an edge.
  character(2), parameter :: node_fields(2) = ['N1', 'N2']

contains

  !> All of them, their edges walked counter-clockwise round the body.
  subroutine resolve_pressures(deck, raw, maps, outside, model, in_doubt)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(boundary_t), intent(in) :: outside
    type(model_t), intent(inout) :: model
    logical, intent(in), optional :: in_doubt(:) !! (n_node) edges of these are not judged
    type(pressure_load_t), allocatable :: loads(:)
    integer, allocatable :: edges(:, :)
    integer :: i, k, n, found, curve

    allocate (loads(64))
    n = 0
    do i = 1, raw%n_row
      associate (row => raw%rows(i))
        if (all(row%kind /= [row_pressure, row_pressure_set])) cycle
        if (row%kind == row_pressure) then
          edges = reshape([0, 0], [2, 1])
          do k = 1, 2
            call resolve_id(deck, maps%nodes, row%nodes(k), 'node', &
              place_t(row%line, 1, node_fields(k)), edges(k, 1))
          end do
          if (any(edges == 0)) edges = edges(:, :0)
        else
          call resolve_id(deck, maps%segment_sets, row%id, 'segment set', id_place(row), found)
          edges = reshape([integer ::], [2, 0])
          if (found > 0) edges = model%segment_sets(found)%nodes
        end if
        call resolve_id(deck, maps%curves, row%curve, 'curve', place_t(row%line, 1, 'LCID'), curve)
        if (present(in_doubt)) edges = edges(:, pack([(k, k=1, size(edges, 2))], &
          [(.not. any(in_doubt(edges(:, k))), k=1, size(edges, 2))]))
        call add_pressures(deck, row, curve, edges, outside, model, loads, n)
      end associate
    end do
    model%conditions%pressures = loads(:n)
  end subroutine resolve_pressures

  !> Pressure of one card on its edges.
  subroutine add_pressures(deck, row, curve, edges, outside, model, loads, n)
    type(deck_t), intent(inout) :: deck
    type(row_t), intent(in) :: row
    integer, intent(in) :: curve         !! 0 where the deck has it not
    integer, intent(in) :: edges(:, :)
    type(boundary_t), intent(in) :: outside
    type(model_t), intent(in) :: model
    type(pressure_load_t), allocatable, intent(inout) :: loads(:)
    integer, intent(inout) :: n          !! loads so far
    type(pressure_load_t) :: load
    integer :: i

    load%curve = curve
    load%scale = row%scale
    load%arrival = row%arrival
    do i = 1, size(edges, 2)
      if (find_edge(outside, edges(1, i), edges(2, i)) > 0) then
        load%nodes = edges(:, i)
      else if (find_edge(outside, edges(2, i), edges(1, i)) > 0) then
        load%nodes = edges([2, 1], i)
      else
        call reject_field(deck, place_t(row%line, 1, merge('N1  ', &
          id_fields(row%kind), row%kind == row_pressure)), ': nodes ' &
          //to_text(model%mesh%node_id(edges(1, i)))//' and ' &
          //to_text(model%mesh%node_id(edges(2, i)))//' are not the ends of an outer edge of ' &
          //'the mesh')
        return
      end if
      if (n == size(loads)) loads = [loads, loads]
      n = n + 1
      loads(n) = load
    end do
  end subroutine add_pressures

end module deck_resolve_pressures_m
