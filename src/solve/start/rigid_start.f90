! SPDX-License-Identifier: MIT
!> Rigid bodies and nodes that move alike (*CONSTRAINED_NODE_SET) at time zero: mass, centre and
!> inertia from the lumped masses of their nodes, velocity from the momentum of these; the mass that
!> contact feels, and the inverse masses that its energy law sees (doc/theory/contact.md, section
!> 6.1).
module rigid_start_m
  use conditions_m, only : motion_velocity
  use loads_m, only : is_active
  use curves_m, only : curve_value
  use kinds_m, only : wp
  use log_m, only : log_t, write_log, to_text
  use model_m, only : model_t
  use rigid_state_m, only : rigid_state_t, velocity_of
  use state_m, only : state_t
  implicit none
  private
  public :: start_rigids, weigh_body, is_held, start_common, weigh_contacts

contains

  !> Set up all bodies; nodal masses and initial velocities are there already.
  subroutine start_rigids(model, log, state)
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    type(state_t), intent(inout) :: state
    integer :: i, k

    state%contact_mass = state%mass(:model%layout%n_special)
    allocate (state%rigids(size(model%rigids)))
    do i = 1, size(model%rigids)
      associate (body => model%rigids(i), rigid => state%rigids(i))
        call weigh_body(model%mesh%coordinates(:, body%nodes), state%mass(body%nodes), rigid)
        ! The velocity that keeps momentum, exactly where all nodes have one, and angular momentum.
        associate (mass => state%mass(body%nodes), v => state%motion(3:4, body%nodes))
          do k = 1, 2
            rigid%velocity(k) = v(k, 1) + sum(mass*(v(k, :) - v(k, 1)))/rigid%inertia(1)
          end do
          rigid%velocity(3) = sum(mass*(rigid%arms(1, :)*(v(2, :) - rigid%velocity(2)) &
            - rigid%arms(2, :)*(v(1, :) - rigid%velocity(1))))/rigid%inertia(3)
        end associate
        if (body%has_velocity) rigid%velocity = body%velocity
        ! What is fixed rests; what has a prescribed velocity from the start has its first value.
        where (body%is_fixed) rigid%velocity = 0.0_wp
        do k = 1, size(model%conditions%rigid_motions)
          associate (motion => model%conditions%rigid_motions(k))
            if (motion%node == i .and. motion%kind == motion_velocity &
              .and. is_active(motion, 0.0_wp)) rigid%velocity(motion%direction) = motion%scale &
              *curve_value(model%curves(motion%curve), 0.0_wp)
          end associate
        end do
        do k = 1, size(body%nodes)
          state%motion(3:4, body%nodes(k)) = velocity_of(rigid%velocity, rigid%arms(:, k))
        end do
        state%inverse_mass(:, body%nodes) = 0.0_wp
        call write_log(log, 'rigid part '//to_text(model%parts(body%part)%id)//': mass ' &
          //to_text(rigid%inertia(1))//', moment of inertia '//to_text(rigid%inertia(3)) &
          //' about its centre of mass '//to_text(rigid%centre(1))//', '//to_text(rigid%centre(2)))
      end associate
    end do
    call share_contact_mass(model, state)
  end subroutine start_rigids

  !> Mass, centre and second moments of lumped masses.
  pure subroutine weigh_body(places, mass, rigid)
    real(wp), intent(in) :: places(:, :) !! (2, n) at time zero
    real(wp), intent(in) :: mass(:)      !! (n)
    type(rigid_state_t), intent(inout) :: rigid
    integer :: k

    rigid%inertia(1:2) = sum(mass)
    do k = 1, 2
      ! From the first node, so that digits are kept far from the origin.
      rigid%centre(k) = places(k, 1) + sum(mass*(places(k, :) - places(k, 1)))/rigid%inertia(1)
    end do
    rigid%arms = places - spread(rigid%centre, 2, size(mass))
    rigid%second = [sum(mass*rigid%arms(1, :)**2), sum(mass*rigid%arms(2, :)**2), &
      sum(mass*rigid%arms(1, :)*rigid%arms(2, :))]
    rigid%inertia(3) = rigid%second(1) + rigid%second(2)
  end subroutine weigh_body

  !> The mass of a body is shared among its nodes that contact can touch, in proportion to their
  !> lumped masses and so that no motion of the body gives these nodes more kinetic energy than the
  !> body has, by the largest eigenvalue of their inertia over the body's: limits of the step found
  !> with these masses hold for the body (doc/theory/rigid_bodies.md, section 4). A body held in one
  !> direction counts as free in both.
  subroutine share_contact_mass(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp), parameter :: as_good_as_none = 1.0e-30_wp
    logical, allocatable :: touched(:)
    integer, allocatable :: list(:)
    real(wp), allocatable :: mass(:), arms(:, :) !! of the nodes that can be touched
    real(wp) :: shift, turn, mixed, share
    logical :: held(3)
    integer :: i, k, n

    allocate (touched(model%layout%n_special), source=.false.)
    do i = 1, size(model%contacts)
      touched(model%contacts(i)%slave%nodes) = .true.
      touched(model%contacts(i)%master%nodes) = .true.
    end do
    do i = 1, size(model%rigids)
      associate (nodes => model%rigids(i)%nodes)
        n = count(nodes <= size(touched)) ! they rise
        list = pack([(k, k=1, n)], touched(nodes(:n)))
        if (size(list) == 0) cycle
        held = is_held(model, i)
        mass = state%mass(nodes(list))
        arms = state%rigids(i)%arms(:, list)
      end associate
      associate (inertia => state%rigids(i)%inertia)
        shift = merge(0.0_wp, sum(mass)/inertia(1), all(held(1:2)))
        turn = merge(0.0_wp, sum(mass*(arms(1, :)**2 + arms(2, :)**2))/inertia(3), held(3))
        mixed = norm2([sum(mass*arms(1, :)), sum(mass*arms(2, :))])/sqrt(inertia(1)*inertia(3))
        if (all(held(1:2)) .or. held(3)) mixed = 0.0_wp
        share = 0.5_wp*(shift + turn + sqrt((shift - turn)**2 + 4.0_wp*mixed**2))
        state%contact_mass(model%rigids(i)%nodes(list)) = mass/max(as_good_as_none, share)
      end associate
    end do
  end subroutine share_contact_mass

  !> Degrees of freedom of a body that no force moves during the whole run.
  pure function is_held(model, i_body) result(held)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_body
    logical :: held(3)
    integer :: i

    held = model%rigids(i_body)%is_fixed
    do i = 1, size(model%conditions%rigid_motions)
      associate (motion => model%conditions%rigid_motions(i))
        if (motion%node == i_body .and. motion%birth <= 0.0_wp &
          .and. motion%death >= model%controls%end_time) held(motion%direction) = .true.
      end associate
    end do
  end function is_held

  !> Nodes that move alike: their mean over the masses, so that momentum stays.
  subroutine start_common(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp) :: first
    integer :: i, k

    if (.not. allocated(model%conditions%common_motions)) return
    do i = 1, size(model%conditions%common_motions)
      associate (common => model%conditions%common_motions(i))
        do k = 1, 2
          if (.not. common%along(k)) cycle
          first = state%motion(2 + k, common%nodes(1))
          state%motion(2 + k, common%nodes) = first + sum(state%mass(common%nodes) &
            *(state%motion(2 + k, common%nodes) - first))/sum(state%mass(common%nodes))
        end do
      end associate
    end do
  end subroutine start_common

  !> 1/m of the nodes of all interfaces, 0 where the motion is held or prescribed. A node of a rigid
  !> body has the mass that contact feels there, with which no force does more to it than to the
  !> body; 0 where the body can not turn and does not move in that direction during the whole run.
  subroutine weigh_contacts(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp), allocatable :: inverse(:, :)
    logical :: held(3)
    integer :: i, k

    if (size(state%contacts) == 0) return
    allocate (inverse(2, model%layout%n_special))
    inverse = state%inverse_mass(:, :model%layout%n_special)
    ! Nodes that move alike: their own mass, the least that a force on one of them moves. Nodes that
    ! have lost theirs with their last element have no contact any more.
    if (allocated(model%conditions%common_motions)) then
      do i = 1, size(model%conditions%common_motions)
        associate (common => model%conditions%common_motions(i))
          do k = 1, size(common%nodes)
            associate (node => common%nodes(k))
              if (state%mass(node) > 0.0_wp) inverse(:, node) = merge(1.0_wp/state%mass(node), &
                inverse(:, node), common%along)
            end associate
          end do
        end associate
      end do
    end if
    do i = 1, size(model%rigids)
      held = is_held(model, i)
      do k = 1, size(model%rigids(i)%nodes)
        associate (node => model%rigids(i)%nodes(k))
          if (node > model%layout%n_special) exit
          inverse(:, node) = merge(0.0_wp, 1.0_wp/state%contact_mass(node), &
            held(1:2) .and. held(3))
        end associate
      end do
    end do
    do i = 1, size(state%contacts)
      if (.not. allocated(state%contacts(i)%limit%inverse_mass)) cycle
      associate (limit => state%contacts(i)%limit)
        ! The bound of the forces before was formed with the masses of before.
        if (any(abs(limit%inverse_mass - inverse(:, state%contacts(i)%nodes)) > 0.0_wp)) &
          limit%recoil = huge(1.0_wp)
        limit%inverse_mass = inverse(:, state%contacts(i)%nodes)
      end associate
    end do
  end subroutine weigh_contacts

end module rigid_start_m
