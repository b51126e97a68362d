! SPDX-License-Identifier: MIT
!> Derivative of the internal force of all elements, for implicit solutions, and the force of a
!> one-point quad with assumed-strain hourglass control in dual numbers (fully integrated quads:
!> `element_tangent`).
module element_stiffness_m
  use block_state_m, only : block_state_t
  use short_dual_m, only : dual_t, constant, operator(+), operator(-), operator(*), operator(/), &
    sqrt
  use element_tangent_m, only : element_t, shape_t, n_pattern, new_element, set_pattern_values, &
    form_full_force, form_gradient, find_stress, find_sheet_stress, pressure_of, start_volumes, &
    twice_area, products, cross
  use hourglass_m, only : form_moduli
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use material_dispatch_m, only : history_size
  use model_m, only : model_t
  use parts_m, only : hourglass_t, material_t
  use plane_stress_m, only : thinning_start
  use quad_points_m, only : n_point
  use sparse_m, only : sparse_t, add_block
  use stress_chunk_m, only : stress_point_t
  implicit none
  private
  public :: add_stiffness

  !> Patterns a = d31, b = d42 and h in x and y, and s (`element_tangent`), of the unknowns x1 y1 x2
  !> y2 ...
  real(wp), parameter :: of_nodes(n_pattern, 8) = real(reshape([ &
    -1, 0, 0, 0, 1, 0, 1, 0, -1, 0, 0, 0, 1, 0, 0, 0, -1, 0, -1, 0, 1, 0, 0, 0, -1, 0, -1, 0, &
    1, 0, 0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 0, 1, 0, 0, 0, 1, 0, -1, 0], &
    [n_pattern, 8]), wp)
  real(wp), parameter :: part = 1.0_wp/24.0_wp

  !> Integrals over a quad of r d/dr, of r d/dz and of 1, pattern by pattern (`form_axisym_shape`).
  type :: integrals_t
    type(dual_t) :: volume, rad(3), axi(3), mean(3)
  end type integrals_t

