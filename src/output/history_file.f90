! SPDX-License-Identifier: MIT
!> The histories: one CSV table per quantity, and DYNA's text file beside it where the deck asks for
!> it. A table whose output was not asked for is not made.
module history_file_m
  use errors_m, only : error_t
  use model_m, only : model_t
  use controls_m, only : interval_t, is_asked
  use supports_m, only : mark_supports
  use csv_table_m, only : csv_table_t, plan_table, open_table, check_table, flush_table, &
    close_table, n_columns, kind_real, kind_integer, kind_side
  use dyna_layouts_m, only : layout_glstat, layout_rcforc, layout_nodout, layout_matsum, &
    layout_sleout, layout_spcforc
  use dyna_text_m, only : open_dyna_text
  implicit none
  private
  public :: histories_t, plan_histories, open_histories, check_histories, flush_histories, &
    close_histories, n_table, table_glstat, table_rcforc, table_nodout, table_contact, &
    table_matsum, table_rwforc, table_sleout, table_spcforc, table_names

  integer, parameter :: n_table = 8
  integer, parameter :: table_glstat = 1, table_rcforc = 2, table_nodout = 3, table_contact = 4, &
    table_matsum = 5, table_rwforc = 6, table_sleout = 7, table_spcforc = 8
  character(8), parameter :: table_names(n_table) = [character(8) :: 'glstat', 'rcforc', &
    'nodout', 'contact', 'matsum', 'rwforc', 'sleout', 'spcforc']

  !> Columns of the tables, as users' scripts know them.
  character(*), parameter :: glstat_columns = 'time,cycle,dt,kinetic,internal,hourglass,'// &
    'viscous,damping,contact,external_work,total,energy_ratio,leapfrog'
  character(*), parameter :: rcforc_columns = 'time,interface,side,fx,fy,n_active'
  character(*), parameter :: nodout_columns = 'time,node,x,y,ux,uy,vx,vy,ax,ay'
  character(*), parameter :: contact_columns = 'time,interface,node,s,x,y,gap,pressure,fx,fy,length'
  character(*), parameter :: matsum_columns = 'time,part,kinetic,internal,hourglass,'// &
    'momentum_x,momentum_y,mass'
  character(*), parameter :: rwforc_columns = 'time,wall,fx,fy,normal_force,impulse,work,n_active'
  character(*), parameter :: sleout_columns = 'time,cycle,interface,energy,damping,stored'
  character(*), parameter :: spcforc_columns = 'time,node,fx,fy'

  !> All tables of a run.
  type :: histories_t
    type(csv_table_t) :: tables(n_table) !! by the `table_` constants
  end type histories_t

