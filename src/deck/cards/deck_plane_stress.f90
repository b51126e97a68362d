! SPDX-License-Identifier: MIT
!> Plane stress (ELFORM 12): its materials, ISTUPD of *CONTROL_SHELL, and thicknesses in contact.
module deck_plane_stress_m
  use contacts_m, only : contact_t
  use eos_m, only : eos_t, eos_by_law, eos_logarithmic
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t, is_sheet
  use parts_m, only : material_t, condensed_bulk, spall_pressure
  use deck_cards_m, only : report_field
  use deck_control_m, only : control_cards
  use deck_fields_m, only : card_t
  use deck_ids_m, only : a_material
  use deck_lines_m, only : deck_t, blocks_of, line_error
  use deck_values_m, only : integer_of
  implicit none
  private
  public :: set_plane_stress, set_contact_thickness

contains

  !> Set the materials of parts in plane stress. Parts, erosion and pressure moduli have been read.
  !> A material of other parts too is copied.
  subroutine set_plane_stress(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    logical, dimension(size(model%parts)) :: is_known, is_thin
    logical :: follows_strain
    integer :: i, m, own

    is_known = model%parts%section > 0 .and. model%parts%material > 0
    is_thin = .false.
    do i = 1, size(model%parts)
      if (is_known(i)) is_thin(i) = model%sections(model%parts(i)%section)%is_plane_stress
    end do
    if (.not. any(is_thin)) return
    call read_shell_control(deck, follows_strain)
    do m = 1, size(model%materials)
      if (.not. any(is_thin .and. model%parts%material == m)) cycle
      if (model%materials(m)%is_rigid) cycle
      own = m
      if (any(is_known .and. .not. is_thin .and. model%parts%material == m)) then
        model%materials = [model%materials, model%materials(m)]
        associate (map => deck%maps(a_material))
          map%lines = [map%lines, map%lines(m)]
        end associate
        own = size(model%materials)
        where (is_thin .and. model%parts%material == m) model%parts%material = own
      end if
      call set_material(deck, own, follows_strain, model%materials(own))
    end do
  end subroutine set_plane_stress

  !> ISTUPD of *CONTROL_SHELL: whether the thickness follows its strain. Its other fields have no
  !> effect.
  subroutine read_shell_control(deck, follows_strain)
    type(deck_t), intent(inout) :: deck
    logical, intent(out) :: follows_strain
    type(card_t) :: cards(6)
    integer, allocatable :: blocks(:)

    follows_strain = .false.
    blocks = blocks_of(deck, 'CONTROL_SHELL')
    if (size(blocks) == 0) return
    call control_cards(deck, blocks(size(blocks)), cards)
    follows_strain = integer_of(cards(1), 'ISTUPD') == 1
    if (all(integer_of(cards(1), 'ISTUPD') /= [0, 1])) call report_field(deck, cards(1), 'ISTUPD', &
      'is not 0 (constant thickness) or 1 (the thickness of plane stress follows its strain)')
    if (cards(3)%line > 0 .and. integer_of(cards(3), 'PSTUPD') /= 0) call report_field(deck, &
      cards(3), 'PSTUPD', 'chooses parts; ISTUPD holds for all parts in plane stress here')
  end subroutine read_shell_control

  !> Put the law of a material under the condition sigma_zz = 0, or report that it has none.
  subroutine set_material(deck, m, follows_strain, material)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: m
    logical, intent(in) :: follows_strain
    type(material_t), intent(inout) :: material
    character(:), allocatable :: reason

    reason = ''
    if (allocated(material%crush)) then
      reason = 'the law of a crushable foam'
    else if (material%decay >= 0.0_wp) then
      reason = 'the law of viscoelasticity'
    else if (material%needs_eos) then
      reason = 'an equation of state'
    else if (allocated(material%eos)) then
      if (.not. any(material%eos%kind == [eos_by_law, eos_logarithmic])) &
        reason = 'an equation of state'
    end if
    if (allocated(material%rubber)) then
      if (material%rubber%n_term > 0) reason = 'the law of Ogden'
    end if
    if (len(reason) == 0 .and. (material%spall /= spall_pressure &
      .or. material%cutoff > -huge(1.0_wp))) reason = 'a pressure cut-off (PC)'
    if (len(reason) > 0) call line_error(deck, deck%maps(a_material)%lines(m), 'material ' &
      //to_text(material%id)//' has '//reason//', which plane stress (ELFORM 12) does not have')
    if (len(reason) > 0 .or. .not. (material%bulk > 0.0_wp .and. material%density > 0.0_wp)) return
    material%is_plane_stress = .true.
    material%follows_strain = follows_strain
    material%eos = eos_t(kind=eos_by_law, stiffness=material%bulk)
    material%sound_speed = sqrt((condensed_bulk(material%bulk, material%shear) &
      + 4.0_wp*material%shear/3.0_wp)/material%density)
  end subroutine set_material

  !> Scale stresses of an interface to forces per length of the sheets that it is between, which
  !> must have one thickness. Penalties follow where they are formed.
  subroutine set_contact_thickness(deck, line, model, contact)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line
    type(model_t), intent(in) :: model
    type(contact_t), intent(inout) :: contact
    integer, allocatable :: parts(:)
    integer :: other

    parts = model%mesh%element_part([contact%slave%segment_element, &
      contact%master%segment_element])
    if (size(parts) == 0 .or. any(model%parts%section == 0)) return
    associate (depths => model%sections(model%parts(parts)%section)%thickness)
      other = findloc(abs(depths - depths(1)) > 1.0e-12_wp*depths(1), .true., dim=1)
      if (other > 0) call line_error(deck, line, 'is between sheets of unlike thickness: part ' &
        //to_text(model%parts(parts(1))%id)//' has '//to_text(depths(1))//' and part ' &
        //to_text(model%parts(parts(other))%id)//' '//to_text(depths(other)) &
        //' (plane strain 1)')
      contact%thickness = depths(1)
    end associate
    contact%is_sheet = is_sheet(model)
    contact%strength = contact%thickness*contact%strength
    contact%friction%most = contact%thickness*contact%friction%most
  end subroutine set_contact_thickness

end module deck_plane_stress_m
