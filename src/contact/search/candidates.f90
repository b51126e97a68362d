! SPDX-License-Identifier: MIT
!> Candidate pairs: which master segments a slave segment may touch before the bodies have moved by
!> the skin (doc/theory/contact.md, section 4). The lists are wide enough that no result depends on
!> when they were made.
module candidates_m
  use contact_state_m, only : contact_state_t
  use search_state_m, only : candidates_t, contact_status_t
  use contacts_m, only : contact_t
  use projection_m, only : face_on
  use geometry_m, only : separation
  use kinds_m, only : wp, long
  use surfaces_m, only : surface_t, is_axis_edge
  implicit none
  private
  public :: update_candidates, list_candidates, mean_length

  !> Skin: relative motion for which a list holds, as a part of the finer mean segment.
  real(wp), parameter :: skin_part = 0.5_wp
  !> Cosine between outward normals from which on segments look the same way (30 degrees). While a
  !> list holds a segment as long as the mean turns by 30 degrees at most, and none of two of these
  !> comes to be opposed to the other (96 degrees).
  real(wp), parameter :: same_way = 0.866_wp
  !> By how much two segments may turn together, rad, that nothing is known of but the skin.
  real(wp), parameter :: most_turn = 1.1_wp
  !> Cells are numbered within this range; beyond it they share the outermost number.
  real(wp), parameter :: widest = 1.0e8_wp

  !> Segments sorted into square cells by hashing. Positions are relative to the first node.
  type :: cells_t
    real(wp) :: side                  !! of a cell, m
    real(wp) :: skin                  !! m
    real(wp), allocatable :: t(:, :)  !! (2, n_segment) vector of each segment, m
    real(wp), allocatable :: low(:, :), high(:, :) !! (2, n_segment) corners of its box, m
    integer, allocatable :: first(:)  !! (n_bucket + 1) where each bucket starts, less 1 ...
    integer, allocatable :: items(:)  !! ... on this list of segments
  end type cells_t

