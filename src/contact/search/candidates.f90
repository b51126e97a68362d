! SPDX-License-Identifier: MIT
!> Candidate pairs: which master segments a slave segment may touch before the bodies have moved by
!> the skin (doc/theory/contact.md, section 4). The lists are wide enough that no result depends on
!> when they were made.
module candidates_m
  use contact_state_m, only : contact_state_t, candidates_t, tracking_t, bucket_grid_t, &
    allocate_grid
  use contacts_m, only : contact_t
  use foot_m, only : face_on
  use geometry_m, only : separation
  use grid_m, only : fill_grid, cell_of, bucket_of
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: update_candidates, list_candidates, list_pairs, mean_length

  !> Skin: relative motion for which a list holds, as a part of the finer mean segment.
  real(wp), parameter :: skin_part = 0.5_wp
  !> Cosine between outward normals from which on segments look the same way (30 degrees). While a
  !> list holds each of them turns by 30 degrees at most, and none comes to be opposed (96 degrees).
  real(wp), parameter :: same_way = 0.866_wp

contains

  !> List the candidate pairs anew when the bodies have moved through the skin, or when FREQ asks
  !> for it; then every separated point is looked at.
  pure subroutine update_candidates(contact, cycle, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: cycle
    type(contact_state_t), intent(inout) :: memory
    logical :: is_due

    is_due = .not. memory%travel < memory%listed_until
    if (contact%search_interval > 0 .and. cycle >= memory%next_search) then
      memory%next_search = cycle + contact%search_interval
      is_due = .true.
    end if
    if (.not. is_due) return
    call list_candidates(contact, memory, memory%listed_until)
    call look_at_all(memory%slave_tracking)
    call look_at_all(memory%master_tracking)
    if (allocated(memory%segment_wake)) memory%segment_wake = -huge(1.0_wp)
    memory%next_segment_wake = -huge(1.0_wp)
  end subroutine update_candidates

  !> Have every separated point looked at in this call.
  pure subroutine look_at_all(tracking)
    type(tracking_t), intent(inout) :: tracking

    if (tracking%n == 0) return
    where (tracking%wake < huge(1.0_wp)) tracking%wake = -huge(1.0_wp)
    tracking%next_wake = -huge(1.0_wp)
  end subroutine look_at_all

  !> All pairs within the search radius, the motion of this call, and the skin. Boxes farther apart
  !> are looked at again when they can have come that near.
  pure subroutine list_candidates(contact, memory, valid_until)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), optional :: valid_until !! travel; after a restart it is known, m
    real(wp) :: skin, radius, apart
    integer :: n

    n = memory%n_slave
    skin = skin_part*min(mean_length(contact%slave, memory%places(:, :n)), &
      mean_length(contact%master, memory%places(:, n + 1:)))
    ! What a long step leads through a face lies as deep as that step.
    radius = memory%advance + max(memory%slave_tracking%reach, deepest_of(memory%slave_tracking), &
      deepest_of(memory%master_tracking))
    apart = box_gap(memory%places(:, :n), memory%places(:, n + 1:))
    if (present(valid_until)) valid_until = memory%travel + max(skin, apart - radius)
    call list_pairs(contact, memory%places, merge(radius + skin, -1.0_wp, apart <= radius + skin), &
      memory%candidates)
    if (memory%master_tracking%n > 0) &
      call reverse_pairs(contact%master%n_segment, memory%candidates, memory%reversed)
  end subroutine list_candidates

  !> Depth of the deepest active point, m.
  pure function deepest_of(tracking) result(depth)
    type(tracking_t), intent(in) :: tracking
    real(wp) :: depth
    integer :: k

    depth = 0.0_wp
    do k = 1, tracking%n_touching
      depth = max(depth, -tracking%gap(tracking%touching(k)))
    end do
  end function deepest_of

  !> Mean length of the segments of a surface, m.
  pure function mean_length(surface, places) result(length)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of this surface
    real(wp) :: length
    integer :: s

    length = 0.0_wp
    do s = 1, surface%n_segment
      length = length + norm2(separation(places(:, surface%segments(2, s)), &
        places(:, surface%segments(1, s))))
    end do
    length = length/max(surface%n_segment, 1)
  end function mean_length

  !> Distance between the boxes of two sets of positions, m.
  pure function box_gap(one, two) result(gap)
    real(wp), intent(in), contiguous :: one(:, :), two(:, :) !! (4, n)
    real(wp) :: gap
    real(wp), dimension(2) :: low_1, high_1, low_2, high_2

    if (min(size(one, 2), size(two, 2)) == 0) then
      gap = 0.0_wp
      return
    end if
    ! Both relative to one position: none loses digits far from the origin.
    call find_box(one, one(:, 1), low_1, high_1)
    call find_box(two, one(:, 1), low_2, high_2)
    gap = norm2(max(0.0_wp, low_1 - high_2, low_2 - high_1))
  end function box_gap

  !> Box of positions relative to an origin.
  pure subroutine find_box(places, origin, low, high)
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n)
    real(wp), intent(in) :: origin(4)
    real(wp), intent(out) :: low(2), high(2)         !! m
    real(wp) :: y(2)
    integer :: i

    low = huge(1.0_wp)
    high = -huge(1.0_wp)
    do i = 1, size(places, 2)
      y = separation(places(:, i), origin)
      low = min(low, y)
      high = max(high, y)
    end do
  end subroutine find_box

  !> Fill the rows: for each slave segment the master segments whose boxes lie within a radius of
  !> its own, by rising number.
  pure subroutine list_pairs(contact, places, radius, candidates)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_slave + n_master)
    real(wp), intent(in) :: radius                   !! m; below 0: no pair
    type(candidates_t), intent(inout) :: candidates
    type(bucket_grid_t) :: grid
    integer, allocatable :: listed_for(:)
    integer :: n, s

    call start_rows(contact%slave%n_segment, candidates)
    if (radius < 0.0_wp) return
    n = size(contact%slave%nodes)
    allocate (listed_for(contact%master%n_segment), source=0)
    call allocate_grid(grid, contact%master%n_segment)
    grid%least_cell = max(radius, tiny(1.0_wp))
    call fill_grid(grid, contact%master, places(:, n + 1:))
    do s = 1, contact%slave%n_segment
      call fill_row(contact, places(:, :n), places(:, n + 1:), radius, grid, s, listed_for, &
        candidates)
    end do
  end subroutine list_pairs

  !> Empty rows.
  pure subroutine start_rows(n, candidates)
    integer, intent(in) :: n
    type(candidates_t), intent(inout) :: candidates

    if (allocated(candidates%first)) then
      if (size(candidates%first) /= n + 1) deallocate (candidates%first)
    end if
    if (.not. allocated(candidates%first)) allocate (candidates%first(n + 1))
    candidates%first = 1
    if (.not. allocated(candidates%items)) allocate (candidates%items(16*n + 16), source=0)
  end subroutine start_rows

  !> One row, from the buckets that the box of the segment reaches.
  pure subroutine fill_row(contact, slave, master, radius, grid, s, listed_for, candidates)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: slave(:, :), master(:, :) !! (4, n_node) positions
    real(wp), intent(in) :: radius
    type(bucket_grid_t), intent(in) :: grid
    integer, intent(in) :: s                   !! slave segment
    integer, intent(inout) :: listed_for(:)    !! (master segments) row that has had it last
    type(candidates_t), intent(inout) :: candidates
    real(wp) :: a(2), b(2), low(2), high(2)
    integer :: cells(2, 2), ix, iy, bucket, i, m

    candidates%first(s + 1) = candidates%first(s)
    a = separation(slave(:, contact%slave%segments(1, s)), master(:, 1))
    b = separation(slave(:, contact%slave%segments(2, s)), master(:, 1))
    low = min(a, b) - radius
    high = max(a, b) + radius
    cells(:, 1) = cell_of(grid, max(low, grid%low))
    cells(:, 2) = cell_of(grid, min(high, grid%high))
    if (product(real(cells(:, 2) - cells(:, 1) + 1, wp)) > contact%master%n_segment) then
      ! The cells of a segment that long, or gone astray, are more than there are segments.
      do m = 1, contact%master%n_segment
        call enter_pair(contact, slave, master, [low, high], s, m, candidates)
      end do
      return
    end if
    do iy = cells(2, 1), cells(2, 2)
      do ix = cells(1, 1), cells(1, 2)
        bucket = bucket_of(grid, ix, iy)
        do i = grid%first(bucket) + 1, grid%first(bucket + 1)
          m = grid%items(i)
          if (listed_for(m) == s) cycle
          listed_for(m) = s
          call enter_pair(contact, slave, master, [low, high], s, m, candidates)
        end do
      end do
    end do
  end subroutine fill_row

  !> Enter a master segment in the row of a slave segment, by rising number, if they may touch.
  pure subroutine enter_pair(contact, slave, master, box, s, m, candidates)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: slave(:, :), master(:, :)
    real(wp), intent(in) :: box(4) !! low x, low y, high x, high y, relative to the first master
                                   !! node, m
    integer, intent(in) :: s, m
    type(candidates_t), intent(inout) :: candidates
    integer, allocatable :: longer(:)
    integer :: n, k

    if (.not. is_candidate(contact, slave, master, s, m, box)) return
    n = candidates%first(s + 1) - 1
    if (n == size(candidates%items)) then
      allocate (longer(2*n), source=0)
      longer(:n) = candidates%items
      call move_alloc(longer, candidates%items)
    end if
    associate (items => candidates%items)
      k = n
      do while (k >= candidates%first(s))
        if (items(k) < m) exit
        items(k + 1) = items(k)
        k = k - 1
      end do
      items(k + 1) = m
    end associate
    candidates%first(s + 1) = n + 2
  end subroutine enter_pair

  !> Whether a master segment may touch a slave segment: its box reaches into the given one, it does
  !> not look the same way, and it is not part of the same side of the body, nor its back.
  pure function is_candidate(contact, slave, master, s, m, box) result(is)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: slave(:, :), master(:, :)
    integer, intent(in) :: s, m
    real(wp), intent(in) :: box(4) !! see `enter_pair`
    logical :: is
    real(wp) :: a(2), b(2), own(2), other(2), product

    is = .false.
    associate (ends => contact%master%segments(:, m), own_ends => contact%slave%segments(:, s))
      a = separation(master(:, ends(1)), master(:, 1))
      b = separation(master(:, ends(2)), master(:, 1))
      if (any(min(a, b) > box(3:4)) .or. any(max(a, b) < box(1:2))) return
      other = b - a
      own = separation(slave(:, own_ends(2)), slave(:, own_ends(1)))
      product = dot_product(own, other)
      if (product > 0.0_wp) then
        if (product**2 > same_way**2*sum(own**2)*sum(other**2)) return
      end if
      if (contact%slave%segment_element(s) == contact%master%segment_element(m)) return
      associate (nodes => contact%master%nodes(ends), own_nodes => contact%slave%nodes(own_ends))
        is = .true.
        if (own_nodes(2) == nodes(1)) then
          is = folds(own, other)
        else if (own_nodes(1) == nodes(2)) then
          is = folds(other, own)
        else
          is = own_nodes(1) /= nodes(1) .and. own_nodes(2) /= nodes(2)
        end if
      end associate
    end associate
  end function is_candidate

  !> Whether a side folds upon itself from one segment to the next: they open towards each other by
  !> less than 60 degrees.
  pure function folds(one, two)
    real(wp), intent(in) :: one(2), two(2) !! vectors of the segments, along the surface, m
    logical :: folds

    folds = one(1)*two(2) - one(2)*two(1) < 0.0_wp .and. &
      dot_product(one, two) < face_on*norm2(one)*norm2(two)
  end function folds

  !> The same pairs by master segment.
  pure subroutine reverse_pairs(n, candidates, reversed)
    integer, intent(in) :: n !! master segments
    type(candidates_t), intent(in) :: candidates
    type(candidates_t), intent(inout) :: reversed
    integer :: s, i, m

    call start_rows(n, reversed)
    associate (n_item => candidates%first(size(candidates%first)) - 1)
      if (size(reversed%items) < n_item) then
        deallocate (reversed%items)
        allocate (reversed%items(n_item), source=0)
      end if
      reversed%first = 0
      do i = 1, n_item
        reversed%first(candidates%items(i)) = reversed%first(candidates%items(i)) + 1
      end do
    end associate
    ! Ends of the rows, which move down to their starts as the rows are filled from behind.
    do m = 2, n
      reversed%first(m) = reversed%first(m) + reversed%first(m - 1)
    end do
    reversed%first(n + 1) = reversed%first(max(n, 1)) + 1
    reversed%first(:n) = reversed%first(:n) + 1
    do s = size(candidates%first) - 1, 1, -1
      do i = candidates%first(s), candidates%first(s + 1) - 1
        m = candidates%items(i)
        reversed%first(m) = reversed%first(m) - 1
        reversed%items(reversed%first(m)) = s
      end do
    end do
  end subroutine reverse_pairs

end module candidates_m
