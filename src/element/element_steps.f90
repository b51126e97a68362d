! SPDX-License-Identifier: MIT
!> Stable steps of single elements, by the kernels of the step itself, and the elements that limit
!> the time step.
module element_steps_m
  use kinds_m, only : wp
  use block_state_m, only : block_state_t, intact
  use element_chunk_m, only : element_chunk_t, gather_motion
  use eos_pressure_m, only : finish_limits, present_moduli
  use hourglass_m, only : form_resistance
  use layout_m, only : chunk_size, slot_part
  use model_m, only : model_t
  use parts_m, only : hourglass_t, hourglass_viscous, part_t
  use quad_kinematics_m, only : form_shape, form_increments
  use quad_m, only : limit_chunk, start_points, move_point, sums_t
  use quad_points_m, only : n_point
  use stable_step_m, only : moduli_t
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: chunk_steps, scaled_step, is_damped, find_smallest_steps, own_steps, &
    exposed_step, start_retardation

  !> Gradients of the shape functions and other data of the element for its step.
  type :: gradients_t
    real(wp) :: x(4), y(4)       !! dN/dx, dN/dy, 1/m
    real(wp) :: area             !! m^2
    real(wp) :: growth           !! A/A0, at least 1
    real(wp) :: rate             !! |trace of the velocity gradient|, 1/s
  end type gradients_t

