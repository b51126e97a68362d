! SPDX-License-Identifier: MIT
!> Friction of an interface (doc/theory/contact.md, section 6.2): slip of each place in a step, and
!> the tractions of all points from it. Only where the deck asks for friction.
module friction_m
  use contact_state_m, only : contact_state_t, contact_points_t, n_side
  use contacts_m, only : contact_t, friction_rule_t
  use friction_block_m, only : rubs_t, find_former, find_before, rub_block
  use friction_sides_m, only : sides_t, find_portions, take_portions, take_feet, &
    n_block
  use friction_slips_m, only : find_slips
  use law_state_m, only : friction_memory_t, is_open, sticks, slips
  use kinds_m, only : wp
  use law_friction_m, only : has_decay
  use lengths_m, only : competence_length
  use nodal_average_m, only : average_more, share_out
  implicit none
  private
  public :: start_trial_slip, take_trial_motion, set_tractions_aside, rub_places, place_of_point, &
    place_at, spot_at, has_slipped, let_stick

contains

  !> Before the points of a trial of an implicit step are placed: friction goes on from the last
  !> converged step.
  pure subroutine start_trial_slip(dt, memory)
    real(wp), intent(in) :: dt                       !! of the step, s
    type(contact_state_t), intent(inout) :: memory

    memory%scratch%dt = dt
    memory%friction%force = 0.0_wp
    call set_tractions_aside(memory)
  end subroutine start_trial_slip

  !> The displacements that it goes on with: all of the step.
  pure subroutine take_trial_motion(motion, memory)
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node) u, and u minus that of the start
                                                     !! of the step
    type(contact_state_t), intent(inout) :: memory

    memory%scratch%increment = motion(3:4, memory%nodes)
  end subroutine take_trial_motion

  !> Whether any place slipped at the end of the last step.
  pure function has_slipped(contacts)
    type(contact_state_t), intent(in) :: contacts(:)
    logical :: has_slipped
    integer :: i

    has_slipped = .false.
    do i = 1, size(contacts)
      if (allocated(contacts(i)%friction%state)) &
        has_slipped = has_slipped .or. any(contacts(i)%friction%state == slips)
    end do
  end function has_slipped

  !> All places that slipped stick in the first tangent of a step.
  pure subroutine let_stick(contacts)
    type(contact_state_t), intent(inout) :: contacts(:)
    integer :: i

    do i = 1, size(contacts)
      if (.not. allocated(contacts(i)%scratch%former_state)) cycle
      associate (state => contacts(i)%scratch%former_state)
        where (state == slips) state = sticks
      end associate
    end do
  end subroutine let_stick

  !> Before the points are placed: all places are open until they are found to be pressed. Tractions
  !> and states trade places with those of the call before.
  pure subroutine set_tractions_aside(memory)
    type(contact_state_t), intent(inout) :: memory
    real(wp), allocatable :: traction(:)
    integer, allocatable :: state(:)

    call move_alloc(memory%scratch%former_traction, traction)
    call move_alloc(memory%friction%traction, memory%scratch%former_traction)
    call move_alloc(traction, memory%friction%traction)
    call move_alloc(memory%scratch%former_state, state)
    call move_alloc(memory%friction%state, memory%scratch%former_state)
    call move_alloc(state, memory%friction%state)
    memory%friction%traction = 0.0_wp
    memory%friction%state = is_open
    memory%friction%stored = 0.0_wp
  end subroutine set_tractions_aside

  !> Tractions of all points, whose pressures are those of the springs alone.
  pure subroutine rub_places(contact, has_unit_area, dt, memory)
    type(contact_t), intent(in) :: contact
    logical, intent(in) :: has_unit_area !! pressures are forces, N/m
    real(wp), intent(in) :: dt           !! step that led to u, s
    type(contact_state_t), intent(inout) :: memory

    if (allocated(memory%node_pressure)) then
      call rub_slave_nodes(contact%friction, dt, memory)
    else if (allocated(memory%spots)) then
      call rub_virtual_nodes(contact, dt, memory)
    else
      call rub_points(contact, has_unit_area, dt, memory)
    end if
  end subroutine rub_places

  !> Types 1, 2, 3 and 5: each point is a place.
  pure subroutine rub_points(contact, has_unit_area, dt, memory)
    type(contact_t), intent(in) :: contact
    logical, intent(in) :: has_unit_area
    real(wp), intent(in) :: dt
    type(contact_state_t), intent(inout) :: memory
    type(rubs_t) :: rubs
    integer :: first, last, n, k

    if (contact%friction%most > 0.0_wp) rubs%most = contact%friction%most
    associate (points => memory%points, scratch => memory%scratch)
      do first = 1, points%n, n_block
        last = min(first + n_block - 1, points%n)
        n = last - first + 1
        call find_slips(n, points%slave_nodes(1, first), points%slave_weights(1, first), &
          points%master_nodes(1, first), points%master_weights(1, first), &
          points%normal(1, first), points%gap(first), scratch%increment, memory%places, rubs%slip)
        call find_former(n, points%slave_nodes(1, first), points%slave_weights(1, first), &
          points%master_nodes(1, first), scratch%former_traction, scratch%former_state, &
          rubs%place, rubs%former)
        if (has_decay(contact%friction)) call find_before(n, points%slave_nodes(1, first), &
          rubs%place, scratch%former_state, rubs%before)
        rubs%pressure(:n) = points%pressure(first:last)
        rubs%stiffness(:n) = contact%friction%stiffness*points%stiffness(first:last)
        if (has_unit_area .and. contact%friction%most > 0.0_wp) then
          do k = 1, n
            rubs%most(k) = contact%friction%most*competence_length(contact%slave, &
              memory%places(:, :memory%n_slave), rubs%place(k))
          end do
        end if
        call rub_block(contact%friction, n, dt, scratch%lag, rubs)
        call leave_tractions(n, rubs, has_decay(contact%friction), points%area(first), &
          points%traction(first), scratch%nodal, memory%friction)
      end do
    end associate
  end subroutine rub_points

  !> Leave tractions to points and to their places.
  pure subroutine leave_tractions(n, rubs, is_damped, area, traction, total, friction)
    integer, intent(in) :: n
    type(rubs_t), intent(in) :: rubs
    logical, intent(in) :: is_damped          !! points have a drag beside
    real(wp), intent(in) :: area(n)           !! of the points, m
    real(wp), intent(inout) :: traction(n)    !! of the points, N/m^2
    real(wp), intent(inout) :: total(2, *)    !! scratch of all places: (1, :) their areas, m
    type(friction_memory_t), intent(inout) :: friction
    integer :: k

    do k = 1, n
      traction(k) = merge(rubs%traction(k), 0.0_wp, rubs%pressure(k) > 0.0_wp)
    end do
    friction%stored = friction%stored + stored_by(n, area, traction, rubs%stiffness)
    if (is_damped) traction = traction + rubs%drag(:n)
    do k = 1, n
      if (.not. rubs%pressure(k) > 0.0_wp) cycle
      associate (place => rubs%place(k))
        if (friction%state(place) == is_open) then
          call leave_traction(rubs, k, friction)
          total(1, place) = area(k)
        else
          call leave_mean(area(k), rubs, k, total(1, place), friction)
        end if
      end associate
    end do
  end subroutine leave_tractions

  !> What tangential springs hold, J/m.
  pure function stored_by(n, area, traction, stiffness) result(stored)
    integer, intent(in) :: n
    real(wp), intent(in) :: area(n), traction(n), stiffness(n)
    real(wp) :: stored
    integer :: k

    stored = 0.0_wp
    !$omp simd reduction(+:stored)
    do k = 1, n
      stored = stored + area(k)*traction(k)**2/(2.0_wp*stiffness(k))
    end do
  end function stored_by

  !> What a place remembers of a step.
  pure subroutine leave_traction(rubs, k, friction)
    type(rubs_t), intent(in) :: rubs
    integer, intent(in) :: k
    type(friction_memory_t), intent(inout) :: friction

    associate (place => rubs%place(k))
      friction%slip(place) = friction%slip(place) + rubs%slip(k)
      friction%traction(place) = rubs%traction(k)
      friction%state(place) = rubs%state(k)
    end associate
  end subroutine leave_traction

  !> The same of a further point at one place (a node between two runs): all of them go on from what
  !> it had, and leave it their mean.
  pure subroutine leave_mean(area, rubs, k, total, friction)
    real(wp), intent(in) :: area     !! of the point, m
    type(rubs_t), intent(in) :: rubs
    integer, intent(in) :: k
    real(wp), intent(inout) :: total !! area of the place so far, m
    type(friction_memory_t), intent(inout) :: friction

    associate (place => rubs%place(k), mean => friction%traction(rubs%place(k)))
      if (total + area > 0.0_wp) then
        mean = (total*mean + area*rubs%traction(k))/(total + area)
      else
        mean = rubs%traction(k)
      end if
      friction%state(place) = max(rubs%state(k), friction%state(place))
    end associate
    total = total + area
  end subroutine leave_mean

  !> The place of a point at a node, slave or master.
  pure function place_of_point(points, p) result(place)
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: p
    integer :: place

    place = points%slave_nodes(1, p)
    if (place /= points%slave_nodes(2, p)) place = points%master_nodes(1, p)
  end function place_of_point

  !> The place of a point at a node or at a virtual node.
  pure function place_at(memory, p) result(place)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: p
    integer :: place

    place = place_of_point(memory%points, p)
    if (.not. allocated(memory%spots)) return
    associate (n => size(memory%spot_xi), points => memory%points)
      place = n*(points%slave_nodes(1, p) - 1) + spot_at(points%slave_weights(2, p), memory%spot_xi)
    end associate
  end function place_at

  !> Type 4, and whatever presses at spots between nodes: virtual nodes, with the foot of each; all
  !> its portions, which follow each other in the order of the spots in contact, have its traction.
  pure subroutine rub_virtual_nodes(contact, dt, memory)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: dt
    type(contact_state_t), intent(inout) :: memory
    type(rubs_t) :: rubs
    integer :: portions(n_block + 1) !! the first of each spot, and the first beyond
    integer :: first, n, k

    if (contact%friction%most > 0.0_wp) rubs%most = contact%friction%most
    rubs%stiffness = contact%friction%stiffness*memory%slave_penalty
    portions(1) = 1
    do first = 1, memory%slave_tracking%n_touching, n_block
      n = min(n_block, memory%slave_tracking%n_touching - first + 1)
      associate (points => memory%points)
        call find_portions(n, points%n, points%slave_nodes, points%slave_weights, portions)
        call find_spot_slips(contact, memory, first, n, portions, rubs)
        do k = 1, n
          rubs%former(k) = memory%scratch%former_traction(rubs%place(k))
          rubs%pressure(k) = points%pressure(portions(k))
        end do
        if (has_decay(contact%friction)) &
          rubs%before(:n) = memory%scratch%former_state(rubs%place(:n))
        call rub_block(contact%friction, n, dt, memory%scratch%lag, rubs)
        do k = 1, n
          if (rubs%pressure(k) > 0.0_wp) then
            call leave_traction(rubs, k, memory%friction)
          else
            rubs%traction(k) = 0.0_wp
          end if
        end do
        call share_tractions(n, portions, rubs, has_decay(contact%friction), points%area, &
          points%traction, memory%friction%stored)
      end associate
      portions(1) = portions(n + 1)
    end do
  end subroutine rub_virtual_nodes

  !> Tractions of the portions of some spots, and what their springs hold.
  pure subroutine share_tractions(n, portions, rubs, is_damped, area, traction, stored)
    integer, intent(in) :: n, portions(n + 1)
    type(rubs_t), intent(in) :: rubs
    logical, intent(in) :: is_damped       !! points have a drag beside
    real(wp), intent(in) :: area(*)        !! of all points, m
    real(wp), intent(inout) :: traction(*) !! of all points, N/m^2
    real(wp), intent(inout) :: stored      !! J/m
    real(wp) :: density
    integer :: k, p

    do k = 1, n
      density = rubs%traction(k)**2/(2.0_wp*rubs%stiffness(k))
      do p = portions(k), portions(k + 1) - 1
        traction(p) = rubs%traction(k)
        stored = stored + area(p)*density
        if (is_damped) traction(p) = traction(p) + rubs%drag(k)
      end do
    end do
  end subroutine share_tractions

  !> Which of the spots of a segment stands at xi.
  pure function spot_at(xi, spot_xi) result(q)
    real(wp), intent(in) :: xi, spot_xi(:)
    integer :: q, i

    q = 1
    do i = 2, size(spot_xi)
      if (abs(spot_xi(i) - xi) < abs(spot_xi(q) - xi)) q = i
    end do
  end function spot_at

  !> Places and slips of some spots in contact: what the first portion of each has, but on the
  !> master the foot of the spot.
  pure subroutine find_spot_slips(contact, memory, first, n, portions, rubs)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: first        !! on the list of spots in contact
    integer, intent(in) :: n
    integer, intent(in) :: portions(n)  !! the first of each
    type(rubs_t), intent(inout) :: rubs
    type(sides_t) :: sides
    integer :: k

    associate (points => memory%points, tracking => memory%slave_tracking)
      call take_portions(n, portions, points%slave_nodes, points%slave_weights, points%normal, &
        points%gap, sides)
      call take_feet(n, tracking%touching(first), tracking%segment, tracking%xi, &
        contact%master%segments, memory%n_slave, sides)
      associate (m => size(memory%spot_xi))
        do k = 1, n
          rubs%place(k) = m*(sides%slave_nodes(1, k) - 1) + 1 &
            + mod(tracking%touching(first + k - 1) - 1, m)
        end do
      end associate
    end associate
    call find_slips(n, sides%slave_nodes, sides%slave_weights, sides%master_nodes, &
      sides%master_weights, sides%normal, sides%gap, memory%scratch%increment, memory%places, &
      rubs%slip)
  end subroutine find_spot_slips

  !> Types 6 and 7: slave nodes, with slips averaged as gaps are.
  pure subroutine rub_slave_nodes(rule, dt, memory)
    type(friction_rule_t), intent(in) :: rule
    real(wp), intent(in) :: dt
    type(contact_state_t), intent(inout) :: memory
    type(rubs_t) :: rubs
    real(wp), allocatable :: drag(:) !! (n_slave) only where there is one
    integer :: i, n

    if (has_decay(rule)) allocate (drag(memory%n_slave), source=0.0_wp)
    associate (points => memory%points, nodal => memory%scratch%nodal)
      call find_slips(points%n, points%slave_nodes, points%slave_weights, points%master_nodes, &
        points%master_weights, points%normal, points%gap, memory%scratch%increment, &
        memory%places, points%traction)
      call average_more(points, points%traction, memory%n_slave, nodal)
      rubs%stiffness = rule%stiffness*memory%slave_penalty
      if (rule%most > 0.0_wp) rubs%most = rule%most
      n = 0
      do i = 1, memory%n_slave
        if (memory%node_pressure(i) > 0.0_wp) then
          n = n + 1
          rubs%place(n) = i
          rubs%slip(n) = nodal(1, i)
          rubs%former(n) = memory%scratch%former_traction(i)
          rubs%pressure(n) = memory%node_pressure(i)
        end if
        if (n < n_block .and. i < memory%n_slave) cycle
        if (has_decay(rule)) rubs%before(:n) = memory%scratch%former_state(rubs%place(:n))
        call rub_nodes(rule, n, [dt, memory%scratch%lag], nodal, rubs, memory%friction)
        if (allocated(drag)) drag(rubs%place(:n)) = rubs%drag(:n)
        n = 0
      end do
      if (allocated(drag)) then
        call share_out(points%n, points%slave_nodes, points%slave_weights, &
          memory%friction%traction(:memory%n_slave) + drag, points%traction)
      else
        call share_out(points%n, points%slave_nodes, points%slave_weights, &
          memory%friction%traction, points%traction)
      end if
    end associate
  end subroutine rub_slave_nodes

  !> Some of them, all pressed.
  pure subroutine rub_nodes(rule, n, times, nodal, rubs, friction)
    type(friction_rule_t), intent(in) :: rule
    integer, intent(in) :: n
    real(wp), intent(in) :: times(2)    !! the step and the lag of what is damped, s
    real(wp), intent(in) :: nodal(2, *) !! of all slave nodes: (2, :) areas, m
    type(rubs_t), intent(inout) :: rubs
    type(friction_memory_t), intent(inout) :: friction
    integer :: k

    call rub_block(rule, n, times(1), times(2), rubs)
    do k = 1, n
      call leave_traction(rubs, k, friction)
      friction%stored = friction%stored + nodal(2, rubs%place(k))*rubs%traction(k)**2 &
        /(2.0_wp*rubs%stiffness(k))
    end do
  end subroutine rub_nodes

end module friction_m
