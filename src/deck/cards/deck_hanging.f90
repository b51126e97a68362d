! SPDX-License-Identifier: MIT
!> *CONSTRAINED_ADAPTIVITY: hanging nodes of locally refined meshes. A node in the middle of an edge
!> of a larger element moves with the mean of the ends of the edge, its parents, which hang on no
!> other node.
module deck_hanging_m
  use conditions_m, only : conditions_t
  use deck_cards_m, only : cursor_t, next_of, report_field, reject_field
  use deck_fields_m, only : card_t
  use deck_ids_m, only : a_node, an_element
  use deck_lines_m, only : deck_t, location_t, blocks_of, line_error
  use deck_values_m, only : find_id
  use kinds_m, only : wp
  use log_m, only : to_text
  use mesh_m, only : mesh_t
  use model_m, only : model_t, mark_meshed_nodes
  implicit none
  private
  public :: read_hanging_nodes, check_hanging_nodes

  !> Largest distance of a hanging node from the middle of its edge, over the length of the edge.
  real(wp), parameter :: off_middle = 1.0e-3_wp

contains

  !> Read the hanging nodes; report nodes that hang twice, on a hanging node, or outside the middle
  !> of their edge. Nodes and elements have been read.
  subroutine read_hanging_nodes(deck, model, lines)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    integer, allocatable, intent(out) :: lines(:) !! of the card of each hanging node
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer :: found(3), k, n
    logical :: is_meshed(model%mesh%n_node)

    allocate (lines(0))
    if (size(blocks_of(deck, 'CONSTRAINED_ADAPTIVITY')) == 0) return
    allocate (model%mesh%hanging(3, 64))
    is_meshed = mark_meshed_nodes(model) .or. deck%maps(an_element)%has_refused
    n = 0
    do while (next_of(deck, 'CONSTRAINED_ADAPTIVITY', cursor, card))
      if (any(card%bad)) cycle
      call find_id(deck, a_node, card, 'DNID', found(1))
      call find_id(deck, a_node, card, 'NID1', found(2))
      call find_id(deck, a_node, card, 'NID2', found(3))
      if (any(found < 1)) cycle
      do k = 1, 3
        if (.not. is_meshed(found(k))) call report_field(deck, card, k, 'belongs to no element')
      end do
      if (any([found(1) == found(2:3), found(2) == found(3)])) then
        call report_field(deck, card, 'DNID', &
          'and its parents NID1 and NID2 must be three different nodes')
      else if (norm2(misplacement(model%mesh, found)) > off_middle) then
        call report_field(deck, card, 'DNID', 'is not in the middle between NID1 and NID2')
      end if
      if (any(card%bad)) cycle
      if (n == size(model%mesh%hanging, 2)) model%mesh%hanging = &
        reshape(model%mesh%hanging, [3, 2*n], pad=[0])
      n = n + 1
      model%mesh%hanging(:, n) = found
      lines = [lines, card%line]
    end do
    model%mesh%hanging = model%mesh%hanging(:, :n)
    call refuse_chains(deck, model%mesh, lines)
  end subroutine read_hanging_nodes

  !> Distance of a node from the middle between two others, over their distance.
  pure function misplacement(mesh, nodes) result(offset)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: nodes(3)
    real(wp) :: offset(2)

    associate (x => mesh%coordinates(:, nodes))
      offset = (x(:, 1) - 0.5_wp*(x(:, 2) + x(:, 3)))/max(norm2(x(:, 3) - x(:, 2)), tiny(1.0_wp))
    end associate
  end function misplacement

  !> Report nodes that hang twice, and parents that hang.
  subroutine refuse_chains(deck, mesh, lines)
    type(deck_t), intent(inout) :: deck
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: lines(:)
    integer :: card_of(mesh%n_node), i, k

    card_of = 0
    do i = 1, size(lines)
      associate (node => mesh%hanging(1, i))
        if (card_of(node) > 0) call reject_field(deck, location_t(lines(i), 1, 'DNID'), &
          'hangs already (line '//to_text(deck%number(lines(card_of(node))))//')')
        card_of(node) = i
      end associate
    end do
    do i = 1, size(lines)
      do k = 2, 3
        associate (other => card_of(mesh%hanging(k, i)))
          if (other > 0) call reject_field(deck, location_t(lines(i), 1, merge('NID1', 'NID2', &
            k == 2)), 'hangs itself (line '//to_text(deck%number(lines(other))) &
            //'): neighbouring elements must not differ by more than one division')
        end associate
      end do
    end do
  end subroutine refuse_chains

  !> Check hanging nodes against all else that moves them, one error for each card. Supports that
  !> both parents have too, and rigid walls of both parents, are left to the parents. The whole
  !> model has been read.
  subroutine check_hanging_nodes(deck, lines, owner, model)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: lines(:)         !! of the card of each hanging node
    integer, intent(in) :: owner(:)         !! (n_node) rigid body or 0
    type(model_t), intent(inout) :: model
    character(:), allocatable :: reason
    integer :: i

    if (size(lines) == 0) return
    if (model%erodes) call line_error(deck, lines(1), &
      'is a hanging node, which this version does not have with elements that may erode')
    if (abs(model%controls%mass_step) > 0.0_wp .and. .not. model%controls%masses_stay) call &
      line_error(deck, lines(1), 'is a hanging node, which this version does not have with mass ' &
      //'scaling during the run (DT2MS); set MS1ST 1')
    call follow_walls(model)
    call follow_supports(model%mesh%hanging, model%conditions)
    do i = 1, size(lines)
      reason = obstacle(model, owner, model%mesh%hanging(:, i))
      if (len(reason) > 0) call reject_field(deck, location_t(lines(i), 1, 'DNID'), reason)
    end do
  end subroutine check_hanging_nodes

  !> What a hanging node has that its parents cannot have for it, in words; empty where nothing.
  function obstacle(model, owner, nodes) result(reason)
    type(model_t), intent(in) :: model
    integer, intent(in) :: owner(:), nodes(3)
    character(:), allocatable :: reason
    integer :: i

    reason = ''
    associate (conditions => model%conditions, node => nodes(1))
      if (any(conditions%fixed_nodes == node)) &
        reason = 'is fixed in a direction in which not both of its parents are'
      if (any(conditions%motions%node == node)) reason = 'has a prescribed motion; move its parents'
      if (allocated(conditions%skew_supports)) then
        if (any(conditions%skew_supports%node == node)) &
          reason = 'has a support along an axis of a coordinate system (CID); support its parents'
      end if
      if (allocated(conditions%common_motions)) then
        do i = 1, size(conditions%common_motions)
          if (any(conditions%common_motions(i)%nodes == node)) &
            reason = 'belongs to a *CONSTRAINED_NODE_SET'
        end do
      end if
      if (any(owner(nodes) > 0)) reason = 'or one of its parents belongs to a rigid part'
      if (allocated(model%walls)) then
        do i = 1, size(model%walls)
          if (any(model%walls(i)%nodes == node)) reason = 'touches rigid wall ' &
            //to_text(model%walls(i)%id)//', and not both of its parents do'
        end do
      end if
      do i = 1, size(model%contacts)
        if (any(model%contacts(i)%slave%nodes == node) .or. &
          any(model%contacts(i)%master%nodes == node)) reason = 'is in a surface of interface ' &
          //to_text(model%contacts(i)%id)//'; refine contact surfaces as a whole'
      end do
    end associate
  end function obstacle

  !> Remove hanging nodes from walls of both parents: they are not behind them if these are not.
  subroutine follow_walls(model)
    type(model_t), intent(inout) :: model
    logical :: is_there(model%mesh%n_node)
    integer :: i

    if (.not. allocated(model%walls)) return
    do i = 1, size(model%walls)
      associate (wall => model%walls(i), hanging => model%mesh%hanging)
        is_there = .false.
        is_there(wall%nodes) = .true.
        is_there(pack(hanging(1, :), is_there(hanging(2, :)) .and. is_there(hanging(3, :)))) &
          = .false.
        wall%nodes = pack(wall%nodes, is_there(wall%nodes))
      end associate
    end do
  end subroutine follow_walls

  !> Remove the supports of hanging nodes that both parents have.
  subroutine follow_supports(hanging, conditions)
    integer, intent(in) :: hanging(:, :) !! as in mesh_t
    type(conditions_t), intent(inout) :: conditions
    logical, allocatable :: is_fixed(:, :), is_left(:)
    integer :: i

    associate (nodes => conditions%fixed_nodes, directions => conditions%fixed_directions)
      allocate (is_fixed(2, max(maxval(nodes), maxval(hanging))), source=.false.)
      do i = 1, size(nodes)
        is_fixed(directions(i), nodes(i)) = .true.
      end do
      do i = 1, size(hanging, 2)
        is_fixed(:, hanging(1, i)) = is_fixed(:, hanging(1, i)) &
          .and. .not. (is_fixed(:, hanging(2, i)) .and. is_fixed(:, hanging(3, i)))
      end do
      is_left = [(is_fixed(directions(i), nodes(i)), i=1, size(nodes))]
    end associate
    conditions%fixed_directions = pack(conditions%fixed_directions, is_left)
    conditions%fixed_nodes = pack(conditions%fixed_nodes, is_left)
  end subroutine follow_supports

end module deck_hanging_m
