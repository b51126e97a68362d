! SPDX-License-Identifier: MIT
!> One text file in DYNA's layout (`<job>.glstat`, `.rcforc` and so on), fed with the rows of a
!> history table. The rows of an instant are kept until they are complete; their lines wait in a
!> buffer of whole lines and reach the file like those of the table.
module dyna_text_m
  use contacts_m, only : n_told
  use build_info_m, only : version
  use dyna_layouts_m, only : columns_of, n_line_of, form_block
  use dyna_lines_m, only : line_size
  use errors_m, only : error_t
  use history_tables_m, only : table_rcforc, table_nodout, table_matsum, table_rwforc, &
    table_sleout, table_spcforc, table_elout, table_secforc
  use text_files_m, only : text_file_t, create_text_file, append_text, close_text_file
  use kinds_m, only : wp, long
  use model_m, only : model_t
  use text_m, only : text_of
  implicit none
  private
  public :: dyna_text_t, open_dyna_text, add_dyna_row, flush_dyna_text, close_dyna_text

  !> Bytes of the buffer of lines.
  integer, parameter :: buffer_size = 65536
  !> Bytes of a title in a legend.
  integer, parameter :: title_size = 70

  !> One file.
  type :: dyna_text_t
    logical :: is_open = .false.             !! rows are taken only while open
    integer :: i_table = 0                   !! one of `table_`
    integer, allocatable :: columns(:)       !! those of the table that the layout takes
    character(:), allocatable :: control     !! what rules the step where no element does
    logical :: scales = .false.              !! masses are scaled
    integer :: n_row = 0                     !! rows of the present instant so far
    real(wp), allocatable :: rows(:, :)      !! (columns, rows of an instant)
    character(line_size), allocatable :: lines(:) !! of one instant
    type(text_file_t) :: file
    character(:), allocatable :: buffer      !! lines that wait
    integer :: n_waiting = 0                 !! bytes of them
    integer(long) :: flushed = 0             !! clock tick of the last write
    type(error_t), allocatable :: trouble    !! first failure; reported by the next flush or close
  end type dyna_text_t

