! SPDX-License-Identifier: MIT
!> Tiles whose elements need no step. A tile rests once a step with all of its nodes in one motion,
!> to the last bit, has left every value of its elements as it was and no force: the next step
!> would then do the same, for elements see only differences of their nodes. It wakes as soon as one
!> of its special nodes moves otherwise, which nothing but contact, loads and tiles around it can
!> bring about, and is stepped from then on. Tiles that rest at velocity zero amid others that do
!> are not even looked at.
module resting_tiles_m
  use element_dispatch_m, only : take_values, same_bits
  use packed_buffer_m, only : packed_buffer_t
  use kinds_m, only : wp, long
  use layout_m, only : layout_t, tile_t
  use log_m, only : log_t, write_log
  use model_m, only : model_t
  use rank_shares_m, only : shares_t
  use ranks_m, only : ranks_t, bring_reals
  use renumber_m, only : mark_moved_nodes
  use state_m, only : state_t
  implicit none
  private
  public :: rest_t, awake, flying, plan_rest, remember_tile, judge_tile, look_at_tile, &
    follow_rest, report_rest

  !> Status of a tile: stepped in each cycle, or not as it rests or all of its nodes move by the
  !> same; above zero so many cycles are left in which it may come to rest.
  integer, parameter :: awake = 0, resting = -1, flying = -2

  !> Cycles in which a tile may come to rest: signs of zeros may change in the first ones.
  integer, parameter :: n_try = 4

  !> Which tiles rest, and which are still looked at.
  type :: rest_t
    integer, allocatable :: status(:)    !! (tiles)
    integer, allocatable :: stepped(:)   !! tiles to step, of this process
    integer, allocatable :: watched(:)   !! resting ones that may wake, or whose nodes move
    integer, allocatable :: summed(:)    !! runs that are summed and moved
    logical :: watches_all = .false.     !! tiles that rest are all looked at
    real(wp), allocatable :: no_force(:, :) !! (2, n_local) this and the next three only once tiles
                                         !! rest
    logical, allocatable :: is_touched(:) !! (tiles) contact, loads, prescribed motion, walls or
                                         !! bodies that are rigid may move its nodes
    integer, allocatable :: first(:)     !! (tiles + 1) where those start that have nodes in common
                                         !! with each tile ...
    integer, allocatable :: near(:)      !! ... in this list
    integer :: n_resting = 0             !! at the start of the cycle
    integer :: n_woken = 0, n_fallen = 0 !! since
    integer(long) :: n_skipped = 0       !! steps of tiles that were not taken
    integer(long) :: n_cycle = 0
  end type rest_t

