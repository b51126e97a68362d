! SPDX-License-Identifier: MIT
!> Friction of an interface (doc/theory/contact.md, section 6.2): slip of each place in a step, and
!> the tractions of all points from it. Only where the deck asks for friction.
module friction_m
  use contact_state_m, only : contact_state_t, contact_points_t, n_side
  use contacts_m, only : contact_t, friction_rule_t
  use friction_state_m, only : is_open, sticks, slips
  use kinds_m, only : wp
  use law_friction_m, only : coefficient_of, return_traction
  use lengths_m, only : competence_length
  use nodal_average_m, only : average_values, share_out
  use radii_m, only : centroid
  implicit none
  private
  public :: take_increments, start_trial_slip, set_tractions_aside, rub_places, &
    place_of_point, place_at, spot_at, has_slipped, let_stick

  !> Places whose slips are formed together.
  integer, parameter :: n_block = 64

  !> A place in a step.
  type :: rub_t
    real(wp) :: slip = 0.0_wp      !! of the step, m
    real(wp) :: former = 0.0_wp    !! traction before, N/m^2
    real(wp) :: pressure = 0.0_wp  !! N/m^2
    real(wp) :: stiffness = 0.0_wp !! tangential, N/m^3
    real(wp) :: most = huge(1.0_wp) !! largest traction whatever the pressure, N/m^2
  end type rub_t

