! SPDX-License-Identifier: MIT
!> Tiles whose elements need no step. A tile is quiescent, or in rigid translation, once a step with
!> all of its nodes in the same motion, to the last bit, has changed no value of its elements and
!> left no force: the next step would do the same, since elements depend on differences of nodes
!> only. The tile becomes active again as soon as one of its special nodes moves differently, by
!> contact, loads or neighbouring tiles, and stays active. Quiescent tiles amid quiescent tiles are
!> not monitored.
module quiescent_tiles_m
  use element_dispatch_m, only : gather_values, same_bits
  use packed_buffer_m, only : packed_buffer_t
  use kinds_m, only : wp, long
  use layout_m, only : layout_t, tile_t
  use log_m, only : log_t, write_log
  use model_m, only : model_t
  use rank_partition_m, only : partition_t
  use ranks_m, only : ranks_t, gather_reals
  use renumber_m, only : mark_moved_nodes
  use state_m, only : state_t
  implicit none
  private
  public :: tile_states_t, tile_active, tile_translating, plan_tile_states, save_tile, test_tile, &
    check_translation, update_tile_states, report_tile_states

  !> Status of a tile: active (above zero: number of cycles left in which it may become inactive),
  !> quiescent, in rigid translation.
  integer, parameter :: tile_active = 0, tile_quiescent = -1, tile_translating = -2

  !> Cycles in which a tile may become inactive: signs of zeros may change in the first ones.
  integer, parameter :: n_try = 4

  !> Activity of the tiles.
  type :: tile_states_t
    integer, allocatable :: status(:)    !! (tiles)
    integer, allocatable :: stepped(:)   !! tiles to step, of this process
    integer, allocatable :: monitored(:) !! inactive tiles that may become active, or whose nodes
                                         !! move
    integer, allocatable :: summed(:)    !! runs of special nodes that are summed and moved
    logical :: monitors_all = .false.    !! all inactive tiles are monitored
    real(wp), allocatable :: zero_force(:, :) !! (2, n_local) zeros; this and the next three are
                                              !! allocated once a tile is inactive
    logical, allocatable :: is_driven(:)  !! (tiles) contact, loads, prescribed motion, walls or
                                          !! rigid bodies may move its nodes
    integer, allocatable :: first(:)     !! (tiles + 1) start of the tiles that share nodes with
                                         !! each tile ...
    integer, allocatable :: neighbours(:) !! ... in this list
    integer :: n_inactive = 0            !! at the start of the cycle
    integer :: n_activated = 0, n_deactivated = 0 !! in this cycle
    integer(long) :: n_skipped = 0       !! tile steps that were skipped
    integer(long) :: n_cycle = 0
  end type tile_states_t

