! SPDX-License-Identifier: MIT
!> Springs on the weighted gaps of type 7 whose forces are those of the end of the step (PUNIT 4;
!> doc/theory/contact.md, section 6.6): no stiffness makes them unstable at the step of the
!> elements. The points are generated with the other interfaces; pressures follow here, once the
!> velocities are known that the nodes would have without them.
module implicit_penalty_m
  use complementarity_m, only : outcome_t, set_size, solve_complementarity, is_low, &
    is_between
  use contact_scatter_m, only : scatter_forces
  use contact_springs_m, only : measure_springs, end_sampling
  use contact_state_m, only : contact_state_t
  use contact_work_m, only : previous_work_t, store_previous_work, apply_forces
  use contacts_m, only : friction_rule_t
  use energy_limit_m, only : energy_factor, scale_forces, count_cycle, returned_t, slack, &
    store_previous_springs, form_springs
  use gap_rates_m, only : find_rates, fill_band, along_normal
  use implicit_friction_m, only : friction_ahead
  use kinds_m, only : wp
  use nodal_average_m, only : average_values, share_out
  use pressure_step_m, only : pressure_step_t, take_diagonal, set_diagonal, fill_columns
  use weighted_gaps_m, only : choose_rows, form_shares
  implicit none
  private
  public :: find_rows, pressures_ahead

  !> Part of a penetration that is taken back in a step where springs have no compliance, or stand
  !> for such.
  real(wp), parameter :: recovered = 0.1_wp
  !> Penetration that counts as one from the start, over the gap below which nodes are looked at.
  real(wp), parameter :: overlap = 1.0e-3_wp

