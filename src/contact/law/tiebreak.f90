! SPDX-License-Identifier: MIT
!> Ties that break (doc/theory/contact.md, section 6.4): where (s_n/NFLS)^2 +
!> (s_t/SFLS)^2 >= 1, s_n the tension and s_t the shear of a site, it is free for good. Sites are
!> those at which pressure is formed (law_state_m).
module tiebreak_m
  use contact_state_m, only : contact_state_t, sites_of_segment, site_at
  use contacts_m, only : contact_t
  use law_state_m, only : tie_memory_t, is_open, is_held, is_broken
  use kinds_m, only : wp
  use tributary_lengths_m, only : nodal_area
  implicit none
  private
  public :: start_breaking, mark_breaks, let_go, holds, holds_node

contains

  !> All sites that springs hold, and what makes their pressures stresses of the bond: those of
  !> type 1 are forces, and two passes share it by their penalties. Sites are in the reference
  !> geometry.
  pure subroutine start_breaking(contact, has_unit_area, has_two_passes, memory)
    type(contact_t), intent(in) :: contact
    logical, intent(in) :: has_unit_area, has_two_passes !! of the formulation
    type(contact_state_t), intent(inout) :: memory
    integer :: s

    associate (ties => memory%ties, points => memory%points)
      allocate (ties%state(sites_of_segment(memory)*memory%n_slave + memory%n_master), &
        source=is_open)
      allocate (ties%to_stress(size(ties%area)), source=1.0_wp)
      if (memory%has%nodal_pressure) then
        ties%site = [(s, s=1, memory%n_slave)]
      else
        ties%site = [(site_at(memory, ties%first(s)), s=1, size(ties%side))]
      end if
      do s = 1, size(ties%area)
        if (ties%area(s) > 0.0_wp) ties%state(ties%site(s)) = is_held
        if (has_two_passes) ties%to_stress(s) = (memory%slave_penalty + memory%master_penalty) &
          /points%stiffness(ties%first(s))
        if (has_unit_area) ties%to_stress(s) = ties%area(s)/nodal_area(contact%slave, &
          memory%positions(:, :memory%n_slave), contact%is_round, ties%site(s))
      end do
    end associate
  end subroutine start_breaking

  !> Mark the sites that reach their strengths under the present pressures and tractions.
  pure subroutine mark_breaks(strength, time, ties, n_new)
    real(wp), intent(in) :: strength(2) !! NFLS, SFLS, N/m^2
    real(wp), intent(in) :: time        !! s
    type(tie_memory_t), intent(inout) :: ties
    integer, intent(out) :: n_new       !! sites marked
    integer :: b

    n_new = 0
    do b = 1, size(ties%site)
      call mark(strength, ties%to_stress(b)*ties%pressure(b), ties%to_stress(b)*ties%traction(b), &
        ties%state(ties%site(b)), n_new)
    end do
    if (n_new == 0) return
    if (.not. ties%first_break > 0.0_wp) ties%first_break = time
    ties%last_break = time
  end subroutine mark_breaks

  !> One site under its stresses. Pressure does not help to break it.
  pure subroutine mark(strength, pressure, traction, state, n_new)
    real(wp), intent(in) :: strength(2), pressure, traction !! N/m^2
    integer, intent(inout) :: state, n_new

    if (state /= is_held) return
    if ((max(0.0_wp, -pressure)/strength(1))**2 + (traction/strength(2))**2 < 1.0_wp) return
    state = is_broken
    n_new = n_new + 1
  end subroutine mark

  !> Broken sites carry nothing.
  pure subroutine let_go(ties)
    type(tie_memory_t), intent(inout) :: ties

    where (ties%state(ties%site) /= is_held)
      ties%pressure = 0.0_wp
      ties%traction = 0.0_wp
    end where
  end subroutine let_go

  !> Whether a spring still holds anything.
  pure function holds(memory, s) result(yes)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    logical :: yes

    yes = .true.
    associate (ties => memory%ties)
      if (.not. memory%has%breaks) return
      if (memory%has%nodal_pressure) then
        yes = any(ties%state(memory%points%slave_nodes(:, ties%first(s))) == is_held)
      else
        yes = ties%state(ties%site(s)) == is_held
      end if
    end associate
  end function holds

  !> Whether a slave node, of types 6 and 7, still holds.
  pure function holds_node(memory, node) result(yes)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: node
    logical :: yes

    yes = .true.
    if (memory%has%breaks) yes = memory%ties%state(node) == is_held
  end function holds_node

end module tiebreak_m
