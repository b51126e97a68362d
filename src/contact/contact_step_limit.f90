! SPDX-License-Identifier: MIT
!> The step that the penalty springs of all interfaces and the elements allow together.
!> With springs k_p between weighted means of slave and master nodes,
!> (s - m)^2 <= (1 + c) s^2 + (1 + 1/c) m^2 for any c > 0 and the convexity of the square give
!>
!>     omega^2 <= max over nodes of sum over interfaces of
!>                (1 + c) K/m (slave side) or (1 + 1/c) K/m (master side),
!>
!> with a c of each interface and the ratios K/m of `spring_ratios`. One interface alone: c = B/A
!> gives max_s K/m + max_m K/m = A + B, exact for two masses and one spring. Averaging the gaps of
!> points over slave nodes only lowers omega: by convexity again the energy is no more than that of
!> springs at the points.
!> Squares of frequencies of elements and springs add up at most. That is the bound of springs that
!> stay closed. One that only pushes may not turn its mass round in the step in which it closes
!> (doc/theory/contact.md, section 7). Everything here obeys both bounds.
module contact_step_limit_m
  use contact_dispatch_m, only : formulation_t, formulation_of, is_strict
  use contact_state_m, only : contact_state_t, n_side
  use contacts_m, only : contact_t
  use geometry_m, only : segment_length
  use kinds_m, only : wp
  use law_state_m, only : is_held, is_broken
  use tributary_lengths_m, only : end_radius, nodal_area
  use surfaces_m, only : surface_t, open_ends
  use ties_m, only : tie_spring_t, tie_spring, has_state, tied_nodes
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: spring_bound_t, spring_ratios, contact_ratios, bound_springs, stable_step, &
    closed_step, opening_step, binding_bound, fitting_scale, sharpness

  !> What is known of the springs at the nodes of one interface, those of other interfaces there
  !> included.
  type, extends(visited_t) :: spring_bound_t
    real(wp) :: rate = 0.0_wp     !! bound of omega^2, 1/s^2
    real(wp) :: damping = 0.0_wp  !! sum of damping fraction times omega, 1/s
    integer :: node = 0           !! where the bound is taken: index in the mesh
    real(wp) :: closed_rate = 0.0_wp !! the part of it of ties, which do not open, 1/s^2
  contains
    procedure :: visit => visit_springs
  end type spring_bound_t

  !> Segments and nodes of a side.
  type :: side_t
    real(wp), allocatable :: length(:) !! (n_segment) m
    real(wp), allocatable :: radius(:) !! (n_node) m; 1 in the plane
    real(wp), allocatable :: area(:)   !! (n_node) tributary length, m; by radius, m^2
    real(wp) :: slope = 0.0_wp         !! most change of the radius by length: 1; 0 in the plane
  end type side_t

  !> K/m of the nodes of one interface.
  type :: ratios_t
    real(wp), allocatable :: at(:) !! (n_slave + n_master)
  end type ratios_t

  !> How far the bounds may lie below the step that eigenvalues allow: the least of the ratios in
  !> doc/studies/stability.md.
  real(wp), parameter :: sharpness = 0.78_wp

  !> Part of a slave segment that points at the end of a master may stand for beyond it.
  real(wp), parameter :: beyond_ends = 0.5_wp

  !> Most rounds over all interfaces, and how far sides may be loaded unlike after them: any c is
  !> safe, more rounds only raise the bound.
  integer, parameter :: n_round = 40
  real(wp), parameter :: even = 1.0e-6_wp
  !> The c, or 1/c, of an interface of which one side alone has springs.
  real(wp), parameter :: beyond_all = 1.0e30_wp

