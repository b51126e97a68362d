! SPDX-License-Identifier: MIT
!> The one place that knows the contact laws: from the gap of a place to the pressure there. Where
!> these places are, at the points or at the slave nodes, the row of the formulation says; the
!> pressure of every point is kept on the list. Adding a law is a row of `laws`, a file law_*.f90,
!> and a `case` for its pressure, its derivative and its energy (doc/add_a_law.md).
module contact_law_m
  use contact_state_m, only : contact_state_t
  use dual_m, only : dual_t
  use entry_offset_m, only : has_offsets, average_with_offsets
  use interference_m, only : take_overlaps, ease_gaps, ease_nodes, gather_moment
  use kinds_m, only : wp
  use law_penalty_m, only : press_penalty, vary_penalty, energy_penalty
  use nodal_average_m, only : share_out
  implicit none
  private
  public :: law_t, laws, law_penalty, pressed_at_points, pressed_at_slave_nodes, press_places, &
    vary_pressure, density_of

  !> Where pressure is formed and kept.
  integer, parameter :: pressed_at_points = 1, pressed_at_slave_nodes = 2

  !> A law.
  type :: law_t
    integer :: number
    character(20) :: name
  end type law_t

  integer, parameter :: law_penalty = 1
  !> Slave nodes pressed together.
  integer, parameter :: n_block = 64
  !> All laws.
  type(law_t), parameter :: laws(*) = [law_t(law_penalty, 'penalty')]

contains

  !> Pressures of all points on the list, before damping.
  pure subroutine press_places(contact_law, where_pressed, memory)
    integer, intent(in) :: contact_law   !! a number of `laws`
    integer, intent(in) :: where_pressed !! one of the constants above
    type(contact_state_t), intent(inout) :: memory
    integer :: n

    if (allocated(memory%interference%depth) .and. memory%scratch%is_start) &
      call take_overlaps(memory)
    associate (points => memory%points, nodal => memory%scratch%nodal)
      select case (where_pressed)
      case (pressed_at_points)
        if (allocated(memory%interference%depth) .or. has_offsets(memory)) then
          call press_eased(contact_law, memory)
        else
          call press(contact_law, points%n, points%stiffness, points%gap, points%pressure)
        end if
      case (pressed_at_slave_nodes)
        n = memory%n_slave
        call average_with_offsets(memory, nodal)
        if (allocated(memory%interference%depth)) call ease_nodes(memory%interference, n, nodal)
        call press_nodes(contact_law, n, memory%slave_penalty, nodal, memory%node_pressure)
        call share_out(points%n, points%slave_nodes, points%slave_weights, memory%node_pressure, &
          points%pressure)
      end select
    end associate
    if (allocated(memory%interference%depth)) call gather_moment(memory)
  end subroutine press_places

  !> Pressures of all points where an initial overlap grows or points have entry offsets.
  pure subroutine press_eased(contact_law, memory)
    integer, intent(in) :: contact_law
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: gaps(memory%points%n)

    call ease_gaps(memory, gaps)
    associate (points => memory%points)
      call press(contact_law, points%n, points%stiffness, gaps, points%pressure)
    end associate
  end subroutine press_eased

  !> Pressures of slave nodes, which have one stiffness.
  pure subroutine press_nodes(contact_law, n, stiffness, nodal, pressure)
    integer, intent(in) :: contact_law, n
    real(wp), intent(in) :: stiffness       !! N/m^2
    real(wp), intent(inout) :: nodal(2, n)  !! (1, :) averaged gaps, m
    real(wp), intent(inout) :: pressure(n)  !! N/m
    real(wp) :: stiffnesses(n_block), gaps(n_block)
    integer :: first, m

    stiffnesses = stiffness
    do first = 1, n, n_block
      m = min(n_block, n - first + 1)
      gaps(:m) = nodal(1, first:first + m - 1)
      call press(contact_law, m, stiffnesses, gaps, pressure(first:first + m - 1))
    end do
  end subroutine press_nodes

  !> Pressures of some places.
  pure subroutine press(contact_law, n, stiffness, gap, pressure)
    integer, intent(in) :: contact_law, n
    real(wp), intent(in) :: stiffness(n), gap(n)
    real(wp), intent(inout) :: pressure(n)

    select case (contact_law)
    case (law_penalty); call press_penalty(n, stiffness, gap, pressure)
    end select
  end subroutine press

  !> Pressure of a place in contact with its derivatives.
  pure function vary_pressure(contact_law, stiffness, gap) result(pressure)
    integer, intent(in) :: contact_law
    real(wp), intent(in) :: stiffness
    type(dual_t), intent(in) :: gap
    type(dual_t) :: pressure

    select case (contact_law)
    case (law_penalty); pressure = vary_penalty(stiffness, gap)
    end select
  end function vary_pressure

  !> Energy that a place stores per unit of its area.
  pure function density_of(contact_law, stiffness, gap) result(density)
    integer, intent(in) :: contact_law
    real(wp), intent(in) :: stiffness, gap
    real(wp) :: density !! J/m^2

    select case (contact_law)
    case (law_penalty); density = energy_penalty(stiffness, gap)
    end select
  end function density_of

end module contact_law_m
