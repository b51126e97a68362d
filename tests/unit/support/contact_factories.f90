! SPDX-License-Identifier: MIT
!> Contact problems for tests: two surfaces given by their nodes, an element behind every segment.
module contact_factories_m
  use clock_m, only : clock_t
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  use log_m, only : log_t
  use model_m, only : model_t
  use parts_m, only : part_t, material_t
  use surfaces_m, only : surface_t, link_segments
  implicit none
  private
  public :: problem_t, make_problem, cut_chain, line, polygon, slave_master_moment, bulk_modulus

  real(wp), parameter :: bulk_modulus = 1.0e9_wp

  !> One interface with all that a step needs.
  type :: problem_t
    type(model_t) :: model
    type(contact_t) :: contact
    type(contact_state_t) :: memory
    type(clock_t) :: clock
    type(log_t) :: log
    real(wp), allocatable :: motion(:, :) !! (4, n_node) u and v
    real(wp), allocatable :: mass(:)      !! (n_node)
    real(wp), allocatable :: force(:, :)  !! (2, n_node)
    real(wp) :: time = 0.0_wp
    integer :: cycle = 0
  end type problem_t

contains

  !> Surfaces through the given nodes, walked with the body on the left; `thickness` of the row of elements
  !> behind them. Nodes of the mesh: slave surface, master surface, then those inside. Type, penalty and
  !> so on of `problem%contact` are the caller's; start_contact comes after that.
  subroutine make_problem(problem, slave, master, thickness, slave_is_closed, master_is_closed)
    type(problem_t), intent(out) :: problem
    real(wp), intent(in) :: slave(:, :), master(:, :) !! (2, n)
    real(wp), intent(in) :: thickness
    logical, intent(in), optional :: slave_is_closed, master_is_closed
    logical :: closed(2)
    integer :: ns, nm, n, i

    ns = size(slave, 2)
    nm = size(master, 2)
    n = ns + nm
    closed = .false.
    if (present(slave_is_closed)) closed(1) = slave_is_closed
    if (present(master_is_closed)) closed(2) = master_is_closed
    call make_chain(problem%contact%slave, 0, ns, closed(1), 0)
    call make_chain(problem%contact%master, ns, nm, closed(2), problem%contact%slave%n_segment)
    problem%contact%id = 1
    problem%contact%penalty = 1.0e6_wp
    associate (mesh => problem%model%mesh)
      mesh%n_node = 2*n
      mesh%n_element = problem%contact%slave%n_segment + problem%contact%master%n_segment
      mesh%node_id = [(1000 + i, i=1, 2*n)]
      allocate (mesh%coordinates(2, 2*n), mesh%element_nodes(4, mesh%n_element))
      mesh%coordinates(:, :ns) = slave
      mesh%coordinates(:, ns + 1:n) = master
      mesh%element_part = [(1, i=1, problem%contact%slave%n_segment), &
        (2, i=1, problem%contact%master%n_segment)]
      call fill_behind(problem%contact%slave, n, thickness, mesh%coordinates, mesh%element_nodes)
      call fill_behind(problem%contact%master, n, thickness, mesh%coordinates, mesh%element_nodes)
    end associate
    allocate (problem%model%parts(2), problem%model%materials(1))
    problem%model%parts%material = 1
    problem%model%materials(1)%bulk = bulk_modulus
    allocate (problem%motion(4, 2*n), problem%force(2, 2*n), source=0.0_wp)
    allocate (problem%mass(2*n), source=1.0_wp)
  end subroutine make_problem

  !> Surface through `n` mesh nodes after `offset`, its elements after `first_element`.
  subroutine make_chain(surface, offset, n, is_closed, first_element)
    type(surface_t), intent(out) :: surface
    integer, intent(in) :: offset, n, first_element
    logical, intent(in) :: is_closed
    integer :: i, n_segment

    n_segment = merge(n, n - 1, is_closed)
    surface%nodes = [(offset + i, i=1, n)]
    allocate (surface%segments(2, n_segment))
    do i = 1, n_segment
      surface%segments(:, i) = [i, 1 + modulo(i, n)]
    end do
    surface%segment_element = [(first_element + i, i=1, n_segment)]
    call link_segments(surface)
  end subroutine make_chain

  !> Take segments out of a surface, so that several remain.
  subroutine cut_chain(surface, dropped)
    type(surface_t), intent(inout) :: surface
    integer, intent(in) :: dropped(:) !! segments
    integer :: i
    integer, allocatable :: kept(:)

    kept = pack([(i, i=1, surface%n_segment)], [(all(dropped /= i), i=1, surface%n_segment)])
    surface%segments = surface%segments(:, kept)
    surface%segment_element = surface%segment_element(kept)
    call link_segments(surface)
  end subroutine cut_chain

  !> The nodes and elements behind a surface: to the left of it.
  subroutine fill_behind(surface, offset, thickness, x, elements)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: offset
    real(wp), intent(in) :: thickness
    real(wp), intent(inout) :: x(:, :)
    integer, intent(inout) :: elements(:, :)
    real(wp) :: t(2)
    integer :: i, before, after

    do i = 1, surface%n_node
      before = i
      after = i
      if (surface%incoming(i) > 0) before = surface%segments(1, surface%incoming(i))
      if (surface%outgoing(i) > 0) after = surface%segments(2, surface%outgoing(i))
      t = x(:, surface%nodes(after)) - x(:, surface%nodes(before))
      t = t/norm2(t)
      x(:, offset + surface%nodes(i)) = x(:, surface%nodes(i)) + thickness*[-t(2), t(1)]
    end do
    do i = 1, surface%n_segment
      associate (ends => surface%nodes(surface%segments(:, i)))
        elements(:, surface%segment_element(i)) = [ends(1), ends(2), offset + ends(2), &
          offset + ends(1)]
      end associate
    end do
  end subroutine fill_behind

  !> n + 1 nodes from a to b at equal distances.
  pure function line(a, b, n) result(x)
    real(wp), intent(in) :: a(2), b(2)
    integer, intent(in) :: n
    real(wp) :: x(2, n + 1)
    integer :: i

    do i = 0, n
      x(:, i + 1) = a + (b - a)*(real(i, wp)/n)
    end do
  end function line

  !> n nodes of a regular polygon about `centre`, counter-clockwise.
  pure function polygon(centre, radius, n) result(x)
    real(wp), intent(in) :: centre(2), radius
    integer, intent(in) :: n
    real(wp) :: x(2, n)
    integer :: i

    do i = 1, n
      x(:, i) = centre + radius*[cos(6.283185307179586_wp*i/n), sin(6.283185307179586_wp*i/n)]
    end do
  end function polygon

  !> Moment of the contact forces about the first node, from differences of positions.
  pure function slave_master_moment(memory) result(moment)
    type(contact_state_t), intent(in) :: memory
    real(wp) :: moment, d(2)
    integer :: i

    moment = 0.0_wp
    do i = 1, size(memory%nodes)
      d = (memory%positions(1:2, i) - memory%positions(1:2, 1)) &
        + (memory%positions(3:4, i) - memory%positions(3:4, 1))
      moment = moment + d(1)*memory%force(2, i) - d(2)*memory%force(1, i)
    end do
  end function slave_master_moment

end module contact_factories_m
