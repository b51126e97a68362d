! SPDX-License-Identifier: MIT
!> Flanagan-Belytschko hourglass control of the one-point quad (Flanagan &
!> Belytschko 1981), from the hourglass velocity gamma.v.
module hourglass_m
  use kinds_m, only : wp
  use assumed_strain_m, only : largest_spread
  use layout_m, only : chunk_size
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t
  use parts_m, only : hourglass_t, hourglass_viscous, hourglass_assumed
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: resist_viscously, resist_elastically, hourglass_steps, harmless_coefficient, &
    note_works

  !> Coefficient up to which hourglass control never asks for less than L/c in a convex quad of its
  !> initial area (doc/theory/elements.md).
  real(wp), parameter :: harmless_coefficient = 0.25_wp

contains

  !> Viscous form: q = (Q_h rho c sqrt(A)/4) gamma.v.
  pure subroutine resist_viscously(factor, dt, chunk, work)
    real(wp), intent(in) :: factor                !! Q_h rho c/4
    real(wp), intent(in) :: dt
    type(element_chunk_t), intent(inout) :: chunk !! q_x, q_y out
    real(wp), intent(out) :: work                 !! work of the step
    real(wp) :: viscosity
    integer :: i

    work = 0.0_wp
    !$omp simd private(viscosity) reduction(+ : work)
    do i = 1, chunk_size
      viscosity = factor*sqrt(abs(chunk%area(i)))
      chunk%qx(i) = viscosity*chunk%gx(i)
      chunk%qy(i) = viscosity*chunk%gy(i)
      work = work + (chunk%qx(i)*chunk%gx(i) + chunk%qy(i)*chunk%gy(i))
    end do
    work = dt*work
  end subroutine resist_viscously

  !> Stiffness form: force (Q_h/4)(K + 4G/3)((B_x.B_x + B_y.B_y)/A) times the hourglass strain e,
  !> which turns with the element. With the rotation R of the step, e' = R e + (1 + R) dt g/2:
  !> gamma.v is of the mid-step frame, half a rotation back, and (1 + R)/2 is that half rotation
  !> times its cosine, by which gamma.v of a turning element is too large. So a pattern that grows
  !> while its element turns is kept without error, whatever the step, and no step divides by zero.
  pure subroutine resist_elastically(factor, dt, stress, strain_x, strain_y, chunk, work)
    real(wp), intent(in) :: factor                  !! Q_h (K + 4G/3)/4
    real(wp), intent(in) :: dt
    type(stress_chunk_t), intent(in) :: stress      !! rotation of the step
    real(wp), intent(inout), dimension(chunk_size) :: strain_x, strain_y
    type(element_chunk_t), intent(inout) :: chunk   !! q_x, q_y out
    real(wp), intent(out) :: work                   !! work of the step
    real(wp) :: stiffness, half_x, half_y, old_x, old_y, growth_x, growth_y
    integer :: i

    work = 0.0_wp
    !$omp simd private(stiffness, half_x, half_y, old_x, old_y, growth_x, growth_y) &
    !$omp& reduction(+ : work)
    do i = 1, chunk_size
      stiffness = 0.5_wp*factor*(chunk%x31(i)**2 + chunk%y31(i)**2 + chunk%x42(i)**2 &
        + chunk%y42(i)**2)*chunk%inverse_area(i)
      half_x = 0.5_wp*dt*chunk%gx(i)
      half_y = 0.5_wp*dt*chunk%gy(i)
      old_x = stress%cosine(i)*strain_x(i) - stress%sine(i)*strain_y(i)
      old_y = stress%sine(i)*strain_x(i) + stress%cosine(i)*strain_y(i)
      growth_x = half_x + (stress%cosine(i)*half_x - stress%sine(i)*half_y)
      growth_y = half_y + (stress%sine(i)*half_x + stress%cosine(i)*half_y)
      strain_x(i) = old_x + growth_x
      strain_y(i) = old_y + growth_y
      chunk%qx(i) = stiffness*strain_x(i)
      chunk%qy(i) = stiffness*strain_y(i)
      work = work + stiffness*((strain_x(i) + old_x)*growth_x + (strain_y(i) + old_y)*growth_y)
    end do
    work = 0.5_wp*work
  end subroutine resist_elastically

  !> Works element by element, where these may leave.
  pure subroutine note_works(i_chunk, hourglass, stress, elements, chunk)
    integer, intent(in) :: i_chunk
    type(hourglass_t), intent(in) :: hourglass
    type(stress_chunk_t), intent(in) :: stress
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(in) :: chunk
    integer :: slot, first

    slot = (i_chunk - 1)*chunk_size + 1
    if (hourglass%form == hourglass_viscous) then
      call add_viscous_works(stress%dt, chunk, elements%erosion%hourglass(slot))
    else
      first = elements%hourglass_start(i_chunk)
      call add_elastic_works(stress, chunk, elements%hourglass_strain(first), &
        elements%hourglass_strain(first + chunk_size), elements%erosion%hourglass(slot))
    end if
  end subroutine note_works

  !> Works of the viscous forces, element by element.
  pure subroutine add_viscous_works(dt, chunk, works)
    real(wp), intent(in) :: dt
    type(element_chunk_t), intent(in) :: chunk
    real(wp), intent(inout) :: works(chunk_size)

    works = works + dt*(chunk%qx*chunk%gx + chunk%qy*chunk%gy)
  end subroutine add_viscous_works

  !> The same of the stiffness form, whose strains are those of the end of the step.
  pure subroutine add_elastic_works(stress, chunk, strain_x, strain_y, works)
    type(stress_chunk_t), intent(in) :: stress
    type(element_chunk_t), intent(in) :: chunk
    real(wp), intent(in), dimension(chunk_size) :: strain_x, strain_y
    real(wp), intent(inout) :: works(chunk_size)
    real(wp) :: half(2), growth(2), square
    integer :: i

    do i = 1, chunk_size
      half = 0.5_wp*stress%dt*[chunk%gx(i), chunk%gy(i)]
      growth = half + [stress%cosine(i)*half(1) - stress%sine(i)*half(2), &
        stress%sine(i)*half(1) + stress%cosine(i)*half(2)]
      works(i) = works(i) + (chunk%qx(i)*growth(1) + chunk%qy(i)*growth(2))
      ! The mean of both ends: less half of stiffness times growth squared.
      square = strain_x(i)**2 + strain_y(i)**2
      if (square > 0.0_wp) works(i) = works(i) - 0.5_wp*sum(growth**2) &
        *(chunk%qx(i)*strain_x(i) + chunk%qy(i)*strain_y(i))/square
    end do
  end subroutine add_elastic_works

  !> Steps that hourglass control of the elements allows. With masses rho A0/4 and
  !> gamma.gamma = 4 + (|d31 x h.x|^2 + |d42 x h.x|^2)/(2 A^2): 2/omega of the stiffness form,
  !> omega^2 = Q_h c^2 (B.B) gamma.gamma/(A A0); 2/rate of the viscous one, whose force is that of
  !> v(n-1/2), rate = Q_h c sqrt(A) gamma.gamma/A0; of assumed strain, with E/(1 - nu^2) <= rho c^2
  !> and the spread S, omega^2 = QM c^2 S gamma.gamma/(6 A A0). A triangle has no hourglass.
  pure function hourglass_steps(hourglass, sound_speed, nodes, chunk) result(steps)
    type(hourglass_t), intent(in) :: hourglass
    real(wp), intent(in) :: sound_speed
    integer, intent(in) :: nodes(4, chunk_size)  !! a triangle repeats its third
    type(element_chunk_t), intent(in) :: chunk
    real(wp) :: steps(chunk_size)                !! s
    real(wp) :: pattern(chunk_size), inverse(chunk_size)
    integer :: i

    do i = 1, chunk_size
      inverse(i) = abs(chunk%inverse_area(i))
      pattern(i) = 4.0_wp + 0.5_wp*inverse(i)**2 &
        *((chunk%x31(i)*chunk%hy(i) - chunk%y31(i)*chunk%hx(i))**2 &
        + (chunk%x42(i)*chunk%hy(i) - chunk%y42(i)*chunk%hx(i))**2)
      pattern(i) = pattern(i)*abs(1.0_wp + chunk%stretch(i))
      if (nodes(4, i) == nodes(3, i)) pattern(i) = 0.0_wp
    end do
    if (hourglass%form == hourglass_viscous) then
      steps = 2.0_wp/max(hourglass%coefficient*sound_speed*(pattern*sqrt(inverse)), tiny(1.0_wp))
      return
    end if
    if (hourglass%form == hourglass_assumed) then
      pattern = pattern*inverse**2*largest_spread(chunk%x31, chunk%y31, chunk%x42, chunk%y42)/6.0_wp
    else
      pattern = 0.5_wp*pattern*inverse**2 &
        *(chunk%x31**2 + chunk%y31**2 + chunk%x42**2 + chunk%y42**2)
    end if
    steps = 2.0_wp/(sound_speed*sqrt(max(hourglass%coefficient*pattern, tiny(1.0_wp))))
  end function hourglass_steps

end module hourglass_m
