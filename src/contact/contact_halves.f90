! SPDX-License-Identifier: MIT
!> Half slave segments seen from master segments, many at a time, so that their roots and quotients are formed together
!> (one by one, they took half of the time of type 4). What is known of a slave segment serves both of its
!> halves, and what is known of a master segment all that are seen from it.
module contact_halves_m
  use contact_plain_cover_m, only : n_room
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: halves_t, sights_t, sides_t, list_halves, add_sight, see_sights, place_halves

  !> Segments of one side, those that are met one after the other listed once. Without default values, which would
  !> be written before each use; so are the other lists.
  type :: sides_t
    integer :: n
    integer :: n_seen                 !! the first so many are known
    integer :: segment(2*n_room)
    integer :: nodes(2, 2*n_room)     !! local numbers of the nodes of each
    real(wp) :: vector(2, 2*n_room)   !! m
    real(wp) :: length(2*n_room)      !! m
    real(wp) :: inverse(2*n_room)     !! 1/length^2 of a master segment, 1/m^2
  end type sides_t

  !> Slave segments seen from master segments, the sights of one slave segment behind each other.
  type :: sights_t
    integer :: n
    integer :: n_seen                 !! the first so many are known
    integer :: slave(2*n_room)        !! place of the slave segment on its list
    integer :: master(2*n_room)       !! place of the master segment that it is seen from on its list
    real(wp) :: place(2*n_room, 3)    !! where its first end, its middle and its second end are on the master segment
  end type sights_t

  !> Half segments, and the one or two portions of the master that each covers.
  type :: halves_t
    integer :: n
    integer :: spot(n_room)           !! virtual node
    integer :: side(n_room)           !! 1: first half of its slave segment, 2: second
    real(wp) :: low(n_room)           !! where the later end is on the master segment below: the slave runs against it
    real(wp) :: high(n_room)          !! where the earlier end is
    real(wp) :: lies_on_one(n_room)   !! 1: both are on that segment, 0: not
    integer :: n_part(n_room)         !! portions
    integer :: sight(n_room, 2)       !! of the portions; of the half itself until these are known
    real(wp) :: foot(n_room, 2)       !! centre of the portion on its master segment
    real(wp) :: area(n_room, 2)       !! m
  end type halves_t

