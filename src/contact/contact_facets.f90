! SPDX-License-Identifier: MIT
!> Error of gaps by the facets of curved surfaces, beside the penetration. Where it is large, facets
!> govern the pressure (doc/theory/contact.md, section 8.2).
module contact_facets_m
  use arcs_m, only : find_curvatures, half_turn, sagitta
  use law_state_m, only : contact_estimate_t
  use contact_state_m, only : contact_state_t, contact_points_t, n_side
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  use log_m, only : log_t, warn, to_text
  use surfaces_m, only : surface_t
  use units_m, only : units_t, in_units
  implicit none
  private
  public :: follow_arcs, report_facets, coarse_turn

  !> Part of the largest penetration above which the error of gaps by facets is reported.
  real(wp), parameter :: noticed_part = 0.1_wp
  !> Weight of the other node up to which a point is at a node, and part by which heights are equal.
  real(wp), parameter :: at_node = 1.0e-6_wp

  !> Turns of more than 16 degrees are corners (24 segments on a circle turn by 15).
  real(wp), parameter :: largest_turn = 16.0_wp/180.0_wp*acos(-1.0_wp)

  !> Largest turn of a coarse circle (12 segments, with a margin), and how many like turns in a row
  !> make one: a bolt head has 6 corners of 60 degrees, an octagon 8 of 45.
  real(wp), parameter :: coarsest = 31.0_wp/180.0_wp*acos(-1.0_wp)
  integer, parameter :: in_a_row = 3
  !> Part by which such turns are alike.
  real(wp), parameter :: alike = 0.1_wp

  !> Arcs that the segments of both surfaces stand for, those of the slave first.
  type :: arcs_t
    real(wp), allocatable :: curvature(:)   !! (segments) 1/m
    real(wp), allocatable :: secant(:)       !! (segments) length of the segment, m
    real(wp), allocatable :: height(:)      !! (segments) how far the arc stands off it, m
    real(wp), allocatable :: unlike(:)      !! (segments) curvature of both surfaces together, where
                                            !! it is loaded, 1/m
    logical, allocatable :: meets_corner(:) !! (segments) and may stand for a coarse arc
    logical, allocatable :: is_loaded(:)    !! (segments)
    integer, allocatable :: beside(:, :)    !! (2, nodes) segments before and behind each, 0: none
  end type arcs_t

