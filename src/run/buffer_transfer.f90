! SPDX-License-Identifier: MIT
!> Transfer of a packed item from the first process to one or all other processes.
module buffer_transfer_m
  use packed_buffer_m, only : packed_buffer_t, start_packing, start_unpacking
  use kinds_m, only : wp
  use ranks_m, only : ranks_t, broadcast_values, exchange_reals
  use visitor_m, only : visited_t
  implicit none
  private
  public :: send_item, all_ranks

  !> Receiver: all processes.
  integer, parameter :: all_ranks = 0

contains

  !> Copy an item of the first process to the receiver, packed into one buffer.
  subroutine send_item(ranks, receiver, buffer, item)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: receiver           !! `all_ranks` or the number of one process
    type(packed_buffer_t), intent(inout) :: buffer !! empty: packs all of the item, or a range of it
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

    !> Send values of the first process to the receiver.
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
