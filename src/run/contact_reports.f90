! SPDX-License-Identifier: MIT
!> Log of the interfaces at the start and at the end of a run.
module contact_reports_m
  use contact_facets_m, only : report_facets
  use error_indicator_m, only : parts_at_surfaces, of_noise
  use contact_log_m, only : report_end, report_initial_contact, report_tie_step
  use contacts_m, only : contact_t, is_tied, penalty_factor, penalty_share, penalty_implicit
  use contact_step_limit_m, only : spring_bound_t, bound_springs, stable_step, closed_step, &
    opening_step, binding_bound, fitting_scale, sharpness
  use controls_m, only : controls_t, contact_step_free, contact_step_rules
  use kinds_m, only : wp
  use law_state_m, only : contact_estimate_t
  use log_m, only : log_t, warn, write_log, to_text, percent, two_decimals
  use model_m, only : model_t, is_sheet
  use state_m, only : state_t
  use units_m, only : per_depth
  implicit none
  private
  public :: report_contact_start, report_contact_end

  !> Round-off of the step bound that an automatic penalty (PUNIT 3) was chosen for.
  real(wp), parameter :: round_off = 1.0e-12_wp
  !> Springs that store more than this multiple of the elements' energy are soft.
  real(wp), parameter :: soft = 2.0_wp
  !> Waves are reported where the static part of the squared estimate is below this share.
  real(wp), parameter :: wave_share = 0.9_wp
  !> Share of the internal energy of the bodies above which stored spring energy is reported.
  real(wp), parameter :: noticed_part = 0.1_wp
  !> Compliance of springs over that of a row of elements on either side, below which stiffer
  !> springs gain little; an advised penalty goes to half of it at most.
  real(wp), parameter :: stiff = 0.5_wp
  !> Ratio of bulk moduli that makes one body hard against the other: 10, less round-off.
  real(wp), parameter :: much_harder = 9.999_wp

