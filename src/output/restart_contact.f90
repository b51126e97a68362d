! SPDX-License-Identifier: MIT
!> The memory of an interface in a restart file (see restart_state_m).
module restart_contact_m
  use archive_m, only : keep, keep_fixed, keep_same, keep_growing
  use archive_file_m, only : archive_t, enter, leave
  use contact_state_m, only : contact_state_t, contact_points_t, tracking_t, bucket_grid_t, &
    segment_memory_t
  use facing_state_m, only : facing_t, facing_side_t
  use contact_watch_m, only : contact_watch_t, contact_change_t
  use energy_limit_state_m, only : energy_limit_t
  use friction_state_m, only : friction_memory_t
  use interference_state_m, only : interference_memory_t
  use log_m, only : to_text
  use tie_state_m, only : tie_memory_t
  implicit none
  private
  public :: keep_contact

contains

  !> The memory of one interface. One that is read must have been started from the model; its
  !> indices are looked at by `check_contact`.
  subroutine keep_contact(archive, name, contact)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(contact_state_t), intent(inout) :: contact

    call enter(archive, name)
    call keep_same(archive, 'n_slave', contact%n_slave)
    call keep_same(archive, 'n_master', contact%n_master)
    call keep_same(archive, 'nodes', contact%nodes)
    call keep(archive, 'places', contact%places)
    call keep(archive, 'travel', contact%travel)
    call keep(archive, 'advance', contact%advance)
    call keep(archive, 'is_stale', contact%is_stale)
    call keep(archive, 'next_search', contact%next_search)
    call keep(archive, 'spots', contact%spots)
    call keep(archive, 'spot_xi', contact%spot_xi)
    call keep(archive, 'spot_share', contact%spot_share)
    call keep(archive, 'spot_spread', contact%spot_spread)
    call keep_tracking(archive, 'slave_tracking', contact%slave_tracking)
    call keep_tracking(archive, 'master_tracking', contact%master_tracking)
    call keep_segments(archive, 'segments', contact%segments)
    call keep_facing(archive, 'facing', contact%facing)
    call keep_points(archive, 'points', contact%points)
    call keep(archive, 'closed_gap', contact%closed_gap)
    call keep(archive, 'node_pressure', contact%node_pressure)
    call keep(archive, 'force', contact%force)
    call keep_same(archive, 'contact_law', contact%contact_law)
    call keep(archive, 'slave_penalty', contact%slave_penalty)
    call keep(archive, 'master_penalty', contact%master_penalty)
    call keep(archive, 'node_penalty', contact%node_penalty)
    call keep(archive, 'damping_force', contact%damping_force)
    call keep_friction(archive, 'friction', contact%friction)
    call keep_interference(archive, 'interference', contact%interference)
    call keep_ties(archive, 'ties', contact%ties)
    call keep(archive, 'energy', contact%energy)
    call keep(archive, 'damping_work', contact%damping_work)
    call keep_watch(archive, 'watch', contact%watch)
    call keep_limit(archive, 'limit', contact%limit)
    call keep(archive, 'n_active', contact%n_active)
    call keep(archive, 'rules_step', contact%rules_step)
    call keep(archive, 'n_released', contact%n_released)
    call keep(archive, 'n_swept', contact%n_swept)
    call keep(archive, 'n_dropped', contact%n_dropped)
    call leave(archive)
  end subroutine keep_contact

  !> What its friction remembers.
  subroutine keep_friction(archive, name, friction)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(friction_memory_t), intent(inout) :: friction

    call enter(archive, name)
    call keep(archive, 'traction', friction%traction)
    call keep(archive, 'state', friction%state)
    call keep(archive, 'slip', friction%slip)
    call keep(archive, 'force', friction%force)
    call keep(archive, 'work', friction%work)
    call keep(archive, 'stored', friction%stored)
    call leave(archive)
  end subroutine keep_friction

  !> What it remembers of an initial overlap that grows.
  subroutine keep_interference(archive, name, interference)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(interference_memory_t), intent(inout) :: interference

    call enter(archive, name)
    call keep(archive, 'depth', interference%depth)
    call keep(archive, 'left', interference%left)
    call keep(archive, 'moment', interference%moment)
    call keep(archive, 'work', interference%work)
    call leave(archive)
  end subroutine keep_interference

  !> What a tied interface has frozen.
  subroutine keep_ties(archive, name, ties)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(tie_memory_t), intent(inout) :: ties

    call enter(archive, name)
    call keep(archive, 'first', ties%first)
    call keep(archive, 'owner', ties%owner)
    call keep(archive, 'side', ties%side)
    call keep(archive, 'lag', ties%lag)
    call keep(archive, 'offset', ties%offset)
    call keep(archive, 'traction', ties%traction)
    call keep(archive, 'state', ties%state)
    call keep(archive, 'place', ties%place)
    call keep(archive, 'to_stress', ties%to_stress)
    call keep(archive, 'spent', ties%spent)
    call keep(archive, 'first_break', ties%first_break)
    call keep(archive, 'last_break', ties%last_break)
    call leave(archive)
  end subroutine keep_ties

  !> What is known of its energy.
  subroutine keep_watch(archive, name, watch)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(contact_watch_t), intent(inout) :: watch
    integer :: i

    call enter(archive, name)
    call keep(archive, 'is_due', watch%is_due)
    call keep(archive, 'has_looked', watch%has_looked)
    call keep(archive, 'stored', watch%stored)
    call keep(archive, 'load', watch%load)
    call keep(archive, 'node', watch%node)
    call keep(archive, 'balance', watch%balance)
    do i = 1, size(watch%changes)
      call keep_change(archive, to_text(i), watch%changes(i))
    end do
    call leave(archive)
  end subroutine keep_watch

  !> Its largest change of one sign.
  subroutine keep_change(archive, name, change)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(contact_change_t), intent(inout) :: change

    call enter(archive, name)
    call keep(archive, 'amount', change%amount)
    call keep(archive, 'node', change%node)
    call keep_fixed(archive, 'place', change%place)
    call keep(archive, 'time', change%time)
    call keep(archive, 'warned', change%warned)
    call leave(archive)
  end subroutine keep_change

  !> What the energy law remembers.
  subroutine keep_limit(archive, name, limit)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(energy_limit_t), intent(inout) :: limit

    call enter(archive, name)
    call keep(archive, 'coming_step', limit%coming_step)
    call keep(archive, 'inverse_mass', limit%inverse_mass)
    call keep(archive, 'velocity', limit%velocity)
    call keep(archive, 'recoil', limit%recoil)
    call keep(archive, 'credit', limit%credit)
    call keep(archive, 'lent', limit%lent)
    call keep(archive, 'loan', limit%loan)
    call keep(archive, 'largest', limit%largest)
    call keep(archive, 'n_loaded', limit%n_loaded)
    call keep(archive, 'n_limited', limit%n_limited)
    call keep(archive, 'least_factor', limit%least_factor)
    call keep(archive, 'least_time', limit%least_time)
    call keep(archive, 'recent', limit%recent)
    call keep(archive, 'warned', limit%warned)
    call leave(archive)
  end subroutine keep_limit

  !> Spots followed over a chain.
  subroutine keep_tracking(archive, name, tracking)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(tracking_t), intent(inout) :: tracking

    call enter(archive, name)
    call keep(archive, 'n', tracking%n)
    call keep(archive, 'n_touching', tracking%n_touching)
    call keep(archive, 'next_wake', tracking%next_wake)
    call keep(archive, 'reach', tracking%reach)
    call keep(archive, 'touching', tracking%touching)
    call keep(archive, 'due', tracking%due)
    call keep(archive, 'segment', tracking%segment)
    call keep(archive, 'status', tracking%status)
    call keep(archive, 'xi', tracking%xi)
    call keep(archive, 'gap', tracking%gap)
    call keep(archive, 'normal', tracking%normal)
    call keep(archive, 'wake', tracking%wake)
    call keep(archive, 'recheck', tracking%recheck)
    call keep(archive, 'spot_depth', tracking%spot_depth)
    call keep(archive, 'segment_depth', tracking%segment_depth)
    call keep(archive, 'chord', tracking%chord)
    call keep_grid(archive, 'grid', tracking%grid)
    call leave(archive)
  end subroutine keep_tracking

  !> Segments sorted into cells.
  subroutine keep_grid(archive, name, grid)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(bucket_grid_t), intent(inout) :: grid

    call enter(archive, name)
    call keep(archive, 'cell', grid%cell)
    call keep(archive, 'least_cell', grid%least_cell)
    call keep(archive, 'filled_at', grid%filled_at)
    call keep_fixed(archive, 'low', grid%low)
    call keep_fixed(archive, 'high', grid%high)
    call keep(archive, 'first', grid%first)
    call keep(archive, 'items', grid%items)
    call leave(archive)
  end subroutine keep_grid

  !> The memory of slave segments.
  subroutine keep_segments(archive, name, segments)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(segment_memory_t), intent(inout) :: segments

    call enter(archive, name)
    call keep(archive, 'status', segments%status)
    call keep(archive, 'wake', segments%wake)
    call keep(archive, 'next_wake', segments%next_wake)
    call leave(archive)
  end subroutine keep_segments

  !> Runs of facing segments. The present interface is made of them again.
  subroutine keep_facing(archive, name, facing)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(facing_t), intent(inout) :: facing

    call enter(archive, name)
    call keep_same(archive, 'is_used', facing%is_used)
    call keep(archive, 'next_look', facing%next_look)
    call keep(archive, 'n_look', facing%n_look)
    call keep(archive, 'n_change', facing%n_change)
    call keep_side(archive, 'slave', facing%slave)
    call keep_side(archive, 'master', facing%master)
    call leave(archive)
  end subroutine keep_facing

  !> The runs of one surface.
  subroutine keep_side(archive, name, side)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(facing_side_t), intent(inout) :: side

    call enter(archive, name)
    call keep(archive, 'n', side%n)
    call keep(archive, 'segments', side%segments)
    call keep(archive, 'is_cut', side%is_cut)
    call leave(archive)
  end subroutine keep_side

  !> Contact points.
  subroutine keep_points(archive, name, points)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(contact_points_t), intent(inout) :: points

    call enter(archive, name)
    call keep(archive, 'n', points%n)
    call keep_growing(archive, 'slave_nodes', points%slave_nodes)
    call keep_growing(archive, 'slave_weights', points%slave_weights)
    call keep_growing(archive, 'master_nodes', points%master_nodes)
    call keep_growing(archive, 'master_weights', points%master_weights)
    call keep_growing(archive, 'normal', points%normal)
    call keep_growing(archive, 'gap', points%gap)
    call keep_growing(archive, 'area', points%area)
    call keep_growing(archive, 'stiffness', points%stiffness)
    call keep_growing(archive, 'pressure', points%pressure)
    call keep_growing(archive, 'load', points%load)
    call keep_growing(archive, 'traction', points%traction)
    call leave(archive)
  end subroutine keep_points

end module restart_contact_m
