! SPDX-License-Identifier: MIT
!> Arcs that the segments of round surfaces stand for: their curvatures from the initial mesh, and
!> contact points between arcs in place of between their secants (doc/theory/contact.md, section
!> 5.9). Forces still go to the two nodes of a segment by linear functions.
module arcs_m
  use contact_state_m, only : arcs_t, arc_shape_t, flat_arc, contact_state_t, contact_points_t, &
    n_side
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  use projection_block_m, only : n_block
  use search_state_m, only : pass_t
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: prepare_arcs, half_turn, find_curvatures, sagitta, curve_points, &
    present_shape, offset_by_arc, sine_terms, is_flat, steepest

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

  !> Points over segments of the other surface, one of which at least is curved, many at a time.
  !> Without default values, which would be written before each use.
  type :: arc_block_t
    integer :: n
    integer :: point(n_block)          !! on the list; the first of a virtual node
    real(wp) :: bend(n_block), skew(n_block)         !! of the segment
    integer :: nodes(4, n_block)       !! of its own segment, or one twice, and of the segment
    real(wp) :: own_bend(n_block), own_skew(n_block) !! of its own segment
    real(wp) :: own_xi(n_block)        !! on that
    real(wp) :: xi(n_block)            !! on the segment: where the force acts
    real(wp) :: gap(n_block)           !! m, between arcs
    real(wp) :: offset(n_block)        !! of that from the gap of the secants, m
    real(wp) :: normal(n_block, 2)     !! of the arc, outward
  end type arc_block_t

