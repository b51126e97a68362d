! SPDX-License-Identifier: MIT
!> Energy-controlling scale factor of the contact forces, one per interface and explicit cycle
!> (doc/theory/contact.md, section 6.1). Springs whose areas and shares change with the angle have
!> no potential; where they would return more energy than they received, all forces of the
!> interface are scaled down by one factor, so that momentum and moments stay in balance.
module energy_limit_m
  use contact_state_m, only : contact_state_t, features_t, exchange
  use law_state_m, only : energy_limit_t
  use spring_gaps_m, only : limit_moment
  use kinds_m, only : wp
  implicit none
  private
  public :: store_previous_springs, form_springs, limit_forces, admit_entry_work, &
    energy_factor, scale_forces, count_cycle, returned_t, slack

  !> Work of forces with the factor one, J/m.
  type :: returned_t
    real(wp) :: behind = 0.0_wp !! in the half step behind
    real(wp) :: ahead = 0.0_wp  !! in the half step to come, at the present velocity
    real(wp) :: pushed = 0.0_wp !! there, by what else accelerates the nodes
    real(wp) :: recoil = 0.0_wp !! there, by the acceleration that the forces make themselves
  end type returned_t

  !> Sums over the nodes of an interface. Without default values, which would be written before
  !> each use.
  type :: power_sums_t
    real(wp) :: present  !! F.v, W/m
    real(wp) :: previous !! F-.v, of the forces of the cycle before
    real(wp) :: recoil   !! F.F/m, N^2/kg
  end type power_sums_t

  !> Share of the largest energy so far that may be returned beyond what is stored: bodies that
  !> slide on each other exchange that much without harm.
  real(wp), parameter :: slack = 0.01_wp
  !> Share of what holds the nodes back that is counted on in the coming half step: it is
  !> extrapolated from the previous step, and vanishes where contact opens.
  real(wp), parameter :: relied_on = 0.5_wp

