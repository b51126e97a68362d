! SPDX-License-Identifier: MIT
!> The global search of a surface in contact with itself (doc/theory/contact.md, section 3.8). Slave
!> and master are one list of runs, so that spots and segments have numbers in common. A spot counts
!> only with runs other than its own, with what it is before or its own side is turned towards, and
!> not with the back of the wall that it stands on.
module self_search_m
  use contact_state_m, only : tracking_t
  use facing_m, only : is_own
  use foot_m, only : foot_t, face_on, side_on, see_segment, closest_foot
  use geometry_m, only : sight_normal, closest_distance, separation
  use grid_m, only : nearest_t, kept_t, cell_of, bucket_of, keep_nearest, conclude
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: find_nearest_other, is_elsewhere, may_meet

  !> Deepest place of a spot behind a segment, by the depth that is caught there: deeper ones stand
  !> before the far side of something.
  real(wp), parameter :: behind = 1.5_wp

  !> What a segment is to a spot: part of its own run, which is never met; nothing as the bodies
  !> stand, but it may be when they have moved; something that it may meet.
  integer, parameter :: is_own_run = 0, is_averted = 1, is_met = 2

  type :: role_t
    integer :: is = is_own_run
    real(wp) :: sleep = 0.0_wp !! square of the motion after which what is averted may be met, m^2
  end type role_t

