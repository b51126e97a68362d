! SPDX-License-Identifier: MIT
!> What is added to the gaps that the law sees; search, points and slips do not know it.
!> Entry offsets: a point that has come behind a face without coming through it starts without
!> force, with the gap g + offset. The offset is never more than the depth, and fades with the slip
!> over half of the segment, small ones as over a ramp of 1 to 20; the work of its fading is
!> admissible energy. What overlaps beside the node have borne is no part of it
!> (doc/theory/contact.md, section 3.3).
!> Interference (LCINT; section 6.5): a site that overlaps by d at time zero has the gap
!> g + (1 - s) d, where the curve s leads from 0 to 1. So a press fit starts without force, and at
!> the end the overlap acts as it is. What the curve does is external work.
module spring_gaps_m
  use contact_state_m, only : contact_state_t, n_springs, site_at
  use search_state_m, only : contact_status_t, separated
  use contacts_m, only : contact_t
  use curves_m, only : curve_value
  use geometry_m, only : separation
  use kinds_m, only : wp
  use nodal_forces_m, only : average_values
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: reduce_new_offsets, update_offsets, add_offsets, faded_work, begin_ramp, &
    store_overlaps, ramp_gaps, gather_moment, limit_moment

  !> Least slope by which an offset fades with the slip.
  real(wp), parameter :: ramp = 0.05_wp