contains

  !> The rows of the interface once its points are generated, and what each moves.
  pure subroutine find_rows(step, memory)
    type(pressure_step_t), intent(inout) :: step
    type(contact_state_t), intent(inout) :: memory

    associate (nodal => memory%scratch%nodal)
      call average_values(memory%points, memory%points%gap, memory%n_slave, nodal)
      step%gap = nodal(1, :memory%n_slave)
      call choose_rows(memory%n_slave, nodal, memory%node_pressure, memory%closed_gap, step%rows)
      if (step%rows%n > 0) call form_shares(memory%points, step%rows)
    end associate
  end subroutine find_rows

  !> Pressures, nodal forces added to `force`, and the work of the step behind.
  pure subroutine pressures_ahead(rule, motion, step, memory, force)
    type(friction_rule_t), intent(in) :: rule
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node) u(n), v(n-1/2)
    type(pressure_step_t), intent(inout) :: step
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, at least the interface's nodes)

    type(previous_work_t) :: previous_work

    memory%scratch%waits = .false.
    call store_previous_springs(memory%scratch%had_force, memory)
    call store_previous_work(motion, memory%scratch%had_force, memory, previous_work)
    if (memory%points%n > 0) then
      call find_pressures(step, memory)
      call share_out(memory%points%n, memory%points%slave_nodes, memory%points%slave_weights, &
        memory%node_pressure, memory%points%pressure)
      if (memory%monitor%is_due .or. step%cycle == 0 .or. memory%scratch%is_born) then
        call measure_springs(memory)
        if (step%is_stiff) memory%monitor%stored = 0.0_wp
      end if
      ! Loaded at time zero they hold energy that no force has put in.
      if (step%cycle == 0) memory%energy = memory%monitor%stored
      call admit_energy(step, memory)
      if (memory%has%friction) then
        call take_velocities(memory%nodes, motion, memory%limit%velocity)
        memory%points%traction(:memory%points%n) = 0.0_wp
        if (step%rows%n > 0) call friction_ahead(rule, step, memory)
      end if
      if (step%rows%n > 0) call scatter_forces(memory)
      call form_springs(memory)
      if (memory%n_active > 0 .and. step%cycle > 0 .and. memory%limit%admissible < huge(1.0_wp)) &
        call limit_return(step, motion, memory)
    else
      step%gap = 0.0_wp
      call admit_energy(step, memory)
      memory%node_pressure = 0.0_wp
    end if
    associate (had_force => memory%scratch%had_force)
      if (memory%n_active > 0 .or. had_force) &
        call apply_forces(step%dt_before, motion, previous_work, memory, force)
      call end_sampling(had_force, memory%n_active > 0, memory%monitor)
    end associate
  end subroutine pressures_ahead

  !> What springs hold that are born loaded may be returned. Without compliance they hold nothing:
  !> a penetration from the start is taken back whatever that makes, and from then on contact owes
  !> nothing.
  pure subroutine admit_energy(step, memory)
    type(pressure_step_t), intent(in) :: step
    type(contact_state_t), intent(inout) :: memory
    logical :: overlaps !! some mean gap is below zero by more than springs leave

    associate (limit => memory%limit, begins => step%cycle == 0 .or. memory%scratch%is_born)
      if (.not. step%is_stiff) then
        if (memory%scratch%is_born) limit%admissible = memory%monitor%stored
        return
      end if
      if (.not. (begins .or. limit%admissible >= huge(1.0_wp))) return
      overlaps = are_below(step%gap, memory%node_pressure, recovered*memory%slave_penalty, &
        -overlap*memory%closed_gap)
      if (begins) then
        if (overlaps) limit%admissible = huge(1.0_wp)
      else if (.not. overlaps) then
        limit%admissible = max(0.0_wp, -memory%energy)
        limit%largest = 0.0_wp
      end if
    end associate
  end subroutine admit_energy

  !> Whether any gap is below a bound by more than springs leave of it.
  pure logical function are_below(gap, pressure, stiffness, bound)
    real(wp), intent(in), contiguous :: gap(:), pressure(:)
    real(wp), intent(in) :: stiffness !! N/m^3; 0: they leave nothing
    real(wp), intent(in) :: bound     !! m

    if (stiffness > 0.0_wp) then
      are_below = any(gap + pressure/stiffness < bound)
    else
      are_below = any(gap < bound)
    end if
  end function are_below

  !> Contact never returns more than it took (section 6.1): areas and normals change while corners
  !> turn. The step to come is known here, and so is what it returns.
  pure subroutine limit_return(step, motion, memory)
    type(pressure_step_t), intent(inout) :: step
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory
    type(returned_t) :: returned
    real(wp) :: before, bound, factor

    if (memory%has%friction) then
      call sum_returns(size(memory%force), memory%limit%velocity, memory%scratch%spring, &
        memory%scratch%previous_spring, step%velocity, step%mobility, returned, before)
      returned%recoil = returned%recoil + sum_modes(memory%scratch%spring)
    else
      call take_velocities(memory%nodes, motion, step%behind)
      call sum_returns(size(memory%force), step%behind, memory%force, &
        memory%scratch%previous_force, step%velocity, step%mobility, returned, before)
      returned%recoil = returned%recoil + sum_modes(memory%force)
    end if
    returned%behind = 0.5_wp*step%dt_before*returned%behind
    returned%ahead = 0.5_wp*step%dt*returned%ahead
    returned%recoil = 0.5_wp*step%dt*returned%recoil
    bound = memory%energy + memory%limit%admissible - 0.5_wp*step%dt_before*before &
      + slack*memory%limit%largest + memory%limit%entry_allowance
    factor = energy_factor(returned, bound)
    call count_cycle(factor, step%time, memory%limit)
    if (.not. factor < 1.0_wp) return
    call scale_forces(factor, memory)
    call form_springs(memory)

  contains

    !> What free motions of rigid bodies add.
    pure function sum_modes(forces) result(recoil)
      real(wp), intent(in), contiguous :: forces(:, :)
      real(wp) :: recoil
      integer :: k

      recoil = 0.0_wp
      do k = 1, step%n_mode
        recoil = recoil + sum(step%modes(:, :, k)*forces)**2
      end do
    end function sum_modes

  end subroutine limit_return

  !> v(n-1/2) of the nodes.
  pure subroutine take_velocities(nodes, motion, velocity)
    integer, intent(in), contiguous :: nodes(:)
    real(wp), intent(in) :: motion(4, *)
    real(wp), intent(inout) :: velocity(2, *)
    integer :: i

    !GCC$ NOVECTOR
    do i = 1, size(nodes)
      velocity(:, i) = motion(3:4, nodes(i))
    end do
  end subroutine take_velocities

  !> Sums over x and y of all nodes, of the springs alone.
  pure subroutine sum_returns(n, behind, present, previous, ahead, mobility, returned, before)
    integer, intent(in) :: n
    real(wp), intent(in), dimension(n) :: behind, ahead   !! velocities of both steps, m/s
    real(wp), intent(in), dimension(n) :: present, previous !! forces, of the step before, N/m
    real(wp), intent(in) :: mobility(n)
    type(returned_t), intent(inout) :: returned
    real(wp), intent(out) :: before
    real(wp) :: of_present, to_come, recoil
    integer :: i

    of_present = 0.0_wp
    to_come = 0.0_wp
    recoil = 0.0_wp
    before = 0.0_wp
    !$omp simd reduction(+:of_present, to_come, recoil, before)
    do i = 1, n
      of_present = of_present + present(i)*behind(i)
      to_come = to_come + present(i)*ahead(i)
      recoil = recoil + present(i)*present(i)*mobility(i)
      before = before + previous(i)*behind(i)
    end do
    returned%behind = of_present
    returned%ahead = to_come
    returned%recoil = recoil
  end subroutine sum_returns

  !> Pressures of the slave nodes: P = kappa p >= 0, and what is left of each mean gap at the end of
  !> the step beside the spring, r + W P >= 0, one of them zero.
  pure subroutine find_pressures(step, memory)
    type(pressure_step_t), intent(inout) :: step
    type(contact_state_t), intent(inout) :: memory
    type(outcome_t) :: outcome
    integer :: i

    associate (rows => step%rows, problem => step%problem)
      if (rows%n > 0) then
        call set_size(problem, rows%n, rows%width, step%n_mode)
        call fill_band(rows, along_normal, step%mobility, problem%band)
        call fill_columns(step, along_normal)
        call take_diagonal(rows%n, rows%width, problem%band, step%diagonal)
        call set_diagonal(rows%n, rows%width, step%diagonal, rows%inverse, &
          memory%slave_penalty*step%dt, problem%band)
        call set_up(step, memory%node_pressure)
        call solve_complementarity(problem, outcome)
      end if
      memory%node_pressure = 0.0_wp
      do i = 1, rows%n
        memory%node_pressure(rows%slave(i)) = problem%x(i)*rows%inverse(i)
      end do
    end associate
  end subroutine find_pressures

  !> What would be left of the mean gaps without pressures, over the step, and what is guessed to
  !> press. Of an overlap a part is taken back in a step where springs have no compliance.
  pure subroutine set_up(step, pressure)
    type(pressure_step_t), intent(inout) :: step
    real(wp), intent(in) :: pressure(:) !! (n_slave) of the step before, N/m^2
    real(wp) :: opens, closes           !! per m of gap, 1/s
    integer :: i

    opens = 1.0_wp/step%dt
    closes = merge(recovered, 1.0_wp, step%is_stiff)/step%dt
    associate (rows => step%rows, problem => step%problem)
      call find_rates(rows, along_normal, step%velocity, problem%r)
      do i = 1, rows%n
        associate (gap => step%gap(rows%slave(i)))
          problem%r(i) = problem%r(i) + merge(closes, opens, gap < 0.0_wp)*gap
        end associate
        problem%low(i) = 0.0_wp
        problem%high(i) = huge(1.0_wp)
        problem%at(i) = merge(is_between, is_low, pressure(rows%slave(i)) > 0.0_wp)
      end do
    end associate
  end subroutine set_up

end module implicit_penalty_m
