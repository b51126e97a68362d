! SPDX-License-Identifier: MIT
!> The command line:
!> `i=DECK r=FILE d=DIR jobid=NAME ncpu=N perthread=N timing=... memory=... OVERRIDES`;
!> a bare path works as i=. Arguments of LS-DYNA have their meaning there, or are ignored with a
!> warning.
module arguments_m
  use deck_lines_m, only : shown_text
  use deck_overrides_m, only : is_override, override_error, contact_names, run_names
  use deck_schema_m, only : distance_limit, update_nearest
  use errors_m, only : error_t, raise, status_input
  use files_m, only : folder_of
  use log_m, only : to_text
  implicit none
  private
  public :: arguments_t, read_arguments, help, file_stem, only_end_time, timing_by_interface, &
    timing_off

  !> Maximum length of an argument.
  integer, parameter :: argument_length = 4096

  !> Timing of phases, of contact phases by interface too, or of the whole run.
  integer, parameter :: timing_by_phase = 0, timing_by_interface = 1, timing_off = 2
  character(9), parameter :: timings(3) = ['phase    ', 'interface', 'off      ']

  !> Other arguments of more than one letter, for suggestions.
  character(9), parameter :: own_words(9) = [character(9) :: 'NCPU', 'PERTHREAD', 'JOBID', &
    'QUIET', 'TIMING', 'MEMORY', '--help', '--version', '--json']

  !> Text of --help.
  character(91), parameter :: help(*) = [character(91) :: &
    'slideline: 2D explicit and implicit contact dynamics', &
    '', &
    'usage: slideline i=DECK [d=DIR] [jobid=NAME] [ncpu=N] [timing=...] [OVERRIDES]', &
    '       slideline r=FILE [i=CHANGES] [d=DIR] [ncpu=N] [endtim=T]   restart', &
    '       slideline DECK ...     the same', &
    '       slideline check DECK [--json] [d=DIR] [OVERRIDES]   all errors and warnings, without', &
    '                     a run; d= writes the state at time zero', &
    '', &
    '  i=DECK        LS-DYNA style keyword deck', &
    '  r=FILE        restart file (JOB.dump01.h5, JOB.runrsf.h5): the run continues there, in', &
    '                its folder unless d= is given; i= is then a small deck of changes', &
    '  d=DIR         folder of the results, made with its parents (default: .)', &
    '  jobid=NAME    stem of the result files (default: the deck''s)', &
    '  ncpu=N        threads at most (default 1); the results have the same bits at any number', &
    '  perthread=N   elements for each of several threads, at least (default 300)', &
    '  timing=HOW    phase: wall clock by phase (default); interface: contact phases of each', &
    '                interface too; off: the total alone', &
    '  quiet=1       one line on the screen: the end of the run', &
    '  c=SECONDS     processor time after which the run stops as by a signal', &
    '  d=nodump      no numbered restart files, whatever the deck says', &
    '  memory=...    and memory2=...: accepted and ignored; so are, with a warning, LS-DYNA''s', &
    '                o= g= s= f= a= x= and para=', &
    '', &
    'overrides, for sweeps:', &
    '  ctype=T ngauss=N pen=P      contact of every interface; ctype.2=T of interface 2', &
    '  punit=U pent=P vdc=D        unit of the penalty, that of the master pass, damping', &
    '  fs=M fd=M dc=C vc=T tfac=R  friction: coefficients, decay, largest stress, spring', &
    '  ctype=0                     the program chooses the type, with target=E the cheapest one', &
    '                              whose error estimate is at most E', &
    '  smooth=DEGREES              segments that turn by less stand for arcs (0: 16; -1: none)', &
    '  endtim=T dt=DT tssfac=F     end time, constant step, safety factor', &
    '  p:NAME=VALUE                a *PARAMETER of the deck', &
    '', &
    'results: JOB.vtkhdf (ParaView), JOB.*.csv, JOB.log, JOB.effective.k (the deck as run)', &
    'while it runs: status.out (JOB.status.out with jobid=) shows progress and remaining time;', &
    'a file DIR/d3kil with sw1 (restart file, stop), sw2 (status line), sw3 (restart', &
    'file), sw4 (plot state), swa (histories up to date) or stop; signals TERM, INT, HUP and', &
    'XCPU (stop), USR1 (sw3), USR2 (sw4)', &
    'exit status: 0 normal, 1 refused input, 2 error in the run, 3 files, 4 stopped on request', &
    '--version prints the version, compiler and options']

  !> Values of the command line.
  type :: arguments_t
    logical :: help = .false.
    logical :: version = .false.
    logical :: check = .false.              !! check the deck without a run
    logical :: json = .false.               !! print the findings of a check as JSON
    character(:), allocatable :: deck       !! path of the deck; at a restart of the changes, or
                                            !! unset
    character(:), allocatable :: restart    !! path of the restart file, or unset
    character(:), allocatable :: directory  !! folder of the results; unset in a check without d=
    character(:), allocatable :: job        !! stem of the result files
    character(:), allocatable :: line       !! all arguments in one line, for the record
    integer :: n_thread = 1                 !! maximum number of threads
    integer :: thread_share = 300           !! minimum number of elements for each of several
                                            !! threads: less costs more than it saves
    integer :: timing = timing_by_phase     !! one of the `timing_` constants
    logical :: quiet = .false.              !! only the end of the run on the screen
    logical :: no_dump = .false.            !! no numbered restart files (d=nodump)
    integer :: cpu_seconds = 0              !! limit of the processor time (c=), 0 = none
    character(:), allocatable :: ignored    !! arguments of LS-DYNA without effect
    character(argument_length), allocatable :: overrides(:) !! ctype=5, p:NAME=VALUE, ...
  end type arguments_t

