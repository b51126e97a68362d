! SPDX-License-Identifier: MIT
!> Exchange between the processes of an explicit run. Each process computes the elements of its
!> tiles and moves their interior nodes. In each cycle neighbours exchange the forces at shared
!> borders (halo exchange, slot by slot, since they are added in a fixed order), and all processes
!> exchange forces on nodes that all compute, check results and notices. The first process gathers
!> other data when files need it.
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
  !> Largest number of chunks in one message.
  integer, parameter :: most_chunks = 128

  !> Buffers of the exchange in each cycle.
  type :: halo_t
    integer, allocatable :: starts(:)  !! (n + 1) start of the values of each process for all
    real(wp), allocatable :: values(:) !! values for all
    real(wp), allocatable :: outgoing(:, :), incoming(:, :) !! (2, slots) forces at borders
    integer(long) :: sent(2) = 0, joined(2) = 0 !! message counts of `ranks_t` of this exchange
                                                !! alone
    integer(long) :: n_cycle = 0
    integer :: n_removed = 0             !! known eroded elements of this process
    integer, allocatable :: n_failed(:)  !! known failed points of its chunks
  end type halo_t

contains

  !> Allocate the buffers of the exchange in each cycle.
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
      if (allocated(elements%erosion)) halo%n_removed = sum(elements%erosion%n_removed(first:last))
      if (allocated(elements%n_failed)) halo%n_failed = elements%n_failed(first:last)
    end associate
  end subroutine plan_halo

  !> Exchange forces of tiles on special nodes and sums over nodes; `exchange_checks` follows.
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

    !> Copy the values of a process for all into the buffer, or out of it.
    subroutine copy_rank_values(rank, puts)
      integer, intent(in) :: rank
      logical, intent(in) :: puts !! into the buffer
      integer :: at, i

      at = halo%starts(rank + 1)
      associate (first => partition%common_starts(rank + 1), &
        last => partition%common_starts(rank + 2) - 1)
        if (last >= first) call copy_columns(puts, partition%common(first:last), 2, &
          state%force_slots, halo%values(at))
        at = at + 2*(last - first + 1)
      end associate
      if (.not. allocated(sums%parts)) return
      ! Sums of blocks follow those of tiles.
      associate (columns => [(i, i=partition%tiles(rank), partition%tiles(rank + 1) - 1), &
        (size(sums%parts, 2) - size(sums%blocks, 2) + i, i=sums%starts(rank + 1), &
        sums%starts(rank + 2) - 1)])
        if (size(columns) > 0) call copy_columns(puts, columns, n_sum, sums%parts, &
          halo%values(at))
      end associate
    end subroutine copy_rank_values

  end subroutine exchange_halo

  !> Copy some columns of a table into a buffer, or out of it.
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

  !> Reduce the check results of all processes into the last check, and the notices.
  subroutine exchange_checks(partition, elements, ranks, halo, checks, notices)
    type(partition_t), intent(in) :: partition
    type(block_state_t), intent(in) :: elements
    type(ranks_t), intent(inout) :: ranks
    type(halo_t), intent(inout) :: halo
    type(tile_check_t), intent(inout) :: checks(:) !! of all tiles, and one for all processes
    logical, intent(inout) :: notices(:) !! in: of this process, without those of elements; out: of
                                         !! any process
    real(wp) :: values(3 + size(notices))
    integer :: n_removed

    associate (first => partition%chunks(ranks%mine), last => partition%chunks(ranks%mine + 1) - 1)
      if (allocated(elements%erosion)) then
        n_removed = sum(elements%erosion%n_removed(first:last))
        notices(notice_eroded) = n_removed > halo%n_removed
        halo%n_removed = n_removed
      end if
      if (allocated(elements%n_failed)) then
        notices(notice_failed) = any(elements%n_failed(first:last) /= halo%n_failed)
        halo%n_failed = elements%n_failed(first:last)
      end if
    end associate
    ! Minimum over the processes: below zero where a notice is set by any.
    values(4:) = merge(-1.0_wp, 0.0_wp, notices)
    associate (own => checks(partition%first_tile:partition%last_tile))
      values(1) = minval(own%time_limit)
      values(2) = -maxval(own%volume_change)
      ! The total work is below the bound if the works of all processes are below this share.
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

  !> Gather an array of integers, one range per process, in all processes.
  subroutine gather_integers(ranks, starts, values)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: starts(0:)     !! (0:n) first item of each range, then one beyond
    integer, intent(inout) :: values(:)
    real(wp), allocatable :: copies(:)

    copies = real(values, wp)
    call gather_reals(ranks, starts, 1, .true., copies)
    values = nint(copies)
  end subroutine gather_integers

  !> Gather the motion of nodes that single processes move, with the velocities of damped runs.
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

  !> Gather the whole state in the first process, or in all.
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

  !> Gather the element values that steps change, process by process, in messages of limited size.
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

  !> Requests of the user received by this process.
  subroutine collect_requests(state, ratio, monitor, recent, asked, error)
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: ratio            !! last energy ratio known
    type(monitor_t), intent(inout) :: monitor
    type(recent_requests_t), intent(inout) :: recent
    type(requests_t), intent(inout) :: asked !! previous requests in, new ones out
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

  !> Log the messages and bytes of a cycle, and those of files and rare events.
  subroutine report_exchange(halo, ranks, log)
    type(halo_t), intent(in) :: halo
    type(ranks_t), intent(inout) :: ranks
    type(log_t), intent(inout) :: log
    integer :: i
    real(wp) :: counts(4, ranks%n), rest(2)
    character(31) :: figures(10) !! means of four counts, their maxima, and the rest

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

    !> Mean and maximum of a count in words.
    function mean_and_most(k) result(text)
      integer, intent(in) :: k
      character(:), allocatable :: text

      text = trim(figures(k))//' ('//trim(figures(4 + k))//')'
    end function mean_and_most

  end subroutine report_exchange

  !> Forces of the elements of cross sections, before the elements are stepped: each process steps
  !> its own on a copy, and the first one gathers them.
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
        ! Slots are in rising order.
        starts = [(1 + count(model%layout%element_slot(elements) <= (partition%chunks(rank) - 1) &
          *chunk_size), rank=0, ranks%n)]
        call gather_reals(ranks, starts, 8, .false., state%cut_force(:, first:last))
        first = last + 1
      end associate
    end do
  end subroutine cut_sections

end module rank_exchange_m
