! SPDX-License-Identifier: MIT
!> Runs of segments: the parts of a surface that take part in contact, as chains of their own
!> (doc/theory/contact.md, section 3.7).
module runs_m
  use foot_m, only : gentle_turn
  use geometry_m, only : separation
  use kinds_m, only : wp
  use surfaces_m, only : surface_t, link_segments, number_chains
  implicit none
  private
  public :: turn_t, turn_at, extend_runs, list_runs, take_runs, count_runs

  !> How the boundary turns from one segment to the next.
  type :: turn_t
    logical :: is_sharp = .false.  !! by more than 60 degrees
    logical :: is_convex = .false. !! towards the body
  end type turn_t

contains

  !> Turn between a segment and the next one.
  pure function turn_at(surface, places, segment, next) result(turn)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node)
    integer, intent(in) :: segment, next
    type(turn_t) :: turn
    real(wp) :: one(2), two(2)

    associate (nodes => surface%segments)
      one = separation(places(:, nodes(2, segment)), places(:, nodes(1, segment)))
      two = separation(places(:, nodes(2, next)), places(:, nodes(1, next)))
    end associate
    turn%is_sharp = dot_product(one, two) < gentle_turn*norm2(one)*norm2(two)
    turn%is_convex = one(1)*two(2) - one(2)*two(1) > 0.0_wp
  end function turn_at

  !> Make runs longer at both ends, by one segment or as many as reach over `length`, but not round
  !> sharp corners.
  pure subroutine extend_runs(surface, places, length, is_active)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node)
    real(wp), intent(in) :: length                   !! m
    logical, intent(inout) :: is_active(:)           !! (n_segment)
    logical, allocatable :: is_base(:)
    integer :: s, k

    allocate (is_base, source=is_active)
    do s = 1, surface%n_segment
      if (.not. is_base(s)) cycle
      do k = 1, 2
        call extend_from(surface, places, length, is_base, s, k == 1, is_active)
      end do
    end do
  end subroutine extend_runs

  !> Activate what follows a segment, backwards or forwards, up to the next run.
  pure subroutine extend_from(surface, places, length, is_base, start, backwards, is_active)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :)
    real(wp), intent(in) :: length
    logical, intent(in) :: is_base(:)      !! (n_segment) of the runs as they were
    integer, intent(in) :: start
    logical, intent(in) :: backwards
    logical, intent(inout) :: is_active(:) !! (n_segment)
    type(turn_t) :: turn
    real(wp) :: walked
    integer :: segment, other

    segment = start
    walked = 0.0_wp
    do while (walked <= length)
      other = merge(surface%previous(segment), surface%next(segment), backwards)
      if (other == 0) return
      if (is_base(other)) return
      if (backwards) then
        turn = turn_at(surface, places, other, segment)
      else
        turn = turn_at(surface, places, segment, other)
      end if
      if (turn%is_sharp) return
      is_active(other) = .true.
      walked = walked + norm2(separation(places(:, surface%segments(2, other)), &
        places(:, surface%segments(1, other))))
      segment = other
    end do
  end subroutine extend_from

  !> List active segments, and where a run is cut although the one before is active: at sharp convex
  !> corners. In a sharp valley a place may be behind both faces, which only a chain can tell.
  pure subroutine list_runs(surface, places, is_active, n, segments, is_cut, is_parted)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node)
    logical, intent(in) :: is_active(:)              !! (n_segment)
    integer, intent(out) :: n
    integer, intent(inout) :: segments(:)            !! (n_segment)
    logical, intent(inout) :: is_cut(:)              !! (n_segment)
    logical, intent(in) :: is_parted(:)              !! (n_segment) cut before it; or none
    type(turn_t) :: turn
    integer :: s

    n = 0
    segments = 0
    is_cut = .false.
    do s = 1, surface%n_segment
      if (.not. is_active(s)) cycle
      n = n + 1
      segments(n) = s
      associate (before => surface%previous(s))
        if (before == 0) cycle
        if (.not. is_active(before)) cycle
        turn = turn_at(surface, places, before, s)
        is_cut(n) = turn%is_sharp .and. turn%is_convex
        if (size(is_parted) > 0) is_cut(n) = is_cut(n) .or. is_parted(s)
      end associate
    end do
  end subroutine list_runs

  !> A surface of some segments of another: nodes as there, segments numbered by the list.
  pure subroutine take_runs(surface, n, segments, is_cut, part)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: n
    integer, intent(in) :: segments(:) !! the first n count
    logical, intent(in) :: is_cut(:)
    type(surface_t), intent(out) :: part
    integer :: k, before

    allocate (part%nodes, source=surface%nodes)
    if (allocated(surface%is_on_axis)) allocate (part%is_on_axis, source=surface%is_on_axis)
    allocate (part%segments(2, n), part%segment_element(n))
    do k = 1, n
      part%segments(:, k) = surface%segments(:, segments(k))
      part%segment_element(k) = surface%segment_element(segments(k))
    end do
    call link_segments(part)
    do k = 1, n
      before = part%previous(k)
      if (before == 0 .or. .not. is_cut(k)) cycle
      part%previous(k) = 0
      part%next(before) = 0
    end do
    call number_chains(part)
  end subroutine take_runs

  !> Chains of a surface.
  pure function count_runs(surface) result(n)
    type(surface_t), intent(in) :: surface
    integer :: n

    n = maxval([0, surface%chain])
  end function count_runs

end module runs_m
