! SPDX-License-Identifier: MIT
!> The scenes in which all contact formulations are tested, and the table of formulations. A new formulation
!> is one more row of `rows`.
module contact_scenes_m
  use contact_factories_m, only : problem_t, make_problem, line
  use kinds_m, only : wp
  use log_m, only : to_text
  implicit none
  private
  public :: types, n_types, adds_slave_length, adds_master_length, adds_facing_length, keeps_p2, &
    keeps_places, passes_patch, weighs_facing, stands_at_nodes, n_scene, penalty, depth, carried_by, &
    label, make_scene

  !> One row per formulation: number (rows in order of it); then, 0 or 1: areas add up to the slave length (0: a spring of
  !> one stiffness at each node), to the master length too, to the facing length; P2 holds; places of points stay
  !> on their nodes or segments when these move; uniform pressure between flat chains; areas are less where a slave
  !> segment turns away from the master; every slave node in contact has a point, the first on the list.
  integer, parameter :: rows(*) = [ &
    1, 0, 0, 0, 1, 1, 0, 0, 1, &
    2, 1, 0, 0, 1, 1, 0, 0, 1, &
    3, 1, 1, 0, 1, 1, 0, 0, 1, &
    4, 1, 0, 0, 0, 0, 1, 0, 0, &
    5, 1, 0, 1, 1, 1, 1, 1, 1, &
    6, 1, 0, 0, 1, 1, 0, 1, 0, &
    7, 1, 0, 1, 1, 0, 1, 1, 0]
  integer, parameter :: n_column = 9
  integer, parameter :: n_types = size(rows)/n_column
  integer, parameter :: types(n_column, n_types) = reshape(rows, [n_column, n_types])
  integer, parameter :: adds_slave_length = 2, adds_master_length = 3, adds_facing_length = 4, &
    keeps_p2 = 5, keeps_places = 6, passes_patch = 7, weighs_facing = 8, stands_at_nodes = 9
  integer, parameter :: n_scene = 8
  character(16), parameter :: scenes(n_scene) = [character(16) :: 'master finer', 'slave finer', &
    'tilted', 'kinked', 'arc', 'partly facing', 'far away', 'spread segment']
  real(wp), parameter :: penalty = 3.0e6_wp, depth = 0.004_wp

contains

  !> What all springs of the i-th type carry, from what each way to place them would: a spring at each slave node, areas
  !> that add up to the slave length, areas of a second pass.
  pure function carried_by(i, at_nodes, over_slave, over_master) result(carried)
    integer, intent(in) :: i
    real(wp), intent(in) :: at_nodes, over_slave, over_master
    real(wp) :: carried

    carried = merge(over_slave, at_nodes, types(adds_slave_length, i) == 1)
    if (types(adds_master_length, i) == 1) carried = carried + over_master
  end function carried_by

  !> Type and scene, for messages.
  function label(i, k)
    integer, intent(in) :: i, k
    character(:), allocatable :: label

    label = 'type '//to_text(types(1, i))//', '//trim(scenes(k))
  end function label

  !> Scene k for the i-th type, turned by an angle; start_contact is the caller's. Slave below y = 0 by
  !> `depth`, unevenly if `is_uneven`.
  subroutine make_scene(problem, i, k, angle, is_uneven, n_gauss, radius)
    type(problem_t), intent(out) :: problem
    integer, intent(in) :: i, k
    real(wp), intent(in) :: angle
    logical, intent(in) :: is_uneven
    integer, intent(in), optional :: n_gauss
    real(wp), intent(in), optional :: radius !! axisymmetric, so far from the axis
    real(wp), allocatable :: slave(:, :), master(:, :), u(:, :)
    real(wp) :: rotation(2, 2), turn
    integer :: n, j

    allocate (slave, source=line([0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp], merge(4, 7, k == 2)))
    allocate (master, source=line([1.0_wp, 0.0_wp], [0.0_wp, 0.0_wp], merge(9, 5, k == 2)))
    if (k == 6) master = line([1.5_wp, 0.0_wp], [0.35_wp, 0.0_wp], 6)
    if (k == 8) slave = line([0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp], 2)
    if (k == 8) master = line([1.0_wp, 0.0_wp], [0.0_wp, 0.0_wp], 7)
    if (k == 4) master(2, :) = -0.2_wp*abs(master(1, :) - 0.4_wp)
    if (k == 4) slave(2, :) = -0.2_wp*abs(slave(1, :) - 0.4_wp)
    if (k == 5) master(2, :) = -0.3_wp*(master(1, :) - 0.5_wp)**2
    if (k == 5) slave(2, :) = -0.3_wp*(slave(1, :) - 0.5_wp)**2
    n = size(slave, 2)
    allocate (u(2, n + size(master, 2)), source=0.0_wp)
    u(2, :n) = -depth
    if (is_uneven) then
      do j = 1, n
        u(:, j) = u(:, j) - [0.0013_wp, 0.7_wp*depth]*sin(2.0_wp*j)
      end do
    end if
    turn = merge(angle + 0.35_wp, angle, k == 3)
    rotation = reshape([cos(turn), sin(turn), -sin(turn), cos(turn)], [2, 2])
    slave = matmul(rotation, slave)
    master = matmul(rotation, master)
    if (k == 7) slave = slave + 1.0e6_wp
    if (k == 7) master = master + 1.0e6_wp
    if (present(radius)) then
      slave(1, :) = slave(1, :) + radius
      master(1, :) = master(1, :) + radius
    end if
    call make_problem(problem, slave, master, 0.3_wp)
    problem%contact%is_axisymmetric = present(radius)
    problem%motion(1:2, :size(u, 2)) = matmul(rotation, u)
    problem%contact%contact_type = types(1, i)
    problem%contact%penalty = penalty
    problem%contact%n_gauss = 4
    if (present(n_gauss)) problem%contact%n_gauss = n_gauss
  end subroutine make_scene

end module contact_scenes_m
