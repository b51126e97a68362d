! SPDX-License-Identifier: MIT
!> The layouts of DYNA's text files, byte for byte as scripts read them: one block of lines
!> for all rows of one instant. Rows are those of the history tables (`history_rows_m`), with the
!> columns that a layout names, in its order; forces and energies per unit depth.
module dyna_layouts_m
  use dyna_body_layouts_m, only : form_elout, form_rbdout
  use dyna_force_layouts_m, only : form_bndout, form_nodfor, form_secforc
  use dyna_lines_m, only : line_size, add_line, number
  use history_tables_m, only : table_glstat, table_rcforc, table_nodout, table_matsum, &
    table_rwforc, table_sleout, table_spcforc, table_elout, table_rbdout, table_bndout, &
    table_nodfor, table_secforc
  use kinds_m, only : wp
  use number_text_m, only : es
  implicit none
  private
  public :: columns_of, n_line_of, form_block

  !> Labels of glstat, each with its dots.
  integer, parameter :: n_label = 19
  character(32), parameter :: labels(n_label) = [character(32) :: &
    ' time...........................', &
    ' time step......................', &
    ' kinetic energy.................', &
    ' internal energy................', &
    ' stonewall energy...............', &
    ' spring and damper energy.......', &
    ' hourglass energy ..............', &
    ' system damping energy..........', &
    ' sliding interface energy.......', &
    ' external work..................', &
    ' eroded kinetic energy..........', &
    ' eroded internal energy.........', &
    ' eroded hourglass energy........', &
    ' total energy...................', &
    ' total energy / initial energy..', &
    ' energy ratio w/o eroded energy.', &
    ' global x velocity..............', &
    ' global y velocity..............', &
    ' global z velocity..............']

