! SPDX-License-Identifier: MIT
!> Curves of crushable foams.
module deck_resolve_foams_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use deck_cards_m, only : reject_field
  use deck_lines_m, only : deck_t, line_error
  use deck_maps_m, only : maps_t, resolve_id
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: resolve_foams

contains

  !> Give every foam its curve, which must not fall.
  subroutine resolve_foams(deck, raw, maps, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    character(:), allocatable :: name
    integer :: i, k

    do i = 1, size(raw%foams)
      call resolve_id(deck, maps%curves, raw%foams(i)%curve, 'curve', raw%foams(i)%place, k)
      if (k == 0) cycle
      associate (curve => model%curves(k))
        curve%is_of_time = .false.
        model%materials(raw%foams(i)%material)%crush = curve
        if (raw%lost%curves) cycle
        name = 'curve '//to_text(curve%id)//' is a yield stress against volumetric strain (LCID)'
        if (.not. minval(curve%ordinate) >= 0.0_wp .or. .not. maxval(curve%ordinate) > 0.0_wp) then
          call line_error(deck, raw%curve_line(k), name &
            //' and must not be negative, nor 0 everywhere')
        else if (any(curve%ordinate(2:) < curve%ordinate(:size(curve%ordinate) - 1))) then
          call line_error(deck, raw%curve_line(k), name &
            //', which must not fall: foams harden as they are crushed')
        end if
        if (curve%abscissa(1) < 0.0_wp) call reject_field(deck, raw%foams(i)%place, &
          'is a curve that starts at the volumetric strain '//to_text(curve%abscissa(1)) &
          //', which is below 0: 1 - V/V0 counts compression')
      end associate
    end do
  end subroutine resolve_foams

end module deck_resolve_foams_m
