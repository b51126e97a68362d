! SPDX-License-Identifier: MIT
!> Rigid bodies from the parts of *MAT_RIGID, and their nodes.
module deck_rigids_m
  use log_m, only : to_text
  use model_m, only : model_t
  use deck_cards_m, only : reject_field
  use deck_ids_m, only : an_element, a_part, a_material
  use deck_lines_m, only : deck_t, place_t, line_error
  implicit none
  private
  public :: make_rigids

contains

  !> One body for each part of *MAT_RIGID.
  subroutine make_rigids(deck, model, owner)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    integer, allocatable, intent(out) :: owner(:) !! (n_node) the body of each node, 0 for none
    integer, allocatable :: parts(:)
    logical :: is_there(0:model%mesh%n_node)
    integer :: i, k

    associate (mesh => model%mesh)
      parts = pack([(i, i=1, size(model%parts))], &
        [(is_rigid_part(model, i), i=1, size(model%parts))])
      allocate (model%rigids(size(parts)), owner(mesh%n_node))
      owner = 0
      do i = 1, size(parts)
        associate (body => model%rigids(i))
          body%part = parts(i)
          body%is_fixed = model%materials(model%parts(parts(i))%material)%is_fixed
          if (model%is_round) body%is_fixed([1, 3]) = .true.
          is_there = .false.
          do k = 1, mesh%n_element
            if (mesh%element_part(k) == parts(i)) is_there(mesh%element_nodes(:, k)) = .true.
          end do
          body%nodes = pack([(k, k=1, mesh%n_node)], is_there(1:))
        end associate
        call own_nodes(deck, i, model, owner)
      end do
    end associate
    if (size(parts) == 0) return
    if (model%controls%implicit%is_on) call line_error(deck, &
      deck%maps(a_material)%lines(model%parts(parts(1))%material), '*MAT_RIGID: the implicit ' &
      //'method does not have rigid bodies')
    if (size(parts) == size(model%parts) .and. model%controls%dt_curve == 0) call line_error(deck, &
      deck%maps(a_part)%lines(1), 'all parts are rigid, so no element gives a time step; give ' &
      //'one by a curve (LCTM of *CONTROL_TIMESTEP)')
  end subroutine make_rigids

  !> Whether a part has *MAT_RIGID.
  pure function is_rigid_part(model, i_part) result(yes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_part
    logical :: yes

    yes = model%parts(i_part)%material > 0
    if (yes) yes = model%materials(model%parts(i_part)%material)%is_rigid
  end function is_rigid_part

  !> No node may have two bodies, and a body needs some.
  subroutine own_nodes(deck, i, model, owner)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i                !! body
    type(model_t), intent(in) :: model
    integer, intent(inout) :: owner(:)      !! (n_node) of the bodies so far
    type(place_t) :: place
    integer :: k

    associate (body => model%rigids(i))
      place = place_t(deck%maps(a_part)%lines(body%part), 2, 'PID')
      if (size(body%nodes) == 0 .and. .not. deck%maps(an_element)%lost) call reject_field(deck, &
        place, ': this rigid part has no elements, so no mass')
      k = findloc(owner(body%nodes) > 0, .true., dim=1)
      if (k > 0) call reject_field(deck, place, ': node ' &
        //to_text(model%mesh%node_id(body%nodes(k)))//' belongs to this rigid part and to rigid ' &
        //'part '//to_text(model%parts(model%rigids(owner(body%nodes(k)))%part)%id) &
        //'; bodies that share nodes must be one part')
      owner(body%nodes) = i
    end associate
  end subroutine own_nodes

end module deck_rigids_m
