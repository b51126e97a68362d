! SPDX-License-Identifier: MIT
!> End conditions of the deck (*TERMINATION_NODE, _BODY, _CONTACT) and requests of the user during a
!> run, by a word in the file d3kil or by a signal. Status lines and flushed histories are handled
!> here, all else by the driver.
module requests_m
  use controls_m, only : end_condition_t, end_node_coordinate, end_node_contact, &
    end_body_displacement, end_body_distance, end_contact
  use errors_m, only : error_t
  use files_m, only : file_exists, is_endless, remove_file
  use history_file_m, only : flush_histories
  use kinds_m, only : wp, long
  use log_m, only : warn, to_text
  use model_m, only : model_t
  use monitor_m, only : monitor_t
  use progress_m, only : show_progress
  use restart_plan_m, only : is_poll_due, switch_path
  use state_m, only : state_t
  use system_m, only : stop_requested, is_requested, request_dump, request_plot
  use text_m, only : upper_case
  implicit none
  private
  public :: requests_t, read_requests, recent_requests_t, get_signals, drop_repeated, read_switch, &
    find_early_end

  !> Longest line that is read, whatever the environment sets (GFORTRAN_DEFAULT_RECL).
  integer, parameter :: line_length = 100000

  !> Requests of the user.
  type :: requests_t
    logical :: dump = .false.      !! a numbered restart file (sw1, sw3, SIGUSR1)
    logical :: plot = .false.      !! a plot state (sw4, SIGUSR2)
    logical :: stop = .false.      !! an end before its time (sw1, stop, SIGTERM, SIGINT, SIGHUP)
    logical :: signalled = .false. !! a signal requests the stop
  end type requests_t

  !> Recently served requests. A launcher sends SIGUSR1 and SIGUSR2 to every process, and these
  !> receive them in different cycles: a request within a second of the same one is ignored.
  type :: recent_requests_t
    integer(long) :: done(2) = -huge(1_long) !! clock tick of the last restart file and of the last
                                             !! plot state
  end type recent_requests_t

