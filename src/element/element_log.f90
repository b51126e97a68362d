! SPDX-License-Identifier: MIT
!> What the log says about the elements of each part.
module element_log_m
  use element_dispatch_m, only : point_count
  use log_m, only : log_t, write_log, to_text
  use model_m, only : model_t
  use parts_m, only : hourglass_stiffness
  use quad_full_m, only : has_mean_dilatation
  implicit none
  private
  public :: log_elements

contains

  !> Element form of each part and what belongs to it.
  subroutine log_elements(model, log)
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    character(:), allocatable :: text
    integer :: i

    do i = 1, size(model%parts)
      associate (part => model%parts(i))
        if (model%materials(part%material)%is_rigid) then
          call write_log(log, 'part '//to_text(part%id)//': rigid body, its elements carry no stress')
          cycle
        end if
        if (point_count(model%sections(part%section)) == 1) then
          text = 'one-point quads, '//trim(merge('stiffness', 'viscous  ', &
            part%hourglass%form == hourglass_stiffness))//' hourglass control ' &
            //to_text(part%hourglass%coefficient)
        else
          text = 'fully integrated quads (2x2 points), '//trim(merge('mean dilatation           ', &
            'volumetric strain by point', has_mean_dilatation(model%materials(part%material))))
        end if
        call write_log(log, 'part '//to_text(part%id)//': '//text//', bulk viscosity Q1 ' &
          //to_text(part%hourglass%quadratic)//' Q2 '//to_text(part%hourglass%linear))
      end associate
    end do
  end subroutine log_elements

end module element_log_m
