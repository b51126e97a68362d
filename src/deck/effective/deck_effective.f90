! SPDX-License-Identifier: MIT
!> The deck as run: one file, parameters and command line resolved, which read again gives the same
!> model to the last bit. Lines that nothing changed are copied as they were written.
module deck_effective_m
  use deck_lines_m, only : deck_t, layout_marks
  use system_m, only : give_back_memory
  implicit none
  private
  public :: write_effective

contains

  !> The text of the effective deck: its characters are counted, then written. What only messages
  !> need is given up before, the files that it is made of are on the way.
  subroutine write_effective(deck, effective)
    type(deck_t), intent(inout) :: deck
    character(:), allocatable, intent(out) :: effective
    integer :: i, k, line, source, n, last_block(deck%n_source)

    if (allocated(deck%number)) deallocate (deck%number, deck%flags)
    call give_back_memory()
    do i = 1, deck%n_block
      last_block(deck%blocks(i)%source) = i
    end do
    do k = 1, 2
      if (k == 2) allocate (character(n) :: effective)
      n = 0
      call put('$ The deck as run: includes, parameters and command line resolved.')
      do i = 1, deck%parameters%n
        associate (item => deck%parameters%items(i))
          if (item%found) call put('$ parameter '//trim(item%name)//' = '//item%text)
        end associate
      end do
      call put('*KEYWORD')
      do i = 1, deck%n_block
        source = deck%blocks(i)%source
        if (.not. deck%blocks(i)%dropped) then
          call put('*'//deck%blocks(i)%given//trim(layout_marks(deck%blocks(i)%layout)))
          do line = deck%blocks(i)%first, deck%blocks(i)%last
            call put(deck%sources(merge(0, source, deck%first(line) < 0))%text( &
              abs(deck%first(line)):deck%last(line)))
          end do
        end if
        ! The text of a file goes behind its last block.
        if (k == 2 .and. last_block(source) == i) deallocate (deck%sources(source)%text)
      end do
      call put('*END')
    end do

  contains

    !> Append a line.
    subroutine put(text)
      character(*), intent(in) :: text

      if (k == 2) effective(n + 1:n + len(text) + 1) = text//new_line('a')
      n = n + len(text) + 1
    end subroutine put

  end subroutine write_effective

end module deck_effective_m
