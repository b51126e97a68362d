! SPDX-License-Identifier: MIT
!> Restart files: state, driver memory, progress of the outputs and the deck between two cycles or
!> steps, so that a restarted run gives the same bits as an uninterrupted one.
!>
!> A state that was read is checked: indices lie within their arrays, lists contain each entry once.
!> Shapes and bounds of single components are checked where they are visited. A restart file may
!> come from elsewhere: its checksum shows that it is complete, not that it is valid.
module restart_m
  use archive_m, only : archive_t
  use checksum_m, only : add_bytes, checksum_text
  use clock_m, only : lap, phase_nodes, phase_output
  use contact_state_m, only : contact_state_t, contact_points_t, n_sites
  use search_state_m, only : contact_status_t, separated, active
  use contacts_m, only : contact_t
  use errors_m, only : error_t, status_files
  use files_m, only : file_exists, remove_file, unfinished
  use history_tables_m, only : history_tables, n_table, asked_by_states
  use kinds_m, only : wp, long
  use law_state_m, only : is_open, is_held, is_beside
  use log_m, only : write_log, to_text
  use model_m, only : model_t
  use monitor_m, only : monitor_t, schedule_t, resume_schedule
  use progress_m, only : show_note
  use restart_file_m, only : create_restart, finish_restart
  use restart_plan_m, only : restarts_t, dump_path, running_path, place_text, numbered_file
  use state_m, only : state_t
  use text_files_m, only : read_whole
  use visitor_m, only : visited_t, any_length
  implicit none
  private
  public :: write_restarts, remove_old_files, visit_run, visit_outputs, check_state

  !> Bounds on numbered files and on the length of a job name.
  integer, parameter :: most_dumps = 1000000000, longest_name = 4096

