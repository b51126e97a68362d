! SPDX-License-Identifier: MIT
!> Columns and rows of the history files: a column is one line here, with its name and its value.
!> Rows for a table that is not open are ignored, so that a driver may hand every snapshot to every
!> table that is due.
module history_rows_m
  use controls_m, only : boundary_body_load, boundary_body_motion
  use contacts_m, only : n_told
  use csv_table_m, only : csv_table_t, add_row
  use energies_m, only : total_energy, energy_ratio
  use history_force_rows_m, only : put_bndout, put_nodfor, put_secforc
  use history_tables_m, only : table_glstat, table_rcforc, table_nodout, table_contact, &
    table_matsum, table_rwforc, table_sleout, table_spcforc, table_elout, table_rbdout, &
    table_bndout, table_nodfor, table_secforc
  use kinds_m, only : wp
  use model_m, only : model_t
  use snapshot_m, only : snapshot_t, interface_result_t, part_result_t, slave_result_t, &
    wall_result_t, rubbed_t, element_result_t, body_result_t, section_result_t
  use table_row_m, only : row_t, put, put_side, end_csv, value_of, vector_of
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
    type(element_result_t) :: element
    type(body_result_t) :: body
    type(section_result_t) :: section
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
      call put_matsum(row, nothing%time, 0, sums, tells_mass)
    case (table_rwforc)
      call put_rwforc(row, nothing%time, 0, wall)
    case (table_sleout)
      call put_sleout(row, nothing, 0, result)
    case (table_spcforc)
      call put_spcforc(row, nothing, 0, 0)
    case (table_elout)
      call put_elout(row, nothing, 0, element)
    case (table_rbdout)
      call put_rbdout(row, nothing, 0, body)
    case (table_bndout)
      call put_bndout(row, nothing, 0, 0, 0)
    case (table_nodfor)
      call put_nodfor(row, nothing, 0, 0, 0)
    case (table_secforc)
      call put_secforc(row, nothing%time, 0, section)
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
        call put_matsum(row, snapshot%time, model%parts(i)%id, snapshot%parts(i), &
          snapshot%energies%tells_mass)
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
    case (table_elout)
      do i = 1, size(snapshot%history_elements)
        call put_elout(row, snapshot, &
          model%mesh%element_id(model%controls%output%history_elements(i)), &
          snapshot%history_elements(i))
        call take(table, row)
      end do
    case (table_rbdout)
      do i = 1, size(snapshot%bodies)
        call put_rbdout(row, snapshot, model%parts(model%rigids(i)%part)%id, snapshot%bodies(i))
        call take(table, row)
      end do
    case (table_bndout)
      call append_boundaries(table, model, snapshot)
    case (table_nodfor)
      call append_groups(table, model, snapshot)
    case (table_secforc)
      do i = 1, size(snapshot%sections)
        call put_secforc(row, snapshot%time, model%controls%output%cross_sections(i)%id, &
          snapshot%sections(i))
        call take(table, row)
      end do
    case default
      call append_interfaces(table, i_table, model, snapshot)
    end select
  end subroutine append_rows

  !> Append the rows of all boundaries.
  subroutine append_boundaries(table, model, snapshot)
    type(csv_table_t), intent(inout) :: table
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    type(row_t) :: row
    integer :: i, id

    associate (rows => model%controls%output%boundaries)
      do i = 1, size(rows%where)
        select case (rows%condition(i))
        case (boundary_body_load, boundary_body_motion)
          id = model%parts(model%rigids(rows%where(i))%part)%id
        case default
          id = model%mesh%node_id(rows%where(i))
        end select
        call put_bndout(row, snapshot, rows%condition(i), id, i)
        call take(table, row)
      end do
    end associate
  end subroutine append_boundaries

  !> Append the rows of the nodes of all force groups.
  subroutine append_groups(table, model, snapshot)
    type(csv_table_t), intent(inout) :: table
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    type(row_t) :: row
    integer :: i, k, n

    n = 0
    do i = 1, size(model%controls%output%force_groups)
      associate (group => model%controls%output%force_groups(i))
        do k = 1, size(group%nodes)
          n = n + 1
          call put_nodfor(row, snapshot, group%id, model%mesh%node_id(group%nodes(k)), n)
          call take(table, row)
        end do
      end associate
    end do
  end subroutine append_groups

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
      if (e%tells_mass) then
        call put(row, 'mass_increase', e%mass_increase)
        call put(row, 'by_dt2ms', shot%by_dt2ms)
      end if
      if (erodes) call put(row, 'eroded_kinetic,eroded_internal,eroded_hourglass,eroded_contact', &
        e%eroded)
      call end_csv(row)
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
  pure subroutine put_matsum(row, time, id, sums, tells_mass)
    type(row_t), intent(inout) :: row
    real(wp), intent(in) :: time
    integer, intent(in) :: id
    type(part_result_t), intent(in) :: sums
    logical, intent(in) :: tells_mass      !! masses are scaled

    call put(row, 'time', time)
    call put(row, 'part', id)
    call put(row, 'kinetic', sums%kinetic)
    call put(row, 'internal', sums%internal)
    call put(row, 'hourglass', sums%hourglass)
    call put(row, 'momentum_x,momentum_y', sums%momentum)
    call put(row, 'mass', sums%mass)
    if (tells_mass) call put(row, 'added_mass', sums%added_mass)
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

  !> Stress and plastic strain of an element.
  pure subroutine put_elout(row, shot, id, element)
    type(row_t), intent(inout) :: row
    type(snapshot_t), intent(in) :: shot
    integer, intent(in) :: id
    type(element_result_t), intent(in) :: element

    call put(row, 'time', shot%time)
    call put(row, 'element', id)
    call put(row, 'sxx,syy,szz,sxy', element%stress)
    call put(row, 'plastic_strain', element%plastic_strain)
    call end_csv(row)
    call put(row, 'cycle', shot%cycle)
    call put(row, 'part', element%part)
    call put(row, 'is_gone', merge(1, 0, element%is_gone))
  end subroutine put_elout

  !> Motion of a rigid body.
  pure subroutine put_rbdout(row, shot, part, body)
    type(row_t), intent(inout) :: row
    type(snapshot_t), intent(in) :: shot
    integer, intent(in) :: part           !! user id
    type(body_result_t), intent(in) :: body

    call put(row, 'time', shot%time)
    call put(row, 'part', part)
    call put(row, 'x,y', body%place)
    call put(row, 'ux,uy,rotation', body%displacement)
    call put(row, 'vx,vy,spin', body%velocity)
    call put(row, 'ax,ay,spin_rate', body%acceleration)
    call end_csv(row)
    call put(row, 'cycle', shot%cycle)
  end subroutine put_rbdout

end module history_rows_m
