! SPDX-License-Identifier: MIT
!> Tiles whose elements need no step. A tile rests once a step with all of its nodes in one motion,
!> to the last bit, has left every value of its elements as it was and no force: the next step
!> would then do the same, for elements see only differences of their nodes. It wakes as soon as one
!> of its special nodes moves otherwise, which nothing but contact, loads and tiles around it can
!> bring about, and is stepped from then on. Tiles that rest at velocity zero amid others that do
!> are not even looked at.
module resting_tiles_m
  use packed_buffer_m, only : packed_buffer_t
  use kinds_m, only : wp, long
  use layout_m, only : layout_t, tile_t
  use log_m, only : log_t, write_log
  use model_m, only : model_t
  use rank_shares_m, only : shares_t
  use ranks_m, only : ranks_t, bring_reals
  use state_m, only : state_t
  use tile_neighbours_m, only : neighbours_t, find_neighbours
  use tile_values_m, only : take_values, same_bits
  implicit none
  private
  public :: rest_t, plan_rest, take_tiles, effort_of, is_awake, is_tried, rests, &
    is_flying, remember_tile, judge_tile, look_at_tile, follow_rest, report_rest

  !> Status of a tile: stepped in each cycle, or not; above zero so many cycles are left in which it
  !> may come to rest.
  integer, parameter :: awake = 0, resting = -1, flying = -2

  !> Cycles in which a tile may come to rest: signs of zeros may change in the first ones.
  integer, parameter :: n_try = 4

  !> Which tiles rest, and which are still looked at.
  type :: rest_t
    integer, allocatable :: status(:)    !! (tiles)
    integer :: first_tile = 1, last_tile = 0 !! of this process
    integer, allocatable :: stepped(:)   !! tiles to step, of this process
    integer, allocatable :: watched(:)   !! resting ones that may wake, or whose nodes move
    integer, allocatable :: run_tiles(:) !! the tile that owns each run of special nodes
    integer, allocatable :: summed(:)    !! runs that are summed and moved
    type(neighbours_t) :: neighbours     !! asked for once tiles rest
    real(wp), allocatable :: no_force(:, :) !! (2, n_local), likewise
    logical :: watches_all = .false.     !! tiles that rest are all looked at
    logical :: is_settled = .false.      !! no tile rests or may come to rest any more, in any
                                         !! process
    integer :: n_resting = 0             !! at the start of the cycle
    integer :: n_woken = 0, n_fallen = 0 !! since
    integer(long) :: n_skipped = 0       !! steps of tiles that were not taken
    integer(long) :: n_cycle = 0
  end type rest_t

