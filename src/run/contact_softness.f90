! SPDX-License-Identifier: MIT
!> Whether the springs of an interface have a part in the answer: what they store beside the bodies
!> that they hold apart (doc/theory/contact.md, section 8.2). Followed at instants that are written.
module contact_softness_m
  use law_state_m, only : contact_estimate_t
  use contact_facets_m, only : follow_arcs, report_facets
  use contacts_m, only : contact_t, is_tied, told_as, penalty_factor, penalty_share, &
    penalty_implicit
  use controls_m, only : controls_t, contact_step_rules
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use log_m, only : log_t, warn, write_log, to_text, percent
  use model_m, only : model_t
  use snapshot_m, only : part_result_t
  use state_m, only : state_t
  implicit none
  private
  public :: follow_softness, report_softness

  !> Part of the internal energy of the bodies from which on what springs stored is told.
  real(wp), parameter :: noticed_part = 0.1_wp
  !> Compliance of springs, over that of a row of elements on either side, below which stiffer ones
  !> take little away; a penalty that is named goes to half of it at most.
  real(wp), parameter :: stiff = 0.5_wp
  !> Ratio of bulk moduli from which on one body is hard beside the other: 10, less round-off.
  real(wp), parameter :: much_harder = 9.999_wp

contains

  !> Follow all interfaces: the largest energies of their springs and of the bodies on both sides,
  !> which have none yet at time zero, and the facets of curved surfaces.
  subroutine follow_softness(model, parts, bodies, state)
    type(model_t), intent(in) :: model
    type(part_result_t), intent(in) :: parts(:)      !! their internal energies are known
    integer, allocatable, intent(inout) :: bodies(:) !! (n_part) found in the first call
    type(state_t), intent(inout) :: state
    integer :: i

    do i = 1, size(model%contacts)
      if (is_tied(model%contacts(i))) cycle
      if (.not. allocated(bodies)) call find_bodies(model, bodies)
      associate (contact => model%contacts(i), memory => state%contacts(i), &
        estimate => state%estimates(told_as(model%contacts, i)))
        call follow_arcs(state%outlines(i), memory, estimate)
        if (state%cycle == 0) cycle
        estimate%bodies = max(estimate%bodies, internal_energy(parts, &
          of_bodies(bodies, parts_behind(model, contact))))
        estimate%stored = max(estimate%stored, memory%watch%stored)
      end associate
    end do
  end subroutine follow_softness

  !> Internal energy of some parts, J/m.
  pure real(wp) function internal_energy(parts, is_some)
    type(part_result_t), intent(in) :: parts(:)
    logical, intent(in) :: is_some(:) !! (n_part)
    integer :: i

    internal_energy = 0.0_wp
    do i = 1, size(parts)
      if (is_some(i)) internal_energy = internal_energy + parts(i)%internal
    end do
  end function internal_energy

  !> Bodies: parts that share nodes, or are tied to each other, have one number.
  pure subroutine find_bodies(model, bodies)
    type(model_t), intent(in) :: model
    integer, allocatable, intent(out) :: bodies(:) !! (n_part)
    integer, allocatable :: first(:) !! (n_node) part that a node was first met in
    logical :: is_joined(size(model%parts))
    integer :: i, k, slot, part

    bodies = [(i, i=1, size(model%parts))]
    allocate (first(model%mesh%n_node), source=0)
    do slot = 1, model%layout%n_slot
      if (model%layout%slot_element(slot) == 0) cycle
      part = slot_part(model%layout, slot)
      do k = 1, size(model%layout%slot_nodes, 1)
        associate (node => model%layout%slot_nodes(k, slot))
          if (first(node) == 0) first(node) = part
          if (bodies(first(node)) == bodies(part)) cycle
          where (bodies == bodies(part)) bodies = bodies(first(node))
        end associate
      end do
    end do
    do i = 1, size(model%contacts)
      if (.not. is_tied(model%contacts(i))) cycle
      is_joined = of_bodies(bodies, parts_behind(model, model%contacts(i)))
      where (is_joined) bodies = minval(bodies, mask=is_joined)
    end do
  end subroutine find_bodies

  !> Which parts are behind the surfaces of an interface.
  pure function parts_behind(model, contact) result(is_behind)
    type(model_t), intent(in) :: model
    type(contact_t), intent(in) :: contact
    logical :: is_behind(size(model%parts))
    integer :: s

    is_behind = .false.
    do s = 1, contact%slave%n_segment
      is_behind(slot_part(model%layout, model%layout%element_slot( &
        contact%slave%segment_element(s)))) = .true.
    end do
    do s = 1, contact%master%n_segment
      is_behind(slot_part(model%layout, model%layout%element_slot( &
        contact%master%segment_element(s)))) = .true.
    end do
  end function parts_behind

  !> Which parts are of the bodies that some of them belong to.
  pure function of_bodies(bodies, is_some) result(is_of)
    integer, intent(in) :: bodies(:)  !! (n_part)
    logical, intent(in) :: is_some(:) !! (n_part)
    logical :: is_of(size(bodies))
    logical :: is_body(size(bodies))
    integer :: i

    is_body = .false.
    do i = 1, size(bodies)
      if (is_some(i)) is_body(bodies(i)) = .true.
    end do
    is_of = is_body(bodies)
  end function of_bodies

  !> At the end: interfaces whose springs stored much beside the bodies, and those whose pressure is
  !> made by facets. Implicit springs without compliance store nothing and have no penetration.
  subroutine report_softness(model, state, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(log_t), intent(inout) :: log
    integer :: i

    if (log%is_mute) return ! the first process alone knows the parts of all elements
    do i = 1, size(state%estimates)
      associate (estimate => state%estimates(i), contact => model%contacts(i))
        if (contact%penalty_unit == penalty_implicit .and. &
          .not. state%contacts(i)%slave_penalty > 0.0_wp) cycle
        if (estimate%bodies > 0.0_wp .and. estimate%stored > noticed_part*estimate%bodies) &
          call tell_softness(model, contact, estimate, log)
        call report_facets(contact, estimate, log)
      end associate
    end do
  end subroutine report_softness

  !> One interface whose springs stored much. Like bodies part as if both were softer; of a hard one
  !> on a soft one the springs give back what the soft one would in part have kept, and the rebound
  !> is wrong: a warning, unless the springs are stiff beside the elements, too coarse ones then.
  subroutine tell_softness(model, contact, estimate, log)
    type(model_t), intent(in) :: model
    type(contact_t), intent(in) :: contact
    type(contact_estimate_t), intent(in) :: estimate
    type(log_t), intent(inout) :: log
    character(:), allocatable :: text

    text = 'interface '//to_text(contact%id)//': its springs have stored up to ' &
      //to_text(estimate%stored)//', '//percent(estimate%stored, estimate%bodies) &
      //' of the largest internal energy of the bodies on both sides, ' &
      //to_text(estimate%bodies)
    if (estimate%softness > stiff .and. has_unlike_bodies(model, contact)) then
      call warn(log, text//': springs give back all of it, of which the soft body would keep a ' &
        //'part, so that the hard one goes in deeper and may rebound faster than it should; ' &
        //remedy(model%controls, contact, estimate))
    else
      call write_log(log, text//'; '//remedy(model%controls, contact, estimate))
    end if
  end subroutine tell_softness

  !> Whether one of the parts behind the surfaces is rigid, or much harder than another.
  pure function has_unlike_bodies(model, contact) result(has)
    type(model_t), intent(in) :: model
    type(contact_t), intent(in) :: contact
    logical :: has

    logical :: is_behind(size(model%parts))
    real(wp) :: softest, hardest
    integer :: i

    is_behind = parts_behind(model, contact)
    has = .false.
    softest = huge(1.0_wp)
    hardest = 0.0_wp
    do i = 1, size(model%parts)
      if (.not. is_behind(i)) cycle
      associate (material => model%materials(model%parts(i)%material))
        has = has .or. material%is_rigid
        softest = min(softest, material%bulk)
        hardest = max(hardest, material%bulk)
      end associate
    end do
    has = has .or. hardest >= much_harder*softest
  end function has_unlike_bodies

  !> The penalty whose springs would store no more than that part, and the step that bears it. By a
  !> given force their energy goes with the power -1 of their stiffness, by blows of a hard block on
  !> a soft one -0.64, and less where rows are coarse: no penalty makes less what the first row of
  !> nodes takes.
  pure function remedy(controls, contact, estimate) result(text)
    type(controls_t), intent(in) :: controls
    type(contact_t), intent(in) :: contact
    type(contact_estimate_t), intent(in) :: estimate
    character(:), allocatable :: text
    real(wp) :: factor

    text = 'finer elements would take more of it'
    if (.not. estimate%softness > stiff) return
    factor = min((estimate%stored/(noticed_part*estimate%bodies))**2, &
      2.0_wp*estimate%softness/stiff)
    associate (wanted => factor*contact%penalty)
      text = 'PEN '//to_text(wanted)//' would do'
      if (contact%penalty_unit == penalty_factor) text = 'SFACT '//to_text(wanted) &
        //', or PEN with PUNIT 2, would do'
      if (contact%penalty_unit == penalty_share .and. wanted > 1.0_wp) text = &
        'a penalty '//to_text(factor)//' times as large would do'
    end associate
    if (.not. controls%implicit%is_on .and. controls%contact_step /= contact_step_rules) &
      text = text//', with the step of the springs (ECDT 2 of *CONTROL_CONTACT)'
  end function remedy

end module contact_softness_m
