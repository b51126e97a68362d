! SPDX-License-Identifier: MIT
!> Warning at the start of places of the slave that stand just beyond an end of the master. Such a
!> place sinks beside the end without a spring; when the bodies spread it comes in over the end and
!> is caught at that depth by a whole spring, which makes energy at any time step
!> (doc/theory/contact.md, section 7.5).
module contact_overhang_m
  use contact_dispatch_m, only : formulation_t, formulation_of, covering_names
  use contact_state_m, only : contact_state_t, tracking_t
  use contacts_m, only : contact_t
  use foot_m, only : see_segment, end_tolerance
  use geometry_m, only : sight_t, sight_gap, separation
  use kinds_m, only : wp
  use log_m, only : log_t, warn, to_text
  use model_m, only : model_t
  use surfaces_m, only : surface_t, meets_axis
  use units_m, only : in_units
  implicit none
  private
  public :: overhang_t, report_overhang, find_overhang

  !> Deepest first contact that keeps the energy of a catch at a hundredth of what it may be by
  !> default.
  real(wp), parameter :: cautious = 0.1_wp
  !> Part of its deepest first contact (half of the shorter of its own segments) within which a
  !> place is just beyond an end.
  real(wp), parameter :: just_beyond = 0.5_wp
  !> Cosine between the directions of a place's own surface and the end segment below which they
  !> face each other.
  real(wp), parameter :: facing = -0.5_wp

  !> Places of the slave just beyond ends of the master.
  type :: overhang_t
    integer :: n = 0                !! how many
    integer :: spot = 0             !! the nearest to its end
    integer :: segment = 0          !! segment of the master at that end
    integer :: node = 0             !! node of the master there, local number
    real(wp) :: distance = huge(1.0_wp) !! how far it is beyond, m
  end type overhang_t

contains

  !> Warn of one interface, unless the deck limits first contacts or what is beyond the end weighs
  !> nothing.
  subroutine report_overhang(contact, model, memory, log)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(in) :: memory
    type(log_t), intent(inout) :: log
    type(formulation_t) :: formulation

    formulation = formulation_of(contact)
    if (formulation%covers_segments .or. contact%search_depth > 0.0_wp) return
    if (contact%is_self) return ! its runs end where nothing touches
    if (memory%facing%is_used) then
      call report_between(memory%facing%present, model, memory, log)
    else
      call report_between(contact, model, memory, log)
    end if
  end subroutine report_overhang

  !> The same between two surfaces, or present runs of them.
  subroutine report_between(contact, model, memory, log)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(in) :: memory
    type(log_t), intent(inout) :: log
    type(overhang_t) :: found
    character(:), allocatable :: place
    real(wp) :: limit

    if (allocated(memory%spots)) then
      call find_overhang(contact%master, memory%places(:, memory%n_slave + 1:), memory%spots, &
        memory%slave_tracking, found)
    else
      call find_overhang(contact%master, memory%places(:, memory%n_slave + 1:), &
        memory%places(:, :memory%n_slave), memory%slave_tracking, found)
    end if
    if (found%n == 0) return
    limit = min(memory%slave_tracking%spot_depth(found%spot), &
      memory%slave_tracking%segment_depth(found%segment))
    place = merge('a point at slave node', 'slave node           ', allocated(memory%spots))
    call warn(log, 'interface '//to_text(contact%id)//': '//trim(place)//' ' &
      //to_text(model%mesh%node_id(contact%slave%nodes(spot_node(contact, memory, found%spot)))) &
      //' stands '//to_text(found%distance)//in_units(model%controls%units, 'L') &
      //' beyond the end of the master at node ' &
      //to_text(model%mesh%node_id(contact%master%nodes(found%node)))//others(found%n - 1) &
      //'; should it sink there and come in over the end, it is caught up to '//to_text(limit) &
      //in_units(model%controls%units, 'L')//' deep, which makes energy at any time ' &
      //'step: SRCH '//to_text(cautious*limit) &
      //' would prevent it, '//covering_names()//' do without')
  end subroutine report_between

  !> Words on further places.
  function others(n) result(text)
    integer, intent(in) :: n
    character(:), allocatable :: text

    text = ''
    if (n > 0) text = ' (and '//to_text(n)//' more)'
  end function others

  !> Slave node at or nearest to a spot, local number.
  pure function spot_node(contact, memory, spot) result(node)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: spot
    integer :: node
    integer :: n

    node = spot
    if (.not. allocated(memory%spots)) return
    n = size(memory%spot_xi)
    associate (xi => memory%spot_xi(1 + modulo(spot - 1, n)))
      node = contact%slave%segments(merge(1, 2, xi < 0.5_wp), 1 + (spot - 1)/n)
    end associate
  end function spot_node

  !> Look at both ends of every open chain.
  pure subroutine find_overhang(master, chain, spots, tracking, found)
    type(surface_t), intent(in) :: master
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :) !! (4, n) places
    type(tracking_t), intent(in) :: tracking                     !! of the spots over the chain
    type(overhang_t), intent(out) :: found
    real(wp) :: distance
    integer :: segment, i, k

    do segment = 1, master%n_segment
      do k = 1, 2
        if (merge(master%previous(segment), master%next(segment), k == 1) > 0) cycle
        if (meets_axis(master, segment, k == 1)) cycle
        do i = 1, tracking%n
          distance = distance_beyond(master, chain, spots, tracking, segment, k == 1, i)
          if (distance > just_beyond*tracking%spot_depth(i)) cycle
          found%n = found%n + 1
          if (distance >= found%distance) cycle
          found = overhang_t(found%n, i, segment, master%segments(k, segment), distance)
        end do
      end do
    end do
  end subroutine find_overhang

  !> How far spot `i` stands beyond the first or the last end of a segment, along it; huge where it
  !> is not beyond the tolerance, out of reach, or where its own surface does not face the segment.
  pure function distance_beyond(master, chain, spots, tracking, segment, is_first, &
      i) result(distance)
    type(surface_t), intent(in) :: master
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :)
    type(tracking_t), intent(in) :: tracking
    integer, intent(in) :: segment, i
    logical, intent(in) :: is_first
    real(wp) :: distance
    type(sight_t) :: sight
    real(wp) :: length, beyond, along(2)

    distance = huge(1.0_wp)
    if (.not. tracking%wake(i) < huge(1.0_wp)) return ! part of no run
    sight = see_segment(master, chain, spots(:, i), segment)
    length = sqrt(sight%square)
    beyond = merge(-sight%along, sight%along - sight%square, is_first)/length
    if (beyond <= end_tolerance*length .or. abs(sight_gap(sight)) > tracking%reach) return
    along = separation(spots(:, tracking%chord(2, i)), spots(:, tracking%chord(1, i)))
    if (dot_product(along, sight%t) < facing*norm2(along)*length) distance = beyond
  end function distance_beyond

end module contact_overhang_m
