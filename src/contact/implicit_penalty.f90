! SPDX-License-Identifier: MIT
!> Springs on the weighted gaps of type 7 whose forces are those of the end of the step (PUNIT 4;
!> doc/theory/contact.md, section 6.6): no stiffness makes them unstable at the step of the
!> elements. The points are placed with the other interfaces; pressures follow here, once the
!> velocities are known that the nodes would have without them.
module implicit_penalty_m
  use complementarity_m, only : solve_complementarity, outcome_t
  use contact_scatter_m, only : scatter_forces
  use contact_springs_m, only : measure_springs, end_look
  use contact_state_m, only : contact_state_t
  use contact_work_m, only : apart_t, hand_over
  use energy_limit_m, only : energy_factor, scale_forces, count_cycle, returned_t, slack
  use kinds_m, only : wp
  use nodal_average_m, only : average_gaps, share_out
  use weighted_gaps_m, only : rows_t, choose_rows, form_shares, gap_rates, fill_band
  implicit none
  private
  public :: coming_step_t, press_ahead

  !> The step ahead at the nodes of an interface.
  type :: coming_step_t
    real(wp) :: dt = 0.0_wp                 !! to the end of the step, s
    real(wp) :: dt_before = 0.0_wp          !! of the step behind, s
    integer :: cycle = 0
    real(wp) :: time = 0.0_wp               !! of u(n), s
    real(wp), allocatable :: velocity(:, :) !! (2, n_slave + n_master) v(n+1/2) without the
                                            !! interface
    real(wp), allocatable :: mobility(:, :) !! (2, n_slave + n_master) velocity from a force of 1
  end type coming_step_t

  !> Part of a penetration that is taken back in a step where springs have no compliance.
  real(wp), parameter :: recovered = 0.1_wp
  !> Penetration that counts as one from the start, over the gap below which nodes are looked at.
  real(wp), parameter :: overlap = 1.0e-3_wp

