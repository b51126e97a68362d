! SPDX-License-Identifier: MIT
!> Everything that changes during a run, and exactly what a restart would have to write.
!>
!> Displacement is stored, never position: strains, volume ratios and gaps are formed from
!> differences of u and of X, since differences of large coordinates lose the digits that a
!> patch test needs. In the explicit driver v lives at half steps: `motion(3:4)` is v(n-1/2)
!> when the forces of cycle n are formed. Node arrays are in the order of the model (special
!> nodes first, see layout_t).
module state_m
  use block_state_m, only : block_state_t
  use law_state_m, only : contact_estimate_t
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  use rigid_state_m, only : rigid_state_t
  use visitor_m, only : visited_t, visitor_t, length, any_length, of_forces, of_nodes
  implicit none
  private
  public :: state_t, relaxation_state_t

  !> State of a dynamic relaxation in progress.
  type, extends(visited_t) :: relaxation_state_t
    integer :: n = 0                      !! cycles so far, 0 where it has not begun or is over
    real(wp) :: time = 0.0_wp             !! time of the relaxation, s; the time of the run stays
                                          !! zero
    real(wp) :: most = 0.0_wp             !! largest kinetic energy
    real(wp), allocatable :: velocity(:, :) !! (2, n_node) initial velocities of the run
  contains
    procedure :: visit => visit_relaxation
  end type relaxation_state_t

  !> State of one rigid wall.
  type, extends(visited_t) :: wall_state_t
    real(wp), allocatable :: force(:) !! (nodes of the wall) normal force on each node, N/m
    real(wp), allocatable :: speed(:) !! (nodes of the wall) normal velocity before the force, m/s
    real(wp), allocatable :: friction(:)   !! (nodes of the wall, none without friction) tangential
                                           !! force on each node, N/m
    real(wp), allocatable :: slip_speed(:) !! (as `friction`) tangential velocity before the force,
                                           !! m/s
    real(wp) :: velocity = 0.0_wp     !! of the wall along its normal, v(n-1/2)
    real(wp) :: displacement = 0.0_wp !! of the wall along its normal, u(n)
    real(wp) :: impulse = 0.0_wp      !! accumulated normal impulse, N s/m
    real(wp) :: work = 0.0_wp         !! accumulated work on the nodes, J/m; negative: dissipated by
                                      !! impacts and friction
    real(wp) :: dissipated = 0.0_wp   !! accumulated dissipation by friction, J/m
  contains
    procedure :: visit => visit_wall
  end type wall_state_t

  !> State of a run.
  type, extends(visited_t) :: state_t
    integer :: cycle = 0
    real(wp) :: time = 0.0_wp
    real(wp) :: dt = 0.0_wp                    !! step from t(n) to t(n+1)
    real(wp) :: dt_before = 0.0_wp             !! step from t(n-1) to t(n), 0 at the start
    real(wp), allocatable :: motion(:, :)      !! (4, n_node) u_x, u_y, v_x, v_y
    real(wp), allocatable :: mass(:)           !! (n_node) lumped mass
    real(wp), allocatable :: inverse_mass(:, :) !! (2, n_node) 1/m, 0 where the motion is prescribed
    real(wp), allocatable :: contact_mass(:)   !! (n_special) mass in contact: lumped, or of a rigid
                                               !! body
    real(wp), allocatable :: force_special(:, :) !! (2, n_special) contact + external force
    real(wp), allocatable :: external(:, :)    !! (2, n_special) external force; allocated where the
                                               !! deck has loads
    real(wp), allocatable :: force_slots(:, :) !! (2, force slots) internal force, tile by tile
    real(wp), allocatable :: internal_force(:, :) !! (2, n_node) divergence of stress; at interior
                                                  !! nodes only in cycles that write
    real(wp), allocatable :: prescribed_velocity(:) !! (n_motion) v(n-1/2); v(n+1/2) from the end of
                                                    !! the cycle
    real(wp), allocatable :: previous_velocity(:, :) !! (2, n_node) v(n-3/2); v(n-1/2) once the
                                                     !! damping work is summed; allocated in damped
                                                     !! runs
    real(wp), allocatable :: node_damping(:, :) !! (2, n_node) D of each node, 1/s; allocated where
                                                !! the deck damps parts
    real(wp), allocatable :: previous_damping(:, :) !! (2, n_node) `node_damping` of the previous
                                                    !! step
    real(wp) :: previous_dt = 0.0_wp           !! step of v(n-3/2), s
    real(wp), allocatable :: acceleration(:, :) !! (2, n_node) implicit driver: v and a belong to
                                                !! the instant of u
    real(wp) :: body_acceleration(2) = 0.0_wp  !! of *LOAD_BODY at `time`
    type(relaxation_state_t) :: relaxation     !! of the phase before time zero
    type(block_state_t) :: elements
    type(contact_state_t), allocatable :: contacts(:)
    type(contact_estimate_t), allocatable :: estimates(:) !! error estimates of the interfaces of
                                                          !! the deck
    type(contact_t), allocatable :: interfaces(:) !! interfaces with their current surfaces, without
                                                !! eroded elements
    type(rigid_state_t), allocatable :: rigids(:)
    type(wall_state_t), allocatable :: walls(:) !! allocated where the deck has rigid walls
    real(wp), allocatable :: boundary_force(:, :) !! (3, n_boundary) x, y and moment about z of the
                                                  !! rows of bndout; this and boundary_work are
                                                  !! allocated where the deck asks for bndout
    real(wp), allocatable :: boundary_work(:)  !! (n_boundary) accumulated work, J/m
    integer :: boundary_since = 0              !! cycle in which the accumulation begins
    real(wp), allocatable :: group_force(:, :) !! (2, n) internal force of the nodes of nodfor; the
                                               !! three group arrays are allocated where the deck
                                               !! asks for nodfor
    real(wp), allocatable :: group_velocity(:, :) !! (2, n) v(n-1/2)
    real(wp), allocatable :: group_work(:)     !! (n)
    real(wp), allocatable :: cut_force(:, :)   !! (8, n) forces of the elements of cross sections on
                                               !! their corners, x and y of each; allocated where
                                               !! the deck has cross sections
    real(wp), allocatable :: quiet_since(:)    !! (end conditions) time since which an interface has
                                               !! had no force, s; below 0: it has force. Allocated
                                               !! where the deck has end conditions
    real(wp) :: external_work = 0.0_wp
    real(wp) :: damping_work = 0.0_wp
    real(wp) :: initial_energy = 0.0_wp
    real(wp) :: largest_energy = 0.0_wp !! largest |initial energy + external work| so far; explicit
                                        !! runs with contact
  contains
    procedure :: visit => visit_state
  end type state_t

