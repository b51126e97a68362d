! SPDX-License-Identifier: MIT
!> How stiff the penalty springs of an interface can hold each of its nodes. A node of the tracked
!> side carries at most its competence length in all formulations, for a node of the other side see
!> `most_on_nodes` (doc/theory/contact.md, section 7).
module contact_spring_ratios_m
  use contact_dispatch_m, only : formulation_t, formulation_of, is_strict
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t, is_tied
  use geometry_m, only : segment_length
  use kinds_m, only : wp
  use lengths_m, only : competence_area, mean_radius
  use radii_m, only : radius_of, end_radius
  use surfaces_m, only : surface_t
  use ties_m, only : stiffness_of_nodes
  implicit none
  private
  public :: spring_ratios

contains

  !> Most K/m of each node, K being the sum of spring stiffness times weight, 1/s^2. `places` are
  !> those in the memory, all nodes in contact.
  pure function spring_ratios(contact, mass, memory) result(ratio)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: mass(:) !! (n_node) kg/m
    type(contact_state_t), intent(in) :: memory
    real(wp) :: ratio(memory%n_slave + memory%n_master) !! slave nodes, then master nodes
    type(formulation_t) :: formulation
    real(wp), allocatable :: slave_spring(:), master_spring(:)
    real(wp) :: spacing, overhang
    integer :: n

    n = memory%n_slave
    if (is_tied(contact)) then
      ratio = stiffness_of_nodes(memory)/mass(memory%nodes)
      return
    end if
    if (contact%is_round) then
      ratio = round_springs(contact, memory)/mass(memory%nodes)
      return
    end if
    formulation = formulation_of(contact)
    overhang = merge(0.0_wp, 0.5_wp, formulation%covers_segments .and. .not. is_strict(contact))
    associate (slave => memory%places(:, :n), master => memory%places(:, n + 1:))
      slave_spring = memory%slave_penalty*areas(contact%slave, slave, .false.)
      master_spring = memory%slave_penalty*most_on_nodes(contact%master, master, &
        maxval(lengths(contact%slave, slave)), overhang, .false.)
      if (formulation%has_unit_area) then
        slave_spring = memory%node_penalty
        spacing = minval(lengths(contact%slave, slave))
        master_spring = memory%node_penalty/spacing &
          *most_on_nodes(contact%master, master, spacing, overhang, .true.)
      end if
      if (formulation%has_two_passes) then
        master_spring = master_spring + memory%master_penalty*areas(contact%master, master, &
          .false.)
        slave_spring = slave_spring + memory%master_penalty*most_on_nodes(contact%slave, slave, &
          maxval(lengths(contact%master, master)), overhang, .false.)
      end if
    end associate
    ratio = [slave_spring, master_spring]/mass(memory%nodes)
  end function spring_ratios

  !> In axisymmetry: the springs of all nodes, N/m per radian. The same bounds, with weights by
  !> radius; points of type 1 weigh with the mean radius of their node, one Gauss point alone on a
  !> segment with the radius of its middle.
  pure function round_springs(contact, memory) result(spring)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp) :: spring(memory%n_slave + memory%n_master)
    type(formulation_t) :: formulation
    real(wp) :: overhang, longest, shortest
    integer :: i, n
    logical :: is_lonely

    n = memory%n_slave
    formulation = formulation_of(contact)
    overhang = merge(0.0_wp, 0.5_wp, formulation%covers_segments .and. .not. is_strict(contact))
    is_lonely = .false.
    if (allocated(memory%spot_xi)) is_lonely = size(memory%spot_xi) == 1
    associate (slave => memory%places(:, :n), master => memory%places(:, n + 1:))
      longest = maxval(lengths(contact%slave, slave))
      if (formulation%has_unit_area) then
        shortest = minval(lengths(contact%slave, slave))
        spring(:n) = memory%node_penalty*[(mean_radius(contact%slave, slave, i), i=1, n)]
        spring(n + 1:) = memory%node_penalty/shortest*(radii_near(contact%master, master) &
          + longest/3.0_wp)*most_on_nodes(contact%master, master, shortest, overhang, .true.)
        return
      end if
      spring(:n) = memory%slave_penalty*areas(contact%slave, slave, .true.)
      if (is_lonely) spring(:n) = max(spring(:n), &
        memory%slave_penalty*middle_areas(contact%slave, slave))
      spring(n + 1:) = memory%slave_penalty &
        *most_by_radius(contact%master, master, longest, overhang, is_lonely)
      if (.not. formulation%has_two_passes) return
      spring(n + 1:) = spring(n + 1:) + memory%master_penalty*areas(contact%master, master, .true.)
      spring(:n) = spring(:n) + memory%master_penalty*most_by_radius(contact%slave, slave, &
        maxval(lengths(contact%master, master)), overhang, .false.)
    end associate
  end function round_springs

  !> Competence lengths of all nodes of a surface, m, or areas, m^2 per radian.
  pure function areas(surface, places, is_round)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :)
    logical, intent(in) :: is_round
    real(wp) :: areas(surface%n_node)
    integer :: i

    do i = 1, surface%n_node
      areas(i) = competence_area(surface, places, is_round, i)
    end do
  end function areas

  !> Half of each neighbouring segment times the radius of its middle, m^2 per radian.
  pure function middle_areas(surface, places) result(areas)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :)
    real(wp) :: areas(surface%n_node)
    integer :: i

    areas = 0.0_wp
    do i = 1, surface%n_segment
      associate (a => places(:, surface%segments(1, i)), b => places(:, surface%segments(2, i)))
        areas(surface%segments(:, i)) = areas(surface%segments(:, i)) &
          + 0.25_wp*segment_length(a, b)*(radius_of(a) + radius_of(b))
      end associate
    end do
  end function middle_areas

  !> Largest radius on the segments beside each node, m.
  pure function radii_near(surface, places) result(radii)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :)
    real(wp) :: radii(surface%n_node)
    integer :: i, k

    radii = 0.0_wp
    do i = 1, surface%n_segment
      do k = 1, 2
        radii(surface%segments(:, i)) = max(radii(surface%segments(:, i)), &
          radius_of(places(:, surface%segments(k, i))))
      end do
    end do
  end function radii_near

  !> Lengths of all segments of a surface, m.
  pure function lengths(surface, places)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :)
    real(wp) :: lengths(surface%n_segment)
    integer :: i

    do i = 1, surface%n_segment
      lengths(i) = segment_length(places(:, surface%segments(1, i)), &
        places(:, surface%segments(2, i)))
    end do
  end function lengths

  !> Most length that points of the other side can put on each node, by its hat function over
  !> segments of length h. At equal distances s, each with the length s: with a point at the node,
  !> s/2 and sum(s (1 - i s/h), i s < h) for each neighbouring segment. At distances up to s, or
  !> integrating segments of up to s: h/2, and the largest error of the trapezoidal rule at the foot
  !> of the hat, s^2/(8h), or (s - h)/2 when s > 2h (the midpoint rule errs as much at the top,
  !> Gauss rules less). Points at a chain's end may stand for a part `overhang` of s beyond it.
  pure function most_on_nodes(surface, places, s, overhang, at_equal_distances) result(most)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :)
    real(wp), intent(in) :: s        !! m
    real(wp), intent(in) :: overhang
    logical, intent(in) :: at_equal_distances
    real(wp) :: most(surface%n_node)
    real(wp) :: h(surface%n_segment), share
    integer :: i, n

    most = overhang*s*(merge(1, 0, surface%incoming == 0) + merge(1, 0, surface%outgoing == 0))
    h = lengths(surface, places)
    do i = 1, surface%n_segment
      if (at_equal_distances) then
        n = int(h(i)/s)
        share = s*(0.5_wp + n*(1.0_wp - 0.5_wp*(n + 1)*s/h(i)))
      else
        share = 0.5_wp*h(i) &
          + merge(s**2/(8.0_wp*h(i)), 0.5_wp*(s - h(i)), s <= 2.0_wp*h(i))
      end if
      most(surface%segments(:, i)) = most(surface%segments(:, i)) + share
    end do
  end function most_on_nodes

  !> The same weighted with the radius, m^2 per radian, at distances up to s: the integral of the
  !> hat function by radius, h (2 r_i + r_j)/6, and the error at its foot with the mean radius
  !> there, at most s/6 above that of the foot. One Gauss point on a segment errs at the top of the
  !> hat instead, and by s^2/12 since radius times hat function is curved.
  pure function most_by_radius(surface, places, s, overhang, is_lonely) result(most)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :)
    real(wp), intent(in) :: s         !! m
    real(wp), intent(in) :: overhang  !! see above
    logical, intent(in) :: is_lonely  !! one Gauss point on each segment of the other side
    real(wp) :: most(surface%n_node)
    real(wp) :: h(surface%n_segment), share, near, far
    integer :: i, k, other

    h = lengths(surface, places)
    most = 0.0_wp
    do i = 1, surface%n_segment
      do k = 1, 2
        associate (node => surface%segments(k, i))
          near = radius_of(places(:, node))
          far = radius_of(places(:, surface%segments(3 - k, i)))
          if (s <= 2.0_wp*h(i)) then
            share = 0.5_wp*h(i)*end_radius(near, far) &
              + s**2/(8.0_wp*h(i))*(merge(max(near, far), far, is_lonely) + s/6.0_wp)
          else
            share = 0.5_wp*s*(max(near, far) + s/3.0_wp)
          end if
          if (is_lonely) share = share + s**2/12.0_wp
          other = merge(surface%incoming(node), surface%outgoing(node), k == 1)
          if (other == 0) share = share + overhang*s*(near + s/3.0_wp)
          most(node) = most(node) + share
        end associate
      end do
    end do
  end function most_by_radius

end module contact_spring_ratios_m