contains

  !> Add the exact derivative of the internal force with respect to the displacement. The step `dt`
  !> goes from the committed state to `motion`, with velocity (u - u_committed)/dt. One-point parts
  !> must have assumed-strain hourglass control.
  pure subroutine add_stiffness(model, motion, dt, committed, equation, matrix)
    type(model_t), intent(in) :: model
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node)
    real(wp), intent(in) :: dt
    type(block_state_t), intent(in) :: committed
    integer, intent(in) :: equation(:, :)            !! (2, n_node) equation numbers, 0 = none
    type(sparse_t), intent(inout) :: matrix          !! started, not compressed
    type(element_t) :: element
    real(wp) :: block(8, 8), du(2, 4)
    integer :: equations(8), i_chunk, slot

    element = new_element(model%is_axisymmetric)
    do i_chunk = 1, model%layout%n_chunk
      associate (part => model%parts(model%layout%chunk_part(i_chunk)), &
        material => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
        if (material%is_rigid) cycle
        do slot = (i_chunk - 1)*chunk_size + 1, i_chunk*chunk_size
          if (model%layout%slot_element(slot) == 0) cycle
          associate (nodes => model%layout%slot_nodes(:, slot))
            equations = reshape(equation(:, nodes), [8])
            if (all(equations == 0)) cycle
            element%x = model%mesh%coordinates(:, nodes)
            element%u = motion(1:2, nodes)
            du = dt*motion(3:4, nodes)
            call set_pattern_values(element%x + element%u, element%now)
            call set_pattern_values(element%x + element%u - 0.5_wp*du, element%middle)
            call set_pattern_values(du, element%change)
            call load_points(i_chunk, mod(slot - 1, chunk_size), material, committed, element)
            if (allocated(committed%start_dilatation) .and. .not. any(abs(du) > 0.0_wp)) &
              call move_inside(element%points)
            call form_block(material, part%hourglass, committed%point_start(i_chunk) > 0, element, &
              block)
            call add_block(matrix, equations, equations, &
              model%sections(part%section)%thickness*block)
          end associate
        end do
      end associate
    end do
  end subroutine add_stiffness

  !> Move points just inside their yield surface, for the elastic tangent: a stage begins with
  !> unloading (springback), for which the plastic tangent of all points at once is singular.
  pure subroutine move_inside(points)
    type(stress_point_t), intent(inout) :: points(n_point)
    real(wp), parameter :: inside = 1.0_wp - 1.0e-6_wp
    integer :: k

    do k = 1, n_point
      points(k)%old = points(k)%back + inside*(points(k)%old - points(k)%back)
    end do
  end subroutine move_inside

  !> Load the state of the points of one element, and its hourglass stress, from the streams.
  pure subroutine load_points(i_chunk, place, material, elements, element)
    integer, intent(in) :: i_chunk
    integer, intent(in) :: place     !! in the chunk, from 0
    type(material_t), intent(in) :: material
    type(block_state_t), intent(in) :: elements
    type(element_t), intent(inout) :: element
    integer, parameter :: columns(3) = [0, chunk_size, 2*chunk_size] !! xx yy xy
    real(wp) :: s(3)
    integer :: first, k, n, n_history

    n_history = history_size(material)
    n = merge(n_point, 1, elements%point_start(i_chunk) > 0)
    element%dilatation = 0.0_wp
    if (allocated(elements%start_dilatation)) element%dilatation = &
      elements%start_dilatation((i_chunk - 1)*chunk_size + place + 1, :)
    first = elements%hourglass_start(i_chunk) + place
    if (n == 1) element%pattern_stress = elements%hourglass_strain([first, first + chunk_size])
    do k = 1, n
      if (n > 1) then
        first = elements%point_start(i_chunk) + 3*(k - 1)*chunk_size + place
        s = elements%point_deviator(first + columns)
      else
        s = elements%deviator((i_chunk - 1)*chunk_size + place + 1, :)
      end if
      if (material%is_plane_stress) element%thinning(k) = elements%eos_state(thinning_start( &
        elements, i_chunk, k) + place)
      element%points(k)%old = [0.5_wp*(s(1) + s(2)), 0.5_wp*(s(1) - s(2)), s(3)]
      if (n_history == 0) cycle
      first = elements%history_start(i_chunk) + n_history*(k - 1)*chunk_size + place
      element%points(k)%plastic_strain = elements%history(first)
      element%points(k)%back = 0.0_wp
      if (n_history == 1) cycle
      s = elements%history(first + chunk_size + columns)
      element%points(k)%back = [0.5_wp*(s(1) + s(2)), 0.5_wp*(s(1) - s(2)), s(3)]
    end do
  end subroutine load_points

  !> Matrix of one element, unknowns x1 y1 x2 y2 ... (per metre of thickness, or per radian).
  pure subroutine form_block(material, hourglass, is_full, element, block)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    logical, intent(in) :: is_full
    type(element_t), intent(inout) :: element
    real(wp), intent(out) :: block(8, 8)
    type(dual_t) :: force(n_pattern)
    real(wp) :: small(n_pattern, n_pattern)
    integer :: k

    if (is_full) then
      call form_full_force(material, element, force)
    else
      call form_one_point_force(material, hourglass, element, force)
    end if
    do k = 1, n_pattern
      small(k, :) = force(k)%slope(:n_pattern)
    end do
    block = matmul(transpose(of_nodes), matmul(small, of_nodes))
  end subroutine form_block

  !> Forces of a one-point quad on the patterns.
  pure subroutine form_one_point_force(material, hourglass, element, force)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(element_t), intent(inout) :: element
    type(dual_t), intent(out) :: force(n_pattern)
    type(integrals_t) :: over
    type(dual_t) :: gradient(2, 2), hoop, growth(2), stress(4), q(2), cosine, area, shares(2)
    real(wp) :: change_a(2), change_b(2)
    integer :: i, k

    associate (now => element%now, middle => element%middle, change => element%change)
      ! By name: components of an array are copied.
      change_a = change%a%value
      change_b = change%b%value
      call form_gradient(now, change_a, change_b, gradient)
      ! gamma.v, over the step.
      do i = 1, 2
        growth(i) = change%h(i) - products(gradient(i, 1), middle%h(1), gradient(i, 2), middle%h(2))
      end do
      hoop = constant(0.0_wp)
      if (element%is_axisymmetric) then
        call form_integrals(.true., middle, over)
        do i = 1, 2
          gradient(i, 1) = (products(over%rad(1), change%a(i), over%rad(2), change%b(i)) &
            + over%rad(3)*change%h(i))/over%volume
          gradient(i, 2) = (products(over%axi(1), change%a(i), over%axi(2), change%b(i)) &
            + over%axi(3)*change%h(i))/over%volume
        end do
        hoop = (products(over%mean(1), change%a(1), over%mean(2), change%b(1)) &
          + over%mean(3)*change%s)/over%volume
      end if
      area = twice_area(now)
      call form_integrals(element%is_axisymmetric, now, over)
      if (material%is_plane_stress) then
        call find_sheet_stress(material, 1, gradient, pressure_of(material%bulk, &
          element%dilatation(1), sum(start_volumes(element)), over%volume), element, stress, cosine)
      else
        call find_stress(material, gradient, hoop, pressure_of(material%bulk, &
          element%dilatation(1), sum(start_volumes(element)), over%volume), element%points(1), &
          stress, cosine)
      end if
      call find_resistance(material, hourglass, element, growth, cosine, q)
      ! The mean radius, and what h contributes to a and b in gamma.
      if (element%is_axisymmetric) then
        hoop = 2.0_wp*over%volume/area
        q(1) = hoop*q(1)
        q(2) = hoop*q(2)
      end if
      shares(1) = cross(now%b(1), now%h(2), now%b(2), now%h(1))/area
      shares(2) = cross(now%h(1), now%a(2), now%h(2), now%a(1))/area
    end associate
    do k = 1, 3
      force(2*k - 1) = products(over%rad(k), stress(1), over%axi(k), stress(3))
      force(2*k) = products(over%rad(k), stress(3), over%axi(k), stress(2))
      if (k == 3) exit
      force(2*k - 1) = force(2*k - 1) + products(shares(k), q(1), over%mean(k), stress(4))
      force(2*k) = force(2*k) + shares(k)*q(2)
    end do
    force(5) = force(5) + q(1)
    force(6) = force(6) + q(2)
    force(7) = over%mean(3)*stress(4)
  end subroutine form_one_point_force

  !> Integrals over a quad; a plane one has unit depth.
  pure subroutine form_integrals(is_axisymmetric, shape, over)
    logical, intent(in) :: is_axisymmetric
    type(shape_t), intent(in) :: shape
    type(integrals_t), intent(out) :: over
    type(dual_t) :: s, h(2)

    associate (a => shape%a, b => shape%b)
      if (.not. is_axisymmetric) then
        over%rad = [0.5_wp*b(2), (-0.5_wp)*a(2), constant(0.0_wp)]
        over%axi = [(-0.5_wp)*b(1), 0.5_wp*a(1), constant(0.0_wp)]
        over%mean = constant(0.0_wp)
        over%volume = 0.5_wp*twice_area(shape)
        return
      end if
      s = 0.125_wp*shape%s
      h(1) = part*shape%h(1)
      h(2) = part*shape%h(2)
      over%rad(1) = cross(s, b(2), b(1), h(2))
      over%rad(2) = -products(s, a(2), a(1), h(2))
      over%rad(3) = part*products(a(1), b(2), b(1), a(2))
      over%axi(1) = b(1)*(h(1) - s)
      over%axi(2) = a(1)*(h(1) + s)
      over%axi(3) = (-2.0_wp*part)*(a(1)*b(1))
      over%mean(1) = cross(h(1), b(2), h(2), b(1))
      over%mean(2) = cross(h(1), a(2), h(2), a(1))
      over%mean(3) = 0.125_wp*twice_area(shape)
      over%volume = shape%s*over%mean(3) + products(a(1), over%mean(1), b(1), over%mean(2))
    end associate
  end subroutine form_integrals

  !> Hourglass force q_x, q_y per unit of depth (`hourglass_assumed_strain`).
  pure subroutine find_resistance(material, hourglass, element, gamma, cosine, q)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(element_t), intent(in) :: element
    type(dual_t), intent(in) :: gamma(2)    !! gamma.v, over the step
    type(dual_t), intent(in) :: cosine      !! of the rotation in the step
    type(dual_t), intent(out) :: q(2)
    type(dual_t) :: growth(2), a(2), b(2), frame(2), weight, stress(2), mixed
    real(wp) :: factor, lateral

    call form_moduli(material, hourglass, factor, lateral)
    frame = frame_of(element%middle)
    weight = sqrt(0.5_wp*(cosine + 1.0_wp))
    a = into(frame, element%middle%a)
    b = into(frame, element%middle%b)
    growth = into(frame, gamma)
    growth(1) = weight*growth(1)
    growth(2) = weight*growth(2)
    weight = constant(4.0_wp*factor/3.0_wp)/twice_area(element%middle)
    mixed = lateral*(weight*products(a(1), a(2), b(1), b(2)))
    stress(1) = products(weight*products(a(2), a(2), b(2), b(2)), growth(1), mixed, growth(2)) &
      + element%pattern_stress(1)
    stress(2) = products(weight*products(a(1), a(1), b(1), b(1)), growth(2), mixed, growth(1)) &
      + element%pattern_stress(2)
    frame = frame_of(element%now)
    q(1) = cross(frame(1), stress(1), frame(2), stress(2))
    q(2) = products(frame(2), stress(1), frame(1), stress(2))
  end subroutine find_resistance

  !> First axis of the element's frame.
  pure function frame_of(shape) result(frame)
    type(shape_t), intent(in) :: shape
    type(dual_t) :: frame(2)
    type(dual_t) :: length

    frame(1) = (shape%a(1) - shape%b(1)) + (shape%a(2) + shape%b(2))
    frame(2) = (shape%a(2) - shape%b(2)) - (shape%a(1) + shape%b(1))
    length = sqrt(products(frame(1), frame(1), frame(2), frame(2)))
    frame(1) = frame(1)/length
    frame(2) = frame(2)/length
  end function frame_of

  !> Components of a vector in a frame.
  pure function into(frame, vector) result(found)
    type(dual_t), intent(in) :: frame(2), vector(2)
    type(dual_t) :: found(2)

    found(1) = products(frame(1), vector(1), frame(2), vector(2))
    found(2) = cross(frame(1), vector(2), frame(2), vector(1))
  end function into

end module element_stiffness_m
