! SPDX-License-Identifier: MIT
!> Rigid bodies from the parts of *MAT_RIGID: their nodes, their prescribed motion, and what
!> may not be asked of them.
module deck_resolve_rigids_m
  use conditions_m, only : prescribed_motion_t
  use kinds_m, only : wp
  use log_m, only : to_text
  use mesh_m, only : mesh_t
  use model_m, only : model_t
  use rigids_m, only : rigid_t
  use deck_cards_m, only : reject_field
  use deck_ids_m, only : index_of
  use deck_lines_m, only : deck_t, place_t, line_error
  use deck_maps_m, only : maps_t, resolve_id
  use deck_raw_m, only : raw_t, row_t, row_spc_node, row_spc_set, row_motion_node, row_motion_set, &
    row_motion_rigid, row_velocity_rigid, id_place
  implicit none
  private
  public :: resolve_rigids

  !> Why a rigid body of an axisymmetric deck does not go where it is told to.
  character(*), parameter :: across_axis = 'asks a rigid body of an axisymmetric deck (ELFORM ' &
    //'15) to move in r or to turn; it moves along the axis alone'

contains

  !> One body for each part of *MAT_RIGID. Conditions on nodes have been resolved.
  subroutine resolve_rigids(deck, raw, maps, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    integer, allocatable :: owner(:), parts(:)
    integer :: i

    allocate (model%conditions%rigid_motions(0))
    parts = pack([(i, i=1, size(model%parts))], [(is_rigid_part(model, i), i=1, size(model%parts))])
    allocate (model%rigids(size(parts)))
    do i = 1, size(parts)
      model%rigids(i)%part = parts(i)
      model%rigids(i)%nodes = nodes_of_part(model%mesh, parts(i))
      model%rigids(i)%is_fixed = model%materials(model%parts(parts(i))%material)%is_fixed
      if (model%is_round) model%rigids(i)%is_fixed([1, 3]) = .true.
    end do
    allocate (owner(model%mesh%n_node), source=0)
    call own_nodes(deck, raw, model, owner)
    call refuse_conditions(deck, raw, maps, model, owner)
    call collect_rigid_motions(deck, raw, maps, model)
    call collect_rigid_velocities(deck, raw, maps, model)
    if (size(model%rigids) == 0) return
    if (model%controls%implicit%is_on) call line_error(deck, &
      raw%material_line(model%parts(model%rigids(1)%part)%material), '*MAT_RIGID: the implicit ' &
      //'method does not have rigid bodies')
    if (size(model%rigids) == size(model%parts) .and. model%controls%dt_curve == 0) call &
      line_error(deck, raw%parts(1)%line, 'all parts are rigid, so no element gives a time step; ' &
      //'give one by a curve (LCTM of *CONTROL_TIMESTEP)')
  end subroutine resolve_rigids

  !> Whether a part has *MAT_RIGID.
  pure function is_rigid_part(model, i_part) result(yes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_part
    logical :: yes

    yes = model%parts(i_part)%material > 0
    if (yes) yes = model%materials(model%parts(i_part)%material)%is_rigid
  end function is_rigid_part

  !> Nodes of the elements of a part, each once.
  pure function nodes_of_part(mesh, i_part) result(nodes)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: i_part
    integer, allocatable :: nodes(:)
    logical :: is_there(0:mesh%n_node)
    integer :: i

    is_there = .false.
    do i = 1, mesh%n_element
      if (mesh%element_part(i) == i_part) is_there(mesh%element_nodes(:, i)) = .true.
    end do
    nodes = pack([(i, i=1, mesh%n_node)], is_there(1:))
  end function nodes_of_part

  !> The body of each node, 0 where there is none; no node may have two.
  subroutine own_nodes(deck, raw, model, owner)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    integer, intent(inout) :: owner(:) !! (n_node) in: 0
    integer :: i, k, node

    do i = 1, size(model%rigids)
      associate (body => model%rigids(i))
        if (size(body%nodes) == 0 .and. .not. raw%lost%elements) call reject_field(deck, &
          place_t(raw%parts(body%part)%line, 2, 'PID'), &
          ': this rigid part has no elements, so no mass')
        do k = 1, size(body%nodes)
          node = body%nodes(k)
          if (owner(node) == 0) cycle
          call reject_field(deck, place_t(raw%parts(body%part)%line, 2, 'PID'), ': node ' &
            //to_text(model%mesh%node_id(node))//' belongs to this rigid part and to rigid part ' &
            //to_text(model%parts(model%rigids(owner(node))%part)%id) &
            //'; bodies that share nodes must be one part')
          exit
        end do
        owner(body%nodes) = i
      end associate
    end do
  end subroutine own_nodes

  !> Nodes of a rigid body follow the body: nothing else may hold or move them. (LS-DYNA passes over
  !> such constraints or turns them into some of the body, according to its version.)
  subroutine refuse_conditions(deck, raw, maps, model, owner)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(in) :: model
    integer, intent(in) :: owner(:)
    integer :: i, node

    if (size(model%rigids) == 0) return
    do i = 1, model%mesh%n_node
      ! TC 3 holds z alone.
      if (owner(i) > 0 .and. any([1, 2, 4, 5, 6, 7] == raw%node_code(i))) call complain(place_t( &
        raw%node_line(i), 1, 'TC'), i, 'CON1 and CON2 of *MAT_RIGID hold the body')
    end do
    do i = 1, raw%n_row
      select case (raw%rows(i)%kind)
      case (row_spc_node, row_spc_set)
        if (.not. any(raw%rows(i)%fixed)) cycle
        node = first_rigid(raw%rows(i), raw%rows(i)%kind == row_spc_set)
        if (node > 0) call complain(id_place(raw%rows(i)), node, &
          'CON1 and CON2 of *MAT_RIGID hold the body')
      case (row_motion_node, row_motion_set)
        node = first_rigid(raw%rows(i), raw%rows(i)%kind == row_motion_set)
        if (node > 0) call complain(id_place(raw%rows(i)), node, &
          '*BOUNDARY_PRESCRIBED_MOTION_RIGID moves the body')
      end select
    end do

  contains

    !> First rigid node of a row, 0 when there is none.
    integer function first_rigid(row, is_set)
      type(row_t), intent(in) :: row
      logical, intent(in) :: is_set
      integer, allocatable :: nodes(:)
      integer :: found

      first_rigid = 0
      found = merge(index_of(maps%node_sets, row%id), index_of(maps%nodes, row%id), is_set)
      if (found == 0) return
      nodes = [found]
      if (is_set) nodes = model%node_sets(found)%nodes
      nodes = pack(nodes, owner(nodes) > 0)
      if (size(nodes) > 0) first_rigid = nodes(1)
    end function first_rigid

    !> One error for each card.
    subroutine complain(place, k, advice)
      type(place_t), intent(in) :: place
      integer, intent(in) :: k
      character(*), intent(in) :: advice

      call reject_field(deck, place, ': node '//to_text(model%mesh%node_id(k)) &
        //' belongs to rigid part '//to_text(model%parts(model%rigids(owner(k))%part)%id) &
        //' and follows it; '//advice)
    end subroutine complain

  end subroutine refuse_conditions

  !> *BOUNDARY_PRESCRIBED_MOTION_RIGID.
  subroutine collect_rigid_motions(deck, raw, maps, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    type(prescribed_motion_t) :: motion
    integer, allocatable :: lines(:)
    integer :: i, part

    allocate (lines(0))
    do i = 1, raw%n_row
      associate (row => raw%rows(i))
        if (row%kind /= row_motion_rigid) cycle
        call resolve_id(deck, maps%parts, row%id, 'part', id_place(row), part)
        call resolve_id(deck, maps%curves, row%curve, 'curve', place_t(row%line, 1, 'LCID'), &
          motion%curve)
        if (part == 0 .or. motion%curve == 0) cycle
        if (model%parts(part)%material == 0) cycle
        motion%node = body_of_part(model%rigids, part)
        if (motion%node == 0) then
          call reject_field(deck, id_place(row), 'is not a rigid part (*MAT_RIGID); ' &
            //'*BOUNDARY_PRESCRIBED_MOTION_SET moves nodes')
          cycle
        end if
        motion%direction = merge(3, row%direction, row%direction == 7)
        motion%kind = row%motion
        motion%scale = row%scale
        motion%death = row%death
        motion%birth = row%birth
        call check_rigid_motion(deck, model, lines, row%line, motion)
        model%conditions%rigid_motions = [model%conditions%rigid_motions, motion]
        lines = [lines, row%line]
      end associate
    end do
  end subroutine collect_rigid_motions

  !> *INITIAL_VELOCITY_RIGID_BODY: it comes before what nodes of the body are given.
  subroutine collect_rigid_velocities(deck, raw, maps, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    integer :: i, part, body

    do i = 1, raw%n_row
      associate (row => raw%rows(i))
        if (row%kind /= row_velocity_rigid) cycle
        call resolve_id(deck, maps%parts, row%id, 'part', id_place(row), part)
        if (part == 0) cycle
        if (model%parts(part)%material == 0) cycle
        body = body_of_part(model%rigids, part)
        if (body == 0) then
          call reject_field(deck, id_place(row), 'is not a rigid part (*MAT_RIGID); ' &
            //'*INITIAL_VELOCITY_GENERATION gives a part its velocity')
        else if (model%rigids(body)%has_velocity) then
          call reject_field(deck, id_place(row), 'has a velocity by another card')
        else
          model%rigids(body)%has_velocity = .true.
          model%rigids(body)%velocity = row%velocity
          if (model%is_round .and. maxval(abs(row%velocity([1, 3]))) > 0.0_wp) call &
            reject_field(deck, place_t(row%line, 1, trim(merge('VX ', 'VZR', &
            abs(row%velocity(1)) > 0.0_wp))), across_axis)
        end if
      end associate
    end do
  end subroutine collect_rigid_velocities

  !> The body of a part, 0 when it is not rigid.
  pure function body_of_part(rigids, part) result(found)
    type(rigid_t), intent(in) :: rigids(:)
    integer, intent(in) :: part
    integer :: found

    do found = size(rigids), 1, -1
      if (rigids(found)%part == part) return
    end do
    found = 0
  end function body_of_part

  !> A moved degree of freedom may not be fixed, nor moved twice at one time.
  subroutine check_rigid_motion(deck, model, lines, line, motion)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    integer, intent(in) :: lines(:)   !! of the motions so far
    integer, intent(in) :: line
    type(prescribed_motion_t), intent(in) :: motion
    integer :: i

    if (model%is_round .and. motion%direction /= 2) then
      call reject_field(deck, place_t(line, 1, 'DOF'), across_axis)
    else if (model%rigids(motion%node)%is_fixed(motion%direction)) then
      call reject_field(deck, place_t(line, 1, 'DOF'), 'is fixed by CON1 or CON2 of the part''s ' &
        //'*MAT_RIGID and cannot be moved by this card too')
    end if
    do i = 1, size(lines)
      associate (other => model%conditions%rigid_motions(i))
        if (other%node /= motion%node .or. other%direction /= motion%direction) cycle
        if (min(other%death, motion%death) <= max(other%birth, motion%birth)) cycle
        call reject_field(deck, place_t(line, 1, 'DOF'), 'is moved by another card at the same ' &
          //'time (line '//to_text(deck%number(lines(i)))//')')
        return
      end associate
    end do
  end subroutine check_rigid_motion

end module deck_resolve_rigids_m
