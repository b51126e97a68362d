! SPDX-License-Identifier: MIT
!> Which elements of a chunk leave the mesh now, by what their material asks for.
module erosion_criteria_m
  use block_state_m, only : block_state_t
  use element_chunk_m, only : reference_sum
  use eos_pressure_m, only : look_for_failed
  use erosion_m, only : erosion_t, asks_for_strain, asks_for_stress
  use erosion_state_m, only : stays
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use parts_m, only : material_t
  use quad_points_m, only : n_point
  use element_steps_m, only : step_of_element
  implicit none
  private
  public :: find_leaving

contains

  !> Elements that leave, by the state at the end of the step. `nodes` are those of the chunk, all
  !> one where an element has gone.
  subroutine find_leaving(model, i_chunk, nodes, motion, times, elements, leaves)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node)
    real(wp), intent(in) :: times(2)                 !! of the state, and the step that led there
    type(block_state_t), intent(inout) :: elements   !! impulses
    logical, intent(out) :: leaves(chunk_size)
    logical :: keeps_pressure
    integer :: first

    leaves = .false.
    first = (i_chunk - 1)*chunk_size + 1
    associate (material => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
      if (.not. allocated(material%erosion)) return
      if (material%erosion%by_law) call look_for_failed(i_chunk, material, elements, leaves, &
        keeps_pressure)
      if (material%erosion%n_given > 0) call find_by_criteria(material, i_chunk, nodes, motion, &
        times, elements, leaves)
      call find_by_step(model, material%erosion, i_chunk, motion, elements, leaves)
    end associate
    leaves = leaves .and. model%layout%slot_element(first:first + chunk_size - 1) > 0 &
      .and. elements%erosion%status(first:first + chunk_size - 1) == stays
  end subroutine find_leaving

  !> By the criteria of the card: as many as asked for, at as many points.
  subroutine find_by_criteria(material, i_chunk, nodes, motion, times, elements, leaves)
    type(material_t), intent(in) :: material
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp), intent(in) :: times(2)
    type(block_state_t), intent(inout) :: elements
    logical, intent(inout) :: leaves(chunk_size)
    real(wp), dimension(chunk_size) :: pressure, principal, mises
    integer :: common(chunk_size), met(chunk_size), points(chunk_size), first, k, n

    first = elements%eos_start(i_chunk)
    pressure = elements%eos_state(first + chunk_size:first + 2*chunk_size - 1)
    associate (erosion => material%erosion)
      common = count_of(pressure >= erosion%most_pressure) &
        + count_of(pressure <= erosion%least_pressure)
      if (times(1) >= erosion%time) common = common + 1
      call count_volumes(erosion, elements%eos_state(first + 2*chunk_size), common)
      if (asks_for_strain(erosion)) call count_strains(erosion, i_chunk, nodes, motion, elements, &
        common)
      if (erosion%impulse < huge(1.0_wp)) call add_impulses(erosion, i_chunk, pressure, times(2), &
        elements, common)
      n = merge(n_point, 1, elements%point_start(i_chunk) > 0)
      points = 0
      do k = 1, n
        met = common
        if (asks_for_stress(erosion)) then
          call form_stresses(i_chunk, k, pressure, elements, principal, mises)
          met = met + count_of(principal >= erosion%principal_stress) &
            + count_of(mises >= erosion%mises)
        end if
        points = points + count_of(met >= erosion%n_criteria)
      end do
      leaves = leaves .or. points >= min(n, erosion%n_point)
    end associate
  end subroutine find_by_criteria

  !> 1 where something holds, else 0.
  elemental function count_of(holds) result(n)
    logical, intent(in) :: holds
    integer :: n

    n = merge(1, 0, holds)
  end function count_of

  !> Volumetric strain ln(V/V0).
  pure subroutine count_volumes(erosion, stretch, met)
    type(erosion_t), intent(in) :: erosion
    real(wp), intent(in) :: stretch(chunk_size) !! V/V0 - 1
    integer, intent(inout) :: met(chunk_size)
    integer :: i

    if (min(erosion%most_volume, -erosion%least_volume) >= huge(1.0_wp)) return
    do i = 1, chunk_size
      associate (strain => log(max(tiny(1.0_wp), 1.0_wp + stretch(i))))
        if (strain >= erosion%most_volume .or. strain <= erosion%least_volume) met(i) = met(i) + 1
      end associate
    end do
  end subroutine count_volumes

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

  !> Integral of the square of what the largest principal stress has above its threshold.
  pure subroutine add_impulses(erosion, i_chunk, pressure, dt, elements, met)
    type(erosion_t), intent(in) :: erosion
    integer, intent(in) :: i_chunk
    real(wp), intent(in) :: pressure(chunk_size), dt
    type(block_state_t), intent(inout) :: elements
    integer, intent(inout) :: met(chunk_size)
    real(wp), dimension(chunk_size) :: principal, mises
    integer :: first

    call form_stresses(i_chunk, 0, pressure, elements, principal, mises)
    first = (i_chunk - 1)*chunk_size + 1
    associate (impulse => elements%erosion%impulse(first:first + chunk_size - 1))
      impulse = impulse + dt*max(0.0_wp, principal - erosion%threshold)**2
      met = met + count_of(impulse >= erosion%impulse)
    end associate
  end subroutine add_impulses

  !> Logarithmic principal strains at the centre, where the diagonals give the deformation.
  pure subroutine count_strains(erosion, i_chunk, nodes, motion, elements, met)
    type(erosion_t), intent(in) :: erosion
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in), contiguous :: motion(:, :)
    type(block_state_t), intent(in) :: elements
    integer, intent(inout) :: met(chunk_size)
    real(wp) :: start(4), strain(3), mean, u(2, 4)
    integer :: i, slot

    do i = 1, chunk_size
      slot = (i_chunk - 1)*chunk_size + i
      u = motion(1:2, nodes(:, i))
      start = elements%reference(slot, 1:4)
      strain(1:2) = plane_strains(start, u(:, 3) - u(:, 1), u(:, 4) - u(:, 2))
      strain(3) = 0.0_wp
      if (size(elements%reference, 2) > 6) strain(3) = log(max(tiny(1.0_wp), 1.0_wp &
        + sum(u(1, :))/elements%reference(slot, reference_sum)))
      mean = sum(strain)/3.0_wp
      met(i) = met(i) + count_of(maxval(strain) >= erosion%most_strain) &
        + count_of(minval(strain) <= erosion%least_strain) &
        + count_of(0.5_wp*(maxval(strain) - minval(strain)) >= erosion%shear_strain) &
        + count_of(sqrt(2.0_wp/3.0_wp*sum((strain - mean)**2)) >= erosion%effective_strain)
    end do
  end subroutine count_strains

  !> Both in the plane: half the logarithms of the eigenvalues of F^T F.
  pure function plane_strains(start, d31, d42) result(strains)
    real(wp), intent(in) :: start(4)         !! X31, Y31, X42, Y42
    real(wp), intent(in) :: d31(2), d42(2)   !! what they have grown by
    real(wp) :: strains(2)
    real(wp) :: f(2, 2), c(3), mean, radius, inverse

    inverse = 1.0_wp/(start(1)*start(4) - start(3)*start(2))
    f(:, 1) = ((start(1:2) + d31)*start(4) - (start(3:4) + d42)*start(2))*inverse
    f(:, 2) = ((start(3:4) + d42)*start(1) - (start(1:2) + d31)*start(3))*inverse
    c = [sum(f(:, 1)**2), sum(f(:, 2)**2), sum(f(:, 1)*f(:, 2))]
    mean = 0.5_wp*(c(1) + c(2))
    radius = sqrt(0.25_wp*(c(1) - c(2))**2 + c(3)**2)
    strains = 0.5_wp*log(max(tiny(1.0_wp), [mean + radius, mean - radius]))
  end function plane_strains

  !> Elements whose own stable step, or volume, has become too small. The limit of a chunk is that
  !> of its shortest element with the fastest waves of any: it may lie below all of theirs.
  subroutine find_by_step(model, erosion, i_chunk, motion, elements, leaves)
    type(model_t), intent(in) :: model
    type(erosion_t), intent(in) :: erosion
    integer, intent(in) :: i_chunk
    real(wp), intent(in), contiguous :: motion(:, :)
    type(block_state_t), intent(inout) :: elements !! the limit of the chunk
    logical, intent(inout) :: leaves(chunk_size)
    real(wp) :: least, step, limit
    integer :: i, slot
    logical :: inverts

    least = erosion%least_step/model%controls%dt_scale
    if (erosion%by_step) least = max(least, elements%erosion%least_step)
    inverts = erosion%by_step .and. .not. elements%volume_limit(i_chunk) > 0.0_wp
    if (elements%time_limit(i_chunk) >= least .and. .not. inverts) return
    limit = huge(1.0_wp)
    do i = 1, chunk_size
      slot = (i_chunk - 1)*chunk_size + i
      if (model%layout%slot_element(slot) == 0 .or. elements%erosion%status(slot) /= stays) cycle
      if (inverts) leaves(i) = leaves(i) .or. &
        .not. elements%eos_state(elements%eos_start(i_chunk) + 2*chunk_size + i - 1) > -1.0_wp
      if (leaves(i)) cycle
      step = step_of_element(model, elements, slot, motion)
      leaves(i) = .not. step >= least
      if (.not. leaves(i)) limit = min(limit, step)
    end do
    elements%time_limit(i_chunk) = limit
  end subroutine find_by_step

end module erosion_criteria_m