contains

  !> Read the arguments, and report all errors together. Errors of overrides alone are reported with
  !> those of the deck.
  subroutine read_arguments(arguments, error)
    type(arguments_t), intent(out) :: arguments
    type(error_t), allocatable, intent(out) :: error
    character(argument_length) :: word
    character(:), allocatable :: problems
    integer :: i, length

    allocate (arguments%overrides(0))
    arguments%line = ''
    arguments%ignored = ''
    problems = ''
    do i = 1, command_argument_count()
      call get_command_argument(i, word, length=length)
      if (length > argument_length) then
        call note('"'//shown_text(word(:60))//'..." has '//to_text(length)//' characters; the ' &
          //'limit is '//to_text(argument_length), problems)
        cycle
      end if
      if (i > 1) arguments%line = arguments%line//' '
      arguments%line = arguments%line//trim(word)
      arguments%check = arguments%check .or. (i == 1 .and. word == 'check')
      if (i > 1 .or. .not. arguments%check) call read_word(trim(word), arguments, problems)
    end do
    if (arguments%help .or. arguments%version) return
    if (.not. (allocated(arguments%deck) .or. allocated(arguments%restart))) &
      call note('no deck given: expected i=DECK (or r=FILE to restart)', problems)
    if (arguments%check .and. allocated(arguments%restart)) &
      call note('check reads a deck: r= has no meaning', problems)
    if (arguments%json .and. .not. arguments%check) call note('--json needs check', problems)
    if (len(problems) > 0) then
      ! Otherwise they are reported with those of the deck.
      do i = 1, size(arguments%overrides)
        call note(override_error(trim(arguments%overrides(i))), problems)
      end do
      call raise(error, problems//'try slideline --help', status_input)
      return
    end if
    if (allocated(arguments%restart)) then
      if (.not. allocated(arguments%directory)) arguments%directory = folder_of(arguments%restart)
      return
    end if
    if (.not. (allocated(arguments%directory) .or. arguments%check)) arguments%directory = '.'
    if (.not. allocated(arguments%job)) arguments%job = file_stem(arguments%deck)
  end subroutine read_arguments

  !> Read one argument.
  subroutine read_word(word, arguments, problems)
    character(*), intent(in) :: word
    type(arguments_t), intent(inout) :: arguments
    character(:), allocatable, intent(inout) :: problems
    character(:), allocatable :: name, value
    integer :: i, equals

    do i = 1, len(word)
      ! They would break lines of logs and status.out, or control terminals.
      if (iachar(word(i:i)) >= 32 .and. iachar(word(i:i)) /= 127) cycle
      call note('"'//trim(shown_text(word))//'" has a control character (line feed, escape or ' &
        //'the like) where ? stands: expected none', problems)
      return
    end do
    equals = index(word, '=')
    ! A slash before the =: this is a path.
    if (equals > 0 .and. index(word(:equals), '/') > 0) equals = 0
    if (equals == 0 .and. index(word, '-') /= 1) then
      call set_once(arguments%deck, word, 'deck', problems)
      return
    end if
    name = lower_case(word(:equals - 1))
    value = word(equals + 1:)
    if (equals == 0 .or. index(word, '-') == 1) name = word
    select case (name)
    case ('--help', '-h')
      arguments%help = .true.
    case ('--version')
      arguments%version = .true.
    case ('--json')
      arguments%json = .true.
    case ('i')
      call set_once(arguments%deck, value, 'deck', problems)
    case ('r')
      call set_once(arguments%restart, value, 'r=', problems)
    case ('d')
      arguments%no_dump = arguments%no_dump .or. lower_case(value) == 'nodump'
      if (lower_case(value) /= 'nodump') call set_once(arguments%directory, value, 'd=', problems)
    case ('jobid')
      call set_once(arguments%job, value, 'jobid=', problems)
      if (index(value, '/') > 0) &
        call note('jobid="'//value//'": expected a name without /', problems)
    case ('ncpu')
      ! LS-DYNA's may have a minus before it.
      call read_count(name, value(1 + index(value(:min(1, len(value))), '-'):), 1024, &
        arguments%n_thread, problems)
    case ('c')
      call read_count(name, value, 1000000000, arguments%cpu_seconds, problems)
    case ('quiet')
      arguments%quiet = value == '1'
      if (value /= '0' .and. value /= '1') &
        call note('quiet="'//value//'": expected 0 or 1', problems)
    case ('perthread')
      call read_count(name, value, 1000000000, arguments%thread_share, problems)
    case ('timing')
      i = findloc(timings == lower_case(value), .true., 1)
      if (i > 0) arguments%timing = i - 1
      if (i == 0) call note('timing="'//value//'": expected phase, interface or off', problems)
    case ('memory', 'memory2')
      continue ! memory is allocated as needed
    case ('o', 'g', 's', 'f', 'a', 'x', 'para')
      if (index(' '//arguments%ignored, ' '//name//'=') == 0) &
        arguments%ignored = trim(adjustl(arguments%ignored//' '//name//'='))
    case default
      if (is_override(name)) then
        arguments%overrides = [character(argument_length) :: arguments%overrides, word]
      else
        call note('unknown argument "'//word//'"'//suggestion(word), problems)
      end if
    end select
  end subroutine read_word

  !> `; did you mean NAME=?` with the most similar argument; empty where there is none.
  pure function suggestion(word) result(text)
    character(*), intent(in) :: word !! unknown argument
    character(:), allocatable :: text
    character(*), parameter :: words(*) = [character(9) :: run_names, contact_names, own_words]
    character(:), allocatable :: given, known
    character(20) :: nearest
    integer :: i, least

    given = lower_case(word(:scan(word//'=.', '=.') - 1))
    if (len(given) < len(word)) given = given//'='
    nearest = ''
    least = distance_limit(given)
    do i = 1, size(words)
      known = lower_case(trim(words(i)))
      if (index(known, '--') /= 1) known = known//'='
      call update_nearest(known, given, least, nearest)
    end do
    text = ''
    if (len_trim(nearest) > 0) text = '; did you mean '//trim(nearest)//'?'
  end function suggestion

  !> Add a problem to the list.
  pure subroutine note(problem, problems)
    character(*), intent(in) :: problem !! empty: none
    character(:), allocatable, intent(inout) :: problems

    if (len(problem) > 0) problems = problems//problem//new_line('a')
  end subroutine note

  !> Read an integer from 1 to `most`.
  pure subroutine read_count(name, value, most, count, problems)
    character(*), intent(in) :: name, value
    integer, intent(in) :: most
    integer, intent(inout) :: count !! unchanged where the value is wrong
    character(:), allocatable, intent(inout) :: problems
    integer :: number, status

    number = 0
    status = verify(value, '0123456789')
    if (status == 0) read (value, *, iostat=status) number
    if (status == 0 .and. number >= 1 .and. number <= most) then
      count = number
    else
      call note(name//'="'//value//'": expected a number from 1 to '//to_text(most), problems)
    end if
  end subroutine read_count

  !> Set a text that may be given once.
  subroutine set_once(target_text, value, name, problems)
    character(:), allocatable, intent(inout) :: target_text
    character(*), intent(in) :: value, name
    character(:), allocatable, intent(inout) :: problems

    if (allocated(target_text)) then
      call note(name//' is given twice: "'//target_text//'" and "'//value//'"', problems)
      if (name == 'deck') &
        call note('(the only command before a deck is check)', problems)
    else if (len_trim(value) == 0) then
      call note(name//' is empty', problems)
    else
      target_text = value
    end if
  end subroutine set_once

  !> The text with letters A to Z in lower case.
  pure function lower_case(text) result(lower)
    character(*), intent(in) :: text
    character(len(text)) :: lower
    integer :: i

    lower = text
    do i = 1, len(text)
      if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') lower(i:i) = achar(iachar(text(i:i)) + 32)
    end do
  end function lower_case

  !> Whether all overrides are endtim=.
  pure function only_end_time(arguments) result(only)
    type(arguments_t), intent(in) :: arguments
    logical :: only
    integer :: i

    only = .true.
    do i = 1, size(arguments%overrides)
      only = only .and. lower_case(arguments%overrides(i)(:7)) == 'endtim='
    end do
  end function only_end_time

  !> File name without folders and extension.
  pure function file_stem(path) result(stem)
    character(*), intent(in) :: path
    character(:), allocatable :: stem
    integer :: dot

    stem = path(index(path, '/', back=.true.) + 1:)
    dot = index(stem, '.', back=.true.)
    if (dot > 1) stem = stem(:dot - 1)
  end function file_stem

end module arguments_m
