! SPDX-License-Identifier: MIT
!> State at time zero. Rigid bodies and coupled nodes (*CONSTRAINED_NODE_SET): mass, centre and
!> inertia from the lumped masses of their nodes, velocity from their momentum; masses in contact,
!> and inverse masses of the energy limit (doc/theory/contact.md, section 6.1). The log lists masses
!> as d3hsp does.
module start_m
  use automatic_penalty_m, only : set_automatic_penalties
  use block_state_m, only : block_state_t
  use conditions_m, only : motion_velocity
  use contact_log_m, only : log_compliance
  use contacts_m, only : is_tied
  use controls_m, only : is_asked, group_nodes
  use curves_m, only : curve_value
  use element_log_m, only : log_elements
  use element_mass_m, only : element_volume, lump_mass
  use element_start_m, only : start_elements
  use element_steps_m, only : start_retardation
  use errors_m, only : error_t, raise, status_input, status_run
  use hanging_nodes_m, only : share_hanging_masses, move_hanging_nodes
  use history_tables_m, only : table_nodfor
  use interface_m, only : start_contact, resume_contact
  use kinds_m, only : wp
  use loads_m, only : start_motion, fix_nodes, update_activity, is_active
  use log_m, only : log_t, to_text, write_log
  use mass_scaling_m, only : added_masses, scales_masses, start_mass_scaling
  use model_m, only : model_t
  use remote_state_m, only : inside_tests_t, remote_t, known_nodes, known_slots
  use rigid_state_m, only : rigid_state_t, velocity_of
  use state_m, only : state_t
  implicit none
  private
  public :: start_state, resume_contacts, start_rigids, set_body_inertia, set_contact_masses, &
    check_added_mass

