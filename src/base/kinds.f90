! SPDX-License-Identifier: MIT
!> Kinds and the few constants that every layer needs.
module kinds_m
  use, intrinsic :: iso_fortran_env, only : real64, int64
  implicit none
  private
  public :: wp, long, pi, line_length

  !> Working precision of all physics.
  integer, parameter :: wp = real64
  !> Integers that count bytes, clock ticks and other things beyond 2^31.
  integer, parameter :: long = int64
  real(wp), parameter :: pi = 3.14159265358979323846_wp
  !> Longest deck line that is read (LONG format lines reach 200 columns).
  integer, parameter :: line_length = 512
end module kinds_m
