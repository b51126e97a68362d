! SPDX-License-Identifier: MIT
!> Places caught from beside: they come in over the end of a chain, behind a face before which they
!> never stood, as when a body slides on to the end of another. Nobody has loaded their springs
!> (doc/theory/contact.md, section 6.1).
module caught_aside_m
  use contact_law_m, only : density_of
  use contact_state_m, only : contact_state_t, tracking_t
  use contacts_m, only : contact_t
  use geometry_m, only : separation
  use kinds_m, only : wp
  use lengths_m, only : competence_area, mean_radius
  use radii_m, only : radius_between
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: energy_caught

  !> Surfaces that slide on to each other lie along each other: the cosine between one's normal and
  !> the opposite of the other's is larger than this. At corners nothing is granted.
  real(wp), parameter :: along = 0.9_wp

contains

  !> Energy of the springs at places that the last search has caught from beside, J/m.
  pure function energy_caught(contact, has_unit_area, memory) result(energy)
    type(contact_t), intent(in) :: contact
    logical, intent(in) :: has_unit_area !! the penalty is N/m per node
    type(contact_state_t), intent(in) :: memory
    real(wp) :: energy
    real(wp) :: stiffness

    energy = 0.0_wp
    associate (n => memory%n_slave, tracking => memory%slave_tracking)
      if (tracking%n_aside > 0) then
        stiffness = merge(memory%node_penalty, memory%slave_penalty, has_unit_area)
        if (allocated(memory%spots)) then
          energy = energy_of(memory%contact_law, stiffness, tracking, memory%spots, &
            spot_areas(contact, memory))
        else
          energy = energy_of(memory%contact_law, stiffness, tracking, memory%places(:, :n), &
            node_areas(contact%slave, memory%places(:, :n), tracking, contact%is_round, &
            has_unit_area))
        end if
      end if
    end associate
    associate (chain => memory%places(:, memory%n_slave + 1:), tracking => memory%master_tracking)
      if (tracking%n_aside > 0) energy = energy + energy_of(memory%contact_law, &
        memory%master_penalty, tracking, chain, node_areas(contact%master, chain, tracking, &
        contact%is_round, has_unit_area))
    end associate
  end function energy_caught

  !> The same of the places of one tracking that lie along the face.
  pure function energy_of(contact_law, stiffness, tracking, spots, areas) result(total)
    integer, intent(in) :: contact_law
    real(wp), intent(in) :: stiffness                  !! N/m^2 (N/m for unit areas)
    type(tracking_t), intent(in) :: tracking
    real(wp), intent(in), contiguous :: spots(:, :)    !! (4, n) places of the spots
    real(wp), intent(in) :: areas(:)                   !! (n_aside) m
    real(wp) :: total
    real(wp) :: t(2)
    integer :: i, k

    total = 0.0_wp
    do k = 1, tracking%n_aside
      i = tracking%due(k)
      t = separation(spots(:, tracking%chord(2, i)), spots(:, tracking%chord(1, i)))
      if (t(2)*tracking%normal(1, i) - t(1)*tracking%normal(2, i) > -along*norm2(t)) cycle
      total = total + areas(k)*density_of(contact_law, stiffness, tracking%gap(i))
    end do
  end function energy_of

  !> Areas of the nodes that were caught, m.
  pure function node_areas(own, places, tracking, is_round, has_unit_area) result(areas)
    type(surface_t), intent(in) :: own
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of this surface
    type(tracking_t), intent(in) :: tracking
    logical, intent(in) :: is_round, has_unit_area
    real(wp) :: areas(tracking%n_aside)
    integer :: k

    areas = 1.0_wp
    do k = 1, tracking%n_aside
      associate (i => tracking%due(k))
        if (.not. has_unit_area) then
          areas(k) = competence_area(own, places, is_round, i)
        else if (is_round) then
          areas(k) = mean_radius(own, places, i)
        end if
      end associate
    end do
  end function node_areas

  !> The same of spots between the nodes of the slave.
  pure function spot_areas(contact, memory) result(areas)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp) :: areas(memory%slave_tracking%n_aside)
    integer :: k, n, s, q

    n = size(memory%spot_share)
    do k = 1, size(areas)
      s = 1 + (memory%slave_tracking%due(k) - 1)/n
      q = memory%slave_tracking%due(k) - (s - 1)*n
      associate (a => memory%places(:, contact%slave%segments(1, s)), &
        b => memory%places(:, contact%slave%segments(2, s)))
        areas(k) = memory%spot_share(q)*norm2(separation(b, a))
        if (contact%is_round) areas(k) = areas(k)*radius_between(a, b, memory%spot_xi(q))
      end associate
    end do
  end function spot_areas

end module caught_aside_m
