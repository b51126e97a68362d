! SPDX-License-Identifier: MIT
!> The layouts of DYNA's text files of forces on boundaries, of groups of nodes and of cross
!> sections (see `dyna_layouts_m`).
module dyna_force_layouts_m
  use controls_m, only : boundary_load, boundary_body_load, boundary_pressure, boundary_motion, &
    boundary_body_motion
  use dyna_lines_m, only : line_size, add_line, number
  use kinds_m, only : wp
  use number_text_m, only : es
  implicit none
  private
  public :: form_bndout, form_nodfor, form_secforc

contains

  !> Loads, pressures and prescribed motions, each with its sums; what there is none of is left out.
  pure subroutine form_bndout(rows, lines, n_line)
    real(wp), intent(in) :: rows(:, :)
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line

    call form_section('discrete nodal point forces', [boundary_load, boundary_body_load], rows, &
      lines, n_line)
    call form_section('pressure boundary condition forces', [boundary_pressure], rows, lines, &
      n_line)
    call form_section('velocity boundary condition forces/rigid body moments', [boundary_motion, &
      boundary_body_motion], rows, lines, n_line)
  end subroutine form_bndout

  !> The rows of some conditions.
  pure subroutine form_section(title, conditions, rows, lines, n_line)
    character(*), intent(in) :: title
    integer, intent(in) :: conditions(:)
    real(wp), intent(in) :: rows(:, :)
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line
    real(wp) :: total(3)
    integer :: i

    if (.not. any([(any(nint(rows(2, i)) == conditions), i=1, size(rows, 2))])) return
    call add_blanks(5, lines, n_line)
    call add_line(' n o d a l   f o r c e/e n e r g y    o u t p u t  t='//es(rows(1, 1), 12, 5), &
      lines, n_line)
    call add_blanks(4, lines, n_line)
    call add_line(' '//title, lines, n_line)
    call add_line('', lines, n_line)
    total = 0.0_wp
    do i = 1, size(rows, 2)
      if (.not. any(nint(rows(2, i)) == conditions)) cycle
      total = total + [rows(4:5, i), rows(7, i)]
      call add_force(head_of(nint(rows(2, i)))//number(rows(3, i), 8), [rows(4:5, i), rows(7, i)], &
        lines, n_line)
      if (nint(rows(2, i)) /= boundary_body_motion) cycle
      call add_line('             xmoment='//es(0.0_wp, 13, 4)//'  ymoment='//es(0.0_wp, 13, 4) &
        //' zmoment='//es(rows(6, i), 13, 4), lines, n_line)
    end do
    call add_total(total, lines, n_line)
  end subroutine form_section

  !> What a row of a condition begins with.
  pure function head_of(condition) result(head)
    integer, intent(in) :: condition
    character(4) :: head

    select case (condition)
    case (boundary_body_load)
      head = ' mt#'
    case (boundary_body_motion)
      head = 'mat#'
    case default
      head = ' nd#'
    end select
  end function head_of

  !> Forces of groups of nodes, and their sums. The rows of a group come together.
  pure subroutine form_nodfor(rows, lines, n_line)
    real(wp), intent(in) :: rows(:, :)
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line
    real(wp) :: total(3)
    integer :: i, n_group
    logical :: is_first, is_last

    call add_blanks(5, lines, n_line)
    call add_line(' n o d a l   f o r c e   g r o u p    o u t p u t  t='//es(rows(1, 1), 12, 5), &
      lines, n_line)
    n_group = 0
    total = 0.0_wp
    do i = 1, size(rows, 2)
      is_first = i == 1
      if (.not. is_first) is_first = nint(rows(2, i)) /= nint(rows(2, i - 1))
      is_last = i == size(rows, 2)
      if (.not. is_last) is_last = nint(rows(2, i)) /= nint(rows(2, i + 1))
      if (is_first) then
        n_group = n_group + 1
        total = 0.0_wp
        call add_blanks(5, lines, n_line)
        call add_line(' nodal group output number '//number(real(n_group, wp), 2), lines, n_line)
        call add_line('', lines, n_line)
      end if
      total = total + rows(4:6, i)
      call add_force(' nd#'//number(rows(3, i), 8), rows(4:6, i), lines, n_line)
      if (is_last) call add_total(total, lines, n_line)
    end do
  end subroutine form_nodfor

  !> Cross sections: force, moment, centroid with area, and the global axes, a line each.
  pure subroutine form_secforc(rows, lines, n_line)
    real(wp), intent(in) :: rows(:, :)
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line
    integer :: i

    do i = 1, size(rows, 2)
      call add_line(number(rows(2, i), 11)//es([rows(1, i), rows(3:4, i), 0.0_wp, &
        norm2(rows(3:4, i))], 13, 4), lines, n_line)
      call add_line(repeat(' ', 24)//es([0.0_wp, 0.0_wp, rows(5, i), abs(rows(5, i))], 13, 4), &
        lines, n_line)
      call add_line(repeat(' ', 24)//es([rows(6:7, i), 0.0_wp, rows(8, i)], 13, 4), lines, n_line)
      call add_line('', lines, n_line)
    end do
  end subroutine form_secforc

  !> One line of a node or a body.
  pure subroutine add_force(head, values, lines, n_line)
    character(*), intent(in) :: head
    real(wp), intent(in) :: values(3)  !! force along x and y, energy
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line

    call add_line(head//'  xforce='//es(values(1), 13, 4)//'   yforce='//es(values(2), 13, 4) &
      //'  zforce='//es(0.0_wp, 13, 4)//'   energy='//es(values(3), 13, 4), lines, n_line)
  end subroutine add_force

  !> Sums of some lines.
  pure subroutine add_total(values, lines, n_line)
    real(wp), intent(in) :: values(3)  !! as in `add_force`
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line

    call add_line('              xtotal='//es(values(1), 13, 4)//'   ytotal=' &
      //es(values(2), 13, 4)//'  ztotal='//es(0.0_wp, 13, 4)//'   etotal='//es(values(3), 13, 4), &
      lines, n_line)
  end subroutine add_total

  !> Some empty lines.
  pure subroutine add_blanks(n, lines, n_line)
    integer, intent(in) :: n
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line
    integer :: i

    do i = 1, n
      call add_line('', lines, n_line)
    end do
  end subroutine add_blanks

end module dyna_force_layouts_m
