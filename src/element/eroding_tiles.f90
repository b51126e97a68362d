! SPDX-License-Identifier: MIT
!> Element forces of tiles with erosion. An eroded element stays in its slot as padding: much
!> larger, all of its nodes equal, without stress or force.
module eroding_tiles_m
  use block_state_m, only : block_state_t, intact, newly_eroded
  use element_chunk_m, only : element_chunk_t, reference_inverse, reference_sum, &
    scatter_forces
  use element_state_m, only : smallest_ratio, initial_volume, thickness_strain_of_slot
  use eos_pressure_m, only : find_failed_elements
  use kinds_m, only : wp
  use layout_m, only : chunk_size, tile_t
  use material_dispatch_m, only : history_size
  use model_m, only : model_t
  use parts_m, only : has_memory_of_heat, erosion_t, asks_for_strain, asks_for_stress
  use plane_stress_m, only : thinning_start
  use quad_m, only : advance_chunk
  use quad_points_m, only : n_point
  use element_steps_m, only : own_steps
  implicit none
  private
  public :: add_eroding_tile_forces, advance_eroding_chunk

  !> Scale factor of the reference shape of an eroded element.
  real(wp), parameter :: much = 1.0e6_wp

  !> Elements of a chunk that erode in this step, and values of all elements before it.
  type :: eroding_t
    logical :: flags(chunk_size) = .false.
    real(wp) :: energy(chunk_size)    !! internal, per initial volume
    real(wp) :: hourglass(chunk_size) !! J/m
    real(wp) :: work                  !! of the hourglass forces of the chunk, J/m
  end type eroding_t

