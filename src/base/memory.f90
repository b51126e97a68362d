! SPDX-License-Identifier: MIT
!> Processor name and available memory from the files of Linux. Linux overcommits memory and kills
!> the program that uses it, so that a successful allocation does not prove that memory is there.
module memory_m
  use kinds_m, only : long
  implicit none
  private
  public :: available_bytes, processor_name

  !> Longest line that is read, whatever the environment says (GFORTRAN_DEFAULT_RECL).
  integer, parameter :: line_length = 100000

contains

  !> Bytes of available memory; the largest number where the system does not report them.
  function available_bytes(root) result(bytes)
    character(*), intent(in), optional :: root !! folder with proc and sys, for tests; absent: /
    integer(long) :: bytes
    character(:), allocatable :: top
    integer(long) :: limit, used

    top = ''
    if (present(root)) top = root
    bytes = huge(bytes)
    limit = number_in(top//'/proc/meminfo', 'MemAvailable:')
    if (limit >= 0) bytes = 1024*limit
    ! Memory limit of a container ("max" where there is none). Its usage contains file caches that
    ! the system releases on demand.
    limit = number_in(top//'/sys/fs/cgroup/memory.max', '')
    used = number_in(top//'/sys/fs/cgroup/memory.current', '')
    if (limit < 0 .or. used < 0) return
    used = used - max(number_in(top//'/sys/fs/cgroup/memory.stat', 'inactive_file '), 0_long)
    bytes = min(bytes, max(limit - used, 0_long))
  end function available_bytes

  !> The number that follows a label at the start of a line; -1 without file, label or number.
  function number_in(file, label) result(number)
    character(*), intent(in) :: file
    character(*), intent(in) :: label
    integer(long) :: number
    character(:), allocatable :: text
    integer :: status

    text = text_behind(file, label)
    read (text, *, iostat=status) number
    if (status /= 0) number = -1
  end function number_in

  !> Processor name; `unknown` where the system is not Linux.
  function processor_name() result(name)
    character(:), allocatable :: name

    name = text_behind('/proc/cpuinfo', 'model name')
    name = trim(adjustl(name(index(name, ':') + 1:)))
    if (len(name) == 0) name = 'unknown'
  end function processor_name

  !> Text that follows a label at the start of a line; empty without file or label.
  function text_behind(file, label) result(text)
    character(*), intent(in) :: file, label
    character(:), allocatable :: text
    character(200) :: line
    integer :: unit, status

    text = ''
    open (newunit=unit, file=file, status='old', action='read', &
      recl=line_length, iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (index(line, label) /= 1) cycle
      text = trim(line(len(label) + 1:))
      exit
    end do
    close (unit)
  end function text_behind

end module memory_m
