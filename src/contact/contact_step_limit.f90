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
  use contact_spring_ratios_m, only : spring_ratios
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t, is_tied
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: spring_bound_t, bound_springs, bound_each, stable_step, closed_step, opening_step, &
    binding_bound, fitting_scale, approach_step, sharpness

  !> What is known of the springs at the nodes of one interface, those of other interfaces there
  !> included.
  type, extends(visited_t) :: spring_bound_t
    real(wp) :: rate = 0.0_wp     !! bound of omega^2, 1/s^2
    real(wp) :: damping = 0.0_wp  !! sum of damping fraction times omega, 1/s
    integer :: node = 0           !! where the bound is taken: index in the mesh
    real(wp) :: closed_rate = 0.0_wp !! the part of it of ties, which never open, 1/s^2
  contains
    procedure :: visit => visit_springs
  end type spring_bound_t

  !> K/m of the nodes of one interface.
  type :: ratios_t
    real(wp), allocatable :: at(:)    !! (n_slave + n_master)
    real(wp) :: c = 1.0_wp            !! share between its sides
  end type ratios_t

  !> How far the bounds may lie below the step that eigenvalues allow: the least of the ratios in
  !> doc/studies/stability.md.
  real(wp), parameter :: sharpness = 0.78_wp

  !> Part of the depth of a first contact by which bodies may come nearer in a step.
  real(wp), parameter :: approach_share = 0.8_wp

  !> Rounds over all interfaces, and halvings of the interval of log c: any c is safe, more only
  !> sharpen the bound.
  integer, parameter :: n_round = 20, n_halving = 40

