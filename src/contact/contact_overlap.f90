! SPDX-License-Identifier: MIT
!> Which part of a slave segment faces which master segments. Both chains are ordered and run
!> against each other: walking the master chain from the foot of one end of a slave segment to that
!> of the other meets every master node in between. Projected on the slave segment these nodes cut
!> it into pieces, each facing one master segment; there is no search (doc/theory/contact.md,
!> section 3.5).
module contact_overlap_m
  use contact_local_foot_m, only : free_foot
  use contact_plain_foot_m, only : well_inside
  use contact_placing_m, only : tracked_foot
  use contact_projection_m, only : foot_t, see_segment, turns_gently, side_on
  use contact_state_m, only : contact_state_t, is_touching
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, sight_of_segment, separation
  use kinds_m, only : wp
  implicit none
  private
  public :: cover_t, piece_t, find_cover, first_piece, next_piece, see_master_node, facing_share, &
    side_on, face_on

  !> Cosine of the angle between two outward normals up to which surfaces face each other entirely
  !> (60 degrees between the surfaces). From there to `side_on` the share falls smoothly: a jump
  !> would create energy when a body turns.
  real(wp), parameter :: face_on = -0.5_wp

  !> A slave segment over the master chain.
  type :: cover_t
    integer :: segment = 0         !! the slave segment
    integer :: ends(2) = 0         !! its nodes
    logical :: exists = .false.    !! some master segment is near
    type(foot_t) :: feet(2)        !! of its two ends
    integer :: far_segment = 0     !! master segment below the second end, where that is of another
                                   !! chain; else 0
  end type cover_t

  !> A stretch of slave segment over one master segment.
  type :: piece_t
    integer :: segment = 0         !! master segment
    integer :: next_segment = 0    !! where the walk goes on
    integer :: n_step = 0          !! master segments passed
    integer :: low_node = 0        !! master node that cuts at `low`, 0: none
    integer :: high_node = 0       !! master node that cuts at `high`, 0: none
    real(wp) :: share = 0.0_wp     !! part of it that counts: none where the two segments do not
                                   !! face
    real(wp) :: low = 0.0_wp       !! where it starts on the slave segment, 0 to 1
    real(wp) :: high = 0.0_wp      !! where it ends
    logical :: is_last = .false.
  end type piece_t

