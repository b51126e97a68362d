! SPDX-License-Identifier: MIT
!> The search for two spots on each slave segment, where nobody else asks for their places: these are formed from the nodes' on
!> the way. Only spots that are looked at one by one get a place that is kept; to move all took a pass of its own through the
!> memory.
module contact_spot_keeping_m
  use contact_keeping_m, only : project_block, list_left, block_size
  use contact_lists_m, only : list_touching
  use contact_search_m, only : list_due, update_due
  use contact_spots_m, only : move_segment
  use contact_state_m, only : contact_state_t, tracking_t
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: track_spots

contains

  !> Bring the pairs of all spots up to date and list the spots in contact.
  pure subroutine track_spots(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer :: n_left, n_due
    logical :: has_changed

    associate (tracking => memory%slave_tracking, slave => contact%slave, first => memory%n_slave + 1)
      tracking%has_feet = .true.
      if (tracking%n_touching == 0 .and. memory%travel < tracking%next_wake) return
      call keep_spots(contact%master%segments, memory%places(1, first), slave%segments, memory%places, &
        memory%spot_xi, tracking, n_left)
      if (n_left == 0 .and. memory%travel < tracking%next_wake) return
      call list_due(tracking, memory%travel, n_left, n_due)
      call move_due(n_left, n_due, tracking, slave%segments, memory%places, memory%spot_xi, memory%spots)
      call update_due(tracking, contact%master, memory%places(:, first:), memory%spots, memory%travel, n_left, &
        n_due, memory%n_released, has_changed)
      if (has_changed) call list_touching(tracking)
    end associate
  end subroutine track_spots

  !> Spots in contact that stay where they are; the others are listed.
  pure subroutine keep_spots(ends, chain, segments, places, spot_xi, tracking, n_left)
    integer, intent(in) :: ends(2, *)      !! of the master segments
    real(wp), intent(in) :: chain(4, *)    !! places of the master nodes
    integer, intent(in) :: segments(2, *)  !! of the slave
    real(wp), intent(in) :: places(4, *), spot_xi(2)
    type(tracking_t), intent(inout) :: tracking
    integer, intent(out) :: n_left         !! spots that were not kept: `tracking%due`
    real(wp) :: edge(2, block_size), way(2, block_size), normal(2, block_size)
    real(wp), dimension(block_size) :: xi, gap, beside
    integer :: first, n, i, k, n_beside

    n_left = 0
    do first = 1, tracking%n_touching, block_size
      n = min(block_size, tracking%n_touching - first + 1)
      call see_spots(n, tracking%touching(first), tracking%segment, ends, chain, segments, places, spot_xi, &
        edge, way)
      i = tracking%touching(first)
      if (tracking%touching(first + n - 1) == i + n - 1) then
        call project_block(n, edge, way, tracking%xi(i), tracking%gap(i), tracking%normal(1, i), beside, n_beside)
      else
        call project_block(n, edge, way, xi, gap, normal, beside, n_beside)
        do k = 1, n
          i = tracking%touching(first + k - 1)
          tracking%xi(i) = xi(k)
          tracking%gap(i) = gap(k)
          tracking%normal(1, i) = normal(1, k)
          tracking%normal(2, i) = normal(2, k)
        end do
      end if
      if (n_beside > 0) call list_left(n, beside, first, tracking%due, n_left)
    end do
  end subroutine keep_spots

  !> Vectors of a block of spots.
  pure subroutine see_spots(n, touching, segment, ends, chain, segments, places, spot_xi, edge, way)
    integer, intent(in) :: n, touching(n), segment(*), ends(2, *), segments(2, *)
    real(wp), intent(in) :: chain(4, *), places(4, *), spot_xi(2)
    real(wp), intent(inout) :: edge(2, block_size) !! segments, m
    real(wp), intent(inout) :: way(2, block_size)  !! from the segments' first nodes, m
    real(wp), dimension(4) :: along, across, one, two
    integer :: i, k, a, b, s

    !GCC$ NOVECTOR
    do k = 1, n
      i = touching(k)
      a = ends(1, segment(i))
      b = ends(2, segment(i))
      s = (i + 1)/2
      along = chain(:, b) - chain(:, a)
      one = places(:, segments(1, s))
      two = places(:, segments(2, s))
      across = (one + spot_xi(2 - iand(i, 1))*(two - one)) - chain(:, a)
      edge(:, k) = along(1:2) + along(3:4)
      way(:, k) = across(1:2) + across(3:4)
    end do
  end subroutine see_spots

  !> Places of the spots on the list, and of the others on their segments, which tell their direction.
  pure subroutine move_due(n_left, n_due, tracking, segments, places, spot_xi, spots)
    integer, intent(in) :: n_left, n_due
    type(tracking_t), intent(in) :: tracking
    integer, intent(in), contiguous :: segments(:, :)
    real(wp), intent(in), contiguous :: places(:, :), spot_xi(:)
    real(wp), intent(inout), contiguous :: spots(:, :)
    integer :: k, i, s

    do k = 1, n_due
      i = tracking%due(k)
      if (k <= n_left) i = tracking%touching(i)
      s = (i + 1)/2
      call move_segment(segments(:, s), places, spot_xi, spots(:, 2*s - 1:2*s))
    end do
  end subroutine move_due

end module contact_spot_keeping_m
