! SPDX-License-Identifier: MIT
!> Log of the element form of each part.
module element_log_m
  use element_dispatch_m, only : point_count
  use kinds_m, only : wp
  use material_dispatch_m, only : history_size, has_mean_dilatation
  use log_m, only : log_t, write_log, warn, to_text
  use model_m, only : model_t
  use parts_m, only : hourglass_viscous, hourglass_stiffness, hourglass_assumed
  implicit none
  private
  public :: log_elements

  !> Coefficient of viscous and stiffness hourglass control above which it limits the step of square
  !> elements.
  real(wp), parameter :: ruling_coefficient = 0.5_wp
  !> Coefficient of assumed-strain hourglass control above which it limits the step of square
  !> elements, at nu = 0.
  real(wp), parameter :: ruling_assumed = 3.0_wp
  !> Names of the hourglass control.
  character(14), parameter :: forms(3) = [character(14) :: 'viscous', 'stiffness', &
    'assumed strain']

contains

  !> Log element form, hourglass control and bulk viscosity of each part.
  subroutine log_elements(model, log)
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    character(:), allocatable :: text
    real(wp) :: ruling, share !! coefficient that begins to limit the step; resulting share of L/c
    integer :: i

    do i = 1, size(model%parts)
      associate (part => model%parts(i))
        if (model%materials(part%material)%is_rigid) then
          call write_log(log, 'part '//to_text(part%id) &
            //': rigid body, its elements carry no stress')
          cycle
        end if
        if (point_count(model%sections(part%section)) == 1) then
          text = trim(merge('axisymmetric volume-weighted one-point quads', &
            'one-point quads                             ', &
            model%is_axisymmetric))//', '//trim(forms(part%hourglass%form))//' hourglass control ' &
            //to_text(part%hourglass%coefficient)
        else
          text = trim(merge('axisymmetric fully integrated quads', &
            'fully integrated quads             ',  &
            model%is_axisymmetric))//' (2x2 points), '//trim(merge('mean dilatation           ', &
            'volumetric strain by point', has_mean_dilatation(model%materials(part%material))))
        end if
        call write_log(log, 'part '//to_text(part%id)//': '//text//', bulk viscosity Q1 ' &
          //to_text(part%hourglass%quadratic)//' Q2 '//to_text(part%hourglass%linear))
        if (point_count(model%sections(part%section)) > 1) cycle
        ! Hourglass control that makes the step of squares smaller than L/c (`hourglass_steps`).
        ruling = merge(ruling_assumed, ruling_coefficient, part%hourglass%form == hourglass_assumed)
        share = ruling/max(part%hourglass%coefficient, ruling)
        if (part%hourglass%form /= hourglass_viscous) share = sqrt(share)
        if (share < 1.0_wp .and. .not. model%is_axisymmetric) call warn(log, &
          'part '//to_text(part%id) &
          //': hourglass control with QM '//to_text(part%hourglass%coefficient)//' reduces the ' &
          //'stable step, for squares to '//to_text(share)//' of L/c; QM up to ' &
          //to_text(ruling)//' does not')
        if (model%is_axisymmetric .and. part%hourglass%form == hourglass_stiffness &
          .and. history_size(model%materials(part%material)) > 0) call warn(log, 'part ' &
          //to_text(part%id)//': stiffness hourglass control makes axisymmetric bodies too stiff ' &
          //'in plastic flow; the viscous form (IHQ 1 to 3) does not')
      end associate
    end do
    call report_missing_viscosity(model, log)
  end subroutine log_elements

  !> Report an equation of state without bulk viscosity, where shocks are likely and not spread over
  !> elements.
  subroutine report_missing_viscosity(model, log)
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    integer :: i

    do i = 1, size(model%parts)
      associate (part => model%parts(i))
        if (.not. allocated(model%materials(part%material)%eos)) cycle
        if (model%materials(part%material)%eos%id == 0) cycle
        if (part%hourglass%quadratic > 0.0_wp .or. part%hourglass%linear > 0.0_wp) cycle
        call write_log(log, 'bulk viscosity is off in part '//to_text(part%id)//' with an ' &
          //'equation of state (the first such part); *CONTROL_BULK_VISCOSITY with a blank card ' &
          //'sets the defaults of LS-DYNA, Q1 1.5 and Q2 0.06')
        return
      end associate
    end do
  end subroutine report_missing_viscosity

end module element_log_m
