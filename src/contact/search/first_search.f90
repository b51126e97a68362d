! SPDX-License-Identifier: MIT
!> Tracking at time zero: who faces whom, and which nodes penetrate already.
!> Initial penetrations are taken as they are, however deep, but only where the node lies inside the
!> body behind the chain: nodes beyond the far side of a body are no penetrations
!> (doc/theory/contact.md, section 3.4).
module first_search_m
  use grid_m, only : nearest_t, fill_grid, find_nearest
  use foot_m, only : foot_t, see_segment, closest_foot, follow_contact
  use spots_m, only : list_owners, list_chords
  use contact_state_m, only : contact_state_t, tracking_t, bucket_grid_t, allocate_tracking, &
    is_free, is_touching
  use contacts_m, only : contact_t, is_tied
  use element_finder_m, only : element_finder_t, start_finder, is_inside_body
  use geometry_m, only : closest_distance
  use others_memory_m, only : answers_t
  use kinds_m, only : wp
  use model_m, only : model_t
  use self_search_m, only : find_nearest_other
  use surfaces_m, only : surface_t
  use tracking_m, only : update_tracking, list_touching, most_facing, begin_contact, &
    measure_depths
  implicit none
  private
  public :: allocate_slave_tracking, allocate_master_tracking, allocate_segments, &
    start_slave_tracking, start_master_tracking, start_segments, nearest_segment

  !> Smallest cell of the grid, as a part of the search reach.
  real(wp), parameter :: least_cell = 0.01_wp
  !> Cells about a place that are looked into before all segments are.
  integer, parameter :: near_cells = 16

