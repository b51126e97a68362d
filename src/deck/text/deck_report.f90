! SPDX-License-Identifier: MIT
!> Errors and warnings of a deck, collected while it is read and written in deck order. Many errors
!> of one kind (one field, messages that differ in numbers only) are written as one message with a
!> count. Programs get the messages as JSON (RFC 8259).
module deck_report_m
  use errors_m, only : error_t, raise, status_input
  use log_m, only : log_t, warn, to_text
  use text_m, only : text_of, utf8_length
  implicit none
  private
  public :: report_t, finding_t, add_error, count_only, add_warning, &
    emit_warnings, emit_errors, list_findings, add_finding, json_text

  !> Maximum number of stored errors, and of warnings; later ones are counted. The first errors of
  !> each kind are stored in any case.
  integer, parameter :: max_kept = 1000, first_kept = 3
  !> Maximum number of kinds of errors.
  integer, parameter :: max_kinds = 200
  !> Maximum number of errors of a kind that are written one by one.
  integer, parameter :: max_listed = 10

  !> A message with its location, for programs. Without a location it belongs to the deck.
  type :: finding_t
    character(:), allocatable :: message !! without location
    character(:), allocatable :: file
    integer :: line = 0                  !! in the file, 0: none
    character(:), allocatable :: keyword !! without asterisk
    integer :: card = 0, field = 0       !! 0: the line as a whole
    character(12) :: name = ''           !! of the field
    integer :: first = 0, last = 0       !! columns of the field; 0 where the line is not that of
                                         !! the file
    character(:), allocatable :: found   !! text of the field
  end type finding_t

  !> One stored message.
  type :: message_t
    integer :: line = 0                !! line of the deck, for the order
    character(:), allocatable :: text
    character(:), allocatable :: key   !! equal for repeated warnings
    integer :: kind = 0                !! of an error, 0: none
    type(finding_t) :: finding
  end type message_t

  !> One kind of errors.
  type :: kind_t
    character(:), allocatable :: key   !! keyword, field and message without numbers
    integer :: n = 0                   !! number of errors
    integer :: n_kept = 0              !! number of stored messages
  end type kind_t

  !> All messages.
  type :: report_t
    integer :: n_error = 0
    integer :: n_kept = 0              !! stored errors
    integer :: n_kind = 0
    type(kind_t), allocatable :: kinds(:)
    integer :: n_warning = 0           !! stored warnings
    integer :: n_dropped = 0           !! warnings that are not stored
    type(message_t), allocatable :: errors(:)
    type(message_t), allocatable :: warnings(:)
  end type report_t

