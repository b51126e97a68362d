! SPDX-License-Identifier: MIT
!> The messages of a deck as JSON (RFC 8259), for editors and scripts.
module deck_findings_m
  use deck_report_m, only : report_t, note_t, spot_t, deck_order
  use log_m, only : to_text
  use text_m, only : text_of, utf8_length
  implicit none
  private
  public :: list_findings, add_finding, json_text

contains

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
    type(note_t), intent(in), optional :: notes(:) !! absent: there are none
    integer, intent(in) :: n, n_more
    character(*), intent(in) :: severity
    character(:), allocatable, intent(inout) :: findings
    integer :: order(n), i
    type(spot_t) :: spot

    if (.not. present(notes)) return
    order = deck_order(notes(:n))
    do i = 1, n
      call add_finding(severity, notes(order(i))%spot, findings)
    end do
    if (n_more < 1) return
    spot%message = 'and '//to_text(n_more)//' more '//severity//'s'
    call add_finding(severity, spot, findings)
  end subroutine list_notes

  !> One more object; what is not known of its place is left out.
  pure subroutine add_finding(severity, spot, findings)
    character(*), intent(in) :: severity !! error or warning
    type(spot_t), intent(in) :: spot
    character(:), allocatable, intent(inout) :: findings
    character(:), allocatable :: text

    text = '{"severity": "'//severity//'"'
    if (allocated(spot%file)) text = text//', "file": '//json_text(spot%file)
    if (spot%line > 0) text = text//', "line": '//to_text(spot%line) &
      //', "keyword": '//json_text('*'//text_of(spot%keyword))
    if (spot%card > 0) text = text//', "card": '//to_text(spot%card)//', "field": ' &
      //to_text(spot%field)//', "name": '//json_text(trim(spot%name))
    if (spot%first > 0) text = text//', "first_column": '//to_text(spot%first) &
      //', "last_column": '//to_text(spot%last)
    if (allocated(spot%found)) text = text//', "found": '//json_text(spot%found)
    text = text//', "message": '//json_text(spot%message)//'}'
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

end module deck_findings_m