contains

  !> What the search knows of the slave nodes, or of the spots of slave segments, before it looks.
  subroutine allocate_slave_tracking(contact, model, memory)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory
    integer :: n

    n = 0
    if (allocated(memory%spot_xi)) n = size(memory%spot_xi)
    memory%slave_tracking%chord = list_chords(contact%slave, n)
    associate (owners => list_owners(contact%slave, n))
      call allocate_tracking(memory%slave_tracking, size(owners, 2), contact%master%n_segment)
      call set_depths(memory%slave_tracking, contact, model, contact%slave, contact%master, owners)
    end associate
    if (contact%is_self) memory%slave_tracking%own_spots = n
  end subroutine allocate_slave_tracking

  !> The same for master nodes.
  subroutine allocate_master_tracking(contact, model, memory)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory

    memory%master_tracking%chord = list_chords(contact%master, 0)
    call allocate_tracking(memory%master_tracking, contact%master%n_node, contact%slave%n_segment)
    call set_depths(memory%master_tracking, contact, model, contact%master, contact%slave, &
      list_owners(contact%master, 0))
  end subroutine allocate_master_tracking

  !> Follow the slave nodes, or the spots of slave segments, over the master chain.
  subroutine start_slave_tracking(contact, model, memory, answers)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory
    type(answers_t), intent(inout), optional :: answers

    associate (tracking => memory%slave_tracking, chain => memory%places(:, memory%n_slave + 1:))
      if (allocated(memory%spots)) then
        call start_tracking(tracking, contact, model, contact%slave, contact%master, memory%spots, &
          chain, list_owners(contact%slave, size(memory%spot_xi)), answers)
      else
        call start_tracking(tracking, contact, model, contact%slave, contact%master, &
          memory%places(:, :memory%n_slave), chain, list_owners(contact%slave, 0), answers)
      end if
    end associate
  end subroutine start_slave_tracking

  !> Follow the master nodes over the slave chain.
  subroutine start_master_tracking(contact, model, memory, answers)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory
    type(answers_t), intent(inout), optional :: answers

    call start_tracking(memory%master_tracking, contact, model, contact%master, contact%slave, &
      memory%places(:, memory%n_slave + 1:), memory%places(:, :memory%n_slave), &
      list_owners(contact%master, 0), answers)
  end subroutine start_master_tracking

  !> Memory of slave segments.
  pure subroutine allocate_segments(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory

    allocate (memory%segments%status(contact%slave%n_segment), source=is_free)
    allocate (memory%segments%wake(contact%slave%n_segment), source=-huge(1.0_wp))
  end subroutine allocate_segments

  !> Slave segments with a master node deep inside the body behind them are in contact from the
  !> start.
  subroutine start_segments(contact, model, memory, answers)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory
    type(answers_t), intent(inout), optional :: answers
    type(element_finder_t) :: finder
    type(tracking_t) :: scratch !! for its grid
    logical :: inside
    integer :: i, segment

    if (contact%birth > 0.0_wp) return
    call begin_asking(model, contact%slave%segment_element, contact%master%nodes, finder, answers)
    call allocate_tracking(scratch, 0, contact%slave%n_segment)
    call fill_grid(scratch%grid, contact%slave, memory%places(:, :memory%n_slave), 0.0_wp)
    do i = 1, contact%master%n_node
      associate (node => contact%master%nodes(i))
        call ask_inside(finder, model, model%mesh%coordinates(:, node), [node], inside, answers)
      end associate
      if (.not. inside) cycle
      if (contact%is_self) then
        segment = nearest_other(memory%slave_tracking, contact%slave, &
          memory%places(:, :memory%n_slave), memory%places(:, :memory%n_slave), i)
        if (segment == 0) cycle
      else
        segment = nearest_segment(scratch%grid, contact%slave, memory%places(:, :memory%n_slave), &
          memory%places(:, memory%n_slave + i))
      end if
      memory%segments%status(segment) = is_touching
    end do
  end subroutine start_segments

  !> Track spots of the surface `own` over the chain `surface`, at time zero.
  subroutine start_tracking(tracking, contact, model, own, surface, spots, chain, owners, answers)
    type(tracking_t), intent(inout) :: tracking
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: own, surface
    real(wp), intent(in), contiguous :: spots(:, :) !! (4, n_spot)
    real(wp), intent(in), contiguous :: chain(:, :) !! (4, n_node of `surface`)
    integer, intent(in) :: owners(:, :)             !! (2, n_spot) segments of `own` at a spot
    type(answers_t), intent(inout), optional :: answers
    integer :: n_ignored

    if (contact%birth > 0.0_wp) return
    n_ignored = 0
    call update_tracking(tracking, surface, chain, spots, 0.0_wp, .false., n_ignored)
    call catch_edges(tracking, surface, chain, spots)
    call catch_deep_spots(tracking, model, own, surface, spots, chain, owners, answers)
    call list_touching(tracking)
    tracking%next_wake = -huge(1.0_wp)
  end subroutine start_tracking

  !> Deepest first contact: SRCH, or half of the shortest of the spot's own segments, the segment
  !> that it meets, and the thickness of the element behind that. All from the initial mesh. The
  !> reach also is the longest segment of both sides: what faces any part of a segment is within
  !> reach of one of its ends.
  subroutine set_depths(tracking, contact, model, own, surface, owners)
    type(tracking_t), intent(inout) :: tracking
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: own, surface
    integer, intent(in) :: owners(:, :) !! (2, n_spot) segments of `own` at each spot
    real(wp) :: length, longest, area
    integer :: i, k

    tracking%spot_depth = huge(1.0_wp)
    longest = 0.0_wp
    do i = 1, tracking%n
      do k = 1, 2
        if (owners(k, i) == 0) cycle
        length = length_of(own, owners(k, i))
        longest = max(longest, length)
        tracking%spot_depth(i) = min(tracking%spot_depth(i), 0.5_wp*length)
      end do
    end do
    do i = 1, surface%n_segment
      length = length_of(surface, i)
      longest = max(longest, length)
      associate (x => model%mesh%coordinates, &
        nodes => model%mesh%element_nodes(:, surface%segment_element(i)))
        area = 0.5_wp*((x(1, nodes(3)) - x(1, nodes(1)))*(x(2, nodes(4)) - x(2, nodes(2))) &
          - (x(1, nodes(4)) - x(1, nodes(2)))*(x(2, nodes(3)) - x(2, nodes(1))))
      end associate
      tracking%segment_depth(i) = 0.5_wp*min(length, area/length)
    end do
    if (contact%search_depth > 0.0_wp) then
      tracking%spot_depth = contact%search_depth
      tracking%segment_depth = contact%search_depth
    end if
    tracking%reach = max(longest, 2.0_wp*maxval(tracking%segment_depth))
    if (is_tied(contact)) then
      ! What is tied its reach says alone, at whatever depth.
      tracking%reach = max(tracking%reach, contact%tie_reach, -0.01_wp*contact%tie_reach*longest)
      tracking%spot_depth = tracking%reach
      tracking%segment_depth = tracking%reach
    end if
    call measure_depths(tracking)
    tracking%grid%least_cell = least_cell*tracking%reach

  contains

    !> Initial length of a segment.
    pure function length_of(surface, segment) result(length)
      type(surface_t), intent(in) :: surface
      integer, intent(in) :: segment
      real(wp) :: length

      length = norm2(model%mesh%coordinates(:, surface%nodes(surface%segments(2, segment))) &
        - model%mesh%coordinates(:, surface%nodes(surface%segments(1, segment))))
    end function length_of

  end subroutine set_depths

  !> Nodes at flush edges that start within the body: the closest face is the side of the body, by a
  !> hair; the face meant is the one that the node's own surface faces.
  subroutine catch_edges(tracking, surface, chain, spots)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :)
    type(foot_t) :: foot
    integer :: i, face, n_ignored

    n_ignored = 0
    do i = 1, tracking%n
      if (tracking%segment(i) == 0) cycle
      foot = closest_foot(surface, chain, spots(:, i), tracking%segment(i))
      if (.not. foot%is_on) cycle
      face = most_facing(tracking, surface, chain, spots, i, foot, .true.)
      if (face == 0 .or. face == tracking%segment(i)) cycle
      foot = follow_contact(surface, chain, spots(:, i), face)
      if (foot%is_on .and. foot%segment == face .and. foot%gap < 0.0_wp) &
        call begin_contact(tracking, i, foot, n_ignored)
    end do
  end subroutine catch_edges

  !> Spots that lie inside an element behind the chain, deeper than a first contact may be.
  subroutine catch_deep_spots(tracking, model, own, surface, spots, chain, owners, answers)
    type(tracking_t), intent(inout) :: tracking
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: own, surface
    real(wp), intent(in), contiguous :: spots(:, :), chain(:, :)
    integer, intent(in) :: owners(:, :)
    type(answers_t), intent(inout), optional :: answers
    type(element_finder_t) :: finder
    type(foot_t) :: foot
    logical :: inside
    integer :: i, nearest

    call begin_asking(model, surface%segment_element, own%nodes, finder, answers)
    call fill_grid(tracking%grid, surface, chain, 0.0_wp)
    do i = 1, tracking%n
      if (tracking%status(i) == is_touching .or. maxval(owners(:, i)) == 0) cycle
      call ask_inside(finder, model, model%mesh%coordinates(:, surface%nodes(1)) &
        + (spots(1:2, i) - chain(1:2, 1)), own%nodes(own_nodes(own, owners(:, i))), inside, answers)
      if (.not. inside) cycle
      if (tracking%own_spots < 0) then
        nearest = nearest_segment(tracking%grid, surface, chain, spots(:, i))
      else
        nearest = nearest_other(tracking, surface, chain, spots, i)
        if (nearest == 0) cycle
      end if
      foot = closest_foot(surface, chain, spots(:, i), nearest)
      if (.not. foot%is_on .or. foot%gap >= 0.0_wp) cycle
      tracking%segment(i) = foot%segment
      tracking%status(i) = is_touching
      tracking%wake(i) = -huge(1.0_wp)
    end do
  end subroutine catch_deep_spots

  !> Nodes that carry a spot: those of its segment, or the node between two.
  pure function own_nodes(own, owners) result(nodes)
    type(surface_t), intent(in) :: own
    integer, intent(in) :: owners(2) !! segments
    integer :: nodes(2)

    if (owners(1) == owners(2)) then
      nodes = own%segments(:, owners(1))
    else if (owners(1) > 0) then
      nodes = own%segments(2, owners(1))
    else
      nodes = own%segments(1, owners(2))
    end if
  end function own_nodes

  !> Segment that a spot inside of its own surface's bodies has come behind, 0: none within reach.
  pure function nearest_other(tracking, surface, chain, spots, i) result(segment)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :)
    integer, intent(in) :: i
    integer :: segment
    type(nearest_t) :: found

    call find_nearest_other(tracking, surface, chain, spots, i, 0.0_wp, .true., found)
    segment = found%segment
  end function nearest_other

  !> Segment of a surface that is nearest to a place, the first of equally near neighbours: by the
  !> grid, or by looking at all where none is near.
  pure function nearest_segment(grid, surface, chain, place) result(segment)
    type(bucket_grid_t), intent(in) :: grid !! filled at a travel of 0
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: place(4)
    integer :: segment, k, neighbours(2)
    real(wp) :: square, nearest
    type(nearest_t) :: found

    call find_nearest(grid, surface, chain, place, 0.0_wp, near_cells*grid%cell, found)
    segment = found%segment
    if (segment > 0) then
      neighbours = [surface%previous(segment), surface%next(segment)]
      nearest = closest_distance(see_segment(surface, chain, place, segment))
      do k = 1, 2
        if (neighbours(k) == 0 .or. neighbours(k) >= segment) cycle
        if (closest_distance(see_segment(surface, chain, place, neighbours(k))) <= nearest) &
          segment = neighbours(k)
      end do
      return
    end if
    nearest = huge(1.0_wp)
    do k = 1, surface%n_segment
      square = closest_distance(see_segment(surface, chain, place, k))
      if (square >= nearest) cycle
      nearest = square
      segment = k
    end do
  end function nearest_segment

  !> Know the bodies behind a surface, unless the answers are.
  pure subroutine begin_asking(model, members, nodes, finder, answers)
    type(model_t), intent(in) :: model
    integer, intent(in) :: members(:) !! elements behind the surface
    integer, intent(in) :: nodes(:)   !! of the surface whose places are asked about
    type(element_finder_t), intent(out) :: finder
    type(answers_t), intent(in), optional :: answers

    if (present(answers)) then
      if (answers%are_given) return
    end if
    call start_finder(model, members, nodes, finder)
  end subroutine begin_asking

  !> The next answer (`is_inside_body`).
  pure subroutine ask_inside(finder, model, x, carriers, inside, answers)
    type(element_finder_t), intent(in) :: finder
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: x(2)
    integer, intent(in) :: carriers(:)
    logical, intent(out) :: inside
    type(answers_t), intent(inout), optional :: answers
    logical, allocatable :: more(:)

    if (.not. present(answers)) then
      inside = is_inside_body(finder, model, x, carriers)
      return
    end if
    answers%n = answers%n + 1
    if (answers%are_given) then
      inside = answers%is_inside(answers%n)
      return
    end if
    inside = is_inside_body(finder, model, x, carriers)
    if (.not. allocated(answers%is_inside)) allocate (answers%is_inside(64), source=.false.)
    if (answers%n > size(answers%is_inside)) then
      allocate (more(2*answers%n), source=.false.)
      more(:answers%n - 1) = answers%is_inside
      call move_alloc(more, answers%is_inside)
    end if
    answers%is_inside(answers%n) = inside
  end subroutine ask_inside

end module first_search_m