contains

  !> Write restart files: the next numbered one, or the running one in place of its predecessor.
  subroutine write_restarts(wanted, state, monitor, error, driver)
    logical, intent(in) :: wanted(:)   !! numbered_file, running_file
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(out) :: error
    class(visited_t), intent(inout), optional :: driver !! memory of the driver besides the state
    type(archive_t) :: archive
    character(:), allocatable :: effective_deck, path, line
    integer :: kind

    if (.not. any(wanted)) return
    if (present(driver)) call lap(monitor%clock, phase_nodes)
    do kind = 1, size(wanted)
      if (.not. wanted(kind) .or. allocated(error)) cycle
      if (kind == numbered_file) monitor%restarts%n_dump = monitor%restarts%n_dump + 1
      path = running_path(monitor%restarts)
      if (kind == numbered_file) path = dump_path(monitor%restarts, monitor%restarts%n_dump)
      call create_restart(path, archive)
      call read_effective_deck(monitor%restarts, archive, effective_deck)
      call visit_run(archive, monitor%restarts, effective_deck)
      if (allocated(effective_deck)) deallocate (effective_deck)
      call visit_outputs(archive, state%time, state%dt_before, monitor)
      call archive%part('state', state)
      if (present(driver)) call archive%part('driver', driver)
      call finish_restart(archive, error)
      if (allocated(error)) cycle
      line = 'restart file '//path//place_text(state)
      if (kind == numbered_file) call show_note(monitor%progress, monitor%log, line)
      if (kind /= numbered_file) call write_log(monitor%log, line)
    end do
    if (present(driver)) call lap(monitor%clock, phase_output)
  end subroutine write_restarts

  !> Read the deck as run from the file written at the start; a large deck is not held in memory.
  subroutine read_effective_deck(restarts, archive, text)
    type(restarts_t), intent(in) :: restarts
    type(archive_t), intent(inout) :: archive
    character(:), allocatable, intent(out) :: text
    character(:), allocatable :: path, reason
    integer(long) :: checksum
    logical :: is_read

    if (allocated(archive%error)) return
    path = restarts%prefix//'.effective.k'
    call read_whole(path, text, is_read)
    if (is_read) then
      checksum = 0
      call add_bytes(checksum, text)
      if (checksum_text(checksum) /= restarts%effective_deck_checksum) &
        reason = 'the file has been changed'
    else
      reason = 'the file cannot be read'
    end if
    if (allocated(reason)) call archive%fail('cannot write a restart file without ' &
      //'the deck as run, '//path//': '//reason, status_files)
  end subroutine read_effective_deck

  !> Write or read the data of the run: deck, job, program, method.
  subroutine visit_run(archive, restarts, effective_deck)
    type(archive_t), intent(inout) :: archive
    type(restarts_t), intent(inout) :: restarts
    character(:), allocatable, intent(inout) :: effective_deck
    integer :: i

    call archive%enter('run')
    call archive%text('effective_deck', effective_deck)
    call archive%text('job', restarts%job)
    call archive%text('deck', restarts%deck)
    call archive%text('program', restarts%program)
    call archive%visit('n_dump', restarts%n_dump, 0, most_dumps - 1, 'a number that no run reaches')
    call archive%visit('is_implicit', restarts%is_implicit)
    ! It begins the names of files in the folder of the results.
    if (archive%validates) then
      associate (job => restarts%job)
        call archive%expect('job', len(job) > 0 .and. len(job) <= longest_name .and. &
          index(job, '/') == 0 .and. all([(iachar(job(i:i)) >= 32, i=1, len(job))]), &
          'an invalid file name')
      end associate
    end if
    call archive%leave()
  end subroutine visit_run

  !> Write or read the progress of the outputs.
  subroutine visit_outputs(archive, time, dt, monitor)
    type(archive_t), intent(inout) :: archive
    real(wp), intent(in) :: time, dt    !! of the state before, and its output tolerance
    type(monitor_t), intent(inout) :: monitor
    real(wp), allocatable :: times(:)
    integer :: k

    call archive%enter('outputs')
    call visit_kept_schedule('plot', monitor%plot)
    do k = 1, n_table
      if (history_tables(k)%asked /= asked_by_states) &
        call visit_kept_schedule(trim(history_tables(k)%name), monitor%tables(k))
    end do
    call archive%part('histories', monitor%histories)
    if (.not. archive%is_read) then
      allocate (times(0))
      if (allocated(monitor%results%times)) times = monitor%results%times(:monitor%results%n_state)
      call archive%visit('state_times', times, any_length)
    end if
    call archive%leave()

  contains

    !> Write or read one schedule, and resume it.
    subroutine visit_kept_schedule(name, schedule)
      character(*), intent(in) :: name
      type(schedule_t), intent(inout) :: schedule !! planned from the deck
      type(schedule_t) :: stored

      stored = schedule
      call archive%part(name, stored)
      if (archive%validates) call resume_schedule(stored, time, dt, schedule)
    end subroutine visit_kept_schedule

  end subroutine visit_outputs

  !> Remove restart files of an earlier run of this name, the running file and consecutive numbered
  !> ones: unfinished files, and complete ones unless the run is a restart.
  subroutine remove_old_files(restarts, error)
    type(restarts_t), intent(in) :: restarts
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: path
    logical :: found
    integer :: i

    i = 0
    path = running_path(restarts)
    do
      found = file_exists(path)
      if (.not. found) found = file_exists(path//unfinished)
      if (found) call remove_file(path//unfinished, error)
      if (found .and. .not. (restarts%is_restart .or. allocated(error))) call remove_file(path, &
        error)
      if (allocated(error) .or. .not. (found .or. i == 0)) exit
      i = i + 1
      path = dump_path(restarts, i)
    end do
  end subroutine remove_old_files

  !> Check a state that was read; the first fault becomes the error of the archive. A relaxation in
  !> progress must be one of the deck, with a velocity of each node.
  subroutine check_state(model, state, archive)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state      !! of the shapes of the model
    type(archive_t), intent(inout) :: archive
    logical :: fits
    integer :: i

    associate (relaxation => state%relaxation)
      call archive%expect('state/relaxation/n', relaxation%n == 0 .or. (relaxation%n > 0 .and. &
        model%controls%relaxation%is_on), 'a phase that the deck does not ask for')
    fits = allocated(relaxation%velocity) .eqv. relaxation%n > 0
    if (fits .and. relaxation%n > 0) fits = all(shape(relaxation%velocity) == &
      [2, size(state%motion, 2)])
    call archive%expect('state/relaxation/velocity', fits, 'another number of velocities ' &
      //'than there are nodes')
    call archive%expect('state/time', relaxation%n == 0 .or. .not. state%time > 0.0_wp, &
      'a time after that of the relaxation')
    end associate
    do i = 1, size(state%contacts)
    call check_contact(state%interfaces(i), state%contacts(i), &
      'state/contacts/'//to_text(i)//'/', archive)
    end do
  end subroutine check_state

  !> Check the memory of one interface.
  subroutine check_contact(contact, memory, folder, archive)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    character(*), intent(in) :: folder
    type(archive_t), intent(inout) :: archive
    integer :: n_segments(2), n_contact_point

    call check_points(memory, memory%points, folder//'points/', archive)
    if (memory%has%ties) then
    call check_points(memory, memory%tie_points, folder//'tie_points/', archive)
    call check_ties(memory, folder//'ties/', archive)
    end if
    n_segments = [contact%slave%n_segment, contact%master%n_segment]
    n_contact_point = memory%n_slave
    if (allocated(memory%segment_points%xi)) &
      n_contact_point = size(memory%segment_points%xi)*n_segments(1)
    call check_status(memory%slave_status, n_contact_point, n_segments(2), &
    folder//'slave_status/', archive)
    call check_status(memory%master_status, memory%n_master, n_segments(1), &
    folder//'master_status/', archive)
  end subroutine check_contact

  !> Check a list of contact points: equal lengths, and nodes of the interface.
  subroutine check_points(memory, points, folder, archive)
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(in) :: points
    character(*), intent(in) :: folder
    type(archive_t), intent(inout) :: archive
    integer :: n_local
    logical :: fits

    fits = allocated(points%slave_nodes) .and. allocated(points%master_nodes) .and. &
      allocated(points%slave_weights) .and. allocated(points%master_weights) .and. &
      allocated(points%normal) .and. allocated(points%gap) .and. allocated(points%area) .and. &
      allocated(points%stiffness) .and. allocated(points%pressure)
    if (fits) fits = all([size(points%slave_nodes, 2), size(points%master_nodes, 2), &
      size(points%slave_weights, 2), size(points%master_weights, 2), size(points%normal, 2), &
      size(points%area), size(points%stiffness), size(points%pressure)] == size(points%gap))
    if (fits .and. allocated(points%damping)) fits = size(points%damping) == size(points%gap)
    if (fits .and. allocated(points%traction)) fits = size(points%traction) == size(points%gap)
    call archive%expect(folder//'gap', fits, 'not as many values as the arrays beside it')
    if (allocated(archive%error)) return
    call archive%expect(folder//'n', points%n >= 0 .and. points%n <= size(points%gap), &
      'a number beyond the length of the list')
    n_local = memory%n_slave + memory%n_master
    call archive%expect(folder//'slave_nodes', all(points%slave_nodes >= 1 &
      .and. points%slave_nodes <= n_local), 'numbers that no node of the interface has')
    call archive%expect(folder//'master_nodes', all(points%master_nodes >= 1 &
      .and. points%master_nodes <= n_local), 'numbers that no node of the interface has')
  end subroutine check_points

  !> Check tie springs: their points are consecutive, nodes and sites belong to the interface.
  subroutine check_ties(memory, folder, archive)
    type(contact_state_t), intent(in) :: memory
    character(*), intent(in) :: folder
    type(archive_t), intent(inout) :: archive
    integer :: n

    associate (ties => memory%ties)
      n = size(ties%side)
      call archive%expect(folder//'state', all(ties%state == is_open .or. ties%state &
        >= is_held .and. ties%state <= is_beside), 'states that do not exist')
      call archive%expect(folder//'site', all(ties%site >= 1 &
        .and. ties%site <= n_sites(memory)), 'numbers that no site of the interface has')
      call archive%expect(folder//'first', ties%first(1) == 1 &
        .and. all(ties%first(2:) > ties%first(:n)) .and. (ties%first(n + 1) &
        == memory%tie_points%n + 1 .or. memory%tie_points%n == 0), &
        'numbers that do not increase to the number of points')
      call archive%expect(folder//'owner', all(ties%owner >= 1 .and. ties%owner &
        <= memory%n_slave + memory%n_master), 'numbers that no node of the interface has')
    end associate
  end subroutine check_ties

  !> Check the status of contact points against the segments of the other surface.
  subroutine check_status(status, n_contact_point, n_segment, folder, archive)
    type(contact_status_t), intent(in) :: status
    integer, intent(in) :: n_contact_point !! points, where there are any
    integer, intent(in) :: n_segment    !! of the other surface
    character(*), intent(in) :: folder
    type(archive_t), intent(inout) :: archive
    logical, allocatable :: is_listed(:)
    integer :: n

    n = status%n
    if (.not. allocated(status%state)) then
      call archive%expect(folder//'n', n == 0, 'another number of contact points than there are')
      call archive%expect(folder//'n_active', status%n_active == 0, &
        'contact points that do not exist')
      return
    end if
    call archive%expect(folder//'n', n == n_contact_point, &
      'another number of contact points than there are')
    call archive%expect(folder//'segment', all(status%segment >= 0 &
      .and. status%segment <= n_segment), 'numbers that no segment has')
    call archive%expect(folder//'state', all(status%state == separated &
      .or. status%segment > 0), 'active points without a segment')
    call archive%expect(folder//'n_active', count(status%state == active) &
      == status%n_active, 'another number than there are active points')
    if (allocated(archive%error)) return
    allocate (is_listed(0:n), source=.false.)
    is_listed(status%active_points(:status%n_active)) = .true.
    call archive%expect(folder//'active_points', all(is_listed(1:) .eqv. status%state &
      == active), 'points that are not the active ones, each once')
  end subroutine check_status

end module restart_m
