! SPDX-License-Identifier: MIT
!> Whether a run ends before its end time (*TERMINATION_NODE, _BODY, _CONTACT), and why.
module early_end_m
  use contacts_m, only : told_as
  use controls_m, only : end_condition_t, end_node_place, end_node_touch, end_body_place, &
    end_body_way, end_contact
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use state_m, only : state_t
  implicit none
  private
  public :: find_early_end

contains

  !> Whether the run ends now, and why. Places are those of the state, contact forces the last ones
  !> known. The first condition of the deck that holds is told.
  subroutine find_early_end(model, state, last, reason)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    logical, intent(inout) :: last   !! the run ends anyway; or for a condition of the deck
    character(:), allocatable, intent(inout) :: reason !! of the end
    character(:), allocatable :: found
    real(wp) :: way
    integer :: i

    if (.not. allocated(model%controls%ends)) return
    do i = 1, size(model%controls%ends)
      associate (ending => model%controls%ends(i))
        found = ''
        select case (ending%kind)
        case (end_node_place)
          found = beyond('node '//to_text(ending%id)//' has come to ', '', &
            model%mesh%coordinates(ending%direction, ending%where) &
            + state%motion(ending%direction, ending%where), ending, ' (*TERMINATION_NODE)')
        case (end_node_touch)
          if (norm2(force_on(state, ending%where)) > 0.0_wp) found = 'node '// &
            to_text(ending%id)//' is in contact (*TERMINATION_NODE)'
        case (end_body_place)
          found = beyond('body '//to_text(ending%id)//' has gone to ', 'displacement ', &
            state%rigids(ending%where)%place(ending%direction), ending, ' (*TERMINATION_BODY)')
        case (end_body_way)
          way = norm2(state%rigids(ending%where)%place(1:2))
          if (way >= ending%most) found = 'body '//to_text(ending%id)//' has gone ' &
            //to_text(way)//' (*TERMINATION_BODY)'
        case (end_contact)
          call judge_contact(model, ending, state, state%quiet_since(i), found)
        end select
      end associate
      if (len(found) == 0 .or. last) cycle
      last = .true.
      reason = found
    end do
  end subroutine find_early_end

  !> What is said of a value at or beyond its bounds; empty within them.
  pure function beyond(what, of, value, ending, keyword) result(found)
    character(*), intent(in) :: what, of, keyword
    real(wp), intent(in) :: value
    type(end_condition_t), intent(in) :: ending
    character(:), allocatable :: found

    found = ''
    if (value > ending%least .and. value < ending%most) return
    found = what//of//merge('x', 'y', ending%direction == 1)//' = '//to_text(value)//keyword
  end function beyond

  !> An interface that has borne no force for long enough.
  subroutine judge_contact(model, ending, state, since, found)
    type(model_t), intent(in) :: model
    type(end_condition_t), intent(in) :: ending
    type(state_t), intent(in) :: state
    real(wp), intent(inout) :: since
    character(:), allocatable, intent(inout) :: found
    real(wp) :: force(2)
    integer :: i

    if (state%time < ending%start) return
    force = 0.0_wp
    do i = 1, size(model%contacts)
      if (told_as(model%contacts, i) /= ending%where) cycle
      associate (memory => state%contacts(i))
        force = force + sum(memory%force(:, :memory%n_slave), 2)
      end associate
    end do
    if (ending%direction > 0) force(3 - ending%direction) = 0.0_wp
    if (norm2(force) > ending%threshold) then
      since = -1.0_wp
      return
    end if
    if (since < 0.0_wp) since = state%time
    if (state%time - since >= ending%duration) found = 'interface '//to_text(ending%id) &
      //' bears no force (*TERMINATION_CONTACT)'
  end subroutine judge_contact

  !> Contact force on a node.
  pure function force_on(state, node) result(force)
    type(state_t), intent(in) :: state
    integer, intent(in) :: node
    real(wp) :: force(2)
    integer :: i, k

    force = 0.0_wp
    do i = 1, size(state%contacts)
      do k = 1, size(state%contacts(i)%nodes)
        if (state%contacts(i)%nodes(k) == node) force = force + state%contacts(i)%force(:, k)
      end do
    end do
  end function force_on

end module early_end_m
