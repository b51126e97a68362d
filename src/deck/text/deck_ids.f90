! SPDX-License-Identifier: MIT
!> Map from user ids to indices: a table where ids are dense, else a sorted list.
module deck_ids_m
  use kinds_m, only : long
  use sorting_m, only : sorted_order
  implicit none
  private
  public :: id_map_t, map_ids, index_of, ids_between, n_kind, kind_names, a_node, an_element, &
    a_part, a_section, a_material, an_eos, an_hourglass, a_curve, a_table, a_node_set, a_part_set, &
    a_segment_set, a_shell_set, a_system, a_box, &
    a_transformation

  !> Kinds of entities with user ids.
  integer, parameter :: n_kind = 16, a_node = 1, an_element = 2, a_part = 3, a_section = 4, &
    a_material = 5, an_eos = 6, an_hourglass = 7, a_curve = 8, a_table = 9, a_node_set = 10, &
    a_part_set = 11, a_segment_set = 12, a_shell_set = 13, a_system = 14, a_box = 15, &
    a_transformation = 16
  character(17), parameter :: kind_names(n_kind) = [character(17) :: 'node', 'element', 'part', &
    'section', 'material', 'equation of state', '*HOURGLASS', 'curve', 'table', 'node set', &
    'part set', 'segment set', 'shell set', 'coordinate system', 'box', &
    'transformation']

  !> Map of one kind of entity.
  type :: id_map_t
    logical :: has_refused = .false.         !! some definitions were refused
    logical :: incomplete = .false.          !! some are refused, or none where a deck needs some
    integer :: n = 0                         !! number defined so far
    integer, allocatable :: ids(:), lines(:) !! ids and lines of their definitions
    integer :: low = 1                       !! smallest id of the table
    integer, allocatable :: table(:)         !! index of id low, low + 1, ..., 0 where there is none
    integer, allocatable :: sorted(:)        !! ids in increasing order ...
    integer, allocatable :: order(:)         !! ... and their indices
  end type id_map_t

contains

  !> Build a map; `duplicates` has the positions of repeated ids.
  subroutine map_ids(ids, map, duplicates)
    integer, intent(in) :: ids(:)
    type(id_map_t), intent(out) :: map
    integer, allocatable, intent(out) :: duplicates(:)
    logical, allocatable :: is_duplicate(:)
    integer :: i, n

    n = size(ids)
    allocate (duplicates(0))
    if (n == 0) then
      allocate (map%table(0))
      return
    end if
    allocate (is_duplicate(n), source=.false.)
    map%low = minval(ids)
    if (int(maxval(ids), long) - map%low < 4_long*n + 1024) then
      allocate (map%table(maxval(ids) - map%low + 1), source=0)
      do i = 1, n
        is_duplicate(i) = map%table(ids(i) - map%low + 1) > 0
        if (.not. is_duplicate(i)) map%table(ids(i) - map%low + 1) = i
      end do
    else
      map%order = sorted_order(int(ids, long))
      map%sorted = ids(map%order)
      do i = 2, n
        is_duplicate(map%order(i)) = map%sorted(i) == map%sorted(i - 1)
      end do
    end if
    if (any(is_duplicate)) duplicates = pack([(i, i=1, n)], is_duplicate)
  end subroutine map_ids

  !> Index of an id, or 0.
  pure function index_of(map, id) result(found)
    type(id_map_t), intent(in) :: map
    integer, intent(in) :: id
    integer :: found
    integer :: position

    found = 0
    if (allocated(map%table)) then
      if (id < map%low .or. id - map%low >= size(map%table)) return
      found = map%table(id - map%low + 1)
    else if (allocated(map%sorted)) then
      position = first_position(map%sorted, id)
      if (position > size(map%sorted)) return
      if (map%sorted(position) == id) found = map%order(position)
    end if
  end function index_of

  !> Indices of all ids from `first` to `last`, in increasing order of id.
  subroutine ids_between(map, first, last, found)
    type(id_map_t), intent(in) :: map
    integer, intent(in) :: first, last
    integer, allocatable, intent(out) :: found(:)
    integer :: from, to

    allocate (found(0))
    if (allocated(map%table)) then
      if (last < map%low .or. size(map%table) == 0) return
      from = max(first, map%low) - map%low + 1
      to = min(last - map%low + 1, size(map%table))
      if (from > to) return
      found = pack(map%table(from:to), map%table(from:to) > 0)
    else if (allocated(map%sorted)) then
      from = first_position(map%sorted, first)
      to = from
      do while (to <= size(map%sorted))
        if (map%sorted(to) > last) exit
        to = to + 1
      end do
      found = map%order(from:to - 1)
    end if
  end subroutine ids_between

  !> Position of the first element of an increasing list that is at least `id`.
  pure function first_position(sorted, id) result(position)
    integer, intent(in) :: sorted(:)
    integer, intent(in) :: id
    integer :: position
    integer :: low, high

    low = 0
    high = size(sorted) + 1
    do while (high - low > 1)
      position = low + (high - low)/2
      if (sorted(position) < id) then
        low = position
      else
        high = position
      end if
    end do
    position = high
  end function first_position

end module deck_ids_m
