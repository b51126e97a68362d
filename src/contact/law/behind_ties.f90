! SPDX-License-Identifier: MIT
!> Contact behind ties that break: between the same surfaces, of all places that no tie holds
!> (doc/theory/contact.md, section 6.4). The tie tells it its places before each call.
module behind_ties_m
  use contact_law_m, only : find_gaps, spring_t, n_springs, spring_at
  use contact_state_m, only : contact_state_t, place_at, n_side
  use law_state_m, only : is_held, is_broken
  use kinds_m, only : wp
  use nodal_average_m, only : share_out
  implicit none
  private
  public :: hear_tie, leave_to_tie, take_over, settle_with_tie, is_left_to_tie

contains

  !> Which places the tie holds now, and which it has just lost.
  pure subroutine hear_tie(tie, memory)
    type(contact_state_t), intent(in) :: tie
    type(contact_state_t), intent(inout) :: memory
    associate (handover => memory%handover)
      if (.not. allocated(handover%is_left)) &
        allocate (handover%is_left(size(tie%ties%state)), source=.false.)
      handover%is_freed = handover%is_left
      handover%is_left = held_places(tie)
      handover%is_freed = handover%is_freed .and. .not. handover%is_left
    end associate
  end subroutine hear_tie

  !> The places that a tie holds. Where slave and master nodes lie upon each other type 5 has one
  !> place of the two: the other, never tied itself, goes with it.
  pure function held_places(tie) result(is_left)
    type(contact_state_t), intent(in) :: tie
    logical :: is_left(size(tie%ties%state))
    integer :: s, p, k

    is_left = tie%ties%state == is_held
    if (tie%has%spots .or. tie%has%nodal_pressure) return
    associate (ties => tie%ties, points => tie%points)
      do s = 1, size(ties%side)
        if (ties%state(ties%place(s)) /= is_held) cycle
        p = ties%first(s)
        do k = 1, n_side
          associate (a => points%slave_nodes(k, p), b => points%master_nodes(k, p))
            if (points%slave_weights(k, p) > 0.5_wp) is_left(a) = ties%state(a) /= is_broken
            if (points%master_weights(k, p) > 0.5_wp) is_left(b) = ties%state(b) /= is_broken
          end associate
        end do
      end do
    end associate
  end function held_places

  !> After all places have been pressed: those that the tie holds are not.
  pure subroutine leave_to_tie(memory)
    type(contact_state_t), intent(inout) :: memory
    integer :: p

    associate (points => memory%points)
      if (memory%has%nodal_pressure) then
        where (memory%handover%is_left(:memory%n_slave)) memory%node_pressure = 0.0_wp
        call share_out(points%n, points%slave_nodes, points%slave_weights, memory%node_pressure, &
          points%pressure)
      else
        do p = 1, points%n
          if (memory%handover%is_left(place_at(memory, p))) points%pressure(p) = 0.0_wp
        end do
      end if
    end associate
  end subroutine leave_to_tie

  !> What the springs hold of places that have just been freed while pressed: the tie has taken it
  !> in, and gives it up (settle_with_tie).
  pure subroutine take_over(memory)
    type(contact_state_t), intent(inout) :: memory
    type(spring_t) :: spring
    real(wp) :: gaps(max(memory%points%n, memory%n_slave))
    integer :: i

    associate (handover => memory%handover)
      if (.not. any(handover%is_freed)) return
      call find_gaps(memory, gaps)
      do i = 1, n_springs(memory)
        spring = spring_at(memory, gaps(i), i)
        if (handover%is_freed(spring%place)) handover%taken = handover%taken + spring%energy
      end do
      memory%energy = memory%energy + handover%taken
    end associate
  end subroutine take_over

  !> After a cycle: what contact has taken over leaves the tie. What it holds beyond that, of
  !> surfaces that lay within each other from the start, nobody has put in: that is told, and may be
  !> returned.
  pure subroutine settle_with_tie(memory, tie)
    type(contact_state_t), intent(inout) :: memory, tie
    real(wp) :: given

    if (.not. memory%handover%taken > 0.0_wp) return
    given = min(memory%handover%taken, max(0.0_wp, tie%ties%spent))
    tie%ties%spent = tie%ties%spent - given
    tie%energy = tie%energy - given
    tie%watch%stored = tie%watch%stored - given
    memory%energy = memory%energy - (memory%handover%taken - given)
    memory%limit%credit = memory%limit%credit + (memory%handover%taken - given)
    memory%handover%taken = 0.0_wp
  end subroutine settle_with_tie

  !> Whether a tie holds a place.
  pure function is_left_to_tie(memory, place) result(is_left)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: place
    logical :: is_left

    is_left = .false.
    if (memory%has%former_tie) is_left = memory%handover%is_left(place)
  end function is_left_to_tie

end module behind_ties_m
