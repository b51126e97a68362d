! SPDX-License-Identifier: MIT
!> Where the runs of a surface in contact with itself are parted: no run may hold two segments that
!> face each other, since a place counts only with runs other than its own (doc/theory/contact.md,
!> section 3.8). Between two such segments the boundary turns back: it is parted where it turns
!> most.
module self_runs_m
  use geometry_m, only : separation
  use kinds_m, only : wp
  use runs_m, only : turn_t, turn_at
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: part_runs

  !> Turns that differ by less count as one, rad: a mirror image is parted at the mirrored nodes.
  real(wp), parameter :: same_turn = 1.0e-6_wp

  !> All runs one behind the other, by position, and the way from each segment to the next one.
  type :: order_t
    integer :: n = 0
    integer, allocatable :: segment(:)  !! (n) at each position
    integer, allocatable :: position(:) !! (n_segment) of each segment, 0: in no run
    integer, allocatable :: first(:)    !! (n) first and last position of the run that each is in
    integer, allocatable :: last(:)
    logical, allocatable :: is_ring(:)  !! (n) its run has no end
    real(wp), allocatable :: turn(:)    !! (n) to the next one, rad, away from the body
    integer, allocatable :: to_cut(:)   !! (n) steps to the next place where the run is parted
    logical, allocatable :: is_cut(:)   !! (n) parted between it and the next one
  end type order_t

