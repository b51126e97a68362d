! SPDX-License-Identifier: MIT
!> The histories: one CSV table per quantity. A table whose output was not asked for is not made,
!> and rows for it are ignored, so that a driver may hand every snapshot to every table that is due.
module history_file_m
  use kinds_m, only : wp
  use errors_m, only : error_t
  use model_m, only : model_t
  use controls_m, only : interval_t
  use energies_m, only : total_energy, energy_ratio
  use snapshot_m, only : snapshot_t
  use csv_table_m, only : csv_table_t, open_table, add_row, flush_table, close_table, &
    kind_real, kind_integer, kind_side
  implicit none
  private
  public :: histories_t, open_histories, append_glstat, append_rcforc, append_nodout, &
    append_matsum, append_contact, append_rwforc, flush_histories, close_histories, n_table, &
    table_glstat, table_rcforc, table_nodout, table_contact, table_matsum, table_rwforc

  integer, parameter :: n_table = 6
  integer, parameter :: table_glstat = 1, table_rcforc = 2, table_nodout = 3, table_contact = 4, &
    table_matsum = 5, table_rwforc = 6

  !> Columns of the tables, as users' scripts know them.
  character(*), parameter :: glstat_columns = 'time,cycle,dt,kinetic,internal,hourglass,'// &
    'viscous,damping,contact,external_work,total,energy_ratio'
  character(*), parameter :: rcforc_columns = 'time,interface,side,fx,fy,n_active'
  character(*), parameter :: nodout_columns = 'time,node,x,y,ux,uy,vx,vy,ax,ay'
  character(*), parameter :: contact_columns = 'time,interface,node,s,x,y,gap,pressure,fx,fy,length'
  character(*), parameter :: matsum_columns = 'time,part,kinetic,internal,hourglass,'// &
    'momentum_x,momentum_y,mass'
  character(*), parameter :: rwforc_columns = 'time,wall,fx,fy,normal_force,impulse,work,n_active'

  !> All tables of a run.
  type :: histories_t
    type(csv_table_t) :: tables(n_table) !! by the `table_` constants
  end type histories_t

