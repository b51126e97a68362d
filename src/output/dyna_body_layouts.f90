! SPDX-License-Identifier: MIT
!> The layouts of DYNA's text files of elements and rigid bodies (see `dyna_layouts_m`).
module dyna_body_layouts_m
  use dyna_lines_m, only : line_size, add_line, number
  use kinds_m, only : wp
  use number_text_m, only : es
  implicit none
  private
  public :: form_elout, form_rbdout

contains

  !> Stress of elements. DYNA's 2D solids stand among the shells: one line for a point through the
  !> thickness, here one in all.
  pure subroutine form_elout(rows, lines, n_line)
    real(wp), intent(in) :: rows(:, :)
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line
    integer :: i

    do i = 1, 3
      call add_line('', lines, n_line)
    end do
    call add_line(' e l e m e n t   s t r e s s   c a l c u l a t i o n s   f o r   t i m e  ' &
      //'s t e p'//number(rows(8, 1), 9)//'   ( at time'//es(rows(1, 1), 12, 5)//' )', lines, &
      n_line)
    call add_line('', lines, n_line)
    call add_line(' element  materl(global)', lines, n_line)
    call add_line(' ipt-shl  stress       sig-xx      sig-yy      sig-zz      sig-xy      ' &
      //'sig-yz      sig-zx       plastic', lines, n_line)
    call add_line('           state'//repeat(' ', 82)//'strain', lines, n_line)
    do i = 1, size(rows, 2)
      call add_line(number(rows(2, i), 8)//'-'//number(rows(9, i), 7), lines, n_line)
      call add_line('   1-  1 '//state_of(rows(7, i), rows(10, i))//es([rows(3:6, i), 0.0_wp, &
        0.0_wp], 12, 4)//es(rows(7, i), 14, 4), lines, n_line)
    end do
  end subroutine form_elout

  !> What DYNA calls the state of the stress.
  pure function state_of(plastic_strain, is_gone) result(state)
    real(wp), intent(in) :: plastic_strain, is_gone
    character(8) :: state

    state = 'elastic'
    if (plastic_strain > 0.0_wp) state = 'plastic'
    if (is_gone > 0.0_wp) state = 'failed'
  end function state_of

  !> Motion of rigid bodies, along global axes and along those that turn with the body, which are
  !> the global ones at time zero.
  pure subroutine form_rbdout(rows, lines, n_line)
    real(wp), intent(in) :: rows(:, :)
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line
    character(*), parameter :: heads(3) = [character(17) :: ' displacements:', '    velocities:', &
      ' accelerations:']
    real(wp) :: axes(2, 2)
    integer :: i, k

    call add_line('1', lines, n_line)
    call add_line('', lines, n_line)
    call add_line('  r i g i d   b o d y   m o t i o n   a t  cycle='//number(rows(14, 1), 8) &
      //'    time='//es(rows(1, 1), 15, 6), lines, n_line)
    do i = 1, size(rows, 2)
      axes = reshape([cos(rows(7, i)), sin(rows(7, i)), -sin(rows(7, i)), cos(rows(7, i))], [2, 2])
      call add_line('', lines, n_line)
      call add_line(' rigid body'//number(rows(2, i), 8), lines, n_line)
      call add_line('   global             x           y           z          x-rot       ' &
        //'y-rot       z-rot', lines, n_line)
      call add_line('   coordinates:  '//es([rows(3:4, i), 0.0_wp], 12, 4), lines, n_line)
      do k = 1, 3
        call add_motion(heads(k), rows(3*k + 2:3*k + 4, i), lines, n_line)
      end do
      call add_axes(axes, lines, n_line)
      call add_line('                      a           b           c          a-rot       ' &
        //'b-rot       c-rot', lines, n_line)
      do k = 1, 3
        call add_motion(heads(k), [matmul(rows(3*k + 2:3*k + 3, i), axes), rows(3*k + 4, i)], &
          lines, n_line)
      end do
    end do
  end subroutine form_rbdout

  !> Where the axes of a body point.
  pure subroutine add_axes(axes, lines, n_line)
    real(wp), intent(in) :: axes(2, 2)   !! one a column
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line
    real(wp) :: rows(3, 3)
    integer :: k

    rows = 0.0_wp
    rows(:2, :2) = axes
    rows(3, 3) = 1.0_wp
    call add_line('', lines, n_line)
    call add_line('principal or user defined local coordinate direction vectors', lines, n_line)
    call add_line('                     a           b           c', lines, n_line)
    do k = 1, 3
      call add_line('     row '//number(real(k, wp), 1)//es(rows(k, :), 15, 4), lines, n_line)
    end do
    call add_line('', lines, n_line)
    call add_line(' output in principal or user defined local coordinate directions', lines, n_line)
  end subroutine add_axes

  !> One line of three translations and three rotations; those of the plane.
  pure subroutine add_motion(head, values, lines, n_line)
    character(*), intent(in) :: head
    real(wp), intent(in) :: values(3)
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line

    call add_line(head//es([values(1:2), 0.0_wp, 0.0_wp, 0.0_wp, values(3)], 12, 4), lines, n_line)
  end subroutine add_motion

end module dyna_body_layouts_m
