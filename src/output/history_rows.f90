! SPDX-License-Identifier: MIT
!> Columns and rows of the history files: a column is one line here, with its name and its value.
!> Rows for a table that is not open are ignored, so that a driver may hand every snapshot to every
!> table that is due.
module history_rows_m
  use contacts_m, only : n_told
  use csv_table_m, only : csv_table_t, add_row
  use energies_m, only : total_energy, energy_ratio
  use history_tables_m, only : table_glstat, table_rcforc, table_nodout, table_contact, &
    table_matsum, table_rwforc, table_sleout, table_spcforc
  use kinds_m, only : wp
  use model_m, only : model_t
  use snapshot_m, only : snapshot_t, interface_result_t, part_result_t, slave_result_t, &
    wall_result_t, rubbed_t
  use table_row_m, only : row_t, put, put_side, end_csv
  implicit none
  private
  public :: name_columns, append_rows

  !> Sides of an interface.
  integer, parameter :: side_slave = 1, side_master = 2

contains

  !> Names and kinds of the columns of a table, by a row of nothing.
  subroutine name_columns(i_table, tells_mass, erodes, row)
    integer, intent(in) :: i_table    !! one of `table_`
    logical, intent(in) :: tells_mass !! masses are scaled
    logical, intent(in) :: erodes     !! elements may leave the mesh
    type(row_t), intent(out) :: row
    type(snapshot_t) :: nothing
    type(interface_result_t) :: result
    type(slave_result_t) :: slave
    type(part_result_t) :: sums
    type(wall_result_t) :: wall
    real(wp), parameter :: nowhere(2) = 0.0_wp

    row%is_named = .true.
    nothing%energies%tells_mass = tells_mass
    select case (i_table)
    case (table_glstat)
      call put_glstat(row, nothing, erodes)
    case (table_rcforc)
      call put_rcforc(row, nothing%time, 0, side_slave, result)
    case (table_nodout)
      call put_nodout(row, nothing, 0, nowhere, 0)
    case (table_contact)
      call put_contact(row, nothing%time, [0, 0], nowhere, slave, 0)
    case (table_matsum)
      call put_matsum(row, nothing%time, 0, sums)
    case (table_rwforc)
      call put_rwforc(row, nothing%time, 0, wall)
    case (table_sleout)
      call put_sleout(row, nothing, 0, result)
    case (table_spcforc)
      call put_spcforc(row, nothing, 0, 0)
    end select
  end subroutine name_columns

  !> Append the rows of an instant to a table.
  subroutine append_rows(table, i_table, model, snapshot)
    type(csv_table_t), intent(inout) :: table
    integer, intent(in) :: i_table   !! which it is, one of `table_`
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    type(row_t) :: row
    integer :: i, i_node

    if (.not. table%is_open) return
    select case (i_table)
    case (table_glstat)
      call put_glstat(row, snapshot, model%erodes)
      call take(table, row)
    case (table_nodout)
      do i = 1, size(model%controls%output%history_nodes)
        i_node = model%controls%output%history_nodes(i)
        call put_nodout(row, snapshot, model%mesh%node_id(i_node), &
          model%mesh%coordinates(:, i_node), i_node)
        call take(table, row)
      end do
    case (table_matsum)
      do i = 1, size(model%parts)
        call put_matsum(row, snapshot%time, model%parts(i)%id, snapshot%parts(i))
        call take(table, row)
      end do
    case (table_rwforc)
      do i = 1, size(snapshot%walls)
        call put_rwforc(row, snapshot%time, model%walls(i)%id, snapshot%walls(i))
        call take(table, row)
      end do
    case (table_spcforc)
      do i = 1, size(snapshot%supports)
        call put_spcforc(row, snapshot, model%mesh%node_id(snapshot%supports(i)), i)
        call take(table, row)
      end do
    case default
      call append_interfaces(table, i_table, model, snapshot)
    end select
  end subroutine append_rows

  !> Append the rows of all interfaces to a table.
  subroutine append_interfaces(table, i_table, model, snapshot)
    type(csv_table_t), intent(inout) :: table
    integer, intent(in) :: i_table
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    type(row_t) :: row
    integer :: i, k, i_node

    do i = 1, n_told(model%contacts)
      associate (id => model%contacts(i)%id, result => snapshot%interfaces(i), &
        slave => snapshot%slaves(i))
        select case (i_table)
        case (table_rcforc)
          call put_rcforc(row, snapshot%time, id, side_slave, result)
          call take(table, row)
          call put_rcforc(row, snapshot%time, id, side_master, result)
          call take(table, row)
        case (table_sleout)
          call put_sleout(row, snapshot, id, result)
          call take(table, row)
        case (table_contact)
          do k = 1, size(slave%node)
            i_node = slave%node(k)
            call put_contact(row, snapshot%time, [id, model%mesh%node_id(i_node)], &
              model%mesh%coordinates(:, i_node) + snapshot%displacement(:, i_node), slave, k)
            call take(table, row)
          end do
        end select
      end associate
    end do
    if (i_table /= table_rcforc .or. .not. allocated(model%transducers)) return
    do i = 1, size(model%transducers)
      call put_rcforc(row, snapshot%time, model%transducers(i)%id, side_slave, &
        snapshot%transducers(i))
      call take(table, row)
    end do
  end subroutine append_interfaces

  !> Hand a row to its table and begin the next.
  subroutine take(table, row)
    type(csv_table_t), intent(inout) :: table
    type(row_t), intent(inout) :: row

    call add_row(table, row%values(:row%n))
    row%n = 0
  end subroutine take

  ! ---- the columns of each table -----------------------------------------------------------------

  !> The energy account.
  pure subroutine put_glstat(row, shot, erodes)
    type(row_t), intent(inout) :: row
    type(snapshot_t), intent(in) :: shot
    logical, intent(in) :: erodes

    associate (e => shot%energies)
      call put(row, 'time', shot%time)
      call put(row, 'cycle', shot%cycle)
      call put(row, 'dt', shot%dt)
      call put(row, 'kinetic', e%kinetic)
      call put(row, 'internal', e%internal)
      call put(row, 'hourglass', e%hourglass)
      call put(row, 'viscous', e%viscous)
      call put(row, 'damping', e%damping)
      call put(row, 'contact', e%contact)
      call put(row, 'external_work', e%external_work)
      call put(row, 'total', total_energy(e))
      call put(row, 'energy_ratio', energy_ratio(e))
      call put(row, 'leapfrog', e%leapfrog)
      call put(row, 'friction', e%friction)
      if (e%tells_mass) call put_added_mass(row, e%added_mass)
      if (erodes) call put(row, 'eroded', sum(e%eroded))
      call end_csv(row)
      if (erodes) call put(row, 'eroded_kinetic,eroded_internal,eroded_hourglass,eroded_contact', &
        e%eroded)
      call put(row, 'velocity_x,velocity_y', shot%mean_velocity)
      call put(row, 'element', shot%slowest(1))
      call put(row, 'element_part', shot%slowest(2))
    end associate
  end subroutine put_glstat

  !> The column that runs with scaled masses have besides.
  pure subroutine put_added_mass(row, mass)
    type(row_t), intent(inout) :: row
    real(wp), intent(in) :: mass

    call put(row, 'added_mass', mass)
  end subroutine put_added_mass

  !> Resultant of one side of an interface.
  pure subroutine put_rcforc(row, time, id, side, result)
    type(row_t), intent(inout) :: row
    real(wp), intent(in) :: time
    integer, intent(in) :: id, side
    type(interface_result_t), intent(in) :: result

    call put(row, 'time', time)
    call put(row, 'interface', id)
    call put_side(row, 'side', side)
    call put(row, 'fx,fy', merge(result%slave_force, result%master_force, side == side_slave))
    call put(row, 'n_active', result%n_active)
  end subroutine put_rcforc

  !> Motion of a history node.
  pure subroutine put_nodout(row, shot, id, first_place, i)
    type(row_t), intent(inout) :: row
    type(snapshot_t), intent(in) :: shot
    integer, intent(in) :: id
    real(wp), intent(in) :: first_place(2)
    integer, intent(in) :: i              !! index of the node

    call put(row, 'time', shot%time)
    call put(row, 'node', id)
    call put(row, 'x,y', first_place + vector_of(shot%displacement, i))
    call put(row, 'ux,uy', vector_of(shot%displacement, i))
    call put(row, 'vx,vy', vector_of(shot%velocity, i))
    call put(row, 'ax,ay', vector_of(shot%acceleration, i))
    call end_csv(row)
    call put(row, 'cycle', shot%cycle)
  end subroutine put_nodout

  !> A slave node.
  pure subroutine put_contact(row, time, ids, place, slave, i)
    type(row_t), intent(inout) :: row
    real(wp), intent(in) :: time
    integer, intent(in) :: ids(2)         !! of interface and node
    real(wp), intent(in) :: place(2)      !! of the node, now
    type(slave_result_t), intent(in) :: slave
    integer, intent(in) :: i              !! its index there
    type(rubbed_t) :: rubbed

    call put(row, 'time', time)
    call put(row, 'interface', ids(1))
    call put(row, 'node', ids(2))
    call put(row, 's', value_of(slave%arc_length, i))
    call put(row, 'x,y', place)
    call put(row, 'gap', value_of(slave%gap, i))
    call put(row, 'pressure', value_of(slave%pressure, i))
    call put(row, 'fx,fy', vector_of(slave%force, i))
    call put(row, 'length', value_of(slave%length, i))
    rubbed = rubbed_t()
    if (allocated(slave%rubbed)) rubbed = slave%rubbed(i)
    call put(row, 'traction', rubbed%traction)
    call put(row, 'slip', rubbed%slip)
    call put(row, 'state', rubbed%state)
    call put(row, 'row_stress', value_of(slave%row_stress, i))
  end subroutine put_contact

  !> Sums over a part.
  pure subroutine put_matsum(row, time, id, sums)
    type(row_t), intent(inout) :: row
    real(wp), intent(in) :: time
    integer, intent(in) :: id
    type(part_result_t), intent(in) :: sums

    call put(row, 'time', time)
    call put(row, 'part', id)
    call put(row, 'kinetic', sums%kinetic)
    call put(row, 'internal', sums%internal)
    call put(row, 'hourglass', sums%hourglass)
    call put(row, 'momentum_x,momentum_y', sums%momentum)
    call put(row, 'mass', sums%mass)
  end subroutine put_matsum

  !> Resultant of a rigid wall.
  pure subroutine put_rwforc(row, time, id, wall)
    type(row_t), intent(inout) :: row
    real(wp), intent(in) :: time
    integer, intent(in) :: id
    type(wall_result_t), intent(in) :: wall

    call put(row, 'time', time)
    call put(row, 'wall', id)
    call put(row, 'fx,fy', wall%force)
    call put(row, 'normal_force', wall%normal_force)
    call put(row, 'impulse', wall%impulse)
    call put(row, 'work', wall%work)
    call put(row, 'n_active', wall%n_active)
    call put(row, 'tangential_force', wall%tangential_force)
    call put(row, 'friction', wall%dissipated)
  end subroutine put_rwforc

  !> Energies of an interface.
  pure subroutine put_sleout(row, shot, id, result)
    type(row_t), intent(inout) :: row
    type(snapshot_t), intent(in) :: shot
    integer, intent(in) :: id
    type(interface_result_t), intent(in) :: result

    call put(row, 'time', shot%time)
    call put(row, 'cycle', shot%cycle)
    call put(row, 'interface', id)
    call put(row, 'energy', result%energy)
    call put(row, 'damping', result%damping)
    call put(row, 'stored', result%stored)
    call put(row, 'friction', result%friction)
    call put(row, 'estimate', result%estimate)
    call put(row, 'row_energy', result%row_energy)
    call put(row, 'step_limit', result%step_limit)
  end subroutine put_sleout

  !> Force of the constraint on a fixed node.
  pure subroutine put_spcforc(row, shot, id, i)
    type(row_t), intent(inout) :: row
    type(snapshot_t), intent(in) :: shot
    integer, intent(in) :: id
    integer, intent(in) :: i              !! index of the support

    call put(row, 'time', shot%time)
    call put(row, 'node', id)
    call put(row, 'fx,fy', vector_of(shot%reaction, i))
  end subroutine put_spcforc

  !> One value; 0 of an array that is not there, in the row of nothing.
  pure function value_of(values, i) result(value)
    real(wp), allocatable, intent(in) :: values(:)
    integer, intent(in) :: i
    real(wp) :: value

    value = 0.0_wp
    if (allocated(values)) value = values(i)
  end function value_of

  !> One vector; 0 of an array that is not there, in the row of nothing.
  pure function vector_of(values, i) result(value)
    real(wp), allocatable, intent(in) :: values(:, :)
    integer, intent(in) :: i
    real(wp) :: value(2)

    value = 0.0_wp
    if (allocated(values)) value = values(:, i)
  end function vector_of

end module history_rows_m
