! SPDX-License-Identifier: MIT
!> What the processes of an explicit run exchange. Each computes the elements of its tiles and moves
!> their interior nodes; special nodes and all that acts on them are everywhere the same. So in each
!> cycle all hear the forces on special nodes (raw, slot by slot: they are added in their fixed
!> order) and what the elements have come to. The first process gathers the rest where files ask
!> for it.
module rank_exchange_m
  use block_state_m, only : block_state_t
  use errors_m, only : error_t
  use health_m, only : tile_check_t, check_elements
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use motion_sums_m, only : motion_sums_t
  use rank_shares_m, only : shares_t, stream_starts
  use ranks_m, only : ranks_t, bring_reals, bring_integers, share_error
  use requests_m, only : requests_t
  use state_m, only : state_t
  implicit none
  private
  public :: parcel_t, plan_parcel, exchange_parcel, write_record, read_records, value_skipped, &
    exchange_erosion, exchange_limits, exchange_history, gather_motion, gather_state, judge_elements

  !> Values of a record: limit, checksum, volumes, elements gone, requests (4), an error, steps of
  !> tiles that were not taken; and of the sums over the nodes of a tile.
  integer, parameter :: n_value = 10, value_skipped = 10, n_sum = 4

  !> What is exchanged in each cycle, process by process.
  type :: parcel_t
    integer, allocatable :: starts(:)      !! (n + 1) where the piece of each process starts
    real(wp), allocatable :: values(:)
    real(wp), allocatable :: records(:, :) !! (n_value, n) what each process says of its tiles
    real(wp) :: own(n_value) = 0.0_wp      !! the record of this process
  end type parcel_t

