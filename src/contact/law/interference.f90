! SPDX-License-Identifier: MIT
!> Interference (LCINT; doc/theory/contact.md, section 6.5): a site that overlaps by d at time zero
!> has the gap g + (1 - s) d, where the curve s leads from 0 to 1. So a press fit starts without
!> force, and at the end the overlap acts as it is. What the curve does is external work.
module interference_m
  use contact_state_m, only : contact_state_t, site_at
  use contacts_m, only : contact_t
  use curves_m, only : curve_value
  use kinds_m, only : wp
  use nodal_average_m, only : average_values
  implicit none
  private
  public :: begin_ramp, take_overlaps, ramp_gaps, gather_moment, limit_moment

contains

  !> At the beginning of a call: the part that does not act yet. The curve works on the springs of
  !> the call before for half of what it grows by; where these are gone, so is the rest.
  pure subroutine begin_ramp(contact, time, memory)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: time
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: previous

    associate (interference => memory%interference)
      previous = interference%remaining
      interference%remaining = 1.0_wp - curve_value(contact%interference, time)
      ! What grows in the step waits here for the moment of this call.
      call add_work(0.5_wp*interference%moment*(previous - interference%remaining), memory)
      memory%scratch%ramp_step = previous - interference%remaining
      memory%scratch%is_start = .not. time > 0.0_wp
      interference%moment = 0.0_wp
    end associate
  end subroutine begin_ramp

  !> At time zero, with the points generated: how deep the sites are.
  pure subroutine take_overlaps(memory)
    type(contact_state_t), intent(inout) :: memory
    integer :: p, site

    associate (depth => memory%interference%depth, points => memory%points)
      if (memory%has%nodal_pressure) then
        call average_values(points, points%gap, memory%n_slave, memory%scratch%nodal)
        depth(:memory%n_slave) = max(0.0_wp, -memory%scratch%nodal(1, :memory%n_slave))
        return
      end if
      do p = 1, points%n
        if (.not. points%gap(p) < 0.0_wp) cycle
        site = site_at(memory, memory%points, p)
        depth(site) = max(depth(site), -points%gap(p))
      end do
    end associate
  end subroutine take_overlaps

  !> Add what does not act yet to the gaps of points or slave nodes.
  pure subroutine ramp_gaps(memory, gaps)
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(inout) :: gaps(:) !! (points or slave nodes, or more) m
    integer :: p

    associate (n => memory%n_slave, remaining => memory%interference%remaining)
      if (memory%has%nodal_pressure) then
        gaps(:n) = gaps(:n) + remaining*memory%interference%depth(:n)
      else
        do p = 1, memory%points%n
          gaps(p) = gaps(p) + remaining*depth_at(memory, p)
        end do
      end if
    end associate
  end subroutine ramp_gaps

  !> The overlap of a point at time zero. A master node that was no site then has what the ends of
  !> its slave segment had.
  pure function depth_at(memory, p) result(depth)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: p
    real(wp) :: depth

    associate (depths => memory%interference%depth, nodes => memory%points%slave_nodes(:, p))
      depth = depths(site_at(memory, memory%points, p))
      if (depth < 0.0_wp) depth = sum(memory%points%slave_weights(:, p)*max(0.0_wp, depths(nodes)))
    end associate
  end function depth_at

  !> The sum of p w depth, and what the curve does to the springs of this call: before the energy
  !> law, which may count on it.
  pure subroutine gather_moment(memory)
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: moment
    integer :: i

    moment = 0.0_wp
    associate (points => memory%points)
      if (memory%has%nodal_pressure) then
        do i = 1, memory%n_slave
          moment = moment + memory%node_pressure(i)*memory%scratch%nodal(2, i) &
            *memory%interference%depth(i)
        end do
      else
        do i = 1, points%n
          moment = moment + points%pressure(i)*points%area(i)*depth_at(memory, i)
        end do
      end if
    end associate
    call add_work(0.5_wp*(moment - memory%interference%moment)*memory%scratch%ramp_step, memory)
    memory%interference%moment = moment
  end subroutine gather_moment

  !> Where the energy law has scaled the springs, the curve has done that much less.
  pure subroutine limit_moment(factor, memory)
    real(wp), intent(in) :: factor
    type(contact_state_t), intent(inout) :: memory

    associate (moment => memory%interference%moment)
      call add_work(0.5_wp*(factor - 1.0_wp)*moment*memory%scratch%ramp_step, memory)
      moment = factor*moment
    end associate
  end subroutine limit_moment

  !> Work of the curve: the springs have it.
  pure subroutine add_work(work, memory)
    real(wp), intent(in) :: work !! J/m
    type(contact_state_t), intent(inout) :: memory

    memory%interference%work = memory%interference%work + work
    memory%energy = memory%energy + work
  end subroutine add_work

end module interference_m
