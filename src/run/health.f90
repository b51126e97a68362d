! SPDX-License-Identifier: MIT
!> Checks that stop a run or warn: element volumes, forces, time step, energy balance.
module health_m
  use block_state_m, only : block_state_t
  use contact_state_m, only : contact_state_t
  use controls_m, only : controls_t
  use snapshot_m, only : energies_t, energy_ratio, total_energy
  use element_state_m, only : smallest_ratio, is_eroded
  use errors_m, only : error_t, raise, status_run
  use kinds_m, only : wp
  use layout_m, only : chunk_size, slot_part, tile_t
  use log_m, only : log_t, warn, to_text
  use model_m, only : model_t
  use plane_stress_m, only : thinning_start
  use state_m, only : state_t
  implicit none
  private
  public :: tile_check_t, check_tile, are_sound, check_elements, check_step, report_collapsed, &
    check_cycle, check_energy, check_ratio, check_static_step, check_radii, warn_of_energies, &
    warn_of_contact_energy, created_by_springs, created_by_forces, most_work, limit_point_advice, &
    energy_unaccounted, scheme_dissipation

  !> Works beyond this bound have lost their meaning. They are detected before numbers overflow,
  !> which a checked build would stop at.
  real(wp), parameter :: most_work = 1.0e150_wp

  !> Deviation of the energy ratio from one without a warning.
  real(wp), parameter :: ratio_tolerance = 0.05_wp

  character(*), parameter :: remedy = ': reduce TSSFAC (or LCTM) of *CONTROL_TIMESTEP if it ' &
    //'collapsed within a few cycles, else refine the mesh or add erosion (*MAT_ADD_EROSION)'

  !> Share of the total work above which the energy balance of a static step is checked.
  real(wp), parameter :: noticed = 1.0e-3_wp

  !> Cause of a violated energy balance in words: unknown, or possibly the numerical dissipation of
  !> implicit dynamics.
  character(*), parameter :: energy_unaccounted = 'energy balance violated'
  character(*), parameter :: scheme_dissipation = energy_unaccounted//' (numerical dissipation ' &
    //'of the time integration is not recorded; RHO 1 or GAMMA 0.5 has none)'

  !> Advice for a structure beyond a limit point.
  character(*), parameter :: limit_point_advice = 'prescribe a displacement instead ' &
    //'of the load to follow the path, or add inertia (IMASS 1 of *CONTROL_IMPLICIT_DYNAMICS)'

  !> Measure of created energy in words: in explicit runs energy that the springs returned beyond
  !> what they received; in implicit runs the whole negative work of contact forces, stored energy
  !> included.
  character(*), parameter :: created_by_springs = 'the contact springs created energy: '
  character(*), parameter :: created_by_forces = 'the contact forces created energy: '

  !> Results of the elements of one tile in a cycle. As long as a cache line, since threads write
  !> neighbouring tiles.
  type :: tile_check_t
    real(wp) :: time_limit = huge(1.0_wp)   !! smallest L/c, s
    real(wp) :: checksum = 0.0_wp           !! sum of works: finite as long as each work is
    logical :: has_volume = .true.          !! all A/A0 are positive
    real(wp) :: volume_change = 0.0_wp      !! largest |change of ln V| in the step
    real(wp) :: unused(4) = 0.0_wp          !! fills the cache line
  end type tile_check_t

