! SPDX-License-Identifier: MIT
!> Checks that end a run which has gone wrong, with the cause in words.
module health_m
  use block_state_m, only : block_state_t
  use contact_state_m, only : contact_state_t
  use controls_m, only : controls_t
  use snapshot_m, only : energies_t, energy_ratio, total_energy
  use element_state_m, only : smallest_ratio, is_gone
  use errors_m, only : error_t, raise, status_run
  use kinds_m, only : wp
  use layout_m, only : chunk_size, slot_part, tile_t
  use log_m, only : log_t, warn, to_text
  use model_m, only : model_t
  use state_m, only : state_t
  implicit none
  private
  public :: tile_check_t, check_tile, are_sound, check_elements, check_step, name_collapsed, &
    check_cycle, check_energy, check_ratio, check_static_step, check_radii, warn_of_energies, &
    warn_of_contact_energy, made_by_springs, made_by_forces, most_work, what_would_do, &
    unaccounted, dissipated

  !> Work beyond this means nothing any more; it is found before numbers overflow, which a
  !> checked build would stop at.
  real(wp), parameter :: most_work = 1.0e150_wp

  !> How far the energy ratio may be from one without a word.
  real(wp), parameter :: ratio_band = 0.05_wp

  character(*), parameter :: remedy = ': reduce TSSFAC (or LCTM) of *CONTROL_TIMESTEP if it ' &
    //'collapsed within a few cycles, else refine the mesh or let it erode (*MAT_ADD_EROSION)'

  !> Part of all work so far from which on a step is looked at whose works do not add up.
  real(wp), parameter :: noticed = 1.0e-3_wp

  !> Where energy that is missing has gone: unknown, or into the numerical dissipation of implicit
  !> dynamics.
  character(*), parameter :: unaccounted = 'energy has come in or gone that no column accounts for'
  character(*), parameter :: dissipated = unaccounted//' (the numerical dissipation of the time ' &
    //'integration is not kept: RHO 1 or GAMMA 0.5 has none)'

  !> What follows a body beyond a limit point.
  character(*), parameter :: what_would_do = 'a prescribed displacement in place of the load ' &
    //'follows the path, inertia (IMASS 1 of *CONTROL_IMPLICIT_DYNAMICS) the jump'

  !> What has made energy: in explicit runs the springs, by what they gave beyond what they took; in
  !> implicit ones all that contact forces did, what is stored among it.
  character(*), parameter :: made_by_springs = 'the contact springs have made energy: '
  character(*), parameter :: made_by_forces = 'the contact forces created energy: '

  !> What the elements of one tile have come to in a cycle. As long as a cache line:
  !> threads fill them side by side.
  type :: tile_check_t
    real(wp) :: time_limit = huge(1.0_wp)   !! smallest L/c, s
    real(wp) :: checksum = 0.0_wp           !! of the works: finite as long as all of them are
    logical :: has_volume = .true.          !! all A/A0 are positive
    real(wp) :: volume_change = 0.0_wp      !! largest change of ln V in the step, without sign
    real(wp) :: unused(4) = 0.0_wp          !! fills the cache line
  end type tile_check_t

