! SPDX-License-Identifier: MIT
!> Numbers of the contact types (CTYPE): the deck layer maps stock keywords to them, the contact
!> dispatcher has a row for each.
module contact_types_m
  implicit none
  private

  integer, parameter, public :: type_nts = 1, type_nts_ar = 2, type_two_pass_ar = 3, &
    type_vts_ppt = 4, type_nts_mar = 5, type_mortar = 6, type_segmented_mortar = 7

  !> What stands in place of a type in decks: the program chooses; there is none.
  integer, parameter, public :: type_chosen = 0, type_missing = -1

end module contact_types_m
