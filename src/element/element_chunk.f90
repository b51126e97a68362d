! SPDX-License-Identifier: MIT
!> Work arrays of one chunk of quads, plane or axisymmetric. All quantities of a one-point quad
!> follow from the diagonals d31 = x3 - x1, d42 = x4 - x2, from h.x = x1 - x2 + x3 - x4 and in
!> axisymmetric models from the sum s of the radii.
module element_chunk_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size, local_kind
  implicit none
  private
  public :: element_chunk_t, n_axisym_reference, reference_sum, reference_inverse, reference_mass, &
    gather_motion, scatter_forces

  !> Streams of the reference shape of axisymmetric quads: those of plane ones, the sum of the
  !> radii, the inverse of the volume, and per node density over mass.
  integer, parameter :: reference_sum = 7, reference_inverse = 8, reference_mass = 9, &
    n_axisym_reference = 12

  !> Work arrays of one chunk.
  type :: element_chunk_t
    logical :: is_axisymmetric
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
    real(wp), dimension(chunk_size) :: pressure           !! tension positive: K ln(J), with bulk
                                                          !! viscosity
    real(wp), dimension(chunk_size) :: heat               !! work of the deviator in the step, for
                                                          !! an equation of state
    real(wp), dimension(chunk_size) :: law_mean, law_energy, law_bulk, law_shear !! pressure and
                                                                                 !! moduli of laws
                                                                                 !! that give the
                                                                                 !! pressure: see
                                                                                 !! `eos_pressure`
    real(wp), dimension(chunk_size) :: qx, qy             !! hourglass force amplitude
    real(wp), dimension(chunk_size) :: hourglass_work     !! its work in the step
    real(wp), dimension(2, chunk_size) :: force3, force4 !! x, y of nodes 3, 4 without hourglass
    real(wp) :: swing(2, chunk_size) !! hourglass amplitude q_x, q_y
    real(wp), dimension(chunk_size) :: resistance !! hourglass force over gamma.v, or its integral
    ! What follows axisymmetric quads have besides: x is the radius r, y the axis z. Of the
    ! gradients of the volume `rad` is what belongs to dv_r/dr, `axi` to d/dz, `mean` to v_r/r
    ! (integrals of N_a over A), each for the patterns d31, d42, h (s: all four nodes); mid_area is
    ! a volume.
    real(wp), dimension(chunk_size) :: us, vs !! sums of u_r and of v_r, 0 in padding. No pairs: a
                                              !! loop that reads one of two has a remainder
    real(wp), dimension(chunk_size) :: hoop   !! force in r on each of the four nodes
    real(wp), dimension(chunk_size) :: volume, inverse_volume !! now
    real(wp), dimension(chunk_size) :: radii  !! an eighth of the sum of the four, now
    real(wp), dimension(chunk_size) :: rad_a, rad_b, rad_h, axi_a, axi_b, axi_h, mean_a, mean_b, &
      mean_s
  end type element_chunk_t

contains

  !> Differences of the nodal motion; displacement and velocity in separate pairs, which the
  !> vectorised loops read without a remainder. The loop over elements stays scalar: each node is
  !> one 32-byte load, several times faster than a vectorised gather. For axisymmetric quads also
  !> the sums of the radial motion. All nodes of padding are the same, so it has no strain.
  pure subroutine gather_motion(is_axisymmetric, nodes, motion, chunk)
    logical, intent(in) :: is_axisymmetric
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in) :: motion(4, *)             !! all nodes: u_x, u_y, v_x, v_y
    type(element_chunk_t), intent(inout) :: chunk
    real(wp) :: d31(4), d42(4), h(4), s(4)
    integer :: i, k

    chunk%is_axisymmetric = is_axisymmetric
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
      if (.not. is_axisymmetric) cycle
      ! All four at a time, since vectors of four are faster; two of the sums are not needed.
      !$omp simd simdlen(4)
      do k = 1, 4
        s(k) = h(k) + 2.0_wp*(motion(k, nodes(2, i)) + motion(k, nodes(4, i)))
      end do
      chunk%us(i) = s(1)
      chunk%vs(i) = s(3)
    end do
    if (.not. is_axisymmetric) return
    do i = chunk_size, 1, -1
      if (nodes(1, i) /= nodes(3, i)) exit
      chunk%us(i) = 0.0_wp
      chunk%vs(i) = 0.0_wp
    end do
  end subroutine gather_motion

  !> Add the nodal forces of a chunk to the tile's nodes, with explicit vectors of x and y (the
  !> compiler's own choice takes half as long again); for axisymmetric quads also the force of the
  !> hoop stress. Padding is left out: all of it has one node, where each sum would wait for the
  !> previous one.
  pure subroutine scatter_forces(n_element, local, chunk, force)
    integer, intent(in) :: n_element             !! elements, in the first slots
    integer(local_kind), intent(in) :: local(4, chunk_size) !! local numbers in the tile
    type(element_chunk_t), intent(in) :: chunk
    real(wp), intent(inout) :: force(2, *)       !! internal force of the local nodes
    real(wp), parameter :: to_r(2) = [1.0_wp, 0.0_wp]
    real(wp) :: hoop
    integer :: i, k, n(4)

    if (.not. chunk%is_axisymmetric) then
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
      return
    end if
    do i = 1, n_element
      n = local(:, i)
      hoop = chunk%hoop(i)
      !$omp simd simdlen(2)
      do k = 1, 2
        force(k, n(1)) = force(k, n(1)) + ((to_r(k)*hoop + chunk%swing(k, i)) - chunk%force3(k, i))
      end do
      !$omp simd simdlen(2)
      do k = 1, 2
        force(k, n(2)) = force(k, n(2)) + ((to_r(k)*hoop - chunk%swing(k, i)) - chunk%force4(k, i))
      end do
      !$omp simd simdlen(2)
      do k = 1, 2
        force(k, n(3)) = force(k, n(3)) + ((to_r(k)*hoop + chunk%swing(k, i)) + chunk%force3(k, i))
      end do
      !$omp simd simdlen(2)
      do k = 1, 2
        force(k, n(4)) = force(k, n(4)) + ((to_r(k)*hoop - chunk%swing(k, i)) + chunk%force4(k, i))
      end do
    end do
  end subroutine scatter_forces

end module element_chunk_m
