! SPDX-License-Identifier: MIT
!> State of the search of an interface: candidate pairs, status of points over the segments of
!> the other surface and of slave segments, points at fixed positions of segments.
!>
!> Contact is searched among candidate pairs alone: master segments near each slave segment. A
!> separated point at distance d from all of its candidates is skipped until `travel` has grown by
!> d: the sum over all steps of a bound on how far any two nodes of the interface have moved
!> relative to each other.
module search_state_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t, length, whole
  implicit none
  private
  public :: candidates_t, pass_t, contact_status_t, segment_points_t, segment_status_t, &
    allocate_status, allocate_segments, segment_point_at, separated, active

  !> Status of a contact point: separated or active.
  integer, parameter :: separated = 0, active = 1

  !> Candidate pairs: for each segment of one surface the segments of the other that it may touch
  !> before the lists are made anew. No result depends on them; a restart makes them again.
  type :: candidates_t
    integer, allocatable :: first(:) !! (n_segment + 1) where each row starts ...
    integer, allocatable :: items(:) !! ... on this list of segments of the other surface
  end type candidates_t

  !> What one call asks of the points of one surface over the segments of the other.
  type :: pass_t
    integer :: own_at = 0              !! local number before the first node of the points' surface
    integer :: other_at = 0            !! and before the first node of the other surface
    integer :: n_on_segment = 0        !! points of a segment; 0: points at nodes
    real(wp), allocatable :: xi(:)     !! (n_on_segment) where they are on it
    integer, allocatable :: segment_at(:) !! (n_node) segment that starts at a node of their surface
    logical :: is_self = .false.       !! both surfaces are one
    logical :: is_closed = .false.     !! the points' surface has a closed boundary
    logical :: has_history = .false.   !! increments are those of a step
    logical :: is_trial = .false.      !! of an implicit step, which may lead to any depth
    real(wp) :: travel = 0.0_wp        !! accumulated relative displacement, m
    real(wp) :: closed_gap = 0.0_wp    !! gaps below it are contact, m
    logical :: has_arcs = .false.      !! then gaps up to the heights of arcs make contact points
    real(wp) :: highest = 0.0_wp       !! of these, of both segments together, m
    real(wp), allocatable :: own_height(:)   !! (n_segment) of the points' surface, m
    real(wp), allocatable :: other_height(:) !! (n_segment) of the other surface, m
  end type pass_t

  !> Status of the points of one surface over the segments of the other.
  type, extends(visited_t) :: contact_status_t
    integer :: n = 0                         !! points
    integer :: n_active = 0
    real(wp) :: earliest_search = -huge(1.0_wp) !! travel before which no separated point can touch
    real(wp) :: reach = 0.0_wp               !! search radius: points farther away are unpaired, m
    integer, allocatable :: active_points(:) !! (n) the first n_active: active points, in order
    integer, allocatable :: due(:)           !! (n) scratch: points to be searched one by one
    integer, allocatable :: segment(:)       !! (n) active: its segment; else the closest, 0 = none
    integer, allocatable :: state(:)         !! (n) separated or active
    real(wp), allocatable :: xi(:)           !! (n) 0 to 1 along the segment (a little more at ends)
    real(wp), allocatable :: gap(:)          !! (n) m; up to date while active
    real(wp), allocatable :: normal(:, :)    !! (2, n) from the segment to the point's side
    real(wp), allocatable :: offset(:)       !! (n) entry offset, m: pressure acts from gap + offset
    real(wp), allocatable :: next_search(:)  !! (n) next search time: travel before which the point
                                             !! can not touch; huge while active
    real(wp), allocatable :: faded(:)        !! (n) scratch: by which offsets have faded in this
                                             !! call, m; below 0: the offset is new
    logical :: has_offset = .false.          !! some offset is above 0
    integer :: n_released = 0                !! first contacts deeper than the limit so far
    real(wp), allocatable :: point_depth(:)  !! (n) deepest first contact of a point, m
    real(wp), allocatable :: segment_depth(:) !! (n_segment) deepest first contact of a segment, m
    real(wp) :: shallowest = huge(1.0_wp)    !! smallest of both, m
    type(pass_t) :: pass                     !! of the present call
  contains
    procedure :: visit => visit_status
  end type contact_status_t

  !> Points at fixed positions of every segment of a surface, which move with its nodes; nothing is
  !> allocated where points stand at nodes.
  type, extends(visited_t) :: segment_points_t
    real(wp), allocatable :: positions(:, :) !! (4, n) X, Y, u_x, u_y
    real(wp), allocatable :: xi(:)           !! (points of a segment) where on it they are
    real(wp), allocatable :: share(:)        !! (points of a segment) part of its length they stand
                                             !! for
    real(wp) :: spread = 0.0_wp              !! above 0: a point stands at the centre, by radius, of
                                             !! this part of its segment about its xi
  contains
    procedure :: visit => visit_segment_points
  end type segment_points_t

  !> Status of slave segments whose overlaps make points; nothing is allocated where none do.
  type, extends(visited_t) :: segment_status_t
    integer, allocatable :: state(:)        !! (n) active: overlaps of it are in contact
    real(wp), allocatable :: gap(:)         !! (n) smallest gap of its points at the last look, m
    real(wp), allocatable :: next_search(:) !! (n) travel before which its overlaps can not touch, m
    real(wp) :: earliest_search = -huge(1.0_wp) !! smallest of these, m
    logical, allocatable :: has_points(:)   !! (n) they have been generated in this call
  contains
    procedure :: visit => visit_segments
  end type segment_status_t

