! SPDX-License-Identifier: MIT
!> The runs of an interface with a whole outline: when they are looked at anew, which segments they
!> have, and the present interface made of them (doc/theory/contact.md, section 3.7).
module facing_look_m
  use element_finder_m, only : half_row
  use contact_state_m, only : contact_state_t, bucket_grid_t, allocate_grid, n_side
  use contacts_m, only : contact_t
  use facing_m, only : side_view_t, find_facing
  use facing_change_m, only : move_memory
  use facing_state_m, only : facing_side_t, allocate_side
  use foot_m, only : side_on
  use geometry_m, only : segment_length, sight_of_segment, sight_normal
  use grid_m, only : fill_grid
  use kinds_m, only : wp
  use model_m, only : model_t
  use runs_m, only : extend_runs, list_runs, take_runs
  use self_runs_m, only : part_runs
  use surfaces_m, only : surface_t, has_closed_chain
  implicit none
  private
  public :: has_outline, prepare_facing, start_facing, look_at_facing, make_present

  !> Motion between two looks, as a part of the mean segment of the finer side.
  real(wp), parameter :: look_interval = 0.5_wp
  !> Depth of a segment that is no surface: no place is that deep before it.
  real(wp), parameter :: no_surface = -huge(1.0_wp)

contains

  !> Whether an interface has a closed chain: only then do runs change.
  pure function has_outline(contact) result(outline)
    type(contact_t), intent(in) :: contact
    logical :: outline

    outline = has_closed_chain(contact%slave) .or. has_closed_chain(contact%master)
  end function has_outline

  !> What is known of both surfaces before anybody looks.
  pure subroutine prepare_facing(contact, model, memory)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory

    memory%facing%is_used = .true.
    call start_side(contact, contact%slave, model, memory%facing%slave)
    call start_side(contact, contact%master, model, memory%facing%master)
  end subroutine prepare_facing

  !> Who faces whom at time zero. The trackings must know their depths, and nothing else yet.
  pure subroutine start_facing(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory

    call look_at_facing(contact, 0.0_wp, .true., memory)
    if (.not. allocated(memory%facing%present)) call make_present(contact, memory)
  end subroutine start_facing

  !> What is known of the segments of a surface: all from the initial mesh. Edges on the axis of a
  !> body of revolution are inside it: nothing faces them, and they face nothing.
  pure subroutine start_side(contact, surface, model, side)
    type(contact_t), intent(in) :: contact
    type(surface_t), intent(in) :: surface
    type(model_t), intent(in) :: model
    type(facing_side_t), intent(inout) :: side
    real(wp) :: length
    integer :: s

    call allocate_side(side, surface%n_segment)
    do s = 1, surface%n_segment
      associate (x => model%mesh%coordinates, ends => surface%nodes(surface%segments(:, s)))
        length = norm2(x(:, ends(2)) - x(:, ends(1)))
      end associate
      side%depth(s) = half_row(model, surface, s)
      side%caught(s) = min(0.5_wp*length, side%depth(s))
      side%reached(s) = 0.5_wp*length
      if (contact%search_depth > 0.0_wp) then
        side%reached(s) = contact%search_depth
        side%caught(s) = contact%search_depth
        ! What is deeper than that may be the back of the spot's own wall.
        if (contact%is_self) side%caught(s) = min(side%caught(s), side%depth(s))
      end if
      if (contact%is_round .and. lies_on_axis(surface, model, s)) side%depth(s) = no_surface
    end do
  end subroutine start_side

  !> Whether both ends of a segment are on the axis.
  pure function lies_on_axis(surface, model, segment) result(on_axis)
    type(surface_t), intent(in) :: surface
    type(model_t), intent(in) :: model
    integer, intent(in) :: segment
    logical :: on_axis

    on_axis = .not. any(model%mesh%coordinates(1, surface%nodes(surface%segments(:, segment))) &
      > 0.0_wp)
  end function lies_on_axis

  !> Look at who faces whom once the bodies have moved so far that runs may be others, and let the
  !> memory follow. Between two looks nothing moves by more than half a segment, and `beyond`: what
  !> is captured lies farther away, so that the ends of runs are open where nothing touches.
  pure subroutine look_at_facing(contact, beyond, is_forced, memory)
    type(contact_t), intent(in) :: contact   !! of the deck
    real(wp), intent(in) :: beyond           !! motion that is to come in any case, m
    logical, intent(in) :: is_forced
    type(contact_state_t), intent(inout) :: memory
    type(side_view_t) :: slave, master
    logical, allocatable :: slave_active(:), master_active(:)
    logical :: no_parts(0)
    real(wp) :: margin

    if (.not. is_forced .and. memory%travel + beyond < memory%facing%next_look) return
    allocate (slave_active(contact%slave%n_segment), master_active(contact%master%n_segment), &
      source=.false.)
    margin = look_interval*min(mean_length(contact%slave, memory%places(:, :memory%n_slave)), &
      mean_length(contact%master, memory%places(:, memory%n_slave + 1:)))
    memory%facing%next_look = memory%travel + margin
    memory%facing%n_look = memory%facing%n_look + 1
    margin = margin + beyond
    if (contact%is_self) then
      call look_at_itself(contact, margin, is_forced, memory)
      return
    end if
    associate (capture => memory%slave_tracking%reach + margin)
      call view_side(contact%slave, memory%places(:, :memory%n_slave), &
        memory%facing%slave%depth, capture, slave)
      call view_side(contact%master, memory%places(:, memory%n_slave + 1:), &
        memory%facing%master%depth, capture, master)
      call find_facing(contact%slave, slave, contact%master, master, capture, .false., &
        slave_active, master_active)
      call find_facing(contact%master, master, contact%slave, slave, capture, .false., &
        master_active, slave_active)
    end associate
    call keep_pressed(contact, memory, slave_active, master_active)
    call extend_runs(contact%slave, slave%places, 2.0_wp*margin, slave_active)
    call extend_runs(contact%master, master%places, 2.0_wp*margin, master_active)
    slave_active = slave_active .and. slave%depth > no_surface
    master_active = master_active .and. master%depth > no_surface
    call take_over(contact, slave, master, slave_active, master_active, is_forced, memory, &
      no_parts)
  end subroutine look_at_facing

  !> The same of a surface with itself: the same runs on both sides, none of which faces itself.
  pure subroutine look_at_itself(contact, margin, is_forced, memory)
    type(contact_t), intent(in) :: contact !! of the deck
    real(wp), intent(in) :: margin         !! m
    logical, intent(in) :: is_forced
    type(contact_state_t), intent(inout) :: memory
    type(side_view_t) :: view
    logical, allocatable :: is_active(:), was_met(:), is_parted(:)
    integer, allocatable :: opposite(:, :), pairs(:, :)
    integer :: n_pair

    associate (n => contact%slave%n_segment)
      allocate (is_active(n), was_met(n), is_parted(n), source=.false.)
      allocate (opposite(4, n), source=0)
    end associate
    associate (capture => memory%slave_tracking%reach + margin)
      call view_side(contact%slave, memory%places(:, :memory%n_slave), &
        memory%facing%slave%depth, capture, view)
      call find_facing(contact%slave, view, contact%slave, view, capture, .true., is_active, &
        was_met, opposite)
    end associate
    call keep_pressed(contact, memory, is_active, was_met)
    is_active = is_active .or. was_met
    call extend_runs(contact%slave, view%places, 2.0_wp*margin, is_active)
    is_active = is_active .and. view%depth > no_surface
    call list_pairs(contact%slave, memory, opposite, n_pair, pairs)
    call part_runs(contact%slave, view%places, is_active, pairs(:, :n_pair), is_parted)
    call take_over(contact, view, view, is_active, is_active, is_forced, memory, is_parted)
  end subroutine look_at_itself

  !> Segments that face each other, or press on each other.
  pure subroutine list_pairs(surface, memory, opposite, n, pairs)
    type(surface_t), intent(in) :: surface
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: opposite(:, :)            !! (4, n_segment) see find_facing
    integer, intent(out) :: n
    integer, allocatable, intent(out) :: pairs(:, :) !! (2, n or more)
    integer :: s, k, p

    allocate (pairs(2, count(opposite > 0) + count(opposite(4, :) > 0) + memory%points%n))
    n = 0
    do s = 1, surface%n_segment
      do k = 1, 4
        if (opposite(k, s) == 0) cycle
        n = n + 1
        pairs(:, n) = [s, opposite(k, s)]
        if (k < 4) cycle
        n = n + 1
        pairs(:, n) = [surface%next(s), opposite(k, s)]
      end do
    end do
    do p = 1, memory%points%n
      if (.not. memory%points%pressure(p) > 0.0_wp) cycle
      n = n + 1
      pairs(:, n) = [segment_at(memory%points%slave_nodes(1, p)), &
        segment_at(memory%points%master_nodes(1, p))]
    end do

  contains

    !> The segment behind a node of a point.
    pure function segment_at(node) result(segment)
      integer, intent(in) :: node
      integer :: segment

      segment = surface%outgoing(1 + modulo(node - 1, memory%n_slave))
    end function segment_at

  end subroutine list_pairs

  !> Places and grid of a surface.
  pure subroutine view_side(surface, places, depth, capture, view)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node)
    real(wp), intent(in) :: depth(:), capture
    type(side_view_t), intent(out) :: view

    allocate (view%places, source=places)
    allocate (view%depth, source=depth)
    call allocate_grid(view%grid, surface%n_segment)
    view%grid%least_cell = 0.5_wp*capture
    call fill_grid(view%grid, surface, view%places, 0.0_wp)
  end subroutine view_side

  !> Mean length of the segments of a surface, m.
  pure function mean_length(surface, places) result(length)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :)
    real(wp) :: length
    integer :: s

    length = 0.0_wp
    do s = 1, surface%n_segment
      length = length + segment_length(places(:, surface%segments(1, s)), &
        places(:, surface%segments(2, s)))
    end do
    length = length/surface%n_segment
  end function mean_length

  !> Segments that carry the force of a point of the last step stay until it opens. So do those at a
  !> node that carries one, but of two the one that has turned away from it so far that it has no
  !> share any more.
  pure subroutine keep_pressed(contact, memory, slave_active, master_active)
    type(contact_t), intent(in) :: contact !! of the deck
    type(contact_state_t), intent(in) :: memory
    logical, intent(inout) :: slave_active(:), master_active(:)
    logical :: slave_before(size(slave_active)), master_before(size(master_active))
    integer :: p, nodes(n_side), k

    slave_before = .false.
    slave_before(memory%facing%slave%segments(:memory%facing%slave%n)) = .true.
    master_before = .false.
    master_before(memory%facing%master%segments(:memory%facing%master%n)) = .true.
    do p = 1, memory%points%n
      if (.not. memory%points%pressure(p) > 0.0_wp) cycle
      do k = 1, 2
        if (k == 1) nodes = memory%points%slave_nodes(:, p)
        if (k == 2) nodes = memory%points%master_nodes(:, p)
        associate (normal => (3 - 2*k)*memory%points%normal(:, p))
          if (nodes(1) <= memory%n_slave) then
            call keep_segments(contact%slave, memory%places(:, :memory%n_slave), nodes, normal, &
              slave_before, slave_active)
          else
            call keep_segments(contact%master, memory%places(:, memory%n_slave + 1:), &
              nodes - memory%n_slave, normal, master_before, master_active)
          end if
        end associate
      end do
    end do
  end subroutine keep_pressed

  !> The segment between two nodes, or those at one node.
  pure subroutine keep_segments(surface, places, nodes, normal, was_active, is_active)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :)
    integer, intent(in) :: nodes(n_side)  !! of the surface
    real(wp), intent(in) :: normal(2)     !! from the other side
    logical, intent(in) :: was_active(:)
    logical, intent(inout) :: is_active(:)
    real(wp) :: cosine(2)
    integer :: k, s(2)

    s = [surface%incoming(nodes(1)), surface%outgoing(nodes(1))]
    if (nodes(1) /= nodes(2)) then
      is_active(s(2)) = .true.
      return
    end if
    cosine = huge(1.0_wp)
    do k = 1, 2
      if (s(k) == 0) cycle
      if (.not. was_active(s(k)) .and. .not. is_active(s(k))) cycle
      cosine(k) = dot_product(sight_normal(sight_of_segment(places(:, nodes(1)), &
        places(:, surface%segments(1, s(k))), places(:, surface%segments(2, s(k))))), normal)
    end do
    do k = 1, 2
      if (cosine(k) < side_on .or. (cosine(k) <= minval(cosine) .and. cosine(k) < 2.0_wp)) &
        is_active(s(k)) = .true.
    end do
  end subroutine keep_segments

  !> Make the present interface of the runs if they are others than before, or if the memory knows
  !> nothing.
  pure subroutine take_over(contact, slave, master, slave_active, master_active, is_forced, &
      memory, is_parted)
    type(contact_t), intent(in) :: contact
    type(side_view_t), intent(in) :: slave, master
    logical, intent(in) :: slave_active(:), master_active(:)
    logical, intent(in) :: is_forced
    type(contact_state_t), intent(inout) :: memory
    logical, intent(in) :: is_parted(:) !! runs of a surface with itself; else none
    integer, allocatable :: former_slave(:), former_master(:)
    logical :: has_changed, is_other

    call list_side(contact%slave, slave, slave_active, memory%facing%slave, former_slave, &
      has_changed, is_parted)
    call list_side(contact%master, master, master_active, memory%facing%master, former_master, &
      is_other, is_parted)
    has_changed = has_changed .or. is_other .or. .not. allocated(memory%facing%present)
    if (.not. (has_changed .or. is_forced)) return
    if (has_changed) memory%facing%n_change = memory%facing%n_change + 1
    call make_present(contact, memory)
    call move_memory(former_slave, former_master, memory)
  end subroutine take_over

  !> The runs of one side.
  pure subroutine list_side(surface, view, is_active, side, former, has_changed, is_parted)
    type(surface_t), intent(in) :: surface
    type(side_view_t), intent(in) :: view
    logical, intent(in) :: is_active(:)
    type(facing_side_t), intent(inout) :: side
    integer, allocatable, intent(out) :: former(:) !! segments of the runs before
    logical, intent(out) :: has_changed
    logical, intent(in) :: is_parted(:)
    logical, allocatable :: was_cut(:)

    allocate (former, source=side%segments(:side%n))
    allocate (was_cut, source=side%is_cut)
    call list_runs(surface, view%places, is_active, side%n, side%segments, side%is_cut, &
      is_parted)
    has_changed = side%n /= size(former)
    if (.not. has_changed) has_changed = any(side%segments(:side%n) /= former) .or. &
      any(side%is_cut .neqv. was_cut)
  end subroutine list_side

  !> The present interface from the lists of segments; after a restart too.
  pure subroutine make_present(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory

    if (.not. allocated(memory%facing%present)) allocate (memory%facing%present, source=contact)
    associate (facing => memory%facing)
      call take_runs(contact%slave, facing%slave%n, facing%slave%segments, facing%slave%is_cut, &
        facing%present%slave)
      call take_runs(contact%master, facing%master%n, facing%master%segments, &
        facing%master%is_cut, facing%present%master)
    end associate
  end subroutine make_present

end module facing_look_m