contains

  !> Which segments are the first behind a place where a run is parted. The cost is that of the runs
  !> and the pairs, times the logarithm of the longest run.
  pure subroutine part_runs(surface, places, is_active, pairs, is_parted)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node)
    logical, intent(in) :: is_active(:)              !! (n_segment)
    integer, intent(in) :: pairs(:, :)               !! (2, n_pair) segments that face each other
    logical, intent(out) :: is_parted(:)             !! (n_segment)
    type(order_t) :: order
    integer, allocatable :: arcs(:, :) ! position of the first segment, steps to the last one
    logical, allocatable :: is_cut(:)
    integer :: n_arc, most, i

    is_parted = .false.
    allocate (arcs(2, 2*size(pairs, 2)))
    call put_in_order(surface, places, is_active, order)
    call list_arcs(order, pairs, n_arc, arcs)
    most = 1
    do while (n_arc > 0)
      allocate (is_cut, source=order%is_cut)
      do i = 1, n_arc
        if (arcs(2, i) > most .or. arcs(2, i) <= most/2) cycle
        if (order%to_cut(arcs(1, i)) >= arcs(2, i)) call cut_arc(order, arcs(:, i), is_cut)
      end do
      call move_alloc(is_cut, order%is_cut)
      if (most >= maxval(arcs(2, :n_arc))) exit
      call measure_cuts(order)
      most = 2*most
    end do
    do i = 1, order%n
      if (order%is_cut(i)) is_parted(order%segment(next_position(order, i))) = .true.
    end do
  end subroutine part_runs

  !> Runs one behind the other.
  pure subroutine put_in_order(surface, places, is_active, order)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :)
    logical, intent(in) :: is_active(:)
    type(order_t), intent(out) :: order
    integer :: s, k, first, n

    n = count(is_active)
    allocate (order%segment(n), order%first(n), order%last(n), order%to_cut(n), source=0)
    allocate (order%position(surface%n_segment), source=0)
    allocate (order%is_ring(n), order%is_cut(n), source=.false.)
    allocate (order%turn(n), source=0.0_wp)
    order%to_cut = huge(1)
    do s = 1, surface%n_segment
      if (.not. is_active(s) .or. order%position(s) > 0) cycle
      first = s
      do
        k = surface%previous(first)
        if (.not. goes_on(k, first)) exit
        first = k
        if (first == s) exit
      end do
      call append_run(first, order)
    end do

  contains

    !> Whether a run goes on from one segment to the next one.
    pure function goes_on(one, two)
      integer, intent(in) :: one, two
      logical :: goes_on
      type(turn_t) :: turn

      goes_on = .false.
      if (one == 0 .or. two == 0) return
      if (.not. (is_active(one) .and. is_active(two))) return
      turn = turn_at(surface, places, one, two)
      goes_on = .not. (turn%is_sharp .and. turn%is_convex)
    end function goes_on

    !> One run from its first segment on.
    pure subroutine append_run(start, order)
      integer, intent(in) :: start
      type(order_t), intent(inout) :: order
      integer :: now, next, from

      from = order%n + 1
      now = start
      do
        order%n = order%n + 1
        order%segment(order%n) = now
        order%position(now) = order%n
        next = surface%next(now)
        if (.not. goes_on(now, next)) exit
        order%turn(order%n) = turn_between(surface, places, now, next)
        if (next == start) then
          order%is_ring(from:order%n) = .true.
          exit
        end if
        now = next
      end do
      order%first(from:order%n) = from
      order%last(from:order%n) = order%n
    end subroutine append_run

  end subroutine put_in_order

  !> Turn from one segment to the next, away from the body, rad.
  pure function turn_between(surface, places, segment, next) result(turn)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :)
    integer, intent(in) :: segment, next
    real(wp) :: turn
    real(wp) :: one(2), two(2)

    associate (nodes => surface%segments)
      one = separation(places(:, nodes(2, segment)), places(:, nodes(1, segment)))
      two = separation(places(:, nodes(2, next)), places(:, nodes(1, next)))
    end associate
    turn = -atan2(one(1)*two(2) - one(2)*two(1), dot_product(one, two))
  end function turn_between

  !> The ways along a run between the segments of each pair that are in one: on a ring there are
  !> two.
  pure subroutine list_arcs(order, pairs, n_arc, arcs)
    type(order_t), intent(in) :: order
    integer, intent(in) :: pairs(:, :)
    integer, intent(out) :: n_arc
    integer, intent(inout) :: arcs(:, :) !! (2, twice the pairs)
    integer :: i, from, to

    n_arc = 0
    do i = 1, size(pairs, 2)
      from = minval(order%position(pairs(:, i)))
      to = maxval(order%position(pairs(:, i)))
      if (from == 0 .or. from == to) cycle
      if (order%first(from) /= order%first(to)) cycle
      n_arc = n_arc + 1
      arcs(:, n_arc) = [from, to - from]
      if (.not. order%is_ring(from)) cycle
      n_arc = n_arc + 1
      arcs(:, n_arc) = [to, from - to + 1 + order%last(from) - order%first(from)]
    end do
  end subroutine list_arcs

  !> Position behind another, round a ring.
  pure function next_position(order, position) result(next)
    type(order_t), intent(in) :: order
    integer, intent(in) :: position
    integer :: next

    next = position + 1
    if (position == order%last(position)) next = order%first(position)
  end function next_position

  !> Part a run between two of its segments: wherever it turns most there.
  pure subroutine cut_arc(order, arc, is_cut)
    type(order_t), intent(in) :: order
    integer, intent(in) :: arc(2)
    logical, intent(inout) :: is_cut(:)
    real(wp) :: most
    integer :: k, step

    most = -huge(1.0_wp)
    k = arc(1)
    do step = 1, arc(2)
      most = max(most, order%turn(k))
      k = next_position(order, k)
    end do
    k = arc(1)
    do step = 1, arc(2)
      if (order%turn(k) >= most - same_turn) is_cut(k) = .true.
      k = next_position(order, k)
    end do
  end subroutine cut_arc

  !> Steps from each position to the next cut of its run.
  pure subroutine measure_cuts(order)
    type(order_t), intent(inout) :: order
    integer :: last, k, round, steps

    last = order%n
    do while (last > 0)
      steps = huge(1) - 2*order%n - 2
      do round = 1, merge(2, 1, order%is_ring(last))
        do k = last, order%first(last), -1
          steps = steps + 1
          if (order%is_cut(k)) steps = 0
          order%to_cut(k) = steps
        end do
      end do
      last = order%first(last) - 1
    end do
  end subroutine measure_cuts

end module self_runs_m
