! SPDX-License-Identifier: MIT
!> Mass scaling (DT2MS of *CONTROL_TIMESTEP): mass is added to elements until their stable step is
!> |DT2MS|; with DT2MS > 0 mass is also removed from elements of larger steps. Omega falls with the
!> root of the mass, and the damping of a mode falls faster, so that the step rises at least with
!> the root of the mass. With less mass damping grows: with damping the step is taken proportional
!> to the mass.
module mass_scaling_m
  use block_state_m, only : block_state_t
  use element_mass_m, only : element_shares
  use element_steps_m, only : chunk_steps, scaled_step, is_damped, exposed_step
  use kinds_m, only : wp
  use layout_m, only : chunk_size, slot_part, tile_t
  use model_m, only : model_t
  implicit none
  private
  public :: scales_masses, start_mass_scaling, refine_limits, needs_refinement, grow_masses, &
    added_masses

  !> Factor on the step of an element that gets mass during the run, so that the mass suffices for
  !> some cycles.
  real(wp), parameter :: reserve = 1.01_wp

contains

  !> Whether a run scales masses.
  pure function scales_masses(model) result(scales)
    type(model_t), intent(in) :: model
    logical :: scales

    scales = abs(model%controls%mass_step) > 0.0_wp .and. .not. model%controls%implicit%is_on
  end function scales_masses

  !> Scale the masses at time zero.
  subroutine start_mass_scaling(model, motion, elements, mass)
    type(model_t), intent(in) :: model
    real(wp), intent(in), contiguous :: motion(:, :)  !! (4, n_node)
    type(block_state_t), intent(inout) :: elements
    real(wp), intent(inout) :: mass(:)                !! (n_node) from the densities in
    real(wp) :: steps(chunk_size)
    integer :: i_chunk, i, slot

    allocate (elements%mass_ratio(model%layout%n_slot), source=1.0_wp)
    do i_chunk = 1, size(elements%time_limit)
      call chunk_steps(model, elements, i_chunk, motion, 0.0_wp, steps)
      do i = 1, model%layout%chunk_elements(i_chunk)
        if (.not. model%controls%mass_step > 0.0_wp .and. steps(i) &
          >= abs(model%controls%mass_step)) cycle
        slot = (i_chunk - 1)*chunk_size + i
        call set_ratio(model, slot, needed_ratio(model, slot, steps(i), &
          abs(model%controls%mass_step)), elements, mass)
      end do
    end do
  end subroutine start_mass_scaling

  !> Set the mass of an element and update its nodes.
  pure subroutine set_ratio(model, slot, ratio, elements, mass)
    type(model_t), intent(in) :: model
    integer, intent(in) :: slot
    real(wp), intent(in) :: ratio
    type(block_state_t), intent(inout) :: elements
    real(wp), intent(inout) :: mass(:)
    real(wp) :: shares(4)
    integer :: k

    shares = (ratio - elements%mass_ratio(slot))*element_shares(model, slot)
    elements%mass_ratio(slot) = ratio
    do k = 1, 4
      associate (node => model%layout%slot_nodes(k, slot))
        mass(node) = mass(node) + shares(k)
      end associate
    end do
  end subroutine set_ratio

  !> Whether the step limits of the forces do not hold for all elements.
  pure function needs_refinement(elements) result(needs)
    type(block_state_t), intent(in) :: elements
    logical :: needs

    needs = allocated(elements%mass_ratio) .or. allocated(elements%retardation) &
      .or. allocated(elements%mass_shares)
  end function needs_refinement

  !> Update the step limits of the chunks of a tile with scaled, damped or exposed elements.
  subroutine refine_limits(model, tile, motion, dt, elements)
    type(model_t), intent(in) :: model
    type(tile_t), intent(in) :: tile
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp), intent(in) :: dt                       !! previous step
    type(block_state_t), intent(inout) :: elements   !! only this tile's chunks are touched
    integer :: i_chunk

    do i_chunk = tile%first_chunk, tile%last_chunk
      call limit_chunk(model, i_chunk, motion, dt, elements)
    end do
  end subroutine refine_limits

  !> Step limit of one chunk; at most DT2MS if that is positive.
  subroutine limit_chunk(model, i_chunk, motion, dt, elements)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    real(wp) :: steps(chunk_size), limit
    integer :: i, first
    logical :: is_own !! scaled or damped

    first = (i_chunk - 1)*chunk_size + 1
    is_own = .false.
    if (allocated(elements%mass_ratio)) is_own = &
      any(abs(elements%mass_ratio(first:first + chunk_size - 1) - 1.0_wp) > 0.0_wp)
    if (allocated(elements%retardation)) is_own = is_own .or. elements%retardation(first) > 0.0_wp
    if (.not. is_own) then
      if (.not. allocated(elements%mass_shares)) return
      if (.not. any(elements%mass_shares(:, first:first + chunk_size - 1) > 0.0_wp)) return
      do i = 1, model%layout%chunk_elements(i_chunk)
        elements%time_limit(i_chunk) = min(elements%time_limit(i_chunk), exposed_step(model, &
          elements, first + i - 1, motion))
      end do
      return
    end if
    call chunk_steps(model, elements, i_chunk, motion, dt, steps)
    limit = huge(1.0_wp)
    do i = 1, model%layout%chunk_elements(i_chunk)
      limit = min(limit, scaled_step(model, first + i - 1, steps(i), elements))
    end do
    if (model%controls%mass_step > 0.0_wp) limit = min(limit, model%controls%mass_step)
    elements%time_limit(i_chunk) = limit
  end subroutine limit_chunk

  !> Add mass to elements whose stable step has become too small, on the geometry of the next cycle.
  !> Velocities stay: `work` is the kinetic energy of the new mass.
  subroutine grow_masses(model, motion, dt, elements, mass, work)
    type(model_t), intent(in) :: model
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    real(wp), intent(inout) :: mass(:)
    real(wp), intent(out) :: work
    real(wp) :: steps(chunk_size), target, before(4)
    integer :: i_chunk, i, slot

    target = abs(model%controls%mass_step)
    work = 0.0_wp
    do i_chunk = 1, size(elements%time_limit)
      if (elements%time_limit(i_chunk) >= target) cycle
      call chunk_steps(model, elements, i_chunk, motion, dt, steps)
      do i = 1, model%layout%chunk_elements(i_chunk)
        slot = (i_chunk - 1)*chunk_size + i
        if (scaled_step(model, slot, steps(i), elements) >= target) cycle
        associate (nodes => model%layout%slot_nodes(:, slot))
          before = mass(nodes)
          call set_ratio(model, slot, max(elements%mass_ratio(slot), needed_ratio(model, slot, &
            steps(i), reserve*target)), elements, mass)
          work = work + 0.5_wp*sum((mass(nodes) - before)*(motion(3, nodes)**2 &
            + motion(4, nodes)**2), [.true., .true., .true., nodes(4) /= nodes(3)])
        end associate
      end do
      call limit_chunk(model, i_chunk, motion, dt, elements)
    end do
  end subroutine grow_masses

  !> Mass ratio that takes an element from one stable step to another.
  pure function needed_ratio(model, slot, step, target) result(ratio)
    type(model_t), intent(in) :: model
    integer, intent(in) :: slot
    real(wp), intent(in) :: step, target !! s
    real(wp) :: ratio

    ratio = target/step
    if (ratio < 1.0_wp) then
      if (is_damped(model, model%parts(slot_part(model%layout, slot)))) return
    end if
    ratio = ratio**2
  end function needed_ratio

  !> Added mass of each part, negative where mass was removed, and its mass from the densities.
  pure subroutine added_masses(model, elements, added, own)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    real(wp), intent(out) :: added(:), own(:) !! (n_part) kg per metre of depth or per radian
    real(wp) :: mass
    integer :: i_chunk, i, slot

    added = 0.0_wp
    own = 0.0_wp
    do i_chunk = 1, model%layout%n_chunk
      associate (part => model%layout%chunk_part(i_chunk))
        do i = 1, model%layout%chunk_elements(i_chunk)
          slot = (i_chunk - 1)*chunk_size + i
          mass = sum(element_shares(model, slot))
          own(part) = own(part) + mass
          added(part) = added(part) + (elements%mass_ratio(slot) - 1.0_wp)*mass
        end do
      end associate
    end do
  end subroutine added_masses

end module mass_scaling_m
