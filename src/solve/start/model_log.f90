! SPDX-License-Identifier: MIT
!> What the log says of the model once its masses and first forces are there, as d3hsp does, and of
!> mass scaling: added mass in all and part by part, and the end of a run by ENDMAS.
module model_log_m
  use block_state_m, only : block_state_t
  use curves_m, only : curve_value
  use errors_m, only : error_t, raise, status_run
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use log_m, only : log_t, write_log, warn, to_text
  use mass_scaling_m, only : added_masses
  use model_m, only : model_t
  use element_mass_m, only : element_volume
  use element_steps_m, only : find_smallest_steps
  use state_m, only : state_t
  implicit none
  private
  public :: log_masses, log_smallest_steps, judge_damping, check_added_mass

  !> Elements of the list of smallest steps.
  integer, parameter :: n_listed = 10

contains

  !> Elements, mass and centre of mass of each part and of the whole, per unit depth or per radian.
  subroutine log_masses(model, log)
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    real(wp), allocatable :: sums(:, :) !! (3, n_part) mass and its first moments
    integer, allocatable :: counts(:)
    real(wp) :: share
    integer :: i, k

    allocate (sums(3, size(model%parts)), source=0.0_wp)
    allocate (counts(size(model%parts)), source=0)
    do i = 1, model%mesh%n_element
      k = model%mesh%element_part(i)
      counts(k) = counts(k) + 1
      associate (nodes => model%mesh%element_nodes(:, i))
        associate (x => model%mesh%coordinates(:, nodes), &
          corners => merge(3, 4, nodes(4) == nodes(3)))
          if (model%is_round) then
            sums(:, k) = sums(:, k) + model%materials(model%parts(k)%material)%density &
              *element_volume(model%mesh, i)
            cycle
          end if
          share = 0.5_wp*model%materials(model%parts(k)%material)%density*((x(1, 3) - x(1, 1)) &
            *(x(2, 4) - x(2, 2)) - (x(1, 4) - x(1, 2))*(x(2, 3) - x(2, 1)))
          sums(:, k) = sums(:, k) + share*[1.0_wp, sum(x(1, :corners))/corners, &
            sum(x(2, :corners))/corners]
        end associate
      end associate
    end do
    do k = 1, size(model%parts)
      call write_log(log, 'part '//to_text(model%parts(k)%id)//': ' &
        //mass_text(counts(k), sums(:, k)))
    end do
    call write_log(log, 'all parts: '//mass_text(sum(counts), sum(sums, 2))//'; ' &
      //to_text(count(model%mesh%element_nodes(4, :) == model%mesh%element_nodes(3, :))) &
      //' of the elements are triangles')
  end subroutine log_masses

  !> Elements, mass and centre in words.
  pure function mass_text(n, sums) result(text)
    integer, intent(in) :: n
    real(wp), intent(in) :: sums(3)
    character(:), allocatable :: text

    text = to_text(n)//' elements, mass '//to_text(sums(1))
    if (sums(1) > 0.0_wp) text = text//', centre of mass '//to_text(sums(2)/sums(1))//', ' &
      //to_text(sums(3)/sums(1))
  end function mass_text

  !> The elements that rule the time step.
  subroutine log_smallest_steps(model, state, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(log_t), intent(inout) :: log
    integer, allocatable :: found(:)
    real(wp), allocatable :: steps(:)
    character(60) :: line
    integer :: i

    call find_smallest_steps(model, state%elements, state%motion, n_listed, found, steps)
    if (size(found) == 0) return
    call write_log(log, 'smallest stable steps of elements (TSSFAC not applied):')
    call write_log(log, '   element      part   stable step')
    do i = 1, size(found)
      write (line, '(ss,2i10,es14.6)') model%mesh%element_id(found(i)), &
        model%parts(slot_part(model%layout, model%layout%element_slot(found(i))))%id, steps(i)
      call write_log(log, trim(line))
    end do
  end subroutine log_smallest_steps

  !> A warning where a step is too long for the global damping. A free node keeps
  !> (2 - D dt)/(2 + D dt) of its velocity in a step (node_motion): that never grows, but is no
  !> longer exp(-D dt) where D dt passes 1, and is below 0 where it passes 2.
  subroutine judge_damping(model, dt, log)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: dt          !! first step, s
    type(log_t), intent(inout) :: log
    character(:), allocatable :: text
    real(wp) :: largest, share

    if (.not. allocated(model%conditions%damping)) return
    associate (damping => model%conditions%damping)
      text = 'VALDMP'
      largest = damping%coefficient
      if (damping%curve > 0) then
        associate (curve => model%curves(damping%curve), end_time => model%controls%end_time)
          text = 'the largest ordinate of curve '//to_text(curve%id)
          largest = max(curve_value(curve, 0.0_wp), curve_value(curve, end_time), &
            maxval(curve%ordinate, curve%abscissa >= 0.0_wp .and. curve%abscissa <= end_time))
        end associate
      end if
      share = largest*maxval(damping%factor)*dt
      if (.not. share > 1.0_wp) return
      text = '*DAMPING_GLOBAL acts on all parts with D = ' &
        //to_text(largest*maxval(damping%factor))//' ('//text &
        //', times STX or STY); times the step '//to_text(dt)//' that is ' &
        //to_text(share)//', above 1: a step leaves '//to_text((2.0_wp - share)/(2.0_wp + share)) &
        //' of a velocity where exp(-D dt) = '//to_text(exp(-share))//' is meant'
    end associate
    if (share > 2.0_wp) text = text//', and above 2 velocities change sign in every step'
    call warn(log, text//'; nothing grows, but a smaller D or a smaller step is needed ' &
      //'to follow it')
  end subroutine judge_damping

  !> An error where the added mass is more than ENDMAS allows; the log, if given, is told of it.
  subroutine check_added_mass(model, elements, error, log)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    type(error_t), allocatable, intent(out) :: error
    type(log_t), intent(inout), optional :: log
    real(wp) :: added(size(model%parts)), own(size(model%parts))
    integer :: i

    if (.not. (present(log) .or. model%controls%most_added > 0.0_wp)) return
    call added_masses(model, elements, added, own)
    if (present(log)) then
      call write_log(log, 'mass scaling (DT2MS '//to_text(model%controls%mass_step) &
        //'): added mass '//share_text(sum(added), sum(own)))
      do i = 1, size(added)
        if (abs(added(i)) > 0.0_wp) call write_log(log, 'part '//to_text(model%parts(i)%id) &
          //': added mass '//share_text(added(i), own(i)))
      end do
      if (.not. model%controls%most_added > 0.0_wp) return
    end if
    if (100.0_wp*sum(added) > model%controls%most_added*sum(own)) call raise(error, 'mass ' &
      //'scaling has added '//share_text(sum(added), sum(own))//', more than the ' &
      //to_text(model%controls%most_added)//' per cent of ENDMAS', status_run)
  end subroutine check_added_mass

  !> An amount and its share in words.
  pure function share_text(added, own) result(text)
    real(wp), intent(in) :: added, own
    character(:), allocatable :: text

    text = to_text(added)
    if (own > 0.0_wp) text = text//' ('//to_text(100.0_wp*added/own)//' per cent)'
  end function share_text

end module model_log_m
