! SPDX-License-Identifier: MIT
!> Tributary lengths: what each node of a surface stands for (doc/theory/contact.md, section 5); in
!> axisymmetry, where the x of a position is its radius, lengths weigh with it while projections
!> stay plane (section 5.8).
module tributary_lengths_m
  use search_state_m, only : contact_status_t
  use projection_m, only : opposed_share, side_share, slave_side
  use geometry_m, only : separation
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: radius_of, end_radius, radius_between, centroid, find_half, nodal_area, find_nodal_areas

contains

  !> Radius of a position, m.
  pure function radius_of(position) result(radius)
    real(wp), intent(in) :: position(4)
    real(wp) :: radius

    radius = position(1) + position(3)
  end function radius_of

  !> Mean radius of a straight stretch as one of its ends has it: with l/2 the integral of r over
  !> the stretch by the hat function of that end.
  elemental function end_radius(near, far) result(radius)
    real(wp), intent(in) :: near, far !! radii of that end and of the other, m
    real(wp) :: radius

    radius = (2.0_wp*near + far)/3.0_wp
  end function end_radius

  !> Radius at xi between two positions, m.
  pure function radius_between(a, b, xi) result(radius)
    real(wp), intent(in) :: a(4), b(4), xi
    real(wp) :: radius

    radius = radius_of(a) + xi*((b(1) - a(1)) + (b(3) - a(3)))
  end function radius_between

  !> Where the centre of a stretch of the segment a-b is when its parts weigh with their radius. On
  !> the axis itself nothing has weight: there it is the middle; never outside of the stretch.
  pure function centroid(a, b, low, high) result(xi)
    real(wp), intent(in) :: a(4), b(4)
    real(wp), intent(in) :: low, high !! where the stretch starts and ends on the segment, 0 to 1
    real(wp) :: xi
    real(wp) :: first, last

    first = radius_between(a, b, low)
    last = radius_between(a, b, high)
    xi = 0.5_wp*(low + high) + (high - low)/6.0_wp &
      *max(-3.0_wp, min(3.0_wp, (last - first)/max(first + last, tiny(1.0_wp))))
  end function centroid

  !> What a node of a surface stands for: half of its segments, m; in axisymmetry the integral of
  !> the radius by its hat function, l (2 r_i + r_j)/6 of each segment, m^2 per radian.
  pure function nodal_area(surface, positions, is_axisymmetric, i_node) result(area)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of this surface
    logical, intent(in) :: is_axisymmetric
    integer, intent(in) :: i_node
    real(wp) :: area
    real(wp) :: t(2), half_lengths(2)
    integer :: k

    do k = 1, 2
      call find_half(surface, positions, is_axisymmetric, i_node, k, t, half_lengths(k))
    end do
    area = half_lengths(1) + half_lengths(2)
  end function nodal_area

  !> Tributary lengths of the active nodes of a surface, m: half of each of their segments; in
  !> axisymmetry as above, m^2 per radian. On a closed boundary segments count as far as they are
  !> opposed to the face below the node. A segment between two active nodes is seen once.
  pure subroutine find_nodal_areas(surface, positions, is_axisymmetric, status, areas)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of this surface
    logical, intent(in) :: is_axisymmetric
    type(contact_status_t), intent(in) :: status     !! of its nodes
    real(wp), intent(inout), contiguous :: areas(:)  !! (n_active)
    real(wp) :: t(2, 2), half_lengths(2)
    integer :: k, seen

    seen = 0
    half_lengths = 0.0_wp
    do k = 1, status%n_active
      associate (node => status%active_points(k))
        if (seen > 0 .and. seen == surface%incoming(node) .and. .not. is_axisymmetric) then
          t(:, 1) = t(:, 2)
          half_lengths(1) = half_lengths(2)
        else
          call find_half(surface, positions, is_axisymmetric, node, 1, t(:, 1), half_lengths(1))
        end if
        call find_half(surface, positions, is_axisymmetric, node, 2, t(:, 2), half_lengths(2))
        seen = surface%outgoing(node)
        areas(k) = half_lengths(1) + half_lengths(2)
        if (status%pass%is_closed) areas(k) = opposed_part(t, half_lengths, status%normal(:, node))
      end associate
    end do
  end subroutine find_nodal_areas

  !> The segment before (1) or after (2) a node: its vector, m, and half of its length, in
  !> axisymmetry weighted with the radius; zero where there is none.
  pure subroutine find_half(surface, positions, is_axisymmetric, i_node, k, t, half)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :)
    logical, intent(in) :: is_axisymmetric
    integer, intent(in) :: i_node, k
    real(wp), intent(out) :: t(2), half
    integer :: s

    t = 0.0_wp
    half = 0.0_wp
    s = merge(surface%incoming(i_node), surface%outgoing(i_node), k == 1)
    if (s == 0) return
    associate (ends => surface%segments(:, s))
      t = separation(positions(:, ends(2)), positions(:, ends(1)))
      half = 0.5_wp*sqrt(t(1)*t(1) + t(2)*t(2))
      if (is_axisymmetric) half = half*end_radius(radius_of(positions(:, i_node)), &
        radius_of(positions(:, ends(k))))
    end associate
  end subroutine find_half

  !> Part of the halves of both segments at a node that counts below a face: each as far as it is
  !> opposed, segments at a sharp vertex together one (see `side_share`). Where the face stands
  !> between both normals of a convex vertex, what is missing to the larger share counts too. At an
  !> end, as on the axis, all counts.
  pure function opposed_part(t, half_lengths, normal) result(area)
    real(wp), intent(in) :: t(2, 2)    !! vectors of the segments before and after the node, m
    real(wp), intent(in) :: half_lengths(2)
    real(wp), intent(in) :: normal(2)  !! outward, of the face
    real(wp) :: area
    real(wp) :: opposed(2), cosines(2), shares(2), turn
    integer :: k

    area = sum(half_lengths)
    if (.not. minval(half_lengths) > 0.0_wp) return
    do k = 1, 2
      cosines(k) = (t(2, k)*normal(1) - t(1, k)*normal(2))/sqrt(t(1, k)**2 + t(2, k)**2)
      opposed(k) = opposed_share(cosines(k))
    end do
    shares = 1.0_wp
    if (t(1, 1)*t(2, 2) - t(2, 1)*t(1, 2) > 0.0_wp) then
      turn = dot_product(t(:, 1), t(:, 2))/sqrt(sum(t(:, 1)**2)*sum(t(:, 2)**2))
      shares = [side_share(turn, cosines(1) - cosines(2), slave_side), &
        side_share(turn, cosines(2) - cosines(1), slave_side)]
    end if
    area = dot_product(half_lengths, shares*opposed)
    if (maxval(opposed) >= 1.0_wp) return
    ! The opposite of the normal turns from the first of both normals to the second.
    if (dot_product(t(:, 1), normal) < 0.0_wp .and. dot_product(t(:, 2), normal) > 0.0_wp) &
      area = area + (1.0_wp - maxval(opposed))*0.5_wp*sum(shares)*sum(half_lengths)
  end function opposed_part

end module tributary_lengths_m
