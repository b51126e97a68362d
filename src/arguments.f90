! SPDX-License-Identifier: MIT
!> The command line:
!> `i=DECK r=FILE d=DIR jobid=NAME ncpu=N perthread=N timing=... memory=... OVERRIDES`;
!> a bare path works as i=. Words of LS-DYNA mean what they mean there, or are told to be without
!> effect.
module arguments_m
  use deck_lines_m, only : shown_text
  use deck_overrides_m, only : is_override, override_mistake, contact_names, run_names
  use deck_spelling_m, only : first_too_far, keep_nearer
  use errors_m, only : error_t, raise, status_input
  implicit none
  private
  public :: arguments_t, read_arguments, help_text, file_stem, only_end_time, timing_by_interface, &
    timing_off

  !> Longest single argument.
  integer, parameter :: argument_length = 4096

  !> What is timed: phases, contact phases of each interface too, or the run as a whole.
  integer, parameter :: timing_by_phase = 0, timing_by_interface = 1, timing_off = 2

  !> Words of more than a letter that are this program's own, for what is misspelt.
  character(10), parameter :: own_words(9) = [character(10) :: 'ncpu=', 'perthread=', 'jobid=', &
    'quiet=', 'timing=', 'memory=', '--help', '--version', '--json']

  !> What the command line asks for.
  type :: arguments_t
    logical :: help = .false.
    logical :: version = .false.
    logical :: check = .false.              !! look at the deck, no run
    logical :: json = .false.               !! what the check finds, for programs
    character(:), allocatable :: deck       !! path of the deck; with a restart, of what changes, or
                                            !! unset
    character(:), allocatable :: restart    !! path of the restart file to go on from, or unset
    character(:), allocatable :: directory  !! where results go; of a check perhaps unset
    character(:), allocatable :: job        !! stem of the result files
    character(:), allocatable :: line       !! all arguments in one line, for the record
    integer :: n_thread = 1                 !! at most
    integer :: thread_share = 300           !! elements for each of several threads, at least:
                                            !! below, waiting costs more than sharing saves
    integer :: timing = timing_by_phase     !! one of the `timing_` constants
    logical :: quiet = .false.              !! nothing on the screen but how the run has ended
    logical :: no_dump = .false.            !! no numbered restart files (d=nodump)
    integer :: cpu_seconds = 0              !! processor time after which to stop (c=), 0 = no limit
    character(:), allocatable :: ignored    !! words of LS-DYNA that have no effect here
    character(argument_length), allocatable :: overrides(:) !! ctype=5, p:NAME=VALUE, ...
  end type arguments_t