contains

  !> Make the file `<path>` and write its head.
  subroutine open_dyna_text(text, path, i_table, model, names, n_row, error)
    type(dyna_text_t), intent(out) :: text
    character(*), intent(in) :: path
    integer, intent(in) :: i_table               !! one of `table_`
    type(model_t), intent(in) :: model
    character(*), intent(in) :: names            !! of the table's columns, with commas between
    integer, intent(in) :: n_row                 !! rows of an instant
    type(error_t), allocatable, intent(out) :: error

    call create_text_file(text%file, path, error)
    if (allocated(error)) return
    text%i_table = i_table
    call find_columns(columns_of(i_table), names, text%columns)
    text%control = 'load curve'
    if (model%controls%implicit%is_on) text%control = 'implicit'
    text%scales = index(','//names//',', ',by_dt2ms,') > 0
    allocate (text%rows(size(text%columns), n_row))
    allocate (text%lines(n_line_of(i_table, n_row)))
    allocate (character(buffer_size) :: text%buffer)
    text%is_open = .true.
    call system_clock(text%flushed)
    call write_head(text, model)
    select case (i_table)
    case (table_spcforc)
      call put_line(text, ' single point constraint forces')
      call put_line(text, '')
    case (table_rwforc)
      call put_line(text, '')
      call put_line(text, '')
      call put_line(text, '    time       wall#   normal-force    x-force        y-force        ' &
        //'z-force')
    case (table_secforc)
      call put_line(text, ' line#1   section#     time      x-force      y-force      z-force    ' &
        //'magnitude')
      call put_line(text, ' line#2   resultant moments     x-moment     y-moment     z-moment    ' &
        //'magnitude')
      call put_line(text, ' line#3   centroids                    x            y            z    ' &
        //'     area')
      call put_line(text, '')
    end select
    call flush_dyna_text(text, error)
  end subroutine open_dyna_text

  !> Places of names in a list, both with commas between; 0 of one that is not there.
  pure subroutine find_columns(wanted, names, columns)
    character(*), intent(in) :: wanted, names
    integer, allocatable, intent(out) :: columns(:)
    character(:), allocatable :: left
    integer :: k, comma, place

    allocate (columns(n_comma(wanted) + 1))
    left = wanted//','
    do k = 1, size(columns)
      comma = index(left, ',')
      place = index(','//names//',', ','//left(:comma))
      columns(k) = merge(n_comma(names(:place - 1)) + 1, 0, place > 0)
      left = left(comma + 1:)
    end do
  end subroutine find_columns

  !> Number of commas in a text.
  pure function n_comma(text) result(n)
    character(*), intent(in) :: text
    integer :: n, i

    n = count([(text(i:i) == ',', i=1, len(text))])
  end function n_comma

  !> Title, program and the legend of entities, where they have titles.
  subroutine write_head(text, model)
    type(dyna_text_t), intent(inout) :: text
    type(model_t), intent(in) :: model
    logical :: has_legend
    integer :: i

    call put_line(text, ' '//text_of(model%controls%title))
    call put_line(text, '                         slideline (version '//version &
      //')     '//trim(merge('axisymmetric, per radian    ', 'plane strain, per unit depth', &
      model%is_round)))
    has_legend = .false.
    select case (text%i_table)
    case (table_matsum)
      do i = 1, size(model%parts)
        call put_entity(text, has_legend, model%parts(i)%id, text_of(model%parts(i)%title))
      end do
    case (table_rcforc, table_sleout)
      do i = 1, n_told(model%contacts)
        call put_entity(text, has_legend, model%contacts(i)%id, text_of(model%contacts(i)%title))
      end do
      if (text%i_table == table_rcforc .and. allocated(model%transducers)) then
        do i = 1, size(model%transducers)
          call put_entity(text, has_legend, model%transducers(i)%id, &
            text_of(model%transducers(i)%title))
        end do
      end if
    case (table_nodout)
      do i = 1, size(model%controls%output%history_nodes)
        call put_entity(text, has_legend, &
          model%mesh%node_id(model%controls%output%history_nodes(i)), 'node')
      end do
    case (table_secforc)
      associate (sections => model%controls%output%cross_sections)
        do i = 1, size(sections)
          call put_entity(text, has_legend, sections(i)%id, text_of(sections(i)%title))
        end do
      end associate
    case (table_elout)
      do i = 1, size(model%controls%output%history_elements)
        call put_entity(text, has_legend, &
          model%mesh%element_id(model%controls%output%history_elements(i)), 'shell')
      end do
    end select
    if (.not. has_legend) return
    call put_line(text, '{END LEGEND}')
    call put_line(text, '')
  end subroutine write_head

  !> One entity of a legend; the first opens it.
  subroutine put_entity(text, has_legend, id, title)
    type(dyna_text_t), intent(inout) :: text
    logical, intent(inout) :: has_legend
    integer, intent(in) :: id
    character(*), intent(in) :: title
    character(9) :: number

    if (len_trim(title) == 0) return
    if (.not. has_legend) then
      call put_line(text, '')
      call put_line(text, '{BEGIN LEGEND}')
      call put_line(text, ' Entity #        Title')
      has_legend = .true.
    end if
    write (number, '(ss,i9)') id
    call put_line(text, number//'     '//title(:min(len(title), title_size)))
  end subroutine put_entity

  !> Take one row of the table; nothing happens to a file that is not open.
  subroutine add_dyna_row(text, values)
    type(dyna_text_t), intent(inout) :: text
    real(wp), intent(in) :: values(:)   !! (n_column) of the table
    integer(long) :: now, rate
    integer :: i, n_line

    if (.not. text%is_open) return
    text%n_row = text%n_row + 1
    do i = 1, size(text%columns)
      text%rows(i, text%n_row) = 0.0_wp
      if (text%columns(i) > 0) text%rows(i, text%n_row) = values(text%columns(i))
    end do
    if (text%n_row < size(text%rows, 2)) return
    text%n_row = 0
    call form_block(text%i_table, text%control, text%scales, text%rows, text%lines, n_line)
    do i = 1, n_line
      call put_line(text, trim(text%lines(i)))
    end do
    call system_clock(now, rate)
    if (now - text%flushed > rate) call write_waiting(text)
  end subroutine add_dyna_row

  !> One line into the buffer.
  subroutine put_line(text, line)
    type(dyna_text_t), intent(inout) :: text
    character(*), intent(in) :: line

    if (text%n_waiting + len(line) + 1 > buffer_size) call write_waiting(text)
    text%buffer(text%n_waiting + 1:text%n_waiting + len(line) + 1) = line//new_line('a')
    text%n_waiting = text%n_waiting + len(line) + 1
  end subroutine put_line

  !> Write the waiting lines. The first failure is remembered and ends the writing.
  subroutine write_waiting(text)
    type(dyna_text_t), intent(inout) :: text
    type(error_t), allocatable :: error

    if (text%n_waiting > 0 .and. .not. allocated(text%trouble)) then
      call append_text(text%file, text%buffer(:text%n_waiting), error)
      if (allocated(error)) call move_alloc(error, text%trouble)
    end if
    text%n_waiting = 0
    call system_clock(text%flushed)
  end subroutine write_waiting

  !> Bring all complete instants into the file.
  subroutine flush_dyna_text(text, error)
    type(dyna_text_t), intent(inout) :: text
    type(error_t), allocatable, intent(out) :: error

    if (.not. text%is_open) return
    call write_waiting(text)
    if (allocated(text%trouble)) error = text%trouble
  end subroutine flush_dyna_text

  !> Bring all complete instants into the file and close it.
  subroutine close_dyna_text(text, error)
    type(dyna_text_t), intent(inout) :: text
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: closing

    if (.not. text%is_open) return
    call flush_dyna_text(text, error)
    call close_text_file(text%file, closing)
    text%is_open = .false.
    if (allocated(closing) .and. .not. allocated(error)) call move_alloc(closing, error)
  end subroutine close_dyna_text

end module dyna_text_m
