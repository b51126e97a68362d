! SPDX-License-Identifier: MIT
!> Sense switches: a word in a file `d3kil` of the results folder asks a run for
!> something, in the DYNA manner.
module sense_switch_m
  use errors_m, only : error_t
  use files_m, only : file_exists, is_endless, remove_file, join_path
  use text_m, only : upper_case
  implicit none
  private
  public :: switch_path, take_switch, forget_switch, switch_none, switch_dump_and_stop, &
    switch_status, switch_dump, switch_plot, switch_stop, switch_flush, switch_unknown

  !> What is asked for: nothing; sw1, sw2, sw3, sw4, stop, swa; a word that says nothing.
  integer, parameter :: switch_none = 0, switch_dump_and_stop = 1, switch_status = 2, &
    switch_dump = 3, switch_plot = 4, switch_stop = 5, switch_flush = 6, switch_unknown = 7
  !> Words of the first six (`SWA.` too, as old manuals write it).
  character(4), parameter :: words(6) = [character(4) :: 'SW1', 'SW2', 'SW3', 'SW4', 'STOP', 'SWA']
  character(*), parameter :: file_name = 'd3kil'
  !> Longest line that is read, whatever the environment says (GFORTRAN_DEFAULT_RECL).
  integer, parameter :: line_length = 100000

contains

  !> Where a request is looked for.
  pure function switch_path(directory) result(path)
    character(*), intent(in) :: directory !! of the results
    character(:), allocatable :: path

    path = join_path(directory, file_name)
  end function switch_path

  !> What the file in this folder asks for; the file is removed. One without a word is left: it
  !> may be about to be written.
  subroutine take_switch(directory, switch)
    character(*), intent(in) :: directory
    integer, intent(out) :: switch  !! one of the `switch_` constants
    type(error_t), allocatable :: ignored
    character(80) :: line
    integer :: unit, status, i

    switch = switch_none
    if (.not. file_exists(switch_path(directory))) return
    if (is_endless(switch_path(directory))) return
    open (newunit=unit, file=switch_path(directory), status='old', action='read', &
      recl=line_length, iostat=status)
    if (status /= 0) return
    read (unit, '(a)', iostat=status) line
    close (unit)
    if (status /= 0 .or. len_trim(line) == 0) return
    switch = switch_unknown
    line = upper_case(adjustl(line))
    if (line(4:) == '.') line(4:) = ''
    do i = 1, size(words)
      if (line == words(i)) switch = i
    end do
    call remove_file(switch_path(directory), ignored)
  end subroutine take_switch

  !> Remove a file that was meant for an earlier run.
  subroutine forget_switch(directory)
    character(*), intent(in) :: directory
    type(error_t), allocatable :: ignored

    call remove_file(switch_path(directory), ignored)
  end subroutine forget_switch

end module sense_switch_m
