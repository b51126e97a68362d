! SPDX-License-Identifier: MIT
!> Plane one-point quads with at most one neighbour: single elements, and the ends of strips one
!> element thick. L/c is above their stable step (doc/theory/elements.md, "Stable step").
module exposed_quads_m
  use boundary_m, only : boundary_t, find_boundary
  use kinds_m, only : wp
  use model_m, only : model_t
  implicit none
  private
  public :: find_exposed, list_exposed, no_side

  !> The neighbouring side of a quad without a neighbour.
  integer, parameter :: no_side = 5

contains

  !> The only side of each element that a neighbour shares or a support holds (side k runs from node
  !> k to the next one), `no_side` where there is none, 0 where there are more and in all other
  !> elements than plane one-point quads.
  pure function find_exposed(model, is_left) result(side)
    type(model_t), intent(in) :: model
    logical, intent(in) :: is_left(:)  !! (n_element) elements that have not eroded
    integer, allocatable :: side(:)    !! (n_element)
    type(boundary_t) :: boundary
    logical, allocatable :: is_free(:, :), is_held(:, :), among(:)
    integer :: i, edge

    allocate (side(model%mesh%n_element), source=0)
    if (model%is_round) return
    associate (mesh => model%mesh)
      allocate (is_free(4, mesh%n_element), among(mesh%n_node))
      is_free = .false.
      among = .true.
      call find_boundary(mesh%element_nodes, is_left, among, boundary)
      is_held = held_directions(model)
      do edge = 1, boundary%n_edge
        associate (nodes => boundary%nodes(:, edge), element => boundary%elements(edge))
          if (any(is_held(:, nodes(1)) .and. is_held(:, nodes(2)))) cycle
          is_free(findloc(mesh%element_nodes(:, element), nodes(1), dim=1), element) = .true.
        end associate
      end do
      do i = 1, mesh%n_element
        if (count(is_free(:, i)) < 3) cycle
        if (mesh%element_nodes(4, i) == mesh%element_nodes(3, i)) cycle
        associate (part => model%parts(mesh%element_part(i)))
          if (model%materials(part%material)%is_rigid .or. model%sections(part%section)%is_full) &
            cycle
        end associate
        side(i) = findloc(is_free(:, i), .false., dim=1)
        if (side(i) == 0) side(i) = no_side
      end do
    end associate
  end function find_exposed

  !> Slot and side of each exposed element of a mesh that is whole.
  pure function list_exposed(model) result(list)
    type(model_t), intent(in) :: model
    integer, allocatable :: list(:, :)  !! (2, n)
    integer, allocatable :: side(:)
    logical, allocatable :: is_left(:)
    integer :: i, n

    allocate (is_left(model%mesh%n_element), source=.true.)
    side = find_exposed(model, is_left)
    allocate (list(2, count(side > 0)))
    n = 0
    do i = 1, size(side)
      if (side(i) == 0) cycle
      n = n + 1
      list(:, n) = [model%layout%element_slot(i), side(i)]
    end do
  end function list_exposed

  !> Degrees of freedom that are held or prescribed during the whole run.
  pure function held_directions(model) result(is_held)
    type(model_t), intent(in) :: model
    logical :: is_held(2, model%mesh%n_node)
    integer :: i

    is_held = .false.
    associate (conditions => model%conditions)
      do i = 1, size(conditions%fixed_nodes)
        is_held(conditions%fixed_directions(i), conditions%fixed_nodes(i)) = .true.
      end do
      do i = 1, size(conditions%motions)
        associate (motion => conditions%motions(i))
          if (motion%birth > 0.0_wp .or. motion%death < model%controls%end_time) cycle
          is_held(motion%direction, motion%node) = .true.
        end associate
      end do
    end associate
    do i = 1, size(model%rigids)
      is_held(:, model%rigids(i)%nodes) = .true.
    end do
  end function held_directions

end module exposed_quads_m