contains

  !> Nearest segment that spot `i` may meet, if there is one within the reach. The bounds are those
  !> of `find_nearest`, for all segments but those of its own run.
  pure subroutine find_nearest_other(tracking, surface, chain, spots, i, travel, any_depth, nearest)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :) !! (4, n) places
    integer, intent(in) :: i
    real(wp), intent(in) :: travel
    logical, intent(in) :: any_depth !! the spot is known to be inside of something
    type(nearest_t), intent(out) :: nearest
    type(kept_t) :: kept
    real(wp) :: bound, averted, slip
    integer :: centre(2), ring, ix, iy, step

    averted = huge(1.0_wp)
    associate (grid => tracking%grid, reach => tracking%reach)
      centre = cell_of(grid, separation(spots(:, i), chain(:, 1)))
      slip = travel - grid%filled_at
      do ring = 0, ceiling((reach + max(0.0_wp, min(slip, reach)))/grid%cell) + 2
        do iy = centre(2) - ring, centre(2) + ring
          step = max(1, merge(1, 2*ring, abs(iy - centre(2)) == ring))
          do ix = centre(1) - ring, centre(1) + ring, step
            call look_into_bucket(tracking, surface, chain, spots, i, bucket_of(grid, ix, iy), &
              any_depth, kept, averted)
          end do
        end do
        bound = max(0.0_wp, ring*grid%cell - slip)
        if (ring >= 1 .and. bound >= min(sqrt(kept%square(1)), reach + grid%cell)) exit
      end do
      call conclude(surface, kept, bound, reach, nearest)
      nearest%other = min(nearest%other, sqrt(averted))
      ! A spot without a segment sleeps by what it is away from more than the reach.
      if (nearest%segment == 0) nearest%distance = min(nearest%distance, reach + sqrt(averted))
    end associate
  end subroutine find_nearest_other

  !> Keep the nearest segments of one bucket that the spot may meet.
  pure subroutine look_into_bucket(tracking, surface, chain, spots, i, bucket, any_depth, kept, &
      averted)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :)
    integer, intent(in) :: i, bucket
    logical, intent(in) :: any_depth
    type(kept_t), intent(inout) :: kept
    real(wp), intent(inout) :: averted !! least square of a distance, m^2
    real(wp) :: square
    type(role_t) :: role
    integer :: k, segment

    do k = tracking%grid%first(bucket) + 1, tracking%grid%first(bucket + 1)
      segment = tracking%grid%items(k)
      if (any(kept%segment == segment)) cycle
      square = closest_distance(see_segment(surface, chain, spots(:, i), segment))
      if (.not. square < kept%square(size(kept%square))) cycle
      role = role_of(tracking, surface, chain, spots, i, segment, any_depth, square)
      select case (role%is)
      case (is_met)
        call keep_nearest(segment, square, kept)
      case (is_averted)
        averted = min(averted, role%sleep)
      end select
    end do
  end subroutine look_into_bucket

  !> Whether a segment belongs to neither the run nor the wall that a spot is on.
  pure function is_elsewhere(tracking, surface, chain, i, segment) result(elsewhere)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :) !! (4, n_node) places
    integer, intent(in) :: i, segment
    logical :: elsewhere
    integer :: beside(2), k

    beside = segments_of(tracking, surface, i)
    elsewhere = .false.
    do k = 1, 2
      if (beside(k) == 0) cycle
      if (surface%chain(beside(k)) == surface%chain(segment)) return
    end do
    elsewhere = .not. is_own(surface, chain, beside, segment)
  end function is_elsewhere

  !> Whether a spot may meet a segment, as it stands: between two surfaces always.
  pure function may_meet(tracking, surface, chain, spots, i, segment)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :)
    integer, intent(in) :: i, segment
    logical :: may_meet
    type(role_t) :: role

    may_meet = tracking%own_spots < 0
    if (may_meet) return
    role = role_of(tracking, surface, chain, spots, i, segment, .false., 0.0_wp)
    may_meet = role%is == is_met
  end function may_meet

  !> What a segment is to a spot. One that it is behind may be met as soon as the spot is less deep,
  !> or has turned: it must be seen then, as deep as it is.
  pure function role_of(tracking, surface, chain, spots, i, segment, any_depth, square) result(role)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :)
    integer, intent(in) :: i, segment
    logical, intent(in) :: any_depth
    real(wp), intent(in) :: square !! of its distance, m^2
    type(role_t) :: role
    integer :: beside(2), k
    type(foot_t) :: foot
    real(wp) :: t(2), least, deep
    logical :: is_past

    beside = segments_of(tracking, surface, i)
    do k = 1, 2
      if (beside(k) == 0) cycle
      if (surface%chain(beside(k)) == surface%chain(segment)) return
    end do
    role%is = is_averted
    role%sleep = square
    if (is_own(surface, chain, beside, segment)) return
    foot = closest_foot(surface, chain, spots(:, i), segment)
    is_past = foot%is_on .and. foot%gap < 0.0_wp
    if (is_past) then
      deep = -foot%gap - behind*tracking%segment_depth(segment)
      role%sleep = max(0.0_wp, deep)**2
      if (deep > 0.0_wp .and. .not. any_depth) return
    end if
    least = side_on
    if (shares_node(surface, beside, segment)) then
      least = face_on
    else if (.not. is_past) then
      ! What a spot has not come behind is the closest for it whichever way it looks: else it would
      ! see through that, and which it sees would change with an angle.
      role%is = is_met
      return
    end if
    t = separation(spots(:, tracking%chord(2, i)), spots(:, tracking%chord(1, i)))
    associate (normal => sight_normal(see_segment(surface, chain, spots(:, i), segment)))
      if (t(2)*normal(1) - t(1)*normal(2) > least*norm2(t)) return
    end associate
    role%is = is_met
  end function role_of

  !> Segments that a spot is on: one, or the two at a node (0: none there).
  pure function segments_of(tracking, surface, i) result(segments)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: i
    integer :: segments(2)

    if (tracking%own_spots == 0) then
      segments = [surface%incoming(i), surface%outgoing(i)]
    else
      segments = 1 + (i - 1)/tracking%own_spots
    end if
  end function segments_of

  !> Whether a segment has a node in common with one of two.
  pure function shares_node(surface, beside, segment) result(shares)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: beside(2), segment
    logical :: shares
    integer :: k

    shares = .false.
    do k = 1, 2
      if (beside(k) == 0) cycle
      shares = shares .or. any(surface%segments(:, beside(k)) == surface%segments(1, segment)) &
        .or. any(surface%segments(:, beside(k)) == surface%segments(2, segment))
    end do
  end function shares_node

end module self_search_m
