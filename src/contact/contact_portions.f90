! SPDX-License-Identifier: MIT
!> The stretch of master chain that lies below a stretch of slave segment, portion by portion.
module contact_portions_m
  use contact_projection_m, only : see_segment, is_over_segment, turns_gently
  use geometry_m, only : sight_t
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: mark_t, walk_to_mark

  !> A place on a chain.
  type :: mark_t
    integer :: segment = 0
    integer :: n_step = 0    !! segments walked to it, negative backwards
    real(wp) :: xi = 0.0_wp
  end type mark_t

contains

  !> Project a place on a chain, starting at a segment and going on to the neighbour where it runs
  !> over a node. It stops at the chain's end (with the usual overshoot), at a sharp corner, and at
  !> a node that no neighbour sees it beyond.
  pure function walk_to_mark(surface, chain, place, start) result(mark)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :) !! (4, n_node) places
    real(wp), intent(in) :: place(4)
    integer, intent(in) :: start
    type(mark_t) :: mark
    type(sight_t) :: sight, other
    logical :: backwards
    integer :: neighbour, i_step

    mark%segment = start
    sight = see_segment(surface, chain, place, start)
    backwards = sight%along < 0.0_wp
    do i_step = 1, surface%n_segment
      mark%xi = sight%along/sight%square
      if (sight%along >= 0.0_wp .and. sight%along <= sight%square) return
      if (backwards .neqv. sight%along < 0.0_wp) exit
      neighbour = merge(surface%previous(mark%segment), surface%next(mark%segment), backwards)
      if (neighbour == 0) then
        if (.not. is_over_segment(sight)) exit
        return
      end if
      other = see_segment(surface, chain, place, neighbour)
      if (.not. turns_gently(sight, other)) exit
      sight = other
      mark%segment = neighbour
      mark%n_step = mark%n_step + merge(-1, 1, backwards)
    end do
    mark%xi = max(0.0_wp, min(1.0_wp, mark%xi))
  end function walk_to_mark

end module contact_portions_m
