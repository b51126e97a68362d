! SPDX-License-Identifier: MIT
!> Element state: streams over the element slots, so that the part of a chunk is contiguous and a
!> kernel receives it without a copy.
module block_state_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t, of_slots, of_columns, of_stresses, of_chunks, &
    new_chunks, fixed_slots, fixed_columns
  implicit none
  private
  public :: block_state_t, erosion_state_t, intact, newly_eroded, eroded_before

  !> Status of an element: intact; eroded in this cycle, not yet counted; eroded.
  integer, parameter :: intact = 0, newly_eroded = 1, eroded_before = 2

  !> Erosion: status and energies of eroded elements. Allocated only where a material or the step
  !> may erode elements.
  type, extends(visited_t) :: erosion_state_t
    integer, allocatable :: status(:)      !! (n_slot) intact, newly_eroded or eroded_before
    integer, allocatable :: n_removed(:)   !! (n_chunk) eroded elements of each chunk
    real(wp), allocatable :: hourglass(:)  !! (n_slot) work of the hourglass forces, J/m
    real(wp), allocatable :: internal(:)   !! (n_slot) internal energy at erosion, J/m
    real(wp), allocatable :: impulse(:)    !! (n_slot) integral of (sigma_1 - SIGTH)^2
    integer, allocatable :: n_element(:)   !! (n_node) elements left at each node
    integer, allocatable :: n_eroded(:)    !! (n_part) eroded elements
    real(wp) :: first_time = 0.0_wp        !! time of the first erosion, s
    real(wp) :: least_step = 0.0_wp        !! stable step below which ERODE erodes an element, s
    real(wp) :: removed_energy(4) = 0.0_wp !! eroded energy: kinetic, internal, hourglass, contact
                                           !! springs, J/m
  contains
    procedure :: visit => visit_erosion
  end type erosion_state_t

  !> Element history. The volumetric stress follows from the displacement, so only the deviator is
  !> stored, with s_zz = -(s_xx + s_yy). Streams of works and limits end with the last tile, since
  !> rigid parts have none.
  type, extends(visited_t) :: block_state_t
    real(wp), allocatable :: reference(:, :)  !! (n_slot, 6) X31 Y31 X42 Y42 and h.X, h.Y at time
                                              !! zero
    real(wp), allocatable :: deviator(:, :)   !! (n_slot, 3) s_xx, s_yy, s_xy, Pa; the mean over the
                                              !! points where an element has several
    integer, allocatable :: point_start(:)    !! (n_chunk) where the points of a chunk start, 0 =
                                              !! one point
    real(wp), allocatable :: point_deviator(:) !! chunk by chunk, point by point: s_xx, then s_yy,
                                               !! s_xy
    integer, allocatable :: history_start(:)  !! (n_chunk) where a chunk's own history starts, 0 =
                                              !! none
    real(wp), allocatable :: history(:)       !! chunk by chunk, point by point: plastic strain,
                                              !! then back stress xx yy xy, or temperature rise
                                              !! and damage; of a foam its mean stress
    integer, allocatable :: eos_start(:)      !! (n_chunk) where a chunk's equation of state starts,
                                              !! 0 = none
    real(wp), allocatable :: eos_state(:)     !! chunk by chunk: energy per initial volume, then
                                              !! pressure (compression positive), V/V0 - 1,
                                              !! bulk viscosity, speed of sound squared
                                              !! or two moduli
    integer, allocatable :: n_failed(:)       !! (n_chunk) failed points of the last step; only
                                              !! where points may fail
    integer, allocatable :: hourglass_start(:) !! (n_chunk) where a chunk's hourglass memory starts,
                                               !! 0 = none
    real(wp), allocatable :: hourglass_strain(:) !! chunk by chunk, x then y: strain (stiffness
                                                 !! form), generalised stress (assumed strain) or
                                                 !! force of the last step (viscous form)
    real(wp), allocatable :: deviatoric_work(:) !! (n_chunk) accumulated work of the deviator, J/m
    real(wp), allocatable :: hourglass_work(:)  !! (n_chunk) accumulated work of the hourglass
                                                !! forces
    real(wp), allocatable :: viscous_work(:)    !! (n_chunk) accumulated work of the bulk viscosity
    real(wp), allocatable :: viscous_pressure(:) !! (n_slot) bulk viscosity of the last step, Pa;
                                                 !! allocated where a part without equation of state
                                                 !! has it
    real(wp), allocatable :: start_dilatation(:, :) !! (n_slot, 4) ln(J) of the stage before at each
                                                    !! point, for the pressure; this and
                                                    !! start_strain are allocated where the deck has
                                                    !! initial stresses and strains
    real(wp), allocatable :: start_strain(:, :) !! (n_slot, 16) strain of the stage before: xx yy zz
                                                !! xy of each point
    real(wp), allocatable :: mass_ratio(:)      !! (n_slot) scaled mass over the mass from the
                                                !! density; allocated with mass scaling
    real(wp), allocatable :: retardation(:)     !! (n_slot) stiffness damping: viscosity over
                                                !! stiffness, s; this, damping_stress and
                                                !! damping_work are allocated where the deck damps
                                                !! by stiffness
    real(wp), allocatable :: damping_stress(:)  !! (16 n_slot) damping stress of the last step, Pa:
                                                !! chunk by chunk, point by point, deviator xx, yy,
                                                !! xy, then mean
    real(wp), allocatable :: damping_work(:)    !! (n_chunk) accumulated work of the damping stress,
                                                !! J/m
    real(wp), allocatable :: time_limit(:)      !! (n_chunk) smallest L/c of the last step, s
    real(wp), allocatable :: volume_limit(:)    !! (n_chunk) smallest A/A0 (or J of a point) of the
                                                !! last step
    real(wp), allocatable :: volume_change(:)   !! (n_chunk) largest |change of ln V| of an element
                                                !! in the last step
    real(wp), allocatable :: mass_shares(:, :)  !! (4, n_slot) shares of exposed quads in the masses
                                                !! of their nodes (`find_exposed`); allocated where
                                                !! there are any
    type(erosion_state_t), allocatable :: erosion !! allocated where elements may erode
  contains
    procedure :: visit => visit_elements
  end type block_state_t

