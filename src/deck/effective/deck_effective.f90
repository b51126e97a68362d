! SPDX-License-Identifier: MIT
!> The deck as run: one file, parameters and command line resolved, which read again gives the same
!> model to the last bit. Lines that nothing changed are copied as they were written.
module deck_effective_m
  use deck_lines_m, only : deck_t, layout_marks
  use system_m, only : give_back_memory
  implicit none
  private
  public :: forget_places, write_effective

  !> A text that is first counted, then written.
  type :: buffer_t
    character(:), allocatable :: text
    integer :: n = 0                   !! characters so far
  end type buffer_t

contains

  !> Give up what only messages need, before a second text of the deck takes room.
  subroutine forget_places(deck)
    type(deck_t), intent(inout) :: deck

    if (allocated(deck%number)) deallocate (deck%number)
    if (allocated(deck%flags)) deallocate (deck%flags)
    call give_back_memory()
  end subroutine forget_places

  !> The text of the effective deck. The files that it is made of are given up on the way.
  subroutine write_effective(deck, effective)
    type(deck_t), intent(inout) :: deck
    character(:), allocatable, intent(out) :: effective
    type(buffer_t) :: buffer

    call compose(deck, buffer)
    allocate (character(buffer%n) :: buffer%text)
    buffer%n = 0
    call compose(deck, buffer)
    call move_alloc(buffer%text, effective)
  end subroutine write_effective

  !> Put the deck together; only counted while the buffer has no text.
  subroutine compose(deck, buffer)
    type(deck_t), intent(inout) :: deck !! loses its text when it is written
    type(buffer_t), intent(inout) :: buffer
    integer :: i, line, source, last_block(deck%n_source)

    do i = 1, deck%n_block
      last_block(deck%blocks(i)%source) = i
    end do
    call put(buffer, '$ The deck as run: includes, parameters and command line resolved.')
    do i = 1, deck%parameters%n
      associate (item => deck%parameters%items(i))
        if (item%found) call put(buffer, '$ parameter '//trim(item%name)//' = '//item%text)
      end associate
    end do
    call put(buffer, '*KEYWORD')
    do i = 1, deck%n_block
      if (i > 1 .and. allocated(buffer%text)) then
        ! The text of a file goes behind its last block.
        associate (last => deck%blocks(i - 1)%source)
          if (last_block(last) == i - 1) deallocate (deck%sources(last)%text)
        end associate
      end if
      if (deck%blocks(i)%dropped) cycle
      call put(buffer, '*'//deck%blocks(i)%given//trim(layout_marks(deck%blocks(i)%layout)))
      source = deck%blocks(i)%source
      do line = deck%blocks(i)%first, deck%blocks(i)%last
        if (deck%first(line) < 0) then
          call put(buffer, deck%patch(-deck%first(line):deck%last(line)))
        else
          call put(buffer, deck%sources(source)%text(deck%first(line):deck%last(line)))
        end if
      end do
    end do
    call put(buffer, '*END')
  end subroutine compose

  !> Append a line.
  subroutine put(buffer, line)
    type(buffer_t), intent(inout) :: buffer
    character(*), intent(in) :: line

    call put_text(buffer, line)
    call put_text(buffer, new_line('a'))
  end subroutine put

  !> Append characters.
  subroutine put_text(buffer, text)
    type(buffer_t), intent(inout) :: buffer
    character(*), intent(in) :: text

    if (allocated(buffer%text)) buffer%text(buffer%n + 1:buffer%n + len(text)) = text
    buffer%n = buffer%n + len(text)
  end subroutine put_text

end module deck_effective_m
