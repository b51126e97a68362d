! SPDX-License-Identifier: MIT
!> All that is wrong or strange in a deck, collected while it is read and shown in deck order.
module deck_report_m
  use errors_m, only : error_t, raise, status_input
  use log_m, only : log_t, warn, to_text
  implicit none
  private
  public :: report_t, note_t, spot_t, add_error, has_error, add_warning, is_full, &
    emit_warnings, emit_errors, deck_order

  !> Messages kept of each kind; what comes later is counted.
  integer, parameter :: max_kept = 1000
  !> Errors shown; the rest is counted.
  integer, parameter :: max_shown = 1000

  !> Where a message points to, for programs that read it. Unset: the deck as a whole.
  type :: spot_t
    character(:), allocatable :: message !! without place and card
    character(:), allocatable :: file
    integer :: line = 0                  !! in the file, 0: none
    character(:), allocatable :: keyword !! without asterisk
    integer :: card = 0, field = 0       !! 0: the line as a whole
    character(12) :: name = ''              !! of the field
    integer :: first = 0, last = 0       !! columns of the field; 0 where the line as read is not
                                         !! that of the file
    character(:), allocatable :: found   !! text of the field
  end type spot_t

  !> One message and the deck line that it belongs to.
  type :: note_t
    integer :: line = 0                !! index of the line in the deck, for the order
    character(:), allocatable :: text
    character(:), allocatable :: key   !! what makes a warning the same as another
    type(spot_t) :: spot
  end type note_t

  !> Messages so far.
  type :: report_t
    integer :: n_error = 0
    integer :: n_warning = 0           !! kept
    integer :: n_dropped = 0           !! warnings beyond these, the same ones more than once
    type(note_t), allocatable :: errors(:)
    type(note_t), allocatable :: warnings(:)
  end type report_t

contains

  !> One more error, `line` giving its place in the order.
  subroutine add_error(report, line, text, spot)
    type(report_t), intent(inout) :: report
    integer, intent(in) :: line
    character(*), intent(in) :: text
    type(spot_t), intent(in) :: spot

    if (.not. allocated(report%errors)) allocate (report%errors(max_kept))
    report%n_error = report%n_error + 1
    if (report%n_error > max_kept) return
    report%errors(report%n_error)%line = line
    report%errors(report%n_error)%text = text
    report%errors(report%n_error)%spot = spot
  end subroutine add_error

  !> Whether an error of this text, which belongs to no line, is kept.
  pure function has_error(report, text) result(found)
    type(report_t), intent(in) :: report
    character(*), intent(in) :: text
    logical :: found
    integer :: i

    found = .false.
    do i = 1, min(report%n_error, max_kept)
      if (report%errors(i)%line > 0) cycle
      found = report%errors(i)%text == text
      if (found) return
    end do
  end function has_error

  !> Whether further errors are only counted, so that their text need not be made.
  pure function is_full(report) result(full)
    type(report_t), intent(in) :: report
    logical :: full

    full = report%n_error >= max_kept
  end function is_full

  !> One more warning; warnings of the same key are given once.
  subroutine add_warning(report, line, key, text, spot)
    type(report_t), intent(inout) :: report
    integer, intent(in) :: line
    character(*), intent(in) :: key
    character(*), intent(in) :: text
    type(spot_t), intent(in) :: spot

    if (.not. allocated(report%warnings)) allocate (report%warnings(max_kept))
    if (has_warning(report, key)) return
    if (report%n_warning == max_kept) then
      report%n_dropped = report%n_dropped + 1
      return
    end if
    report%n_warning = report%n_warning + 1
    report%warnings(report%n_warning)%line = line
    report%warnings(report%n_warning)%key = key
    report%warnings(report%n_warning)%text = text
    report%warnings(report%n_warning)%spot = spot
  end subroutine add_warning

  !> Whether a warning of this key has been given.
  pure function has_warning(report, key) result(found)
    type(report_t), intent(in) :: report
    character(*), intent(in) :: key
    logical :: found
    integer :: i

    found = .false.
    do i = report%n_warning, 1, -1
      found = report%warnings(i)%key == key
      if (found) return
    end do
  end function has_warning

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
    integer :: i

    if (report%n_error == 0) return
    order = deck_order(report%errors(:min(report%n_error, max_kept)))
    text = ''
    do i = 1, min(size(order), max_shown)
      text = text//report%errors(order(i))%text//new_line('a')
    end do
    if (report%n_error > max_shown) text = text//path//': and ' &
      //to_text(report%n_error - max_shown)//' more errors'//new_line('a')
    text = text//path//': refused, '//to_text(report%n_error)
    text = text//merge(' error ', ' errors', report%n_error == 1)
    call raise(error, trim(text), status_input)
  end subroutine emit_errors

  !> Order of the notes by line, equal lines as they came, those of no line (0) last.
  pure function deck_order(notes) result(order)
    type(note_t), intent(in) :: notes(:)
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

end module deck_report_m
