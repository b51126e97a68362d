! SPDX-License-Identifier: MIT
!> Masses that grow during an explicit run, with all that is made of them.
module mass_growth_m
  use rigid_start_m, only : weigh_contacts
  use kinds_m, only : wp
  use mass_scaling_m, only : grow_masses
  use model_m, only : model_t
  use state_m, only : state_t
  implicit none
  private
  public :: grow_state_masses

contains

  !> Mass for elements that have become too small for DT2MS. What it brings in kinetic energy comes
  !> from outside.
  subroutine grow_state_masses(model, state, has_grown)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    logical, intent(out) :: has_grown
    real(wp), allocatable :: before(:)
    real(wp) :: work
    integer :: i, k

    before = state%mass
    call grow_masses(model, state%motion, state%dt, state%elements, state%mass, work)
    has_grown = any(state%mass > before)
    if (.not. has_grown) return
    state%external_work = state%external_work + work
    do i = 1, size(before)
      if (.not. state%mass(i) > before(i)) cycle
      do k = 1, 2
        if (state%inverse_mass(k, i) > 0.0_wp) state%inverse_mass(k, i) = 1.0_wp/state%mass(i)
      end do
      if (i <= size(state%contact_mass)) &
        state%contact_mass(i) = state%contact_mass(i) + (state%mass(i) - before(i))
    end do
    call weigh_contacts(model, state)
  end subroutine grow_state_masses

end module mass_growth_m
