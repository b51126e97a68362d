! SPDX-License-Identifier: MIT
!> Friction of an interface (doc/theory/contact.md, section 6.2): slip of each site in a step, and
!> the tractions of all points from it. Only where the deck asks for friction.
module friction_m
  use contact_state_m, only : contact_state_t, contact_points_t, n_side, site_at
  use contacts_m, only : contact_t, friction_rule_t
  use law_state_m, only : friction_memory_t, is_open, sticks, slips
  use kinds_m, only : wp
  use law_friction_m, only : coefficient_of, has_decay, sliding_speed, return_traction, &
    holds_on
  use tributary_lengths_m, only : nodal_area
  use contact_scatter_m, only : average_values, share_out
  implicit none
  private
  public :: start_trial_slip, take_trial_motion, store_previous_tractions, form_tractions, &
    has_slipped, let_hold, slip_of

  !> One site in a step.
  type :: slider_t
    integer :: site                   !! on the lists of friction
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

  !> Before the points of a trial of an implicit step are placed: friction goes on from the last
  !> converged step.
  pure subroutine start_trial_slip(dt, memory)
    real(wp), intent(in) :: dt                       !! of the step, s
    type(contact_state_t), intent(inout) :: memory

    memory%scratch%dt = dt
    memory%friction%force = 0.0_wp
    call store_previous_tractions(memory)
  end subroutine start_trial_slip

  !> The displacements that it goes on with: all of the step.
  pure subroutine take_trial_motion(motion, memory)
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node) u, and u minus that of the start
                                                     !! of the step
    type(contact_state_t), intent(inout) :: memory

    memory%scratch%increment = motion(3:4, memory%nodes)
  end subroutine take_trial_motion

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
  pure subroutine store_previous_tractions(memory)
    type(contact_state_t), intent(inout) :: memory
    real(wp), allocatable :: traction(:)
    integer, allocatable :: state(:)

    call move_alloc(memory%scratch%previous_traction, traction)
    call move_alloc(memory%friction%traction, memory%scratch%previous_traction)
    call move_alloc(traction, memory%friction%traction)
    call move_alloc(memory%scratch%previous_state, state)
    call move_alloc(memory%friction%state, memory%scratch%previous_state)
    call move_alloc(state, memory%friction%state)
    memory%friction%traction = 0.0_wp
    memory%friction%state = is_open
    memory%friction%stored = 0.0_wp
  end subroutine store_previous_tractions

  !> Tractions of all points, whose pressures are those of the springs alone.
  pure subroutine form_tractions(contact, has_unit_area, dt, memory)
    type(contact_t), intent(in) :: contact
    logical, intent(in) :: has_unit_area !! pressures are forces, N/m
    real(wp), intent(in) :: dt           !! step that led to u, s
    type(contact_state_t), intent(inout) :: memory

    if (memory%has%nodal_pressure) then
      call tractions_at_slave_nodes(contact%friction, dt, memory)
    else if (memory%has%segment_points) then
      call tractions_at_virtual_nodes(contact, dt, memory)
    else
      call tractions_at_points(contact, has_unit_area, dt, memory)
    end if
  end subroutine form_tractions

  !> Types 1, 2, 3 and 5: each point is a site. A master node that was none of the points then
  !> starts from what the two ends of its slave segment had (of nothing it would lose that part of
  !> the shear), and goes on sliding where one of them slid.
  pure subroutine tractions_at_points(contact, has_unit_area, dt, memory)
    type(contact_t), intent(in) :: contact
    logical, intent(in) :: has_unit_area
    real(wp), intent(in) :: dt
    type(contact_state_t), intent(inout) :: memory
    type(slider_t) :: slider
    integer :: p

    associate (points => memory%points, rule => contact%friction, scratch => memory%scratch)
      if (rule%most > 0.0_wp) slider%most = rule%most
      do p = 1, points%n
        slider%site = site_at(memory, memory%points, p)
        slider%slip = slip_at(memory, p)
        call read_previous(memory, slider)
        if (slider%before == is_open) then
          associate (nodes => points%slave_nodes(:, p))
            slider%previous = sum(points%slave_weights(:, p)*scratch%previous_traction(nodes))
            if (any(scratch%previous_state(nodes) == slips)) slider%before = slips
          end associate
        end if
        slider%pressure = points%pressure(p)
        slider%stiffness = rule%stiffness*points%stiffness(p)
        if (has_unit_area .and. rule%most > 0.0_wp) slider%most = rule%most*nodal_area( &
          contact%slave, memory%positions(:, :memory%n_slave), .false., slider%site)
        call return_slider(rule, [dt, scratch%lag], slider)
        points%traction(p) = slider%traction + slider%drag
        call store_state(slider, points%area(p), scratch%nodal(1, slider%site), memory%friction)
      end do
    end associate
  end subroutine tractions_at_points

  !> Type 4, and whatever presses at points between nodes: virtual nodes, with the projection of
  !> each; all its sub-segments, which follow each other in the order of the points in contact, have
  !> its traction.
  pure subroutine tractions_at_virtual_nodes(contact, dt, memory)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: dt
    type(contact_state_t), intent(inout) :: memory
    type(slider_t) :: slider
    real(wp) :: weights(n_side), none
    integer :: nodes(n_side), point, k, p, last

    last = 0
    associate (points => memory%points, rule => contact%friction, &
      status => memory%slave_status)
      if (rule%most > 0.0_wp) slider%most = rule%most
      slider%stiffness = rule%stiffness*memory%slave_penalty
      do k = 1, status%n_active
        point = status%active_points(k)
        p = last + 1
        last = last_sub_segment(points, p)
        slider%site = site_at(memory, memory%points, p)
        nodes = memory%n_slave + contact%master%segments(:, status%segment(point))
        weights = [1.0_wp - status%xi(point), status%xi(point)]
        slider%slip = slip_of(points%slave_nodes(1, p), points%slave_weights(1, p), nodes, &
          weights, points%normal(1, p), points%gap(p), memory%scratch%increment, memory%positions)
        call read_previous(memory, slider)
        slider%pressure = points%pressure(p)
        call return_slider(rule, [dt, memory%scratch%lag], slider)
        points%traction(p:last) = slider%traction + slider%drag
        call store_state(slider, sum(points%area(p:last)), none, memory%friction)
      end do
    end associate
  end subroutine tractions_at_virtual_nodes

  !> The last sub-segment of a point: another one has another node or stands elsewhere on its
  !> segment.
  pure function last_sub_segment(points, first) result(last)
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: first
    integer :: last

    do last = first, points%n - 1
      if (points%slave_nodes(1, last + 1) /= points%slave_nodes(1, first)) return
      if (abs(points%slave_weights(2, last + 1) - points%slave_weights(2, first)) > 0.0_wp) return
    end do
  end function last_sub_segment

  !> Types 6 and 7: slave nodes, with slips averaged as gaps are.
  pure subroutine tractions_at_slave_nodes(rule, dt, memory)
    type(friction_rule_t), intent(in) :: rule
    real(wp), intent(in) :: dt
    type(contact_state_t), intent(inout) :: memory
    type(slider_t) :: slider
    real(wp) :: acting(memory%n_slave) !! N/m^2
    real(wp) :: none
    integer :: p, i

    if (rule%most > 0.0_wp) slider%most = rule%most
    slider%stiffness = rule%stiffness*memory%slave_penalty
    acting = 0.0_wp
    associate (points => memory%points, nodal => memory%scratch%nodal)
      do p = 1, points%n
        points%traction(p) = slip_at(memory, p)
      end do
      call average_values(points, points%traction, memory%n_slave, nodal)
      do i = 1, memory%n_slave
        if (.not. memory%node_pressure(i) > 0.0_wp) cycle
        slider%site = i
        slider%slip = nodal(1, i)
        call read_previous(memory, slider)
        slider%pressure = memory%node_pressure(i)
        call return_slider(rule, [dt, memory%scratch%lag], slider)
        acting(i) = slider%traction + slider%drag
        call store_state(slider, nodal(2, i), none, memory%friction)
      end do
      call share_out(points%n, points%slave_nodes, points%slave_weights, acting, points%traction)
    end associate
  end subroutine tractions_at_slave_nodes

  !> What a site had before the step.
  pure subroutine read_previous(memory, slider)
    type(contact_state_t), intent(in) :: memory
    type(slider_t), intent(inout) :: slider

    slider%previous = memory%scratch%previous_traction(slider%site)
    slider%before = memory%scratch%previous_state(slider%site)
  end subroutine read_previous

  !> Slip of a step of a point on the list, m.
  pure function slip_at(memory, p) result(slip)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: p
    real(wp) :: slip

    associate (points => memory%points)
      slip = slip_of(points%slave_nodes(1, p), points%slave_weights(1, p), &
        points%master_nodes(1, p), points%master_weights(1, p), points%normal(1, p), &
        points%gap(p), memory%scratch%increment, memory%positions)
    end associate
  end function slip_at

  !> Slip of a step of the slave side of a point over its master side, along t = (-n_y, n_x), m: the
  !> motion of the projection over the segment that has the normal, L d(xi) (doc/theory/contact.md,
  !> section 6.2). That segment is the master's, or the slave's where the master side is one node.
  !> Its second term takes off what the turn of that segment moves at a distance; without it a
  !> rotation of all would slip.
  pure function slip_of(slave_nodes, slave_weights, master_nodes, master_weights, normal, gap, &
      du, positions) result(slip)
    integer, intent(in) :: slave_nodes(n_side), master_nodes(n_side)
    real(wp), intent(in) :: slave_weights(n_side), master_weights(n_side)
    real(wp), intent(in) :: normal(2), gap      !! m
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
      + gap*(t(2)*change(1) - t(1)*change(2))/max(t(1)*t(1) + t(2)*t(2), tiny(1.0_wp))
  end function slip_of

  !> Traction and state of a site after a step.
  pure subroutine return_slider(rule, times, slider)
    type(friction_rule_t), intent(in) :: rule
    real(wp), intent(in) :: times(2) !! the step and the lag of what is damped, s
    type(slider_t), intent(inout) :: slider
    real(wp) :: limit

    slider%drag = 0.0_wp
    slider%traction = 0.0_wp
    if (.not. slider%pressure > 0.0_wp) return
    limit = min(coefficient_of(rule, 0.0_wp)*slider%pressure, slider%most)
    call return_traction(slider%previous + slider%stiffness*slider%slip, limit, slider%traction, &
      slider%state)
    if (has_decay(rule) .and. times(1) > 0.0_wp .and. slider%stiffness > 0.0_wp) &
      call slow_down(rule, times, limit, slider)
  end subroutine return_slider

  !> The traction of a site that slides, at the speed of its sliding, and damping of one that
  !> sticks and did so before, up to its limit. A damped site slides where its spring and both
  !> together are beyond the limit, so that tractions do not jump between the two.
  pure subroutine slow_down(rule, times, limit, slider)
    type(friction_rule_t), intent(in) :: rule
    real(wp), intent(in) :: times(2) !! the step and the lag of what is damped, s
    real(wp), intent(in) :: limit    !! of what sticks, N/m^2
    type(slider_t), intent(inout) :: slider
    real(wp) :: trial, damped, speed

    trial = slider%previous + slider%stiffness*slider%slip
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
  end subroutine slow_down

  !> What a site remembers of a step, and what its spring holds. Further points at one site, of a
  !> node where bodies lie over each other, go on from what it had, and leave it their mean.
  pure subroutine store_state(slider, area, total, friction)
    type(slider_t), intent(in) :: slider
    real(wp), intent(in) :: area     !! of the points, m
    real(wp), intent(inout) :: total !! area of the site so far, m; set by its first point
    type(friction_memory_t), intent(inout) :: friction

    if (.not. slider%pressure > 0.0_wp) return
    friction%stored = friction%stored + area*slider%traction**2/(2.0_wp*slider%stiffness)
    associate (traction => friction%traction(slider%site), state => friction%state(slider%site))
      if (state == is_open) then
        friction%slip(slider%site) = friction%slip(slider%site) + slider%slip
        traction = slider%traction
        state = slider%state
        total = area
        return
      end if
      if (total + area > 0.0_wp) then
        traction = (total*traction + area*slider%traction)/(total + area)
      else
        traction = slider%traction
      end if
      state = max(slider%state, state)
      total = total + area
    end associate
  end subroutine store_state

end module friction_m
