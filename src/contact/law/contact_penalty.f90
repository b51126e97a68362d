! SPDX-License-Identifier: MIT
!> From the penalty of the deck to the stiffness of the springs.
module contact_penalty_m
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t, penalty_per_node, penalty_distributed, penalty_factor, &
    penalty_share, penalty_implicit, is_tied
  use controls_m, only : controls_t
  use element_finder_m, only : initial_length, area_behind
  use kinds_m, only : wp
  use model_m, only : model_t
  use rigids_m, only : mark_rigid_nodes
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: set_penalties, rigid_factor, built_in_penalty, side_stiffness, &
    mean_length, spread_of_stiffness, has_default_penalty

  !> Times K L/A of the softer side: implicit springs of a rigid slave without compliance.
  real(wp), parameter :: rigid_factor = 1000.0_wp

contains

  !> Whether the penalty is the built-in one and nothing has scaled it: SFACT, PEN and SLSFAC at
  !> their defaults. Ties have one of their own.
  pure function has_default_penalty(contact, controls) result(has)
    type(contact_t), intent(in) :: contact
    type(controls_t), intent(in) :: controls
    logical :: has
    type(controls_t) :: default

    has = contact%penalty_unit == penalty_factor &
      .and. .not. is_tied(contact) .and. .not. abs(contact%penalty - 1.0_wp) > 0.0_wp &
      .and. .not. abs(contact%master_penalty - 1.0_wp) > 0.0_wp &
      .and. .not. abs(controls%penalty_scale - default%penalty_scale) > 0.0_wp
  end function has_default_penalty

  !> All equivalents of the penalty. The rule eps_hat = eps/l (Kang, Lee & Shin 2023) with the mean
  !> segment length of the initial mesh converts; l is that of the slave surface for eps_hat of the
  !> slave pass and for eps of type 1, that of the master surface for eps_hat of the master pass. A
  !> share of the largest stable penalty stands as it is until the step is known.
  pure subroutine set_penalties(contact, model, self_share, memory)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: self_share !! part that either pass of a surface with itself has
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: master_value, estimate, factor

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
    case (penalty_implicit)
      ! Below 0: no compliance, which 0 stands for. Rows of a rigid slave may depend on others, and
      ! those of nodes that are fixed or prescribed before a rigid master.
      factor = max(0.0_wp, contact%penalty)
      if (.not. factor > 0.0_wp .and. (is_rigid(contact%slave, model) .or. (is_rigid( &
        contact%master, model) .and. is_held(contact%slave, model)))) factor = rigid_factor
      memory%slave_penalty = factor*softer_side(contact, model)
      memory%master_penalty = memory%slave_penalty
    end select
    if (contact%penalty_unit /= penalty_per_node) then
      memory%slave_penalty = contact%thickness*memory%slave_penalty
      memory%master_penalty = contact%thickness*memory%master_penalty
    end if
    ! Each pair of runs meets twice, either one being the slave once.
    if (contact%is_self) memory%slave_penalty = self_share*memory%slave_penalty
    memory%node_penalty = memory%slave_penalty*mean_length(contact%slave, model)
  end subroutine set_penalties

  !> Whether nodes of a surface belong to a rigid body.
  pure logical function is_rigid(surface, model)
    type(surface_t), intent(in) :: surface
    type(model_t), intent(in) :: model
    logical :: of_body(model%mesh%n_node)

    of_body = mark_rigid_nodes(model%rigids, model%mesh%n_node)
    is_rigid = any(of_body(surface%nodes))
  end function is_rigid

  !> Whether nodes of a surface are fixed or prescribed along x or y.
  pure logical function is_held(surface, model)
    type(surface_t), intent(in) :: surface
    type(model_t), intent(in) :: model
    logical :: of_conditions(model%mesh%n_node)

    of_conditions = .false.
    of_conditions(model%conditions%fixed_nodes) = .true.
    of_conditions(model%conditions%motions%node) = .true.
    is_held = any(of_conditions(surface%nodes))
  end function is_held

  !> The built-in estimate of the distributed penalty, N/m^2: SLSFAC K L/A of the softer side.
  pure function built_in_penalty(contact, model) result(estimate)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    real(wp) :: estimate

    estimate = model%controls%penalty_scale*softer_side(contact, model)
  end function built_in_penalty

  !> K L/A of the softer side, N/m^2.
  pure function softer_side(contact, model) result(stiffness)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    real(wp) :: stiffness

    stiffness = min(side_stiffness(contact%slave, model), side_stiffness(contact%master, model))
  end function softer_side

  !> Mean length of the segments of a surface at time zero, m.
  pure function mean_length(surface, model) result(length)
    type(surface_t), intent(in) :: surface
    type(model_t), intent(in) :: model
    real(wp) :: length
    integer :: i

    length = 0.0_wp
    do i = 1, surface%n_segment
      length = length + initial_length(model, surface, i)
    end do
    length = length/surface%n_segment
  end function mean_length

  !> K L/A of one side, N/m^2: bulk modulus and area of the element behind each segment, mean with
  !> K L over the sum of squares of the element's sides as weight. Elements of one size and material
  !> so count by length; what is coarse or soft beside others and is not touched counts little, and
  !> a sliver no more than its neighbours.
  pure function side_stiffness(surface, model) result(stiffness)
    type(surface_t), intent(in) :: surface
    type(model_t), intent(in) :: model
    real(wp) :: stiffness
    real(wp) :: x(2, 4), weight, total
    integer :: i

    stiffness = 0.0_wp
    total = 0.0_wp
    do i = 1, surface%n_segment
      associate (element => surface%segment_element(i), length => initial_length(model, surface, i))
        associate (bulk => model%materials(model%parts(model%mesh%element_part(element))%material) &
          %bulk)
          x = model%mesh%coordinates(:, model%mesh%element_nodes(:, element))
          weight = bulk*length/sum((x - cshift(x, 1, 2))**2)
          stiffness = stiffness + weight*bulk*length/area_behind(model, surface, i)
          total = total + weight
        end associate
      end associate
    end do
    stiffness = stiffness/total
  end function side_stiffness

  !> Largest bulk modulus behind a surface over the smallest.
  pure function spread_of_stiffness(surface, model) result(ratio)
    type(surface_t), intent(in) :: surface
    type(model_t), intent(in) :: model
    real(wp) :: ratio
    real(wp) :: low, high
    integer :: i

    low = huge(1.0_wp)
    high = 0.0_wp
    do i = 1, surface%n_segment
      associate (part => model%parts(model%mesh%element_part(surface%segment_element(i))))
        low = min(low, model%materials(part%material)%bulk)
        high = max(high, model%materials(part%material)%bulk)
      end associate
    end do
    ratio = huge(1.0_wp)
    if (low > 0.0_wp) ratio = high/low
  end function spread_of_stiffness

end module contact_penalty_m
