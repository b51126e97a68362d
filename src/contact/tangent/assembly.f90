! SPDX-License-Identifier: MIT
!> From linearised points to the tangent of an interface, K = -dF/du: their loads under gaps and
!> slips of their own or averaged at slave nodes, and the matrix (doc/theory/contact.md, sections
!> 9.1, 9.5 and 9.8).
module assembly_m
  use contact_law_m, only : linearise_pressure
  use contact_state_m, only : contact_state_t, n_side, has_offsets
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, n_partial, constant, variable, operator(+), operator(-), operator(*)
  use spring_gaps_m, only : ramp_gaps
  use kinds_m, only : wp
  use friction_m, only : linearise_traction, goes_on
  use law_state_m, only : is_open, slips
  use linearisation_m, only : linearised_list_t, linearised_point_t, n_slot, slip_of, between
  use sparse_m, only : sparse_t, add_block
  use ties_m, only : is_tied_site
  implicit none
  private
  public :: add_point_tangents, add_nodal_tangents, load_point, nodal_share, add_linearised_point, &
    product_t, start_product, add_at_node, add_change, finish_product

  !> A product of two vectors over the nodes of an interface of which few entries are not zero.
  type :: product_t
    integer :: n = 0                      !! nodes in use
    integer, allocatable :: nodes(:)      !! (n_node) the first n: local numbers
    logical, allocatable :: is_used(:)    !! (n_node)
    real(wp), allocatable :: column(:, :) !! (2, n_node) force
    real(wp), allocatable :: row(:, :)    !! (2, n_node) gradient
  end type product_t

  !> What is averaged.
  integer, parameter :: of_gap = 1, of_slip = 2

