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
  use lengths_m, only : competence_length
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
    associate (n => memory%n_slave, law => memory%contact_law)
      if (memory%slave_tracking%n_aside > 0) then
        stiffness = merge(memory%node_penalty, memory%slave_penalty, has_unit_area)
        if (allocated(memory%spots)) then
          energy = energy_of(law, stiffness, memory%slave_tracking, contact%slave, has_unit_area, &
            memory%places(:, :n), memory%spots, memory%spot_share)
        else
          energy = energy_of(law, stiffness, memory%slave_tracking, contact%slave, has_unit_area, &
            memory%places(:, :n), memory%places(:, :n))
        end if
      end if
      if (memory%master_tracking%n_aside > 0) energy = energy + energy_of(law, &
        memory%master_penalty, memory%master_tracking, contact%master, has_unit_area, &
        memory%places(:, n + 1:), memory%places(:, n + 1:))
    end associate
  end function energy_caught

  !> The same of the places of one tracking that lie along the face.
  pure function energy_of(contact_law, stiffness, tracking, own, has_unit_area, places, spots, &
    spot_share) result(total)
    integer, intent(in) :: contact_law
    real(wp), intent(in) :: stiffness                  !! N/m^2 (N/m for unit areas)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: own                 !! of the spots
    logical, intent(in) :: has_unit_area
    real(wp), intent(in), contiguous :: places(:, :)   !! (4, n_node) of this surface
    real(wp), intent(in), contiguous :: spots(:, :)    !! (4, n) places of the spots
    real(wp), intent(in), optional :: spot_share(:)    !! where spots are no nodes
    real(wp) :: total
    real(wp) :: t(2), area
    integer :: i, k, s

    total = 0.0_wp
    do k = 1, tracking%n_aside
      i = tracking%due(k)
      t = separation(spots(:, tracking%chord(2, i)), spots(:, tracking%chord(1, i)))
      if (t(2)*tracking%normal(1, i) - t(1)*tracking%normal(2, i) > -along*norm2(t)) cycle
      if (has_unit_area) then
        area = 1.0_wp
      else if (present(spot_share)) then
        s = 1 + (i - 1)/size(spot_share)
        area = spot_share(i - (s - 1)*size(spot_share))*norm2(separation( &
          places(:, own%segments(2, s)), places(:, own%segments(1, s))))
      else
        area = competence_length(own, places, i)
      end if
      total = total + area*density_of(contact_law, stiffness, tracking%gap(i))
    end do
  end function energy_of

end module caught_aside_m
