! SPDX-License-Identifier: MIT
!> A buffer from the first of several processes to all others, or to one of them.
module buffer_sharing_m
  use packed_buffer_m, only : packed_buffer_t, start_loading, start_unloading
  use kinds_m, only : wp
  use ranks_m, only : ranks_t, spread_values, swap_reals
  use visitor_m, only : visited_t
  implicit none
  private
  public :: hand, everyone

  !> In place of a receiver: all.
  integer, parameter :: everyone = 0

contains

  !> What the first process has of an item, into that of the receiver.
  subroutine hand(ranks, receiver, buffer, item)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: receiver           !! `everyone` or one of the others
    type(packed_buffer_t), intent(inout) :: buffer !! empty: whole or a range
    class(visited_t), intent(inout) :: item

    if (receiver /= everyone .and. all(ranks%mine /= [0, receiver])) return
    if (ranks%mine == 0) then
      call item%visit(buffer)
      call start_loading(buffer)
      call item%visit(buffer)
    end if
    if (receiver == everyone) then
      call spread_buffer(ranks, buffer)
    else
      call send_buffer(ranks, receiver, buffer)
    end if
    if (ranks%mine == 0) return
    call start_unloading(buffer)
    call item%visit(buffer)
  end subroutine hand

  !> What the first process has loaded, for all others.
  subroutine spread_buffer(ranks, buffer)
    type(ranks_t), intent(in) :: ranks
    type(packed_buffer_t), intent(inout) :: buffer
    real(wp) :: n(1)

    n = real(buffer%n, wp)
    call spread_values(ranks, n)
    if (ranks%mine > 0) then
      buffer%n = nint(n(1))
      call start_loading(buffer)
    end if
    call spread_values(ranks, buffer%values)
  end subroutine spread_buffer

  !> The same for one of the others.
  subroutine send_buffer(ranks, receiver, buffer)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: receiver
    type(packed_buffer_t), intent(inout) :: buffer
    real(wp) :: n(1), nothing(1)

    n = real(buffer%n, wp)
    if (ranks%mine == 0) then
      call swap_reals(ranks, [receiver], [1, 2], n, [1, 1], nothing)
      call swap_reals(ranks, [receiver], [1, buffer%n + 1], buffer%values, [1, 1], nothing)
    else
      call swap_reals(ranks, [0], [1, 1], nothing, [1, 2], n)
      buffer%n = nint(n(1))
      call start_loading(buffer)
      call swap_reals(ranks, [0], [1, 1], nothing, [1, size(buffer%values) + 1], buffer%values)
    end if
  end subroutine send_buffer

end module buffer_sharing_m
