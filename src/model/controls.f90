! SPDX-License-Identifier: MIT
!> Controls of the run: end, time step and output plan.
module controls_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use boundary_rows_m, only : boundary_rows_t
  use cross_sections_m, only : cross_section_t
  use end_conditions_m, only : end_condition_t
  use force_groups_m, only : force_group_t
  use history_tables_m, only : n_table
  use kinds_m, only : wp
  use units_m, only : units_t
  use visitor_m, only : visited_t, visitor_t, length
  implicit none
  private
  public :: controls_t, relaxation_t, implicit_t, output_plan_t, interval_t, is_asked, &
    length_by_side, length_by_diagonal, contact_step_warns, contact_step_free, contact_step_rules

  !> Element length of the stable step (ISDO): area over longest side, or over longest diagonal.
  integer, parameter :: length_by_side = 0, length_by_diagonal = 1

  !> What the contact springs do to the step (ECDT): the start warns where it is too large for them,
  !> nothing, or the stable step is that of elements and springs together.
  integer, parameter :: contact_step_warns = 0, contact_step_free = 1, contact_step_rules = 2

  !> Time between two outputs of one file; off while both are zero.
  type :: interval_t
    real(wp) :: dt = 0.0_wp  !! constant interval
    integer :: curve = 0     !! index of a curve of the interval against time, 0 = none
    logical :: is_text = .false.   !! a DYNA text file is written too (BINARY)
    logical :: is_binout = .false. !! binout data are asked for (BINARY)
  end type interval_t

  !> What is written, and how often.
  type, extends(visited_t) :: output_plan_t
    type(interval_t) :: plot    !! VTKHDF states and contact rows (*DATABASE_BINARY_D3PLOT)
    type(interval_t) :: histories(n_table)   !! by the `table_` constants; that of contact is
                                             !! unused
    integer, allocatable :: history_nodes(:) !! node indices of *DATABASE_HISTORY_NODE
    integer, allocatable :: history_elements(:) !! element indices of *DATABASE_HISTORY_SHELL
    type(boundary_rows_t) :: boundaries      !! only where *DATABASE_BNDOUT asks for them
    type(force_group_t), allocatable :: force_groups(:) !! only where the deck has any
    type(cross_section_t), allocatable :: cross_sections(:) !! likewise
    integer :: dump_cycles = -1    !! cycles between restart files that stay
                                   !! (*DATABASE_BINARY_D3DUMP), 0 = at the end alone, -1 = none
    integer :: running_cycles = 0  !! cycles between restart files that replace each other (RUNRSF),
                                   !! 0 = none
    integer :: status_interval = 0 !! cycles between progress lines (IKEDIT); 0 = the program's
                                   !! choice
  contains
    procedure :: visit => visit_output
  end type output_plan_t

  !> The implicit method (*CONTROL_IMPLICIT_...). Time integration is the generalised-alpha family
  !> (Chung & Hulbert 1993); alpha_m = alpha_f = 0 is Newmark's.
  type :: implicit_t
    logical :: is_on = .false.         !! IMFLAG = 1
    logical :: is_dynamic = .false.    !! IMASS = 1
    real(wp) :: dt = 0.0_wp            !! DT0, first step
    real(wp) :: alpha_m = 0.0_wp       !! weight of the old instant in the inertia forces
    real(wp) :: alpha_f = 0.0_wp       !! weight of the old instant in the other forces
    real(wp) :: gamma = 0.5_wp
    real(wp) :: beta = 0.25_wp
    character(:), allocatable :: scheme !! in words, for the log
    logical :: is_linear = .false.     !! NSOLVR = 1: one iteration
    integer :: max_iteration = 15      !! MAXREF: iterations of a step at most
    real(wp) :: energy_tolerance = 1.0e-20_wp  !! ECTOL: |dU.R|/|dU0.R0|
    real(wp) :: step_tolerance = 0.0_wp        !! DCTOL: |dU|/|U(n+1) - U(n)|, 0 = off
    real(wp) :: residual_tolerance = 0.0_wp    !! RCTOL: |R|/|R0|, 0 = off
    real(wp) :: search_tolerance = 0.9_wp      !! LSTOL: line search until |dU.R| falls below this
                                               !! part
    logical :: is_automatic = .false.  !! IAUTO = 1: steps grow and shrink
    integer :: best_iterations = 11    !! ITEOPT
    integer :: iteration_window = 5    !! ITEWIN
    real(wp) :: dt_least = 0.0_wp      !! DTMIN, 0 = a thousandth of DT0
    real(wp) :: dt_most = 0.0_wp       !! DTMAX, 0 = ten times DT0
  end type implicit_t

  !> Dynamic relaxation (*CONTROL_DYNAMIC_RELAXATION): a first phase in which velocities are scaled
  !> down in every cycle until the body rests.
  type :: relaxation_t
    logical :: is_on = .false.         !! IDRFLG = 1, or a curve of the phase (SIDR 1 or 2)
    integer :: check_cycles = 250      !! NRCYCK
    real(wp) :: tolerance = 1.0e-3_wp  !! DRTOL: of the kinetic energy over its largest
    real(wp) :: factor = 0.995_wp      !! DRFCTR
    real(wp) :: most_time = huge(1.0_wp) !! DRTERM
    real(wp) :: step_scale = 0.0_wp    !! TSSFDR, 0 = TSSFAC
  end type relaxation_t

  !> All controls.
  type, extends(visited_t) :: controls_t
    character(:), allocatable :: title       !! *TITLE
    real(wp) :: end_time = 0.0_wp            !! ENDTIM
    integer :: end_cycle = 0                 !! ENDCYC, 0 = no limit
    real(wp) :: dt_floor = 0.0_wp            !! DTMIN, as a factor on the first step
    real(wp) :: energy_limit = 0.0_wp        !! ENDENG: change of the energy ratio in per cent, 0 =
                                             !! off
    type(end_condition_t), allocatable :: ends(:) !! *TERMINATION_, only where the deck has any
    logical :: check_only = .false.          !! NOSOL: stop after initialisation
    real(wp) :: dt_initial = 0.0_wp          !! DTINIT, 0 = computed
    real(wp) :: dt_scale = 0.9_wp            !! TSSFAC
    integer :: length_rule = length_by_side  !! ISDO
    integer :: dt_curve = 0                  !! LCTM: index of the curve that caps the step
    real(wp) :: mass_step = 0.0_wp           !! DT2MS: stable step of scaled elements; below 0
                                             !! mass is added alone
    logical :: masses_stay = .false.         !! MS1ST: masses are scaled at the start alone
    real(wp) :: most_added = 0.0_wp          !! ENDMAS: added mass in per cent, 0 = off
    type(relaxation_t) :: relaxation
    real(wp) :: penalty_scale = 0.1_wp       !! SLSFAC
    integer :: contact_step = contact_step_warns !! ECDT, one of the `contact_step_` constants
    type(implicit_t) :: implicit
    type(units_t) :: units                   !! *CONTROL_UNITS
    type(output_plan_t) :: output
  contains
    procedure :: visit => visit_controls
  end type controls_t

