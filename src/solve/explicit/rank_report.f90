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
    call write_log(log, 'exchange: '//to_text(ranks%n)//' processes, a cycle: messages ' &
      //spread_text(counts(1, :))//', bytes '//spread_text(counts(2, :)) &
      //'; common calls '//to_text(counts(3, 1))//', bytes that come by them ' &
      //spread_text(counts(4, :))//'; besides, in all: calls '//to_text(rest(1)) &
      //', bytes to the first process '//to_text(rest(2)))
  end subroutine report_exchange

  !> Mean and largest of what the processes have.
  function spread_text(values) result(text)
    real(wp), intent(in) :: values(:)
    character(:), allocatable :: text

    text = to_text(sum(values)/size(values))//' (most '//to_text(maxval(values))//')'
  end function spread_text

end module rank_report_m
