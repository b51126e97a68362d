! SPDX-License-Identifier: MIT
!> Exposed quads: plane one-point quads that own most of the mass of their nodes, such as single
!> elements, ends of strips one element thick, and dense inclusions. Their stable step is below L/c
!> (doc/theory/elements.md, "Stable step").
module exposed_quads_m
  use kinds_m, only : wp
  use model_m, only : model_t
  implicit none
  private
  public :: find_exposed

  !> Main share of the mass of a node: other elements have at most about half of this mass.
  real(wp), parameter :: main_share = 0.66_wp

  !> Half share, above 0.5 so that round-off does not decide in strips and at edges of regular
  !> meshes.
  real(wp), parameter :: half_share = 0.51_wp

  !> Share of the mass of a node below which an element is not counted as a neighbour.
  real(wp), parameter :: small_share = 0.1_wp

contains

  !> Shares of exposed quads in the element masses of their nodes (masses of *ELEMENT_MASS only
  !> increase the stable step); 0 in all other elements and, up to round-off, at nodes with a
  !> support, a prescribed motion or a rigid body. A quad is exposed if it has the main share of two
  !> nodes or more than half of three nodes; above a Poisson's ratio of 0.4 also if it has the main
  !> share of one node and so have all elements around it (four quads in a block: 0.94 L/c and
  !> less).
  pure function find_exposed(model, is_left) result(shares)
    type(model_t), intent(in) :: model
    logical, intent(in) :: is_left(:)  !! (n_element) not eroded
    real(wp), allocatable :: shares(:, :)  !! (4, n_element)
    real(wp), allocatable :: mass(:)
    logical, allocatable :: is_surrounded(:)
    integer :: i, k

    allocate (shares(4, model%mesh%n_element), source=0.0_wp)
    if (model%is_axisymmetric) return
    allocate (mass(model%mesh%n_node), source=0.0_wp)
    allocate (is_surrounded(model%mesh%n_node), source=.true.)
    shares = corner_masses(model, is_left)
    do i = 1, model%mesh%n_element
      do k = 1, 4
        associate (node => model%mesh%element_nodes(k, i))
          mass(node) = mass(node) + shares(k, i)
        end associate
      end do
    end do
    do i = 1, model%mesh%n_element
      if (.not. is_left(i)) cycle
      associate (nodes => model%mesh%element_nodes(:, i))
        if (any(shares(:, i) > main_share*mass(nodes))) cycle
        do k = 1, 4
          if (shares(k, i) > small_share*mass(nodes(k))) is_surrounded(nodes(k)) = .false.
        end do
      end associate
    end do
    call hold_nodes(model, mass)
    do i = 1, model%mesh%n_element
      if (is_left(i)) shares(:, i) = shares(:, i)/mass(model%mesh%element_nodes(:, i))
      if (.not. is_exposed(model, i, shares(:, i), is_surrounded)) shares(:, i) = 0.0_wp
    end do
  end function find_exposed

  !> Lumped masses of the elements at their corners; 0 at the fourth of a triangle.
  pure function corner_masses(model, is_left) result(masses)
    type(model_t), intent(in) :: model
    logical, intent(in) :: is_left(:)
    real(wp) :: masses(4, model%mesh%n_element)
    real(wp) :: x(2, 4)
    integer :: i, n

    masses = 0.0_wp
    do i = 1, model%mesh%n_element
      if (.not. is_left(i)) cycle
      associate (nodes => model%mesh%element_nodes(:, i), &
        part => model%parts(model%mesh%element_part(i)))
        n = merge(3, 4, nodes(4) == nodes(3))
        x = model%mesh%coordinates(:, nodes)
        masses(:n, i) = model%materials(part%material)%density/n*0.5_wp*((x(1, 3) - x(1, 1))*( &
          x(2, 4) - x(2, 2)) - (x(1, 4) - x(1, 2))*(x(2, 3) - x(2, 1))) &
          *model%sections(part%section)%thickness
      end associate
    end do
  end function corner_masses

  !> Whether an element is exposed, see `find_exposed`.
  pure logical function is_exposed(model, i, shares, is_surrounded)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    real(wp), intent(in) :: shares(4)
    logical, intent(in) :: is_surrounded(:)  !! (n_node) by elements with a main share

    is_exposed = .false.
    if (.not. (any(shares > main_share) .or. count(shares > half_share) > 2)) return
    associate (nodes => model%mesh%element_nodes(:, i), &
      part => model%parts(model%mesh%element_part(i)))
      if (nodes(4) == nodes(3) .or. model%sections(part%section)%is_full &
        .or. model%materials(part%material)%is_rigid) return
      is_exposed = count(shares > main_share) > 1 .or. count(shares > half_share) > 2
      associate (law => model%materials(part%material))
        if (law%shear < (law%bulk + 4.0_wp*law%shear/3.0_wp)/6.0_wp &
          .and. .not. law%is_plane_stress) &
          is_exposed = is_exposed .or. all(is_surrounded(nodes))
      end associate
    end associate
  end function is_exposed

  !> Set the mass of nodes with a constraint or a prescribed motion during the whole run to
  !> infinity: they act like nodes of a mirror image.
  pure subroutine hold_nodes(model, mass)
    type(model_t), intent(in) :: model
    real(wp), intent(inout) :: mass(:)  !! (n_node)
    integer :: i

    associate (conditions => model%conditions)
      mass(conditions%fixed_nodes) = huge(1.0_wp)
      do i = 1, size(conditions%motions)
        associate (motion => conditions%motions(i))
          if (motion%birth > 0.0_wp .or. motion%death < model%controls%end_time) cycle
          mass(motion%node) = huge(1.0_wp)
        end associate
      end do
    end associate
    do i = 1, size(model%rigids)
      mass(model%rigids(i)%nodes) = huge(1.0_wp)
    end do
  end subroutine hold_nodes

end module exposed_quads_m
