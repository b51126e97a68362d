! SPDX-License-Identifier: MIT
!> Springs on the weighted gaps of type 7 whose forces are those of the end of the step (PUNIT 4;
!> doc/theory/contact.md, section 6.6): no stiffness makes them unstable at the step of the
!> elements. The points are placed with the other interfaces; pressures follow here, once the
!> velocities are known that the nodes would have without them.
module implicit_penalty_m
  use complementarity_m, only : problem_t, outcome_t, set_size, solve_complementarity, is_low, &
    is_between
  use contact_scatter_m, only : scatter_forces
  use contact_springs_m, only : measure_springs, end_look
  use contact_state_m, only : contact_state_t
  use contact_work_m, only : apart_t, hand_over
  use energy_limit_m, only : energy_factor, scale_forces, count_cycle, returned_t, slack
  use kinds_m, only : wp
  use nodal_average_m, only : average_gaps, average_more, share_out
  use weighted_gaps_m, only : rows_t, choose_rows, form_shares, find_rates, fill_band, along_normal
  implicit none
  private
  public :: pressing_t, start_pressing, press_ahead

  !> The step ahead at the nodes of an interface, and room to find its pressures that is kept from
  !> step to step.
  type :: pressing_t
    real(wp) :: dt = 0.0_wp                 !! to the end of the step, s
    real(wp) :: dt_before = 0.0_wp          !! of the step behind, s
    integer :: cycle = 0
    real(wp) :: time = 0.0_wp               !! of u(n), s
    real(wp), allocatable :: velocity(:, :) !! (2, n_slave + n_master) v(n+1/2) without the
                                            !! interface
    real(wp), allocatable :: mobility(:, :) !! (2, n_slave + n_master) velocity from a force of 1
    integer, allocatable :: led(:, :)       !! (2, :) motions that lead nodes, and these
    real(wp), allocatable :: gap(:)         !! (n_slave) mean gaps, m
    real(wp), allocatable :: left(:)        !! (n_slave) what would be left of them, over dt, m/s
    logical, allocatable :: wanted(:)       !! (n_slave) may press
    real(wp), allocatable :: rate(:)        !! (points) of gaps, m/s
    type(rows_t) :: rows
    type(problem_t) :: problem
  end type pressing_t

  !> Part of a penetration that is taken back in a step where springs have no compliance.
  real(wp), parameter :: recovered = 0.1_wp
  !> Penetration that counts as one from the start, over the gap below which nodes are looked at.
  real(wp), parameter :: overlap = 1.0e-3_wp
  !> Rows are those that would close, and others that open no faster than this times what the
  !> fastest of those closes by: pressing one changes another by about as much as itself at most.
  real(wp), parameter :: pushed_apart = 2.0_wp

