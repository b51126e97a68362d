! SPDX-License-Identifier: MIT
!> Layouts of DYNA's text files, byte for byte as scripts read them: one block of lines for all rows
!> of one instant. Columns are those of `history_tables`, by number; forces and energies per unit
!> depth. In a layout each `@` stands for the next number and each `|` ends a line.
module dyna_layouts_m
  use controls_m, only : boundary_load, boundary_body_load, boundary_pressure, &
    boundary_motion, boundary_body_motion
  use history_tables_m, only : table_glstat, table_rcforc, table_nodout, table_matsum, &
    table_rwforc, table_sleout, table_spcforc, table_elout, table_rbdout, table_bndout, &
    table_nodfor, table_secforc
  use kinds_m, only : wp
  use text_m, only : es, integer_size, put_integer
  use text_files_m, only : line_file_t, put_lines
  implicit none
  private
  public :: put_line, put_head, put_instant

  real(wp), parameter :: zero = 0.0_wp

  !> Labels of glstat, each with its dots.
  integer, parameter :: n_label = 19
  !> Labels of glstat with their dots.
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

  !> Forces and energy of a node or body, and their sums.
  character(*), parameter :: force_line = '  xforce=@   yforce=@  zforce=@   energy=@|', &
    total_line = '              xtotal=@   ytotal=@  ztotal=@   etotal=@|'