contains

  !> Before the present places are taken: displacements since the last call; none after a time
  !> without contact.
  pure subroutine take_increments(motion, memory)
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node) u(n), v(n-1/2)
    type(contact_state_t), intent(inout) :: memory

    associate (increment => memory%scratch%increment)
      if (memory%is_stale) then
        increment = 0.0_wp
      else
        call take_changes(size(memory%nodes), memory%nodes, motion, memory%places, increment)
      end if
    end associate
  end subroutine take_increments

  !> On arrays of known shape.
  pure subroutine take_changes(n, nodes, motion, places, increment)
    integer, intent(in) :: n, nodes(n)
    real(wp), intent(in) :: motion(4, *), places(4, n)
    real(wp), intent(inout) :: increment(2, n)
    integer :: i

    !GCC$ NOVECTOR
    do i = 1, n
      increment(:, i) = motion(1:2, nodes(i)) - places(3:4, i)
    end do
  end subroutine take_changes

  !> Before the points of a trial of an implicit step are placed: friction goes on from the last
  !> converged step, with all motion since then.
  pure subroutine start_trial_slip(motion, dt, memory)
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node) u, and u minus that of the start
                                                     !! of the step
    real(wp), intent(in) :: dt                       !! of the step, s
    type(contact_state_t), intent(inout) :: memory

    memory%scratch%increment = motion(3:4, memory%nodes)
    memory%scratch%dt = dt
    memory%friction%force = 0.0_wp
    call set_tractions_aside(memory)
  end subroutine start_trial_slip

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

  !> Before the points are placed: all places are open until they are found to be pressed.
  pure subroutine set_tractions_aside(memory)
    type(contact_state_t), intent(inout) :: memory

    memory%scratch%former_traction(:) = memory%friction%traction
    memory%scratch%former_state(:) = memory%friction%state
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
    type(rub_t) :: rub
    integer :: p, place

    memory%scratch%nodal(1, :) = 0.0_wp
    rub%most = most_traction(contact%friction)
    call find_point_slips(memory)
    do p = 1, memory%points%n
      rub%slip = memory%points%traction(p)
      memory%points%traction(p) = 0.0_wp
      if (.not. memory%points%pressure(p) > 0.0_wp) cycle
      place = place_of_point(memory%points, p)
      associate (points => memory%points)
        rub%former = former_traction(memory, p, place)
        rub%pressure = points%pressure(p)
        rub%stiffness = contact%friction%stiffness*points%stiffness(p)
        if (has_unit_area .and. contact%friction%most > 0.0_wp) rub%most = contact%friction%most &
          *competence_length(contact%slave, memory%places(:, :memory%n_slave), place)
      end associate
      call rub_point(contact%friction, rub, dt, p, place, memory)
    end do
  end subroutine rub_points

  !> One of them. Points at one place in a step (a node between two runs) go on from what it had,
  !> and leave it their mean.
  pure subroutine rub_point(rule, rub, dt, p, place, memory)
    type(friction_rule_t), intent(in) :: rule
    type(rub_t), intent(in) :: rub
    real(wp), intent(in) :: dt
    integer, intent(in) :: p, place
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: traction, area
    integer :: state

    call rub_one(rule, rub, dt, traction, state)
    associate (friction => memory%friction, points => memory%points, &
      total => memory%scratch%nodal(1, place))
      points%traction(p) = traction
      area = points%area(p)
      friction%stored = friction%stored + area*traction**2/(2.0_wp*rub%stiffness)
      if (friction%state(place) == is_open) then
        friction%slip(place) = friction%slip(place) + rub%slip
      else if (total + area > 0.0_wp) then
        traction = (total*friction%traction(place) + area*traction)/(total + area)
      end if
      friction%traction(place) = traction
      friction%state(place) = max(state, friction%state(place))
      total = total + area
    end associate
  end subroutine rub_point

  !> Traction in the step before. A master node that was none of the points then starts from what
  !> the two ends of its slave segment had: of nothing it would lose that part of the shear.
  pure function former_traction(memory, p, place) result(traction)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: p, place
    real(wp) :: traction

    associate (former => memory%scratch%former_traction, nodes => memory%points%slave_nodes(:, p))
      traction = former(place)
      if (nodes(1) /= nodes(2) .and. memory%scratch%former_state(place) == is_open) &
        traction = sum(memory%points%slave_weights(:, p)*former(nodes))
    end associate
  end function former_traction

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
  !> its portions have its traction.
  pure subroutine rub_virtual_nodes(contact, dt, memory)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: dt
    type(contact_state_t), intent(inout) :: memory
    type(rub_t) :: rub
    real(wp) :: slips(memory%slave_tracking%n)
    integer :: p, n, q, place

    rub%most = most_traction(contact%friction)
    rub%stiffness = contact%friction%stiffness*memory%slave_penalty
    n = size(memory%spot_xi)
    call find_spot_slips(contact, memory, slips)
    do p = 1, memory%points%n
      memory%points%traction(p) = 0.0_wp
      if (.not. memory%points%pressure(p) > 0.0_wp) cycle
      associate (friction => memory%friction, points => memory%points, &
        first => memory%points%slave_nodes(1, p))
        q = spot_at(points%slave_weights(2, p), memory%spot_xi)
        place = n*(first - 1) + q
        if (friction%state(place) == is_open) then
          rub%slip = slips(n*(contact%slave%outgoing(first) - 1) + q)
          rub%former = memory%scratch%former_traction(place)
          rub%pressure = points%pressure(p)
          call rub_one(contact%friction, rub, dt, friction%traction(place), friction%state(place))
          friction%slip(place) = friction%slip(place) + rub%slip
        end if
        points%traction(p) = friction%traction(place)
        friction%stored = friction%stored + points%area(p)*points%traction(p)**2 &
          /(2.0_wp*rub%stiffness)
      end associate
    end do
  end subroutine rub_virtual_nodes

  !> Which of the spots of a segment stands at xi.
  pure function spot_at(xi, spot_xi) result(q)
    real(wp), intent(in) :: xi, spot_xi(:)
    integer :: q, i

    q = 1
    do i = 2, size(spot_xi)
      if (abs(spot_xi(i) - xi) < abs(spot_xi(q) - xi)) q = i
    end do
  end function spot_at

  !> Slips of the spots in contact, some at a time.
  pure subroutine find_spot_slips(contact, memory, slips)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(inout) :: slips(:) !! of all spots, m
    integer, dimension(n_side, n_block) :: slave_nodes, master_nodes
    real(wp), dimension(n_side, n_block) :: slave_weights, master_weights
    real(wp) :: normals(2, n_block), gaps(n_block), found(n_block)
    integer :: first, n, k, i, s, q

    associate (tracking => memory%slave_tracking, xi => memory%spot_xi)
      do first = 1, tracking%n_touching, n_block
        n = min(n_block, tracking%n_touching - first + 1)
        do k = 1, n
          i = tracking%touching(first + k - 1)
          s = 1 + (i - 1)/size(xi)
          q = i - (s - 1)*size(xi)
          slave_nodes(:, k) = contact%slave%segments(:, s)
          slave_weights(2, k) = xi(q)
          if (memory%spot_spread > 0.0_wp) slave_weights(2, k) = centroid( &
            memory%places(:, slave_nodes(1, k)), memory%places(:, slave_nodes(2, k)), &
            xi(q) - 0.5_wp*memory%spot_spread, xi(q) + 0.5_wp*memory%spot_spread)
          slave_weights(1, k) = 1.0_wp - slave_weights(2, k)
          master_nodes(:, k) = memory%n_slave + contact%master%segments(:, tracking%segment(i))
          master_weights(1, k) = 1.0_wp - tracking%xi(i)
          master_weights(2, k) = tracking%xi(i)
          normals(:, k) = tracking%normal(:, i)
          gaps(k) = tracking%gap(i)
        end do
        call find_slips(n, slave_nodes, slave_weights, master_nodes, master_weights, normals, &
          gaps, memory%scratch%increment, memory%places, found)
        do k = 1, n
          slips(tracking%touching(first + k - 1)) = found(k)
        end do
      end do
    end associate
  end subroutine find_spot_slips

  !> Types 6 and 7: slave nodes, with slips averaged as gaps are.
  pure subroutine rub_slave_nodes(rule, dt, memory)
    type(friction_rule_t), intent(in) :: rule
    real(wp), intent(in) :: dt
    type(contact_state_t), intent(inout) :: memory
    type(rub_t) :: rub
    integer :: i

    associate (friction => memory%friction, points => memory%points, nodal => memory%scratch%nodal)
      call find_point_slips(memory)
      call average_values(points, points%traction, memory%n_slave, nodal)
      rub%stiffness = rule%stiffness*memory%slave_penalty
      rub%most = most_traction(rule)
      do i = 1, memory%n_slave
        if (.not. memory%node_pressure(i) > 0.0_wp) cycle
        rub%slip = nodal(1, i)
        rub%former = memory%scratch%former_traction(i)
        rub%pressure = memory%node_pressure(i)
        call rub_one(rule, rub, dt, friction%traction(i), friction%state(i))
        friction%slip(i) = friction%slip(i) + rub%slip
        friction%stored = friction%stored + nodal(2, i)*friction%traction(i)**2 &
          /(2.0_wp*rub%stiffness)
      end do
      call share_out(points%n, points%slave_nodes, points%slave_weights, friction%traction, &
        points%traction)
    end associate
  end subroutine rub_slave_nodes

  !> Slips of all points, into their tractions.
  pure subroutine find_point_slips(memory)
    type(contact_state_t), intent(inout) :: memory

    associate (points => memory%points)
      call find_slips(points%n, points%slave_nodes, points%slave_weights, points%master_nodes, &
        points%master_weights, points%normal, points%gap, memory%scratch%increment, &
        memory%places, points%traction)
    end associate
  end subroutine find_point_slips

  !> Slips of a step of the slave sides of places over their master sides, along t = (-n_y, n_x), m:
  !> the motion of the foot over the segment that has the normal, L d(xi)
  !> (doc/theory/contact.md, section 6.2). Its second term takes off what the turn of that segment
  !> moves at a distance; without it a rotation of all would slip. That segment is the master's, or
  !> the slave's where the master side is one node.
  pure subroutine find_slips(n, slave_nodes, slave_weights, master_nodes, master_weights, normal, &
      gap, du, places, slip)
    integer, intent(in) :: n, slave_nodes(n_side, *), master_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), master_weights(n_side, *)
    real(wp), intent(in) :: normal(2, *), gap(*)
    real(wp), intent(in) :: du(2, *)      !! increments of the nodes, m
    real(wp), intent(in) :: places(4, *)  !! of the nodes
    real(wp), intent(inout) :: slip(*)
    real(wp) :: relative(2), along(4), t(2), turn(2)
    integer :: p, a, b, c, d

    !GCC$ NOVECTOR
    do p = 1, n
      a = slave_nodes(1, p)
      b = slave_nodes(2, p)
      c = master_nodes(1, p)
      d = master_nodes(2, p)
      relative = slave_weights(1, p)*du(:, a) + slave_weights(2, p)*du(:, b) &
        - master_weights(1, p)*du(:, c) - master_weights(2, p)*du(:, d)
      if (c == d) then
        c = a
        d = b
      end if
      along = places(:, d) - places(:, c)
      t = along(1:2) + along(3:4)
      turn = du(:, d) - du(:, c)
      slip(p) = normal(1, p)*relative(2) - normal(2, p)*relative(1) &
        + gap(p)*(t(2)*turn(1) - t(1)*turn(2))/max(t(1)**2 + t(2)**2, tiny(1.0_wp))
    end do
  end subroutine find_slips

  !> Largest traction of a rule whatever the pressure.
  pure function most_traction(rule) result(most)
    type(friction_rule_t), intent(in) :: rule
    real(wp) :: most

    most = huge(1.0_wp)
    if (rule%most > 0.0_wp) most = rule%most
  end function most_traction

  !> Traction and state of a place after a step.
  pure subroutine rub_one(rule, rub, dt, traction, state)
    type(friction_rule_t), intent(in) :: rule
    type(rub_t), intent(in) :: rub
    real(wp), intent(in) :: dt
    real(wp), intent(out) :: traction
    integer, intent(out) :: state
    real(wp) :: speed

    speed = 0.0_wp
    if (dt > 0.0_wp) speed = abs(rub%slip)/dt
    call return_traction(rub%former + rub%stiffness*rub%slip, &
      min(coefficient_of(rule, speed)*rub%pressure, rub%most), traction, state)
  end subroutine rub_one

end module friction_m
