! SPDX-License-Identifier: MIT
!> Entry offsets: a point that has come behind a face without coming through it starts without
!> force, with the gap g + offset. The offset is never more than the depth, and fades with the slip
!> over half of the segment, small ones as over a ramp of 1 to 20; the work of its fading is
!> admissible energy (doc/theory/contact.md, section 3.3).
module entry_offset_m
  use contact_state_m, only : contact_state_t, contact_status_t, separated, segment_point_at
  use contacts_m, only : contact_t
  use geometry_m, only : separation
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: has_offsets, update_offsets, add_offsets, faded_work

  !> Least slope by which an offset fades with the slip.
  real(wp), parameter :: ramp = 0.05_wp

contains

  !> Whether some point has an entry offset.
  pure function has_offsets(memory) result(has)
    type(contact_state_t), intent(in) :: memory
    logical :: has

    has = memory%has%entry_offsets .and. (memory%slave_status%has_offset &
      .or. memory%master_status%has_offset)
  end function has_offsets

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
    integer :: n

    associate (points => memory%points, nodes => memory%points%slave_nodes(:, p))
      if (nodes(1) > memory%n_slave) then
        value = of_master(nodes(1) - memory%n_slave)
      else if (memory%has%segment_points) then
        n = size(memory%segment_xi)
        value = of_slave(n*(memory%slave_status%pass%segment_at(nodes(1)) - 1) &
          + segment_point_at(points%slave_weights(2, p), memory%segment_xi))
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

end module entry_offset_m
