! SPDX-License-Identifier: MIT
!> A freight from the first of several processes to all others, or to one of them.
module freight_sharing_m
  use freight_m, only : freight_t, start_loading, start_unloading
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
  subroutine hand(ranks, receiver, freight, item)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: receiver           !! `everyone` or one of the others
    type(freight_t), intent(inout) :: freight !! empty: whole or a range
    class(visited_t), intent(inout) :: item

    if (receiver /= everyone .and. all(ranks%mine /= [0, receiver])) return
    if (ranks%mine == 0) then
      call item%visit(freight)
      call start_loading(freight)
      call item%visit(freight)
    end if
    if (receiver == everyone) then
      call spread_freight(ranks, freight)
    else
      call send_freight(ranks, receiver, freight)
    end if
    if (ranks%mine == 0) return
    call start_unloading(freight)
    call item%visit(freight)
  end subroutine hand

  !> What the first process has loaded, for all others.
  subroutine spread_freight(ranks, freight)
    type(ranks_t), intent(in) :: ranks
    type(freight_t), intent(inout) :: freight
    real(wp) :: n(1)

    n = real(freight%n, wp)
    call spread_values(ranks, n)
    if (ranks%mine > 0) then
      freight%n = nint(n(1))
      call start_loading(freight)
    end if
    call spread_values(ranks, freight%values)
  end subroutine spread_freight

  !> The same for one of the others.
  subroutine send_freight(ranks, receiver, freight)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: receiver
    type(freight_t), intent(inout) :: freight
    real(wp) :: n(1), nothing(1)

    n = real(freight%n, wp)
    if (ranks%mine == 0) then
      call swap_reals(ranks, [receiver], [1, 2], n, [1, 1], nothing)
      call swap_reals(ranks, [receiver], [1, freight%n + 1], freight%values, [1, 1], nothing)
    else
      call swap_reals(ranks, [0], [1, 1], nothing, [1, 2], n)
      freight%n = nint(n(1))
      call start_loading(freight)
      call swap_reals(ranks, [0], [1, 1], nothing, [1, size(freight%values) + 1], freight%values)
    end if
  end subroutine send_freight

end module freight_sharing_m
