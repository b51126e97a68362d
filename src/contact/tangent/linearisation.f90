! SPDX-License-Identifier: MIT
!> Linearisation of a contact point: its gap, its site on the master segment and its normal with
!> their derivatives by the displacements of nodes, and its slip (Laursen 2002; Wriggers 2006;
!> doc/theory/contact.md, section 9). What the formulations make of these, areas above all, is
!> built from the same parts. All in dual numbers, so that each formula stands here once.
module linearisation_m
  use arcs_m, only : present_shape, sine_terms, is_flat, steepest, followed, hinge
  use contact_state_m, only : contact_state_t, arc_shape_t, flat_arc
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, n_partial, constant, variable, operator(+), operator(-), operator(*), &
    operator(/), sqrt
  use projection_m, only : side_on, face_on, gentle_vertex, sharp_vertex, round_off, &
    on_bisector
  use friction_m, only : node_beyond
  use geometry_m, only : separation
  use kinds_m, only : wp
  use tributary_lengths_m, only : radius_of
  implicit none
  private
  public :: linearised_point_t, linearised_list_t, linearised_projection_t, n_slot, append_point, &
    difference, length_between, project, way_from, project_point, project_on_arcs, slip_of, &
    between, cosine_between, share_of, side_share_of, radius_at, centroid_of

  !> Nodes that a point depends on, at most.
  integer, parameter :: n_slot = n_partial/2

  !> A point. Its forces act on the nodes in slots 1, 2 (slave side) and `master_slot` and the next
  !> (master side); it may depend on those in the other slots too. A node may stand in several
  !> slots; variable 2 i - 1 is u_x of slot i, 2 i its u_y.
  type :: linearised_point_t
    integer :: nodes(n_slot) = 0   !! local numbers, 0 = slot not used
    integer :: master_slot = 3
    logical :: is_on_vertex = .false. !! projection on a vertex
    type(dual_t) :: turn_beyond    !! in the step, of the neighbour there, which has slot 7
    integer :: site = 0            !! of its traction, and of the tie that it may be left to
    real(wp) :: stiffness = 0.0_wp !! N/m^2 (N/m for type 1)
    type(dual_t) :: slave_xi       !! weights of slots 1, 2 are (1 - xi, xi)
    type(dual_t) :: master_xi      !! of the master slots, likewise
    type(dual_t) :: normal(2)      !! unit, from master to slave
    type(dual_t) :: gap            !! m
    type(dual_t) :: distance       !! of both sides along the normal, m; the gap but between arcs
    type(dual_t) :: shift          !! m, along the master: what arcs add to the projection
    type(dual_t) :: area           !! m
    type(dual_t) :: length         !! what a largest traction counts times: 1, or m for type 1
  end type linearised_point_t

  !> Points of an interface.
  type :: linearised_list_t
    integer :: n = 0
    type(linearised_point_t), allocatable :: points(:) !! the first n
  end type linearised_list_t

  !> A projection on the line of a segment.
  type :: linearised_projection_t
    type(dual_t) :: xi        !! 0 to 1 on the segment
    type(dual_t) :: gap       !! m
    type(dual_t) :: normal(2) !! of the segment
  end type linearised_projection_t

