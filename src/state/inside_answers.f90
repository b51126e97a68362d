! SPDX-License-Identifier: MIT
!> Whether places lie inside of bodies, as the first search of interfaces asks in its order. Of
!> several processes the first one has the bodies and keeps the answers; the others are given them.
module inside_answers_m
  implicit none
  private
  public :: answers_t

  !> Those of all interfaces.
  type :: answers_t
    logical :: are_given = .false.
    integer :: n = 0                     !! asked for so far
    logical, allocatable :: is_inside(:) !! with room for more where they are kept
  end type answers_t

end module inside_answers_m
