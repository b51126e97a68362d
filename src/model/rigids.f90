! SPDX-License-Identifier: MIT
!> Rigid bodies: one for each part of *MAT_RIGID.
module rigids_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: rigid_t, mark_rigid_nodes

  !> One body.
  type, extends(visited_t) :: rigid_t
    integer :: part = 0               !! index into model%parts
    integer, allocatable :: nodes(:)  !! node indices, increasing, so that special nodes come first
    logical :: is_fixed(3) = .false.  !! x, y and rotation about z (CON1 and CON2 of *MAT_RIGID)
    logical :: has_velocity = .false. !! *INITIAL_VELOCITY_RIGID_BODY gives `velocity`
    real(wp) :: velocity(3) = 0.0_wp  !! of the centre of mass, m/s, and angular velocity, 1/s
    logical :: has_inertia = .false.  !! *PART_INERTIA gives `velocity` and:
    real(wp) :: given_mass = 0.0_wp   !! kg/m
    real(wp) :: given_centre(2) = 0.0_wp
    real(wp) :: given_moment = 0.0_wp !! about the centre of mass, kg m
    character(:), allocatable :: source !! file and line of *PART_INERTIA, for messages
  contains
    procedure :: visit => visit_rigid
  end type rigid_t

contains

  !> (n_node) Whether a node belongs to a rigid body.
  pure function mark_rigid_nodes(rigids, n_node) result(is_rigid)
    type(rigid_t), intent(in) :: rigids(:)
    integer, intent(in) :: n_node
    logical :: is_rigid(n_node)
    integer :: i

    is_rigid = .false.
    do i = 1, size(rigids)
      is_rigid(rigids(i)%nodes) = .true.
    end do
  end function mark_rigid_nodes

  !> Visit the components of a rigid body.
  subroutine visit_rigid(self, visitor)
    class(rigid_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('part', self%part)
    call visitor%visit('nodes', self%nodes)
    call visitor%plain(c_loc(self%is_fixed), storage_size(self%is_fixed), size(self%is_fixed))
    call visitor%visit('has_velocity', self%has_velocity)
    call visitor%fixed('velocity', self%velocity)
    call visitor%visit('has_inertia', self%has_inertia)
    call visitor%visit('given_mass', self%given_mass)
    call visitor%fixed('given_centre', self%given_centre)
    call visitor%visit('given_moment', self%given_moment)
    call visitor%visit('source', self%source)
  end subroutine visit_rigid

end module rigids_m