contains

  !> Bounds of all interfaces together, each penalty times its `scale`.
  pure subroutine bound_springs(contacts, mass, memories, scale, bounds)
    type(contact_t), intent(in) :: contacts(:)
    real(wp), intent(in) :: mass(:)                      !! (n_node) kg/m
    type(contact_state_t), intent(in) :: memories(:)
    real(wp), intent(in) :: scale(:)                     !! (n_interface) 0 or more
    type(spring_bound_t), intent(out) :: bounds(:)       !! (n_interface)
    type(ratios_t), dimension(size(contacts)) :: ratios, opening
    real(wp), dimension(size(mass)) :: total, opens, damping
    integer :: i

    damping = 0.0_wp
    do i = 1, size(contacts)
      ratios(i)%at = scale(i)*spring_ratios(contacts(i), mass, memories(i))
      opening(i) = ratios(i)
      if (memories(i)%has%ties) opening(i)%at = scale(i)*opening_ratios(contacts(i), mass, &
        memories(i))
      associate (most => most_of_sides(memories(i)%n_slave, opening(i)%at))
        call add_once(memories(i)%nodes, contacts(i)%damping*sqrt(sum(most) &
          *merge(2.0_wp, 1.0_wp, contacts(i)%is_self)), damping)
      end associate
    end do
    call add_up(contacts, memories, ratios, total)
    opens = total
    if (any(memories%has%ties)) call add_up(contacts, memories, opening, opens)
    do i = 1, size(contacts)
      associate (nodes => memories(i)%nodes)
        bounds(i)%rate = maxval(total(nodes))
        bounds(i)%closed_rate = bounds(i)%rate
        if (memories(i)%has%contact) bounds(i)%closed_rate = bounds(i)%rate - maxval(opens(nodes))
        bounds(i)%node = nodes(maxloc(ratios(i)%at, 1))
        bounds(i)%damping = maxval(damping(nodes))
      end associate
    end do
  end subroutine bound_springs

  !> The sum over the interfaces at each node of the mesh. The c of all are evened out together:
  !> each goes half the way, by its logarithm, to where the two sides of its interface would be
  !> loaded alike. An interface alone is there from the start. A surface with itself has each node
  !> on both sides, evenly; where one side has no springs the other bears them alone.
  pure subroutine add_up(contacts, memories, ratios, total)
    type(contact_t), intent(in) :: contacts(:)
    type(contact_state_t), intent(in) :: memories(:)
    type(ratios_t), intent(in) :: ratios(:)
    real(wp), intent(out) :: total(:) !! (n_node of the mesh)
    real(wp), dimension(size(ratios)) :: c, uneven
    real(wp) :: most(2)
    integer :: i, k, round

    c = 1.0_wp
    do i = 1, size(ratios)
      most = most_of_sides(memories(i)%n_slave, ratios(i)%at)
      if (.not. contacts(i)%is_self) c(i) = min(max(most(2)/max(most(1), tiny(1.0_wp)), &
        1.0_wp/beyond_all), beyond_all)
    end do
    do round = 1, n_round
      total = 0.0_wp
      do i = 1, size(ratios)
        associate (nodes => memories(i)%nodes, at => ratios(i)%at, n => memories(i)%n_slave)
          do k = 1, size(nodes)
            total(nodes(k)) = total(nodes(k)) + (1.0_wp + merge(c(i), 1.0_wp/c(i), k <= n))*at(k)
          end do
        end associate
      end do
      uneven = 1.0_wp
      do i = 1, size(ratios)
        if (contacts(i)%is_self .or. c(i) <= 1.0_wp/beyond_all .or. c(i) >= beyond_all) cycle
        most = most_of_sides(memories(i)%n_slave, total(memories(i)%nodes))
        uneven(i) = most(2)/most(1)
      end do
      if (all(abs(uneven - 1.0_wp) < even)) return
      c = c*sqrt(uneven)
    end do
  end subroutine add_up

  !> The most on the slave nodes and on the master nodes of an interface.
  pure function most_of_sides(n_slave, values) result(most)
    integer, intent(in) :: n_slave
    real(wp), intent(in) :: values(:) !! (n_slave + n_master) 0 or more
    real(wp) :: most(2)

    most = max(0.0_wp, [maxval(values(:n_slave)), maxval(values(n_slave + 1:))])
  end function most_of_sides

  !> Add a value to each of some nodes once, though some stand there several times.
  pure subroutine add_once(nodes, value, total)
    integer, intent(in) :: nodes(:)
    real(wp), intent(in) :: value
    real(wp), intent(inout) :: total(:) !! (n_node of the mesh)
    real(wp) :: before(size(nodes))
    integer :: k

    before = total(nodes)
    do k = 1, size(nodes)
      total(nodes(k)) = before(k) + value
    end do
  end subroutine add_once

  !> Most K/m of each node, K being the sum of spring stiffness times weight, 1/s^2, for the
  !> positions in the memory: of what ties hold, and of contact.
  pure function spring_ratios(contact, mass, memory) result(ratio)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: mass(:) !! (n_node) kg/m
    type(contact_state_t), intent(in) :: memory
    real(wp) :: ratio(memory%n_slave + memory%n_master) !! slave nodes, then master nodes

    ratio = opening_ratios(contact, mass, memory)
    if (memory%has%ties) ratio = ratio + tie_stiffness(memory)/mass(memory%nodes)
  end function spring_ratios

  !> Most that ties hold each node with, so that the sum over nodes of K u^2 bounds twice their
  !> energy, slave and master side each for itself: (sum of |a| |u|)^2 <= sum of |a| times sum of
  !> |a| u^2, with a the weights and, on the nodes of the segment, what its turn moves at the
  !> distance |d|. Averages over slave nodes only lower it.
  pure function tie_stiffness(memory) result(stiffness)
    type(contact_state_t), intent(in) :: memory
    real(wp) :: stiffness(memory%n_slave + memory%n_master) !! N/m
    type(tie_spring_t) :: spring
    real(wp) :: turn, sums(n_side), k, turning
    integer :: s, p, i

    stiffness = 0.0_wp
    if (memory%tie_points%n == 0) return
    associate (points => memory%tie_points, ties => memory%ties)
      do s = 1, size(ties%side)
        if (.not. has_state(memory, s, [is_held])) cycle
        spring = tie_spring(ties, points, memory%positions, s)
        turn = norm2(spring%d)/spring%length
        do p = ties%first(s), ties%first(s + 1) - 1
          k = points%stiffness(p)*points%area(p)
          sums = [sum(abs(points%slave_weights(:, p))), sum(abs(points%master_weights(:, p)))]
          i = merge(2, 1, ties%side(s) > 0.0_wp)
          sums(i) = sums(i) + 2.0_wp*turn
          turning = k*sums(i)*turn
          do i = 1, n_side
            associate (a => stiffness(points%slave_nodes(i, p)))
              a = a + k*sums(1)*abs(points%slave_weights(i, p))
            end associate
            associate (b => stiffness(points%master_nodes(i, p)))
              b = b + k*sums(2)*abs(points%master_weights(i, p))
            end associate
            associate (c => stiffness(ties%owner(i, s)))
              c = c + turning
            end associate
          end do
        end do
      end do
    end associate
  end function tie_stiffness

  !> The part of contact. Ties that break leave it the nodes that they do not hold, or not any more
  !> in part, from the start where slave nodes are among them.
  pure function opening_ratios(contact, mass, memory) result(ratio)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: mass(:) !! (n_node) kg/m
    type(contact_state_t), intent(in) :: memory
    real(wp) :: ratio(memory%n_slave + memory%n_master)
    logical :: counts(size(ratio))

    counts = memory%has%contact
    if (memory%has%breaks) counts = tied_nodes(memory, [is_broken]) &
      .or. .not. tied_nodes(memory, [is_held])
    counts = counts .and. any(counts(:memory%n_slave))
    ratio = 0.0_wp
    if (any(counts)) ratio = merge(contact_ratios(contact, mass, memory), 0.0_wp, counts)
  end function opening_ratios

  !> That of contact, all nodes touching: a node of the tracked side carries at most its tributary
  !> length in all formulations, a node of the other side `most_on_nodes`.
  pure function contact_ratios(contact, mass, memory) result(ratio)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: mass(:) !! (n_node) kg/m
    type(contact_state_t), intent(in) :: memory
    real(wp) :: ratio(memory%n_slave + memory%n_master)
    type(formulation_t) :: formulation
    type(side_t) :: slave, plane, master
    real(wp) :: overhang
    logical :: is_lonely

    formulation = formulation_of(contact)
    overhang = beyond_ends
    if (formulation%covers_segments .and. .not. is_strict(contact)) overhang = 0.0_wp
    is_lonely = .false.
    if (contact%is_axisymmetric .and. allocated(memory%segment_points%xi)) &
      is_lonely = size(memory%segment_points%xi) == 1
    associate (n => memory%n_slave)
      slave = measure_side(contact%slave, memory%positions(:, :n), contact%is_axisymmetric, &
        is_lonely)
      master = measure_side(contact%master, memory%positions(:, n + 1:), contact%is_axisymmetric, &
        .false.)
      if (formulation%has_unit_area) then
        plane = measure_side(contact%slave, memory%positions(:, :n), .false., .false.)
        ratio = memory%node_penalty*node_shares(contact, slave, plane, master)
      else
        ratio = memory%slave_penalty*[slave%area, &
          most_on_nodes(contact%master, master, maxval(slave%length), overhang, is_lonely)]
        if (formulation%has_two_passes) ratio = ratio + memory%master_penalty &
          *[most_on_nodes(contact%slave, slave, maxval(master%length), overhang, .false.), &
          master%area]
      end if
    end associate
    ratio = ratio/mass(memory%nodes)
  end function contact_ratios

  !> Lengths, radii and areas of a side; where one Gauss point stands alone on a segment areas are
  !> no less than half of each neighbouring segment by the radius of its middle.
  pure function measure_side(surface, positions, is_axisymmetric, is_lonely) result(side)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node)
    logical, intent(in) :: is_axisymmetric, is_lonely
    type(side_t) :: side
    real(wp) :: middle(surface%n_node)
    integer :: i

    allocate (side%length(surface%n_segment))
    side%radius = [(1.0_wp, i=1, surface%n_node)]
    if (is_axisymmetric) side%radius = positions(1, :) + positions(3, :)
    if (is_axisymmetric) side%slope = 1.0_wp
    middle = 0.0_wp
    do i = 1, surface%n_segment
      associate (ends => surface%segments(:, i))
        side%length(i) = segment_length(positions(:, ends(1)), positions(:, ends(2)))
        middle(ends) = middle(ends) + 0.25_wp*side%length(i)*sum(side%radius(ends))
      end associate
    end do
    side%area = [(nodal_area(surface, positions, is_axisymmetric, i), i=1, surface%n_node)]
    if (is_lonely) side%area = max(side%area, middle)
  end function measure_side

  !> Type 1, where each slave node has the same spring: how much of it each node of both sides can
  !> get, by its hat function over segments of length h with slave nodes at equal distances s and
  !> one at the node itself: s/2 and sum(s (1 - i s/h), i s < h) for each neighbouring segment, and
  !> at ends what lies beyond, over s. In axisymmetry slave nodes weigh with their mean radius, m.
  pure function node_shares(contact, slave, plane, master) result(share)
    type(contact_t), intent(in) :: contact
    type(side_t), intent(in) :: slave, plane, master !! plane: the slave without radii
    real(wp) :: share(size(slave%radius) + size(master%radius))
    real(wp) :: s, largest(size(master%radius)) !! radius on the segments at each node, m
    integer :: i, n, n_slave

    n_slave = size(slave%radius)
    share(:n_slave) = slave%area/max(plane%area, tiny(1.0_wp))
    share(n_slave + 1:) = beyond_ends*open_ends(contact%master)
    largest = 0.0_wp
    s = minval(slave%length)
    do i = 1, contact%master%n_segment
      associate (ends => contact%master%segments(:, i), h => master%length(i))
        n = int(h/s)
        share(n_slave + ends) = share(n_slave + ends) &
          + (0.5_wp + n*(1.0_wp - 0.5_wp*(n + 1)*s/h))
        largest(ends) = max(largest(ends), maxval(master%radius(ends)))
      end associate
    end do
    share(n_slave + 1:) = share(n_slave + 1:)*(largest + slave%slope*maxval(slave%length)/3.0_wp)
  end function node_shares

  !> Most length, or area by radius, that points of the other side can put on each node by its hat
  !> function over segments of length h, at distances up to s or integrating segments of up to s:
  !> the integral of the hat, h/2 or h (2 r_i + r_j)/6, and the largest error of the trapezoidal
  !> rule at its projection, s^2/(8h) times the mean radius there, at most s/6 above that of the
  !> projection; or, where s > 2h, s/2 in all (the midpoint rule errs as much at the top, Gauss
  !> rules less). One Gauss point on a segment errs at the top of the hat, by s^2/12 more since
  !> radius times hat is curved. Points at a surface's end may stand for a part `overhang` of s
  !> beyond it.
  pure function most_on_nodes(surface, side, s, overhang, is_lonely) result(most)
    type(surface_t), intent(in) :: surface
    type(side_t), intent(in) :: side
    real(wp), intent(in) :: s         !! m
    real(wp), intent(in) :: overhang
    logical, intent(in) :: is_lonely  !! one Gauss point on each segment of the other side
    real(wp) :: most(surface%n_node)
    real(wp) :: share
    integer :: ends(surface%n_node), i, k, other

    most = 0.0_wp
    ends = open_ends(surface)
    do i = 1, surface%n_segment
      do k = 1, 2
        associate (node => surface%segments(k, i), near => side%radius(surface%segments(k, i)), &
          far => side%radius(surface%segments(3 - k, i)), h => side%length(i), rise => side%slope)
          if (s <= 2.0_wp*h) then
            share = 0.5_wp*h*end_radius(near, far) &
              + s**2/(8.0_wp*h)*(merge(max(near, far), far, is_lonely) + rise*s/6.0_wp)
          else
            share = 0.5_wp*s*(max(near, far) + rise*s/3.0_wp)
          end if
          if (is_lonely) share = share + s**2/12.0_wp
          other = merge(surface%incoming(node), surface%outgoing(node), k == 1)
          if (other == 0 .and. ends(node) > 0) share = share + overhang*s*(near + rise*s/3.0_wp)
          most(node) = most(node) + share
        end associate
      end do
    end do
  end function most_on_nodes

  !> Largest stable step of elements and contact springs, s; without springs that of the elements.
  pure elemental function stable_step(element_limit, bound) result(limit)
    real(wp), intent(in) :: element_limit !! s
    type(spring_bound_t), intent(in) :: bound
    real(wp) :: limit

    limit = min(closed_step(element_limit, bound), opening_step(bound))
  end function stable_step

  !> Springs that stay closed: the largest dt with
  !> (dt/element_limit)^2 + dt^2 rate/4 + dt damping <= 1, s.
  pure elemental function closed_step(element_limit, bound) result(limit)
    real(wp), intent(in) :: element_limit !! s
    type(spring_bound_t), intent(in) :: bound
    real(wp) :: limit
    real(wp) :: square

    limit = element_limit
    if (.not. bound%rate > 0.0_wp) return
    square = (1.0_wp/element_limit)**2 + 0.25_wp*bound%rate
    limit = 2.0_wp/(bound%damping + sqrt(bound%damping**2 + 4.0_wp*square))
  end function closed_step

  !> Springs that open and close: the largest dt with dt^2 rate + 2 dt damping <= 1, s; half of
  !> what they would allow alone while closed.
  pure elemental function opening_step(bound) result(limit)
    type(spring_bound_t), intent(in) :: bound
    real(wp) :: limit

    limit = huge(1.0_wp)
    if (.not. bound%rate - bound%closed_rate > 0.0_wp) return
    limit = 1.0_wp/(bound%damping + sqrt(bound%damping**2 + (bound%rate - bound%closed_rate)))
  end function opening_step

  !> Which of the two bounds is the smaller step, for messages.
  pure function binding_bound(element_limit, bound) result(name)
    real(wp), intent(in) :: element_limit !! s
    type(spring_bound_t), intent(in) :: bound
    character(:), allocatable :: name

    name = 'springs that stay closed'
    if (opening_step(bound) < closed_step(element_limit, bound)) &
      name = 'springs that open and close'
  end function binding_bound

  !> Factor on the penalties for which the step `dt` is just stable by both bounds; 0 where the
  !> elements leave no room.
  pure elemental function fitting_scale(dt, element_limit, bound) result(scale)
    real(wp), intent(in) :: dt, element_limit !! s
    type(spring_bound_t), intent(in) :: bound !! with a rate above 0
    real(wp) :: scale
    real(wp) :: room

    room = max(1.0_wp - (dt/element_limit)**2, 0.0_wp)
    scale = min(2.0_wp*room/(dt*(bound%damping + sqrt(bound%damping**2 + room*bound%rate))), &
      opening_step(bound)/dt)**2
  end function fitting_scale

  !> Visit the components of the bound of an interface.
  subroutine visit_springs(self, visitor)
    class(spring_bound_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('rate', self%rate)
    call visitor%visit('damping', self%damping)
    call visitor%visit('node', self%node, 0, visitor%n_node, 'a number that no node has')
    call visitor%visit('closed_rate', self%closed_rate)
  end subroutine visit_springs

end module contact_step_limit_m
