! SPDX-License-Identifier: MIT
!> What a step changes in the elements of one chunk: taken out of the streams of all elements, and
!> put back.
module chunk_memory_m
  use block_state_m, only : block_state_t
  use erosion_state_m, only : erosion_state_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use viscous_stress_m, only : viscous_start
  implicit none
  private
  public :: take_chunk, put_chunk

  !> Some values of a stream, where there is one, to or from those that are kept.
  interface move
    module procedure move_reals, move_columns, move_integers
  end interface move

contains

  !> Copy a chunk.
  subroutine take_chunk(i_chunk, elements, kept)
    integer, intent(in) :: i_chunk
    type(block_state_t), intent(inout) :: elements !! stays as it is
    type(block_state_t), intent(inout) :: kept     !! of this chunk alone

    call move_chunk(i_chunk, .true., elements, kept)
  end subroutine take_chunk

  !> A chunk as it was when it was copied.
  subroutine put_chunk(i_chunk, kept, elements)
    integer, intent(in) :: i_chunk
    type(block_state_t), intent(inout) :: kept     !! stays as it is
    type(block_state_t), intent(inout) :: elements

    call move_chunk(i_chunk, .false., elements, kept)
  end subroutine put_chunk

  !> Component by component, in the order of their declarations.
  subroutine move_chunk(i_chunk, is_taken, elements, kept)
    integer, intent(in) :: i_chunk
    logical, intent(in) :: is_taken !! from the elements, else back into them
    type(block_state_t), intent(inout) :: elements, kept
    integer :: slots(2), viscous(2), own(2)

    own = i_chunk
    slots = [(i_chunk - 1)*chunk_size + 1, i_chunk*chunk_size]
    viscous = [viscous_start(i_chunk, 1), viscous_start(i_chunk + 1, 1) - 1]
    associate (e => elements)
      ! The shape of an element that leaves the mesh becomes that of padding.
      if (allocated(e%erosion)) call move(slots, is_taken, e%reference, kept%reference)
      call move(slots, is_taken, e%deviator, kept%deviator)
      call move(stretch(i_chunk, e%point_start, size(e%point_deviator)), is_taken, &
        e%point_deviator, kept%point_deviator)
      call move(stretch(i_chunk, e%history_start, size(e%history)), is_taken, e%history, &
        kept%history)
      call move(stretch(i_chunk, e%eos_start, size(e%eos_state)), is_taken, e%eos_state, &
        kept%eos_state)
      call move(own, is_taken, e%n_failed, kept%n_failed)
      call move(stretch(i_chunk, e%hourglass_start, size(e%hourglass_strain)), is_taken, &
        e%hourglass_strain, kept%hourglass_strain)
      call move(own, is_taken, e%deviatoric_work, kept%deviatoric_work)
      call move(own, is_taken, e%hourglass_work, kept%hourglass_work)
      call move(own, is_taken, e%viscous_work, kept%viscous_work)
      call move(viscous, is_taken, e%damping_stress, kept%damping_stress)
      call move(own, is_taken, e%damping_work, kept%damping_work)
      call move(own, is_taken, e%time_limit, kept%time_limit)
      call move(own, is_taken, e%volume_limit, kept%volume_limit)
      if (.not. allocated(e%erosion)) return
      if (.not. allocated(kept%erosion)) allocate (kept%erosion)
      call move_erosion(own, slots, is_taken, e%erosion, kept%erosion)
    end associate
  end subroutine move_chunk

  !> Of elements that may leave the mesh; what belongs to nodes and parts changes elsewhere.
  subroutine move_erosion(own, slots, is_taken, erosion, kept)
    integer, intent(in) :: own(2), slots(2)
    logical, intent(in) :: is_taken
    type(erosion_state_t), intent(inout) :: erosion, kept

    call move(slots, is_taken, erosion%status, kept%status)
    call move(own, is_taken, erosion%n_gone, kept%n_gone)
    call move(slots, is_taken, erosion%hourglass, kept%hourglass)
    call move(slots, is_taken, erosion%internal, kept%internal)
    call move(slots, is_taken, erosion%impulse, kept%impulse)
  end subroutine move_erosion

  !> Where a chunk stands in a stream that only some chunks have; first above last: nowhere.
  pure function stretch(i_chunk, starts, n) result(bounds)
    integer, intent(in) :: i_chunk
    integer, intent(in) :: starts(:)   !! (n_chunk), 0 = it is not there
    integer, intent(in) :: n           !! length of the stream
    integer :: bounds(2)
    integer :: k

    bounds = [1, 0]
    if (starts(i_chunk) == 0) return
    bounds = [starts(i_chunk), n]
    do k = i_chunk + 1, size(starts)
      if (starts(k) == 0) cycle
      bounds(2) = starts(k) - 1
      return
    end do
  end function stretch

  subroutine move_reals(bounds, is_taken, stream, kept)
    integer, intent(in) :: bounds(2)
    logical, intent(in) :: is_taken
    real(wp), allocatable, intent(inout) :: stream(:), kept(:)
    integer :: n

    n = bounds(2) - bounds(1) + 1
    if (.not. allocated(stream) .or. n < 1) return
    if (.not. is_taken) then
      stream(bounds(1):bounds(2)) = kept
      return
    end if
    if (allocated(kept)) then
      if (size(kept) /= n) deallocate (kept)
    end if
    if (.not. allocated(kept)) allocate (kept(n))
    kept(:) = stream(bounds(1):bounds(2))
  end subroutine move_reals

  subroutine move_columns(bounds, is_taken, stream, kept)
    integer, intent(in) :: bounds(2)
    logical, intent(in) :: is_taken
    real(wp), allocatable, intent(inout) :: stream(:, :), kept(:, :)

    if (.not. is_taken) then
      stream(bounds(1):bounds(2), :) = kept
      return
    end if
    if (.not. allocated(kept)) allocate (kept(bounds(2) - bounds(1) + 1, size(stream, 2)))
    kept(:, :) = stream(bounds(1):bounds(2), :)
  end subroutine move_columns

  subroutine move_integers(bounds, is_taken, stream, kept)
    integer, intent(in) :: bounds(2)
    logical, intent(in) :: is_taken
    integer, allocatable, intent(inout) :: stream(:), kept(:)

    if (.not. allocated(stream)) return
    if (.not. is_taken) then
      stream(bounds(1):bounds(2)) = kept
      return
    end if
    if (.not. allocated(kept)) allocate (kept(bounds(2) - bounds(1) + 1))
    kept(:) = stream(bounds(1):bounds(2))
  end subroutine move_integers

end module chunk_memory_m
