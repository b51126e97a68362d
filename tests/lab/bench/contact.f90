! SPDX-License-Identifier: MIT
!> Time of contact alone, whole (search, points, pressure, scatter, energy; the clock takes no laps): two chains
!> that face each other, the slave sliding over the master by 1e-4 of a segment a step. `flat`: all slave nodes
!> touch; `crown`: the slave is part of a circle that dips into a flat master, a third of its nodes touch.
!> `match` and `shift`: two meshes of the same size that move by 1e-6 of a segment, their nodes 1e-7 off their places:
!> nodes opposite nodes, and opposite a place between two. `exact`: as `match`, to round-off and at rest.
!> `slide` and `stick`: `flat` and `shift` with friction, of which all places slip and stick.
!> usage: bench_contact [SLAVE_NODES [TYPE, 0 for all [STEPS [SCENE, '' for all [THREADS]]]]]. Prints a row per scene,
!> size and type: the best and the median of interleaved rounds, ns per step, slave node and point; of this process, or
!> with THREADS on the wall.
program bench_contact
  use, intrinsic :: iso_fortran_env, only : output_unit
  use contact_dispatch_m, only : contact_kinds
  use contact_factories_m, only : problem_t, make_problem, line
  use interface_m, only : start_contact, apply_contact
  use kinds_m, only : wp, long
  implicit none

  integer, parameter :: n_type = size(contact_kinds), n_round = 5, sizes(3) = [20, 1000, 100000]
  character(5), parameter :: scenes(7) = [character(5) :: 'flat', 'crown', 'match', 'shift', &
    'exact', 'slide', 'stick']
  real(wp), parameter :: friction_coefficient = 0.3_wp
  !> Steps times slave nodes of a round.
  integer, parameter :: n_work = 200000
  real(wp), parameter :: slip = 1.0e-4_wp
  !> Part of it in the scenes of meshes of the same size, and how far their nodes are off their places.
  real(wp), parameter :: creep = 1.0e-6_wp, off_place = 1.0e-7_wp
  integer :: i_scene, i_size, chosen(3) !! slave nodes, type and steps of a round asked for, 0: all
  integer :: n_thread !! 0: one, whose own time counts
  character(20) :: argument

  chosen = 0
  do i_size = 1, min(size(chosen), command_argument_count())
    call get_command_argument(i_size, argument)
    read (argument, *) chosen(i_size)
  end do
  n_thread = 0
  if (command_argument_count() > size(chosen) + 1) then
    call get_command_argument(size(chosen) + 2, argument)
    read (argument, *) n_thread
  end if
  argument = ''
  if (command_argument_count() > size(chosen)) call get_command_argument(size(chosen) + 1, argument)
  write (output_unit, '(a)') 'scene,slave_nodes,type,points,active,ns_step,ns_step_median,' &
    //'ns_slave_node,ns_point,of_type_1'
  do i_scene = 1, size(scenes)
    if (argument /= '' .and. argument /= scenes(i_scene)) cycle
    if (chosen(1) > 0) then
      call time_types(scenes(i_scene), chosen(1))
    else
      do i_size = 1, size(sizes)
        call time_types(scenes(i_scene), sizes(i_size))
      end do
    end if
  end do

