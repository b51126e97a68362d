! SPDX-License-Identifier: MIT
!> A buffer from the first of several processes to all others, or to one of them.
module buffer_transfer_m
  use packed_buffer_m, only : packed_buffer_t, start_packing, start_unpacking
  use kinds_m, only : wp
  use ranks_m, only : ranks_t, broadcast_values, exchange_reals
  use visitor_m, only : visited_t
  implicit none
  private
  public :: send_item, all_ranks

  !> In place of a receiver: all.
  integer, parameter :: all_ranks = 0

contains

  !> What the first process has of an item, into that of the receiver.
  subroutine send_item(ranks, receiver, buffer, item)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: receiver           !! `all_ranks` or one of the others
    type(packed_buffer_t), intent(inout) :: buffer !! empty: whole or a range
    class(visited_t), intent(inout) :: item
    real(wp) :: n(1)

    if (receiver /= all_ranks .and. all(ranks%mine /= [0, receiver])) return
    if (ranks%mine == 0) then
      call item%visit(buffer)
      call start_packing(buffer)
      call item%visit(buffer)
    end if
    n = real(buffer%n, wp)
    call share(n)
    if (ranks%mine > 0) then
      buffer%n = nint(n(1))
      call start_packing(buffer)
    end if
    call share(buffer%values)
    if (ranks%mine == 0) return
    call start_unpacking(buffer)
    call item%visit(buffer)

  contains

    !> Values of the first process for the receiver.
    subroutine share(values)
      real(wp), intent(inout) :: values(:)
      real(wp) :: nothing(1)

      if (receiver == all_ranks) then
        call broadcast_values(ranks, values)
      else if (ranks%mine == 0) then
        call exchange_reals(ranks, [receiver], [1, size(values) + 1], values, [1, 1], nothing)
      else
        call exchange_reals(ranks, [0], [1, 1], nothing, [1, size(values) + 1], values)
      end if
    end subroutine share

  end subroutine send_item

end module buffer_transfer_m
