! SPDX-License-Identifier: MIT
!> State of elements from stage to stage. The pressure follows from the volume, which begins anew
!> with each stage: ln(J) of the stage before, its mean stress over K, is added to that of this one.
!> Strain is Hencky's: with F of this stage the left Cauchy-Green tensor is F exp(2 e) F^T, so that
!> stages add up without error. Hourglass memory goes as the force per unit of depth, whatever the
!> form that makes it.
module element_stage_m
  use block_state_m, only : block_state_t
  use element_state_m, only : point_stretches, volume_ratios
  use kinds_m, only : wp
  use layout_m, only : chunk_size, slot_part
  use material_dispatch_m, only : has_mean_dilatation, has_plastic_strain, history_size
  use model_m, only : model_t
  use parts_m, only : material_t, hourglass_viscous, hourglass_stiffness, condensed_bulk
  use plane_stress_m, only : thinning_start
  use quad_points_m, only : n_point, shift, shape_at_points
  use stages_m, only : n_stage_value, n_stage_strain, stage_plastic, stage_law, stage_thickness, &
    stage_hourglass, n_law_history
  use volumetric_m, only : log_ratio, volumetric_energy
  implicit none
  private
  public :: set_stage, find_stage_values, find_stage_strains, has_hourglass_memory

contains

  !> Set the elements of this process to the state of the stage before.
  subroutine set_stage(model, known, elements)
    type(model_t), intent(in) :: model
    integer, intent(in) :: known(:, :) !! (2, n) first and last slot of the ranges of this process
    type(block_state_t), intent(inout) :: elements
    integer :: k, slot

    associate (stage => model%stage, n_slot => model%layout%n_slot)
      if (allocated(stage%strains)) allocate (elements%start_strain(n_slot, &
        n_stage_strain*n_point))
      if (allocated(stage%stresses)) allocate (elements%start_dilatation(n_slot, n_point))
      do k = 1, size(known, 2)
        do slot = known(1, k), known(2, k)
          if (allocated(stage%strains)) elements%start_strain(slot, :) = stage%strains(:, slot)
          if (.not. allocated(stage%stresses)) cycle
          elements%start_dilatation(slot, :) = 0.0_wp
          if (any(abs(stage%stresses(:, slot)) > 0.0_wp)) call set_slot(model, slot, &
            reshape(stage%stresses(:, slot), [n_stage_value, n_point]), elements)
        end do
      end do
    end associate
  end subroutine set_stage

  !> Set the element in a slot; its internal energy is that of its elastic strain.
  subroutine set_slot(model, slot, values, elements)
    type(model_t), intent(in) :: model
    integer, intent(in) :: slot
    real(wp), intent(in) :: values(n_stage_value, n_point)
    type(block_state_t), intent(inout) :: elements
    real(wp), parameter :: at_rest(2, 4) = 0.0_wp
    real(wp) :: mean(n_point), stretch(n_point), start(n_point), deviator(3, n_point), energy, &
      memory(2), diagonals(4)
    integer :: i_chunk, place, n, k, i, first

    i_chunk = (slot - 1)/chunk_size + 1
    place = mod(slot - 1, chunk_size)
    associate (part => model%parts(model%layout%chunk_part(i_chunk)), &
      material => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
      n = merge(n_point, 1, elements%point_start(i_chunk) > 0)
      call point_stretches(elements, slot, at_rest, stretch, start)
      if (n == 1) start(1) = sum(start)
      mean = sum(values(1:3, :), dim=1)/3.0_wp
      deviator(1, :) = values(1, :) - mean
      deviator(2, :) = values(2, :) - mean
      deviator(3, :) = values(4, :)
      if (n > 1 .and. has_mean_dilatation(material) .and. .not. material%is_plane_stress) &
        mean = sum(start*mean)/sum(start)
      energy = 0.0_wp
      do k = 1, n
        elements%start_dilatation(slot, k) = mean(k)/material%bulk
        energy = energy + start(k)*elastic_energy(material, mean(k), deviator(:, k)) &
          *merge(1.0_wp + values(stage_thickness, k), 1.0_wp, material%follows_strain)
        if (n > 1) elements%point_deviator([(elements%point_start(i_chunk) + place &
          + (3*(k - 1) + i - 1)*chunk_size, i=1, 3)]) = deviator(:, k)
        first = elements%history_start(i_chunk) + place + (k - 1)*chunk_size*history_size(material)
        if (has_plastic_strain(material)) elements%history(first) = values(stage_plastic, k)
        do i = 1, n_law_history(material)
          elements%history(first + i*chunk_size) = values(stage_law + i - 1, k)
        end do
        if (.not. material%is_plane_stress) cycle
        elements%eos_state(thinning_start(elements, i_chunk, k) + place) &
          = values(stage_thickness, k)
        elements%start_dilatation(slot, k) = elements%start_dilatation(slot, k) &
          - log_ratio(values(stage_thickness, k))
      end do
      elements%deviator(slot, :) = matmul(deviator(:, :n), start(:n))/sum(start(:n))
      if (elements%eos_start(i_chunk) > 0) then
        first = elements%eos_start(i_chunk) + place
        elements%eos_state(first) = elements%eos_state(first) + energy/sum(start(:n))
        elements%eos_state(first + chunk_size) = -sum(start(:n)*mean(:n))/sum(start(:n))
      else
        elements%deviatoric_work(i_chunk) = elements%deviatoric_work(i_chunk) + energy
      end if
      if (.not. has_hourglass_memory(model, i_chunk, elements)) return
      diagonals = elements%reference(slot, :4)
      call find_hourglass(model, i_chunk, diagonals, .true., &
        values(stage_hourglass:stage_hourglass + 1, 1), memory)
      first = elements%hourglass_start(i_chunk) + place
      elements%hourglass_strain([first, first + chunk_size]) = memory
    end associate
  end subroutine set_slot

  !> Elastic energy per volume of a stress.
  pure function elastic_energy(material, mean, s) result(energy)
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: mean, s(3) !! deviator xx yy xy
    real(wp) :: energy
    real(wp) :: dilatation

    dilatation = mean/material%bulk
    energy = (s(1)**2 + s(2)**2 + s(1)*s(2) + s(3)**2)/(2.0_wp*material%shear) &
      + volumetric_energy(material%bulk, exp(dilatation) - 1.0_wp)*exp(-dilatation)
  end function elastic_energy

  !> Whether the one-point quads of a chunk have hourglass forces at rest.
  pure function has_hourglass_memory(model, i_chunk, elements) result(yes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    type(block_state_t), intent(in) :: elements
    logical :: yes

    associate (hourglass => model%parts(model%layout%chunk_part(i_chunk))%hourglass)
      yes = elements%hourglass_start(i_chunk) > 0 .and. hourglass%form /= hourglass_viscous &
        .and. hourglass%coefficient > 0.0_wp
    end associate
  end function has_hourglass_memory

  !> From the hourglass force per unit of depth to the memory of the form, or back.
  pure subroutine find_hourglass(model, i_chunk, diagonals, to_memory, given, found)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    real(wp), intent(in) :: diagonals(4)    !! present x31 y31 x42 y42
    logical, intent(in) :: to_memory
    real(wp), intent(in) :: given(2)
    real(wp), intent(out) :: found(2)
    real(wp) :: frame(2), stiffness

    associate (d => diagonals, part => model%parts(model%layout%chunk_part(i_chunk)), &
      material => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
      if (part%hourglass%form == hourglass_stiffness) then
        stiffness = material%bulk
        if (material%is_plane_stress) stiffness = condensed_bulk(material%bulk, material%shear)
        stiffness = 0.25_wp*part%hourglass%coefficient*(stiffness + 4.0_wp*material%shear/3.0_wp) &
          *dot_product(d, d)/(d(1)*d(4) - d(3)*d(2))
        found = merge(given/stiffness, given*stiffness, to_memory)
      else
        ! The generalised stress has the axes of the element.
        frame = [(d(1) - d(3)) + (d(2) + d(4)), (d(2) - d(4)) - (d(1) + d(3))]
        frame = frame/norm2(frame)
        if (to_memory) frame(2) = -frame(2)
        found = [frame(1)*given(1) - frame(2)*given(2), frame(2)*given(1) + frame(1)*given(2)]
      end if
    end associate
  end subroutine find_hourglass

  !> Values of the points of the element in a slot.
  subroutine find_stage_values(model, motion, elements, slot, values)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: motion(:, :)
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: slot
    real(wp), allocatable, intent(out) :: values(:, :) !! (n_stage_value, points)
    real(wp) :: stretch(n_point), start(n_point), mean, s(3), u(2, 4), d(4)
    integer :: i_chunk, place, n, n_volume, k, i, first

    i_chunk = (slot - 1)/chunk_size + 1
    place = mod(slot - 1, chunk_size)
    n = merge(n_point, 1, elements%point_start(i_chunk) > 0)
    allocate (values(n_stage_value, n), source=0.0_wp)
    associate (material => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
      call volume_ratios(model, motion, elements, slot, n_volume, stretch, start)
      do k = 1, n
        s = elements%deviator(slot, :)
        if (n > 1) s = elements%point_deviator([(elements%point_start(i_chunk) + place &
          + (3*(k - 1) + i - 1)*chunk_size, i=1, 3)])
        mean = log_ratio(stretch(min(k, n_volume)))
        if (allocated(elements%start_dilatation)) mean = mean + elements%start_dilatation(slot, k)
        mean = material%bulk*mean
        if (elements%eos_start(i_chunk) > 0) mean = -elements%eos_state( &
          elements%eos_start(i_chunk) + chunk_size + place)
        if (material%is_plane_stress) mean = s(1) + s(2)
        values(1:4, k) = [mean + s(1), mean + s(2), mean - (s(1) + s(2)), s(3)]
        first = elements%history_start(i_chunk) + place + (k - 1)*chunk_size*history_size(material)
        if (has_plastic_strain(material)) values(stage_plastic, k) = elements%history(first)
        do i = 1, n_law_history(material)
          values(stage_law + i - 1, k) = elements%history(first + i*chunk_size)
        end do
        if (material%is_plane_stress) values(stage_thickness, k) = elements%eos_state( &
          thinning_start(elements, i_chunk, k) + place)
      end do
    end associate
    if (.not. has_hourglass_memory(model, i_chunk, elements)) return
    u = motion(1:2, model%layout%slot_nodes(:, slot))
    d = elements%reference(slot, :4) + [u(:, 3) - u(:, 1), u(:, 4) - u(:, 2)]
    first = elements%hourglass_start(i_chunk) + place
    call find_hourglass(model, i_chunk, d, .false., elements%hourglass_strain([first, first &
      + chunk_size]), values(stage_hourglass:stage_hourglass + 1, 1))
  end subroutine find_stage_values

  !> Hencky strain of all stages of the points of the element in a slot, in present axes.
  subroutine find_stage_strains(model, motion, elements, slot, strains)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: motion(:, :)
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: slot
    real(wp), allocatable, intent(out) :: strains(:, :) !! (n_stage_strain, points)
    real(wp) :: u(2, 4), d(4), h(2), change(4), moved(2), f(2, 2), b(3), radius
    integer :: i_chunk, n, k

    i_chunk = (slot - 1)/chunk_size + 1
    n = merge(n_point, 1, elements%point_start(i_chunk) > 0)
    allocate (strains(n_stage_strain, n), source=0.0_wp)
    u = motion(1:2, model%layout%slot_nodes(:, slot))
    moved = (u(:, 1) - u(:, 2)) + (u(:, 3) - u(:, 4))
    do k = 1, n
      d = elements%reference(slot, :4)
      change = [u(:, 3) - u(:, 1), u(:, 4) - u(:, 2)]
      if (n > 1) then
        h = elements%reference(slot, 5:6)
        d = d + [shift(1, k)*h, shift(2, k)*h]
        change = change + [shift(1, k)*moved, shift(2, k)*moved]
      end if
      ! F - 1 maps the diagonals of time zero to their changes.
      f = matmul(reshape(change, [2, 2]), reshape([d(4), -d(2), -d(3), d(1)], [2, 2])) &
        /(d(1)*d(4) - d(3)*d(2))
      f(1, 1) = f(1, 1) + 1.0_wp
      f(2, 2) = f(2, 2) + 1.0_wp
      b = [1.0_wp, 1.0_wp, 0.0_wp]
      if (allocated(elements%start_strain)) then
        associate (e => elements%start_strain(slot, n_stage_strain*(k - 1) + 1:n_stage_strain*k))
          b = of_eigenvalues(2.0_wp*e([1, 2, 4]), .true.)
          strains(3, k) = e(3)
        end associate
      end if
      f = matmul(matmul(f, reshape([b(1), b(3), b(3), b(2)], [2, 2])), transpose(f))
      strains([1, 2, 4], k) = 0.5_wp*of_eigenvalues([f(1, 1), f(2, 2), f(1, 2)], .false.)
      if (model%is_axisymmetric) then
        associate (x => model%mesh%coordinates(1, model%layout%slot_nodes(:, slot)))
          radius = sum(x)
          if (n > 1) radius = dot_product(shape_at_points(:, k), x)
          strains(3, k) = strains(3, k) + log_ratio(merge(dot_product(shape_at_points(:, k), &
            u(1, :)), sum(u(1, :)), n > 1)/radius)
        end associate
      else if (elements%eos_start(i_chunk) > 0) then
        if (model%materials(model%parts(slot_part(model%layout, slot))%material)%is_plane_stress) &
          strains(3, k) = log_ratio(elements%eos_state(thinning_start(elements, i_chunk, k) &
          + mod(slot - 1, chunk_size)))
      end if
    end do
  end subroutine find_stage_strains

  !> Exponential or logarithm of a symmetric tensor xx yy xy.
  pure function of_eigenvalues(t, is_exponential) result(found)
    real(wp), intent(in) :: t(3)
    logical, intent(in) :: is_exponential
    real(wp) :: found(3)
    real(wp) :: mean, half, values(2)

    mean = 0.5_wp*(t(1) + t(2))
    half = hypot(0.5_wp*(t(1) - t(2)), t(3))
    values = mean + [half, -half]
    values = merge(exp(merge(values, 0.0_wp, is_exponential)), log(merge(1.0_wp, values, &
      is_exponential)), is_exponential)
    found = 0.5_wp*(values(1) + values(2))*[1.0_wp, 1.0_wp, 0.0_wp]
    if (half > 0.0_wp) found = found + 0.5_wp*(values(1) - values(2))/half &
      *[0.5_wp*(t(1) - t(2)), 0.5_wp*(t(2) - t(1)), t(3)]
  end function of_eigenvalues

end module element_stage_m
