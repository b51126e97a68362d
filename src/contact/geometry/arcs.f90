! SPDX-License-Identifier: MIT
!> Arcs that the segments of round surfaces stand for: their curvatures from the initial mesh, and
!> contact points between arcs in place of between their secants (doc/theory/contact.md, section
!> 5.9). Forces still go to the two nodes of a segment by linear functions.
module arcs_m
  use contact_state_m, only : arcs_t, contact_state_t, contact_points_t, n_side, site_at
  use contacts_m, only : contact_t
  use geometry_m, only : separation
  use kinds_m, only : wp
  use search_state_m, only : pass_t
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: prepare_arcs, half_turn, find_curvatures, sagitta, curve_points, arc_shape_t, &
    arc_projection_t, project_on_arcs, project_virtual_node, present_shape, sine_at, sine_terms, &
    is_flat, flat_arc, steepest

  !> Turn at one end of a segment, as a part of that at the other, below which it is flat.
  real(wp), parameter :: flat = 0.1_wp
  !> Sine of the turn up to which two segments are straight: inclined lines have some by round-off.
  real(wp), parameter :: straight = 1.0e-6_wp
  !> Ratio of turns below which a line meets the arc at that end: the surface turns by half there.
  real(wp), parameter :: tangent = 0.75_wp
  !> Largest sine of the angle between an arc and its secant.
  real(wp), parameter :: steepest = 0.9_wp
  !> Present over initial turn up to which arcs follow it, and from which on there are none: a
  !> plastic hinge is a corner.
  real(wp), parameter :: followed = 1.5_wp, hinge = 3.0_wp
  !> Parts of the turn at a node that the arc of a segment has there: all where a line meets the
  !> arc, else as its length in that of both. At the end of an open surface it is the mirror image
  !> of the other end.
  real(wp), parameter :: all_of_it = 1.0_wp, mirrored = -1.0_wp

  !> Shape of an arc over its secant: the sine of its angle to the secant is
  !> bend (1/2 - xi) + skew (1 - 6 xi (1 - xi)): normals of neighbours meet at their node.
  type :: arc_shape_t
    real(wp) :: bend !! kappa L
    real(wp) :: skew
  end type arc_shape_t

  !> Shape of a flat segment.
  type(arc_shape_t), parameter :: flat_arc = arc_shape_t(0.0_wp, 0.0_wp)

  !> Projection of a point on the arc over a secant. Without default values, which would be written
  !> before each use.
  type :: arc_projection_t
    real(wp) :: xi        !! on the secant: where the force acts
    real(wp) :: gap       !! m, to the arc
    real(wp) :: offset    !! of that from the gap of the secants, m
    real(wp) :: normal(2) !! of the arc, outward
  end type arc_projection_t

