! SPDX-License-Identifier: MIT
!> Stable step of plane one-point quads whose nodes carry hardly any mass but their own. A node
!> moves as if the rest of its mass belonged to mirror images of the element: one component of its
!> acceleration is that of the free element, the other one 2 s - 1 of that where s > 1/2 is the
!> element's share in its mass, and 0 below. omega^2 = 4 J c^2 lambda, lambda the largest eigenvalue
!> of D B Q B^T over K + 4G/3 with these weights Q, and J = A/A0. Of a free element, and of four in
!> a block, this is exact (doc/theory/elements.md, "Stable step").
module exposed_step_m
  use block_state_m, only : block_state_t
  use kinds_m, only : wp
  use law_pressure_m, only : take_now
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use parts_m, only : hourglass_t, material_t
  implicit none
  private
  public :: has_exposed, limit_exposed, exposed_step

  !> Gradients of the shape functions and what the step takes of the element besides.
  type :: gradients_t
    real(wp) :: x(4), y(4)       !! dN/dx, dN/dy, 1/m
    real(wp) :: area             !! m^2
    real(wp) :: growth           !! A/A0, at least 1
    real(wp) :: rate             !! size of the trace of the velocity gradient, 1/s
  end type gradients_t

contains

  !> Whether elements of a chunk are exposed.
  pure function has_exposed(elements, i_chunk) result(has)
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: i_chunk
    logical :: has

    has = .false.
    if (allocated(elements%mass_shares)) has = any(elements%mass_shares(:, (i_chunk &
      - 1)*chunk_size + 1:i_chunk*chunk_size) > 0.0_wp)
  end function has_exposed

  !> Lower the steps of those elements of a chunk that are exposed.
  subroutine limit_exposed(model, elements, i_chunk, motion, steps)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: i_chunk
    real(wp), intent(in), contiguous :: motion(:, :)    !! (4, n_node) u, v
    real(wp), intent(inout) :: steps(chunk_size)        !! s
    integer :: i

    if (.not. has_exposed(elements, i_chunk)) return
    do i = 1, model%layout%chunk_elements(i_chunk)
      steps(i) = min(steps(i), exposed_step(model, elements, (i_chunk - 1)*chunk_size + i, motion))
    end do
  end subroutine limit_exposed

  !> Stable step of the element in a slot, s, with the mass of its density; huge where it is not
  !> exposed.
  function exposed_step(model, elements, slot, motion) result(step)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: slot
    real(wp), intent(in), contiguous :: motion(:, :)    !! (4, n_node) u, v
    real(wp) :: step
    type(material_t) :: now
    type(gradients_t) :: gradients
    real(wp) :: normal(2), shape(6), nodal(4, 4), weights(4)
    real(wp), parameter :: one(4) = 1.0_wp

    step = huge(step)
    if (.not. allocated(elements%mass_shares)) return
    associate (part => model%parts(model%layout%chunk_part((slot - 1)/chunk_size + 1)), &
      shares => elements%mass_shares(:, slot))
      if (.not. any(shares > 0.0_wp)) return
      call take_now(model%materials(part%material), elements, slot, now)
      shape = elements%reference(slot, :6)
      nodal = motion(:, model%layout%slot_nodes(:, slot))
      ! Mirror images lie beyond the side where the least of the mass is its own.
      call form_gradients(shape, nodal, minloc(shares + cshift(shares, 1), 1), gradients, normal)
      call turn_gradients(normal, gradients)
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

  !> Gradients in the frame whose first axis is a unit vector.
  pure subroutine turn_gradients(axis, gradients)
    real(wp), intent(in) :: axis(2)
    type(gradients_t), intent(inout) :: gradients
    real(wp) :: across(4)

    across = axis(1)*gradients%y - axis(2)*gradients%x
    gradients%x = axis(1)*gradients%x + axis(2)*gradients%y
    gradients%y = across
  end subroutine turn_gradients

  !> Stable step of the motions in which the nodes have these weights in the first and in the second
  !> direction: of dt^2 omega^2/4 + dt rate/2 <= 1, with the rate of bulk viscosity, whose pressure
  !> is that of v(n-1/2). It counts in expansion too: two steps later such an element is in
  !> compression.
  pure function mode_step(now, viscosity, gradients, weights_x, weights_y) result(step)
    type(material_t), intent(in) :: now
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
    step = 2.0_wp/(rate + sqrt(rate**2 + omega**2))
  end function mode_step

  !> Largest eigenvalue of the product of a diagonal and a symmetric matrix, both without negative
  !> eigenvalues, by the roots of the cubic in trigonometric form.
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

end module exposed_step_m
