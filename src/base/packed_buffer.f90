! SPDX-License-Identifier: MIT
!> A visitor that carries values from one process to another, or aside: the same visit counts them,
!> loads them one behind the other and unloads them. As they lie in memory: who loads and who
!> unloads are programs of one build.
!>
!> A buffer takes all that is not divided among processes; of arrays that are, it gives the lengths
!> alone. A partial one takes ranges of these.
module packed_buffer_m
  use, intrinsic :: iso_c_binding, only : c_intptr_t, c_loc, c_ptr, c_size_t
  use kinds_m, only : wp
  use system_m, only : release_pages
  use visitor_m, only : visitor_t, item_t, any_length, of_slots, of_columns, of_streams, &
    of_stresses, of_chunks, new_chunks, fixed_slots, fixed_columns, n_of, as_integer, as_bytes
  implicit none
  private
  public :: packed_buffer_t, memory_release_t, start_packing, start_unpacking, part_of, &
    choose_slots, stream_starts

  integer, parameter :: real_bytes = storage_size(1.0_wp)/8, integer_bytes = storage_size(1)/8

  type, extends(visitor_t) :: packed_buffer_t
    integer :: n = 0                    !! values passed so far
    logical :: is_unpacking = .false.
    real(wp), allocatable :: values(:)  !! not there while they are only counted
    integer :: ranges(2, n_of) = spread([1, 0], 2, n_of) !! of a partial one: first and last that it
                                        !! takes of what is divided, by the `of_` constants
  contains
    procedure :: find => pass_extents
    procedure :: pass => pass_values
    procedure :: transfer_bytes => copy_bytes
  end type packed_buffer_t

  !> A partial one that gives the memory of its ranges back: nobody asks for them any more. The
  !> arrays stay as long as they are.
  type, extends(packed_buffer_t) :: memory_release_t
  contains
    procedure :: transfer_bytes => release
  end type memory_release_t

  interface
    function c_memcpy(to, from, n_byte) bind(c, name='memcpy') result(same)
      import :: c_ptr, c_size_t
      type(c_ptr), value :: to, from
      integer(c_size_t), value :: n_byte
      type(c_ptr) :: same
    end function c_memcpy
  end interface