contains

  !> Before the points are generated: the forces of the normal springs alone that acted in the cycle
  !> before, where there are others; both lists are exchanged.
  pure subroutine store_previous_springs(memory)
    type(contact_state_t), intent(inout) :: memory

    if (.not. has_other_forces(memory%has)) return
    call exchange(memory%scratch%spring, memory%scratch%previous_spring)
    if (.not. memory%scratch%had_force) memory%scratch%previous_spring = 0.0_wp
  end subroutine store_previous_springs

  !> The forces of the normal springs alone, where there are others; after a restart too.
  pure subroutine form_springs(memory)
    type(contact_state_t), intent(inout) :: memory

    if (.not. has_other_forces(memory%has)) return
    associate (spring => memory%scratch%spring, n => size(memory%force))
      if (memory%has%friction) then
        call difference(n, memory%force, memory%friction%force, spring)
      else
        spring = memory%force
      end if
      if (memory%has%ties) call subtract(n, memory%ties%force, spring)
      if (memory%has%damping) call subtract(n, memory%damping_force, spring)
    end associate
  end subroutine form_springs

  !> Whether springs along the normal are limited among other forces.
  pure function has_other_forces(has) result(others)
    type(features_t), intent(in) :: has
    logical :: others

    others = has%limit .and. (has%damping .or. has%friction .or. has%ties)
  end function has_other_forces

  !> Both components of all nodes in one loop: column by column it takes twenty times as long.
  pure subroutine subtract(n, part, spring)
    integer, intent(in) :: n
    real(wp), intent(in) :: part(n)
    real(wp), intent(inout) :: spring(n)

    spring = spring - part
  end subroutine subtract

  !> Forces without one of their parts, without a copy first.
  pure subroutine difference(n, force, part, spring)
    integer, intent(in) :: n
    real(wp), intent(in) :: force(n), part(n)
    real(wp), intent(inout) :: spring(n)

    spring = force - part
  end subroutine difference

  !> Scale the forces of the interface, with the pressures and the part of damping, by what the
  !> springs may return; before they are added to those of the mesh and their work is counted.
  pure subroutine limit_forces(motion, time, dt, memory)
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node) u(n), v(n-1/2)
    real(wp), intent(in) :: time                     !! of u, s
    real(wp), intent(in) :: dt                       !! step that led to u, s
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: factor

    call form_springs(memory)
    associate (limit => memory%limit, scratch => memory%scratch)
      if (.not. memory%has%limit) return
      if (has_other_forces(memory%has)) then
        call find_factor(memory%energy - memory%ties%energy, memory%nodes, motion, dt, &
          scratch%previous_spring, scratch%spring, scratch%velocity, limit, factor)
      else
        call find_factor(memory%energy, memory%nodes, motion, dt, scratch%previous_force, &
          memory%force, scratch%velocity, limit, factor)
      end if
      call exchange(scratch%velocity, limit%velocity)
      call count_cycle(factor, time, limit)
    end associate
    if (.not. factor < 1.0_wp) return
    call scale_forces(factor, memory)
    call form_springs(memory)
    if (memory%has%interference) call limit_moment(factor, memory)
  end subroutine limit_forces

  !> The factor of this cycle. The sums that are formed in each cycle bound what may be returned;
  !> only where that is too much, most often just before contact opens, all is summed.
  pure subroutine find_factor(energy, nodes, motion, dt, previous, present, velocity, limit, factor)
    real(wp), intent(in) :: energy       !! of the springs up to the cycle before, J/m
    integer, intent(in), contiguous :: nodes(:)
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node of the mesh)
    real(wp), intent(in) :: dt
    real(wp), intent(in), contiguous :: previous(:, :) !! (2, n) forces of the cycle before, N/m
    real(wp), intent(in), contiguous :: present(:, :)  !! (2, n) forces of this cycle, N/m
    real(wp), intent(inout), contiguous :: velocity(:, :) !! (2, n) v(n-1/2) on return
    type(energy_limit_t), intent(inout) :: limit       !! has that of the cycle before
    real(wp), intent(out) :: factor
    type(power_sums_t) :: sums
    type(returned_t) :: returned
    real(wp) :: leap, bound, previous_recoil

    factor = 1.0_wp
    call sum_powers(size(nodes), nodes, motion, previous, present, limit%inverse_mass, velocity, &
      sums)
    previous_recoil = limit%recoil
    limit%recoil = sums%recoil
    if (.not. limit%coming_step > 0.0_wp) return
    leap = 0.25_wp*limit%coming_step*(dt + limit%coming_step)
    bound = energy + limit%admissible - 0.5_wp*dt*sums%previous + slack*limit%largest
    ! |F.q| <= (F.F + F-.F-)/2
    if (.not. 0.5_wp*(dt + limit%coming_step)*sums%present + leap*(1.5_wp*sums%recoil &
      + 0.5_wp*previous_recoil) > bound) return
    returned%behind = 0.5_wp*dt*sums%present
    returned%ahead = 0.5_wp*limit%coming_step*sums%present
    returned%recoil = leap*sums%recoil
    returned%pushed = pushed_work(dt, leap, previous, present, limit%inverse_mass, velocity &
      - limit%velocity)
    if (returned%pushed < 0.0_wp) returned%pushed = relied_on*returned%pushed
    factor = energy_factor(returned, bound)
    limit%recoil = factor**2*limit%recoil
  end subroutine find_factor

  !> The velocities, the powers of previous and present forces, and what these do to the nodes. One
  !> loop gathers, the other goes through lists that lie in one piece: that is vectorised.
  pure subroutine sum_powers(n, nodes, motion, previous, present, inverse_mass, velocity, sums)
    integer, intent(in) :: n, nodes(n)
    real(wp), intent(in) :: motion(4, *)
    real(wp), intent(in), dimension(2*n) :: previous, present, inverse_mass !! x and y of each node
    real(wp), intent(inout) :: velocity(2*n)
    type(power_sums_t), intent(out) :: sums
    real(wp) :: power, previous_power, recoil
    integer :: i

    do i = 1, n
      velocity(2*i - 1:2*i) = motion(3:4, nodes(i))
    end do
    power = 0.0_wp
    previous_power = 0.0_wp
    recoil = 0.0_wp
    !$omp simd reduction(+:power, previous_power, recoil)
    do i = 1, 2*n
      power = power + velocity(i)*present(i)
      previous_power = previous_power + velocity(i)*previous(i)
      recoil = recoil + inverse_mass(i)*(present(i)*present(i))
    end do
    sums = power_sums_t(power, previous_power, recoil)
  end subroutine sum_powers

  !> Work that all else does on the nodes in the half step to come: forces as in the cycle before,
  !> in the free directions of each node no larger than the contact force there was.
  pure function pushed_work(dt, leap, previous, present, inverse_mass, change) result(work)
    real(wp), intent(in) :: dt
    real(wp), intent(in) :: leap !! half the coming step times the mean of both steps, s^2
    real(wp), intent(in), contiguous :: previous(:, :), present(:, :), inverse_mass(:, :)
    real(wp), intent(in), contiguous :: change(:, :) !! (2, n) v(n-1/2) - v(n-3/2)
    real(wp) :: work
    real(wp) :: other(2), square, previous_square
    integer :: i

    work = 0.0_wp
    do i = 1, size(present, 2)
      associate (is_free => inverse_mass(:, i) > 0.0_wp)
        previous_square = sum(previous(:, i)**2, mask=is_free)
        if (.not. previous_square > 0.0_wp) cycle
        other = 0.0_wp
        where (is_free) other = change(:, i)/(inverse_mass(:, i)*dt) - previous(:, i)
        square = sum(other**2)
        if (square > previous_square) other = other*sqrt(previous_square/square)
        work = work + leap*sum(present(:, i)*other*inverse_mass(:, i))
      end associate
    end do
  end function pushed_work

  !> The largest factor s, from 0 to 1, with which the half step behind, s behind, and both half
  !> steps, s (behind + ahead + pushed) + s^2 recoil, return no more than `bound`; where no s does,
  !> that with the least return.
  pure function energy_factor(returned, bound) result(factor)
    type(returned_t), intent(in) :: returned
    real(wp), intent(in) :: bound !! J/m
    real(wp) :: factor
    real(wp) :: linear, square, discriminant

    factor = 1.0_wp
    if (returned%behind > 0.0_wp) factor = min(1.0_wp, max(0.0_wp, bound)/returned%behind)
    linear = returned%behind + returned%ahead + returned%pushed
    square = returned%recoil
    if (.not. (linear + square > bound .and. linear + square > 0.0_wp)) return
    discriminant = linear**2 + 4.0_wp*square*bound
    if (linear > 0.0_wp) then
      ! The root without a difference of like numbers; 0 where even the least would be too much.
      factor = min(factor, max(0.0_wp, 2.0_wp*bound/(linear + sqrt(max(0.0_wp, discriminant)))))
    else
      factor = min(factor, (-linear + sqrt(max(0.0_wp, discriminant)))/(2.0_wp*square))
    end if
  end function energy_factor

  !> Scale all that acts in this cycle but ties, which have a potential.
  pure subroutine scale_forces(factor, memory)
    real(wp), intent(in) :: factor
    type(contact_state_t), intent(inout) :: memory

    memory%force = factor*memory%force
    if (memory%has%ties) memory%force = memory%force + (1.0_wp - factor)*memory%ties%force
    associate (points => memory%points)
      points%pressure(:points%n) = factor*points%pressure(:points%n)
      if (memory%has%damping) then
        points%damping(:points%n) = factor*points%damping(:points%n)
        memory%damping_force = factor*memory%damping_force
      end if
      if (memory%has%friction) then
        points%traction(:points%n) = factor*points%traction(:points%n)
        memory%friction%force = factor*memory%friction%force
      end if
    end associate
    if (memory%has%nodal_pressure) memory%node_pressure = factor*memory%node_pressure
  end subroutine scale_forces

  !> Count a cycle with force. Cycle zero has no step to come and is not limited.
  pure subroutine count_cycle(factor, time, limit)
    real(wp), intent(in) :: factor, time
    type(energy_limit_t), intent(inout) :: limit

    limit%n_loaded = limit%n_loaded + 1
    if (.not. factor < 1.0_wp) return
    limit%n_limited = limit%n_limited + 1
    if (.not. factor < limit%least_factor) return
    limit%least_factor = factor
    limit%least_time = time
  end subroutine count_cycle

  !> Admit the energy of springs that became active loaded, up to the allowance of entries.
  pure subroutine admit_entry_work(energy, limit)
    real(wp), intent(in) :: energy !! J/m
    type(energy_limit_t), intent(inout) :: limit
    real(wp) :: granted

    granted = min(energy, max(0.0_wp, limit%entry_allowance - limit%admitted))
    limit%admitted = limit%admitted + granted
    limit%admissible = limit%admissible + granted
  end subroutine admit_entry_work

end module energy_limit_m
