! SPDX-License-Identifier: MIT
!> A freight from the first of several processes to all others, or to one of them.
module freight_sharing_m
  use freight_m, only : freight_t, start_loading, start_unloading
  use kinds_m, only : wp
  use ranks_m, only : ranks_t, spread_values, swap_reals
  implicit none
  private
  public :: spread_freight, send_freight

contains

  !> What the first process has loaded, for all others to unload.
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
    if (ranks%mine > 0) call start_unloading(freight)
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
    else if (ranks%mine == receiver) then
      call swap_reals(ranks, [0], [1, 1], nothing, [1, 2], n)
      freight%n = nint(n(1))
      call start_loading(freight)
      call swap_reals(ranks, [0], [1, 1], nothing, [1, size(freight%values) + 1], freight%values)
      call start_unloading(freight)
    end if
  end subroutine send_freight

end module freight_sharing_m
