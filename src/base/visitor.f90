! SPDX-License-Identifier: MIT
!> Visitor pattern for the stored components of states and models. Each type lists its components
!> once, in its `visit`; the visitor writes or reads a restart file (`archive_m`), sends them to
!> another process or releases memory (`packed_buffer_m`).
!>
!> A visitor that reads values allocates arrays with the extents that come with them; others leave
!> unallocated arrays as they are. One that validates checks bounds; nothing is done after its first
!> error.
module visitor_m
  use, intrinsic :: iso_c_binding, only : c_loc, c_null_ptr, c_ptr
  use, intrinsic :: iso_fortran_env, only : int16
  use errors_m, only : error_t, raise, status_input
  use kinds_m, only : wp, long
  use log_m, only : to_text
  implicit none
  private
  public :: visitor_t, visited_t, item_t, absent, length, as_real, as_integer, as_index, as_bytes, &
    whole, any_length, of_nodes, of_elements, of_slots, of_columns, of_stresses, of_streams, &
    of_chunks, of_forces, new_chunks, fixed_slots, fixed_columns, n_of

  !> Content of an item: float64, int32, int64; or bytes that only the same build can read.
  integer, parameter :: as_real = 1, as_integer = 2, as_index = 3, as_bytes = 4
  !> Meaning of the last extent of an array: not distributed over processes; not distributed, any
  !> length; nodes of the mesh, elements in deck order, element slots, chunks, force slots.
  !> `of_columns`: the first extent counts slots; `of_stresses`: 16 values a slot; `of_streams`:
  !> only some chunks have a part of it. Time steps do not change `fixed_` arrays and set `new_`
  !> arrays before they are used, so that restart files do not contain them.
  integer, parameter :: whole = 0, any_length = 1, of_nodes = 2, of_elements = 3, of_slots = 4, &
    of_columns = 5, of_stresses = 6, of_streams = 7, of_chunks = 8, of_forces = 9, &
    new_chunks = 10, fixed_slots = 11, fixed_columns = 12, n_of = 12
  !> Extent of an unallocated array.
  integer, parameter :: absent = -1
  character(*), parameter :: not_finite = 'values that are not finite numbers'
  character(*), parameter :: other_numbers = 'numbers that differ from those of the deck'

  !> Description of one component.
  type :: item_t
    character(24) :: name = ''
    integer :: content = as_real              !! one of the `as_` constants
    integer :: rank = 1
    integer :: extents(2) = [absent, 1]
    integer :: of = whole                     !! meaning of the last extent
    logical :: is_new = .false.               !! to be allocated with these extents, unless absent
  end type item_t

  !> A visitor.
  type, abstract :: visitor_t
    logical :: validates = .false.            !! its values may be wrong
    logical :: is_partial = .false.           !! visits distributed arrays only
    integer :: n_item = 0                     !! length set by `makes`
    integer :: n_node = 0                     !! nodes of the mesh, for bounds
    character(:), allocatable :: path         !! file, for messages
    character(:), allocatable :: folder       !! of the component, ends with / or is empty
    type(error_t), allocatable :: error       !! first failure
  contains
    !> Get the extents of an array.
    procedure(find_item), deferred :: find
    !> Pass its values.
    procedure(pass_item), deferred :: pass
    procedure :: enter
    procedure :: leave
    procedure :: part
    procedure :: each
    procedure :: makes
    procedure :: plain
    procedure :: stream
    procedure :: fixed
    procedure :: expect
    procedure :: fail
    generic :: visit => visit_integer, visit_long, visit_real, visit_logical, visit_text, &
      visit_integers, visit_reals, visit_logicals, visit_integer_table, visit_real_table, &
      visit_short_table
    generic :: same => same_integer, same_integers
    procedure, private :: visit_integer, visit_long, visit_real, visit_logical, visit_text, &
      visit_integers, visit_reals, visit_logicals, visit_integer_table, visit_real_table, &
      visit_short_table, same_integer, same_integers
  end type visitor_t

  !> A type with stored components.
  type, abstract :: visited_t
  contains
    procedure(visit_components), deferred :: visit
  end type visited_t

  abstract interface
    subroutine find_item(visitor, item)
      import :: visitor_t, item_t
      class(visitor_t), intent(inout) :: visitor
      type(item_t), intent(inout) :: item    !! in: present extents; out: extents of the values
    end subroutine find_item

    subroutine pass_item(visitor, item, address, starts)
      import :: visitor_t, item_t, c_ptr
      class(visitor_t), intent(inout) :: visitor
      type(item_t), intent(in) :: item
      type(c_ptr), intent(in) :: address              !! first value
      integer, intent(in), optional :: starts(:)    !! of a stream
    end subroutine pass_item

    subroutine visit_components(self, visitor)
      import :: visited_t, visitor_t
      class(visited_t), intent(inout), target :: self
      class(visitor_t), intent(inout) :: visitor
    end subroutine visit_components
  end interface

