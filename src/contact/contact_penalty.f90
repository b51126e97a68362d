! SPDX-License-Identifier: MIT
!> From the penalty of the deck to the pressure of each point.
module contact_penalty_m
  use contact_state_m, only : contact_points_t, contact_state_t, n_side
  use contacts_m, only : contact_t, penalty_per_node, penalty_distributed, penalty_factor, &
    penalty_share
  use kinds_m, only : wp
  use model_m, only : model_t
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: set_penalties, built_in_penalty, mean_length, press_points, press_each, pressures_of, &
    average_gaps, share_pressure, damp_points

contains

  !> All equivalents of the penalty. The rule eps_hat = eps/l (Kang, Lee & Shin 2023) with the mean
  !> segment length of the initial mesh converts; l is that of the slave surface for eps_hat of the
  !> slave pass and for eps of type 1, that of the master surface for eps_hat of the master pass. A
  !> share of the largest stable penalty stands as it is until the step is known.
  pure subroutine set_penalties(contact, model, memory)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: master_value, estimate

    master_value = contact%master_penalty
    if (.not. master_value > 0.0_wp) master_value = contact%penalty
    select case (contact%penalty_unit)
    case (penalty_per_node)
      memory%slave_penalty = contact%penalty/mean_length(contact%slave, model)
      memory%master_penalty = master_value/mean_length(contact%master, model)
    case (penalty_distributed, penalty_share)
      memory%slave_penalty = contact%penalty
      memory%master_penalty = master_value
    case (penalty_factor)
      estimate = built_in_penalty(contact, model)
      memory%slave_penalty = contact%penalty*estimate
      memory%master_penalty = master_value*estimate
    end select
    memory%node_penalty = memory%slave_penalty*mean_length(contact%slave, model)
  end subroutine set_penalties

  !> The built-in estimate of the distributed penalty, N/m^2: SLSFAC K L/A of the softer side.
  pure function built_in_penalty(contact, model) result(estimate)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    real(wp) :: estimate

    estimate = model%controls%penalty_scale*min(side_stiffness(contact%slave, model), &
      side_stiffness(contact%master, model))
  end function built_in_penalty

  !> Mean length of the segments of a surface at time zero, m.
  pure function mean_length(surface, model) result(length)
    type(surface_t), intent(in) :: surface
    type(model_t), intent(in) :: model
    real(wp) :: length
    integer :: i

    length = 0.0_wp
    do i = 1, surface%n_segment
      length = length + initial_length(surface, model, i)
    end do
    length = length/surface%n_segment
  end function mean_length

  !> Length of one segment at time zero, m.
  pure function initial_length(surface, model, segment) result(length)
    type(surface_t), intent(in) :: surface
    type(model_t), intent(in) :: model
    integer, intent(in) :: segment
    real(wp) :: length

    associate (ends => surface%nodes(surface%segments(:, segment)))
      length = norm2(model%mesh%coordinates(:, ends(2)) - model%mesh%coordinates(:, ends(1)))
    end associate
  end function initial_length

  !> K L/A of one side, N/m^2: bulk modulus and area of the element behind each segment, mean over
  !> the length of the surface.
  pure function side_stiffness(surface, model) result(stiffness)
    type(surface_t), intent(in) :: surface
    type(model_t), intent(in) :: model
    real(wp) :: stiffness
    real(wp) :: total, length
    integer :: i, element

    stiffness = 0.0_wp
    total = 0.0_wp
    do i = 1, surface%n_segment
      element = surface%segment_element(i)
      length = initial_length(surface, model, i)
      associate (part => model%parts(model%mesh%element_part(element)))
        stiffness = stiffness + length*model%materials(part%material)%bulk*length &
          /element_area(model, element)
      end associate
      total = total + length
    end do
    stiffness = stiffness/total
  end function side_stiffness

  !> Area of an element at time zero, m^2.
  pure function element_area(model, element) result(area)
    type(model_t), intent(in) :: model
    integer, intent(in) :: element
    real(wp) :: area
    real(wp) :: x(2, 4)

    x = model%mesh%coordinates(:, model%mesh%element_nodes(:, element))
    area = 0.5_wp*((x(1, 3) - x(1, 1))*(x(2, 4) - x(2, 2)) &
      - (x(1, 4) - x(1, 2))*(x(2, 3) - x(2, 1)))
  end function element_area

  !> Pressure of all points before damping: p = stiffness * max(0, -gap) at the point, or shared out
  !> from the slave nodes.
  pure subroutine press_points(memory)
    type(contact_state_t), intent(inout) :: memory

    if (memory%averages_pressure) then
      call average_gaps(memory%points, memory%n_slave, memory%nodal)
      call share_pressure(memory%points%n, memory%points%slave_nodes, memory%points%slave_weights, &
        memory%slave_penalty, memory%nodal, memory%points%pressure)
    else
      call press_each(memory%points%n, memory%points%stiffness, memory%points%gap, &
        memory%points%pressure)
    end if
  end subroutine press_points

  !> Pressure of points that each have their own.
  pure subroutine press_each(n, stiffness, gap, pressure)
    integer, intent(in) :: n
    real(wp), intent(in) :: stiffness(*), gap(*)
    real(wp), intent(inout) :: pressure(*)
    integer :: p

    do p = 1, n
      pressure(p) = stiffness(p)*max(0.0_wp, -gap(p))
    end do
  end subroutine press_each

  !> Pressures that the present forces come from. Where each point has its own, which nothing but
  !> its gap decides, the list need not have it.
  pure function pressures_of(contact, memory) result(pressures)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp), allocatable :: pressures(:)

    associate (points => memory%points)
      pressures = points%pressure(:points%n)
      if (memory%averages_pressure .or. contact%damping > 0.0_wp) return
      call press_each(points%n, points%stiffness, points%gap, pressures)
    end associate
  end function pressures_of

  !> What makes the pressure at slave nodes, p_A = stiffness * max(0, -g_A) with the averaged gap
  !> g_A = sum(N_A a g)/sum(N_A a); points get it by the slave shape functions (Fischer & Wriggers
  !> 2005). The forces that follow are the derivative of the energy sum of p_A^2 sum(N_A a)/(2
  !> stiffness) at frozen weights.
  pure subroutine average_gaps(points, n_slave, nodal)
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: n_slave
    real(wp), intent(inout), contiguous :: nodal(:, :) !! (2, n_slave or more) out: (1, :) max(0,
                                                       !! -g_A), m
    integer :: node

    do node = 1, n_slave
      nodal(1, node) = 0.0_wp
      nodal(2, node) = 0.0_wp
    end do
    call sum_gaps(points%n, points%slave_nodes, points%slave_weights, points%area, points%gap, &
      nodal)
    do node = 1, n_slave
      nodal(1, node) = max(0.0_wp, -nodal(1, node))/max(nodal(2, node), tiny(1.0_wp))
    end do
  end subroutine average_gaps

  !> Pressure of the points from -g_A of the slave nodes.
  pure subroutine share_pressure(n, slave_nodes, slave_weights, stiffness, nodal, pressure)
    integer, intent(in) :: n, slave_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), stiffness, nodal(2, *)
    real(wp), intent(inout) :: pressure(*)
    integer :: p

    !GCC$ NOVECTOR
    do p = 1, n
      pressure(p) = stiffness*(slave_weights(1, p)*nodal(1, slave_nodes(1, p)) &
        + slave_weights(2, p)*nodal(1, slave_nodes(2, p)))
    end do
  end subroutine share_pressure

  !> Sums of weight times area times gap, and of weight times area, by slave node. Points of one
  !> segment follow each other and are summed before they are given to the nodes.
  pure subroutine sum_gaps(n, slave_nodes, slave_weights, area, gap, nodal)
    integer, intent(in) :: n, slave_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), area(*), gap(*)
    real(wp), intent(inout) :: nodal(2, *)
    real(wp) :: gap_1, area_1, gap_2, area_2
    integer :: p
    logical :: is_last

    gap_1 = 0.0_wp; area_1 = 0.0_wp; gap_2 = 0.0_wp; area_2 = 0.0_wp
    do p = 1, n
      gap_1 = gap_1 + slave_weights(1, p)*(area(p)*gap(p))
      area_1 = area_1 + slave_weights(1, p)*area(p)
      gap_2 = gap_2 + slave_weights(2, p)*(area(p)*gap(p))
      area_2 = area_2 + slave_weights(2, p)*area(p)
      is_last = p == n
      if (.not. is_last) is_last = slave_nodes(1, p) /= slave_nodes(1, p + 1) .or. &
        slave_nodes(2, p) /= slave_nodes(2, p + 1)
      if (.not. is_last) cycle
      associate (a => slave_nodes(1, p), b => slave_nodes(2, p))
        nodal(:, a) = nodal(:, a) + [gap_1, area_1]
        nodal(:, b) = nodal(:, b) + [gap_2, area_2]
      end associate
      gap_1 = 0.0_wp; area_1 = 0.0_wp; gap_2 = 0.0_wp; area_2 = 0.0_wp
    end do
  end subroutine sum_gaps

  !> Add the damping of points in contact, -2 fraction k/omega times the opening velocity, with
  !> omega^2 = sum of w K/m over the nodes of both sides, where K is the sum of all springs at a
  !> node. For two masses and one spring it is the fraction of critical, and it does not depend on
  !> how many points share a node's spring. The total never pulls.
  pure subroutine damp_points(points, fraction, nodes, motion, mass, nodal)
    type(contact_points_t), intent(inout) :: points
    real(wp), intent(in) :: fraction
    integer, intent(in), contiguous :: nodes(:)      !! mesh index of each local node
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node) u and v
    real(wp), intent(in), contiguous :: mass(:)      !! (n_node) kg/m
    real(wp), intent(inout), contiguous :: nodal(:, :) !! (2, local nodes) scratch
    real(wp) :: rate, square, weight
    integer :: p, k, local

    call sum_springs(points, nodal)
    do p = 1, points%n
      if (.not. points%pressure(p)*points%area(p) > 0.0_wp) cycle
      rate = 0.0_wp
      square = 0.0_wp
      do k = 1, n_side
        local = points%slave_nodes(k, p)
        weight = points%slave_weights(k, p)
        rate = rate + weight*dot_product(points%normal(:, p), motion(3:4, nodes(local)))
        square = square + weight*nodal(1, local)/mass(nodes(local))
        local = points%master_nodes(k, p)
        weight = points%master_weights(k, p)
        rate = rate - weight*dot_product(points%normal(:, p), motion(3:4, nodes(local)))
        square = square + weight*nodal(1, local)/mass(nodes(local))
      end do
      points%pressure(p) = max(0.0_wp, points%pressure(p) &
        - 2.0_wp*fraction*rate*points%stiffness(p)/sqrt(square))
    end do
  end subroutine damp_points

  !> Springs of all pressed points by node, N/m, into nodal(1, :): in two passes a node stands on
  !> either side.
  pure subroutine sum_springs(points, nodal)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(inout), contiguous :: nodal(:, :)
    real(wp) :: spring
    integer :: p, k

    nodal(1, :) = 0.0_wp
    do p = 1, points%n
      if (.not. points%pressure(p) > 0.0_wp) cycle
      spring = points%stiffness(p)*points%area(p)
      do k = 1, n_side
        nodal(1, points%slave_nodes(k, p)) = nodal(1, points%slave_nodes(k, p)) &
          + points%slave_weights(k, p)*spring
        nodal(1, points%master_nodes(k, p)) = nodal(1, points%master_nodes(k, p)) &
          + points%master_weights(k, p)*spring
      end do
    end do
  end subroutine sum_springs

end module contact_penalty_m