contains

  !> Stable steps of the elements of a chunk, padding included. With an equation of state the
  !> stiffest element determines the moduli.
  subroutine chunk_steps(model, elements, i_chunk, motion, dt, steps)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: i_chunk
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node)
    real(wp), intent(in) :: dt
    real(wp), intent(out) :: steps(chunk_size)
    type(moduli_t) :: now, other
    integer :: first, i

    first = (i_chunk - 1)*chunk_size + 1
    associate (material => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
      now = present_moduli(material, elements, first)
      if (allocated(material%eos)) then
        do i = first + 1, first + model%layout%chunk_elements(i_chunk) - 1
          other = present_moduli(material, elements, i)
          now%bulk = max(now%bulk, other%bulk)
          now%shear = max(now%shear, other%shear)
          now%sound_speed = max(now%sound_speed, other%sound_speed)
        end do
      end if
    end associate
    call steps_at_moduli(model, elements, i_chunk, [now], motion, dt, steps)
  end subroutine chunk_steps

  !> Stable steps of the elements of a chunk at given moduli, with hourglass control.
  subroutine steps_at_moduli(model, elements, i_chunk, now, motion, dt, steps)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: i_chunk
    type(moduli_t), intent(in) :: now(:)             !! of each element, or one for all
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node)
    real(wp), intent(in) :: dt                       !! previous step; 0: no rates
    real(wp), intent(out) :: steps(chunk_size)       !! s
    type(element_chunk_t) :: chunk, shape, point
    type(stress_chunk_t) :: unused
    type(sums_t) :: sums
    real(wp) :: at_moduli(chunk_size)
    integer :: first, i

    first = (i_chunk - 1)*chunk_size + 1
    call gather_motion(model%is_axisymmetric, model%layout%slot_nodes(1, first), motion, chunk)
    call form_shape(elements%reference(first, 1), size(elements%reference, 1), chunk)
    call form_increments(dt, chunk, unused)
    if (elements%point_start(i_chunk) > 0) then
      call start_points(chunk%is_axisymmetric, point, sums)
      do i = 1, n_point
        call move_point(i_chunk, i, dt, elements, chunk, point, unused, sums)
      end do
    else if (chunk%is_axisymmetric) then
      associate (part => model%parts(model%layout%chunk_part(i_chunk)))
        call form_resistance(model%materials(part%material), part%hourglass, chunk)
      end associate
    end if
    if (size(now) > 1 .and. chunk%is_axisymmetric) shape = chunk
    call limit_elements(model, i_chunk, now(1), elements, chunk, sums, steps)
    do i = 2, size(now)
      if (chunk%is_axisymmetric) chunk = shape ! the limits of triangles change it
      call limit_elements(model, i_chunk, now(i), elements, chunk, sums, at_moduli)
      steps(i) = at_moduli(i)
    end do
    do i = 1, chunk_size
      if (allocated(elements%mass_shares)) steps(i) = min(steps(i), exposed_step(model, elements, &
        first + i - 1, motion))
      if (.not. allocated(elements%retardation)) cycle
      ! Damping by stiffness, whose forces are those of v(n-1/2): with zeta = beta omega/2 and
      ! omega = 2/step the step is 2 (sqrt(1 + zeta^2) - zeta)/omega.
      associate (zeta => elements%retardation(first + i - 1)/steps(i))
        if (zeta > 0.0_wp) steps(i) = steps(i)/(zeta + sqrt(1.0_wp + zeta**2))
      end associate
    end do
  end subroutine steps_at_moduli

  !> Stable steps of the elements of a chunk whose shape and points are set.
  subroutine limit_elements(model, i_chunk, now, elements, chunk, sums, steps)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    type(moduli_t), intent(in) :: now
    type(block_state_t), intent(in) :: elements
    type(element_chunk_t), intent(inout) :: chunk
    type(sums_t), intent(inout) :: sums
    real(wp), intent(out) :: steps(chunk_size)
    real(wp) :: limits(2), same(chunk_size)
    integer :: i

    call limit_chunk(model, i_chunk, now, elements, chunk, sums, limits, steps)
    associate (material => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
      if (.not. material%viscosity > 0.0_wp) return
      do i = 1, chunk_size
        same = chunk%stretch(i)
        call finish_limits(material, now, same, steps(i), limits(2))
      end do
    end associate
  end subroutine limit_elements

  !> Stable steps of the elements of a chunk, each with its present moduli and mass.
  subroutine own_steps(model, elements, i_chunk, motion, steps)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: i_chunk
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node)
    real(wp), intent(out) :: steps(chunk_size)       !! s
    type(moduli_t) :: now(chunk_size)
    integer :: first, i, n

    first = (i_chunk - 1)*chunk_size + 1
    associate (material => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
      n = merge(model%layout%chunk_elements(i_chunk), 1, allocated(material%eos))
      do i = 1, n
        now(i) = present_moduli(material, elements, first + i - 1)
      end do
    end associate
    call steps_at_moduli(model, elements, i_chunk, now(:n), motion, 0.0_wp, steps)
    do i = 1, model%layout%chunk_elements(i_chunk)
      steps(i) = scaled_step(model, first + i - 1, steps(i), elements)
    end do
  end subroutine own_steps

  !> The `n` elements of the smallest stable steps, or all where there are fewer, in rising order.
  !> They lie in the chunks of the `n` smallest limits of the last forces.
  subroutine find_smallest_steps(model, elements, motion, n, found, steps)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    real(wp), intent(in), contiguous :: motion(:, :)  !! (4, n_node)
    integer, intent(in) :: n
    integer, allocatable, intent(out) :: found(:)     !! element indices
    real(wp), allocatable, intent(out) :: steps(:)    !! s
    logical, allocatable :: seen(:)
    real(wp) :: of_slots(chunk_size)
    integer :: i, k, i_chunk, i_slot, place

    allocate (found(0), steps(0))
    allocate (seen(size(elements%time_limit)), source=.false.)
    do i = 1, min(n, size(seen))
      i_chunk = minloc(elements%time_limit, dim=1, mask=.not. seen)
      seen(i_chunk) = .true.
      call own_steps(model, elements, i_chunk, motion, of_slots)
      do k = 1, model%layout%chunk_elements(i_chunk)
        i_slot = (i_chunk - 1)*chunk_size + k
        if (allocated(elements%erosion)) then
          if (elements%erosion%status(i_slot) /= intact) cycle
        end if
        place = count(steps <= of_slots(k))
        if (place >= n) cycle
        found = [found(:place), model%layout%slot_element(i_slot), found(place + 1:)]
        steps = [steps(:place), of_slots(k), steps(place + 1:)]
      end do
    end do
    found = found(:min(n, size(found)))
    steps = steps(:size(found))
  end subroutine find_smallest_steps

  !> Stable step of the element in a slot with its scaled mass.
  pure function scaled_step(model, slot, step, elements) result(scaled)
    type(model_t), intent(in) :: model
    integer, intent(in) :: slot
    real(wp), intent(in) :: step                 !! with the mass from its density
    type(block_state_t), intent(in) :: elements
    real(wp) :: scaled

    scaled = step
    if (.not. allocated(elements%mass_ratio)) return
    associate (ratio => elements%mass_ratio(slot))
      scaled = step*sqrt(ratio)
      if (ratio < 1.0_wp) then
        if (is_damped(model, model%parts(slot_part(model%layout, slot)))) scaled = step*ratio
      end if
    end associate
  end function scaled_step

  !> Whether rates of a part are damped.
  pure function is_damped(model, part) result(damped)
    type(model_t), intent(in) :: model
    type(part_t), intent(in) :: part
    logical :: damped

    associate (hourglass => part%hourglass)
      damped = model%materials(part%material)%viscosity > 0.0_wp &
        .or. hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp &
        .or. (hourglass%form == hourglass_viscous .and. hourglass%coefficient > 0.0_wp &
        .and. .not. model%sections(part%section)%is_full) .or. abs(part%stiffness_damping) > 0.0_wp
    end associate
  end function is_damped

  !> Stable step, s, of a plane one-point quad in a slot whose nodes carry hardly any mass of other
  !> elements, with the mass from its density; huge where it is not exposed. A node moves as if the
  !> rest of its mass belonged to mirror images of the element: one component of its acceleration is
  !> that of the free element, the other one 2 s - 1 of that where s > 1/2 is the element's share in
  !> its mass, and 0 below. omega^2 = 4 J c^2 lambda, lambda the largest eigenvalue of D B Q B^T
  !> over K + 4G/3 with these weights Q, and J = A/A0. Exact for a free element and for four in a
  !> block (doc/theory/elements.md, "Stable step").
  function exposed_step(model, elements, slot, motion) result(step)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: slot
    real(wp), intent(in), contiguous :: motion(:, :)    !! (4, n_node) u, v
    real(wp) :: step
    type(moduli_t) :: now
    type(gradients_t) :: gradients
    real(wp) :: normal(2), shape(6), nodal(4, 4), weights(4)
    real(wp), parameter :: one(4) = 1.0_wp

    step = huge(step)
    associate (part => model%parts(model%layout%chunk_part((slot - 1)/chunk_size + 1)), &
      shares => elements%mass_shares(:, slot))
      if (.not. any(shares > 0.0_wp)) return
      now = present_moduli(model%materials(part%material), elements, slot)
      shape = elements%reference(slot, :6)
      nodal = motion(:, model%layout%slot_nodes(:, slot))
      ! Mirror images lie beyond the side with the smallest own share of the mass.
      call form_gradients(shape, nodal, minloc(shares + cshift(shares, 1), 1), gradients, normal)
      associate (x => normal(1)*gradients%x + normal(2)*gradients%y)
        gradients%y = normal(1)*gradients%y - normal(2)*gradients%x
        gradients%x = x
      end associate
      weights = max(0.0_wp, 2.0_wp*shares - 1.0_wp)
      step = min(mode_step(now, part%hourglass, gradients, one, weights), &
        mode_step(now, part%hourglass, gradients, weights, one))
    end associate
  end function exposed_step

  !> Gradients in the present shape, and the unit normal of a side.
  pure subroutine form_gradients(shape, motion, side, gradients, normal)
    real(wp), intent(in) :: shape(6)      !! X31 Y31 X42 Y42 h.X h.Y at time zero
    real(wp), intent(in) :: motion(4, 4)  !! u, v of the nodes
    integer, intent(in) :: side
    type(gradients_t), intent(out) :: gradients
    real(wp), intent(out) :: normal(2)
    real(wp) :: a(2), b(2), h(2), along(2), start

    a = shape(1:2) + (motion(1:2, 3) - motion(1:2, 1))
    b = shape(3:4) + (motion(1:2, 4) - motion(1:2, 2))
    h = shape(5:6) + (motion(1:2, 1) - motion(1:2, 2)) + (motion(1:2, 3) - motion(1:2, 4))
    start = 0.5_wp*(shape(1)*shape(4) - shape(3)*shape(2))
    gradients%area = 0.5_wp*(a(1)*b(2) - b(1)*a(2))
    gradients%growth = max(1.0_wp, gradients%area/start)
    gradients%x = 0.5_wp*[-b(2), a(2), b(2), -a(2)]/gradients%area
    gradients%y = 0.5_wp*[b(1), -a(1), -b(1), a(1)]/gradients%area
    gradients%rate = abs(sum(gradients%x*motion(3, :) + gradients%y*motion(4, :)))
    select case (side)
    case (1)
      along = a - b - h
    case (2)
      along = a + b + h
    case (3)
      along = b - a - h
    case default
      along = h - a - b
    end select
    normal = [along(2), -along(1)]/max(norm2(along), tiny(1.0_wp))
  end subroutine form_gradients

  !> Stable step of motions with the given nodal weights in both directions: dt^2 omega^2/4 + dt
  !> rate/2 <= 1, with the rate of bulk viscosity, whose pressure is that of v(n-1/2). It counts in
  !> expansion too: two steps later such an element is in compression.
  pure function mode_step(now, viscosity, gradients, weights_x, weights_y) result(step)
    type(moduli_t), intent(in) :: now
    type(hourglass_t), intent(in) :: viscosity         !! its Q1 and Q2
    type(gradients_t), intent(in) :: gradients
    real(wp), intent(in) :: weights_x(4), weights_y(4) !! 0 to 1
    real(wp) :: step
    real(wp) :: xx, yy, xy, yx, shear, modulus, lateral, omega, rate, length

    xx = sum(weights_x*gradients%x**2)
    yy = sum(weights_y*gradients%y**2)
    xy = sum(weights_x*gradients%x*gradients%y)
    yx = sum(weights_y*gradients%x*gradients%y)
    shear = sum(weights_x*gradients%y**2) + sum(weights_y*gradients%x**2)
    modulus = now%bulk + 4.0_wp*now%shear/3.0_wp
    lateral = (modulus - 2.0_wp*now%shear)/modulus
    ! D B B^T of the strains (xx + yy)/root 2, (xx - yy)/root 2 and xy.
    omega = 2.0_wp*now%sound_speed*sqrt(gradients%growth*largest_eigenvalue( &
      [1.0_wp + lateral, 1.0_wp - lateral, now%shear/modulus], &
      [0.5_wp*(xx + yy), 0.5_wp*(xx + yy), shear], &
      [0.5_wp*(xx - yy), (xy + yx)/sqrt(2.0_wp), (xy - yx)/sqrt(2.0_wp)]))
    rate = 0.0_wp
    if (viscosity%quadratic > 0.0_wp .or. viscosity%linear > 0.0_wp) then
      length = sqrt(abs(gradients%area))
      rate = 2.0_wp*length*(viscosity%linear*now%sound_speed + viscosity%quadratic*length &
        *gradients%rate)*(xx + yy)
    end if
    step = 2.0_wp/max(rate + sqrt(rate**2 + omega**2), tiny(1.0_wp)) ! no motion, no limit
  end function mode_step

  !> Largest eigenvalue of the product of a diagonal and a symmetric matrix, both positive
  !> semidefinite, by the roots of the cubic in trigonometric form.
  pure function largest_eigenvalue(scale, diagonal, off) result(largest)
    real(wp), intent(in) :: scale(3)     !! diagonal matrix
    real(wp), intent(in) :: diagonal(3)  !! 11, 22, 33 of the other
    real(wp), intent(in) :: off(3)       !! 12, 13, 23
    real(wp) :: largest
    real(wp) :: a(3), b(3), mean, spread, determinant

    a = scale*diagonal
    b = off*sqrt([scale(1)*scale(2), scale(1)*scale(3), scale(2)*scale(3)])
    mean = sum(a)/3.0_wp
    a = a - mean
    spread = sqrt((sum(a**2) + 2.0_wp*sum(b**2))/6.0_wp)
    determinant = a(1)*a(2)*a(3) + 2.0_wp*b(1)*b(2)*b(3) - a(1)*b(3)**2 - a(2)*b(2)**2 &
      - a(3)*b(1)**2
    largest = mean
    if (.not. spread > 0.0_wp) return
    largest = mean + 2.0_wp*spread*cos(acos(max(-1.0_wp, min(1.0_wp, 0.5_wp*determinant &
      /spread**3)))/3.0_wp)
  end function largest_eigenvalue

  !> Retardation times at time zero: a share of critical damping of the fastest mode of the element,
  !> omega = 2/step, is that share times the step.
  subroutine start_retardation(model, motion, elements)
    type(model_t), intent(in) :: model
    real(wp), intent(in), contiguous :: motion(:, :)  !! (4, n_node)
    type(block_state_t), intent(inout) :: elements
    real(wp), allocatable :: retardation(:)
    real(wp) :: steps(chunk_size)
    integer :: i_chunk, first

    allocate (retardation(model%layout%n_slot), source=0.0_wp)
    do i_chunk = 1, size(elements%time_limit)
      first = (i_chunk - 1)*chunk_size + 1
      associate (share => model%parts(model%layout%chunk_part(i_chunk))%stiffness_damping, &
        times => retardation(first:first + chunk_size - 1))
        if (share < 0.0_wp) times = -share
        if (.not. share > 0.0_wp) cycle
        call chunk_steps(model, elements, i_chunk, motion, 0.0_wp, steps)
        times = share*steps
        times(model%layout%chunk_elements(i_chunk) + 1:) = 0.0_wp
      end associate
    end do
    call move_alloc(retardation, elements%retardation)
    allocate (elements%damping_stress(16*model%layout%n_slot), source=0.0_wp)
    allocate (elements%damping_work(size(elements%time_limit)), source=0.0_wp)
  end subroutine start_retardation

end module element_steps_m
