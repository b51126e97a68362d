! SPDX-License-Identifier: MIT
!> *PART, *SECTION_SHELL and *HOURGLASS, checks across parts, and rigid bodies of *MAT_RIGID.
module deck_part_m
  use kinds_m, only : wp
  use text_m, only : read_integer, number_good
  use log_m, only : to_text
  use eos_m, only : eos_t
  use model_m, only : model_t
  use parts_m, only : section_t, hourglass_t, part_t, hourglass_viscous, hourglass_stiffness, &
    hourglass_assumed, form_one_point, form_full, form_axisym_one_point, form_axisym_full
  use deck_ids_m, only : a_part, a_section, a_material, an_hourglass, an_element
  use deck_lines_m, only : deck_t, location_t, blocks_of, count_rows, line_text, line_error, &
    line_warning, flag_blank
  use deck_fields_m, only : field_number, card_t
  use deck_cards_m, only : cursor_t, open_cursor, skip_title, next_card, next_row, next_text, &
    next_of, row_comes, report_field, reject_field
  use deck_values_m, only : integer_of, real_of, is_blank, is_bad, define, map_defined, find_id
  use deck_inertia_m, only : inertia_t, read_inertia
  use deck_material_m, only : assign_equation
  implicit none
  private
  public :: read_parts, read_sections, hourglass_form, hourglass_coefficient, make_rigids

