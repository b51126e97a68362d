! SPDX-License-Identifier: MIT
!> Gauss points of type 7 on the pieces of one slave segment, piece by piece and each over whatever
!> master segment is closest (doc/theory/contact.md, section 5.7).
module contact_pieces_m
  use contact_local_foot_m, only : local_foot
  use contact_overlap_m, only : cover_t, piece_t, first_piece, next_piece, facing_share
  use contact_placing_m, only : add_segment_point, place_on_segment
  use contact_projection_m, only : foot_t
  use contact_state_m, only : contact_state_t, make_room
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, sight_of_segment, sight_normal
  use kinds_m, only : wp
  implicit none
  private
  public :: slave_t, n_gauss, gauss_xi, add_pieces, add_local

  !> Gauss points of a piece.
  integer, parameter :: n_gauss = 2
  !> Where they are on 0 .. 1; both have weight one half. They integrate the product of shape
  !> functions and a linear gap exactly up to the curvature of the chain.
  real(wp), parameter :: gauss_xi(n_gauss) = [0.5_wp - sqrt(1.0_wp/12.0_wp), &
    0.5_wp + sqrt(1.0_wp/12.0_wp)]

  !> A slave segment.
  type :: slave_t
    integer :: ends(2)       !! its nodes
    real(wp) :: normal(2)
    real(wp) :: length       !! m
  end type slave_t

contains

  !> The points of one segment.
  pure subroutine add_pieces(contact, memory, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(cover_t), intent(in) :: cover
    type(piece_t) :: piece
    type(slave_t) :: slave

    if (.not. cover%exists) return
    slave = slave_of(memory, cover%ends)
    call first_piece(contact, memory, cover, piece)
    do while (.not. piece%is_last)
      call next_piece(contact, memory, cover, piece)
      if (piece%high > piece%low .and. piece%share > 0.0_wp) &
        call add_piece(contact, memory, slave, piece%segment, piece%low, piece%high)
    end do
  end subroutine add_pieces

  !> What the points of a slave segment have in common.
  pure function slave_of(memory, ends) result(slave)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    type(slave_t) :: slave
    type(sight_t) :: sight

    sight = sight_of_segment(memory%places(:, ends(2)), memory%places(:, ends(1)), &
      memory%places(:, ends(2)))
    slave%ends = ends
    slave%normal = sight_normal(sight)
    slave%length = sqrt(sight%square)
  end function slave_of

  !> The Gauss points on a piece, each over whatever master segment is closest there.
  pure subroutine add_piece(contact, memory, slave, segment, low, high)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(slave_t), intent(in) :: slave
    integer, intent(in) :: segment    !! master segment of the piece
    real(wp), intent(in) :: low, high !! where it starts and ends on the slave segment
    real(wp) :: xi
    integer :: q

    do q = 1, n_gauss
      xi = low + gauss_xi(q)*(high - low)
      call add_local(contact, memory, slave, segment, xi, 0.5_wp*(high - low)*slave%length)
    end do
  end subroutine add_piece

  !> One Gauss point.
  pure subroutine add_local(contact, memory, slave, segment, xi, area)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(slave_t), intent(in) :: slave
    integer, intent(in) :: segment  !! of the master, close by
    real(wp), intent(in) :: xi      !! place on the slave segment
    real(wp), intent(in) :: area    !! where that faces the master entirely, m
    type(foot_t) :: foot
    real(wp) :: share

    foot = local_foot(contact, memory, place_on_segment(memory%places, slave%ends, xi), segment)
    if (.not. foot%is_on) return
    share = facing_share(dot_product(slave%normal, foot%normal))
    if (.not. share > 0.0_wp) return
    call make_room(memory%points, 1)
    call add_segment_point(contact%master, memory%n_slave, slave%ends, xi, foot, memory%points)
    memory%points%area(memory%points%n) = area*share
    memory%points%stiffness(memory%points%n) = memory%slave_penalty
  end subroutine add_local

end module contact_pieces_m
