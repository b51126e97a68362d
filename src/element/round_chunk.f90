! SPDX-License-Identifier: MIT
!> The volume of a chunk of round quads and its gradients, in closed form. A quad of four nodes is
!> given by its diagonals a = x3 - x1, b = x4 - x2, by h = x1 - x2 + x3 - x4 and by the sum s of its
!> radii; then the volume per radian is (METHODS 6 in these patterns, doc/theory/elements.md)
!>   V = s A/4 + (h_r (a_r b_z + b_r a_z) - 2 a_r b_r h_z)/24,   A = (a_r b_z - b_r a_z)/2.
module round_chunk_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  implicit none
  private
  public :: round_chunk_t, round_shape_t, n_round_reference, reference_sum, reference_mass, &
    form_gradients, form_sums, scatter_hoop, node_volumes

  !> Streams of the reference shape: those of the plane, the sum of the radii, and per node
  !> density over mass.
  integer, parameter :: reference_sum = 7, reference_mass = 8, n_round_reference = 11

  !> Patterns of a chunk of quads, its areas and volumes, and the gradients of the volume: of it
  !> `rad` is what belongs to dv_r/dr, `axi` to d/dz, `mean` to v_r/r (integrals of N_a over A).
  type :: round_shape_t
    real(wp), dimension(chunk_size) :: s                  !! sum of the four radii
    real(wp), dimension(chunk_size) :: ar, az, br, bz     !! diagonals
    real(wp), dimension(chunk_size) :: hr, hz             !! h.x
    real(wp), dimension(chunk_size) :: area, volume
    real(wp), dimension(chunk_size) :: rad_a, rad_b, rad_h
    real(wp), dimension(chunk_size) :: axi_a, axi_b, axi_h
    real(wp), dimension(chunk_size) :: mean_a, mean_b, mean_s
  end type round_shape_t

  !> What a chunk of round quads has besides that of a plane one.
  type :: round_chunk_t
    real(wp), dimension(chunk_size) :: us, vs  !! sum of u_r and of v_r, 0 in padding
    real(wp), dimension(chunk_size) :: hoop    !! force in r on each of the four nodes
    type(round_shape_t) :: now
  end type round_chunk_t

contains

  !> Areas, volumes and gradients of shapes whose patterns are there.
  pure subroutine form_gradients(shape)
    type(round_shape_t), intent(inout) :: shape
    real(wp), parameter :: part = 1.0_wp/24.0_wp
    real(wp) :: s, ar, az, br, bz, hr, hz
    integer :: i

    !$omp simd private(s, ar, az, br, bz, hr, hz)
    do i = 1, chunk_size
      s = 0.125_wp*shape%s(i)
      ar = shape%ar(i)
      az = shape%az(i)
      br = shape%br(i)
      bz = shape%bz(i)
      hr = part*shape%hr(i)
      hz = part*shape%hz(i)
      shape%area(i) = 0.5_wp*(ar*bz - br*az)
      shape%rad_a(i) = s*bz - br*hz
      shape%rad_b(i) = -(s*az + ar*hz)
      shape%rad_h(i) = part*(ar*bz + br*az)
      shape%axi_a(i) = -br*(s - hr)
      shape%axi_b(i) = ar*(s + hr)
      shape%axi_h(i) = -2.0_wp*part*ar*br
      shape%mean_a(i) = hr*bz - hz*br
      shape%mean_b(i) = hr*az - hz*ar
      shape%mean_s(i) = 0.25_wp*shape%area(i)
      shape%volume(i) = shape%s(i)*shape%mean_s(i) + (ar*shape%mean_a(i) + br*shape%mean_b(i))
    end do
  end subroutine form_gradients

  !> Sums of u_r and v_r of the nodes; all nodes of padding are one, and it carries no strain.
  pure subroutine form_sums(nodes, motion, round)
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in) :: motion(4, *)   !! all nodes: u_r, u_z, v_r, v_z
    type(round_chunk_t), intent(inout) :: round
    integer :: i, n(4)

    !GCC$ NOVECTOR
    do i = 1, chunk_size
      n = nodes(:, i)
      round%us(i) = (motion(1, n(1)) + motion(1, n(2))) + (motion(1, n(3)) + motion(1, n(4)))
      round%vs(i) = (motion(3, n(1)) + motion(3, n(2))) + (motion(3, n(3)) + motion(3, n(4)))
      if (n(1) == n(3)) then
        round%us(i) = 0.0_wp
        round%vs(i) = 0.0_wp
      end if
    end do
  end subroutine form_sums

  !> Add the part of the forces that all four nodes share: of the hoop stress, in r.
  pure subroutine scatter_hoop(n_element, local, round, force)
    integer, intent(in) :: n_element            !! elements, in the first slots
    integer, intent(in) :: local(4, chunk_size) !! local numbers in the tile
    type(round_chunk_t), intent(in) :: round
    real(wp), intent(inout) :: force(2, *)      !! internal force of the local nodes
    integer :: i, k

    do i = 1, n_element
      do k = 1, 4
        force(1, local(k, i)) = force(1, local(k, i)) + round%hoop(i)
      end do
    end do
  end subroutine scatter_hoop

  !> Integrals of N_a r over one quad or triangle, per radian: its volume by nodes. 2x2 Gauss points
  !> are exact. A triangle's third node gets the shares of both its places, its fourth none.
  pure function node_volumes(x, is_triangle) result(volumes)
    real(wp), intent(in) :: x(2, 4) !! corners, x(1, :) the radii
    logical, intent(in) :: is_triangle
    real(wp) :: volumes(4)
    real(wp), parameter :: g = sqrt(1.0_wp/3.0_wp)
    real(wp) :: shape(4), along(4), across(4), to_x(2), to_y(2), xi, eta
    integer :: i, j

    volumes = 0.0_wp
    do i = -1, 1, 2
      do j = -1, 1, 2
        xi = i*g
        eta = j*g
        shape = 0.25_wp*[(1 - xi)*(1 - eta), (1 + xi)*(1 - eta), (1 + xi)*(1 + eta), &
          (1 - xi)*(1 + eta)]
        along = 0.25_wp*[-(1 - eta), 1 - eta, 1 + eta, -(1 + eta)]
        across = 0.25_wp*[-(1 - xi), -(1 + xi), 1 + xi, 1 - xi]
        to_x = matmul(x, along)
        to_y = matmul(x, across)
        volumes = volumes + shape*dot_product(shape, x(1, :)) &
          *(to_x(1)*to_y(2) - to_x(2)*to_y(1))
      end do
    end do
    if (.not. is_triangle) return
    volumes(3) = volumes(3) + volumes(4)
    volumes(4) = 0.0_wp
  end function node_volumes

end module round_chunk_m
