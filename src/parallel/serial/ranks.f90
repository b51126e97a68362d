! SPDX-License-Identifier: MIT
!> Processes that share one run, in a build without MPI: there is one, and nothing to exchange.
!> src/parallel/mpi has the same module for several, with the same declarations: what is compiled
!> with one of them may be linked with the other.
module ranks_m
  use errors_m, only : error_t
  use kinds_m, only : wp, long
  implicit none
  private
  public :: ranks_t, join_ranks, leave_ranks, gather_reals, exchange_reals, reduce_min, &
    broadcast_values, share_error

  !> This process among those of the run.
  type :: ranks_t
    integer :: mine = 0 !! its number, from 0 on; the first one reads, writes and speaks
    integer :: n = 1    !! how many there are
    integer(long) :: sent(2) = 0   !! messages to single processes, and bytes in them
    integer(long) :: joined(2) = 0 !! calls that all take part in, and bytes that came by them
  end type ranks_t

contains

  !> Begin: who this process is.
  subroutine join_ranks(ranks)
    type(ranks_t), intent(out) :: ranks

    ranks%n = 1
  end subroutine join_ranks

  !> End, once nothing is left to exchange.
  subroutine leave_ranks()
  end subroutine leave_ranks

  !> Pieces of an array, one a process, to all of them or to the first.
  subroutine gather_reals(ranks, starts, width, to_all, values)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: starts(0:)     !! (0:n) item at which each piece starts, then one beyond
    integer, intent(in) :: width          !! values of an item
    logical, intent(in) :: to_all
    real(wp), intent(inout) :: values(*)
  end subroutine gather_reals

  !> Values for some other processes, a message each, against what these have for this one.
  subroutine exchange_reals(ranks, peers, out_starts, outgoing, in_starts, incoming)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: peers(:)       !! their numbers
    integer, intent(in) :: out_starts(:), in_starts(:) !! (peers + 1) where the values of each start
    real(wp), intent(in) :: outgoing(*)
    real(wp), intent(inout) :: incoming(*)
  end subroutine exchange_reals

  !> The least of what the processes have, value by value, to all of them.
  subroutine reduce_min(ranks, values)
    type(ranks_t), intent(inout) :: ranks
    real(wp), intent(inout), contiguous :: values(:)
  end subroutine reduce_min

  !> Values of the first process to all.
  subroutine broadcast_values(ranks, values)
    type(ranks_t), intent(in) :: ranks
    real(wp), intent(inout), contiguous :: values(:)
  end subroutine broadcast_values

  !> An error of any process becomes that of all: where several have one that of the first of them,
  !> but each keeps its own.
  subroutine share_error(ranks, error)
    type(ranks_t), intent(in) :: ranks
    type(error_t), allocatable, intent(inout) :: error
  end subroutine share_error

end module ranks_m
