! SPDX-License-Identifier: MIT
!> The memory of an interface before it has looked at anything: shapes and penalties.
module contact_preparation_m
  use contact_dispatch_m, only : formulation_t, formulation_of
  use contact_penalty_m, only : set_penalties
  use contact_state_m, only : contact_state_t, features_t, allocate_points, allocate_damping, &
    allocate_tractions, allocate_scratch, sites_of_segment
  use contacts_m, only : contact_t, has_friction, is_tied, breaks, penalty_implicit
  use law_state_m, only : allocate_limit, allocate_friction, allocate_interference
  use initial_status_m, only : allocate_slave_status, allocate_master_status, allocate_segments
  use kinds_m, only : wp
  use model_m, only : model_t
  use points_on_segments_m, only : start_segment_points, points_at_nodes
  use sharp_vertices_m, only : has_folds
  implicit none
  private
  public :: prepare_contact

contains

  !> The memory of one interface that knows nothing yet.
  subroutine prepare_contact(contact, model, memory)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(out) :: memory
    type(formulation_t) :: formulation
    real(wp) :: origin(2)
    integer :: n_slave, n_master, i

    n_slave = contact%slave%n_node
    n_master = contact%master%n_node
    memory%n_slave = n_slave
    memory%n_master = n_master
    memory%nodes = [contact%slave%nodes, contact%master%nodes]
    allocate (memory%force(2, n_slave + n_master), memory%positions(4, n_slave + n_master), &
      source=0.0_wp)
    origin = model%mesh%coordinates(:, memory%nodes(1))
    if (contact%is_round) origin(1) = 0.0_wp
    do i = 1, size(memory%nodes)
      memory%positions(1:2, i) = model%mesh%coordinates(:, memory%nodes(i)) - origin
    end do
    formulation = formulation_of(contact)
    memory%contact_law = formulation%contact_law
    memory%has = features_of(contact, formulation, model%controls%implicit%is_on)
    call set_penalties(contact, model, formulation%self_share, memory)
    call start_segment_points(formulation%segment_points, contact%n_gauss, contact%is_round, &
      has_folds(contact), contact%slave, memory)
    call allocate_slave_status(contact, model, memory)
    if (formulation%has_two_passes) call allocate_master_status(contact, model, memory)
    if (memory%has%overlaps) call allocate_segments(contact, memory)
    call allocate_points(memory%points, formulation%points_per_slave*memory%slave_status%n &
      + formulation%points_per_master*n_master)
    if (memory%has%nodal_pressure) allocate (memory%node_pressure(n_slave), source=0.0_wp)
    if (memory%has%damping) then
      call allocate_damping(memory%points)
      allocate (memory%damping_force(2, n_slave + n_master), source=0.0_wp)
    end if
    if (memory%has%limit) call allocate_limit(memory%limit, n_slave + n_master)
    if (memory%has%friction) then
      call allocate_tractions(memory%points)
      call allocate_friction(memory%friction, sites_of_segment(memory)*n_slave + n_master, &
        n_slave + n_master)
    end if
    if (memory%has%interference) call allocate_interference(memory%interference, &
      sites_of_segment(memory)*n_slave, n_master)
    call allocate_scratch(memory)
  end subroutine prepare_contact

  !> What an interface has by its formulation and by the deck. Forces of the end of the step have an
  !> energy limit of their own, which has to know them apart from those of friction.
  pure function features_of(contact, formulation, is_implicit) result(has)
    type(contact_t), intent(in) :: contact
    type(formulation_t), intent(in) :: formulation
    logical, intent(in) :: is_implicit !! the whole run
    type(features_t) :: has

    has%segment_points = formulation%segment_points /= points_at_nodes
    has%overlaps = formulation%covers_segments
    has%nodal_pressure = formulation%has_nodal_pressure
    has%damping = contact%damping > 0.0_wp
    has%friction = has_friction(contact)
    has%interference = allocated(contact%interference)
    has%ties = is_tied(contact)
    has%breaks = breaks(contact)
    has%tie_handover = contact%behind > 0
    has%limit = .not. (is_implicit .or. has%ties &
      .or. contact%penalty_unit == penalty_implicit .and. .not. has%friction)
    has%entry_offsets = contact%penalty_unit /= penalty_implicit
  end function features_of

end module contact_preparation_m
