! SPDX-License-Identifier: MIT
!> Erosion of elements, and element results for output.
module element_state_m
  use element_dispatch_m, only : point_count
  use kinds_m, only : wp
  use block_state_m, only : block_state_t, erosion_state_t, intact, newly_eroded, eroded_before
  use element_chunk_m, only : reference_sum
  use layout_m, only : chunk_size, slot_part
  use material_dispatch_m, only : find_failed, history_size, column_temperature, column_damage, &
    has_plastic_strain, has_mean_dilatation
  use model_m, only : model_t
  use parts_m, only : has_memory_of_heat, may_fail
  use plane_stress_m, only : thinning_start
  use quad_points_m, only : n_point, point_areas, point_ratios, shape_at_points
  use volumetric_m, only : log_ratio, volumetric_energy
  implicit none
  private
  public :: start_erosion, update_erosion, is_eroded, stress_of_slot, plastic_strain_of_slot, &
    find_heat, hoop_strain_of_slot, thickness_strain_of_slot, initial_volume, smallest_ratio, &
    add_part_energies, count_points, first_failed, volume_ratios, point_stretches

contains

  !> Allocate the erosion state.
  subroutine start_erosion(model, elements)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(inout) :: elements
    integer :: i_slot, k

    allocate (elements%erosion)
    associate (erosion => elements%erosion, layout => model%layout)
      allocate (erosion%status(layout%n_slot), source=intact)
      allocate (erosion%n_removed(layout%n_chunk), erosion%n_element(model%mesh%n_node), &
        erosion%n_eroded(size(model%parts)), source=0)
      allocate (erosion%hourglass(layout%n_slot), erosion%internal(layout%n_slot), &
        erosion%impulse(layout%n_slot), source=0.0_wp)
      do i_slot = 1, layout%n_slot
        if (layout%slot_element(i_slot) == 0) cycle
        associate (nodes => layout%slot_nodes(:, i_slot))
          ! A triangle repeats its third node.
          do k = 1, merge(3, 4, nodes(4) == nodes(3))
            erosion%n_element(nodes(k)) = erosion%n_element(nodes(k)) + 1
          end do
        end associate
      end do
    end associate
  end subroutine start_erosion

  !> Count the elements that eroded in this cycle: energies move to the eroded energies, nodes lose
  !> an element. Slot by slot, so that sums do not depend on threads.
  subroutine update_erosion(model, time, erosion, freed)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: time
    type(erosion_state_t), intent(inout) :: erosion
    integer, allocatable, intent(out) :: freed(:) !! nodes without an element; not allocated where
                                                  !! no element eroded
    integer :: slot, k

    if (.not. any(erosion%status == newly_eroded)) return
    allocate (freed(0))
    if (sum(erosion%n_eroded) == 0) erosion%first_time = time
    do slot = 1, model%layout%n_slot
      if (erosion%status(slot) /= newly_eroded) cycle
      erosion%status(slot) = eroded_before
      erosion%removed_energy(2) = erosion%removed_energy(2) + erosion%internal(slot)
      associate (part => slot_part(model%layout, slot), nodes => model%layout%slot_nodes(:, slot))
        erosion%removed_energy(3) = erosion%removed_energy(3) + erosion%hourglass(slot) &
          *model%sections(model%parts(part)%section)%thickness
        erosion%n_eroded(part) = erosion%n_eroded(part) + 1
        do k = 1, merge(3, 4, nodes(4) == nodes(3))
          erosion%n_element(nodes(k)) = erosion%n_element(nodes(k)) - 1
          if (erosion%n_element(nodes(k)) == 0) freed = [freed, nodes(k)]
        end do
      end associate
    end do
  end subroutine update_erosion

  !> Whether the element in a slot has eroded.
  pure function is_eroded(elements, slot) result(eroded)
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: slot
    logical :: eroded

    eroded = allocated(elements%erosion)
    if (eroded) eroded = elements%erosion%status(slot) /= intact
  end function is_eroded

  !> Cauchy stress of the element in a slot: xx yy zz xy, in axisymmetric models rr, zz, hoop and
  !> rz; the mean over the present volume where an element has several points.
  pure function stress_of_slot(model, motion, elements, slot) result(stress)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: motion(:, :)
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: slot
    real(wp) :: stress(4), volumetric, stretch(n_point), start(n_point), now(n_point), s(3)
    integer :: i_eos, n

    associate (material => model%materials(model%parts(slot_part(model%layout, slot))%material))
      call volume_ratios(model, motion, elements, slot, n, stretch, start)
      if (material%is_rigid) stretch = 0.0_wp
      now(:n) = start(:n)*(1.0_wp + stretch(:n))
      stretch(:n) = log_ratio(stretch(:n))
      if (allocated(elements%start_dilatation) .and. .not. material%is_rigid) stretch(:n) = &
        stretch(:n) + elements%start_dilatation(slot, :n)
      volumetric = material%bulk*(sum(now(:n)*stretch(:n))/sum(now(:n)))
    end associate
    i_eos = elements%eos_start((slot - 1)/chunk_size + 1)
    if (i_eos > 0) volumetric = -elements%eos_state(i_eos + chunk_size + mod(slot - 1, chunk_size))
    s = elements%deviator(slot, :)
    if (model%materials(model%parts(slot_part(model%layout, slot))%material)%is_plane_stress) &
      volumetric = s(1) + s(2)
    stress = [s(1) + volumetric, s(2) + volumetric, volumetric - (s(1) + s(2)), s(3)]
  end function stress_of_slot

  !> Effective plastic strain of the element in a slot, 0 in elastic parts.
  function plastic_strain_of_slot(model, elements, slot) result(plastic_strain)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: slot
    real(wp) :: plastic_strain

    plastic_strain = 0.0_wp
    if (has_plastic_strain(model%materials(model%parts(slot_part(model%layout, slot))%material))) &
      plastic_strain = history_of_slot(model, elements, slot, 1)
  end function plastic_strain_of_slot

  !> Temperature and damage of the element in a slot, 0 in parts without.
  subroutine find_heat(model, elements, slot, temperature, damage)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: slot
    real(wp), intent(out) :: temperature, damage

    temperature = 0.0_wp
    damage = 0.0_wp
    associate (material => model%materials(model%parts(slot_part(model%layout, slot))%material))
      if (.not. has_memory_of_heat(material)) return
      temperature = material%flow%room + history_of_slot(model, elements, slot, column_temperature)
      damage = history_of_slot(model, elements, slot, column_damage)
    end associate
  end subroutine find_heat

  !> One history value of the element in a slot, the mean over the initial volume where it has
  !> several points.
  function history_of_slot(model, elements, slot, column) result(value)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: slot, column
    real(wp) :: value
    real(wp) :: stretch(n_point), start(n_point)
    real(wp), parameter :: none(2, 4) = 0.0_wp
    integer :: k, i_chunk, first, stride

    i_chunk = (slot - 1)/chunk_size + 1
    first = elements%history_start(i_chunk) + (column - 1)*chunk_size + mod(slot - 1, chunk_size)
    if (elements%point_start(i_chunk) == 0) then
      value = elements%history(first)
      return
    end if
    call point_stretches(elements, slot, none, stretch, start)
    associate (part => model%parts(model%layout%chunk_part(i_chunk)))
      stride = chunk_size*history_size(model%materials(part%material))
    end associate
    value = sum([(start(k)*elements%history(first + (k - 1)*stride), k = 1, n_point)])/sum(start)
  end function history_of_slot

  !> J - 1 at the positions where the volumetric stress of the element in a slot is formed (once per
  !> element, or at each point), and the initial area or volume per radian of each.
  pure subroutine volume_ratios(model, motion, elements, slot, n, stretch, start)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: motion(:, :)
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: slot
    integer, intent(out) :: n                                !! number of positions
    real(wp), intent(out) :: stretch(n_point), start(n_point)
    real(wp) :: u(2, 4), d31(2), d42(2)

    stretch = 0.0_wp
    start = 0.0_wp
    n = 1
    associate (nodes => model%layout%slot_nodes(:, slot), r => elements%reference(slot, :4), &
      i_chunk => (slot - 1)/chunk_size + 1)
      if (elements%point_start(i_chunk) > 0) then
        if (.not. has_mean_dilatation(model%materials(model%parts(model%layout%chunk_part( &
          i_chunk))%material))) n = n_point
      end if
      u = motion(1:2, nodes)
      if (n > 1 .or. model%is_axisymmetric) then
        call point_stretches(elements, slot, u, stretch, start)
        if (n > 1) return
        ! 2x2 points integrate the volume exactly.
        stretch(1) = sum(start*stretch)/sum(start)
        start(1) = sum(start)
      else
        d31 = u(:, 3) - u(:, 1)
        d42 = u(:, 4) - u(:, 2)
        start(1) = 0.5_wp*(r(1)*r(4) - r(3)*r(2))
        stretch(1) = 0.5_wp*((r(1)*d42(2) + d31(1)*(r(4) + d42(2))) &
          - (r(3)*d31(2) + d42(1)*(r(2) + d31(2))))/start(1)
      end if
    end associate
  end subroutine volume_ratios

  !> Initial volume of the element in a slot, per unit depth or per radian.
  pure function initial_volume(model, elements, slot) result(volume)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: slot
    real(wp) :: volume
    real(wp) :: stretch(n_point), start(n_point)
    real(wp), parameter :: none(2, 4) = 0.0_wp

    if (model%is_axisymmetric) then
      call point_stretches(elements, slot, none, stretch, start)
      volume = sum(start)
    else
      associate (r => elements%reference(slot, :4))
        volume = 0.5_wp*(r(1)*r(4) - r(3)*r(2)) &
          *model%sections(model%parts(slot_part(model%layout, slot))%section)%thickness
      end associate
    end if
  end function initial_volume

  !> Logarithmic hoop strain of the element in a slot: ln of the current over the initial mean
  !> radius, both means over the initial area.
  pure function hoop_strain_of_slot(model, motion, slot) result(strain)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: motion(:, :)     !! (4, n_node)
    integer, intent(in) :: slot
    real(wp) :: strain
    real(wp) :: x(2, 4), u(2, 4), areas(n_point)

    x = model%mesh%coordinates(:, model%layout%slot_nodes(:, slot))
    u = motion(1:2, model%layout%slot_nodes(:, slot))
    areas = point_areas(x)
    strain = log_ratio(sum(areas*matmul(u(1, :), shape_at_points)) &
      /sum(areas*matmul(x(1, :), shape_at_points)))
  end function hoop_strain_of_slot

  !> Logarithmic strain of the thickness of the element in a slot, of the mean over its points; 0
  !> where there is no plane stress.
  pure function thickness_strain_of_slot(model, elements, slot) result(strain)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: slot
    real(wp) :: strain
    integer :: k, n

    strain = 0.0_wp
    if (.not. model%materials(model%parts(slot_part(model%layout, slot))%material) &
      %is_plane_stress) return
    associate (i_chunk => (slot - 1)/chunk_size + 1)
      n = merge(n_point, 1, elements%point_start(i_chunk) > 0)
      do k = 1, n
        strain = strain + elements%eos_state(thinning_start(elements, i_chunk, k) + mod(slot - 1, &
          chunk_size))
      end do
    end associate
    strain = log_ratio(strain/n)
  end function thickness_strain_of_slot

  !> J - 1 at the points of the element in a slot, and the initial area or volume of each.
  pure subroutine point_stretches(elements, slot, u, stretch, start)
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: slot
    real(wp), intent(in) :: u(2, 4)            !! displacement of the nodes
    real(wp), intent(out) :: stretch(n_point), start(n_point)
    real(wp) :: reference(reference_sum)

    reference(:6) = elements%reference(slot, :6)
    if (size(elements%reference, 2) > 6) reference(reference_sum) = elements%reference(slot, &
      reference_sum)
    call point_ratios(size(elements%reference, 2) > 6, reference, u, stretch, start)
  end subroutine point_stretches

  !> Smallest J of the element in a slot: of the element, and of its points where it has several.
  pure function smallest_ratio(model, motion, elements, slot) result(smallest)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: motion(:, :)
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: slot
    real(wp) :: smallest
    real(wp) :: u(2, 4), stretch(n_point), start(n_point)
    integer :: n

    call volume_ratios(model, motion, elements, slot, n, stretch, start)
    if (elements%point_start((slot - 1)/chunk_size + 1) > 0) then
      n = n_point
      u = motion(1:2, model%layout%slot_nodes(:, slot))
      call point_stretches(elements, slot, u, stretch, start)
    end if
    smallest = 1.0_wp + minval(stretch(:n))
  end function smallest_ratio

  !> Add energies of each part. The volumetric part of the internal energy is a potential and is
  !> evaluated here; the work of the deviator is accumulated in the step.
  subroutine add_part_energies(model, motion, elements, internal, hourglass, viscous)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: motion(:, :)
    type(block_state_t), intent(in) :: elements
    real(wp), intent(inout), dimension(:) :: internal, hourglass, viscous !! (n_part)
    real(wp) :: stretch(n_point), start(n_point), depth
    integer :: i_chunk, n, part, slot

    do i_chunk = 1, model%layout%n_chunk
      part = model%layout%chunk_part(i_chunk)
      if (model%materials(model%parts(part)%material)%is_rigid) cycle
      depth = model%sections(model%parts(part)%section)%thickness
      internal(part) = internal(part) + elements%deviatoric_work(i_chunk)
      hourglass(part) = hourglass(part) + depth*elements%hourglass_work(i_chunk)
      viscous(part) = viscous(part) + depth*elements%viscous_work(i_chunk)
      do slot = (i_chunk - 1)*chunk_size + 1, i_chunk*chunk_size
        if (model%layout%slot_element(slot) == 0) cycle
        if (is_eroded(elements, slot)) cycle
        call volume_ratios(model, motion, elements, slot, n, stretch, start)
        associate (material => model%materials(model%parts(part)%material))
          if (elements%eos_start(i_chunk) > 0) then
            internal(part) = internal(part) + depth*start(1)*(material%eos%datum &
              + elements%eos_state(elements%eos_start(i_chunk) + mod(slot - 1, chunk_size)))
          else
            internal(part) = internal(part) + sum(start(:n)*volumetric_energy(material%bulk, &
              stretch(:n)))
            if (allocated(elements%start_dilatation)) internal(part) = internal(part) &
              + material%bulk*sum(start(:n)*elements%start_dilatation(slot, :n)*stretch(:n))
          end if
        end associate
      end do
    end do
  end subroutine add_part_energies

  !> Number of points that may fail.
  pure function count_points(model, elements) result(n)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer :: n
    integer :: i_chunk

    n = 0
    do i_chunk = 1, size(elements%n_failed)
      associate (part => model%parts(model%layout%chunk_part(i_chunk)), &
        slots => model%layout%slot_element((i_chunk - 1)*chunk_size + 1:i_chunk*chunk_size))
        if (may_fail(model%materials(part%material))) n = n &
          + point_count(model%sections(part%section))*count(slots > 0)
      end associate
    end do
  end function count_points

  !> First slot with a failed point; there must be one.
  pure function first_failed(model, elements) result(slot)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer :: slot
    logical :: failed(chunk_size), one(chunk_size), ignored
    integer :: i_chunk, k

    i_chunk = findloc(elements%n_failed > 0, .true., dim=1)
    failed = .false.
    associate (material => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
      do k = 1, merge(n_point, 1, elements%point_start(i_chunk) > 0)
        call find_failed(material, elements%history(elements%history_start(i_chunk) &
          + (k - 1)*chunk_size*history_size(material)), one, ignored)
        failed = failed .or. one
      end do
    end associate
    slot = (i_chunk - 1)*chunk_size + findloc(failed, .true., dim=1)
  end function first_failed

end module element_state_m
