! SPDX-License-Identifier: MIT
!> Values of an interface that the command line may give in place of the card: which one counts, and
!> the rules that both must keep.
module deck_contact_values_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use contact_types_m, only : type_chosen
  use contacts_m, only : contact_t, contact_kind_t, kind_text, most_gauss, penalty_per_node, &
    penalty_distributed, penalty_share, penalty_implicit, implicit_factor
  use deck_lines_m, only : deck_t, deck_error
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, report_field
  use deck_values_m, only : has_field
  use deck_overrides_m, only : overrides_t, contact_names, override_text, override_phrase, &
    override_real, override_integer
  use deck_raw_m, only : raw_contact_t
  implicit none
  private
  public :: find_commanded, take_overrides, check_values, kind_names, leaves_type, name_of, &
    of_penalty, of_unit, of_master_penalty, of_damping

  !> Values by their place in `contact_names`.
  integer, parameter :: of_type = 1, of_gauss = 2, of_penalty = 3, of_unit = 4, &
    of_master_penalty = 5, of_damping = 6, of_target = 12

  !> Most damping, per cent of critical. The force goes with the velocity of half a step ago: with
  !> ten times critical damping the scene block-to-block breaks up.
  real(wp), parameter :: most_damping = 100.0_wp

contains

  !> Which values of an interface the command line gives.
  pure function find_commanded(overrides, id) result(commanded)
    type(overrides_t), intent(in) :: overrides
    integer, intent(in) :: id
    logical :: commanded(size(contact_names))
    integer :: k

    do k = 1, size(contact_names)
      commanded(k) = len(override_text(overrides, trim(contact_names(k)), id)) > 0
    end do
  end function find_commanded

  !> Put the values of the command line in place of those of the deck. PENT follows PEN where the
  !> deck makes them the same.
  pure subroutine take_overrides(overrides, entry)
    type(overrides_t), intent(in) :: overrides
    type(raw_contact_t), intent(inout) :: entry
    logical :: given(size(contact_names)), follows

    given = .false.
    associate (contact => entry%contact, id => entry%contact%id)
      follows = .not. abs(contact%master_penalty - contact%penalty) > 0.0_wp
      call override_integer(overrides, 'CTYPE', id, contact%contact_type, given(of_type))
      call override_integer(overrides, 'NGAUSS', id, contact%n_gauss, given(of_gauss))
      call override_real(overrides, 'PEN', id, contact%penalty, given(of_penalty))
      if (follows) contact%master_penalty = contact%penalty
      call override_real(overrides, 'PENT', id, contact%master_penalty, given(of_master_penalty))
      call override_integer(overrides, 'PUNIT', id, contact%penalty_unit, given(of_unit))
      call override_real(overrides, 'VDC', id, entry%per_cent, given(of_damping))
      contact%damping = entry%per_cent/100.0_wp
      ! A type that the command line names is not the program's to change.
      if (given(of_type) .and. .not. leaves_type(contact)) contact%target = 0.0_wp
      call override_real(overrides, 'TARGET', id, contact%target, given(of_target))
      if (contact%penalty_unit == penalty_implicit .and. .not. abs(contact%penalty) > 0.0_wp) &
        contact%penalty = implicit_factor
      contact%chosen_by_keyword = contact%chosen_by_keyword .and. .not. given(of_type)
      entry%unit_phrase = override_phrase(overrides, 'PUNIT', id)
      if (given(of_unit)) entry%unit_place%line = 0
      entry%overridden = any(given)
    end associate
  end subroutine take_overrides

  !> The rules of all values, wherever they come from.
  subroutine check_values(deck, cursor, cards, kinds, overrides, commanded, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: cards(:)
    type(contact_kind_t), intent(in) :: kinds(:)
    type(overrides_t), intent(in) :: overrides
    logical, intent(in) :: commanded(:)  !! values that the command line gives
    type(raw_contact_t), intent(in) :: entry

    associate (contact => entry%contact)
      if (.not. any([type_chosen, kinds%number] == contact%contact_type)) call refuse(of_type, &
        'is not a contact type'//kind_names(kinds))
      if (contact%n_gauss < 1 .or. contact%n_gauss > most_gauss) call refuse(of_gauss, &
        'is not a number of Gauss points from 1 to '//to_text(most_gauss))
      if (contact%penalty <= 0.0_wp .and. contact%penalty_unit /= penalty_implicit &
        .and. .not. leaves_penalty(contact)) &
        call refuse(of_penalty, 'is not a penalty (more than 0)')
      if (contact%penalty_unit < penalty_per_node .or. contact%penalty_unit > penalty_implicit) &
        call refuse(of_unit, 'is not a unit of the penalty (0 force per length at each contact ' &
        //'node, 1 stress, 2 factor on the built-in estimate, 3 share of the largest stable ' &
        //'one, 4 factor on K L/A of implicit springs)')
      if (contact%penalty_unit == penalty_implicit .and. any(kinds%number == contact%contact_type &
        .and. .not. kinds%has_implicit_springs)) call refuse(of_unit, &
        'asks for implicit springs'//implicit_names(kinds))
      if (contact%target < 0.0_wp .or. contact%target >= 1.0_wp) call refuse(of_target, &
        'is not a target of the estimate of contact (above 0, below 1)')
      if (commanded(of_target) .and. .not. leaves_type(contact)) call refuse(of_target, &
        'is for types that the program chooses (CTYPE 0); interface '//to_text(contact%id) &
        //' has '//name_of(kinds, contact%contact_type))
      if (entry%per_cent < 0.0_wp) call refuse(of_damping, 'is negative')
      if (entry%per_cent > most_damping) call refuse(of_damping, &
        'is not a damping in per cent of critical (0 to 100)')
      if (contact%penalty_unit == penalty_share .and. contact%penalty > 1.0_wp) call refuse_share()
    end associate

  contains

    !> A penalty that is no share: PEN and PUNIT may come from different places.
    subroutine refuse_share()
      character(:), allocatable :: given

      if (commanded(of_penalty) .or. commanded(of_unit)) then
        given = override_phrase(overrides, 'PEN', entry%contact%id)
        if (all(commanded([of_penalty, of_unit]))) given = given//' and '
        call deck_error(deck, 'with '//given//entry%unit_phrase//' the penalty "' &
          //to_text(entry%contact%penalty)//'" is not a share of the largest stable one ' &
          //'(punit=3: pen= above 0, at most 1)')
      else
        call refuse(of_penalty, &
          'is not a share of the largest stable penalty (PUNIT 3: above 0, at most 1)')
      end if
    end subroutine refuse_share

    !> An error of a value where it was given: fields have the names of the command line. A keyword
    !> without such a field gives the value itself.
    subroutine refuse(k, message)
      integer, intent(in) :: k
      character(*), intent(in) :: message
      integer :: i

      if (commanded(k)) then
        call deck_error(deck, override_phrase(overrides, contact_names(k), entry%contact%id) &
          //' '//message)
        return
      end if
      do i = 1, cursor%n_card
        if (has_field(cards(i), contact_names(k))) call report_field(deck, cursor, cards(i), &
          contact_names(k), message)
      end do
    end subroutine refuse

  end subroutine check_values

  !> The name of a type, or its number where there is none.
  pure function name_of(kinds, number) result(text)
    type(contact_kind_t), intent(in) :: kinds(:)
    integer, intent(in) :: number
    character(:), allocatable :: text
    integer :: i

    text = 'type '//to_text(number)
    do i = 1, size(kinds)
      if (kinds(i)%number == number) text = kind_text(kinds(i))
    end do
  end function name_of

  !> Whether the type is the program's to choose.
  pure function leaves_type(contact) result(leaves)
    type(contact_t), intent(in) :: contact
    logical :: leaves

    leaves = type_chosen == contact%contact_type
  end function leaves_type

  !> Whether the penalty is the program's to choose, with the type.
  pure function leaves_penalty(contact) result(leaves)
    type(contact_t), intent(in) :: contact
    logical :: leaves

    leaves = leaves_type(contact) .and. .not. abs(contact%penalty) > 0.0_wp &
      .and. contact%penalty_unit /= penalty_distributed
  end function leaves_penalty

  !> `, which only name (type n) has`.
  pure function implicit_names(kinds) result(text)
    type(contact_kind_t), intent(in) :: kinds(:)
    character(:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(kinds)
      if (.not. kinds(i)%has_implicit_springs) cycle
      if (len(text) > 0) text = text//' and '
      text = text//kind_text(kinds(i))
    end do
    text = ', which only '//text//' has (CTYPE)'
  end function implicit_names

  !> ` (1 name, 2 name, ...)`.
  pure function kind_names(kinds) result(text)
    type(contact_kind_t), intent(in) :: kinds(:)
    character(:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(kinds)
      text = text//merge(' (', ', ', i == 1)//to_text(kinds(i)%number)//' '//trim(kinds(i)%name)
    end do
    if (size(kinds) > 0) text = text//')'
  end function kind_names

end module deck_contact_values_m
