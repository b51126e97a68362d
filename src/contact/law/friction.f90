! SPDX-License-Identifier: MIT
!> Friction of an interface (doc/theory/contact.md, section 6.2): slip of each site in a step, and
!> the tractions of all points from it, of tangential springs that slip at a limit (regularised
!> Coulomb). Only where the deck asks for friction.
module friction_m
  use arcs_m, only : is_flat
  use nodal_forces_m, only : average_values, share_out
  use contact_state_m, only : contact_state_t, contact_scratch_t, n_side, site_at
  use contacts_m, only : contact_t, friction_rule_t
  use dual_m, only : dual_t, operator(+), operator(-), operator(*)
  use geometry_m, only : separation
  use kinds_m, only : wp
  use law_state_m, only : friction_memory_t, is_open, sticks, slips
  use projection_m, only : round_off
  use surfaces_m, only : surface_t
  use tributary_lengths_m, only : nodal_area
  implicit none
  private
  public :: store_previous_tractions, form_tractions, has_slipped, let_hold, coefficient_of, &
    has_decay, sliding_speed, slider_t, return_slider, linearise_traction, goes_on, slip_of, &
    node_beyond

  !> What slips on in the first tangent of a step, in which nothing has moved yet.
  integer, parameter :: goes_on = -1
  !> What slips where the tangent of slipping is singular: its spring stands for it.
  integer, parameter :: holds_on = -2

  !> Passes of Newton's method for the speed of sliding. Where two roots all but meet each halves
  !> the error.
  integer, parameter :: most_passes = 100

  !> One site in a step.
  type :: slider_t
    integer :: site                   !! on the lists of friction
    real(wp) :: area                  !! that it stands for, m
    real(wp) :: slip                  !! of the step, m
    real(wp) :: previous              !! traction before, N/m^2
    integer :: before                 !! state before
    real(wp) :: stiffness             !! tangential, N/m^3
    real(wp) :: pressure              !! N/m^2
    real(wp) :: most = huge(1.0_wp)   !! largest traction whatever the pressure, N/m^2
    real(wp) :: traction              !! after the step, N/m^2
    integer :: state                  !! the same
    real(wp) :: drag                  !! traction of the damping of what sticks, N/m^2
  end type slider_t

