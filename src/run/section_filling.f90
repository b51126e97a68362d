! SPDX-License-Identifier: MIT
!> Cross sections of the histories (secforc): resultants of what their elements put on their nodes.
module section_filling_m
  use controls_m, only : cross_section_t
  use kinds_m, only : wp
  use model_m, only : model_t
  use snapshot_m, only : snapshot_t, section_result_t
  use state_m, only : state_t
  implicit none
  private
  public :: fill_sections

contains

  !> All of them, from the forces that the state keeps.
  subroutine fill_sections(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    integer :: i, first

    if (.not. allocated(state%cut_force)) return
    first = 1
    associate (sections => model%controls%output%cross_sections)
      if (.not. allocated(snapshot%sections)) allocate (snapshot%sections(size(sections)))
      do i = 1, size(sections)
        call find_centroid(model, sections(i), state%motion, snapshot%sections(i))
        call add_forces(model, sections(i), state%motion, first, state%cut_force, &
          snapshot%sections(i))
        first = first + size(sections(i)%elements)
      end do
    end associate
  end subroutine fill_sections

  !> Area and its centroid, now: of the edges that lie in the section; of nodes without edges their
  !> mean place, without area.
  pure subroutine find_centroid(model, section, motion, result)
    type(model_t), intent(in) :: model
    type(cross_section_t), intent(in) :: section
    real(wp), intent(in) :: motion(:, :)      !! (4, n_node)
    type(section_result_t), intent(out) :: result
    real(wp) :: a(2), b(2), length
    integer :: i

    do i = 1, size(section%edges, 2)
      a = place_of(model, motion, section%edges(1, i))
      b = place_of(model, motion, section%edges(2, i))
      length = norm2(b - a)
      if (model%is_round) then
        result%area = result%area + 0.5_wp*length*(a(1) + b(1))
        result%centroid = result%centroid + length/6.0_wp*((2.0_wp*a(1) + b(1))*a + (a(1) &
          + 2.0_wp*b(1))*b)
      else
        result%area = result%area + length
        result%centroid = result%centroid + 0.5_wp*length*(a + b)
      end if
    end do
    if (result%area > 0.0_wp) then
      result%centroid = result%centroid/result%area
      return
    end if
    do i = 1, size(section%nodes)
      result%centroid = result%centroid + place_of(model, motion, section%nodes(i)) &
        /size(section%nodes)
    end do
  end subroutine find_centroid

  !> Sum of the forces on the nodes of the section, and their moment about its centroid.
  pure subroutine add_forces(model, section, motion, first, force, result)
    type(model_t), intent(in) :: model
    type(cross_section_t), intent(in) :: section
    real(wp), intent(in) :: motion(:, :)      !! (4, n_node)
    integer, intent(in) :: first              !! of its elements in `force`
    real(wp), intent(in) :: force(:, :)       !! (8, n)
    type(section_result_t), intent(inout) :: result
    real(wp) :: arm(2), f(2)
    integer :: i, k

    do i = 1, size(section%elements)
      associate (nodes => model%layout%slot_nodes(:, &
        model%layout%element_slot(section%elements(i))))
        do k = 1, 4
          if (.not. section%is_corner(k, i)) cycle
          f = force(2*k - 1:2*k, first + i - 1)
          arm = place_of(model, motion, nodes(k)) - result%centroid
          result%force = result%force + f
          result%moment = result%moment + (arm(1)*f(2) - arm(2)*f(1))
        end do
      end associate
    end do
  end subroutine add_forces

  !> Where a node is now.
  pure function place_of(model, motion, node) result(place)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: motion(:, :)
    integer, intent(in) :: node
    real(wp) :: place(2)

    place = model%mesh%coordinates(:, node) + motion(1:2, node)
  end function place_of

end module section_filling_m
