! SPDX-License-Identifier: MIT
!> Half slave segments seen from master segments, many at a time, so that their roots and quotients are formed together
!> (one by one, they took half of the time of type 4).
module contact_halves_m
  use contact_plain_cover_m, only : see_pieces, n_room
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: halves_t, take_half, see_halves

  !> A list of half segments. Without default values, which would be written before each use.
  type :: halves_t
    integer :: n
    integer :: spot(n_room)         !! virtual node
    integer :: part(n_room)         !! place of its first portion on the list of these
    integer :: ends(2, n_room)      !! nodes of its slave segment
    integer :: master(n_room)       !! master segment that it is seen from
    integer :: nodes(2, n_room)     !! local numbers of its nodes
    real(wp) :: xi(n_room)          !! of the virtual node
    real(wp) :: own(2, n_room)      !! vector of the slave segment, m
    real(wp) :: other(2, n_room)    !! vector of the master segment, m
    real(wp) :: way(2, n_room)      !! from its first node to the first end of the slave segment, m
    real(wp) :: low(n_room)         !! where the later end is on the master segment: the slave runs against the master
    real(wp) :: high(n_room)        !! where the earlier end is
    real(wp) :: length(n_room)      !! of the master segment, m
    real(wp) :: half(n_room)        !! length of the half segment, m
  end type halves_t

contains

  !> Put the half segment of a virtual node, to be seen from a master segment, at a place of the list.
  pure subroutine take_half(contact, memory, spot, segment, halves, k)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: spot, segment
    type(halves_t), intent(inout) :: halves
    integer, intent(in) :: k

    halves%spot(k) = spot
    halves%ends(1, k) = contact%slave%segments(1, (spot + 1)/2)
    halves%ends(2, k) = contact%slave%segments(2, (spot + 1)/2)
    halves%master(k) = segment
    halves%xi(k) = memory%spot_xi(2 - mod(spot, 2))
  end subroutine take_half

  !> Project the ends of the half segments.
  pure subroutine see_halves(contact, memory, halves)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(halves_t), intent(inout) :: halves

    call see_pieces(halves%n, halves%ends, halves%master, contact%master%segments, memory%n_slave, &
      memory%places, halves%nodes, halves%own, halves%other, halves%way)
    call project_halves(halves%n, halves%xi, halves%own, halves%other, halves%way, halves%low, &
      halves%high, halves%length, halves%half)
  end subroutine see_halves

  !> The same on arrays of known shape.
  pure subroutine project_halves(n, xi, own, other, way, low, high, length, half)
    integer, intent(in) :: n
    real(wp), intent(in) :: xi(n_room)
    real(wp), dimension(2, n_room), intent(in) :: own, other, way
    real(wp), dimension(n_room), intent(inout) :: low, high, length, half
    real(wp) :: square, inverse, start, slope
    integer :: k

    do k = 1, n
      square = max(other(1, k)*other(1, k) + other(2, k)*other(2, k), tiny(1.0_wp))
      inverse = 1.0_wp/sqrt(square)
      length(k) = square*inverse
      slope = (own(1, k)*other(1, k) + own(2, k)*other(2, k))*(inverse*inverse)
      start = (way(1, k)*other(1, k) + way(2, k)*other(2, k))*(inverse*inverse)
      low(k) = start + (xi(k) + 0.25_wp)*slope
      high(k) = start + (xi(k) - 0.25_wp)*slope
      half(k) = 0.5_wp*sqrt(own(1, k)*own(1, k) + own(2, k)*own(2, k))
    end do
  end subroutine project_halves

end module contact_halves_m
