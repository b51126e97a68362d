! SPDX-License-Identifier: MIT
!> Hardening of materials, crushable foams: curves and tables put together and checked.
module deck_resolve_hardenings_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use curves_m, only : curve_t
  use hardenings_m, only : hardening_t, make_hardening, depends_on_rate
  use model_m, only : model_t
  use deck_cards_m, only : reject_field
  use deck_ids_m, only : index_of
  use deck_ids_m, only : a_curve, a_table
  use deck_lines_m, only : deck_t, place_t, line_error, line_warning
  use deck_maps_m, only : resolve_id
  use deck_raw_m, only : raw_t, raw_hardening_t, raw_table_t
  implicit none
  private
  public :: resolve_hardenings, check_no_rates, resolve_foams

contains

  !> Give every material of piecewise linear hardening its points.
  subroutine resolve_hardenings(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model
    integer, allocatable :: curves(:, :)
    integer :: i, j, k

    do i = 1, size(raw%tables)
      if (index_of(deck%maps(a_curve), raw%tables(i)%id) > 0) call reject_field(deck, &
        place_t(raw%tables(i)%line, 1, 'TBID'), 'is the number of a curve too')
    end do
    allocate (curves(2, size(raw%tables)))
    do i = 1, size(raw%tables)
      call find_table_curves(deck, raw, raw%tables(i), curves(:, i))
    end do
    do i = 1, size(raw%hardenings)
      associate (entry => raw%hardenings(i))
        if (entry%curve == 0) then
          if (allocated(entry%points%abscissa)) call take_curves(deck, raw, entry, [integer ::], &
            [0.0_wp], model)
        else if (index_of(deck%maps(a_table), entry%curve) > 0) then
          k = index_of(deck%maps(a_table), entry%curve)
          if (curves(2, k) >= curves(1, k)) call take_curves(deck, raw, entry, &
            [(j, j=curves(1, k), curves(2, k))], raw%tables(k)%values, model)
        else if (index_of(deck%maps(a_curve), entry%curve) > 0 .or. .not. deck%maps(a_table)%incomplete) then
          call resolve_id(deck, a_curve, entry%curve, entry%curve_place, k, ' (nor a table)')
          if (k > 0) call take_curves(deck, raw, entry, [k], [0.0_wp], model)
        end if
        call take_rates(deck, entry, model)
      end associate
    end do
  end subroutine resolve_hardenings

  !> First and last curve of a table: those of the blocks that come next, one for each value. The
  !> last lies before the first where there are not enough.
  subroutine find_table_curves(deck, raw, table, curves)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(raw_table_t), intent(in) :: table
    integer, intent(out) :: curves(2)
    integer :: i, k, n

    n = 0
    k = 0
    curves = [1, 0]
    do i = table%block + 1, deck%n_block
      if (n == size(table%values)) exit
      if (deck%blocks(i)%dropped) cycle
      if (deck%blocks(i)%name /= 'DEFINE_CURVE') exit
      n = n + 1
      k = curve_of_block(deck, raw, i)
      if (k == 0) return ! its own mistake has been reported
      if (n == 1) curves(1) = k
    end do
    if (n == size(table%values)) then
      if (n > 0) curves(2) = k
    else if (.not. deck%maps(a_curve)%lost) then
      call line_error(deck, table%line, 'table '//to_text(table%id)//' has ' &
        //to_text(size(table%values))//' values but '//to_text(n) &
        //' *DEFINE_CURVE right behind it: it takes one for each value, in that order')
    end if
  end subroutine find_table_curves

  !> The curve that a block defines, 0 when it was refused.
  pure function curve_of_block(deck, raw, i_block) result(k)
    type(deck_t), intent(in) :: deck
    type(raw_t), intent(in) :: raw
    integer, intent(in) :: i_block
    integer :: k

    do k = size(raw%curve_line), 1, -1
      if (raw%curve_line(k) >= deck%blocks(i_block)%keyword .and. &
        raw%curve_line(k) <= deck%blocks(i_block)%last) return
    end do
    k = 0
  end function curve_of_block

  !> Rows of points from curves, or from the card where there are none.
  subroutine take_curves(deck, raw, entry, curves, rates, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(raw_hardening_t), intent(in) :: entry
    integer, intent(in) :: curves(:) !! one behind the other
    real(wp), intent(in) :: rates(:)
    type(model_t), intent(inout) :: model
    type(curve_t) :: points(1)
    integer :: i, n_before

    n_before = deck%report%n_error
    if (rates(1) < 0.0_wp) call reject_field(deck, entry%curve_place, 'is a table with negative ' &
      //'values, logarithms of strain rates, which this version does not have')
    model%curves(curves)%is_of_time = .false.
    do i = 1, size(curves)
      call check_curve(deck, raw, model%curves(curves(i)), raw%curve_line(curves(i)))
    end do
    if (deck%report%n_error > n_before) return
    associate (material => model%materials(entry%material))
      if (size(curves) > 0) then
        material%curve = make_hardening(model%curves(curves(1):curves(size(curves))), rates)
      else
        points(1) = entry%points
        material%curve = make_hardening(points, rates)
        if (size(entry%points%abscissa) == 1) material%curve%slope = entry%modulus
      end if
      material%yield = material%curve%stress(1, 1)
      material%hardening = material%curve%slope(1, 1)
      if (minval(material%curve%slope) <= -3.0_wp*material%shear) call line_error(deck, &
        raw%material_line(entry%material), 'the yield stress of material '//to_text(material%id) &
        //' falls faster than 3G: no stress would be in balance')
    end associate
  end subroutine take_curves

  !> Whether a curve can be a yield stress.
  subroutine check_curve(deck, raw, curve, line)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(curve_t), intent(in) :: curve
    integer, intent(in) :: line
    character(:), allocatable :: name

    name = 'curve '//to_text(curve%id)//' is a yield stress against plastic strain (LCSS) and must '
    if (deck%maps(a_curve)%lost) return
    if (abs(curve%abscissa(1)) > 0.0_wp) call line_error(deck, line, name &
      //'start at plastic strain 0, not '//to_text(curve%abscissa(1)))
    if (.not. minval(curve%ordinate) > 0.0_wp) call line_error(deck, line, name &
      //'be above 0 everywhere')
  end subroutine check_curve

  !> Rate effect: a table comes before LCSR, LCSR before C and P.
  subroutine take_rates(deck, entry, model)
    type(deck_t), intent(inout) :: deck
    type(raw_hardening_t), intent(in) :: entry
    type(model_t), intent(inout) :: model
    integer :: k

    k = 0
    if (entry%rate_curve > 0) call resolve_id(deck, a_curve, entry%rate_curve, &
      entry%rate_curve_place, k)
    associate (material => model%materials(entry%material), line => entry%curve_place%line)
      if (.not. allocated(material%curve)) return
      if (size(material%curve%rate) > 1) then
        if (entry%rate_curve > 0 .or. entry%rate_constant > 0.0_wp) call line_warning(deck, line, &
          'rates of a table', 'a table (LCSS) gives the rate effect: LCSR, C and P have none')
      else if (k > 0) then
        model%curves(k)%is_of_time = .false.
        if (.not. minval(model%curves(k)%ordinate) > 0.0_wp) call reject_field(deck, &
          entry%rate_curve_place, 'is a curve that is not above 0 everywhere: it is a ' &
          //'factor on the yield stress')
        if (entry%rate_constant > 0.0_wp) call line_warning(deck, line, 'rates of a curve', &
          'LCSR gives the rate effect: C and P have none')
        material%curve%rate_factor = model%curves(k)
      else if (entry%rate_constant > 0.0_wp .and. entry%rate_curve == 0) then
        material%curve%rate_constant = entry%rate_constant
        material%curve%rate_exponent = 1.0_wp/entry%rate_power
      end if
      call check_rates(deck, entry, material%curve)
    end associate
  end subroutine take_rates

  !> What goes together with a rate effect.
  subroutine check_rates(deck, entry, hardening)
    type(deck_t), intent(inout) :: deck
    type(raw_hardening_t), intent(in) :: entry
    type(hardening_t), intent(in) :: hardening

    if (.not. depends_on_rate(hardening)) then
      if (entry%is_viscoplastic) call line_warning(deck, entry%form_place%line, &
        'form of no rates', 'VP has no effect: the material has no rate effect')
      return
    end if
    if (entry%is_viscoplastic) call reject_field(deck, entry%form_place, &
      'asks for the viscoplastic rate form, which this version does not have; 0 scales the ' &
      //'yield stress with the total strain rate')
    if (minval(hardening%slope) < 0.0_wp) call reject_field(deck, entry%rate_place, &
      'begins a card with a rate effect, but the yield stress falls somewhere: both together ' &
      //'are not part of this law')
  end subroutine check_rates

  !> The implicit method has steps, but in statics no rates.
  subroutine check_no_rates(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    integer :: i

    do i = 1, size(model%materials)
      if (.not. allocated(model%materials(i)%curve)) cycle
      if (depends_on_rate(model%materials(i)%curve)) call line_error(deck, raw%material_line(i), &
        'material '//to_text(model%materials(i)%id)//' has a yield stress that depends on the ' &
        //'strain rate (C, LCSR or a table), which the implicit method does not have')
    end do
  end subroutine check_no_rates

  !> Give every foam its curve, which must not fall.
  subroutine resolve_foams(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model
    character(:), allocatable :: name
    integer :: i, k

    do i = 1, size(raw%foams)
      call resolve_id(deck, a_curve, raw%foams(i)%curve, raw%foams(i)%place, k)
      if (k == 0) cycle
      associate (curve => model%curves(k))
        curve%is_of_time = .false.
        model%materials(raw%foams(i)%material)%crush = curve
        if (deck%maps(a_curve)%lost) cycle
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

end module deck_resolve_hardenings_m