contains

  !> Feet of both ends of a slave segment. Ends in contact are where the tracking has them; others
  !> are looked for from the foot of the other end, so that both are on the same stretch of the
  !> chain.
  pure subroutine find_cover(contact, memory, segment, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: segment !! of the slave surface
    type(cover_t), intent(out) :: cover
    integer :: k, start

    cover%segment = segment
    cover%ends = contact%slave%segments(:, segment)
    associate (tracking => memory%slave_tracking)
      start = 0
      do k = 2, 1, -1
        if (tracking%segment(cover%ends(k)) > 0) start = tracking%segment(cover%ends(k))
      end do
      if (start == 0) return
      cover%exists = .true.
      do k = 1, 2
        if (tracking%status(cover%ends(k)) /= is_touching) cycle
        cover%feet(k) = tracked_foot(tracking, cover%ends(k))
        start = cover%feet(k)%segment
      end do
      do k = 1, 2
        if (cover%feet(k)%segment == 0) cover%feet(k) = free_foot(contact, memory, &
          memory%places(:, cover%ends(k)), start)
        start = cover%feet(1)%segment
      end do
    end associate
    if (all(cover%feet%is_on) .and. contact%master%chain(cover%feet(1)%segment) &
      /= contact%master%chain(cover%feet(2)%segment)) cover%far_segment = cover%feet(2)%segment
    call take_nodes_in(contact, cover%feet)
  end subroutine find_cover

  !> A foot on a master node belongs to two segments; it takes the outer one, so that the node lies
  !> between the feet whatever round-off decided. Where ends of closed surfaces meet exactly, a hair
  !> off the node would count otherwise: what stands over the end of a slave would gain or lose half
  !> of the side of its body under the strict rule of type 5.
  pure subroutine take_nodes_in(contact, feet)
    type(contact_t), intent(in) :: contact
    type(foot_t), intent(inout) :: feet(2)

    associate (next => contact%master%next(feet(1)%segment))
      if (abs(feet(1)%xi - 1.0_wp) <= well_inside .and. next > 0) then
        feet(1)%segment = next
        feet(1)%xi = 0.0_wp
      end if
    end associate
    associate (previous => contact%master%previous(feet(2)%segment))
      if (abs(feet(2)%xi) <= well_inside .and. previous > 0) then
        feet(2)%segment = previous
        feet(2)%xi = 1.0_wp
      end if
    end associate
  end subroutine take_nodes_in

  !> Where the walk along a covered segment starts: at its first end, or at the end of the master
  !> chain.
  pure subroutine first_piece(contact, memory, cover, piece)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(cover_t), intent(in) :: cover
    type(piece_t), intent(out) :: piece !! empty; next_piece makes the first one
    type(sight_t) :: sight
    integer :: node

    piece%is_last = .not. cover%exists
    if (piece%is_last) return
    piece%next_segment = cover%feet(1)%segment
    ! Both ends beyond the same end of the master chain: nothing faces the segment.
    if (.not. cover%feet(1)%is_on) piece%is_last = cover%feet(1)%xi < 0.5_wp
    if (.not. cover%feet(2)%is_on) piece%is_last = piece%is_last .or. cover%feet(2)%xi > 0.5_wp
    if (all(cover%feet%is_on) .and. cover%far_segment == 0) &
      piece%is_last = .not. runs_against(contact, cover%feet)
    if (piece%is_last .or. cover%feet(1)%is_on) return
    node = contact%master%segments(2, piece%next_segment)
    sight = see_master_node(memory, cover, node)
    if (sight%along <= 0.0_wp) return
    piece%is_last = sight%along >= sight%square
    piece%high = sight%along/sight%square
    piece%high_node = node
  end subroutine first_piece

  !> Whether the way along the master chain from the first foot to the second is shorter backwards.
  !> Otherwise slave and master do not face: the side of a body, seen from the chain, runs along
  !> with it.
  pure function runs_against(contact, feet) result(against)
    type(contact_t), intent(in) :: contact
    type(foot_t), intent(in) :: feet(2)
    logical :: against
    integer :: back, forth

    back = feet(1)%segment
    forth = feet(1)%segment
    do
      against = back == feet(2)%segment
      if (against .or. forth == feet(2)%segment) return
      if (back > 0) back = contact%master%previous(back)
      if (forth > 0) forth = contact%master%next(forth)
      if (back == 0 .and. forth == 0) return
    end do
  end function runs_against

  !> The next piece along the slave segment; it may be empty (high = low) where the chain is bent
  !> back.
  pure subroutine next_piece(contact, memory, cover, piece)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(cover_t), intent(in) :: cover
    type(piece_t), intent(inout) :: piece
    type(sight_t) :: sight
    logical :: is_over_end

    if (cover%far_segment > 0 .and. piece%n_step > 0) call cross_over(contact, memory, cover, piece)
    piece%low = piece%high
    piece%low_node = piece%high_node
    piece%segment = piece%next_segment
    piece%next_segment = contact%master%previous(piece%segment)
    piece%n_step = piece%n_step + 1
    piece%share = share_of_segment(contact, memory, cover, piece%segment)
    is_over_end = cover%feet(2)%is_on .and. piece%segment == cover%feet(2)%segment
    if (.not. is_over_end) then
      sight = see_master_node(memory, cover, contact%master%segments(1, piece%segment))
      is_over_end = sight%along >= sight%square
    end if
    if (is_over_end) then
      piece%high = 1.0_wp
      piece%high_node = 0
      piece%is_last = .true.
      return
    end if
    piece%is_last = piece%n_step >= contact%master%n_segment .or. sight%along < -sight%square &
      .or. (piece%next_segment == 0 .and. cover%far_segment == 0)
    if (sight%along <= piece%low*sight%square) return
    piece%high = sight%along/sight%square
    piece%high_node = contact%master%segments(1, piece%segment)
  end subroutine next_piece

  !> At the end of the chain below the first end of a slave segment, or at a sharp corner of it, go
  !> over to the chain below the other end: to the segment with which that chain, or its stretch up
  !> to a sharp corner, begins.
  pure subroutine cross_over(contact, memory, cover, piece)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(cover_t), intent(in) :: cover
    type(piece_t), intent(inout) :: piece
    type(sight_t) :: sight
    integer :: segment, i_step

    segment = cover%far_segment
    if (contact%master%chain(piece%segment) == contact%master%chain(segment)) return
    if (goes_on(piece%segment, piece%next_segment)) return
    do i_step = 1, contact%master%n_segment
      sight = see_master_node(memory, cover, contact%master%segments(2, segment))
      if (sight%along <= piece%high*sight%square) exit
      if (.not. goes_on(segment, contact%master%next(segment))) exit
      segment = contact%master%next(segment)
    end do
    piece%next_segment = segment
    piece%high = max(piece%high, min(1.0_wp, sight%along/sight%square))
    piece%high_node = contact%master%segments(2, segment)

  contains

    !> Whether a master segment has a neighbour across a gentle corner.
    pure function goes_on(segment, neighbour)
      integer, intent(in) :: segment, neighbour !! 0: no neighbour
      logical :: goes_on

      goes_on = neighbour > 0
      if (goes_on) goes_on = turns_gently(see(segment), see(neighbour))
    end function goes_on

    !> The first end of the slave segment seen from a master segment.
    pure function see(segment) result(sight)
      integer, intent(in) :: segment
      type(sight_t) :: sight

      sight = see_segment(contact%master, memory%places(:, memory%n_slave + 1:), &
        memory%places(:, cover%ends(1)), segment)
    end function see

  end subroutine cross_over

  !> A master node seen from a slave segment.
  pure function see_master_node(memory, cover, node) result(sight)
    type(contact_state_t), intent(in) :: memory
    type(cover_t), intent(in) :: cover
    integer, intent(in) :: node !! of the master surface
    type(sight_t) :: sight

    sight = sight_of_segment(memory%places(:, memory%n_slave + node), &
      memory%places(:, cover%ends(1)), memory%places(:, cover%ends(2)))
  end function see_master_node

  !> How much of a slave segment counts over a master segment.
  pure function share_of_segment(contact, memory, cover, segment) result(share)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(cover_t), intent(in) :: cover
    integer, intent(in) :: segment !! of the master
    real(wp) :: share, own(2), other(2), product, squares

    own = separation(memory%places(:, cover%ends(2)), memory%places(:, cover%ends(1)))
    other = separation(memory%places(:, memory%n_slave + contact%master%segments(2, segment)), &
      memory%places(:, memory%n_slave + contact%master%segments(1, segment)))
    product = dot_product(own, other)
    squares = dot_product(own, own)*dot_product(other, other)
    if (product < 0.0_wp .and. product**2 >= face_on**2*squares) then
      share = 1.0_wp
    else
      share = facing_share(product/sqrt(max(squares, tiny(1.0_wp))))
    end if
  end function share_of_segment

  !> How much of a surface counts where its outward normal and that of the other side have this
  !> cosine, 0 to 1.
  pure function facing_share(cosine) result(share)
    real(wp), intent(in) :: cosine
    real(wp) :: share

    share = 1.0_wp
    if (cosine <= face_on) return
    share = max(0.0_wp, min(1.0_wp, (side_on - cosine)/(side_on - face_on)))
    share = share*share*(3.0_wp - 2.0_wp*share)
  end function facing_share

end module contact_overlap_m
