! SPDX-License-Identifier: MIT
!> Competence lengths: what each node of a surface stands for (doc/theory/contact.md, section 5).
module lengths_m
  use geometry_m, only : segment_length, separation
  use foot_m, only : facing_share, side_share
  use kinds_m, only : wp
  use radii_m, only : radius_of, end_radius
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: competence_length, competence_area, tributary_area, mean_radius, put_lengths

  !> Most nodes of a list.
  integer, parameter :: n_room = 64

contains

  !> Half of the neighbouring segments of a node at their present length, m.
  pure function competence_length(surface, places, i_node) result(length)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of this surface
    integer, intent(in) :: i_node
    real(wp) :: length

    length = 0.0_wp
    if (surface%incoming(i_node) > 0) length = length + 0.5_wp*segment_length( &
      places(:, surface%segments(1, surface%incoming(i_node))), places(:, i_node))
    if (surface%outgoing(i_node) > 0) length = length + 0.5_wp*segment_length( &
      places(:, i_node), places(:, surface%segments(2, surface%outgoing(i_node))))
  end function competence_length

  !> What a node of a surface stands for: its competence length, m; in axisymmetry the integral of
  !> the radius by its hat function, l (2 r_i + r_j)/6 of each neighbouring segment, m^2 per radian.
  pure function competence_area(surface, places, is_round, i_node) result(area)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of this surface
    logical, intent(in) :: is_round
    integer, intent(in) :: i_node
    real(wp) :: area
    integer :: k, s

    if (.not. is_round) then
      area = competence_length(surface, places, i_node)
      return
    end if
    area = 0.0_wp
    do k = 1, 2
      s = merge(surface%incoming(i_node), surface%outgoing(i_node), k == 1)
      if (s == 0) cycle
      associate (own => places(:, i_node), other => places(:, surface%segments(k, s)))
        area = area + 0.5_wp*segment_length(own, other) &
          *end_radius(radius_of(own), radius_of(other))
      end associate
    end do
  end function competence_area

  !> Tributary length of a node of a closed boundary, m: half of each of its segments as far as that
  !> is opposed to the face below the node; of the side at a corner less than that, or nothing (see
  !> `side_share`). Where the face stands between both normals of a convex vertex, what is missing
  !> to the larger share counts too. In axisymmetry the integral of the radius, m^2 per radian.
  pure function tributary_area(surface, places, is_round, i_node, normal) result(area)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of this surface
    logical, intent(in) :: is_round
    integer, intent(in) :: i_node
    real(wp), intent(in) :: normal(2)                !! outward, of the face
    real(wp) :: area
    real(wp) :: t(2, 2), halves(2), shares(2), cosines(2)
    integer :: segments(2), k

    segments = [surface%incoming(i_node), surface%outgoing(i_node)]
    halves = 0.0_wp
    shares = 0.0_wp
    cosines = 0.0_wp
    do k = 1, 2
      if (segments(k) == 0) cycle
      associate (ends => surface%segments(:, segments(k)))
        t(:, k) = separation(places(:, ends(2)), places(:, ends(1)))
        halves(k) = 0.5_wp*sqrt(t(1, k)**2 + t(2, k)**2)
        cosines(k) = (t(2, k)*normal(1) - t(1, k)*normal(2)) &
          /max(2.0_wp*halves(k), tiny(1.0_wp))
        shares(k) = facing_share(cosines(k))
        if (is_round) halves(k) = halves(k)*end_radius(radius_of(places(:, i_node)), &
          radius_of(places(:, ends(k))))
      end associate
    end do
    k = maxloc(cosines, 1)
    shares(k) = shares(k)*side_share(maxval(cosines) - minval(cosines))
    area = dot_product(halves, shares)
    if (maxval(shares) >= 1.0_wp .or. any(segments == 0)) return
    ! The opposite of the normal turns from the first of both normals to the second.
    if (dot_product(t(:, 1), normal) < 0.0_wp .and. dot_product(t(:, 2), normal) > 0.0_wp) &
      area = area + (1.0_wp - maxval(shares))*sum(halves)
  end function tributary_area

  !> The second over the first in axisymmetry, m.
  pure function mean_radius(surface, places, i_node) result(radius)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of this surface
    integer, intent(in) :: i_node
    real(wp) :: radius

    radius = competence_area(surface, places, .true., i_node) &
      /max(competence_length(surface, places, i_node), tiny(1.0_wp))
  end function mean_radius

  !> The same for some nodes, one after the other. A segment between two of
  !> them is measured once, and the roots of a list of segments are formed together: node by node it
  !> took three times as long.
  pure subroutine put_lengths(surface, places, n, nodes, areas)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of this surface
    integer, intent(in) :: n
    integer, intent(in) :: nodes(n)          !! of the surface, in order
    real(wp), intent(inout) :: areas(n)      !! m
    integer :: first, m

    do first = 1, n, n_room
      m = min(n_room, n - first + 1)
      call put_block(m, nodes(first), surface%incoming, surface%outgoing, surface%segments, &
        places, areas(first))
    end do
  end subroutine put_lengths

  !> The same for a list of them, on arrays of known shape. Nodes that follow each other have the
  !> segment between them in common, and nothing has to be looked up.
  pure subroutine put_block(n, nodes, incoming, outgoing, segments, places, areas)
    integer, intent(in) :: n, nodes(n)
    integer, intent(in) :: incoming(*), outgoing(*), segments(2, *) !! of the surface
    real(wp), intent(in) :: places(4, *)
    real(wp), intent(inout) :: areas(n)
    integer :: list(2*n_room)               !! segments
    integer, dimension(n_room) :: before, after !! of each node, on that list
    real(wp) :: halves(2*n_room)
    integer :: p, k, i

    i = nodes(1)
    if (nodes(n) - nodes(1) == n - 1) then
      if (is_run(n, incoming(i), outgoing(i))) then
        list(1) = incoming(i)
        do p = 1, n
          list(p + 1) = outgoing(i + p - 1)
        end do
        call halve_segments(n + 1, list, segments, places, halves)
        do p = 1, n
          areas(p) = halves(p) + halves(p + 1)
        end do
        return
      end if
    end if
    k = 0
    do p = 1, n
      i = nodes(p)
      if (k > 0) then
        if (list(k) /= incoming(i)) k = k + 1
      else
        k = k + 1
      end if
      list(k) = incoming(i)
      before(p) = k
      k = k + 1
      list(k) = outgoing(i)
      after(p) = k
    end do
    call halve_segments(k, list, segments, places, halves)
    do p = 1, n
      areas(p) = halves(before(p)) + halves(after(p))
    end do
  end subroutine put_block

  !> Whether the segment after each of some nodes is the one before the next.
  pure function is_run(n, incoming, outgoing)
    integer, intent(in) :: n, incoming(n), outgoing(n)
    logical :: is_run
    integer :: p, n_odd

    n_odd = 0
    do p = 2, n
      if (incoming(p) /= outgoing(p - 1)) n_odd = n_odd + 1
    end do
    is_run = n_odd == 0
  end function is_run

  !> Half of the present lengths of some segments, m: zero where there is none.
  pure subroutine halve_segments(n, list, segments, places, halves)
    integer, intent(in) :: n, list(n), segments(2, *)
    real(wp), intent(in) :: places(4, *)
    real(wp), intent(inout) :: halves(2*n_room)
    real(wp) :: vectors(2, 2*n_room)
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      call take_vector(list(k), segments, places, vectors(1, k))
    end do
    do k = 1, n
      halves(k) = 0.5_wp*sqrt(vectors(1, k)**2 + vectors(2, k)**2)
    end do
  end subroutine halve_segments

  !> Vector of a segment at its present length, m: zero where there is none.
  pure subroutine take_vector(s, segments, places, vector)
    integer, intent(in) :: s, segments(2, *)
    real(wp), intent(in) :: places(4, *)
    real(wp), intent(inout) :: vector(2)
    real(wp) :: along(4)

    if (s > 0) then
      along = places(:, segments(2, s)) - places(:, segments(1, s))
      vector = along(1:2) + along(3:4)
    else
      vector = 0.0_wp
    end if
  end subroutine take_vector

end module lengths_m