contains

  !> Set up the state at time zero.
  subroutine start_state(model, log, state, error, remote, inside_tests)
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    type(state_t), intent(out) :: state
    type(error_t), allocatable, intent(out) :: error
    type(remote_t), intent(inout), optional :: remote !! remote nodes and slots; its arrays are
                                                      !! moved into the state
    type(inside_tests_t), intent(inout), optional :: inside_tests !! of the first search
    integer :: known(2, 3), i, k

    known = known_nodes(model, remote)
    call start_elements(model, known_slots(model, remote), state%elements)
    call start_motion(model, known, state%motion)
    call log_elements(model, log)
    if (present(remote)) then
      call move_alloc(remote%mass, state%mass)
    else
      call lump_mass(model, state%mass)
      call check_masses(model, state%mass, error)
      if (allocated(error)) return
      call log_masses(model, log)
    end if
    if (any(abs(model%parts%stiffness_damping) > 0.0_wp)) &
      call start_retardation(model, state%motion, state%elements)
    if (scales_masses(model)) then
      call start_mass_scaling(model, state%motion, state%elements, state%mass)
      call check_added_mass(model, state%elements, error, log)
      if (allocated(error)) return
    end if
    call start_constrained_nodes(model, state)
    call start_vectors(known, model%mesh%n_node, state%inverse_mass)
    do k = 1, size(known, 2)
      do i = known(1, k), known(2, k)
        if (state%mass(i) > 0.0_wp) state%inverse_mass(:, i) = 1.0_wp/state%mass(i)
      end do
    end do
    call update_activity(model, 0.0_wp, state%mass, state%inverse_mass)
    call fix_nodes(model, state%inverse_mass)
    allocate (state%force_special(2, model%layout%n_special), source=0.0_wp)
    if (size(model%conditions%nodal_loads) + size(model%conditions%pressures) > 0) &
      allocate (state%external(2, model%layout%n_special), source=0.0_wp)
    if (allocated(model%conditions%damping) .and. .not. model%controls%implicit%is_on) &
      call start_vectors(known, model%mesh%n_node, state%previous_velocity)
    if (allocated(model%conditions%part_damping) .and. .not. model%controls%implicit%is_on) then
      allocate (state%node_damping(2, model%mesh%n_node), &
        state%previous_damping(2, model%mesh%n_node), source=0.0_wp)
      if (.not. allocated(state%previous_velocity)) &
        allocate (state%previous_velocity(2, model%mesh%n_node), source=0.0_wp)
    end if
    allocate (state%force_slots(2, size(model%layout%special_node)), source=0.0_wp)
    call start_vectors(known, model%mesh%n_node, state%internal_force)
    allocate (state%prescribed_velocity(size(model%conditions%motions)), source=0.0_wp)
    do i = 1, size(model%conditions%motions)
      associate (prescribed => model%conditions%motions(i))
        state%prescribed_velocity(i) = state%motion(2 + prescribed%direction, prescribed%node)
      end associate
    end do
    call start_rigids(model, log, state)
    call start_works(model, state)
    if (allocated(model%controls%ends)) &
      allocate (state%quiet_since(size(model%controls%ends)), source=-1.0_wp)
    call start_contacts(model, log, state, error, inside_tests)
    if (allocated(error)) return
    state%interfaces = model%contacts
    call set_contact_masses(model, state)
    if (present(remote)) then
      do i = 1, size(state%contacts)
        state%contacts(i)%slave_penalty = remote%penalties(1, i)
        state%contacts(i)%master_penalty = remote%penalties(2, i)
        state%contacts(i)%node_penalty = remote%penalties(3, i)
      end do
    else
      call set_automatic_penalties(model, state, log, error)
      if (allocated(error)) return
      do i = 1, size(state%estimates)
        call log_compliance(model%contacts(i), model, state%contacts(i), log, &
          state%estimates(i)%softness)
      end do
    end if
  end subroutine start_state

  !> Set up the memories of the interfaces.
  subroutine start_contacts(model, log, state, error, inside_tests)
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    type(state_t), intent(inout) :: state
    type(error_t), allocatable, intent(out) :: error
    type(inside_tests_t), intent(inout), optional :: inside_tests !! of the first search
    integer :: i

    allocate (state%contacts(size(model%contacts)), state%estimates(size(model%contacts)))
    do i = 1, size(model%contacts)
      call start_contact(model%contacts(i), model, log, state%contacts(i), inside_tests)
      if (.not. is_tied(model%contacts(i)) .or. state%contacts(i)%tie_points%n > 0) cycle
      call raise(error, 'interface '//to_text(model%contacts(i)%id)//' ties nothing: none of its ' &
        //to_text(state%contacts(i)%n_slave)//' slave nodes lies within the search radius of the ' &
        //'master', &
        status_input)
      return
    end do
  end subroutine start_contacts

  !> Nodal vectors, zero at the nodes of this process.
  pure subroutine start_vectors(known, n_node, vectors)
    integer, intent(in) :: known(:, :)
    integer, intent(in) :: n_node
    real(wp), allocatable, intent(out) :: vectors(:, :) !! (2, n_node)
    integer :: k

    allocate (vectors(2, n_node))
    do k = 1, size(known, 2)
      vectors(:, known(1, k):known(2, k)) = 0.0_wp
    end do
  end subroutine start_vectors

  !> Set up the rigid walls, and forces and works for histories.
  subroutine start_works(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    integer :: i, n

    n = 0
    if (allocated(model%walls)) n = size(model%walls)
    if (n > 0) allocate (state%walls(n))
    do i = 1, n
      associate (wall => model%walls(i), memory => state%walls(i))
        memory%velocity = wall%velocity
        allocate (memory%force(size(wall%nodes)), memory%speed(size(wall%nodes)), source=0.0_wp)
        allocate (memory%friction(merge(size(wall%nodes), 0, wall%friction > 0.0_wp)), &
          source=0.0_wp)
        allocate (memory%slip_speed, source=memory%friction)
      end associate
    end do
    associate (output => model%controls%output)
      if (allocated(output%boundaries%where)) then
        n = size(output%boundaries%where)
        allocate (state%boundary_force(3, n), state%boundary_work(n), source=0.0_wp)
      end if
      if (allocated(output%cross_sections)) allocate (state%cut_force(8, &
        sum([(size(output%cross_sections(i)%elements), i=1, size(output%cross_sections))])), &
        source=0.0_wp)
      if (.not. allocated(output%force_groups)) return
      if (.not. is_asked(output%histories(table_nodfor))) return
      n = size(group_nodes(output%force_groups))
      allocate (state%group_force(2, n), state%group_work(n), state%group_velocity(2, n), &
        source=0.0_wp)
    end associate
  end subroutine start_works

  !> Restore what interfaces derive from the memory that was read.
  pure subroutine resume_contacts(state)
    type(state_t), intent(inout) :: state
    integer :: i

    do i = 1, size(state%contacts)
      call resume_contact(state%interfaces(i), state%contacts(i))
    end do
  end subroutine resume_contacts

  !> Set up the rigid bodies; nodal masses and initial velocities are set.
  subroutine start_rigids(model, log, state)
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    type(state_t), intent(inout) :: state
    integer :: i, k

    state%contact_mass = state%mass(:model%layout%n_special)
    allocate (state%rigids(size(model%rigids)))
    do i = 1, size(model%rigids)
      associate (body => model%rigids(i), rigid => state%rigids(i))
        call set_body_inertia(model%mesh%coordinates(:, body%nodes), state%mass(body%nodes), rigid)
        ! Velocity from momentum and angular momentum; exact where all nodes have the same velocity.
        associate (mass => state%mass(body%nodes), v => state%motion(3:4, body%nodes))
          do k = 1, 2
            rigid%velocity(k) = v(k, 1) + sum(mass*(v(k, :) - v(k, 1)))/rigid%inertia(1)
          end do
          rigid%velocity(3) = sum(mass*(rigid%arms(1, :)*(v(2, :) - rigid%velocity(2)) &
            - rigid%arms(2, :)*(v(1, :) - rigid%velocity(1))))/rigid%inertia(3)
        end associate
        if (body%has_velocity .or. body%has_inertia) rigid%velocity = body%velocity
        ! Fixed degrees of freedom are at rest, prescribed velocities start with their first value.
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

  !> Check that the nodes of each body of *PART_INERTIA have masses above 0, and that moving walls
  !> are heavier than each of their nodes.
  subroutine check_masses(model, mass, error)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: mass(:)     !! (n_node)
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    do i = 1, size(model%rigids)
      associate (body => model%rigids(i))
        if (.not. body%has_inertia .or. all(mass(body%nodes) > 0.0_wp)) cycle
        call raise(error, body%source//': rigid part '//to_text(model%parts(body%part)%id) &
          //': no masses above 0 at its nodes have the mass '//to_text(body%given_mass) &
          //', centre of mass '//to_text(body%given_centre(1))//', ' &
          //to_text(body%given_centre(2))//' and moment of inertia '//to_text(body%given_moment) &
          //'; the mesh must reach about as far as the body, in several elements', status_input)
        return
      end associate
    end do
    if (.not. allocated(model%walls)) return
    do i = 1, size(model%walls)
      associate (wall => model%walls(i))
        if (.not. (wall%mass > 0.0_wp .and. any(mass(wall%nodes) >= wall%mass))) cycle
        call raise(error, wall%source//': the mass '//to_text(wall%mass)//' of the wall is not ' &
          //'above that of a node, '//to_text(maxval(mass(wall%nodes))), status_input)
        return
      end associate
    end do
  end subroutine check_masses

  !> Mass, centre and second moments of a set of lumped masses.
  pure subroutine set_body_inertia(positions, mass, rigid)
    real(wp), intent(in) :: positions(:, :) !! (2, n) at time zero
    real(wp), intent(in) :: mass(:)      !! (n)
    type(rigid_state_t), intent(inout) :: rigid
    integer :: k

    rigid%inertia(1:2) = sum(mass)
    do k = 1, 2
      ! From the first node, so that digits are kept far from the origin.
      rigid%centre(k) = positions(k, 1) + sum(mass*(positions(k, :) - positions(k, &
        1)))/rigid%inertia(1)
    end do
    rigid%arms = positions - spread(rigid%centre, 2, size(mass))
    rigid%second = [sum(mass*rigid%arms(1, :)**2), sum(mass*rigid%arms(2, :)**2), &
      sum(mass*rigid%arms(1, :)*rigid%arms(2, :))]
    rigid%inertia(3) = rigid%second(1) + rigid%second(2)
  end subroutine set_body_inertia

  !> Distribute the mass of a rigid body over its nodes at contact surfaces, in proportion to their
  !> lumped masses, such that no motion of the body gives these nodes more kinetic energy than the
  !> body, by the largest eigenvalue of their inertia over the body's: step limits found with these
  !> masses hold for the body (doc/theory/rigid_bodies.md, section 4). A body fixed in one direction
  !> counts as free in both.
  subroutine share_contact_mass(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp), parameter :: as_good_as_none = 1.0e-30_wp
    logical, allocatable :: touched(:)
    integer, allocatable :: list(:)
    real(wp), allocatable :: mass(:), arms(:, :) !! of the nodes at contact surfaces
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

  !> Degrees of freedom of a rigid body that are fixed or prescribed during the whole run.
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

  !> Masses of hanging nodes go to their parents, whose mean velocity they get. Set the velocity of
  !> coupled nodes to their mean over the masses, which keeps the momentum.
  subroutine start_constrained_nodes(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp) :: first
    integer :: i, k

    call share_hanging_masses(model%mesh, state%mass)
    call move_hanging_nodes(model%mesh, state%motion)
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
  end subroutine start_constrained_nodes

  !> Set the inverse masses of the nodes of all interfaces, 0 where fixed or prescribed. A node of a
  !> rigid body has its mass in contact, with which no force has a larger effect than on the body; 0
  !> where the body cannot rotate nor move in that direction during the whole run.
  subroutine set_contact_masses(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp), allocatable :: inverse(:, :)
    logical :: held(3)
    integer :: i, k

    if (size(state%contacts) == 0) return
    allocate (inverse(2, model%layout%n_special))
    inverse = state%inverse_mass(:, :model%layout%n_special)
    ! Coupled nodes: their own mass as a lower bound. Nodes without elements have no contact.
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
      if (.not. state%contacts(i)%has%limit) cycle
      associate (limit => state%contacts(i)%limit)
        ! The previous bound was formed with the previous masses.
        if (any(abs(limit%inverse_mass - inverse(:, state%contacts(i)%nodes)) > 0.0_wp)) &
          limit%recoil = huge(1.0_wp)
        limit%inverse_mass = inverse(:, state%contacts(i)%nodes)
      end associate
    end do
  end subroutine set_contact_masses

  !> Log elements, mass and centre of mass of each part and of the whole, per unit depth or per
  !> radian.
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
          if (model%is_axisymmetric) then
            sums(:, k) = sums(:, k) + model%materials(model%parts(k)%material)%density &
              *element_volume(model%mesh, i)
            cycle
          end if
          share = 0.5_wp*model%materials(model%parts(k)%material)%density*((x(1, 3) - x(1, 1)) &
            *(x(2, 4) - x(2, 2)) - (x(1, 4) - x(1, 2))*(x(2, 3) - x(2, 1))) &
            *model%sections(model%parts(k)%section)%thickness
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

  !> Elements, mass and centre of mass in words.
  pure function mass_text(n, sums) result(text)
    integer, intent(in) :: n
    real(wp), intent(in) :: sums(3)
    character(:), allocatable :: text

    text = to_text(n)//' elements, mass '//to_text(sums(1))
    if (sums(1) > 0.0_wp) text = text//', centre of mass '//to_text(sums(2)/sums(1))//', ' &
      //to_text(sums(3)/sums(1))
  end function mass_text

  !> Stop where the added mass exceeds ENDMAS; with `log` report the added mass.
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

end module start_m
