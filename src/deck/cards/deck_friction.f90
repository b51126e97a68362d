! SPDX-License-Identifier: MIT
!> Friction of interfaces: fields of contact cards, and the defaults of *CONTROL_CONTACT.
module deck_friction_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use contacts_m, only : contact_t, friction_rule_t, has_friction
  use deck_lines_m, only : deck_t, location_t, line_warning
  use deck_fields_m, only : card_t, smallest_value
  use deck_cards_m, only : report_field, warn_of_field
  use deck_values_m, only : real_of, is_bad, location_of
  implicit none
  private
  public :: read_friction, read_stock_friction, read_penalty_friction, read_friction_rule, &
    warn_of_unused, warn_of_rule, default_friction_t

  !> Friction of *CONTROL_CONTACT.
  type :: default_friction_t
    type(friction_rule_t) :: rule
    type(location_t) :: location !! of SFRIC, line 0 without the keyword
    logical :: acts = .false.    !! used by an interface
  end type default_friction_t

contains

  !> *CONTACT_2D_SLIDELINE: FD 0 means FS.
  subroutine read_friction(cards, rule, location)
    type(card_t), intent(in) :: cards(:)
    type(friction_rule_t), intent(inout) :: rule
    type(location_t), intent(out) :: location       !! of the coefficient

    call read_friction_rule(cards(1), cards(3), ['FS', 'FD', 'DC', 'VC'], rule, location)
    if (.not. abs(real_of(cards(1), 'FD')) > 0.0_wp) rule%sliding = rule%at_rest
    rule%stiffness = real_of(cards(3), 'TFAC')
  end subroutine read_friction

  !> *CONTACT_2D_AUTOMATIC_: the default is the friction of *CONTROL_CONTACT.
  subroutine read_stock_friction(cards, default, rule, location)
    type(card_t), intent(in) :: cards(:)
    type(default_friction_t), intent(inout) :: default
    type(friction_rule_t), intent(inout) :: rule
    type(location_t), intent(out) :: location       !! of the coefficient

    call read_friction_rule(cards(1), cards(3), ['FS', 'FD', 'DC', 'VC'], rule, location)
    if (max(abs(rule%at_rest), abs(rule%sliding), abs(rule%decay), abs(rule%most)) > 0.0_wp) return
    default%acts = .true.
    if (.not. max(default%rule%at_rest, default%rule%sliding) > 0.0_wp) return
    rule = default%rule
    location = default%location
  end subroutine read_stock_friction

  !> Read static and dynamic coefficient, decay and largest traction, and the location of the
  !> coefficient. A dynamic coefficient of 0 is replaced by the smallest number, since 0 means FS on
  !> *CONTACT_2D_SLIDELINE: a rewritten card then gives the same bits.
  subroutine read_friction_rule(card, last, names, rule, location)
    type(card_t), intent(in) :: card, last     !! of the first three, of the stress
    character(*), intent(in) :: names(4)
    type(friction_rule_t), intent(inout) :: rule
    type(location_t), intent(out) :: location

    rule%at_rest = real_of(card, trim(names(1)))
    rule%sliding = real_of(card, trim(names(2)))
    if (rule%at_rest > 0.0_wp .and. .not. abs(rule%sliding) > 0.0_wp) rule%sliding = smallest_value
    rule%decay = real_of(card, trim(names(3)))
    rule%most = real_of(last, trim(names(4)))
    location = location_of(card, trim(names(1)))
    if (rule%sliding > 0.0_wp .and. .not. rule%at_rest > 0.0_wp) &
      location = location_of(card, trim(names(2)))
  end subroutine read_friction_rule

  !> *CONTACT_2D_PENALTY_FRICTION: FRIC, FRIC_L and FRIC_H must be equal or 0, since the card has no
  !> decay coefficient.
  subroutine read_penalty_friction(deck, card, rule, location)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(friction_rule_t), intent(inout) :: rule
    type(location_t), intent(out) :: location       !! of the coefficient
    character(6), parameter :: names(3) = ['FRIC  ', 'FRIC_L', 'FRIC_H']
    integer :: i

    location = location_of(card, names(1))
    do i = 1, size(names)
      if (is_bad(card, names(i)) .or. .not. real_of(card, names(i)) > 0.0_wp) cycle
      if (.not. rule%at_rest > 0.0_wp) then
        rule%at_rest = real_of(card, names(i))
        location = location_of(card, names(i))
      else if (abs(real_of(card, names(i)) - rule%at_rest) > 0.0_wp) then
        call report_field(deck, card, names(i), 'is not '//trim(location%name) &
          //' "'//to_text(rule%at_rest)//'", and the card does not say at which speeds they ' &
          //'act; *CONTACT_2D_SLIDELINE has FS, FD and the decay DC')
      end if
    end do
    rule%sliding = rule%at_rest
  end subroutine read_penalty_friction

  !> Warn of friction of *CONTROL_CONTACT that no interface uses.
  subroutine warn_of_unused(deck, default)
    type(deck_t), intent(inout) :: deck
    type(default_friction_t), intent(in) :: default

    if (max(default%rule%at_rest, default%rule%sliding) > 0.0_wp .and. .not. default%acts) &
      call warn_of_field(deck, default%location, 'has no effect here: it is the friction of ' &
      //'*CONTACT_2D_AUTOMATIC_ cards that have none (FS, FD, DC and VC 0)')
  end subroutine warn_of_unused

  !> Warn of unusual coefficients.
  subroutine warn_of_rule(deck, line, contact)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line               !! of the coefficient
    type(contact_t), intent(in) :: contact
    character(:), allocatable :: id

    id = to_text(contact%id)
    associate (rule => contact%friction)
      if (rule%sliding > max(0.0_wp, rule%at_rest)) call line_warning(deck, line, &
        'friction rises'//id, 'the dynamic coefficient of friction (FD) of interface ' &
        //id//', "'//to_text(rule%sliding)//'", is above the static one (FS), "' &
        //to_text(rule%at_rest)//'"')
      if (abs(rule%sliding - rule%at_rest) > 0.0_wp .and. rule%sliding > smallest_value .and. &
        .not. rule%decay > 0.0_wp) call line_warning(deck, line, 'friction decay'//id, &
        'without a decay (DC) the friction of interface '//id//' is static (FS) at any speed: ' &
        //'the dynamic coefficient (FD) has no effect')
      if (rule%most > 0.0_wp .and. .not. has_friction(contact)) call line_warning(deck, &
        line, 'friction cap'//id, 'the limit of the friction stress (VC) of interface '//id &
        //' has no effect without a coefficient of friction (FS)')
    end associate
  end subroutine warn_of_rule

end module deck_friction_m
