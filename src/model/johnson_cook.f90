! SPDX-License-Identifier: MIT
!> Constants of Johnson and Cook (1983, 1985): flow stress, heat and damage.
module johnson_cook_m
  use kinds_m, only : wp
  implicit none
  private
  public :: johnson_cook_t

  !> sigma = (A + B p^n)(1 + C ln(rate/rate0))(1 - T*^m), the rate not below rate0.
  type :: johnson_cook_t
    real(wp) :: a = 0.0_wp, b = 0.0_wp, n = 1.0_wp, c = 0.0_wp
    real(wp) :: rate = 1.0_wp            !! rate0, 1/s
    real(wp) :: most_static = huge(1.0_wp) !! SIGMAX, bound on A + B p^n
    real(wp) :: most = huge(1.0_wp)      !! SIGSAT, bound on the flow stress
    real(wp) :: m = 1.0_wp               !! thermal exponent
    real(wp) :: span = 1.0_wp            !! melting temperature less room temperature, K
    real(wp) :: room = 0.0_wp            !! room temperature, at which everything starts
    real(wp) :: heat = 0.0_wp            !! 1/(rho0 c_p), K m^3/J; 0 = no heating
    real(wp) :: d(5) = 0.0_wp            !! D1 to D5
    real(wp) :: least = 0.0_wp           !! EFMIN, bound on the strain at fracture
    logical :: is_viscoplastic = .false. !! the rate is that of the plastic strain
    logical :: keeps_broken = .false.    !! broken elements stay in the mesh (EROD)
    logical :: has_damage = .false.
    logical :: has_memory = .false.      !! points keep a temperature and a damage
  end type johnson_cook_t

end module johnson_cook_m
