! SPDX-License-Identifier: MIT
!> Keywords without the card that they need.
module deck_empty_m
  use deck_cards_m, only : cursor_t, open_cursor
  use deck_lines_m, only : deck_t, line_error, flag_blank
  implicit none
  private
  public :: check_empty

contains

  !> Whether a block lacks its first card, which is an error. A blank line is a card where a keyword
  !> has one card, and none where it has rows.
  subroutine check_empty(deck, i_block, is_empty)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    logical, intent(out) :: is_empty
    type(cursor_t) :: cursor
    character(:), allocatable :: fields
    integer :: k

    is_empty = .false.
    if (deck%blocks(i_block)%dropped .or. may_be_empty(deck%blocks(i_block)%name)) return
    associate (block => deck%blocks(i_block))
      is_empty = all(iand(deck%flags(block%first:block%last), flag_blank) /= 0)
      if (is_empty .and. block%last >= block%first) is_empty = has_rows(block%name)
    end associate
    if (.not. is_empty) return
    call open_cursor(deck, i_block, cursor)
    fields = ''
    associate (spec => cursor%specs(1))
      do k = 1, spec%n
        if (spec%names(k) /= '-') fields = fields//', '//trim(spec%names(k))
      end do
    end associate
    call line_error(deck, deck%blocks(i_block)%keyword, 'has no card; expected one with ' &
      //fields(3:))
  end subroutine check_empty

  !> Keywords whose defaults do, those whose rows are as many as there are of a mesh, and what has
  !> a message of its own.
  pure function may_be_empty(name) result(may)
    character(*), intent(in) :: name
    logical :: may

    select case (name)
    case ('TITLE', 'NODE', 'ELEMENT_SHELL', 'ELEMENT_BEAM', 'INITIAL_VELOCITY')
      may = .true.
    case default
      may = index(name, 'CONTROL_') == 1 .or. index(name, 'PARAMETER') == 1
    end select
  end function may_be_empty

  !> Keywords of rows of which blank ones do not count.
  pure function has_rows(name)
    character(*), intent(in) :: name
    logical :: has_rows
    integer :: i
    character(*), parameter :: heads(*) = [character(27) :: 'TERMINATION_', 'ELEMENT_MASS', &
      'BOUNDARY_', 'LOAD_', 'DAMPING_', 'INITIAL_VELOCITY_NODE', 'INITIAL_VELOCITY_RIGID_BODY', &
      'DATABASE_HISTORY_', 'DATABASE_NODAL_FORCE_GROUP', 'DATABASE_CROSS_SECTION_SET', &
      'CONSTRAINED_NODE_SET', 'PART']

    has_rows = .false.
    do i = 1, size(heads)
      has_rows = has_rows .or. index(name, trim(heads(i))) == 1
    end do
  end function has_rows

end module deck_empty_m
