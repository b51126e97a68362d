! SPDX-License-Identifier: MIT
!> Rows of *BOUNDARY_, *LOAD_ and *DAMPING_ cards to conditions on nodes.
module deck_resolve_conditions_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use conditions_m, only : conditions_t, prescribed_motion_t, nodal_load_t, body_load_t, &
    skew_support_t
  use model_m, only : model_t
  use supports_m, only : mark_meshed_nodes
  use deck_lines_m, only : deck_t, place_t, line_warning, line_error
  use deck_cards_m, only : reject_field
  use deck_maps_m, only : maps_t, resolve_id
  use deck_resolve_round_m, only : mark_axis
  use deck_raw_m, only : raw_t, row_t, row_spc_node, row_spc_set, row_motion_node, row_motion_set, &
    row_load_node, row_load_set, row_body, row_damping, id_place
  implicit none
  private
  public :: resolve_conditions, row_nodes, load_axes

contains

  !> Everything but pressures and initial velocities.
  subroutine resolve_conditions(deck, raw, maps, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    logical, allocatable :: fixed(:, :), meshed(:)
    integer, allocatable :: motion_rows(:)

    allocate (fixed(2, model%mesh%n_node), source=.false.)
    meshed = mark_meshed_nodes(model)
    if (raw%lost%elements .or. deck%incomplete) meshed = .true.
    call collect_fixed(deck, raw, maps, model, meshed, fixed)
    where (mark_axis(model)) fixed(1, :) = .true.
    call collect_motions(deck, raw, maps, model, motion_rows)
    call check_motions(deck, raw, model, motion_rows, fixed, meshed)
    call check_skew_supports(deck, raw, model, motion_rows)
    call collect_loads(deck, raw, maps, model, meshed)
    call collect_global(deck, raw, maps, model)
    call list_fixed(fixed, model%conditions)
  end subroutine resolve_conditions

  !> Nodes that a row is about: one node, or those of a set, each once. Empty when the id is wrong.
  subroutine row_nodes(deck, maps, model, row, is_set, nodes)
    type(deck_t), intent(inout) :: deck
    type(maps_t), intent(in) :: maps
    type(model_t), intent(in) :: model
    type(row_t), intent(in) :: row
    logical, intent(in) :: is_set
    integer, allocatable, intent(out) :: nodes(:)
    integer :: found

    if (.not. is_set) then
      call resolve_id(deck, maps%nodes, row%id, 'node', id_place(row), found)
      nodes = pack([found], [found > 0])
      return
    end if
    call resolve_id(deck, maps%node_sets, row%id, 'node set', id_place(row), found)
    allocate (nodes(0))
    if (found > 0) call unique_nodes(model%node_sets(found)%nodes, model%mesh%n_node, nodes)
  end subroutine row_nodes

  !> The nodes of a list, each once.
  pure subroutine unique_nodes(list, n_node, nodes)
    integer, intent(in) :: list(:)
    integer, intent(in) :: n_node
    integer, allocatable, intent(out) :: nodes(:)
    logical, allocatable :: first(:), listed(:)
    integer :: i

    if (size(list) < 2) then
      nodes = list
      return
    end if
    allocate (first(size(list)), listed(n_node), source=.false.)
    do i = 1, size(list)
      first(i) = .not. listed(list(i))
      listed(list(i)) = .true.
    end do
    nodes = pack(list, first)
  end subroutine unique_nodes

  !> Fixed degrees of freedom: codes of *NODE, *BOUNDARY_SPC_, nodes without an element.
  subroutine collect_fixed(deck, raw, maps, model, meshed, fixed)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    logical, intent(in) :: meshed(:)
    logical, intent(inout) :: fixed(:, :)
    integer, allocatable :: nodes(:)
    integer :: i, n_free, first_free
    ! Codes of *NODE, TC: 0 none, 1 x, 2 y, 3 z, 4 xy, 5 yz, 6 zx, 7 xyz.
    logical, parameter :: code_x(0:7) = [.false., .true., .false., .false., .true., .false., &
      .true., .true.]
    logical, parameter :: code_y(0:7) = [.false., .false., .true., .false., .true., .true., &
      .false., .true.]

    n_free = 0
    first_free = 0
    do i = 1, model%mesh%n_node
      if (raw%node_code(i) >= 0 .and. raw%node_code(i) <= 7) &
        fixed(:, i) = [code_x(raw%node_code(i)), code_y(raw%node_code(i))]
      if (meshed(i)) cycle
      fixed(:, i) = .true.
      n_free = n_free + 1
      if (n_free == 1) first_free = i
    end do
    if (n_free > 0 .and. model%mesh%n_element > 0 .and. deck%report%n_error == 0) &
      call line_warning(deck, raw%node_line(first_free), 'free', to_text(n_free) &
      //' node(s) belong to no element and are fixed; the first is ' &
      //to_text(model%mesh%node_id(first_free)))
    do i = 1, raw%n_row
      if (raw%rows(i)%kind /= row_spc_node .and. raw%rows(i)%kind /= row_spc_set) cycle
      call row_nodes(deck, maps, model, raw%rows(i), raw%rows(i)%kind == row_spc_set, nodes)
      if (raw%rows(i)%system /= 0) then
        call fix_along_axes(deck, raw, maps, raw%rows(i), nodes, model%conditions, fixed)
        cycle
      end if
      if (raw%rows(i)%fixed(1)) fixed(1, nodes) = .true.
      if (raw%rows(i)%fixed(2)) fixed(2, nodes) = .true.
    end do
  end subroutine collect_fixed

  !> Fix nodes along the axes of a coordinate system. Axes along x and y, and both of any two, are
  !> plain supports; a node that two skew supports hold does not move at all.
  subroutine fix_along_axes(deck, raw, maps, row, nodes, conditions, fixed)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(row_t), intent(in) :: row
    integer, intent(in) :: nodes(:)
    type(conditions_t), intent(inout) :: conditions
    logical, intent(inout) :: fixed(:, :)
    type(skew_support_t) :: support
    integer :: system, k, j
    real(wp), parameter :: aligned = 1.0e-12_wp

    call resolve_id(deck, maps%systems, row%system, 'coordinate system', &
      place_t(row%line, 1, 'CID'), system)
    if (system == 0 .or. .not. any(row%fixed)) return
    if (all(row%fixed)) then
      fixed(:, nodes) = .true.
      return
    end if
    support%normal = raw%systems(system)%axes(:, merge(1, 2, row%fixed(1)))
    k = maxloc(abs(support%normal), 1)
    if (abs(support%normal(3 - k)) < aligned) then
      fixed(k, nodes) = .true.
      return
    end if
    if (.not. allocated(conditions%skew_supports)) allocate (conditions%skew_supports(0))
    do k = 1, size(nodes)
      support%node = nodes(k)
      do j = size(conditions%skew_supports), 1, -1
        if (conditions%skew_supports(j)%node == nodes(k)) exit
      end do
      if (j == 0) then
        conditions%skew_supports = [conditions%skew_supports, support]
      else
        associate (a => conditions%skew_supports(j)%normal, b => support%normal)
          ! Along two axes; the same axis twice is one.
          if (abs(a(1)*b(2) - a(2)*b(1)) >= aligned) fixed(:, nodes(k)) = .true.
        end associate
      end if
    end do
  end subroutine fix_along_axes

  !> What skew supports ask of the rest of the deck.
  subroutine check_skew_supports(deck, raw, model, rows)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    integer, intent(in) :: rows(:) !! of the motions
    logical :: is_skew(model%mesh%n_node)
    integer :: i, k

    if (.not. allocated(model%conditions%skew_supports)) return
    is_skew = .false.
    is_skew(model%conditions%skew_supports%node) = .true.
    do i = 1, size(rows)
      if (.not. is_skew(model%conditions%motions(i)%node)) cycle
      call reject_field(deck, id_place(raw%rows(rows(i))), ': node ' &
        //to_text(model%mesh%node_id(model%conditions%motions(i)%node)) &
        //' has a support along an axis of a coordinate system (CID) and cannot be moved by this ' &
        //'card too')
      exit
    end do
    if (.not. model%controls%implicit%is_on) return
    do k = 1, raw%n_row
      if (any(raw%rows(k)%kind == [row_spc_node, row_spc_set]) .and. raw%rows(k)%system /= 0) &
        call reject_field(deck, place_t(raw%rows(k)%line, 1, 'CID'), &
        'is a coordinate system of a support, which the implicit method does not have')
    end do
  end subroutine check_skew_supports

  !> The direction of a load in the axes of the model; 0 for a moment.
  subroutine load_axes(deck, raw, maps, row, axis)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(row_t), intent(in) :: row
    real(wp), intent(out) :: axis(2)
    integer :: system

    axis = 0.0_wp
    if (row%direction /= 1 .and. row%direction /= 2) return
    axis(row%direction) = 1.0_wp
    if (row%system == 0) return
    call resolve_id(deck, maps%systems, row%system, 'coordinate system', &
      place_t(row%line, 1, 'CID'), system)
    if (system > 0) axis = raw%systems(system)%axes(:, row%direction)
  end subroutine load_axes

  !> Fixed pairs of node and direction as lists.
  pure subroutine list_fixed(fixed, conditions)
    logical, intent(in) :: fixed(:, :)
    type(conditions_t), intent(inout) :: conditions
    integer :: i, k, n

    n = count(fixed)
    allocate (conditions%fixed_nodes(n), conditions%fixed_directions(n))
    n = 0
    do i = 1, size(fixed, 2)
      do k = 1, 2
        if (.not. fixed(k, i)) cycle
        n = n + 1
        conditions%fixed_nodes(n) = i
        conditions%fixed_directions(n) = k
      end do
    end do
  end subroutine list_fixed

  !> Prescribed motions, node by node.
  subroutine collect_motions(deck, raw, maps, model, rows)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    integer, allocatable, intent(out) :: rows(:)  !! of each motion, in `raw%rows`
    type(prescribed_motion_t), allocatable :: motions(:)
    type(prescribed_motion_t) :: motion
    integer, allocatable :: nodes(:), all_rows(:)
    integer :: i, k, n

    allocate (motions(64), all_rows(64))
    n = 0
    do i = 1, raw%n_row
      if (raw%rows(i)%kind /= row_motion_node .and. raw%rows(i)%kind /= row_motion_set) cycle
      call row_nodes(deck, maps, model, raw%rows(i), raw%rows(i)%kind == row_motion_set, nodes)
      call resolve_id(deck, maps%curves, raw%rows(i)%curve, 'curve', &
        place_t(raw%rows(i)%line, 1, 'LCID'), motion%curve)
      if (motion%curve == 0) cycle
      motion%direction = raw%rows(i)%direction
      motion%kind = raw%rows(i)%motion
      motion%scale = raw%rows(i)%scale
      motion%death = raw%rows(i)%death
      motion%birth = raw%rows(i)%birth
      do k = 1, size(nodes)
        if (n == size(motions)) then
          motions = [motions, motions]
          all_rows = [all_rows, all_rows]
        end if
        n = n + 1
        motion%node = nodes(k)
        motions(n) = motion
        all_rows(n) = i
      end do
    end do
    model%conditions%motions = motions(:n)
    rows = all_rows(:n)
  end subroutine collect_motions

  !> A moved degree of freedom may not be fixed, nor moved twice at one time, nor without mass.
  subroutine check_motions(deck, raw, model, rows, fixed, meshed)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    integer, intent(in) :: rows(:)       !! of each motion, in `raw%rows`
    logical, intent(in) :: fixed(:, :), meshed(:)
    integer, allocatable :: last(:, :), before(:)
    integer :: i, j, told

    allocate (last(2, model%mesh%n_node), before(size(rows)), source=0)
    told = 0
    do i = 1, size(rows)
      associate (motion => model%conditions%motions(i))
        ! Motions of one degree of freedom are chained backwards through `before`.
        before(i) = last(motion%direction, motion%node)
        last(motion%direction, motion%node) = i
        if (rows(i) == told) cycle
        if (.not. meshed(motion%node)) then
          call complain(i, 'belongs to no element, so it has no mass to be moved')
        else if (model%is_round .and. motion%direction == 1 &
          .and. .not. model%mesh%coordinates(1, motion%node) > 0.0_wp) then
          call complain(i, 'lies on the axis (x = 0) of an axisymmetric deck and can not move in r')
        else if (fixed(motion%direction, motion%node)) then
          call complain(i, 'is fixed in this direction and cannot be moved by this card too')
        end if
        j = before(i)
        do while (j > 0 .and. rows(i) /= told)
          if (min(model%conditions%motions(j)%death, motion%death) &
            > max(model%conditions%motions(j)%birth, motion%birth)) call complain(i, &
            'is moved in this direction by another card at the same time (line ' &
            //to_text(deck%number(raw%rows(rows(j))%line))//')')
          j = before(j)
        end do
      end associate
    end do

  contains

    !> One error for each card.
    subroutine complain(k, message)
      integer, intent(in) :: k
      character(*), intent(in) :: message

      told = rows(k)
      call reject_field(deck, id_place(raw%rows(rows(k))), &
        ': node '//to_text(model%mesh%node_id(model%conditions%motions(k)%node))//' '//message)
    end subroutine complain

  end subroutine check_motions

  !> Forces on nodes.
  subroutine collect_loads(deck, raw, maps, model, meshed)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    logical, intent(in) :: meshed(:)
    type(nodal_load_t), allocatable :: loads(:)
    type(nodal_load_t) :: load
    integer, allocatable :: nodes(:)
    real(wp) :: axis(2)
    integer :: i, j, k, n

    allocate (loads(64))
    n = 0
    do i = 1, raw%n_row
      if (raw%rows(i)%kind /= row_load_node .and. raw%rows(i)%kind /= row_load_set) cycle
      call row_nodes(deck, maps, model, raw%rows(i), raw%rows(i)%kind == row_load_set, nodes)
      call resolve_id(deck, maps%curves, raw%rows(i)%curve, 'curve', &
        place_t(raw%rows(i)%line, 1, 'LCID'), load%curve)
      do k = 1, size(nodes)
        if (meshed(nodes(k))) cycle
        call reject_field(deck, id_place(raw%rows(i)), ': node ' &
          //to_text(model%mesh%node_id(nodes(k)))//' belongs to no element and cannot be loaded')
        exit
      end do
      if (load%curve == 0) cycle
      call load_axes(deck, raw, maps, raw%rows(i), axis)
      do k = 1, size(nodes)
        do j = 1, 2
          if (.not. abs(axis(j)) > 0.0_wp) cycle
          if (n == size(loads)) loads = [loads, loads]
          n = n + 1
          load%node = nodes(k)
          load%direction = j
          load%scale = raw%rows(i)%scale*axis(j)
          loads(n) = load
        end do
      end do
    end do
    model%conditions%nodal_loads = loads(:n)
  end subroutine collect_loads

  !> Base accelerations and global damping.
  subroutine collect_global(deck, raw, maps, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    type(body_load_t) :: load
    type(body_load_t), allocatable :: loads(:)
    integer :: i, k, n

    allocate (loads(count(raw%rows(:raw%n_row)%kind == row_body)))
    n = 0
    do i = 1, raw%n_row
      associate (row => raw%rows(i))
        if (row%kind == row_body) then
          call resolve_id(deck, maps%curves, row%curve, 'curve', id_place(row), load%curve)
          load%direction = row%direction
          load%scale = row%scale
          if (load%curve == 0) cycle
          n = n + 1
          loads(n) = load
        else if (row%kind == row_damping) then
          if (allocated(model%conditions%damping)) call line_error(deck, row%line, &
            'is given a second time')
          if (.not. allocated(model%conditions%damping)) allocate (model%conditions%damping)
          if (row%curve > 0) call resolve_id(deck, maps%curves, row%curve, 'curve', &
            id_place(row), model%conditions%damping%curve)
          k = model%conditions%damping%curve
          if (k > 0) then
            if (minval(model%curves(k)%ordinate) < 0.0_wp) call reject_field(deck, id_place(row), &
              'is a curve with values below 0: forces that push along with the velocity would ' &
              //'feed energy')
          end if
          model%conditions%damping%coefficient = row%scale
          model%conditions%damping%factor = row%factor
        end if
      end associate
    end do
    model%conditions%body_loads = loads(:n)
  end subroutine collect_global

end module deck_resolve_conditions_m