contains

  !> Whether the deck asks for this output.
  pure function is_asked(interval) result(asked)
    type(interval_t), intent(in) :: interval
    logical :: asked

    asked = interval%dt > 0.0_wp .or. interval%curve > 0
  end function is_asked

  !> Its components.
  subroutine visit_output(self, visitor)
    class(output_plan_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%plain(c_loc(self%plot), storage_size(self%plot), 1)
    call visitor%plain(c_loc(self%histories(1)), storage_size(self%histories), n_table)
    call visitor%visit('history_nodes', self%history_nodes)
    call visitor%visit('history_elements', self%history_elements)
    call visitor%part('boundaries', self%boundaries)
    if (visitor%makes(length(self%force_groups))) allocate (self%force_groups(visitor%n_item))
    call visitor%each('force_groups', self%force_groups)
    if (visitor%makes(length(self%cross_sections))) allocate (self%cross_sections(visitor%n_item))
    call visitor%each('cross_sections', self%cross_sections)
    call visitor%visit('dump_cycles', self%dump_cycles)
    call visitor%visit('running_cycles', self%running_cycles)
    call visitor%visit('status_interval', self%status_interval)
  end subroutine visit_output

  !> Its components, but for implicit runs, which have one process.
  subroutine visit_controls(self, visitor)
    class(controls_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('title', self%title)
    call visitor%visit('end_time', self%end_time)
    call visitor%visit('end_cycle', self%end_cycle)
    call visitor%visit('dt_floor', self%dt_floor)
    call visitor%visit('energy_limit', self%energy_limit)
    if (visitor%makes(length(self%ends))) allocate (self%ends(visitor%n_item))
    if (visitor%n_item > 0) &
      call visitor%plain(c_loc(self%ends(1)), storage_size(self%ends), visitor%n_item)
    call visitor%visit('check_only', self%check_only)
    call visitor%visit('dt_initial', self%dt_initial)
    call visitor%visit('dt_scale', self%dt_scale)
    call visitor%visit('length_rule', self%length_rule)
    call visitor%visit('dt_curve', self%dt_curve)
    call visitor%visit('mass_step', self%mass_step)
    call visitor%visit('masses_stay', self%masses_stay)
    call visitor%visit('most_added', self%most_added)
    call visitor%plain(c_loc(self%relaxation), storage_size(self%relaxation), 1)
    call visitor%visit('penalty_scale', self%penalty_scale)
    call visitor%visit('contact_step', self%contact_step)
    call visitor%plain(c_loc(self%units), storage_size(self%units), 1)
    call visitor%part('output', self%output)
  end subroutine visit_controls

end module controls_m
