! SPDX-License-Identifier: MIT
!> Whether the numbers of a state that was read may be used: every index lies within what it points
!> at, and every list is one. Shapes, and bounds that one component has, are looked at where they
!> are visited. A restart file may come from elsewhere: its checksum says that it is whole, not that
!> it is sound.
module restart_bounds_m
  use archive_m, only : archive_t
  use contact_state_m, only : contact_state_t, tracking_t, bucket_grid_t, is_free, is_touching
  use contacts_m, only : contact_t
  use facing_state_m, only : facing_side_t
  use law_state_m, only : is_open, is_held, is_broken
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use state_m, only : state_t
  implicit none
  private
  public :: check_state

  !> Cells of the smallest side that the reach of a search takes, at most: 100 but for rounding.
  real(wp), parameter :: most_cells = 101.0_wp

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
    if (allocated(memory%ties%side)) call check_ties(memory, folder//'ties/', archive)
    n_segments = [contact%slave%n_segment, contact%master%n_segment]
    if (memory%facing%is_used) then
      call check_side(memory%facing%slave, n_segments(1), folder//'facing/slave/', archive)
      call check_side(memory%facing%master, n_segments(2), folder//'facing/master/', archive)
      n_segments = [memory%facing%slave%n, memory%facing%master%n]
    end if
    n_spot = memory%n_slave
    if (allocated(memory%spot_xi)) n_spot = size(memory%spot_xi)*n_segments(1)
    call check_tracking(memory%slave_tracking, n_spot, n_segments(2), &
      folder//'slave_tracking/', archive)
    call check_tracking(memory%master_tracking, memory%n_master, n_segments(1), &
      folder//'master_tracking/', archive)
  end subroutine check_contact

  !> Runs of facing segments of one surface: rising numbers of segments that there are.
  subroutine check_side(side, n, folder, archive)
    type(facing_side_t), intent(in) :: side
    integer, intent(in) :: n !! segments of the surface
    character(*), intent(in) :: folder
    type(archive_t), intent(inout) :: archive

    call archive%expect(folder//'n', side%n >= 0 .and. side%n <= n, &
      'a number beyond the length of its list')
    if (allocated(archive%error)) return
    call archive%expect(folder//'segments', all(side%segments(:side%n) >= 1 &
      .and. side%segments(:side%n) <= n) .and. all(side%segments(2:side%n) &
      > side%segments(:side%n - 1)), 'numbers that do not rise, or that no segment has')
  end subroutine check_side

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
    logical, allocatable :: is_listed(:)
    integer :: n

    n = tracking%n
    if (.not. allocated(tracking%status)) then
      call archive%expect(folder//'n', n == 0, 'another number of spots than there are')
      call archive%expect(folder//'n_touching', tracking%n_touching == 0, &
        'spots that are not there')
      return
    end if
    call archive%expect(folder//'n', n == n_spot, 'another number of spots than there are')
    call archive%expect(folder//'chord', all(tracking%chord >= 1 &
      .and. tracking%chord <= max(1, n)), 'numbers that no spot has')
    call archive%expect(folder//'segment', all(tracking%segment >= 0 &
      .and. tracking%segment <= n_segment), 'numbers that no segment has')
    call archive%expect(folder//'status', all(tracking%status == is_free &
      .or. tracking%segment > 0), 'spots that stand before no segment')
    call archive%expect(folder//'n_touching', count(tracking%status == is_touching) &
      == tracking%n_touching, 'another number than there are spots in contact')
    if (allocated(archive%error)) return
    allocate (is_listed(0:n), source=.false.)
    is_listed(tracking%touching(:tracking%n_touching)) = .true.
    call archive%expect(folder//'touching', all(is_listed(1:) .eqv. tracking%status &
      == is_touching), 'spots that are not those in contact, each once')
    call archive%expect(folder//'reach', tracking%reach >= 0.0_wp .and. tracking%reach &
      <= most_cells*tracking%grid%least_cell, 'a distance that does not fit its cells')
    call check_grid(tracking%grid, n_segment, folder//'grid/', archive)
  end subroutine check_tracking

  !> Segments in cells: each bucket ends where the next one starts.
  subroutine check_grid(grid, n_segment, folder, archive)
    type(bucket_grid_t), intent(in) :: grid
    integer, intent(in) :: n_segment
    character(*), intent(in) :: folder
    type(archive_t), intent(inout) :: archive
    integer :: n

    n = size(grid%first)
    if (.not. grid%cell > 0.0_wp) return ! never filled, or to be filled anew
    call archive%expect(folder//'cell', grid%cell >= grid%least_cell .and. &
      grid%cell > tiny(1.0_wp), 'a side below the smallest')
    call archive%expect(folder//'first', grid%first(1) >= 0 .and. grid%first(n) &
      <= size(grid%items) .and. all(grid%first(2:) >= grid%first(:n - 1)), &
      'places that do not follow each other in its list')
    if (allocated(archive%error)) return
    call archive%expect(folder//'items', all(grid%items(grid%first(1) + 1:grid%first(n)) >= 1 &
      .and. grid%items(grid%first(1) + 1:grid%first(n)) <= n_segment), &
      'numbers that no segment has')
  end subroutine check_grid

end module restart_bounds_m
