! SPDX-License-Identifier: MIT
!> What the processes of an explicit run exchange. Each computes the elements of its tiles and moves
!> their interior nodes; special nodes and all that acts on them are everywhere the same, so that in
!> a cycle it is forces on special nodes (raw, slot by slot: they are added in their fixed order) and
!> what the elements have come to. The first process gathers the rest where files ask for it.
module rank_exchange_m
  use block_state_m, only : block_state_t
  use errors_m, only : error_t
  use health_m, only : tile_check_t, check_elements
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use rank_shares_m, only : shares_t, stream_starts
  use ranks_m, only : ranks_t, bring_reals, bring_integers, share_records, share_error
  use requests_m, only : requests_t
  use state_m, only : state_t
  implicit none
  private
  public :: exchange_forces, exchange_checks, exchange_erosion, exchange_limits, gather_motion, &
    gather_state, judge_elements

  !> Values of a record: limit, checksum, volumes, elements gone, requests (4), an error.
  integer, parameter :: n_value = 9

contains

  !> Forces of all tiles on special nodes; failed points of their chunks.
  subroutine exchange_forces(ranks, shares, state)
    type(ranks_t), intent(in) :: ranks
    type(shares_t), intent(in) :: shares
    type(state_t), intent(inout) :: state

    call bring_reals(ranks, shares%force_slots, 2, .true., state%force_slots)
    if (allocated(state%elements%n_failed)) call bring_integers(ranks, shares%chunks, 1, .true., &
      state%elements%n_failed)
  end subroutine exchange_forces

  !> What the elements of each process have come to, in place of what those of single tiles have;
  !> what was asked of the first process; whether any has an error, which then is that of all.
  subroutine exchange_checks(ranks, elements, checks, n_gone, asked, error)
    type(ranks_t), intent(in) :: ranks
    type(block_state_t), intent(in) :: elements
    type(tile_check_t), intent(inout) :: checks(:)  !! one a tile at least, and one a process
    integer, intent(out) :: n_gone                  !! elements of all processes that are not there
    type(requests_t), intent(inout) :: asked
    type(error_t), allocatable, intent(inout) :: error
    real(wp) :: record(n_value), records(n_value, ranks%n)

    record(1) = minval(checks%time_limit)
    record(2) = sum(checks%checksum)
    record(3) = merge(1.0_wp, 0.0_wp, all(checks%has_volume))
    record(4) = 0.0_wp
    if (allocated(elements%erosion)) record(4) = sum(elements%erosion%n_gone)
    record(5:8) = merge(1.0_wp, 0.0_wp, [asked%dump, asked%plot, asked%stop, asked%signalled])
    record(9) = merge(1.0_wp, 0.0_wp, allocated(error))
    call share_records(ranks, record, records)
    checks = tile_check_t()
    checks(:ranks%n)%time_limit = records(1, :)
    checks(:ranks%n)%checksum = records(2, :)
    checks(:ranks%n)%has_volume = records(3, :) > 0.0_wp
    n_gone = nint(sum(records(4, :)))
    asked%dump = records(5, 1) > 0.0_wp
    asked%plot = records(6, 1) > 0.0_wp
    asked%stop = records(7, 1) > 0.0_wp
    asked%signalled = records(8, 1) > 0.0_wp
    if (any(records(9, :) > 0.0_wp)) call share_error(ranks, error)
  end subroutine exchange_checks

  !> Elements that have left in this cycle, and what they take along.
  subroutine exchange_erosion(ranks, shares, elements)
    type(ranks_t), intent(in) :: ranks
    type(shares_t), intent(in) :: shares
    type(block_state_t), intent(inout) :: elements

    associate (erosion => elements%erosion, slots => slots_of(shares%chunks))
      call bring_integers(ranks, shares%chunks, 1, .true., erosion%n_gone)
      call bring_integers(ranks, slots, 1, .true., erosion%status)
      call bring_reals(ranks, slots, 1, .true., erosion%hourglass)
      call bring_reals(ranks, slots, 1, .true., erosion%internal)
    end associate
  end subroutine exchange_erosion

  !> Step limits of all chunks.
  subroutine exchange_limits(ranks, shares, elements)
    type(ranks_t), intent(in) :: ranks
    type(shares_t), intent(in) :: shares
    type(block_state_t), intent(inout) :: elements

    call bring_reals(ranks, shares%chunks, 1, .true., elements%time_limit)
  end subroutine exchange_limits

  !> Motion of all interior nodes.
  subroutine gather_motion(ranks, shares, to_all, state)
    type(ranks_t), intent(in) :: ranks
    type(shares_t), intent(in) :: shares
    logical, intent(in) :: to_all
    type(state_t), intent(inout) :: state

    call bring_reals(ranks, shares%nodes, 4, to_all, state%motion)
  end subroutine gather_motion

  !> The whole state for the first process, or for all.
  subroutine gather_state(ranks, shares, to_all, state)
    type(ranks_t), intent(in) :: ranks
    type(shares_t), intent(in) :: shares
    logical, intent(in) :: to_all
    type(state_t), intent(inout) :: state

    call gather_motion(ranks, shares, to_all, state)
    call bring_reals(ranks, shares%nodes, 2, to_all, state%internal_force)
    if (allocated(state%former_velocity)) &
      call bring_reals(ranks, shares%nodes, 2, to_all, state%former_velocity)
    if (allocated(state%former_damping)) &
      call bring_reals(ranks, shares%nodes, 2, to_all, state%former_damping)
    call gather_chunks(ranks, shares, to_all, state%elements)
    call gather_slots(ranks, shares, to_all, state%elements)
    call gather_streams(ranks, shares, to_all, state%elements)
  end subroutine gather_state

  !> What elements keep chunk by chunk.
  subroutine gather_chunks(ranks, shares, to_all, elements)
    type(ranks_t), intent(in) :: ranks
    type(shares_t), intent(in) :: shares
    logical, intent(in) :: to_all
    type(block_state_t), intent(inout) :: elements

    call bring_reals(ranks, shares%chunks, 1, to_all, elements%deviatoric_work)
    call bring_reals(ranks, shares%chunks, 1, to_all, elements%hourglass_work)
    call bring_reals(ranks, shares%chunks, 1, to_all, elements%viscous_work)
    call bring_reals(ranks, shares%chunks, 1, to_all, elements%time_limit)
    call bring_reals(ranks, shares%chunks, 1, to_all, elements%volume_limit)
    if (allocated(elements%damping_work)) &
      call bring_reals(ranks, shares%chunks, 1, to_all, elements%damping_work)
  end subroutine gather_chunks

  !> What they keep slot by slot. Their shape changes where they may leave the mesh.
  subroutine gather_slots(ranks, shares, to_all, elements)
    type(ranks_t), intent(in) :: ranks
    type(shares_t), intent(in) :: shares
    logical, intent(in) :: to_all
    type(block_state_t), intent(inout) :: elements
    integer :: k

    associate (slots => slots_of(shares%chunks))
      do k = 1, size(elements%deviator, 2)
        call bring_reals(ranks, slots, 1, to_all, elements%deviator(:, k))
      end do
      if (allocated(elements%damping_stress)) &
        call bring_reals(ranks, slots, 16, to_all, elements%damping_stress)
      if (.not. allocated(elements%erosion)) return
      do k = 1, size(elements%reference, 2)
        call bring_reals(ranks, slots, 1, to_all, elements%reference(:, k))
      end do
      call bring_reals(ranks, slots, 1, to_all, elements%erosion%hourglass)
      call bring_reals(ranks, slots, 1, to_all, elements%erosion%impulse)
    end associate
  end subroutine gather_slots

  !> What only some chunks keep.
  subroutine gather_streams(ranks, shares, to_all, elements)
    type(ranks_t), intent(in) :: ranks
    type(shares_t), intent(in) :: shares
    logical, intent(in) :: to_all
    type(block_state_t), intent(inout) :: elements

    call gather_stream(elements%point_start, elements%point_deviator)
    call gather_stream(elements%history_start, elements%history)
    call gather_stream(elements%eos_start, elements%eos_state)
    call gather_stream(elements%hourglass_start, elements%hourglass_strain)

  contains

    subroutine gather_stream(chunk_start, values)
      integer, intent(in) :: chunk_start(:)
      real(wp), intent(inout), contiguous :: values(:)

      if (size(values) > 0) call bring_reals(ranks, stream_starts(shares%chunks, chunk_start, &
        size(values)), 1, to_all, values)
    end subroutine gather_stream

  end subroutine gather_streams

  !> Ranges of slots from those of chunks.
  pure function slots_of(chunks) result(slots)
    integer, intent(in) :: chunks(0:)
    integer :: slots(0:size(chunks) - 1)

    slots = (chunks - 1)*chunk_size + 1
  end function slots_of

  !> The first process looks at all elements, whose state it has gathered, and tells the others.
  subroutine judge_elements(ranks, model, state, error)
    type(ranks_t), intent(in) :: ranks
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(error_t), allocatable, intent(inout) :: error

    if (ranks%mine == 0) call check_elements(model, state, error)
    if (ranks%n > 1) call share_error(ranks, error)
  end subroutine judge_elements

end module rank_exchange_m
