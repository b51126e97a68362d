! SPDX-License-Identifier: MIT
!> Points of many spots, placed, pressed and scattered range by range in the same columns of the
!> list, which stay in the cache: a whole list of 100,000 slave nodes goes to the memory and back (a
!> quarter of the contact of type 4). Formulations that can place some points without the others
!> come here.
module contact_ranges_m
  use clock_m, only : clock_t, lap, phase_contact_pairing, phase_contact_force
  use contact_dispatch_m, only : place_points, place_range, places_ranges
  use contact_penalty_m, only : press_points
  use contact_springs_m, only : add_springs
  use contact_scatter_m, only : end_t, scatter_range, close_run
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: range_size, goes_in_ranges, press_ranges, is_listed, list_again

  !> Spots of a range; so many or fewer have a whole list. From 500 to 2000 it makes little
  !> difference; a multiple of what formulations place together keeps the points in their order.
  integer, parameter :: range_size = 1024

contains

  !> Whether there is no whole list. Damping and the energy of the start ask for one.
  pure function goes_in_ranges(contact, cycle, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: cycle
    type(contact_state_t), intent(in) :: memory
    logical :: goes_in_ranges

    goes_in_ranges = .false.
    if (memory%slave_tracking%n_touching <= range_size .or. contact%damping > 0.0_wp .or. cycle &
      == 0) return
    goes_in_ranges = places_ranges(contact)
  end function goes_in_ranges

  !> Place, press and scatter, counting the points that carry pressure. The list is empty in the
  !> end.
  subroutine press_ranges(contact, clock, memory)
    type(contact_t), intent(in) :: contact
    type(clock_t), intent(inout) :: clock
    type(contact_state_t), intent(inout) :: memory
    type(end_t) :: run(4)
    integer :: first

    associate (n => memory%slave_tracking%n_touching)
      do first = 1, n, range_size
        call place_range(contact, first, min(first + range_size - 1, n), memory)
        call lap(clock, phase_contact_pairing)
        call press_points(memory)
        call scatter_range(memory%points, run, memory%force, memory%n_active)
        if (memory%watch%is_due) call add_springs(memory)
        call lap(clock, phase_contact_force)
      end do
    end associate
    call close_run(run, memory%force)
    memory%points%n = 0
  end subroutine press_ranges

  !> Whether the points of the last call are on the list. If not, some carry pressure and none is
  !> there.
  pure function is_listed(memory)
    type(contact_state_t), intent(in) :: memory
    logical :: is_listed

    is_listed = memory%points%n > 0 .or. memory%n_active == 0
  end function is_listed

  !> List them all for those who ask for single points.
  pure subroutine list_again(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory

    call place_points(contact, memory)
    call press_points(memory)
  end subroutine list_again

end module contact_ranges_m