contains

  !> Whether any site slipped at the end of the last step.
  pure function has_slipped(contacts)
    type(contact_state_t), intent(in) :: contacts(:)
    logical :: has_slipped
    integer :: i

    has_slipped = .false.
    do i = 1, size(contacts)
      if (contacts(i)%has%friction) &
        has_slipped = has_slipped .or. any(contacts(i)%friction%state == slips)
    end do
  end function has_slipped

  !> All sites that slip or slipped hold on in the next tangent, wherever round-off puts them
  !> beside the limit: a body all of whose sites slip meets no stiffness along the face.
  pure subroutine let_hold(contacts)
    type(contact_state_t), intent(inout) :: contacts(:)
    integer :: i

    do i = 1, size(contacts)
      if (.not. contacts(i)%has%friction) cycle
      associate (previous => contacts(i)%scratch%previous_state)
        where (previous == slips .or. contacts(i)%friction%state == slips) previous = holds_on
      end associate
    end do
  end subroutine let_hold

  !> Before the points are generated: all sites are open until they are found to be loaded.
  !> Tractions and states are exchanged with those of the call before.
  pure subroutine store_previous_tractions(friction, scratch)
    type(friction_memory_t), intent(inout) :: friction
    type(contact_scratch_t), intent(inout) :: scratch
    real(wp), allocatable :: traction(:)
    integer, allocatable :: state(:)

    call move_alloc(scratch%previous_traction, traction)
    call move_alloc(friction%traction, scratch%previous_traction)
    call move_alloc(traction, friction%traction)
    call move_alloc(scratch%previous_state, state)
    call move_alloc(friction%state, scratch%previous_state)
    call move_alloc(state, friction%state)
    friction%traction = 0.0_wp
    friction%state = is_open
  end subroutine store_previous_tractions

  !> Tractions of all points, whose pressures are those of the springs alone. Each point is a site;
  !> in types 6 and 7 slave nodes are, with slips averaged as gaps are.
  pure subroutine form_tractions(contact, dt, memory)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: dt !! step that led to u, s
    type(contact_state_t), intent(inout) :: memory
    type(slider_t) :: slider
    integer :: i

    call find_slips(contact, memory)
    associate (points => memory%points, rule => contact%friction, lag => memory%scratch%lag, &
      acting => memory%scratch%at_sites)
      if (rule%most > 0.0_wp) slider%most = rule%most
      if (memory%has%nodal_pressure) then
        call average_values(points, points%traction, memory%n_slave, memory%scratch%nodal)
        do i = 1, memory%n_slave
          call read_node(rule, memory, i, slider)
          call return_slider(rule, [dt, lag], slider)
          acting(i) = slider%traction + slider%drag
          call store_state(slider, memory)
        end do
        call share_out(points%n, points%slave_nodes, points%slave_weights, acting, points%traction)
        return
      end if
      do i = 1, points%n
        call read_point(rule, memory, i, slider)
        if (memory%has%unit_area .and. rule%most > 0.0_wp) slider%most = rule%most*nodal_area( &
          contact%slave, memory%positions(:, :memory%n_slave), .false., slider%site)
        call return_slider(rule, [dt, lag], slider)
        points%traction(i) = slider%traction + slider%drag
        call store_state(slider, memory)
      end do
    end associate
  end subroutine form_tractions

  !> Slips of all points, which wait where tractions will be. All sub-segments of a virtual node
  !> have that of its projection.
  pure subroutine find_slips(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: weights(n_side), distance
    integer :: nodes(n_side), p, point, beyond
    logical :: is_curved

    associate (points => memory%points, status => memory%slave_status)
      do p = 1, points%n
        nodes = points%master_nodes(:, p)
        weights = points%master_weights(:, p)
        if (memory%has%virtual_nodes) then
          point = site_at(memory, points, p)
          nodes = memory%n_slave + contact%master%segments(:, status%segment(point))
          weights = [1.0_wp - status%xi(point), status%xi(point)]
        end if
        is_curved = memory%has%arcs
        if (is_curved) is_curved = .not. is_flat(memory%arcs%shape(nodes(1)))
        if (is_curved .and. memory%has%virtual_nodes) weights = weights_along( &
          points%slave_nodes(:, p), points%slave_weights(:, p), nodes, points%normal(:, p), &
          memory%positions)
        beyond = 0
        if (.not. is_curved .and. .not. abs(weights(1)*weights(2)) > 0.0_wp) &
          beyond = node_beyond(contact, memory, nodes, weights(2), points%normal(:, p))
        distance = points%gap(p)
        if (memory%has%arcs) distance = distance_along(points%slave_nodes(:, p), &
          points%slave_weights(:, p), nodes, weights, points%normal(:, p), memory%positions)
        points%traction(p) = slip_of(points%slave_nodes(1, p), points%slave_weights(1, p), &
          nodes, weights, points%normal(1, p), distance, memory%scratch%increment, &
          memory%positions)
        if (beyond == 0) cycle
        ! On a vertex the mean of the turns of both segments counts.
        nodes = merge([beyond, nodes(1)], [nodes(2), beyond], weights(1) > 0.5_wp)
        points%traction(p) = 0.5_wp*(points%traction(p) + slip_of(points%slave_nodes(1, p), &
          points%slave_weights(1, p), nodes, weights([2, 1]), points%normal(1, p), distance, &
          memory%scratch%increment, memory%positions))
      end do
    end associate
  end subroutine find_slips

  !> The other node of the neighbour of a segment at a vertex that is the projection of a point,
  !> with a normal that is not that of the segment; 0: none.
  pure function node_beyond(contact, memory, nodes, xi, normal) result(node)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: nodes(n_side)  !! of the segment, local numbers
    real(wp), intent(in) :: xi, normal(2) !! projection on it
    integer :: node
    real(wp) :: t(2)

    node = 0
    if (nodes(1) == nodes(2)) return
    t = separation(memory%positions(:, nodes(2)), memory%positions(:, nodes(1)))
    if (dot_product(normal, t)**2 <= round_off**2*dot_product(t, t)) return
    if (nodes(1) > memory%n_slave) then
      node = beside(contact%master, nodes - memory%n_slave, xi)
      if (node > 0) node = node + memory%n_slave
    else
      node = beside(contact%slave, nodes, xi)
    end if

  contains

    !> The other node of the neighbour of a segment of a surface.
    pure integer function beside(surface, nodes, xi)
      type(surface_t), intent(in) :: surface
      integer, intent(in) :: nodes(n_side)
      real(wp), intent(in) :: xi

      beside = merge(surface%incoming(nodes(1)), surface%outgoing(nodes(2)), xi < 0.5_wp)
      if (beside > 0) beside = surface%segments(merge(1, 2, xi < 0.5_wp), beside)
    end function beside

  end function node_beyond

  !> Weights of the projection of a virtual node along the normal of an arc.
  pure function weights_along(slave_nodes, slave_weights, master_nodes, normal, positions) &
      result(weights)
    integer, intent(in) :: slave_nodes(n_side), master_nodes(n_side)
    real(wp), intent(in) :: slave_weights(n_side), normal(2)
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    real(wp) :: weights(n_side)
    real(wp) :: d(2), t(2)

    d = separation(positions(:, slave_nodes(1)), positions(:, master_nodes(1))) &
      + slave_weights(2)*separation(positions(:, slave_nodes(2)), positions(:, slave_nodes(1)))
    t = separation(positions(:, master_nodes(2)), positions(:, master_nodes(1)))
    weights(2) = (normal(1)*d(2) - normal(2)*d(1))/(normal(1)*t(2) - normal(2)*t(1))
    weights(1) = 1.0_wp - weights(2)
  end function weights_along

  !> Distance of both sides of a point along its normal, m: that of the secants, where gaps are
  !> those of arcs.
  pure function distance_along(slave_nodes, slave_weights, master_nodes, master_weights, normal, &
      positions) result(distance)
    integer, intent(in) :: slave_nodes(n_side), master_nodes(n_side)
    real(wp), intent(in) :: slave_weights(n_side), master_weights(n_side), normal(2)
    real(wp), intent(in) :: positions(:, :) !! (4, n_node) of the interface
    real(wp) :: distance
    real(wp) :: d(2)

    d = separation(positions(:, slave_nodes(1)), positions(:, master_nodes(1))) &
      + slave_weights(2)*separation(positions(:, slave_nodes(2)), positions(:, slave_nodes(1))) &
      - master_weights(2)*separation(positions(:, master_nodes(2)), positions(:, master_nodes(1)))
    distance = dot_product(d, normal)
  end function distance_along

  !> A slave node as a site, with the averages of its points.
  pure subroutine read_node(rule, memory, i, slider)
    type(friction_rule_t), intent(in) :: rule
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: i
    type(slider_t), intent(inout) :: slider

    slider%site = i
    slider%slip = memory%scratch%nodal(1, i)
    slider%area = memory%scratch%nodal(2, i)
    slider%pressure = memory%node_pressure(i)
    slider%stiffness = rule%stiffness*memory%slave_penalty
    slider%previous = memory%scratch%previous_traction(i)
    slider%before = memory%scratch%previous_state(i)
  end subroutine read_node

  !> A point as a site. A master node that was no point before starts from the tractions of the two
  !> ends of its slave segment (from zero that part of the shear would be lost), and slides where
  !> one of them slid.
  pure subroutine read_point(rule, memory, p, slider)
    type(friction_rule_t), intent(in) :: rule
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: p
    type(slider_t), intent(inout) :: slider

    associate (points => memory%points, scratch => memory%scratch)
      slider%site = site_at(memory, points, p)
      slider%slip = points%traction(p)
      slider%area = points%area(p)
      slider%pressure = points%pressure(p)
      slider%stiffness = rule%stiffness*points%stiffness(p)
      slider%previous = scratch%previous_traction(slider%site)
      slider%before = scratch%previous_state(slider%site)
      if (slider%before /= is_open .or. memory%has%segment_points) return
      associate (nodes => points%slave_nodes(:, p))
        slider%previous = sum(points%slave_weights(:, p)*scratch%previous_traction(nodes))
        if (any(scratch%previous_state(nodes) == slips)) slider%before = slips
      end associate
    end associate
  end subroutine read_point

  !> Slip of a step of the slave side of a point over its master side, along t = (-n_y, n_x), m: the
  !> motion of the projection over the segment that has the normal, L d(xi) (doc/theory/contact.md,
  !> section 6.2). That segment is the master's, or the slave's where the master side is one node.
  !> Its second term takes off what the turn of that segment moves at a distance; without it a
  !> rotation of all would slip.
  pure function slip_of(slave_nodes, slave_weights, master_nodes, master_weights, normal, &
      distance, du, positions) result(slip)
    integer, intent(in) :: slave_nodes(n_side), master_nodes(n_side)
    real(wp), intent(in) :: slave_weights(n_side), master_weights(n_side)
    real(wp), intent(in) :: normal(2), distance !! m, of both sides along the normal
    real(wp), intent(in) :: du(2, *)            !! increments of the nodes, m
    real(wp), intent(in) :: positions(4, *)     !! of the nodes
    real(wp) :: slip
    real(wp) :: relative(2), along(4), t(2), change(2)
    integer :: a, b

    a = slave_nodes(1)
    b = slave_nodes(2)
    relative = slave_weights(1)*du(:, a) + slave_weights(2)*du(:, b) &
      - master_weights(1)*du(:, master_nodes(1)) - master_weights(2)*du(:, master_nodes(2))
    if (master_nodes(1) /= master_nodes(2)) then
      a = master_nodes(1)
      b = master_nodes(2)
    end if
    along = positions(:, b) - positions(:, a)
    t = along(1:2) + along(3:4)
    change = du(:, b) - du(:, a)
    slip = normal(1)*relative(2) - normal(2)*relative(1) &
      + distance*(t(2)*change(1) - t(1)*change(2))/max(t(1)*t(1) + t(2)*t(2), tiny(1.0_wp))
  end function slip_of

  !> Traction and state of a site after a step. Where the coefficient depends on the speed, what
  !> slides has that of its speed, and what sticks and did so before is damped, up to its limit. A
  !> damped site slides where its spring and both together are beyond the limit, so that tractions
  !> do not jump between the two.
  pure subroutine return_slider(rule, times, slider)
    type(friction_rule_t), intent(in) :: rule
    real(wp), intent(in) :: times(2) !! the step and the lag of what is damped, s
    type(slider_t), intent(inout) :: slider
    real(wp) :: limit, trial, damped, speed

    slider%drag = 0.0_wp
    slider%traction = 0.0_wp
    if (.not. slider%pressure > 0.0_wp) return
    limit = min(coefficient_of(rule, 0.0_wp)*slider%pressure, slider%most)
    trial = slider%previous + slider%stiffness*slider%slip
    slider%traction = sign(min(abs(trial), limit), trial)
    slider%state = merge(slips, sticks, abs(trial) > limit)
    if (.not. (has_decay(rule) .and. times(1) > 0.0_wp .and. slider%stiffness > 0.0_wp)) return
    damped = trial
    if (slider%before == sticks) damped = trial + times(2)/times(1)*slider%stiffness*slider%slip
    speed = sliding_speed(rule, min(abs(trial), damped*sign(1.0_wp, trial)), slider%pressure, &
      slider%most, slider%stiffness*times(1), slider%before == slips .and. trial*slider%previous &
      > 0.0_wp)
    if (speed > 0.0_wp) then
      slider%traction = sign(min(coefficient_of(rule, speed)*slider%pressure, slider%most), trial)
      slider%state = slips
    else if (slider%before == sticks) then
      slider%traction = trial
      slider%state = sticks
      slider%drag = sign(min(abs(damped), limit), damped) - trial
    end if
  end subroutine return_slider

  !> What a site remembers of a step, and what its spring holds. Further points at one site, of a
  !> node where bodies lie over each other, go on from what it had, and leave it their mean.
  pure subroutine store_state(slider, memory)
    type(slider_t), intent(in) :: slider
    type(contact_state_t), intent(inout) :: memory

    if (.not. slider%pressure > 0.0_wp) return
    associate (friction => memory%friction, site => slider%site, &
      area => memory%scratch%at_sites(slider%site))
      friction%stored = friction%stored &
        + slider%area*slider%traction**2/(2.0_wp*slider%stiffness)
      if (friction%state(site) == is_open) then
        friction%slip(site) = friction%slip(site) + slider%slip
        friction%traction(site) = slider%traction
        friction%state(site) = slider%state
        if (.not. memory%has%nodal_pressure) area = slider%area
        return
      end if
      area = area + slider%area
      friction%traction(site) = friction%traction(site) + slider%area/max(area, tiny(area)) &
        *(slider%traction - friction%traction(site))
      friction%state(site) = max(slider%state, friction%state(site))
    end associate
  end subroutine store_state

  !> Coefficient of friction at a speed of sliding: FD + (FS - FD) exp(-DC speed).
  pure function coefficient_of(rule, speed) result(coefficient)
    type(friction_rule_t), intent(in) :: rule
    real(wp), intent(in) :: speed !! m/s, >= 0
    real(wp) :: coefficient

    coefficient = rule%sliding + (rule%at_rest - rule%sliding)
    ! The exponential costs as much as all the rest.
    if (rule%decay > 0.0_wp) coefficient = rule%sliding &
      + (rule%at_rest - rule%sliding)*exp(-rule%decay*speed)
  end function coefficient_of

  !> Whether the coefficient depends on the speed of sliding.
  pure function has_decay(rule)
    type(friction_rule_t), intent(in) :: rule
    logical :: has_decay

    has_decay = rule%decay > 0.0_wp .and. abs(rule%at_rest - rule%sliding) > 0.0_wp
  end function has_decay

  !> Speed of sliding of a site, m/s: that of the slip that does not come back, by v = (trial -
  !> limit(v))/stiffness with limit(v) = min(mu(v) p, most); 0 where it sticks
  !> (doc/theory/contact.md, section 6.2).
  pure function sliding_speed(rule, trial, pressure, most, stiffness, slid) result(speed)
    type(friction_rule_t), intent(in) :: rule
    real(wp), intent(in) :: trial     !! size of the trial traction, N/m^2
    real(wp), intent(in) :: pressure  !! N/m^2, > 0
    real(wp), intent(in) :: most      !! largest traction whatever the pressure, N/m^2
    real(wp), intent(in) :: stiffness !! tangential, times the step, N s/m^3, > 0
    logical, intent(in) :: slid       !! the same way in the step before
    real(wp) :: speed
    real(wp) :: x, previous, beyond, height, fall
    integer :: pass

    speed = 0.0_wp
    ! With x = DC v: x + height exp(-x) = beyond, whose left side is least at x = log(height).
    beyond = rule%decay*(trial - rule%sliding*pressure)/stiffness
    height = rule%decay*(rule%at_rest - rule%sliding)*pressure/stiffness
    if (trial <= min(coefficient_of(rule, speed)*pressure, most)) then
      if (.not. (slid .and. height > 1.0_wp)) return
      if (beyond < 1.0_wp + log(height)) return
    else if (trial > most) then
      speed = (trial - most)/stiffness
      if (coefficient_of(rule, speed)*pressure >= most) return
    end if
    ! Where the coefficient falls the left side is convex, and Newton's method comes down to its
    ! last root from the right; where it rises the left side is concave and increases, and it comes
    ! up to its only one from the left. Neither passes the root.
    x = merge(beyond, 0.0_wp, height > 0.0_wp)
    do pass = 1, most_passes
      previous = x
      fall = height*exp(-x)
      if (fall >= 1.0_wp) exit
      x = x - (x + fall - beyond)/(1.0_wp - fall)
      if (abs(x - previous) <= 2.0_wp*spacing(x)) exit
    end do
    speed = max(x, 0.0_wp)/rule%decay
  end function sliding_speed

  !> The traction of a site in contact with its derivatives. One that touches without pressure has
  !> none yet, and sticks.
  pure function linearise_traction(rule, previous, slip, pressure, stiffness, most, times, before) &
      result(traction)
    type(friction_rule_t), intent(in) :: rule
    type(dual_t), intent(in) :: previous !! traction before, N/m^2
    type(dual_t), intent(in) :: slip     !! of the step, m
    type(dual_t), intent(in) :: pressure !! N/m^2
    real(wp), intent(in) :: stiffness    !! tangential, N/m^3
    type(dual_t), intent(in) :: most     !! largest traction whatever the pressure, N/m^2
    real(wp), intent(in) :: times(2)     !! step that made the slip, and lag of what sticks, s
    integer, intent(in) :: before        !! state before; `goes_on`: at the limit, wherever the
                                         !! trial is
    type(dual_t) :: traction
    type(dual_t) :: trial, damped, limit
    real(wp) :: speed

    traction = stiffness*slip
    if (.not. pressure%value > 0.0_wp) then
      traction%value = 0.0_wp
      return
    end if
    traction = previous + traction
    trial = sign(1.0_wp, traction%value)*traction
    limit = coefficient_of(rule, 0.0_wp)*pressure
    if (most%value < limit%value) limit = most
    if (before == holds_on) then
      traction%value = sign(min(limit%value, trial%value), traction%value)
      return
    end if
    speed = 0.0_wp
    if (has_decay(rule) .and. stiffness*times(1) > 0.0_wp) then
      if (before == sticks) then
        damped = traction + (times(2)/times(1)*stiffness)*slip
        if (sign(1.0_wp, traction%value)*damped%value < trial%value) &
          trial = sign(1.0_wp, traction%value)*damped
        traction = damped
      end if
      speed = sliding_speed(rule, trial%value, pressure%value, most%value, stiffness*times(1), &
        (before == slips .or. before == goes_on) .and. traction%value*previous%value > 0.0_wp)
    end if
    if (speed > 0.0_wp) then
      limit = linearise_sliding_limit(rule, speed, trial, pressure, most, stiffness*times(1))
    else if (.not. (abs(traction%value) > limit%value .or. before == goes_on)) then
      return
    end if
    traction = sign(1.0_wp, traction%value)*limit
  end function linearise_traction

  !> The limit at a speed of sliding with its derivatives, from those of the equation that the speed
  !> solves.
  pure function linearise_sliding_limit(rule, speed, trial, pressure, most, stiffness) result(limit)
    type(friction_rule_t), intent(in) :: rule
    real(wp), intent(in) :: speed     !! m/s
    type(dual_t), intent(in) :: trial !! size of the trial traction, N/m^2
    type(dual_t), intent(in) :: pressure, most
    real(wp), intent(in) :: stiffness !! tangential, times the step, N s/m^3
    type(dual_t) :: limit
    real(wp) :: coefficient, fall

    coefficient = coefficient_of(rule, speed)
    limit = coefficient*pressure
    if (.not. most%value > limit%value) then
      limit = most
      return
    end if
    ! Not as steep as where two roots meet.
    fall = rule%decay*(coefficient - rule%sliding)*pressure%value/stiffness
    limit%slope = limit%slope - fall/max(1.0_wp - fall, sqrt(epsilon(fall))) &
      *(trial%slope - limit%slope)
  end function linearise_sliding_limit

end module friction_m
