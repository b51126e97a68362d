! SPDX-License-Identifier: MIT
!> Stress of the elements at contact surfaces, extrapolated to the segments, and contact pressure of
!> other interfaces on the same segments: the total pressure balances the stress
!> (doc/theory/contact.md, section 8.1).
module face_stress_m
  use element_mass_m, only : element_shares
  use element_state_m, only : is_eroded, stress_of_slot
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use model_m, only : model_t
  use snapshot_m, only : slave_result_t
  use state_m, only : state_t
  use stress_error_m, only : energy_density
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: face_rows_t, find_face_rows, face_pressure, face_inertia, elastic_energy, has_stress, &
    position_of, other_pressure_t, find_other_pressures, face_share

  !> Corners and edges of an element; a triangle repeats its third node.
  integer, parameter :: n_corner = 4

  !> Elements at contact surfaces and the elements across their edges.
  type :: face_rows_t
    integer, allocatable :: elements(:)  !! (n_row)
    integer, allocatable :: row_of(:)    !! (n_element) row of an element, 0: none
    integer, allocatable :: across(:, :) !! (4, n_row) element across the edge from node k to node k
                                         !! + 1, 0: none
    logical :: are_shared = .false.      !! interfaces share nodes
  end type face_rows_t

  !> Contact pressure of other interfaces at the nodes of one side, Pa.
  type :: other_pressure_t
    real(wp), allocatable :: pressure(:)
    real(wp), allocatable :: area(:) !! area of each node, half of each segment, m or m^2 per radian
  end type other_pressure_t

  !> A segment of a side; sides are the slave and the master of each interface.
  type :: face_t
    integer :: side = 0
    integer :: element = 0             !! element at the segment
    integer :: ends(2) = 0             !! local numbers of its nodes in the side
    integer :: nodes(2) = 0            !! the nodes in the mesh
  end type face_t