contains

  !> Read the arguments; all mistakes are reported together.
  subroutine read_arguments(arguments, error)
    type(arguments_t), intent(out) :: arguments
    type(error_t), allocatable, intent(out) :: error
    character(argument_length) :: word
    character(:), allocatable :: mistakes
    integer :: i, length

    allocate (arguments%overrides(0))
    arguments%line = ''
    arguments%ignored = ''
    mistakes = ''
    do i = 1, command_argument_count()
      call get_command_argument(i, word, length=length)
      if (length > argument_length) then
        call refuse_length(word, length, mistakes)
        cycle
      end if
      if (i > 1) arguments%line = arguments%line//' '
      arguments%line = arguments%line//trim(word)
      arguments%check = arguments%check .or. (i == 1 .and. word == 'check')
      if (i > 1 .or. .not. arguments%check) call read_word(trim(word), arguments, mistakes)
    end do
    if (arguments%help .or. arguments%version) return
    if (.not. allocated(arguments%deck) .and. .not. allocated(arguments%restart)) &
      mistakes = mistakes//'no deck given: expected i=DECK (or r=FILE to go on)'//new_line('a')
    if (arguments%check .and. allocated(arguments%restart)) mistakes = mistakes &
      //'check looks at a deck: r= has no meaning'//new_line('a')
    if (arguments%json .and. .not. arguments%check) mistakes = mistakes &
      //'--json goes with check'//new_line('a')
    if (len(mistakes) > 0) then
      ! Else the deck tells them with its own.
      do i = 1, size(arguments%overrides)
        call note(override_mistake(trim(arguments%overrides(i))), mistakes)
      end do
      call raise(error, mistakes//'try slideline --help', status_input)
      return
    end if
    if (allocated(arguments%restart)) then
      if (.not. allocated(arguments%directory)) arguments%directory = folder_of(arguments%restart)
      return
    end if
    if (.not. (allocated(arguments%directory) .or. arguments%check)) arguments%directory = '.'
    if (.not. allocated(arguments%job)) arguments%job = file_stem(arguments%deck)
  end subroutine read_arguments

  !> An argument of which only the first part was read.
  pure subroutine refuse_length(word, length, mistakes)
    character(*), intent(in) :: word !! as far as it was read
    integer, intent(in) :: length
    character(:), allocatable, intent(inout) :: mistakes
    integer, parameter :: shown = 60
    character(12) :: found, limit

    write (found, '(ss,i0)') length
    write (limit, '(ss,i0)') argument_length
    mistakes = mistakes//'"'//shown_text(word(:shown))//'..." has '//trim(found) &
      //' characters: an argument may have '//trim(limit)//new_line('a')
  end subroutine refuse_length

  !> Understand one argument.
  subroutine read_word(word, arguments, mistakes)
    character(*), intent(in) :: word
    type(arguments_t), intent(inout) :: arguments
    character(:), allocatable, intent(inout) :: mistakes
    character(:), allocatable :: name, value, mistake
    integer :: equals

    mistake = control_mistake(word)
    call note(mistake, mistakes)
    if (len(mistake) > 0) return
    equals = index(word, '=')
    ! No name before a value holds a slash: this is a path.
    if (equals > 0 .and. index(word(:equals), '/') > 0) equals = 0
    if (word == '--help' .or. word == '-h') then
      arguments%help = .true.
      return
    else if (word == '--version') then
      arguments%version = .true.
      return
    else if (word == '--json') then
      arguments%json = .true.
      return
    else if (equals == 0 .and. word(1:min(1, len(word))) /= '-') then
      call take(arguments%deck, word, 'deck', mistakes)
      return
    end if
    name = lower_case(word(:equals - 1))
    value = word(equals + 1:)
    select case (name)
    case ('i')
      call take(arguments%deck, value, 'deck', mistakes)
    case ('r')
      call take(arguments%restart, value, 'r=', mistakes)
    case ('d')
      arguments%no_dump = arguments%no_dump .or. lower_case(value) == 'nodump'
      if (lower_case(value) /= 'nodump') call take(arguments%directory, value, 'd=', mistakes)
    case ('jobid')
      call take(arguments%job, value, 'jobid=', mistakes)
      if (index(value, '/') > 0) mistakes = mistakes//'jobid="'//value &
        //'": expected a name without /'//new_line('a')
    case ('ncpu')
      ! LS-DYNA's may have a minus before it.
      call read_count(name, value(1 + index(value(:min(1, len(value))), '-'):), 1024, &
        arguments%n_thread, mistake)
      call note(mistake, mistakes)
    case ('c')
      call read_count(name, value, 1000000000, arguments%cpu_seconds, mistake)
      call note(mistake, mistakes)
    case ('quiet')
      arguments%quiet = value == '1'
      if (value /= '0' .and. value /= '1') mistakes = mistakes//'quiet="'//value &
        //'": expected 0 or 1'//new_line('a')
    case ('perthread')
      call read_count(name, value, 1000000000, arguments%thread_share, mistake)
      call note(mistake, mistakes)
    case ('timing')
      call read_timing(value, arguments%timing, mistakes)
    case ('memory', 'memory2')
      continue ! memory is taken as it is needed
    case ('o', 'g', 's', 'f', 'a', 'x', 'para')
      call ignore(name//'=', arguments%ignored)
    case default
      if (is_override(name)) then
        arguments%overrides = [character(argument_length) :: arguments%overrides, word]
      else
        mistakes = mistakes//'unknown argument "'//word//'"'//meant_word(word) &
          //new_line('a')
      end if
    end select
  end subroutine read_word

  !> `; did you mean NAME=?`, NAME the nearest of all words; nothing where none is near.
  pure function meant_word(word) result(text)
    character(*), intent(in) :: word !! that is not known
    character(:), allocatable :: text
    character(:), allocatable :: given
    character(20) :: nearest
    integer :: i, least

    given = lower_case(word(:scan(word//'=.', '=.') - 1))
    if (len(given) < len(word)) given = given//'='
    nearest = ''
    least = first_too_far(given)
    do i = 1, size(run_names)
      call keep_nearer(lower_case(trim(run_names(i)))//'=', given, least, nearest)
    end do
    do i = 1, size(contact_names)
      call keep_nearer(lower_case(trim(contact_names(i)))//'=', given, least, nearest)
    end do
    do i = 1, size(own_words)
      call keep_nearer(trim(own_words(i)), given, least, nearest)
    end do
    text = ''
    if (len_trim(nearest) > 0) text = '; did you mean '//trim(nearest)//'?'
  end function meant_word

  !> Note a word of LS-DYNA that has no effect, once.
  pure subroutine ignore(word, ignored)
    character(*), intent(in) :: word
    character(:), allocatable, intent(inout) :: ignored

    if (index(' '//ignored//' ', ' '//word//' ') > 0) return
    if (len(ignored) > 0) ignored = ignored//' '
    ignored = ignored//word
  end subroutine ignore

  !> What is wrong with a word that has control characters, which would make lines of their own in
  !> logs and status.out, or act on terminals; empty where nothing is.
  pure function control_mistake(word) result(mistake)
    character(*), intent(in) :: word
    character(:), allocatable :: mistake
    integer :: i

    mistake = ''
    do i = 1, len(word)
      if (iachar(word(i:i)) >= 32 .and. iachar(word(i:i)) /= 127) cycle
      mistake = '"'//trim(shown_text(word))//'" has a control character (line feed, escape or ' &
        //'the like) where ? stands: expected none'
      return
    end do
  end function control_mistake

  !> Keep what is wrong with one word.
  pure subroutine note(mistake, mistakes)
    character(*), intent(in) :: mistake !! empty: nothing
    character(:), allocatable, intent(inout) :: mistakes

    if (len(mistake) > 0) mistakes = mistakes//mistake//new_line('a')
  end subroutine note

  !> Understand a number from 1 to `most`.
  pure subroutine read_count(name, value, most, count, mistake)
    character(*), intent(in) :: name, value
    integer, intent(in) :: most
    integer, intent(inout) :: count !! kept where the value is wrong
    character(:), allocatable, intent(out) :: mistake !! empty: none
    character(12) :: limit
    integer :: number, status

    mistake = ''
    number = 0
    status = verify(value, '0123456789')
    if (status == 0) read (value, *, iostat=status) number
    if (status == 0 .and. number >= 1 .and. number <= most) then
      count = number
      return
    end if
    write (limit, '(ss,i0)') most
    mistake = name//'="'//value//'": expected a number from 1 to '//trim(limit)
  end subroutine read_count

  !> Understand the value of timing=.
  subroutine read_timing(value, timing, mistakes)
    character(*), intent(in) :: value
    integer, intent(inout) :: timing
    character(:), allocatable, intent(inout) :: mistakes

    select case (lower_case(value))
    case ('phase')
      timing = timing_by_phase
    case ('interface')
      timing = timing_by_interface
    case ('off')
      timing = timing_off
    case default
      mistakes = mistakes//'timing="'//value//'": expected phase, interface or off' &
        //new_line('a')
    end select
  end subroutine read_timing

  !> Set a text once.
  subroutine take(target_text, value, name, mistakes)
    character(:), allocatable, intent(inout) :: target_text
    character(*), intent(in) :: value, name
    character(:), allocatable, intent(inout) :: mistakes

    if (allocated(target_text)) then
      mistakes = mistakes//name//' is given twice: "'//target_text//'" and "'//value//'"' &
        //new_line('a')
      if (name == 'deck') mistakes = mistakes &
        //'(the one command that may come before a deck is check)'//new_line('a')
    else if (len_trim(value) == 0) then
      mistakes = mistakes//name//' is empty'//new_line('a')
    else
      target_text = value
    end if
  end subroutine take

  !> The text with letters A to Z made lower case, in which words of the command line are told.
  pure function lower_case(text) result(lower)
    character(*), intent(in) :: text
    character(len(text)) :: lower
    integer :: i

    lower = text
    do i = 1, len(text)
      if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') lower(i:i) = achar(iachar(text(i:i)) + 32)
    end do
  end function lower_case

  !> Whether the command line changes nothing of a deck but its end time.
  pure function only_end_time(arguments) result(only)
    type(arguments_t), intent(in) :: arguments
    logical :: only
    integer :: i

    only = .true.
    do i = 1, size(arguments%overrides)
      only = only .and. lower_case(arguments%overrides(i)(:7)) == 'endtim='
    end do
  end function only_end_time

  !> The folder that a file lies in.
  pure function folder_of(path) result(folder)
    character(*), intent(in) :: path
    character(:), allocatable :: folder

    folder = path(:index(path, '/', back=.true.))
    if (len(folder) == 0) folder = '.'
  end function folder_of

  !> File name without folders and last extension.
  pure function file_stem(path) result(stem)
    character(*), intent(in) :: path
    character(:), allocatable :: stem
    integer :: dot

    stem = path(index(path, '/', back=.true.) + 1:)
    dot = index(stem, '.', back=.true.)
    if (dot > 1) stem = stem(:dot - 1)
  end function file_stem

  !> What --help prints.
  function help_text() result(text)
    character(:), allocatable :: text
    character(1), parameter :: n = new_line('a')

    text = 'slideline: 2D explicit contact dynamics'//n//n// &
      'usage: slideline i=DECK [d=DIR] [jobid=NAME] [ncpu=N] [timing=...] [OVERRIDES]'//n// &
      '       slideline r=FILE [i=CHANGES] [d=DIR] [ncpu=N] [endtim=T]   go on from a '// &
        'restart file'//n// &
      '       slideline DECK ...     the same'//n// &
      '       slideline check DECK [--json] [d=DIR] [OVERRIDES]   all errors and warnings, '// &
        'without a run;'//n// &
      '                     d= writes the state at time zero'//n//n// &
      '  i=DECK        LS-DYNA style keyword deck'//n// &
      '  r=FILE        restart file (JOB.dump01.h5, JOB.runrsf.h5): the run goes on from '// &
        'there, in its'//n// &
      '                folder unless d= says otherwise; i= then names a small deck of '// &
        'changes'//n// &
      '  d=DIR         folder of the results, made with its parents (default: .)'//n// &
      '  jobid=NAME    stem of the result files (default: the deck''s)'//n// &
      '  ncpu=N        threads at most (default 1); the results have the same bits at any '// &
        'number'//n// &
      '  perthread=N   elements for each of several threads, at least (default 300)'//n// &
      '  timing=HOW    phase: wall clock by phase (default); interface: contact phases of '// &
        'each'//n// &
      '                interface too; off: the total alone'//n// &
      '  quiet=1       one line on the screen: how the run has ended'//n// &
      '  c=SECONDS     processor time after which the run stops as by a signal'//n// &
      '  d=nodump      no numbered restart files, whatever the deck asks for'//n// &
      '  memory=...    and memory2=...: accepted and ignored; so are, with a warning, '// &
        'LS-DYNA''s o= g='//n// &
      '                s= f= a= x= and para='//n//n// &
      'overrides, for sweeps:'//n// &
      '  ctype=T ngauss=N pen=P      contact of every interface; ctype.2=T of interface 2'//n// &
      '  punit=U pent=P vdc=D        unit of the penalty, that of the master pass, damping'//n// &
      '  fs=M fd=M dc=C vc=T tfac=R  friction: coefficients, decay, largest stress, spring'//n// &
      '  target=E                    with ctype=0: the largest estimate of the error'//n// &
      '  endtim=T dt=DT tssfac=F     end time, constant step, safety factor'//n// &
      '  p:NAME=VALUE                a *PARAMETER of the deck'//n//n// &
      'results: JOB.vtkhdf (ParaView), JOB.*.csv, JOB.log, JOB.effective.k (the deck as run)'//n// &
      'while it runs: status.out (JOB.status.out with jobid=) says how far it is and how '// &
        'long it may take;'//n// &
      'a file DIR/d3kil with sw1 (restart file, stop), sw2 (status line), sw3 (restart '// &
        'file), sw4 (plot'//n// &
      'state), swa (histories up to date) or stop; signals TERM, INT, HUP and XCPU (stop), '// &
        'USR1 (sw3),'//n// &
      'USR2 (sw4)'//n// &
      'exit status: 0 normal, 1 refused input, 2 error in the run, 3 files, 4 stopped on '// &
        'request'//n// &
      '--version prints the version, compiler and options'
  end function help_text

end module arguments_m
