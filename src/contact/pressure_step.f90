! SPDX-License-Identifier: MIT
!> What implicit penalties (PUNIT 4) know of the step ahead, with room that is kept from step to
!> step.
module pressure_step_m
  use complementarity_m, only : problem_t
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use gap_rates_m, only : find_rates
  use kinds_m, only : wp
  use weighted_gaps_m, only : rows_t, start_rows
  implicit none
  private
  public :: pressure_step_t, start_pressure_step, take_diagonal, set_diagonal, fill_columns

  !> The step ahead at the nodes of an interface.
  type :: pressure_step_t
    real(wp) :: dt = 0.0_wp                 !! to the end of the step, s
    real(wp) :: dt_before = 0.0_wp          !! of the step behind, s
    integer :: cycle = 0
    logical :: is_stiff = .false.           !! the deck asks for springs without compliance
    real(wp) :: time = 0.0_wp               !! of u(n), s
    real(wp), allocatable :: velocity(:, :) !! (2, n_slave + n_master) v(n+1/2) without the
                                            !! interface; this and the next of nodes that have
                                            !! rows, of others from some step before
    real(wp), allocatable :: mobility(:, :) !! (2, n_slave + n_master) velocity from a force of 1
    integer, allocatable :: led(:, :)       !! (2, :) motions that lead nodes, and these
    integer, allocatable :: riders(:, :)    !! (3, :) rigid bodies, their nodes, and these
    integer :: n_mode = 0                   !! free motions of rigid bodies
    real(wp), allocatable :: modes(:, :, :) !! (2, n_slave + n_master, n_mode or more) velocities of
                                            !! them, times the root of what a unit force makes
    real(wp), allocatable :: gap(:)         !! (n_slave) mean gaps, m
    real(wp), allocatable :: behind(:, :)   !! (2, n_slave + n_master) v(n-1/2); only where there is
                                            !! no friction
    real(wp), allocatable :: loaded(:, :)   !! (2, n_slave + n_master) velocities with pressures, of
                                            !! nodes that have rows; only where there is friction
    real(wp), allocatable :: diagonal(:)    !! (rows) W(i, i) of the rows alone
    type(rows_t) :: rows
    type(problem_t) :: problem
  end type pressure_step_t

contains

  !> Room for an interface.
  pure subroutine start_pressure_step(contact, memory, step)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(pressure_step_t), intent(inout) :: step

    step%is_stiff = contact%penalty < 0.0_wp
    associate (n_node => memory%n_slave + memory%n_master, n_slave => memory%n_slave)
      allocate (step%velocity(2, n_node), step%mobility(2, n_node), source=0.0_wp)
      allocate (step%gap(n_slave), step%diagonal(n_slave))
      if (memory%has%friction) then
        allocate (step%loaded(2, n_node))
      else
        allocate (step%behind(2, n_node))
      end if
      call start_rows(n_slave, n_node, step%rows)
    end associate
  end subroutine start_pressure_step

  !> The diagonal of the rows alone.
  pure subroutine take_diagonal(n, width, band, diagonal)
    integer, intent(in) :: n, width
    real(wp), intent(in) :: band(0:width, n)
    real(wp), intent(inout) :: diagonal(n)

    diagonal = band(0, :)
  end subroutine take_diagonal

  !> The diagonal of the band: that of the rows alone, and what their springs give way by.
  pure subroutine set_diagonal(n, width, diagonal, inverse, stiffness, band)
    integer, intent(in) :: n, width
    real(wp), intent(in) :: diagonal(n)
    real(wp), intent(in) :: inverse(n)      !! 1/kappa of rows, 1/m
    real(wp), intent(in) :: stiffness       !! times the step, N s/m^2; 0: they do not give way
    real(wp), intent(inout) :: band(0:width, n)

    if (stiffness > 0.0_wp) then
      band(0, :) = diagonal + inverse/stiffness
    else
      band(0, :) = diagonal
    end if
  end subroutine set_diagonal

  !> How the rows move rigid bodies.
  pure subroutine fill_columns(step, direction)
    type(pressure_step_t), intent(inout) :: step
    integer, intent(in) :: direction !! along_normal or along_tangent
    integer :: m

    do m = 1, step%n_mode
      associate (n => step%problem%n)
        call find_rates(step%rows, direction, step%modes(:, :, m), &
          step%problem%column((m - 1)*n + 1))
      end associate
    end do
  end subroutine fill_columns

end module pressure_step_m
