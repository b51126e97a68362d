! SPDX-License-Identifier: MIT
!> Counterpart of src/parallel/mpi for builds without MPI: one process, nothing to exchange. The
!> declarations are the same: code compiled with one may be linked with the other.
module ranks_m
  use errors_m, only : error_t
  use kinds_m, only : wp, long
  implicit none
  private
  public :: ranks_t, join_ranks, leave_ranks, gather_reals, exchange_reals, reduce_min, &
    broadcast_values, share_error

  !> This process among those of the run.
  type :: ranks_t
    integer :: mine = 0 !! number of this process, from 0; process 0 reads and writes files
    integer :: n = 1    !! number of processes
    integer(long) :: sent(2) = 0   !! point-to-point messages and their bytes
    integer(long) :: joined(2) = 0 !! collective calls and the bytes received by them
  end type ranks_t

contains

  !> Get the number of this process.
  subroutine join_ranks(ranks)
    type(ranks_t), intent(out) :: ranks

    ranks%n = 1
  end subroutine join_ranks

  !> Nothing to end.
  subroutine leave_ranks()
  end subroutine leave_ranks

  !> Gather an array of which each process has one range, in all processes or in the first.
  subroutine gather_reals(ranks, starts, width, to_all, values)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: starts(0:)     !! (0:n) first item of each range, then one beyond
    integer, intent(in) :: width          !! values per item
    logical, intent(in) :: to_all
    real(wp), intent(inout) :: values(*)
  end subroutine gather_reals

  !> Exchange values with some processes, one message each.
  subroutine exchange_reals(ranks, peers, out_starts, outgoing, in_starts, incoming)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: peers(:)       !! numbers of these processes
    integer, intent(in) :: out_starts(:), in_starts(:) !! (peers + 1) start of the values of each
    real(wp), intent(in) :: outgoing(*)
    real(wp), intent(inout) :: incoming(*)
  end subroutine exchange_reals

  !> Minimum over the processes, value by value, in all of them.
  subroutine reduce_min(ranks, values)
    type(ranks_t), intent(inout) :: ranks
    real(wp), intent(inout), contiguous :: values(:)
  end subroutine reduce_min

  !> Copy values of the first process to all.
  subroutine broadcast_values(ranks, values)
    type(ranks_t), intent(in) :: ranks
    real(wp), intent(inout), contiguous :: values(:)
  end subroutine broadcast_values

  !> Give an error of any process to all: of several errors that of the lowest process, while each
  !> process keeps its own.
  subroutine share_error(ranks, error)
    type(ranks_t), intent(in) :: ranks
    type(error_t), allocatable, intent(inout) :: error
  end subroutine share_error

end module ranks_m
