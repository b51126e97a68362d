! SPDX-License-Identifier: MIT
!> Pieces of what is as long as the mesh, in a freight.
module mesh_freight_m
  use freight_m, only : freight_t, pass_reals, pass_integers, pass_shorts
  use layout_m, only : layout_t
  use model_m, only : model_t
  implicit none
  private
  public :: pass_nodes, pass_slots, pass_elements, pass_faces

contains

  !> Nodes of the mesh.
  subroutine pass_nodes(first, last, model, freight)
    integer, intent(in) :: first, last
    type(model_t), intent(inout) :: model
    type(freight_t), intent(inout) :: freight

    associate (n => last - first + 1, mesh => model%mesh, conditions => model%conditions)
      call pass_integers(n, mesh%node_id(first:last), freight)
      call pass_reals(2*n, mesh%coordinates(:, first:last), freight)
      if (allocated(conditions%initial_velocity)) &
        call pass_reals(2*n, conditions%initial_velocity(:, first:last), freight)
    end associate
  end subroutine pass_nodes

  !> Slots of elements.
  subroutine pass_slots(first, last, layout, freight)
    integer, intent(in) :: first, last
    type(layout_t), intent(inout) :: layout
    type(freight_t), intent(inout) :: freight

    associate (n => last - first + 1)
      call pass_integers(n, layout%slot_element(first:last), freight)
      call pass_integers(4*n, layout%slot_nodes(:, first:last), freight)
      call pass_shorts(4*n, layout%slot_local(:, first:last), freight)
    end associate
  end subroutine pass_slots

  !> Elements in deck order.
  subroutine pass_elements(first, last, model, freight)
    integer, intent(in) :: first, last
    type(model_t), intent(inout) :: model
    type(freight_t), intent(inout) :: freight

    associate (n => last - first + 1, mesh => model%mesh)
      call pass_integers(n, mesh%element_id(first:last), freight)
      call pass_integers(4*n, mesh%element_nodes(:, first:last), freight)
      call pass_integers(n, mesh%element_part(first:last), freight)
      call pass_integers(n, model%layout%element_slot(first:last), freight)
    end associate
  end subroutine pass_elements

  !> Single elements that all have to know: those behind contact surfaces with their nodes, and
  !> where those of cross sections stand.
  subroutine pass_faces(model, freight)
    type(model_t), intent(inout) :: model
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
          call pass_integers(1, model%layout%element_slot(elements(k):elements(k)), freight)
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
          call pass_integers(1, mesh%element_part(e:e), freight)
          call pass_integers(4, mesh%element_nodes(:, e), freight)
          do k = 1, 4
            call pass_reals(2, mesh%coordinates(:, mesh%element_nodes(k, e)), freight)
          end do
        end associate
      end do
    end subroutine pass_side

  end subroutine pass_faces

end module mesh_freight_m