contains

  !> All tiles are awake, and may come to rest if the model lets them.
  subroutine plan_rest(model, shares, run_tiles, watches_all, rest)
    type(model_t), intent(in) :: model
    type(shares_t), intent(in) :: shares
    integer, intent(in) :: run_tiles(:)  !! of the runs of special nodes that this process moves
    logical, intent(in) :: watches_all   !! resting tiles have to be looked at in each cycle
    type(rest_t), intent(out) :: rest
    integer :: i

    associate (n => size(model%layout%tiles), first => shares%first_tile, last => shares%last_tile)
      allocate (rest%status(n), source=awake)
      ! Where all bodies are rigid the one tile is empty.
      rest%is_settled = .not. may_rest(model)
      if (may_rest(model)) rest%status(first:last) = merge(n_try, awake, &
        model%layout%tiles(first:last)%last_chunk >= model%layout%tiles(first:last)%first_chunk)
      allocate (rest%stepped(last - first + 1), source=[(i, i = first, last)])
      allocate (rest%watched(0))
      allocate (rest%run_tiles, source=run_tiles)
      allocate (rest%summed(size(run_tiles)), source=[(i, i = 1, size(run_tiles))])
    end associate
    rest%first_tile = shares%first_tile
    rest%last_tile = shares%last_tile
    rest%watches_all = watches_all
  end subroutine plan_rest

  !> The tiles that a process has from now on, some of which rest.
  subroutine take_tiles(model, shares, status, run_tiles, rest)
    type(model_t), intent(in) :: model
    type(shares_t), intent(in) :: shares
    integer, intent(in) :: status(:)     !! of all tiles
    integer, intent(in) :: run_tiles(:)  !! as above
    type(rest_t), intent(inout) :: rest
    integer :: i

    rest%first_tile = shares%first_tile
    rest%last_tile = shares%last_tile
    associate (first => rest%first_tile, last => rest%last_tile)
      rest%status = awake
      rest%status(first:last) = status(first:last)
      rest%n_resting = count(rest%status < awake)
    end associate
    rest%run_tiles = run_tiles
    rest%summed = [(i, i = 1, size(run_tiles))]
    call list_tiles(model, rest)
  end subroutine take_tiles

  !> What a cycle costs an element of a tile, over what it costs where the tile is stepped: tiles
  !> that fly are looked at and their nodes move, of the others some are looked at.
  elemental function effort_of(status) result(effort)
    integer, intent(in) :: status
    real(wp) :: effort

    select case (status)
    case (flying); effort = 0.15_wp
    case (resting); effort = 0.02_wp
    case default; effort = 1.0_wp
    end select
  end function effort_of

  !> Whether a tile is stepped in all cycles to come.
  elemental function is_awake(status)
    integer, intent(in) :: status
    logical :: is_awake

    is_awake = status == awake
  end function is_awake

  !> Whether nothing but motion of its nodes can change the next step of a tile: no body load, no
  !> mass that grows, no element that leaves the mesh at a given time.
  pure function may_rest(model) result(may)
    type(model_t), intent(in) :: model
    logical :: may
    integer :: i

    may = size(model%conditions%body_loads) == 0 .and. (model%controls%masses_stay &
      .or. .not. abs(model%controls%mass_step) > 0.0_wp)
    do i = 1, size(model%materials)
      if (allocated(model%materials(i)%erosion)) &
        may = may .and. .not. model%materials(i)%erosion%time < huge(1.0_wp)
    end do
  end function may_rest

  !> Whether a tile that is stepped may come to rest.
  pure function is_tried(rest, i_tile) result(tried)
    type(rest_t), intent(in) :: rest
    integer, intent(in) :: i_tile
    logical :: tried

    tried = rest%status(i_tile) > 0
  end function is_tried

  !> Whether a tile rests.
  pure function rests(rest, i_tile)
    type(rest_t), intent(in) :: rest
    integer, intent(in) :: i_tile
    logical :: rests

    rests = rest%status(i_tile) < 0
  end function rests

  !> Whether a tile rests and its nodes move on, all by the same.
  pure function is_flying(rest, i_tile) result(flies)
    type(rest_t), intent(in) :: rest
    integer, intent(in) :: i_tile
    logical :: flies

    flies = rest%status(i_tile) == flying
  end function is_flying

  !> Before the step of a tile that is tried: what its elements are, if its nodes are in one motion;
  !> if not it is awake for good.
  subroutine remember_tile(model, i_tile, state, rest, before)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_tile
    type(state_t), intent(inout) :: state !! as before
    type(rest_t), intent(inout) :: rest
    real(wp), allocatable, intent(out) :: before(:) !! not there where it can not come to rest
    real(wp) :: one(4)
    integer :: i
    type(packed_buffer_t) :: buffer

    one = motion_of(model%layout, model%layout%tiles(i_tile), state%motion)
    rest%status(i_tile) = merge(rest%status(i_tile), awake, may_go_on(model, one, state) &
      .and. moves_as_one(model%layout, model%layout%tiles(i_tile), one, state%motion))
    do i = model%layout%tiles(i_tile)%first_node, model%layout%tiles(i_tile)%last_node
      if (rest%status(i_tile) == awake) exit
      if (.not. same_bits(state%motion(:, i), one)) rest%status(i_tile) = awake
    end do
    if (rest%status(i_tile) == awake .or. .not. state%dt_before > 0.0_wp) return
    call take_values(model%layout%tiles(i_tile), state%elements, buffer)
    call move_alloc(buffer%values, before)
  end subroutine remember_tile

  !> Whether the motion of a tile in one motion goes on as one: each element of a round body is
  !> strained by a radial one, and damping of parts is not that of one tile.
  pure function may_go_on(model, one, state) result(may)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: one(4)
    type(state_t), intent(in) :: state
    logical :: may

    may = .true.
    if (model%is_round) may = same_bits(one(1:3:2), [0.0_wp, 0.0_wp])
    if (allocated(state%node_damping)) may = may .and. same_bits(one(3:4), [0.0_wp, 0.0_wp])
  end function may_go_on

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
      call count_one(rest%n_fallen)
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
    call count_one(rest%n_woken)
  end subroutine look_at_tile

  !> The threads of the team count one after the other.
  subroutine count_one(n)
    integer, intent(inout) :: n

    !$omp atomic
    n = n + 1
  end subroutine count_one

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

  !> Whether all special nodes of a tile have this motion.
  pure function moves_as_one(layout, tile, one, motion) result(same)
    type(layout_t), intent(in) :: layout
    type(tile_t), intent(in) :: tile
    real(wp), intent(in) :: one(4)
    real(wp), intent(in), contiguous :: motion(:, :)
    logical :: same

    same = .true.
    if (tile%last_special < tile%first_special) return
    same = .not. differs(tile%last_special - tile%first_special + 1, &
      layout%special_node(tile%first_special), one, motion)
  end function moves_as_one

  !> Whether any of these nodes has another motion, in its bits.
  pure function differs(n, nodes, one, motion)
    integer, intent(in) :: n
    integer, intent(in) :: nodes(n)
    real(wp), intent(in) :: one(4)
    real(wp), intent(in) :: motion(4, *)
    logical :: differs
    integer(long) :: wanted(4), found(4)
    integer :: i, k

    wanted = transfer(one, wanted)
    found = 0_long
    do i = 1, n
      do k = 1, 4
        found(k) = ior(found(k), ieor(transfer(motion(k, nodes(i)), 0_long), wanted(k)))
      end do
    end do
    differs = any(found /= 0_long)
  end function differs

  !> At the end of a cycle: steps that were not taken, and the tiles of the next one.
  subroutine follow_rest(model, rest)
    type(model_t), intent(in) :: model
    type(rest_t), intent(inout) :: rest

    rest%n_cycle = rest%n_cycle + 1
    rest%n_skipped = rest%n_skipped + rest%n_resting - rest%n_woken
    if (rest%n_woken + rest%n_fallen == 0) return
    rest%n_resting = rest%n_resting - rest%n_woken + rest%n_fallen
    rest%n_woken = 0
    rest%n_fallen = 0
    call list_tiles(model, rest)
  end subroutine follow_rest

  !> The tiles of the next cycle. A resting one is looked at if it may wake, for its nodes may have
  !> moved, or a neighbour may, which would then push its nodes. Those of other processes count as
  !> awake: what becomes of them is not known here.
  subroutine list_tiles(model, rest)
    type(model_t), intent(in) :: model
    type(rest_t), intent(inout) :: rest
    logical, dimension(size(rest%status)) :: may_wake, is_watched, is_stepped
    integer :: i

    if (.not. allocated(rest%no_force)) then
      allocate (rest%no_force(2, model%layout%n_local), source=0.0_wp)
      call find_neighbours(model, rest%neighbours)
    end if
    associate (first => rest%neighbours%first, near => rest%neighbours%near)
      do i = 1, size(rest%status)
        may_wake(i) = rest%status(i) < awake .and. (rest%watches_all &
          .or. rest%neighbours%is_touched(i) &
          .or. any(rest%status(near(first(i):first(i + 1) - 1)) >= awake))
      end do
      do i = 1, size(rest%status)
        is_watched(i) = rest%status(i) < awake .and. (may_wake(i) .or. rest%status(i) == flying &
          .or. any(may_wake(near(first(i):first(i + 1) - 1))))
      end do
    end associate
    is_stepped = .false.
    is_stepped(rest%first_tile:rest%last_tile) = &
      rest%status(rest%first_tile:rest%last_tile) >= awake
    call list_true(is_stepped, rest%stepped)
    call list_true(is_watched, rest%watched)
    ! Else all are listed.
    if (.not. rest%watches_all) then
      is_watched = is_watched .or. rest%status >= awake
      call list_true([(is_watched(rest%run_tiles(i)), i = 1, size(rest%run_tiles))], rest%summed)
    end if
  end subroutine list_tiles

  !> The tiles for which something is true.
  subroutine list_true(is_true, tiles)
    logical, intent(in) :: is_true(:)
    integer, allocatable, intent(inout) :: tiles(:)
    integer :: i, n

    deallocate (tiles)
    allocate (tiles(count(is_true)))
    n = 0
    do i = 1, size(is_true)
      if (.not. is_true(i)) cycle
      n = n + 1
      tiles(n) = i
    end do
  end subroutine list_true

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
