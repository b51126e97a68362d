! SPDX-License-Identifier: MIT
!> One of several processes has read the deck, resolved and renumbered; the others get the model
!> from it. Arrays stay as long as the mesh, so that numbers mean the same everywhere, but what
!> nobody has sent or written takes no memory: a process that is not the first gets special nodes,
!> and the nodes and slots of its own tiles.
module rank_model_m
  use packed_buffer_m, only : packed_buffer_t, part_of
  use buffer_sharing_m, only : hand, everyone
  use others_memory_m, only : answers_t, others_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use rank_shares_m, only : shares_t, share_out, needs_all, others_of
  use ranks_m, only : ranks_t
  use state_m, only : state_t
  use visitor_m, only : visited_t, visitor_t, of_elements, of_nodes, of_slots
  implicit none
  private
  public :: hand_model, hand_others

  !> Items of a piece at most.
  integer, parameter :: most_items = 65536

  !> What is handed besides the model.
  type, extends(visited_t) :: handed_t
    integer, allocatable :: parts(:)                !! of elements behind surfaces
    integer, allocatable :: corners(:, :)           !! (4, elements) their nodes
    real(wp), allocatable :: places(:, :)           !! (2, 4 elements) where these are
    integer, allocatable :: slots(:)                !! of elements of cross sections
    real(wp), allocatable :: mass(:)                !! (n_node) lumped masses
    real(wp), allocatable :: penalties(:, :)        !! (3, interfaces) as in others_t
    logical, allocatable :: is_inside(:)            !! as in answers_t
  contains
    procedure :: visit => visit_handed
  end type handed_t

