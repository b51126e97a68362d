! SPDX-License-Identifier: MIT
!> A model in a freight, for processes that share a run, component by component in their order, and
!> plain types as they are. tests/house/test_model_freight.py notices what is missing.
module model_freight_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use boundary_rows_m, only : boundary_rows_t
  use conditions_m, only : conditions_t, prescribed_motion_t, nodal_load_t, common_motion_t
  use contacts_m, only : contact_t, transducer_t
  use controls_m, only : controls_t, output_plan_t
  use cross_sections_m, only : cross_section_t
  use curves_m, only : curve_t
  use force_groups_m, only : force_group_t
  use freight_lists_m, only : pass, pass_text, pass_plain, absent
  use freight_m, only : freight_t, pass_reals
  use hardenings_m, only : hardening_t
  use layout_m, only : layout_t
  use model_m, only : model_t
  use parts_m, only : part_t, material_t
  use rigids_m, only : rigid_t
  use surfaces_m, only : surface_t
  use walls_m, only : wall_t
  implicit none
  private
  public :: pass_model

contains

  !> All but pieces of the mesh (`mesh_freight_m`), and what the first process keeps.
  subroutine pass_model(freight, model)
    type(freight_t), intent(inout) :: freight
    type(model_t), intent(inout), target :: model
    integer :: i, n

    call pass(freight, model%mesh%n_node, model%mesh%n_element)
    call pass_layout(freight, model%layout)
    n = absent
    if (allocated(model%parts)) n = size(model%parts)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (model%parts(n))
    do i = 1, n
      call pass_part(freight, model%parts(i))
    end do
    n = absent
    if (allocated(model%sections)) n = size(model%sections)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (model%sections(n))
    if (n > 0) call pass_plain(freight, c_loc(model%sections(1)), storage_size(model%sections), n)
    n = absent
    if (allocated(model%materials)) n = size(model%materials)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (model%materials(n))
    do i = 1, n
      call pass_material(freight, model%materials(i))
    end do
    n = absent
    if (allocated(model%curves)) n = size(model%curves)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (model%curves(n))
    do i = 1, n
      call pass_curve(freight, model%curves(i))
    end do
    call pass_conditions(freight, model%conditions)
    n = absent
    if (allocated(model%contacts)) n = size(model%contacts)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (model%contacts(n))
    do i = 1, n
      call pass_contact(freight, model%contacts(i))
    end do
    n = absent
    if (allocated(model%transducers)) n = size(model%transducers)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (model%transducers(n))
    do i = 1, n
      call pass_transducer(freight, model%transducers(i))
    end do
    n = absent
    if (allocated(model%rigids)) n = size(model%rigids)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (model%rigids(n))
    do i = 1, n
      call pass_rigid(freight, model%rigids(i))
    end do
    n = absent
    if (allocated(model%walls)) n = size(model%walls)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (model%walls(n))
    do i = 1, n
      call pass_wall(freight, model%walls(i))
    end do
    call pass_controls(freight, model%controls)
    call pass(freight, model%erodes, model%is_round)
  end subroutine pass_model

  !> The layout but for what it says of single elements.
  subroutine pass_layout(freight, layout)
    type(freight_t), intent(inout) :: freight
    type(layout_t), intent(inout), target :: layout
    integer :: n

    call pass(freight, layout%n_slot, layout%n_chunk, layout%n_special, layout%n_local)
    n = absent
    if (allocated(layout%tiles)) n = size(layout%tiles)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (layout%tiles(n))
    if (n > 0) call pass_plain(freight, c_loc(layout%tiles(1)), storage_size(layout%tiles), n)
    call pass(freight, layout%chunk_part)
    call pass(freight, layout%chunk_elements)
    call pass(freight, layout%exposed)
    call pass(freight, layout%exposed_shares)
    call pass(freight, layout%special_node)
    call pass(freight, layout%node_slots)
    call pass(freight, layout%slot_list)
  end subroutine pass_layout

  !> One part.
  subroutine pass_part(freight, part)
    type(freight_t), intent(inout) :: freight
    type(part_t), intent(inout), target :: part

    call pass(freight, part%id, part%section, part%material)
    call pass_text(freight, part%title)
    call pass_plain(freight, c_loc(part%hourglass), storage_size(part%hourglass), 1)
    call pass(freight, part%stiffness_damping)
  end subroutine pass_part

  !> One material.
  subroutine pass_material(freight, material)
    type(freight_t), intent(inout) :: freight
    type(material_t), intent(inout), target :: material
    logical :: is_there

    call pass(freight, material%id, material%law, material%spall)
    call pass(freight, material%density, material%young, material%poisson, material%bulk, &
      material%shear, material%sound_speed, material%yield)
    call pass(freight, material%hardening, material%beta, material%viscosity, material%tension, &
      material%failure_strain, material%cutoff)
    call pass(freight, material%takes_eos, material%needs_eos, material%is_rigid)
    call pass_plain(freight, c_loc(material%is_fixed), &
      storage_size(material%is_fixed), size(material%is_fixed))
    is_there = allocated(material%curve)
    call pass(freight, is_there)
    if (is_there .and. freight%unloads) allocate (material%curve)
    if (is_there) call pass_hardening(freight, material%curve)
    is_there = allocated(material%flow)
    call pass(freight, is_there)
    if (is_there .and. freight%unloads) allocate (material%flow)
    if (is_there) call pass_plain(freight, c_loc(material%flow), storage_size(material%flow), 1)
    is_there = allocated(material%rubber)
    call pass(freight, is_there)
    if (is_there .and. freight%unloads) allocate (material%rubber)
    if (is_there) call pass_plain(freight, c_loc(material%rubber), storage_size(material%rubber), 1)
    call pass_own_curve(freight, material%crush)
    is_there = allocated(material%eos)
    call pass(freight, is_there)
    if (is_there .and. freight%unloads) allocate (material%eos)
    if (is_there) call pass_plain(freight, c_loc(material%eos), storage_size(material%eos), 1)
    is_there = allocated(material%erosion)
    call pass(freight, is_there)
    if (is_there .and. freight%unloads) allocate (material%erosion)
    if (is_there) call pass_plain(freight, c_loc(material%erosion), &
      storage_size(material%erosion), 1)
  end subroutine pass_material

  !> Hardening of one material.
  subroutine pass_hardening(freight, hardening)
    type(freight_t), intent(inout) :: freight
    type(hardening_t), intent(inout), target :: hardening

    call pass(freight, hardening%strain)
    call pass(freight, hardening%stress)
    call pass(freight, hardening%slope)
    call pass(freight, hardening%rate)
    call pass(freight, hardening%rate_constant, hardening%rate_exponent)
    call pass_own_curve(freight, hardening%rate_factor)
  end subroutine pass_hardening

  !> A curve that may not be there.
  subroutine pass_own_curve(freight, curve)
    type(freight_t), intent(inout) :: freight
    type(curve_t), allocatable, intent(inout) :: curve
    logical :: is_there

    is_there = allocated(curve)
    call pass(freight, is_there)
    if (is_there .and. freight%unloads) allocate (curve)
    if (is_there) call pass_curve(freight, curve)
  end subroutine pass_own_curve

  !> One curve.
  subroutine pass_curve(freight, curve)
    type(freight_t), intent(inout) :: freight
    type(curve_t), intent(inout), target :: curve

    call pass(freight, curve%id, curve%phase)
    call pass(freight, curve%is_of_time)
    call pass(freight, curve%abscissa)
    call pass(freight, curve%ordinate)
  end subroutine pass_curve

  !> Conditions.
  subroutine pass_conditions(freight, conditions)
    type(freight_t), intent(inout) :: freight
    type(conditions_t), intent(inout), target :: conditions
    logical :: is_there
    integer :: i, n

    call pass(freight, conditions%n_support)
    call pass_motions(freight, conditions%motions)
    call pass_motions(freight, conditions%rigid_motions)
    call pass_loads(freight, conditions%nodal_loads)
    call pass_loads(freight, conditions%rigid_loads)
    n = absent
    if (allocated(conditions%pressures)) n = size(conditions%pressures)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (conditions%pressures(n))
    if (n > 0) call pass_plain(freight, c_loc(conditions%pressures(1)), &
      storage_size(conditions%pressures), n)
    n = absent
    if (allocated(conditions%body_loads)) n = size(conditions%body_loads)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (conditions%body_loads(n))
    if (n > 0) call pass_plain(freight, c_loc(conditions%body_loads(1)), &
      storage_size(conditions%body_loads), n)
    is_there = allocated(conditions%damping)
    call pass(freight, is_there)
    if (is_there .and. freight%unloads) allocate (conditions%damping)
    if (is_there) call pass_plain(freight, c_loc(conditions%damping), &
      storage_size(conditions%damping), 1)
    n = absent
    if (allocated(conditions%part_damping)) n = size(conditions%part_damping)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (conditions%part_damping(n))
    if (n > 0) call pass_plain(freight, c_loc(conditions%part_damping(1)), &
      storage_size(conditions%part_damping), n)
    n = absent
    if (allocated(conditions%lumped_masses)) n = size(conditions%lumped_masses)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (conditions%lumped_masses(n))
    if (n > 0) call pass_plain(freight, c_loc(conditions%lumped_masses(1)), &
      storage_size(conditions%lumped_masses), n)
    n = absent
    if (allocated(conditions%common_motions)) n = size(conditions%common_motions)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (conditions%common_motions(n))
    do i = 1, n
      call pass_common_motion(freight, conditions%common_motions(i))
    end do
    n = absent
    if (allocated(conditions%skew_supports)) n = size(conditions%skew_supports)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (conditions%skew_supports(n))
    if (n > 0) call pass_plain(freight, c_loc(conditions%skew_supports(1)), &
      storage_size(conditions%skew_supports), n)
  end subroutine pass_conditions

  !> Prescribed motions.
  subroutine pass_motions(freight, motions)
    type(freight_t), intent(inout) :: freight
    type(prescribed_motion_t), allocatable, intent(inout), target :: motions(:)
    integer :: n

    n = absent
    if (allocated(motions)) n = size(motions)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (motions(n))
    if (n > 0) call pass_plain(freight, c_loc(motions(1)), storage_size(motions), n)
  end subroutine pass_motions

  !> Forces on nodes or on bodies.
  subroutine pass_loads(freight, loads)
    type(freight_t), intent(inout) :: freight
    type(nodal_load_t), allocatable, intent(inout), target :: loads(:)
    integer :: n

    n = absent
    if (allocated(loads)) n = size(loads)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (loads(n))
    if (n > 0) call pass_plain(freight, c_loc(loads(1)), storage_size(loads), n)
  end subroutine pass_loads

  !> Nodes that move alike.
  subroutine pass_common_motion(freight, common)
    type(freight_t), intent(inout) :: freight
    type(common_motion_t), intent(inout), target :: common

    call pass(freight, common%nodes)
    call pass_plain(freight, c_loc(common%along), storage_size(common%along), size(common%along))
  end subroutine pass_common_motion

  !> One interface.
  subroutine pass_contact(freight, contact)
    type(freight_t), intent(inout) :: freight
    type(contact_t), intent(inout), target :: contact

    call pass_text(freight, contact%title)
    call pass_text(freight, contact%reason)
    call pass(freight, contact%id, contact%contact_type, contact%scene, contact%n_gauss, &
      contact%penalty_unit, contact%search_interval)
    call pass(freight, contact%tie, contact%behind)
    call pass(freight, contact%chosen_by_keyword, contact%strict, contact%is_round, contact%is_self)
    call pass(freight, contact%target, contact%penalty, contact%master_penalty, contact%damping, &
      contact%birth, contact%death)
    call pass(freight, contact%search_depth, contact%tie_reach)
    call pass_reals(size(contact%strength), contact%strength, freight)
    call pass_plain(freight, c_loc(contact%friction), storage_size(contact%friction), 1)
    call pass_surface(freight, contact%slave)
    call pass_surface(freight, contact%master)
    call pass_own_curve(freight, contact%interference)
  end subroutine pass_contact

  !> One surface.
  subroutine pass_surface(freight, surface)
    type(freight_t), intent(inout) :: freight
    type(surface_t), intent(inout), target :: surface

    call pass(freight, surface%n_node, surface%n_segment)
    call pass(freight, surface%nodes)
    call pass(freight, surface%segments)
    call pass(freight, surface%segment_element)
    call pass(freight, surface%previous)
    call pass(freight, surface%next)
    call pass(freight, surface%chain)
    call pass(freight, surface%incoming)
    call pass(freight, surface%outgoing)
    call pass(freight, surface%parts)
    call pass(freight, surface%is_on_axis)
  end subroutine pass_surface

  !> One force transducer.
  subroutine pass_transducer(freight, transducer)
    type(freight_t), intent(inout) :: freight
    type(transducer_t), intent(inout), target :: transducer

    call pass(freight, transducer%id)
    call pass_text(freight, transducer%title)
    call pass(freight, transducer%nodes)
  end subroutine pass_transducer

  !> One rigid body.
  subroutine pass_rigid(freight, rigid)
    type(freight_t), intent(inout) :: freight
    type(rigid_t), intent(inout), target :: rigid

    call pass(freight, rigid%part)
    call pass(freight, rigid%nodes)
    call pass_plain(freight, c_loc(rigid%is_fixed), &
      storage_size(rigid%is_fixed), size(rigid%is_fixed))
    call pass(freight, rigid%has_velocity)
    call pass_reals(size(rigid%velocity), rigid%velocity, freight)
  end subroutine pass_rigid

  !> One rigid wall.
  subroutine pass_wall(freight, wall)
    type(freight_t), intent(inout) :: freight
    type(wall_t), intent(inout), target :: wall

    call pass(freight, wall%id)
    call pass_reals(size(wall%foot), wall%foot, freight)
    call pass_reals(size(wall%normal), wall%normal, freight)
    call pass(freight, wall%friction, wall%birth, wall%death)
    call pass(freight, wall%nodes)
    call pass(freight, wall%place)
  end subroutine pass_wall

  !> Controls.
  subroutine pass_controls(freight, controls)
    type(freight_t), intent(inout) :: freight
    type(controls_t), intent(inout), target :: controls
    integer :: n

    call pass_text(freight, controls%title)
    call pass(freight, controls%end_time, controls%dt_floor, controls%energy_limit, &
      controls%dt_initial, controls%dt_scale, controls%mass_step)
    call pass(freight, controls%most_added, controls%penalty_scale)
    call pass(freight, controls%end_cycle, controls%length_rule, controls%dt_curve, &
      controls%contact_step)
    call pass(freight, controls%check_only, controls%masses_stay)
    n = absent
    if (allocated(controls%ends)) n = size(controls%ends)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (controls%ends(n))
    if (n > 0) call pass_plain(freight, c_loc(controls%ends(1)), storage_size(controls%ends), n)
    call pass_plain(freight, c_loc(controls%relaxation), storage_size(controls%relaxation), 1)
    call pass_plain(freight, c_loc(controls%units), storage_size(controls%units), 1)
    call pass_output_plan(freight, controls%output)
  end subroutine pass_controls

  !> What is written, and how often.
  subroutine pass_output_plan(freight, plan)
    type(freight_t), intent(inout) :: freight
    type(output_plan_t), intent(inout), target :: plan
    integer :: i, n

    call pass_plain(freight, c_loc(plan%plot), storage_size(plan%plot), 1)
    call pass_plain(freight, c_loc(plan%histories(1)), &
      storage_size(plan%histories), size(plan%histories))
    call pass(freight, plan%history_nodes)
    call pass(freight, plan%history_elements)
    call pass_boundaries(freight, plan%boundaries)
    n = absent
    if (allocated(plan%force_groups)) n = size(plan%force_groups)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (plan%force_groups(n))
    do i = 1, n
      call pass_group(freight, plan%force_groups(i))
    end do
    n = absent
    if (allocated(plan%cross_sections)) n = size(plan%cross_sections)
    call pass(freight, n)
    if (freight%unloads .and. n /= absent) allocate (plan%cross_sections(n))
    do i = 1, n
      call pass_cross_section(freight, plan%cross_sections(i))
    end do
    call pass(freight, plan%dump_cycles, plan%running_cycles, plan%status_interval)
  end subroutine pass_output_plan

  !> Rows of the history of boundaries.
  subroutine pass_boundaries(freight, rows)
    type(freight_t), intent(inout) :: freight
    type(boundary_rows_t), intent(inout), target :: rows

    call pass(freight, rows%condition)
    call pass(freight, rows%where)
    call pass(freight, rows%motion_rows)
    call pass(freight, rows%body_motion_rows)
  end subroutine pass_boundaries

  !> One group of nodes.
  subroutine pass_group(freight, group)
    type(freight_t), intent(inout) :: freight
    type(force_group_t), intent(inout), target :: group

    call pass(freight, group%id)
    call pass(freight, group%nodes)
  end subroutine pass_group

  !> One cross section.
  subroutine pass_cross_section(freight, section)
    type(freight_t), intent(inout) :: freight
    type(cross_section_t), intent(inout), target :: section

    call pass(freight, section%id)
    call pass_text(freight, section%title)
    call pass(freight, section%nodes)
    call pass(freight, section%elements)
    call pass(freight, section%is_corner)
    call pass(freight, section%edges)
  end subroutine pass_cross_section

end module model_freight_m
