! SPDX-License-Identifier: MIT
!> Processes that share one run: all that is exchanged between them goes through here, by MPI.
!> src/parallel/serial has the same module for builds without it. Only one thread of a process
!> comes here. A process that ends without `leave_ranks` ends the run: the launcher stops the others.
module ranks_m
  use errors_m, only : error_t, raise
  use kinds_m, only : wp
  use mpi, only : mpi_allgatherv, mpi_allreduce, mpi_bcast, mpi_character, &
    mpi_comm_rank, mpi_comm_size, mpi_comm_world, mpi_datatype_null, mpi_double_precision, &
    mpi_finalize, mpi_gatherv, mpi_in_place, mpi_init_thread, mpi_integer, mpi_min, &
    mpi_thread_funneled
  implicit none
  private
  public :: ranks_t, join_ranks, leave_ranks, bring_reals, bring_integers, spread_values, &
    share_error

  !> This process among those of the run.
  type :: ranks_t
    integer :: mine = 0 !! its number, from 0 on; the first one reads, writes and speaks
    integer :: n = 1    !! how many there are
  end type ranks_t

contains

  !> Begin: who this process is.
  subroutine join_ranks(ranks)
    type(ranks_t), intent(out) :: ranks
    integer :: provided, status

    call mpi_init_thread(mpi_thread_funneled, provided, status)
    call mpi_comm_rank(mpi_comm_world, ranks%mine, status)
    call mpi_comm_size(mpi_comm_world, ranks%n, status)
  end subroutine join_ranks

  !> End, once nothing is left to exchange.
  subroutine leave_ranks()
    integer :: status

    call mpi_finalize(status)
  end subroutine leave_ranks

  !> Pieces of an array, one a process, to all of them or to the first.
  subroutine bring_reals(ranks, starts, width, to_all, values)
    type(ranks_t), intent(in) :: ranks
    integer, intent(in) :: starts(0:)     !! (0:n) item at which each piece starts, then one beyond
    integer, intent(in) :: width          !! values of an item
    logical, intent(in) :: to_all
    real(wp), intent(inout) :: values(*)
    integer :: counts(0:ranks%n - 1), places(0:ranks%n - 1), status

    call lay_out(ranks, starts, width, counts, places)
    if (to_all) then
      call mpi_allgatherv(mpi_in_place, 0, mpi_datatype_null, values, counts, places, &
        mpi_double_precision, mpi_comm_world, status)
    else if (ranks%mine == 0) then
      call mpi_gatherv(mpi_in_place, 0, mpi_datatype_null, values, counts, places, &
        mpi_double_precision, 0, mpi_comm_world, status)
    else
      call mpi_gatherv(values(places(ranks%mine) + 1), counts(ranks%mine), mpi_double_precision, &
        values, counts, places, mpi_double_precision, 0, mpi_comm_world, status)
    end if
  end subroutine bring_reals

  !> The same for integers.
  subroutine bring_integers(ranks, starts, width, to_all, values)
    type(ranks_t), intent(in) :: ranks
    integer, intent(in) :: starts(0:)     !! (0:n) item at which each piece starts, then one beyond
    integer, intent(in) :: width          !! values of an item
    logical, intent(in) :: to_all
    integer, intent(inout) :: values(*)
    integer :: counts(0:ranks%n - 1), places(0:ranks%n - 1), status

    call lay_out(ranks, starts, width, counts, places)
    if (to_all) then
      call mpi_allgatherv(mpi_in_place, 0, mpi_datatype_null, values, counts, places, &
        mpi_integer, mpi_comm_world, status)
    else if (ranks%mine == 0) then
      call mpi_gatherv(mpi_in_place, 0, mpi_datatype_null, values, counts, places, &
        mpi_integer, 0, mpi_comm_world, status)
    else
      call mpi_gatherv(values(places(ranks%mine) + 1), counts(ranks%mine), mpi_integer, &
        values, counts, places, mpi_integer, 0, mpi_comm_world, status)
    end if
  end subroutine bring_integers

  !> How many values each process has, and how many stand before them.
  pure subroutine lay_out(ranks, starts, width, counts, places)
    type(ranks_t), intent(in) :: ranks
    integer, intent(in) :: starts(0:)
    integer, intent(in) :: width
    integer, intent(out) :: counts(0:), places(0:)

    counts = width*(starts(1:ranks%n) - starts(0:ranks%n - 1))
    places = width*(starts(0:ranks%n - 1) - 1)
  end subroutine lay_out

  !> Values of the first process to all.
  subroutine spread_values(ranks, values)
    type(ranks_t), intent(in) :: ranks
    real(wp), intent(inout), contiguous :: values(:)
    integer :: status

    if (ranks%n > 1) call mpi_bcast(values, size(values), mpi_double_precision, 0, &
      mpi_comm_world, status)
  end subroutine spread_values

  !> An error of any process becomes that of all: where several have one that of the first of them,
  !> but each keeps its own.
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