contains

  !> Visit the components of the state.
  subroutine visit_state(self, visitor)
    class(state_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor
    logical :: is_new

    call visitor%visit('cycle', self%cycle, 0, huge(1) - 1, 'a cycle that no run reaches')
    call visitor%visit('time', self%time, 0.0_wp, 'a time below zero')
    call visitor%visit('dt', self%dt)
    call visitor%expect('dt', self%dt > 0.0_wp, 'a step that is not positive')
    call visitor%visit('dt_before', self%dt_before, 0.0_wp, 'a step below zero')
    call visitor%visit('motion', self%motion, of_nodes)
    if (allocated(self%motion)) visitor%n_node = size(self%motion, 2)
    call visitor%visit('mass', self%mass, of_nodes, 0.0_wp, 'masses below zero')
    call visitor%visit('inverse_mass', self%inverse_mass, of_nodes)
    call visitor%visit('contact_mass', self%contact_mass)
    call visitor%visit('force_special', self%force_special)
    call visitor%visit('external', self%external)
    call visitor%visit('force_slots', self%force_slots, of_forces)
    call visitor%visit('internal_force', self%internal_force, of_nodes)
    call visitor%visit('prescribed_velocity', self%prescribed_velocity)
    call visitor%visit('previous_velocity', self%previous_velocity, of_nodes)
    call visitor%visit('node_damping', self%node_damping, of_nodes)
    call visitor%visit('previous_damping', self%previous_damping, of_nodes)
    call visitor%visit('previous_dt', self%previous_dt)
    call visitor%visit('acceleration', self%acceleration, of_nodes)
    call visitor%fixed('body_acceleration', self%body_acceleration)
    call visitor%part('relaxation', self%relaxation)
    call visitor%part('elements', self%elements)
    call visitor%each('contacts', self%contacts)
    call visitor%each('estimates', self%estimates)
    call visitor%each('rigids', self%rigids)
    call visitor%each('walls', self%walls)
    call visit_asked_table(visitor, 'boundary_force', self%boundary_force)
    call visit_asked(visitor, 'boundary_work', self%boundary_work, is_new)
    if (is_new) self%boundary_since = self%cycle
    call visit_asked_table(visitor, 'group_force', self%group_force)
    call visit_asked_table(visitor, 'group_velocity', self%group_velocity)
    call visit_asked(visitor, 'group_work', self%group_work, is_new)
    call visitor%visit('cut_force', self%cut_force)
    call visitor%visit('quiet_since', self%quiet_since)
    call visitor%visit('external_work', self%external_work)
    call visitor%visit('damping_work', self%damping_work)
    call visitor%visit('initial_energy', self%initial_energy)
    call visitor%visit('largest_energy', self%largest_energy)
  end subroutine visit_state

  !> Visit accumulated values of a history. If the restarted run asks for other rows, they begin at
  !> zero.
  subroutine visit_asked(visitor, name, values, is_new)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    real(wp), allocatable, intent(inout) :: values(:)
    logical, intent(out) :: is_new !! the values begin at zero here
    real(wp), allocatable :: kept(:)

    is_new = .false.
    if (visitor%is_partial) return
    if (allocated(values)) kept = values
    call visitor%visit(name, kept, any_length)
    is_new = length(values) /= length(kept)
    if (allocated(values) .and. .not. is_new) values = kept
  end subroutine visit_asked

  !> Visit vectors of a history. If the restarted run asks for other rows, they begin at zero.
  subroutine visit_asked_table(visitor, name, values)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    real(wp), allocatable, intent(inout) :: values(:, :)
    real(wp), allocatable :: kept(:, :)

    if (visitor%is_partial) return
    if (allocated(values)) kept = values
    call visitor%visit(name, kept, any_length)
    if (.not. allocated(values) .or. .not. allocated(kept)) return
    if (all(shape(kept) == shape(values))) values = kept
  end subroutine visit_asked_table

  !> Visit the components of the relaxation state.
  subroutine visit_relaxation(self, visitor)
    class(relaxation_state_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('n', self%n)
    call visitor%visit('time', self%time, 0.0_wp, 'a time below zero')
    call visitor%visit('most', self%most)
    call visitor%visit('velocity', self%velocity, any_length)
  end subroutine visit_relaxation

  !> Visit the components of the wall state.
  subroutine visit_wall(self, visitor)
    class(wall_state_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('force', self%force)
    call visitor%visit('speed', self%speed)
    call visitor%visit('velocity', self%velocity)
    call visitor%visit('displacement', self%displacement)
    call visitor%visit('impulse', self%impulse)
    call visitor%visit('work', self%work)
    call visitor%visit('friction', self%friction)
    call visitor%visit('slip_speed', self%slip_speed)
    call visitor%visit('dissipated', self%dissipated)
  end subroutine visit_wall

end module state_m
