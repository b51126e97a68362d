! SPDX-License-Identifier: MIT
!> What an interface remembers follows when the runs of facing segments change
!> (doc/theory/contact.md, section 3.7). Segments, and spots between nodes, are numbered by the
!> present runs; nodes keep their numbers, and those in no run rest.
module facing_change_m
  use contacts_m, only : contact_t
  use contact_state_m, only : contact_state_t, tracking_t, is_free
  use facing_state_m, only : facing_side_t
  use kinds_m, only : wp
  use spots_m, only : list_chords, move_spots
  use surfaces_m, only : surface_t
  use tracking_m, only : list_touching, measure_depths
  implicit none
  private
  public :: move_memory, rest_loose_nodes

contains

  !> Let the memory follow from former runs to the present ones.
  pure subroutine move_memory(former_slave, former_master, memory)
    integer, intent(in) :: former_slave(:), former_master(:) !! their segments by the deck's numbers
    type(contact_state_t), intent(inout) :: memory !! with the present interface
    integer, allocatable :: slave_now(:), master_now(:)
    type(contact_t), allocatable :: present
    integer :: n_spot

    slave_now = numbers_now(memory%facing%slave, former_slave)
    master_now = numbers_now(memory%facing%master, former_master)
    n_spot = 0
    if (allocated(memory%spot_xi)) n_spot = size(memory%spot_xi)
    if (n_spot > 0) call move_spot_memory(memory%facing%slave, n_spot, slave_now, &
      memory%slave_tracking)
    call follow_chain(memory%facing%master, master_now, memory%slave_tracking)
    call replace_chords(memory%facing%present%slave, n_spot, memory%slave_tracking)
    if (n_spot > 0) call place_spots(memory)
    if (memory%master_tracking%n > 0) then
      call follow_chain(memory%facing%slave, slave_now, memory%master_tracking)
      call replace_chords(memory%facing%present%master, 0, memory%master_tracking)
    end if
    if (allocated(memory%segments%status)) call move_segments(memory, slave_now)
    call move_alloc(memory%facing%present, present)
    call rest_loose_nodes(present%slave, present%master, memory)
    call move_alloc(present, memory%facing%present)
    call list_touching(memory%slave_tracking)
    if (memory%master_tracking%n > 0) call list_touching(memory%master_tracking)
  end subroutine move_memory

  !> Present numbers of the segments of former runs, 0: in none.
  pure function numbers_now(side, former) result(now)
    type(facing_side_t), intent(in) :: side
    integer, intent(in) :: former(:)
    integer, allocatable :: now(:)
    integer :: position(size(side%segments)), k

    position = 0
    do k = 1, side%n
      position(side%segments(k)) = k
    end do
    allocate (now(size(former)))
    do k = 1, size(former)
      now(k) = position(former(k))
    end do
  end function numbers_now

  !> A tracking over a chain whose segments have other numbers. Spots on segments that are in no run
  !> any more know nothing; all that do not touch look round anew.
  pure subroutine follow_chain(side, now, tracking)
    type(facing_side_t), intent(in) :: side !! tracked upon
    integer, intent(in) :: now(:)           !! present numbers of its former segments
    type(tracking_t), intent(inout) :: tracking
    integer :: i

    do i = 1, tracking%n
      if (tracking%segment(i) > 0) tracking%segment(i) = now(tracking%segment(i))
      if (tracking%segment(i) == 0) tracking%status(i) = is_free
    end do
    tracking%wake(:tracking%n) = -huge(1.0_wp)
    tracking%recheck(:tracking%n) = -huge(1.0_wp)
    tracking%next_wake = -huge(1.0_wp)
    tracking%grid%cell = 0.0_wp
    tracking%segment_depth(:side%n) = side%caught(side%segments(:side%n))
    tracking%segment_depth(side%n + 1:) = huge(1.0_wp)
    call measure_depths(tracking)
  end subroutine follow_chain

  !> Spots of slave segments that have other numbers.
  pure subroutine move_spot_memory(side, n_spot, now, tracking)
    type(facing_side_t), intent(in) :: side !! that the spots are on
    integer, intent(in) :: n_spot           !! of a segment
    integer, intent(in) :: now(:)           !! present numbers of its former segments
    type(tracking_t), intent(inout) :: tracking
    type(tracking_t) :: former
    integer :: k, to, from

    allocate (former%segment, source=tracking%segment)
    allocate (former%status, source=tracking%status)
    allocate (former%xi, source=tracking%xi)
    allocate (former%gap, source=tracking%gap)
    allocate (former%normal, source=tracking%normal)
    tracking%n = n_spot*side%n
    tracking%segment = 0
    tracking%status = is_free
    tracking%wake = huge(1.0_wp)
    tracking%spot_depth = huge(1.0_wp)
    do k = 1, side%n
      tracking%spot_depth((k - 1)*n_spot + 1:k*n_spot) = side%reached(side%segments(k))
    end do
    do k = 1, size(now)
      if (now(k) == 0) cycle
      to = (now(k) - 1)*n_spot
      from = (k - 1)*n_spot
      tracking%segment(to + 1:to + n_spot) = former%segment(from + 1:from + n_spot)
      tracking%status(to + 1:to + n_spot) = former%status(from + 1:from + n_spot)
      tracking%xi(to + 1:to + n_spot) = former%xi(from + 1:from + n_spot)
      tracking%gap(to + 1:to + n_spot) = former%gap(from + 1:from + n_spot)
      tracking%normal(:, to + 1:to + n_spot) = former%normal(:, from + 1:from + n_spot)
    end do
  end subroutine move_spot_memory

  !> Chords along the present runs.
  pure subroutine replace_chords(own, n_spot, tracking)
    type(surface_t), intent(in) :: own
    integer, intent(in) :: n_spot !! of a segment, 0: spots at nodes
    type(tracking_t), intent(inout) :: tracking

    tracking%chord = 1
    tracking%chord(:, :tracking%n) = list_chords(own, n_spot)
  end subroutine replace_chords

  !> Spots on the present slave segments.
  pure subroutine place_spots(memory)
    type(contact_state_t), intent(inout) :: memory
    integer :: s, q, n

    n = size(memory%spot_xi)
    associate (slave => memory%facing%present%slave)
      do s = 1, slave%n_segment
        do q = 1, n
          memory%spots(1:2, (s - 1)*n + q) = (1.0_wp - memory%spot_xi(q)) &
            *memory%places(1:2, slave%segments(1, s)) &
            + memory%spot_xi(q)*memory%places(1:2, slave%segments(2, s))
        end do
      end do
      call move_spots(slave, memory%places, memory%spot_xi, memory%spot_spread, memory%spots)
    end associate
  end subroutine place_spots

  !> The memory of slave segments that have other numbers.
  pure subroutine move_segments(memory, now)
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: now(:) !! present numbers of the former segments
    integer, allocatable :: former(:)
    integer :: k

    allocate (former, source=memory%segments%status)
    memory%segments%status = is_free
    do k = 1, size(now)
      if (now(k) > 0) memory%segments%status(now(k)) = former(k)
    end do
    memory%segments%wake = -huge(1.0_wp)
    memory%segments%next_wake = -huge(1.0_wp)
  end subroutine move_segments

  !> Nodes in no run are not followed. Again after all have been woken.
  pure subroutine rest_loose_nodes(slave, master, memory)
    type(surface_t), intent(in) :: slave, master !! present ones
    type(contact_state_t), intent(inout) :: memory

    if (.not. allocated(memory%spots)) call rest_nodes(slave, memory%slave_tracking)
    if (memory%master_tracking%n > 0) call rest_nodes(master, memory%master_tracking)
    if (allocated(memory%segments%wake)) &
      memory%segments%wake(memory%facing%slave%n + 1:) = huge(1.0_wp)
  end subroutine rest_loose_nodes

  !> Those of one tracking.
  pure subroutine rest_nodes(own, tracking)
    type(surface_t), intent(in) :: own
    type(tracking_t), intent(inout) :: tracking
    integer :: i

    do i = 1, tracking%n
      if (own%incoming(i) > 0 .or. own%outgoing(i) > 0) cycle
      tracking%segment(i) = 0
      tracking%status(i) = is_free
      tracking%wake(i) = huge(1.0_wp)
      tracking%recheck(i) = huge(1.0_wp)
    end do
  end subroutine rest_nodes

end module facing_change_m