contains

  !> Find the elements at contact surfaces and their neighbours, once. With erosion all elements,
  !> since erosion exposes new surfaces.
  subroutine find_face_rows(model, rows)
    type(model_t), intent(in) :: model
    type(face_rows_t), intent(inout) :: rows
    logical, allocatable :: is_behind(:)
    integer, allocatable :: user(:) !! an interface of each node
    integer :: i

    if (allocated(rows%elements)) return
    allocate (is_behind(model%mesh%n_element), source=model%erodes)
    do i = 1, size(model%contacts)
      is_behind(model%contacts(i)%slave%segment_element) = .true.
      is_behind(model%contacts(i)%master%segment_element) = .true.
    end do
    allocate (rows%elements(count(is_behind)))
    rows%elements = pack([(i, i=1, size(is_behind))], is_behind)
    allocate (rows%row_of(size(is_behind)), source=0)
    rows%row_of(rows%elements) = [(i, i=1, size(rows%elements))]
    call list_opposite_elements(model, rows)
    ! With erosion a node may come into several interfaces.
    if (size(model%contacts) < 2) return
    rows%are_shared = model%erodes
    allocate (user(model%mesh%n_node), source=0)
    do i = 1, size(model%contacts)
      associate (slave => model%contacts(i)%slave%nodes, master => model%contacts(i)%master%nodes)
        rows%are_shared = rows%are_shared .or. any(user(slave) > 0) .or. any(user(master) > 0)
        user(slave) = i
        user(master) = i
      end associate
    end do
  end subroutine find_face_rows

  !> List the elements across the edges. An edge that one element has from a to b, its neighbour has
  !> from b to a.
  subroutine list_opposite_elements(model, rows)
    type(model_t), intent(in) :: model
    type(face_rows_t), intent(inout) :: rows
    integer, allocatable :: first(:), next(:) !! edges of the rows by their first node
    integer :: i, k, edge, slot, a

    allocate (rows%across(n_corner, size(rows%elements)), first(model%mesh%n_node), &
      next(size(rows%across)), source=0)
    do i = 1, size(rows%elements)
      do k = 1, n_corner
        a = model%layout%slot_nodes(k, model%layout%element_slot(rows%elements(i)))
        edge = n_corner*(i - 1) + k
        next(edge) = first(a)
        first(a) = edge
      end do
    end do
    do slot = 1, model%layout%n_slot
      if (model%layout%slot_element(slot) == 0) cycle
      do k = 1, n_corner
        associate (nodes => model%layout%slot_nodes(:, slot))
          edge = first(nodes(mod(k, n_corner) + 1))
          do while (edge > 0)
            i = (edge - 1)/n_corner + 1
            associate (other => model%layout%element_slot(rows%elements(i)))
              a = model%layout%slot_nodes(mod(edge, n_corner) + 1, other) ! at which it ends
              if (a == nodes(k) .and. other /= slot) &
                rows%across(edge - n_corner*(i - 1), i) = model%layout%slot_element(slot)
            end associate
            edge = next(edge)
          end do
        end associate
      end do
    end do
  end subroutine list_opposite_elements

  !> Whether the stress of an element balances the contact pressure: not in rigid bodies, eroded
  !> elements, and elements whose nodes are all fixed or prescribed.
  pure function has_stress(model, state, element) result(has)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: element
    logical :: has

    associate (slot => model%layout%element_slot(element))
      has = .not. (model%materials(model%parts(slot_part(model%layout, slot))%material)%is_rigid &
        .or. is_eroded(state%elements, slot)) &
        .and. any(state%inverse_mass(:, model%layout%slot_nodes(:, slot)) > 0.0_wp)
    end associate
  end function has_stress

  !> Pressure -n.s.n of a body at a segment: that of the element, extrapolated along the normal with
  !> the difference to the next element inside, if there is one.
  function face_pressure(model, state, rows, element, ends) result(pressure)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(face_rows_t), intent(in) :: rows
    integer, intent(in) :: element, ends(2) !! element at the segment; nodes of the segment
    real(wp) :: pressure
    real(wp) :: ends_at(2, 2), normal(2), depth, beyond_depth
    integer :: beyond

    ends_at(:, 1) = position_of(model, state, ends(1))
    ends_at(:, 2) = position_of(model, state, ends(2))
    normal = [ends_at(2, 2) - ends_at(2, 1), ends_at(1, 1) - ends_at(1, 2)]
    normal = normal/max(norm2(normal), tiny(1.0_wp))
    pressure = normal_pressure(model, state, element, normal)
    beyond = opposite_element(model, rows, element, ends)
    if (beyond == 0) return
    if (.not. has_stress(model, state, beyond)) return
    associate (middle => 0.5_wp*(ends_at(:, 1) + ends_at(:, 2)))
      depth = dot_product(middle - centre_of(model, state, element), normal)
      beyond_depth = dot_product(middle - centre_of(model, state, beyond), normal)
    end associate
    ! Where elements fold a small difference of depths would multiply that of the pressures.
    if (.not. beyond_depth - depth > abs(depth)) return
    pressure = pressure + (pressure - normal_pressure(model, state, beyond, normal)) &
      *(depth/(beyond_depth - depth))
  end function face_pressure

  !> Inertia force of an element at the ends of a segment, against the normal: the part of the
  !> pressure that `face_pressure` does not contain. The acceleration of the next row, which the
  !> extrapolation contains, is subtracted.
  function face_inertia(model, state, rows, element, ends) result(force)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(face_rows_t), intent(in) :: rows
    integer, intent(in) :: element, ends(2) !! element at the segment; nodes of the segment
    real(wp) :: force(2)
    real(wp) :: normal(2), shares(4), a(2)
    logical :: is_carried
    integer :: k, j, beyond

    force = 0.0_wp
    normal = position_of(model, state, ends(2)) - position_of(model, state, ends(1))
    normal = [normal(2), -normal(1)]/max(norm2(normal), tiny(1.0_wp))
    beyond = opposite_element(model, rows, element, ends)
    is_carried = .false.
    if (beyond > 0) is_carried = has_stress(model, state, beyond)
    associate (slot => model%layout%element_slot(element))
      shares = element_shares(model, slot)/model%sections(model%parts(slot_part(model%layout, &
        slot))%section)%thickness
      if (allocated(state%elements%mass_ratio)) shares = shares*state%elements%mass_ratio(slot)
      associate (nodes => model%layout%slot_nodes(:, slot))
        if (nodes(4) == nodes(3)) shares(4) = shares(3)
        do k = 1, n_corner
          if (nodes(k) /= ends(1) .or. nodes(mod(k, n_corner) + 1) /= ends(2)) cycle
          do j = 1, 2
            a = acceleration_of(model, state, ends(j))
            if (is_carried) a = a - acceleration_of(model, state, nodes(mod(k + 3 - j, n_corner) &
              + 1))
            force(j) = -shares(mod(k + j - 2, n_corner) + 1)*dot_product(a, normal)
          end do
        end do
      end associate
    end associate
    ! With the consistent mass of implicit runs half of it acts on the next row.
    if (is_carried .and. allocated(state%acceleration)) force = 0.5_wp*force
  end function face_inertia

  !> Acceleration of a node by element and contact forces, m/s^2. Body loads and damping act on all
  !> rows alike and are left out.
  pure function acceleration_of(model, state, node) result(acceleration)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: node
    real(wp) :: acceleration(2)

    if (allocated(state%acceleration)) then
      acceleration = state%acceleration(:, node)
    else
      acceleration = -state%internal_force(:, node)
      if (node <= model%layout%n_special) acceleration = acceleration + state%force_special(:, node)
      acceleration = acceleration*state%inverse_mass(:, node)
    end if
  end function acceleration_of

  !> Pressure -n.s.n of an element.
  pure function normal_pressure(model, state, element, n) result(pressure)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: element
    real(wp), intent(in) :: n(2)
    real(wp) :: pressure
    real(wp) :: s(4)

    s = stress_of_slot(model, state%motion, state%elements, model%layout%element_slot(element))
    pressure = -(s(1)*n(1)**2 + s(2)*n(2)**2 + 2.0_wp*s(4)*n(1)*n(2))
  end function normal_pressure

  !> Element across the edge opposite of a segment, 0: none, or the element is a triangle.
  pure function opposite_element(model, rows, element, ends) result(beyond)
    type(model_t), intent(in) :: model
    type(face_rows_t), intent(in) :: rows
    integer, intent(in) :: element, ends(2)
    integer :: beyond
    integer :: i, k

    beyond = 0
    i = rows%row_of(element)
    if (i == 0) return
    associate (nodes => model%layout%slot_nodes(:, model%layout%element_slot(element)))
      if (nodes(4) == nodes(3)) return
      do k = 1, n_corner
        if (nodes(k) == ends(1) .and. nodes(mod(k, n_corner) + 1) == ends(2)) &
          beyond = rows%across(mod(k + 1, n_corner) + 1, i)
      end do
    end associate
  end function opposite_element

  !> Elastic energy of an element from its stress, or from `stress`, and the moduli of its material,
  !> J per metre or per radian; an estimate for nonlinear laws.
  function elastic_energy(model, state, element, stress) result(energy)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: element
    real(wp), intent(in), optional :: stress(4) !! xx yy zz xy
    real(wp) :: energy
    real(wp) :: s(4), d31(2), d42(2), centre(2), volume

    associate (slot => model%layout%element_slot(element))
      associate (nodes => model%layout%slot_nodes(:, slot), &
        part => model%parts(slot_part(model%layout, slot)))
        s = stress_of_slot(model, state%motion, state%elements, slot)
        if (present(stress)) s = stress
        d31 = position_of(model, state, nodes(3)) - position_of(model, state, nodes(1))
        d42 = position_of(model, state, nodes(4)) - position_of(model, state, nodes(2))
        volume = 0.5_wp*(d31(1)*d42(2) - d42(1)*d31(2))
        centre = centre_of(model, state, element)
        if (model%is_axisymmetric) volume = volume*centre(1)
        volume = volume*model%sections(part%section)%thickness
        energy = volume*energy_density(model%materials(part%material), s)
      end associate
    end associate
  end function elastic_energy

  !> Mean of the corners of an element, m.
  pure function centre_of(model, state, element) result(centre)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: element
    real(wp) :: centre(2)
    integer :: k, n

    centre = 0.0_wp
    associate (nodes => model%layout%slot_nodes(:, model%layout%element_slot(element)))
      n = merge(3, n_corner, nodes(4) == nodes(3))
      do k = 1, n
        centre = centre + position_of(model, state, nodes(k))/n
      end do
    end associate
  end function centre_of

  !> Current position of a node, m.
  pure function position_of(model, state, node) result(place)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: node
    real(wp) :: place(2)

    place = model%mesh%coordinates(:, node) + state%motion(1:2, node)
  end function position_of

  !> Contact pressure of other interfaces on the segments of each side. The pressure of a node acts
  !> on all its segments of an interface.
  subroutine find_other_pressures(model, state, slaves, others)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(slave_result_t), intent(in) :: slaves(:) !! (n_interface)
    type(other_pressure_t), intent(inout) :: others(:) !! (2, interfaces); empty before
    type(surface_t) :: surfaces(size(others))
    type(face_t), allocatable :: faces(:)
    integer, allocatable :: first(:), next(:) !! segments by their first node
    real(wp) :: pressure(2)
    integer :: i, k, m, s

    do i = 1, size(others)/2
      surfaces(2*i - 1) = state%interfaces(i)%slave
      surfaces(2*i) = state%interfaces(i)%master
      ! Self contact has slave nodes only.
      if (state%interfaces(i)%is_self) surfaces(2*i)%n_segment = 0
    end do
    allocate (faces(sum(surfaces%n_segment)), next(sum(surfaces%n_segment)))
    allocate (first(model%mesh%n_node), source=0)
    k = 0
    do i = 1, size(others)
      allocate (others(i)%pressure(surfaces(i)%n_node), others(i)%area(surfaces(i)%n_node), &
        source=0.0_wp)
      do s = 1, surfaces(i)%n_segment
        k = k + 1
        associate (ends => surfaces(i)%segments(:, s))
          faces(k) = face_t(i, surfaces(i)%segment_element(s), ends, surfaces(i)%nodes(ends))
          others(i)%area(ends) = others(i)%area(ends) + face_share(model, state, faces(k)%nodes)
        end associate
        next(k) = first(faces(k)%nodes(1))
        first(faces(k)%nodes(1)) = k
      end do
    end do
    do k = 1, size(faces)
      m = first(faces(k)%nodes(1))
      do while (m > 0)
        if (faces(m)%element == faces(k)%element .and. &
          (faces(m)%side + 1)/2 /= (faces(k)%side + 1)/2) then
          associate (result => slaves((faces(m)%side + 1)/2), &
            mine => others(faces(k)%side)%pressure)
            if (mod(faces(m)%side, 2) == 1) pressure = result%pressure(faces(m)%ends)
            if (mod(faces(m)%side, 2) == 0) pressure = result%master_pressure(faces(m)%ends)
            mine(faces(k)%ends) = mine(faces(k)%ends) + face_share(model, state, faces(k)%nodes) &
              *pressure
          end associate
        end if
        m = next(m)
      end do
    end do
    do i = 1, size(others)
      where (others(i)%area > 0.0_wp) others(i)%pressure = others(i)%pressure/others(i)%area
    end do
  end subroutine find_other_pressures

  !> Area of a segment that belongs to each of its ends, m or m^2 per radian.
  pure function face_share(model, state, nodes) result(share)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: nodes(2)
    real(wp) :: share(2)
    real(wp) :: at(2, 2)

    at = model%mesh%coordinates(:, nodes) + state%motion(1:2, nodes)
    share = 0.5_wp*norm2(at(:, 2) - at(:, 1))
    if (model%is_axisymmetric) share = share*(at(1, :) + sum(at(1, :)))/3.0_wp
  end function face_share

end module face_stress_m
