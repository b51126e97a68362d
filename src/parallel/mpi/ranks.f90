! SPDX-License-Identifier: MIT
!> Message passing between the processes of a run, by MPI. src/parallel/serial has the same module
!> for builds without MPI, with the same declarations: code compiled with one may be linked with the
!> other. Only one thread of a process calls MPI. A process that ends without `leave_ranks` ends the
!> run: the launcher stops the others.
module ranks_m
  use errors_m, only : error_t, raise
  use kinds_m, only : wp, long
  use mpi, only : mpi_allgatherv, mpi_allreduce, mpi_bcast, mpi_character, &
    mpi_comm_rank, mpi_comm_size, mpi_comm_world, mpi_datatype_null, mpi_double_precision, &
    mpi_finalize, mpi_gatherv, mpi_in_place, mpi_init_thread, mpi_integer, mpi_irecv, mpi_isend, &
    mpi_min, mpi_statuses_ignore, mpi_thread_funneled, mpi_waitall
  implicit none
  private
  public :: ranks_t, join_ranks, leave_ranks, gather_reals, exchange_reals, reduce_min, &
    broadcast_values, share_error

  integer, parameter :: real_bytes = storage_size(1.0_wp)/8

  !> This process among those of the run.
  type :: ranks_t
    integer :: mine = 0 !! number of this process, from 0; process 0 reads and writes files
    integer :: n = 1    !! number of processes
    integer(long) :: sent(2) = 0   !! point-to-point messages and their bytes
    integer(long) :: joined(2) = 0 !! collective calls and the bytes received by them
  end type ranks_t

contains

  !> Start MPI and get the number of this process.
  subroutine join_ranks(ranks)
    type(ranks_t), intent(out) :: ranks
    integer :: provided, status

    call mpi_init_thread(mpi_thread_funneled, provided, status)
    call mpi_comm_rank(mpi_comm_world, ranks%mine, status)
    call mpi_comm_size(mpi_comm_world, ranks%n, status)
  end subroutine join_ranks

  !> End MPI.
  subroutine leave_ranks()
    integer :: status

    call mpi_finalize(status)
  end subroutine leave_ranks

  !> Gather an array of which each process has one range, in all processes or in the first.
  subroutine gather_reals(ranks, starts, width, to_all, values)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: starts(0:)     !! (0:n) first item of each range, then one beyond
    integer, intent(in) :: width          !! values per item
    logical, intent(in) :: to_all
    real(wp), intent(inout) :: values(*)
    integer :: counts(0:ranks%n - 1), offsets(0:ranks%n - 1), status

    counts = width*(starts(1:ranks%n) - starts(0:ranks%n - 1))
    offsets = width*(starts(0:ranks%n - 1) - 1) ! values before those of each
    if (to_all) then
      call mpi_allgatherv(mpi_in_place, 0, mpi_datatype_null, values, counts, offsets, &
        mpi_double_precision, mpi_comm_world, status)
    else if (ranks%mine == 0) then
      call mpi_gatherv(mpi_in_place, 0, mpi_datatype_null, values, counts, offsets, &
        mpi_double_precision, 0, mpi_comm_world, status)
    else
      call mpi_gatherv(values(offsets(ranks%mine) + 1), counts(ranks%mine), mpi_double_precision, &
        values, counts, offsets, mpi_double_precision, 0, mpi_comm_world, status)
    end if
    ranks%joined(1) = ranks%joined(1) + 1
    if (to_all .or. ranks%mine == 0) ranks%joined(2) = ranks%joined(2) &
      + int(real_bytes, long)*(sum(int(counts, long)) - counts(ranks%mine))
  end subroutine gather_reals

  !> Exchange values with some processes, one message each.
  subroutine exchange_reals(ranks, peers, out_starts, outgoing, in_starts, incoming)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: peers(:)       !! numbers of these processes
    integer, intent(in) :: out_starts(:), in_starts(:) !! (peers + 1) start of the values of each
    real(wp), intent(in) :: outgoing(*)
    real(wp), intent(inout) :: incoming(*)
    integer, parameter :: tag = 1
    integer :: requests(2*size(peers)), i, n, n_request, status

    n_request = 0
    do i = 1, size(peers)
      n = in_starts(i + 1) - in_starts(i)
      if (n == 0) cycle
      n_request = n_request + 1
      call mpi_irecv(incoming(in_starts(i)), n, mpi_double_precision, peers(i), tag, &
        mpi_comm_world, requests(n_request), status)
    end do
    do i = 1, size(peers)
      n = out_starts(i + 1) - out_starts(i)
      if (n == 0) cycle
      n_request = n_request + 1
      call mpi_isend(outgoing(out_starts(i)), n, mpi_double_precision, peers(i), tag, &
        mpi_comm_world, requests(n_request), status)
      ranks%sent = ranks%sent + [1_long, int(real_bytes, long)*n]
    end do
    call mpi_waitall(n_request, requests, mpi_statuses_ignore, status)
  end subroutine exchange_reals

  !> Minimum over the processes, value by value, in all of them.
  subroutine reduce_min(ranks, values)
    type(ranks_t), intent(inout) :: ranks
    real(wp), intent(inout), contiguous :: values(:)
    integer :: status

    call mpi_allreduce(mpi_in_place, values, size(values), mpi_double_precision, mpi_min, &
      mpi_comm_world, status)
    ranks%joined = ranks%joined + [1_long, int(real_bytes, long)*size(values)]
  end subroutine reduce_min

  !> Copy values of the first process to all.
  subroutine broadcast_values(ranks, values)
    type(ranks_t), intent(in) :: ranks
    real(wp), intent(inout), contiguous :: values(:)
    integer :: status

    if (ranks%n > 1) call mpi_bcast(values, size(values), mpi_double_precision, 0, &
      mpi_comm_world, status)
  end subroutine broadcast_values

  !> Give an error of any process to all: of several errors that of the lowest process, while each
  !> process keeps its own.
  subroutine share_error(ranks, error)
    type(ranks_t), intent(in) :: ranks
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: text
    integer :: own, first, facts(2), status

    if (ranks%n == 1) return
    own = merge(ranks%mine, ranks%n, allocated(error))
    call mpi_allreduce(own, first, 1, mpi_integer, mpi_min, mpi_comm_world, status)
    if (first == ranks%n) return
    facts = 0
    if (first == ranks%mine) facts = [len(error%message), error%status]
    call mpi_bcast(facts, 2, mpi_integer, first, mpi_comm_world, status)
    allocate (character(facts(1)) :: text)
    if (first == ranks%mine) text = error%message
    call mpi_bcast(text, facts(1), mpi_character, first, mpi_comm_world, status)
    if (.not. allocated(error)) call raise(error, text, facts(2))
  end subroutine share_error

end module ranks_m
