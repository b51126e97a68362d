! SPDX-License-Identifier: MIT
!> Constraints and prescribed motion of nodes and rigid bodies: TC of *NODE, *BOUNDARY_SPC_,
!> *BOUNDARY_PRESCRIBED_MOTION_ and *CONSTRAINED_NODE_SET.
module deck_supports_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use conditions_m, only : prescribed_motion_t, skew_support_t, common_motion_t, &
    motion_acceleration
  use model_m, only : model_t, mark_meshed_nodes
  use rigids_m, only : mark_rigid_nodes
  use deck_cards_m, only : cursor_t, next_of, report_field, reject_field
  use deck_fields_m, only : card_t
  use deck_ids_m, only : a_node, an_element, a_part, a_curve, a_node_set, a_system
  use deck_lines_m, only : deck_t, location_t, blocks_of, line_warning, line_error
  use deck_sets_m, only : remove_duplicates
  use deck_values_m, only : integer_of, real_of, has_field, read_active_time, find_id, along_axes
  implicit none
  private
  public :: read_supports, read_motions, read_common_motions, card_nodes, find_body, mark_axis, &
    mark_nodes_with_mass, mark_constrained, warn_of_nodes

  !> Message about motion of a rigid body in an axisymmetric deck.
  character(*), parameter, public :: across_axis = 'asks a rigid body of an axisymmetric deck ' &
    //'(ELFORM 15) to move in r or to rotate; it can move along the axis only'