contains

  !> Allocate for `n` points over `n_segment` segments.
  pure subroutine allocate_status(status, n, n_segment)
    type(contact_status_t), intent(inout) :: status
    integer, intent(in) :: n, n_segment

    status%n = n
    allocate (status%active_points(n), status%due(n), status%segment(n), status%state(n), &
      source=0)
    allocate (status%xi(n), status%gap(n), status%normal(2, n), status%point_depth(n), &
      status%segment_depth(n_segment), source=0.0_wp)
    allocate (status%offset(n), status%faded(n), source=0.0_wp)
    allocate (status%next_search(n), source=-huge(1.0_wp))
  end subroutine allocate_status

  !> Allocate for `n` slave segments: separated, and due in the first call.
  pure subroutine allocate_segments(segments, n)
    type(segment_status_t), intent(inout) :: segments
    integer, intent(in) :: n

    allocate (segments%state(n), source=separated)
    allocate (segments%gap(n), source=huge(1.0_wp))
    allocate (segments%next_search(n), source=-huge(1.0_wp))
    allocate (segments%has_points(n), source=.false.)
  end subroutine allocate_segments

  !> Which of the points of a segment stands at xi.
  pure function segment_point_at(xi, segment_xi) result(q)
    real(wp), intent(in) :: xi, segment_xi(:)
    integer :: q, i

    q = 1
    do i = 2, size(segment_xi)
      if (abs(segment_xi(i) - xi) < abs(segment_xi(q) - xi)) q = i
    end do
  end function segment_point_at

  !> Visit the components of the status; extremes are found again.
  subroutine visit_status(self, visitor)
    class(contact_status_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('n', self%n)
    call visitor%visit('n_active', self%n_active)
    call visitor%visit('earliest_search', self%earliest_search)
    call visitor%visit('active_points', self%active_points, whole, 0, length(self%active_points), &
      'numbers that no contact point has')
    call visitor%visit('segment', self%segment)
    call visitor%visit('state', self%state, whole, separated, active, &
      'states that do not exist')
    call visitor%visit('xi', self%xi)
    call visitor%visit('gap', self%gap)
    call visitor%visit('normal', self%normal)
    call visitor%visit('offset', self%offset)
    call visitor%visit('has_offset', self%has_offset)
    call visitor%visit('n_released', self%n_released, 0, 10**9, 'a number that no run reaches')
    call visitor%visit('next_search', self%next_search)
    call visitor%visit('point_depth', self%point_depth)
    call visitor%visit('segment_depth', self%segment_depth)
    call visitor%visit('shallowest', self%shallowest)
  end subroutine visit_status

  !> Visit the components of the points at fixed positions of segments.
  subroutine visit_segment_points(self, visitor)
    class(segment_points_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('positions', self%positions)
    call visitor%visit('xi', self%xi)
    call visitor%visit('share', self%share)
    call visitor%visit('spread', self%spread)
  end subroutine visit_segment_points

  !> Visit the components of the status of slave segments.
  subroutine visit_segments(self, visitor)
    class(segment_status_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('state', self%state, whole, separated, active, 'states that do not exist')
    call visitor%visit('gap', self%gap)
    call visitor%visit('next_search', self%next_search)
    call visitor%visit('earliest_search', self%earliest_search)
  end subroutine visit_segments

end module search_state_m
