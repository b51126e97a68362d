! SPDX-License-Identifier: MIT
!> The processor that the program runs on, for the record.
module processor_m
  implicit none
  private
  public :: processor_name

  !> Longest line that is read, whatever the environment says (GFORTRAN_DEFAULT_RECL).
  integer, parameter :: line_length = 100000

contains

  !> The model name that Linux knows; `unknown` elsewhere.
  function processor_name() result(name)
    character(:), allocatable :: name
    character(200) :: line
    integer :: unit, status

    name = 'unknown'
    open (newunit=unit, file='/proc/cpuinfo', status='old', action='read', &
      recl=line_length, iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (index(line, 'model name') /= 1) cycle
      name = trim(adjustl(line(index(line, ':') + 1:)))
      exit
    end do
    close (unit)
  end function processor_name

end module processor_m
