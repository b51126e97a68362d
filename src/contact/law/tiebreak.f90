! SPDX-License-Identifier: MIT
!> Ties that break (doc/theory/contact.md, section 6.4): where (s_n/NFLS)^2 +
!> (s_t/SFLS)^2 >= 1, s_n the tension and s_t the shear of a place, it is free for good. Places are
!> those at which pressure is formed (law_state_m).
module tiebreak_m
  use contact_state_m, only : contact_state_t, places_of_segment, place_at
  use contacts_m, only : contact_t
  use law_state_m, only : is_open, is_held, is_broken
  use kinds_m, only : wp
  use lengths_m, only : competence_area
  implicit none
  private
  public :: start_breaking, mark_breaks, let_go, holds, holds_node

contains

  !> All places that springs hold, and what makes their pressures stresses of the bond: those of
  !> type 1 are forces, and two passes share it by their penalties. Places are in the reference
  !> geometry.
  pure subroutine start_breaking(contact, has_unit_area, has_two_passes, memory)
    type(contact_t), intent(in) :: contact
    logical, intent(in) :: has_unit_area, has_two_passes !! of the formulation
    type(contact_state_t), intent(inout) :: memory
    integer :: s, p

    associate (ties => memory%ties, points => memory%points)
      allocate (ties%state(places_of_segment(memory)*memory%n_slave + memory%n_master), source=is_open)
      allocate (ties%place(size(ties%side)), source=0)
      allocate (ties%to_stress(size(ties%side)), source=1.0_wp)
      do s = 1, size(ties%side)
        p = ties%first(s)
        if (memory%has%nodal_pressure) then
          where (points%slave_weights(:, p) > 0.0_wp) ties%state(points%slave_nodes(:, p)) = is_held
        else
          ties%place(s) = place_at(memory, p)
          ties%state(ties%place(s)) = is_held
          if (has_two_passes) ties%to_stress(s) = (memory%slave_penalty + memory%master_penalty) &
            /points%stiffness(p)
          if (has_unit_area) ties%to_stress(s) = points%area(p)/competence_area(contact%slave, &
            memory%places(:, :memory%n_slave), contact%is_round, ties%place(s))
        end if
      end do
    end associate
  end subroutine start_breaking

  !> Mark the places that reach their strengths under the present pressures and tractions.
  pure subroutine mark_breaks(strength, time, memory, n_new)
    real(wp), intent(in) :: strength(2) !! NFLS, SFLS, N/m^2
    real(wp), intent(in) :: time        !! s
    type(contact_state_t), intent(inout) :: memory
    integer, intent(out) :: n_new       !! places marked
    integer :: s

    n_new = 0
    associate (ties => memory%ties, points => memory%points)
      if (memory%has%nodal_pressure) then
        do s = 1, memory%n_slave
          call mark(strength, memory%node_pressure(s), ties%traction(s), ties%state(s), n_new)
        end do
      else
        do s = 1, size(ties%side)
          call mark(strength, ties%to_stress(s)*points%pressure(ties%first(s)), &
            ties%to_stress(s)*points%traction(ties%first(s)), ties%state(ties%place(s)), n_new)
        end do
      end if
      if (n_new == 0) return
      if (.not. ties%first_break > 0.0_wp) ties%first_break = time
      ties%last_break = time
    end associate
  end subroutine mark_breaks

  !> One place under its stresses. Pressure does not help to break it.
  pure subroutine mark(strength, pressure, traction, state, n_new)
    real(wp), intent(in) :: strength(2), pressure, traction !! N/m^2
    integer, intent(inout) :: state, n_new

    if (state /= is_held) return
    if ((max(0.0_wp, -pressure)/strength(1))**2 + (traction/strength(2))**2 < 1.0_wp) return
    state = is_broken
    n_new = n_new + 1
  end subroutine mark

  !> Broken places carry nothing.
  pure subroutine let_go(memory)
    type(contact_state_t), intent(inout) :: memory
    integer :: s

    associate (ties => memory%ties, points => memory%points)
      if (memory%has%nodal_pressure) then
        where (ties%state(:memory%n_slave) /= is_held)
          memory%node_pressure = 0.0_wp
          ties%traction = 0.0_wp
        end where
        return
      end if
      do s = 1, size(ties%side)
        if (ties%state(ties%place(s)) == is_held) cycle
        points%pressure(ties%first(s):ties%first(s + 1) - 1) = 0.0_wp
        points%traction(ties%first(s):ties%first(s + 1) - 1) = 0.0_wp
      end do
    end associate
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
        yes = ties%state(ties%place(s)) == is_held
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