contains

  !> Advance all elements of one tile as `add_tile_forces`, with erosion; elements that erode in
  !> this step have no force.
  subroutine add_eroding_tile_forces(model, tile, motion, times, elements, force)
    type(model_t), intent(in) :: model
    type(tile_t), intent(in) :: tile
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node)
    real(wp), intent(in) :: times(2)                   !! time of the motion, and the step before it
    type(block_state_t), intent(inout) :: elements     !! only this tile's slots are touched
    real(wp), intent(inout) :: force(2, model%layout%n_local) !! set here
    type(element_chunk_t) :: chunk
    integer :: i_chunk

    force = 0.0_wp
    do i_chunk = tile%first_chunk, tile%last_chunk
      call advance_eroding_chunk(model, i_chunk, motion, times, elements, chunk)
      call scatter_forces(model%layout%chunk_elements(i_chunk), model%layout%slot_local(1, &
        (i_chunk - 1)*chunk_size + 1), chunk, force)
    end do
  end subroutine add_eroding_tile_forces

  !> Advance one chunk as `advance_chunk`, with erosion.
  subroutine advance_eroding_chunk(model, i_chunk, motion, times, elements, chunk)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node)
    real(wp), intent(in) :: times(2)                   !! time of the motion, and the step before it
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk      !! forces out
    type(eroding_t) :: leaving
    integer :: nodes(4, chunk_size), first, i

    first = (i_chunk - 1)*chunk_size + 1
    ! All nodes of an eroded element are its first one.
    nodes = model%layout%slot_nodes(:, first:first + chunk_size - 1)
    do i = 1, chunk_size
      if (elements%erosion%status(first + i - 1) /= intact) nodes(:, i) = nodes(1, i)
    end do
    leaving%energy = 0.0_wp
    associate (i_eos => elements%eos_start(i_chunk))
      if (i_eos > 0) leaving%energy = elements%eos_state(i_eos:i_eos + chunk_size - 1)
    end associate
    leaving%hourglass = elements%erosion%hourglass(first:first + chunk_size - 1)
    leaving%work = elements%hourglass_work(i_chunk)
    call advance_chunk(model, i_chunk, nodes, motion, times(2), elements, chunk)
    if (times(2) > 0.0_wp) then
      call find_eroding(model, i_chunk, nodes, motion, times, elements, leaving%flags)
      if (any(leaving%flags)) call erode_elements(model, i_chunk, motion, times(2), leaving, &
        elements, chunk)
    end if
    if (elements%erosion%n_removed(i_chunk) == 0) return
    do i = 1, chunk_size
      if (elements%erosion%status(first + i - 1) == intact) cycle
      chunk%force3(:, i) = 0.0_wp
      chunk%force4(:, i) = 0.0_wp
      chunk%swing(:, i) = 0.0_wp
      if (chunk%is_axisymmetric) chunk%hoop(i) = 0.0_wp
    end do
  end subroutine advance_eroding_chunk

  !> Erode elements: store their energies and set the limits of the chunk to those of the others.
  subroutine erode_elements(model, i_chunk, motion, dt, leaving, elements, chunk)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp), intent(in) :: dt
    type(eroding_t), intent(in) :: leaving
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(in) :: chunk
    real(wp) :: steps(chunk_size), limit, volume, share, v(2, 4)
    integer :: i, slot, i_eos

    limit = huge(1.0_wp)
    volume = huge(1.0_wp)
    call own_steps(model, elements, i_chunk, motion, steps)
    elements%hourglass_work(i_chunk) = leaving%work
    i_eos = elements%eos_start(i_chunk)
    do i = 1, model%layout%chunk_elements(i_chunk)
      slot = (i_chunk - 1)*chunk_size + i
      if (elements%erosion%status(slot) /= intact) cycle
      if (.not. leaving%flags(i)) then
        elements%hourglass_work(i_chunk) = elements%hourglass_work(i_chunk) &
          + (elements%erosion%hourglass(slot) - leaving%hourglass(i))
        limit = min(limit, steps(i))
        volume = min(volume, smallest_ratio(model, motion, elements, slot))
        cycle
      end if
      ! The force at the end of the step does no work: take back half of the work of the step.
      v = motion(3:4, model%layout%slot_nodes(:, slot))
      share = dot_product(chunk%force3(:, i), v(:, 3) - v(:, 1)) + dot_product(chunk%force4(:, i), &
        v(:, 4) - v(:, 2)) + dot_product(chunk%swing(:, i), v(:, 1) - v(:, 2) + v(:, 3) - v(:, 4))
      if (chunk%is_axisymmetric) share = share + chunk%hoop(i)*sum(v(1, :))
      share = 0.5_wp*dt*share
      if (elements%eos_state(i_eos + 2*chunk_size + i - 1) > -1.0_wp .and. abs(share) &
        <= huge(1.0_wp)) then
        elements%erosion%internal(slot) = elements%eos_state(i_eos + i - 1) &
          *initial_volume(model, elements, slot) - share
      else
        elements%erosion%hourglass(slot) = leaving%hourglass(i)
        elements%erosion%internal(slot) = leaving%energy(i)*initial_volume(model, elements, slot)
      end if
      elements%hourglass_work(i_chunk) = elements%hourglass_work(i_chunk) - leaving%hourglass(i)
      elements%erosion%status(slot) = newly_eroded
      elements%erosion%n_removed(i_chunk) = elements%erosion%n_removed(i_chunk) + 1
      call make_padding(model, i_chunk, i, elements)
    end do
    elements%time_limit(i_chunk) = limit
    elements%volume_limit(i_chunk) = volume
  end subroutine erode_elements

  !> Turn an element slot into padding.
  pure subroutine make_padding(model, i_chunk, i, elements)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk, i
    type(block_state_t), intent(inout) :: elements
    integer :: slot, first, k, n

    slot = (i_chunk - 1)*chunk_size + i
    associate (reference => elements%reference, &
      material => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
      n = min(size(reference, 2), reference_inverse - 1)
      reference(slot, :n) = much*reference(slot, :n)
      if (size(reference, 2) > n) reference(slot, n + 1:) = reference(slot, n + 1:)/much**3
      elements%deviator(slot, :) = 0.0_wp
      n = merge(n_point, 1, elements%point_start(i_chunk) > 0)
      do k = 0, merge(3*n, 0, n > 1) - 1
        elements%point_deviator(elements%point_start(i_chunk) + k*chunk_size + i - 1) = 0.0_wp
      end do
      ! Plastic strain, temperature and damage stay for output; back stress would give a force.
      n = merge(n, 0, elements%history_start(i_chunk) > 0)*history_size(material)
      do k = 0, n - 1
        associate (value => elements%history(elements%history_start(i_chunk) + k*chunk_size + i &
          - 1))
          if (mod(k, history_size(material)) > 0 .and. .not. has_memory_of_heat(material)) &
            value = 0.0_wp
          if (.not. abs(value) <= huge(1.0_wp)) value = 0.0_wp
        end associate
      end do
      first = elements%hourglass_start(i_chunk) + i - 1
      if (first >= i) elements%hourglass_strain([first, first + chunk_size]) = 0.0_wp
      first = elements%eos_start(i_chunk) + i - 1
      elements%eos_state([(first + k*chunk_size, k=0, 3)]) = 0.0_wp
      elements%eos_state(first + 4*chunk_size) = material%sound_speed**2
      if (.not. material%is_plane_stress) return
      first = thinning_start(elements, i_chunk, 1) + i - 1
      n = merge(n_point, 1, elements%point_start(i_chunk) > 0)
      elements%eos_state([(first + k*chunk_size, k=0, n - 1)]) = 0.0_wp
    end associate
  end subroutine make_padding

  !> Elements that erode, by the state at the end of the step.
  subroutine find_eroding(model, i_chunk, nodes, motion, times, elements, leaves)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node)
    real(wp), intent(in) :: times(2)                 !! time of the state, and the step before it
    type(block_state_t), intent(inout) :: elements   !! impulses
    logical, intent(out) :: leaves(chunk_size)
    logical :: keeps_pressure
    integer :: first

    leaves = .false.
    first = (i_chunk - 1)*chunk_size + 1
    associate (material => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
      if (.not. allocated(material%erosion)) return
      if (material%erosion%by_law) call find_failed_elements(i_chunk, material, elements, leaves, &
        keeps_pressure)
      if (material%erosion%n_given > 0) call find_by_criteria(model, i_chunk, nodes, motion, &
        times, elements, leaves)
      call find_by_step(model, material%erosion, i_chunk, motion, elements, leaves)
    end associate
    leaves = leaves .and. model%layout%slot_element(first:first + chunk_size - 1) > 0 &
      .and. elements%erosion%status(first:first + chunk_size - 1) == intact
  end subroutine find_eroding

  !> Elements that meet enough criteria of the card at enough points.
  subroutine find_by_criteria(model, i_chunk, nodes, motion, times, elements, leaves)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp), intent(in) :: times(2)
    type(block_state_t), intent(inout) :: elements
    logical, intent(inout) :: leaves(chunk_size)
    real(wp), dimension(chunk_size) :: pressure, volumetric, principal, mises, thickness
    integer :: common(chunk_size), met(chunk_size), points(chunk_size), first, k, n

    first = elements%eos_start(i_chunk)
    pressure = elements%eos_state(first + chunk_size:first + 2*chunk_size - 1)
    thickness = 0.0_wp
    if (model%materials(model%parts(model%layout%chunk_part(i_chunk))%material)%is_plane_stress) &
      thickness = [(thickness_strain_of_slot(model, elements, (i_chunk - 1)*chunk_size + k), k=1, &
      chunk_size)]
    associate (erosion => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material) &
      %erosion)
      common = merge(1, 0, pressure >= erosion%most_pressure) &
        + merge(1, 0, pressure <= erosion%least_pressure)
      if (times(1) >= erosion%time) common = common + 1
      if (min(erosion%most_volume, -erosion%least_volume) < huge(1.0_wp)) then
        volumetric = log(max(tiny(1.0_wp), 1.0_wp + elements%eos_state(first + 2*chunk_size: &
          first + 3*chunk_size - 1))) + thickness
        common = common + merge(1, 0, volumetric >= erosion%most_volume .or. &
          volumetric <= erosion%least_volume)
      end if
      if (asks_for_strain(erosion)) call count_strains(erosion, i_chunk, nodes, motion, elements, &
        thickness, common)
      if (erosion%impulse < huge(1.0_wp)) then
        call form_stresses(i_chunk, 0, pressure, elements, principal, mises)
        first = (i_chunk - 1)*chunk_size + 1
        associate (impulse => elements%erosion%impulse(first:first + chunk_size - 1))
          ! Integral of the squared excess of the largest principal stress over its threshold.
          impulse = impulse + times(2)*max(0.0_wp, principal - erosion%threshold)**2
          common = common + merge(1, 0, impulse >= erosion%impulse)
        end associate
      end if
      n = merge(n_point, 1, elements%point_start(i_chunk) > 0)
      points = 0
      do k = 1, n
        met = common
        if (asks_for_stress(erosion)) then
          call form_stresses(i_chunk, k, pressure, elements, principal, mises)
          met = met + merge(1, 0, principal >= erosion%principal_stress) &
            + merge(1, 0, mises >= erosion%mises)
        end if
        points = points + merge(1, 0, met >= erosion%n_criteria)
      end do
      leaves = leaves .or. points >= min(n, erosion%n_point)
    end associate
  end subroutine find_by_criteria

  !> Largest principal stress and von Mises stress of a point, tension positive.
  pure subroutine form_stresses(i_chunk, k, pressure, elements, principal, mises)
    integer, intent(in) :: i_chunk
    integer, intent(in) :: k   !! point, 0: the mean of all
    real(wp), intent(in) :: pressure(chunk_size)
    type(block_state_t), intent(in) :: elements
    real(wp), intent(out), dimension(chunk_size) :: principal, mises
    real(wp), dimension(chunk_size) :: xx, yy, xy
    integer :: first

    if (k == 0 .or. elements%point_start(i_chunk) == 0) then
      first = (i_chunk - 1)*chunk_size + 1
      xx = elements%deviator(first:first + chunk_size - 1, 1)
      yy = elements%deviator(first:first + chunk_size - 1, 2)
      xy = elements%deviator(first:first + chunk_size - 1, 3)
    else
      first = elements%point_start(i_chunk) + 3*chunk_size*(k - 1)
      xx = elements%point_deviator(first:first + chunk_size - 1)
      yy = elements%point_deviator(first + chunk_size:first + 2*chunk_size - 1)
      xy = elements%point_deviator(first + 2*chunk_size:first + 3*chunk_size - 1)
    end if
    principal = max(0.5_wp*(xx + yy) + sqrt(0.25_wp*(xx - yy)**2 + xy**2), -(xx + yy)) - pressure
    mises = sqrt(3.0_wp*(xx**2 + yy**2 + xx*yy + xy**2))
  end subroutine form_stresses

  !> Count the strain criteria that are met, from logarithmic principal strains at the centre.
  pure subroutine count_strains(erosion, i_chunk, nodes, motion, elements, thickness, met)
    type(erosion_t), intent(in) :: erosion
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in), contiguous :: motion(:, :)
    type(block_state_t), intent(in) :: elements
    real(wp), intent(in) :: thickness(chunk_size) !! strain of the thickness of plane stress
    integer, intent(inout) :: met(chunk_size)
    real(wp) :: a(2), b(2), f(2, 2), c(3), strain(3), mean, radius, inverse, u(2, 4)
    integer :: i, slot

    do i = 1, chunk_size
      slot = (i_chunk - 1)*chunk_size + i
      u = motion(1:2, nodes(:, i))
      ! In the plane half the logarithms of the eigenvalues of F^T F.
      a = elements%reference(slot, 1:2)
      b = elements%reference(slot, 3:4)
      inverse = 1.0_wp/(a(1)*b(2) - b(1)*a(2))
      f(:, 1) = ((a + (u(:, 3) - u(:, 1)))*b(2) - (b + (u(:, 4) - u(:, 2)))*a(2))*inverse
      f(:, 2) = ((b + (u(:, 4) - u(:, 2)))*a(1) - (a + (u(:, 3) - u(:, 1)))*b(1))*inverse
      c = [sum(f(:, 1)**2), sum(f(:, 2)**2), sum(f(:, 1)*f(:, 2))]
      mean = 0.5_wp*(c(1) + c(2))
      radius = sqrt(0.25_wp*(c(1) - c(2))**2 + c(3)**2)
      strain(1:2) = 0.5_wp*log(max(tiny(1.0_wp), [mean + radius, mean - radius]))
      strain(3) = thickness(i)
      if (size(elements%reference, 2) > 6) strain(3) = log(max(tiny(1.0_wp), 1.0_wp &
        + sum(u(1, :))/elements%reference(slot, reference_sum)))
      mean = sum(strain)/3.0_wp
      met(i) = met(i) + merge(1, 0, maxval(strain) >= erosion%most_strain) &
        + merge(1, 0, minval(strain) <= erosion%least_strain) &
        + merge(1, 0, 0.5_wp*(maxval(strain) - minval(strain)) >= erosion%shear_strain) &
        + merge(1, 0, sqrt(2.0_wp/3.0_wp*sum((strain - mean)**2)) >= erosion%effective_strain)
    end do
  end subroutine count_strains

  !> Elements whose stable step or volume is too small. The limit of a chunk combines its shortest
  !> element and its fastest waves, so it may lie below the limits of all its elements.
  subroutine find_by_step(model, erosion, i_chunk, motion, elements, leaves)
    type(model_t), intent(in) :: model
    type(erosion_t), intent(in) :: erosion
    integer, intent(in) :: i_chunk
    real(wp), intent(in), contiguous :: motion(:, :)
    type(block_state_t), intent(inout) :: elements !! the limit of the chunk
    logical, intent(inout) :: leaves(chunk_size)
    real(wp) :: steps(chunk_size), least, limit
    integer :: i, slot
    logical :: inverts

    least = erosion%least_step/model%controls%dt_scale
    if (erosion%by_step) least = max(least, elements%erosion%least_step)
    inverts = erosion%by_step .and. .not. elements%volume_limit(i_chunk) > 0.0_wp
    if (elements%time_limit(i_chunk) >= least .and. .not. inverts) return
    call own_steps(model, elements, i_chunk, motion, steps)
    limit = huge(1.0_wp)
    do i = 1, chunk_size
      slot = (i_chunk - 1)*chunk_size + i
      if (model%layout%slot_element(slot) == 0 .or. elements%erosion%status(slot) /= intact) cycle
      if (inverts) leaves(i) = leaves(i) .or. &
        .not. elements%eos_state(elements%eos_start(i_chunk) + 2*chunk_size + i - 1) > -1.0_wp
      if (leaves(i)) cycle
      leaves(i) = .not. steps(i) >= least
      if (.not. leaves(i)) limit = min(limit, steps(i))
    end do
    elements%time_limit(i_chunk) = limit
  end subroutine find_by_step

end module eroding_tiles_m
