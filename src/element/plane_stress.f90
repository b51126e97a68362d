! SPDX-License-Identifier: MIT
!> Plane stress: any law under the condition sigma_zz = 0. A law sees the strain of the thickness as
!> it sees the hoop strain of axisymmetric bodies; its increment in the step is found by secants,
!> for all points of a chunk at a time (doc/theory/elements.md, "Plane stress"). The thickness of
!> points stands behind the values of the law in the stream of equations of state.
module plane_stress_m
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use material_dispatch_m, only : history_size, update_stress
  use parts_m, only : material_t, may_fail
  use stress_chunk_m, only : stress_chunk_t
  use volumetric_m, only : log_ratio
  implicit none
  private
  public :: n_law_value, thinning_start, update_sheet, form_membrane_stress

  !> Values of each element with a law that gives the pressure: energy, pressure, V/V0 - 1 (in plane
  !> stress A/A0 - 1), bulk viscosity, bulk and shear modulus; in plane stress t/t0 - 1 of each
  !> point follows.
  integer, parameter :: n_law_value = 6

  integer, parameter :: most_iterations = 60
  !> Largest sigma_zz, as a share of the stresses it is the difference of.
  real(wp), parameter :: tolerance = 1.0e-12_wp
  !> Share after the last iteration above which no thickness is without stress across it.
  real(wp), parameter :: largest_miss = 1.0e-9_wp
  !> Bounds of the strain increment of the thickness, and of its change in an iteration.
  real(wp), parameter :: most_strain = 1.9_wp, most_change = 0.5_wp

  !> State of the search for the strain increments.
  type :: search_t
    real(wp), dimension(chunk_size) :: strain, last_strain !! estimates, of this iteration and the
                                                           !! last
    real(wp), dimension(chunk_size) :: residual            !! sigma_zz in the last iteration
    real(wp), dimension(chunk_size) :: slope               !! its derivative
    real(wp), dimension(chunk_size) :: dilation            !! ln(A/A0)
    logical, dimension(chunk_size) :: is_open
  end type search_t