contains

  !> Arcs of both surfaces of an interface; none where all segments are flat.
  pure subroutine prepare_arcs(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory

    associate (arcs => memory%arcs)
      allocate (arcs%share(2, size(memory%nodes)), arcs%turn(size(memory%nodes)), &
        arcs%height(size(memory%nodes)), source=0.0_wp)
      allocate (arcs%beside(2, size(memory%nodes)), source=0)
      allocate (arcs%shape(size(memory%nodes)), source=flat_arc)
      allocate (arcs%is_formed(size(memory%nodes)), source=.false.)
      allocate (arcs%around(4, size(memory%nodes)), source=0)
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
        ! At an end of an open surface the segment has no turn: its arc is the mirror image there.
        arcs%around(:, ends(1)) = [merge(arcs%beside(1, ends(1)), ends(1), neighbours(1) > 0), &
          ends, merge(arcs%beside(2, ends(2)), ends(2), neighbours(2) > 0)]
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

  !> Shape of the arc of a segment at present.
  pure function present_shape(memory, first) result(shape)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: first !! node where the segment starts, local number
    type(arc_shape_t) :: shape
    type(arc_shape_t) :: shapes(1)

    shape = flat_arc
    if (.not. abs(memory%arcs%share(1, first)) > 0.0_wp) return
    call form_shapes([first], memory%positions, memory%arcs, shapes)
    shape = shapes(1)
  end function present_shape

  !> Shapes of the arcs of segments at present, at most of a block of them: at each end an arc turns
  !> by its part of what the surface turns there, as far as that is still bent as it was.
  pure subroutine form_shapes(first, positions, arcs, shapes)
    integer, intent(in), contiguous :: first(:)         !! nodes where they start, local numbers
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    type(arcs_t), intent(in) :: arcs
    type(arc_shape_t), intent(out) :: shapes(:)
    real(wp), dimension(n_block, 0:2) :: x, y !! the segments before, these, and those behind, m
    real(wp), dimension(n_block, 2) :: initial, share, sine
    real(wp) :: turn, square, fade, way(4)
    integer :: k, e

    do k = 1, size(first)
      associate (nodes => arcs%around(:, first(k)))
        do e = 0, 2
          way = positions(:, nodes(e + 2)) - positions(:, nodes(e + 1))
          x(k, e) = way(1) + way(3)
          y(k, e) = way(2) + way(4)
        end do
        do e = 1, 2
          share(k, e) = arcs%share(e, first(k))
          initial(k, e) = arcs%turn(nodes(e + 1))
        end do
      end associate
    end do
    do e = 1, 2
      !$omp simd private(turn, square, fade)
      do k = 1, size(first)
        turn = (x(k, e - 1)*y(k, e) - y(k, e - 1)*x(k, e))/max(tiny(1.0_wp), &
          sqrt((x(k, e - 1)**2 + y(k, e - 1)**2)*(x(k, e)**2 + y(k, e)**2)) &
          + (x(k, e - 1)*x(k, e) + y(k, e - 1)*y(k, e)))
        fade = (hinge - turn/merge(initial(k, e), 1.0_wp, share(k, e) > 0.0_wp)) &
          /(hinge - followed)
        turn = turn*max(0.0_wp, min(1.0_wp, fade))
        turn = merge(turn, 0.0_wp, turn*initial(k, e) > 0.0_wp)
        square = turn*turn
        sine(k, e) = 2.0_wp*share(k, e)*turn/sqrt(1.0_wp + square*((2.0_wp + 4.0_wp &
          *share(k, e)**2)/3.0_wp + square*(16.0_wp*share(k, e)**4 - 1.0_wp)/15.0_wp))
      end do
    end do
    do k = 1, size(first)
      associate (one => merge(sine(k, 2), sine(k, 1), share(k, 1) < 0.0_wp), &
        two => merge(sine(k, 1), sine(k, 2), share(k, 2) < 0.0_wp))
        shapes(k)%bend = one + two
        shapes(k)%skew = 0.5_wp*(one - two)
      end associate
    end do
  end subroutine form_shapes

  !> Whether a segment is flat.
  pure function is_flat(shape)
    type(arc_shape_t), intent(in) :: shape
    logical :: is_flat

    is_flat = .not. (abs(shape%bend) > 0.0_wp .or. abs(shape%skew) > 0.0_wp)
  end function is_flat

  !> Factors of the powers 2 and 4 of the tangent x of half a turn in the square of 2 p x over the
  !> sine of the part p of the turn: exact for half and all of it, else to the order 6.
  pure function sine_terms(share) result(terms)
    real(wp), intent(in) :: share
    real(wp) :: terms(2)

    terms = [(2.0_wp + 4.0_wp*share**2)/3.0_wp, (16.0_wp*share**4 - 1.0_wp)/15.0_wp]
  end function sine_terms

  !> Heights of arcs over their secants as parts of the lengths of these, and sine and cosine of
  !> their angles to them. Beyond the ends both arcs of a node go on along its tangent.
  pure subroutine find_heights(n, bend, skew, xi, height, sine, cosine)
    integer, intent(in) :: n
    real(wp), intent(in), dimension(n) :: bend, skew, xi
    real(wp), intent(out), dimension(n) :: height, sine, cosine
    real(wp) :: x, circle, end_sine
    integer :: k

    !$omp simd private(x, circle, end_sine)
    do k = 1, n
      x = max(0.0_wp, min(1.0_wp, xi(k)))
      circle = bend(k)*(0.5_wp - x)
      end_sine = min(0.5_wp*abs(bend(k)), steepest)
      sine(k) = max(-steepest, min(steepest, circle + skew(k)*(1.0_wp - 6.0_wp*x*(1.0_wp - x))))
      cosine(k) = sqrt(1.0_wp - sine(k)**2)
      height(k) = x*(1.0_wp - x)*(bend(k)/(sqrt(1.0_wp - min(circle**2, steepest**2)) &
        + sqrt(1.0_wp - end_sine**2)) + skew(k)*(1.0_wp - 2.0_wp*x)) &
        + (xi(k) - x)*sine(k)/cosine(k)
    end do
  end subroutine find_heights

  !> Project the points of a block on the arcs over their secants t of length L, each from its
  !> projection on the secant, at the distance d and xi: by one Newton step, no longer than for a
  !> point at half the radius of curvature, to where the normal n of the arc, at the angle beta to
  !> that of the secant, goes through the point. The force acts along n, for the point on its own
  !> secant at xi + d tan(beta)/L, so that it has no moment. Both arcs of a node so have the same
  !> normal there. A circle has sin(beta) = kappa L (1/2 - xi).
  pure subroutine project_block(positions, block)
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    type(arc_block_t), intent(inout) :: block
    real(wp), dimension(n_block, 2) :: t, d, own !! secants, from their first nodes to the points on
                                                 !! their own secants, these secants, m
    real(wp), dimension(n_block) :: length, across, above, foot, way, height, sine, cosine
    real(wp) :: unit(2), off(2), gap, fall
    integer :: k

    associate (n => block%n, bend => block%bend, skew => block%skew)
      call gather_block(n, block%nodes, block%own_xi, positions, t, d, own)
      call find_heights(n, block%own_bend, block%own_skew, block%own_xi, height, sine, cosine)
      !$omp simd private(unit, off)
      do k = 1, n
        length(k) = sqrt(t(k, 1)**2 + t(k, 2)**2)
        unit(1) = t(k, 1)/length(k)
        unit(2) = t(k, 2)/length(k)
        off(1) = height(k)*own(k, 2)
        off(2) = -height(k)*own(k, 1)
        across(k) = d(k, 1)*unit(2) - d(k, 2)*unit(1)
        above(k) = across(k) + (off(1)*unit(2) - off(2)*unit(1))
        foot(k) = ((d(k, 1) + off(1))*unit(1) + (d(k, 2) + off(2))*unit(2))/length(k)
      end do
      call find_heights(n, bend, skew, foot, height, sine, cosine)
      !$omp simd private(gap, fall)
      do k = 1, n
        gap = (above(k)/length(k) - height(k))*cosine(k)
        fall = bend(k) + 6.0_wp*skew(k)*(1.0_wp - 2.0_wp*foot(k))
        fall = merge(0.0_wp, fall, abs(foot(k) - 0.5_wp) > 0.5_wp)
        way(k) = gap*sine(k)/max(0.5_wp, 1.0_wp + gap*fall)
        foot(k) = foot(k) + way(k)
      end do
      call find_heights(n, bend, skew, foot, height, sine, cosine)
      !$omp simd private(unit)
      do k = 1, n
        unit(1) = t(k, 1)/length(k)
        unit(2) = t(k, 2)/length(k)
        block%gap(k) = (above(k) - height(k)*length(k))*cosine(k) + way(k)*length(k)*sine(k)
        block%offset(k) = block%gap(k) - across(k)
        block%normal(k, 1) = unit(2)*cosine(k) - unit(1)*sine(k)
        block%normal(k, 2) = -unit(1)*cosine(k) - unit(2)*sine(k)
        block%xi(k) = (d(k, 1)*unit(1) + d(k, 2)*unit(2) + across(k)*sine(k)/cosine(k))/length(k)
      end do
    end associate
  end subroutine project_block

  !> Vectors of the points of a block, m.
  pure subroutine gather_block(n, nodes, own_xi, positions, t, d, own)
    integer, intent(in) :: n, nodes(4, n)
    real(wp), intent(in) :: own_xi(n), positions(4, *)
    real(wp), intent(inout), dimension(n_block, 2) :: t, d, own
    real(wp), dimension(4) :: along, way, secant
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      along = positions(:, nodes(2, k)) - positions(:, nodes(1, k))
      way = (positions(:, nodes(1, k)) - positions(:, nodes(3, k))) + own_xi(k)*along
      secant = positions(:, nodes(4, k)) - positions(:, nodes(3, k))
      own(k, :) = along(1:2) + along(3:4)
      d(k, :) = way(1:2) + way(3:4)
      t(k, :) = secant(1:2) + secant(3:4)
    end do
  end subroutine gather_block

  !> Let all points of an interface stand between arcs: gaps, normals and where forces act on the
  !> segments that have the normals; of type 4 the virtual nodes, for all of their sub-segments.
  !> Points between flat segments keep their bits.
  pure subroutine curve_points(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory !! out: present shapes of the points' segments
    type(contact_points_t), intent(inout) :: points
    type(arc_block_t) :: block
    integer :: own(n_side), other(n_side), p, v
    real(wp) :: own_xi

    if (points%n == 0) return
    call form_present_shapes(contact, memory, points)
    p = 0
    v = 0
    do while (p < points%n)
      block%n = 0
      do while (p < points%n .and. block%n < n_block)
        p = p + 1
        own = points%slave_nodes(:, p)
        own_xi = points%slave_weights(2, p)
        other = points%master_nodes(:, p)
        if (memory%has%virtual_nodes) then
          v = v + 1
          other = nodes_below(contact, memory, memory%slave_status%active_points(v))
        else if (other(1) == other(2)) then
          own = other
          own_xi = 0.0_wp
          other = points%slave_nodes(:, p)
        end if
        call append_to_block(memory%arcs%shape, own, own_xi, other, p, block)
        if (memory%has%virtual_nodes) p = last_of_virtual_node(points, p)
      end do
      call project_block(memory%positions, block)
      if (memory%has%virtual_nodes) then
        call store_virtual_nodes(memory%positions, block, points)
      else
        call store_points(block, points)
      end if
    end do
  end subroutine curve_points

  !> Form the shapes of all segments that points are on, once each.
  pure subroutine form_present_shapes(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(contact_points_t), intent(in) :: points
    integer :: listed(n_block), below(n_side), n, p

    n = 0
    associate (arcs => memory%arcs, status => memory%slave_status)
      arcs%is_formed = .not. abs(arcs%share(1, :)) > 0.0_wp
      do p = 1, points%n
        associate (slave => points%slave_nodes(:, p), master => points%master_nodes(:, p))
          if (.not. arcs%is_formed(master(1)) .and. master(1) /= master(2)) &
            call list_segment(master(1), memory%positions, arcs, listed, n)
          if (.not. arcs%is_formed(slave(1)) .and. slave(1) /= slave(2)) &
            call list_segment(slave(1), memory%positions, arcs, listed, n)
        end associate
      end do
      if (memory%has%virtual_nodes) then
        do p = 1, status%n_active
          below = nodes_below(contact, memory, status%active_points(p))
          if (.not. arcs%is_formed(below(1))) &
            call list_segment(below(1), memory%positions, arcs, listed, n)
        end do
      end if
      call form_listed(listed(:n), memory%positions, arcs)
    end associate
  end subroutine form_present_shapes

  !> List a segment; form the shapes of a full list.
  pure subroutine list_segment(first, positions, arcs, listed, n)
    integer, intent(in) :: first !! node where it starts, local number
    real(wp), intent(in), contiguous :: positions(:, :)
    type(arcs_t), intent(inout) :: arcs
    integer, intent(inout) :: listed(n_block), n

    if (n == n_block) then
      call form_listed(listed, positions, arcs)
      n = 0
    end if
    n = n + 1
    listed(n) = first
    arcs%is_formed(first) = .true.
  end subroutine list_segment

  !> Form the shapes of some segments and keep them.
  pure subroutine form_listed(listed, positions, arcs)
    integer, intent(in), contiguous :: listed(:)
    real(wp), intent(in), contiguous :: positions(:, :)
    type(arcs_t), intent(inout) :: arcs
    type(arc_shape_t) :: shapes(size(listed))
    integer :: k

    call form_shapes(listed, positions, arcs, shapes)
    do k = 1, size(listed)
      arcs%shape(listed(k)) = shapes(k)
    end do
  end subroutine form_listed

  !> Nodes of the master segment that a virtual node is over.
  pure function nodes_below(contact, memory, virtual_node) result(nodes)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: virtual_node
    integer :: nodes(n_side)

    nodes = memory%n_slave + contact%master%segments(:, memory%slave_status%segment(virtual_node))
  end function nodes_below

  !> The last of the sub-segments of a virtual node, which follow each other.
  pure function last_of_virtual_node(points, first) result(last)
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: first
    integer :: last

    last = first
    do while (last < points%n)
      if (points%slave_nodes(1, last + 1) /= points%slave_nodes(1, first) &
        .or. abs(points%slave_weights(2, last + 1) - points%slave_weights(2, first)) > 0.0_wp) exit
      last = last + 1
    end do
  end function last_of_virtual_node

  !> Append a point at xi between two nodes of its own surface, over a segment of the other one,
  !> unless both are flat. Nodes are on their arcs.
  pure subroutine append_to_block(shape, own, own_xi, other, point, block)
    type(arc_shape_t), intent(in) :: shape(*)         !! by the nodes where segments start
    integer, intent(in) :: own(n_side), other(n_side) !! local numbers; own: one node twice, or both
                                                      !! of a segment
    real(wp), intent(in) :: own_xi
    integer, intent(in) :: point                      !! its number
    type(arc_block_t), intent(inout) :: block
    type(arc_shape_t) :: own_shape
    integer :: n

    own_shape = flat_arc
    if (own(1) /= own(2) .and. own_xi*(1.0_wp - own_xi) > 0.0_wp) own_shape = shape(own(1))
    if (is_flat(own_shape) .and. is_flat(shape(other(1)))) return
    n = block%n + 1
    block%n = n
    block%point(n) = point
    block%nodes(1:2, n) = own
    block%nodes(3:4, n) = other
    block%own_xi(n) = own_xi
    block%own_bend(n) = own_shape%bend
    block%own_skew(n) = own_shape%skew
    block%bend(n) = shape(other(1))%bend
    block%skew(n) = shape(other(1))%skew
  end subroutine append_to_block

  !> Store the projections of points.
  pure subroutine store_points(block, points)
    type(arc_block_t), intent(in) :: block
    type(contact_points_t), intent(inout) :: points
    integer :: k

    do k = 1, block%n
      associate (p => block%point(k))
        points%gap(p) = block%gap(k)
        if (points%master_nodes(1, p) /= points%master_nodes(2, p)) then
          points%master_weights(:, p) = [1.0_wp - block%xi(k), block%xi(k)]
          points%normal(:, p) = block%normal(k, :)
        else
          points%slave_weights(:, p) = [1.0_wp - block%xi(k), block%xi(k)]
          points%normal(:, p) = -block%normal(k, :)
        end if
      end associate
    end do
  end subroutine store_points

  !> Type 4: the sub-segments of a virtual node have its gap and normal, and move along the master
  !> together until their resultant acts along the normal.
  pure subroutine store_virtual_nodes(positions, block, points)
    real(wp), intent(in), contiguous :: positions(:, :)
    type(arc_block_t), intent(in) :: block
    type(contact_points_t), intent(inout) :: points
    real(wp), dimension(4) :: own, way, master
    real(wp) :: normal(2), d(2), t(2), lever, along, area
    integer :: k, p, first, last

    do k = 1, block%n
      normal = block%normal(k, :)
      first = block%point(k)
      last = last_of_virtual_node(points, first)
      lever = 0.0_wp
      along = 0.0_wp
      associate (a => points%slave_nodes(1, first), b => points%slave_nodes(2, first))
        own = positions(:, a) + points%slave_weights(2, first)*(positions(:, b) - positions(:, a))
      end associate
      do p = first, last
        associate (a => points%master_nodes(1, p), b => points%master_nodes(2, p))
          master = positions(:, b) - positions(:, a)
          way = own - positions(:, a) - points%master_weights(2, p)*master
        end associate
        t = master(1:2) + master(3:4)
        d = way(1:2) + way(3:4)
        points%gap(p) = block%gap(k)
        points%normal(:, p) = normal
        ! Until they are known their ways wait here.
        points%master_weights(1, p) = 1.0_wp/sqrt(t(1)**2 + t(2)**2)
        area = points%area(p)
        lever = lever + area*(normal(1)*d(2) - normal(2)*d(1))
        along = along + area*(normal(1)*t(2) - normal(2)*t(1))*points%master_weights(1, p)
      end do
      lever = lever/along
      do p = first, last
        points%master_weights(2, p) = points%master_weights(2, p) &
          + lever*points%master_weights(1, p)
        points%master_weights(1, p) = 1.0_wp - points%master_weights(2, p)
      end do
    end do
  end subroutine store_virtual_nodes

  !> What the gap of a node to the arc over a segment of the other surface has more than that to the
  !> segment, m.
  pure function offset_by_arc(memory, node, other) result(offset)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: node, other(n_side) !! local numbers
    real(wp) :: offset
    type(arc_block_t) :: block
    type(arc_shape_t) :: shape

    offset = 0.0_wp
    shape = present_shape(memory, other(1))
    if (is_flat(shape)) return
    block%n = 1
    block%nodes(:, 1) = [node, node, other]
    block%own_xi(1) = 0.0_wp
    block%own_bend(1) = 0.0_wp
    block%own_skew(1) = 0.0_wp
    block%bend(1) = shape%bend
    block%skew(1) = shape%skew
    call project_block(memory%positions, block)
    offset = block%offset(1)
  end function offset_by_arc

end module arcs_m