contains

  !> Length of a list, `absent` where it is not allocated.
  pure function length(list) result(n)
    class(*), intent(in), optional :: list(:)
    integer :: n

    n = absent
    if (present(list)) n = size(list)
  end function length

  !> Enter a component that has components of its own.
  subroutine enter(visitor, name)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name

    if (.not. allocated(visitor%folder)) visitor%folder = ''
    visitor%folder = visitor%folder//name//'/'
  end subroutine enter

  !> Leave a component that has components of its own.
  subroutine leave(visitor)
    class(visitor_t), intent(inout) :: visitor

    visitor%folder = visitor%folder(:index(visitor%folder(:len(visitor%folder) - 1), '/', &
      back=.true.))
  end subroutine leave

  !> Visit a component that has components of its own.
  subroutine part(visitor, name, item)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    class(visited_t), intent(inout) :: item

    call visitor%enter(name)
    call item%visit(visitor)
    call visitor%leave()
  end subroutine part

  !> Visit a list of components with components of their own, numbered from 1.
  subroutine each(visitor, name, items)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    class(visited_t), intent(inout), optional :: items(:)
    integer :: i

    if (visitor%is_partial) return
    call visitor%enter(name)
    call visitor%same('n', max(0, length(items)))
    do i = 1, length(items)
      call visitor%part(to_text(i), items(i))
    end do
    call visitor%leave()
  end subroutine each

  !> Whether a list of derived types is to be allocated with `visitor%n_item` items, because the
  !> visitor reads one.
  function makes(visitor, n)
    class(visitor_t), intent(inout) :: visitor
    integer, intent(in) :: n !! present length or `absent`
    logical :: makes
    type(item_t) :: item

    item%content = as_bytes
    item%extents(1) = n
    if (.not. visitor%is_partial) call visitor%find(item)
    visitor%n_item = item%extents(1)
    makes = item%is_new .and. visitor%n_item /= absent
  end function makes

  !> Visit items of a type without allocatable components as bytes; for programs of the same build.
  subroutine plain(visitor, address, n_bit, n)
    class(visitor_t), intent(inout) :: visitor
    type(c_ptr), intent(in) :: address
    integer, intent(in) :: n_bit  !! storage size of an item
    integer, intent(in) :: n      !! items
    type(item_t) :: item

    if (visitor%is_partial) return
    item%content = as_bytes
    item%extents(1) = n_bit/8*n
    call visitor%pass(item, address)
  end subroutine plain

  !> Visit an integer.
  subroutine visit_integer(visitor, name, value, lowest, highest, problem)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    integer, intent(inout) :: value
    integer, intent(in), optional :: lowest, highest
    character(*), intent(in), optional :: problem !! description of a value out of bounds
    integer, allocatable :: values(:)

    if (visitor%is_partial) return
    values = [value]
    call visitor%visit(name, values, whole, lowest, highest, problem)
    if (.not. allocated(visitor%error)) value = values(1)
  end subroutine visit_integer

  !> Visit a long integer of 0 or more.
  subroutine visit_long(visitor, name, value, highest, problem)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    integer(long), intent(inout) :: value
    integer(long), intent(in) :: highest
    character(*), intent(in) :: problem        !! description of a value out of bounds
    integer(long), target :: copy

    copy = value
    call visitor%pass(item_t(name, as_index, 1, [1, 1]), c_loc(copy))
    call visitor%expect(name, copy >= 0 .and. copy <= highest, problem)
    if (.not. allocated(visitor%error)) value = copy
  end subroutine visit_long

  !> Visit a real.
  subroutine visit_real(visitor, name, value, lowest, problem)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    real(wp), intent(inout) :: value
    real(wp), intent(in), optional :: lowest
    character(*), intent(in), optional :: problem !! description of a value below `lowest`
    real(wp), allocatable :: values(:)

    if (visitor%is_partial) return
    values = [value]
    call visitor%visit(name, values, whole, lowest, problem)
    if (.not. allocated(visitor%error)) value = values(1)
  end subroutine visit_real

  !> Visit a logical, stored as 0 or 1.
  subroutine visit_logical(visitor, name, value)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    logical, intent(inout) :: value
    integer :: number

    if (visitor%is_partial) return
    number = merge(1, 0, value)
    call visitor%visit(name, number, 0, 1, 'a logical other than 0 and 1')
    if (.not. allocated(visitor%error)) value = number == 1
  end subroutine visit_logical

  !> Visit a text or an unallocated text; for programs of the same build.
  subroutine visit_text(visitor, name, text)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    character(:), allocatable, intent(inout), target :: text
    type(item_t) :: item

    if (visitor%is_partial) return
    item = item_t(name, as_bytes)
    if (allocated(text)) item%extents(1) = len(text)
    call visitor%find(item)
    if (item%is_new .and. allocated(text)) deallocate (text)
    if (item%is_new .and. item%extents(1) /= absent) allocate (character(item%extents(1)) :: text)
    if (item%extents(1) > 0) call visitor%pass(item, c_loc(text))
  end subroutine visit_text

  !> Visit an array of integers.
  subroutine visit_integers(visitor, name, values, of, lowest, highest, problem)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    integer, allocatable, intent(inout), target :: values(:)
    integer, intent(in), optional :: of, lowest, highest
    character(*), intent(in), optional :: problem
    type(item_t) :: item
    type(c_ptr) :: address

    item = item_t(name, as_integer, 1)
    if (present(of)) item%of = of
    if (allocated(values)) item%extents(:1) = shape(values)
    if (.not. visitor%is_partial) call visitor%find(item)
    if (item%is_new .and. allocated(values)) deallocate (values)
    if (item%is_new .and. item%extents(1) /= absent) allocate (values(item%extents(1)))
    address = c_null_ptr
    if (allocated(values)) address = c_loc(values)
    call visitor%pass(item, address)
    if (.not. visitor%validates .or. .not. (allocated(values) .and. present(problem))) return
    if (present(lowest)) call visitor%expect(name, all(values >= lowest), problem)
    if (present(highest)) call visitor%expect(name, all(values <= highest), problem)
  end subroutine visit_integers

  !> Visit an array of reals.
  subroutine visit_reals(visitor, name, values, of, lowest, problem)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    real(wp), allocatable, intent(inout), target :: values(:)
    integer, intent(in), optional :: of
    real(wp), intent(in), optional :: lowest
    character(*), intent(in), optional :: problem
    type(item_t) :: item
    type(c_ptr) :: address

    item = item_t(name, as_real, 1)
    if (present(of)) item%of = of
    if (allocated(values)) item%extents(:1) = shape(values)
    if (.not. visitor%is_partial) call visitor%find(item)
    if (item%is_new .and. allocated(values)) deallocate (values)
    if (item%is_new .and. item%extents(1) /= absent) allocate (values(item%extents(1)))
    address = c_null_ptr
    if (allocated(values)) address = c_loc(values)
    call visitor%pass(item, address)
    if (.not. visitor%validates .or. .not. allocated(values)) return
    call visitor%expect(name, all(is_finite(values)), not_finite)
    if (visitor%validates .and. present(problem)) call visitor%expect(name, all(values >= lowest), &
      problem)
  end subroutine visit_reals

  !> Visit an array of logicals.
  subroutine visit_logicals(visitor, name, values)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    logical, allocatable, intent(inout) :: values(:)
    integer, allocatable :: numbers(:)

    if (visitor%is_partial) return
    if (allocated(values)) allocate (numbers, source=merge(1, 0, values))
    call visitor%visit(name, numbers, whole, 0, 1, 'logicals other than 0 and 1')
    if (allocated(numbers) .and. .not. allocated(visitor%error)) values = numbers == 1
  end subroutine visit_logicals

  !> Visit a table of integers.
  subroutine visit_integer_table(visitor, name, values, of)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    integer, allocatable, intent(inout), target :: values(:, :)
    integer, intent(in), optional :: of
    type(item_t) :: item
    type(c_ptr) :: address

    item = item_t(name, as_integer, 2, [absent, absent])
    if (present(of)) item%of = of
    if (allocated(values)) item%extents = shape(values)
    if (.not. visitor%is_partial) call visitor%find(item)
    if (item%is_new .and. allocated(values)) deallocate (values)
    if (item%is_new .and. item%extents(1) /= absent) &
      allocate (values(item%extents(1), item%extents(2)))
    address = c_null_ptr
    if (allocated(values)) address = c_loc(values)
    call visitor%pass(item, address)
  end subroutine visit_integer_table

  !> Visit a table of reals.
  subroutine visit_real_table(visitor, name, values, of)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    real(wp), allocatable, intent(inout), target :: values(:, :)
    integer, intent(in), optional :: of
    type(item_t) :: item
    type(c_ptr) :: address

    item = item_t(name, as_real, 2, [absent, absent])
    if (present(of)) item%of = of
    if (allocated(values)) item%extents = shape(values)
    if (.not. visitor%is_partial) call visitor%find(item)
    if (item%is_new .and. allocated(values)) deallocate (values)
    if (item%is_new .and. item%extents(1) /= absent) &
      allocate (values(item%extents(1), item%extents(2)))
    address = c_null_ptr
    if (allocated(values)) address = c_loc(values)
    call visitor%pass(item, address)
    if (.not. visitor%validates .or. .not. allocated(values)) return
    call visitor%expect(name, all(is_finite(values)), not_finite)
  end subroutine visit_real_table

  !> Visit a table of short integers; for programs of the same build.
  subroutine visit_short_table(visitor, name, values, of)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    integer(int16), allocatable, intent(inout), target :: values(:, :)
    integer, intent(in) :: of
    integer, parameter :: n_byte = storage_size(1_int16)/8
    type(item_t) :: item

    item = item_t(name, as_bytes, 2, [absent, absent], of)
    if (allocated(values)) item%extents = [n_byte, 1]*shape(values)
    if (.not. visitor%is_partial) call visitor%find(item)
    if (item%is_new .and. item%extents(1) /= absent) &
      allocate (values(item%extents(1)/n_byte, item%extents(2)))
    if (allocated(values)) call visitor%pass(item, c_loc(values))
  end subroutine visit_short_table

  !> Visit an array of fixed size.
  subroutine fixed(visitor, name, values)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    real(wp), intent(inout) :: values(:)
    real(wp), allocatable :: copy(:)

    if (visitor%is_partial) return
    copy = values
    call visitor%visit(name, copy)
    if (.not. allocated(visitor%error)) values = copy
  end subroutine fixed

  !> Visit a stream that only some chunks have a part of, and the first index of each part.
  subroutine stream(visitor, name, values, name_of_starts, starts)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name, name_of_starts
    real(wp), allocatable, intent(inout), target :: values(:)
    integer, allocatable, intent(in) :: starts(:)  !! 0: none
    type(item_t) :: item

    call visitor%same(name_of_starts, starts)
    item = item_t(name, as_real, 1, [size(values), 1], of_streams)
    call visitor%pass(item, c_loc(values), starts)
    if (visitor%validates) call visitor%expect(name, all(is_finite(values)), not_finite)
  end subroutine stream

  !> Check that a stored integer equals that of the model.
  subroutine same_integer(visitor, name, value)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    integer, intent(in) :: value
    integer :: found

    found = value
    call visitor%visit(name, found)
    if (found /= value) call visitor%expect(name, .false., 'the number '//to_text(found)//', ' &
      //'expected '//to_text(value))
  end subroutine same_integer

  !> Check that stored integers equal those of the model.
  subroutine same_integers(visitor, name, values)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    integer, allocatable, intent(in) :: values(:)
    integer, allocatable :: found(:)

    if (visitor%is_partial) return
    if (allocated(values)) allocate (found, source=values)
    call visitor%visit(name, found)
    if (visitor%validates .and. allocated(values)) &
      call visitor%expect(name, all(found == values), other_numbers)
  end subroutine same_integers

  !> Raise an error unless the value of a component is valid.
  subroutine expect(visitor, name, is_sound, problem)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: name
    logical, intent(in) :: is_sound
    character(*), intent(in) :: problem !! description of an invalid value

    if (visitor%validates .and. .not. is_sound) call &
      visitor%fail('the restart file '//visitor%path &
      //' is refused: its '//visitor%folder//name//' has '//problem, status_input)
  end subroutine expect

  !> Raise an error unless there is one already.
  subroutine fail(visitor, message, status)
    class(visitor_t), intent(inout) :: visitor
    character(*), intent(in) :: message
    integer, intent(in) :: status    !! exit status

    visitor%validates = .false.
    if (.not. allocated(visitor%error)) call raise(visitor%error, message, status)
  end subroutine fail

  !> Whether a real is finite, by its bits: a comparison could trap.
  elemental function is_finite(value)
    real(wp), intent(in) :: value
    logical :: is_finite
    integer(long), parameter :: exponent_bits = 2047

    is_finite = ibits(transfer(value, 0_long), 52, 11) /= exponent_bits
  end function is_finite

end module visitor_m