contains

  !> The tables that were asked for, without files. glstat always; the others with an interval and
  !> something to write: interfaces for rcforc, sleout and contact, history nodes for nodout, rigid
  !> walls for rwforc, fixed nodes for spcforc.
  subroutine plan_histories(histories, model)
    type(histories_t), intent(out) :: histories
    type(model_t), intent(in) :: model
    integer, parameter :: r = kind_real, i = kind_integer
    logical :: wanted(n_table)
    character(:), allocatable :: name
    integer :: k

    wanted = wanted_tables(model)
    do k = 1, n_table
      if (.not. wanted(k)) cycle
      name = trim(table_names(k))
      associate (table => histories%tables(k))
        select case (k)
        case (table_glstat)
          call plan_table(table, name, glstat_columns, &
            [r, i, r, r, r, r, r, r, r, r, r, r, r, r, r, i, i], &
            'velocity_x,velocity_y,element,element_part')
        case (table_rcforc)
          call plan_table(table, name, rcforc_columns, [r, i, kind_side, r, r, i])
        case (table_nodout)
          call plan_table(table, name, nodout_columns, [r, i, r, r, r, r, r, r, r, r, i], 'cycle')
        case (table_contact)
          call plan_table(table, name, contact_columns, [r, i, i, r, r, r, r, r, r, r, r])
        case (table_matsum)
          call plan_table(table, name, matsum_columns, [r, i, r, r, r, r, r, r])
        case (table_rwforc)
          call plan_table(table, name, rwforc_columns, [r, i, r, r, r, r, r, i])
        case (table_sleout)
          call plan_table(table, name, sleout_columns, [r, i, i, r, r, r])
        case (table_spcforc)
          call plan_table(table, name, spcforc_columns, [r, i, r, r])
        end select
      end associate
    end do
  end subroutine plan_histories

  !> Plan the tables and make their files.
  subroutine open_histories(histories, prefix, model, error)
    type(histories_t), intent(out) :: histories
    character(*), intent(in) :: prefix   !! directory and job name
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    integer :: k

    call plan_histories(histories, model)
    do k = 1, n_table
      if (.not. allocated(histories%tables(k)%values)) cycle
      call open_table(histories%tables(k), prefix, error)
      if (allocated(error)) return
    end do
    call open_texts(histories, prefix, model, error)
  end subroutine open_histories

  !> Which tables the run has.
  pure function wanted_tables(model) result(wanted)
    type(model_t), intent(in) :: model
    logical :: wanted(n_table)
    logical :: has_contacts

    has_contacts = .false.
    if (allocated(model%contacts)) has_contacts = size(model%contacts) > 0
    associate (plan => model%controls%output)
      wanted(table_glstat) = .true.
      wanted(table_rcforc) = is_asked(plan%rcforc) .and. has_contacts
      wanted(table_nodout) = is_asked(plan%nodout) .and. n_history_node(model) > 0
      wanted(table_contact) = is_asked(plan%plot) .and. has_contacts
      wanted(table_matsum) = is_asked(plan%matsum)
      wanted(table_rwforc) = is_asked(plan%rwforc) .and. allocated(model%walls)
      wanted(table_sleout) = is_asked(plan%sleout) .and. has_contacts
      wanted(table_spcforc) = is_asked(plan%spcforc) .and. any(mark_supports(model))
    end associate
  end function wanted_tables

  !> The files in DYNA's layout.
  subroutine open_texts(histories, prefix, model, error)
    type(histories_t), intent(inout) :: histories
    character(*), intent(in) :: prefix
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error

    associate (plan => model%controls%output)
      call open_text(table_glstat, plan%glstat, layout_glstat)
      call open_text(table_rcforc, plan%rcforc, layout_rcforc)
      call open_text(table_nodout, plan%nodout, layout_nodout)
      call open_text(table_matsum, plan%matsum, layout_matsum)
      call open_text(table_sleout, plan%sleout, layout_sleout)
      call open_text(table_spcforc, plan%spcforc, layout_spcforc)
    end associate

  contains

    !> One file, unless an earlier one failed.
    subroutine open_text(i_table, interval, layout)
      integer, intent(in) :: i_table, layout
      type(interval_t), intent(in) :: interval

      if (allocated(error)) return
      associate (table => histories%tables(i_table))
        if (table%is_open .and. interval%is_text .and. is_asked(interval)) &
          call open_dyna_text(table%text, prefix//'.'//table%name, layout, model, &
          [n_columns(table), n_row_of_block(model, i_table)], error)
      end associate
    end subroutine open_text

  end subroutine open_texts

  !> Rows that make a block of a text file: those of an instant, one where blocks are lines.
  pure function n_row_of_block(model, i_table) result(n)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_table
    integer :: n

    select case (i_table)
    case (table_nodout)
      n = n_history_node(model)
    case (table_matsum)
      n = size(model%parts)
    case (table_sleout)
      n = size(model%contacts)
    case (table_spcforc)
      n = count(mark_supports(model))
    case default
      n = 1
    end select
  end function n_row_of_block

  !> Number of history nodes.
  pure function n_history_node(model) result(n)
    type(model_t), intent(in) :: model
    integer :: n

    n = 0
    if (allocated(model%controls%output%history_nodes)) &
      n = size(model%controls%output%history_nodes)
  end function n_history_node

  !> The first failure that any table has had so far.
  pure subroutine check_histories(histories, error)
    type(histories_t), intent(in) :: histories
    type(error_t), allocatable, intent(out) :: error
    integer :: i_table

    do i_table = 1, n_table
      call check_table(histories%tables(i_table), error)
      if (allocated(error)) return
    end do
  end subroutine check_histories

  !> Bring all rows into the files; reports the first failure of any table.
  subroutine flush_histories(histories, error)
    type(histories_t), intent(inout) :: histories
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: trouble
    integer :: i_table

    do i_table = 1, n_table
      call flush_table(histories%tables(i_table), trouble)
      if (allocated(trouble) .and. .not. allocated(error)) call move_alloc(trouble, error)
    end do
  end subroutine flush_histories

  !> Bring all rows into the files and close them; the values stay for the results file.
  subroutine close_histories(histories, error)
    type(histories_t), intent(inout) :: histories
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: trouble
    integer :: i_table

    do i_table = 1, n_table
      call close_table(histories%tables(i_table), trouble)
      if (allocated(trouble) .and. .not. allocated(error)) call move_alloc(trouble, error)
    end do
  end subroutine close_histories

end module history_file_m
