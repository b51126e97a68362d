! SPDX-License-Identifier: MIT
!> The volume of a chunk of round quads and its gradients, in closed form. A quad of four nodes is
!> given by its diagonals a = x3 - x1, b = x4 - x2, by h = x1 - x2 + x3 - x4 and by the sum s of its
!> radii; then the volume per radian is (METHODS 6 in these patterns, doc/theory/elements.md)
!>   V = s A/4 + (h_r (a_r b_z + b_r a_z) - 2 a_r b_r h_z)/24,   A = (a_r b_z - b_r a_z)/2.
module round_chunk_m
  use kinds_m, only : wp
  use element_chunk_m, only : element_chunk_t
  use layout_m, only : chunk_size, local_kind
  implicit none
  private
  public :: round_chunk_t, n_round_reference, reference_sum, reference_inverse, &
    reference_mass, gather_round, scatter_round, node_volumes

  !> Streams of the reference shape: those of the plane, the sum of the radii, the inverse of the
  !> volume, and per node density over mass.
  integer, parameter :: reference_sum = 7, reference_inverse = 8, reference_mass = 9, &
    n_round_reference = 12

  !> What a chunk of round quads has besides that of a plane one. Of the gradients of the volume
  !> `rad` is what belongs to dv_r/dr, `axi` to d/dz, `mean` to v_r/r (integrals of N_a over A),
  !> each for the patterns a, b, h (s: all four nodes).
  type :: round_chunk_t
    real(wp), dimension(chunk_size) :: us, vs !! sums of u_r and of v_r, 0 in padding. No pairs: a
                                              !! loop that reads one of two has a remainder
    real(wp) :: force(4, chunk_size), swing(2, chunk_size) !! forces as in the plane chunk
    real(wp), dimension(chunk_size) :: hoop !! and in r on each of the four nodes
    real(wp), dimension(chunk_size) :: volume, inverse_volume !! now
    real(wp), dimension(chunk_size) :: radii !! an eighth of the sum of the four, now
    real(wp), dimension(chunk_size) :: rad_a, rad_b, rad_h
    real(wp), dimension(chunk_size) :: axi_a, axi_b, axi_h
    real(wp), dimension(chunk_size) :: mean_a, mean_b, mean_s
    real(wp), dimension(chunk_size) :: resistance !! force over gamma.v, or over its integral
  end type round_chunk_t

contains

  !> Differences and sums of the nodal motion (as `gather_chunk`, of which this is the round form).
  !> All nodes of padding are one: it carries no strain.
  pure subroutine gather_round(nodes, motion, chunk, round)
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in) :: motion(4, *)   !! all nodes: u_r, u_z, v_r, v_z
    type(element_chunk_t), intent(inout) :: chunk
    type(round_chunk_t), intent(inout) :: round
    real(wp) :: d31(4), d42(4), h(4), s(4)
    integer :: i, k

    !GCC$ NOVECTOR
    do i = 1, chunk_size
      ! All four at a time, told in so many words: two of the sums are not asked for.
      !$omp simd simdlen(4)
      do k = 1, 4
        d31(k) = motion(k, nodes(3, i)) - motion(k, nodes(1, i))
        d42(k) = motion(k, nodes(4, i)) - motion(k, nodes(2, i))
        h(k) = (motion(k, nodes(1, i)) - motion(k, nodes(2, i))) &
          + (motion(k, nodes(3, i)) - motion(k, nodes(4, i)))
        s(k) = h(k) + 2.0_wp*(motion(k, nodes(2, i)) + motion(k, nodes(4, i)))
      end do
      chunk%u31(:, i) = d31(1:2)
      chunk%v31(:, i) = d31(3:4)
      chunk%u42(:, i) = d42(1:2)
      chunk%v42(:, i) = d42(3:4)
      chunk%hu(:, i) = h(1:2)
      chunk%hv(:, i) = h(3:4)
      round%us(i) = s(1)
      round%vs(i) = s(3)
    end do
    do i = chunk_size, 1, -1
      if (nodes(1, i) /= nodes(3, i)) exit
      round%us(i) = 0.0_wp
      round%vs(i) = 0.0_wp
    end do
  end subroutine gather_round

  !> Add the nodal forces of a chunk to the tile's own nodes: as `scatter_chunk`, with the force of
  !> the hoop stress on all four.
  pure subroutine scatter_round(n_element, local, round, force)
    integer, intent(in) :: n_element            !! elements, in the first slots
    integer(local_kind), intent(in) :: local(4, chunk_size) !! local numbers in the tile
    type(round_chunk_t), intent(in) :: round
    real(wp), intent(inout) :: force(2, *)      !! internal force of the local nodes
    real(wp), parameter :: to_r(2) = [1.0_wp, 0.0_wp]
    real(wp) :: hoop
    integer :: i, k, n(4)

    do i = 1, n_element
      n = local(:, i)
      hoop = round%hoop(i)
      !$omp simd simdlen(2)
      do k = 1, 2
        force(k, n(1)) = force(k, n(1)) + ((to_r(k)*hoop + round%swing(k, i)) &
          - round%force(k, i))
      end do
      !$omp simd simdlen(2)
      do k = 1, 2
        force(k, n(2)) = force(k, n(2)) + ((to_r(k)*hoop - round%swing(k, i)) &
          - round%force(k + 2, i))
      end do
      !$omp simd simdlen(2)
      do k = 1, 2
        force(k, n(3)) = force(k, n(3)) + ((to_r(k)*hoop + round%swing(k, i)) &
          + round%force(k, i))
      end do
      !$omp simd simdlen(2)
      do k = 1, 2
        force(k, n(4)) = force(k, n(4)) + ((to_r(k)*hoop - round%swing(k, i)) &
          + round%force(k + 2, i))
      end do
    end do
  end subroutine scatter_round

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
