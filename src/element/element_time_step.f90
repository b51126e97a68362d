! SPDX-License-Identifier: MIT
!> Stable step of a chunk: L/c with L = area over the longest side or diagonal (ISDO of
!> *CONTROL_TIMESTEP), and L/(Q + sqrt(Q^2 + c^2)), Q = Q2 c + Q1 L |t|, in compression under
!> bulk viscosity; never above the step that hourglass control allows
!> (doc/theory/elements.md, "Stable step").
module element_time_step_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use controls_m, only : length_by_diagonal
  use element_chunk_m, only : element_chunk_t
  use hourglass_m, only : hourglass_steps, harmless_coefficient
  use parts_m, only : hourglass_t
  implicit none
  private
  public :: stable_step, single_steps

contains

  !> Smallest stable step of the chunk, and its smallest volume ratio.
  pure subroutine stable_step(length_rule, sound_speed, hourglass, nodes, chunk, limit, volume)
    integer, intent(in) :: length_rule
    real(wp), intent(in) :: sound_speed
    type(hourglass_t), intent(in) :: hourglass  !! bulk viscosity too
    integer, intent(in) :: nodes(4, chunk_size) !! a triangle repeats its third
    type(element_chunk_t), intent(in) :: chunk
    real(wp), intent(out) :: limit             !! s
    real(wp), intent(out) :: volume            !! smallest A/A0
    real(wp) :: squared(chunk_size), largest
    integer :: i

    if (length_rule == length_by_diagonal) then
      call longest_diagonals(chunk, squared)
    else
      call longest_sides(chunk, squared)
    end if
    largest = 0.0_wp
    volume = huge(1.0_wp)
    !$omp simd reduction(max : largest) reduction(min : volume)
    do i = 1, chunk_size
      squared(i) = squared(i)*(chunk%inverse_area(i)*chunk%inverse_area(i))
      largest = max(largest, squared(i))
      volume = min(volume, 1.0_wp + chunk%stretch(i))
    end do
    limit = 1.0_wp/(sound_speed*sqrt(largest))
    if (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp) &
      limit = minval(viscous_limit(1.0_wp/sqrt(squared), sound_speed, hourglass%quadratic, &
      hourglass%linear, chunk%trace))
    if (hourglass%coefficient > harmless_coefficient) &
      limit = min(limit, minval(hourglass_steps(hourglass, sound_speed, nodes, chunk)))
  end subroutine stable_step

  !> The steps of the elements, each by the same rule.
  pure subroutine single_steps(length_rule, sound_speed, hourglass, nodes, chunk, single)
    integer, intent(in) :: length_rule
    real(wp), intent(in) :: sound_speed
    type(hourglass_t), intent(in) :: hourglass
    integer, intent(in) :: nodes(4, chunk_size)
    type(element_chunk_t), intent(in) :: chunk
    real(wp), intent(out) :: single(chunk_size) !! s
    real(wp) :: squared(chunk_size)

    if (length_rule == length_by_diagonal) then
      call longest_diagonals(chunk, squared)
    else
      call longest_sides(chunk, squared)
    end if
    squared = squared*(chunk%inverse_area*chunk%inverse_area)
    single = 1.0_wp/(sound_speed*sqrt(squared))
    if (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp) single = &
      viscous_limit(1.0_wp/sqrt(squared), sound_speed, hourglass%quadratic, hourglass%linear, &
      chunk%trace)
    if (hourglass%coefficient > harmless_coefficient) &
      single = min(single, hourglass_steps(hourglass, sound_speed, nodes, chunk))
  end subroutine single_steps

  !> Step of one element under bulk viscosity.
  pure elemental function viscous_limit(length, sound_speed, quadratic, linear, trace) result(limit)
    real(wp), intent(in) :: length, sound_speed, quadratic, linear, trace
    real(wp) :: limit
    real(wp) :: q

    q = 0.0_wp
    if (trace < 0.0_wp) q = linear*sound_speed - quadratic*length*trace
    limit = length/(q + sqrt(q*q + sound_speed*sound_speed))
  end function viscous_limit

  !> Square of the longest side: with d = d31 -+ d42, opposite sides are (d +- h)/2.
  pure subroutine longest_sides(chunk, squared)
    type(element_chunk_t), intent(in) :: chunk
    real(wp), intent(out) :: squared(chunk_size)
    real(wp) :: ax, ay, bx, by, hx, hy
    integer :: i

    !$omp simd private(ax, ay, bx, by, hx, hy)
    do i = 1, chunk_size
      ax = 0.5_wp*(chunk%x31(i) - chunk%x42(i))
      ay = 0.5_wp*(chunk%y31(i) - chunk%y42(i))
      bx = 0.5_wp*(chunk%x31(i) + chunk%x42(i))
      by = 0.5_wp*(chunk%y31(i) + chunk%y42(i))
      hx = 0.5_wp*chunk%hx(i)
      hy = 0.5_wp*chunk%hy(i)
      ! |a +- h|^2 is largest with the sign of a.h.
      squared(i) = hx*hx + hy*hy + max(ax*ax + ay*ay + 2.0_wp*abs(ax*hx + ay*hy), &
        bx*bx + by*by + 2.0_wp*abs(bx*hx + by*hy))
    end do
  end subroutine longest_sides

  !> Square of the longer diagonal.
  pure subroutine longest_diagonals(chunk, squared)
    type(element_chunk_t), intent(in) :: chunk
    real(wp), intent(out) :: squared(chunk_size)
    integer :: i

    !$omp simd
    do i = 1, chunk_size
      squared(i) = max(chunk%x31(i)**2 + chunk%y31(i)**2, chunk%x42(i)**2 + chunk%y42(i)**2)
    end do
  end subroutine longest_diagonals

end module element_time_step_m