contains

  !> Follow an interface: the deepest penetration so far of positions on curved segments, that of
  !> time zero included, which is the interference, and the way by which bodies of unlike curvature
  !> are flattened there; and what facets put gaps off by.
  pure subroutine follow_arcs(contact, memory, estimate)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(contact_estimate_t), intent(inout) :: estimate
    type(arcs_t) :: arcs
    real(wp) :: deepest
    integer :: p, k

    associate (points => memory%points, n => memory%n_slave, m => contact%slave%n_segment)
      if (memory%has%arcs) return
      if (.not. any(points%gap(:points%n) < 0.0_wp)) return
      k = m + contact%master%n_segment
      allocate (arcs%curvature(k), arcs%secant(k), arcs%height(k), arcs%unlike(k), source=0.0_wp)
      allocate (arcs%meets_corner(k), arcs%is_loaded(k), source=.false.)
      allocate (arcs%beside(2, size(memory%nodes)), source=0)
      call find_arcs(contact%slave, [0, 0], memory%positions(:, :n), arcs)
      call find_arcs(contact%master, [n, m], memory%positions(:, n + 1:), arcs)
      if (.not. any(abs(arcs%curvature) > 0.0_wp)) return
      deepest = 0.0_wp
      do p = 1, points%n
        if (.not. points%gap(p) < 0.0_wp) cycle
        ! Those of an overlap that grows have no pressure at first.
        if (points%pressure(p) > 0.0_wp .or. memory%has%interference) &
          call sample_point(contact, points, p, arcs, deepest, estimate)
      end do
      if (any(arcs%is_loaded)) estimate%penetration = max(estimate%penetration, deepest &
        + max(flattening(contact%slave, 0, arcs), flattening(contact%master, m, arcs)))
    end associate
  end subroutine follow_arcs

  !> The arcs of one surface.
  pure subroutine find_arcs(surface, before, positions, arcs)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: before(2)        !! nodes and segments of surfaces before it
    real(wp), intent(in) :: positions(:, :) !! (4, n_node) X, Y, u_x, u_y
    type(arcs_t), intent(inout) :: arcs
    integer :: s

    associate (first => before(2) + 1, last => before(2) + surface%n_segment)
      call find_curvatures(surface, positions, largest_turn, arcs%curvature(first:last), &
        arcs%meets_corner(first:last))
      do s = 1, surface%n_segment
        associate (ends => surface%segments(:, s))
          arcs%secant(before(2) + s) = norm2(positions(1:2, ends(2)) - positions(1:2, ends(1)))
          arcs%beside(2, before(1) + ends(1)) = before(2) + s
          arcs%beside(1, before(1) + ends(2)) = before(2) + s
        end associate
      end do
      arcs%height(first:last) = sagitta(arcs%curvature(first:last), arcs%secant(first:last))
    end associate
  end subroutine find_arcs

  !> One point that is loaded: the segments that it is on, either of which may be of either surface
  !> where there are two passes.
  pure subroutine sample_point(contact, points, p, arcs, deepest, estimate)
    type(contact_t), intent(in) :: contact
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: p
    type(arcs_t), intent(inout) :: arcs
    real(wp), intent(inout) :: deepest !! penetration of arcs, m
    type(contact_estimate_t), intent(inout) :: estimate
    integer :: segments(2), k
    real(wp) :: weights(n_side, 2), off

    weights = reshape([points%slave_weights(:, p), points%master_weights(:, p)], [n_side, 2])
    segments = [segment_at(arcs, points%slave_nodes(:, p), weights(:, 1)), &
      segment_at(arcs, points%master_nodes(:, p), weights(:, 2))]
    if (any(segments == 0)) return
    associate (curvature => arcs%curvature(segments), height => arcs%height(segments), &
      meets_corner => arcs%meets_corner(segments))
      if (.not. any(abs(curvature) > 0.0_wp)) return
      off = 0.5_wp*sum(curvature*arcs%secant(segments)**2*max(product(weights, 1), 0.0_wp))
      do k = 1, 2
        arcs%is_loaded(segments(k)) = .true.
        if (.not. any(meets_corner)) arcs%unlike(segments(k)) = abs(sum(curvature))
      end do
      ! That of the arcs: what facets add is no measure of itself.
      deepest = max(deepest, off - points%gap(p))
      ! A facet that turns by more may be off by the whole height.
      if (any(meets_corner .and. product(weights, 1) > at_node)) off = maxval(height)
      estimate%facet_error = max(estimate%facet_error, abs(off))
      k = maxloc(height, 1)
      if (.not. height(k) > estimate%arc_height) return
      estimate%arc_height = height(k)
      estimate%arc_curvature = abs(curvature(k))
      estimate%arc_side = merge(1, 2, segments(k) <= contact%slave%n_segment)
    end associate
  end subroutine sample_point

  !> The segment that a position is on; of those beside the node that it is at, the one with the
  !> higher arc, the first one of equal ones (round-off is no choice); 0: none.
  pure function segment_at(arcs, nodes, weights) result(segment)
    type(arcs_t), intent(in) :: arcs
    integer, intent(in) :: nodes(n_side)
    real(wp), intent(in) :: weights(n_side)
    integer :: segment
    integer :: main, here, k

    main = maxloc(weights, 1)
    segment = 0
    do k = 1, 2
      here = arcs%beside(k, nodes(main))
      if (here == 0) cycle
      if (minval(weights) > at_node .and. all(arcs%beside(:, nodes(3 - main)) /= here)) cycle
      if (segment > 0) then
        if (.not. arcs%height(here) > (1.0_wp + at_node)*arcs%height(segment)) cycle
      end if
      segment = here
    end do
  end function segment_at

  !> The way by which bodies of unlike curvature are flattened where they touch: the arc of both
  !> curvatures over the mean run of loaded segments, up to one radian of it.
  pure function flattening(surface, offset, arcs) result(way)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: offset !! segments of surfaces before it
    type(arcs_t), intent(in) :: arcs
    real(wp) :: way !! m
    real(wp) :: length, unlike, bend
    integer :: s, n_run
    logical :: goes_on

    length = 0.0_wp
    unlike = 0.0_wp
    bend = tiny(1.0_wp)
    n_run = 0
    do s = 1, surface%n_segment
      if (.not. arcs%is_loaded(offset + s)) cycle
      goes_on = surface%previous(s) > 0
      if (goes_on) goes_on = arcs%is_loaded(offset + surface%previous(s))
      if (.not. goes_on) n_run = n_run + 1
      length = length + arcs%secant(offset + s)
      unlike = max(unlike, arcs%unlike(offset + s))
      bend = max(bend, abs(arcs%curvature(offset + s)))
    end do
    way = sagitta(unlike, min(length/max(1, n_run), 1.0_wp/bend))
  end function flattening

  !> Warn at the end of the run where facets change gaps by more than the noticed part of the
  !> penetration, with the number of segments at which they would not. Where nodes lie opposite each
  !> other gaps are right, however coarse the facets.
  subroutine report_facets(contact, units, estimate, log)
    type(contact_t), intent(in) :: contact
    type(units_t), intent(in) :: units
    type(contact_estimate_t), intent(in) :: estimate
    type(log_t), intent(inout) :: log
    character(:), allocatable :: text

    associate (height => estimate%arc_height, curvature => estimate%arc_curvature, &
      depth => estimate%penetration)
      if (.not. min(height, estimate%facet_error) > noticed_part*depth) return
      text = trim(merge('slave ', 'master', estimate%arc_side == 1))
      if (contact%is_self) text = 'surface'
      text = 'interface '//to_text(contact%id)//': flat facets govern the contact pressure: its ' &
        //text//' (radius '//to_text(1.0_wp/curvature)//in_units(units, 'L')//', ' &
        //to_text(nint(segments_of(curvature, height)))//' segments on a full circle) is up to ' &
        //to_text(height)//' inside its arcs, which changes gaps by up to ' &
        //to_text(estimate%facet_error)//', more than a tenth of the penetration ' &
        //to_text(depth)//' (interference and flattening included); take arcs (SMOOTH '
      if (contact%largest_turn > 0.0_wp) then
        text = text//'above its present value)'
      else
        text = text//'0, not -1)'
      end if
      if (depth > 0.0_wp) text = text//' or ' &
        //to_text(ceiling(segments_of(curvature, noticed_part*depth)))//' segments'
      call warn(log, text)
    end associate
  end subroutine report_facets

  !> Segments on a full circle whose arcs stand so far off them: over the turn phi by
  !> phi^2/(8 curvature).
  pure real(wp) function segments_of(curvature, height)
    real(wp), intent(in) :: curvature, height !! 1/m, m

    segments_of = 2.0_wp*acos(-1.0_wp)/sqrt(8.0_wp*curvature*height)
  end function segments_of

  !> Largest turn of a surface that looks like a coarse circle and has no arcs there, since it turns
  !> by more than SMOOTH from segment to segment, rad; 0: none.
  pure function coarse_turn(surface, positions, largest_turn) result(turn)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in) :: positions(:, :) !! (at least 2, n_node) X, Y at time zero, m
    real(wp), intent(in) :: largest_turn    !! rad
    real(wp) :: turn
    real(wp) :: turns(surface%n_segment)
    integer :: s, k, n_like

    turns = 0.0_wp
    do s = 1, surface%n_segment
      if (surface%next(s) == 0) cycle
      associate (a => surface%segments(:, s), b => surface%segments(:, surface%next(s)))
        turns(s) = 2.0_wp*atan(half_turn(positions(1:2, a(2)) - positions(1:2, a(1)), &
          positions(1:2, b(2)) - positions(1:2, b(1))))
      end associate
    end do
    turn = 0.0_wp
    do s = 1, surface%n_segment
      if (abs(turns(s)) <= largest_turn .or. abs(turns(s)) > coarsest) cycle
      n_like = 1
      k = s
      do while (n_like < in_a_row)
        k = surface%next(k)
        if (k == 0) exit
        if (abs(turns(k) - turns(s)) > alike*abs(turns(s))) exit
        n_like = n_like + 1
      end do
      if (n_like == in_a_row) turn = max(turn, abs(turns(s)))
    end do
  end function coarse_turn

end module contact_facets_m
