! SPDX-License-Identifier: MIT
!> Initial velocities: *INITIAL_VELOCITY and _NODE in deck order, then _GENERATION in deck order.
module deck_resolve_velocity_m
  use kinds_m, only : wp
  use deck_cards_m, only : reject_field
  use model_m, only : model_t
  use deck_lines_m, only : deck_t, place_t
  use deck_maps_m, only : maps_t, resolve_id
  use deck_raw_m, only : raw_t, row_t, row_velocity, row_velocity_generation, id_place
  implicit none
  private
  public :: resolve_velocity

contains

  !> Fill `initial_velocity` when the deck asks for any.
  subroutine resolve_velocity(deck, raw, maps, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    real(wp), allocatable :: velocity(:, :)
    integer :: i, next

    if (raw%n_node_velocity == 0 .and. .not. any(raw%rows(:raw%n_row)%kind == row_velocity &
      .or. raw%rows(:raw%n_row)%kind == row_velocity_generation)) return
    allocate (velocity(2, model%mesh%n_node), source=0.0_wp)
    next = 1
    do i = 1, raw%n_row
      if (raw%rows(i)%kind /= row_velocity) cycle
      call set_node_velocities(deck, raw, maps, i - 1, next, velocity)
      call set_velocity(deck, maps, model, raw%rows(i), velocity)
    end do
    call set_node_velocities(deck, raw, maps, raw%n_row, next, velocity)
    do i = 1, raw%n_row
      if (raw%rows(i)%kind == row_velocity_generation) &
        call generate_velocity(deck, maps, model, raw%rows(i), velocity)
    end do
    call move_alloc(velocity, model%conditions%initial_velocity)
  end subroutine resolve_velocity

  !> *INITIAL_VELOCITY_NODE: the cards with at most `n_row` rows before
  !> them; `next` moves past them.
  subroutine set_node_velocities(deck, raw, maps, n_row, next, velocity)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    integer, intent(in) :: n_row
    integer, intent(inout) :: next
    real(wp), intent(inout) :: velocity(:, :)
    integer :: found

    do while (next <= raw%n_node_velocity)
      associate (card => raw%node_velocities(next))
        if (card%n_row > n_row) return
        call resolve_id(deck, maps%nodes, card%node, 'node', place_t(card%line, 1, 'NID'), found)
        if (found > 0) velocity(:, found) = card%velocity
      end associate
      next = next + 1
    end do
  end subroutine set_node_velocities

  !> *INITIAL_VELOCITY: a set or all nodes, less those of a second set, which have a velocity of
  !> their own.
  subroutine set_velocity(deck, maps, model, row, velocity)
    type(deck_t), intent(inout) :: deck
    type(maps_t), intent(in) :: maps
    type(model_t), intent(in) :: model
    type(row_t), intent(in) :: row
    real(wp), intent(inout) :: velocity(:, :)
    logical, allocatable :: chosen(:)
    integer :: found, i

    if (model%is_round .and. abs(row%spin) > 0.0_wp) call reject_field(deck, &
      place_t(row%line, 1, 'OMEGA'), 'turns bodies of revolution out of their plane: ' &
      //'axisymmetric parts take no spin')
    allocate (chosen(model%mesh%n_node), source=row%id == 0)
    if (row%id > 0) then
      call resolve_id(deck, maps%node_sets, row%id, 'node set', id_place(row), found)
      if (found > 0) chosen(model%node_sets(found)%nodes) = .true.
    end if
    if (row%others > 0) then
      call resolve_id(deck, maps%node_sets, row%others, 'node set', &
        place_t(row%line, 1, 'NSIDEX'), found)
      if (found > 0) then
        chosen(model%node_sets(found)%nodes) = .false.
        do i = 1, size(model%node_sets(found)%nodes)
          velocity(:, model%node_sets(found)%nodes(i)) = row%other_velocity
        end do
      end if
    end if
    do i = 1, model%mesh%n_node
      if (chosen(i)) velocity(:, i) = row%velocity(:2)
    end do
  end subroutine set_velocity

  !> *INITIAL_VELOCITY_GENERATION: translation and spin about an axis along z.
  subroutine generate_velocity(deck, maps, model, row, velocity)
    type(deck_t), intent(inout) :: deck
    type(maps_t), intent(in) :: maps
    type(model_t), intent(in) :: model
    type(row_t), intent(in) :: row
    real(wp), intent(inout) :: velocity(:, :)
    logical, allocatable :: chosen(:), chosen_part(:)
    integer :: found, i, k

    if (model%is_round .and. abs(row%spin) > 0.0_wp) call reject_field(deck, &
      place_t(row%line, 1, 'OMEGA'), 'turns bodies of revolution out of their plane: ' &
      //'axisymmetric parts take no spin')
    allocate (chosen(model%mesh%n_node), source=row%id == 0)
    allocate (chosen_part(0:size(model%parts)), source=.false.)
    if (row%id > 0) then
      select case (row%set_kind)
      case (1)
        call resolve_id(deck, maps%part_sets, row%id, 'part set', id_place(row), found)
        if (found > 0) chosen_part(model%part_sets(found)%parts) = .true.
      case (2)
        call resolve_id(deck, maps%parts, row%id, 'part', id_place(row), found)
        if (found > 0) chosen_part(found) = .true.
      case default
        call resolve_id(deck, maps%node_sets, row%id, 'node set', id_place(row), found)
        if (found > 0) chosen(model%node_sets(found)%nodes) = .true.
      end select
    end if
    do i = 1, model%mesh%n_element
      if (.not. chosen_part(model%mesh%element_part(i))) cycle
      do k = 1, 4
        if (model%mesh%element_nodes(k, i) > 0) chosen(model%mesh%element_nodes(k, i)) = .true.
      end do
    end do
    do i = 1, model%mesh%n_node
      if (.not. chosen(i)) cycle
      velocity(1, i) = row%velocity(1) - row%spin*(model%mesh%coordinates(2, i) - row%centre(2))
      velocity(2, i) = row%velocity(2) + row%spin*(model%mesh%coordinates(1, i) - row%centre(1))
    end do
  end subroutine generate_velocity

end module deck_resolve_velocity_m
