! SPDX-License-Identifier: MIT
!> One of several processes has read the deck, resolved and renumbered; the others get the model
!> from it. Arrays stay as long as the mesh, so that numbers mean the same everywhere, but what
!> nobody has sent or written takes no memory: a process that is not the first gets special nodes,
!> and the nodes and slots of its own tiles.
module rank_model_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use freight_m, only : freight_t, start_loading, part_of
  use freight_sharing_m, only : spread_freight, send_freight
  use inside_answers_m, only : answers_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use others_memory_m, only : others_t
  use rank_memory_m, only : starts_from_all, others_of
  use rank_shares_m, only : shares_t, share_out
  use ranks_m, only : ranks_t
  use state_m, only : state_t
  use visitor_m, only : of_elements, of_nodes, of_slots
  implicit none
  private
  public :: hand_model, hand_others

  !> What goes in pieces besides the mesh, and items of a piece at most.
  integer, parameter :: of_faces = -1, of_mass = -2
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

    has_all = .true.
    if (ranks%n == 1) return
    if (ranks%mine == 0) then
      has_all = starts_from_all(model)
      call pass_all()
      call start_loading(freight)
      call pass_all()
    end if
    call spread_freight(ranks, freight)
    if (ranks%mine > 0) call pass_all()
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
      call freight%visit('has_all', has_all)
      call model%visit(freight)
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

      call freight%visit('nodes', nodes)
      call freight%visit('directions', directions)
    end subroutine pass_fixed

  end subroutine hand_fixed

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
      call freight%visit('is_inside', answers%is_inside)
      call freight%visit('penalties', penalties)
    end subroutine pass_answers

  end subroutine hand_others

  !> What all have to know, and then to each process what is of its tiles. Nodes inside of rigid
  !> bodies stand behind those of tiles: all move them.
  subroutine hand_shares(ranks, what, model, mass)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: what
    type(model_t), intent(inout) :: model
    real(wp), allocatable, intent(inout), optional :: mass(:)
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
    real(wp), allocatable, intent(inout), optional :: mass(:)
    type(freight_t) :: freight
    integer :: first, last

    if (receiver /= everyone .and. all(ranks%mine /= [0, receiver])) return
    do first = range(1), range(2), most_items
      last = min(range(2), first + most_items - 1)
      freight = part_of(merge(of_nodes, what, what < 0), [first, last])
      freight%is_partial = what /= of_faces
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
      case (of_faces)
        call pass_faces(model, freight)
      case (of_mass)
        call freight%visit('mass', mass, of_nodes)
      case default
        call model%visit(freight)
      end select
    end subroutine pass_piece

  end subroutine hand_range

  !> Single elements that all have to know: those behind contact surfaces with their nodes, and
  !> where those of cross sections stand.
  subroutine pass_faces(model, freight)
    type(model_t), intent(inout), target :: model
    type(freight_t), intent(inout) :: freight
    integer :: i, k

    do i = 1, size(model%contacts)
      call pass_side(model%contacts(i)%slave%segment_element)
      call pass_side(model%contacts(i)%master%segment_element)
    end do
    if (.not. allocated(model%controls%output%cross_sections)) return
    do i = 1, size(model%controls%output%cross_sections)
      associate (elements => model%controls%output%cross_sections(i)%elements)
        do k = 1, size(elements)
          call freight%plain(c_loc(model%layout%element_slot(elements(k))), storage_size(1), 1)
        end do
      end associate
    end do

  contains

    !> Nodes, places and parts of the elements behind one surface.
    subroutine pass_side(elements)
      integer, intent(in) :: elements(:)
      integer :: i, k

      do i = 1, size(elements)
        associate (e => elements(i), mesh => model%mesh)
          call freight%plain(c_loc(mesh%element_part(e)), storage_size(1), 1)
          call freight%plain(c_loc(mesh%element_nodes(1, e)), storage_size(1), 4)
          do k = 1, 4
            call freight%plain(c_loc(mesh%coordinates(1, mesh%element_nodes(k, e))), &
              storage_size(1.0_wp), 2)
          end do
        end associate
      end do
    end subroutine pass_side

  end subroutine pass_faces

end module rank_model_m