contains

  !> Once the values are counted: room for them.
  pure subroutine start_packing(buffer)
    type(packed_buffer_t), intent(inout) :: buffer

    allocate (buffer%values(buffer%n))
    buffer%n = 0
  end subroutine start_packing

  !> Back to the first value, to put them into arrays.
  pure subroutine start_unpacking(buffer)
    type(packed_buffer_t), intent(inout) :: buffer

    buffer%n = 0
    buffer%is_unpacking = .true.
  end subroutine start_unpacking

  !> A buffer of a range of what is divided.
  pure function part_of(of, range) result(buffer)
    integer, intent(in) :: of       !! one of the `of_` constants
    integer, intent(in) :: range(2)
    type(packed_buffer_t) :: buffer

    buffer%is_partial = .true.
    buffer%ranges(:, of) = range
  end function part_of

  !> The slots of a range of chunks, and their streams.
  pure subroutine choose_slots(buffer, chunks, chunk_size, with_fixed, with_chunks)
    class(packed_buffer_t), intent(inout) :: buffer
    integer, intent(in) :: chunks(2)
    integer, intent(in) :: chunk_size
    logical, intent(in) :: with_fixed  !! what steps do not change too
    logical, intent(in) :: with_chunks !! values of whole chunks too
    integer :: slots(2)

    buffer%is_partial = .true.
    slots = [(chunks(1) - 1)*chunk_size + 1, chunks(2)*chunk_size]
    buffer%ranges(:, of_slots) = slots
    buffer%ranges(:, of_columns) = slots
    buffer%ranges(:, of_stresses) = [16*slots(1) - 15, 16*slots(2)]
    buffer%ranges(:, of_streams) = chunks
    if (with_fixed) buffer%ranges(:, fixed_slots) = slots
    if (with_fixed) buffer%ranges(:, fixed_columns) = slots
    if (with_chunks) buffer%ranges(:, of_chunks) = chunks
    if (with_chunks) buffer%ranges(:, new_chunks) = chunks
  end subroutine choose_slots

  !> Extents go along, so that who unloads can allocate.
  subroutine pass_extents(visitor, item)
    class(packed_buffer_t), intent(inout) :: visitor
    type(item_t), intent(inout) :: item
    integer, target :: extents(2)

    extents = item%extents
    call visitor%transfer_bytes(c_loc(extents), int(2*integer_bytes, c_size_t))
    item%extents = extents
    item%is_new = visitor%is_unpacking
  end subroutine pass_extents

  !> All values of an array, or those of a range of it.
  subroutine pass_values(visitor, item, address, starts)
    class(packed_buffer_t), intent(inout) :: visitor
    type(item_t), intent(in) :: item
    type(c_ptr), intent(in) :: address
    integer, intent(in), optional :: starts(:)
    integer(c_size_t) :: n_byte
    integer :: range(2), k

    if (item%extents(1) < 1 .or. (visitor%is_partial .neqv. item%of > any_length)) return
    n_byte = real_bytes
    if (item%content == as_integer) n_byte = integer_bytes
    if (item%content == as_bytes) n_byte = 1
    if (.not. visitor%is_partial) then
      n_byte = n_byte*product(int(item%extents(:item%rank), c_size_t))
      if (n_byte > 0) call visitor%transfer_bytes(address, n_byte)
      return
    end if
    range = visitor%ranges(:, item%of)
    if (present(starts)) &
      range = stream_starts([range(1), range(2) + 1], starts, item%extents(1)) - [0, 1]
    if (range(2) < range(1)) return
    if (any(item%of == [of_columns, fixed_columns])) then
      do k = 1, item%extents(2)
        call visitor%transfer_bytes(offset_address(address, n_byte*(int(k - 1, &
          c_size_t)*item%extents(1) + range(1) - 1)), n_byte*(range(2) - range(1) + 1))
      end do
    else
      if (item%rank == 2) n_byte = n_byte*item%extents(1)
      call visitor%transfer_bytes(offset_address(address, n_byte*(range(1) - 1)), n_byte*(range(2) &
        - range(1) + 1))
    end if
  end subroutine pass_values

  !> The place so many bytes behind another.
  pure function offset_address(address, n_byte) result(shifted)
    type(c_ptr), intent(in) :: address
    integer(c_size_t), intent(in) :: n_byte
    type(c_ptr) :: shifted
    integer(c_intptr_t) :: bits

    bits = transfer(address, bits) + n_byte
    shifted = transfer(bits, shifted)
  end function offset_address

  !> Bytes that lie side by side. They take a whole number of reals.
  subroutine copy_bytes(visitor, address, n_byte)
    class(packed_buffer_t), intent(inout), target :: visitor
    type(c_ptr), intent(in) :: address
    integer(c_size_t), intent(in) :: n_byte
    type(c_ptr) :: ignored
    integer :: last

    last = visitor%n + int((n_byte + real_bytes - 1)/real_bytes)
    if (allocated(visitor%values)) then
      if (visitor%is_unpacking) then
        ignored = c_memcpy(address, c_loc(visitor%values(visitor%n + 1)), n_byte)
      else
        visitor%values(last) = 0.0_wp
        ignored = c_memcpy(c_loc(visitor%values(visitor%n + 1)), address, n_byte)
      end if
    end if
    visitor%n = last
  end subroutine copy_bytes

  !> Their pages go back to the system.
  subroutine release(visitor, address, n_byte)
    class(memory_release_t), intent(inout), target :: visitor
    type(c_ptr), intent(in) :: address
    integer(c_size_t), intent(in) :: n_byte

    call release_pages(address, n_byte)
    visitor%n = visitor%n + int(n_byte/real_bytes)
  end subroutine release

  !> Ranges of a stream that only some chunks of elements have a part of.
  pure function stream_starts(chunks, chunk_start, n_value) result(starts)
    integer, intent(in) :: chunks(0:)      !! ranges of chunks
    integer, intent(in) :: chunk_start(:)  !! where a chunk's part starts, 0 = none
    integer, intent(in) :: n_value         !! length of the stream
    integer :: starts(0:size(chunks) - 1)
    integer :: rank, i

    do rank = 0, size(chunks) - 1
      starts(rank) = n_value + 1
      do i = chunks(rank), size(chunk_start)
        if (chunk_start(i) == 0) cycle
        starts(rank) = chunk_start(i)
        exit
      end do
    end do
  end function stream_starts

end module packed_buffer_m
