! SPDX-License-Identifier: MIT
!> Interference (LCINT; doc/theory/contact.md, section 6.5): a place that overlaps by d at time zero
!> has the gap g + (1 - s) d, where the curve s leads from 0 to 1. So a press fit starts without
!> force, and at the end the overlap acts as it is. What the curve does is external work.
module interference_m
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use curves_m, only : curve_value
  use entry_offset_m, only : has_offsets, offset_at
  use friction_m, only : place_of_point, spot_at
  use law_state_m, only : interference_memory_t
  use kinds_m, only : wp
  use nodal_average_m, only : average_gaps
  implicit none
  private
  public :: begin_growth, take_overlaps, eased_gap, ease_gaps, ease_nodes, gather_moment, &
    limit_moment

contains

  !> At the beginning of a call: the part that does not act yet. The curve works on the springs of
  !> the call before for half of what it grows by; where these are gone, so is the rest.
  pure subroutine begin_growth(contact, time, memory)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: time
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: former

    associate (interference => memory%interference)
      former = interference%left
      interference%left = 1.0_wp - curve_value(contact%interference, time)
      ! What grows in the step waits here for the moment of this call.
      call add_work(0.5_wp*interference%moment*(former - interference%left), memory)
      memory%scratch%growth = former - interference%left
      memory%scratch%is_start = .not. time > 0.0_wp
      interference%moment = 0.0_wp
    end associate
  end subroutine begin_growth

  !> At time zero, with the points placed: how deep the places are.
  pure subroutine take_overlaps(memory)
    type(contact_state_t), intent(inout) :: memory
    integer :: p, place

    associate (depth => memory%interference%depth, points => memory%points)
      if (allocated(memory%node_pressure)) then
        call average_gaps(points, memory%n_slave, memory%scratch%nodal)
        depth(:memory%n_slave) = max(0.0_wp, -memory%scratch%nodal(1, :memory%n_slave))
        return
      end if
      do p = 1, points%n
        if (.not. points%gap(p) < 0.0_wp) cycle
        place = place_of(memory, p)
        depth(place) = max(depth(place), -points%gap(p))
      end do
    end associate
  end subroutine take_overlaps

  !> The gaps that the springs of all points feel.
  pure subroutine ease_gaps(memory, gaps)
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(inout) :: gaps(:) !! (points%n or more) m
    integer :: p

    do p = 1, memory%points%n
      gaps(p) = eased_gap(memory, p)
    end do
  end subroutine ease_gaps

  !> The same of one point.
  pure function eased_gap(memory, p) result(gap)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: p
    real(wp) :: gap

    gap = memory%points%gap(p)
    if (has_offsets(memory)) gap = gap + offset_at(memory, p)
    if (allocated(memory%interference%depth)) &
      gap = gap + memory%interference%left*depth_at(memory, p)
  end function eased_gap

  !> The averaged gaps that the springs of slave nodes feel, from averages of the gaps.
  pure subroutine ease_nodes(interference, n, nodal)
    type(interference_memory_t), intent(in) :: interference
    integer, intent(in) :: n
    real(wp), intent(inout) :: nodal(2, n) !! (1, :) m

    nodal(1, :) = nodal(1, :) + interference%left*interference%depth(:n)
  end subroutine ease_nodes

  !> The overlap of a point at time zero. A master node that was no place then has what the ends of
  !> its slave segment had.
  pure function depth_at(memory, p) result(depth)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: p
    real(wp) :: depth

    associate (depths => memory%interference%depth, nodes => memory%points%slave_nodes(:, p))
      depth = depths(place_of(memory, p))
      if (depth < 0.0_wp) depth = sum(memory%points%slave_weights(:, p)*max(0.0_wp, depths(nodes)))
    end associate
  end function depth_at

  !> The place where the pressure of a point is formed, where that is no slave node.
  pure function place_of(memory, p) result(place)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: p
    integer :: place

    if (allocated(memory%spots)) then
      associate (n => size(memory%spot_xi), points => memory%points)
        place = n*(points%slave_nodes(1, p) - 1) &
          + spot_at(points%slave_weights(2, p), memory%spot_xi)
      end associate
    else
      place = place_of_point(memory%points, p)
    end if
  end function place_of

  !> The sum of p w depth, and what the curve does to the springs of this call: before the energy
  !> law, which may count on it.
  pure subroutine gather_moment(memory)
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: moment
    integer :: i

    moment = 0.0_wp
    associate (points => memory%points)
      if (allocated(memory%node_pressure)) then
        call average_gaps(points, memory%n_slave, memory%scratch%nodal)
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
    call add_work(0.5_wp*(moment - memory%interference%moment)*memory%scratch%growth, memory)
    memory%interference%moment = moment
  end subroutine gather_moment

  !> Where the energy law has scaled the springs, the curve has done that much less.
  pure subroutine limit_moment(factor, memory)
    real(wp), intent(in) :: factor
    type(contact_state_t), intent(inout) :: memory

    associate (moment => memory%interference%moment)
      call add_work(0.5_wp*(factor - 1.0_wp)*moment*memory%scratch%growth, memory)
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
