! SPDX-License-Identifier: MIT
!> Tracking at time zero: who faces whom, and which nodes penetrate already.
!> Initial penetrations are taken as they are, however deep, but only where the node lies inside the
!> body behind the chain: nodes beyond the far side of a body are no penetrations
!> (doc/theory/contact.md, section 3.4).
module contact_initial_m
  use contact_projection_m, only : foot_t, see_segment, closest_foot, follow_contact
  use contact_search_m, only : update_tracking, most_facing, begin_contact
  use contact_state_m, only : tracking_t, allocate_tracking, is_touching
  use contacts_m, only : contact_t
  use element_finder_m, only : element_finder_t, start_finder, is_inside_body
  use geometry_m, only : closest_distance
  use kinds_m, only : wp
  use model_m, only : model_t
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: start_tracking

  !> Smallest cell of the grid, as a part of the search reach.
  real(wp), parameter :: least_cell = 0.01_wp

contains

  !> Track the nodes of `own` over the chain `surface`, at time zero.
  subroutine start_tracking(tracking, contact, model, own, surface, places)
    type(tracking_t), intent(inout) :: tracking
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: own, surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, nodes of own then of surface)
    integer :: i, n_ignored

    call allocate_tracking(tracking, own%n_node, surface%n_segment)
    do i = 1, own%n_node
      tracking%chord(:, i) = i
      if (own%incoming(i) > 0) tracking%chord(1, i) = own%segments(1, own%incoming(i))
      if (own%outgoing(i) > 0) tracking%chord(2, i) = own%segments(2, own%outgoing(i))
    end do
    call set_depths(tracking, contact, model, own, surface)
    if (contact%birth > 0.0_wp) return
    n_ignored = 0
    call update_tracking(tracking, surface, places(:, own%n_node + 1:), places(:, :own%n_node), &
      0.0_wp, n_ignored)
    call catch_edges(tracking, surface, places(:, own%n_node + 1:), places(:, :own%n_node))
    call catch_deep_nodes(tracking, model, own, surface, places)
    tracking%next_wake = -huge(1.0_wp)
  end subroutine start_tracking

  !> Deepest first contact: SRCH, or half of the shortest of the tracked node's segments, the segment that it
  !> meets, and the thickness of the element behind that. All from the initial mesh.
  subroutine set_depths(tracking, contact, model, own, surface)
    type(tracking_t), intent(inout) :: tracking
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: own, surface
    real(wp) :: length, longest, area
    integer :: i

    tracking%spot_depth = huge(1.0_wp)
    do i = 1, own%n_segment
      length = length_of(own, i)
      associate (ends => own%segments(:, i))
        tracking%spot_depth(ends(1)) = min(tracking%spot_depth(ends(1)), 0.5_wp*length)
        tracking%spot_depth(ends(2)) = min(tracking%spot_depth(ends(2)), 0.5_wp*length)
      end associate
    end do
    longest = 0.0_wp
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

  !> Nodes that lie inside an element behind the chain, deeper than a first contact may be.
  subroutine catch_deep_nodes(tracking, model, own, surface, places)
    type(tracking_t), intent(inout) :: tracking
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: own, surface
    real(wp), intent(in), contiguous :: places(:, :)
    type(element_finder_t) :: finder
    type(foot_t) :: foot
    real(wp) :: square, nearest
    integer :: i, k, segment

    call start_finder(model, surface%segment_element, finder)
    do i = 1, tracking%n
      if (tracking%status(i) == is_touching) cycle
      if (.not. is_inside_body(finder, model, own%nodes(i))) cycle
      segment = 0
      nearest = huge(1.0_wp)
      do k = 1, surface%n_segment
        square = closest_distance(see_segment(surface, places(:, own%n_node + 1:), &
          places(:, i), k))
        if (square >= nearest) cycle
        nearest = square
        segment = k
      end do
      foot = closest_foot(surface, places(:, own%n_node + 1:), places(:, i), segment)
      if (.not. foot%is_on .or. foot%gap >= 0.0_wp) cycle
      tracking%segment(i) = foot%segment
      tracking%status(i) = is_touching
      tracking%wake(i) = -huge(1.0_wp)
    end do
  end subroutine catch_deep_nodes

end module contact_initial_m