contains

  !> Limit all offsets by the present depths, and let them fade: after the search; in implicit runs
  !> at the end of a step.
  pure subroutine update_offsets(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory

    call fade_offsets(memory%slave_status, contact%slave, contact%master, memory%positions, &
      memory%scratch%increment)
    if (memory%master_status%n > 0) call fade_offsets(memory%master_status, contact%master, &
      contact%slave, memory%positions, memory%scratch%increment)
  end subroutine update_offsets

  !> Nodes that have come behind a face beside overlaps: the depth that these, or springs of master
  !> nodes there as they weigh at the node, bore in the call before is no part of a new offset.
  pure subroutine reduce_new_offsets(memory)
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: borne
    integer :: k, p

    associate (status => memory%slave_status, points => memory%points)
      do k = 1, status%n_active
        associate (i => status%active_points(k))
          if (.not. status%faded(i) < 0.0_wp) cycle
          borne = 0.0_wp
          if (memory%has%nodal_pressure) borne = memory%node_pressure(i)/memory%slave_penalty
          do p = 1, merge(0, points%n, memory%has%nodal_pressure)
            borne = max(borne, points%pressure(p)/points%stiffness(p) &
              *sum(points%slave_weights(:, p), mask=points%slave_nodes(:, p) == i))
          end do
          status%faded(i) = 0.0_wp
          status%offset(i) = max(0.0_wp, status%offset(i) - borne)
        end associate
      end do
    end associate
  end subroutine reduce_new_offsets

  !> The offsets of one pass.
  pure subroutine fade_offsets(status, own, other, positions, increments)
    type(contact_status_t), intent(inout) :: status
    type(surface_t), intent(in) :: own, other
    real(wp), intent(in), contiguous :: positions(:, :)  !! (4, n_node) of the interface
    real(wp), intent(in), contiguous :: increments(:, :) !! (2, n_node) displacements of the step, m
    real(wp) :: limited, t(2), length, slip
    integer :: k, i, ends(2)

    status%faded = 0.0_wp
    status%has_offset = .false.
    where (status%state == separated) status%offset = 0.0_wp
    do k = 1, status%n_active
      i = status%active_points(k)
      if (.not. status%offset(i) > 0.0_wp) cycle
      limited = min(status%offset(i), max(0.0_wp, -status%gap(i)))
      ends = status%pass%other_at + other%segments(:, status%segment(i))
      t = separation(positions(:, ends(2)), positions(:, ends(1)))
      length = norm2(t)
      associate (xi => status%xi(i))
        slip = dot_product(motion_of(status, own, increments, i) - (1.0_wp - xi) &
          *increments(:, ends(1)) - xi*increments(:, ends(2)), t)/length
      end associate
      if (.not. status%pass%has_history) slip = 0.0_wp
      status%offset(i) = max(0.0_wp, limited - abs(slip)*max(2.0_wp*limited/length, ramp))
      status%faded(i) = limited - status%offset(i)
      status%has_offset = status%has_offset .or. limited > 0.0_wp
    end do
  end subroutine fade_offsets

  !> Displacement of a point in the step, m.
  pure function motion_of(status, own, increments, i) result(motion)
    type(contact_status_t), intent(in) :: status
    type(surface_t), intent(in) :: own
    real(wp), intent(in), contiguous :: increments(:, :)
    integer, intent(in) :: i
    real(wp) :: motion(2)
    integer :: s, q

    if (status%pass%n_on_segment == 0) then
      motion = increments(:, status%pass%own_at + i)
    else
      s = 1 + (i - 1)/status%pass%n_on_segment
      q = i - (s - 1)*status%pass%n_on_segment
      associate (ends => status%pass%own_at + own%segments(:, s), xi => status%pass%xi(q))
        motion = (1.0_wp - xi)*increments(:, ends(1)) + xi*increments(:, ends(2))
      end associate
    end if
  end function motion_of

  !> A value of the points that are followed, at a contact point on the list: that of its virtual
  !> node or Gauss point where the search follows these, else of its slave nodes by their weights.
  pure function value_at(memory, of_slave, of_master, p) result(value)
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(in), allocatable :: of_slave(:), of_master(:)
    integer, intent(in) :: p
    real(wp) :: value

    associate (points => memory%points, nodes => memory%points%slave_nodes(:, p))
      if (nodes(1) > memory%n_slave) then
        value = of_master(nodes(1) - memory%n_slave)
      else if (memory%has%segment_points) then
        value = of_slave(site_at(memory, points, p))
      else
        value = dot_product(points%slave_weights(:, p), of_slave(nodes))
      end if
    end associate
  end function value_at

  !> Add the entry offsets of all contact points on the list to their gaps.
  pure subroutine add_offsets(memory, gaps)
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(inout) :: gaps(:) !! (points%n or more) m
    integer :: p

    do p = 1, memory%points%n
      gaps(p) = gaps(p) + value_at(memory, memory%slave_status%offset, &
        memory%master_status%offset, p)
    end do
  end subroutine add_offsets

  !> Work of the fading of this call, with the points loaded, J/m: the springs have been given it.
  pure function faded_work(memory) result(work)
    type(contact_state_t), intent(in) :: memory
    real(wp) :: work
    integer :: p

    work = 0.0_wp
    do p = 1, memory%points%n
      work = work + memory%points%pressure(p)*memory%points%area(p) &
        *value_at(memory, memory%slave_status%faded, memory%master_status%faded, p)
    end do
  end function faded_work

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
  pure subroutine store_overlaps(memory)
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
  end subroutine store_overlaps

  !> Add what does not act yet to the gaps of points or slave nodes.
  pure subroutine ramp_gaps(memory, gaps)
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(inout) :: gaps(:) !! (springs or more) m
    integer :: i

    do i = 1, n_springs(memory)
      gaps(i) = gaps(i) + memory%interference%remaining*depth_at(memory, i)
    end do
  end subroutine ramp_gaps

  !> The overlap of a point or slave node at time zero. A master node that was no site then has what
  !> the ends of its slave segment had.
  pure function depth_at(memory, i) result(depth)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: i
    real(wp) :: depth

    associate (depths => memory%interference%depth, points => memory%points)
      if (memory%has%nodal_pressure) then
        depth = depths(i)
      else
        depth = depths(site_at(memory, points, i))
        if (depth < 0.0_wp) depth = sum(points%slave_weights(:, i) &
          *max(0.0_wp, depths(points%slave_nodes(:, i))))
      end if
    end associate
  end function depth_at

  !> The sum of p w depth, and what the curve does to the springs of this call: before the energy
  !> law, which may count on it.
  pure subroutine gather_moment(memory)
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: moment, load
    integer :: i

    moment = 0.0_wp
    do i = 1, n_springs(memory)
      if (memory%has%nodal_pressure) then
        load = memory%node_pressure(i)*memory%scratch%nodal(2, i)
      else
        load = memory%points%pressure(i)*memory%points%area(i)
      end if
      moment = moment + load*depth_at(memory, i)
    end do
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

end module spring_gaps_m