contains

  !> Collect the results of a tile while its chunks are in the cache of the thread that advanced
  !> them.
  pure function check_tile(tile, elements) result(check)
    type(tile_t), intent(in) :: tile
    type(block_state_t), intent(in) :: elements
    type(tile_check_t) :: check
    integer :: i

    do i = tile%first_chunk, tile%last_chunk
      check%time_limit = min(check%time_limit, elements%time_limit(i))
      check%volume_change = max(check%volume_change, elements%volume_change(i))
      check%has_volume = check%has_volume .and. elements%volume_limit(i) > 0.0_wp
      check%checksum = check%checksum + (elements%deviatoric_work(i) + elements%hourglass_work(i))
    end do
  end function check_tile

  !> Whether all tiles and interfaces pass the checks of `check_elements`.
  pure function are_sound(checks, contacts) result(sound)
    type(tile_check_t), intent(in) :: checks(:)
    type(contact_state_t), intent(in) :: contacts(:)
    logical :: sound

    sound = all(checks%has_volume) &
      .and. abs(sum(checks%checksum) + sum(contacts%energy)) <= most_work
  end function are_sound

  !> Stop a run with a volume that is not positive, or with stresses or contact forces that are not
  !> finite.
  subroutine check_elements(model, state, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: checksum
    logical :: volumes_good

    volumes_good = minval(state%elements%volume_limit) > 0.0_wp
    checksum = sum(state%elements%deviatoric_work) + sum(state%elements%hourglass_work)
    if (allocated(state%contacts)) checksum = checksum + sum(state%contacts%energy)
    ! The comparison is false for NaN.
    if (volumes_good .and. abs(checksum) <= most_work) return
    if (allocated(state%contacts)) call name_bad_contact(model, state, error)
    if (.not. allocated(error)) call name_bad_chunk(model, state, error)
  end subroutine check_elements

  !> Name the interface and node of a contact force that is not finite although the positions are
  !> finite.
  subroutine name_bad_contact(model, state, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(error_t), allocatable, intent(out) :: error
    integer :: i, k

    do i = 1, size(state%contacts)
      associate (contact => state%contacts(i))
        if (.not. all(abs(contact%positions) <= huge(1.0_wp))) cycle
        do k = 1, size(contact%force, 2)
          if (all(abs(contact%force(:, k)) <= huge(1.0_wp))) cycle
          call raise(error, 'contact force is not finite at node ' &
            //to_text(model%mesh%node_id(contact%nodes(k)))//' of interface ' &
            //to_text(model%contacts(i)%id)//instant_text(state), status_run)
          return
        end do
        if (abs(contact%energy) <= most_work) cycle
        call raise(error, 'the work of the contact forces of interface ' &
          //to_text(model%contacts(i)%id)//instant_text(state)//' is '//to_text(-contact%energy) &
          //': the penalty or the time step is too large', status_run)
        return
      end associate
    end do
  end subroutine name_bad_contact

  !> Name the element at fault. Nodes have moved since its forces were formed, and a stress that is
  !> not finite spoils the nodes shared with neighbours; so stresses are checked before volumes.
  subroutine name_bad_chunk(model, state, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: what
    integer :: test, slot, first, last

    do test = 1, 4
      do slot = 1, model%layout%n_slot
        if (model%layout%slot_element(slot) == 0) cycle
        what = element_fault(model, state, slot, test)
        if (len(what) == 0) cycle
        call raise_for_element(model, state, slot, what, error)
        if (index(what, 'negative') == 1) error%message = error%message//remedy
        return
      end do
    end do
    ! Else the element with the largest stress of the chunk with the largest work.
    associate (work => abs(state%elements%deviatoric_work) + abs(state%elements%hourglass_work))
      first = (maxloc(work, 1) - 1)*chunk_size + 1
      last = min(first + chunk_size - 1, model%layout%n_slot)
      if (any(work > 0.5_wp*most_work)) call raise_for_element(model, state, first - 1 &
        + maxloc(maxval(abs(state%elements%deviator(first:last, :)), 2), 1, &
        model%layout%slot_element(first:last) > 0), 'excessive work of stresses', error)
    end associate
    if (.not. allocated(error)) call raise(error, &
      'negative area or values that are not finite'//instant_text(state), status_run)
  end subroutine name_bad_chunk

  !> Fault of an element in words, empty if there is none, in four passes: stress, volume, the
  !> volume limit of its equation of state, and its thickness in plane stress.
  function element_fault(model, state, slot, test) result(what)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: slot, test
    character(:), allocatable :: what
    real(wp) :: ratio
    integer :: i_chunk, first

    what = ''
    select case (test)
    case (1)
      if (.not. all(abs(state%elements%deviator(slot, :)) <= huge(ratio))) &
        what = 'values that are not finite'
    case (2)
      if (is_eroded(state%elements, slot)) return
      ratio = smallest_ratio(model, state%motion, state%elements, slot)
      if (.not. (ratio > 0.0_wp .and. ratio <= huge(ratio))) what = 'values that are not finite'
      if (ratio <= 0.0_wp) what = 'negative area'
    case (3)
      i_chunk = (slot - 1)/chunk_size + 1
      first = state%elements%eos_start(i_chunk)
      if (first == 0) return
      ratio = state%elements%eos_state(first + 2*chunk_size + mod(slot - 1, chunk_size))
      associate (eos => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material)%eos)
        if (1.0_wp + ratio < eos%least_ratio) what = 'V/V0 '//to_text(1.0_wp + ratio) &
          //', near which the ' &
          //'pressure of equation of state '//to_text(eos%id)//' has no bound (1 - (S1 - 1) mu - ' &
          //'S2 mu^2/(1 + mu) - S3 mu^3/(1 + mu)^2 comes to 0),'
      end associate
    case (4)
      i_chunk = (slot - 1)/chunk_size + 1
      if (.not. model%materials(model%parts(model%layout%chunk_part(i_chunk))%material) &
        %is_plane_stress) return
      first = thinning_start(state%elements, i_chunk, 1) + mod(slot - 1, chunk_size)
      if (minval(state%elements%eos_state(first:first + chunk_size*merge(3, 0, &
        state%elements%point_start(i_chunk) > 0):chunk_size)) <= -1.0_wp) &
        what = 'no thickness without stress across it (plane stress)'
    end select
  end function element_fault

  !> Raise the error that names the element in a slot.
  subroutine raise_for_element(model, state, slot, what, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: slot
    character(*), intent(in) :: what
    type(error_t), allocatable, intent(out) :: error

    call raise(error, trim(what)//' in '//element_text(model, slot)//instant_text(state), &
      status_run)
  end subroutine raise_for_element

  !> Element and part of a slot in words.
  pure function element_text(model, slot) result(text)
    type(model_t), intent(in) :: model
    integer, intent(in) :: slot
    character(:), allocatable :: text

    text = 'element '//to_text(model%mesh%element_id(model%layout%slot_element(slot))) &
      //' of part '//to_text(model%parts(slot_part(model%layout, slot))%id)
  end function element_text

  !> Cycle and time in words.
  pure function instant_text(state) result(text)
    type(state_t), intent(in) :: state
    character(:), allocatable :: text

    text = ' at cycle '//to_text(state%cycle)//', time '//to_text(state%time)
  end function instant_text

  !> Stop a run whose step falls below its floor: DTMIN of *CONTROL_TERMINATION, a millionth of the
  !> first step, and the resolution of the time.
  subroutine check_step(controls, first_dt, time, dt, error)
    type(controls_t), intent(in) :: controls
    real(wp), intent(in) :: first_dt, time, dt
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: floor_dt

    floor_dt = max(controls%dt_floor, 1.0e-6_wp)*first_dt
    if (dt >= floor_dt .and. dt > 4.0_wp*spacing(time)) return
    call raise(error, 'the time step '//to_text(dt)//' at time '//to_text(time) &
      //' is below its limit '//to_text(floor_dt)//' (DTMIN times the first step, at least a ' &
      //'millionth of it)', status_run)
  end subroutine check_step

  !> Add to the error of a small step the element with the smallest volume ratio, if that is below
  !> 0.1.
  subroutine report_collapsed(model, state, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(error_t), intent(inout) :: error
    real(wp) :: ratio, smallest
    integer :: slot, worst

    smallest = 0.1_wp
    worst = 0
    do slot = 1, model%layout%n_slot
      if (model%layout%slot_element(slot) == 0) cycle
      if (is_eroded(state%elements, slot)) cycle
      ratio = smallest_ratio(model, state%motion, state%elements, slot)
      if (ratio >= smallest) cycle
      smallest = ratio
      worst = slot
    end do
    if (worst == 0) return
    error%message = error%message//'; '//element_text(model, worst)//' has collapsed to V/V0 ' &
      //to_text(smallest)//remedy
  end subroutine report_collapsed

  !> Stop a run at the largest cycle number of a default integer.
  subroutine check_cycle(cycle, time, error)
    integer, intent(in) :: cycle
    real(wp), intent(in) :: time
    type(error_t), allocatable, intent(out) :: error

    if (cycle < huge(cycle)) return
    call raise(error, 'cycle '//to_text(cycle)//' at time '//to_text(time) &
      //' is the largest possible cycle number; use a larger time step', status_run)
  end subroutine check_cycle

  !> Stop a run whose energy is not finite, or with ENDENG whose energy ratio or created contact
  !> energy exceeds the limit.
  subroutine check_energy(controls, energies, creator, error)
    type(controls_t), intent(in) :: controls
    type(energies_t), intent(in) :: energies
    character(*), intent(in) :: creator !! `created_by_springs` or `created_by_forces`
    type(error_t), allocatable, intent(out) :: error

    if (.not. abs(total_energy(energies)) <= huge(1.0_wp)) then
      call raise(error, 'the total energy is not finite', status_run)
    else if (controls%energy_limit > 0.0_wp .and. &
      abs(energy_ratio(energies) - 1.0_wp) > 0.01_wp*controls%energy_limit) then
      call raise(error, 'the energy ratio '//to_text(energy_ratio(energies)) &
        //' changed by more than '//to_text(controls%energy_limit)//' per cent (ENDENG)', &
        status_run)
    else if (controls%energy_limit > 0.0_wp .and. &
      energies%created > 0.01_wp*controls%energy_limit*largest_energy(energies)) then
      call raise(error, creator//to_text(energies%created)//' of ' &
        //to_text(largest_energy(energies))//', more than '//to_text(controls%energy_limit) &
        //' per cent (ENDENG); the penalty or the time step is too large', status_run)
    end if
  end subroutine check_energy

  !> Warn once when the energy balance is first violated while the run continues. Missing energy is
  !> measured by the supplied or stored energy. Short waves may exceed the tolerance for a while:
  !> twice the tolerance is allowed.
  subroutine check_ratio(energies, spent, cause, cycle, time, warned, log)
    type(energies_t), intent(in) :: energies
    real(wp), intent(in) :: spent    !! admissible loss, J/m
    character(*), intent(in) :: cause !! `energy_unaccounted` or `scheme_dissipation`
    integer, intent(in) :: cycle
    real(wp), intent(in) :: time     !! s
    logical, intent(inout) :: warned !! already
    type(log_t), intent(inout) :: log

    if (warned) return
    warned = abs(energy_ratio(energies) - 1.0_wp) > 2.0_wp*ratio_tolerance .and. &
      abs(energy_error(energies, spent)) > 2.0_wp*ratio_tolerance*largest_energy(energies)
    if (warned) call warn(log, 'at cycle '//to_text(cycle)//', time '//to_text(time) &
      //': energy ratio '//to_text(energy_ratio(energies))//', unaccounted energy ' &
      //to_text(energy_error(energies, spent))//': '//cause)
  end subroutine check_ratio

  !> Unaccounted energy: gain, or loss beyond the admissible loss (negative), J/m.
  pure function energy_error(energies, spent) result(energy)
    type(energies_t), intent(in) :: energies
    real(wp), intent(in) :: spent !! admissible loss, J/m
    real(wp) :: energy

    energy = total_energy(energies) - energies%initial - energies%external_work
    if (energy < 0.0_wp) energy = min(0.0_wp, energy + spent)
  end function energy_error

  !> Warn of a static step that loses work: the structure has jumped to another equilibrium and the
  !> kinetic energy of the jump is lost. Along the path the trapezoidal rule misses less than a
  !> hundredth of the work of a step.
  subroutine check_static_step(work, held, spent, cycle, time, log)
    real(wp), intent(in) :: work(2)           !! external work before and after the step, J/m
    real(wp), intent(in) :: held(2)           !! stored or dissipated energy before and after the
                                              !! step, J/m
    real(wp), intent(in) :: spent             !! admissible loss, J/m
    integer, intent(in) :: cycle
    real(wp), intent(in) :: time              !! s
    type(log_t), intent(inout) :: log
    real(wp) :: change(2)

    change = [work(2) - work(1), held(2) - held(1)]
    if (change(1) - change(2) - spent <= max(ratio_tolerance*maxval(abs(change)), &
      noticed*max(abs(work(2)), abs(held(2))))) return
    call warn(log, 'step '//to_text(cycle)//' to time '//to_text(time)//' has passed a limit ' &
      //'point or is too large: the loads do the work '//to_text(change(1))//', but only ' &
      //to_text(change(2))//' is stored or dissipated; '//limit_point_advice)
  end subroutine check_static_step

  !> Warn once when nodes of an axisymmetric run have crossed the axis.
  subroutine check_radii(model, state, warned, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    logical, intent(inout) :: warned
    type(log_t), intent(inout) :: log
    integer :: i, n, last
    real(wp) :: radius, least

    if (warned .or. .not. model%is_axisymmetric) return
    n = 0
    last = 1
    least = 0.0_wp
    do i = 1, model%mesh%n_node
      radius = model%mesh%coordinates(1, i) + state%motion(1, i)
      if (radius >= 0.0_wp) cycle
      n = n + 1
      if (radius < least) last = i
      least = min(least, radius)
    end do
    warned = n > 0
    if (warned) call warn(log, 'node '//to_text(model%mesh%node_id(last)) &
      //' has crossed the axis (radius '//to_text(least)//'; nodes beyond it: '//to_text(n)//') ' &
      //'at cycle '//to_text(state%cycle)//', time '//to_text(state%time)//': results are ' &
      //'invalid from here on')
  end subroutine check_radii

  !> Reference energy: largest of initial energy, external work and internal energy, J/m.
  pure function largest_energy(energies) result(largest)
    type(energies_t), intent(in) :: energies
    real(wp) :: largest

    largest = max(abs(energies%initial), abs(energies%external_work), energies%internal)
  end function largest_energy

  !> Warn at the end of an implicit run whose contact forces created more than 5 % of the energy.
  !> Less is within the error of the trapezoidal rule when a gap closes in a step.
  subroutine warn_of_contact_energy(energies, log)
    type(energies_t), intent(in) :: energies
    type(log_t), intent(inout) :: log

    if (energies%created > 0.05_wp*largest_energy(energies)) call warn(log, created_by_forces &
      //to_text(energies%created)//' of '//to_text(largest_energy(energies))//'; the penalty or ' &
      //'the time step is too large, or slave nodes were activated at a large penetration beside ' &
      //'the end of a surface (limit it with SRCH)')
  end subroutine warn_of_contact_energy

  !> Warn at the end of a run of a large hourglass energy and of a violated energy balance.
  subroutine warn_of_energies(energies, spent, cause, log)
    type(energies_t), intent(in) :: energies
    real(wp), intent(in) :: spent     !! admissible loss, J/m
    character(*), intent(in) :: cause !! `energy_unaccounted` or `scheme_dissipation`
    type(log_t), intent(inout) :: log

    ! Bodies that have bounced off keep little internal energy: a thousandth of all is no fault.
    if (energies%hourglass > 0.1_wp*max(energies%internal, 0.01_wp*largest_energy(energies))) &
      call warn(log, &
      'the hourglass energy '//to_text(energies%hourglass)//' is more than 10 % of the internal ' &
      //'energy '//to_text(energies%internal))
    if (abs(energy_ratio(energies) - 1.0_wp) > ratio_tolerance .and. abs(energy_error(energies, &
      spent)) > ratio_tolerance*abs(energies%initial + energies%external_work)) call warn(log, &
      'at the end: energy ratio '//to_text(energy_ratio(energies))//', unaccounted energy ' &
      //to_text(energy_error(energies, spent))//': '//cause)
  end subroutine warn_of_energies

end module health_m
