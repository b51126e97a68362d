! SPDX-License-Identifier: MIT
!> How stiff the penalty springs of an interface can hold each of its nodes. A node of the tracked
!> side carries at most its competence length in all formulations, for a node of the other side see
!> `most_on_nodes` (doc/theory/contact.md, section 7).
module contact_spring_ratios_m
  use contact_dispatch_m, only : formulation_t, formulation_of, is_strict
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use geometry_m, only : segment_length
  use kinds_m, only : wp
  use lengths_m, only : competence_length
  use surfaces_m, only : surface_t
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
    formulation = formulation_of(contact)
    overhang = merge(0.0_wp, 0.5_wp, formulation%covers_segments .and. .not. is_strict(contact))
    associate (slave => memory%places(:, :n), master => memory%places(:, n + 1:))
      slave_spring = memory%slave_penalty*areas(contact%slave, slave)
      master_spring = memory%slave_penalty*most_on_nodes(contact%master, master, &
        maxval(lengths(contact%slave, slave)), overhang, .false.)
      if (formulation%has_unit_area) then
        slave_spring = memory%node_penalty
        spacing = minval(lengths(contact%slave, slave))
        master_spring = memory%node_penalty/spacing &
          *most_on_nodes(contact%master, master, spacing, overhang, .true.)
      end if
      if (formulation%has_two_passes) then
        master_spring = master_spring + memory%master_penalty*areas(contact%master, master)
        slave_spring = slave_spring + memory%master_penalty*most_on_nodes(contact%slave, slave, &
          maxval(lengths(contact%master, master)), overhang, .false.)
      end if
    end associate
    ratio = [slave_spring, master_spring]/mass(memory%nodes)
  end function spring_ratios

  !> Competence lengths of all nodes of a surface, m.
  pure function areas(surface, places)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :)
    real(wp) :: areas(surface%n_node)
    integer :: i

    do i = 1, surface%n_node
      areas(i) = competence_length(surface, places, i)
    end do
  end function areas

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

end module contact_spring_ratios_m
