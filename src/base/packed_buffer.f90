! SPDX-License-Identifier: MIT
!> A visitor that packs values into a buffer, for another process or for a copy in memory. One visit
!> counts them, a second packs them, a third unpacks them. Values are copied as they lie in memory:
!> both sides run the same build.
!>
!> A complete buffer holds all values that are not distributed over processes, and the extents of
!> distributed arrays. A partial buffer holds ranges of distributed arrays.
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
    real(wp), allocatable :: values(:)  !! unallocated while values are counted
    integer :: ranges(2, n_of) = spread([1, 0], 2, n_of) !! first and last index of each kind of
                                        !! distributed array, by the `of_` constants; partial only
  contains
    procedure :: find => pass_extents
    procedure :: pass => pass_values
    procedure :: transfer_bytes => copy_bytes
  end type packed_buffer_t

  !> A partial buffer that releases the memory pages of its ranges, whose values are not needed any
  !> more. The arrays keep their shapes.
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

  !> Allocate the values after they have been counted.
  pure subroutine start_packing(buffer)
    type(packed_buffer_t), intent(inout) :: buffer

    allocate (buffer%values(buffer%n))
    buffer%n = 0
  end subroutine start_packing

  !> Return to the first value, to unpack.
  pure subroutine start_unpacking(buffer)
    type(packed_buffer_t), intent(inout) :: buffer

    buffer%n = 0
    buffer%is_unpacking = .true.
  end subroutine start_unpacking

  !> A partial buffer of one range of one kind of distributed array.
  pure function part_of(of, range) result(buffer)
    integer, intent(in) :: of       !! one of the `of_` constants
    integer, intent(in) :: range(2)
    type(packed_buffer_t) :: buffer

    buffer%is_partial = .true.
    buffer%ranges(:, of) = range
  end function part_of

  !> Choose the slots and streams of a range of chunks.
  pure subroutine choose_slots(buffer, chunks, chunk_size, with_fixed, with_chunks)
    class(packed_buffer_t), intent(inout) :: buffer
    integer, intent(in) :: chunks(2)
    integer, intent(in) :: chunk_size
    logical, intent(in) :: with_fixed  !! include arrays that time steps do not change
    logical, intent(in) :: with_chunks !! include values per chunk
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

  !> Pass the extents of an array, so that the receiver can allocate it.
  subroutine pass_extents(visitor, item)
    class(packed_buffer_t), intent(inout) :: visitor
    type(item_t), intent(inout) :: item
    integer, target :: extents(2)

    extents = item%extents
    call visitor%transfer_bytes(c_loc(extents), int(2*integer_bytes, c_size_t))
    item%extents = extents
    item%is_new = visitor%is_unpacking
  end subroutine pass_extents

  !> Pass all values of an array, or the chosen range.
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

  !> The address `n_byte` bytes after another.
  pure function offset_address(address, n_byte) result(shifted)
    type(c_ptr), intent(in) :: address
    integer(c_size_t), intent(in) :: n_byte
    type(c_ptr) :: shifted
    integer(c_intptr_t) :: bits

    bits = transfer(address, bits) + n_byte
    shifted = transfer(bits, shifted)
  end function offset_address

  !> Copy contiguous bytes; they occupy a whole number of reals in the buffer.
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

  !> Release the memory pages of contiguous bytes.
  subroutine release(visitor, address, n_byte)
    class(memory_release_t), intent(inout), target :: visitor
    type(c_ptr), intent(in) :: address
    integer(c_size_t), intent(in) :: n_byte

    call release_pages(address, n_byte)
    visitor%n = visitor%n + int(n_byte/real_bytes)
  end subroutine release

  !> First index of each range of chunks in a stream that only some chunks have a part of.
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