contains

  !> Bounds of all interfaces together, each penalty times its `scale`.
  pure subroutine bound_springs(contacts, mass, memories, scale, bounds)
    type(contact_t), intent(in) :: contacts(:)
    real(wp), intent(in) :: mass(:)                      !! (n_node) kg/m
    type(contact_state_t), intent(in) :: memories(:)
    real(wp), intent(in) :: scale(:)                     !! (n_interface) 0 or more
    type(spring_bound_t), intent(out) :: bounds(:)       !! (n_interface)
    integer :: number(size(mass))

    number = 0
    call bound_group(contacts, mass, memories, scale, number, bounds)
  end subroutine bound_springs

  !> Bounds of all interfaces, of each as if there were no other one.
  pure subroutine bound_each(contacts, mass, memories, scale, bounds)
    type(contact_t), intent(in) :: contacts(:)
    real(wp), intent(in) :: mass(:)
    type(contact_state_t), intent(in) :: memories(:)
    real(wp), intent(in) :: scale(:)
    type(spring_bound_t), intent(out) :: bounds(:)
    integer :: number(size(mass)), i

    number = 0
    do i = 1, size(contacts)
      call bound_group(contacts(i:i), mass, memories(i:i), scale(i:i), number, bounds(i:i))
    end do
  end subroutine bound_each

  !> Bounds of some interfaces together.
  pure subroutine bound_group(contacts, mass, memories, scale, number, bounds)
    type(contact_t), intent(in) :: contacts(:)
    real(wp), intent(in) :: mass(:)
    type(contact_state_t), intent(in) :: memories(:)
    real(wp), intent(in) :: scale(:)
    integer, intent(inout) :: number(:) !! (n_node) room of the nodes' numbers in the group, 0
                                        !! between calls
    type(spring_bound_t), intent(inout) :: bounds(:)
    type(ratios_t) :: ratios(size(contacts))
    integer :: i, n, n_node, worst(2)
    logical :: are_joined

    n_node = 0
    are_joined = .false.
    do i = 1, size(contacts)
      n = memories(i)%n_slave
      ratios(i)%at = scale(i)*spring_ratios(contacts(i), mass, memories(i))
      worst = [maxloc(ratios(i)%at(:n), 1), n + maxloc(ratios(i)%at(n + 1:), 1)]
      associate (most => ratios(i)%at(worst), nodes => memories(i)%nodes)
        bounds(i)%rate = sum(most)
        if (is_tied(contacts(i))) bounds(i)%closed_rate = bounds(i)%rate
        bounds(i)%damping = contacts(i)%damping*sqrt(bounds(i)%rate*merge(2.0_wp, 1.0_wp, &
          contacts(i)%is_self))
        bounds(i)%node = nodes(worst(merge(1, 2, most(1) >= most(2))))
        if (all(most > 0.0_wp) .and. .not. contacts(i)%is_self) ratios(i)%c = most(2)/most(1)
        if (.not. scale(i) > 0.0_wp) cycle
        call number_nodes(nodes(:n), number, n_node, are_joined)
        call number_nodes(nodes(n + 1:), number, n_node, are_joined)
      end associate
    end do
    if (are_joined) then
      do i = 1, size(contacts)
        call number_nodes(memories(i)%nodes, number, n_node, are_joined)
      end do
      call join_interfaces(contacts, memories, number, n_node, ratios, bounds)
    end if
    do i = 1, size(contacts)
      number(memories(i)%nodes) = 0
    end do
  end subroutine bound_group

  !> Number the nodes of a side that have no number yet.
  pure subroutine number_nodes(nodes, number, n, are_shared)
    integer, intent(in) :: nodes(:)
    integer, intent(inout) :: number(:)    !! (n_node of the mesh)
    integer, intent(inout) :: n            !! numbers so far
    logical, intent(inout) :: are_shared   !! some node has a number from another side
    integer :: k, before

    before = n
    do k = 1, size(nodes)
      associate (at => number(nodes(k)))
        are_shared = are_shared .or. (at > 0 .and. at <= before)
        if (at > 0) cycle
        n = n + 1
        at = n
      end associate
    end do
  end subroutine number_nodes

  !> Interfaces that share nodes: the c of each in turn evens out its sides, as the others stand.
  !> A surface with itself has each node on both sides, evenly.
  pure subroutine join_interfaces(contacts, memories, number, n_node, ratios, bounds)
    type(contact_t), intent(in) :: contacts(:)
    type(contact_state_t), intent(in) :: memories(:)
    integer, intent(in) :: number(:) !! (n_node of the mesh) 1 to n_node where they have any
    integer, intent(in) :: n_node
    type(ratios_t), intent(inout) :: ratios(:)
    type(spring_bound_t), intent(inout) :: bounds(:)
    real(wp) :: total(n_node), opening(n_node), damping(n_node)
    integer :: i, round

    total = 0.0_wp
    damping = 0.0_wp
    do i = 1, size(memories)
      call add_sides(number(memories(i)%nodes), memories(i)%n_slave, 1.0_wp, ratios(i), total)
      call add_damping(number(memories(i)%nodes), bounds(i)%damping, damping)
    end do
    do round = 1, n_round
      do i = 1, size(memories)
        if (contacts(i)%is_self) cycle
        associate (nodes => number(memories(i)%nodes), n_slave => memories(i)%n_slave)
          call add_sides(nodes, n_slave, -1.0_wp, ratios(i), total)
          ratios(i)%c = even_share(ratios(i), n_slave, max(total(nodes), 0.0_wp))
          call add_sides(nodes, n_slave, 1.0_wp, ratios(i), total)
        end associate
      end do
    end do
    opening = total
    do i = 1, size(memories)
      if (is_tied(contacts(i))) call add_sides(number(memories(i)%nodes), memories(i)%n_slave, &
        -1.0_wp, ratios(i), opening)
    end do
    do i = 1, size(memories)
      associate (nodes => number(memories(i)%nodes))
        bounds(i)%rate = maxval(total(nodes))
        bounds(i)%closed_rate = merge(bounds(i)%rate, bounds(i)%rate - maxval(opening(nodes)), &
          is_tied(contacts(i)))
        bounds(i)%node = memories(i)%nodes(maxloc(total(nodes), 1))
        bounds(i)%damping = maxval(damping(nodes))
      end associate
    end do
  end subroutine join_interfaces

  !> What an interface puts on its nodes, times `sign`.
  pure subroutine add_sides(nodes, n_slave, sign, ratios, total)
    integer, intent(in) :: nodes(:), n_slave
    real(wp), intent(in) :: sign
    type(ratios_t), intent(in) :: ratios
    real(wp), intent(inout) :: total(:) !! by number of the node
    real(wp) :: load(size(nodes))
    integer :: k

    load = weighted(ratios, n_slave, ratios%c)
    do k = 1, size(nodes)
      total(nodes(k)) = total(nodes(k)) + sign*load(k)
    end do
  end subroutine add_sides

  !> The damping of an interface on each of its nodes, once.
  pure subroutine add_damping(nodes, damping, total)
    integer, intent(in) :: nodes(:)
    real(wp), intent(in) :: damping
    real(wp), intent(inout) :: total(:) !! by number of the node
    real(wp) :: before(size(nodes))
    integer :: k

    before = total(nodes)
    do k = 1, size(nodes)
      total(nodes(k)) = before(k) + damping
    end do
  end subroutine add_damping

  !> (1 + c) K/m of slave nodes and (1 + 1/c) K/m of master nodes.
  pure function weighted(ratios, n_slave, c)
    type(ratios_t), intent(in) :: ratios
    integer, intent(in) :: n_slave
    real(wp), intent(in) :: c
    real(wp) :: weighted(size(ratios%at))

    weighted(:n_slave) = (1.0_wp + c)*ratios%at(:n_slave)
    weighted(n_slave + 1:) = (1.0_wp + 1.0_wp/c)*ratios%at(n_slave + 1:)
  end function weighted

  !> The c for which both sides of an interface are loaded alike, on top of what others put on the
  !> nodes.
  pure function even_share(ratios, n_slave, others) result(c)
    type(ratios_t), intent(in) :: ratios
    integer, intent(in) :: n_slave
    real(wp), intent(in) :: others(:) !! (n_slave + n_master)
    real(wp) :: c
    real(wp) :: low, high, load(size(others))
    integer :: i

    low = log(ratios%c) - 10.0_wp
    high = low + 20.0_wp
    do i = 1, n_halving
      c = exp(0.5_wp*(low + high))
      load = others + weighted(ratios, n_slave, c)
      if (maxval(load(:n_slave)) > maxval(load(n_slave + 1:))) then
        high = log(c)
      else
        low = log(c)
      end if
    end do
  end function even_share

  !> Largest stable step of elements and contact springs, s; without springs that of the elements.
  pure elemental function stable_step(element_limit, bound) result(limit)
    real(wp), intent(in) :: element_limit !! s
    type(spring_bound_t), intent(in) :: bound
    real(wp) :: limit

    limit = min(closed_step(element_limit, bound), opening_step(bound))
  end function stable_step

  !> Step in which nothing comes deeper than a first contact may be, from the relative motion in a
  !> step `dt`; huge where that is slow, and where the deck says what counts as a first contact
  !> (ties, a depth of its own). Alarms of the search are no part of it: they depend on when it last
  !> looked.
  pure function approach_step(contact, memory, dt) result(limit)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(in) :: dt             !! s
    real(wp) :: limit
    real(wp) :: depth

    limit = huge(limit)
    if (is_tied(contact) .or. contact%search_depth > 0.0_wp) return
    depth = min(memory%slave_status%shallowest, memory%master_status%shallowest)
    depth = approach_share*depth
    if (memory%advance > 0.01_wp*depth) limit = dt*(depth/memory%advance)
  end function approach_step

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

  !> Its components.
  subroutine visit_springs(self, visitor)
    class(spring_bound_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('rate', self%rate)
    call visitor%visit('damping', self%damping)
    call visitor%visit('node', self%node, 0, visitor%n_node, 'a number that no node has')
    call visitor%visit('closed_rate', self%closed_rate)
  end subroutine visit_springs

end module contact_step_limit_m
