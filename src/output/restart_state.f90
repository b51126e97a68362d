! SPDX-License-Identifier: MIT
!> The state in a restart file, type by type, component by component, in the order of their
!> declarations. A component that is missing here is noticed by
!> tests/house/test_restart_components.py.
module restart_state_m
  use archive_m, only : keep, keep_fixed, keep_growing, keep_same
  use archive_file_m, only : archive_t, enter, leave
  use block_state_m, only : block_state_t
  use contact_estimate_m, only : contact_estimate_t
  use erosion_state_m, only : erosion_state_t
  use kinds_m, only : wp
  use log_m, only : to_text
  use others_memory_m, only : others_t, forget_nodes, forget_slots
  use relaxation_state_m, only : relaxation_state_t
  use restart_contact_m, only : keep_contact
  use rigid_state_m, only : rigid_state_t
  use state_m, only : state_t
  use wall_state_m, only : wall_state_t
  implicit none
  private
  public :: keep_state, keep_erosion_status

contains

  !> Write or read the state. One that is read must have been started from the model, which gives
  !> all arrays their shapes. What other processes have is given up array by array.
  subroutine keep_state(archive, state, others)
    type(archive_t), intent(inout) :: archive
    type(state_t), intent(inout) :: state
    type(others_t), intent(in), optional :: others
    logical :: is_new

    call enter(archive, 'state')
    call keep(archive, 'cycle', state%cycle)
    call keep(archive, 'time', state%time)
    call keep(archive, 'dt', state%dt)
    call keep(archive, 'dt_before', state%dt_before)
    call keep(archive, 'motion', state%motion)
    if (present(others)) call forget_nodes(others, state)
    call keep(archive, 'mass', state%mass)
    if (present(others)) call forget_nodes(others, state)
    call keep(archive, 'inverse_mass', state%inverse_mass)
    if (present(others)) call forget_nodes(others, state)
    call keep(archive, 'contact_mass', state%contact_mass)
    call keep(archive, 'force_special', state%force_special)
    call keep(archive, 'external', state%external)
    call keep(archive, 'force_slots', state%force_slots)
    call keep(archive, 'internal_force', state%internal_force)
    if (present(others)) call forget_nodes(others, state)
    call keep(archive, 'prescribed_velocity', state%prescribed_velocity)
    call keep(archive, 'former_velocity', state%former_velocity)
    if (present(others)) call forget_nodes(others, state)
    call keep(archive, 'node_damping', state%node_damping)
    call keep(archive, 'former_damping', state%former_damping)
    call keep(archive, 'former_dt', state%former_dt)
    call keep(archive, 'acceleration', state%acceleration)
    call keep_fixed(archive, 'body_acceleration', state%body_acceleration)
    call keep_relaxation(archive, 'relaxation', state%relaxation)
    call keep_elements(archive, 'elements', state%elements, others)
    call keep_contacts(archive, 'contacts', state)
    call keep_estimates(archive, 'estimates', state)
    call keep_rigids(archive, 'rigids', state)
    call keep_walls(archive, 'walls', state)
    call keep_columns(archive, 'boundary_force', state%boundary_force)
    call keep_column(archive, 'boundary_work', state%boundary_work, is_new)
    if (is_new) state%boundary_since = state%cycle
    call keep_columns(archive, 'group_force', state%group_force)
    call keep_columns(archive, 'group_velocity', state%group_velocity)
    call keep_column(archive, 'group_work', state%group_work)
    call keep(archive, 'cut_force', state%cut_force)
    call keep(archive, 'quiet_since', state%quiet_since)
    call keep(archive, 'external_work', state%external_work)
    call keep(archive, 'damping_work', state%damping_work)
    call keep(archive, 'initial_energy', state%initial_energy)
    call keep(archive, 'largest_energy', state%largest_energy)
    call leave(archive)
  end subroutine keep_state

  !> The phase before time zero, where it goes on.
  subroutine keep_relaxation(archive, name, relaxation)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(relaxation_state_t), intent(inout) :: relaxation

    call enter(archive, name)
    call keep(archive, 'n', relaxation%n)
    call keep(archive, 'time', relaxation%time)
    call keep(archive, 'most', relaxation%most)
    call keep_growing(archive, 'velocity', relaxation%velocity)
    call leave(archive)
  end subroutine keep_relaxation

  !> Vectors that a history asks for. The run that goes on may ask for them anew: they begin at 0
  !> then.
  subroutine keep_columns(archive, name, values)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    real(wp), allocatable, intent(inout) :: values(:, :)
    real(wp), allocatable :: kept(:, :)

    if (allocated(values)) kept = values
    call keep_growing(archive, name, kept)
    if (.not. allocated(values) .or. .not. allocated(kept)) return
    if (all(shape(kept) == shape(values))) values = kept
  end subroutine keep_columns

  !> Values that a history asks for, in the same way.
  subroutine keep_column(archive, name, values, is_new)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    real(wp), allocatable, intent(inout) :: values(:)
    logical, intent(out), optional :: is_new !! they begin here
    real(wp), allocatable :: kept(:)
    logical :: fits

    if (allocated(values)) kept = values
    call keep_growing(archive, name, kept)
    fits = allocated(values) .and. allocated(kept)
    if (fits) fits = size(kept) == size(values)
    if (fits) values = kept
    if (present(is_new)) is_new = archive%is_read .and. .not. fits
  end subroutine keep_column

  !> Element history.
  subroutine keep_elements(archive, name, elements, others)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(block_state_t), intent(inout) :: elements
    type(others_t), intent(in), optional :: others

    call enter(archive, name)
    call keep(archive, 'reference', elements%reference)
    if (present(others)) call forget_slots(others, elements)
    call keep(archive, 'deviator', elements%deviator)
    if (present(others)) call forget_slots(others, elements)
    call keep_same(archive, 'point_start', elements%point_start)
    call keep(archive, 'point_deviator', elements%point_deviator)
    if (present(others)) call forget_slots(others, elements)
    call keep_same(archive, 'history_start', elements%history_start)
    call keep(archive, 'history', elements%history)
    if (present(others)) call forget_slots(others, elements)
    call keep_same(archive, 'eos_start', elements%eos_start)
    call keep(archive, 'eos_state', elements%eos_state)
    if (present(others)) call forget_slots(others, elements)
    call keep_same(archive, 'hourglass_start', elements%hourglass_start)
    call keep(archive, 'hourglass_strain', elements%hourglass_strain)
    if (present(others)) call forget_slots(others, elements)
    call keep(archive, 'deviatoric_work', elements%deviatoric_work)
    call keep(archive, 'hourglass_work', elements%hourglass_work)
    call keep(archive, 'viscous_work', elements%viscous_work)
    call keep(archive, 'viscous_pressure', elements%viscous_pressure)
    call keep(archive, 'mass_ratio', elements%mass_ratio)
    call keep(archive, 'retardation', elements%retardation)
    call keep(archive, 'damping_stress', elements%damping_stress)
    call keep(archive, 'damping_work', elements%damping_work)
    call keep(archive, 'time_limit', elements%time_limit)
    call keep(archive, 'volume_limit', elements%volume_limit)
    if (allocated(elements%erosion)) call keep_erosion(archive, 'erosion', elements%erosion)
    call leave(archive)
  end subroutine keep_elements

  !> Which elements are there, before anything else is read: shapes of interfaces follow from it.
  subroutine keep_erosion_status(archive, erosion)
    type(archive_t), intent(inout) :: archive
    type(erosion_state_t), intent(inout) :: erosion

    call enter(archive, 'state')
    call enter(archive, 'elements')
    call enter(archive, 'erosion')
    call keep(archive, 'status', erosion%status)
    call leave(archive)
    call leave(archive)
    call leave(archive)
  end subroutine keep_erosion_status

  !> Which elements have left the mesh.
  subroutine keep_erosion(archive, name, erosion)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(erosion_state_t), intent(inout) :: erosion

    call enter(archive, name)
    call keep(archive, 'status', erosion%status)
    call keep(archive, 'n_gone', erosion%n_gone)
    call keep(archive, 'hourglass', erosion%hourglass)
    call keep(archive, 'internal', erosion%internal)
    call keep(archive, 'impulse', erosion%impulse)
    call keep(archive, 'n_element', erosion%n_element)
    call keep(archive, 'n_eroded', erosion%n_eroded)
    call keep(archive, 'first_time', erosion%first_time)
    call keep(archive, 'least_step', erosion%least_step)
    call keep_fixed(archive, 'took', erosion%took)
    call leave(archive)
  end subroutine keep_erosion

  !> Memories of all interfaces, numbered from 1.
  subroutine keep_contacts(archive, name, state)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(state_t), intent(inout) :: state
    integer :: i, n

    n = 0
    if (allocated(state%contacts)) n = size(state%contacts)
    call enter(archive, name)
    call keep_same(archive, 'n', n)
    do i = 1, n
      call keep_contact(archive, to_text(i), state%contacts(i))
    end do
    call leave(archive)
  end subroutine keep_contacts

  !> What is known of the quality of interfaces, numbered from 1.
  subroutine keep_estimates(archive, name, state)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(state_t), intent(inout) :: state
    integer :: i, n

    n = 0
    if (allocated(state%estimates)) n = size(state%estimates)
    call enter(archive, name)
    call keep_same(archive, 'n', n)
    do i = 1, n
      call keep_estimate(archive, to_text(i), state%estimates(i))
    end do
    call leave(archive)
  end subroutine keep_estimates

  !> That of one interface.
  subroutine keep_estimate(archive, name, estimate)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(contact_estimate_t), intent(inout) :: estimate

    call enter(archive, name)
    call keep(archive, 'cycle', estimate%cycle)
    call keep(archive, 'stride', estimate%stride)
    call keep(archive, 'n', estimate%n)
    call keep(archive, 'misfit', estimate%misfit)
    call keep(archive, 'load', estimate%load)
    call keep(archive, 'still', estimate%still)
    call keep(archive, 'heaviest', estimate%heaviest)
    call keep(archive, 'at_heaviest', estimate%at_heaviest)
    call keep(archive, 'springs', estimate%springs)
    call keep(archive, 'rows', estimate%rows)
    call keep_fixed(archive, 'force', estimate%force)
    call keep_fixed(archive, 'former', estimate%former)
    call keep(archive, 'jumps', estimate%jumps)
    call keep(archive, 'forces', estimate%forces)
    call keep(archive, 'least_margin', estimate%least_margin)
    call keep(archive, 'softness', estimate%softness)
    call keep(archive, 'stored', estimate%stored)
    call keep(archive, 'bodies', estimate%bodies)
    call keep(archive, 'penetration', estimate%penetration)
    call keep(archive, 'facet_error', estimate%facet_error)
    call keep(archive, 'arc_height', estimate%arc_height)
    call keep(archive, 'arc_curvature', estimate%arc_curvature)
    call keep(archive, 'arc_side', estimate%arc_side)
    call leave(archive)
  end subroutine keep_estimate

  !> Rigid bodies, numbered from 1.
  subroutine keep_rigids(archive, name, state)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(state_t), intent(inout) :: state
    integer :: i, n

    n = 0
    if (allocated(state%rigids)) n = size(state%rigids)
    call enter(archive, name)
    call keep_same(archive, 'n', n)
    do i = 1, n
      call keep_rigid(archive, to_text(i), state%rigids(i))
    end do
    call leave(archive)
  end subroutine keep_rigids

  !> One rigid body.
  subroutine keep_rigid(archive, name, rigid)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(rigid_state_t), intent(inout) :: rigid

    call enter(archive, name)
    call keep_fixed(archive, 'inertia', rigid%inertia)
    call keep_fixed(archive, 'second', rigid%second)
    call keep_fixed(archive, 'centre', rigid%centre)
    call keep(archive, 'arms', rigid%arms)
    call keep_fixed(archive, 'place', rigid%place)
    call keep_fixed(archive, 'velocity', rigid%velocity)
    call keep_fixed(archive, 'next_velocity', rigid%next_velocity)
    call keep_fixed(archive, 'acceleration', rigid%acceleration)
    call keep_fixed(archive, 'force', rigid%force)
    call keep_fixed(archive, 'load', rigid%load)
    call leave(archive)
  end subroutine keep_rigid

  !> Rigid walls, numbered from 1.
  subroutine keep_walls(archive, name, state)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(state_t), intent(inout) :: state
    integer :: i, n

    n = 0
    if (allocated(state%walls)) n = size(state%walls)
    call enter(archive, name)
    call keep_same(archive, 'n', n)
    do i = 1, n
      call keep_wall(archive, to_text(i), state%walls(i))
    end do
    call leave(archive)
  end subroutine keep_walls

  !> One rigid wall.
  subroutine keep_wall(archive, name, wall)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(wall_state_t), intent(inout) :: wall

    call enter(archive, name)
    call keep(archive, 'force', wall%force)
    call keep(archive, 'speed', wall%speed)
    call keep(archive, 'impulse', wall%impulse)
    call keep(archive, 'work', wall%work)
    call keep(archive, 'friction', wall%friction)
    call keep(archive, 'slip_speed', wall%slip_speed)
    call keep(archive, 'dissipated', wall%dissipated)
    call leave(archive)
  end subroutine keep_wall

end module restart_state_m