contains

  !> Room for what is exchanged in each cycle.
  pure subroutine plan_parcel(shares, sums, parcel)
    type(shares_t), intent(in) :: shares
    type(motion_sums_t), intent(in) :: sums
    type(parcel_t), intent(out) :: parcel
    integer :: i

    associate (n => ubound(shares%tiles, 1))
      parcel%starts = n_value*[(i, i=0, n)] + 2*(shares%force_slots - 1) + 1
      if (allocated(sums%parts)) parcel%starts = parcel%starts + n_sum*(shares%tiles - 1)
      ! The assignment has made the lower bound 1.
      allocate (parcel%values(parcel%starts(n + 1) - 1), source=0.0_wp)
      allocate (parcel%records(n_value, n), source=0.0_wp)
    end associate
  end subroutine plan_parcel

  !> Records of all processes, forces of all tiles on special nodes and, where they are formed, sums
  !> over the nodes of all tiles, in one message.
  subroutine exchange_parcel(ranks, shares, parcel, state, sums)
    type(ranks_t), intent(in) :: ranks
    type(shares_t), intent(in) :: shares
    type(parcel_t), intent(inout) :: parcel
    type(state_t), intent(inout) :: state
    type(motion_sums_t), intent(inout) :: sums
    integer :: rank

    call fill_piece(ranks%mine, .true.)
    call bring_reals(ranks, parcel%starts, 1, .true., parcel%values)
    do rank = 0, ranks%n - 1
      if (rank /= ranks%mine) call fill_piece(rank, .false.)
    end do
    parcel%records(:, ranks%mine + 1) = parcel%own
    if (allocated(state%elements%n_failed)) call bring_integers(ranks, shares%chunks, 1, .true., &
      state%elements%n_failed)

  contains

    !> Put the piece of a process into the parcel, or take it out.
    subroutine fill_piece(rank, puts)
      integer, intent(in) :: rank
      logical, intent(in) :: puts
      integer :: at, first, last

      at = parcel%starts(rank + 1)
      if (puts) then
        parcel%values(at:at + n_value - 1) = parcel%own
      else
        parcel%records(:, rank + 1) = parcel%values(at:at + n_value - 1)
      end if
      at = at + n_value
      first = shares%force_slots(rank)
      last = shares%force_slots(rank + 1) - 1
      if (last >= first) call copy_columns(puts, last - first + 1, 2, state%force_slots(1, first), &
        parcel%values(at))
      at = at + 2*(last - first + 1)
      first = shares%tiles(rank)
      last = shares%tiles(rank + 1) - 1
      if (allocated(sums%parts) .and. last >= first) call copy_columns(puts, last - first + 1, &
        n_sum, sums%parts(1, first), parcel%values(at))
    end subroutine fill_piece

  end subroutine exchange_parcel

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

  !> What the elements of this process have come to, and what is asked of it, for its record.
  pure subroutine write_record(shares, mine, checks, elements, asked, has_error, parcel)
    type(shares_t), intent(in) :: shares
    integer, intent(in) :: mine                   !! number of this process
    type(tile_check_t), intent(in) :: checks(:)
    type(block_state_t), intent(in) :: elements
    type(requests_t), intent(in) :: asked
    logical, intent(in) :: has_error
    type(parcel_t), intent(inout) :: parcel

    associate (record => parcel%own, own => checks(shares%first_tile:shares%last_tile))
      record(1) = minval(own%time_limit)
      record(2) = sum(own%checksum)
      record(3) = merge(1.0_wp, 0.0_wp, all(own%has_volume))
      record(4) = 0.0_wp
      if (allocated(elements%erosion)) record(4) = real(sum(elements%erosion%n_gone( &
        shares%chunks(mine):shares%chunks(mine + 1) - 1)), wp)
      record(5:8) = merge(1.0_wp, 0.0_wp, [asked%dump, asked%plot, asked%stop, asked%signalled])
      record(9) = merge(1.0_wp, 0.0_wp, has_error)
    end associate
  end subroutine write_record

  !> The records of all: what elements have come to, one check a process, and what is asked of the
  !> first one.
  pure subroutine read_records(parcel, checks, asked, n_gone, has_error)
    type(parcel_t), intent(in) :: parcel
    type(tile_check_t), intent(out) :: checks(:)  !! one a process at least
    type(requests_t), intent(out) :: asked
    integer, intent(out) :: n_gone                !! elements of all that are not there
    logical, intent(out) :: has_error             !! some process has one

    associate (records => parcel%records, n => size(parcel%records, 2))
      checks(:n)%time_limit = records(1, :)
      checks(:n)%checksum = records(2, :)
      checks(:n)%has_volume = records(3, :) > 0.0_wp
      n_gone = nint(sum(records(4, :)))
      asked%dump = records(5, 1) > 0.0_wp
      asked%plot = records(6, 1) > 0.0_wp
      asked%stop = records(7, 1) > 0.0_wp
      asked%signalled = records(8, 1) > 0.0_wp
      has_error = any(records(9, :) > 0.0_wp)
    end associate
  end subroutine read_records

  !> Elements that have left in this cycle, and what they take along.
  subroutine exchange_erosion(ranks, shares, elements)
    type(ranks_t), intent(in) :: ranks
    type(shares_t), intent(in) :: shares
    type(block_state_t), intent(inout) :: elements

    associate (erosion => elements%erosion, slots => slots_of(shares%chunks))
      call bring_integers(ranks, shares%chunks, 1, .true., erosion%n_gone)
      call bring_integers(ranks, slots, 1, .true., erosion%status)
      call bring_reals(ranks, slots, 1, .true., erosion%hourglass)
      call bring_reals(ranks, slots, 1, .true., erosion%internal)
    end associate
  end subroutine exchange_erosion

  !> Step limits of all chunks.
  subroutine exchange_limits(ranks, shares, elements)
    type(ranks_t), intent(in) :: ranks
    type(shares_t), intent(in) :: shares
    type(block_state_t), intent(inout) :: elements

    call bring_reals(ranks, shares%chunks, 1, .true., elements%time_limit)
  end subroutine exchange_limits

  !> The history of all elements, for what looks for one of them.
  subroutine exchange_history(ranks, shares, elements)
    type(ranks_t), intent(in) :: ranks
    type(shares_t), intent(in) :: shares
    type(block_state_t), intent(inout) :: elements

    call bring_reals(ranks, stream_starts(shares%chunks, elements%history_start, &
      size(elements%history)), 1, .true., elements%history)
  end subroutine exchange_history

  !> Motion of all interior nodes, with the velocities that damped runs keep.
  subroutine gather_motion(ranks, shares, to_all, state)
    type(ranks_t), intent(in) :: ranks
    type(shares_t), intent(in) :: shares
    logical, intent(in) :: to_all
    type(state_t), intent(inout) :: state

    call bring_reals(ranks, shares%nodes, 4, to_all, state%motion)
    if (allocated(state%former_velocity)) &
      call bring_reals(ranks, shares%nodes, 2, to_all, state%former_velocity)
  end subroutine gather_motion

  !> The whole state for the first process, or for all.
  subroutine gather_state(ranks, shares, to_all, state)
    type(ranks_t), intent(in) :: ranks
    type(shares_t), intent(in) :: shares
    logical, intent(in) :: to_all
    type(state_t), intent(inout) :: state

    call gather_motion(ranks, shares, to_all, state)
    call bring_reals(ranks, shares%nodes, 2, to_all, state%internal_force)
    if (allocated(state%former_damping)) &
      call bring_reals(ranks, shares%nodes, 2, to_all, state%former_damping)
    call gather_chunks(ranks, shares, to_all, state%elements)
    call gather_slots(ranks, shares, to_all, state%elements)
    call gather_streams(ranks, shares, to_all, state%elements)
  end subroutine gather_state

  !> What elements keep chunk by chunk.
  subroutine gather_chunks(ranks, shares, to_all, elements)
    type(ranks_t), intent(in) :: ranks
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
    type(ranks_t), intent(in) :: ranks
    type(shares_t), intent(in) :: shares
    logical, intent(in) :: to_all
    type(block_state_t), intent(inout) :: elements
    integer :: k

    associate (slots => slots_of(shares%chunks))
      do k = 1, size(elements%deviator, 2)
        call bring_reals(ranks, slots, 1, to_all, elements%deviator(:, k))
      end do
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
    type(ranks_t), intent(in) :: ranks
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
    type(ranks_t), intent(in) :: ranks
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(error_t), allocatable, intent(inout) :: error

    if (ranks%mine == 0) call check_elements(model, state, error)
    if (ranks%n > 1) call share_error(ranks, error)
  end subroutine judge_elements

end module rank_exchange_m
