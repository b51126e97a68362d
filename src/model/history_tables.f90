! SPDX-License-Identifier: MIT
!> Table of the history files, over which deck reader, schedules, files, restarts and results loop.
!> `history_rows_m` fills the columns, `dyna_layouts_m` has the text layouts; doc/add_a_history.md
!> explains how to add a history.
module history_tables_m
  use text_m, only : upper_case
  implicit none
  private
  public :: history_table_t, history_tables, table_of_keyword, n_table, table_glstat, &
    table_rcforc, table_nodout, table_contact, table_matsum, table_rwforc, table_sleout, &
    table_spcforc, table_elout, table_rbdout, table_bndout, table_nodfor, table_secforc, &
    asked_alone, asked_or_states, asked_by_states, each_run, each_contact, each_history_node, &
    each_part, each_wall, each_support, each_history_element, each_body, each_boundary, &
    each_group_node, each_section, text_none, text_rows, text_instants

  !> Indices of the files, in the order of restart files and results.
  integer, parameter :: n_table = 13
  integer, parameter :: table_glstat = 1, table_rcforc = 2, table_nodout = 3, table_contact = 4, &
    table_matsum = 5, table_rwforc = 6, table_sleout = 7, table_spcforc = 8, &
    table_elout = 9, table_rbdout = 10, table_bndout = 11, table_nodfor = 12, &
    table_secforc = 13

  !> Interval of a file: by its keyword; by its keyword, or with the states where there is none;
  !> with the states, without a keyword.
  integer, parameter :: asked_alone = 1, asked_or_states = 2, asked_by_states = 3

  !> Entities of the rows of an instant. Without such entities in the model there is no file.
  integer, parameter :: each_run = 1, each_contact = 2, each_history_node = 3, each_part = 4, &
    each_wall = 5, each_support = 6, each_history_element = 7, each_body = 8, &
    each_boundary = 9, each_group_node = 10, each_section = 11

  !> Additional text file in DYNA's layout (BINARY): none, one block of lines for each row, or one
  !> for all rows of an instant.
  integer, parameter :: text_none = 0, text_rows = 1, text_instants = 2

  !> One file. Columns before the semicolon are in the CSV file, all columns in the results file.
  !> Marks before a name: # integer, @ side of an interface (1 slave, 2 master), + only with mass
  !> scaling, - only where elements may erode.
  type :: history_table_t
    character(8) :: name     !! end of the file's name, and of its keyword *DATABASE_<NAME>
    integer :: asked         !! one of `asked_`
    integer :: each          !! one of `each_`
    integer :: text          !! one of `text_`
    character(300) :: columns
  end type history_table_t

  type(history_table_t), parameter :: history_tables(n_table) = [ &
    history_table_t('glstat', asked_or_states, each_run, text_rows, &
      'time,#cycle,dt,kinetic,internal,hourglass,viscous,damping,contact,external_work,'// &
      'total,energy_ratio,leapfrog,friction,+added_mass,-eroded,+mass_increase,+#by_dt2ms,'// &
      '-eroded_kinetic,-eroded_internal,-eroded_hourglass,-eroded_contact;'// &
      'velocity_x,velocity_y,#element,#element_part'), &
    history_table_t('rcforc', asked_alone, each_contact, text_rows, &
      'time,#interface,@side,fx,fy,#n_active'), &
    history_table_t('nodout', asked_alone, each_history_node, text_instants, &
      'time,#node,x,y,ux,uy,vx,vy,ax,ay;#cycle'), &
    history_table_t('contact', asked_by_states, each_contact, text_none, &
      'time,#interface,#node,s,x,y,gap,pressure,fx,fy,length,traction,slip,#state,row_stress,'// &
      'offset'), &
    history_table_t('matsum', asked_alone, each_part, text_instants, &
      'time,#part,kinetic,internal,hourglass,momentum_x,momentum_y,mass,+added_mass'), &
    history_table_t('rwforc', asked_alone, each_wall, text_instants, &
      'time,#wall,fx,fy,normal_force,impulse,work,#n_active,tangential_force,friction,' &
      //'displacement'), &
    history_table_t('sleout', asked_alone, each_contact, text_instants, &
      'time,#cycle,#interface,energy,damping,stored,friction,estimate,row_energy,step_limit'), &
    history_table_t('spcforc', asked_alone, each_support, text_instants, 'time,#node,fx,fy'), &
    history_table_t('elout', asked_alone, each_history_element, text_instants, &
      'time,#element,sxx,syy,szz,sxy,plastic_strain;#cycle,#part,#is_gone'), &
    history_table_t('rbdout', asked_alone, each_body, text_instants, &
      'time,#part,x,y,ux,uy,rotation,vx,vy,spin,ax,ay,spin_rate;#cycle'), &
    history_table_t('bndout', asked_alone, each_boundary, text_instants, &
      'time,#condition,#id,fx,fy,moment,work'), &
    history_table_t('nodfor', asked_alone, each_group_node, text_instants, &
      'time,#group,#node,fx,fy,work'), &
    history_table_t('secforc', asked_alone, each_section, text_instants, &
      'time,#section,fx,fy,moment,x,y,area')]

contains

  !> Index of the table whose interval a keyword gives (DATABASE_GLSTAT, no asterisk); 0: none.
  pure function table_of_keyword(keyword) result(i_table)
    character(*), intent(in) :: keyword   !! in capital letters
    integer :: i_table
    character(*), parameter :: head = 'DATABASE_'

    do i_table = n_table, 1, -1
      if (history_tables(i_table)%asked == asked_by_states) cycle
      if (keyword == head//upper_case(history_tables(i_table)%name)) exit
    end do
  end function table_of_keyword

end module history_tables_m