contains

  !> Set all tiles active, and let them become inactive if the model allows it.
  subroutine plan_tile_states(model, partition, monitors_all, tile_states)
    type(model_t), intent(in) :: model
    type(partition_t), intent(in) :: partition
    logical, intent(in) :: monitors_all  !! inactive tiles must be monitored in each cycle
    type(tile_states_t), intent(out) :: tile_states
    logical :: is_allowed
    integer :: i

    ! Only motion of its nodes may change the next step of a tile: no body load, no growing mass, no
    ! erosion at a given time.
    is_allowed = size(model%conditions%body_loads) == 0 .and. (model%controls%masses_stay &
      .or. .not. abs(model%controls%mass_step) > 0.0_wp)
    do i = 1, size(model%materials)
      if (allocated(model%materials(i)%erosion)) &
        is_allowed = is_allowed .and. .not. model%materials(i)%erosion%time < huge(1.0_wp)
    end do
    associate (n => size(model%layout%tiles), first => partition%first_tile, &
      last => partition%last_tile)
      allocate (tile_states%status(n), source=tile_active)
      ! With rigid bodies only, the one tile is empty.
      if (is_allowed) tile_states%status(first:last) = merge(n_try, tile_active, &
        model%layout%tiles(first:last)%last_chunk >= model%layout%tiles(first:last)%first_chunk)
      allocate (tile_states%stepped(last - first + 1), source=[(i, i = first, last)])
      allocate (tile_states%monitored(0))
      tile_states%summed = [(i, i=1, size(partition%run_tiles))]
    end associate
    tile_states%monitors_all = monitors_all
  end subroutine plan_tile_states

  !> Save the element values of a tile on trial before its step, if all nodes have the same motion;
  !> else the tile stays active.
  subroutine save_tile(model, i_tile, state, tile_states, before)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_tile
    type(state_t), intent(inout) :: state !! unchanged
    type(tile_states_t), intent(inout) :: tile_states
    real(wp), allocatable, intent(out) :: before(:) !! not allocated where the tile cannot become
                                                    !! inactive
    real(wp) :: one(4)
    logical :: is_uniform
    integer :: i
    type(packed_buffer_t) :: buffer

    one = motion_of(model%layout, model%layout%tiles(i_tile), state%motion)
    ! A radial motion strains axisymmetric elements, and with damping of parts velocities change.
    is_uniform = is_translation(model%layout, model%layout%tiles(i_tile), one, state%motion)
    if (model%is_axisymmetric) is_uniform = is_uniform .and. same_bits(one(1:3:2), [0.0_wp, 0.0_wp])
    if (allocated(state%node_damping)) &
      is_uniform = is_uniform .and. same_bits(one(3:4), [0.0_wp, 0.0_wp])
    do i = model%layout%tiles(i_tile)%first_node, model%layout%tiles(i_tile)%last_node
      if (.not. is_uniform) exit
      is_uniform = same_bits(state%motion(:, i), one)
    end do
    if (.not. is_uniform) tile_states%status(i_tile) = tile_active
    if (tile_states%status(i_tile) == tile_active .or. .not. state%dt_before > 0.0_wp) return
    call gather_values(model%layout%tiles(i_tile), state%elements, buffer)
    call move_alloc(buffer%values, before)
  end subroutine save_tile

  !> Set a tile on trial inactive if the step has changed no value and left no force.
  subroutine test_tile(model, i_tile, before, force, state, tile_states)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_tile
    real(wp), intent(in) :: before(:)
    real(wp), intent(in) :: force(2, *)    !! of the tile's local nodes
    type(state_t), intent(inout) :: state
    type(tile_states_t), intent(inout) :: tile_states
    type(packed_buffer_t) :: after
    real(wp) :: one(4)
    integer :: i
    logical :: is_unchanged

    tile_states%status(i_tile) = tile_states%status(i_tile) - 1
    associate (tile => model%layout%tiles(i_tile))
      call gather_values(tile, state%elements, after)
      is_unchanged = same_bits(before, after%values)
      do i = 1, tile%last_node - tile%first_node + 1 + tile%last_special - tile%first_special + 1
        is_unchanged = is_unchanged .and. same_bits(force(:, i), [0.0_wp, 0.0_wp])
      end do
      if (.not. is_unchanged) return
      one = motion_of(model%layout, tile, state%motion)
      tile_states%status(i_tile) = merge(tile_quiescent, tile_translating, same_bits(one(3:4), &
        [0.0_wp, 0.0_wp]))
      state%internal_force(:, tile%first_node:tile%last_node) = 0.0_wp
      !$omp atomic
      tile_states%n_deactivated = tile_states%n_deactivated + 1
    end associate
  end subroutine test_tile

  !> Check whether an inactive tile stays inactive in this cycle; else it is active from now on.
  subroutine check_translation(layout, i_tile, motion, tile_states)
    type(layout_t), intent(in) :: layout
    integer, intent(in) :: i_tile
    real(wp), intent(in), contiguous :: motion(:, :)
    type(tile_states_t), intent(inout) :: tile_states

    associate (tile => layout%tiles(i_tile))
      if (is_translation(layout, tile, motion_of(layout, tile, motion), motion)) return
    end associate
    tile_states%status(i_tile) = tile_active
    !$omp atomic
    tile_states%n_activated = tile_states%n_activated + 1
  end subroutine check_translation

  !> Motion of one node of a tile, an interior one if there is any.
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

  !> Whether all special nodes of a tile have this motion, bit by bit.
  pure function is_translation(layout, tile, one, motion) result(same)
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
  end function is_translation

  !> Count skipped steps at the end of a cycle, and list the tiles of the next one.
  subroutine update_tile_states(model, partition, tile_states)
    type(model_t), intent(in) :: model
    type(partition_t), intent(in) :: partition
    type(tile_states_t), intent(inout) :: tile_states

    tile_states%n_cycle = tile_states%n_cycle + 1
    tile_states%n_skipped = tile_states%n_skipped + tile_states%n_inactive - tile_states%n_activated
    if (tile_states%n_activated + tile_states%n_deactivated == 0) return
    tile_states%n_inactive = tile_states%n_inactive - tile_states%n_activated + &
      tile_states%n_deactivated
    tile_states%n_activated = 0
    tile_states%n_deactivated = 0
    call list_tiles(model, partition, tile_states)
  end subroutine update_tile_states

  !> List the tiles of the next cycle. An inactive tile is monitored if its nodes may move or a
  !> neighbour may become active. Tiles of other processes count as active.
  subroutine list_tiles(model, partition, tile_states)
    type(model_t), intent(in) :: model
    type(partition_t), intent(in) :: partition
    type(tile_states_t), intent(inout) :: tile_states
    logical, dimension(size(tile_states%status)) :: may_activate, is_monitored
    integer :: i

    if (.not. allocated(tile_states%zero_force)) then
      allocate (tile_states%zero_force(2, model%layout%n_local), source=0.0_wp)
      call find_neighbours(model, tile_states)
    end if
    associate (status => tile_states%status, neighbours => tile_states%neighbours, &
      first => tile_states%first)
      do i = 1, size(status)
        may_activate(i) = status(i) < tile_active .and. (tile_states%monitors_all &
          .or. tile_states%is_driven(i) &
          .or. any(status(neighbours(first(i):first(i + 1) - 1)) >= tile_active))
      end do
      do i = 1, size(status)
        is_monitored(i) = status(i) < tile_active .and. (may_activate(i) &
          .or. status(i) == tile_translating &
          .or. any(may_activate(neighbours(first(i):first(i + 1) - 1))))
      end do
      tile_states%stepped = pack([(i, i=partition%first_tile, partition%last_tile)], &
        status(partition%first_tile:partition%last_tile) >= tile_active)
      tile_states%monitored = pack([(i, i=1, size(status))], is_monitored)
      if (tile_states%monitors_all) return ! all runs are listed
      is_monitored = is_monitored .or. status >= tile_active
    end associate
    tile_states%summed = pack([(i, i=1, size(partition%run_tiles))], &
      is_monitored(partition%run_tiles))
  end subroutine list_tiles

  !> Find the tiles whose nodes have other forces than those of elements, and the tiles that share
  !> special nodes.
  subroutine find_neighbours(model, tile_states)
    type(model_t), intent(in) :: model
    type(tile_states_t), intent(inout) :: tile_states
    logical, allocatable :: is_moved(:)
    logical :: is_near(size(model%layout%tiles))
    integer :: tile_of(size(model%layout%special_node)), i, k

    call mark_moved_nodes(model, is_moved)
    associate (layout => model%layout, tiles => model%layout%tiles)
      allocate (tile_states%is_driven(size(tiles)), tile_states%first(size(tiles) + 1), &
        tile_states%neighbours(0))
      do i = 1, size(tiles)
        tile_of(tiles(i)%first_special:tiles(i)%last_special) = i
      end do
      do i = 1, size(tiles)
        associate (nodes => layout%special_node(tiles(i)%first_special:tiles(i)%last_special))
          tile_states%is_driven(i) = any(is_moved(nodes))
          is_near = .false.
          do k = 1, size(nodes)
            is_near(tile_of(layout%slot_list(layout%node_slots(nodes(k)): &
              layout%node_slots(nodes(k) + 1) - 1))) = .true.
          end do
        end associate
        is_near(i) = .false.
        tile_states%first(i) = size(tile_states%neighbours) + 1
        tile_states%neighbours = [tile_states%neighbours, pack([(k, k=1, size(tiles))], is_near)]
      end do
      tile_states%first(size(tiles) + 1) = size(tile_states%neighbours) + 1
      ! The last tile has the nodes without elements.
      tile_states%is_driven(size(tiles)) = .true.
    end associate
  end subroutine find_neighbours

  !> Log the number of tile steps, if some were skipped.
  subroutine report_tile_states(ranks, tile_states, log)
    type(ranks_t), intent(inout) :: ranks
    type(tile_states_t), intent(in) :: tile_states
    type(log_t), intent(inout) :: log
    real(wp) :: skipped(ranks%n)
    integer(long) :: n, n_skipped
    integer :: i
    character(48) :: figures

    skipped = 0.0_wp
    skipped(ranks%mine + 1) = real(tile_states%n_skipped, wp)
    if (ranks%n > 1) call gather_reals(ranks, [(i, i = 1, ranks%n + 1)], 1, .true., skipped)
    n = size(tile_states%status)*tile_states%n_cycle
    n_skipped = nint(sum(skipped), long)
    if (n_skipped == 0) return
    write (figures, '(ss,i0,a,i0)') n - n_skipped, ' of ', n
    call write_log(log, &
      'steps of tiles: '//trim(figures)//' (the others are quiescent or in rigid translation)')
  end subroutine report_tile_states

end module quiescent_tiles_m
