! SPDX-License-Identifier: MIT
!> Contact behind ties that break: between the same surfaces, of all sites that no tie holds
!> (doc/theory/contact.md, section 6.4). The tie tells it its sites before each call.
module tie_handover_m
  use contact_law_m, only : find_gaps, spring_t, n_springs, spring_at
  use contact_state_m, only : contact_state_t, site_at, n_side
  use law_state_m, only : is_held, is_broken
  use kinds_m, only : wp
  use nodal_average_m, only : share_out
  implicit none
  private
  public :: receive_tie_state, exclude_tied_sites, take_handover, complete_handover, is_held_by_tie

contains

  !> Which sites the tie holds now, and which it has just lost.
  pure subroutine receive_tie_state(tie, memory)
    type(contact_state_t), intent(in) :: tie
    type(contact_state_t), intent(inout) :: memory
    associate (handover => memory%handover)
      if (.not. allocated(handover%is_tied_site)) &
        allocate (handover%is_tied_site(size(tie%ties%state)), source=.false.)
      handover%is_freed = handover%is_tied_site
      handover%is_tied_site = held_sites(tie)
      handover%is_freed = handover%is_freed .and. .not. handover%is_tied_site
    end associate
  end subroutine receive_tie_state

  !> The sites that a tie holds. Where slave and master nodes lie upon each other type 5 has one
  !> site of the two: the other, never tied itself, goes with it.
  pure function held_sites(tie) result(is_tied_site)
    type(contact_state_t), intent(in) :: tie
    logical :: is_tied_site(size(tie%ties%state))
    integer :: s, p, k

    is_tied_site = tie%ties%state == is_held
    if (tie%has%segment_points .or. tie%has%nodal_pressure) return
    associate (ties => tie%ties, points => tie%points)
      do s = 1, size(ties%side)
        if (ties%state(ties%site(s)) /= is_held) cycle
        p = ties%first(s)
        do k = 1, n_side
          associate (a => points%slave_nodes(k, p), b => points%master_nodes(k, p))
            if (points%slave_weights(k, p) > 0.5_wp) is_tied_site(a) = ties%state(a) /= is_broken
            if (points%master_weights(k, p) > 0.5_wp) is_tied_site(b) = ties%state(b) /= is_broken
          end associate
        end do
      end do
    end associate
  end function held_sites

  !> After all sites have been loaded: those that the tie holds are not.
  pure subroutine exclude_tied_sites(memory)
    type(contact_state_t), intent(inout) :: memory
    integer :: p

    associate (points => memory%points)
      if (memory%has%nodal_pressure) then
        where (memory%handover%is_tied_site(:memory%n_slave)) memory%node_pressure = 0.0_wp
        call share_out(points%n, points%slave_nodes, points%slave_weights, memory%node_pressure, &
          points%pressure)
      else
        do p = 1, points%n
          if (memory%handover%is_tied_site(site_at(memory, p))) points%pressure(p) = 0.0_wp
        end do
      end if
    end associate
  end subroutine exclude_tied_sites

  !> What the springs hold of sites that have just been freed while loaded: the tie has taken it
  !> in, and gives it up (complete_handover).
  pure subroutine take_handover(memory)
    type(contact_state_t), intent(inout) :: memory
    type(spring_t) :: spring
    real(wp) :: gaps(max(memory%points%n, memory%n_slave))
    integer :: i

    associate (handover => memory%handover)
      if (.not. any(handover%is_freed)) return
      call find_gaps(memory, gaps)
      do i = 1, n_springs(memory)
        spring = spring_at(memory, gaps(i), i)
        if (handover%is_freed(spring%site)) handover%handed_over = handover%handed_over &
          + spring%energy
      end do
      memory%energy = memory%energy + handover%handed_over
    end associate
  end subroutine take_handover

  !> After a cycle: what contact has taken over leaves the tie. What it holds beyond that, of
  !> surfaces that lay within each other from the start, nobody has put in: that is told, and may be
  !> returned.
  pure subroutine complete_handover(memory, tie)
    type(contact_state_t), intent(inout) :: memory, tie
    real(wp) :: given

    if (.not. memory%handover%handed_over > 0.0_wp) return
    given = min(memory%handover%handed_over, max(0.0_wp, tie%ties%spent))
    tie%ties%spent = tie%ties%spent - given
    tie%energy = tie%energy - given
    tie%monitor%stored = tie%monitor%stored - given
    memory%energy = memory%energy - (memory%handover%handed_over - given)
    memory%limit%admissible = memory%limit%admissible + (memory%handover%handed_over - given)
    memory%handover%handed_over = 0.0_wp
  end subroutine complete_handover

  !> Whether a tie holds a site.
  pure function is_held_by_tie(memory, site) result(is_tied_site)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: site
    logical :: is_tied_site

    is_tied_site = .false.
    if (memory%has%tie_handover) is_tied_site = memory%handover%is_tied_site(site)
  end function is_held_by_tie

end module tie_handover_m