contains

  !> Write one line.
  subroutine put_line(file, text)
    type(line_file_t), intent(inout) :: file
    character(*), intent(in) :: text

    call put_lines(file, text//new_line('a'))
  end subroutine put_line

  !> Write the lines of a layout.
  subroutine put(file, layout, values, width, n_digit)
    type(line_file_t), intent(inout) :: file
    character(*), intent(in) :: layout
    real(wp), intent(in) :: values(:)         !! one for each `@`
    integer, intent(in) :: width, n_digit     !! of each as ESw.d
    character(len(layout) + (width - 1)*size(values)) :: text
    integer :: i, k, n

    k = 0
    n = 0
    do i = 1, len(layout)
      select case (layout(i:i))
      case ('@')
        k = k + 1
        text(n + 1:n + width) = es(values(k), width, n_digit)
        n = n + width - 1
      case ('|')
        text(n + 1:n + 1) = new_line('a')
      case default
        text(n + 1:n + 1) = layout(i:i)
      end select
      n = n + 1
    end do
    call put_lines(file, text(:n))
  end subroutine put

  !> A whole number, right-justified in `width` columns or as many as it needs.
  pure function number(value, width) result(text)
    real(wp), intent(in) :: value
    integer, intent(in) :: width
    character(:), allocatable :: text
    character(integer_size) :: digits
    integer :: n

    call put_integer(nint(value), digits, n)
    text = repeat(' ', max(width - n, 0))//digits(:n)
  end function number

  !> Write the head of a file, after its legend.
  subroutine put_head(i_table, file)
    integer, intent(in) :: i_table   !! one of `table_`
    type(line_file_t), intent(inout) :: file
    real(wp), parameter :: none(0) = 0.0_wp

    select case (i_table)
    case (table_spcforc)
      call put(file, ' single point constraint forces||', none, 1, 0)
    case (table_rwforc)
      call put(file, '||    time       wall#   normal-force    x-force        y-force        ' &
        //'z-force|', none, 1, 0)
    case (table_secforc)
      call put(file, ' line#1   section#     time      x-force      y-force      z-force    ' &
        //'magnitude| line#2   resultant moments     x-moment     y-moment     z-moment    ' &
        //'magnitude| line#3   centroids                    x            y            z    ' &
        //'     area||', none, 1, 0)
    end select
  end subroutine put_head

  !> Write the lines of one instant.
  subroutine put_instant(i_table, control, scales, rows, file)
    integer, intent(in) :: i_table       !! one of `table_`
    character(*), intent(in) :: control  !! what determines the step where no element does
    logical, intent(in) :: scales        !! masses are scaled
    real(wp), intent(in) :: rows(:, :)   !! (n_column, n_row)
    type(line_file_t), intent(inout) :: file
    character(*), parameter :: indent = repeat(' ', 24)
    integer :: i

    select case (i_table)
    case (table_glstat)
      call put_glstat(rows(:, 1), control, scales, file)
    case (table_rcforc)
      do i = 1, size(rows, 2)
        call put(file, '  '//merge('slave ', 'master', nint(rows(3, i)) == 1) &
          //number(rows(2, i), 11)//' time@  x @  y @  z @ mass @|', &
          [rows(1, i), rows(4:5, i), zero, zero], 12, 5)
      end do
    case (table_nodout)
      call put_nodout(rows, file)
    case (table_matsum)
      call put_matsum(rows, file)
    case (table_sleout)
      call put_sleout(rows, file)
    case (table_spcforc)
      call put(file, ' output at time =@|', rows(1:1, 1), 14, 5)
      do i = 1, size(rows, 2)
        call put(file, ' node='//number(rows(2, i), 8)//' local x,y,z forces =@@@|', &
          [rows(3:4, i), zero], 14, 4)
      end do
      call put(file, '             force resultants   =@@@|', [sum(rows(3:4, :), 2), zero], 14, 4)
    case (table_rwforc)
      do i = 1, size(rows, 2)
        call put(file, es(rows(1, i), 12, 5)//number(rows(2, i), 8)//'@@@@|', &
          [rows(5, i), rows(3:4, i), zero], 15, 6)
      end do
    case (table_elout)
      call put_elout(rows, file)
    case (table_rbdout)
      call put_rbdout(rows, file)
    case (table_bndout)
      call put_section('discrete nodal point forces', [boundary_load, boundary_body_load], rows, &
        file)
      call put_section('pressure boundary condition forces', [boundary_pressure], rows, file)
      call put_section('velocity boundary condition forces/rigid body moments', &
        [boundary_motion, boundary_body_motion], rows, file)
    case (table_nodfor)
      call put_nodfor(rows, file)
    case (table_secforc)
      do i = 1, size(rows, 2)
        call put(file, number(rows(2, i), 11)//'@@@@@|'//indent//'@@@@|'//indent//'@@@@||', &
          [rows(1, i), rows(3:4, i), zero, norm2(rows(3:4, i)), zero, zero, rows(5, i), &
          abs(rows(5, i)), rows(6:7, i), zero, rows(8, i)], 13, 4)
      end do
    end select
  end subroutine put_instant

  !> Energies. DYNA counts the work of bulk viscosity as internal energy, and eroded energy in
  !> kinetic, internal and hourglass energy, with separate lines for the eroded parts; so the lines
  !> add up to the total except for the leap-frog term (doc/results.md). Eroded energy of contact
  !> springs stays with the sliding energy, since DYNA has no line for it.
  subroutine put_glstat(row, control, scales, file)
    real(wp), intent(in) :: row(:)
    character(*), intent(in) :: control
    logical, intent(in) :: scales
    type(line_file_t), intent(inout) :: file
    character(:), allocatable :: by
    real(wp) :: values(n_label), share
    integer :: i

    by = control
    if (nint(row(25)) > 0) by = 'shell '//number(row(25), 8)//' of part '//number(row(26), 8)
    if (scales .and. nint(row(18)) > 0) by = 'dt2ms'
    associate (eroded => row(19:22), total => row(11))
      share = 1.0_wp
      if (abs(total) > zero) share = 1.0_wp - sum(eroded)/total
      values = [row(1), row(3), row(4) + eroded(1), row(5) + row(7) + eroded(2), zero, zero, &
        row(6) + eroded(3), row(8), row(9) + row(14) + eroded(4), row(10), eroded(:3), total, &
        row(12), share*row(12), row(23), row(24), zero]
    end associate
    call put(file, '|| dt of cycle'//number(row(2), 8)//' is controlled by '//by//'||', &
      values(:0), 14, 5)
    do i = 1, n_label
      call put(file, labels(i)//'@|', values(i:i), 14, 5)
    end do
    call put_line(file, ' time per zone cycle.(nanosec)..             0')
    if (scales) call put(file, '| added mass.....................@' &
      //'| percentage increase............@|', [row(15), row(17)], 14, 5)
  end subroutine put_glstat

  !> Motion of nodes.
  subroutine put_nodout(rows, file)
    real(wp), intent(in) :: rows(:, :)
    type(line_file_t), intent(inout) :: file
    character(:), allocatable :: id
    integer :: i

    call put(file, '||| n o d a l   p r i n t   o u t   f o r   t i m e  s t e p' &
      //number(rows(11, 1), 8)//repeat(' ', 30)//'( at time@ )|| nodal point  x-disp     ' &
      //'y-disp      z-disp      x-vel       y-vel       z-vel      x-accl      y-accl      ' &
      //'z-accl      x-coor      y-coor      z-coor|', rows(1:1, 1), 14, 7)
    do i = 1, size(rows, 2)
      id = number(rows(2, i), 9)
      if (len(id) == 9) id = id//' '
      call put_line(file, id//es([rows(5:6, i), zero, rows(7:8, i), zero, rows(9:10, i), zero, &
        rows(3:4, i), zero], 12, 4))
    end do
  end subroutine put_nodout

  !> Sums of parts; the rigid-body velocity is that of the centre of mass, `+mass` the mass added by
  !> mass scaling. Part ids use at least eight columns, short ones the first five.
  subroutine put_matsum(rows, file)
    real(wp), intent(in) :: rows(:, :)
    type(line_file_t), intent(inout) :: file
    character(:), allocatable :: id
    real(wp) :: velocity(2)
    integer :: i

    call put(file, '|| time =@|', rows(1:1, 1), 13, 4)
    do i = 1, size(rows, 2)
      id = number(rows(2, i), 5)
      if (len(id) < 8) id = id//repeat(' ', 8 - len(id))
      velocity = zero
      if (rows(8, i) > zero) velocity = rows(6:7, i)/rows(8, i)
      call put(file, ' mat.#='//id//'          inten=@     kinen=@     eroded_ie=@     ' &
        //'eroded_ke=@| x-mom=@     y-mom=@     z-mom=@| x-rbv=@     y-rbv=@     z-rbv=@|' &
        //repeat(' ', 25)//'hgeng=@     +mass=@|', [rows(4, i), rows(3, i), zero, zero, &
        rows(6:7, i), zero, velocity, zero, rows(5, i), rows(9, i)], 13, 4)
    end do
  end subroutine put_matsum

  !> Energies of interfaces. Penalty springs act between both sides: each interface has one number,
  !> as DYNA's single-sided contacts have, and the dissipation by friction.
  subroutine put_sleout(rows, file)
    real(wp), intent(in) :: rows(:, :)
    type(line_file_t), intent(inout) :: file
    integer, parameter :: energies(3) = [4, 5, 7] !! springs, damping, friction
    real(wp) :: total
    integer :: i

    total = sum(rows(energies, :))
    call put(file, '||| contact interface energy file, time=@|    #            slave       ' &
      //'master   frictional   cycle='//number(rows(2, 1), 14)//'||', rows(1:1, 1), 14, 7)
    do i = 1, size(rows, 2)
      call put(file, number(rows(3, i), 10)//'@@@|', [sum(rows(energies, i)), zero, rows(7, i)], &
        13, 4)
    end do
    call put(file, '| summary   total slave side=@|           total mastr side=@|           ' &
      //'total energy    =@|           friction energy =@|', [total, zero, total, &
      sum(rows(7, :))], 14, 7)
  end subroutine put_sleout

  !> Stress of elements. DYNA lists 2D solids among the shells, one line per through-thickness
  !> point; here one per element.
  subroutine put_elout(rows, file)
    real(wp), intent(in) :: rows(:, :)
    type(line_file_t), intent(inout) :: file
    character(8) :: state
    integer :: i

    call put(file, '||| e l e m e n t   s t r e s s   c a l c u l a t i o n s   f o r   ' &
      //'t i m e  s t e p'//number(rows(8, 1), 9)//'   ( at time@ )|| element  materl(global)|' &
      //' ipt-shl  stress       sig-xx      sig-yy      sig-zz      sig-xy      sig-yz      ' &
      //'sig-zx       plastic|           state'//repeat(' ', 82)//'strain|', rows(1:1, 1), 12, 5)
    do i = 1, size(rows, 2)
      state = 'elastic'
      if (rows(7, i) > zero) state = 'plastic'
      if (rows(10, i) > zero) state = 'failed'
      call put_line(file, number(rows(2, i), 8)//'-'//number(rows(9, i), 7))
      call put_line(file, '   1-  1 '//state//es([rows(3:6, i), zero, zero], 12, 4) &
        //es(rows(7, i), 14, 4))
    end do
  end subroutine put_elout

  !> Motion of rigid bodies, along global axes and along axes that rotate with the body and are
  !> global at time zero.
  subroutine put_rbdout(rows, file)
    real(wp), intent(in) :: rows(:, :)
    type(line_file_t), intent(inout) :: file
    real(wp) :: axes(3, 3), values(3, 3)
    integer :: i, k

    call put(file, '1||  r i g i d   b o d y   m o t i o n   a t  cycle=' &
      //number(rows(14, 1), 8)//'    time=@|', rows(1:1, 1), 15, 6)
    do i = 1, size(rows, 2)
      associate (angle => rows(7, i))
        axes = reshape([cos(angle), sin(angle), zero, -sin(angle), cos(angle), zero, zero, zero, &
          1.0_wp], [3, 3])
      end associate
      values = reshape(rows(5:13, i), [3, 3])
      call put(file, '| rigid body'//number(rows(2, i), 8)//'|   global             x           ' &
        //'y           z          x-rot       y-rot       z-rot|   coordinates:  @@@|', &
        [rows(3:4, i), zero], 12, 4)
      call put_motion()
      call put(file, '|principal or user defined local coordinate direction vectors|' &
        //'                     a           b           c|     row 1@@@|     row 2@@@|' &
        //'     row 3@@@|| output in principal or user defined local coordinate directions|' &
        //'                      a           b           c          a-rot       b-rot       ' &
        //'c-rot|', reshape(transpose(axes), [9]), 15, 4)
      do k = 1, 3
        values(:2, k) = matmul(values(:2, k), axes(:2, :2))
      end do
      call put_motion()
    end do

  contains

    !> Three translations and three rotations per line; those out of the plane are zero.
    subroutine put_motion()
      call put(file, ' displacements:  @@@@@@|    velocities:  @@@@@@| accelerations:  @@@@@@|', &
        [(values(:2, k), zero, zero, zero, values(3, k), k=1, 3)], 12, 4)
    end subroutine put_motion

  end subroutine put_rbdout

  !> Loads, pressures or prescribed motions with their sums, if there are any.
  subroutine put_section(title, conditions, rows, file)
    character(*), intent(in) :: title
    integer, intent(in) :: conditions(:)
    real(wp), intent(in) :: rows(:, :)
    type(line_file_t), intent(inout) :: file
    character(4), parameter :: heads(5) = [' nd#', ' mt#', ' nd#', ' nd#', 'mat#'] !! by `boundary_`
    real(wp) :: forces(4), total(4) !! along x, y and z, energy
    integer :: i

    if (.not. any([(any(nint(rows(2, i)) == conditions), i=1, size(rows, 2))])) return
    call put(file, '||||| n o d a l   f o r c e/e n e r g y    o u t p u t  t=@||||| '//title &
      //'||', rows(1:1, 1), 12, 5)
    total = zero
    do i = 1, size(rows, 2)
      if (.not. any(nint(rows(2, i)) == conditions)) cycle
      forces = [rows(4:5, i), zero, rows(7, i)]
      total = total + forces
      call put(file, heads(nint(rows(2, i)))//number(rows(3, i), 8)//force_line, forces, 13, 4)
      if (nint(rows(2, i)) == boundary_body_motion) call put(file, &
        '             xmoment=@  ymoment=@ zmoment=@|', [zero, zero, rows(6, i)], 13, 4)
    end do
    call put(file, total_line, total, 13, 4)
  end subroutine put_section

  !> Forces of node groups, and their sums. Rows of a group are consecutive.
  subroutine put_nodfor(rows, file)
    real(wp), intent(in) :: rows(:, :)
    type(line_file_t), intent(inout) :: file
    integer :: group(0:size(rows, 2) + 1), i, n_group
    real(wp) :: forces(4), total(4) !! along x, y and z, energy

    call put(file, '||||| n o d a l   f o r c e   g r o u p    o u t p u t  t=@|', rows(1:1, 1), &
      12, 5)
    group = [-1, nint(rows(2, :)), -1]
    n_group = 0
    do i = 1, size(rows, 2)
      if (group(i) /= group(i - 1)) then
        n_group = n_group + 1
        total = zero
        call put(file, '||||| nodal group output number '//number(real(n_group, wp), 2)//'||', &
          total(:0), 1, 0)
      end if
      forces = [rows(4:5, i), zero, rows(6, i)]
      total = total + forces
      call put(file, ' nd#'//number(rows(3, i), 8)//force_line, forces, 13, 4)
      if (group(i) /= group(i + 1)) call put(file, total_line, total, 13, 4)
    end do
  end subroutine put_nodfor

end module dyna_layouts_m