contains

  !> Requests by signal, of a process without files.
  subroutine get_signals(requests)
    type(requests_t), intent(out) :: requests

    requests%dump = is_requested(request_dump)
    requests%plot = is_requested(request_plot)
    requests%signalled = stop_requested()
    requests%stop = requests%signalled
  end subroutine get_signals

  !> Drop requests that repeat one served within the last second.
  subroutine drop_repeated(served, recent, requests)
    type(requests_t), intent(in) :: served    !! requests served since the last call
    type(recent_requests_t), intent(inout) :: recent
    type(requests_t), intent(inout) :: requests
    integer(long) :: now, rate

    if (.not. any([served%dump, served%plot, requests%dump, requests%plot])) return
    call system_clock(now, rate)
    where ([served%dump, served%plot]) recent%done = now
    requests%dump = requests%dump .and. now - rate > recent%done(1)
    requests%plot = requests%plot .and. now - rate > recent%done(2)
  end subroutine drop_repeated

  !> Read the requests: signals in each call; d3kil twice a second, or in each call where steps are
  !> long.
  subroutine read_requests(state, ratio, steps_are_long, monitor, requests, error)
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: ratio          !! last energy ratio known
    logical, intent(in) :: steps_are_long
    type(monitor_t), intent(inout) :: monitor
    type(requests_t), intent(out) :: requests
    type(error_t), allocatable, intent(inout) :: error
    logical :: is_due
    character(:), allocatable :: switch

    switch = ''
    is_due = steps_are_long
    if (.not. is_due) call is_poll_due(monitor%restarts, monitor%clock%is_on, monitor%clock%last, &
      state%cycle, is_due)
    if (is_due) call read_switch(monitor%restarts%directory, switch)
    call get_signals(requests)
    select case (switch)
    case ('')
      continue
    case ('SW1')
      requests%dump = .true.
      requests%stop = .true.
    case ('SW2')
      call show_progress(monitor%progress, monitor%clock, state%cycle, state%time, state%dt, &
        ratio, 'status (sw2)', .true.)
    case ('SW3')
      requests%dump = .true.
    case ('SW4')
      requests%plot = .true.
    case ('STOP')
      requests%stop = .true.
    case ('SWA')
      if (.not. allocated(error)) call flush_histories(monitor%histories, .true., error)
    case default
      call warn(monitor%log, 'd3kil holds an unknown word; known: sw1, sw2, sw3, sw4, swa, stop')
    end select
  end subroutine read_requests

  !> Read the word in the file d3kil of a folder and remove the file. The word is returned in
  !> capitals, without the point of `SWA.` of old manuals. An empty file stays: it may be in the
  !> course of being written.
  subroutine read_switch(directory, switch)
    character(*), intent(in) :: directory
    character(:), allocatable, intent(out) :: switch  !! empty: none
    type(error_t), allocatable :: ignored
    character(80) :: line
    integer :: unit, status

    switch = ''
    if (.not. file_exists(switch_path(directory))) return
    if (is_endless(switch_path(directory))) return
    open (newunit=unit, file=switch_path(directory), status='old', action='read', &
      recl=line_length, iostat=status)
    if (status /= 0) return
    read (unit, '(a)', iostat=status) line
    close (unit)
    if (status /= 0 .or. len_trim(line) == 0) return
    line = upper_case(adjustl(line))
    if (line(4:) == '.') line(4:) = ''
    switch = trim(line)
    call remove_file(switch_path(directory), ignored)
  end subroutine read_switch

  !> Test the end conditions of the deck. Positions are those of the state, contact forces the
  !> latest known. The first condition that holds is reported.
  subroutine find_early_end(model, state, last, reason)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    logical, intent(inout) :: last   !! the run ends anyway; on return also by a condition
    character(:), allocatable, intent(inout) :: reason !! of the end
    character(:), allocatable :: found
    real(wp) :: way
    integer :: i

    if (.not. allocated(model%controls%ends)) return
    do i = 1, size(model%controls%ends)
      associate (ending => model%controls%ends(i))
        found = ''
        select case (ending%kind)
        case (end_node_coordinate)
          found = beyond('node '//to_text(ending%id)//' has come to ', '', &
            model%mesh%coordinates(ending%direction, ending%where) &
            + state%motion(ending%direction, ending%where), ending, ' (*TERMINATION_NODE)')
        case (end_node_contact)
          if (norm2(force_on(state, ending%where)) > 0.0_wp) found = 'node '// &
            to_text(ending%id)//' is in contact (*TERMINATION_NODE)'
        case (end_body_displacement)
          found = beyond('body '//to_text(ending%id)//' has moved to ', 'displacement ', &
            state%rigids(ending%where)%displacement(ending%direction), ending, &
            ' (*TERMINATION_BODY)')
        case (end_body_distance)
          way = norm2(state%rigids(ending%where)%displacement(1:2))
          if (way >= ending%most) found = 'body '//to_text(ending%id)//' has moved by ' &
            //to_text(way)//' (*TERMINATION_BODY)'
        case (end_contact)
          call check_contact_end(ending, state, state%quiet_since(i), found)
        end select
      end associate
      if (len(found) == 0 .or. last) cycle
      last = .true.
      reason = found
    end do
  end subroutine find_early_end

  !> Report of a value at or beyond its bounds; empty within them.
  pure function beyond(what, of, value, ending, keyword) result(found)
    character(*), intent(in) :: what, of, keyword
    real(wp), intent(in) :: value
    type(end_condition_t), intent(in) :: ending
    character(:), allocatable :: found

    found = ''
    if (value > ending%least .and. value < ending%most) return
    found = what//of//merge('x', 'y', ending%direction == 1)//' = '//to_text(value)//keyword
  end function beyond

  !> Test whether an interface has had no force for long enough, and update the time since which it
  !> has none.
  subroutine check_contact_end(ending, state, since, found)
    type(end_condition_t), intent(in) :: ending
    type(state_t), intent(in) :: state
    real(wp), intent(inout) :: since
    character(:), allocatable, intent(inout) :: found
    real(wp) :: force(2)

    if (state%time < ending%start) return
    associate (memory => state%contacts(ending%where))
      force = sum(memory%force(:, :memory%n_slave), 2)
    end associate
    if (ending%direction > 0) force(3 - ending%direction) = 0.0_wp
    if (norm2(force) > ending%threshold) then
      since = -1.0_wp
      return
    end if
    if (since < 0.0_wp) since = state%time
    if (state%time - since >= ending%duration) found = 'interface '//to_text(ending%id) &
      //' has no contact force (*TERMINATION_CONTACT)'
  end subroutine check_contact_end

  !> Contact force on a node, of all interfaces.
  pure function force_on(state, node) result(force)
    type(state_t), intent(in) :: state
    integer, intent(in) :: node
    real(wp) :: force(2)
    integer :: i, k

    force = 0.0_wp
    do i = 1, size(state%contacts)
      do k = 1, size(state%contacts(i)%nodes)
        if (state%contacts(i)%nodes(k) == node) force = force + state%contacts(i)%force(:, k)
      end do
    end do
  end function force_on

end module requests_m
