! SPDX-License-Identifier: MIT
!> Rows of the history files: values in the order of the columns of `history_tables`. Rows of a
!> table that is not open are ignored, so that a driver may pass every snapshot to every due table.
module history_rows_m
  use controls_m, only : boundary_body_load, boundary_body_motion
  use snapshot_m, only : total_energy, energy_ratio, snapshot_t, friction_result_t
  use history_file_m, only : history_t, add_row, n_each
  use history_tables_m, only : table_glstat, table_rcforc, table_nodout, table_contact, &
    table_matsum, table_rwforc, table_sleout, table_spcforc, table_elout, table_rbdout, &
    table_bndout, table_nodfor, table_secforc
  use kinds_m, only : wp
  use model_m, only : model_t
  implicit none
  private
  public :: append_rows

  !> Sides of an interface.
  real(wp), parameter :: side_slave = 1.0_wp, side_master = 2.0_wp

contains

  !> Append the rows of an instant to a table.
  subroutine append_rows(table, i_table, model, shot)
    type(history_t), intent(inout) :: table
    integer, intent(in) :: i_table   !! one of `table_`
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: shot
    integer :: i, k, n

    if (.not. table%file%is_open) return
    select case (i_table)
    case (table_rcforc)
      do i = 1, size(model%contacts)
        associate (id => model%contacts(i)%id, one => shot%interfaces(i))
          call add_side(id, side_slave, one%slave_force, one%n_active)
          call add_side(id, side_master, one%master_force, one%n_active)
        end associate
      end do
      if (.not. allocated(model%transducers)) return
      do i = 1, size(model%transducers)
        call add_side(model%transducers(i)%id, side_slave, shot%transducers(i)%slave_force, &
          shot%transducers(i)%n_active)
      end do
    case (table_contact)
      call append_slaves(table, model, shot)
    case (table_nodfor)
      n = 0
      do i = 1, size(model%controls%output%force_groups)
        associate (group => model%controls%output%force_groups(i))
          do k = 1, size(group%nodes)
            n = n + 1
            call add_row(table, [shot%time, real([group%id, model%mesh%node_id(group%nodes(k))], &
              wp), shot%group_force(:, n), shot%group_work(n)])
          end do
        end associate
      end do
    case default
      do i = 1, n_each(model, i_table)
        call add_row(table, [shot%time, row_of(i_table, i, model, shot)])
      end do
    end select

  contains

    !> Add the resultant of one side.
    subroutine add_side(id, side, force, n_active)
      integer, intent(in) :: id, n_active
      real(wp), intent(in) :: side, force(2)

      call add_row(table, [shot%time, real(id, wp), side, force, real(n_active, wp)])
    end subroutine add_side

  end subroutine append_rows

  !> One row, without its time, of a table with one row per entity.
  pure function row_of(i_table, i, model, shot) result(row)
    integer, intent(in) :: i_table
    integer, intent(in) :: i         !! the entity
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: shot
    real(wp), allocatable :: row(:)
    integer :: id, node

    associate (plan => model%controls%output, cycle => real(shot%cycle, wp), e => shot%energies)
      select case (i_table)
      case (table_glstat)
        row = [cycle, shot%dt, e%kinetic, e%internal, e%hourglass, e%viscous, e%damping, &
          e%contact, e%external_work, total_energy(e), energy_ratio(e), e%leapfrog, e%friction, &
          e%added_mass, sum(e%eroded), e%mass_increase, real(shot%by_dt2ms, wp), e%eroded, &
          shot%mean_velocity, real(shot%slowest, wp)]
      case (table_matsum)
        associate (part => shot%parts(i))
          row = [real(model%parts(i)%id, wp), part%kinetic, part%internal, part%hourglass, &
            part%momentum, part%mass, part%added_mass]
        end associate
      case (table_rbdout)
        associate (body => shot%bodies(i))
          row = [real(model%parts(model%rigids(i)%part)%id, wp), body%position, body%displacement, &
            body%velocity, body%acceleration, cycle]
        end associate
      case (table_elout)
        associate (element => shot%history_elements(i))
          row = [real(model%mesh%element_id(plan%history_elements(i)), wp), element%stress, &
            element%plastic_strain, cycle, real(element%part, wp), &
            merge(1.0_wp, 0.0_wp, element%is_eroded)]
        end associate
      case (table_nodout)
        node = plan%history_nodes(i)
        row = [real(model%mesh%node_id(node), wp), model%mesh%coordinates(:, node) &
          + shot%displacement(:, node), shot%displacement(:, node), shot%velocity(:, node), &
          shot%acceleration(:, node), cycle]
      case (table_sleout)
        associate (one => shot%interfaces(i))
          row = [cycle, real(model%contacts(i)%id, wp), one%energy, one%damping, one%stored, &
            one%friction, one%estimate, one%row_energy, one%step_limit]
        end associate
      case (table_rwforc)
        associate (wall => shot%walls(i))
          row = [real(model%walls(i)%id, wp), wall%force, wall%normal_force, wall%impulse, &
            wall%work, real(wall%n_active, wp), wall%tangential_force, wall%dissipated, &
            wall%displacement]
        end associate
      case (table_spcforc)
        row = [real(model%mesh%node_id(shot%supports(i)), wp), shot%reaction(:, i)]
      case (table_secforc)
        associate (section => shot%sections(i))
          row = [real(plan%cross_sections(i)%id, wp), section%force, section%moment, &
            section%centroid, section%area]
        end associate
      case (table_bndout)
        associate (rows => plan%boundaries)
          if (any(rows%condition(i) == [boundary_body_load, boundary_body_motion])) then
            id = model%parts(model%rigids(rows%where(i))%part)%id
          else
            id = model%mesh%node_id(rows%where(i))
          end if
          row = [real([rows%condition(i), id], wp), shot%boundary_force(:, i), &
            shot%boundary_work(i)]
        end associate
      end select
    end associate
  end function row_of

  !> Append the rows of slave nodes.
  subroutine append_slaves(table, model, shot)
    type(history_t), intent(inout) :: table
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: shot
    type(friction_result_t) :: friction_result
    real(wp) :: row_stress
    integer :: i, k

    do i = 1, size(model%contacts)
      associate (slave => shot%slaves(i))
        do k = 1, size(slave%node)
          friction_result = friction_result_t()
          if (allocated(slave%friction_result)) friction_result = slave%friction_result(k)
          row_stress = 0.0_wp
          if (allocated(slave%row_stress)) row_stress = slave%row_stress(k)
          associate (node => slave%node(k))
            call add_row(table, [shot%time, &
              real([model%contacts(i)%id, model%mesh%node_id(node)], wp), slave%arc_length(k), &
              model%mesh%coordinates(:, node) + shot%displacement(:, node), slave%gap(k), &
              slave%pressure(k), slave%force(:, k), slave%length(k), friction_result%traction, &
              friction_result%slip, real(friction_result%state, wp), row_stress, &
              slave%offset(k)])
          end associate
        end do
      end associate
    end do
  end subroutine append_slaves

end module history_rows_m