contains

  !> Nodes of NID or NSID of a card, each once; empty where the id is wrong.
  subroutine card_nodes(deck, card, model, nodes)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(in) :: model
    integer, allocatable, intent(out) :: nodes(:)
    integer :: found

    if (has_field(card, 'NSID')) then
      call find_id(deck, a_node_set, card, 'NSID', found)
      allocate (nodes(0))
      if (found > 0) call remove_duplicates(model%node_sets(found)%nodes, model%mesh%n_node, nodes)
    else
      call find_id(deck, a_node, card, 'NID', found)
      nodes = pack([found], [found > 0])
    end if
  end subroutine card_nodes

  !> Index of the rigid body of PID; 0 with an error where there is none.
  subroutine find_body(deck, card, model, advice, body)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(in) :: model
    character(*), intent(in) :: advice !! end of the message
    integer, intent(out) :: body
    integer :: part

    body = 0
    call find_id(deck, a_part, card, 'PID', part)
    if (part == 0) return
    if (model%parts(part)%material == 0) return
    body = findloc(model%rigids%part, part, dim=1)
    if (body == 0) call report_field(deck, card, 'PID', 'is not a rigid part (*MAT_RIGID)'//advice)
  end subroutine find_body

  !> Warn of a list of nodes, unless it is empty: their number and the first of them.
  subroutine warn_of_nodes(deck, line, key, model, nodes, text, advice)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line
    character(*), intent(in) :: key
    type(model_t), intent(in) :: model
    integer, intent(in) :: nodes(:)
    character(*), intent(in) :: text, advice !! before their number, and after the first node

    if (size(nodes) > 0) call line_warning(deck, line, key, text//': ' &
      //to_text(size(nodes))//', the first at node '//to_text(model%mesh%node_id(nodes(1)))//advice)
  end subroutine warn_of_nodes

  !> (n_node) Whether a node lies on the axis of an axisymmetric model.
  pure function mark_axis(model) result(is_there)
    type(model_t), intent(in) :: model
    logical :: is_there(model%mesh%n_node)

    is_there = .false.
    if (model%is_axisymmetric) is_there = .not. model%mesh%coordinates(1, :) > 0.0_wp
  end function mark_axis

  !> (n_node) Whether a node belongs to an element; true where elements have been refused.
  pure function mark_nodes_with_mass(deck, model) result(has_mass)
    type(deck_t), intent(in) :: deck
    type(model_t), intent(in) :: model
    logical :: has_mass(model%mesh%n_node)

    has_mass = deck%maps(an_element)%has_refused
    if (.not. deck%maps(an_element)%has_refused) has_mass = mark_meshed_nodes(model)
  end function mark_nodes_with_mass

  !> Read fixed degrees of freedom: TC of *NODE, *BOUNDARY_SPC_, nodes without an element.
  subroutine read_supports(deck, codes, owner, model, fixed)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: codes(:), owner(:) !! (n_node) TC, rigid body or 0
    type(model_t), intent(inout) :: model
    logical, allocatable, intent(out) :: fixed(:, :) !! (2, n_node)
    type(cursor_t) :: cursor
    type(card_t) :: card
    logical :: is_free(model%mesh%n_node), along(2)
    integer, allocatable :: nodes(:)
    integer :: i

    is_free = .not. mark_nodes_with_mass(deck, model)
    allocate (fixed(2, model%mesh%n_node), source=.false.)
    do i = 1, model%mesh%n_node
      if (codes(i) >= 0 .and. codes(i) <= 7) fixed(:, i) = along_axes(:2, codes(i))
      if (any(fixed(:, i))) call refuse_rigid(deck, location_t(deck%maps(a_node)%lines(i), 1, &
        'TC'), [i], owner, model, 'CON1 and CON2 of *MAT_RIGID hold the body')
      if (is_free(i)) fixed(:, i) = .true.
    end do
    nodes = pack([(i, i=1, size(is_free))], is_free .and. model%mesh%n_element > 0 &
      .and. deck%report%n_error == 0)
    if (size(nodes) > 0) call warn_of_nodes(deck, deck%maps(a_node)%lines(nodes(1)), 'free', &
      model, nodes, 'nodes that belong to no element and are fixed', '')
    do while (next_of(deck, 'BOUNDARY_SPC_', cursor, card))
      if (any(card%bad)) cycle
      call card_nodes(deck, card, model, nodes)
      along = [integer_of(card, 'DOFX'), integer_of(card, 'DOFY')] == 1
      if (any(along)) call refuse_rigid(deck, location_t(card%line, 1, field=1), nodes, owner, &
        model, 'CON1 and CON2 of *MAT_RIGID hold the body')
      if (integer_of(card, 'CID') /= 0) then
        call fix_along_axes(deck, card, along, nodes, model, fixed)
      else
        fixed(1, nodes) = fixed(1, nodes) .or. along(1)
        fixed(2, nodes) = fixed(2, nodes) .or. along(2)
      end if
    end do
    where (mark_axis(model)) fixed(1, :) = .true.
    associate (conditions => model%conditions, n => model%mesh%n_node)
      conditions%fixed_nodes = pack(spread([(i, i=1, n)], 1, 2), fixed)
      conditions%fixed_directions = pack(spread([1, 2], 2, n), fixed)
    end associate
  end subroutine read_supports

  !> Fix nodes along axes of a coordinate system. Axes parallel to x or y, and both axes, give
  !> ordinary constraints; a node with two skew supports is fixed.
  subroutine fix_along_axes(deck, card, along, nodes, model, fixed)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    logical, intent(in) :: along(2)
    integer, intent(in) :: nodes(:)
    type(model_t), intent(inout) :: model
    logical, intent(inout) :: fixed(:, :)
    type(skew_support_t) :: support
    integer :: system, k, j
    real(wp), parameter :: aligned = 1.0e-12_wp

    call find_id(deck, a_system, card, 'CID', system)
    if (system == 0 .or. .not. any(along)) return
    if (all(along)) then
      fixed(:, nodes) = .true.
      return
    end if
    support%normal = deck%axes(:, merge(1, 2, along(1)), system)
    k = maxloc(abs(support%normal), 1)
    if (abs(support%normal(3 - k)) < aligned) then
      fixed(k, nodes) = .true.
      return
    end if
    if (model%controls%implicit%is_on) call report_field(deck, card, 'CID', &
      'is a coordinate system of a support, which the implicit method does not have')
    associate (conditions => model%conditions)
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
            ! Two different axes.
            if (abs(a(1)*b(2) - a(2)*b(1)) >= aligned) fixed(:, nodes(k)) = .true.
          end associate
        end if
      end do
    end associate
  end subroutine fix_along_axes

  !> Report constraints and motion of nodes of rigid bodies, one error for each card. (LS-DYNA
  !> ignores them or applies them to the body, depending on its version.)
  subroutine refuse_rigid(deck, location, nodes, owner, model, advice)
    type(deck_t), intent(inout) :: deck
    type(location_t), intent(in) :: location
    integer, intent(in) :: nodes(:), owner(:)
    type(model_t), intent(in) :: model
    character(*), intent(in) :: advice
    integer :: i

    i = findloc(owner(nodes) > 0, .true., dim=1)
    if (i > 0) call reject_field(deck, location, ': node '//to_text(model%mesh%node_id(nodes(i))) &
      //' belongs to rigid part '//to_text(model%parts(model%rigids(owner(nodes(i)))%part)%id) &
      //' and follows it; '//advice)
  end subroutine refuse_rigid

  !> *BOUNDARY_PRESCRIBED_MOTION_: of nodes and of rigid bodies.
  subroutine read_motions(deck, owner, fixed, model)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: owner(:)      !! (n_node) rigid body or 0
    logical, intent(in) :: fixed(:, :)   !! (2, n_node)
    type(model_t), intent(inout) :: model
    type(prescribed_motion_t), allocatable :: motions(:)
    type(prescribed_motion_t) :: motion
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer, allocatable :: nodes(:), lines(:), rigid_lines(:)
    integer :: k, n
    logical :: is_static

    allocate (motions(64), lines(64), rigid_lines(0), model%conditions%rigid_motions(0))
    is_static = model%controls%implicit%is_on .and. .not. model%controls%implicit%is_dynamic
    n = 0
    do while (next_of(deck, 'BOUNDARY_PRESCRIBED_MOTION_', cursor, card))
      call read_active_time(deck, card, ['BIRTH', 'DEATH'], motion%birth, motion%death)
      if (any(card%bad)) cycle
      motion%direction = integer_of(card, 'DOF')
      motion%kind = integer_of(card, 'VAD')
      motion%scale = real_of(card, 'SF')
      call find_id(deck, a_curve, card, 'LCID', motion%curve)
      if (motion%kind == motion_acceleration .and. is_static) call report_field(deck, card, 'VAD', &
        'is an acceleration, which has no meaning in statics ' &
        //'(0 velocity or 2 displacement, or IMASS 1 of *CONTROL_IMPLICIT_DYNAMICS)')
      if (has_field(card, 'PID')) then
        call read_rigid_motion(deck, card, motion, rigid_lines, model)
        cycle
      end if
      call card_nodes(deck, card, model, nodes)
      call refuse_rigid(deck, location_t(card%line, 1, field=1), nodes, owner, model, &
        '*BOUNDARY_PRESCRIBED_MOTION_RIGID moves the body')
      if (motion%curve == 0) cycle
      do k = 1, size(nodes)
        if (n == size(motions)) then
          motions = [motions, motions]
          lines = [lines, lines]
        end if
        n = n + 1
        motions(n) = motion
        motions(n)%node = nodes(k)
        lines(n) = card%line
      end do
    end do
    model%conditions%motions = motions(:n)
    call check_motions(deck, model, lines(:n), fixed)
  end subroutine read_motions

  !> Report prescribed degrees of freedom that are fixed, prescribed twice at one time, or without
  !> mass, one error for each card.
  subroutine check_motions(deck, model, lines, fixed)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    integer, intent(in) :: lines(:)      !! of the card of each motion
    logical, intent(in) :: fixed(:, :)   !! (2, n_node)
    integer :: last(2, model%mesh%n_node), before(size(lines)), i, j, reported_line
    logical :: has_mass(model%mesh%n_node), is_skew(model%mesh%n_node)
    character(:), allocatable :: message

    has_mass = mark_nodes_with_mass(deck, model)
    is_skew = .false.
    if (allocated(model%conditions%skew_supports)) &
      is_skew(model%conditions%skew_supports%node) = .true.
    last = 0
    reported_line = 0
    message = ''
    do i = 1, size(lines)
      associate (motion => model%conditions%motions(i))
        ! Motions of one degree of freedom are linked backwards.
        before(i) = last(motion%direction, motion%node)
        last(motion%direction, motion%node) = i
        if (len(message) > 0 .and. lines(i) == reported_line) cycle
        message = ''
        j = before(i)
        do while (j > 0 .and. len(message) == 0)
          if (min(model%conditions%motions(j)%death, motion%death) &
            > max(model%conditions%motions(j)%birth, motion%birth)) message = &
            'is moved in this direction by another card at the same time (line ' &
            //to_text(deck%number(lines(j)))//')'
          j = before(j)
        end do
        if (is_skew(motion%node)) message = 'has a support along an axis of a coordinate system ' &
          //'(CID) and cannot be moved by this card too'
        if (fixed(motion%direction, motion%node)) message = &
          'is fixed in this direction and cannot be moved by this card too'
        if (model%is_axisymmetric .and. motion%direction == 1 .and. .not. &
          model%mesh%coordinates(1, motion%node) > 0.0_wp) message = &
          'lies on the axis (x = 0) of an axisymmetric deck and cannot move in r'
        if (.not. has_mass(motion%node)) message = &
          'belongs to no element and has no mass'
        reported_line = lines(i)
        if (len(message) > 0) call reject_field(deck, location_t(reported_line, 1, field=1), &
          ': node '//to_text(model%mesh%node_id(motion%node))//' '//message)
      end associate
    end do
  end subroutine check_motions

  !> *BOUNDARY_PRESCRIBED_MOTION_RIGID; report degrees of freedom that are fixed or prescribed twice
  !> at one time.
  subroutine read_rigid_motion(deck, card, motion, lines, model)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(prescribed_motion_t), intent(inout) :: motion
    integer, allocatable, intent(inout) :: lines(:) !! of the motions so far
    type(model_t), intent(inout) :: model
    integer :: i

    call find_body(deck, card, model, '; *BOUNDARY_PRESCRIBED_MOTION_SET moves nodes', motion%node)
    if (motion%node == 0 .or. motion%curve == 0) return
    if (motion%direction == 7) motion%direction = 3
    if (model%is_axisymmetric .and. motion%direction /= 2) then
      call report_field(deck, card, 'DOF', across_axis)
    else if (model%rigids(motion%node)%is_fixed(motion%direction)) then
      call report_field(deck, card, 'DOF', 'is fixed by CON1 or CON2 of the part''s *MAT_RIGID ' &
        //'and cannot be moved by this card too')
    end if
    do i = 1, size(lines)
      associate (other => model%conditions%rigid_motions(i))
        if (other%node == motion%node .and. other%direction == motion%direction &
          .and. min(other%death, motion%death) > max(other%birth, motion%birth)) call &
          report_field(deck, card, 'DOF', 'is moved by another card at the same time (line ' &
          //to_text(deck%number(lines(i)))//')')
      end associate
    end do
    model%conditions%rigid_motions = [model%conditions%rigid_motions, motion]
    lines = [lines, card%line]
  end subroutine read_rigid_motion

  !> *CONSTRAINED_NODE_SET; report nodes with other constraints or motion in the same direction.
  subroutine read_common_motions(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(common_motion_t) :: common
    type(cursor_t) :: cursor
    type(card_t) :: card
    logical :: constrained(2, model%mesh%n_node), is_rigid(model%mesh%n_node), &
      meshed(model%mesh%n_node)
    character(:), allocatable :: message
    integer :: i, k

    if (size(blocks_of(deck, 'CONSTRAINED_NODE_SET')) == 0) return
    constrained = mark_constrained(model)
    meshed = mark_meshed_nodes(model)
    is_rigid = mark_rigid_nodes(model%rigids, model%mesh%n_node)
    do while (next_of(deck, 'CONSTRAINED_NODE_SET', cursor, card))
      if (any(card%bad)) cycle
      if (model%controls%implicit%is_on) call line_error(deck, card%line, &
        'the implicit method does not have *CONSTRAINED_NODE_SET')
      call card_nodes(deck, card, model, common%nodes)
      common%along = along_axes(:2, integer_of(card, 'DOF'))
      if (.not. any(common%along) .or. size(common%nodes) == 0) cycle
      do i = 1, size(common%nodes)
        associate (node => common%nodes(i))
          message = ''
          if (any(constrained(:, node) .and. common%along)) message = &
            'is fixed, moved or in another *CONSTRAINED_NODE_SET in the same direction'
          if (is_rigid(node)) message = 'belongs to a rigid part and follows it'
          if (.not. meshed(node)) message = 'belongs to no element'
          if (len(message) > 0) call report_field(deck, card, 'NSID', ': node ' &
            //to_text(model%mesh%node_id(node))//' '//message)
        end associate
      end do
      if (any(card%bad)) cycle
      do k = 1, 2
        if (common%along(k)) constrained(k, common%nodes) = .true.
      end do
      if (.not. allocated(model%conditions%common_motions)) &
        allocate (model%conditions%common_motions(0))
      model%conditions%common_motions = [model%conditions%common_motions, common]
    end do
  end subroutine read_common_motions

  !> (2, n_node) Whether a degree of freedom is fixed or prescribed.
  pure function mark_constrained(model) result(constrained)
    type(model_t), intent(in) :: model
    logical :: constrained(2, model%mesh%n_node)
    integer :: i

    constrained = .false.
    associate (conditions => model%conditions)
      do i = 1, size(conditions%fixed_nodes)
        constrained(conditions%fixed_directions(i), conditions%fixed_nodes(i)) = .true.
      end do
      do i = 1, size(conditions%motions)
        constrained(conditions%motions(i)%direction, conditions%motions(i)%node) = .true.
      end do
      if (allocated(conditions%skew_supports)) constrained(:, &
        conditions%skew_supports%node) = .true.
    end associate
  end function mark_constrained

end module deck_supports_m
