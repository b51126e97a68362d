! SPDX-License-Identifier: MIT
!> The histories: one CSV table per quantity, and DYNA's text file beside it where the deck asks for
!> it. A table whose output was not asked for is not made.
module history_file_m
  use contacts_m, only : n_told
  use errors_m, only : error_t
  use model_m, only : model_t
  use controls_m, only : is_asked
  use csv_table_m, only : csv_table_t, plan_table, open_table, visit_rows
  use dyna_text_m, only : open_dyna_text
  use kinds_m, only : wp
  use log_m, only : to_text
  use history_tables_m, only : history_tables, n_table, asked_alone, asked_by_states, each_run, &
    each_contact, each_history_node, each_part, each_wall, each_support, each_history_element, &
    each_body, each_boundary, each_group_node, each_section, text_none, text_rows
  use text_files_m, only : line_file_t, flush_lines, close_lines
  use visitor_m, only : visited_t, visitor_t, length
  implicit none
  private
  public :: histories_t, plan_histories, open_histories, flush_histories, close_histories, has_rows

  !> All tables of a run.
  type, extends(visited_t) :: histories_t
    type(csv_table_t) :: tables(n_table) !! by the `table_` constants
  contains
    procedure :: visit => visit_histories
  end type histories_t

contains

  !> The tables that were asked for and have something to write, without files.
  subroutine plan_histories(histories, model)
    type(histories_t), intent(out) :: histories
    type(model_t), intent(in) :: model
    integer :: k
    logical :: is_wanted, tells_mass

    tells_mass = abs(model%controls%mass_step) > 0.0_wp .and. .not. model%controls%implicit%is_on
    do k = 1, n_table
      is_wanted = has_rows(model, k)
      if (history_tables(k)%asked == asked_alone) is_wanted = is_wanted .and. &
        is_asked(model%controls%output%histories(k))
      if (history_tables(k)%asked == asked_by_states) is_wanted = is_wanted .and. &
        is_asked(model%controls%output%plot)
      if (is_wanted) call plan_table(histories%tables(k), k, tells_mass, model%erodes)
    end do
  end subroutine plan_histories

  !> Plan the tables and make their files, those in DYNA's layout too.
  subroutine open_histories(histories, prefix, model, error)
    type(histories_t), intent(out) :: histories
    character(*), intent(in) :: prefix   !! directory and job name
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: path
    integer :: k, n_row

    call plan_histories(histories, model)
    do k = 1, n_table
      if (.not. allocated(histories%tables(k)%values)) cycle
      call open_table(histories%tables(k), prefix//'.'//trim(history_tables(k)%name)//'.csv', error)
      if (allocated(error)) return
    end do
    do k = 1, n_table
      associate (table => histories%tables(k), interval => model%controls%output%histories(k))
        if (history_tables(k)%text == text_none .or. .not. table%file%is_open) cycle
        if (.not. (interval%is_text .and. is_asked(interval))) cycle
        path = prefix//'.'//trim(history_tables(k)%name)
        n_row = n_each(model, k)
        if (history_tables(k)%text == text_rows) n_row = 1
        call open_dyna_text(table%text, path, k, model, table%tells_mass, &
          size(table%is_kept), n_row, error)
      end associate
      if (allocated(error)) return
    end do
  end subroutine open_histories

  !> Whether a table would have rows.
  pure function has_rows(model, i_table)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_table   !! one of `table_`
    logical :: has_rows

    has_rows = n_each(model, i_table) > 0
  end function has_rows

  !> Number of those that a table tells of.
  pure function n_each(model, i_table) result(n)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_table
    integer :: n, i

    n = 0
    associate (plan => model%controls%output)
      select case (history_tables(i_table)%each)
      case (each_run); n = 1
      case (each_contact); if (allocated(model%contacts)) n = n_told(model%contacts)
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

  !> Bring all rows into the files, or look only whether all that came so far could be written;
  !> reports the first failure of any table.
  subroutine flush_histories(histories, is_asked, error)
    type(histories_t), intent(inout) :: histories
    logical, intent(in) :: is_asked
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: ignored
    integer :: k

    do k = 1, n_table
      associate (table => histories%tables(k))
        if (is_asked) call flush_lines(table%text%file, ignored)
        if (is_asked) call flush_lines(table%file, ignored)
        if (allocated(error)) cycle
        if (allocated(table%text%file%trouble)) error = table%text%file%trouble
        if (allocated(table%file%trouble)) error = table%file%trouble
      end associate
    end do
  end subroutine flush_histories

  !> Bring all rows into the files and close them; the values stay for the results file.
  subroutine close_histories(histories, error)
    type(histories_t), intent(inout) :: histories
    type(error_t), allocatable, intent(out) :: error
    integer :: k

    do k = 1, n_table
      call finish(histories%tables(k)%file)
      call finish(histories%tables(k)%text%file)
    end do

  contains

    !> One file; the first failure stays.
    subroutine finish(file)
      type(line_file_t), intent(inout) :: file
      type(error_t), allocatable :: trouble

      call close_lines(file, trouble)
      if (allocated(trouble) .and. .not. allocated(error)) call move_alloc(trouble, error)
    end subroutine finish

  end subroutine close_histories

  !> Its components. Tables are kept whole: the run that goes on writes them again from the first
  !> row, so that they do not depend on what has become of the files.
  subroutine visit_histories(self, visitor)
    class(histories_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor
    integer :: i

    do i = 1, n_table
      call visit_rows(self%tables(i), to_text(i), visitor)
    end do
  end subroutine visit_histories

end module history_file_m
