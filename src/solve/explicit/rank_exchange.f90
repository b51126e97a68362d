! SPDX-License-Identifier: MIT
!> What the processes of an explicit run exchange. Each computes the elements of its tiles and moves
!> their interior nodes. In each cycle those that share a border hear each other's forces on it
!> (raw, slot by slot: they are added in their fixed order), and all hear the forces on nodes that
!> all compute and what the elements have come to. The first process gathers the rest where files
!> ask for it.
module rank_exchange_m
  use block_state_m, only : block_state_t
  use errors_m, only : error_t
  use packed_buffer_m, only : stream_starts
  use health_m, only : tile_check_t, check_elements, most_work
  use kinds_m, only : wp, long
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use motion_sums_m, only : motion_sums_t
  use rank_borders_m, only : borders_t
  use rank_shares_m, only : shares_t
  use ranks_m, only : ranks_t, bring_reals, bring_integers, swap_reals, find_least, share_error
  use requests_m, only : requests_t
  use state_m, only : state_t
  implicit none
  private
  public :: parcel_t, record_t, plan_parcel, exchange_parcel, exchange_record, exchange_failures, &
    exchange_erosion, exchange_limits, exchange_history, gather_motion, gather_special, &
    gather_state, judge_elements

  !> Values of the sums over the nodes of a tile.
  integer, parameter :: n_sum = 4

  !> What is exchanged in each cycle.
  type :: parcel_t
    integer, allocatable :: starts(:)  !! (n + 1) where the piece of each process for all starts
    real(wp), allocatable :: values(:)
    real(wp), allocatable :: outgoing(:, :), incoming(:, :) !! (2, slots) forces on borders
    integer(long) :: sent(2) = 0, joined(2) = 0 !! what `ranks_t` counts, of these exchanges alone
    integer(long) :: n_cycle = 0
    integer :: n_shared = 0              !! times that the tiles were shared out anew
    integer :: n_gone = 0                !! elements of this process that are known to have left
    integer, allocatable :: n_failed(:)  !! failed points of its chunks that are known
  end type parcel_t

  !> What all have to know of each other's elements, and what someone asks of any of them.
  type :: record_t
    real(wp) :: time_limit = huge(1.0_wp) !! smallest of the elements
    real(wp) :: volume_change = 0.0_wp    !! largest of the elements
    logical :: is_sound = .true.          !! volumes are positive, works finite
    logical :: loses = .false.            !! elements have left
    logical :: fails = .false.            !! points have failed
    logical :: has_error = .false.
    type(requests_t) :: asked
  end type record_t

