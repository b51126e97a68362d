! SPDX-License-Identifier: MIT
!> Controls of the run: end, time step and output plan.
module controls_m
  use kinds_m, only : wp
  implicit none
  private
  public :: controls_t, output_plan_t, interval_t, length_by_side, length_by_diagonal

  !> Element length of the stable step (ISDO): area over longest side, or over longest diagonal.
  integer, parameter :: length_by_side = 0, length_by_diagonal = 1

  !> Time between two outputs of one file; off while both are zero.
  type :: interval_t
    real(wp) :: dt = 0.0_wp  !! constant interval
    integer :: curve = 0     !! index of a curve of the interval against time, 0 = none
  end type interval_t

  !> What is written, and how often.
  type :: output_plan_t
    type(interval_t) :: plot    !! VTKHDF states and contact rows (*DATABASE_BINARY_D3PLOT)
    type(interval_t) :: glstat
    type(interval_t) :: matsum
    type(interval_t) :: rcforc
    type(interval_t) :: nodout
    integer, allocatable :: history_nodes(:) !! node indices of *DATABASE_HISTORY_NODE
    integer :: status_interval = 0 !! cycles between progress lines (IKEDIT); 0 = the program's choice
  end type output_plan_t

  !> All controls.
  type :: controls_t
    character(:), allocatable :: title       !! *TITLE
    real(wp) :: end_time = 0.0_wp            !! ENDTIM
    integer :: end_cycle = 0                 !! ENDCYC, 0 = no limit
    real(wp) :: dt_floor = 0.0_wp            !! DTMIN, as a factor on the first step
    real(wp) :: energy_limit = 0.0_wp        !! ENDENG: change of the energy ratio in per cent, 0 = off
    logical :: check_only = .false.          !! NOSOL: stop after initialisation
    real(wp) :: dt_initial = 0.0_wp          !! DTINIT, 0 = computed
    real(wp) :: dt_scale = 0.9_wp            !! TSSFAC
    integer :: length_rule = length_by_side  !! ISDO
    integer :: dt_curve = 0                  !! LCTM: index of the curve that caps the step
    real(wp) :: penalty_scale = 0.1_wp       !! SLSFAC
    logical :: contact_limits_step = .true.  !! ECDT = 1 switches the contact warning off
    type(output_plan_t) :: output
  end type controls_t

end module controls_m