contains

  !> Where t/t0 - 1 of point `k` of a chunk starts among the values of equations of state.
  pure function thinning_start(elements, i_chunk, k) result(first)
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: i_chunk, k
    integer :: first

    first = elements%eos_start(i_chunk) + chunk_size*(n_law_value + k - 1)
  end function thinning_start

  !> Update the stress of point `k`, or of the one point, and its thickness.
  pure subroutine update_sheet(i_chunk, k, material, point, elements, stress)
    integer, intent(in) :: i_chunk, k
    type(material_t), intent(in) :: material
    type(element_chunk_t), intent(in) :: point
    type(block_state_t), intent(inout) :: elements
    type(stress_chunk_t), intent(inout) :: stress !! increments of the plane and rotated old
                                                  !! deviator in; new deviator, mean stress and work
                                                  !! out, t/t0 - 1 in `hzz`
    type(stress_chunk_t) :: start
    type(search_t) :: search
    real(wp) :: before(chunk_size*history_size(material)), old(chunk_size), stiffness
    integer :: first, last, place, iteration

    place = thinning_start(elements, i_chunk, k)
    first = elements%history_start(i_chunk) + (k - 1)*size(before)
    last = first + size(before) - 1
    before = elements%history(first:last)
    old = elements%eos_state(place:place + chunk_size - 1)
    stress%mean = stress%sxx + stress%syy
    start = stress
    stress%has_hoop = .true.
    stress%bulk = material%bulk
    stress%shear = material%shear
    stiffness = material%bulk + 4.0_wp*material%shear/3.0_wp
    search%strain = -((stiffness - 2.0_wp*material%shear)/stiffness)*(stress%dxx + stress%dyy)
    search%slope = stiffness
    search%dilation = log_ratio(point%stretch)
    if (allocated(elements%start_dilatation)) search%dilation = search%dilation &
      + elements%start_dilatation((i_chunk - 1)*chunk_size + 1:i_chunk*chunk_size, k)
    search%is_open = .true.
    do iteration = 1, most_iterations
      call set_strain(search%strain, point%stretch, old, start, stress)
      if (size(before) > 0) then
        elements%history(first:last) = before
        call update_stress(material, stress, elements%history(first))
      else
        call update_stress(material, stress)
      end if
      call update_strain(material, iteration, stress, search)
      if (.not. any(search%is_open)) exit
    end do
    ! The run stops where no strain of the thickness was found (health, implicit_forces).
    where (search%is_open) stress%hzz = -1.0_wp
    elements%eos_state(place:place + chunk_size - 1) = stress%hzz
    call finish_work(material%follows_strain, old, start, stress)
  end subroutine update_sheet

  !> Set what a law gets of an estimate of the strain increment of the thickness.
  pure subroutine set_strain(strain, stretch, old, start, stress)
    real(wp), intent(in), dimension(chunk_size) :: strain
    real(wp), intent(in), dimension(chunk_size) :: stretch !! A/A0 - 1
    real(wp), intent(in), dimension(chunk_size) :: old     !! t/t0 - 1 at the start of the step
    type(stress_chunk_t), intent(in) :: start
    type(stress_chunk_t), intent(inout) :: stress
    integer :: i

    !$omp simd
    do i = 1, chunk_size
      stress%hoop(i) = strain(i)
      stress%dxx(i) = start%dxx(i) - strain(i)
      stress%dyy(i) = start%dyy(i) - strain(i)
      stress%sxx(i) = start%sxx(i)
      stress%syy(i) = start%syy(i)
      stress%sxy(i) = start%sxy(i)
      ! In the middle of the step the strain increment is (t1 - t0)/((t0 + t1)/2).
      stress%hzz(i) = old(i) + (1.0_wp + old(i))*2.0_wp*strain(i)/(2.0_wp - strain(i))
      stress%stretch(i) = stretch(i) + (1.0_wp + stretch(i))*stress%hzz(i)
      stress%volume(i) = 1.0_wp + stress%stretch(i)
      stress%mean(i) = start%mean(i)
      stress%ratio(i) = (1.0_wp + stretch(i))*(1.0_wp + 0.5_wp*(old(i) + stress%hzz(i)))
    end do
  end subroutine set_strain

  !> Find sigma_zz and the next estimate; points whose law has failed carry nothing.
  pure subroutine update_strain(material, iteration, stress, search)
    type(material_t), intent(in) :: material
    integer, intent(in) :: iteration
    type(stress_chunk_t), intent(in) :: stress
    type(search_t), intent(inout) :: search
    real(wp) :: stiffness, growth, mean, residual, change
    logical :: breaks
    integer :: i

    stiffness = material%bulk + 4.0_wp*material%shear/3.0_wp
    breaks = may_fail(material)
    do i = 1, chunk_size
      if (.not. search%is_open(i)) cycle
      growth = log_ratio(stress%hzz(i))
      mean = material%bulk*(search%dilation(i) + growth)
      if (allocated(material%rubber)) mean = stress%mean(i)
      residual = mean - (stress%sxx(i) + stress%syy(i))
      if (iteration > 1) then
        change = search%strain(i) - search%last_strain(i)
        if (abs(change) > 0.0_wp) search%slope(i) = max(0.1_wp*stiffness, &
          (residual - search%residual(i))/change)
      end if
      search%is_open(i) = abs(residual) > merge(tolerance, largest_miss, &
        iteration < most_iterations)*(material%bulk*(abs(search%dilation(i)) &
        + abs(growth)) + abs(stress%sxx(i)) + abs(stress%syy(i)))
      if (breaks) search%is_open(i) = search%is_open(i) .and. abs(stress%sxx(i)) &
        + abs(stress%syy(i)) + abs(stress%sxy(i)) > 0.0_wp
      if (.not. search%is_open(i)) cycle
      search%last_strain(i) = search%strain(i)
      search%residual(i) = residual
      change = max(-most_change, min(most_change, -residual/search%slope(i)))
      search%strain(i) = max(-most_strain, min(most_strain, search%strain(i) + change))
    end do
  end subroutine update_strain

  !> Mean stress, which is (sigma_xx + sigma_yy)/3, and the work of the stress in the plane, per
  !> area and thickness of time zero.
  pure subroutine finish_work(follows_strain, old, start, stress)
    logical, intent(in) :: follows_strain
    real(wp), intent(in) :: old(chunk_size)
    type(stress_chunk_t), intent(in) :: start
    type(stress_chunk_t), intent(inout) :: stress
    integer :: i

    !$omp simd
    do i = 1, chunk_size
      stress%mean(i) = stress%sxx(i) + stress%syy(i)
      stress%work(i) = (start%sxy(i) + stress%sxy(i))*start%dxy(i) + 0.5_wp*( &
        ((start%sxx(i) + stress%sxx(i)) + (start%mean(i) + stress%mean(i)))*start%dxx(i) &
        + ((start%syy(i) + stress%syy(i)) + (start%mean(i) + stress%mean(i)))*start%dyy(i))
    end do
    if (follows_strain) stress%work = stress%work*(1.0_wp + 0.5_wp*(old + stress%hzz))
  end subroutine finish_work

  !> The stress of the plane in place of its deviator, times t/t0 where forces follow the thickness.
  pure subroutine form_membrane_stress(follows_strain, stress)
    logical, intent(in) :: follows_strain
    type(stress_chunk_t), intent(inout) :: stress
    real(wp) :: factor
    integer :: i

    !$omp simd private(factor)
    do i = 1, chunk_size
      factor = merge(1.0_wp + stress%hzz(i), 1.0_wp, follows_strain)
      stress%sxx(i) = factor*(stress%sxx(i) + stress%mean(i))
      stress%syy(i) = factor*(stress%syy(i) + stress%mean(i))
      stress%sxy(i) = factor*stress%sxy(i)
    end do
  end subroutine form_membrane_stress

end module plane_stress_m