contains

  !> Room for what is exchanged in each cycle.
  pure subroutine plan_parcel(borders, shares, mine, elements, sums, parcel)
    type(borders_t), intent(in) :: borders
    type(shares_t), intent(in) :: shares
    integer, intent(in) :: mine !! number of this process
    type(block_state_t), intent(in) :: elements
    type(motion_sums_t), intent(in) :: sums
    type(parcel_t), intent(out) :: parcel

    parcel%starts = 2*(borders%common_starts - 1) + 1
    if (allocated(sums%parts)) parcel%starts = parcel%starts + n_sum*(shares%tiles - 1 &
      + sums%starts - 1)
    allocate (parcel%values(parcel%starts(size(parcel%starts)) - 1), source=0.0_wp)
    allocate (parcel%outgoing(2, size(borders%out_slots)), source=0.0_wp)
    allocate (parcel%incoming(2, size(borders%in_slots)), source=0.0_wp)
    associate (first => shares%chunks(mine), last => shares%chunks(mine + 1) - 1)
      if (allocated(elements%erosion)) parcel%n_gone = sum(elements%erosion%n_gone(first:last))
      if (allocated(elements%n_failed)) parcel%n_failed = elements%n_failed(first:last)
    end associate
  end subroutine plan_parcel

  !> Forces of tiles on special nodes and, where they are formed, sums over nodes; `exchange_record`
  !> follows.
  subroutine exchange_parcel(shares, borders, ranks, parcel, state, sums)
    type(shares_t), intent(in) :: shares
    type(borders_t), intent(in) :: borders
    type(ranks_t), intent(inout) :: ranks
    type(parcel_t), intent(inout) :: parcel
    type(state_t), intent(inout) :: state
    type(motion_sums_t), intent(inout) :: sums
    integer :: rank

    parcel%sent = parcel%sent - ranks%sent
    parcel%joined = parcel%joined - ranks%joined
    parcel%n_cycle = parcel%n_cycle + 1
    call copy_slots(.true., borders%out_slots, state%force_slots, parcel%outgoing)
    call swap_reals(ranks, borders%peers, 2*borders%out_starts - 1, parcel%outgoing, &
      2*borders%in_starts - 1, parcel%incoming)
    call copy_slots(.false., borders%in_slots, state%force_slots, parcel%incoming)
    if (size(parcel%values) == 0) return
    call fill_piece(ranks%mine, .true.)
    call bring_reals(ranks, parcel%starts, 1, .true., parcel%values)
    do rank = 0, ranks%n - 1
      if (rank /= ranks%mine) call fill_piece(rank, .false.)
    end do

  contains

    !> Put the piece of a process for all into the parcel, or take it out.
    subroutine fill_piece(rank, puts)
      integer, intent(in) :: rank
      logical, intent(in) :: puts
      integer :: at, first, last

      at = parcel%starts(rank + 1)
      first = borders%common_starts(rank + 1)
      last = borders%common_starts(rank + 2) - 1
      if (last >= first) call copy_slots(puts, borders%common(first:last), state%force_slots, &
        parcel%values(at))
      at = at + 2*(last - first + 1)
      if (.not. allocated(sums%parts)) return
      first = shares%tiles(rank)
      last = shares%tiles(rank + 1) - 1
      if (last >= first) call copy_columns(puts, last - first + 1, n_sum, sums%parts(1, first), &
        parcel%values(at))
      at = at + n_sum*(last - first + 1)
      ! Those of blocks stand behind those of tiles.
      first = size(sums%parts, 2) - size(sums%blocks, 2) + sums%starts(rank + 1)
      last = first + sums%starts(rank + 2) - sums%starts(rank + 1) - 1
      if (last >= first) call copy_columns(puts, last - first + 1, n_sum, sums%parts(1, first), &
        parcel%values(at))
    end subroutine fill_piece

  end subroutine exchange_parcel

  !> Forces of some slots into the parcel, or out of it.
  pure subroutine copy_slots(puts, slots, table, values)
    logical, intent(in) :: puts
    integer, intent(in) :: slots(:)
    real(wp), intent(inout) :: table(2, *), values(2, *)
    integer :: i

    if (puts) then
      do i = 1, size(slots)
        values(:, i) = table(:, slots(i))
      end do
    else
      do i = 1, size(slots)
        table(:, slots(i)) = values(:, i)
      end do
    end if
  end subroutine copy_slots

  !> Columns of a table into the parcel, or out of it.
  pure subroutine copy_columns(puts, n, width, table, values)
    logical, intent(in) :: puts
    integer, intent(in) :: n, width
    real(wp), intent(inout) :: table(width, n), values(width, n)

    if (puts) then
      values = table
    else
      table = values
    end if
  end subroutine copy_columns

  !> The record of this process, from what the elements of its tiles have come to, becomes that of
  !> all.
  subroutine exchange_record(shares, checks, elements, ranks, parcel, record)
    type(shares_t), intent(in) :: shares
    type(tile_check_t), intent(in) :: checks(:)   !! of all tiles
    type(block_state_t), intent(in) :: elements
    type(ranks_t), intent(inout) :: ranks
    type(parcel_t), intent(inout) :: parcel
    type(record_t), intent(inout) :: record       !! in: an error and what is asked of this one
    real(wp) :: values(10)
    integer :: n_gone

    associate (own => checks(shares%first_tile:shares%last_tile))
      record%time_limit = minval(own%time_limit)
      record%volume_change = maxval(own%volume_change)
      ! So that the works of all are below the bound where those of each are.
      record%is_sound = all(own%has_volume) &
        .and. abs(sum(own%checksum)) <= most_work/(ranks%n + 1)
    end associate
    associate (first => shares%chunks(ranks%mine), last => shares%chunks(ranks%mine + 1) - 1)
      if (allocated(elements%erosion)) then
        n_gone = sum(elements%erosion%n_gone(first:last))
        record%loses = n_gone > parcel%n_gone
        parcel%n_gone = n_gone
      end if
      if (allocated(elements%n_failed)) then
        record%fails = any(elements%n_failed(first:last) /= parcel%n_failed)
        parcel%n_failed = elements%n_failed(first:last)
      end if
    end associate
    associate (asked => record%asked)
      values(1) = record%time_limit
      values(10) = -record%volume_change
      ! The least of numbers: below zero where it holds of any process.
      values(2:9) = merge(-1.0_wp, 0.0_wp, [.not. record%is_sound, record%loses, record%fails, &
        record%has_error, asked%dump, asked%plot, asked%stop, asked%signalled])
      call find_least(ranks, values)
      record%time_limit = values(1)
      record%volume_change = -values(10)
      record%is_sound = values(2) >= 0.0_wp
      record%loses = values(3) < 0.0_wp
      record%fails = values(4) < 0.0_wp
      record%has_error = values(5) < 0.0_wp
      asked%dump = values(6) < 0.0_wp
      asked%plot = values(7) < 0.0_wp
      asked%stop = values(8) < 0.0_wp
      asked%signalled = values(9) < 0.0_wp
    end associate
    parcel%sent = parcel%sent + ranks%sent
    parcel%joined = parcel%joined + ranks%joined
  end subroutine exchange_record

  !> Elements that have left in this cycle, and what they take along.
  subroutine exchange_erosion(ranks, shares, elements)
    type(ranks_t), intent(inout) :: ranks
    type(shares_t), intent(in) :: shares
    type(block_state_t), intent(inout) :: elements

    associate (erosion => elements%erosion, slots => slots_of(shares%chunks))
      call bring_integers(ranks, shares%chunks, 1, .true., erosion%n_gone)
      call bring_integers(ranks, slots, 1, .true., erosion%status)
      call bring_reals(ranks, slots, 1, .true., erosion%hourglass)
      call bring_reals(ranks, slots, 1, .true., erosion%internal)
    end associate
  end subroutine exchange_erosion

  !> Points that have failed, chunk by chunk.
  subroutine exchange_failures(ranks, shares, elements)
    type(ranks_t), intent(inout) :: ranks
    type(shares_t), intent(in) :: shares
    type(block_state_t), intent(inout) :: elements

    call bring_integers(ranks, shares%chunks, 1, .true., elements%n_failed)
  end subroutine exchange_failures

  !> Step limits of all chunks.
  subroutine exchange_limits(ranks, shares, elements)
    type(ranks_t), intent(inout) :: ranks
    type(shares_t), intent(in) :: shares
    type(block_state_t), intent(inout) :: elements

    call bring_reals(ranks, shares%chunks, 1, .true., elements%time_limit)
  end subroutine exchange_limits

  !> The history of all elements for the first process, which looks for one of them.
  subroutine exchange_history(ranks, shares, elements)
    type(ranks_t), intent(inout) :: ranks
    type(shares_t), intent(in) :: shares
    type(block_state_t), intent(inout) :: elements

    call bring_reals(ranks, stream_starts(shares%chunks, elements%history_start, &
      size(elements%history)), 1, .false., elements%history)
  end subroutine exchange_history

  !> Motion of all nodes that only some processes move, with the velocities that damped runs keep.
  subroutine gather_motion(shares, borders, to_all, ranks, state)
    type(shares_t), intent(in) :: shares
    type(borders_t), intent(in) :: borders
    logical, intent(in) :: to_all
    type(ranks_t), intent(inout) :: ranks
    type(state_t), intent(inout) :: state

    call bring_reals(ranks, shares%nodes, 4, to_all, state%motion)
    if (allocated(state%former_velocity)) &
      call bring_reals(ranks, shares%nodes, 2, to_all, state%former_velocity)
    call gather_special(shares, borders, to_all, ranks, state)
  end subroutine gather_motion

  !> That of special nodes.
  subroutine gather_special(shares, borders, to_all, ranks, state)
    type(shares_t), intent(in) :: shares
    type(borders_t), intent(in) :: borders
    logical, intent(in) :: to_all
    type(ranks_t), intent(inout) :: ranks
    type(state_t), intent(inout) :: state

    call bring_reals(ranks, shares%special, 4, to_all, state%motion)
    if (allocated(state%former_velocity)) &
      call bring_reals(ranks, borders%block_nodes, 2, to_all, state%former_velocity)
  end subroutine gather_special

  !> The whole state for the first process, or for all.
  subroutine gather_state(shares, borders, to_all, ranks, state)
    type(shares_t), intent(in) :: shares
    type(borders_t), intent(in) :: borders
    logical, intent(in) :: to_all
    type(ranks_t), intent(inout) :: ranks
    type(state_t), intent(inout) :: state

    call gather_motion(shares, borders, to_all, ranks, state)
    call bring_reals(ranks, shares%nodes, 2, to_all, state%internal_force)
    call bring_reals(ranks, shares%special, 2, to_all, state%internal_force)
    call bring_reals(ranks, shares%force_slots, 2, to_all, state%force_slots)
    if (allocated(state%former_damping)) then
      call bring_reals(ranks, shares%nodes, 2, to_all, state%former_damping)
      call bring_reals(ranks, borders%block_nodes, 2, to_all, state%former_damping)
    end if
    call gather_chunks(ranks, shares, to_all, state%elements)
    call gather_slots(ranks, shares, to_all, state%elements)
    call gather_streams(ranks, shares, to_all, state%elements)
  end subroutine gather_state

  !> What elements keep chunk by chunk.
  subroutine gather_chunks(ranks, shares, to_all, elements)
    type(ranks_t), intent(inout) :: ranks
    type(shares_t), intent(in) :: shares
    logical, intent(in) :: to_all
    type(block_state_t), intent(inout) :: elements

    call bring_reals(ranks, shares%chunks, 1, to_all, elements%deviatoric_work)
    call bring_reals(ranks, shares%chunks, 1, to_all, elements%hourglass_work)
    call bring_reals(ranks, shares%chunks, 1, to_all, elements%viscous_work)
    call bring_reals(ranks, shares%chunks, 1, to_all, elements%time_limit)
    call bring_reals(ranks, shares%chunks, 1, to_all, elements%volume_limit)
    if (allocated(elements%damping_work)) &
      call bring_reals(ranks, shares%chunks, 1, to_all, elements%damping_work)
  end subroutine gather_chunks

  !> What they keep slot by slot. Their shape changes where they may leave the mesh.
  subroutine gather_slots(ranks, shares, to_all, elements)
    type(ranks_t), intent(inout) :: ranks
    type(shares_t), intent(in) :: shares
    logical, intent(in) :: to_all
    type(block_state_t), intent(inout) :: elements
    integer :: k

    associate (slots => slots_of(shares%chunks))
      do k = 1, size(elements%deviator, 2)
        call bring_reals(ranks, slots, 1, to_all, elements%deviator(:, k))
      end do
      if (allocated(elements%viscous_pressure)) &
        call bring_reals(ranks, slots, 1, to_all, elements%viscous_pressure)
      if (allocated(elements%damping_stress)) &
        call bring_reals(ranks, slots, 16, to_all, elements%damping_stress)
      if (.not. allocated(elements%erosion)) return
      do k = 1, size(elements%reference, 2)
        call bring_reals(ranks, slots, 1, to_all, elements%reference(:, k))
      end do
      call bring_reals(ranks, slots, 1, to_all, elements%erosion%hourglass)
      call bring_reals(ranks, slots, 1, to_all, elements%erosion%impulse)
    end associate
  end subroutine gather_slots

  !> What only some chunks keep.
  subroutine gather_streams(ranks, shares, to_all, elements)
    type(ranks_t), intent(inout) :: ranks
    type(shares_t), intent(in) :: shares
    logical, intent(in) :: to_all
    type(block_state_t), intent(inout) :: elements

    call gather_stream(elements%point_start, elements%point_deviator)
    call gather_stream(elements%history_start, elements%history)
    call gather_stream(elements%eos_start, elements%eos_state)
    call gather_stream(elements%hourglass_start, elements%hourglass_strain)

  contains

    subroutine gather_stream(chunk_start, values)
      integer, intent(in) :: chunk_start(:)
      real(wp), intent(inout), contiguous :: values(:)

      if (size(values) > 0) call bring_reals(ranks, stream_starts(shares%chunks, chunk_start, &
        size(values)), 1, to_all, values)
    end subroutine gather_stream

  end subroutine gather_streams

  !> Ranges of slots from those of chunks.
  pure function slots_of(chunks) result(slots)
    integer, intent(in) :: chunks(0:)
    integer :: slots(0:size(chunks) - 1)

    slots = (chunks - 1)*chunk_size + 1
  end function slots_of

  !> The first process looks at all elements, whose state it has gathered, and tells the others.
  subroutine judge_elements(ranks, model, state, error)
    type(ranks_t), intent(inout) :: ranks
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(error_t), allocatable, intent(inout) :: error

    if (ranks%mine == 0) call check_elements(model, state, error)
    if (ranks%n > 1) call share_error(ranks, error)
  end subroutine judge_elements

end module rank_exchange_m
