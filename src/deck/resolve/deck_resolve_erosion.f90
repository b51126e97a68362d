! SPDX-License-Identifier: MIT
!> Which materials may leave the mesh, and what a run that may lose elements does not have.
module deck_resolve_erosion_m
  use contacts_m, only : is_tied
  use erosion_m, only : erosion_t
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use parts_m, only : material_t, law_elastic, law_plastic, law_piecewise, law_johnson_cook, &
    law_hot_johnson_cook, law_null, hourglass_assumed
  use deck_cards_m, only : reject_field
  use deck_ids_m, only : a_material
  use deck_lines_m, only : deck_t, line_error, line_warning
  use deck_maps_m, only : resolve_id
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: resolve_erosion, check_erosion_points, check_eroding_contacts

  !> Laws whose pressure can be lost.
  integer, parameter :: can_go(6) = [law_elastic, law_plastic, law_piecewise, law_johnson_cook, &
    law_hot_johnson_cook, law_null]

contains

  !> Give materials their criteria, before they get their pressures.
  subroutine resolve_erosion(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model
    integer :: i, m

    do i = 1, size(raw%erosions)
      if (raw%erosions(i)%material == 0) cycle
      call resolve_id(deck, a_material, raw%erosions(i)%material, &
        raw%erosions(i)%place, m)
      if (m == 0) cycle
      if (allocated(model%materials(m)%erosion)) then
        call reject_field(deck, raw%erosions(i)%place, 'has criteria of erosion already')
      else if (.not. any(can_go == model%materials(m)%law) .or. model%materials(m)%is_rigid) then
        call reject_field(deck, raw%erosions(i)%place, 'is a material whose elements can not ' &
          //'leave the mesh')
      else
        model%materials(m)%erosion = raw%erosions(i)%erosion
      end if
    end do
    do m = 1, size(model%materials)
      call add_criteria_of_law(raw%erodes_by_step, model%materials(m))
      model%erodes = model%erodes .or. allocated(model%materials(m)%erosion)
    end do
    if (.not. (model%erodes .and. model%controls%implicit%is_on)) return
    do i = 1, size(raw%erosions)
      call line_error(deck, raw%erosions(i)%place%line, 'lets elements leave the mesh, which the ' &
        //'implicit method does not have')
    end do
    if (raw%erodes_by_step) call line_error(deck, raw%step_line, 'ERODE lets elements leave the ' &
      //'mesh, which the implicit method does not have')
    model%erodes = .false.
    do m = 1, size(model%materials)
      if (allocated(model%materials(m)%erosion)) deallocate (model%materials(m)%erosion)
    end do
  end subroutine resolve_erosion

  !> What the law itself and ERODE ask for.
  pure subroutine add_criteria_of_law(by_step, material)
    logical, intent(in) :: by_step
    type(material_t), intent(inout) :: material
    logical :: by_law

    if (material%is_rigid .or. .not. any(can_go == material%law)) return
    by_law = material%failure_strain < huge(1.0_wp)
    if (allocated(material%flow)) by_law = by_law .or. (material%flow%has_damage &
      .and. .not. material%flow%keeps_broken)
    if (.not. (by_law .or. by_step)) return
    if (.not. allocated(material%erosion)) allocate (material%erosion)
    material%erosion%by_law = by_law
    material%erosion%by_step = by_step
  end subroutine add_criteria_of_law

  !> NUMFIP beside the points that elements have; hourglass works of each element are those of the
  !> viscous and the stiffness form.
  subroutine check_erosion_points(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    integer :: i, k

    do i = 1, size(raw%erosions)
      if (raw%erosions(i)%erosion%n_point == 1) cycle
      do k = 1, size(model%parts)
        if (model%parts(k)%material == 0 .or. model%parts(k)%section == 0) cycle
        if (model%materials(model%parts(k)%material)%id /= raw%erosions(i)%material) cycle
        if (model%sections(model%parts(k)%section)%is_full) cycle
        call reject_field(deck, raw%erosions(i)%place, 'asks for '//to_text( &
          raw%erosions(i)%erosion%n_point)//' points (NUMFIP), but elements of part ' &
          //to_text(model%parts(k)%id)//' have one')
      end do
    end do
    do k = 1, size(model%parts)
      associate (part => model%parts(k))
        if (part%material == 0 .or. part%section == 0) cycle
        if (.not. allocated(model%materials(part%material)%erosion)) cycle
        if (model%sections(part%section)%is_full) cycle
        if (part%hourglass%form /= hourglass_assumed) cycle
        call line_error(deck, raw%parts(k)%line, 'part '//to_text(part%id)//' has hourglass ' &
          //'control by assumed strain (IHQ 6), and elements that may leave the mesh, which have ' &
          //'IHQ 1 to 5')
      end associate
    end do
    if (raw%erodes_by_step .and. .not. model%controls%implicit%is_on) call name_what_stays(deck, &
      raw%step_line, model)
  end subroutine check_erosion_points

  !> Parts that ERODE passes over: rubber and foam can not lose their pressure.
  subroutine name_what_stays(deck, line, model)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line    !! of the card with ERODE
    type(model_t), intent(in) :: model
    integer :: k

    do k = 1, size(model%parts)
      if (model%parts(k)%material == 0) cycle
      associate (material => model%materials(model%parts(k)%material))
        if (material%is_rigid .or. any(can_go == material%law)) cycle
        call line_warning(deck, line, 'ERODE and part '//to_text(model%parts(k)%id), &
          'ERODE takes no elements of part '//to_text(model%parts(k)%id)//', which is rubber or ' &
          //'foam: a step of theirs below DTMIN ends the run')
      end associate
    end do
  end subroutine name_what_stays

  !> Ties and initial overlaps do not follow surfaces that change.
  subroutine check_eroding_contacts(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    logical :: may_go(size(model%materials))
    integer :: i, m

    if (.not. model%erodes) return
    do m = 1, size(model%materials)
      may_go(m) = allocated(model%materials(m)%erosion)
    end do
    do i = 1, size(raw%contacts)
      associate (contact => model%contacts(i))
        if (.not. (is_tied(contact) .or. allocated(contact%interference))) cycle
        if (.not. (touches(contact%slave%segment_element) &
          .or. touches(contact%master%segment_element))) cycle
        call line_error(deck, deck%blocks(raw%contacts(i)%block)%keyword, trim(merge( &
          'ties                  ', 'has an overlap (LCINT)', is_tied(contact)))//' on elements ' &
          //'that may leave the mesh, which this version does not have')
      end associate
    end do

  contains

    !> Whether some of the elements may leave.
    pure function touches(elements)
      integer, intent(in) :: elements(:)
      logical :: touches

      touches = any(may_go(model%parts(model%mesh%element_part(elements))%material))
    end function touches

  end subroutine check_eroding_contacts

end module deck_resolve_erosion_m
