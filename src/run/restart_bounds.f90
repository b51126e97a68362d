! SPDX-License-Identifier: MIT
!> Whether the numbers of a state that was read may be used: every index lies within what it points
!> at, and every list is one. Shapes, and bounds that one component has, are looked at where they
!> are visited. A restart file may come from elsewhere: its checksum says that it is whole, not that
!> it is sound.
module restart_bounds_m
  use archive_m, only : archive_t
  use contact_state_m, only : contact_state_t, tracking_t, is_free, is_touching
  use contacts_m, only : contact_t
  use law_state_m, only : is_open, is_held, is_broken
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use state_m, only : state_t
  implicit none
  private
  public :: check_state


contains

  !> Look at a whole state; the first thing that is wrong is told as an error of the archive. A
  !> phase before time zero is one that the deck has, with a velocity of each node.
  subroutine check_state(model, state, archive)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state      !! of the shapes of the model
    type(archive_t), intent(inout) :: archive
    logical :: fits
    integer :: i

    associate (relaxation => state%relaxation)
      call archive%expect('state/relaxation/n', relaxation%n == 0 .or. (relaxation%n > 0 .and. &
        model%controls%relaxation%is_on), 'a phase that the deck does not ask for')
      fits = allocated(relaxation%velocity) .eqv. relaxation%n > 0
      if (fits .and. relaxation%n > 0) fits = all(shape(relaxation%velocity) == &
        [2, size(state%motion, 2)])
      call archive%expect('state/relaxation/velocity', fits, 'another number of velocities ' &
        //'than there are nodes')
      call archive%expect('state/time', relaxation%n == 0 .or. .not. state%time > 0.0_wp, &
        'a time after that of the relaxation')
    end associate
    do i = 1, size(state%contacts)
      call check_contact(state%outlines(i), state%contacts(i), &
        'state/contacts/'//to_text(i)//'/', archive)
    end do
  end subroutine check_state

  !> The memory of one interface.
  subroutine check_contact(contact, memory, folder, archive)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    character(*), intent(in) :: folder
    type(archive_t), intent(inout) :: archive
    integer :: n_segments(2), n_spot

    call check_points(memory, folder//'points/', archive)
    if (allocated(archive%error)) return
    if (allocated(memory%ties%side)) call check_ties(memory, folder//'ties/', archive)
    if (allocated(archive%error)) return
    n_segments = [contact%slave%n_segment, contact%master%n_segment]
    n_spot = memory%n_slave
    if (allocated(memory%spot_xi)) n_spot = size(memory%spot_xi)*n_segments(1)
    call check_tracking(memory%slave_tracking, n_spot, n_segments(2), &
      folder//'slave_tracking/', archive)
    if (allocated(archive%error)) return
    call check_tracking(memory%master_tracking, memory%n_master, n_segments(1), &
      folder//'master_tracking/', archive)
  end subroutine check_contact

  !> The list of points: as many in all its arrays, and nodes of the interface.
  subroutine check_points(memory, folder, archive)
    type(contact_state_t), intent(in) :: memory
    character(*), intent(in) :: folder
    type(archive_t), intent(inout) :: archive
    integer :: n_local
    logical :: fits

    associate (points => memory%points)
      fits = allocated(points%slave_nodes) .and. allocated(points%master_nodes) .and. &
        allocated(points%slave_weights) .and. allocated(points%master_weights) .and. &
        allocated(points%normal) .and. allocated(points%gap) .and. allocated(points%area) .and. &
        allocated(points%stiffness) .and. allocated(points%pressure)
      if (fits) fits = all([size(points%slave_nodes, 2), size(points%master_nodes, 2), &
        size(points%slave_weights, 2), size(points%master_weights, 2), size(points%normal, 2), &
        size(points%area), size(points%stiffness), size(points%pressure)] == size(points%gap))
      if (fits .and. allocated(points%load)) fits = size(points%load, 2) == size(points%gap)
      if (fits .and. allocated(points%traction)) fits = size(points%traction) == size(points%gap)
      call archive%expect(folder//'gap', fits, 'not as many values as the arrays beside it')
      if (allocated(archive%error)) return
      call archive%expect(folder//'n', points%n >= 0 .and. points%n <= size(points%gap), &
        'a number beyond the length of the list')
      n_local = memory%n_slave + memory%n_master
      call archive%expect(folder//'slave_nodes', all(points%slave_nodes >= 1 &
        .and. points%slave_nodes <= n_local), 'numbers that no node of the interface has')
      call archive%expect(folder//'master_nodes', all(points%master_nodes >= 1 &
        .and. points%master_nodes <= n_local), 'numbers that no node of the interface has')
    end associate
  end subroutine check_points

  !> Springs of ties, as many as the deck makes: their points follow each other, nodes and places
  !> are those of the interface.
  subroutine check_ties(memory, folder, archive)
    type(contact_state_t), intent(in) :: memory
    character(*), intent(in) :: folder
    type(archive_t), intent(inout) :: archive
    integer :: n, n_place

    associate (ties => memory%ties)
      n = size(ties%side)
      n_place = memory%n_master + memory%n_slave
      if (allocated(memory%spots)) n_place = memory%n_master + size(memory%spot_xi)*memory%n_slave
      if (allocated(ties%state)) then
        call archive%expect(folder//'state', all(ties%state == is_open .or. ties%state &
          == is_held .or. ties%state == is_broken), 'numbers that mean nothing')
        call archive%expect(folder//'place', all(ties%place >= merge(0, 1, &
          allocated(memory%node_pressure)) .and. ties%place <= n_place), &
          'numbers that no place of the interface has')
      end if
      call archive%expect(folder//'first', ties%first(1) == 1 &
        .and. all(ties%first(2:) > ties%first(:n)) .and. (ties%first(n + 1) == memory%points%n + 1 &
        .or. memory%points%n == 0), 'numbers that do not rise to the number of points')
      call archive%expect(folder//'owner', all(ties%owner >= 1 .and. ties%owner &
        <= memory%n_slave + memory%n_master), 'numbers that no node of the interface has')
    end associate
  end subroutine check_ties

  !> Spots followed over a chain.
  subroutine check_tracking(tracking, n_spot, n_segment, folder, archive)
    type(tracking_t), intent(in) :: tracking
    integer, intent(in) :: n_spot       !! spots, where there are any
    integer, intent(in) :: n_segment    !! of the chain
    character(*), intent(in) :: folder
    type(archive_t), intent(inout) :: archive
    integer :: n

    n = tracking%n
    if (.not. allocated(tracking%status)) then
      call archive%expect(folder//'n', n == 0, 'another number of spots than there are')
      call archive%expect(folder//'n_touching', tracking%n_touching == 0, &
        'spots that are not there')
      return
    end if
    call archive%expect(folder//'n', n == n_spot, 'another number of spots than there are')
    call archive%expect(folder//'n_touching', tracking%n_touching >= 0 &
      .and. tracking%n_touching <= n, 'more than there are spots')
    call archive%expect(folder//'segment', all(tracking%segment >= 0 &
      .and. tracking%segment <= n_segment), 'numbers that no segment has')
    call archive%expect(folder//'status', all(tracking%status == is_free &
      .or. tracking%segment > 0), 'spots that stand before no segment')
    if (allocated(archive%error)) return
    call archive%expect(folder//'touching', is_list(tracking%touching(:tracking%n_touching), n), &
      'spots that stand on its list twice')
    if (allocated(archive%error)) return
    call archive%expect(folder//'touching', all(tracking%status( &
      tracking%touching(:tracking%n_touching)) == is_touching), 'spots that do not touch')
    call archive%expect(folder//'n_touching', count(tracking%status == is_touching) &
      == tracking%n_touching, 'another number than there are spots in contact')
  end subroutine check_tracking

  !> Whether numbers are from 1 to n, each at most once.
  pure function is_list(numbers, n)
    integer, intent(in) :: numbers(:)
    integer, intent(in) :: n
    logical :: is_list
    logical, allocatable :: is_used(:)
    integer :: i

    allocate (is_used(n), source=.false.)
    is_list = .false.
    do i = 1, size(numbers)
      if (numbers(i) < 1 .or. numbers(i) > n) return
      if (is_used(numbers(i))) return
      is_used(numbers(i)) = .true.
    end do
    is_list = .true.
  end function is_list

end module restart_bounds_m
