! SPDX-License-Identifier: MIT
!> Surfaces of a mesh some elements of which are refused: mistakes that do not follow from theirs
!> are told in the same pass.
module deck_unsound_m
  use model_m, only : model_t
  use deck_lines_m, only : deck_t
  use deck_raw_m, only : raw_t
  use boundary_m, only : boundary_t, find_boundary
  use deck_resolve_contacts_m, only : check_common_nodes, resolve_interference
  use deck_loads_m, only : settle_pressures
  use deck_resolve_sides_m, only : find_side, require_side, resolve_side, side_nodes, side_segments
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: check_unsound_mesh

contains

  !> Wrong numbers always; edges where no refused element has their nodes.
  subroutine check_unsound_mesh(deck, raw, is_sound, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    logical, intent(in) :: is_sound(:)    !! (n_element)
    type(model_t), intent(inout) :: model !! gets interfaces without surfaces
    type(boundary_t) :: outside
    logical, allocatable :: in_doubt(:), all_nodes(:)
    integer :: i, k, n, kind, found

    allocate (in_doubt(model%mesh%n_node), source=.not. any(is_sound))
    do i = 1, size(is_sound)
      if (is_sound(i)) cycle
      do k = 1, 4
        n = model%mesh%element_nodes(k, i)
        if (n > 0) in_doubt(n) = .true.
      end do
    end do
    allocate (all_nodes(model%mesh%n_node), source=.true.)
    call find_boundary(model%mesh%element_nodes, is_sound, all_nodes, outside)
    call settle_pressures(deck, raw%pressure_places, outside, model, in_doubt)
    allocate (model%contacts(size(raw%contacts)))
    do i = 1, size(raw%contacts)
      call check_sides(deck, raw, i, outside, in_doubt, model)
      model%contacts(i) = raw%contacts(i)%contact
      call resolve_interference(deck, raw%contacts(i), model, model%contacts(i))
    end do
    do i = 1, size(raw%transducers)
      call require_side(deck, raw%transducers(i), 1, kind, found)
    end do
  end subroutine check_unsound_mesh

  !> Sides of nodes or segments without doubt as in a sound mesh, of others whether they exist.
  subroutine check_sides(deck, raw, i, outside, in_doubt, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    integer, intent(in) :: i
    type(boundary_t), intent(in) :: outside
    logical, intent(in) :: in_doubt(:)
    type(model_t), intent(in) :: model
    type(surface_t) :: sides(2)
    integer :: k, kind, found, n_known

    n_known = 0
    do k = 1, merge(1, 2, raw%contacts(i)%contact%is_self)
      call find_side(deck, raw%contacts(i), k, kind, found)
      if (is_certain(kind, found)) then
        call resolve_side(deck, raw, i, k, outside, model, sides(k))
        n_known = n_known + 1
      else
        call require_side(deck, raw%contacts(i), k, kind, found)
      end if
    end do
    if (n_known == 2) call check_common_nodes(deck, raw%contacts(i), sides, model)

  contains

    !> Whether no refused element has nodes of the surface.
    pure function is_certain(kind, found)
      integer, intent(in) :: kind, found
      logical :: is_certain

      is_certain = .false.
      if (kind == side_nodes) then
        is_certain = .not. any(in_doubt(model%node_sets(found)%nodes))
      else if (kind == side_segments) then
        if (allocated(model%segment_sets(found)%parts)) return
        is_certain = .not. any(in_doubt([model%segment_sets(found)%nodes]))
      end if
    end function is_certain

  end subroutine check_sides

end module deck_unsound_m
