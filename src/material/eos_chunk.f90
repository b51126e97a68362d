! SPDX-License-Identifier: MIT
!> What an equation of state gives for one chunk: p = A + B E and its derivatives by mu = 1/v - 1.
module eos_chunk_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  implicit none
  private
  public :: eos_chunk_t

  !> Of one chunk at one volume.
  type :: eos_chunk_t
    real(wp), dimension(chunk_size) :: a, b             !! A (Pa) and B
    real(wp), dimension(chunk_size) :: a_slope, b_slope !! dA/dmu and dB/dmu
  end type eos_chunk_t

end module eos_chunk_m