contains

  !> Look through the chunks of a tile while they are in the cache of the thread that advanced them.
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

  !> Whether all tiles and interfaces are as `check_elements` wants them.
  pure function are_sound(checks, contacts) result(sound)
    type(tile_check_t), intent(in) :: checks(:)
    type(contact_state_t), intent(in) :: contacts(:)
    logical :: sound

    sound = all(checks%has_volume) &
      .and. abs(sum(checks%checksum) + sum(contacts%energy)) <= most_work
  end function are_sound

  !> Volumes must stay positive, stresses and contact forces finite.
  subroutine check_elements(model, state, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: checksum
    logical :: volumes_good

    volumes_good = minval(state%elements%volume_limit) > 0.0_wp
    checksum = sum(state%elements%deviatoric_work) + sum(state%elements%hourglass_work)
    if (allocated(state%contacts)) checksum = checksum + sum(state%contacts%energy)
    ! Not a number, or beyond all that means something.
    if (volumes_good .and. abs(checksum) <= most_work) return
    if (allocated(state%contacts)) call name_bad_contact(model, state, error)
    if (.not. allocated(error)) call name_bad_chunk(model, state, error)
  end subroutine check_elements

  !> The interface whose forces are not finite though its nodes are at finite
  !> places: that is where it began.
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
          call raise(error, 'a contact force that is not finite at node ' &
            //to_text(model%mesh%node_id(contact%nodes(k)))//' of interface ' &
            //to_text(model%contacts(i)%id)//instant_text(state), status_run)
          return
        end do
        if (abs(contact%energy) <= most_work) cycle
        call raise(error, 'the work '//to_text(-contact%energy) &
          //' of the contact forces of interface '//to_text(model%contacts(i)%id) &
          //instant_text(state)//' is beyond all measure', status_run)
        return
      end associate
    end do
  end subroutine name_bad_contact

  !> Find the element at fault. The nodes have moved on since its forces were formed: a
  !> stress that is not finite has spoilt the corners that neighbours share, so stresses
  !> are looked at before areas.
  subroutine name_bad_chunk(model, state, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: what
    integer :: look, slot, first, last

    do look = 1, 3
      do slot = 1, model%layout%n_slot
        if (model%layout%slot_element(slot) == 0) cycle
        what = fault_of(model, state, slot, look)
        if (len(what) == 0) cycle
        call blame(model, state, slot, what, error)
        if (index(what, 'negative') == 1) error%message = error%message//remedy
        return
      end do
    end do
    ! The element under the largest stress of those whose chunk has done work beyond all measure.
    associate (work => abs(state%elements%deviatoric_work) + abs(state%elements%hourglass_work))
      first = (maxloc(work, 1) - 1)*chunk_size + 1
      last = min(first + chunk_size - 1, model%layout%n_slot)
      if (any(work > 0.5_wp*most_work)) call blame(model, state, first - 1 &
        + maxloc(maxval(abs(state%elements%deviator(first:last, :)), 2), 1, &
        model%layout%slot_element(first:last) > 0), 'work beyond all measure', error)
    end associate
    if (.not. allocated(error)) call raise(error, &
      'negative area or values that are not finite'//instant_text(state), status_run)
  end subroutine name_bad_chunk

  !> What is wrong with an element, in three looks: stresses, the area, and an equation of state
  !> that has next to no bound at its volume; nothing where all is well.
  function fault_of(model, state, slot, look) result(what)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: slot, look
    character(:), allocatable :: what
    real(wp) :: ratio
    integer :: i_chunk, first

    what = ''
    select case (look)
    case (1)
      if (.not. all(abs(state%elements%deviator(slot, :)) <= huge(ratio))) &
        what = 'values that are not finite'
    case (2)
      if (is_gone(state%elements, slot)) return
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
    end select
  end function fault_of

  !> The error that names the element in a slot.
  subroutine blame(model, state, slot, what, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: slot
    character(*), intent(in) :: what
    type(error_t), allocatable, intent(out) :: error

    call raise(error, trim(what)//' in '//element_text(model, slot)//instant_text(state), &
      status_run)
  end subroutine blame

  !> An element with its part.
  pure function element_text(model, slot) result(text)
    type(model_t), intent(in) :: model
    integer, intent(in) :: slot
    character(:), allocatable :: text

    text = 'element '//to_text(model%mesh%element_id(model%layout%slot_element(slot))) &
      //' of part '//to_text(model%parts(slot_part(model%layout, slot))%id)
  end function element_text

  !> Where a run is.
  pure function instant_text(state) result(text)
    type(state_t), intent(in) :: state
    character(:), allocatable :: text

    text = ' at cycle '//to_text(state%cycle)//', time '//to_text(state%time)
  end function instant_text

  !> The step must stay above its floor: DTMIN of *CONTROL_TERMINATION, and in any case a millionth
  !> of the first step (such a run would never end) and what the time can still resolve.
  subroutine check_step(controls, first_dt, time, dt, error)
    type(controls_t), intent(in) :: controls
    real(wp), intent(in) :: first_dt, time, dt
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: floor_dt

    floor_dt = max(controls%dt_floor, 1.0e-6_wp)*first_dt
    if (dt >= floor_dt .and. dt > 4.0_wp*spacing(time)) return
    call raise(error, 'the time step '//to_text(dt)//' at time '//to_text(time) &
      //' fell below its floor '//to_text(floor_dt)//' (DTMIN times the first step, at least a ' &
      //'millionth of it)', status_run)
  end subroutine check_step

  !> What a step below its floor owes to an element that collapses, whose volume no step lets change
  !> by much.
  subroutine name_collapsed(model, state, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(error_t), intent(inout) :: error
    real(wp) :: ratio, smallest
    integer :: slot, worst

    smallest = 0.1_wp
    worst = 0
    do slot = 1, model%layout%n_slot
      if (model%layout%slot_element(slot) == 0) cycle
      if (is_gone(state%elements, slot)) cycle
      ratio = smallest_ratio(model, state%motion, state%elements, slot)
      if (ratio >= smallest) cycle
      smallest = ratio
      worst = slot
    end do
    if (worst == 0) return
    error%message = error%message//'; '//element_text(model, worst)//' has collapsed to V/V0 ' &
      //to_text(smallest)//remedy
  end subroutine name_collapsed

  !> Cycles are counted no further than a default integer reaches.
  subroutine check_cycle(cycle, time, error)
    integer, intent(in) :: cycle
    real(wp), intent(in) :: time
    type(error_t), allocatable, intent(out) :: error

    if (cycle < huge(cycle)) return
    call raise(error, 'cycle '//to_text(cycle)//' at time '//to_text(time) &
      //' is the last that can be counted: a run has to end before', status_run)
  end subroutine check_cycle

  !> Energies must be finite; where the deck sets ENDENG the energy ratio must stay within so many
  !> per cent of one, and contact must not have made more than that of the largest energy.
  subroutine check_energy(controls, energies, maker, error)
    type(controls_t), intent(in) :: controls
    type(energies_t), intent(in) :: energies
    character(*), intent(in) :: maker !! `made_by_springs` or `made_by_forces`: what `made` measures
    type(error_t), allocatable, intent(out) :: error

    if (.not. abs(total_energy(energies)) <= huge(1.0_wp)) then
      call raise(error, 'the total energy is not finite', status_run)
    else if (controls%energy_limit > 0.0_wp .and. &
      abs(energy_ratio(energies) - 1.0_wp) > 0.01_wp*controls%energy_limit) then
      call raise(error, 'the energy ratio '//to_text(energy_ratio(energies)) &
        //' changed by more than '//to_text(controls%energy_limit)//' per cent (ENDENG)', &
        status_run)
    else if (controls%energy_limit > 0.0_wp .and. &
      energies%made > 0.01_wp*controls%energy_limit*largest_energy(energies)) then
      call raise(error, maker//to_text(energies%made)//' of ' &
        //to_text(largest_energy(energies))//', more than '//to_text(controls%energy_limit) &
        //' per cent (ENDENG); the penalty or the time step is too large', status_run)
    end if
  end subroutine check_energy

  !> Warn of the first energies of a run that do not add up, while it goes on: a run that ends by an
  !> error is not judged at its end. What is missing is measured by the energy that came in or is
  !> stored; short waves may take twice the band for a while.
  subroutine check_ratio(energies, spent, cause, cycle, time, warned, log)
    type(energies_t), intent(in) :: energies
    real(wp), intent(in) :: spent    !! energy that may go without an account, J/m
    character(*), intent(in) :: cause !! `unaccounted` or `dissipated`
    integer, intent(in) :: cycle
    real(wp), intent(in) :: time     !! s
    logical, intent(inout) :: warned !! already
    type(log_t), intent(inout) :: log

    if (warned) return
    warned = abs(energy_ratio(energies) - 1.0_wp) > 2.0_wp*ratio_band .and. &
      abs(unexplained(energies, spent)) > 2.0_wp*ratio_band*largest_energy(energies)
    if (warned) call warn(log, 'at cycle '//to_text(cycle)//', time '//to_text(time) &
      //', the energy ratio is '//to_text(energy_ratio(energies))//': '//cause)
  end subroutine check_ratio

  !> Energy that has come in, or gone beyond what may go without an account (minus), J/m.
  pure function unexplained(energies, spent) result(energy)
    type(energies_t), intent(in) :: energies
    real(wp), intent(in) :: spent !! J/m
    real(wp) :: energy

    energy = total_energy(energies) - energies%initial - energies%external_work
    if (energy < 0.0_wp) energy = min(0.0_wp, energy + spent)
  end function unexplained

  !> Warn of a static step that has lost work: the body has jumped from one equilibrium to another,
  !> and what it would have had as kinetic energy is gone. The trapezoidal rule misses less than a
  !> hundredth of the work of a step that follows the path.
  subroutine check_static_step(work, held, spent, cycle, time, log)
    real(wp), intent(in) :: work(2)           !! done from outside, before and after the step, J/m
    real(wp), intent(in) :: held(2)           !! stored or dissipated, the same
    real(wp), intent(in) :: spent             !! energy that may go without an account, J/m
    integer, intent(in) :: cycle
    real(wp), intent(in) :: time              !! s
    type(log_t), intent(inout) :: log
    real(wp) :: change(2)

    change = [work(2) - work(1), held(2) - held(1)]
    if (change(1) - change(2) - spent <= max(ratio_band*maxval(abs(change)), &
      noticed*max(abs(work(2)), abs(held(2))))) return
    call warn(log, 'step '//to_text(cycle)//' to time '//to_text(time)//' has passed a limit ' &
      //'point, or is far too long: of the work '//to_text(change(1))//' of the loads ' &
      //to_text(change(2))//' is stored or dissipated, the rest would be motion; '//what_would_do)
  end subroutine check_static_step

  !> Warn of nodes of an axisymmetric run that have passed the axis, once.
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
    if (warned) call warn(log, to_text(n)//' node(s) have passed through the axis by cycle ' &
      //to_text(state%cycle)//', time '//to_text(state%time)//', node ' &
      //to_text(model%mesh%node_id(last))//' to the radius '//to_text(least) &
      //': no body of revolution does that, what follows means nothing')
  end subroutine check_radii

  !> The largest of what came in and what is stored, to measure others by.
  pure function largest_energy(energies) result(largest)
    type(energies_t), intent(in) :: energies
    real(wp) :: largest

    largest = max(abs(energies%initial), abs(energies%external_work), energies%internal)
  end function largest_energy

  !> A warning at the end of an implicit run whose contact forces have made energy. There the work
  !> of a step is a trapezium between two equilibria, in which a gap may close: no more than 5 % is
  !> worth a word.
  subroutine warn_of_contact_energy(energies, log)
    type(energies_t), intent(in) :: energies
    type(log_t), intent(inout) :: log

    if (energies%made > 0.05_wp*largest_energy(energies)) call warn(log, made_by_forces &
      //to_text(energies%made)//' of '//to_text(largest_energy(energies))//'; the penalty or the ' &
      //'time step is too large, or places of the slave came in deep beside the end of a surface ' &
      //'(SRCH limits that)')
  end subroutine warn_of_contact_energy

  !> Warnings at the end of a run whose figures deserve a second look, or do not add up.
  subroutine warn_of_energies(energies, spent, cause, log)
    type(energies_t), intent(in) :: energies
    real(wp), intent(in) :: spent     !! energy that may go without an account, J/m
    character(*), intent(in) :: cause !! `unaccounted` or `dissipated`
    type(log_t), intent(inout) :: log

    if (energies%hourglass > 0.1_wp*max(energies%internal, 1.0e-6_wp*largest_energy(energies))) &
      call warn(log, &
      'the hourglass energy '//to_text(energies%hourglass)//' is more than 10 % of the internal ' &
      //'energy '//to_text(energies%internal))
    if (abs(energy_ratio(energies) - 1.0_wp) > ratio_band .and. abs(unexplained(energies, spent)) &
      > ratio_band*abs(energies%initial + energies%external_work)) call warn(log, &
      'the energy ratio ends at '//to_text(energy_ratio(energies))//': '//cause)
  end subroutine warn_of_energies

end module health_m
