! SPDX-License-Identifier: MIT
!> One of several processes has read the deck, resolved and renumbered; the others get the model
!> from it. Arrays stay as long as the mesh, so that numbers mean the same everywhere, but what
!> nobody has sent or written takes no memory: a process that is not the first gets special nodes,
!> and the nodes and slots of its own tiles.
module rank_model_m
  use freight_lists_m, only : pass
  use freight_m, only : freight_t, start_loading, pass_reals
  use freight_sharing_m, only : spread_freight, send_freight
  use inside_answers_m, only : answers_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use mesh_freight_m, only : pass_nodes, pass_slots, pass_elements, pass_faces
  use model_freight_m, only : pass_model
  use model_m, only : model_t
  use others_memory_m, only : others_t
  use rank_memory_m, only : starts_from_all, others_of
  use rank_shares_m, only : shares_t, share_out
  use ranks_m, only : ranks_t
  use state_m, only : state_t
  implicit none
  private
  public :: hand_model, hand_others

  !> What goes in pieces, and items of a piece at most.
  integer, parameter :: of_nodes = 1, of_slots = 2, of_elements = 3, of_faces = 4, of_mass = 5
  integer, parameter :: most_items = 65536
  !> In place of a receiver: all.
  integer, parameter :: everyone = 0

contains

  !> The model of the first process for all.
  subroutine hand_model(ranks, model, has_all)
    type(ranks_t), intent(inout) :: ranks
    type(model_t), intent(inout) :: model
    logical, intent(out) :: has_all !! each process gets all of it
    type(freight_t) :: freight
    logical :: moves !! there are initial velocities

    has_all = .true.
    if (ranks%n == 1) return
    if (ranks%mine == 0) then
      has_all = starts_from_all(model)
      moves = allocated(model%conditions%initial_velocity)
      call pass_all()
      call start_loading(freight)
      call pass_all()
    end if
    call spread_freight(ranks, freight)
    if (ranks%mine > 0) then
      call pass_all()
      call reserve_mesh(moves, model)
    end if
    deallocate (freight%values)
    if (has_all) then
      call hand_range(ranks, everyone, of_nodes, [1, model%mesh%n_node], model)
      call hand_range(ranks, everyone, of_slots, [1, model%layout%n_slot], model)
      call hand_range(ranks, everyone, of_elements, [1, model%mesh%n_element], model)
    else
      call hand_shares(ranks, of_nodes, model)
      call hand_shares(ranks, of_slots, model)
      call hand_range(ranks, everyone, of_faces, [1, 1], model)
    end if
    call hand_fixed(ranks, has_all, model)

  contains

    subroutine pass_all()
      call pass(freight, has_all, moves)
      call pass_model(freight, model)
    end subroutine pass_all

  end subroutine hand_model

  !> Fixed degrees of freedom of the nodes that each process has.
  subroutine hand_fixed(ranks, has_all, model)
    type(ranks_t), intent(inout) :: ranks
    logical, intent(in) :: has_all
    type(model_t), intent(inout) :: model
    type(freight_t) :: freight
    type(shares_t) :: shares
    integer, allocatable :: nodes(:), directions(:)
    logical, allocatable :: is_known(:)
    integer :: rank

    shares = share_out(model%layout, ranks%mine, ranks%n)
    do rank = 1, ranks%n - 1
      if (all(ranks%mine /= [0, rank])) cycle
      freight = freight_t()
      if (ranks%mine == 0) then
        associate (all_nodes => model%conditions%fixed_nodes, starts => shares%nodes)
          is_known = all_nodes <= model%layout%n_special .or. all_nodes >= starts(ranks%n) &
            .or. (all_nodes >= starts(rank) .and. all_nodes < starts(rank + 1))
          if (has_all) is_known = .true.
          nodes = pack(all_nodes, is_known)
        end associate
        directions = pack(model%conditions%fixed_directions, is_known)
        call pass_fixed(nodes, directions)
        call start_loading(freight)
        call pass_fixed(nodes, directions)
      end if
      call send_freight(ranks, rank, freight)
      if (ranks%mine > 0) &
        call pass_fixed(model%conditions%fixed_nodes, model%conditions%fixed_directions)
    end do

  contains

    subroutine pass_fixed(nodes, directions)
      integer, allocatable, intent(inout) :: nodes(:), directions(:)

      call pass(freight, nodes)
      call pass(freight, directions)
    end subroutine pass_fixed

  end subroutine hand_fixed

  !> Room for what goes in pieces; it takes memory where something is put.
  subroutine reserve_mesh(moves, model)
    logical, intent(in) :: moves
    type(model_t), intent(inout) :: model

    associate (mesh => model%mesh, layout => model%layout)
      allocate (mesh%node_id(mesh%n_node), mesh%coordinates(2, mesh%n_node))
      if (moves) allocate (model%conditions%initial_velocity(2, mesh%n_node))
      allocate (layout%slot_element(layout%n_slot), layout%slot_nodes(4, layout%n_slot), &
        layout%slot_local(4, layout%n_slot))
      allocate (mesh%element_id(mesh%n_element), mesh%element_nodes(4, mesh%n_element), &
        mesh%element_part(mesh%n_element), layout%element_slot(mesh%n_element))
    end associate
  end subroutine reserve_mesh

  !> What a process that starts its own share alone has to know of the state of the first one.
  subroutine hand_others(model, ranks, state, others, answers)
    type(model_t), intent(inout) :: model
    type(ranks_t), intent(inout) :: ranks
    type(state_t), intent(inout) :: state              !! of the first process
    type(others_t), allocatable, intent(out) :: others !! left alone
    type(answers_t), allocatable, intent(inout) :: answers !! to the first process; then from it
    type(freight_t) :: freight
    real(wp), allocatable :: penalties(:, :)
    integer :: i

    if (ranks%mine == 0) then
      call hand_shares(ranks, of_mass, model, state%mass)
      penalties = reshape([(state%contacts(i)%slave_penalty, state%contacts(i)%master_penalty, &
        state%contacts(i)%node_penalty, i=1, size(state%contacts))], [3, size(state%contacts)])
      call pass_answers()
      call start_loading(freight)
      call pass_answers()
    else
      allocate (others, source=others_of(model, share_out(model%layout, ranks%mine, ranks%n), &
        ranks))
      allocate (others%mass(model%mesh%n_node))
      call hand_shares(ranks, of_mass, model, others%mass)
      allocate (answers)
      answers%are_given = .true.
    end if
    call spread_freight(ranks, freight)
    if (ranks%mine == 0) return
    call pass_answers()
    call move_alloc(penalties, others%penalties)

  contains

    subroutine pass_answers()
      call pass(freight, answers%is_inside)
      call pass(freight, penalties)
    end subroutine pass_answers

  end subroutine hand_others

  !> What all have to know, and then to each process what is of its tiles. Nodes inside of rigid
  !> bodies stand behind those of tiles: all move them.
  subroutine hand_shares(ranks, what, model, mass)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: what
    type(model_t), intent(inout) :: model
    real(wp), intent(inout), optional :: mass(:)
    type(shares_t) :: shares
    integer :: starts(0:ranks%n), rank

    shares = share_out(model%layout, ranks%mine, ranks%n)
    starts = shares%nodes
    if (what == of_slots) then
      starts = (shares%chunks - 1)*chunk_size + 1
    else
      call hand_range(ranks, everyone, what, [1, model%layout%n_special], model, mass)
      call hand_range(ranks, everyone, what, [starts(ranks%n), model%mesh%n_node], model, mass)
    end if
    do rank = 1, ranks%n - 1
      call hand_range(ranks, rank, what, [starts(rank), starts(rank + 1) - 1], model, mass)
    end do
  end subroutine hand_shares

  !> A range of items, piece by piece.
  subroutine hand_range(ranks, receiver, what, range, model, mass)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: receiver   !! `everyone` or one of the others
    integer, intent(in) :: what       !! one of the `of_` constants
    integer, intent(in) :: range(2)
    type(model_t), intent(inout) :: model
    real(wp), intent(inout), optional :: mass(:)
    type(freight_t) :: freight
    integer :: first, last

    if (receiver /= everyone .and. all(ranks%mine /= [0, receiver])) return
    do first = range(1), range(2), most_items
      last = min(range(2), first + most_items - 1)
      freight = freight_t()
      if (ranks%mine == 0) then
        call pass_piece()
        call start_loading(freight)
        call pass_piece()
      end if
      if (receiver == everyone) then
        call spread_freight(ranks, freight)
      else
        call send_freight(ranks, receiver, freight)
      end if
      if (ranks%mine > 0) call pass_piece()
    end do

  contains

    !> Count, load or unload it.
    subroutine pass_piece()
      select case (what)
      case (of_nodes)
        call pass_nodes(first, last, model, freight)
      case (of_slots)
        call pass_slots(first, last, model%layout, freight)
      case (of_elements)
        call pass_elements(first, last, model, freight)
      case (of_faces)
        call pass_faces(model, freight)
      case (of_mass)
        call pass_reals(last - first + 1, mass(first:last), freight)
      end select
    end subroutine pass_piece

  end subroutine hand_range

end module rank_model_m
