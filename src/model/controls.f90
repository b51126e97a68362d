! SPDX-License-Identifier: MIT
!> Controls of the run: termination, time step, implicit method, outputs and the rows of histories.
module controls_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use conditions_m, only : conditions_t
  use history_tables_m, only : n_table
  use kinds_m, only : long, wp
  use layout_m, only : layout_t
  use sorting_m, only : sorted_order
  use units_m, only : units_t
  use visitor_m, only : visited_t, visitor_t, length
  implicit none
  private
  public :: boundary_rows_t, list_boundaries, boundary_load, boundary_body_load, &
    boundary_pressure, boundary_motion, boundary_body_motion, force_group_t, group_nodes, &
    cross_section_t, set_edges, set_corners, end_condition_t, end_node_coordinate, &
    end_node_contact, end_body_displacement, end_body_distance, end_contact, controls_t, &
    relaxation_t, &
    implicit_t, output_plan_t, interval_t, is_asked, length_by_side, length_by_diagonal, &
    contact_step_warns, contact_step_free, contact_step_rules

  !> Boundary conditions of bndout, in the order of its rows: force on a node, on a rigid body,
  !> pressure on edges of a node, prescribed motion of a node, of a rigid body.
  integer, parameter :: boundary_load = 1, boundary_body_load = 2, boundary_pressure = 3, &
    boundary_motion = 4, boundary_body_motion = 5

  !> Rows of bndout, and the rows of the prescribed motions.
  type, extends(visited_t) :: boundary_rows_t
    integer, allocatable :: condition(:)       !! one of `boundary_`
    integer, allocatable :: where(:)           !! index of the node, or of the body
    integer, allocatable :: motion_rows(:)     !! of each prescribed motion of a node
    integer, allocatable :: body_motion_rows(:) !! of each of a body
  contains
    procedure :: visit => visit_rows
  end type boundary_rows_t

  !> One *DATABASE_NODAL_FORCE_GROUP.
  type, extends(visited_t) :: force_group_t
    integer :: id = 0                !! user number of its node set
    integer, allocatable :: nodes(:) !! node indices, each once, in the order of the set
  contains
    procedure :: visit => visit_group
  end type force_group_t

  !> One *DATABASE_CROSS_SECTION_SET.
  type, extends(visited_t) :: cross_section_t
    integer :: id = 0                   !! user number, or its position in the deck
    character(:), allocatable :: title
    integer, allocatable :: nodes(:)    !! node indices, each once
    integer, allocatable :: elements(:) !! element indices, each once; by increasing slot after the
                                        !! layout is built
    logical, allocatable :: is_corner(:, :) !! (4, elements) corners that are nodes of the section
    integer, allocatable :: edges(:, :) !! (2, n) element edges with both nodes in the section
  contains
    procedure :: visit => visit_section
  end type cross_section_t

  !> Kinds of termination conditions: coordinate of a node, contact of a node, displacement of a
  !> rigid body along an axis, magnitude of its displacement, interface without force.
  integer, parameter :: end_node_coordinate = 1, end_node_contact = 2, end_body_displacement = 3, &
    end_body_distance = 4, end_contact = 5

  !> One *TERMINATION_ condition.
  type :: end_condition_t
    integer :: kind = 0
    integer :: id = 0                  !! user number of the node, part or interface
    integer :: where = 0               !! index of the node, body or interface
    integer :: direction = 0           !! 1 x, 2 y; of an interface 0 both
    real(wp) :: least = -huge(1.0_wp)  !! MINC
    real(wp) :: most = huge(1.0_wp)    !! MAXC
    real(wp) :: start = 0.0_wp         !! ACTIM
    real(wp) :: duration = 0.0_wp      !! DUR
    real(wp) :: threshold = 0.0_wp     !! THRES
  end type end_condition_t

  !> Element length of the stable step (ISDO): area over longest side, or over longest diagonal.
  integer, parameter :: length_by_side = 0, length_by_diagonal = 1

  !> Contact springs and the time step (ECDT): a warning at the start where the step is too large
  !> for them; no check; or a step that is stable for elements and springs.
  integer, parameter :: contact_step_warns = 0, contact_step_free = 1, contact_step_rules = 2

  !> Time between two outputs of one file; off while both are zero.
  type :: interval_t
    real(wp) :: dt = 0.0_wp  !! constant interval
    integer :: curve = 0     !! index of a curve of the interval against time, 0 = none
    logical :: is_text = .false.   !! also write a DYNA text file (BINARY)
    logical :: is_binout = .false. !! binout requested (BINARY)
  end type interval_t

  !> Outputs and their intervals.
  type, extends(visited_t) :: output_plan_t
    type(interval_t) :: plot    !! VTKHDF states and contact rows (*DATABASE_BINARY_D3PLOT)
    type(interval_t) :: histories(n_table)   !! by the `table_` constants; contact is unused
    integer, allocatable :: history_nodes(:) !! node indices of *DATABASE_HISTORY_NODE
    integer, allocatable :: history_elements(:) !! element indices of *DATABASE_HISTORY_SHELL
    type(boundary_rows_t) :: boundaries      !! with *DATABASE_BNDOUT
    type(force_group_t), allocatable :: force_groups(:)
    type(cross_section_t), allocatable :: cross_sections(:)
    integer :: dump_cycles = -1    !! cycles between numbered restart files
                                   !! (*DATABASE_BINARY_D3DUMP), 0 = at the end only, -1 = none
    integer :: running_cycles = 0  !! cycles between running restart files (RUNRSF), 0 = none
    integer :: status_interval = 0 !! cycles between progress lines (IKEDIT); 0 = the program's
                                   !! choice
    logical :: has_errors = .false. !! errors of elements in the states (*DATABASE_ERROR_INDICATOR)
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
    real(wp) :: search_tolerance = 0.9_wp      !! LSTOL: line search while |dU.R|/|dU0.R0| is larger
    logical :: is_automatic = .false.  !! IAUTO = 1: automatic step
    integer :: best_iterations = 11    !! ITEOPT
    integer :: iteration_window = 5    !! ITEWIN
    real(wp) :: dt_least = 0.0_wp      !! DTMIN, 0 = a thousandth of DT0
    real(wp) :: dt_most = 0.0_wp       !! DTMAX, 0 = ten times DT0
  end type implicit_t

  !> Dynamic relaxation (*CONTROL_DYNAMIC_RELAXATION): an initial phase with velocities scaled down
  !> in every cycle until the kinetic energy vanishes.
  type :: relaxation_t
    logical :: is_on = .false.         !! IDRFLG = 1, or a curve of the phase (SIDR 1 or 2)
    integer :: check_cycles = 250      !! NRCYCK
    real(wp) :: tolerance = 1.0e-3_wp  !! DRTOL: kinetic energy over its maximum
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
    type(end_condition_t), allocatable :: ends(:) !! *TERMINATION_
    logical :: check_only = .false.          !! NOSOL: stop after initialisation
    real(wp) :: dt_initial = 0.0_wp          !! DTINIT, 0 = computed
    real(wp) :: dt_scale = 0.9_wp            !! TSSFAC
    integer :: length_rule = length_by_side  !! ISDO
    integer :: dt_curve = 0                  !! LCTM: index of the curve that caps the step
    real(wp) :: mass_step = 0.0_wp           !! DT2MS: stable step of scaled elements; below 0 mass
                                             !! is only added
    logical :: masses_stay = .false.         !! MS1ST: mass scaling at the start only
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

  !> All rows of bndout, by kind of condition and increasing user number.
  subroutine list_boundaries(conditions, node_ids, body_ids, rows)
    type(conditions_t), intent(in) :: conditions
    integer, intent(in) :: node_ids(:), body_ids(:) !! user numbers
    type(boundary_rows_t), intent(out) :: rows
    integer :: row_at(max(size(node_ids), size(body_ids))), i

    allocate (rows%condition(0), rows%where(0))
    call add_rows(boundary_load, [conditions%nodal_loads%node], node_ids, rows, row_at)
    if (allocated(conditions%rigid_loads)) call add_rows(boundary_body_load, &
      [conditions%rigid_loads%node], body_ids, rows, row_at)
    call add_rows(boundary_pressure, [(conditions%pressures(i)%nodes, i=1, &
      size(conditions%pressures))], node_ids, rows, row_at)
    call add_rows(boundary_motion, [conditions%motions%node], node_ids, rows, row_at)
    rows%motion_rows = row_at(conditions%motions%node)
    call add_rows(boundary_body_motion, [conditions%rigid_motions%node], body_ids, rows, row_at)
    rows%body_motion_rows = row_at(conditions%rigid_motions%node)
  end subroutine list_boundaries

  !> Append the rows of one kind of condition, one for each node or body.
  subroutine add_rows(condition, items, ids, rows, row_at)
    integer, intent(in) :: condition
    integer, intent(in) :: items(:)    !! indices of nodes or bodies, possibly repeated
    integer, intent(in) :: ids(:)      !! user numbers
    type(boundary_rows_t), intent(inout) :: rows
    integer, intent(out) :: row_at(:)  !! row of each index, 0 = none
    logical :: is_there(size(ids))
    integer, allocatable :: found(:)
    integer :: i

    is_there = .false.
    is_there(items) = .true.
    found = pack([(i, i=1, size(ids))], is_there)
    found = found(sorted_order(int(ids(found), long)))
    row_at = 0
    row_at(found) = size(rows%where) + [(i, i=1, size(found))]
    rows%condition = [rows%condition, spread(condition, 1, size(found))]
    rows%where = [rows%where, found]
  end subroutine add_rows

  !> Visit the components of the rows.
  subroutine visit_rows(self, visitor)
    class(boundary_rows_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('condition', self%condition)
    call visitor%visit('where', self%where)
    call visitor%visit('motion_rows', self%motion_rows)
    call visitor%visit('body_motion_rows', self%body_motion_rows)
  end subroutine visit_rows

  !> Visit the components of a force group.
  subroutine visit_group(self, visitor)
    class(force_group_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('id', self%id)
    call visitor%visit('nodes', self%nodes)
  end subroutine visit_group

  !> Nodes of all groups, group after group.
  pure function group_nodes(groups) result(nodes)
    type(force_group_t), intent(in) :: groups(:)
    integer, allocatable :: nodes(:)
    integer :: i

    nodes = [(groups(i)%nodes, i=1, size(groups))]
  end function group_nodes

  !> Set the edges of a cross section: element edges with both nodes in it, each once.
  subroutine set_edges(element_nodes, section)
    integer, intent(in) :: element_nodes(:, :) !! (4, n_element)
    type(cross_section_t), intent(inout) :: section
    integer(long), allocatable :: keys(:)
    integer, allocatable :: edges(:, :), order(:)
    logical, allocatable :: is_in(:)
    integer :: i, k, n, a, b

    allocate (is_in(max(maxval(element_nodes), maxval(section%nodes))), source=.false.)
    is_in(section%nodes) = .true.
    allocate (edges(2, 4*size(section%elements)))
    n = 0
    do i = 1, size(section%elements)
      do k = 1, 4
        a = element_nodes(k, section%elements(i))
        b = element_nodes(mod(k, 4) + 1, section%elements(i))
        if (a == b .or. .not. (is_in(a) .and. is_in(b))) cycle
        n = n + 1
        edges(:, n) = [min(a, b), max(a, b)]
      end do
    end do
    keys = edges(1, :n)*int(size(is_in), long) + edges(2, :n)
    order = sorted_order(keys)
    keys = keys(order)
    section%edges = edges(:, pack(order, [(i == 1 .or. keys(i) > keys(max(i - 1, 1)), i=1, n)]))
  end subroutine set_edges

  !> Set the element corners that are nodes of a cross section, after the layout is built.
  subroutine set_corners(layout, n_node, section)
    type(layout_t), intent(in) :: layout
    integer, intent(in) :: n_node
    type(cross_section_t), intent(inout) :: section
    logical, allocatable :: is_in(:)
    integer :: i

    allocate (is_in(n_node), source=.false.)
    is_in(section%nodes) = .true.
    allocate (section%is_corner(4, size(section%elements)))
    do i = 1, size(section%elements)
      section%is_corner(:, i) = &
        is_in(layout%slot_nodes(:, layout%element_slot(section%elements(i))))
    end do
  end subroutine set_corners

  !> Visit the components of a cross section.
  subroutine visit_section(self, visitor)
    class(cross_section_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor
    integer, allocatable :: corner(:, :)

    call visitor%visit('id', self%id)
    call visitor%visit('title', self%title)
    call visitor%visit('nodes', self%nodes)
    call visitor%visit('elements', self%elements)
    if (allocated(self%is_corner)) corner = merge(1, 0, self%is_corner)
    call visitor%visit('is_corner', corner)
    if (allocated(corner)) self%is_corner = corner == 1
    call visitor%visit('edges', self%edges)
  end subroutine visit_section

  !> Whether an output is requested.
  pure function is_asked(interval) result(asked)
    type(interval_t), intent(in) :: interval
    logical :: asked

    asked = interval%dt > 0.0_wp .or. interval%curve > 0
  end function is_asked

  !> Visit the components of the output plan.
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
    call visitor%visit('has_errors', self%has_errors)
  end subroutine visit_output

  !> Visit the components of the controls, without `implicit`: implicit runs have one process.
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
