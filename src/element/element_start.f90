! SPDX-License-Identifier: MIT
!> Element state at time zero.
module element_start_m
  use block_state_m, only : block_state_t
  use element_chunk_m, only : n_axisym_reference, reference_inverse, reference_mass, reference_sum
  use element_dispatch_m, only : point_count
  use element_mass_m, only : node_volumes
  use element_stage_m, only : set_stage
  use element_state_m, only : start_erosion
  use eos_pressure_m, only : n_eos_value
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use material_dispatch_m, only : history_size
  use model_m, only : model_t
  use parts_m, only : may_fail, gives_pressure
  use plane_stress_m, only : n_law_value
  implicit none
  private
  public :: start_elements

contains

  !> Allocate the streams and fill the reference shape. Elastic parts have no plastic history, fully
  !> integrated ones no hourglass memory.
  subroutine start_elements(model, known, elements)
    type(model_t), intent(in) :: model
    integer, intent(in) :: known(:, :) !! (2, n) first and last slot of the ranges of this process
    type(block_state_t), intent(out) :: elements
    integer :: n_chunk, k

    allocate (elements%reference(model%layout%n_slot, merge(n_axisym_reference, 6, &
      model%is_axisymmetric)))
    allocate (elements%deviator(model%layout%n_slot, 3))
    ! Chunks of rigid parts follow.
    n_chunk = model%layout%tiles(size(model%layout%tiles))%last_chunk
    allocate (elements%deviatoric_work(n_chunk), elements%hourglass_work(n_chunk), &
      elements%viscous_work(n_chunk), source=0.0_wp)
    allocate (elements%time_limit(n_chunk), elements%volume_limit(n_chunk), source=1.0_wp)
    allocate (elements%volume_change(n_chunk), source=0.0_wp)
    if (allocated(model%layout%exposed)) then
      if (size(model%layout%exposed) > 0) then
        allocate (elements%mass_shares(4, model%layout%n_slot), source=0.0_wp)
        elements%mass_shares(:, model%layout%exposed) = model%layout%exposed_shares
      end if
    end if
    call reserve_memories(model, elements)
    do k = 1, size(model%parts)
      associate (viscosity => model%parts(k)%hourglass, &
        material => model%materials(model%parts(k)%material))
        ! An equation of state stores the bulk viscosity of the last step itself.
        if ((viscosity%quadratic > 0.0_wp .or. viscosity%linear > 0.0_wp) .and. &
          .not. (allocated(material%eos) .or. material%is_rigid .or. &
          allocated(elements%viscous_pressure))) &
          allocate (elements%viscous_pressure(model%layout%n_slot))
      end associate
    end do
    do k = 1, size(known, 2)
      associate (first => known(1, k), last => known(2, k))
        elements%deviator(first:last, :) = 0.0_wp
        if (allocated(elements%viscous_pressure)) elements%viscous_pressure(first:last) = 0.0_wp
        call fill_reference(model, first, last, elements%reference)
        call clear_memories(model, (first - 1)/chunk_size + 1, last/chunk_size, elements)
      end associate
    end do
    call set_stage(model, known, elements)
    if (model%erodes) call start_erosion(model, elements)
  end subroutine start_elements

  !> Diagonals and h.X of slots; for axisymmetric models also the sum of the radii, 1/V and density
  !> over nodal mass. Padding is the first element of its chunk, much larger, so that it divides by
  !> no zero and never limits the step.
  subroutine fill_reference(model, from, to, reference)
    type(model_t), intent(in) :: model
    integer, intent(in) :: from, to            !! slots
    real(wp), intent(inout) :: reference(:, :) !! (n_slot, 6 or n_axisym_reference)
    real(wp), parameter :: much = 1.0e6_wp
    real(wp) :: x(2, 4), volumes(4)
    integer :: i, first, n

    do i = from, to
      if (model%layout%slot_element(i) == 0) then
        first = i - mod(i - 1, chunk_size)
        n = min(size(reference, 2), reference_sum)
        reference(i, :n) = much*reference(first, :n)
        reference(i, n + 1:) = reference(first, n + 1:)/much**3
        cycle
      end if
      associate (nodes => model%layout%slot_nodes(:, i))
        x = model%mesh%coordinates(:, nodes)
        reference(i, 1:2) = x(:, 3) - x(:, 1)
        reference(i, 3:4) = x(:, 4) - x(:, 2)
        reference(i, 5:6) = (x(:, 1) - x(:, 2)) + (x(:, 3) - x(:, 4))
        if (.not. model%is_axisymmetric) cycle
        volumes = node_volumes(x, nodes(4) == nodes(3))
        reference(i, reference_sum) = sum(x(1, :))
        reference(i, reference_inverse) = 1.0_wp/sum(volumes)
        reference(i, reference_mass:) = 0.0_wp
        where (volumes > 0.0_wp) reference(i, reference_mass:) = 1.0_wp/volumes
      end associate
    end do
  end subroutine fill_reference

  !> Start of each chunk's points, history, equation of state and hourglass memory.
  subroutine reserve_memories(model, elements)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(inout) :: elements
    integer :: i_chunk, n(4), total(4)

    allocate (elements%history_start(model%layout%n_chunk), &
      elements%eos_start(model%layout%n_chunk), elements%hourglass_start(model%layout%n_chunk), &
      elements%point_start(model%layout%n_chunk), source=0)
    total = 0
    do i_chunk = 1, model%layout%n_chunk
      n = memory_sizes(model, model%layout%chunk_part(i_chunk))
      if (n(1) > 0) elements%point_start(i_chunk) = total(1) + 1
      if (n(2) > 0) elements%history_start(i_chunk) = total(2) + 1
      if (n(3) > 0) elements%eos_start(i_chunk) = total(3) + 1
      if (n(4) > 0) elements%hourglass_start(i_chunk) = total(4) + 1
      total = total + n
    end do
    allocate (elements%point_deviator(total(1)), elements%history(total(2)), &
      elements%eos_state(total(3)), elements%hourglass_strain(total(4)))
    if (any(may_fail(model%materials(model%parts%material)))) allocate (elements%n_failed( &
      model%layout%n_chunk), source=0)
  end subroutine reserve_memories

  !> Values of a chunk of a part in each of the four streams.
  pure function memory_sizes(model, i_part) result(n)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_part
    integer :: n(4), n_points

    n = 0
    associate (part => model%parts(i_part), &
      material => model%materials(model%parts(i_part)%material))
      if (material%is_rigid) return
      n_points = point_count(model%sections(part%section))
      n(2) = n_points*history_size(material)
      if (allocated(material%eos)) n(3) = merge(n_law_value, n_eos_value, gives_pressure(material))
      if (material%is_plane_stress) n(3) = n_law_value + n_points
      if (n_points > 1) then
        n(1) = 3*n_points
      else
        n(4) = 2
      end if
      n = n*chunk_size
    end associate
  end function memory_sizes

  !> Initialise the streams of some chunks.
  subroutine clear_memories(model, first, last, elements)
    type(model_t), intent(in) :: model
    integer, intent(in) :: first, last
    type(block_state_t), intent(inout) :: elements
    integer :: i_chunk, n(4), starts(4)

    do i_chunk = first, last
      n = memory_sizes(model, model%layout%chunk_part(i_chunk))
      starts = [elements%point_start(i_chunk), elements%history_start(i_chunk), &
        elements%eos_start(i_chunk), elements%hourglass_start(i_chunk)]
      if (n(1) > 0) elements%point_deviator(starts(1):starts(1) + n(1) - 1) = 0.0_wp
      if (n(2) > 0) elements%history(starts(2):starts(2) + n(2) - 1) = 0.0_wp
      if (n(3) > 0) elements%eos_state(starts(3):starts(3) + n(3) - 1) = 0.0_wp
      if (n(4) > 0) elements%hourglass_strain(starts(4):starts(4) + n(4) - 1) = 0.0_wp
      if (n(3) > 0) elements%eos_state(starts(3):starts(3) + chunk_size - 1) = &
        model%materials(model%parts(model%layout%chunk_part(i_chunk))%material)%eos%energy
    end do
  end subroutine clear_memories

end module element_start_m