contains

  !> Pressures, nodal forces added to `force`, and the work of the step behind.
  pure subroutine press_ahead(step, motion, memory, force)
    type(coming_step_t), intent(in) :: step
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node) u(n), v(n-1/2)
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, at least the interface's nodes)

    memory%scratch%waits = .false.
    if (memory%points%n > 0) then
      call average_gaps(memory%points, memory%n_slave, memory%scratch%nodal)
      call find_pressures(step, memory)
      call share_out(memory%points%n, memory%points%slave_nodes, memory%points%slave_weights, &
        memory%node_pressure, memory%points%pressure)
      if (memory%watch%is_due .or. step%cycle == 0 .or. memory%scratch%is_born) &
        call measure_springs(memory)
      ! Loaded at time zero they hold energy that no force has put in.
      if (step%cycle == 0) memory%energy = memory%watch%stored
      call give_credit(step%cycle, any(memory%scratch%nodal(2, :memory%n_slave) > 0.0_wp &
        .and. memory%scratch%nodal(1, :memory%n_slave) < -overlap*memory%closed_gap), memory)
      call scatter_forces(memory)
      if (memory%n_active > 0 .and. step%cycle > 0 .and. memory%limit%credit < huge(1.0_wp)) &
        call limit_return(step, motion, memory)
    else
      call give_credit(step%cycle, .false., memory)
      memory%node_pressure = 0.0_wp
    end if
    associate (had_force => memory%scratch%had_force)
      if (memory%n_active > 0 .or. had_force) &
        call hand_over(step%dt_before, motion, apart_t(), memory, force)
      call end_look(had_force, memory%n_active > 0, memory%watch)
    end associate
  end subroutine press_ahead

  !> What springs hold that are born loaded may be returned. Without compliance they hold nothing:
  !> a penetration from the start is taken back whatever that makes, and from then on contact owes
  !> nothing.
  pure subroutine give_credit(cycle, overlaps, memory)
    integer, intent(in) :: cycle
    logical, intent(in) :: overlaps !! some mean gap is below zero by more than springs leave
    type(contact_state_t), intent(inout) :: memory

    associate (limit => memory%limit, begins => cycle == 0 .or. memory%scratch%is_born)
      if (memory%slave_penalty > 0.0_wp) then
        if (memory%scratch%is_born) limit%credit = memory%watch%stored
      else if (begins) then
        if (overlaps) limit%credit = huge(1.0_wp)
      else if (.not. (overlaps .or. limit%credit < huge(1.0_wp))) then
        limit%credit = max(0.0_wp, -memory%energy)
        limit%largest = 0.0_wp
      end if
    end associate
  end subroutine give_credit

  !> Contact never returns more than it took (section 6.1): areas and normals change while corners
  !> turn. The step to come is known here, and so is what it returns.
  pure subroutine limit_return(step, motion, memory)
    type(coming_step_t), intent(in) :: step
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory
    type(returned_t) :: returned
    real(wp) :: before, bound, factor
    integer :: i

    before = 0.0_wp
    do i = 1, size(memory%nodes)
      associate (force => memory%force(:, i), v => motion(3:4, memory%nodes(i)))
        returned%behind = returned%behind + dot_product(force, v)
        returned%ahead = returned%ahead + dot_product(force, step%velocity(:, i))
        returned%recoil = returned%recoil + sum(force**2*step%mobility(:, i))
        if (memory%scratch%had_force) &
          before = before + dot_product(memory%scratch%former_force(:, i), v)
      end associate
    end do
    returned%behind = 0.5_wp*step%dt_before*returned%behind
    returned%ahead = 0.5_wp*step%dt*returned%ahead
    returned%recoil = 0.5_wp*step%dt*returned%recoil
    bound = memory%energy + memory%limit%credit - 0.5_wp*step%dt_before*before &
      + slack*memory%limit%largest + memory%limit%loan
    factor = energy_factor(returned, bound)
    call count_cycle(factor, step%time, memory%limit)
    if (factor < 1.0_wp) call scale_forces(factor, memory)
  end subroutine limit_return

  !> Pressures of the slave nodes: P = kappa p >= 0, and what is left of each mean gap at the end of
  !> the step beside the spring, r + W P >= 0, one of them zero.
  pure subroutine find_pressures(step, memory)
    type(coming_step_t), intent(in) :: step
    type(contact_state_t), intent(inout) :: memory
    type(rows_t) :: rows
    type(outcome_t) :: outcome
    real(wp), allocatable :: band(:, :), rate(:), pressing(:)
    logical, allocatable :: acts(:)
    integer :: i

    associate (gap => memory%scratch%nodal(1, :memory%n_slave), &
      kappa => memory%scratch%nodal(2, :memory%n_slave))
      call choose_rows(memory%n_slave, size(memory%nodes), kappa > 0.0_wp &
        .and. (gap < memory%closed_gap .or. memory%node_pressure > 0.0_wp), rows)
      call form_shares(memory%points, kappa, rows)
      allocate (band(0:rows%width, rows%n), rate(rows%n), pressing(rows%n), acts(rows%n))
      call fill_band(rows, step%mobility, band)
      do i = 1, rows%n
        acts(i) = memory%node_pressure(rows%slave(i)) > 0.0_wp
        rate(i) = gap(rows%slave(i))/step%dt
        if (memory%slave_penalty > 0.0_wp) then
          band(0, i) = band(0, i) + 1.0_wp/(memory%slave_penalty*kappa(rows%slave(i))*step%dt)
        else if (rate(i) < 0.0_wp) then
          rate(i) = recovered*rate(i)
        end if
      end do
      call gap_rates(rows, step%velocity, rate)
      call solve_complementarity(rows%n, rows%width, band, rate, acts, pressing, outcome)
      memory%node_pressure = 0.0_wp
      do i = 1, rows%n
        memory%node_pressure(rows%slave(i)) = pressing(i)/kappa(rows%slave(i))
      end do
    end associate
    if (outcome%n_sweep > 0) memory%n_swept = memory%n_swept + 1
    if (outcome%n_dropped > 0) memory%n_dropped = memory%n_dropped + 1
  end subroutine find_pressures

end module implicit_penalty_m