contains

  !> List the candidate pairs anew when the bodies have moved through the skin, or when FREQ asks
  !> for it; then every separated point is due.
  pure subroutine update_candidates(contact, cycle, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: cycle
    type(contact_state_t), intent(inout) :: memory
    logical :: is_due

    is_due = .not. memory%travel < memory%listed_until
    if (contact%search_interval > 0 .and. cycle >= memory%next_listing) then
      memory%next_listing = cycle + contact%search_interval
      is_due = .true.
    end if
    if (.not. is_due) return
    call list_candidates(contact, memory, .false.)
    call search_all(memory%slave_status)
    call search_all(memory%master_status)
    if (allocated(memory%segments%next_search)) memory%segments%next_search = -huge(1.0_wp)
    memory%segments%earliest_search = -huge(1.0_wp)
  end subroutine update_candidates

  !> Make every separated point due in this call.
  pure subroutine search_all(status)
    type(contact_status_t), intent(inout) :: status

    if (status%n == 0) return
    where (status%next_search < huge(1.0_wp)) status%next_search = -huge(1.0_wp)
    status%earliest_search = -huge(1.0_wp)
  end subroutine search_all

  !> All pairs within the search radius, the motion of this call, and the skin. Boxes farther apart
  !> are searched again when they can have come that near.
  pure subroutine list_candidates(contact, memory, restarts)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    logical, intent(in) :: restarts !! until when the lists hold is known from the restart file
    real(wp) :: skin, radius, box_distance
    integer :: n

    n = memory%n_slave
    skin = skin_part*min(mean_length(contact%slave, memory%positions(:, :n)), &
      mean_length(contact%master, memory%positions(:, n + 1:)))
    ! What a long step leads through a face lies as deep as that step.
    radius = memory%advance + max(memory%slave_status%reach, deepest_of(memory%slave_status), &
      deepest_of(memory%master_status))
    box_distance = box_gap(memory%positions(:, :n), memory%positions(:, n + 1:))
    if (.not. restarts) memory%listed_until = memory%travel + max(skin, box_distance - radius)
    call list_pairs(contact, memory%positions, merge(radius + skin, -1.0_wp, box_distance &
      <= radius + skin), skin, memory%candidates)
    if (memory%master_status%n > 0) &
      call reverse_pairs(contact%master%n_segment, memory%candidates, memory%reversed)
  end subroutine list_candidates

  !> Depth of the deepest active point, m.
  pure function deepest_of(status) result(depth)
    type(contact_status_t), intent(in) :: status
    real(wp) :: depth
    integer :: k

    depth = 0.0_wp
    do k = 1, status%n_active
      depth = max(depth, -status%gap(status%active_points(k)))
    end do
  end function deepest_of

  !> Mean length of the segments of a surface, m.
  pure function mean_length(surface, positions) result(length)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of this surface
    real(wp) :: length
    integer :: s

    length = 0.0_wp
    do s = 1, surface%n_segment
      length = length + norm2(separation(positions(:, surface%segments(2, s)), &
        positions(:, surface%segments(1, s))))
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
  pure subroutine find_box(positions, origin, low, high)
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n)
    real(wp), intent(in) :: origin(4)
    real(wp), intent(out) :: low(2), high(2)         !! m
    real(wp) :: y(2)
    integer :: i

    low = huge(1.0_wp)
    high = -huge(1.0_wp)
    do i = 1, size(positions, 2)
      y = separation(positions(:, i), origin)
      low = min(low, y)
      high = max(high, y)
    end do
  end subroutine find_box

  !> Fill the rows: for each slave segment the master segments whose boxes lie within a radius of
  !> its own, by rising number.
  pure subroutine list_pairs(contact, positions, radius, skin, candidates)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_slave + n_master)
    real(wp), intent(in) :: radius                   !! m; below 0: no pair
    real(wp), intent(in) :: skin                     !! m
    type(candidates_t), intent(inout) :: candidates
    type(cells_t) :: cells
    integer, allocatable :: listed_for(:)
    integer :: n, s

    call start_rows(contact%slave%n_segment, candidates)
    if (radius < 0.0_wp) return
    n = size(contact%slave%nodes)
    allocate (listed_for(contact%master%n_segment), source=0)
    call fill_cells(contact%master, positions(:, n + 1:), radius, cells)
    cells%skin = skin
    do s = 1, contact%slave%n_segment
      associate (ends => contact%slave%segments(:, s))
        call fill_row(contact, s, separation(positions(:, ends(1)), positions(:, n + 1)), &
          separation(positions(:, ends(2)), positions(:, ends(1))), radius, cells, listed_for, &
          candidates)
      end associate
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

  !> Sort segments into cells (counting sort over hashed cells), so long that each of them lies in
  !> four at most.
  pure subroutine fill_cells(surface, positions, least, cells)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of this surface
    real(wp), intent(in) :: least                    !! side of a cell, m
    type(cells_t), intent(out) :: cells
    real(wp) :: a(2), b(2)
    integer :: i, n_bucket

    associate (n => surface%n_segment)
      allocate (cells%t(2, n), cells%low(2, n), cells%high(2, n))
      do i = 1, n
        a = separation(positions(:, surface%segments(1, i)), positions(:, 1))
        b = separation(positions(:, surface%segments(2, i)), positions(:, 1))
        cells%t(:, i) = b - a
        cells%low(:, i) = min(a, b)
        cells%high(:, i) = max(a, b)
      end do
      n_bucket = 16
      do while (n_bucket < 2*n)
        n_bucket = 2*n_bucket
      end do
      allocate (cells%first(n_bucket + 1), source=0)
      allocate (cells%items(4*n))
      cells%side = max(least, maxval(cells%high - cells%low), tiny(1.0_wp))
      if (.not. cells%side <= huge(1.0_wp)) cells%side = max(least, tiny(1.0_wp))
      do i = 1, n
        call visit_cells(i, .true., cells)
      end do
      do i = 2, n_bucket + 1
        cells%first(i) = cells%first(i) + cells%first(i - 1)
      end do
      do i = n, 1, -1
        call visit_cells(i, .false., cells)
      end do
    end associate
  end subroutine fill_cells

  !> Count a segment in the cells of its box, or enter it; that moves each bucket's end down to its
  !> start.
  pure subroutine visit_cells(segment, counts, cells)
    integer, intent(in) :: segment
    logical, intent(in) :: counts !! count only
    type(cells_t), intent(inout) :: cells
    integer :: low(2), high(2), ix, iy, bucket

    low = cell_of(cells, cells%low(:, segment))
    high = min(cell_of(cells, cells%high(:, segment)), low + 1)
    do iy = low(2), high(2)
      do ix = low(1), high(1)
        bucket = bucket_of(cells, ix, iy)
        if (counts) then
          cells%first(bucket) = cells%first(bucket) + 1
        else
          cells%items(cells%first(bucket)) = segment
          cells%first(bucket) = cells%first(bucket) - 1
        end if
      end do
    end do
  end subroutine visit_cells

  !> Cell that holds a position.
  pure function cell_of(cells, y) result(cell)
    type(cells_t), intent(in) :: cells
    real(wp), intent(in) :: y(2)
    integer :: cell(2)

    cell = floor(max(-widest, min(widest, y/cells%side)))
  end function cell_of

  !> Bucket of a cell (the usual hash of two primes).
  pure function bucket_of(cells, ix, iy) result(bucket)
    type(cells_t), intent(in) :: cells
    integer, intent(in) :: ix, iy
    integer :: bucket

    bucket = 1 + int(iand(ieor(73856093_long*ix, 19349663_long*iy), &
      int(size(cells%first) - 2, long)))
  end function bucket_of

  !> One row, from the buckets that the box of the segment reaches.
  pure subroutine fill_row(contact, s, start, t, radius, cells, listed_for, candidates)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: s                   !! slave segment
    real(wp), intent(in) :: start(2), t(2)     !! its first node from the master's first, its vector
    real(wp), intent(in) :: radius
    type(cells_t), intent(in) :: cells
    integer, intent(inout) :: listed_for(:)    !! (master segments) row that has had it last
    type(candidates_t), intent(inout) :: candidates
    real(wp) :: box(4)
    integer :: first(2), last(2), ix, iy, bucket, i, m

    candidates%first(s + 1) = candidates%first(s)
    box = [min(start, start + t) - radius, max(start, start + t) + radius]
    first = cell_of(cells, box(1:2))
    last = cell_of(cells, box(3:4))
    if (product(real(last - first + 1, wp)) > contact%master%n_segment) then
      ! The cells of a segment that long, or gone astray, are more than there are segments.
      do m = 1, contact%master%n_segment
        call enter_pair(contact, cells, s, t, box, m, candidates)
      end do
      return
    end if
    do iy = first(2), last(2)
      do ix = first(1), last(1)
        bucket = bucket_of(cells, ix, iy)
        do i = cells%first(bucket) + 1, cells%first(bucket + 1)
          m = cells%items(i)
          if (listed_for(m) == s) cycle
          listed_for(m) = s
          call enter_pair(contact, cells, s, t, box, m, candidates)
        end do
      end do
    end do
  end subroutine fill_row

  !> Enter a master segment in the row of a slave segment, by rising number, if its box reaches into
  !> the given one and they may touch.
  pure subroutine enter_pair(contact, cells, s, t, box, m, candidates)
    type(contact_t), intent(in) :: contact
    type(cells_t), intent(in) :: cells
    integer, intent(in) :: s, m
    real(wp), intent(in) :: t(2)   !! vector of the slave segment, m
    real(wp), intent(in) :: box(4) !! low x, low y, high x, high y, m
    type(candidates_t), intent(inout) :: candidates
    integer, allocatable :: longer(:)
    integer :: n, k

    if (max(cells%low(1, m) - box(3), cells%low(2, m) - box(4), box(1) - cells%high(1, m), &
      box(2) - cells%high(2, m)) > 0.0_wp) return
    if (.not. is_candidate(contact, s, t, m, cells%t(:, m), cells%skin)) return
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

  !> Whether a master segment may touch a slave segment: it does not look the same way, unless they
  !> are so short that they may turn, and it is not part of the same side of the body, nor its back,
  !> and neither lies on the axis.
  pure function is_candidate(contact, s, own, m, other, skin) result(is)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: s, m
    real(wp), intent(in) :: own(2), other(2) !! their vectors, m
    real(wp), intent(in) :: skin
    logical :: is
    real(wp) :: product, lengths(2)
    integer :: own_first, own_last, first, last

    is = .false.
    if (is_axis_edge(contact%master, m) .or. is_axis_edge(contact%slave, s)) return
    product = own(1)*other(1) + own(2)*other(2)
    if (product > 0.0_wp) then
      lengths = [norm2(own), norm2(other)]
      if (product > same_way*lengths(1)*lengths(2) .and. skin*(lengths(1) + lengths(2)) &
        <= most_turn*lengths(1)*lengths(2)) return
    end if
    if (contact%slave%segment_element(s) == contact%master%segment_element(m)) return
    own_first = contact%slave%nodes(contact%slave%segments(1, s))
    own_last = contact%slave%nodes(contact%slave%segments(2, s))
    first = contact%master%nodes(contact%master%segments(1, m))
    last = contact%master%nodes(contact%master%segments(2, m))
    is = .true.
    if (own_last == first) then
      is = turns_sharply(own, other)
    else if (own_first == last) then
      is = turns_sharply(other, own)
    else
      is = own_first /= first .and. own_last /= last
    end if
  end function is_candidate

  !> Whether two segments that follow each other form a sharp vertex: they open towards each other
  !> by less than 60 degrees.
  pure function turns_sharply(one, two)
    real(wp), intent(in) :: one(2), two(2) !! vectors of the segments, along the surface, m
    logical :: turns_sharply

    turns_sharply = one(1)*two(2) - one(2)*two(1) < 0.0_wp .and. &
      dot_product(one, two) < face_on*norm2(one)*norm2(two)
  end function turns_sharply

  !> Candidate pairs by master segment, from those by slave segment.
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