contains

  !> List the halves of some touching virtual nodes, each to be seen from the master segment below it.
  pure subroutine list_halves(n, touching, below, halves, sights, slaves, masters)
    integer, intent(in) :: n, touching(n) !! virtual nodes
    integer, intent(in) :: below(*)       !! master segments below these
    type(halves_t), intent(inout) :: halves
    type(sights_t), intent(inout) :: sights
    type(sides_t), intent(inout) :: slaves, masters
    integer :: k, i, j, s, m, n_slave, n_master

    j = 0
    n_slave = 0
    n_master = 0
    s = 0
    m = 0
    do k = 1, n
      i = touching(k)
      halves%spot(k) = i
      halves%side(k) = 2 - iand(i, 1)
      if ((i + 1)/2 /= s .or. below(i) /= m) then
        if ((i + 1)/2 /= s) n_slave = n_slave + 1
        if (below(i) /= m) n_master = n_master + 1
        s = (i + 1)/2
        m = below(i)
        slaves%segment(n_slave) = s
        masters%segment(n_master) = m
        j = j + 1
        sights%slave(j) = n_slave
        sights%master(j) = n_master
      end if
      halves%sight(k, 1) = j
    end do
    halves%n = n
    sights%n = j
    slaves%n = n_slave
    masters%n = n_master
    sights%n_seen = 0
    slaves%n_seen = 0
    masters%n_seen = 0
  end subroutine list_halves

  !> The sight of the slave segment of sight `j` from the master segment before (`step` = 1) or after (-1), which is
  !> that of the next or the last sight, or else new on the list.
  pure subroutine add_sight(j, segment, step, sights, masters, other)
    integer, intent(in) :: j, segment, step
    type(sights_t), intent(inout) :: sights
    type(sides_t), intent(inout) :: masters
    integer, intent(out) :: other
    integer :: master

    other = j + step
    master = 0
    if (other > 0 .and. other <= sights%n_seen) then
      if (masters%segment(sights%master(other)) == segment) then
        if (sights%slave(other) == sights%slave(j)) return
        master = sights%master(other)
      end if
    end if
    if (master == 0) then
      masters%n = masters%n + 1
      master = masters%n
      masters%segment(master) = segment
    end if
    sights%n = sights%n + 1
    other = sights%n
    sights%slave(other) = sights%slave(j)
    sights%master(other) = master
  end subroutine add_sight

  !> Project the ends of the slave segments of all sights that are new.
  pure subroutine see_sights(contact, memory, sights, slaves, masters)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(sights_t), intent(inout) :: sights
    type(sides_t), intent(inout) :: slaves, masters
    real(wp), dimension(2, n_room) :: own, other, way
    real(wp) :: inverse(n_room)

    associate (n => slaves%n - slaves%n_seen, k => slaves%n_seen + 1)
      call take_vectors(n, slaves%segment(k), 0, contact%slave%segments, memory%places, &
        slaves%nodes(1, k), slaves%vector(1, k))
    end associate
    associate (n => masters%n - masters%n_seen, k => masters%n_seen + 1)
      call take_vectors(n, masters%segment(k), memory%n_slave, contact%master%segments, memory%places, &
        masters%nodes(1, k), masters%vector(1, k))
    end associate
    call measure_sides(slaves, masters)
    associate (n => sights%n - sights%n_seen, j => sights%n_seen + 1)
      call take_ways(n, sights%slave(j), sights%master(j), slaves, masters, memory%places, own, other, &
        way, inverse)
      call project_ends(n, [memory%spot_xi(1) - 0.25_wp, memory%spot_xi + 0.25_wp], own, other, way, &
        inverse, sights%place(j, 1))
    end associate
    sights%n_seen = sights%n
  end subroutine see_sights

  !> Nodes and vectors of segments of a side.
  pure subroutine take_vectors(n, segment, offset, segments, places, nodes, vector)
    integer, intent(in) :: n, segment(n)
    integer, intent(in) :: offset                !! local number before the first node of the side
    integer, intent(in) :: segments(2, *)
    real(wp), intent(in) :: places(4, *)
    integer, intent(inout) :: nodes(2, n_room)
    real(wp), intent(inout) :: vector(2, n_room) !! m
    real(wp) :: along(4)
    integer :: k, a, b

    !GCC$ NOVECTOR
    do k = 1, n
      a = offset + segments(1, segment(k))
      b = offset + segments(2, segment(k))
      nodes(1, k) = a
      nodes(2, k) = b
      along = places(:, b) - places(:, a)
      vector(:, k) = along(1:2) + along(3:4)
    end do
  end subroutine take_vectors

  !> Lengths of the new slave segments, and lengths and their inverse squares of the new master segments.
  pure subroutine measure_sides(slaves, masters)
    type(sides_t), intent(inout) :: slaves, masters
    real(wp) :: square, inverse
    integer :: k

    do k = slaves%n_seen + 1, slaves%n
      slaves%length(k) = sqrt(slaves%vector(1, k)*slaves%vector(1, k) &
        + slaves%vector(2, k)*slaves%vector(2, k))
    end do
    slaves%n_seen = slaves%n
    do k = masters%n_seen + 1, masters%n
      square = max(masters%vector(1, k)*masters%vector(1, k) &
        + masters%vector(2, k)*masters%vector(2, k), tiny(1.0_wp))
      inverse = 1.0_wp/sqrt(square)
      masters%length(k) = square*inverse
      masters%inverse(k) = inverse*inverse
    end do
    masters%n_seen = masters%n
  end subroutine measure_sides

  !> What is known of both segments of some sights, and the ways between them.
  pure subroutine take_ways(n, slave, master, slaves, masters, places, own, other, way, inverse)
    integer, intent(in) :: n, slave(n), master(n)
    type(sides_t), intent(in) :: slaves, masters
    real(wp), intent(in) :: places(4, *)
    real(wp), dimension(2, n_room), intent(inout) :: own, other !! m
    real(wp), intent(inout) :: way(2, n_room)  !! from the first master node to the first slave node, m
    real(wp), intent(inout) :: inverse(n_room) !! of the master, 1/m^2
    real(wp) :: across(4)
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      across = places(:, slaves%nodes(1, slave(k))) - places(:, masters%nodes(1, master(k)))
      way(:, k) = across(1:2) + across(3:4)
      own(:, k) = slaves%vector(:, slave(k))
      other(:, k) = masters%vector(:, master(k))
      inverse(k) = masters%inverse(master(k))
    end do
  end subroutine take_ways

  !> Where the ends and the middles of slave segments are on master segments.
  pure subroutine project_ends(n, xi, own, other, way, inverse, place)
    integer, intent(in) :: n
    real(wp), intent(in) :: xi(3) !! of the first end, the middle and the second end
    real(wp), dimension(2, n_room), intent(in) :: own, other, way
    real(wp), intent(in) :: inverse(n_room)
    real(wp), intent(inout) :: place(2*n_room, *)
    real(wp) :: start, slope
    integer :: k

    do k = 1, n
      slope = (own(1, k)*other(1, k) + own(2, k)*other(2, k))*inverse(k)
      start = (way(1, k)*other(1, k) + way(2, k)*other(2, k))*inverse(k)
      place(k, 1) = start + xi(1)*slope
      place(k, 2) = start + xi(2)*slope
      place(k, 3) = start + xi(3)*slope
    end do
  end subroutine project_ends

  !> Both ends of the halves on the segments that these are seen from, and the portion of each that lies on one.
  pure subroutine place_halves(sights, slaves, halves)
    type(sights_t), intent(in) :: sights
    type(sides_t), intent(in) :: slaves
    type(halves_t), intent(inout) :: halves
    real(wp) :: low, high
    integer :: k, j

    do k = 1, halves%n
      j = halves%sight(k, 1)
      low = sights%place(j, halves%side(k) + 1)
      high = sights%place(j, halves%side(k))
      halves%low(k) = low
      halves%high(k) = high
      halves%lies_on_one(k) = merge(1.0_wp, 0.0_wp, low >= 0.0_wp .and. high <= 1.0_wp .and. high > low)
      halves%n_part(k) = 1
      halves%sight(k, 2) = j
      halves%foot(k, 1) = 0.5_wp*(low + high)
      halves%foot(k, 2) = 0.0_wp
      halves%area(k, 1) = 0.5_wp*slaves%length(sights%slave(j))
      halves%area(k, 2) = 0.0_wp
    end do
  end subroutine place_halves

end module contact_halves_m
