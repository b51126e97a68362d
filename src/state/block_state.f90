! SPDX-License-Identifier: MIT
!> Everything about elements that changes, as long streams over the element slots, so that a chunk
!> of a stream is contiguous and goes to a kernel without a copy.
module block_state_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t, of_slots, of_columns, of_stresses, of_chunks, &
    new_chunks, fixed_slots, fixed_columns
  implicit none
  private
  public :: block_state_t, erosion_state_t, stays, has_left, has_gone

  !> An element is there; it has left in this cycle and nobody has heard of it; it has gone.
  integer, parameter :: stays = 0, has_left = 1, has_gone = 2

  !> Only in runs some elements of which may leave.
  type, extends(visited_t) :: erosion_state_t
    integer, allocatable :: status(:)      !! (n_slot) one of the constants above
    integer, allocatable :: n_gone(:)      !! (n_chunk) elements of a chunk that are not there
    real(wp), allocatable :: hourglass(:)  !! (n_slot) work of its hourglass forces, J/m
    real(wp), allocatable :: internal(:)   !! (n_slot) of those that have left: what they took along
    real(wp), allocatable :: impulse(:)    !! (n_slot) integral of (sigma_1 - SIGTH)^2
    integer, allocatable :: n_element(:)   !! (n_node) elements that each node still has
    integer, allocatable :: n_eroded(:)    !! (n_part) elements that have gone
    real(wp) :: first_time = 0.0_wp        !! when the first one went, s
    real(wp) :: least_step = 0.0_wp        !! step below which ERODE takes elements, s
    real(wp) :: took(4) = 0.0_wp           !! energies that went with them: kinetic, internal,
                                           !! hourglass, contact springs, J/m
  contains
    procedure :: visit => visit_erosion
  end type erosion_state_t

  !> Element history. The volumetric stress follows from the displacement, so only the deviator is
  !> stored: s_zz = -(s_xx + s_yy). Work and limits end with the last tile: rigid parts have none.
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
                                                !! only where parts without an equation of state
                                                !! have any
    real(wp), allocatable :: mass_ratio(:)      !! (n_slot) mass of an element over that of its
                                                !! density; only where masses are scaled
    real(wp), allocatable :: retardation(:)     !! (n_slot) viscosity over stiffness, s; it and
    real(wp), allocatable :: damping_stress(:)  !! (16 n_slot) its stress of the last step, chunk by
                                                !! chunk, point by point: deviator xx, yy, xy, then
                                                !! mean; and
    real(wp), allocatable :: damping_work(:)    !! (n_chunk) its work only where the deck damps by
                                                !! stiffness
    real(wp), allocatable :: time_limit(:)      !! (n_chunk) smallest L/c of the last step, s
    real(wp), allocatable :: volume_limit(:)    !! (n_chunk) smallest A/A0 (or J of a point) of the
                                                !! last step
    real(wp), allocatable :: volume_change(:)   !! (n_chunk) largest change of ln V of an element in
                                                !! the last step, without its sign
    real(wp), allocatable :: mass_shares(:, :)  !! (4, n_slot) of exposed quads in the masses of
                                                !! their nodes (`find_exposed`); only where some are
    type(erosion_state_t), allocatable :: erosion !! only where elements may leave the mesh
  contains
    procedure :: visit => visit_elements
  end type block_state_t

contains

  !> Its components, but for shares in masses, which are made anew. The shape of an element that
  !> leaves the mesh becomes that of padding.
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
    call visitor%visit('mass_ratio', self%mass_ratio, fixed_slots)
    call visitor%visit('retardation', self%retardation, fixed_slots)
    call visitor%visit('damping_stress', self%damping_stress, of_stresses)
    call visitor%visit('damping_work', self%damping_work, of_chunks)
    call visitor%visit('time_limit', self%time_limit, of_chunks)
    call visitor%visit('volume_limit', self%volume_limit, of_chunks)
    call visitor%visit('volume_change', self%volume_change, new_chunks)
    if (allocated(self%erosion)) call visitor%part('erosion', self%erosion)
  end subroutine visit_elements

  !> Its components.
  subroutine visit_erosion(self, visitor)
    class(erosion_state_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('status', self%status, of_slots)
    call visitor%visit('n_gone', self%n_gone, of_chunks)
    call visitor%visit('hourglass', self%hourglass, of_slots)
    call visitor%visit('internal', self%internal, of_slots)
    call visitor%visit('impulse', self%impulse, of_slots)
    call visitor%visit('n_element', self%n_element)
    call visitor%visit('n_eroded', self%n_eroded)
    call visitor%visit('first_time', self%first_time)
    call visitor%visit('least_step', self%least_step)
    call visitor%fixed('took', self%took)
  end subroutine visit_erosion

end module block_state_m
