! SPDX-License-Identifier: MIT
!> Lists of what a deck defines: as long as its cards may make them before these are read, and of
!> their true length behind.
module deck_raw_lists_m
  use deck_lines_m, only : deck_t
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: reserve_lists, trim_lists

contains

  !> Room for all definitions of the deck: one for each keyword, or for each line where rows repeat.
  subroutine reserve_lists(deck, raw)
    type(deck_t), intent(in) :: deck
    type(raw_t), intent(inout) :: raw
    integer :: n

    allocate (raw%parts(n_line('PART')))
    n = n_line('SECTION_')
    allocate (raw%sections(n), raw%section_line(n))
    n = n_block('MAT_')
    allocate (raw%materials(n), raw%material_line(n), raw%hardenings(n), raw%foams(n), &
      raw%erosions(n))
    n = n_block('EOS_')
    allocate (raw%equations(n), raw%equation_line(n))
    n = n_line('HOURGLASS')
    allocate (raw%hourglasses(n), raw%hourglass_line(n), raw%bulk_given(2, n))
    n = n_block('DEFINE_CURVE')
    allocate (raw%curves(n), raw%curve_line(n))
    allocate (raw%tables(n_block('DEFINE_TABLE')), raw%systems(n_block('DEFINE_COORDINATE')))
    n = n_block('CONTACT_')
    allocate (raw%contacts(n), raw%transducers(n), raw%walls(n_block('RIGIDWALL_')))
    allocate (raw%ends(n_line('TERMINATION_')), raw%cuts(n_line('DATABASE_CROSS_SECTION')))

  contains

    !> Keywords whose names begin so.
    pure function n_block(head) result(n)
      character(*), intent(in) :: head
      integer :: n
      integer :: i

      n = 0
      do i = 1, deck%n_block
        if (index(deck%blocks(i)%name, head) == 1) n = n + 1
      end do
    end function n_block

    !> Data lines of keywords whose names begin so.
    pure function n_line(head) result(n)
      character(*), intent(in) :: head
      integer :: n
      integer :: i

      n = 0
      do i = 1, deck%n_block
        if (index(deck%blocks(i)%name, head) /= 1) cycle
        n = n + max(deck%blocks(i)%last - deck%blocks(i)%first, 0) + 1
      end do
    end function n_line

  end subroutine reserve_lists

  !> Shorten the lists to what they hold.
  subroutine trim_lists(raw)
    type(raw_t), intent(inout) :: raw

    raw%parts = raw%parts(:raw%n_part)
    raw%sections = raw%sections(:raw%n_section)
    raw%section_line = raw%section_line(:raw%n_section)
    raw%materials = raw%materials(:raw%n_material)
    raw%material_line = raw%material_line(:raw%n_material)
    raw%equations = raw%equations(:raw%n_equation)
    raw%equation_line = raw%equation_line(:raw%n_equation)
    raw%erosions = raw%erosions(:raw%n_erosion)
    raw%hardenings = raw%hardenings(:raw%n_hardening)
    raw%foams = raw%foams(:raw%n_foam)
    raw%tables = raw%tables(:raw%n_table)
    raw%hourglasses = raw%hourglasses(:raw%n_hourglass)
    raw%hourglass_line = raw%hourglass_line(:raw%n_hourglass)
    raw%bulk_given = raw%bulk_given(:, :raw%n_hourglass)
    raw%curves = raw%curves(:raw%n_curve)
    raw%curve_line = raw%curve_line(:raw%n_curve)
    raw%contacts = raw%contacts(:raw%n_contact)
    raw%transducers = raw%transducers(:raw%n_transducer)
    raw%walls = raw%walls(:raw%n_wall)
    raw%ends = raw%ends(:raw%n_end)
    raw%systems = raw%systems(:raw%n_system)
    raw%cuts = raw%cuts(:raw%n_cut)
  end subroutine trim_lists

end module deck_raw_lists_m