contains

  !> All types of one scene, a round of each in turn.
  subroutine time_types(scene, n)
    character(*), intent(in) :: scene
    integer, intent(in) :: n !! slave nodes
    type(problem_t), allocatable :: problems(:)
    real(wp) :: times(n_round, n_type), best
    integer :: i_type, i_round, n_step, n_point

    allocate (problems(n_type))
    times = huge(1.0_wp)
    do i_type = 1, n_type
      if (chosen(2) > 0 .and. chosen(2) /= i_type) cycle
      call start_problem(problems(i_type), bare(scene), n, i_type, bare(scene) /= scene)
      call take_steps(bare(scene), problems(i_type), 3, best)
    end do
    n_step = max(20, n_work/n)
    if (chosen(3) > 0) n_step = chosen(3)
    do i_round = 1, n_round
      do i_type = 1, n_type
        if (chosen(2) > 0 .and. chosen(2) /= i_type) cycle
        call take_steps(bare(scene), problems(i_type), n_step, times(i_round, i_type))
      end do
    end do
    do i_type = 1, n_type
      if (chosen(2) > 0 .and. chosen(2) /= i_type) cycle
      best = minval(times(:, i_type))
      associate (memory => problems(i_type)%memory)
        n_point = memory%points%n
        write (output_unit, '(a, 4(",", i0), 4(",", f0.2), ",", f0.3)') trim(scene), n, i_type, n_point, &
          memory%n_active, best, median(times(:, i_type)), best/n, best/max(1, n_point), &
          best/minval(times(:, 1))
      end associate
    end do
  end subroutine time_types

  !> The scene without friction.
  pure function bare(scene)
    character(*), intent(in) :: scene
    character(5) :: bare

    bare = scene
    if (scene == 'slide') bare = 'flat'
    if (scene == 'stick') bare = 'shift'
  end function bare

  !> Chains of unit segments; where the slave slides, the master's are a little longer.
  subroutine start_problem(problem, scene, n, i_type, rubs)
    type(problem_t), intent(out) :: problem
    character(*), intent(in) :: scene
    integer, intent(in) :: n, i_type
    logical, intent(in) :: rubs
    real(wp), allocatable :: slave(:, :), master(:, :)
    integer :: n_master

    slave = line([0.0_wp, 0.0_wp], [real(n - 1, wp), 0.0_wp], n - 1)
    n_master = n + 9
    if (scene == 'flat' .or. scene == 'crown') n_master = nint((n + 9)/1.02_wp)
    master = line([n + 4.0_wp, 0.0_wp], [-5.0_wp, 0.0_wp], n_master)
    if (scene == 'match' .or. scene == 'shift') call move_nodes(merge(0.4_wp, 0.0_wp, scene == 'shift'), master)
    slave(2, :) = -1.0e-3_wp*(1.0_wp + 0.1_wp*sin(real(slave(1, :), wp)))
    ! Depth at the middle such that a third of the chord is below zero.
    if (scene == 'crown') slave(2, :) = 0.3_wp/n*((slave(1, :) - 0.5_wp*(n - 1))**2/n - n/36.0_wp)
    call make_problem(problem, slave, master, 1.0_wp)
    problem%contact%contact_type = i_type
    problem%contact%n_gauss = 6
    if (rubs) problem%contact%friction%at_rest = friction_coefficient
    if (rubs) problem%contact%friction%sliding = friction_coefficient
    problem%clock%is_on = .false.
    call start_contact(problem%contact, problem%model, problem%log, problem%memory)
  end subroutine start_problem

  !> Bring nodes off their places along the chain: all by a shift, each by a little.
  subroutine move_nodes(shift, nodes)
    real(wp), intent(in) :: shift
    real(wp), intent(inout) :: nodes(:, :)
    integer :: i

    do i = 1, size(nodes, 2)
      nodes(1, i) = nodes(1, i) + (shift + off_place*sin(1.7_wp*i))
    end do
  end subroutine move_nodes

  !> Mean time of a step, ns. Moving the slave is not counted. As in a run, one thread steps while the others wait, and
  !> help, at the barrier that ends the region.
  subroutine take_steps(scene, problem, n_step, time)
    character(*), intent(in) :: scene
    type(problem_t), intent(inout) :: problem
    integer, intent(in) :: n_step
    real(wp), intent(out) :: time

    if (n_thread < 2) then
      call time_steps(scene, problem, n_step, time)
    else
      !$omp parallel num_threads(n_thread) default(none) shared(scene, problem, n_step, time)
      !$omp master
      call time_steps(scene, problem, n_step, time)
      !$omp end master
      !$omp end parallel
    end if
  end subroutine take_steps

  !> The same, by one thread.
  subroutine time_steps(scene, problem, n_step, time)
    character(*), intent(in) :: scene
    type(problem_t), intent(inout) :: problem
    integer, intent(in) :: n_step
    real(wp), intent(out) :: time
    real(wp) :: start, middle, finish
    integer :: i

    start = now()
    do i = 1, n_step
      call move_slave(scene, problem)
      call apply_contact(problem%contact, problem%motion, problem%mass, 1.0e-9_wp*problem%cycle, 1.0e-9_wp, &
        problem%cycle, problem%clock, problem%memory, problem%force)
    end do
    middle = now()
    do i = 1, n_step
      call move_slave(scene, problem)
    end do
    finish = now()
    problem%cycle = problem%cycle - n_step
    time = 1.0e9_wp*((middle - start) - (finish - middle))/n_step
  end subroutine time_steps

  !> Seconds of this process (the machine may be shared), or on the wall.
  function now() result(seconds)
    real(wp) :: seconds
    integer(long) :: tick, rate

    call cpu_time(seconds)
    if (n_thread == 0) return
    call system_clock(tick, rate)
    seconds = real(tick, wp)/real(rate, wp)
  end function now

  !> To and fro over two segments.
  subroutine move_slave(scene, problem)
    character(*), intent(in) :: scene
    type(problem_t), intent(inout) :: problem
    integer :: i
    real(wp) :: shift

    problem%cycle = problem%cycle + 1
    shift = 2.0_wp*abs(1.0_wp - modulo(0.5_wp*slip*problem%cycle, 2.0_wp))
    if (scene == 'match' .or. scene == 'shift') shift = creep*(shift - 2.0_wp)
    if (scene == 'exact') shift = 0.0_wp
    do i = 1, problem%contact%slave%n_node
      problem%motion(1, i) = shift
    end do
  end subroutine move_slave

  !> Median of an odd number of values.
  pure function median(values)
    real(wp), intent(in) :: values(:)
    real(wp) :: median
    integer :: i

    median = values(1)
    do i = 1, size(values)
      if (count(values < values(i)) <= size(values)/2 .and. count(values > values(i)) &
        <= size(values)/2) median = values(i)
    end do
  end function median

end program bench_contact
