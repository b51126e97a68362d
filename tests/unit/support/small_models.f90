! SPDX-License-Identifier: MIT
!> Small models for the unit tests: rectangular meshes and separate elements, with one elastic part
!> and no conditions. What a test needs beyond that it adds before `renumber_model`.
module small_models
  use kinds_m, only : wp
  use model_m, only : model_t
  use parts_m, only : material_t
  implicit none
  private
  public :: make_grid, make_separate_quads, set_moduli, scattered

contains

  !> Numbers in (-1, 1) without order, always the same ones (a linear congruence).
  pure function scattered(n, seed) result(values)
    integer, intent(in) :: n
    integer, intent(in) :: seed
    real(wp) :: values(n)
    integer :: state, i

    state = modulo(seed*7919 + 12345, 65521)
    do i = 1, n
      state = modulo(state*17364 + 1, 65521)
      values(i) = 2.0_wp*real(state, wp)/65521.0_wp - 1.0_wp
    end do
  end function scattered

  !> Moduli and wave speed from E, nu and rho by the textbook formulas of Lame's constants.
  pure subroutine set_moduli(material, young, poisson, density)
    type(material_t), intent(inout) :: material
    real(wp), intent(in) :: young, poisson, density
    real(wp) :: lame

    material%young = young
    material%poisson = poisson
    material%density = density
    material%shear = young/(2.0_wp*(1.0_wp + poisson))
    lame = young*poisson/((1.0_wp + poisson)*(1.0_wp - 2.0_wp*poisson))
    material%bulk = lame + 2.0_wp*material%shear/3.0_wp
    material%sound_speed = sqrt((lame + 2.0_wp*material%shear)/density)
  end subroutine set_moduli

  !> n_x by n_y rectangles of the given size, one part; ids are 1000 + index for nodes, 5000 + index for
  !> elements. Not yet renumbered.
  subroutine make_grid(n_x, n_y, size_x, size_y, model)
    integer, intent(in) :: n_x, n_y
    real(wp), intent(in) :: size_x, size_y !! of one element
    type(model_t), intent(out) :: model
    integer :: i, j, corner, element

    call start_mesh((n_x + 1)*(n_y + 1), n_x*n_y, model)
    do j = 0, n_y
      do i = 0, n_x
        model%mesh%coordinates(:, j*(n_x + 1) + i + 1) = [i*size_x, j*size_y]
      end do
    end do
    do j = 1, n_y
      do i = 1, n_x
        element = (j - 1)*n_x + i
        corner = (j - 1)*(n_x + 1) + i
        model%mesh%element_nodes(:, element) = [corner, corner + 1, corner + n_x + 2, &
          corner + n_x + 1]
      end do
    end do
  end subroutine make_grid

  !> Quads that share no node, each the unit square at the origin (they lie upon each other) with corners
  !> shifted by up to `distortion` in each direction. Not yet renumbered.
  subroutine make_separate_quads(n, distortion, model)
    integer, intent(in) :: n
    real(wp), intent(in) :: distortion
    type(model_t), intent(out) :: model
    real(wp), parameter :: corners(2, 4) = reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, &
      1.0_wp, 0.0_wp, 1.0_wp], [2, 4])
    integer :: i, k

    call start_mesh(4*n, n, model)
    do i = 1, n
      do k = 1, 4
        model%mesh%element_nodes(k, i) = 4*(i - 1) + k
        model%mesh%coordinates(:, 4*(i - 1) + k) = corners(:, k) &
          + distortion*scattered(2, 4*i + k)
      end do
    end do
  end subroutine make_separate_quads

  !> Arrays, ids, one part with section and material, and no conditions.
  subroutine start_mesh(n_node, n_element, model)
    integer, intent(in) :: n_node, n_element
    type(model_t), intent(inout) :: model
    integer :: i

    associate (mesh => model%mesh)
      mesh%n_node = n_node
      mesh%n_element = n_element
      allocate (mesh%node_id(n_node), mesh%coordinates(2, n_node), mesh%deck_node(n_node))
      allocate (mesh%element_id(n_element), mesh%element_nodes(4, n_element))
      allocate (mesh%element_part(n_element), source=1)
      mesh%node_id = [(1000 + i, i = 1, n_node)]
      mesh%deck_node = [(i, i = 1, n_node)]
      mesh%element_id = [(5000 + i, i = 1, n_element)]
    end associate
    allocate (model%parts(1), model%sections(1), model%materials(1), model%curves(0))
    model%parts(1)%id = 7
    model%parts(1)%section = 1
    model%parts(1)%material = 1
    call set_moduli(model%materials(1), 210.0_wp, 0.3_wp, 2.5_wp)
    allocate (model%node_sets(0), model%segment_sets(0), model%part_sets(0), model%contacts(0), &
      model%rigids(0))
    associate (conditions => model%conditions)
      allocate (conditions%fixed_nodes(0), conditions%fixed_directions(0), conditions%motions(0), &
        conditions%rigid_motions(0), conditions%nodal_loads(0), conditions%pressures(0), conditions%body_loads(0))
    end associate
    allocate (model%controls%output%history_nodes(0))
    model%controls%end_time = 1.0_wp
  end subroutine start_mesh

end module small_models
