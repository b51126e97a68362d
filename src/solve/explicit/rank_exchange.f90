! SPDX-License-Identifier: MIT
!> What the processes of an explicit run exchange. Each computes the elements of its tiles and moves
!> their interior nodes. In each cycle those that share a border hear each other's forces on it
!> (raw, slot by slot: they are added in their fixed order), and all hear the forces on nodes that
!> all compute and what the elements have come to. The first process gathers the rest where files
!> ask for it.
module rank_exchange_m
  use block_state_m, only : block_state_t
  use cut_forces_m, only : find_cut_forces
  use errors_m, only : error_t
  use health_m, only : tile_check_t, most_work
  use kinds_m, only : wp, long
  use layout_m, only : chunk_size
  use log_m, only : log_t, write_log, to_text
  use model_m, only : model_t
  use monitor_m, only : monitor_t
  use load_work_m, only : motion_sums_t
  use packed_buffer_m, only : packed_buffer_t, start_packing, start_unpacking, choose_slots
  use rank_partition_m, only : partition_t
  use ranks_m, only : ranks_t, gather_reals, exchange_reals, reduce_min
  use requests_m, only : requests_t, read_requests, recent_requests_t, get_signals, drop_repeated
  use state_m, only : state_t
  implicit none
  private
  public :: halo_t, plan_halo, exchange_halo, exchange_checks, n_notice, notice_eroded, &
    notice_failed, notice_error, notice_dump, notice_plot, notice_stop, notice_signal, &
    gather_integers, gather_motion, gather_state, collect_requests, report_exchange, &
    cut_sections

  !> Values of the sums over the nodes of a tile.
  integer, parameter :: n_sum = 4
  !> Notices that each process sends to all others, by number: elements have eroded, points have
  !> failed, an error has occurred; requests of the user for a restart file, a plot state, a stop,
  !> and a stop by a signal.
  integer, parameter :: n_notice = 7, notice_eroded = 1, notice_failed = 2, notice_error = 3, &
    notice_dump = 4, notice_plot = 5, notice_stop = 6, notice_signal = 7
  !> Chunks of a piece at most.
  integer, parameter :: most_chunks = 128

  !> What is exchanged in each cycle.
  type :: halo_t
    integer, allocatable :: starts(:)  !! (n + 1) where the piece of each process for all starts
    real(wp), allocatable :: values(:)
    real(wp), allocatable :: outgoing(:, :), incoming(:, :) !! (2, slots) forces on borders
    integer(long) :: sent(2) = 0, joined(2) = 0 !! what `ranks_t` counts, of these exchanges alone
    integer(long) :: n_cycle = 0
    integer :: n_gone = 0                !! elements of this process that are known to have left
    integer, allocatable :: n_failed(:)  !! failed points of its chunks that are known
  end type halo_t