contains

  !> All tiles are awake, and may come to rest if the model lets them.
  subroutine plan_rest(model, shares, watches_all, rest)
    type(model_t), intent(in) :: model
    type(shares_t), intent(in) :: shares
    logical, intent(in) :: watches_all   !! resting tiles have to be looked at in each cycle
    type(rest_t), intent(out) :: rest
    logical :: may_rest
    integer :: i

    ! Nothing but motion of its nodes can change the next step of a tile: no body load, no mass that
    ! grows, no element that leaves the mesh at a given time.
    may_rest = size(model%conditions%body_loads) == 0 .and. (model%controls%masses_stay &
      .or. .not. abs(model%controls%mass_step) > 0.0_wp)
    do i = 1, size(model%materials)
      if (allocated(model%materials(i)%erosion)) &
        may_rest = may_rest .and. .not. model%materials(i)%erosion%time < huge(1.0_wp)
    end do
    associate (n => size(model%layout%tiles), first => shares%first_tile, last => shares%last_tile)
      allocate (rest%status(n), source=awake)
      ! Where all bodies are rigid the one tile is empty.
      if (may_rest) rest%status(first:last) = merge(n_try, awake, &
        model%layout%tiles(first:last)%last_chunk >= model%layout%tiles(first:last)%first_chunk)
      allocate (rest%stepped(last - first + 1), source=[(i, i = first, last)])
      allocate (rest%watched(0))
      rest%summed = [(i, i=1, size(shares%run_tiles))]
    end associate
    rest%watches_all = watches_all
  end subroutine plan_rest

  !> Before the step of a tile that is tried: what its elements are, if its nodes are in one motion;
  !> if not it is awake for good.
  subroutine remember_tile(model, i_tile, state, rest, before)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_tile
    type(state_t), intent(inout) :: state !! as before
    type(rest_t), intent(inout) :: rest
    real(wp), allocatable, intent(out) :: before(:) !! not there where it can not come to rest
    real(wp) :: one(4)
    logical :: goes_on
    integer :: i
    type(packed_buffer_t) :: buffer

    one = motion_of(model%layout, model%layout%tiles(i_tile), state%motion)
    ! Each element of an axisymmetric body is strained by a radial motion, and damping of parts is
    ! not that of one tile.
    goes_on = moves_as_one(model%layout, model%layout%tiles(i_tile), one, state%motion)
    if (model%is_axisymmetric) goes_on = goes_on .and. same_bits(one(1:3:2), [0.0_wp, 0.0_wp])
    if (allocated(state%node_damping)) &
      goes_on = goes_on .and. same_bits(one(3:4), [0.0_wp, 0.0_wp])
    do i = model%layout%tiles(i_tile)%first_node, model%layout%tiles(i_tile)%last_node
      if (.not. goes_on) exit
      goes_on = same_bits(state%motion(:, i), one)
    end do
    if (.not. goes_on) rest%status(i_tile) = awake
    if (rest%status(i_tile) == awake .or. .not. state%dt_before > 0.0_wp) return
    call take_values(model%layout%tiles(i_tile), state%elements, buffer)
    call move_alloc(buffer%values, before)
  end subroutine remember_tile

  !> Behind it: the tile rests if nothing has come of the step.
  subroutine judge_tile(model, i_tile, before, force, state, rest)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_tile
    real(wp), intent(in) :: before(:)
    real(wp), intent(in) :: force(2, *)    !! of the tile's local nodes
    type(state_t), intent(inout) :: state
    type(rest_t), intent(inout) :: rest
    type(packed_buffer_t) :: after
    real(wp) :: one(4)
    integer :: i
    logical :: is_still

    rest%status(i_tile) = rest%status(i_tile) - 1
    associate (tile => model%layout%tiles(i_tile))
      call take_values(tile, state%elements, after)
      is_still = same_bits(before, after%values)
      do i = 1, tile%last_node - tile%first_node + 1 + tile%last_special - tile%first_special + 1
        is_still = is_still .and. same_bits(force(:, i), [0.0_wp, 0.0_wp])
      end do
      if (.not. is_still) return
      one = motion_of(model%layout, tile, state%motion)
      rest%status(i_tile) = merge(resting, flying, same_bits(one(3:4), [0.0_wp, 0.0_wp]))
      state%internal_force(:, tile%first_node:tile%last_node) = 0.0_wp
      !$omp atomic
      rest%n_fallen = rest%n_fallen + 1
    end associate
  end subroutine judge_tile

  !> Whether a resting tile goes on to rest in this cycle; if not it is awake for good.
  subroutine look_at_tile(layout, i_tile, motion, rest)
    type(layout_t), intent(in) :: layout
    integer, intent(in) :: i_tile
    real(wp), intent(in), contiguous :: motion(:, :)
    type(rest_t), intent(inout) :: rest

    associate (tile => layout%tiles(i_tile))
      if (moves_as_one(layout, tile, motion_of(layout, tile, motion), motion)) return
    end associate
    rest%status(i_tile) = awake
    !$omp atomic
    rest%n_woken = rest%n_woken + 1
  end subroutine look_at_tile

  !> Motion of one node of a tile, an interior one if it has any.
  pure function motion_of(layout, tile, motion) result(one)
    type(layout_t), intent(in) :: layout
    type(tile_t), intent(in) :: tile
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp) :: one(4)

    if (tile%last_node >= tile%first_node) then
      one = motion(:, tile%first_node)
    else
      one = motion(:, layout%special_node(tile%first_special))
    end if
  end function motion_of

  !> Whether all special nodes of a tile have this motion, in its bits.
  pure function moves_as_one(layout, tile, one, motion) result(same)
    type(layout_t), intent(in) :: layout
    type(tile_t), intent(in) :: tile
    real(wp), intent(in) :: one(4)
    real(wp), intent(in), contiguous :: motion(:, :)
    logical :: same
    integer(long) :: wanted(4), found(4)
    integer :: i, k

    wanted = transfer(one, wanted)
    found = 0_long
    do i = tile%first_special, tile%last_special
      associate (node => layout%special_node(i))
        do k = 1, 4
          found(k) = ior(found(k), ieor(transfer(motion(k, node), 0_long), wanted(k)))
        end do
      end associate
    end do
    same = all(found == 0_long)
  end function moves_as_one

  !> At the end of a cycle: steps that were not taken, and the tiles of the next one.
  subroutine follow_rest(model, shares, rest)
    type(model_t), intent(in) :: model
    type(shares_t), intent(in) :: shares
    type(rest_t), intent(inout) :: rest

    rest%n_cycle = rest%n_cycle + 1
    rest%n_skipped = rest%n_skipped + rest%n_resting - rest%n_woken
    if (rest%n_woken + rest%n_fallen == 0) return
    rest%n_resting = rest%n_resting - rest%n_woken + rest%n_fallen
    rest%n_woken = 0
    rest%n_fallen = 0
    call list_tiles(model, shares, rest)
  end subroutine follow_rest

  !> The tiles of the next cycle. A resting one is looked at if it may wake, for its nodes may have
  !> moved, or a neighbour may, which would then push its nodes. Those of other processes count as
  !> awake: what becomes of them is not known here.
  subroutine list_tiles(model, shares, rest)
    type(model_t), intent(in) :: model
    type(shares_t), intent(in) :: shares
    type(rest_t), intent(inout) :: rest
    logical, dimension(size(rest%status)) :: may_wake, is_watched
    integer :: i

    if (.not. allocated(rest%no_force)) then
      allocate (rest%no_force(2, model%layout%n_local), source=0.0_wp)
      call find_neighbours(model, rest)
    end if
    do i = 1, size(rest%status)
      may_wake(i) = rest%status(i) < awake .and. (rest%watches_all .or. rest%is_touched(i) &
        .or. any(rest%status(rest%near(rest%first(i):rest%first(i + 1) - 1)) >= awake))
    end do
    do i = 1, size(rest%status)
      is_watched(i) = rest%status(i) < awake .and. (may_wake(i) .or. rest%status(i) == flying &
        .or. any(may_wake(rest%near(rest%first(i):rest%first(i + 1) - 1))))
    end do
    rest%stepped = pack([(i, i=shares%first_tile, shares%last_tile)], &
      rest%status(shares%first_tile:shares%last_tile) >= awake)
    rest%watched = pack([(i, i=1, size(rest%status))], is_watched)
    if (rest%watches_all) return ! all runs are listed
    is_watched = is_watched .or. rest%status >= awake
    rest%summed = pack([(i, i=1, size(shares%run_tiles))], is_watched(shares%run_tiles))
  end subroutine list_tiles

  !> Which tiles have nodes that feel more than their elements, and which have special nodes in
  !> common.
  subroutine find_neighbours(model, rest)
    type(model_t), intent(in) :: model
    type(rest_t), intent(inout) :: rest
    logical, allocatable :: is_moved(:)
    logical :: is_near(size(model%layout%tiles))
    integer :: tile_of(size(model%layout%special_node)), i, k

    call mark_moved_nodes(model, is_moved)
    associate (layout => model%layout, tiles => model%layout%tiles)
      allocate (rest%is_touched(size(tiles)), rest%first(size(tiles) + 1), rest%near(0))
      do i = 1, size(tiles)
        tile_of(tiles(i)%first_special:tiles(i)%last_special) = i
      end do
      do i = 1, size(tiles)
        associate (nodes => layout%special_node(tiles(i)%first_special:tiles(i)%last_special))
          rest%is_touched(i) = any(is_moved(nodes))
          is_near = .false.
          do k = 1, size(nodes)
            is_near(tile_of(layout%slot_list(layout%node_slots(nodes(k)): &
              layout%node_slots(nodes(k) + 1) - 1))) = .true.
          end do
        end associate
        is_near(i) = .false.
        rest%first(i) = size(rest%near) + 1
        rest%near = [rest%near, pack([(k, k=1, size(tiles))], is_near)]
      end do
      rest%first(size(tiles) + 1) = size(rest%near) + 1
      ! The last one has the nodes without element, too.
      rest%is_touched(size(tiles)) = .true.
    end associate
  end subroutine find_neighbours

  !> The log tells how many steps of tiles were taken, if not all.
  subroutine report_rest(ranks, rest, log)
    type(ranks_t), intent(inout) :: ranks
    type(rest_t), intent(in) :: rest
    type(log_t), intent(inout) :: log
    real(wp) :: skipped(ranks%n)
    integer(long) :: n, n_skipped
    integer :: i
    character(48) :: figures

    skipped = 0.0_wp
    skipped(ranks%mine + 1) = real(rest%n_skipped, wp)
    if (ranks%n > 1) call bring_reals(ranks, [(i, i = 1, ranks%n + 1)], 1, .true., skipped)
    n = size(rest%status)*rest%n_cycle
    n_skipped = nint(sum(skipped), long)
    if (n_skipped == 0) return
    write (figures, '(ss,i0,a,i0)') n - n_skipped, ' of ', n
    call write_log(log, 'steps of tiles: '//trim(figures)//', in the others all nodes moved as one')
  end subroutine report_rest

end module resting_tiles_m
