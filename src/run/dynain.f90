! SPDX-License-Identifier: MIT
!> The file for a next stage, <job>.dynain: nodes at their present positions, elements, stresses and
!> strains, in the cards of LS-DYNA. Coordinates have the long format, stresses and strains LARGE=1.
module dynain_m
  use element_stage_m, only : find_stage_values, find_stage_strains, has_hourglass_memory
  use element_state_m, only : is_eroded
  use errors_m, only : error_t
  use kinds_m, only : wp, long
  use layout_m, only : chunk_size, slot_part
  use log_m, only : to_text
  use model_m, only : model_t
  use sorting_m, only : sorted_order
  use stages_m, only : n_law_history, stage_plastic, stage_law, stage_thickness, stage_hourglass
  use state_m, only : state_t
  use text_files_m, only : line_file_t, open_lines, put_lines, close_lines
  use text_m, only : shortest, es
  implicit none
  private
  public :: write_dynain, fitted_text

  !> Width of fields of coordinates, and of stresses and strains.
  integer, parameter :: wide = 20, large = 16
  character(1), parameter :: end_line = new_line('a')

contains

  !> Write the file from the state of the whole model.
  subroutine write_dynain(model, state, path, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    type(line_file_t) :: lines
    integer, allocatable :: slots(:)
    integer :: i

    ! In deck order, without eroded elements.
    slots = pack(model%layout%element_slot, [(model%springback%is_part(slot_part(model%layout, &
      model%layout%element_slot(i))) .and. .not. is_eroded(state%elements, &
      model%layout%element_slot(i)), i=1, model%mesh%n_element)])
    call open_lines(lines, path, error)
    if (allocated(error)) return
    call put_lines(lines, '*KEYWORD'//end_line//'$ state at time '//to_text(state%time) &
      //', cycle '//to_text(state%cycle)//end_line)
    if (is_wanted('NODE')) call write_nodes(model, state, slots, lines)
    if (is_wanted('ELEMENT_SHELL')) call write_elements(model, slots, lines)
    ! Rigid parts have neither stress nor strain.
    slots = pack(slots, [(.not. model%materials(model%parts(slot_part(model%layout, slots(i))) &
      %material)%is_rigid, i=1, size(slots))])
    if (size(slots) > 0 .and. is_wanted('INITIAL_STRESS_SHELL')) &
      call write_stresses(model, state, slots, lines)
    if (size(slots) > 0 .and. is_wanted('INITIAL_STRAIN_SHELL')) &
      call write_strains(model, state, slots, lines)
    call put_lines(lines, '*END'//end_line)
    call close_lines(lines, error)

  contains

    !> Whether a keyword is not excluded.
    pure logical function is_wanted(name)
      character(*), intent(in) :: name

      is_wanted = index(model%springback%excluded, ' '//name//' ') == 0
    end function is_wanted

  end subroutine write_dynain

  !> *NODE by increasing numbers: all of the elements, or all of the deck.
  subroutine write_nodes(model, state, slots, lines)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: slots(:)
    type(line_file_t), intent(inout) :: lines
    logical :: is_chosen(model%mesh%n_node)
    integer, allocatable :: nodes(:)
    real(wp) :: x(2)
    integer :: i, code
    character(wide) :: number, tail

    is_chosen = model%springback%all_nodes
    do i = 1, size(slots)
      is_chosen(model%layout%slot_nodes(:, slots(i))) = .true.
    end do
    nodes = pack([(i, i=1, model%mesh%n_node)], is_chosen)
    nodes = nodes(sorted_order(int(model%mesh%node_id(nodes), long)))
    call put_lines(lines, '*NODE +'//end_line)
    do i = 1, size(nodes)
      associate (id => model%mesh%node_id(nodes(i)), codes => model%springback%codes)
        x = model%mesh%coordinates(:, nodes(i)) + state%motion(1:2, nodes(i))
        write (number, '(i20)') id
        code = findloc(model%springback%nodes, id, dim=1, back=.true.)
        tail = ''
        if (code > 0) write (tail, '(i20)') codes(code)
        call put_lines(lines, number//fitted_text(x(1), wide)//fitted_text(x(2), wide) &
          //trim(merge(repeat(' ', wide)//tail, repeat(' ', 2*wide), code > 0))//end_line)
      end associate
    end do
  end subroutine write_nodes

  !> *ELEMENT_SHELL, with fields of ten columns where a number needs them.
  subroutine write_elements(model, slots, lines)
    type(model_t), intent(in) :: model
    integer, intent(in) :: slots(:)
    type(line_file_t), intent(inout) :: lines
    character(60) :: line
    logical :: is_wide
    integer :: i

    is_wide = max(maxval(model%mesh%element_id), maxval(model%mesh%node_id), &
      maxval(model%parts%id)) > 99999999
    call put_lines(lines, '*ELEMENT_SHELL'//trim(merge(' %', '  ', is_wide))//end_line)
    do i = 1, size(slots)
      write (line, merge('(6i10)', '(6i8) ', is_wide)) model%mesh%element_id( &
        model%layout%slot_element(slots(i))), model%parts(slot_part(model%layout, slots(i)))%id, &
        model%mesh%node_id(model%layout%slot_nodes(:, slots(i)))
      call put_lines(lines, trim(line)//end_line)
    end do
  end subroutine write_elements

  !> *INITIAL_STRESS_SHELL: history values are those of the law, t/t0 - 1 in plane stress and the
  !> hourglass forces, and zeros up to NSHV.
  subroutine write_stresses(model, state, slots, lines)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: slots(:)
    type(line_file_t), intent(inout) :: lines
    real(wp), allocatable :: values(:, :), history(:)
    character(80) :: line
    integer :: i, k, i_chunk, n

    call put_lines(lines, '*INITIAL_STRESS_SHELL'//end_line)
    do i = 1, size(slots)
      i_chunk = (slots(i) - 1)/chunk_size + 1
      call find_stage_values(model, state%motion, state%elements, slots(i), values)
      do k = 1, size(values, 2)
        associate (v => values(:, k), &
          material => model%materials(model%parts(slot_part(model%layout, slots(i)))%material))
          history = v(stage_law:stage_law + n_law_history(material) - 1)
          if (material%is_plane_stress) history = [history, v(stage_thickness)]
          if (has_hourglass_memory(model, i_chunk, state%elements)) &
            history = [history, v(stage_hourglass:)]
          n = max(0, model%springback%n_history - size(history))
          history = [history, spread(0.0_wp, 1, n)]
          if (k == 1) write (line, '(8i10)') model%mesh%element_id( &
            model%layout%slot_element(slots(i))), size(values, 2), 1, size(history), 0, 1, 0, 0
          if (k == 1) call put_lines(lines, trim(line)//end_line)
          call put_values(lines, [0.0_wp, v(:stage_plastic - 1)])
          call put_values(lines, [0.0_wp, 0.0_wp, v(stage_plastic)])
          do n = 1, size(history), 5
            call put_values(lines, history(n:min(n + 4, size(history))))
          end do
        end associate
      end do
    end do
  end subroutine write_stresses

  !> *INITIAL_STRAIN_SHELL.
  subroutine write_strains(model, state, slots, lines)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: slots(:)
    type(line_file_t), intent(inout) :: lines
    real(wp), allocatable :: strains(:, :)
    character(80) :: line
    integer :: i, k

    call put_lines(lines, '*INITIAL_STRAIN_SHELL'//end_line)
    do i = 1, size(slots)
      call find_stage_strains(model, state%motion, state%elements, slots(i), strains)
      write (line, '(4i10)') model%mesh%element_id(model%layout%slot_element(slots(i))), &
        size(strains, 2), 1, 1
      call put_lines(lines, trim(line)//end_line)
      do k = 1, size(strains, 2)
        call put_values(lines, [strains(:, k), 0.0_wp])
        call put_values(lines, [0.0_wp, 0.0_wp])
      end do
    end do
  end subroutine write_strains

  !> Add a card of large fields.
  subroutine put_values(lines, values)
    type(line_file_t), intent(inout) :: lines
    real(wp), intent(in) :: values(:)
    character(:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(values)
      text = text//fitted_text(values(i), large)
    end do
    call put_lines(lines, text//end_line)
  end subroutine put_values

  !> A number with as many digits as a field holds, at the right of it: the shortest text that
  !> reads back as the same number, or that of decimals or powers of ten that comes nearer to it.
  pure function fitted_text(value, width) result(field)
    real(wp), intent(in) :: value
    integer, intent(in) :: width   !! 12 or more
    character(width) :: field
    character(:), allocatable :: text
    character(40) :: decimals
    integer :: n, digits

    text = brief(shortest(value))
    if (len(text) > width) then
      n = width
      do
        n = n - 1
        text = brief(trim(adjustl(es(value, 40, min(16, n)))))
        if (len(text) <= width) exit
      end do
      ! Digits before the point need no power of ten.
      digits = max(0, floor(log10(abs(value))) + 1)
      if (abs(value) > 1.0e-4_wp .and. digits < width - 3) then
        do n = width - 1 - digits, 1, -1
          write (decimals, '(f40.'//to_text(n)//')') value
          decimals = brief(trim(adjustl(decimals)))
          if (len_trim(decimals) > width) cycle
          if (distance(trim(decimals)) < distance(text)) text = trim(decimals)
          exit
        end do
      end if
    end if
    field = repeat(' ', width - len(text))//text

  contains

    !> Distance of a text from the number.
    pure function distance(text)
      character(*), intent(in) :: text
      real(wp) :: distance, read_back

      read (text, *) read_back
      distance = abs(read_back - value)
    end function distance

  end function fitted_text

  !> A number without the zero before its point and those of its exponent.
  pure function brief(number) result(text)
    character(*), intent(in) :: number
    character(:), allocatable :: text
    integer :: at, power

    text = number
    at = index(text, '0.')
    if (at == 1 .or. (at == 2 .and. text(1:1) == '-')) text = text(:at - 1)//text(at + 1:)
    at = index(text, 'E')
    if (at == 0) return
    read (text(at + 1:), *) power
    text = text(:at - 1)
    if (power /= 0) text = text//'E'//to_text(power)
  end function brief

end module dynain_m
