! SPDX-License-Identifier: MIT
!> What the energy law of an interface remembers (contact/law/energy_limit).
module energy_limit_state_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: energy_limit_t, allocate_limit

  !> Arrays are allocated in explicit runs alone; without them nothing is limited.
  type, extends(visited_t) :: energy_limit_t
    real(wp) :: coming_step = 0.0_wp  !! step that leads away from this cycle, s; 0: no limit
    real(wp), allocatable :: inverse_mass(:, :) !! (2, n_slave + n_master) 1/m that a force of
                                      !! contact meets, 0 where the motion is held, m/kg
    real(wp), allocatable :: velocity(:, :) !! (2, n_slave + n_master) of the last call with force
    real(wp) :: recoil = 0.0_wp       !! sum of F.F/m of the last call, N^2/kg
    real(wp) :: credit = 0.0_wp       !! what springs held that were born or caught loaded, J/m
    real(wp) :: lent = 0.0_wp         !! the part of it of those that were caught, J/m
    real(wp) :: loan = 0.0_wp         !! most that may be lent, J/m
    real(wp) :: largest = 0.0_wp      !! largest energy of the springs so far, credit included, J/m
    integer :: n_loaded = 0           !! cycles with force
    integer :: n_limited = 0          !! cycles whose forces were scaled down
    real(wp) :: least_factor = 1.0_wp !! of all cycles
    real(wp) :: least_time = 0.0_wp   !! of that factor, s
    integer :: recent = 0             !! rises with limited cycles, falls with others
    logical :: warned = .false.       !! the log has told that it is limited again and again
  contains
    procedure :: visit => visit_limit
  end type energy_limit_t

contains

  !> Allocate for `n` nodes; held until their masses are known.
  pure subroutine allocate_limit(limit, n)
    type(energy_limit_t), intent(inout) :: limit
    integer, intent(in) :: n

    allocate (limit%inverse_mass(2, n), limit%velocity(2, n), source=0.0_wp)
  end subroutine allocate_limit

  !> Its components.
  subroutine visit_limit(self, visitor)
    class(energy_limit_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('coming_step', self%coming_step)
    call visitor%visit('inverse_mass', self%inverse_mass)
    call visitor%visit('velocity', self%velocity)
    call visitor%visit('recoil', self%recoil)
    call visitor%visit('credit', self%credit)
    call visitor%visit('lent', self%lent)
    call visitor%visit('loan', self%loan)
    call visitor%visit('largest', self%largest)
    call visitor%visit('n_loaded', self%n_loaded)
    call visitor%visit('n_limited', self%n_limited)
    call visitor%visit('least_factor', self%least_factor)
    call visitor%visit('least_time', self%least_time)
    call visitor%visit('recent', self%recent)
    call visitor%visit('warned', self%warned)
  end subroutine visit_limit

end module energy_limit_state_m