contains

  !> Visit the components of the element state. `mass_shares` is derived from the mesh; the
  !> reference shape of an eroded element becomes that of padding.
  subroutine visit_elements(self, visitor)
    class(block_state_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('reference', self%reference, merge(of_columns, fixed_columns, &
      allocated(self%erosion)))
    call visitor%visit('deviator', self%deviator, of_columns)
    call visitor%stream('point_deviator', self%point_deviator, 'point_start', self%point_start)
    call visitor%stream('history', self%history, 'history_start', self%history_start)
    call visitor%stream('eos_state', self%eos_state, 'eos_start', self%eos_start)
    call visitor%stream('hourglass_strain', self%hourglass_strain, 'hourglass_start', &
      self%hourglass_start)
    call visitor%visit('n_failed', self%n_failed, new_chunks)
    call visitor%visit('deviatoric_work', self%deviatoric_work, of_chunks)
    call visitor%visit('hourglass_work', self%hourglass_work, of_chunks)
    call visitor%visit('viscous_work', self%viscous_work, of_chunks)
    call visitor%visit('viscous_pressure', self%viscous_pressure, of_slots)
    call visitor%visit('start_dilatation', self%start_dilatation, fixed_columns)
    call visitor%visit('start_strain', self%start_strain, fixed_columns)
    call visitor%visit('mass_ratio', self%mass_ratio, fixed_slots)
    call visitor%visit('retardation', self%retardation, fixed_slots)
    call visitor%visit('damping_stress', self%damping_stress, of_stresses)
    call visitor%visit('damping_work', self%damping_work, of_chunks)
    call visitor%visit('time_limit', self%time_limit, of_chunks)
    call visitor%visit('volume_limit', self%volume_limit, of_chunks)
    call visitor%visit('volume_change', self%volume_change, new_chunks)
    if (allocated(self%erosion)) call visitor%part('erosion', self%erosion)
  end subroutine visit_elements

  !> Visit the components of the erosion state.
  subroutine visit_erosion(self, visitor)
    class(erosion_state_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('status', self%status, of_slots)
    call visitor%visit('n_removed', self%n_removed, of_chunks)
    call visitor%visit('hourglass', self%hourglass, of_slots)
    call visitor%visit('internal', self%internal, of_slots)
    call visitor%visit('impulse', self%impulse, of_slots)
    call visitor%visit('n_element', self%n_element)
    call visitor%visit('n_eroded', self%n_eroded)
    call visitor%visit('first_time', self%first_time)
    call visitor%visit('least_step', self%least_step)
    call visitor%fixed('removed_energy', self%removed_energy)
  end subroutine visit_erosion

end module block_state_m
