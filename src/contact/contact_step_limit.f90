! SPDX-License-Identifier: MIT
!> The step that the penalty springs of an interface alone allow.
!> With springs k_p between weighted means of slave and master nodes, (s - m)^2 <= (1 + c) s^2 + (1 + 1/c) m^2
!> and the convexity of the square give omega^2 <= max_s K_s/m_s + max_m K_m/m_m, where K is the sum of
!> k_p times weight at a node. It is exact for two masses and one spring (doc/theory/contact.md, section 7).
module contact_step_limit_m
  use contact_dispatch_m, only : formulation_t, formulation_of
  use contact_placing_m, only : competence_length
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: find_step_limit

  !> Most that nodes at equal spacing, each with its spacing as weight, can put on a hat function, relative
  !> to its area: reached where the spacing is 3/4 of the segment.
  real(wp), parameter :: worst_sampling = 1.125_wp

contains

  !> Stable step 2/omega of the springs alone and the node that matters most (the larger K/m). A penalty
  !> smaller by (dt/limit)^2 would fit a step dt. `places` are those in the memory, all nodes in contact.
  pure subroutine find_step_limit(contact, mass, memory, limit, node)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: mass(:) !! (n_node) kg/m
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(out) :: limit  !! s; huge without any spring
    integer, intent(out) :: node    !! index in the mesh
    type(formulation_t) :: formulation
    real(wp), allocatable :: slave_areas(:), master_areas(:), slave_ratio(:), master_ratio(:)
    integer :: n, worst(2)

    n = memory%n_slave
    formulation = formulation_of(contact)
    slave_areas = areas(contact%slave, memory%places(:, :n))
    master_areas = areas(contact%master, memory%places(:, n + 1:))
    slave_ratio = memory%slave_penalty*slave_areas
    master_ratio = memory%slave_penalty*max(worst_sampling*master_areas, maxval(slave_areas))
    if (formulation%has_unit_area) then
      slave_ratio = memory%node_penalty
      master_ratio = memory%node_penalty &
        *max(worst_sampling*master_areas*contact%slave%n_segment/sum(slave_areas), 1.0_wp)
    end if
    if (formulation%has_two_passes) then
      master_ratio = master_ratio + memory%master_penalty*master_areas
      slave_ratio = slave_ratio + memory%master_penalty &
        *max(worst_sampling*slave_areas, maxval(master_areas))
    end if
    slave_ratio = slave_ratio/mass(memory%nodes(:n))
    master_ratio = master_ratio/mass(memory%nodes(n + 1:))
    worst = [maxloc(slave_ratio, 1), maxloc(master_ratio, 1)]
    limit = 2.0_wp/sqrt(max(slave_ratio(worst(1)) + master_ratio(worst(2)), tiny(1.0_wp)))
    node = memory%nodes(merge(worst(1), n + worst(2), &
      slave_ratio(worst(1)) >= master_ratio(worst(2))))
  end subroutine find_step_limit

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

end module contact_step_limit_m
