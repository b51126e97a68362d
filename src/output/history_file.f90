! SPDX-License-Identifier: MIT
!> Histories: one CSV table per quantity (comma-separated, no blanks, reals as the shortest decimals
!> that read back to the same numbers), and a text file in DYNA's layout where the deck asks for it
!> (`<job>.glstat`, `.rcforc` and so on). Tables that were not asked for are not written. All values
!> are stored for the results file.
module history_file_m
  use build_info_m, only : version
  use controls_m, only : is_asked
  use dyna_layouts_m, only : put_line, put_head, put_instant
  use errors_m, only : error_t
  use history_tables_m, only : history_tables, n_table, table_rcforc, table_nodout, table_matsum, &
    table_sleout, table_elout, table_secforc, asked_alone, asked_by_states, each_run, &
    each_contact, each_history_node, each_part, each_wall, each_support, each_history_element, &
    each_body, each_boundary, each_group_node, each_section, text_none, text_rows
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use text_files_m, only : line_file_t, open_lines, put_lines, flush_due, flush_lines, close_lines
  use text_m, only : text_of, real_size, put_real, put_integer
  use visitor_m, only : visited_t, visitor_t, any_length, length
  implicit none
  private
  public :: history_t, histories_t, plan_table, plan_histories, open_table, open_histories, &
    add_row, row_text, flush_histories, close_histories, n_each, kind_real, kind_integer, kind_side

  !> Kinds of columns: a real, an integer, a side of an interface (1 = slave, 2 = master).
  integer, parameter :: kind_real = 1, kind_integer = 2, kind_side = 3
  !> Bytes of a title in a legend.
  integer, parameter :: title_size = 70

  !> One table.
  type :: history_t
    integer :: i_table = 0                  !! one of `table_`
    logical :: has_mass_scaling = .false.   !! masses are scaled
    logical, allocatable :: is_kept(:)      !! (columns of `history_tables`) columns of this run
    character(20), allocatable :: names(:)  !! (n_column)
    integer, allocatable :: kinds(:)        !! (n_column) `kind_` of each
    integer :: n_csv = 0                    !! columns of the CSV file, the first ones
    integer :: n_row = 0                    !! rows so far
    real(wp), allocatable :: values(:, :)   !! (n_column, capacity) all rows; integers are exact
    type(line_file_t) :: file               !! rows are added while it is open
    type(line_file_t) :: text               !! file in DYNA's layout, where the deck asks for it
    character(:), allocatable :: control    !! for it: what determines the step where no element
                                            !! does
    integer :: n_waiting = 0                !! rows of the present instant, held until it is
                                            !! complete
    real(wp), allocatable :: waiting(:, :)  !! (columns of `history_tables`, rows of an instant)
  end type history_t

  !> All tables of a run.
  type, extends(visited_t) :: histories_t
    type(history_t) :: tables(n_table)      !! by the `table_` constants
  contains
    procedure :: visit => visit_histories
  end type histories_t

