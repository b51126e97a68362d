! SPDX-License-Identifier: MIT
!> Rows of the histories from a snapshot. Rows for a table that is not open are ignored, so that a
!> driver may hand every snapshot to every table that is due.
module history_rows_m
  use csv_table_m, only : add_row
  use energies_m, only : total_energy, energy_ratio
  use history_file_m, only : histories_t, table_glstat, table_rcforc, table_nodout, table_contact, &
    table_matsum, table_rwforc, table_sleout, table_spcforc
  use kinds_m, only : wp
  use model_m, only : model_t
  use snapshot_m, only : snapshot_t
  implicit none
  private
  public :: append_glstat, append_rcforc, append_nodout, append_matsum, append_contact, &
    append_rwforc, append_sleout, append_spcforc

contains

  !> The energy account: one row.
  subroutine append_glstat(histories, snapshot)
    type(histories_t), intent(inout) :: histories
    type(snapshot_t), intent(in) :: snapshot

    associate (e => snapshot%energies)
      call add_row(histories%tables(table_glstat), [snapshot%time, real(snapshot%cycle, wp), &
        snapshot%dt, e%kinetic, e%internal, e%hourglass, e%viscous, e%damping, e%contact, &
        e%external_work, total_energy(e), energy_ratio(e), e%leapfrog, snapshot%mean_velocity, &
        real(snapshot%slowest, wp)])
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
    do i = 1, size(model%controls%output%history_nodes)
      i_node = model%controls%output%history_nodes(i)
      call add_row(histories%tables(table_nodout), [snapshot%time, &
        real(model%mesh%node_id(i_node), wp), &
        model%mesh%coordinates(:, i_node) + snapshot%displacement(:, i_node), &
        snapshot%displacement(:, i_node), snapshot%velocity(:, i_node), &
        snapshot%acceleration(:, i_node), real(snapshot%cycle, wp)])
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

  !> Energies of interfaces.
  subroutine append_sleout(histories, model, snapshot)
    type(histories_t), intent(inout) :: histories
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    integer :: i

    if (.not. histories%tables(table_sleout)%is_open) return
    do i = 1, size(model%contacts)
      call add_row(histories%tables(table_sleout), [snapshot%time, real(snapshot%cycle, wp), &
        real(model%contacts(i)%id, wp), snapshot%interfaces(i)%energy, &
        snapshot%interfaces(i)%damping, snapshot%interfaces(i)%stored])
    end do
  end subroutine append_sleout

  !> Forces of the constraints on fixed nodes.
  subroutine append_spcforc(histories, model, snapshot)
    type(histories_t), intent(inout) :: histories
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    integer :: i

    if (.not. histories%tables(table_spcforc)%is_open) return
    do i = 1, size(snapshot%supports)
      call add_row(histories%tables(table_spcforc), [snapshot%time, &
        real(model%mesh%node_id(snapshot%supports(i)), wp), snapshot%reaction(:, i)])
    end do
  end subroutine append_spcforc

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

end module history_rows_m
