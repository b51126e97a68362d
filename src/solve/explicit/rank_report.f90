! SPDX-License-Identifier: MIT
!> What the processes of a run have exchanged, as they have counted it call by call.
module rank_report_m
  use kinds_m, only : wp, long
  use log_m, only : log_t, write_log, to_text
  use rank_exchange_m, only : parcel_t
  use ranks_m, only : ranks_t, bring_reals
  implicit none
  private
  public :: report_exchange

contains

  !> A line of the log: what a cycle exchanges, and what files and rare events have besides.
  subroutine report_exchange(parcel, ranks, log)
    type(parcel_t), intent(in) :: parcel
    type(ranks_t), intent(inout) :: ranks
    type(log_t), intent(inout) :: log
    integer :: starts(ranks%n + 1), i
    real(wp) :: counts(4, ranks%n), rest(2)

    rest(1) = real(ranks%joined(1) - parcel%joined(1), wp)
    rest(2) = real(ranks%joined(2) - parcel%joined(2), wp)
    starts = [(i, i=1, ranks%n + 1)]
    counts(:, ranks%mine + 1) = real([parcel%sent, parcel%joined], wp) &
      /real(max(parcel%n_cycle, 1_long), wp)
    call bring_reals(ranks, starts, 4, .false., counts)
    if (ranks%mine > 0) return
    call write_log(log, 'exchange: '//to_text(ranks%n)//' processes; a cycle, mean (most): ' &
      //'messages '//spread_text(counts(1, :))//', bytes '//spread_text(counts(2, :)) &
      //', calls of all '//spread_text(counts(3, :))//', bytes by them ' &
      //spread_text(counts(4, :))//'; besides, first process, in all: calls of all ' &
      //plain_text(rest(1))//', bytes by them '//plain_text(rest(2)) &
      //'; tiles shared out anew: '//to_text(parcel%n_shared))
  end subroutine report_exchange

  !> Mean and largest of what the processes have.
  function spread_text(values) result(text)
    real(wp), intent(in) :: values(:)
    character(:), allocatable :: text

    text = plain_text(sum(values)/size(values))//' ('//plain_text(maxval(values))//')'
  end function spread_text

  !> A number with two decimals.
  function plain_text(value) result(text)
    real(wp), intent(in) :: value
    character(:), allocatable :: text
    character(32) :: buffer

    write (buffer, '(f31.2)') value
    text = trim(adjustl(buffer))
  end function plain_text

end module rank_report_m
