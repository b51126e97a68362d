! SPDX-License-Identifier: MIT
!> Half slave segments seen from master segments, many at a time, so that their roots and quotients
!> are formed together (one by one, they took half of the time of type 4). Both halves of a slave
!> segment share what is seen of it.
module contact_halves_m
  use contact_piece_cutting_m, only : see_pieces, n_room
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: sights_t, halves_t, list_halves, see_segments, place_halves, find_sight

  !> Slave segments seen from master segments, the sights of one slave segment behind each other;
  !> each half may ask for a second one. Without default values, which would be written before each
  !> use.
  type :: sights_t
    integer :: n
    integer :: n_seen                 !! the first so many are known
    integer :: slave(2*n_room)        !! slave segment
    integer :: ends(2, 2*n_room)      !! its nodes
    integer :: master(2*n_room)       !! master segment that it is seen from
    integer :: nodes(2, 2*n_room)     !! local numbers of its nodes
    real(wp) :: own(2, 2*n_room)      !! vector of the slave segment, m
    real(wp) :: other(2, 2*n_room)    !! vector of the master segment, m
    real(wp) :: way(2, 2*n_room)      !! from its first node to the first end of the slave segment,
                                      !! m
    real(wp) :: place(2*n_room, 3)    !! where its first end, its middle and its second end are on
                                      !! the master segment
    real(wp) :: length(2*n_room)      !! of the master segment, m
  end type sights_t

  !> Half segments, and the one or two portions of the master that each covers.
  type :: halves_t
    integer :: n
    integer :: spot(n_room)           !! virtual node
    integer :: side(n_room)           !! 1: first half of its slave segment, 2: second
    real(wp) :: low(n_room)           !! where the later end is on the master segment below: the
                                      !! slave runs against it
    real(wp) :: high(n_room)          !! where the earlier end is
    real(wp) :: lies_on_one(n_room)   !! 1: both are on that segment, 0: not
    integer :: n_part(n_room)         !! portions
    integer :: sight(n_room, 2)       !! of the portions; of the half itself until these are known
    real(wp) :: foot(n_room, 2)       !! centre of the portion on its master segment
    real(wp) :: area(n_room, 2)       !! m
  end type halves_t

contains

  !> List the halves of some touching virtual nodes, each to be seen from the master segment below
  !> it.
  pure subroutine list_halves(n, touching, master, segments, halves, sights)
    integer, intent(in) :: n, touching(n) !! virtual nodes
    integer, intent(in) :: master(*)      !! master segments below these
    integer, intent(in) :: segments(2, *) !! of the slave
    type(halves_t), intent(inout) :: halves
    type(sights_t), intent(inout) :: sights
    integer :: k, j, s, last, below

    j = 0
    last = 0
    below = 0
    do k = 1, n
      halves%spot(k) = touching(k)
      halves%side(k) = 2 - iand(touching(k), 1)
      s = (touching(k) + 1)/2
      if (s /= last .or. master(touching(k)) /= below) then
        last = s
        below = master(touching(k))
        j = j + 1
        sights%slave(j) = s
        sights%ends(1, j) = segments(1, s)
        sights%ends(2, j) = segments(2, s)
        sights%master(j) = below
      end if
      halves%sight(k, 1) = j
    end do
    halves%n = n
    sights%n = j
    sights%n_seen = 0
  end subroutine list_halves

  !> Project the ends of the slave segments that are new on the list.
  pure subroutine see_segments(contact, memory, sights)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(sights_t), intent(inout) :: sights

    associate (n => sights%n - sights%n_seen, j => sights%n_seen + 1)
      call see_pieces(n, sights%ends(1, j), sights%master(j), contact%master%segments, &
        memory%n_slave, memory%places, sights%nodes(1, j), sights%own(1, j), sights%other(1, j), &
        sights%way(1, j))
      call project_ends(n, memory%spot_xi, sights%own(1, j), sights%other(1, j), sights%way(1, j), &
        sights%place(j, 1), sights%length(j))
    end associate
    sights%n_seen = sights%n
  end subroutine see_segments

  !> The same on arrays of known shape.
  pure subroutine project_ends(n, xi, own, other, way, place, length)
    integer, intent(in) :: n
    real(wp), intent(in) :: xi(2) !! of the virtual nodes
    real(wp), dimension(2, n_room), intent(in) :: own, other, way
    real(wp), intent(inout) :: place(2*n_room, *)
    real(wp), intent(inout) :: length(n_room)
    real(wp) :: square, inverse, start, slope
    integer :: k

    do k = 1, n
      square = max(other(1, k)*other(1, k) + other(2, k)*other(2, k), tiny(1.0_wp))
      inverse = 1.0_wp/sqrt(square)
      length(k) = square*inverse
      slope = (own(1, k)*other(1, k) + own(2, k)*other(2, k))*(inverse*inverse)
      start = (way(1, k)*other(1, k) + way(2, k)*other(2, k))*(inverse*inverse)
      place(k, 1) = start + (xi(1) - 0.25_wp)*slope
      place(k, 2) = start + (xi(1) + 0.25_wp)*slope
      place(k, 3) = start + (xi(2) + 0.25_wp)*slope
    end do
  end subroutine project_ends

  !> Both ends of the halves on the segments that these are seen from, and the portion of each that
  !> lies on one.
  pure subroutine place_halves(sights, halves)
    type(sights_t), intent(in) :: sights
    type(halves_t), intent(inout) :: halves
    real(wp) :: length(n_room), low, high
    integer :: k, j

    do k = 1, sights%n
      length(k) = 0.5_wp*sqrt(sights%own(1, k)*sights%own(1, k) + sights%own(2, k)*sights%own(2, k))
    end do
    do k = 1, halves%n
      j = halves%sight(k, 1)
      low = sights%place(j, halves%side(k) + 1)
      high = sights%place(j, halves%side(k))
      halves%low(k) = low
      halves%high(k) = high
      halves%lies_on_one(k) = merge(1.0_wp, 0.0_wp, low >= 0.0_wp .and. high <= 1.0_wp .and. high &
        > low)
      halves%n_part(k) = 1
      halves%sight(k, 2) = j
      halves%foot(k, 1) = 0.5_wp*(low + high)
      halves%foot(k, 2) = 0.0_wp
      halves%area(k, 1) = length(j)
      halves%area(k, 2) = 0.0_wp
    end do
  end subroutine place_halves

  !> The sight of the slave segment of sight `j` from another master segment: where it may be on the
  !> list, or new at its end.
  pure subroutine find_sight(j, segment, guess, sights, other)
    integer, intent(in) :: j, segment, guess
    type(sights_t), intent(inout) :: sights
    integer, intent(out) :: other

    other = guess
    if (other > 0 .and. other <= sights%n_seen) then
      if (sights%master(other) == segment .and. sights%slave(other) == sights%slave(j)) return
    end if
    other = sights%n + 1
    sights%n = other
    sights%slave(other) = sights%slave(j)
    sights%ends(1, other) = sights%ends(1, j)
    sights%ends(2, other) = sights%ends(2, j)
    sights%master(other) = segment
  end subroutine find_sight

end module contact_halves_m