contains

  !> Points under their own gaps, with friction by their own slips.
  pure subroutine add_point_tangents(contact, memory, list, equations, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(linearised_list_t), intent(in) :: list
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(dual_t) :: pressure, traction
    logical :: acts
    integer :: p

    do p = 1, list%n
      associate (point => list%points(p))
        call load_point(contact, memory, point, acts, pressure, traction)
        if (acts) call add_linearised_point(point, pressure*point%area, traction*point%area, &
          equations, matrix)
      end associate
    end do
  end subroutine add_point_tangents

  !> Pressure and traction of a point, if it acts.
  pure subroutine load_point(contact, memory, point, acts, pressure, traction)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(linearised_point_t), intent(in) :: point
    logical, intent(out) :: acts !! in contact, and not left to a tie
    type(dual_t), intent(out) :: pressure, traction
    type(dual_t) :: gap, previous, slip
    integer :: before

    gap = loaded_gap(memory, point)
    acts = gap%value < memory%closed_gap
    if (acts .and. memory%has%breaks) acts = .not. is_tied_site(memory%ties%state(point%site))
    if (.not. acts) return
    pressure = linearise_pressure(memory%contact_law, point%stiffness, gap)
    traction = constant(0.0_wp)
    if (.not. memory%has%friction) return
    associate (tractions => memory%scratch%previous_traction, &
      states => memory%scratch%previous_state, nodes => point%nodes)
      previous = constant(tractions(point%site))
      before = states(point%site)
      if (nodes(4) == 0 .and. before == is_open) then
        ! A master node that was no point before starts from the ends of its slave segment.
        previous = between(tractions(nodes(:2)), point%slave_xi)
        if (any(states(nodes(:2)) == slips)) before = slips
      end if
    end associate
    slip = slip_of(memory%positions, memory%scratch%increment, point)
    traction = linearise_friction(contact, memory, previous, slip, pressure, point%stiffness, &
      before, point%length)
  end subroutine load_point

  !> Gap of a point that its pressure comes from: with what of its depth does not act, its entry
  !> offset and its initial overlap that has not grown yet. Overlaps of averages are added to these.
  pure function loaded_gap(memory, point) result(gap)
    type(contact_state_t), intent(in) :: memory
    type(linearised_point_t), intent(in) :: point
    type(dual_t) :: gap
    integer :: nodes(2)

    gap = point%gap
    nodes = point%nodes(:2)
    associate (offset => memory%slave_status%offset, site => point%site, &
      remaining => memory%interference%remaining, depth => memory%interference%depth)
      if (has_offsets(memory)) then
        if (memory%has%segment_points) then
          gap = gap + offset(site)
        else if (nodes(2) > 0) then
          gap = gap + between(offset(nodes), point%slave_xi)
        else if (nodes(1) > memory%n_slave) then
          gap = gap + memory%master_status%offset(nodes(1) - memory%n_slave)
        else
          gap = gap + offset(nodes(1))
        end if
      end if
      if (.not. memory%has%interference .or. memory%has%nodal_pressure) return
      if (depth(site) < 0.0_wp .and. point%nodes(4) == 0) then
        gap = gap + remaining*between(max(0.0_wp, depth(nodes)), point%slave_xi)
      else
        gap = gap + remaining*max(0.0_wp, depth(site))
      end if
    end associate
  end function loaded_gap

  !> Traction from the previous one and a slip; in the first tangent of a step, before any motion,
  !> points that slipped before slip.
  pure function linearise_friction(contact, memory, previous, slip, pressure, stiffness, before, &
    length) result(traction)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(dual_t), intent(in) :: previous, slip, pressure !! N/m^2, m, N/m^2
    real(wp), intent(in) :: stiffness                  !! normal, N/m^3
    integer, intent(in) :: before                      !! state at the end of the step before
    type(dual_t), intent(in) :: length                 !! what a largest traction counts times
    type(dual_t) :: traction, most

    most = constant(huge(1.0_wp))
    associate (rule => contact%friction)
      if (rule%most > 0.0_wp) most = rule%most*length
      traction = linearise_traction(rule, previous, slip, pressure, rule%stiffness*stiffness, &
        most, [memory%scratch%dt, memory%scratch%lag], &
        merge(goes_on, before, memory%closed_gap > 0.0_wp .and. before == slips))
    end associate
  end function linearise_friction

  !> Points under pressures and tractions from gaps and slips averaged at slave nodes: the points
  !> under the present nodal values, and for each slave node in contact and each average a product
  !> of the force that a unit of that makes and its gradient. Points of a slave segment follow each
  !> other.
  pure subroutine add_nodal_tangents(contact, memory, list, equations, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(linearised_list_t), intent(in) :: list
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(dual_t) :: values(list%n, 2)
    type(dual_t), dimension(memory%n_slave) :: pressures, tractions
    real(wp) :: means(2, memory%n_slave), areas(memory%n_slave)
    integer :: p

    do p = 1, list%n
      values(p, of_gap) = loaded_gap(memory, list%points(p))
      values(p, of_slip) = constant(0.0_wp)
      if (memory%has%friction) values(p, of_slip) = slip_of(memory%positions, &
        memory%scratch%increment, list%points(p))
    end do
    call average(list, values, means, areas)
    call form_nodal_pressures(contact, memory, means, areas, pressures, tractions)
    do p = 1, list%n
      associate (point => list%points(p), a => list%points(p)%nodes(1), &
        b => list%points(p)%nodes(2))
        if (.not. max(pressures(a)%value, pressures(b)%value) > 0.0_wp) cycle
        call add_linearised_point(point, &
          point%area*between([pressures(a)%value, pressures(b)%value], point%slave_xi), &
          point%area*between([tractions(a)%value, tractions(b)%value], point%slave_xi), &
          equations, matrix)
      end associate
    end do
    call add_averages(contact, list, values, means, areas, pressures, tractions, equations, matrix)
  end subroutine add_nodal_tangents

  !> Means of gaps and slips at the slave nodes, and what these weigh there.
  pure subroutine average(list, values, means, areas)
    type(linearised_list_t), intent(in) :: list
    type(dual_t), intent(in) :: values(:, :) !! (list%n, 2) m
    real(wp), intent(out) :: means(:, :)     !! (2, n_slave) m; 0 where there is no point
    real(wp), intent(out) :: areas(:)        !! (n_slave) m
    type(dual_t) :: share
    integer :: p, k

    means = 0.0_wp
    areas = 0.0_wp
    do p = 1, list%n
      do k = 1, n_side
        share = nodal_share(list%points(p), k)
        associate (node => list%points(p)%nodes(k))
          means(:, node) = means(:, node) + share%value*values(p, :)%value
          areas(node) = areas(node) + share%value
        end associate
      end do
    end do
    means = means/spread(max(areas, tiny(1.0_wp)), 1, 2)
  end subroutine average

  !> Pressures and tractions of the slave nodes, variable 1 the mean gap, 2 the mean slip; without
  !> slopes where nothing acts.
  pure subroutine form_nodal_pressures(contact, memory, means, areas, pressures, tractions)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(in) :: means(:, :), areas(:)
    type(dual_t), intent(out) :: pressures(:), tractions(:) !! (n_slave) N/m^2
    real(wp) :: gaps(memory%n_slave)
    integer :: i

    gaps = means(of_gap, :)
    if (memory%has%interference) call ramp_gaps(memory, gaps)
    pressures = constant(0.0_wp)
    tractions = constant(0.0_wp)
    do i = 1, memory%n_slave
      if (.not. (gaps(i) < memory%closed_gap .and. areas(i) > 0.0_wp)) cycle
      if (memory%has%breaks) then
        if (is_tied_site(memory%ties%state(i))) cycle
      end if
      pressures(i) = linearise_pressure(memory%contact_law, memory%slave_penalty, &
        variable(gaps(i), of_gap))
      if (memory%has%friction) tractions(i) = linearise_friction(contact, memory, &
        constant(memory%scratch%previous_traction(i)), variable(means(of_slip, i), of_slip), &
        pressures(i), memory%slave_penalty, memory%scratch%previous_state(i), constant(1.0_wp))
    end do
  end subroutine form_nodal_pressures

  !> Add what the means of all slave nodes change, by the points on both segments of each.
  pure subroutine add_averages(contact, list, values, means, areas, pressures, tractions, &
      equations, matrix)
    type(contact_t), intent(in) :: contact
    type(linearised_list_t), intent(in) :: list
    type(dual_t), intent(in) :: values(:, :)
    real(wp), intent(in) :: means(:, :), areas(:)
    type(dual_t), intent(in) :: pressures(:), tractions(:)
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    type(product_t) :: product
    type(dual_t) :: share, change
    integer, dimension(contact%slave%n_segment) :: first, last
    integer :: segments(2), i, k, p, q

    first = 1
    last = 0
    do p = list%n, 1, -1
      associate (s => contact%slave%outgoing(list%points(p)%nodes(1)))
        first(s) = p
        if (last(s) == 0) last(s) = p
      end associate
    end do
    call start_product(product, size(equations, 2))
    do i = 1, size(areas)
      segments = [contact%slave%outgoing(i), contact%slave%incoming(i)]
      do q = of_gap, of_slip
        if (.not. max(abs(pressures(i)%slope(q)), abs(tractions(i)%slope(q))) > 0.0_wp) cycle
        do k = 1, 2
          if (segments(k) == 0) cycle
          do p = first(segments(k)), last(segments(k))
            share = nodal_share(list%points(p), k)
            change = share*(values(p, q) + (-means(q, i)))
            call add_change(product, list%points(p), pressures(i)%slope(q)*share%value, &
              tractions(i)%slope(q)*share%value, change%slope)
          end do
        end do
        call finish_product(product, -1.0_wp/areas(i), equations, matrix)
      end do
    end do
  end subroutine add_averages

  !> N_A a at a point, for its k-th slave node.
  pure function nodal_share(point, k) result(share)
    type(linearised_point_t), intent(in) :: point
    integer, intent(in) :: k
    type(dual_t) :: share

    share = point%slave_xi*point%area
    if (k == 1) share = point%area - share
  end function nodal_share

  !> Forces of a point on slots 1, 2 and its master side: load*normal - shear*tangent on the slave
  !> side; the load is pressure times area, the shear traction times area, the tangent (-n_y, n_x).
  pure function forces_of(point, load, shear) result(forces)
    type(linearised_point_t), intent(in) :: point
    type(dual_t), intent(in) :: load, shear
    type(dual_t) :: forces(2, 4)
    type(dual_t) :: pull(2), to_last(2)

    pull = load*point%normal
    if (abs(shear%value) > 0.0_wp .or. any(abs(shear%slope) > 0.0_wp)) &
      pull = pull + [shear*point%normal(2), -(shear*point%normal(1))]
    to_last = point%slave_xi*pull
    forces(:, 2) = to_last
    forces(:, 1) = pull - to_last
    to_last = point%master_xi*pull
    forces(:, 4) = -to_last
    forces(:, 3) = to_last - pull
  end function forces_of

  !> Add a point under its load and shear.
  pure subroutine add_linearised_point(point, load, shear, equations, matrix)
    type(linearised_point_t), intent(in) :: point
    type(dual_t), intent(in) :: load, shear            !! N/m
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(dual_t) :: forces(2, 4)
    real(wp) :: block(8, n_partial)
    integer :: numbers(n_partial), rows(8), k

    numbers = 0
    do k = 1, n_slot
      if (point%nodes(k) > 0) numbers(2*k - 1:2*k) = equations(:, point%nodes(k))
    end do
    associate (i => 2*point%master_slot)
      rows = [numbers(1:4), numbers(i - 1:i + 2)]
    end associate
    forces = forces_of(point, load, shear)
    do k = 1, 4
      block(2*k - 1, :) = -forces(1, k)%slope
      block(2*k, :) = -forces(2, k)%slope
      if (.not. any(abs(block(2*k - 1:2*k, :)) > 0.0_wp)) rows(2*k - 1:2*k) = 0
    end do
    call add_block(matrix, rows, numbers, block)
  end subroutine add_linearised_point

  !> An empty product for an interface of n nodes.
  pure subroutine start_product(product, n)
    type(product_t), intent(out) :: product
    integer, intent(in) :: n

    allocate (product%nodes(n), product%column(2, n), product%row(2, n))
    allocate (product%is_used(n), source=.false.)
  end subroutine start_product

  !> Add a force at a node and a vector there to the gradient.
  pure subroutine add_at_node(product, node, force, gradient)
    type(product_t), intent(inout) :: product
    integer, intent(in) :: node
    real(wp), intent(in) :: force(2), gradient(2)

    if (.not. product%is_used(node)) then
      product%is_used(node) = .true.
      product%n = product%n + 1
      product%nodes(product%n) = node
      product%column(:, node) = 0.0_wp
      product%row(:, node) = 0.0_wp
    end if
    product%column(:, node) = product%column(:, node) + force
    product%row(:, node) = product%row(:, node) + gradient
  end subroutine add_at_node

  !> Add the forces of a point under a load and a shear without derivatives, and derivatives by its
  !> slots to the gradient.
  pure subroutine add_change(product, point, load, shear, slope)
    type(product_t), intent(inout) :: product
    type(linearised_point_t), intent(in) :: point
    real(wp), intent(in) :: load, shear !! N/m
    real(wp), intent(in) :: slope(n_partial)
    real(wp) :: pull(2), weights(n_slot)
    integer :: k

    pull = load*point%normal%value &
      + shear*[point%normal(2)%value, -point%normal(1)%value]
    weights = 0.0_wp
    weights(:2) = [1.0_wp - point%slave_xi%value, point%slave_xi%value]
    associate (at => point%master_slot, xi => point%master_xi%value)
      weights(at:at + 1) = [xi - 1.0_wp, -xi]
    end associate
    do k = 1, n_slot
      if (point%nodes(k) > 0) call add_at_node(product, point%nodes(k), weights(k)*pull, &
        slope(2*k - 1:2*k))
    end do
  end subroutine add_change

  !> Add factor*column*row to the matrix and empty the product.
  pure subroutine finish_product(product, factor, equations, matrix)
    type(product_t), intent(inout) :: product
    real(wp), intent(in) :: factor
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    real(wp) :: column(2*product%n), block(2*product%n, 2)
    integer :: rows(2*product%n), k

    associate (nodes => product%nodes(:product%n))
      column = factor*reshape(product%column(:, nodes), [2*product%n])
      rows = reshape(equations(:, nodes), [2*product%n])
      do k = 1, product%n
        if (.not. any(abs(column(2*k - 1:2*k)) > 0.0_wp)) rows(2*k - 1:2*k) = 0
      end do
      do k = 1, product%n
        block(:, 1) = product%row(1, nodes(k))*column
        block(:, 2) = product%row(2, nodes(k))*column
        call add_block(matrix, rows, equations(:, nodes(k)), block)
      end do
      product%is_used(nodes) = .false.
    end associate
    product%n = 0
  end subroutine finish_product

end module assembly_m
