! SPDX-License-Identifier: MIT
!> Arcs that the segments of round surfaces stand for: their curvatures from the initial mesh, their
!> shapes at present (doc/theory/contact.md, section 5.9).
module arcs_m
  use contact_state_m, only : arcs_t, arc_shape_t, flat_arc, contact_state_t
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  use projection_block_m, only : n_block
  use search_state_m, only : pass_t
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: prepare_arcs, half_turn, find_curvatures, sagitta, present_shape, form_shapes, &
    sine_terms, is_flat, steepest, followed, hinge

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
      allocate (arcs%formed_in(size(memory%nodes)), source=0)
      allocate (arcs%around(4, size(memory%nodes)), source=0)
      call add_surface(contact%slave, contact%largest_turn, 0, memory%positions, arcs)
      call add_surface(contact%master, contact%largest_turn, memory%n_slave, memory%positions, arcs)
      memory%has%arcs = any(arcs%height > 0.0_wp)
      if (.not. memory%has%arcs) return
      where (.not. abs(arcs%share(1, :)) > 0.0_wp) arcs%formed_in = huge(1)
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

end module arcs_m
