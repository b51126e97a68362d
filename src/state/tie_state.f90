! SPDX-License-Identifier: MIT
!> What a tied interface remembers (contact/law/ties): springs between places that were frozen in
!> the reference geometry. Their points are on the list of the interface, one or several to a
!> spring. Node numbers are local to the interface.
module tie_state_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: tie_memory_t, allocate_ties

  !> Arrays are allocated for tied interfaces alone.
  type, extends(visited_t) :: tie_memory_t
    integer, allocatable :: first(:)     !! (n_spring + 1) first point of each, then the end
    integer, allocatable :: owner(:, :)  !! (2, n_spring) nodes of the segment that n and t turn
                                         !! with
    real(wp), allocatable :: side(:)     !! (n_spring) 1: its outward normal points from master to
                                         !! slave, -1: the other way
    real(wp), allocatable :: lag(:, :)   !! (2, n_spring) from the master place to the slave place
                                         !! in the reference geometry, m
    real(wp), allocatable :: offset(:, :) !! (2, n_spring) parts of it along n and t there, m
    real(wp), allocatable :: traction(:) !! (n_slave) where pressure is formed at slave nodes, N/m^2
    integer, allocatable :: state(:)     !! (n_place) of each place of friction_state_m: open, held
                                         !! or broken; this and the next two only where ties break
    integer, allocatable :: place(:)     !! (n_spring) of each spring; of types 6 and 7, whose
                                         !! places are slave nodes, 0
    real(wp), allocatable :: to_stress(:) !! (n_spring) stress of the bond over pressure: 1 but for
                                         !! types 1 and 3
    real(wp) :: spent = 0.0_wp           !! what springs held that have broken, less what contact
                                         !! behind them took over, J/m
    real(wp) :: first_break = 0.0_wp     !! its time, s
    real(wp) :: last_break = 0.0_wp      !! likewise
  contains
    procedure :: visit => visit_ties
  end type tie_memory_t

contains

  !> Allocate for so many springs.
  pure subroutine allocate_ties(ties, n_spring)
    type(tie_memory_t), intent(inout) :: ties
    integer, intent(in) :: n_spring

    allocate (ties%first(n_spring + 1), ties%owner(2, n_spring), source=1)
    allocate (ties%side(n_spring), ties%lag(2, n_spring), ties%offset(2, n_spring), source=0.0_wp)
  end subroutine allocate_ties

  !> Its components.
  subroutine visit_ties(self, visitor)
    class(tie_memory_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('first', self%first)
    call visitor%visit('owner', self%owner)
    call visitor%visit('side', self%side)
    call visitor%visit('lag', self%lag)
    call visitor%visit('offset', self%offset)
    call visitor%visit('traction', self%traction)
    call visitor%visit('state', self%state)
    call visitor%visit('place', self%place)
    call visitor%visit('to_stress', self%to_stress)
    call visitor%visit('spent', self%spent)
    call visitor%visit('first_break', self%first_break)
    call visitor%visit('last_break', self%last_break)
  end subroutine visit_ties

end module tie_state_m