contains

  !> Make the files that were asked for. glstat always; the others with an interval and something to
  !> write: interfaces for rcforc and contact, history nodes for nodout, rigid walls for rwforc.
  subroutine open_histories(histories, prefix, model, error)
    type(histories_t), intent(out) :: histories
    character(*), intent(in) :: prefix   !! directory and job name
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    integer, parameter :: r = kind_real, i = kind_integer
    logical :: has_contacts

    has_contacts = .false.
    if (allocated(model%contacts)) has_contacts = size(model%contacts) > 0
    call open_table(histories%tables(table_glstat), prefix, 'glstat', glstat_columns, &
      [r, i, r, r, r, r, r, r, r, r, r, r], error)
    if (allocated(error)) return
    if (is_asked(model%controls%output%rcforc) .and. has_contacts) then
      call open_table(histories%tables(table_rcforc), prefix, 'rcforc', rcforc_columns, &
        [r, i, kind_side, r, r, i], error)
      if (allocated(error)) return
    end if
    if (is_asked(model%controls%output%nodout) .and. n_history_node(model) > 0) then
      call open_table(histories%tables(table_nodout), prefix, 'nodout', nodout_columns, &
        [r, i, r, r, r, r, r, r, r, r], error)
      if (allocated(error)) return
    end if
    if (is_asked(model%controls%output%plot) .and. has_contacts) then
      call open_table(histories%tables(table_contact), prefix, 'contact', contact_columns, &
        [r, i, i, r, r, r, r, r, r, r, r], error)
      if (allocated(error)) return
    end if
    if (is_asked(model%controls%output%matsum)) call open_table(histories%tables(table_matsum), &
      prefix, 'matsum', matsum_columns, [r, i, r, r, r, r, r, r], error)
    if (allocated(error)) return
    if (is_asked(model%controls%output%rwforc) .and. allocated(model%walls)) &
      call open_table(histories%tables(table_rwforc), prefix, 'rwforc', rwforc_columns, &
      [r, i, r, r, r, r, r, i], error)
  end subroutine open_histories

  !> Whether an output has an interval.
  pure function is_asked(interval) result(asked)
    type(interval_t), intent(in) :: interval
    logical :: asked

    asked = interval%dt > 0.0_wp .or. interval%curve > 0
  end function is_asked

  !> Number of history nodes.
  pure function n_history_node(model) result(n)
    type(model_t), intent(in) :: model
    integer :: n

    n = 0
    if (allocated(model%controls%output%history_nodes)) &
      n = size(model%controls%output%history_nodes)
  end function n_history_node

  !> The energy account: one row.
  subroutine append_glstat(histories, snapshot)
    type(histories_t), intent(inout) :: histories
    type(snapshot_t), intent(in) :: snapshot

    associate (e => snapshot%energies)
      call add_row(histories%tables(table_glstat), [snapshot%time, real(snapshot%cycle, wp), &
        snapshot%dt, e%kinetic, e%internal, e%hourglass, e%viscous, e%damping, e%contact, &
        e%external_work, total_energy(e), energy_ratio(e)])
    end associate
  end subroutine append_glstat

  !> Resultants: for each interface a row of the slave side and a row of the master side.
  subroutine append_rcforc(histories, model, snapshot)
    type(histories_t), intent(inout) :: histories
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    real(wp) :: start(2)
    integer :: i_contact

    if (.not. histories%tables(table_rcforc)%is_open) return
    do i_contact = 1, size(model%contacts)
      start = [snapshot%time, real(model%contacts(i_contact)%id, wp)]
      associate (result => snapshot%interfaces(i_contact), table => histories%tables(table_rcforc))
        call add_row(table, [start, 1.0_wp, result%slave_force, real(result%n_active, wp)])
        call add_row(table, [start, 2.0_wp, result%master_force, real(result%n_active, wp)])
      end associate
    end do
  end subroutine append_rcforc

  !> Motion of the history nodes, in the order of the deck's list.
  subroutine append_nodout(histories, model, snapshot)
    type(histories_t), intent(inout) :: histories
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    integer :: i, i_node

    if (.not. histories%tables(table_nodout)%is_open) return
    do i = 1, n_history_node(model)
      i_node = model%controls%output%history_nodes(i)
      call add_row(histories%tables(table_nodout), [snapshot%time, &
        real(model%mesh%node_id(i_node), wp), &
        model%mesh%coordinates(:, i_node) + snapshot%displacement(:, i_node), &
        snapshot%displacement(:, i_node), snapshot%velocity(:, i_node), &
        snapshot%acceleration(:, i_node)])
    end do
  end subroutine append_nodout

  !> Sums over each part.
  subroutine append_matsum(histories, model, snapshot)
    type(histories_t), intent(inout) :: histories
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    integer :: i_part

    if (.not. histories%tables(table_matsum)%is_open) return
    do i_part = 1, size(model%parts)
      associate (sums => snapshot%parts(i_part))
        call add_row(histories%tables(table_matsum), [snapshot%time, &
          real(model%parts(i_part)%id, wp), sums%kinetic, sums%internal, sums%hourglass, &
          sums%momentum, sums%mass])
      end associate
    end do
  end subroutine append_matsum

  !> Slave nodes of every interface, in walking order.
  subroutine append_contact(histories, model, snapshot)
    type(histories_t), intent(inout) :: histories
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    integer :: i_contact, i, i_node

    if (.not. histories%tables(table_contact)%is_open) return
    do i_contact = 1, size(model%contacts)
      associate (slave => snapshot%slaves(i_contact))
        do i = 1, size(slave%node)
          i_node = slave%node(i)
          call add_row(histories%tables(table_contact), [snapshot%time, &
            real(model%contacts(i_contact)%id, wp), real(model%mesh%node_id(i_node), wp), &
            slave%arc_length(i), &
            model%mesh%coordinates(:, i_node) + snapshot%displacement(:, i_node), &
            slave%gap(i), slave%pressure(i), slave%force(:, i), slave%length(i)])
        end do
      end associate
    end do
  end subroutine append_contact

  !> Resultants of the rigid walls.
  subroutine append_rwforc(histories, model, snapshot)
    type(histories_t), intent(inout) :: histories
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    integer :: i

    if (.not. histories%tables(table_rwforc)%is_open) return
    do i = 1, size(snapshot%walls)
      associate (wall => snapshot%walls(i))
        call add_row(histories%tables(table_rwforc), [snapshot%time, real(model%walls(i)%id, wp), &
          wall%force, wall%normal_force, wall%impulse, wall%work, real(wall%n_active, wp)])
      end associate
    end do
  end subroutine append_rwforc

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