contains

  !> Plan the tables that were asked for and have rows, without files.
  subroutine plan_histories(histories, model)
    type(histories_t), intent(out) :: histories
    type(model_t), intent(in) :: model
    integer :: k
    logical :: is_wanted, has_mass_scaling

    has_mass_scaling = abs(model%controls%mass_step) > 0.0_wp .and. &
      .not. model%controls%implicit%is_on
    do k = 1, n_table
      is_wanted = n_each(model, k) > 0
      if (history_tables(k)%asked == asked_alone) is_wanted = is_wanted .and. &
        is_asked(model%controls%output%histories(k))
      if (history_tables(k)%asked == asked_by_states) is_wanted = is_wanted .and. &
        is_asked(model%controls%output%plot)
      if (is_wanted) call plan_table(histories%tables(k), k, has_mass_scaling, model%erodes)
    end do
  end subroutine plan_histories

  !> Columns of a table, without rows or file.
  subroutine plan_table(table, i_table, has_mass_scaling, erodes)
    type(history_t), intent(out) :: table
    integer, intent(in) :: i_table    !! one of `table_`
    logical, intent(in) :: has_mass_scaling !! masses are scaled
    logical, intent(in) :: erodes     !! elements may leave the mesh
    character(len(history_tables%columns) + 1) :: left
    integer :: i, n, last
    logical :: is_beside

    left = trim(history_tables(i_table)%columns)//','
    table%i_table = i_table
    table%has_mass_scaling = has_mass_scaling
    n = count([(scan(left(i:i), ',;') == 1, i=1, len(left))])
    allocate (table%is_kept(n), table%names(n), table%kinds(n))
    is_beside = .false.
    do i = 1, n
      last = scan(left, ',;') - 1
      table%is_kept(i) = (has_mass_scaling .or. left(1:1) /= '+') .and. (erodes .or. left(1:1) &
        /= '-')
      if (table%is_kept(i) .and. .not. is_beside) table%n_csv = table%n_csv + 1
      table%kinds(i) = kind_real
      if (index(left(:last), '#') > 0) table%kinds(i) = kind_integer
      if (index(left(:last), '@') > 0) table%kinds(i) = kind_side
      table%names(i) = left(verify(left, '+-#@'):last)
      is_beside = is_beside .or. left(last + 1:last + 1) == ';'
      left = left(last + 2:)
    end do
    table%names = pack(table%names, table%is_kept)
    table%kinds = pack(table%kinds, table%is_kept)
    allocate (table%values(size(table%kinds), 64))
  end subroutine plan_table

  !> Plan the tables and create their files, also those in DYNA's layout.
  subroutine open_histories(histories, prefix, model, error)
    type(histories_t), intent(out) :: histories
    character(*), intent(in) :: prefix   !! directory and job name
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    integer :: k

    call plan_histories(histories, model)
    do k = 1, n_table
      if (allocated(error) .or. .not. allocated(histories%tables(k)%values)) cycle
      call open_table(histories%tables(k), prefix//'.'//trim(history_tables(k)%name)//'.csv', error)
    end do
    do k = 1, n_table
      associate (table => histories%tables(k), interval => model%controls%output%histories(k))
        if (allocated(error) .or. history_tables(k)%text == text_none) cycle
        if (table%file%is_open .and. interval%is_text .and. is_asked(interval)) &
          call open_text(table, prefix//'.'//trim(history_tables(k)%name), model, error)
      end associate
    end do
  end subroutine open_histories

  !> Create the CSV file of a planned table and write its header.
  subroutine open_table(table, path, error)
    type(history_t), intent(inout) :: table
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: header
    integer :: i

    header = trim(table%names(1))
    do i = 2, table%n_csv
      header = header//','//trim(table%names(i))
    end do
    call open_lines(table%file, path, error)
    if (allocated(error)) return
    call put_lines(table%file, header//new_line('a'))
    call flush_lines(table%file, error)
  end subroutine open_table

  !> Create the file in DYNA's layout and write its head: title, program and the legend of entities
  !> with titles.
  subroutine open_text(table, path, model, error)
    type(history_t), intent(inout) :: table
    character(*), intent(in) :: path
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    integer :: n_row

    call open_lines(table%text, path, error)
    if (allocated(error)) return
    table%control = 'load curve'
    if (model%controls%implicit%is_on) table%control = 'implicit'
    n_row = n_each(model, table%i_table)
    if (history_tables(table%i_table)%text == text_rows) n_row = 1
    allocate (table%waiting(size(table%is_kept), n_row))
    call put_line(table%text, ' '//text_of(model%controls%title))
    call put_line(table%text, '                         slideline (version '//version//')     ' &
      //trim(merge('axisymmetric, per radian    ', 'plane strain, per unit depth', &
      model%is_axisymmetric)))
    call put_legend(table, model)
    call put_head(table%i_table, table%text)
    call flush_lines(table%text, error)
  end subroutine open_text

  !> Write ids and titles of the entities of the rows, if there are titles.
  subroutine put_legend(table, model)
    type(history_t), intent(inout) :: table
    type(model_t), intent(in) :: model
    logical :: has_legend
    integer :: i

    has_legend = .false.
    associate (plan => model%controls%output)
      select case (table%i_table)
      case (table_matsum)
        do i = 1, size(model%parts)
          call put_entity(model%parts(i)%id, text_of(model%parts(i)%title))
        end do
      case (table_rcforc, table_sleout)
        do i = 1, size(model%contacts)
          call put_entity(model%contacts(i)%id, text_of(model%contacts(i)%title))
        end do
        if (table%i_table == table_rcforc .and. allocated(model%transducers)) then
          do i = 1, size(model%transducers)
            call put_entity(model%transducers(i)%id, text_of(model%transducers(i)%title))
          end do
        end if
      case (table_nodout)
        do i = 1, size(plan%history_nodes)
          call put_entity(model%mesh%node_id(plan%history_nodes(i)), 'node')
        end do
      case (table_secforc)
        do i = 1, size(plan%cross_sections)
          call put_entity(plan%cross_sections(i)%id, text_of(plan%cross_sections(i)%title))
        end do
      case (table_elout)
        do i = 1, size(plan%history_elements)
          call put_entity(model%mesh%element_id(plan%history_elements(i)), 'shell')
        end do
      end select
    end associate
    if (has_legend) call put_line(table%text, '{END LEGEND}'//new_line('a'))

  contains

    !> Write one entity; the first one opens the legend.
    subroutine put_entity(id, title)
      integer, intent(in) :: id
      character(*), intent(in) :: title
      character(9) :: number

      if (len_trim(title) == 0) return
      if (.not. has_legend) call put_line(table%text, new_line('a')//'{BEGIN LEGEND}' &
        //new_line('a')//' Entity #        Title')
      has_legend = .true.
      write (number, '(ss,i9)') id
      call put_line(table%text, number//'     '//title(:min(len(title), title_size)))
    end subroutine put_entity

  end subroutine put_legend

  !> Number of entities that a table has rows for.
  pure function n_each(model, i_table) result(n)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_table
    integer :: n, i

    n = 0
    associate (plan => model%controls%output)
      select case (history_tables(i_table)%each)
      case (each_run); n = 1
      case (each_contact); if (allocated(model%contacts)) n = size(model%contacts)
      case (each_history_node); n = length(plan%history_nodes)
      case (each_part); n = length(model%parts)
      case (each_wall); n = length(model%walls)
      case (each_support); n = model%conditions%n_support
      case (each_history_element); n = length(plan%history_elements)
      case (each_body); n = length(model%rigids)
      case (each_boundary); n = length(plan%boundaries%where)
      case (each_group_node)
        if (allocated(plan%force_groups)) &
          n = sum([(size(plan%force_groups(i)%nodes), i=1, size(plan%force_groups))])
      case (each_section); n = length(plan%cross_sections)
      end select
    end associate
  end function n_each

  !> Add one row to a table, if it is open.
  subroutine add_row(table, values)
    type(history_t), intent(inout) :: table
    real(wp), intent(in) :: values(:)   !! of all columns of `history_tables`
    real(wp), allocatable :: larger(:, :)

    if (.not. table%file%is_open) return
    if (table%n_row == size(table%values, 2)) then
      allocate (larger(size(table%values, 1), 2*table%n_row))
      larger(:, :table%n_row) = table%values
      call move_alloc(larger, table%values)
    end if
    table%n_row = table%n_row + 1
    table%values(:, table%n_row) = pack(values, table%is_kept)
    call put_lines(table%file, row_text(table%values(:table%n_csv, table%n_row), table%kinds))
    call flush_due(table%file)
    if (.not. table%text%is_open) return
    table%n_waiting = table%n_waiting + 1
    table%waiting(:, table%n_waiting) = values
    if (table%n_waiting < size(table%waiting, 2)) return
    table%n_waiting = 0
    call put_instant(table%i_table, table%control, table%has_mass_scaling, table%waiting, &
      table%text)
    call flush_due(table%text)
  end subroutine add_row

  !> One row as text, with its line end.
  pure function row_text(values, kinds) result(text)
    real(wp), intent(in) :: values(:)
    integer, intent(in) :: kinds(:)   !! `kind_` of each value
    character(:), allocatable :: text
    character((real_size + 1)*size(values)) :: buffer
    character(real_size) :: word
    integer :: i, n, length

    n = 0
    do i = 1, size(values)
      select case (kinds(i))
      case (kind_integer)
        call put_integer(nint(values(i)), word, length)
      case (kind_side)
        word = merge('slave ', 'master', nint(values(i)) == 1)
        length = len_trim(word)
      case default
        call put_real(values(i), word, length)
      end select
      buffer(n + 1:n + length + 1) = word(:length)//','
      n = n + length + 1
    end do
    text = buffer(:n - 1)//new_line('a')
  end function row_text

  !> Write all rows to the files, or only check that all rows so far could be written; returns the
  !> first failure of any table.
  subroutine flush_histories(histories, is_asked, error)
    type(histories_t), intent(inout) :: histories
    logical, intent(in) :: is_asked
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: ignored
    integer :: k

    do k = 1, n_table
      associate (table => histories%tables(k))
        if (is_asked) call flush_lines(table%text, ignored)
        if (is_asked) call flush_lines(table%file, ignored)
        if (allocated(error)) cycle
        if (allocated(table%text%first_error)) error = table%text%first_error
        if (allocated(table%file%first_error)) error = table%file%first_error
      end associate
    end do
  end subroutine flush_histories

  !> Write all rows and close the files; the values stay for the results file.
  subroutine close_histories(histories, error)
    type(histories_t), intent(inout) :: histories
    type(error_t), allocatable, intent(out) :: error
    integer :: k

    do k = 1, n_table
      call finish(histories%tables(k)%file)
      call finish(histories%tables(k)%text)
    end do

  contains

    !> Close one file; the first failure stays.
    subroutine finish(file)
      type(line_file_t), intent(inout) :: file
      type(error_t), allocatable :: first_error

      call close_lines(file, first_error)
      if (allocated(first_error) .and. .not. allocated(error)) call move_alloc(first_error, error)
    end subroutine finish

  end subroutine close_histories

  !> Visit the tables. They are stored whole: a restarted run writes them again from the first row,
  !> whatever happened to the files; tables that it no longer writes are skipped. A null array is no
  !> error: a restart may ask for tables that the first run did not write.
  subroutine visit_histories(self, visitor)
    class(histories_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor
    real(wp), allocatable :: rows(:, :)
    integer :: k, i

    do k = 1, n_table
      associate (table => self%tables(k))
        if (allocated(rows)) deallocate (rows)
        if (allocated(table%values)) rows = table%values(:, :table%n_row)
        call visitor%visit(to_text(k), rows, any_length)
        if (.not. visitor%validates .or. .not. allocated(rows)) cycle
        do i = 1, size(rows, 2)
          if (table%file%is_open) call add_row(table, unpack(rows(:, i), table%is_kept, 0.0_wp))
        end do
      end associate
    end do
  end subroutine visit_histories

end module history_file_m
