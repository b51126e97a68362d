! SPDX-License-Identifier: MIT
!> Work arrays of one chunk of quads. All quantities of a one-point quad follow from the two
!> diagonals d31 = x3 - x1, d42 = x4 - x2 and from h.x = x1 - x2 + x3 - x4.
module element_chunk_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size, local_kind
  implicit none
  private
  public :: element_chunk_t, gather_chunk, scatter_chunk

  !> One chunk.
  type :: element_chunk_t
    real(wp) :: u31(2, chunk_size), v31(2, chunk_size) !! u and v of node 3 minus node 1
    real(wp) :: u42(2, chunk_size), v42(2, chunk_size) !! of node 4 minus node 2
    real(wp) :: hu(2, chunk_size), hv(2, chunk_size)   !! of node 1 - node 2 + node 3 - node 4
    real(wp), dimension(chunk_size) :: x31, y31, x42, y42 !! present diagonals
    real(wp), dimension(chunk_size) :: hx, hy             !! present h.x, h.y
    real(wp), dimension(chunk_size) :: gx, gy             !! hourglass velocity gamma.v
    real(wp), dimension(chunk_size) :: area, mid_area     !! now, and half a step ago
    real(wp), dimension(chunk_size) :: inverse_area       !! 1/A now
    real(wp), dimension(chunk_size) :: stretch            !! A/A0 - 1
    real(wp), dimension(chunk_size) :: trace              !! volumetric strain rate D_xx + D_yy
    real(wp), dimension(chunk_size) :: pressure           !! tension positive: K ln(J), bulk
                                                          !! viscosity added
    real(wp), dimension(chunk_size) :: heat               !! work of the deviator in the step, for
                                                          !! an equation of state
    real(wp), dimension(chunk_size) :: law_mean, law_energy, law_bulk, law_shear !! where the law
                                                          !! gives the pressure: see `law_pressure`
    real(wp), dimension(chunk_size) :: qx, qy             !! hourglass force amplitude
    real(wp), dimension(chunk_size) :: hourglass_work     !! its work in the step
    real(wp), dimension(2, chunk_size) :: force3, force4 !! x, y of nodes 3, 4 without hourglass
    real(wp) :: swing(2, chunk_size) !! hourglass amplitude q_x, q_y
  end type element_chunk_t

contains

  !> Differences of the nodal motion, displacement and velocity apart: pairs are what the vectorised
  !> loops read without a remainder. The loop over elements stays scalar: each node is one 32-byte
  !> load, where a vectorised gather would be several times slower.
  pure subroutine gather_chunk(nodes, motion, chunk)
    integer, intent(in) :: nodes(4, chunk_size)      !! node indices
    real(wp), intent(in) :: motion(4, *)           !! all nodes: u_x, u_y, v_x, v_y
    type(element_chunk_t), intent(inout) :: chunk
    real(wp) :: d31(4), d42(4), h(4)
    integer :: i, k

    !GCC$ NOVECTOR
    do i = 1, chunk_size
      !$omp simd simdlen(4)
      do k = 1, 4
        d31(k) = motion(k, nodes(3, i)) - motion(k, nodes(1, i))
        d42(k) = motion(k, nodes(4, i)) - motion(k, nodes(2, i))
        h(k) = (motion(k, nodes(1, i)) - motion(k, nodes(2, i))) &
          + (motion(k, nodes(3, i)) - motion(k, nodes(4, i)))
      end do
      chunk%u31(:, i) = d31(1:2)
      chunk%v31(:, i) = d31(3:4)
      chunk%u42(:, i) = d42(1:2)
      chunk%v42(:, i) = d42(3:4)
      chunk%hu(:, i) = h(1:2)
      chunk%hv(:, i) = h(3:4)
    end do
  end subroutine gather_chunk

  !> Add the nodal forces of a chunk to the tile's own nodes, x and y of a node at a time (told to
  !> the compiler in so many words: left alone it takes them one by one, half as fast again).
  !> Padding is left out: all of it has one node, where each sum would wait for the one before.
  pure subroutine scatter_chunk(n_element, local, chunk, force)
    integer, intent(in) :: n_element             !! elements, in the first slots
    integer(local_kind), intent(in) :: local(4, chunk_size) !! local numbers in the tile
    type(element_chunk_t), intent(in) :: chunk
    real(wp), intent(inout) :: force(2, *)       !! internal force of the local nodes
    integer :: i, k, n(4)

    do i = 1, n_element
      n = local(:, i)
      !$omp simd simdlen(2)
      do k = 1, 2
        force(k, n(1)) = force(k, n(1)) + (chunk%swing(k, i) - chunk%force3(k, i))
      end do
      !$omp simd simdlen(2)
      do k = 1, 2
        force(k, n(2)) = force(k, n(2)) - (chunk%swing(k, i) + chunk%force4(k, i))
      end do
      !$omp simd simdlen(2)
      do k = 1, 2
        force(k, n(3)) = force(k, n(3)) + (chunk%swing(k, i) + chunk%force3(k, i))
      end do
      !$omp simd simdlen(2)
      do k = 1, 2
        force(k, n(4)) = force(k, n(4)) - (chunk%swing(k, i) - chunk%force4(k, i))
      end do
    end do
  end subroutine scatter_chunk

end module element_chunk_m
