! SPDX-License-Identifier: MIT
!> One text file in DYNA's layout (`<job>.glstat`, `.rcforc` and so on), fed with the rows of a
!> history. The rows of an instant are kept until they are complete.
module dyna_text_m
  use build_info_m, only : version
  use contacts_m, only : n_told
  use dyna_layouts_m, only : put_line, put_head, put_instant
  use errors_m, only : error_t
  use history_tables_m, only : table_rcforc, table_nodout, table_matsum, table_sleout, &
    table_elout, table_secforc
  use kinds_m, only : wp
  use model_m, only : model_t
  use text_files_m, only : line_file_t, open_lines, keep_up, flush_lines
  use text_m, only : text_of
  implicit none
  private
  public :: dyna_text_t, open_dyna_text, add_dyna_row

  !> Bytes of a title in a legend.
  integer, parameter :: title_size = 70

  !> One file.
  type :: dyna_text_t
    integer :: i_table = 0                   !! one of `table_`
    character(:), allocatable :: control     !! what rules the step where no element does
    logical :: scales = .false.              !! masses are scaled
    integer :: n_row = 0                     !! rows of the present instant so far
    real(wp), allocatable :: rows(:, :)      !! (columns, rows of an instant)
    type(line_file_t) :: file                !! rows are taken only while it is open
  end type dyna_text_t

contains

  !> Make the file `<path>` and write its head: title, program and the legend of entities, where
  !> they have titles.
  subroutine open_dyna_text(text, path, i_table, model, scales, n_column, n_row, error)
    type(dyna_text_t), intent(out) :: text
    character(*), intent(in) :: path
    integer, intent(in) :: i_table               !! one of `table_`
    type(model_t), intent(in) :: model
    logical, intent(in) :: scales                !! masses are scaled
    integer, intent(in) :: n_column, n_row       !! of a row; rows of an instant
    type(error_t), allocatable, intent(out) :: error
    logical :: has_legend

    call open_lines(text%file, path, error)
    if (allocated(error)) return
    text%i_table = i_table
    text%control = 'load curve'
    if (model%controls%implicit%is_on) text%control = 'implicit'
    text%scales = scales
    allocate (text%rows(n_column, n_row))
    call put_line(text%file, ' '//text_of(model%controls%title))
    call put_line(text%file, '                         slideline (version '//version//')     ' &
      //trim(merge('axisymmetric, per radian    ', 'plane strain, per unit depth', model%is_round)))
    has_legend = .false.
    call put_legend(text, model, has_legend)
    if (has_legend) call put_line(text%file, '{END LEGEND}')
    if (has_legend) call put_line(text%file, '')
    call put_head(i_table, text%file)
    call flush_lines(text%file, error)
  end subroutine open_dyna_text

  !> Numbers and titles of what the rows are of.
  subroutine put_legend(text, model, has_legend)
    type(dyna_text_t), intent(inout) :: text
    type(model_t), intent(in) :: model
    logical, intent(inout) :: has_legend
    integer :: i

    associate (plan => model%controls%output)
      select case (text%i_table)
      case (table_matsum)
        do i = 1, size(model%parts)
          call put_entity(text, has_legend, model%parts(i)%id, text_of(model%parts(i)%title))
        end do
      case (table_rcforc, table_sleout)
        do i = 1, n_told(model%contacts)
          call put_entity(text, has_legend, model%contacts(i)%id, text_of(model%contacts(i)%title))
        end do
        if (text%i_table == table_sleout .or. .not. allocated(model%transducers)) return
        do i = 1, size(model%transducers)
          call put_entity(text, has_legend, model%transducers(i)%id, &
            text_of(model%transducers(i)%title))
        end do
      case (table_nodout)
        do i = 1, size(plan%history_nodes)
          call put_entity(text, has_legend, model%mesh%node_id(plan%history_nodes(i)), 'node')
        end do
      case (table_secforc)
        do i = 1, size(plan%cross_sections)
          call put_entity(text, has_legend, plan%cross_sections(i)%id, &
            text_of(plan%cross_sections(i)%title))
        end do
      case (table_elout)
        do i = 1, size(plan%history_elements)
          call put_entity(text, has_legend, model%mesh%element_id(plan%history_elements(i)), &
            'shell')
        end do
      end select
    end associate
  end subroutine put_legend

  !> One entity of a legend; the first opens it.
  subroutine put_entity(text, has_legend, id, title)
    type(dyna_text_t), intent(inout) :: text
    logical, intent(inout) :: has_legend
    integer, intent(in) :: id
    character(*), intent(in) :: title
    character(9) :: number

    if (len_trim(title) == 0) return
    if (.not. has_legend) then
      call put_line(text%file, '')
      call put_line(text%file, '{BEGIN LEGEND}')
      call put_line(text%file, ' Entity #        Title')
      has_legend = .true.
    end if
    write (number, '(ss,i9)') id
    call put_line(text%file, number//'     '//title(:min(len(title), title_size)))
  end subroutine put_entity

  !> Take one row of the history; nothing happens to a file that is not open.
  subroutine add_dyna_row(text, values)
    type(dyna_text_t), intent(inout) :: text
    real(wp), intent(in) :: values(:)   !! of all columns of `history_tables`

    if (.not. text%file%is_open) return
    text%n_row = text%n_row + 1
    text%rows(:, text%n_row) = values
    if (text%n_row < size(text%rows, 2)) return
    text%n_row = 0
    call put_instant(text%i_table, text%control, text%scales, text%rows, text%file)
    call keep_up(text%file)
  end subroutine add_dyna_row

end module dyna_text_m