contains

  !> Append a point.
  pure subroutine append_point(list, point)
    type(linearised_list_t), intent(inout) :: list
    type(linearised_point_t), intent(in) :: point
    type(linearised_point_t), allocatable :: longer(:)

    if (.not. allocated(list%points)) allocate (list%points(16))
    if (list%n == size(list%points)) then
      allocate (longer(2*list%n))
      longer(:list%n) = list%points
      call move_alloc(longer, list%points)
    end if
    list%n = list%n + 1
    list%points(list%n) = point
  end subroutine append_point

  !> Vector from the node in slot j of a point to that in slot i, m.
  pure function difference(positions, point, i, j) result(d)
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    type(linearised_point_t), intent(in) :: point
    integer, intent(in) :: i, j
    type(dual_t) :: d(2)

    d = constant(separation(positions(:, point%nodes(i)), &
      positions(:, point%nodes(j))))
    d(1)%slope(2*i - 1) = 1.0_wp
    d(2)%slope(2*i) = 1.0_wp
    d(1)%slope(2*j - 1) = d(1)%slope(2*j - 1) - 1.0_wp
    d(2)%slope(2*j) = d(2)%slope(2*j) - 1.0_wp
  end function difference

  !> Distance between the nodes in slots i and j, m.
  pure function length_between(positions, point, i, j) result(length)
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    type(linearised_point_t), intent(in) :: point
    integer, intent(in) :: i, j
    type(dual_t) :: length, d(2)

    d = difference(positions, point, i, j)
    length = sqrt(d(1)*d(1) + d(2)*d(2))
  end function length_between

  !> A value at xi between those of both nodes of a segment.
  pure function between(ends, xi) result(value)
    real(wp), intent(in) :: ends(2)
    type(dual_t), intent(in) :: xi
    type(dual_t) :: value

    value = (ends(2) - ends(1))*xi + ends(1)
  end function between

  !> Projection on the line of a segment t of a position at d from its first node: xi = d.t/t.t,
  !> g = d.n, n = (t_y, -t_x)/|t|.
  pure function project(d, t) result(projection)
    type(dual_t), intent(in) :: d(2), t(2)
    type(linearised_projection_t) :: projection
    type(dual_t) :: square, length

    square = t(1)*t(1) + t(2)*t(2)
    length = sqrt(square)
    projection%xi = (d(1)*t(1) + d(2)*t(2))/square
    projection%gap = (d(1)*t(2) - d(2)*t(1))/length
    projection%normal = [t(2)/length, -(t(1)/length)]
  end function project

  !> Vector from the node in slot i to the slave side of a point, which is slot 1 where slot 2 is
  !> not used.
  pure function way_from(positions, point, i) result(d)
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    type(linearised_point_t), intent(in) :: point
    integer, intent(in) :: i
    type(dual_t) :: d(2)

    d = difference(positions, point, 1, i)
    if (point%nodes(2) > 0) d = d + point%slave_xi*difference(positions, point, 2, 1)
  end function way_from

  !> Gap, site and normal of a point over the segment in slots 3, 4, like those known: on the line
  !> of the segment, or at its node at a corner, where the normal points along the connection, or
  !> is held if the node is so close that this means nothing.
  pure subroutine project_point(contact, memory, xi, gap, normal, point)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(in) :: xi, gap, normal(2) !! known; gap in m
    type(linearised_point_t), intent(inout) :: point
    type(linearised_projection_t) :: projection
    type(dual_t) :: d(2), t(2)
    logical :: is_corner

    d = way_from(memory%positions, point, 3)
    t = difference(memory%positions, point, 4, 3)
    projection = project(d, t)
    point%is_on_vertex = .false.
    is_corner = .not. (abs(xi) > 0.0_wp .and. abs(xi - 1.0_wp) > 0.0_wp)
    if (memory%has%arcs) is_corner = is_corner &
      .and. is_flat(present_shape(memory, point%nodes(3)))
    if (is_corner) is_corner = norm2(projection%normal%value - normal) > round_off
    if (is_corner) then
      projection%xi = constant(xi)
      d = d - xi*t
      if (abs(gap) > max(memory%closed_gap, on_bisector*norm2(t%value))) then
        projection%gap = sign(1.0_wp, gap)*sqrt(d(1)*d(1) + d(2)*d(2))
        projection%normal = [d(1)/projection%gap, d(2)/projection%gap]
      else
        projection%gap = normal(1)*d(1) + normal(2)*d(2)
        projection%normal = constant(normal)
      end if
      if (memory%has%friction) then
        point%nodes(7) = node_beyond(contact, memory, point%nodes(3:4), xi, &
          projection%normal%value)
        point%is_on_vertex = point%nodes(7) > 0
        if (point%is_on_vertex) point%turn_beyond = turn_of(memory%positions, &
          memory%scratch%increment, point, merge(7, 4, xi < 0.5_wp), merge(3, 7, xi < 0.5_wp))
      end if
    end if
    point%distance = projection%gap
    point%shift = constant(0.0_wp)
    if (memory%has%arcs) call project_on_arcs(memory, point, 3, d, t, projection)
    point%master_xi = projection%xi
    point%gap = projection%gap
    point%normal = projection%normal
    point%length = constant(1.0_wp)
  end subroutine project_point

  !> Let a projection on a segment be that on its arc, of a point on the arc of its own segment
  !> (`arcs_m`).
  pure subroutine project_on_arcs(memory, point, owner, d, t, projection)
    type(contact_state_t), intent(in) :: memory
    type(linearised_point_t), intent(inout) :: point !! out: its distance; nodes beside the segment
                                                     !! in slots 7, 8, beside its own in 9, 10
    integer, intent(in) :: owner        !! first slot of the segment
    type(dual_t), intent(in) :: d(2)    !! from its first node to the point, m
    type(dual_t), intent(in) :: t(2)    !! the segment, m
    type(linearised_projection_t), intent(inout) :: projection
    type(dual_t) :: own(2), off(2), length, unit(2), normal(2), across, above, xi, shift, sine
    type(dual_t) :: cosine
    type(dual_t) :: bend, skew, height
    type(arc_shape_t) :: own_shape

    own_shape = flat_arc
    if (owner == 3 .and. point%nodes(2) > 0) then
      if (point%slave_xi%value*(1.0_wp - point%slave_xi%value) > 0.0_wp) &
        own_shape = present_shape(memory, point%nodes(1))
    end if
    if (is_flat(present_shape(memory, point%nodes(owner))) .and. is_flat(own_shape)) return
    off = constant([0.0_wp, 0.0_wp])
    if (.not. is_flat(own_shape)) then
      own = difference(memory%positions, point, 2, 1)
      call linearise_shape(memory, point, 1, 9, own, bend, skew)
      call find_height(bend, skew, point%slave_xi, height, sine)
      off = [height*own(2), -(height*own(1))]
    end if
    call linearise_shape(memory, point, owner, 7, t, bend, skew)
    length = sqrt(t(1)*t(1) + t(2)*t(2))
    unit = [t(1)/length, t(2)/length]
    normal = [unit(2), -unit(1)]
    across = d(1)*normal(1) + d(2)*normal(2)
    above = across + off(1)*normal(1) + off(2)*normal(2)
    xi = ((d(1) + off(1))*unit(1) + (d(2) + off(2))*unit(2))/length
    call find_height(bend, skew, xi, height, sine)
    shift = shift_to_projection(bend, skew, xi, (above/length - height)*sqrt(1.0_wp - sine*sine), &
      sine)
    call find_height(bend, skew, xi + shift, height, sine)
    cosine = sqrt(1.0_wp - sine*sine)
    projection%gap = (above - height*length)*cosine + shift*length*sine
    projection%normal = [normal(1)*cosine - unit(1)*sine, normal(2)*cosine - unit(2)*sine]
    point%shift = across*sine/cosine
    projection%xi = (d(1)*unit(1) + d(2)*unit(2) + point%shift)/length
    point%distance = across/cosine
  end subroutine project_on_arcs

  !> Shape of the arc of a segment.
  pure subroutine linearise_shape(memory, point, owner, beside, t, bend, skew)
    type(contact_state_t), intent(in) :: memory
    type(linearised_point_t), intent(inout) :: point !! out: the nodes beside the segment
    integer, intent(in) :: owner     !! first slot of the segment
    integer, intent(in) :: beside    !! first slot of these
    type(dual_t), intent(in) :: t(2) !! the segment, m
    type(dual_t), intent(out) :: bend, skew
    type(dual_t) :: sines(2), other(2), turn
    integer :: ends(2), k

    ends = point%nodes(owner:owner + 1)
    sines = constant([0.0_wp, 0.0_wp])
    associate (arcs => memory%arcs, share => memory%arcs%share(:, ends(1)))
      do k = 1, 2
        if (.not. share(k) > 0.0_wp) cycle
        point%nodes(beside + k - 1) = arcs%beside(k, ends(k))
        other = difference(memory%positions, point, merge(owner, beside + 1, k == 1), &
          merge(beside, owner + 1, k == 1))
        if (k == 1) then
          turn = half_turn(other, t)
        else
          turn = half_turn(t, other)
        end if
        turn = faded(turn, arcs%turn(ends(k)))
        associate (terms => sine_terms(share(k)))
          sines(k) = (2.0_wp*share(k))*turn/sqrt(turn*turn*(terms(2)*turn*turn + terms(1)) + 1.0_wp)
        end associate
      end do
      if (share(1) < 0.0_wp) sines(1) = sines(2)
      if (share(2) < 0.0_wp) sines(2) = sines(1)
    end associate
    bend = sines(1) + sines(2)
    skew = 0.5_wp*(sines(1) - sines(2))
  end subroutine linearise_shape

  !> As much of a turn as an arc follows (`arcs_m`): none of one the other way, or at a hinge.
  pure function faded(turn, initial) result(part)
    type(dual_t), intent(in) :: turn
    real(wp), intent(in) :: initial !! turn at time zero
    type(dual_t) :: part

    part = constant(0.0_wp)
    if (turn%value/initial < hinge .and. turn%value*initial > 0.0_wp) part = turn
    if (turn%value/initial > followed) part = (1.0_wp/(hinge - followed))*(part*(hinge &
      - (1.0_wp/initial)*turn))
  end function faded

  !> Tangent of half the turn from one segment to the next.
  pure function half_turn(a, b) result(turn)
    type(dual_t), intent(in) :: a(2), b(2) !! these, m
    type(dual_t) :: turn

    turn = (a(1)*b(2) - a(2)*b(1))/(sqrt((a(1)*a(1) + a(2)*a(2))*(b(1)*b(1) + b(2)*b(2))) &
      + (a(1)*b(1) + a(2)*b(2)))
  end function half_turn

  !> Height of an arc over its secant as a part of the length of that, and the sine of its angle to
  !> it (`arcs_m`).
  pure subroutine find_height(bend, skew, xi, height, sine)
    type(dual_t), intent(in) :: bend, skew
    type(dual_t), intent(in) :: xi
    type(dual_t), intent(out) :: height, sine
    type(dual_t) :: x, circle
    type(dual_t) :: end_sine

    x = xi
    if (abs(xi%value - 0.5_wp) > 0.5_wp) x = constant(merge(0.0_wp, 1.0_wp, xi%value < 0.5_wp))
    circle = bend*(0.5_wp - x)
    if (abs(circle%value) > steepest) circle = constant(sign(steepest, circle%value))
    end_sine = 0.5_wp*bend
    if (abs(end_sine%value) > steepest) end_sine = constant(steepest)
    sine = circle + skew*(1.0_wp - 6.0_wp*x*(1.0_wp - x))
    if (abs(sine%value) > steepest) sine = constant(sign(steepest, sine%value))
    height = x*(1.0_wp - x)*(bend/(sqrt(1.0_wp - circle*circle) + sqrt(1.0_wp &
      - end_sine*end_sine)) + skew*(1.0_wp - 2.0_wp*x)) + (xi - x)*sine/sqrt(1.0_wp - sine*sine)
  end subroutine find_height

  !> Newton step from above a place on an arc to the place whose normal goes through the point
  !> (`arcs_m`).
  pure function shift_to_projection(bend, skew, xi, gap, sine) result(shift)
    type(dual_t), intent(in) :: bend, skew, xi, gap, sine !! gap as a part of the secant
    type(dual_t) :: shift, fall

    fall = bend + 6.0_wp*skew*(1.0_wp - 2.0_wp*xi)
    if (abs(xi%value - 0.5_wp) > 0.5_wp) fall = constant(0.0_wp)
    fall = gap*fall + 1.0_wp
    if (fall%value < 0.5_wp) fall = constant(0.5_wp)
    shift = gap*sine/fall
  end function shift_to_projection

  !> Slip of a point in the step over the segment in slots 3, 4, m: L d(xi). Where slot 4 is not
  !> used the segment that has the normal is the slave's.
  pure function slip_of(positions, increments, point) result(slip)
    real(wp), intent(in), contiguous :: positions(:, :)  !! (4, n_node) of the interface
    real(wp), intent(in), contiguous :: increments(:, :) !! (2, n_node) displacements of the step, m
    type(linearised_point_t), intent(in) :: point
    type(dual_t) :: slip
    type(dual_t) :: relative(2), turn
    integer :: owner

    relative = moved(increments, point, 1) - moved(increments, point, 3)
    if (point%nodes(2) > 0) relative = relative + point%slave_xi &
      *(moved(increments, point, 2) - moved(increments, point, 1))
    owner = 1
    if (point%nodes(4) > 0) then
      owner = 3
      relative = relative &
        - point%master_xi*(moved(increments, point, 4) - moved(increments, point, 3))
    end if
    turn = turn_of(positions, increments, point, owner, owner + 1)
    if (point%is_on_vertex) turn = 0.5_wp*(turn + point%turn_beyond)
    slip = point%normal(1)*relative(2) - point%normal(2)*relative(1) + point%distance*turn
  end function slip_of

  !> Turn in the step of the segment from the node in slot i to that in slot j, clockwise.
  pure function turn_of(positions, increments, point, i, j) result(turn)
    real(wp), intent(in), contiguous :: positions(:, :)  !! (4, n_node) of the interface
    real(wp), intent(in), contiguous :: increments(:, :) !! (2, n_node) displacements of the step, m
    type(linearised_point_t), intent(in) :: point
    integer, intent(in) :: i, j
    type(dual_t) :: turn, t(2), change(2)

    t = difference(positions, point, j, i)
    change = moved(increments, point, j) - moved(increments, point, i)
    turn = (t(2)*change(1) - t(1)*change(2))/(t(1)*t(1) + t(2)*t(2))
  end function turn_of

  !> Displacement of the node in slot i in the step, m.
  pure function moved(increments, point, i) result(du)
    real(wp), intent(in), contiguous :: increments(:, :) !! (2, n_node) displacements of the step, m
    type(linearised_point_t), intent(in) :: point
    integer, intent(in) :: i
    type(dual_t) :: du(2)

    du = constant(increments(:, point%nodes(i)))
    du(1)%slope(2*i - 1) = 1.0_wp
    du(2)%slope(2*i) = 1.0_wp
  end function moved

  !> Cosine between two vectors.
  pure function cosine_between(a, b) result(cosine)
    type(dual_t), intent(in) :: a(2), b(2)
    type(dual_t) :: cosine

    cosine = (a(1)*b(1) + a(2)*b(2))/sqrt((a(1)*a(1) + a(2)*a(2))*(b(1)*b(1) + b(2)*b(2)))
  end function cosine_between

  !> Share of a segment that counts as opposed, by the cosine between outward normals.
  pure function share_of(cosine) result(share)
    type(dual_t), intent(in) :: cosine
    type(dual_t) :: share

    share = smooth_step((1.0_wp/(side_on - face_on))*(side_on - cosine))
  end function share_of

  !> Share of a segment next to a convex vertex (`side_share`).
  pure function side_share_of(turn, excess, range) result(share)
    type(dual_t), intent(in) :: turn, excess
    real(wp), intent(in) :: range(2)
    type(dual_t) :: share

    share = 1.0_wp - smooth_step((1.0_wp/(sharp_vertex - gentle_vertex))*(1.0_wp - gentle_vertex &
      - turn))*smooth_step((1.0_wp/(range(2) - range(1)))*(excess - constant(range(1))))
  end function side_share_of

  !> A step from 0 to 1 with slopes of zero.
  pure function smooth_step(along) result(share)
    type(dual_t), intent(in) :: along
    type(dual_t) :: share

    share = constant(min(max(along%value, 0.0_wp), 1.0_wp))
    if (along%value > 0.0_wp .and. along%value < 1.0_wp) share = along*along*(3.0_wp - 2.0_wp*along)
  end function smooth_step

  !> In axisymmetry: radius at xi of the segment in slots i, j, m.
  pure function radius_at(positions, point, i, j, xi) result(radius)
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    type(linearised_point_t), intent(in) :: point
    integer, intent(in) :: i, j
    type(dual_t), intent(in) :: xi
    type(dual_t) :: radius, t(2)

    radius = variable(radius_of(positions(:, point%nodes(i))), 2*i - 1)
    t = difference(positions, point, j, i)
    radius = radius + xi*t(1)
  end function radius_at

  !> Centre by radius of a stretch of the segment in slots i, j; the middle where nothing has
  !> weight.
  pure function centroid_of(positions, point, i, j, range) result(xi)
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    type(linearised_point_t), intent(in) :: point
    integer, intent(in) :: i, j
    type(dual_t), intent(in) :: range(2) !! its ends, 0 to 1
    type(dual_t) :: xi, first, last

    xi = 0.5_wp*(range(1) + range(2))
    first = radius_at(positions, point, i, j, range(1))
    last = radius_at(positions, point, i, j, range(2))
    if (first%value + last%value > tiny(1.0_wp)) &
      xi = xi + (1.0_wp/6.0_wp)*((range(2) - range(1))*(last - first)/(first + last))
  end function centroid_of

end module linearisation_m