contains

  !> Add an error, sorted by `line`; equal errors of the deck as a whole (line 0) are added once.
  subroutine add_error(report, line, text, finding)
    type(report_t), intent(inout) :: report
    integer, intent(in) :: line
    character(*), intent(in) :: text
    type(finding_t), intent(in) :: finding
    integer :: k
    logical :: is_kept

    if (.not. allocated(report%errors)) &
      allocate (report%errors(max_kept + first_kept*max_kinds), report%kinds(max_kinds))
    do k = 1, merge(report%n_kept, 0, line < 1)
      if (report%errors(k)%line < 1 .and. report%errors(k)%text == text) return
    end do
    report%n_error = report%n_error + 1
    if (allocated(finding%keyword)) then
      call get_kind(report, key_of(finding%keyword, finding%name, finding%message), k)
    else
      call get_kind(report, key_of('', '', text), k)
    end if
    is_kept = report%n_kept < max_kept
    if (k > 0) then
      report%kinds(k)%n = report%kinds(k)%n + 1
      is_kept = is_kept .or. report%kinds(k)%n <= first_kept
    end if
    if (.not. is_kept) return
    if (k > 0) report%kinds(k)%n_kept = report%kinds(k)%n_kept + 1
    report%n_kept = report%n_kept + 1
    associate (note => report%errors(report%n_kept))
      note%line = line
      note%text = text
      note%finding = finding
      note%kind = k
    end associate
  end subroutine add_error

  !> Count an error if enough errors of its kind are stored; `is_done` is false where it has to be
  !> added.
  subroutine count_only(report, keyword, name, message, is_done)
    type(report_t), intent(inout) :: report
    character(*), intent(in) :: keyword, name, message
    logical, intent(out) :: is_done
    integer :: k

    is_done = report%n_kept >= max_kept
    if (.not. is_done) return
    call get_kind(report, key_of(keyword, name, message), k)
    if (k > 0) is_done = report%kinds(k)%n >= first_kept
    if (.not. is_done) return
    report%n_error = report%n_error + 1
    if (k > 0) report%kinds(k)%n = report%kinds(k)%n + 1
  end subroutine count_only

  !> Index of the kind of a key, added where there is room; 0 where there is not.
  subroutine get_kind(report, key, k)
    type(report_t), intent(inout) :: report
    character(*), intent(in) :: key
    integer, intent(out) :: k

    do k = 1, report%n_kind
      if (report%kinds(k)%key == key) return
    end do
    k = 0
    if (report%n_kind == max_kinds) return
    report%n_kind = report%n_kind + 1
    k = report%n_kind
    report%kinds(k)%key = key
  end subroutine get_kind

  !> Key of a kind of errors: keyword, field and message, with # for each integer in field and
  !> message (the members of a set have numbered fields).
  pure function key_of(keyword, name, message) result(key)
    character(*), intent(in) :: keyword, name, message
    character(:), allocatable :: key
    character(len_trim(name) + 1 + len(message)) :: text
    integer :: i, n
    logical :: is_digit, was_digit

    text = trim(name)//' '//message
    n = 0
    was_digit = .false.
    do i = 1, len(text)
      is_digit = text(i:i) >= '0' .and. text(i:i) <= '9'
      if (.not. (is_digit .and. was_digit)) then
        n = n + 1
        text(n:n) = merge('#', text(i:i), is_digit)
      end if
      was_digit = is_digit
    end do
    key = keyword//' '//text(:n)
  end function key_of

  !> Add a warning; warnings with equal keys are added once.
  subroutine add_warning(report, line, key, text, finding)
    type(report_t), intent(inout) :: report
    integer, intent(in) :: line
    character(*), intent(in) :: key
    character(*), intent(in) :: text
    type(finding_t), intent(in) :: finding
    integer :: i

    if (.not. allocated(report%warnings)) allocate (report%warnings(max_kept))
    do i = report%n_warning, 1, -1
      if (report%warnings(i)%key == key) return
    end do
    if (report%n_warning == max_kept) then
      report%n_dropped = report%n_dropped + 1
      return
    end if
    report%n_warning = report%n_warning + 1
    associate (note => report%warnings(report%n_warning))
      note%line = line
      note%key = key
      note%text = text
      note%finding = finding
    end associate
  end subroutine add_warning

  !> Write all warnings to the log in deck order.
  subroutine emit_warnings(report, log)
    type(report_t), intent(in) :: report
    type(log_t), intent(inout) :: log
    integer, allocatable :: order(:)
    integer :: i

    if (report%n_warning == 0) return
    order = deck_order(report%warnings(:report%n_warning))
    do i = 1, size(order)
      call warn(log, report%warnings(order(i))%text)
    end do
    if (report%n_dropped > 0) call warn(log, 'and '//to_text(report%n_dropped) &
      //' more warnings')
  end subroutine emit_warnings

  !> One error with all messages in deck order; none without errors.
  subroutine emit_errors(report, path, error)
    type(report_t), intent(in) :: report
    character(*), intent(in) :: path !! name of the deck
    type(error_t), allocatable, intent(out) :: error
    integer, allocatable :: order(:)
    character(:), allocatable :: text
    logical :: is_listed(report%n_kind), many
    integer :: i, k, n_rest

    if (report%n_error == 0) return
    order = deck_order(report%errors(:report%n_kept))
    is_listed = .false.
    n_rest = report%n_error
    text = ''
    do i = 1, size(order)
      k = report%errors(order(i))%kind
      ! Too many, or some without a stored message: one message with a count.
      many = .false.
      if (k > 0) many = report%kinds(k)%n > max_listed &
        .or. report%kinds(k)%n > report%kinds(k)%n_kept
      if (.not. many) then
        text = text//report%errors(order(i))%text//new_line('a')
        n_rest = n_rest - 1
      else if (.not. is_listed(k)) then
        text = text//report%errors(order(i))%text//new_line('a')//count_text(report, order(i:), k)
        is_listed(k) = .true.
        n_rest = n_rest - report%kinds(k)%n
      end if
    end do
    if (n_rest > 0) text = text//path//': and '//to_text(n_rest)//' more errors'//new_line('a')
    text = text//path//': refused, '//to_text(report%n_error)
    text = text//merge(' error ', ' errors', report%n_error == 1)
    call raise(error, trim(text), status_input)
  end subroutine emit_errors

  !> Line with the number of errors of a kind and their first locations.
  pure function count_text(report, order, k) result(text)
    type(report_t), intent(in) :: report
    integer, intent(in) :: order(:) !! of the errors, from the first of the kind on
    integer, intent(in) :: k
    character(:), allocatable :: text
    character(:), allocatable :: location, before
    integer :: i, n

    text = '  | '//to_text(report%kinds(k)%n)//' times'
    before = ''
    n = 0
    do i = 1, size(order)
      associate (note => report%errors(order(i)))
        if (note%kind /= k .or. .not. allocated(note%finding%file)) cycle
        location = note%finding%file//':'//to_text(note%finding%line)
      end associate
      if (location == before) cycle
      if (n == 3) then
        text = text//' and so on'
        exit
      end if
      n = n + 1
      text = text//trim(merge(': ', ', ', n == 1))//' '//location
      before = location
    end do
    text = text//new_line('a')
  end function count_text

  !> Order of messages by line, stable, line 0 last.
  pure function deck_order(notes) result(order)
    type(message_t), intent(in) :: notes(:)
    integer :: order(size(notes))
    integer :: i, j, moved

    do i = 1, size(notes)
      order(i) = i
      do j = i - 1, 1, -1
        if (notes(i)%line < 1 .or. (notes(order(j))%line > 0 .and. &
          notes(order(j))%line <= notes(i)%line)) exit
        moved = order(j)
        order(j) = order(j + 1)
        order(j + 1) = moved
      end do
    end do
  end function deck_order

  !> All stored messages as JSON objects separated by commas: errors, then warnings, in deck order.
  pure subroutine list_findings(report, findings)
    type(report_t), intent(in) :: report
    character(:), allocatable, intent(out) :: findings

    findings = ''
    call list_notes(report%errors, report%n_kept, report%n_error - report%n_kept, 'error', findings)
    call list_notes(report%warnings, report%n_warning, report%n_dropped, 'warning', findings)
  end subroutine list_findings

  !> Append messages of one severity, and the number of those that are not stored.
  pure subroutine list_notes(notes, n, n_more, severity, findings)
    type(message_t), intent(in), optional :: notes(:) !! absent: none
    integer, intent(in) :: n, n_more
    character(*), intent(in) :: severity
    character(:), allocatable, intent(inout) :: findings
    integer :: order(n), i
    type(finding_t) :: finding

    if (.not. present(notes)) return
    order = deck_order(notes(:n))
    do i = 1, n
      call add_finding(severity, notes(order(i))%finding, findings)
    end do
    if (n_more < 1) return
    finding%message = 'and '//to_text(n_more)//' more '//severity//'s'
    call add_finding(severity, finding, findings)
  end subroutine list_notes

  !> Append a finding as JSON object, with the known parts of its location.
  pure subroutine add_finding(severity, finding, findings)
    character(*), intent(in) :: severity !! error or warning
    type(finding_t), intent(in) :: finding
    character(:), allocatable, intent(inout) :: findings
    character(:), allocatable :: text

    text = '{"severity": "'//severity//'"'
    if (allocated(finding%file)) text = text//', "file": '//json_text(finding%file)
    if (finding%line > 0) text = text//', "line": '//to_text(finding%line) &
      //', "keyword": '//json_text('*'//text_of(finding%keyword))
    if (finding%card > 0) text = text//', "card": '//to_text(finding%card)//', "field": ' &
      //to_text(finding%field)//', "name": '//json_text(trim(finding%name))
    if (finding%first > 0) text = text//', "first_column": '//to_text(finding%first) &
      //', "last_column": '//to_text(finding%last)
    if (allocated(finding%found)) text = text//', "found": '//json_text(finding%found)
    text = text//', "message": '//json_text(finding%message)//'}'
    if (len(findings) > 0) findings = findings//','//new_line('a')
    findings = findings//'    '//text
  end subroutine add_finding

  !> A JSON string with quotes in UTF-8; bytes that are not UTF-8 are interpreted as Latin-1.
  pure function json_text(text) result(quoted)
    character(*), intent(in) :: text
    character(:), allocatable :: quoted
    character(6) :: code
    integer :: i, n

    quoted = '"'
    i = 1
    do while (i <= len(text))
      n = utf8_length(text(i:))
      if (n == 0 .or. iachar(text(i:i)) < 32 .or. text(i:i) == achar(127)) then
        write (code, '(a, z4.4)') achar(92)//'u', iachar(text(i:i))
        quoted = quoted//code
      else if (scan(text(i:i), '"'//achar(92)) > 0) then
        quoted = quoted//achar(92)//text(i:i)
      else
        quoted = quoted//text(i:i + n - 1)
      end if
      i = i + max(n, 1)
    end do
    quoted = quoted//'"'
  end function json_text

end module deck_report_m
