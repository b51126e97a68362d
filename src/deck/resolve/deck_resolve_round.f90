! SPDX-License-Identifier: MIT
!> Axisymmetric decks (*SECTION_SHELL ELFORM 15): x is the radius, y the axis. What that asks of the
!> rest of the deck, and what the program settles by itself: nodes on the axis keep to it.
module deck_resolve_round_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use rigids_m, only : mark_rigid_nodes
  use deck_lines_m, only : deck_t, place_t, line_warning
  use deck_cards_m, only : reject_field
  use deck_raw_m, only : raw_t, row_body, row_velocity, row_velocity_generation, &
    row_load_node, row_load_set, id_place
  implicit none
  private
  public :: settle_form, settle_axis, mark_axis, mark_round_contacts, check_loads_of_round, &
    check_velocities_of_round

  !> Radii below this share of the largest are the axis.
  real(wp), parameter :: axis_share = 1.0e-10_wp
  !> No bore is that narrow: nodes that were meant to be on the axis.
  real(wp), parameter :: bore_share = 1.0e-6_wp

contains

  !> Whether the deck is axisymmetric: all of its parts, or none.
  subroutine settle_form(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model
    logical :: is_round(size(model%parts)), is_known(size(model%parts))
    integer :: i, first

    is_known = model%parts%section > 0
    is_round = .false.
    do i = 1, size(model%parts)
      if (is_known(i)) is_round(i) = model%sections(model%parts(i)%section)%is_round
    end do
    model%is_round = any(is_round)
    if (.not. any(is_known)) return
    first = findloc(is_known, .true., dim=1)
    do i = 1, size(model%parts)
      if (.not. is_known(i) .or. (is_round(i) .eqv. is_round(first))) cycle
      call reject_field(deck, place_t(raw%parts(i)%line, 2, 'SECID'), 'is a section of ' &
        //form_name(is_round(i))//', but part '//to_text(model%parts(first)%id)//' is of ' &
        //form_name(is_round(first))//': a deck is of one kind')
    end do
  end subroutine settle_form

  !> An element form in words.
  pure function form_name(is_round) result(name)
    logical, intent(in) :: is_round
    character(:), allocatable :: name

    name = 'plane strain (ELFORM 13)'
    if (is_round) name = 'axisymmetry (ELFORM 15)'
  end function form_name

  !> Radii must not be below zero; those that are none are made exactly zero.
  subroutine settle_axis(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model
    real(wp) :: reach
    integer :: i

    if (.not. model%is_round .or. model%mesh%n_node == 0) return
    reach = axis_share*maxval(model%mesh%coordinates(1, :))
    associate (x => model%mesh%coordinates)
      do i = 1, model%mesh%n_node
        if (x(1, i) < -reach) then
          call reject_field(deck, place_t(raw%node_line(i), 1, 'X'), ': node ' &
            //to_text(model%mesh%node_id(i))//' lies at a radius below 0 (an axisymmetric deck ' &
            //'turns about x = 0, and x is the radius)')
        else if (x(1, i) <= reach) then
          x(1, i) = 0.0_wp
        end if
      end do
    end associate
  end subroutine settle_axis

  !> (n_node) nodes on the axis of an axisymmetric deck.
  pure function mark_axis(model) result(is_there)
    type(model_t), intent(in) :: model
    logical :: is_there(model%mesh%n_node)

    is_there = .false.
    if (model%is_round) is_there = .not. model%mesh%coordinates(1, :) > 0.0_wp
  end function mark_axis

  !> Contacts of an axisymmetric deck know it, and which of their nodes are on the axis.
  pure subroutine mark_round_contacts(model)
    type(model_t), intent(inout) :: model
    integer :: i

    model%contacts%is_round = .true.
    do i = 1, size(model%contacts)
      associate (slave => model%contacts(i)%slave, master => model%contacts(i)%master, &
        radii => model%mesh%coordinates(1, :))
        slave%is_on_axis = .not. radii(slave%nodes) > 0.0_wp
        master%is_on_axis = .not. radii(master%nodes) > 0.0_wp
      end associate
    end do
  end subroutine mark_round_contacts

  !> A body load across the axis has no meaning; a force in r on nodes of the axis does nothing;
  !> nodes next to the axis are the rim of a bore.
  subroutine check_loads_of_round(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    integer :: i

    if (.not. model%is_round) return
    do i = 1, raw%n_row
      if (raw%rows(i)%kind == row_body .and. raw%rows(i)%direction == 1) call reject_field(deck, &
        id_place(raw%rows(i)), ': *LOAD_BODY_X acts across the axis of an axisymmetric deck; ' &
        //'*LOAD_BODY_Y acts along it')
    end do
    if (allocated(model%conditions%nodal_loads)) call warn_of_axis_loads(deck, raw, model)
    if (allocated(model%conditions%fixed_nodes)) call warn_of_bores(deck, raw, model)
  end subroutine check_loads_of_round

  !> Warn of free nodes next to the axis: the hoop stress at the rim of a bore is not that of a body
  !> without one, however narrow it is.
  subroutine warn_of_bores(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    logical :: is_rim(model%mesh%n_node)
    integer :: first

    if (model%mesh%n_node == 0) return
    associate (radius => model%mesh%coordinates(1, :), conditions => model%conditions)
      is_rim = radius > 0.0_wp .and. radius < bore_share*maxval(radius) &
        .and. .not. mark_rigid_nodes(model%rigids, model%mesh%n_node)
      is_rim(pack(conditions%fixed_nodes, conditions%fixed_directions == 1)) = .false.
      if (.not. any(is_rim)) return
      first = findloc(is_rim, .true., dim=1)
      call line_warning(deck, raw%node_line(first), 'bore', to_text(count(is_rim)) &
        //' node(s) lie next to the axis but not on it, and move in r as the rim of a bore; the ' &
        //'first is '//to_text(model%mesh%node_id(first))//' at the radius ' &
        //to_text(radius(first))//'; give them x = 0, or hold them')
    end associate
  end subroutine warn_of_bores

  !> Warn of forces in r on nodes of the axis, at the first card with a force in r.
  subroutine warn_of_axis_loads(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    logical :: is_there(model%mesh%n_node), is_lost(size(model%conditions%nodal_loads))
    integer :: i, line

    is_there = mark_axis(model)
    associate (loads => model%conditions%nodal_loads)
      is_lost = is_there(loads%node) .and. loads%direction == 1
      if (.not. any(is_lost)) return
      line = 0
      do i = raw%n_row, 1, -1
        if (any(raw%rows(i)%kind == [row_load_node, row_load_set]) &
          .and. raw%rows(i)%direction == 1) line = raw%rows(i)%line
      end do
      call line_warning(deck, line, 'radial load', to_text(count(is_lost)) &
        //' load(s) in r act on nodes on the axis (x = 0), which do not move in r: they do ' &
        //'nothing; the first is on node ' &
        //to_text(model%mesh%node_id(loads(findloc(is_lost, .true., dim=1))%node)))
    end associate
  end subroutine warn_of_axis_loads

  !> Initial velocities across the axis where there can be none.
  subroutine check_velocities_of_round(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model
    logical :: is_held(model%mesh%n_node)
    integer :: i, line

    if (.not. model%is_round .or. .not. allocated(model%conditions%initial_velocity)) return
    is_held = mark_axis(model) .or. mark_rigid_nodes(model%rigids, model%mesh%n_node)
    is_held = is_held .and. abs(model%conditions%initial_velocity(1, :)) > 0.0_wp
    if (.not. any(is_held)) return
    line = 0
    if (raw%n_node_velocity > 0) line = raw%node_velocities(1)%line
    do i = raw%n_row, 1, -1
      if (raw%rows(i)%kind == row_velocity .or. raw%rows(i)%kind == row_velocity_generation) &
        line = raw%rows(i)%line
    end do
    where (is_held) model%conditions%initial_velocity(1, :) = 0.0_wp
    call line_warning(deck, line, 'radial velocity', to_text(count(is_held))//' node(s) on the ' &
      //'axis or of rigid bodies have an initial velocity in r, which they can not take: it is ' &
      //'left out; the first is '//to_text(model%mesh%node_id(findloc(is_held, .true., dim=1))))
  end subroutine check_velocities_of_round

end module deck_resolve_round_m
