! SPDX-License-Identifier: MIT
!> Forces of the elements of cross sections in an explicit cycle that tells of them.
module section_cuts_m
  use cut_forces_m, only : find_cut_forces
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use rank_shares_m, only : shares_t
  use ranks_m, only : ranks_t, bring_reals
  use state_m, only : state_t
  implicit none
  private
  public :: cut_sections

contains

  !> Before the elements are stepped: each process steps its own on a copy, the first one gets all.
  subroutine cut_sections(model, shares, ranks, state)
    type(model_t), intent(in) :: model
    type(shares_t), intent(in) :: shares
    type(ranks_t), intent(inout) :: ranks
    type(state_t), intent(inout) :: state
    integer :: i, first, last, starts(0:ranks%n)

    call find_cut_forces(model, [shares%chunks(ranks%mine), shares%chunks(ranks%mine + 1) - 1], &
      state%motion, [state%time, state%dt_before], state%elements, state%cut_force)
    if (ranks%n == 1) return
    first = 1
    do i = 1, size(model%controls%output%cross_sections)
      associate (elements => model%controls%output%cross_sections(i)%elements)
        last = first + size(elements) - 1
        starts = starts_of(model, elements, shares)
        call bring_reals(ranks, starts, 8, .false., state%cut_force(:, first:last))
        first = last + 1
      end associate
    end do
  end subroutine cut_sections

  !> Where the elements of each process start among some by rising slot, then one beyond the last.
  pure function starts_of(model, elements, shares) result(starts)
    type(model_t), intent(in) :: model
    integer, intent(in) :: elements(:)
    type(shares_t), intent(in) :: shares
    integer :: starts(0:ubound(shares%chunks, 1))
    integer :: rank

    do rank = 0, ubound(starts, 1)
      starts(rank) = 1 + count(model%layout%element_slot(elements) &
        <= (shares%chunks(rank) - 1)*chunk_size)
    end do
  end function starts_of

end module section_cuts_m