contains

  !> Room for an interface.
  pure subroutine start_pressing(memory, step)
    type(contact_state_t), intent(in) :: memory
    type(pressing_t), intent(inout) :: step

    associate (n_node => memory%n_slave + memory%n_master, n_slave => memory%n_slave)
      allocate (step%velocity(2, n_node), step%mobility(2, n_node))
      allocate (step%gap(n_slave), step%left(n_slave), step%wanted(n_slave))
      allocate (step%rows%slave(n_slave), step%rows%place(n_slave), step%rows%newest(n_node))
    end associate
  end subroutine start_pressing

  !> Pressures, nodal forces added to `force`, and the work of the step behind.
  pure subroutine press_ahead(motion, step, memory, force)
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node) u(n), v(n-1/2)
    type(pressing_t), intent(inout) :: step
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, at least the interface's nodes)

    memory%scratch%waits = .false.
    if (memory%points%n > 0) then
      call find_mean_gaps(step, memory)
      call find_pressures(step, memory)
      call share_out(memory%points%n, memory%points%slave_nodes, memory%points%slave_weights, &
        memory%node_pressure, memory%points%pressure)
      if (memory%watch%is_due .or. step%cycle == 0 .or. memory%scratch%is_born) &
        call measure_springs(memory)
      ! Loaded at time zero they hold energy that no force has put in.
      if (step%cycle == 0) memory%energy = memory%watch%stored
      call give_credit(step, memory)
      if (step%rows%n > 0) call scatter_forces(memory)
      if (memory%n_active > 0 .and. step%cycle > 0 .and. memory%limit%credit < huge(1.0_wp)) &
        call limit_return(step, motion, memory)
    else
      step%gap = 0.0_wp
      call give_credit(step, memory)
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
  pure subroutine give_credit(step, memory)
    type(pressing_t), intent(in) :: step
    type(contact_state_t), intent(inout) :: memory
    logical :: overlaps !! some mean gap is below zero by more than springs leave

    associate (limit => memory%limit, begins => step%cycle == 0 .or. memory%scratch%is_born)
      if (memory%slave_penalty > 0.0_wp) then
        if (memory%scratch%is_born) limit%credit = memory%watch%stored
        return
      end if
      if (.not. (begins .or. limit%credit >= huge(1.0_wp))) return
      overlaps = any(step%gap < -overlap*memory%closed_gap)
      if (begins) then
        if (overlaps) limit%credit = huge(1.0_wp)
      else if (.not. overlaps) then
        limit%credit = max(0.0_wp, -memory%energy)
        limit%largest = 0.0_wp
      end if
    end associate
  end subroutine give_credit

  !> Contact never returns more than it took (section 6.1): areas and normals change while corners
  !> turn. The step to come is known here, and so is what it returns.
  pure subroutine limit_return(step, motion, memory)
    type(pressing_t), intent(in) :: step
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory
    type(returned_t) :: returned
    real(wp) :: before, bound, factor
    integer :: i

    before = 0.0_wp
    do i = 1, size(memory%nodes)
      associate (force => memory%force(:, i), v => motion(3:4, memory%nodes(i)), &
        former => memory%scratch%former_force(:, i))
        returned%behind = returned%behind + (force(1)*v(1) + force(2)*v(2))
        returned%ahead = returned%ahead + (force(1)*step%velocity(1, i) &
          + force(2)*step%velocity(2, i))
        returned%recoil = returned%recoil + (force(1)**2*step%mobility(1, i) &
          + force(2)**2*step%mobility(2, i))
        before = before + (former(1)*v(1) + former(2)*v(2))
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

  !> Mean gaps of the slave nodes, and what would be left of each at the end of the step without
  !> pressures. Of an overlap a part is taken back in a step where springs have no compliance.
  pure subroutine find_mean_gaps(step, memory)
    type(pressing_t), intent(inout) :: step
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: share
    integer :: i

    share = merge(1.0_wp, recovered, memory%slave_penalty > 0.0_wp)
    associate (points => memory%points, nodal => memory%scratch%nodal)
      call average_gaps(points, memory%n_slave, nodal)
      if (allocated(step%rate)) then
        if (size(step%rate) < size(points%gap)) deallocate (step%rate)
      end if
      if (.not. allocated(step%rate)) allocate (step%rate(size(points%gap)))
      call find_rates(points%n, points%slave_nodes, points%slave_weights, points%master_nodes, &
        points%master_weights, points%normal, step%velocity, step%rate)
      do i = 1, memory%n_slave
        step%gap(i) = nodal(1, i)
      end do
      call average_more(points, step%rate, memory%n_slave, nodal)
      do i = 1, memory%n_slave
        step%left(i) = nodal(1, i) + merge(share, 1.0_wp, step%gap(i) < 0.0_wp)*step%gap(i)/step%dt
        nodal(1, i) = step%gap(i)
      end do
    end associate
  end subroutine find_mean_gaps

  !> Pressures of the slave nodes: P = kappa p >= 0, and what is left of each mean gap at the end of
  !> the step beside the spring, r + W P >= 0, one of them zero.
  pure subroutine find_pressures(step, memory)
    type(pressing_t), intent(inout) :: step
    type(contact_state_t), intent(inout) :: memory
    type(outcome_t) :: outcome
    integer :: i

    call choose_pressed(step, memory)
    associate (rows => step%rows, problem => step%problem, &
      kappa => memory%scratch%nodal(2, :memory%n_slave))
      if (rows%n > 0) then
        call form_shares(memory%points, memory%scratch%nodal, rows)
        call set_size(problem, rows%n, rows%width, 0)
        call fill_band(rows, along_normal, step%mobility, problem%band)
        if (memory%slave_penalty > 0.0_wp) call add_compliance(rows%n, rows%width, rows%slave, &
          memory%scratch%nodal, memory%slave_penalty*step%dt, problem%band)
        do i = 1, rows%n
          problem%r(i) = step%left(rows%slave(i))
          problem%low(i) = 0.0_wp
          problem%high(i) = huge(1.0_wp)
          problem%at(i) = merge(is_between, is_low, memory%node_pressure(rows%slave(i)) > 0.0_wp)
        end do
        call solve_complementarity(problem, outcome)
      end if
      memory%node_pressure = 0.0_wp
      do i = 1, rows%n
        memory%node_pressure(rows%slave(i)) = problem%x(i)/kappa(rows%slave(i))
      end do
    end associate
    if (outcome%n_sweep > 0) memory%n_swept = memory%n_swept + 1
    if (outcome%n_dropped > 0) memory%n_dropped = memory%n_dropped + 1
  end subroutine find_pressures

  !> Rows for the slave nodes that may press.
  pure subroutine choose_pressed(step, memory)
    type(pressing_t), intent(inout) :: step
    type(contact_state_t), intent(in) :: memory
    real(wp) :: fastest
    integer :: i

    fastest = 0.0_wp
    do i = 1, memory%n_slave
      fastest = max(fastest, -step%left(i))
    end do
    fastest = pushed_apart*fastest
    associate (kappa => memory%scratch%nodal)
      do i = 1, memory%n_slave
        step%wanted(i) = kappa(2, i) > 0.0_wp .and. (memory%node_pressure(i) > 0.0_wp &
          .or. step%left(i) < fastest)
      end do
    end associate
    call choose_rows(memory%n_slave, step%wanted, step%rows)
  end subroutine choose_pressed

  !> What the springs of rows give way by.
  pure subroutine add_compliance(n, width, slave, nodal, stiffness, band)
    integer, intent(in) :: n, width, slave(n)
    real(wp), intent(in) :: nodal(2, *)     !! kappa of slave nodes in (2, :), m
    real(wp), intent(in) :: stiffness       !! times the step, N s/m^2
    real(wp), intent(inout) :: band(0:width, n)
    integer :: i

    do i = 1, n
      band(0, i) = band(0, i) + 1.0_wp/(stiffness*nodal(2, slave(i)))
    end do
  end subroutine add_compliance

end module implicit_penalty_m
