! SPDX-License-Identifier: MIT
!> Schedules and histories in a restart file. Histories are kept whole: the run that goes on writes
!> its tables again from the first row, so that they do not depend on what has become of the files.
module restart_history_m
  use archive_m, only : keep, keep_growing, expect
  use archive_file_m, only : archive_t, enter, leave
  use csv_table_m, only : csv_table_t, add_row
  use history_file_m, only : histories_t
  use history_tables_m, only : n_table
  use kinds_m, only : wp, long
  use log_m, only : to_text
  use output_schedule_m, only : schedule_t, mark_written
  use results_file_m, only : results_file_t
  implicit none
  private
  public :: keep_schedule, keep_histories, keep_times

  !> Bound on the outputs of one kind: intervals are no shorter than 1e-9 of a run.
  integer(long), parameter :: most_outputs = 2_long**53

contains

  !> Write or read how far an output is. Where the run goes on with another interval, the first
  !> output comes at the next multiple of the new one.
  subroutine keep_schedule(archive, name, time, dt, schedule)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    real(wp), intent(in) :: time, dt                !! of the state before, as given to `is_due`
                                                    !! then
    type(schedule_t), intent(inout) :: schedule     !! planned from the deck
    type(schedule_t) :: kept

    kept = schedule
    call enter(archive, name)
    call keep(archive, 'active', kept%active)
    call keep(archive, 'interval', kept%interval)
    call keep(archive, 'varies', kept%varies)
    call keep_growing(archive, 'curve_abscissa', kept%curve%abscissa)
    call keep_growing(archive, 'curve_ordinate', kept%curve%ordinate)
    call keep(archive, 'count', kept%count)
    call keep(archive, 'next', kept%next)
    call expect(archive, 'count', kept%count >= 0 .and. kept%count <= most_outputs, &
      'a count that no run can reach')
    call expect(archive, 'next', kept%next >= 0.0_wp, 'a time below zero')
    call leave(archive)
    if (.not. archive%is_read .or. allocated(archive%error)) return
    if (is_same_plan(kept, schedule)) then
      schedule%active = kept%active
      schedule%count = kept%count
      schedule%next = kept%next
    else
      call mark_written(schedule, time, dt)
    end if
  end subroutine keep_schedule

  !> Whether two schedules have the same output times. One of a curve may have come to its end.
  pure function is_same_plan(kept, schedule) result(same)
    type(schedule_t), intent(in) :: kept, schedule
    logical :: same

    same = kept%varies .eqv. schedule%varies
    if (.not. same) return
    if (.not. schedule%varies) then
      same = (kept%active .eqv. schedule%active) &
        .and. .not. abs(kept%interval - schedule%interval) > 0.0_wp
    else
      same = allocated(kept%curve%ordinate) .and. allocated(kept%curve%abscissa)
      if (same) same = size(kept%curve%ordinate) == size(schedule%curve%ordinate) &
        .and. size(kept%curve%abscissa) == size(schedule%curve%abscissa)
      if (same) same = all(.not. abs(kept%curve%ordinate - schedule%curve%ordinate) > 0.0_wp) &
        .and. all(.not. abs(kept%curve%abscissa - schedule%curve%abscissa) > 0.0_wp)
    end if
  end function is_same_plan

  !> Write or read the rows of all tables.
  subroutine keep_histories(archive, name, histories)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(histories_t), intent(inout) :: histories
    integer :: i

    call enter(archive, name)
    do i = 1, n_table
      call keep_table(archive, to_text(i), histories%tables(i))
    end do
    call leave(archive)
  end subroutine keep_histories

  !> One table. Rows of a table that the run no longer writes are left out.
  subroutine keep_table(archive, name, table)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(csv_table_t), intent(inout) :: table
    real(wp), allocatable :: rows(:, :)
    integer :: i

    if (allocated(table%values)) then
      allocate (rows(size(table%values, 1), table%n_row))
      rows(:, :) = table%values(:, :table%n_row)
    end if
    call keep_growing(archive, name, rows)
    if (.not. archive%is_read .or. allocated(archive%error)) return
    if (.not. allocated(rows) .or. .not. table%is_open) return
    do i = 1, size(rows, 2)
      call add_row(table, rows(:, i))
    end do
  end subroutine keep_table

  !> Write or read the times of the states in the results file.
  subroutine keep_times(archive, name, results, times)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(results_file_t), intent(in) :: results       !! whose times are written
    real(wp), allocatable, intent(out) :: times(:)    !! that were read, or written

    if (allocated(results%times)) then
      times = results%times(:results%n_state)
    else
      allocate (times(0))
    end if
    call keep_growing(archive, name, times)
    if (.not. allocated(times)) allocate (times(0))
  end subroutine keep_times

end module restart_history_m
