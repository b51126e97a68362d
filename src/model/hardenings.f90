! SPDX-License-Identifier: MIT
!> Piecewise linear yield stress against plastic strain, and its dependence on the strain rate.
module hardenings_m
  use kinds_m, only : wp, long
  use curves_m, only : curve_t
  use sorting_m, only : sorted_order
  use visitor_m, only : visited_t, visitor_t, absent
  implicit none
  private
  public :: hardening_t, make_hardening, depends_on_rate

  !> Hardening of one material: a row of points for each strain rate, all at the same plastic
  !> strains. The yield stress is linear between points and between rates, and constant outside the
  !> range of rates.
  type, extends(visited_t) :: hardening_t
    real(wp), allocatable :: strain(:)     !! (n) plastic strain of the points, increasing, the
                                           !! first 0
    real(wp), allocatable :: stress(:, :)  !! (n, n_rate) yield stress at the points
    real(wp), allocatable :: slope(:, :)   !! (n, n_rate) after each point
    real(wp), allocatable :: rate(:)       !! (n_rate) increasing, 1/s; one row: at any rate
    real(wp) :: rate_constant = 0.0_wp     !! C of Cowper and Symonds, 1/s, 0 = none
    real(wp) :: rate_exponent = 1.0_wp     !! 1/P
    type(curve_t), allocatable :: rate_factor !! factor on the yield stress against the strain rate
  contains
    procedure :: visit => visit_hardening
  end type hardening_t

contains

  !> Hardening from curves of yield stress against plastic strain that start at 0. A curve is
  !> extrapolated by its last slope if that is positive, else by its last value; all rows have the
  !> points of all curves.
  pure function make_hardening(curves, rates) result(hardening)
    type(curve_t), intent(in) :: curves(:) !! one for each rate
    real(wp), intent(in) :: rates(:)       !! increasing
    type(hardening_t) :: hardening
    real(wp), allocatable :: strains(:)
    integer :: i, n

    hardening%rate = rates
    strains = [(curves(i)%abscissa, i=1, size(curves))]
    ! Bits of non-negative numbers sort like the numbers.
    strains = strains(sorted_order(transfer(strains, [0_long])))
    hardening%strain = pack(strains, [(i == 1 .or. strains(i) > strains(max(i - 1, 1)), i=1, &
      size(strains))])
    n = size(hardening%strain)
    allocate (hardening%stress(n, size(curves)), hardening%slope(n, size(curves)))
    do i = 1, size(curves)
      call fill_row(curves(i), hardening%strain, hardening%stress(:, i), hardening%slope(:, i))
    end do
  end function make_hardening

  !> Values and slopes of one curve at points that include its own.
  pure subroutine fill_row(curve, strain, stress, slope)
    type(curve_t), intent(in) :: curve
    real(wp), intent(in) :: strain(:)
    real(wp), intent(out) :: stress(:), slope(:)
    integer :: i, k, n

    n = size(curve%abscissa)
    k = 1 ! a curve with errors may begin beyond the first value
    do i = 1, size(strain)
      if (k < n) then
        if (strain(i) >= curve%abscissa(k + 1)) k = k + 1
      end if
      if (k < n) then
        slope(i) = (curve%ordinate(k + 1) - curve%ordinate(k)) &
          /(curve%abscissa(k + 1) - curve%abscissa(k))
      else if (n > 1) then
        slope(i) = max(0.0_wp, (curve%ordinate(n) - curve%ordinate(n - 1)) &
          /(curve%abscissa(n) - curve%abscissa(n - 1)))
      else
        slope(i) = 0.0_wp
      end if
      stress(i) = curve%ordinate(k) + slope(i)*(strain(i) - curve%abscissa(k))
    end do
  end subroutine fill_row

  !> Whether the yield stress depends on the strain rate.
  pure function depends_on_rate(hardening) result(yes)
    type(hardening_t), intent(in) :: hardening
    logical :: yes

    yes = size(hardening%rate) > 1 .or. hardening%rate_constant > 0.0_wp &
      .or. allocated(hardening%rate_factor)
  end function depends_on_rate

  !> Visit the components of a hardening.
  subroutine visit_hardening(self, visitor)
    class(hardening_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('strain', self%strain)
    call visitor%visit('stress', self%stress)
    call visitor%visit('slope', self%slope)
    call visitor%visit('rate', self%rate)
    call visitor%visit('rate_constant', self%rate_constant)
    call visitor%visit('rate_exponent', self%rate_exponent)
    if (visitor%makes(merge(1, absent, allocated(self%rate_factor)))) allocate (self%rate_factor)
    if (allocated(self%rate_factor)) call visitor%part('rate_factor', self%rate_factor)
  end subroutine visit_hardening

end module hardenings_m
