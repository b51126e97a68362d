! SPDX-License-Identifier: MIT
!> *MAT_ADD_EROSION, and the materials that may erode.
module deck_erosion_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use parts_m, only : law_elastic, law_plastic, law_piecewise, law_johnson_cook, &
    law_hot_johnson_cook, law_null, hourglass_assumed, erosion_t
  use deck_lines_m, only : deck_t, blocks_of, line_error, line_warning
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, first_card, next_card, check_rest, report_field
  use deck_ids_m, only : a_material, a_part
  use deck_values_m, only : real_of, is_blank, is_bad, find_id
  implicit none
  private
  public :: read_erosions

  !> Laws that can erode.
  integer, parameter :: can_erode(6) = [law_elastic, law_plastic, law_piecewise, law_johnson_cook, &
    law_hot_johnson_cook, law_null]

contains

  !> Read the erosion criteria of all materials, before their pressure moduli are set. Parts have
  !> been read.
  subroutine read_erosions(deck, by_step, step_line, model)
    type(deck_t), intent(inout) :: deck
    logical, intent(in) :: by_step       !! ERODE
    integer, intent(in) :: step_line     !! of the card with ERODE
    type(model_t), intent(inout) :: model
    integer, allocatable :: blocks(:)
    integer :: i, m
    logical :: by_law

    blocks = blocks_of(deck, 'MAT_ADD_EROSION')
    do i = 1, size(blocks)
      call read_erosion(deck, blocks(i), model)
    end do
    do m = 1, size(model%materials)
      associate (material => model%materials(m))
        ! Criteria of the law and of ERODE.
        by_law = material%failure_strain < huge(1.0_wp)
        if (allocated(material%flow)) by_law = by_law .or. (material%flow%has_damage &
          .and. .not. material%flow%keeps_broken)
        if ((by_law .or. by_step) .and. any(can_erode == material%law) &
          .and. .not. material%is_rigid) then
          if (.not. allocated(material%erosion)) allocate (material%erosion)
          material%erosion%by_law = by_law
          material%erosion%by_step = by_step
        end if
        model%erodes = model%erodes .or. allocated(material%erosion)
      end associate
    end do
    if (.not. model%controls%implicit%is_on) then
      call check_parts(deck, by_step, step_line, model)
      return
    end if
    if (by_step .and. model%erodes) call line_error(deck, step_line, 'ERODE asks for erosion, ' &
      //'which the implicit method does not have')
    model%erodes = .false.
    do m = 1, size(model%materials)
      if (allocated(model%materials(m)%erosion)) deallocate (model%materials(m)%erosion)
    end do
  end subroutine read_erosions

  !> Read the criteria of one material. Fields that are blank or equal to EXCL are not used.
  subroutine read_erosion(deck, i_block, model)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(model_t), intent(inout) :: model
    type(cursor_t) :: cursor
    type(card_t) :: cards(5)
    type(erosion_t) :: erosion
    integer :: i, m

    call first_card(deck, i_block, cursor, cards(1))
    do i = 2, 5
      call next_card(deck, cursor, i, cards(i))
    end do
    call check_rest(deck, cursor)
    call read_criteria(deck, cards(1), cards(2), erosion)
    erosion%least_step = max(0.0_wp, real_of(cards(5), 'DTMIN'))
    associate (card => cards(1), n_most => max(1, erosion%n_given))
      if (.not. is_bad(card, 'NUMFIP')) erosion%n_point = max(1, nint(real_of(card, 'NUMFIP')))
      erosion%n_criteria = max(1, nint(real_of(card, 'NCS')))
      if (erosion%n_given == 0 .and. .not. erosion%least_step > 0.0_wp) then
        call report_field(deck, card, 'MID', 'has no criterion: all fields are blank or EXCL')
      else if (real_of(card, 'NCS') > n_most) then
        call report_field(deck, card, 'NCS', 'is not a number of criteria that may hold at ' &
          //'once (1 to '//to_text(n_most)//', which are given)')
      end if
    end associate
    call find_id(deck, a_material, cards(1), 'MID', m)
    if (m == 0) return
    associate (material => model%materials(m))
      if (allocated(material%erosion)) then
        call report_field(deck, cards(1), 'MID', 'has erosion criteria already')
      else if (.not. any(can_erode == material%law) .or. material%is_rigid) then
        call report_field(deck, cards(1), 'MID', &
          'is a material that cannot erode')
      else
        if (model%controls%implicit%is_on) call line_error(deck, cards(1)%line, &
          'asks for erosion, which the implicit method does not have')
        do i = m, size(model%materials)
          if (model%materials(i)%id == material%id) model%materials(i)%erosion = erosion
        end do
      end if
      do i = 1, size(model%parts)
        if (model%parts(i)%material == 0 .or. model%parts(i)%section == 0) cycle
        if (model%materials(model%parts(i)%material)%id /= material%id) cycle
        if (erosion%n_point == 1 .or. model%sections(model%parts(i)%section)%is_full) cycle
        call report_field(deck, cards(1), 'NUMFIP', 'asks for '//to_text(erosion%n_point) &
          //' points, but elements of part '//to_text(model%parts(i)%id)//' have one')
      end do
    end associate
  end subroutine read_erosion

  !> Read the criteria of cards 1 and 2.
  subroutine read_criteria(deck, card, more, erosion)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card, more
    type(erosion_t), intent(inout) :: erosion

    call read_limit(card, 'MXPRES', erosion%most_pressure)
    call read_limit(card, 'MNEPS', erosion%least_strain)
    call read_limit(card, 'EFFEPS', erosion%effective_strain)
    if (is_given(card, 'VOLEPS')) then
      if (real_of(card, 'VOLEPS') > 0.0_wp) call read_limit(card, 'VOLEPS', erosion%most_volume)
      if (real_of(card, 'VOLEPS') < 0.0_wp) call read_limit(card, 'VOLEPS', erosion%least_volume)
      if (.not. abs(real_of(card, 'VOLEPS')) > 0.0_wp) then
        erosion%n_given = erosion%n_given + 1
        call report_field(deck, card, 'VOLEPS', 'is not a volumetric strain at failure (above 0 ' &
          //'in tension, below 0 in compression)')
      end if
    end if
    call read_limit(more, 'MNPRES', erosion%least_pressure)
    call read_limit(more, 'SIGP1', erosion%principal_stress)
    call read_limit(more, 'SIGVM', erosion%mises)
    call read_limit(more, 'MXEPS', erosion%most_strain)
    call read_limit(more, 'EPSSH', erosion%shear_strain)
    call read_limit(more, 'IMPULSE', erosion%impulse)
    call read_limit(more, 'FAILTM', erosion%time)
    if (.not. is_given(more, 'SIGTH')) return
    if (real_of(more, 'SIGTH') < 0.0_wp) call report_field(deck, more, 'SIGTH', 'is negative')
    erosion%threshold = max(0.0_wp, real_of(more, 'SIGTH'))
    if (.not. is_given(more, 'IMPULSE')) call report_field(deck, more, 'SIGTH', &
      'is a threshold stress without IMPULSE')

  contains

    !> Whether a field gives a criterion.
    function is_given(card_of, name) result(given)
      type(card_t), intent(in) :: card_of
      character(*), intent(in) :: name
      logical :: given

      given = .not. is_blank(card_of, name) &
        .and. abs(real_of(card_of, name) - real_of(card, 'EXCL')) > 0.0_wp
    end function is_given

    !> Read a criterion, of either sign where allowed, else above 0.
    subroutine read_limit(card_of, name, value)
      type(card_t), intent(inout) :: card_of
      character(*), intent(in) :: name
      real(wp), intent(inout) :: value

      if (.not. is_given(card_of, name)) return
      erosion%n_given = erosion%n_given + 1
      if (real_of(card_of, name) > 0.0_wp .or. any(name == ['MXPRES', 'MNEPS ', 'MNPRES', &
        'VOLEPS'])) then
        value = real_of(card_of, name)
      else
        call report_field(deck, card_of, name, 'is not a limit of this version (more than 0; ' &
          //'below 0 it would be a curve)')
      end if
    end subroutine read_limit

  end subroutine read_criteria

  !> Report parts that may erode with assumed strain hourglass control, which has no hourglass
  !> energy per element, and rubber and foam with ERODE.
  subroutine check_parts(deck, by_step, step_line, model)
    type(deck_t), intent(inout) :: deck
    logical, intent(in) :: by_step
    integer, intent(in) :: step_line
    type(model_t), intent(in) :: model
    integer :: k

    do k = 1, size(model%parts)
      associate (part => model%parts(k))
        if (part%material == 0 .or. part%section == 0) cycle
        associate (material => model%materials(part%material))
          if (by_step .and. .not. (material%is_rigid .or. any(can_erode == material%law))) call &
            line_warning(deck, step_line, 'ERODE and part '//to_text(part%id), &
            'ERODE does not erode part '//to_text(part%id)//', which is rubber or foam: a time ' &
            //'step below DTMIN ends the run')
          if (.not. allocated(material%erosion)) cycle
          if (model%sections(part%section)%is_full) cycle
          if (part%hourglass%form == hourglass_assumed) call line_error(deck, &
            deck%maps(a_part)%lines(k), 'part '//to_text(part%id)//' has hourglass control by ' &
            //'assumed strain (IHQ 6), but elements that may erode, which need IHQ 1 to 5')
        end associate
      end associate
    end do
  end subroutine check_parts

end module deck_erosion_m