contains

  !> Its components.
  subroutine visit_handed(self, visitor)
    class(handed_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('parts', self%parts)
    call visitor%visit('corners', self%corners)
    call visitor%visit('places', self%places)
    call visitor%visit('slots', self%slots)
    call visitor%visit('mass', self%mass, of_nodes)
    call visitor%visit('penalties', self%penalties)
    call visitor%visit('is_inside', self%is_inside)
  end subroutine visit_handed

  !> The model of the first process for all.
  subroutine hand_model(ranks, model, has_all)
    type(ranks_t), intent(inout) :: ranks
    type(model_t), intent(inout) :: model
    logical, intent(out) :: has_all !! each process gets all of it
    type(packed_buffer_t) :: buffer
    type(shares_t) :: shares
    logical, allocatable :: is_known(:)
    integer :: n_node

    has_all = .true.
    if (ranks%n == 1) return
    call hand(ranks, everyone, buffer, model)
    deallocate (buffer%values)
    ! Where each process looks at the state of all elements at the start, or steps them in dynamic
    ! relaxation.
    has_all = needs_all(model) .or. model%controls%relaxation%is_on &
      .or. abs(model%controls%mass_step) > 0.0_wp &
      .or. any(abs(model%parts%stiffness_damping) > 0.0_wp)
    n_node = model%mesh%n_node
    if (has_all) then
      call hand_range(ranks, everyone, of_nodes, [1, n_node], model)
      call hand_range(ranks, everyone, of_slots, [1, model%layout%n_slot], model)
      call hand_range(ranks, everyone, of_elements, [1, model%mesh%n_element], model)
    else
      shares = share_out(model%layout, ranks%mine, ranks%n)
      call hand_shares(ranks, of_nodes, shares, n_node, model)
      call hand_shares(ranks, of_slots, shares, n_node, model)
      call hand_faces(ranks, model)
    end if
    if (has_all .or. ranks%mine == 0) return
    ! Of fixed degrees of freedom each process keeps those of the nodes that it has.
    associate (nodes => model%conditions%fixed_nodes, starts => shares%nodes)
      is_known = nodes <= model%layout%n_special .or. nodes >= starts(ranks%n) &
        .or. (nodes >= starts(ranks%mine) .and. nodes < starts(ranks%mine + 1))
    end associate
    model%conditions%fixed_directions = pack(model%conditions%fixed_directions, is_known)
    model%conditions%fixed_nodes = pack(model%conditions%fixed_nodes, is_known)
  end subroutine hand_model

  !> Single elements that all have to know: those behind contact surfaces with their nodes, and
  !> where those of cross sections stand.
  subroutine hand_faces(ranks, model)
    type(ranks_t), intent(inout) :: ranks
    type(model_t), intent(inout) :: model
    type(handed_t) :: handed
    type(packed_buffer_t) :: buffer
    integer, allocatable :: elements(:), cut(:)
    integer :: i, k

    allocate (elements(0), cut(0))
    do i = 1, size(model%contacts)
      elements = [elements, model%contacts(i)%slave%segment_element, &
        model%contacts(i)%master%segment_element]
    end do
    if (allocated(model%controls%output%cross_sections)) then
      do i = 1, size(model%controls%output%cross_sections)
        cut = [cut, model%controls%output%cross_sections(i)%elements]
      end do
    end if
    associate (mesh => model%mesh, layout => model%layout)
      if (ranks%mine == 0) then
        handed%parts = mesh%element_part(elements)
        handed%corners = mesh%element_nodes(:, elements)
        handed%places = mesh%coordinates(:, [handed%corners])
        handed%slots = layout%element_slot(cut)
      end if
      call hand(ranks, everyone, buffer, handed)
      if (ranks%mine == 0) return
      do i = 1, size(elements)
        mesh%element_part(elements(i)) = handed%parts(i)
        mesh%element_nodes(:, elements(i)) = handed%corners(:, i)
        do k = 1, 4
          mesh%coordinates(:, handed%corners(k, i)) = handed%places(:, 4*(i - 1) + k)
        end do
      end do
      do i = 1, size(cut)
        layout%element_slot(cut(i)) = handed%slots(i)
      end do
    end associate
  end subroutine hand_faces

  !> What a process that starts its own share alone has to know of the state of the first one.
  subroutine hand_others(model, ranks, state, others, answers)
    type(model_t), intent(in) :: model
    type(ranks_t), intent(inout) :: ranks
    type(state_t), intent(inout) :: state              !! of the first process
    type(others_t), allocatable, intent(out) :: others !! left alone
    type(answers_t), allocatable, intent(inout) :: answers !! to the first process; then from it
    type(packed_buffer_t) :: buffer
    type(handed_t) :: handed
    type(shares_t) :: shares
    integer :: i

    if (ranks%mine == 0) then
      call move_alloc(state%mass, handed%mass)
      handed%penalties = reshape([(state%contacts(i)%slave_penalty, &
        state%contacts(i)%master_penalty, state%contacts(i)%node_penalty, &
        i=1, size(state%contacts))], [3, size(state%contacts)])
      if (allocated(answers%is_inside)) handed%is_inside = answers%is_inside
    end if
    call hand(ranks, everyone, buffer, handed)
    shares = share_out(model%layout, ranks%mine, ranks%n)
    call hand_shares(ranks, of_nodes, shares, model%mesh%n_node, handed)
    if (ranks%mine == 0) then
      call move_alloc(handed%mass, state%mass)
      return
    end if
    allocate (others, source=others_of(model, shares, ranks))
    call move_alloc(handed%mass, others%mass)
    call move_alloc(handed%penalties, others%penalties)
    allocate (answers)
    answers%are_given = .true.
    if (allocated(handed%is_inside)) call move_alloc(handed%is_inside, answers%is_inside)
  end subroutine hand_others

  !> What all have to know, and then to each process what is of its tiles. Nodes inside of rigid
  !> bodies stand behind those of tiles: all move them.
  subroutine hand_shares(ranks, of, shares, n_node, item)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: of         !! of_nodes or of_slots
    type(shares_t), intent(in) :: shares
    integer, intent(in) :: n_node     !! of the mesh
    class(visited_t), intent(inout) :: item
    integer :: starts(0:ranks%n), rank

    starts = shares%nodes
    if (of == of_slots) then
      starts = (shares%chunks - 1)*chunk_size + 1
    else
      call hand_range(ranks, everyone, of, [1, starts(0) - 1], item)
      call hand_range(ranks, everyone, of, [starts(ranks%n), n_node], item)
    end if
    do rank = 1, ranks%n - 1
      call hand_range(ranks, rank, of, [starts(rank), starts(rank + 1) - 1], item)
    end do
  end subroutine hand_shares

  !> A range of what an item has, piece by piece.
  subroutine hand_range(ranks, receiver, of, range, item)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: receiver   !! `everyone` or one of the others
    integer, intent(in) :: of         !! one of the `of_` constants
    integer, intent(in) :: range(2)
    class(visited_t), intent(inout) :: item
    type(packed_buffer_t) :: buffer
    integer :: first

    do first = range(1), range(2), most_items
      buffer = part_of(of, [first, min(range(2), first + most_items - 1)])
      call hand(ranks, receiver, buffer, item)
    end do
  end subroutine hand_range

end module rank_model_m
