! SPDX-License-Identifier: MIT
!> What interfaces do not go with: the implicit method, elements that leave the mesh, and what
!> implicit penalties do not have.
module deck_contact_rules_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use contacts_m, only : is_tied, penalty_implicit, penalty_share
  use model_m, only : model_t
  use deck_lines_m, only : deck_t, line_error, line_warning
  use deck_cards_m, only : reject_field, warn_of_field
  use deck_contact_m, only : contact_cards_t
  use deck_values_m, only : has_field, place_of
  implicit none
  private
  public :: check_implicit_method, check_eroding_contacts, check_implicit_penalties

contains

  !> What the implicit method asks of an interface: automatic and implicit penalties are made for
  !> explicit steps.
  subroutine check_implicit_method(deck, entry)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: entry
    character(*), parameter :: no_effect = 'has no effect with the implicit method'
    character(:), allocatable :: reason

    if (entry%contact%damping > 0.0_wp) call line_warning(deck, &
      deck%blocks(entry%block)%keyword, 'implicit contact damping', &
      'contact damping (VDC) '//no_effect)
    if (entry%contact%search_interval > 0) call warn_of_field(deck, place_of(entry%cards(merge(1, &
      2, has_field(entry%cards(1), 'FREQ'))), 'FREQ'), no_effect)
    select case (entry%contact%penalty_unit)
    case (penalty_share)
      reason = 'asks for a share of the largest stable penalty of an explicit step'
    case (penalty_implicit)
      reason = 'asks for the implicit springs of explicit steps'
    case default
      return
    end select
    call reject_field(deck, place_of(entry%cards(2), 'PUNIT'), reason//', which the implicit ' &
      //'method does not have (0, 1 or 2)')
  end subroutine check_implicit_method

  !> Ties and initial overlaps do not follow surfaces that change.
  subroutine check_eroding_contacts(deck, contacts, model)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: contacts(:)
    type(model_t), intent(in) :: model
    logical :: may_go(size(model%materials))
    integer :: i, m

    do m = 1, size(model%materials)
      may_go(m) = allocated(model%materials(m)%erosion)
    end do
    do i = 1, size(contacts)
      associate (contact => contacts(i)%contact)
        if (.not. (is_tied(contact) .or. allocated(contact%interference))) cycle
        if (.not. (touches(contact%slave%segment_element) &
          .or. touches(contact%master%segment_element))) cycle
        call line_error(deck, deck%blocks(contacts(i)%block)%keyword, trim(merge( &
          'ties                  ', 'has an overlap (LCINT)', is_tied(contact)))//' on elements ' &
          //'that may leave the mesh, which this version does not have')
      end associate
    end do

  contains

    !> Whether some of the elements may leave.
    pure function touches(elements)
      integer, intent(in) :: elements(:)
      logical :: touches

      touches = any(may_go(model%parts(model%mesh%element_part(elements))%material))
    end function touches

  end subroutine check_eroding_contacts

  !> What implicit penalties (PUNIT 4) do not have: refused by name.
  subroutine check_implicit_penalties(deck, contacts, model, sound)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: contacts(:)
    type(model_t), intent(in) :: model
    logical, intent(in) :: sound !! the interfaces have their surfaces
    integer :: i

    if (.not. any(contacts%contact%penalty_unit == penalty_implicit)) return
    do i = 1, size(contacts)
      associate (entry => contacts(i), contact => contacts(i)%contact)
        if (contact%penalty_unit /= penalty_implicit) cycle
        if (contact%is_self) call refuse(deck, entry, 'do not act between a surface and itself')
        if (is_tied(contact)) call refuse(deck, entry, 'only push: a tie (TIE) has other springs')
        if (contact%damping > 0.0_wp) call refuse(deck, entry, 'have no damping of their own (VDC)')
        if (allocated(contact%interference)) call refuse(deck, entry, &
          'have no initial overlap that grows (LCINT)')
        if (model%erodes) call refuse(deck, entry, 'do not act where elements may leave the mesh')
      end associate
    end do
    if (sound) call check_shared_nodes(deck, contacts, model)
    if (sound) call check_shared_bodies(deck, contacts, model)
  end subroutine check_implicit_penalties

  !> One error for each interface, rigid wall, set of nodes that move alike and skew support that
  !> has nodes of such an interface too.
  subroutine check_shared_nodes(deck, contacts, model)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: contacts(:)
    type(model_t), intent(in) :: model
    integer, parameter :: most = 4 !! owners of a node that are known
    integer, allocatable :: owners(:, :), told(:), nodes(:)
    integer :: i, k, n, n_wall, n_alike

    allocate (owners(most, model%mesh%n_node), source=0)
    n = size(contacts)
    n_wall = 0
    n_alike = 0
    do i = 1, n
      call own(i, [contacts(i)%contact%slave%nodes, contacts(i)%contact%master%nodes])
    end do
    if (allocated(model%walls)) n_wall = size(model%walls)
    do i = 1, n_wall
      call own(n + i, model%walls(i)%nodes)
    end do
    if (allocated(model%conditions%common_motions)) n_alike = size(model%conditions%common_motions)
    do i = 1, n_alike
      call own(n + n_wall + i, model%conditions%common_motions(i)%nodes)
    end do
    if (allocated(model%conditions%skew_supports)) call own(n + n_wall + n_alike + 1, &
      [model%conditions%skew_supports%node])
    do i = 1, n
      if (contacts(i)%contact%penalty_unit /= penalty_implicit) cycle
      told = [0, i]
      nodes = [contacts(i)%contact%slave%nodes, contacts(i)%contact%master%nodes]
      do k = 0, most*size(nodes) - 1
        associate (node => nodes(1 + k/most), owner => owners(1 + modulo(k, most), &
          nodes(1 + k/most)))
          if (any(told == owner)) cycle
          told = [told, owner]
          call refuse(deck, contacts(i), 'share no nodes with others: node ' &
            //to_text(model%mesh%node_id(node))//' belongs to '//name_of(owner)//' too')
        end associate
      end do
    end do

  contains

    !> Nodes of an owner.
    subroutine own(owner, nodes)
      integer, intent(in) :: owner, nodes(:)
      integer :: j, free

      do j = 1, size(nodes)
        free = findloc(owners(:, nodes(j)), 0, 1)
        if (free > 0) owners(free, nodes(j)) = owner
      end do
    end subroutine own

    !> An owner in words.
    function name_of(owner) result(name)
      integer, intent(in) :: owner
      character(:), allocatable :: name

      if (owner <= n) then
        name = 'interface '//to_text(contacts(owner)%contact%id)
      else if (owner <= n + n_wall) then
        name = 'rigid wall '//to_text(model%walls(owner - n)%id)
      else if (owner <= n + n_wall + n_alike) then
        name = 'a set of nodes that move alike'
      else
        name = 'a support along neither x nor y'
      end if
    end function name_of

  end subroutine check_shared_nodes

  !> One error for each rigid body, free to move, that another such interface presses too: the
  !> pressures of both would depend on each other.
  subroutine check_shared_bodies(deck, contacts, model)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: contacts(:)
    type(model_t), intent(in) :: model
    integer, allocatable :: body_of(:), n_press(:), last(:)
    integer :: i, k, pass

    allocate (body_of(model%mesh%n_node), n_press(0:size(model%rigids)), last(0:size(model%rigids)))
    body_of = 0
    n_press = 0
    do k = 1, size(model%rigids)
      if (.not. all(model%rigids(k)%is_fixed)) body_of(model%rigids(k)%nodes) = k
    end do
    do pass = 1, 2
      last = 0
      do i = 1, size(contacts)
        if (contacts(i)%contact%penalty_unit /= penalty_implicit) cycle
        last(0) = i
        associate (nodes => [contacts(i)%contact%slave%nodes, contacts(i)%contact%master%nodes])
          do k = 1, size(nodes)
            associate (body => body_of(nodes(k)))
              if (last(body) == i) cycle
              last(body) = i
              if (pass == 1) n_press(body) = n_press(body) + 1
              if (pass == 2 .and. n_press(body) > 1) call refuse(deck, contacts(i), &
                'share no rigid body that may move: part ' &
                //to_text(model%parts(model%rigids(body)%part)%id) &
                //' is pressed by another interface of PUNIT 4 too')
            end associate
          end do
        end associate
      end do
    end do
  end subroutine check_shared_bodies

  !> An error of an interface with implicit penalties.
  subroutine refuse(deck, entry, message)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: entry
    character(*), intent(in) :: message

    call reject_field(deck, place_of(entry%cards(2), 'PUNIT'), 'asks for implicit springs, which ' &
      //'in this version '//message)
  end subroutine refuse

end module deck_contact_rules_m