contains

  !> The columns that a layout takes, with commas between.
  pure function columns_of(i_table) result(names)
    integer, intent(in) :: i_table   !! one of `table_`
    character(:), allocatable :: names

    names = ''
    select case (i_table)
    case (table_glstat)
      names = 'time,cycle,dt,kinetic,internal,hourglass,viscous,damping,contact,external_work,'// &
        'total,energy_ratio,leapfrog,velocity_x,velocity_y,element,element_part,'// &
        'friction,eroded_kinetic,eroded_internal,eroded_hourglass,eroded_contact,'// &
        'added_mass,mass_increase,by_dt2ms'
    case (table_rcforc)
      names = 'time,interface,side,fx,fy'
    case (table_nodout)
      names = 'time,node,x,y,ux,uy,vx,vy,ax,ay,cycle'
    case (table_matsum)
      names = 'time,part,kinetic,internal,hourglass,momentum_x,momentum_y,mass,added_mass'
    case (table_sleout)
      names = 'time,cycle,interface,energy,damping,friction'
    case (table_spcforc)
      names = 'time,node,fx,fy'
    case (table_rwforc)
      names = 'time,wall,normal_force,fx,fy'
    case (table_elout)
      names = 'time,element,sxx,syy,szz,sxy,plastic_strain,cycle,part,is_gone'
    case (table_rbdout)
      names = 'time,part,x,y,ux,uy,rotation,vx,vy,spin,ax,ay,spin_rate,cycle'
    case (table_bndout)
      names = 'time,condition,id,fx,fy,moment,work'
    case (table_nodfor)
      names = 'time,group,node,fx,fy,work'
    case (table_secforc)
      names = 'time,section,fx,fy,moment,x,y,area'
    end select
  end function columns_of

  !> Lines of a block of `n_row` rows, at most.
  pure function n_line_of(i_table, n_row) result(n)
    integer, intent(in) :: i_table   !! one of `table_`
    integer, intent(in) :: n_row
    integer :: n

    select case (i_table)
    case (table_glstat)
      n = n_label + 8
    case (table_matsum)
      n = 4*n_row + 3
    case (table_elout)
      n = 2*n_row + 9
    case (table_rbdout)
      n = 20*n_row + 3
    case (table_bndout)
      n = 2*n_row + 45
    case (table_nodfor)
      n = 9*n_row + 6
    case (table_secforc)
      n = 5*n_row
    case default
      n = n_row + 13
    end select
  end function n_line_of

  !> The lines of one instant.
  pure subroutine form_block(i_table, control, scales, rows, lines, n_line)
    integer, intent(in) :: i_table                      !! one of `table_`
    character(*), intent(in) :: control                 !! what rules the step where no element does
    logical, intent(in) :: scales                       !! masses are scaled
    real(wp), intent(in) :: rows(:, :)                  !! (n_column, n_row) of `columns_of`
    character(line_size), intent(inout) :: lines(:)     !! `n_line_of` or more
    integer, intent(out) :: n_line

    n_line = 0
    select case (i_table)
    case (table_glstat)
      call form_glstat(rows(:, 1), control, scales, lines, n_line)
    case (table_rcforc)
      call form_rcforc(rows, lines, n_line)
    case (table_nodout)
      call form_nodout(rows, lines, n_line)
    case (table_matsum)
      call form_matsum(rows, lines, n_line)
    case (table_sleout)
      call form_sleout(rows, lines, n_line)
    case (table_spcforc)
      call form_spcforc(rows, lines, n_line)
    case (table_rwforc)
      call form_rwforc(rows, lines, n_line)
    case (table_elout)
      call form_elout(rows, lines, n_line)
    case (table_rbdout)
      call form_rbdout(rows, lines, n_line)
    case (table_bndout)
      call form_bndout(rows, lines, n_line)
    case (table_nodfor)
      call form_nodfor(rows, lines, n_line)
    case (table_secforc)
      call form_secforc(rows, lines, n_line)
    end select
  end subroutine form_block

  !> Energies. DYNA counts the work of the bulk viscosity as internal energy, and what has eroded in
  !> kinetic, internal and hourglass energy, of which the eroded lines say how much; so the lines of
  !> these energies add up to the total but for what leap-frog adds (doc/results.md). Springs of
  !> contact that went with elements stay with those that are there: DYNA has no line for them.
  pure subroutine form_glstat(row, control, scales, lines, n_line)
    real(wp), intent(in) :: row(:)
    character(*), intent(in) :: control
    logical, intent(in) :: scales
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line
    real(wp) :: values(n_label)
    real(wp) :: share
    integer :: i

    call add_line('', lines, n_line)
    call add_line('', lines, n_line)
    if (scales .and. nint(row(25)) > 0) then
      call add_line(' dt of cycle'//number(row(2), 8)//' is controlled by dt2ms', lines, n_line)
    else if (nint(row(16)) > 0) then
      call add_line(' dt of cycle'//number(row(2), 8)//' is controlled by shell ' &
        //number(row(16), 8)//' of part '//number(row(17), 8), lines, n_line)
    else
      call add_line(' dt of cycle'//number(row(2), 8)//' is controlled by '//control, lines, n_line)
    end if
    call add_line('', lines, n_line)
    share = 1.0_wp
    if (abs(row(11)) > 0.0_wp) share = 1.0_wp - sum(row(19:22))/row(11)
    values = [row(1), row(3), row(4) + row(19), row(5) + row(7) + row(20), 0.0_wp, 0.0_wp, &
      row(6) + row(21), row(8), row(9) + row(18) + row(22), row(10), row(19:21), row(11), row(12), &
      share*row(12), row(14), row(15), 0.0_wp]
    do i = 1, n_label
      call add_line(labels(i)//es(values(i), 14, 5), lines, n_line)
    end do
    call add_line(' time per zone cycle.(nanosec)..             0', lines, n_line)
    if (.not. scales) return
    call add_line('', lines, n_line)
    call add_line(' added mass.....................'//es(row(23), 14, 5), lines, n_line)
    call add_line(' percentage increase............'//es(row(24), 14, 5), lines, n_line)
  end subroutine form_glstat

  !> Contact forces, a line for each side.
  pure subroutine form_rcforc(rows, lines, n_line)
    real(wp), intent(in) :: rows(:, :)
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line
    integer :: i

    do i = 1, size(rows, 2)
      call add_line('  '//merge('slave ', 'master', nint(rows(3, i)) == 1)//number(rows(2, i), 11) &
        //' time'//es(rows(1, i), 12, 5)//'  x '//es(rows(4, i), 12, 5)//'  y ' &
        //es(rows(5, i), 12, 5)//'  z '//es(0.0_wp, 12, 5)//' mass '//es(0.0_wp, 12, 5), lines, &
        n_line)
    end do
  end subroutine form_rcforc

  !> Motion of nodes.
  pure subroutine form_nodout(rows, lines, n_line)
    real(wp), intent(in) :: rows(:, :)
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line
    character(:), allocatable :: id
    integer :: i

    do i = 1, 3
      call add_line('', lines, n_line)
    end do
    call add_line(' n o d a l   p r i n t   o u t   f o r   t i m e  s t e p' &
      //number(rows(11, 1), 8)//repeat(' ', 30)//'( at time'//es(rows(1, 1), 14, 7)//' )', lines, &
      n_line)
    call add_line('', lines, n_line)
    call add_line(' nodal point  x-disp     y-disp      z-disp      x-vel       y-vel       ' &
      //'z-vel      x-accl      y-accl      z-accl      x-coor      y-coor      z-coor', lines, &
      n_line)
    do i = 1, size(rows, 2)
      id = number(rows(2, i), 9)
      if (len(id) == 9) id = id//' '
      call add_line(id//es([rows(5:6, i), 0.0_wp, rows(7:8, i), 0.0_wp, rows(9:10, i), 0.0_wp, &
        rows(3:4, i), 0.0_wp], 12, 4), lines, n_line)
    end do
  end subroutine form_nodout

  !> Sums of parts; the velocity of the body is that of its centre of mass, `+mass` is the mass that
  !> mass scaling has added.
  pure subroutine form_matsum(rows, lines, n_line)
    real(wp), intent(in) :: rows(:, :)
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line
    real(wp) :: velocity(2)
    integer :: i

    call add_line('', lines, n_line)
    call add_line('', lines, n_line)
    call add_line(' time ='//es(rows(1, 1), 13, 4), lines, n_line)
    do i = 1, size(rows, 2)
      velocity = 0.0_wp
      if (rows(8, i) > 0.0_wp) velocity = rows(6:7, i)/rows(8, i)
      call add_line(' mat.#='//part_field(rows(2, i))//'          inten='//es(rows(4, i), 13, 4) &
        //'     kinen='//es(rows(3, i), 13, 4)//'     eroded_ie='//es(0.0_wp, 13, 4) &
        //'     eroded_ke='//es(0.0_wp, 13, 4), lines, n_line)
      call add_line(' x-mom='//es(rows(6, i), 13, 4)//'     y-mom='//es(rows(7, i), 13, 4) &
        //'     z-mom='//es(0.0_wp, 13, 4), lines, n_line)
      call add_line(' x-rbv='//es(velocity(1), 13, 4)//'     y-rbv='//es(velocity(2), 13, 4) &
        //'     z-rbv='//es(0.0_wp, 13, 4), lines, n_line)
      call add_line(repeat(' ', 25)//'hgeng='//es(rows(5, i), 13, 4)//'     +mass=' &
        //es(rows(9, i), 13, 4), lines, n_line)
    end do
  end subroutine form_matsum

  !> Part id in eight columns or more: short ones stand in the first five.
  pure function part_field(id) result(field)
    real(wp), intent(in) :: id
    character(:), allocatable :: field

    field = number(id, 5)
    if (len(field) < 8) field = field//repeat(' ', 8 - len(field))
  end function part_field

  !> Energies of interfaces. Penalty springs act between the sides: each interface has one number,
  !> as DYNA's single-sided contacts do, and what of it friction has dissipated.
  pure subroutine form_sleout(rows, lines, n_line)
    real(wp), intent(in) :: rows(:, :)
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line
    integer :: i

    do i = 1, 3
      call add_line('', lines, n_line)
    end do
    call add_line(' contact interface energy file, time='//es(rows(1, 1), 14, 7), lines, n_line)
    call add_line('    #            slave       master   frictional   cycle=' &
      //number(rows(2, 1), 14), lines, n_line)
    call add_line('', lines, n_line)
    do i = 1, size(rows, 2)
      call add_line(number(rows(3, i), 10)//es([sum(rows(4:6, i)), 0.0_wp, rows(6, i)], 13, 4), &
        lines, n_line)
    end do
    call add_line('', lines, n_line)
    call add_line(' summary   total slave side='//es(sum(rows(4:6, :)), 14, 7), lines, n_line)
    call add_line('           total mastr side='//es(0.0_wp, 14, 7), lines, n_line)
    call add_line('           total energy    ='//es(sum(rows(4:6, :)), 14, 7), lines, n_line)
    call add_line('           friction energy ='//es(sum(rows(6, :)), 14, 7), lines, n_line)
  end subroutine form_sleout

  !> Forces of constraints on their nodes, and their sum.
  pure subroutine form_spcforc(rows, lines, n_line)
    real(wp), intent(in) :: rows(:, :)
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line
    integer :: i

    call add_line(' output at time ='//es(rows(1, 1), 14, 5), lines, n_line)
    do i = 1, size(rows, 2)
      call add_line(' node='//number(rows(2, i), 8)//' local x,y,z forces =' &
        //es([rows(3:4, i), 0.0_wp], 14, 4), lines, n_line)
    end do
    call add_line('             force resultants   =' &
      //es([sum(rows(3, :)), sum(rows(4, :)), 0.0_wp], 14, 4), lines, n_line)
  end subroutine form_spcforc

  !> Forces of rigid walls.
  pure subroutine form_rwforc(rows, lines, n_line)
    real(wp), intent(in) :: rows(:, :)
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line
    integer :: i

    do i = 1, size(rows, 2)
      call add_line(es(rows(1, i), 12, 5)//number(rows(2, i), 8) &
        //es([rows(3:5, i), 0.0_wp], 15, 6), lines, n_line)
    end do
  end subroutine form_rwforc

end module dyna_layouts_m
