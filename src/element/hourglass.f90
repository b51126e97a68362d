! SPDX-License-Identifier: MIT
!> Flanagan-Belytschko hourglass control of the one-point quad (Flanagan &
!> Belytschko 1981), from the hourglass velocity gamma.v.
module hourglass_m
  use kinds_m, only : wp
  use assumed_strain_m, only : largest_spread
  use layout_m, only : chunk_size
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t
  use material_dispatch_m, only : find_failed
  use parts_m, only : hourglass_t, material_t, hourglass_viscous, hourglass_assumed
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: resist_viscously, resist_elastically, hourglass_steps, harmless_coefficient, &
    stop_failed, drop_failed, note_works

  !> Coefficient up to which hourglass control never asks for less than L/c in a convex quad of its
  !> initial area (doc/theory/elements.md).
  real(wp), parameter :: harmless_coefficient = 0.25_wp

contains

  !> Viscous form: q = (Q_h rho c sqrt(A)/4) gamma.v. Its work is that of the mean of it and of the
  !> force of the step before: a force acts over half of the step that it was formed from and half
  !> of the next.
  pure subroutine resist_viscously(factor, dt, last_x, last_y, chunk, work)
    real(wp), intent(in) :: factor                !! Q_h rho c/4
    real(wp), intent(in) :: dt
    real(wp), intent(inout), dimension(chunk_size) :: last_x, last_y !! q of the step before; then
                                                  !! the present one
    type(element_chunk_t), intent(inout) :: chunk !! q_x, q_y and their work out
    real(wp), intent(out) :: work                 !! of all of them in the step
    real(wp) :: viscosity
    integer :: i

    work = 0.0_wp
    !$omp simd private(viscosity) reduction(+ : work)
    do i = 1, chunk_size
      viscosity = factor*sqrt(abs(chunk%area(i)))
      chunk%qx(i) = viscosity*chunk%gx(i)
      chunk%qy(i) = viscosity*chunk%gy(i)
      chunk%hourglass_work(i) = 0.5_wp*dt*((last_x(i) + chunk%qx(i))*chunk%gx(i) &
        + (last_y(i) + chunk%qy(i))*chunk%gy(i))
      last_x(i) = chunk%qx(i)
      last_y(i) = chunk%qy(i)
      work = work + chunk%hourglass_work(i)
    end do
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
    type(element_chunk_t), intent(inout) :: chunk   !! q_x, q_y and their work out
    real(wp), intent(out) :: work                   !! of all of them in the step
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
      chunk%hourglass_work(i) = 0.5_wp*stiffness*((strain_x(i) + old_x)*growth_x &
        + (strain_y(i) + old_y)*growth_y)
      work = work + chunk%hourglass_work(i)
    end do
  end subroutine resist_elastically

  !> No hourglass velocity of elements that have failed and whose force is gone: before hourglass
  !> control is formed. In the step in which an element fails the force before it still does work.
  pure subroutine stop_failed(i_chunk, material, elements, chunk)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(block_state_t), intent(in) :: elements
    type(element_chunk_t), intent(inout) :: chunk !! gamma.v
    logical :: failed(chunk_size)

    if (.not. has_failed(i_chunk, elements)) return
    call find_elements(i_chunk, material, elements, failed)
    associate (x => elements%hourglass_start(i_chunk), y => elements%hourglass_start(i_chunk) &
      + chunk_size, memory => elements%hourglass_strain)
      where (failed .and. .not. abs(memory(x:x + chunk_size - 1)) &
        + abs(memory(y:y + chunk_size - 1)) > 0.0_wp)
        chunk%gx = 0.0_wp
        chunk%gy = 0.0_wp
      end where
    end associate
  end subroutine stop_failed

  !> Elements that have failed have no hourglass force, nor a memory of it; at the end of the step
  !> in which they fail it does no work.
  pure subroutine drop_failed(i_chunk, material, dt, elements, chunk, work)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk
    real(wp), intent(inout) :: work               !! of all hourglass forces in the step
    logical :: failed(chunk_size)
    integer :: i, first

    if (.not. has_failed(i_chunk, elements)) return
    call find_elements(i_chunk, material, elements, failed)
    do i = 1, chunk_size
      if (.not. failed(i)) cycle
      chunk%hourglass_work(i) = chunk%hourglass_work(i) - 0.5_wp*dt*(chunk%qx(i)*chunk%gx(i) &
        + chunk%qy(i)*chunk%gy(i))
      chunk%qx(i) = 0.0_wp
      chunk%qy(i) = 0.0_wp
      first = elements%hourglass_start(i_chunk) + i - 1
      elements%hourglass_strain([first, first + chunk_size]) = 0.0_wp
    end do
    work = sum(chunk%hourglass_work)
  end subroutine drop_failed

  !> Works element by element, where these may leave.
  pure subroutine note_works(i_chunk, elements, chunk)
    integer, intent(in) :: i_chunk
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(in) :: chunk
    integer :: first

    first = (i_chunk - 1)*chunk_size + 1
    associate (works => elements%erosion%hourglass(first:first + chunk_size - 1))
      works = works + chunk%hourglass_work
    end associate
  end subroutine note_works

  !> Whether some element of a chunk has failed in this step or before.
  pure logical function has_failed(i_chunk, elements)
    integer, intent(in) :: i_chunk
    type(block_state_t), intent(in) :: elements

    has_failed = .false.
    if (allocated(elements%n_failed)) has_failed = elements%n_failed(i_chunk) > 0
  end function has_failed

  !> Which elements of a chunk have failed.
  pure subroutine find_elements(i_chunk, material, elements, failed)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(block_state_t), intent(in) :: elements
    logical, intent(out) :: failed(chunk_size)
    logical :: ignored

    call find_failed(material, elements%history(elements%history_start(i_chunk)), failed, ignored)
  end subroutine find_elements

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
