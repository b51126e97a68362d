! SPDX-License-Identifier: MIT
!> Prints K, the unit of all times: `yardstick_ns,<ns per element>` of the least disturbed of many short rounds.
!> usage: yardstick [ROUNDS]   (5000; a round takes some 40 microseconds)
program yardstick
  use, intrinsic :: iso_c_binding, only : c_intptr_t, c_loc
  use, intrinsic :: iso_fortran_env, only : int64, wp => real64
  use yardstick_kernel_m, only : advance_yardstick, n_element, yardstick_sums_t
  implicit none

  integer, parameter :: n_call = 200
  ! Columns of the memory, n_element reals each.
  integer, parameter :: place = 0, velocity = 8, area_2 = 16, deviator = 17, strain = 20, force = 21, n_column = 29
  integer, parameter :: line = 8 ! reals in a line of the cache
  real(wp), target :: memory(n_column*n_element + line)
  character(20) :: word
  integer :: n_round, first

  n_round = 5000
  call get_command_argument(1, word)
  if (word /= '') read (word, *) n_round
  ! A vector that lies across two lines costs two loads: the columns begin with a line.
  first = 1 + modulo(-int(transfer(c_loc(memory), 0_c_intptr_t)/8_c_intptr_t), line)
  call measure(n_round, memory(first:first + n_column*n_element - 1))

contains

  !> Rounds of steps; the time of the quickest is printed.
  subroutine measure(n_round, column)
    integer, intent(in) :: n_round
    real(wp), intent(inout) :: column(n_element, 0:n_column - 1)
    real(wp), parameter :: dt = 1.0e-6_wp ! s
    type(yardstick_sums_t) :: sums
    integer(int64) :: start, finish, per_second, least
    integer :: i_round, i_call

    call set_up(column)
    least = huge(least)
    call system_clock(start, per_second)
    do i_round = 1, n_round
      call system_clock(start)
      do i_call = 1, n_call
        call advance_yardstick(column(1, place), column(1, velocity), column(1, area_2), dt, column(1, deviator), &
          column(1, strain), column(1, force), sums)
      end do
      call system_clock(finish)
      least = min(least, finish - start)
    end do
    call check(column, sums)
    print '(a, f0.3)', 'yardstick_ns,', 1.0e9_wp*real(least, wp)/real(per_second, wp)/(n_call*n_element)
  end subroutine measure

  !> Squares of a metre out of shape by up to a tenth, in motion at up to 10 m/s.
  subroutine set_up(column)
    real(wp), intent(out) :: column(n_element, 0:n_column - 1)
    real(wp), parameter :: corner(8) = [0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp] ! x, then y
    integer :: i

    column = 0.0_wp
    call random_number(column(:, place:velocity + 7))
    do i = 1, 8
      column(:, place + i - 1) = corner(i) + 0.1_wp*column(:, place + i - 1)
    end do
    column(:, velocity:velocity + 7) = 10.0_wp*column(:, velocity:velocity + 7)
    column(:, area_2) = 2.0_wp
  end subroutine set_up

  !> That the steps were those of elements that yield and whose forces have neither resultant nor moment.
  subroutine check(column, sums)
    real(wp), intent(in) :: column(n_element, 0:n_column - 1)
    type(yardstick_sums_t), intent(in) :: sums
    real(wp) :: moment(n_element), slight

    associate (x => column(:, place:place + 3), y => column(:, place + 4:place + 7), &
               fx => column(:, force:force + 3), fy => column(:, force + 4:force + 7))
      slight = 1.0e-12_wp*maxval(abs(column(:, force:)))
      moment = sum(x*fy - y*fx, dim=2)
      if (maxval(abs(moment)) > slight .or. maxval(abs(sum(fx, dim=2))) > slight .or. &
          maxval(abs(sum(fy, dim=2))) > slight .or. .not. slight > 0.0_wp) error stop 'forces out of balance'
    end associate
    if (.not. maxval(column(:, strain)) > 0.0_wp) error stop 'no element yields'
    if (.not. (sums%stiffest > 0.0_wp .and. sums%argument < 0.02_wp)) error stop 'elements out of shape'
  end subroutine check

end program yardstick
