! SPDX-License-Identifier: MIT
!> Damping of parts, masses on nodes, nodes that move alike, loads on rigid bodies.
module deck_resolve_damping_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use conditions_m, only : part_damping_t, lumped_mass_t, common_motion_t, nodal_load_t
  use model_m, only : model_t
  use parts_m, only : gives_pressure
  use rigids_m, only : mark_rigid_nodes
  use supports_m, only : mark_meshed_nodes
  use deck_cards_m, only : reject_field
  use deck_lines_m, only : deck_t, place_t, line_error
  use deck_maps_m, only : maps_t, resolve_id
  use deck_raw_m, only : raw_t, row_t, row_damping_part, row_damping_part_set, row_stiffness, &
    row_stiffness_set, row_load_rigid, row_mass, row_mass_set, row_common, id_place
  use deck_resolve_conditions_m, only : row_nodes, load_axes
  implicit none
  private
  public :: resolve_damping, refuse_static, settle_relaxation

contains

  !> All of these; conditions and rigid bodies have been resolved.
  subroutine resolve_damping(deck, raw, maps, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    integer :: i

    do i = 1, raw%n_row
      associate (row => raw%rows(i))
        select case (row%kind)
        case (row_damping_part, row_damping_part_set)
          call refuse_static(deck, model, row%line, '*DAMPING_PART_MASS')
          call take_part_damping(deck, maps, row, model)
        case (row_stiffness, row_stiffness_set)
          call refuse_implicit(deck, model, row%line, '*DAMPING_PART_STIFFNESS is damping')
          call take_stiffness_damping(deck, maps, row, model)
        case (row_load_rigid)
          call take_rigid_load(deck, raw, maps, row, model)
        case (row_common)
          call refuse_implicit(deck, model, row%line, '*CONSTRAINED_NODE_SET is a constraint')
        end select
      end associate
    end do
    if (any(raw%rows(:raw%n_row)%kind == row_mass .or. raw%rows(:raw%n_row)%kind == row_mass_set)) &
      call collect_masses(deck, raw, maps, model)
    if (any(raw%rows(:raw%n_row)%kind == row_common)) call collect_common(deck, raw, maps, model)
  end subroutine resolve_damping

  !> Whether the run begins with dynamic relaxation, and what may not be in it.
  subroutine settle_relaxation(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model
    integer :: i, line

    associate (relaxation => model%controls%relaxation, conditions => model%conditions)
      do i = 1, size(model%curves)
        if (model%curves(i)%phase > 0 .and. .not. raw%never_relaxes) relaxation%is_on = .true.
      end do
      if (.not. relaxation%is_on) return
      line = raw%relaxation_line
      if (line == 0) line = raw%curve_line(findloc(raw%curves%phase > 0, .true., dim=1))
      if (model%controls%implicit%is_on) call refuse('with the implicit method')
      if (size(raw%contacts) > 0) call refuse('with contact')
      if (model%erodes) call refuse('with elements that may leave the mesh')
      if (size(raw%walls) > 0) call refuse('with rigid walls')
      if (size(model%rigids) > 0) call refuse('with rigid bodies')
      if (size(conditions%motions) > 0) call refuse('with prescribed motion')
      if (allocated(conditions%common_motions)) call refuse('with *CONSTRAINED_NODE_SET')
    end associate

  contains

    !> One error.
    subroutine refuse(what)
      character(*), intent(in) :: what

      call line_error(deck, line, 'asks for dynamic relaxation '//what &
        //', which this version does not have')
    end subroutine refuse

  end subroutine settle_relaxation

  !> What the implicit method does not have.
  subroutine refuse_implicit(deck, model, line, what)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    integer, intent(in) :: line
    character(*), intent(in) :: what

    if (model%controls%implicit%is_on) call line_error(deck, line, what &
      //' that the implicit method does not have')
  end subroutine refuse_implicit

  !> Damping by mass acts on velocities.
  subroutine refuse_static(deck, model, line, name)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    integer, intent(in) :: line
    character(*), intent(in) :: name

    associate (implicit => model%controls%implicit)
      if (implicit%is_on .and. .not. implicit%is_dynamic) call line_error(deck, line, name &
        //' damps velocities, which statics do not have (IMASS 1 of *CONTROL_IMPLICIT_DYNAMICS)')
    end associate
  end subroutine refuse_static

  !> The part of a row, or those of its part set; none where the id is wrong.
  subroutine row_parts(deck, maps, model, row, parts)
    type(deck_t), intent(inout) :: deck
    type(maps_t), intent(in) :: maps
    type(model_t), intent(in) :: model
    type(row_t), intent(in) :: row
    integer, allocatable, intent(out) :: parts(:)
    integer :: found

    allocate (parts(0))
    if (row%kind == row_damping_part_set .or. row%kind == row_stiffness_set) then
      call resolve_id(deck, maps%part_sets, row%id, 'part set', id_place(row), found)
      if (found > 0) parts = model%part_sets(found)%parts
    else
      call resolve_id(deck, maps%parts, row%id, 'part', id_place(row), found)
      if (found > 0) parts = [found]
    end if
  end subroutine row_parts

  !> *DAMPING_PART_MASS.
  subroutine take_part_damping(deck, maps, row, model)
    type(deck_t), intent(inout) :: deck
    type(maps_t), intent(in) :: maps
    type(row_t), intent(in) :: row
    type(model_t), intent(inout) :: model
    type(part_damping_t) :: damping
    integer, allocatable :: parts(:)
    integer :: k

    call row_parts(deck, maps, model, row, parts)
    call resolve_id(deck, maps%curves, row%curve, 'curve', place_t(row%line, 1, 'LCID'), &
      damping%curve)
    if (damping%curve == 0) return
    if (minval(model%curves(damping%curve)%ordinate) < 0.0_wp) call reject_field(deck, &
      place_t(row%line, 1, 'LCID'), 'is a curve with values below 0: forces that push along with ' &
      //'the velocity would feed energy')
    if (.not. allocated(model%conditions%part_damping)) allocate (model%conditions%part_damping(0))
    damping%scale = row%scale
    damping%factor = row%factor
    do k = 1, size(parts)
      damping%part = parts(k)
      model%conditions%part_damping = [model%conditions%part_damping, damping]
    end do
  end subroutine take_part_damping

  !> *DAMPING_PART_STIFFNESS.
  subroutine take_stiffness_damping(deck, maps, row, model)
    type(deck_t), intent(inout) :: deck
    type(maps_t), intent(in) :: maps
    type(row_t), intent(in) :: row
    type(model_t), intent(inout) :: model
    integer, allocatable :: parts(:)
    integer :: k

    call row_parts(deck, maps, model, row, parts)
    do k = 1, size(parts)
      associate (part => model%parts(parts(k)))
        if (part%material == 0) cycle
        if (allocated(model%materials(part%material)%eos) .or. &
          gives_pressure(model%materials(part%material))) call reject_field(deck, id_place(row), &
          ': part '//to_text(part%id)//' has an equation of state, or is a rubber or a law ' &
          //'whose points may fail, for which there is no damping by stiffness')
        if (abs(part%stiffness_damping) > 0.0_wp) call reject_field(deck, id_place(row), &
          ': part '//to_text(part%id)//' is damped by stiffness by another card too')
        if (model%materials(part%material)%is_rigid) cycle
        part%stiffness_damping = row%scale
      end associate
    end do
  end subroutine take_stiffness_damping

  !> *LOAD_RIGID_BODY.
  subroutine take_rigid_load(deck, raw, maps, row, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(row_t), intent(in) :: row
    type(model_t), intent(inout) :: model
    type(nodal_load_t) :: load
    real(wp) :: axis(2)
    integer :: part, k

    call resolve_id(deck, maps%parts, row%id, 'part', id_place(row), part)
    call resolve_id(deck, maps%curves, row%curve, 'curve', place_t(row%line, 1, 'LCID'), load%curve)
    call load_axes(deck, raw, maps, row, axis)
    if (part == 0 .or. load%curve == 0) return
    if (model%parts(part)%material == 0) return
    load%node = findloc(model%rigids%part, part, dim=1)
    if (load%node == 0) then
      call reject_field(deck, id_place(row), 'is not a rigid part (*MAT_RIGID); *LOAD_NODE_SET ' &
        //'loads nodes')
      return
    end if
    if (model%is_round .and. (row%direction == 7 .or. abs(axis(1)) > 0.0_wp)) &
      call reject_field(deck, place_t(row%line, 1, 'DOF'), 'asks a rigid body of an ' &
      //'axisymmetric deck (ELFORM 15) to move in r or to turn; it moves along the axis alone')
    if (.not. allocated(model%conditions%rigid_loads)) allocate (model%conditions%rigid_loads(0))
    if (row%direction == 7) then
      load%direction = 3
      load%scale = row%scale
      model%conditions%rigid_loads = [model%conditions%rigid_loads, load]
      return
    end if
    do k = 1, 2
      load%direction = k
      load%scale = row%scale*axis(k)
      if (abs(axis(k)) > 0.0_wp) &
        model%conditions%rigid_loads = [model%conditions%rigid_loads, load]
    end do
  end subroutine take_rigid_load

  !> *ELEMENT_MASS and *ELEMENT_MASS_NODE_SET: the mass on each node.
  subroutine collect_masses(deck, raw, maps, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    type(lumped_mass_t), allocatable :: masses(:)
    integer, allocatable :: nodes(:)
    logical, allocatable :: meshed(:)
    integer :: i, k, n

    meshed = mark_meshed_nodes(model)
    if (raw%lost%elements .or. deck%incomplete) meshed = .true.
    allocate (masses(64))
    n = 0
    do i = 1, raw%n_row
      if (all(raw%rows(i)%kind /= [row_mass, row_mass_set])) cycle
      call row_nodes(deck, maps, model, raw%rows(i), raw%rows(i)%kind == row_mass_set, nodes)
      do k = 1, size(nodes)
        if (.not. meshed(nodes(k))) then
          call reject_field(deck, id_place(raw%rows(i)), ': node ' &
            //to_text(model%mesh%node_id(nodes(k)))//' belongs to no element and can not carry a ' &
            //'mass')
          exit
        end if
        if (.not. raw%rows(i)%scale > 0.0_wp) cycle
        if (n == size(masses)) masses = [masses, masses]
        n = n + 1
        masses(n) = lumped_mass_t(nodes(k), raw%rows(i)%scale)
      end do
    end do
    model%conditions%lumped_masses = masses(:n)
  end subroutine collect_masses

  !> *CONSTRAINED_NODE_SET: the sets whose nodes nothing else holds or moves.
  subroutine collect_common(deck, raw, maps, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    type(common_motion_t), allocatable :: motions(:)
    logical :: taken(2, model%mesh%n_node), is_rigid(model%mesh%n_node), meshed(model%mesh%n_node)
    logical :: is_sound
    integer :: i, k, n

    meshed = mark_meshed_nodes(model)
    is_rigid = mark_rigid_nodes(model%rigids, model%mesh%n_node)
    call mark_taken(model, taken)
    allocate (motions(count(raw%rows(:raw%n_row)%kind == row_common)))
    n = 0
    do i = 1, raw%n_row
      if (raw%rows(i)%kind /= row_common) cycle
      associate (row => raw%rows(i), common => motions(n + 1))
        call row_nodes(deck, maps, model, row, .true., common%nodes)
        common%along = [any(row%direction == [1, 4, 6, 7]), any(row%direction == [2, 4, 5, 7])]
        if (.not. any(common%along) .or. size(common%nodes) == 0) cycle
        call check_common(deck, row, model, common, meshed, is_rigid, taken, is_sound)
        if (.not. is_sound) cycle
        do k = 1, 2
          if (common%along(k)) taken(k, common%nodes) = .true.
        end do
      end associate
      n = n + 1
    end do
    if (n > 0) model%conditions%common_motions = motions(:n)
  end subroutine collect_common

  !> Nodes that move alike may not be held or moved otherwise along the same direction: an error of
  !> the first that is.
  subroutine check_common(deck, row, model, common, meshed, is_rigid, taken, is_sound)
    type(deck_t), intent(inout) :: deck
    type(row_t), intent(in) :: row
    type(model_t), intent(in) :: model
    type(common_motion_t), intent(in) :: common
    logical, intent(in) :: meshed(:), is_rigid(:)   !! (n_node)
    logical, intent(in) :: taken(:, :)              !! (2, n_node)
    logical, intent(out) :: is_sound
    character(:), allocatable :: message
    integer :: i

    is_sound = .false.
    do i = 1, size(common%nodes)
      associate (node => common%nodes(i))
        if (.not. meshed(node)) then
          message = 'belongs to no element'
        else if (is_rigid(node)) then
          message = 'belongs to a rigid part and follows it'
        else if (any(taken(:, node) .and. common%along)) then
          message = 'is held, moved or in another such set along the same direction'
        else
          cycle
        end if
        call reject_field(deck, id_place(row), ': node '//to_text(model%mesh%node_id(node))//' ' &
          //message)
        return
      end associate
    end do
    is_sound = .true.
  end subroutine check_common

  !> Degrees of freedom that something holds or moves.
  pure subroutine mark_taken(model, taken)
    type(model_t), intent(in) :: model
    logical, intent(out) :: taken(:, :) !! (2, n_node)
    integer :: i

    taken = .false.
    associate (conditions => model%conditions)
      do i = 1, size(conditions%fixed_nodes)
        taken(conditions%fixed_directions(i), conditions%fixed_nodes(i)) = .true.
      end do
      do i = 1, size(conditions%motions)
        taken(conditions%motions(i)%direction, conditions%motions(i)%node) = .true.
      end do
      if (allocated(conditions%skew_supports)) taken(:, conditions%skew_supports%node) = .true.
    end associate
  end subroutine mark_taken

end module deck_resolve_damping_m
