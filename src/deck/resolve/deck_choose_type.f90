! SPDX-License-Identifier: MIT
!> CTYPE 0: the program chooses the contact type, once, from how the scene stands in the published
!> studies (doc/choose.md). The effective deck has the type chosen, so that a restart keeps it.
module deck_choose_type_m
  use conditions_m, only : conditions_t
  use contact_types_m, only : type_nts_ar, type_nts_mar, type_segmented_mortar
  use contacts_m, only : contact_t, has_friction, is_tied, penalty_factor, penalty_share, &
    penalty_implicit, tie_factor
  use deck_contact_values_m, only : leaves_type
  use deck_lines_m, only : deck_t
  use deck_override_apply_m, only : contact_text
  use deck_raw_m, only : raw_contact_t
  use kinds_m, only : wp
  use model_m, only : model_t
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: choose_type

  !> By how much faces that are flat may be uneven, and nodes that match be apart, over a segment.
  real(wp), parameter :: exactly = 1.0e-6_wp
  !> Part of a motion along faces from which on they are led along each other.
  real(wp), parameter :: aside = 0.1_wp

contains

  !> Choose for one interface that asks for it.
  subroutine choose_type(deck, entry, model, contact)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    type(model_t), intent(in) :: model
    type(contact_t), intent(inout) :: contact
    type(raw_contact_t) :: chosen

    if (.not. leaves_type(contact)) return
    call decide(model, contact)
    if (.not. abs(contact%penalty) > 0.0_wp) call take_penalty(model%controls%implicit%is_on, &
      contact)
    chosen = entry
    chosen%contact%contact_type = contact%contact_type
    chosen%contact%penalty_unit = contact%penalty_unit
    chosen%contact%penalty = contact%penalty
    chosen%contact%master_penalty = contact%master_penalty
    deck%blocks(entry%block)%replacement = contact_text(chosen)
  end subroutine choose_type

  !> The penalty where the deck has none: the largest that an explicit step bears; K L/A of implicit
  !> runs and ties, up to which contact costs next to nothing.
  pure subroutine take_penalty(is_implicit, contact)
    logical, intent(in) :: is_implicit
    type(contact_t), intent(inout) :: contact

    if (is_implicit .or. is_tied(contact)) then
      contact%penalty_unit = penalty_factor
      contact%penalty = tie_factor
    else
      contact%penalty_unit = penalty_share
      contact%penalty = 1.0_wp
    end if
    contact%master_penalty = contact%penalty
  end subroutine take_penalty

  !> The type and the reason, the first that holds.
  subroutine decide(model, contact)
    type(model_t), intent(in) :: model
    type(contact_t), intent(inout) :: contact
    real(wp) :: along(2)

    along = chord(model, contact%slave)
    if (contact%penalty_unit == penalty_implicit) then
      call take(type_segmented_mortar, 'implicit springs (PUNIT 4) are its own')
    else if (contact%strict) then
      call take(type_nts_mar, 'the strict rule (IPF 1) is its own')
    else if (is_tied(contact)) then
      call take(type_nts_mar, 'ties of uneven meshes are exact with it')
    else if (has_friction(contact)) then
      call take(type_segmented_mortar, 'with friction its force is the smoothest')
    else if (is_led(model%conditions, along)) then
      call take(type_segmented_mortar, 'a motion leads along the faces, and its force is the ' &
        //'smoothest')
    else if (is_at_rest(model, contact, along) .and. match(model, contact, along)) then
      call take(type_nts_ar, 'the faces are flat, match and stay beside each other: the cheapest ' &
        //'that is exact then')
    else
      call take(type_nts_mar, 'exact pressure on any mesh')
    end if

  contains

    !> Keep what was decided.
    subroutine take(contact_type, reason)
      integer, intent(in) :: contact_type
      character(*), intent(in) :: reason

      contact%contact_type = contact_type
      contact%reason = reason
    end subroutine take

  end subroutine decide

  !> Unit vector from the first to the last node of a surface that is one open chain; else none.
  pure function chord(model, surface) result(along)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    real(wp) :: along(2)

    along = 0.0_wp
    if (count(surface%previous == 0) /= 1) return
    associate (x => model%mesh%coordinates, nodes => surface%nodes)
      along = x(:, nodes(size(nodes))) - x(:, nodes(1))
    end associate
    if (norm2(along) > 0.0_wp) along = along/norm2(along)
  end function chord

  !> Whether prescribed motion, of nodes or rigid bodies, leads along the faces.
  pure function is_led(conditions, along)
    type(conditions_t), intent(in) :: conditions
    real(wp), intent(in) :: along(2)
    logical :: is_led
    integer :: i

    is_led = .false.
    do i = 1, size(conditions%motions)
      is_led = is_led .or. abs(along(conditions%motions(i)%direction)) > aside
    end do
    do i = 1, size(conditions%rigid_motions)
      associate (direction => conditions%rigid_motions(i)%direction)
        if (direction <= 2) is_led = is_led .or. abs(along(min(direction, 2))) > aside
      end associate
    end do
  end function is_led

  !> Whether nothing starts or pulls one face along the other: initial velocities, loads on nodes,
  !> edges and bodies, base acceleration.
  pure function is_at_rest(model, contact, along) result(at_rest)
    type(model_t), intent(in) :: model
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: along(2)
    logical :: at_rest
    real(wp) :: v(2)
    integer :: i

    associate (given => model%conditions)
      at_rest = .not. (any(abs(along(given%nodal_loads%direction)) > aside) &
        .or. any(abs(along(given%body_loads%direction)) > aside))
      if (allocated(given%rigid_loads)) at_rest = at_rest .and. size(given%rigid_loads) == 0
      do i = 1, size(given%pressures)
        associate (ends => model%mesh%coordinates(:, given%pressures(i)%nodes))
          ! A pressure acts across its edge.
          at_rest = at_rest .and. abs(along(2)*(ends(1, 2) - ends(1, 1)) &
            - along(1)*(ends(2, 2) - ends(2, 1))) <= aside*norm2(ends(:, 2) - ends(:, 1))
        end associate
      end do
      do i = 1, size(model%rigids)
        if (model%rigids(i)%has_velocity) at_rest = at_rest .and. abs(dot_product( &
          model%rigids(i)%velocity(1:2), along)) <= aside*norm2(model%rigids(i)%velocity)
      end do
      if (.not. allocated(given%initial_velocity)) return
      v = sum(given%initial_velocity(:, contact%slave%nodes), 2)/size(contact%slave%nodes) &
        - sum(given%initial_velocity(:, contact%master%nodes), 2)/size(contact%master%nodes)
      at_rest = at_rest .and. abs(dot_product(v, along)) <= exactly*maxval(abs( &
        given%initial_velocity))
    end associate
  end function is_at_rest

  !> Whether each node of the slave stands before one of the master, neighbours before neighbours,
  !> both on straight lines side by side. The chains run against each other.
  pure function match(model, contact, along)
    type(model_t), intent(in) :: model
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: along(2)
    logical :: match
    real(wp) :: across(2), apart(2), tolerance, gap
    integer :: i, k, former

    match = .false.
    if (.not. norm2(along) > 0.0_wp) return
    across = [along(2), -along(1)]
    associate (x => model%mesh%coordinates, slave => contact%slave%nodes, &
      master => contact%master%nodes)
      tolerance = exactly*norm2(x(:, slave(size(slave))) - x(:, slave(1)))/size(slave)
      k = size(master)
      do i = 1, size(slave)
        former = k
        do while (k > 1)
          if (.not. dot_product(x(:, master(k)) - x(:, slave(i)), along) < -tolerance) exit
          k = k - 1
        end do
        apart = x(:, master(k)) - x(:, slave(i))
        if (i == 1) gap = dot_product(apart, across)
        ! Nodes of a finer master between would get no force.
        if (i > 1 .and. k /= former - 1) return
        if (abs(dot_product(apart, along)) > tolerance) return
        if (abs(dot_product(apart, across) - gap) > tolerance) return
        if (abs(dot_product(x(:, slave(i)) - x(:, slave(1)), across)) > tolerance) return
      end do
    end associate
    match = .true.
  end function match

end module deck_choose_type_m
