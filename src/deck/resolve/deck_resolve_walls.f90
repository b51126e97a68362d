! SPDX-License-Identifier: MIT
!> The nodes that see each rigid wall.
module deck_resolve_walls_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use rigids_m, only : mark_rigid_nodes
  use supports_m, only : mark_meshed_nodes
  use walls_m, only : wall_t, wall_distance
  use deck_lines_m, only : deck_t, place_t, line_error, line_warning
  use deck_maps_m, only : maps_t, resolve_id
  use deck_raw_m, only : raw_t, raw_wall_t
  implicit none
  private
  public :: resolve_walls

contains

  !> Nodes of all walls, such that an element has. Conditions and rigid bodies have been resolved.
  subroutine resolve_walls(deck, raw, maps, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    logical :: sees(model%mesh%n_node)
    integer :: i, k

    if (size(raw%walls) == 0) return
    if (model%controls%implicit%is_on) call line_error(deck, raw%walls(1)%line, &
      'rigid walls: the implicit method does not have them')
    allocate (model%walls(size(raw%walls)))
    do i = 1, size(raw%walls)
      model%walls(i) = raw%walls(i)%wall
      call find_nodes(deck, raw%walls(i), maps, model, sees)
      if (.not. (raw%lost%elements .or. deck%incomplete)) sees = sees .and. mark_meshed_nodes(model)
      if (raw%walls(i)%reach > 0.0_wp) then
        do k = 1, size(sees)
          sees(k) = sees(k) .and. wall_distance(model%walls(i), model%mesh%coordinates(:, k), &
            [0.0_wp, 0.0_wp]) <= raw%walls(i)%reach
        end do
      end if
      model%walls(i)%nodes = pack([(k, k=1, model%mesh%n_node)], sees)
      call look_at_nodes(deck, raw%walls(i)%line, model, model%walls(i))
      call look_at_motions(deck, raw%walls(i)%line, model, model%walls(i))
    end do
    call number_walls(model%walls)
  end subroutine resolve_walls

  !> Numbers of walls that have none (0): the position in the deck, or the next number that is free.
  pure subroutine number_walls(walls)
    type(wall_t), intent(inout) :: walls(:)
    logical :: is_taken(2*size(walls))
    integer :: i, k

    is_taken = .false.
    do i = 1, size(walls)
      if (walls(i)%id > 0 .and. walls(i)%id <= size(is_taken)) is_taken(walls(i)%id) = .true.
    end do
    do i = 1, size(walls)
      if (walls(i)%id > 0) cycle
      k = findloc(is_taken(i:), .false., 1) + i - 1
      walls(i)%id = k
      is_taken(k) = .true.
    end do
  end subroutine number_walls

  !> NSID without NSIDEX and nodes of rigid bodies.
  subroutine find_nodes(deck, entry, maps, model, sees)
    type(deck_t), intent(inout) :: deck
    type(raw_wall_t), intent(in) :: entry
    type(maps_t), intent(in) :: maps
    type(model_t), intent(in) :: model
    logical, intent(out) :: sees(:)
    integer :: k

    sees = entry%sets(1) == 0
    if (entry%sets(1) > 0) then
      call resolve_id(deck, maps%node_sets, entry%sets(1), 'node set', &
        place_t(entry%card_line, 1, 'NSID'), k)
      if (k > 0) sees(known(model%node_sets(k)%nodes)) = .true.
    end if
    if (entry%sets(2) > 0) then
      call resolve_id(deck, maps%node_sets, entry%sets(2), 'node set', &
        place_t(entry%card_line, 1, 'NSIDEX'), k)
      if (k > 0) sees(known(model%node_sets(k)%nodes)) = .false.
    end if
    if (any(sees .and. mark_rigid_nodes(model%rigids, size(sees)))) then
      call line_warning(deck, entry%line, 'wall and rigid body'//to_text(entry%line), &
        to_text(count(sees .and. mark_rigid_nodes(model%rigids, size(sees)))) &
        //' node(s) of rigid bodies do not see the wall')
      sees = sees .and. .not. mark_rigid_nodes(model%rigids, size(sees))
    end if
  end subroutine find_nodes

  !> Nodes that are there: those of a set that are not have been reported.
  pure function known(nodes) result(those)
    integer, intent(in) :: nodes(:)
    integer, allocatable :: those(:)

    those = pack(nodes, nodes > 0)
  end function known

  !> A wall without nodes, and nodes that start behind it.
  subroutine look_at_nodes(deck, line, model, wall)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line
    type(model_t), intent(in) :: model
    type(wall_t), intent(in) :: wall
    real(wp) :: size_of_mesh
    integer :: i, n, first

    if (size(wall%nodes) == 0) call line_warning(deck, line, 'wall'//to_text(line), &
      'no node sees this wall')
    size_of_mesh = maxval(abs(model%mesh%coordinates))
    n = 0
    first = 0
    do i = 1, size(wall%nodes)
      if (wall_distance(wall, model%mesh%coordinates(:, wall%nodes(i)), [0.0_wp, 0.0_wp]) &
        >= -1.0e-12_wp*size_of_mesh) cycle
      n = n + 1
      if (first == 0) first = wall%nodes(i)
    end do
    if (n > 0) call line_warning(deck, line, 'behind the wall'//to_text(line), to_text(n) &
      //' node(s) start behind the wall, the first is '//to_text(model%mesh%node_id(first)) &
      //': they are kept from going further, not brought back')
  end subroutine look_at_nodes

  !> Nodes that can not give way: wherever the wall pushes, a motion is prescribed or the
  !> node is fixed. Nodes that are fixed in all such directions never come nearer, so they
  !> are no reason for a warning.
  subroutine look_at_motions(deck, line, model, wall)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line
    type(model_t), intent(in) :: model
    type(wall_t), intent(in) :: wall
    logical :: is_free(2, model%mesh%n_node), is_moved(model%mesh%n_node)
    integer, allocatable :: blind(:)
    integer :: i

    is_free = spread(abs(wall%normal) > 0.0_wp, 2, model%mesh%n_node)
    is_moved = .false.
    associate (conditions => model%conditions)
      do i = 1, size(conditions%fixed_nodes)
        is_free(conditions%fixed_directions(i), conditions%fixed_nodes(i)) = .false.
      end do
      do i = 1, size(conditions%motions)
        associate (motion => conditions%motions(i))
          is_moved(motion%node) = is_moved(motion%node) .or. is_free(motion%direction, motion%node)
        end associate
      end do
      do i = 1, size(conditions%motions)
        is_free(conditions%motions(i)%direction, conditions%motions(i)%node) = .false.
      end do
    end associate
    is_moved = is_moved .and. .not. any(is_free, 1)
    blind = pack(wall%nodes, is_moved(wall%nodes))
    if (size(blind) > 0) call line_warning(deck, line, 'wall and motion'//to_text(line), &
      to_text(size(blind))//' node(s) do not see the wall while their motion is prescribed ' &
      //'(*BOUNDARY_PRESCRIBED_MOTION), the first is '//to_text(model%mesh%node_id(blind(1))) &
      //': they pass through it')
  end subroutine look_at_motions

end module deck_resolve_walls_m
