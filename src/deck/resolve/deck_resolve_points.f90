! SPDX-License-Identifier: MIT
!> Integration points: what assumed strain and the implicit method ask of parts of one-point quads.
module deck_resolve_points_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use parts_m, only : form_full, form_round_full, hourglass_assumed, section_t
  use deck_lines_m, only : deck_t, line_error, line_warning
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: settle_points

contains

  !> Parts of one-point quads: those with assumed strain must resist shear; in implicit runs those
  !> without it, or of rubber, whose tangent is that of full integration, are fully integrated,
  !> whatever the deck says.
  subroutine settle_points(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model
    character(:), allocatable :: changed
    integer :: twins(size(model%sections)) !! fully integrated ones, 0 where there is none
    integer :: i, line

    changed = ''
    twins = 0
    do i = 1, size(model%parts)
      associate (part => model%parts(i))
        if (part%section == 0 .or. part%material == 0) cycle
        if (model%sections(part%section)%is_full .or. model%materials(part%material)%is_rigid) cycle
        if (part%hourglass%form == hourglass_assumed .and. .not. (model%controls%implicit%is_on &
          .and. allocated(model%materials(part%material)%rubber))) then
          call check_shear(deck, raw%parts(i)%line, i, model)
        else if (model%controls%implicit%is_on) then
          if (len(changed) == 0) line = raw%section_line(part%section)
          changed = changed//', '//to_text(part%id)
          if (twins(part%section) == 0) call add_full_section(part%section, model, twins)
          part%section = twins(part%section)
        end if
      end associate
    end do
    if (len(changed) > 0) call line_warning(deck, line, 'implicit points', 'the implicit method ' &
      //'takes parts whose NIP is not 4 as NIP 4 where hourglass control is not by ' &
      //'assumed strain (IHQ 6), which would keep them as they are (but for rubber): '//changed(3:))
  end subroutine settle_points

  !> The stiffness of assumed strain is that of shear.
  subroutine check_shear(deck, line, i, model)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line     !! card of the part
    integer, intent(in) :: i        !! part
    type(model_t), intent(in) :: model

    associate (part => model%parts(i))
      if (model%materials(part%material)%shear > 0.0_wp) return
      if (.not. model%materials(part%material)%needs_eos) return ! told as a field
      call line_error(deck, line, 'part '//to_text(part%id)//' has hourglass control by assumed ' &
        //'strain (IHQ 6), whose stiffness comes from the shear modulus, and its material ' &
        //to_text(model%materials(part%material)%id)//' has none (take IHQ 1 to 3)')
    end associate
  end subroutine check_shear

  !> The fully integrated twin of a section, which other parts may go on sharing as it is.
  pure subroutine add_full_section(section, model, twins)
    integer, value :: section             !! index
    type(model_t), intent(inout) :: model
    integer, intent(inout) :: twins(:)    !! index, by that of the section
    type(section_t) :: twin

    twin = model%sections(section)
    twin%is_full = .true.
    twin%element_form = merge(form_round_full, form_full, twin%is_round)
    model%sections = [model%sections, twin]
    twins(section) = size(model%sections)
  end subroutine add_full_section

end module deck_resolve_points_m
