! SPDX-License-Identifier: MIT
!> Points that have lost their stress, as far as the log asks for them.
module failed_points_m
  use block_state_m, only : block_state_t
  use element_dispatch_m, only : point_count
  use layout_m, only : chunk_size
  use material_dispatch_m, only : find_failed, history_size
  use model_m, only : model_t
  use parts_m, only : may_fail
  implicit none
  private
  public :: count_points, first_failed

contains

  !> Points that may fail.
  pure function count_points(model, elements) result(n)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer :: n
    integer :: i_chunk

    n = 0
    do i_chunk = 1, size(elements%n_failed)
      associate (part => model%parts(model%layout%chunk_part(i_chunk)), &
        slots => model%layout%slot_element((i_chunk - 1)*chunk_size + 1:i_chunk*chunk_size))
        if (may_fail(model%materials(part%material))) n = n &
          + point_count(model%sections(part%section))*count(slots > 0)
      end associate
    end do
  end function count_points

  !> The first slot with a failed point; there must be one.
  pure function first_failed(model, elements) result(slot)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer :: slot
    logical :: failed(chunk_size), one(chunk_size), ignored
    integer :: i_chunk, k

    i_chunk = findloc(elements%n_failed > 0, .true., dim=1)
    failed = .false.
    associate (part => model%parts(model%layout%chunk_part(i_chunk)))
      associate (material => model%materials(part%material))
        do k = 1, point_count(model%sections(part%section))
          call find_failed(material, elements%history(elements%history_start(i_chunk) &
            + (k - 1)*chunk_size*history_size(material)), one, ignored)
          failed = failed .or. one
        end do
      end associate
    end associate
    slot = (i_chunk - 1)*chunk_size + findloc(failed, .true., dim=1)
  end function first_failed

end module failed_points_m
