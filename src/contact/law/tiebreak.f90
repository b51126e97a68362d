! SPDX-License-Identifier: MIT
!> Ties that break (doc/theory/contact.md, section 6.4): where (s_n/NFLS)^2 +
!> (s_t/SFLS)^2 >= 1, s_n the tension and s_t the shear of a site, it is free for good, and in
!> contact from then on. Sites are those at which pressure is formed (law_state_m).
module tiebreak_m
  use contact_state_m, only : contact_state_t, n_side, n_sites, site_at
  use contacts_m, only : contact_t
  use law_state_m, only : tie_memory_t, is_open, is_held, is_broken, is_beside
  use kinds_m, only : wp
  use tributary_lengths_m, only : nodal_area
  implicit none
  private
  public :: start_breaking, mark_breaks, let_go, has_state, is_tied_site, exclude_tied_sites

contains

  !> All sites that springs hold, and what makes their pressures stresses of the bond: those of
  !> type 1 are forces, and two passes share it by their penalties. Sites are in the reference
  !> geometry.
  pure subroutine start_breaking(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer :: s

    associate (ties => memory%ties, points => memory%tie_points)
      allocate (ties%state(n_sites(memory)), source=is_open)
      allocate (ties%to_stress(size(ties%area)), source=1.0_wp)
      if (memory%has%nodal_pressure) then
        ties%site = [(s, s=1, memory%n_slave)]
      else
        ties%site = [(site_at(memory, points, ties%first(s)), s=1, size(ties%side))]
      end if
      do s = 1, size(ties%area)
        if (ties%area(s) > 0.0_wp) ties%state(ties%site(s)) = is_held
        if (memory%master_status%n > 0) ties%to_stress(s) = (memory%slave_penalty &
          + memory%master_penalty)/points%stiffness(ties%first(s))
        if (memory%has%unit_area) ties%to_stress(s) = ties%area(s)/nodal_area(contact%slave, &
          memory%positions(:, :memory%n_slave), contact%is_axisymmetric, ties%site(s))
      end do
    end associate
    call mark_beside(memory)
  end subroutine start_breaking

  !> Where slave and master nodes lie upon each other type 5 has one site of the two: the other,
  !> never tied itself, goes with it.
  pure subroutine mark_beside(memory)
    type(contact_state_t), intent(inout) :: memory
    integer :: s, k

    if (memory%has%segment_points .or. memory%has%nodal_pressure) return
    associate (ties => memory%ties, points => memory%tie_points)
      where (ties%state == is_beside) ties%state = is_open
      do s = 1, size(ties%side)
        if (ties%state(ties%site(s)) /= is_held) cycle
        do k = 1, n_side
          associate (a => points%slave_nodes(k, ties%first(s)), &
            b => points%master_nodes(k, ties%first(s)))
            if (points%slave_weights(k, ties%first(s)) > 0.5_wp .and. ties%state(a) == is_open) &
              ties%state(a) = is_beside
            if (points%master_weights(k, ties%first(s)) > 0.5_wp .and. ties%state(b) == is_open) &
              ties%state(b) = is_beside
          end associate
        end do
      end do
    end associate
  end subroutine mark_beside

  !> Mark the sites that reach their strengths under the present pressures and tractions.
  pure subroutine mark_breaks(strength, time, memory, n_new)
    real(wp), intent(in) :: strength(2) !! NFLS, SFLS, N/m^2
    real(wp), intent(in) :: time        !! s
    type(contact_state_t), intent(inout) :: memory
    integer, intent(out) :: n_new       !! sites marked
    integer :: b

    n_new = 0
    associate (ties => memory%ties, scratch => memory%scratch)
      scratch%n_freed = 0
      scratch%is_freed = is_tied_site(ties%state)
      do b = 1, size(ties%site)
        associate (to_stress => ties%to_stress(b))
          call mark(strength, to_stress*ties%pressure(b), to_stress*ties%traction(b), &
            ties%state(ties%site(b)), n_new)
        end associate
      end do
      if (n_new == 0) return
      call mark_beside(memory)
      scratch%is_freed = scratch%is_freed .and. .not. is_tied_site(ties%state)
      scratch%n_freed = count(scratch%is_freed)
      if (.not. ties%first_break > 0.0_wp) ties%first_break = time
      ties%last_break = time
    end associate
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

  !> Whether a spring, or a part of it, is held or broken.
  pure function has_state(memory, s, state) result(yes)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, state !! is_held or is_broken
    logical :: yes

    yes = state == is_held
    if (.not. memory%has%breaks) return
    associate (ties => memory%ties)
      if (memory%has%nodal_pressure) then
        yes = any(ties%state(memory%tie_points%slave_nodes(:, ties%first(s))) == state)
      else
        yes = ties%state(ties%site(s)) == state
      end if
    end associate
  end function has_state

  !> Whether a tie keeps a site of this state out of contact.
  elemental function is_tied_site(state) result(is_tied)
    integer, intent(in) :: state
    logical :: is_tied

    is_tied = state == is_held .or. state == is_beside
  end function is_tied_site

  !> After pressures of all sites have been formed: those that ties hold have none.
  pure subroutine exclude_tied_sites(memory)
    type(contact_state_t), intent(inout) :: memory
    integer :: p

    associate (states => memory%ties%state, points => memory%points)
      if (memory%has%nodal_pressure) then
        where (is_tied_site(states(:memory%n_slave))) memory%node_pressure = 0.0_wp
      else
        do p = 1, points%n
          if (is_tied_site(states(site_at(memory, points, p)))) points%pressure(p) = 0.0_wp
        end do
      end if
    end associate
  end subroutine exclude_tied_sites

end module tiebreak_m