contains

  !> Arcs of both surfaces of an interface; none where all segments are flat.
  pure subroutine prepare_arcs(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory

    associate (arcs => memory%arcs)
      allocate (arcs%share(2, size(memory%nodes)), arcs%turn(size(memory%nodes)), &
        arcs%height(size(memory%nodes)), source=0.0_wp)
      allocate (arcs%beside(2, size(memory%nodes)), source=0)
      call add_surface(contact%slave, contact%largest_turn, 0, memory%positions, arcs)
      call add_surface(contact%master, contact%largest_turn, memory%n_slave, memory%positions, arcs)
      memory%has%arcs = any(arcs%height > 0.0_wp)
      if (.not. memory%has%arcs) return
      arcs%highest = maxval(arcs%height(:memory%n_slave)) + maxval(arcs%height(memory%n_slave + 1:))
      call start_pass(contact%slave, contact%master, 0, memory%n_slave, memory%slave_status%pass)
      call start_pass(contact%master, contact%slave, memory%n_slave, 0, memory%master_status%pass)
    end associate

  contains

    !> Heights of arcs, within which the points of a surface are searched.
    pure subroutine start_pass(own, other, before_own, before_other, pass)
      type(surface_t), intent(in) :: own, other
      integer, intent(in) :: before_own, before_other !! local numbers before their first nodes
      type(pass_t), intent(inout) :: pass

      pass%has_arcs = .true.
      pass%highest = memory%arcs%highest
      pass%own_height = memory%arcs%height(before_own + own%segments(1, :))
      pass%other_height = memory%arcs%height(before_other + other%segments(1, :))
    end subroutine start_pass

  end subroutine prepare_arcs

  !> Arcs of one surface. How far they stand off their secants has a margin for what they bend.
  pure subroutine add_surface(surface, largest_turn, before, positions, arcs)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in) :: largest_turn    !! rad
    integer, intent(in) :: before           !! local number before its first node
    real(wp), intent(in) :: positions(:, :) !! (4, n_node) of the interface
    type(arcs_t), intent(inout) :: arcs
    real(wp) :: curvature(surface%n_segment)
    logical :: meets_corner(surface%n_segment)
    real(wp) :: length(surface%n_segment), part(2)
    integer :: s, k, neighbours(2)

    call find_curvatures(surface, positions(:, before + 1:), largest_turn, curvature, meets_corner)
    do s = 1, surface%n_segment
      associate (ends => before + surface%segments(:, s))
        arcs%beside(2, ends(1)) = ends(2)
        arcs%beside(1, ends(2)) = ends(1)
        length(s) = norm2(positions(1:2, ends(2)) - positions(1:2, ends(1)))
      end associate
    end do
    do s = before + 1, before + surface%n_node
      if (all(arcs%beside(:, s) > 0)) arcs%turn(s) = half_turn( &
        positions(1:2, s) - positions(1:2, arcs%beside(1, s)), &
        positions(1:2, arcs%beside(2, s)) - positions(1:2, s))
    end do
    do s = 1, surface%n_segment
      if (.not. abs(curvature(s)) > 0.0_wp) cycle
      neighbours = [surface%previous(s), surface%next(s)]
      associate (ends => before + surface%segments(:, s))
        arcs%height(ends(1)) = followed*sagitta(curvature(s), length(s))
        part = mirrored
        do k = 1, 2
          if (neighbours(k) > 0) part(k) = length(s)/(length(s) + length(neighbours(k)))
        end do
        arcs%share(:, ends(1)) = part
        do k = 1, 2
          if (neighbours(k) == 0) cycle
          if (.not. abs(curvature(neighbours(k))) > 0.0_wp .and. abs(arcs%turn(ends(k))) &
            < tangent*2.0_wp*part(3 - k)*abs(arcs%turn(ends(3 - k)))) &
            arcs%share(k, ends(1)) = all_of_it
        end do
      end associate
    end do
  end subroutine add_surface

  !> Tangent of half the turn from one segment to the next.
  pure function half_turn(a, b) result(turn)
    real(wp), intent(in) :: a(2), b(2) !! these, m
    real(wp) :: turn

    turn = (a(1)*b(2) - a(2)*b(1))/max(tiny(1.0_wp), sqrt((a(1)**2 + a(2)**2)*(b(1)**2 &
      + b(2)**2)) + (a(1)*b(1) + a(2)*b(2)))
  end function half_turn

  !> Curvature of the arc that each segment of a surface stands for: the mean of those at its ends,
  !> kappa_i = 2 (a x b)/(|a| |b| |a + b|) of the circle through three nodes; 0 where one end is a
  !> corner, straight, or bent the other way, and on a line between arcs (bent less at its ends than
  !> beyond); at an end of an open surface, and where a line meets the arc, that of the other end.
  pure subroutine find_curvatures(surface, positions, largest_turn, curvature, meets_corner)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in) :: positions(:, :)   !! (at least 2, n_node) X, Y at time zero, m
    real(wp), intent(in) :: largest_turn      !! between two segments, rad; more is a corner
    real(wp), intent(out) :: curvature(:)     !! (n_segment) 1/m, above 0 where the body is convex
    logical, intent(out) :: meets_corner(:)   !! (n_segment) at either end
    real(wp) :: at_end(surface%n_segment), turn(surface%n_segment), ends(2), beyond(2), turns(2)
    logical :: is_corner(surface%n_segment), is_line
    integer :: s

    at_end = 0.0_wp
    turn = 0.0_wp
    is_corner = .false.
    do s = 1, surface%n_segment
      if (surface%next(s) > 0) call curvature_at_end(surface, positions, s, largest_turn, &
        at_end(s), turn(s), is_corner(s))
    end do
    curvature = 0.0_wp
    meets_corner = is_corner
    do s = 1, surface%n_segment
      associate (before => surface%previous(s), after => surface%next(s))
        ends = at_end(s)
        turns = turn(s)
        beyond = 0.0_wp
        if (after > 0) beyond(2) = at_end(after)
        if (before > 0) then
          meets_corner(s) = meets_corner(s) .or. is_corner(before)
          ends(1) = at_end(before)
          turns(1) = turn(before)
          if (surface%previous(before) > 0) beyond(1) = at_end(surface%previous(before))
          if (after == 0) ends(2) = ends(1)
          if (after == 0) turns(2) = turns(1)
        end if
        is_line = all(abs(ends) < tangent*abs(beyond) .or. [before, after] == 0)
      end associate
      if (is_line) cycle
      if (meets_corner(s) .or. product(sign([1.0_wp, 1.0_wp], ends)) < 0.0_wp) cycle
      if (minval(abs(turns)) < flat*maxval(abs(turns)) .or. .not. any(abs(turns) > 0.0_wp)) cycle
      curvature(s) = 0.5_wp*sum(ends)
      associate (k => minloc(abs(ends), 1))
        if (abs(ends(k)) < tangent*abs(ends(3 - k)) .and. abs(beyond(k)) < flat*abs(ends(k))) &
          curvature(s) = ends(3 - k)
      end associate
    end do
  end subroutine find_curvatures

  !> Curvature of the circle through the nodes of a segment and the next one, and whether the turn
  !> between them is a corner.
  pure subroutine curvature_at_end(surface, positions, segment, largest_turn, curvature, turn, &
    is_corner)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in) :: positions(:, :)
    integer, intent(in) :: segment
    real(wp), intent(in) :: largest_turn !! rad
    real(wp), intent(out) :: curvature !! 1/m
    real(wp), intent(out) :: turn      !! tangent of half of it
    logical, intent(out) :: is_corner
    real(wp) :: a(2), b(2)

    associate (one => surface%segments(:, segment), &
      two => surface%segments(:, surface%next(segment)))
      a = positions(1:2, one(2)) - positions(1:2, one(1))
      b = positions(1:2, two(2)) - positions(1:2, two(1))
    end associate
    curvature = 0.0_wp
    turn = 0.0_wp
    if (abs(a(1)*b(2) - a(2)*b(1)) > straight*norm2(a)*norm2(b)) then
      curvature = 2.0_wp*(a(1)*b(2) - a(2)*b(1))/(norm2(a)*norm2(b)*norm2(a + b))
      turn = half_turn(a, b)
    end if
    is_corner = dot_product(a, b) < cos(largest_turn)*norm2(a)*norm2(b)
  end subroutine curvature_at_end

  !> How far an arc stands off the middle of its secant, m.
  pure elemental function sagitta(curvature, secant) result(height)
    real(wp), intent(in) :: curvature, secant !! 1/m, m
    real(wp) :: height

    height = 0.125_wp*abs(curvature)*secant**2
  end function sagitta

  !> Shape of the arc of a segment at present: at each end it turns by its part of what the surface
  !> turns there.
  pure function present_shape(memory, first) result(shape)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: first !! node where the segment starts, local number
    type(arc_shape_t) :: shape
    real(wp) :: sines(2)

    shape = flat_arc
    associate (share => memory%arcs%share(:, first))
      if (.not. abs(share(1)) > 0.0_wp) return
      sines = 0.0_wp
      if (share(1) > 0.0_wp) sines(1) = sine_at(memory, first, share(1))
      if (share(2) > 0.0_wp) sines(2) = sine_at(memory, memory%arcs%beside(2, first), share(2))
      where (share < 0.0_wp) sines = sines([2, 1])
    end associate
    shape = arc_shape_t(sines(1) + sines(2), 0.5_wp*(sines(1) - sines(2)))
  end function present_shape

  !> Sine of a part of the present turn at a node, of a surface that is still bent there.
  pure function sine_at(memory, node, share) result(sine)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: node
    real(wp), intent(in) :: share
    real(wp) :: sine
    real(wp) :: turn, ratio

    associate (positions => memory%positions, beside => memory%arcs%beside(:, node))
      turn = half_turn(separation(positions(:, node), positions(:, beside(1))), &
        separation(positions(:, beside(2)), positions(:, node)))
    end associate
    ratio = turn/memory%arcs%turn(node)
    if (ratio <= 0.0_wp .or. ratio >= hinge) turn = 0.0_wp
    if (ratio > followed) turn = turn*(hinge - ratio)/(hinge - followed)
    associate (terms => sine_terms(share))
      sine = 2.0_wp*share*turn/sqrt(1.0_wp + turn**2*(terms(1) + turn**2*terms(2)))
    end associate
  end function sine_at

  !> Factors of the powers 2 and 4 of the tangent x of half a turn in the square of 2 p x over the
  !> sine of the part p of the turn: exact for half and all of it, else to the order 6.
  pure function sine_terms(share) result(terms)
    real(wp), intent(in) :: share
    real(wp) :: terms(2)

    terms = [(2.0_wp + 4.0_wp*share**2)/3.0_wp, (16.0_wp*share**4 - 1.0_wp)/15.0_wp]
  end function sine_terms

  !> Whether a segment is flat.
  pure function is_flat(shape)
    type(arc_shape_t), intent(in) :: shape
    logical :: is_flat

    is_flat = .not. (abs(shape%bend) > 0.0_wp .or. abs(shape%skew) > 0.0_wp)
  end function is_flat

  !> Height of an arc over its secant as a part of the length of that, and the sine of its angle to
  !> it. Beyond the ends both arcs of a node go on along its tangent.
  pure subroutine find_height(shape, xi, height, sine)
    type(arc_shape_t), intent(in) :: shape
    real(wp), intent(in) :: xi
    real(wp), intent(out) :: height, sine
    real(wp) :: x, circle, end_sine

    x = max(0.0_wp, min(1.0_wp, xi))
    circle = shape%bend*(0.5_wp - x)
    end_sine = min(0.5_wp*abs(shape%bend), steepest)
    sine = max(-steepest, min(steepest, circle + shape%skew*(1.0_wp - 6.0_wp*x*(1.0_wp - x))))
    height = x*(1.0_wp - x)*(shape%bend/(sqrt(1.0_wp - min(circle**2, steepest**2)) &
      + sqrt(1.0_wp - end_sine**2)) + shape%skew*(1.0_wp - 2.0_wp*x)) &
      + (xi - x)*sine/sqrt(1.0_wp - sine**2)
  end subroutine find_height

  !> Projection on the arc over a secant t of length L, from that of the point on the secant, at the
  !> distance d and xi: by one Newton step to where the normal n of the arc, at the angle beta to
  !> that of the secant, goes through the point; the force acts along n, for the point on its own
  !> secant at xi + d tan(beta)/L, so that it has no moment. Both arcs of a node so have the same
  !> normal there. A circle has sin(beta) = kappa L (1/2 - xi).
  pure function project_on_arc(t, d, off, shape) result(projection)
    real(wp), intent(in) :: t(2)   !! secant, m
    real(wp), intent(in) :: d(2)   !! from its first node to the point on its own secant, m
    real(wp), intent(in) :: off(2) !! from there to the point on its own arc, m
    type(arc_shape_t), intent(in) :: shape
    type(arc_projection_t) :: projection
    real(wp) :: length, unit(2), normal(2), xi, way, sine, cosine, across, above, height

    length = sqrt(t(1)**2 + t(2)**2)
    unit = t/length
    normal = [unit(2), -unit(1)]
    across = d(1)*normal(1) + d(2)*normal(2)
    above = across + (off(1)*normal(1) + off(2)*normal(2))
    xi = ((d(1) + off(1))*unit(1) + (d(2) + off(2))*unit(2))/length
    call find_height(shape, xi, height, sine)
    way = way_to_projection(shape, xi, (above/length - height)*sqrt(1.0_wp - sine**2), sine)
    call find_height(shape, xi + way, height, sine)
    cosine = sqrt(1.0_wp - sine**2)
    projection%gap = (above - height*length)*cosine + way*length*sine
    projection%offset = projection%gap - across
    projection%normal = normal*cosine - unit*sine
    projection%xi = (d(1)*unit(1) + d(2)*unit(2) + across*sine/cosine)/length
  end function project_on_arc

  !> Newton step from above a place on an arc to the place whose normal goes through the point, as a
  !> part of the secant; no longer than for a point at half the radius of curvature.
  pure function way_to_projection(shape, xi, gap, sine) result(way)
    type(arc_shape_t), intent(in) :: shape
    real(wp), intent(in) :: xi, gap, sine !! gap as a part of the secant
    real(wp) :: way, fall

    fall = shape%bend + 6.0_wp*shape%skew*(1.0_wp - 2.0_wp*xi)
    if (abs(xi - 0.5_wp) > 0.5_wp) fall = 0.0_wp
    way = gap*sine/max(0.5_wp, 1.0_wp + gap*fall)
  end function way_to_projection

  !> Let all points of an interface stand between arcs: gaps, normals and where forces act on the
  !> segments that have the normals. Points between flat segments keep their bits.
  pure subroutine curve_points(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(inout) :: points
    type(arc_projection_t) :: projection
    integer :: p, last
    logical :: is_curved

    p = 1
    do while (p <= points%n)
      last = p
      if (memory%has%virtual_nodes) then
        call curve_virtual_node(contact, memory, points, p, last)
      else if (points%master_nodes(1, p) /= points%master_nodes(2, p)) then
        call project_on_arcs(memory, points%slave_nodes(:, p), points%slave_weights(2, p), &
          points%master_nodes(:, p), projection, is_curved)
        if (is_curved) then
          points%master_weights(:, p) = [1.0_wp - projection%xi, projection%xi]
          points%gap(p) = projection%gap
          points%normal(:, p) = projection%normal
        end if
      else
        call project_on_arcs(memory, points%master_nodes(:, p), points%master_weights(2, p), &
          points%slave_nodes(:, p), projection, is_curved)
        if (is_curved) then
          points%slave_weights(:, p) = [1.0_wp - projection%xi, projection%xi]
          points%gap(p) = projection%gap
          points%normal(:, p) = -projection%normal
        end if
      end if
      p = last + 1
    end do
  end subroutine curve_points

  !> Type 4: the sub-segments of a virtual node, which follow each other, have its gap and normal,
  !> and move along the master together until their resultant acts along the normal.
  pure subroutine curve_virtual_node(contact, memory, points, first, last)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(inout) :: points
    integer, intent(in) :: first
    integer, intent(out) :: last
    type(arc_projection_t) :: projection
    real(wp) :: lever, along, t(2), d(2)
    integer :: nodes(n_side), p
    logical :: is_curved

    last = first
    do while (last < points%n)
      if (points%slave_nodes(1, last + 1) /= points%slave_nodes(1, first) &
        .or. abs(points%slave_weights(2, last + 1) - points%slave_weights(2, first)) > 0.0_wp) exit
      last = last + 1
    end do
    call project_virtual_node(contact, memory, points, first, projection, nodes, is_curved)
    if (.not. is_curved) return
    lever = 0.0_wp
    along = 0.0_wp
    do p = first, last
      points%gap(p) = projection%gap
      points%normal(:, p) = projection%normal
      call sides_of_point(memory, points, p, d, t)
      lever = lever + points%area(p)*cross(projection%normal, d)
      along = along + points%area(p)*cross(projection%normal, t/norm2(t))
    end do
    do p = first, last
      call sides_of_point(memory, points, p, d, t)
      points%master_weights(2, p) = points%master_weights(2, p) + lever/(along*norm2(t))
      points%master_weights(1, p) = 1.0_wp - points%master_weights(2, p)
    end do
  end subroutine curve_virtual_node

  !> Vector from the master side of a point to its slave side, and its master segment, m.
  pure subroutine sides_of_point(memory, points, p, d, t)
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: p
    real(wp), intent(out) :: d(2), t(2)

    associate (positions => memory%positions, slave => points%slave_nodes(:, p), &
      master => points%master_nodes(:, p))
      t = separation(positions(:, slave(2)), positions(:, slave(1)))
      d = separation(positions(:, slave(1)), positions(:, master(1))) &
        + points%slave_weights(2, p)*t
      t = separation(positions(:, master(2)), positions(:, master(1)))
      d = d - points%master_weights(2, p)*t
    end associate
  end subroutine sides_of_point

  !> z component of the cross product.
  pure function cross(a, b)
    real(wp), intent(in) :: a(2), b(2)
    real(wp) :: cross

    cross = a(1)*b(2) - a(2)*b(1)
  end function cross

  !> Projection of a point at xi between two nodes of its own surface on the arc of a segment of the
  !> other one.
  pure subroutine project_on_arcs(memory, own, own_xi, other, projection, is_curved)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: own(n_side), other(n_side) !! local numbers; own: one node twice, or both
                                                      !! of a segment
    real(wp), intent(in) :: own_xi
    type(arc_projection_t), intent(out) :: projection
    logical, intent(out) :: is_curved !! either segment; else there is no projection
    type(arc_shape_t) :: shape, own_shape
    real(wp) :: t(2), d(2), off(2), height, sine

    shape = present_shape(memory, other(1))
    own_shape = flat_arc
    if (own(1) /= own(2) .and. own_xi*(1.0_wp - own_xi) > 0.0_wp) &
      own_shape = present_shape(memory, own(1))
    is_curved = .not. (is_flat(shape) .and. is_flat(own_shape))
    if (.not. is_curved) return
    call find_height(own_shape, own_xi, height, sine)
    associate (positions => memory%positions)
      t = separation(positions(:, own(2)), positions(:, own(1)))
      d = separation(positions(:, own(1)), positions(:, other(1))) + own_xi*t
      off = height*[t(2), -t(1)]
      t = separation(positions(:, other(2)), positions(:, other(1)))
    end associate
    projection = project_on_arc(t, d, off, shape)
  end subroutine project_on_arcs

  !> Projection on arcs of the virtual node of a point of type 4; xi is counted from its projection
  !> on the secant.
  pure subroutine project_virtual_node(contact, memory, points, p, projection, nodes, is_curved)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: p
    type(arc_projection_t), intent(out) :: projection
    integer, intent(out) :: nodes(n_side) !! of the master segment
    logical, intent(out) :: is_curved
    integer :: point

    associate (status => memory%slave_status)
      point = site_at(memory, points, p)
      nodes = memory%n_slave + contact%master%segments(:, status%segment(point))
      call project_on_arcs(memory, points%slave_nodes(:, p), &
        points%slave_weights(2, p), nodes, projection, is_curved)
      projection%xi = projection%xi - status%xi(point)
    end associate
  end subroutine project_virtual_node

end module arcs_m
