! SPDX-License-Identifier: MIT
!> CTYPE 0: the program chooses the contact type when the deck is read, by the kind of scene and the
!> published studies (doc/choose.md): the recommended type, or the cheapest type within a target.
!> The effective deck contains the chosen type and the target, for restarts and repeated runs.
module deck_choose_type_m
  use contacts_m, only : type_nts_ar, type_nts_mar, type_segmented_mortar, type_chosen, &
    contact_t, has_friction, is_tied, penalty_factor, penalty_share, &
    penalty_implicit, tie_factor
  use deck_edits_m, only : set_field
  use deck_lines_m, only : deck_t
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use text_m, only : shortest
  use type_charts_m, only : scene_bound, scene_matching, scene_general, scene_sliding, &
    scene_friction, scene_names, estimates, cheapest_type
  implicit none
  private
  public :: choose_type

  !> Tolerance of flat faces and matching nodes, over the mean segment length.
  real(wp), parameter :: exactly = 1.0e-6_wp
  !> Tangential share of a motion or load from which on it counts as sliding.
  real(wp), parameter :: sliding_share = 0.1_wp
  !> Default target; types with a larger estimate do not represent the surface.
  real(wp), parameter :: default_target = 0.1_wp

contains

  !> Choose the type of an interface with CTYPE 0; set the kind of scene of one with a target.
  subroutine choose_type(deck, i_block, model, contact)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block       !! of the interface
    type(model_t), intent(in) :: model
    type(contact_t), intent(inout) :: contact
    logical :: has_target, is_chosen

    is_chosen = type_chosen == contact%contact_type
    has_target = contact%target > 0.0_wp
    if (has_target .or. is_chosen) contact%scene = scene_of(model, contact)
    if (.not. is_chosen) return
    if (has_target .and. contact%scene /= scene_bound) then
      call decide_by_charts(contact)
    else
      call decide_by_scene(contact)
    end if
    if (.not. has_target) contact%target = default_target
    if (.not. abs(contact%penalty) > 0.0_wp) then
      ! The largest penalty of a stable explicit step; K L/A of implicit runs and ties, up to which
      ! contact costs next to nothing.
      contact%penalty_unit = penalty_share
      contact%penalty = 1.0_wp
      if (model%controls%implicit%is_on .or. is_tied(contact)) then
        contact%penalty_unit = penalty_factor
        contact%penalty = tie_factor
      end if
      contact%master_penalty = contact%penalty
    end if
    ! The effective deck has the choice.
    call set_field(deck, i_block, 'CTYPE', to_text(contact%contact_type))
    call set_field(deck, i_block, 'PEN', shortest(contact%penalty))
    call set_field(deck, i_block, 'PUNIT', to_text(contact%penalty_unit))
    call set_field(deck, i_block, 'PENT', shortest(max(contact%master_penalty, 0.0_wp)))
    call set_field(deck, i_block, 'TARGET', shortest(contact%target))
  end subroutine choose_type

  !> The kind of scene; the first that applies.
  pure function scene_of(model, contact) result(scene)
    type(model_t), intent(in) :: model
    type(contact_t), intent(in) :: contact
    integer :: scene
    real(wp) :: along(2)

    ! Unit vector from the first to the last node of a surface of one open chain; else zero.
    along = 0.0_wp
    associate (x => model%mesh%coordinates, nodes => contact%slave%nodes)
      if (count(contact%slave%previous == 0) == 1) along = x(:, nodes(size(nodes))) - x(:, nodes(1))
    end associate
    if (norm2(along) > 0.0_wp) along = along/norm2(along)
    associate (given => model%conditions)
      if (contact%penalty_unit == penalty_implicit .or. contact%strict .or. is_tied(contact)) then
        scene = scene_bound
      else if (has_friction(contact)) then
        scene = scene_friction
      else if (any(abs(along(given%motions%direction)) > sliding_share) &
        .or. any(abs(along(pack([given%rigid_motions%direction], &
        given%rigid_motions%direction <= 2))) > sliding_share)) then
        ! Prescribed motion of nodes or rigid bodies along the faces.
        scene = scene_sliding
      else if (is_at_rest(model, contact, along) .and. match(model, contact, along)) then
        scene = scene_matching
      else
        scene = scene_general
      end if
    end associate
  end function scene_of

  !> Choose the type by the kind of scene, without a target.
  pure subroutine decide_by_scene(contact)
    type(contact_t), intent(inout) :: contact

    contact%contact_type = type_nts_mar
    select case (contact%scene)
    case (scene_friction)
      contact%contact_type = type_segmented_mortar
      contact%reason = 'smoothest forces with friction'
    case (scene_sliding)
      contact%contact_type = type_segmented_mortar
      contact%reason = 'smoothest forces in prescribed sliding'
    case (scene_matching)
      contact%contact_type = type_nts_ar
      contact%reason = 'flat matching faces without sliding: the cheapest exact type'
    case (scene_general)
      contact%reason = 'exact pressure on any mesh'
    case default
      if (contact%penalty_unit == penalty_implicit) then
        contact%contact_type = type_segmented_mortar
        contact%reason = 'only this type has implicit springs (PUNIT 4)'
      else if (contact%strict) then
        contact%reason = 'only this type has the strict rule (IPF 1)'
      else
        contact%reason = 'exact ties of non-matching meshes'
      end if
    end select
  end subroutine decide_by_scene

  !> Choose the cheapest type within the target in the published studies.
  pure subroutine decide_by_charts(contact)
    type(contact_t), intent(inout) :: contact

    contact%contact_type = cheapest_type(contact%scene, contact%target)
    associate (estimate => estimates(contact%contact_type, contact%scene))
      contact%reason = 'error estimate up to '//to_text(estimate)//' in studies of ' &
        //trim(scene_names(contact%scene))
      if (estimate <= contact%target) then
        contact%reason = contact%reason//', the cheapest type within the target ' &
          //to_text(contact%target)
      else
        contact%reason = contact%reason//', the smallest; no type reaches the target ' &
          //to_text(contact%target)//' there'
      end if
    end associate
  end subroutine decide_by_charts

  !> Whether no initial velocity, load or base acceleration acts along the faces.
  pure function is_at_rest(model, contact, along) result(at_rest)
    type(model_t), intent(in) :: model
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: along(2)
    logical :: at_rest
    real(wp) :: v(2)
    integer :: i

    associate (given => model%conditions)
      at_rest = .not. (any(abs(along(given%nodal_loads%direction)) > sliding_share) &
        .or. any(abs(along(given%body_loads%direction)) > sliding_share))
      if (allocated(given%rigid_loads)) at_rest = at_rest .and. size(given%rigid_loads) == 0
      do i = 1, size(given%pressures)
        associate (ends => model%mesh%coordinates(:, given%pressures(i)%nodes))
          ! A pressure acts across its edge.
          at_rest = at_rest .and. abs(along(2)*(ends(1, 2) - ends(1, 1)) &
            - along(1)*(ends(2, 2) - ends(2, 1))) <= sliding_share*norm2(ends(:, 2) - ends(:, 1))
        end associate
      end do
      do i = 1, size(model%rigids)
        if (model%rigids(i)%has_velocity) at_rest = at_rest .and. abs(dot_product( &
          model%rigids(i)%velocity(1:2), along)) <= sliding_share*norm2(model%rigids(i)%velocity)
      end do
      if (.not. allocated(given%initial_velocity)) return
      v = sum(given%initial_velocity(:, contact%slave%nodes), 2)/size(contact%slave%nodes) &
        - sum(given%initial_velocity(:, contact%master%nodes), 2)/size(contact%master%nodes)
      at_rest = at_rest .and. abs(dot_product(v, along)) <= exactly*maxval(abs( &
        given%initial_velocity))
    end associate
  end function is_at_rest

  !> Whether each slave node faces a master node, in order, and both surfaces are straight and
  !> parallel. The chains have opposite directions.
  pure function match(model, contact, along)
    type(model_t), intent(in) :: model
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: along(2)
    logical :: match
    real(wp) :: across(2), separation(2), tolerance, gap
    integer :: i, k, previous

    match = .false.
    if (.not. norm2(along) > 0.0_wp) return
    across = [along(2), -along(1)]
    associate (x => model%mesh%coordinates, slave => contact%slave%nodes, &
      master => contact%master%nodes)
      tolerance = exactly*norm2(x(:, slave(size(slave))) - x(:, slave(1)))/size(slave)
      k = size(master)
      do i = 1, size(slave)
        previous = k
        do while (k > 1)
          if (.not. dot_product(x(:, master(k)) - x(:, slave(i)), along) < -tolerance) exit
          k = k - 1
        end do
        separation = x(:, master(k)) - x(:, slave(i))
        if (i == 1) gap = dot_product(separation, across)
        ! Nodes of a finer master between them would get no force.
        if (i > 1 .and. k /= previous - 1) return
        if (abs(dot_product(separation, along)) > tolerance) return
        if (abs(dot_product(separation, across) - gap) > tolerance) return
        if (abs(dot_product(x(:, slave(i)) - x(:, slave(1)), across)) > tolerance) return
      end do
    end associate
    match = .true.
  end function match

end module deck_choose_type_m