contains

  !> *PART: a heading and a card for each part. Sections and materials have been read.
  subroutine read_parts(deck, default, equations, model, inertias)
    type(deck_t), intent(inout) :: deck
    type(hourglass_t), intent(in) :: default     !! of parts that name no control of their own
    type(eos_t), intent(in) :: equations(:)
    type(model_t), intent(inout) :: model
    type(inertia_t), allocatable, intent(out) :: inertias(:) !! of *PART_INERTIA
    type(hourglass_t), allocatable :: hourglasses(:)
    type(part_t), allocatable :: parts(:)
    type(part_t) :: part
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer, allocatable :: blocks(:), equation_of(:)
    integer :: i, k, n

    call read_hourglasses(deck, default, hourglasses)
    equation_of = spread(-1, 1, size(model%materials))
    blocks = blocks_of(deck, 'PART')
    allocate (parts(count_rows(deck, 'PART')), inertias(0))
    do i = 1, size(blocks)
      call open_cursor(deck, blocks(i), cursor)
      do
        call skip_separators(deck, cursor)
        if (cursor%line > cursor%last) exit
        call next_text(deck, cursor, part%title)
        part%title = trim(adjustl(part%title))
        if (.not. next_row(deck, cursor, 2, card)) then
          call line_error(deck, cursor%line - 1, &
            'the card of the part is missing after this heading')
          exit
        end if
        call define(deck, a_part, card, n)
        if (deck%blocks(blocks(i))%name == 'PART_INERTIA') call read_inertia(deck, cursor, n, &
          inertias)
        if (n == 0) cycle
        part%id = integer_of(card, 'PID')
        call find_id(deck, a_section, card, 'SECID', part%section)
        call find_id(deck, a_material, card, 'MID', part%material)
        if (part%material > 0) call assign_equation(deck, card, equations, model, equation_of, &
          part%material)
        part%hourglass = default
        if (integer_of(card, 'HGID') > 0) then
          call find_id(deck, an_hourglass, card, 'HGID', k)
          if (k > 0) part%hourglass = hourglasses(k)
        end if
        parts(n) = part
      end do
    end do
    model%parts = parts(:deck%maps(a_part)%n)
    call map_defined(deck, a_part, 'PID')
    call set_formulation(deck, model)
    call set_integration(deck, model)
  end subroutine read_parts

  !> Move past blank lines between parts; a blank line right before a card of numbers is a heading.
  subroutine skip_separators(deck, cursor)
    type(deck_t), intent(in) :: deck
    type(cursor_t), intent(inout) :: cursor
    character(:), allocatable :: text
    integer :: number, status, width

    width = cursor%specs(2)%widths(field_number(cursor%specs(2)%names, 'PID'))
    do while (cursor%line <= cursor%last)
      if (iand(deck%flags(cursor%line), flag_blank) == 0) return
      if (cursor%line < cursor%last) then
        text = line_text(deck, cursor%line + 1)
        if (index(text, ',') > 0) text = text(:index(text, ',') - 1)
        call read_integer(text(:min(width, len(text))), number, status)
        if (status == number_good) return
      end if
      cursor%line = cursor%line + 1
    end do
  end subroutine skip_separators

  !> *SECTION_SHELL: two cards each.
  subroutine read_sections(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(section_t), allocatable :: sections(:)
    type(section_t) :: section
    type(cursor_t) :: cursor
    type(card_t) :: card, thickness
    integer, allocatable :: blocks(:)
    integer :: i, n
    logical :: found

    blocks = blocks_of(deck, 'SECTION_SHELL')
    allocate (sections(count_rows(deck, 'SECTION_SHELL') + size(blocks)))
    do i = 1, size(blocks)
      call open_cursor(deck, blocks(i), cursor)
      found = .true.
      do while (found)
        call skip_title(deck, cursor)
        call next_card(deck, cursor, 1, card)
        call next_card(deck, cursor, 2, thickness)
        found = row_comes(deck, cursor)
        call check_form(deck, card)
        section%id = integer_of(card, 'SECID')
        call set_thickness(deck, card, thickness, section)
        section%is_full = integer_of(card, 'NIP') == 4
        section%is_axisymmetric = integer_of(card, 'ELFORM') == 15
        section%element_form = merge(form_full, form_one_point, section%is_full)
        if (section%is_axisymmetric) section%element_form = merge(form_axisym_full, &
          form_axisym_one_point, section%is_full)
        call define(deck, a_section, card, n)
        if (n > 0) sections(n) = section
      end do
    end do
    model%sections = sections(:deck%maps(a_section)%n)
    call map_defined(deck, a_section, 'SECID')
  end subroutine read_sections

  !> T1 of plane stress, one thickness for all corners.
  subroutine set_thickness(deck, card, thickness, section)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(in) :: card
    type(card_t), intent(inout) :: thickness
    type(section_t), intent(inout) :: section
    character(2), parameter :: corners(3) = ['T2', 'T3', 'T4']
    integer :: k

    section%is_plane_stress = integer_of(card, 'ELFORM') == 12
    section%thickness = 1.0_wp
    if (.not. section%is_plane_stress) return
    section%thickness = real_of(thickness, 'T1')
    if (.not. section%thickness > 0.0_wp) call report_field(deck, thickness, 'T1', &
      'is not the thickness of plane stress (more than 0)')
    do k = 1, size(corners)
      if (abs(real_of(thickness, corners(k))) > 0.0_wp .and. &
        abs(real_of(thickness, corners(k)) - section%thickness) > 0.0_wp) call report_field(deck, &
        thickness, corners(k), 'is not T1: plane stress has one thickness in a section')
    end do
  end subroutine set_thickness

  !> Check ELFORM.
  subroutine check_form(deck, card)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    character(:), allocatable :: message

    select case (integer_of(card, 'ELFORM'))
    case (12, 13, 15)
      return
    case (14)
      message = 'is axisymmetric and area weighted, which this version does not have; it has 15 ' &
        //'(axisymmetric, volume weighted)'
    case default
      message = 'is not a 2D element form of this version; it has 12 (plane stress), 13 (plane ' &
        //'strain) and 15 (axisymmetric)'
    end select
    call report_field(deck, card, 'ELFORM', message)
  end subroutine check_form

  !> *HOURGLASS: one card each.
  subroutine read_hourglasses(deck, default, hourglasses)
    type(deck_t), intent(inout) :: deck
    type(hourglass_t), intent(in) :: default   !! bulk viscosity of blank fields
    type(hourglass_t), allocatable, intent(out) :: hourglasses(:)
    type(hourglass_t) :: hourglass
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer :: n

    allocate (hourglasses(count_rows(deck, 'HOURGLASS')))
    do while (next_of(deck, 'HOURGLASS', cursor, card))
      call skip_title(deck, cursor)
      hourglass%id = integer_of(card, 'HGID')
      call hourglass_form(deck, card, 'IHQ', hourglass%form)
      call hourglass_coefficient(deck, card, 'QM', hourglass%coefficient)
      hourglass%quadratic = default%quadratic
      hourglass%linear = default%linear
      if (.not. is_blank(card, 'Q1')) hourglass%quadratic = real_of(card, 'Q1')
      if (.not. is_blank(card, 'Q2')) hourglass%linear = real_of(card, 'Q2')
      call define(deck, an_hourglass, card, n)
      if (n > 0) hourglasses(n) = hourglass
    end do
    call map_defined(deck, an_hourglass, 'HGID')
  end subroutine read_hourglasses

  !> Read an hourglass form.
  subroutine hourglass_form(deck, card, name, form)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name
    integer, intent(out) :: form

    form = hourglass_viscous
    select case (integer_of(card, name))
    case (0:3)
      continue
    case (4, 5)
      form = hourglass_stiffness
    case (6)
      form = hourglass_assumed
    case (7)
      call report_field(deck, card, name, 'is assumed strain in total form, which this version ' &
        //'does not have; the incremental form (6) is equivalent for small elastic strains')
    case default
      call report_field(deck, card, name, &
        'is not an hourglass form (1 to 3 viscous, 4 and 5 stiffness, 6 assumed strain)')
    end select
  end subroutine hourglass_form

  !> Read an hourglass coefficient; 0 and blank are 0.1, as in LS-DYNA.
  subroutine hourglass_coefficient(deck, card, name, coefficient)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name
    real(wp), intent(out) :: coefficient
    real(wp) :: given

    coefficient = 0.1_wp
    given = real_of(card, name)
    if (given > 0.0_wp) then
      coefficient = given
    else if (.not. is_blank(card, name) .and. .not. is_bad(card, name)) then
      call line_warning(deck, card%line, 'qh'//to_text(card%line), &
        'an hourglass coefficient of 0 means the default 0.1; give a very small one for hardly ' &
        //'any')
    end if
  end subroutine hourglass_coefficient

  !> Set whether the model is axisymmetric; parts with another formulation are errors.
  subroutine set_formulation(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    character(*), parameter :: forms(2) = ['a plane (ELFORM 12 or 13)', 'axisymmetry (ELFORM 15)  ']
    logical :: is_axisymmetric(size(model%parts)), is_known(size(model%parts))
    integer :: i, first

    is_known = model%parts%section > 0
    is_axisymmetric = .false.
    do i = 1, size(model%parts)
      if (is_known(i)) is_axisymmetric(i) = model%sections(model%parts(i)%section)%is_axisymmetric
    end do
    model%is_axisymmetric = any(is_axisymmetric)
    if (.not. any(is_known)) return
    first = findloc(is_known, .true., dim=1)
    do i = 1, size(model%parts)
      if (.not. is_known(i) .or. (is_axisymmetric(i) .eqv. is_axisymmetric(first))) cycle
      call reject_field(deck, location_t(deck%maps(a_part)%lines(i), 2, 'SECID'), &
        'is a section of '//trim(forms(merge(2, 1, &
        is_axisymmetric(i))))//', but part '//to_text(model%parts(first)%id) &
        //' has '//trim(forms(merge(2, 1, is_axisymmetric(first))))//': all parts must be of one ' &
        //'kind')
    end do
  end subroutine set_formulation

  !> Check and set the integration of one-point quads. Assumed strain needs a shear modulus.
  !> Implicit runs integrate parts fully that have rubber or no assumed strain, whatever NIP.
  subroutine set_integration(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    character(:), allocatable :: changed
    type(section_t) :: full_section
    integer :: full_sections(size(model%sections)) !! fully integrated copy of each section, 0: none
    integer :: i, line

    changed = ''
    full_sections = 0
    do i = 1, size(model%parts)
      associate (part => model%parts(i))
        if (part%section == 0 .or. part%material == 0) cycle
        if (model%sections(part%section)%is_full .or. model%materials(part%material)%is_rigid) cycle
        if (part%hourglass%form == hourglass_assumed .and. .not. (model%controls%implicit%is_on &
          .and. allocated(model%materials(part%material)%rubber))) then
          ! Assumed strain takes its stiffness from the shear modulus.
          associate (material => model%materials(part%material))
            if (material%needs_eos .and. .not. material%shear > 0.0_wp) call line_error(deck, &
              deck%maps(a_part)%lines(i), 'part '//to_text(part%id)//' has hourglass control by ' &
              //'assumed strain (IHQ 6), whose stiffness comes from the shear modulus, and its ' &
              //'material '//to_text(material%id)//' has none (take IHQ 1 to 3)')
          end associate
        else if (model%controls%implicit%is_on) then
          if (len(changed) == 0) line = deck%maps(a_section)%lines(part%section)
          changed = changed//', '//to_text(part%id)
          if (full_sections(part%section) == 0) then
            full_section = model%sections(part%section)
            full_section%is_full = .true.
            full_section%element_form = merge(form_axisym_full, form_full, &
              full_section%is_axisymmetric)
            model%sections = [model%sections, full_section]
            full_sections(part%section) = size(model%sections)
          end if
          part%section = full_sections(part%section)
        end if
      end associate
    end do
    if (len(changed) > 0) call line_warning(deck, line, 'implicit points', 'the implicit method ' &
      //'integrates these parts fully, as with NIP 4 (one-point elements need IHQ 6 and no ' &
      //'rubber): '//changed(3:))
  end subroutine set_integration

  !> Make one rigid body for each part of *MAT_RIGID.
  subroutine make_rigids(deck, model, owner)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    integer, allocatable, intent(out) :: owner(:) !! (n_node) body of each node, 0: none
    integer, allocatable :: parts(:)
    logical :: is_there(0:model%mesh%n_node)
    integer :: i, k

    associate (mesh => model%mesh)
      parts = pack([(i, i=1, size(model%parts))], model%parts%material > 0)
      parts = pack(parts, [(model%materials(model%parts(parts(i))%material)%is_rigid, i=1, &
        size(parts))])
      allocate (model%rigids(size(parts)), owner(mesh%n_node))
      owner = 0
      do i = 1, size(parts)
        associate (body => model%rigids(i))
          body%part = parts(i)
          body%is_fixed = model%materials(model%parts(parts(i))%material)%is_fixed
          if (model%is_axisymmetric) body%is_fixed([1, 3]) = .true.
          is_there = .false.
          do k = 1, mesh%n_element
            if (mesh%element_part(k) == parts(i)) is_there(mesh%element_nodes(:, k)) = .true.
          end do
          body%nodes = pack([(k, k=1, mesh%n_node)], is_there(1:))
        end associate
        call own_nodes(deck, i, model, owner)
      end do
    end associate
    if (size(parts) == 0) return
    if (size(parts) == size(model%parts) .and. model%controls%dt_curve == 0 .and. .not. &
      model%controls%implicit%is_on) call line_error(deck, deck%maps(a_part)%lines(1), 'all parts' &
      //' are rigid, so that no element has a time step; give a curve LCTM of *CONTROL_TIMESTEP')
  end subroutine make_rigids

  !> Report a rigid body without nodes, and nodes of two rigid bodies.
  subroutine own_nodes(deck, i, model, owner)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i                !! body
    type(model_t), intent(in) :: model
    integer, intent(inout) :: owner(:)      !! (n_node) of the bodies so far
    type(location_t) :: location
    integer :: k

    associate (body => model%rigids(i))
      location = location_t(deck%maps(a_part)%lines(body%part), 2, 'PID')
      if (size(body%nodes) == 0 .and. .not. deck%maps(an_element)%has_refused) &
        call reject_field(deck, location, ': this rigid part has no elements, so no mass')
      k = findloc(owner(body%nodes) > 0, .true., dim=1)
      if (k > 0) call reject_field(deck, location, ': node ' &
        //to_text(model%mesh%node_id(body%nodes(k)))//' belongs to this rigid part and to rigid ' &
        //'part '//to_text(model%parts(model%rigids(owner(body%nodes(k)))%part)%id) &
        //'; bodies that share nodes must be one part')
      owner(body%nodes) = i
    end associate
  end subroutine own_nodes

end module deck_part_m
