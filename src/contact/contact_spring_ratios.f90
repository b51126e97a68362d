! SPDX-License-Identifier: MIT
!> How stiff the penalty springs of an interface can hold each of its nodes. A node of the tracked
!> side carries at most its tributary length in all formulations, for a node of the other side see
!> `most_on_nodes` (doc/theory/contact.md, section 7). In axisymmetry lengths weigh with their
!> radius: m^2 per radian.
module contact_spring_ratios_m
  use contact_dispatch_m, only : formulation_t, formulation_of, is_strict
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t, is_tied
  use geometry_m, only : segment_length
  use kinds_m, only : wp
  use tributary_lengths_m, only : nodal_area, mean_radius
  use radii_m, only : radius_of, end_radius
  use surfaces_m, only : surface_t, open_ends
  use ties_m, only : stiffness_of_nodes
  implicit none
  private
  public :: spring_ratios

  !> Part of a slave segment that points at the end of a master may stand for beyond it.
  real(wp), parameter :: beyond_ends = 0.5_wp

contains

  !> Most K/m of each node, K being the sum of spring stiffness times weight, 1/s^2. `positions` are
  !> those in the memory, all nodes in contact.
  pure function spring_ratios(contact, mass, memory) result(ratio)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: mass(:) !! (n_node) kg/m
    type(contact_state_t), intent(in) :: memory
    real(wp) :: ratio(memory%n_slave + memory%n_master) !! slave nodes, then master nodes
    type(formulation_t) :: formulation
    real(wp) :: overhang
    logical :: is_lonely, is_round

    formulation = formulation_of(contact)
    is_round = contact%is_round
    overhang = beyond_ends
    if (formulation%covers_segments .and. .not. is_strict(contact)) overhang = 0.0_wp
    is_lonely = .false.
    if (is_round .and. allocated(memory%segment_xi)) is_lonely = size(memory%segment_xi) == 1
    associate (n => memory%n_slave, slave => memory%positions(:, :memory%n_slave), &
      master => memory%positions(:, memory%n_slave + 1:))
      if (is_tied(contact)) then
        ratio = stiffness_of_nodes(memory)
      else if (formulation%has_unit_area) then
        ratio = memory%node_penalty*node_shares(contact, slave, master)
      else
        ratio(:n) = memory%slave_penalty*areas(contact%slave, slave, is_round, is_lonely)
        ratio(n + 1:) = memory%slave_penalty*most_on_nodes(contact%master, master, is_round, &
          longest_of(contact%slave, slave), overhang, is_lonely)
        if (formulation%has_two_passes) then
          ratio(:n) = ratio(:n) + memory%master_penalty*most_on_nodes(contact%slave, slave, &
            is_round, longest_of(contact%master, master), overhang, .false.)
          ratio(n + 1:) = ratio(n + 1:) + memory%master_penalty*areas(contact%master, master, &
            is_round, .false.)
        end if
      end if
    end associate
    ratio = ratio/mass(memory%nodes)
  end function spring_ratios

  !> Type 1, where each slave node has the same spring: how much of it each node of both sides can
  !> get, by its hat function over segments of length h with slave nodes at equal distances s and
  !> one at the node itself: s/2 and sum(s (1 - i s/h), i s < h) for each neighbouring segment, and
  !> at ends what lies beyond, over s. In axisymmetry slave nodes weigh with their mean radius, m.
  pure function node_shares(contact, slave, master) result(share)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: slave(:, :), master(:, :) !! (4, n_node) positions
    real(wp) :: share(size(slave, 2) + size(master, 2))
    real(wp) :: s, h(contact%master%n_segment)
    integer :: i, n, n_slave, nodes(2)

    n_slave = size(slave, 2)
    share(:n_slave) = 1.0_wp
    if (contact%is_round) share(:n_slave) = [(mean_radius(contact%slave, slave, i), i=1, n_slave)]
    share(n_slave + 1:) = beyond_ends*open_ends(contact%master)
    s = minval(lengths(contact%slave, slave))
    h = lengths(contact%master, master)
    do i = 1, contact%master%n_segment
      n = int(h(i)/s)
      nodes = n_slave + contact%master%segments(:, i)
      share(nodes) = share(nodes) + (0.5_wp + n*(1.0_wp - 0.5_wp*(n + 1)*s/h(i)))
    end do
    if (contact%is_round) share(n_slave + 1:) = share(n_slave + 1:)*(radii_near(contact%master, &
      master) + longest_of(contact%slave, slave)/3.0_wp)
  end function node_shares

  !> Competence areas of all nodes of a surface; where one Gauss point stands alone on a segment no
  !> less than half of each neighbouring segment by the radius of its middle.
  pure function areas(surface, positions, is_round, is_lonely)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :)
    logical, intent(in) :: is_round, is_lonely
    real(wp) :: areas(surface%n_node)
    real(wp) :: middle(surface%n_node)
    integer :: i

    areas = [(nodal_area(surface, positions, is_round, i), i=1, surface%n_node)]
    if (.not. is_lonely) return
    middle = 0.0_wp
    do i = 1, surface%n_segment
      associate (a => positions(:, surface%segments(1, i)), b => &
        positions(:, surface%segments(2, i)))
        middle(surface%segments(:, i)) = middle(surface%segments(:, i)) &
          + 0.25_wp*segment_length(a, b)*(radius_of(a) + radius_of(b))
      end associate
    end do
    areas = max(areas, middle)
  end function areas

  !> Largest radius on the segments beside each node, m.
  pure function radii_near(surface, positions) result(radii)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :)
    real(wp) :: radii(surface%n_node)
    integer :: i, k

    radii = 0.0_wp
    do i = 1, surface%n_segment
      do k = 1, 2
        radii(surface%segments(:, i)) = max(radii(surface%segments(:, i)), &
          radius_of(positions(:, surface%segments(k, i))))
      end do
    end do
  end function radii_near

  !> Lengths of all segments of a surface, m.
  pure function lengths(surface, positions)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :)
    real(wp) :: lengths(surface%n_segment)
    integer :: i

    do i = 1, surface%n_segment
      lengths(i) = segment_length(positions(:, surface%segments(1, i)), &
        positions(:, surface%segments(2, i)))
    end do
  end function lengths

  !> Length of the longest segment of a surface, m.
  pure real(wp) function longest_of(surface, positions)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :)

    longest_of = maxval(lengths(surface, positions))
  end function longest_of

  !> Most length, or area by radius, that points of the other side can put on each node by its hat
  !> function over segments of length h, at distances up to s or integrating segments of up to s:
  !> the integral of the hat, h/2 or h (2 r_i + r_j)/6, and the largest error of the trapezoidal
  !> rule at its projection, s^2/(8h) times the mean radius there, at most s/6 above that of the
  !> projection; or, where s > 2h, s/2 in all (the midpoint rule errs as much at the top, Gauss
  !> rules less). One Gauss point on a segment errs at the top of the hat, by s^2/12 more since
  !> radius times hat is curved. Points at a surface's end may stand for a part `overhang` of s
  !> beyond it.
  pure function most_on_nodes(surface, positions, is_round, s, overhang, is_lonely) result(most)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :)
    logical, intent(in) :: is_round
    real(wp), intent(in) :: s         !! m
    real(wp), intent(in) :: overhang
    logical, intent(in) :: is_lonely  !! one Gauss point on each segment of the other side
    real(wp) :: most(surface%n_node)
    real(wp) :: h(surface%n_segment), share, near, far, rise
    integer :: ends(surface%n_node), i, k, other

    h = lengths(surface, positions)
    rise = merge(1.0_wp, 0.0_wp, is_round)
    near = 1.0_wp
    far = 1.0_wp
    most = 0.0_wp
    ends = open_ends(surface)
    do i = 1, surface%n_segment
      do k = 1, 2
        associate (node => surface%segments(k, i))
          if (is_round) near = radius_of(positions(:, node))
          if (is_round) far = radius_of(positions(:, surface%segments(3 - k, i)))
          if (s <= 2.0_wp*h(i)) then
            share = 0.5_wp*h(i)*end_radius(near, far) &
              + s**2/(8.0_wp*h(i))*(merge(max(near, far), far, is_lonely) + rise*s/6.0_wp)
          else
            share = 0.5_wp*s*(max(near, far) + rise*s/3.0_wp)
          end if
          if (is_lonely) share = share + s**2/12.0_wp
          other = merge(surface%incoming(node), surface%outgoing(node), k == 1)
          if (other == 0 .and. ends(node) > 0) share = share + overhang*s*(near + rise*s/3.0_wp)
          most(node) = most(node) + share
        end associate
      end do
    end do
  end function most_on_nodes

end module contact_spring_ratios_m