contains

  !> Room for what is exchanged in each cycle.
  pure subroutine plan_halo(partition, mine, elements, sums, halo)
    type(partition_t), intent(in) :: partition
    integer, intent(in) :: mine !! number of this process
    type(block_state_t), intent(in) :: elements
    type(motion_sums_t), intent(in) :: sums
    type(halo_t), intent(out) :: halo

    halo%starts = 2*(partition%common_starts - 1) + 1
    if (allocated(sums%parts)) halo%starts = halo%starts + n_sum*(partition%tiles - 1 &
      + sums%starts - 1)
    allocate (halo%values(halo%starts(size(halo%starts)) - 1), source=0.0_wp)
    allocate (halo%outgoing(2, size(partition%out_slots)), source=0.0_wp)
    allocate (halo%incoming(2, size(partition%in_slots)), source=0.0_wp)
    associate (first => partition%chunks(mine), last => partition%chunks(mine + 1) - 1)
      if (allocated(elements%erosion)) halo%n_gone = sum(elements%erosion%n_gone(first:last))
      if (allocated(elements%n_failed)) halo%n_failed = elements%n_failed(first:last)
    end associate
  end subroutine plan_halo

  !> Forces of tiles on special nodes and, where they are formed, sums over nodes; `exchange_checks`
  !> follows.
  subroutine exchange_halo(partition, ranks, halo, state, sums)
    type(partition_t), intent(in) :: partition
    type(ranks_t), intent(inout) :: ranks
    type(halo_t), intent(inout) :: halo
    type(state_t), intent(inout) :: state
    type(motion_sums_t), intent(inout) :: sums
    integer :: rank

    halo%sent = halo%sent - ranks%sent
    halo%joined = halo%joined - ranks%joined
    halo%n_cycle = halo%n_cycle + 1
    call copy_columns(.true., partition%out_slots, 2, state%force_slots, halo%outgoing)
    call exchange_reals(ranks, partition%peers, 2*partition%out_starts - 1, halo%outgoing, &
      2*partition%in_starts - 1, halo%incoming)
    call copy_columns(.false., partition%in_slots, 2, state%force_slots, halo%incoming)
    if (size(halo%values) == 0) return
    call copy_rank_values(ranks%mine, .true.)
    call gather_reals(ranks, halo%starts, 1, .true., halo%values)
    do rank = 0, ranks%n - 1
      if (rank /= ranks%mine) call copy_rank_values(rank, .false.)
    end do

  contains

    !> Put the piece of a process for all into the halo, or take it out.
    subroutine copy_rank_values(rank, puts)
      integer, intent(in) :: rank
      logical, intent(in) :: puts
      integer :: at, i

      at = halo%starts(rank + 1)
      associate (first => partition%common_starts(rank + 1), &
        last => partition%common_starts(rank + 2) - 1)
        if (last >= first) call copy_columns(puts, partition%common(first:last), 2, &
          state%force_slots, halo%values(at))
        at = at + 2*(last - first + 1)
      end associate
      if (.not. allocated(sums%parts)) return
      ! Those of blocks stand behind those of tiles.
      associate (columns => [(i, i=partition%tiles(rank), partition%tiles(rank + 1) - 1), &
        (size(sums%parts, 2) - size(sums%blocks, 2) + i, i=sums%starts(rank + 1), &
        sums%starts(rank + 2) - 1)])
        if (size(columns) > 0) call copy_columns(puts, columns, n_sum, sums%parts, &
          halo%values(at))
      end associate
    end subroutine copy_rank_values

  end subroutine exchange_halo

  !> Some columns of a table into the halo, or out of it.
  pure subroutine copy_columns(puts, columns, width, table, values)
    logical, intent(in) :: puts
    integer, intent(in) :: columns(:), width
    real(wp), intent(inout) :: table(width, *), values(width, *)
    integer :: i

    do i = 1, size(columns)
      if (puts) then
        values(:, i) = table(:, columns(i))
      else
        table(:, columns(i)) = values(:, i)
      end if
    end do
  end subroutine copy_columns

  !> What the elements of all have come to, into the last of the checks; what any process tells.
  subroutine exchange_checks(partition, elements, ranks, halo, checks, notices)
    type(partition_t), intent(in) :: partition
    type(block_state_t), intent(in) :: elements
    type(ranks_t), intent(inout) :: ranks
    type(halo_t), intent(inout) :: halo
    type(tile_check_t), intent(inout) :: checks(:) !! of all tiles, and one behind them
    logical, intent(inout) :: notices(:) !! in: of this process, its elements aside; out: of any
    real(wp) :: values(3 + size(notices))
    integer :: n_gone

    associate (first => partition%chunks(ranks%mine), last => partition%chunks(ranks%mine + 1) - 1)
      if (allocated(elements%erosion)) then
        n_gone = sum(elements%erosion%n_gone(first:last))
        notices(notice_eroded) = n_gone > halo%n_gone
        halo%n_gone = n_gone
      end if
      if (allocated(elements%n_failed)) then
        notices(notice_failed) = any(elements%n_failed(first:last) /= halo%n_failed)
        halo%n_failed = elements%n_failed(first:last)
      end if
    end associate
    ! The least of numbers: below zero where it holds of any process.
    values(4:) = merge(-1.0_wp, 0.0_wp, notices)
    associate (own => checks(partition%first_tile:partition%last_tile))
      values(1) = minval(own%time_limit)
      values(2) = -maxval(own%volume_change)
      ! So that the works of all are below the bound where those of each are.
      values(3) = merge(0.0_wp, -1.0_wp, all(own%has_volume) &
        .and. abs(sum(own%checksum)) <= most_work/(ranks%n + 1))
    end associate
    call reduce_min(ranks, values)
    checks(size(checks)) = tile_check_t(time_limit=values(1), volume_change=-values(2), &
      has_volume=values(3) >= 0.0_wp)
    notices = values(4:) < 0.0_wp
    halo%sent = halo%sent + ranks%sent
    halo%joined = halo%joined + ranks%joined
  end subroutine exchange_checks

  !> Pieces of an array of integers, one a process, to all of them, as reals.
  subroutine gather_integers(ranks, starts, values)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: starts(0:)     !! (0:n) item at which each piece starts, then one beyond
    integer, intent(inout) :: values(:)
    real(wp), allocatable :: copies(:)

    copies = real(values, wp)
    call gather_reals(ranks, starts, 1, .true., copies)
    values = nint(copies)
  end subroutine gather_integers

  !> Motion of all nodes that only some processes move, with the velocities that damped runs keep.
  subroutine gather_motion(partition, to_all, ranks, state)
    type(partition_t), intent(in) :: partition
    logical, intent(in) :: to_all
    type(ranks_t), intent(inout) :: ranks
    type(state_t), intent(inout) :: state

    call gather_reals(ranks, partition%nodes, 4, to_all, state%motion)
    call gather_reals(ranks, partition%special, 4, to_all, state%motion)
    if (.not. allocated(state%previous_velocity)) return
    call gather_reals(ranks, partition%nodes, 2, to_all, state%previous_velocity)
    call gather_reals(ranks, partition%block_nodes, 2, to_all, state%previous_velocity)
  end subroutine gather_motion

  !> The whole state for the first process, or for all.
  subroutine gather_state(partition, to_all, ranks, state)
    type(partition_t), intent(in) :: partition
    logical, intent(in) :: to_all
    type(ranks_t), intent(inout) :: ranks
    type(state_t), intent(inout) :: state

    call gather_motion(partition, to_all, ranks, state)
    call gather_reals(ranks, partition%nodes, 2, to_all, state%internal_force)
    call gather_reals(ranks, partition%special, 2, to_all, state%internal_force)
    call gather_reals(ranks, partition%force_slots, 2, to_all, state%force_slots)
    if (allocated(state%previous_damping)) then
      call gather_reals(ranks, partition%nodes, 2, to_all, state%previous_damping)
      call gather_reals(ranks, partition%block_nodes, 2, to_all, state%previous_damping)
    end if
    call gather_elements(partition, to_all, ranks, state%elements)
  end subroutine gather_state

  !> What steps change of the elements of each process in turn, piece by piece.
  subroutine gather_elements(partition, to_all, ranks, elements)
    type(partition_t), intent(in) :: partition
    logical, intent(in) :: to_all
    type(ranks_t), intent(inout) :: ranks
    type(block_state_t), intent(inout) :: elements
    type(packed_buffer_t) :: buffer
    integer :: starts(0:ranks%n), rank, first
    logical :: takes

    do rank = merge(0, 1, to_all), ranks%n - 1
      takes = ranks%mine /= rank .and. (to_all .or. ranks%mine == 0)
      do first = partition%chunks(rank), partition%chunks(rank + 1) - 1, most_chunks
        buffer = packed_buffer_t()
        call choose_slots(buffer, [first, min(first + most_chunks, partition%chunks(rank + 1)) - &
          1], chunk_size, .false., .true.)
        call elements%visit(buffer)
        starts(:rank) = 1
        starts(rank + 1:) = buffer%n + 1
        if (.not. (takes .or. ranks%mine == rank)) buffer%n = 0
        call start_packing(buffer)
        if (ranks%mine == rank) call elements%visit(buffer)
        call gather_reals(ranks, starts, 1, to_all, buffer%values)
        if (.not. takes) cycle
        call start_unpacking(buffer)
        call elements%visit(buffer)
      end do
    end do
  end subroutine gather_elements

  !> What someone asks of this process, for all of them.
  subroutine collect_requests(state, ratio, monitor, recent, asked, error)
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: ratio            !! last energy ratio known
    type(monitor_t), intent(inout) :: monitor
    type(recent_requests_t), intent(inout) :: recent
    type(requests_t), intent(inout) :: asked !! last time, and now
    type(error_t), allocatable, intent(inout) :: error
    type(requests_t) :: before

    before = asked
    if (monitor%ranks%mine == 0) then
      call read_requests(state, ratio, .false., monitor, asked, error)
    else
      call get_signals(asked)
    end if
    call drop_repeated(before, recent, asked)
  end subroutine collect_requests

  !> A line of the log: what a cycle exchanges, and what files and rare events have besides.
  subroutine report_exchange(halo, ranks, log)
    type(halo_t), intent(in) :: halo
    type(ranks_t), intent(inout) :: ranks
    type(log_t), intent(inout) :: log
    integer :: i
    real(wp) :: counts(4, ranks%n), rest(2)
    character(31) :: figures(10) !! means of four counts, the most of each, and the rest

    rest = real(ranks%joined - halo%joined, wp)
    counts(:, ranks%mine + 1) = real([halo%sent, halo%joined], wp) &
      /real(max(halo%n_cycle, 1_long), wp)
    call gather_reals(ranks, [(i, i=1, ranks%n + 1)], 4, .false., counts)
    if (ranks%mine > 0) return
    write (figures, '(f31.2)') sum(counts, 2)/ranks%n, maxval(counts, 2), rest
    figures = adjustl(figures)
    call write_log(log, 'exchange: '//to_text(ranks%n)//' processes; a cycle, mean (most): ' &
      //'messages '//mean_and_most(1)//', bytes '//mean_and_most(2)//', calls of all ' &
      //mean_and_most(3)//', bytes by them '//mean_and_most(4)//'; besides, first process, in ' &
      //'all: calls of all '//trim(figures(9))//', bytes by them '//trim(figures(10)))

  contains

    !> Of one of the counts, in words.
    function mean_and_most(k) result(text)
      integer, intent(in) :: k
      character(:), allocatable :: text

      text = trim(figures(k))//' ('//trim(figures(4 + k))//')'
    end function mean_and_most

  end subroutine report_exchange

  !> Forces of the elements of cross sections, before the elements are stepped: each process steps
  !> its own on a copy, the first one gets all.
  subroutine cut_sections(model, partition, ranks, state)
    type(model_t), intent(in) :: model
    type(partition_t), intent(in) :: partition
    type(ranks_t), intent(inout) :: ranks
    type(state_t), intent(inout) :: state
    integer :: i, rank, first, last, starts(0:ranks%n)

    call find_cut_forces(model, [partition%chunks(ranks%mine), partition%chunks(ranks%mine + 1) - &
      1], state%motion, [state%time, state%dt_before], state%elements, state%cut_force)
    if (ranks%n == 1) return
    first = 1
    do i = 1, size(model%controls%output%cross_sections)
      associate (elements => model%controls%output%cross_sections(i)%elements)
        last = first + size(elements) - 1
        ! Their slots rise.
        starts = [(1 + count(model%layout%element_slot(elements) <= (partition%chunks(rank) - 1) &
          *chunk_size), rank=0, ranks%n)]
        call gather_reals(ranks, starts, 8, .false., state%cut_force(:, first:last))
        first = last + 1
      end associate
    end do
  end subroutine cut_sections

end module rank_exchange_m
