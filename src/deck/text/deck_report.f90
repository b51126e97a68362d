! SPDX-License-Identifier: MIT
!> All that is wrong or strange in a deck, collected while it is read and shown in deck order. The
!> same mistake many times is one message with a count: errors of one field whose messages differ in
!> numbers alone are of one kind. Programs get the messages as JSON (RFC 8259).
module deck_report_m
  use errors_m, only : error_t, raise, status_input
  use log_m, only : log_t, warn, to_text
  use text_m, only : text_of, utf8_length
  implicit none
  private
  public :: report_t, finding_t, add_error, count_only, add_warning, &
    emit_warnings, emit_errors, list_findings, add_finding, json_text

  !> Errors kept, and warnings; what comes later is counted. Of a kind of errors that comes later
  !> the first ones are kept too, so that none goes untold.
  integer, parameter :: max_kept = 1000, first_kept = 3
  !> Kinds of errors that are told apart.
  integer, parameter :: max_kinds = 200
  !> Errors of a kind that are shown one by one; more are one message with their count.
  integer, parameter :: max_listed = 10

  !> Where a message points to, for programs that read it. Unset: the deck as a whole.
  type :: finding_t
    character(:), allocatable :: message !! without place and card
    character(:), allocatable :: file
    integer :: line = 0                  !! in the file, 0: none
    character(:), allocatable :: keyword !! without asterisk
    integer :: card = 0, field = 0       !! 0: the line as a whole
    character(12) :: name = ''              !! of the field
    integer :: first = 0, last = 0       !! columns of the field; 0 where the line as read is not
                                         !! that of the file
    character(:), allocatable :: found   !! text of the field
  end type finding_t

  !> One message and the deck line that it belongs to.
  type :: message_t
    integer :: line = 0                !! index of the line in the deck, for the order
    character(:), allocatable :: text
    character(:), allocatable :: key   !! what makes a warning the same as another
    integer :: kind = 0                !! of an error, 0: of none that is told apart
    type(finding_t) :: finding
  end type message_t

  !> One kind of errors.
  type :: kind_t
    character(:), allocatable :: key   !! keyword, field and message, numbers apart
    integer :: n = 0                   !! errors
    integer :: n_kept = 0              !! of these with their message
  end type kind_t

  !> Messages so far.
  type :: report_t
    integer :: n_error = 0
    integer :: n_kept = 0              !! errors with their message
    integer :: n_kind = 0
    type(kind_t), allocatable :: kinds(:)
    integer :: n_warning = 0           !! kept
    integer :: n_dropped = 0           !! warnings beyond these, the same ones more than once
    type(message_t), allocatable :: errors(:)
    type(message_t), allocatable :: warnings(:)
  end type report_t

contains

  !> One more error, `line` giving its place in the order; the same one of the deck as a whole (line
  !> 0) is told once.
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
      call find_kind(report, key_of(finding%keyword, finding%name, finding%message), k)
    else
      call find_kind(report, key_of('', '', text), k)
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

  !> Count an error whose message need not be made, since enough of its kind are kept; false in
  !> `is_done` where it has to be added.
  subroutine count_only(report, keyword, name, message, is_done)
    type(report_t), intent(inout) :: report
    character(*), intent(in) :: keyword, name, message
    logical, intent(out) :: is_done
    integer :: k

    is_done = report%n_kept >= max_kept
    if (.not. is_done) return
    call find_kind(report, key_of(keyword, name, message), k)
    if (k > 0) is_done = report%kinds(k)%n >= first_kept
    if (.not. is_done) return
    report%n_error = report%n_error + 1
    if (k > 0) report%kinds(k)%n = report%kinds(k)%n + 1
  end subroutine count_only

  !> The kind of a key, a new one where there is room; 0: none.
  subroutine find_kind(report, key, k)
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
  end subroutine find_kind

  !> What errors of one kind share: keyword, field and message, a # for each whole number in field
  !> and message (the members of a set have numbered fields).
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

  !> One more warning; warnings of the same key are given once.
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

  !> Give all warnings to the log in deck order.
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

  !> One error that holds all messages in deck order; nothing when there are none.
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
      ! So many, or some of them without their text: one message.
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

  !> The line with the count of a kind and its first places.
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

  !> Order of the notes by line, equal lines as they came, those of no line (0) last.
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

  !> All messages kept by the report as JSON objects with commas between them, errors first, each
  !> kind in deck order; empty when there are none.
  pure subroutine list_findings(report, findings)
    type(report_t), intent(in) :: report
    character(:), allocatable, intent(out) :: findings

    findings = ''
    call list_notes(report%errors, report%n_kept, report%n_error - report%n_kept, 'error', findings)
    call list_notes(report%warnings, report%n_warning, report%n_dropped, 'warning', findings)
  end subroutine list_findings

  !> Messages of one kind, and how many there are beyond those that are kept.
  pure subroutine list_notes(notes, n, n_more, severity, findings)
    type(message_t), intent(in), optional :: notes(:) !! absent: there are none
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

  !> One more object; what is not known of its place is left out.
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

  !> A JSON string with its quotes, always UTF-8: characters of UTF-8 pass, and a byte that belongs
  !> to none is taken for Latin-1, whose codes are the first of Unicode.
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