contains

  !> Report initial penetrations and, in explicit runs, penalties that require a smaller step than
  !> `state%dt`. A warning, except for the default penalty where the violation lies within the
  !> uncertainty of the bound.
  subroutine report_contact_start(model, state, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(log_t), intent(inout) :: log
    type(spring_bound_t) :: bounds(size(model%contacts))
    real(wp) :: element_limit, limit
    logical :: limits_step
    integer :: i

    limits_step = model%controls%contact_step /= contact_step_free &
      .and. .not. model%controls%implicit%is_on
    element_limit = minval(state%elements%time_limit)
    if (.not. model%controls%implicit%is_on .and. (limits_step .or. any(is_tied(model%contacts)))) &
      call bound_springs(model%contacts, state%contact_mass, state%contacts, &
      merge(0.0_wp, 1.0_wp, model%contacts%penalty_unit == penalty_implicit), bounds)
    do i = 1, size(model%contacts)
      associate (contact => model%contacts(i))
        if (state%contacts(i)%has%contact) &
          call report_initial_contact(contact, model, state%contacts(i), log)
        if (.not. is_tied(contact)) then
          if (limits_step .and. contact%penalty_unit /= penalty_implicit) &
            call report_step_limit(model, state, i, element_limit, bounds(i), log)
        else if (limits_step) then
          call report_tie_step(contact%id, element_limit, stable_step(element_limit, bounds(i)), &
            log)
        else if (.not. model%controls%implicit%is_on) then
          limit = closed_step(element_limit, bounds(i))
          if (state%dt > limit*(1.0_wp + round_off)) call warn(log, 'interface ' &
            //to_text(contact%id)//': the time step '//to_text(state%dt)//' exceeds the ' &
            //'stability limit of its ties '//to_text(limit)//' (ECDT 1 of *CONTROL_CONTACT ' &
            //'ignores springs): energy may grow without bound')
        end if
      end associate
    end do
  end subroutine report_contact_start

  !> Report the step limit of the springs of an interface: that the step follows it, or that the
  !> step exceeds it, with node, bound and the penalty that would be stable. No warning for the
  !> default penalty where the violation lies within the uncertainty of the bound.
  subroutine report_step_limit(model, state, i, element_limit, bound, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: i              !! the interface
    real(wp), intent(in) :: element_limit !! s
    type(spring_bound_t), intent(in) :: bound
    type(log_t), intent(inout) :: log
    type(controls_t) :: default
    character(:), allocatable :: name
    logical :: is_usual

    name = 'interface '//to_text(model%contacts(i)%id)//': '
    associate (contact => model%contacts(i), dt => state%dt, &
      limit => stable_step(element_limit, bound))
      if (state%contacts(i)%rules_step) call write_log(log, name//'the time step ' &
        //'follows its springs, since penalty and step have their defaults: stable step ' &
        //to_text(limit)//', of the elements alone '//to_text(element_limit)//'; a penalty of ' &
        //to_text(fitting_scale(model%controls%dt_scale*element_limit, element_limit, bound)) &
        //' times this one would be stable at the step of the elements')
      if (dt <= limit*(1.0_wp + round_off)) return
      is_usual = contact%penalty_unit == penalty_factor &
        .and. max(contact%penalty, contact%master_penalty) <= 1.0_wp &
        .and. model%controls%penalty_scale <= default%penalty_scale
      if (.not. dt < element_limit) then
        call warn(log, name//'the time step '//to_text(dt)//' exceeds the stability limit ' &
          //'of the elements '//to_text(element_limit)//' and admits no contact springs')
      else if (is_usual .and. dt*sharpness <= limit) then
        call write_log(log, name//'the time step '//to_text(dt)//' exceeds '//to_text(limit) &
          //', the bound of '//binding_bound(element_limit, bound)//', within the uncertainty of ' &
          //'that bound for the default penalty; ECDT 2 of *CONTROL_CONTACT, or ' &
          //to_text(fitting_scale(dt, element_limit, bound))//' times the penalty, satisfies it')
      else
        call warn(log, name//'its penalty requires a time step of at most '//to_text(limit) &
          //', the bound of '//binding_bound(element_limit, bound)//' (while they stay closed ' &
          //to_text(closed_step(element_limit, bound))//', where they open and close ' &
          //to_text(opening_step(bound))//', elements alone '//to_text(element_limit) &
          //', springs of all contacts at its nodes alone ' &
          //to_text(closed_step(huge(1.0_wp), bound))//' at node ' &
          //to_text(model%mesh%node_id(bound%node))//'), the step is '//to_text(dt) &
          //'; a penalty of '//to_text(fitting_scale(dt, element_limit, bound)) &
          //' times the present one would be stable')
      end if
    end associate
  end subroutine report_step_limit

  !> Report the error estimate of each interface that was loaded at a sampled instant, soft springs,
  !> facets that govern the pressure, excluded first contacts, failed ties, and dissipation by
  !> friction. Implicit springs without compliance store nothing.
  subroutine report_contact_end(model, state, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(log_t), intent(inout) :: log
    integer :: i

    do i = 1, size(state%estimates)
      associate (contact => model%contacts(i), estimate => state%estimates(i))
        if (.not. estimate%load > 0.0_wp) cycle
        call write_log(log, 'interface '//to_text(contact%id)//': '//words(estimate, state, i))
        if (contact%target > 0.0_wp) call write_log(log, 'interface '//to_text(contact%id)//': ' &
          //target_words(contact, estimate))
      end associate
    end do
    do i = 1, size(state%estimates)
      if (log%is_silent) exit ! the first process alone knows the parts of all elements
      associate (estimate => state%estimates(i), contact => model%contacts(i))
        if (contact%penalty_unit == penalty_implicit .and. &
          .not. state%contacts(i)%slave_penalty > 0.0_wp) cycle
        if (estimate%bodies > 0.0_wp .and. estimate%stored > noticed_part*estimate%bodies) &
          call report_soft_springs(model, contact, estimate, log)
        call report_facets(contact, model%controls%units, estimate, log)
      end associate
    end do
    do i = 1, size(model%contacts)
      call report_end(model%contacts(i), model%controls%units, state%contacts(i), log)
      associate (friction => state%contacts(i)%friction)
        if (abs(friction%work) > 0.0_wp) call write_log(log, 'interface ' &
          //to_text(model%contacts(i)%id)//': friction has dissipated ' &
          //to_text(friction%work - friction%stored) &
          //per_depth(model%controls%units, 'F L', model%is_axisymmetric, is_sheet(model)))
      end associate
    end do
  end subroutine report_contact_end

  !> The error estimate of an interface in words.
  function words(estimate, state, i) result(text)
    type(contact_estimate_t), intent(in) :: estimate
    type(state_t), intent(in) :: state
    integer, intent(in) :: i
    character(:), allocatable :: text

    text = 'contact pressure and the stress behind it differ by ' &
      //percent(sqrt(estimate%misfit), sqrt(estimate%load))//' (r.m.s., ' &
      //'instants: '//to_text(estimate%n)//'), by '//percent(estimate%at_heaviest, 1.0_wp) &
      //' at the largest load'
    if (has_waves(estimate)) text = text//', without waves by ' &
      //percent(sqrt(estimate%still), sqrt(estimate%load))
    if (estimate%rows > 0.0_wp) then
      text = text//'; springs store '//two_decimals(estimate%springs/estimate%rows) &
        //' times the energy of the elements at the surface'
      if (estimate%springs > soft*estimate%rows) text = text//', the penalty is soft'
    end if
    if (estimate%forces > 0.0_wp) text = text//'; noise of the force ' &
      //percent(sqrt(estimate%jumps/of_noise), sqrt(estimate%forces))//' between instants'
    if (state%largest_energy > 0.0_wp) text = text//'; contact ' &
      //trim(merge('created', 'lost   ', state%contacts(i)%monitor%balance < 0.0_wp))//' ' &
      //percent(abs(state%contacts(i)%monitor%balance), state%largest_energy) &
      //' of the largest energy'
    if (estimate%least_margin < huge(1.0_wp)) text = text//'; the time step is ' &
      //percent(1.0_wp, estimate%least_margin)//' of the stable step'
  end function words

  !> Whether the target was reached, and if not whether waves prevent it or what finds a type and a
  !> mesh that do.
  pure function target_words(contact, estimate) result(text)
    type(contact_t), intent(in) :: contact
    type(contact_estimate_t), intent(in) :: estimate
    character(:), allocatable :: text
    real(wp) :: at_rest

    text = 'the target '//percent(contact%target, 1.0_wp)//' is '
    if (sqrt(estimate%misfit/estimate%load) <= contact%target) then
      text = text//'reached'
      return
    end if
    text = text//'not reached; '
    at_rest = sqrt(estimate%still/estimate%load)
    if (at_rest <= contact%target) then
      text = text//'waves prevent it, the static part is '//percent(at_rest, 1.0_wp)
      return
    end if
    if (has_waves(estimate)) text = text//'the static part is '//percent(at_rest, 1.0_wp)//'; '
    text = text//'slideline-tools answer DECK --of QUANTITY --within X% --choose ' &
      //'finds type and mesh'
  end function target_words

  !> Whether inertia of the elements at the surface is a notable part of the estimate.
  elemental function has_waves(estimate) result(has)
    type(contact_estimate_t), intent(in) :: estimate
    logical :: has

    has = estimate%still < wave_share*estimate%misfit
  end function has_waves

  !> Report an interface whose springs stored much energy. Between bodies of similar stiffness the
  !> rebound is that of softer bodies. Between a hard and a soft body the springs return energy that
  !> the soft body would have kept in part, and the rebound is too fast: a warning, unless the
  !> springs are stiff against the elements, which then are too coarse. The advised penalty stores
  !> no more than the noticed share: at a given force spring energy varies with stiffness^-1, in
  !> impacts of a hard on a soft block with stiffness^-0.64 or less on coarse meshes.
  subroutine report_soft_springs(model, contact, estimate, log)
    type(model_t), intent(in) :: model
    type(contact_t), intent(in) :: contact
    type(contact_estimate_t), intent(in) :: estimate
    type(log_t), intent(inout) :: log
    character(:), allocatable :: text
    integer, allocatable :: behind(:) !! materials of the parts at the surfaces
    real(wp) :: softest, hardest, factor, wanted
    logical :: is_wrong
    integer :: i

    behind = pack([model%parts%material], parts_at_surfaces(model, contact))
    softest = huge(1.0_wp)
    hardest = 0.0_wp
    do i = 1, size(behind)
      softest = min(softest, model%materials(behind(i))%bulk)
      hardest = max(hardest, model%materials(behind(i))%bulk)
      if (model%materials(behind(i))%is_rigid) hardest = huge(1.0_wp)
    end do
    text = 'finer elements would store a larger part'
    if (estimate%softness > stiff) then
      factor = min((estimate%stored/(noticed_part*estimate%bodies))**2, &
        2.0_wp*estimate%softness/stiff)
      wanted = factor*contact%penalty
      text = 'use PEN '//to_text(wanted)
      if (contact%penalty_unit == penalty_factor) text = 'use SFACT '//to_text(wanted) &
        //', or PEN with PUNIT 2'
      if (contact%penalty_unit == penalty_share .and. wanted > 1.0_wp) text = &
        'use a penalty '//to_text(factor)//' times as large'
      if (.not. model%controls%implicit%is_on .and. model%controls%contact_step &
        /= contact_step_rules) text = text//', with the step of the springs (ECDT 2 of ' &
        //'*CONTROL_CONTACT)'
    end if
    is_wrong = estimate%softness > stiff .and. hardest >= much_harder*softest
    if (is_wrong) text = 'the springs return all of it, of which the soft body would ' &
      //'dissipate a part: penetration and rebound of the hard body are too large; '//text
    text = 'interface '//to_text(contact%id)//': its springs stored up to ' &
      //to_text(estimate%stored)//', '//percent(estimate%stored, estimate%bodies) &
      //' of the largest internal energy of the bodies on both sides, ' &
      //to_text(estimate%bodies)//trim(merge(': ', '; ', is_wrong))//' '//text
    if (is_wrong) then
      call warn(log, text)
    else
      call write_log(log, text)
    end if
  end subroutine report_soft_springs

end module contact_reports_m
