! SPDX-License-Identifier: MIT
!> Faces that several interfaces press on: what the others put there, for the pressure that stands
!> against the stress behind the face is that of all (doc/theory/contact.md, section 8.1).
module shared_faces_m
  use contacts_m, only : contact_t, n_told
  use kinds_m, only : wp
  use model_m, only : model_t
  use snapshot_m, only : slave_result_t
  use state_m, only : state_t
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: others_t, shares_nodes, find_others, face_share

  !> Pressure of other interfaces on the faces at the nodes of one, Pa.
  type :: others_t
    real(wp), allocatable :: slave(:), master(:)
  end type others_t

  !> A face of one side of an interface.
  type :: face_t
    integer :: interface = 0, side = 0 !! 1 slave, 2 master
    integer :: element = 0             !! behind it
    integer :: ends(2) = 0             !! local numbers of its nodes in that side
    integer :: nodes(2) = 0            !! the same in the mesh
  end type face_t

contains

  !> Whether a node is in more than one interface; where elements may leave the mesh it may become
  !> so.
  pure function shares_nodes(model) result(shares)
    type(model_t), intent(in) :: model
    logical :: shares
    integer :: i
    integer, allocatable :: user(:)

    shares = .false.
    if (n_told(model%contacts) < 2) return
    shares = model%erodes
    allocate (user(model%mesh%n_node), source=0)
    do i = 1, n_told(model%contacts)
      associate (slave => model%contacts(i)%slave%nodes, master => model%contacts(i)%master%nodes)
        shares = shares .or. any(user(slave) > 0) .or. any(user(master) > 0)
        user(slave) = i
        user(master) = i
      end associate
    end do
  end function shares_nodes

  !> An interface between the surfaces that it has now.
  function present_contact(model, state, i) result(contact)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: i
    type(contact_t) :: contact

    if (state%contacts(i)%facing%is_used) then
      contact = state%contacts(i)%facing%present
    else if (model%erodes) then
      contact = state%outlines(i)
    else
      contact = model%contacts(i)
    end if
  end function present_contact

  !> What other interfaces put on the faces of each. The pressure of a node acts on all of its faces
  !> in an interface alike.
  subroutine find_others(model, state, slaves, others)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(slave_result_t), intent(in) :: slaves(:) !! (n_interface)
    type(others_t), intent(inout) :: others(:) !! (interfaces that are told), empty before
    type(contact_t) :: contacts(n_told(model%contacts))
    type(face_t), allocatable :: faces(:)
    integer, allocatable :: first(:), next(:) !! faces by the node that they start at
    real(wp) :: share(2), pressure(2)
    integer :: i, k, m

    do i = 1, size(contacts)
      contacts(i) = present_contact(model, state, i)
      allocate (others(i)%slave(contacts(i)%slave%n_node), &
        others(i)%master(contacts(i)%master%n_node), source=0.0_wp)
    end do
    call list_faces(contacts, faces)
    allocate (first(model%mesh%n_node), next(size(faces)), source=0)
    do k = 1, size(faces)
      next(k) = first(faces(k)%nodes(1))
      first(faces(k)%nodes(1)) = k
    end do
    do k = 1, size(faces)
      m = first(faces(k)%nodes(1))
      do while (m > 0)
        if (faces(m)%element == faces(k)%element .and. faces(m)%interface /= faces(k)%interface) &
          then
          share = face_share(model, state, faces(k)%nodes)
          pressure = end_pressure(slaves, faces(m))
          call add_face(share*pressure, faces(k), others)
        end if
        m = next(m)
      end do
    end do
    do i = 1, size(contacts)
      call divide_by_areas(model, state, contacts(i)%slave, others(i)%slave)
      call divide_by_areas(model, state, contacts(i)%master, others(i)%master)
    end do
  end subroutine find_others

  !> All faces of interfaces; of a surface with itself all is on the slave.
  subroutine list_faces(contacts, faces)
    type(contact_t), intent(in) :: contacts(:)
    type(face_t), allocatable, intent(out) :: faces(:)
    integer :: i, n

    n = sum(contacts%slave%n_segment) + sum(contacts%master%n_segment, .not. contacts%is_self)
    allocate (faces(n))
    n = 0
    do i = 1, size(contacts)
      call list_side(contacts(i)%slave, i, 1, faces, n)
      if (.not. contacts(i)%is_self) call list_side(contacts(i)%master, i, 2, faces, n)
    end do
  end subroutine list_faces

  !> The faces of one side, behind the `n` that are there.
  pure subroutine list_side(surface, interface, side, faces, n)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: interface, side
    type(face_t), intent(inout) :: faces(:)
    integer, intent(inout) :: n
    integer :: s, ends(2), nodes(2)

    do s = 1, surface%n_segment
      n = n + 1
      ends = surface%segments(:, s)
      nodes = surface%nodes(ends)
      faces(n) = face_t(interface, side, surface%segment_element(s), ends, nodes)
    end do
  end subroutine list_side

  !> Pressure at the ends of a face in its own interface.
  pure function end_pressure(slaves, face) result(pressure)
    type(slave_result_t), intent(in) :: slaves(:)
    type(face_t), intent(in) :: face
    real(wp) :: pressure(2)

    if (face%side == 1) then
      pressure = slaves(face%interface)%pressure(face%ends)
    else
      pressure = slaves(face%interface)%master_pressure(face%ends)
    end if
  end function end_pressure

  !> What another interface puts on the ends of a face.
  pure subroutine add_face(force, face, others)
    real(wp), intent(in) :: force(2)
    type(face_t), intent(in) :: face
    type(others_t), intent(inout) :: others(:)

    associate (mine => others(face%interface))
      if (face%side == 1) then
        mine%slave(face%ends) = mine%slave(face%ends) + force
      else
        mine%master(face%ends) = mine%master(face%ends) + force
      end if
    end associate
  end subroutine add_face

  !> Forces of nodes to pressures.
  subroutine divide_by_areas(model, state, surface, pressure)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(surface_t), intent(in) :: surface
    real(wp), intent(inout) :: pressure(:)
    real(wp) :: area(surface%n_node), share(2)
    integer :: s, ends(2), nodes(2)

    area = 0.0_wp
    do s = 1, surface%n_segment
      ends = surface%segments(:, s)
      nodes = surface%nodes(ends)
      share = face_share(model, state, nodes)
      area(ends) = area(ends) + share
    end do
    where (area > 0.0_wp) pressure = pressure/area
  end subroutine divide_by_areas

  !> The area of a face that each of its ends has, m or m^2 per radian.
  pure function face_share(model, state, nodes) result(share)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: nodes(2)
    real(wp) :: share(2)
    real(wp) :: at(2, 2)

    at = model%mesh%coordinates(:, nodes) + state%motion(1:2, nodes)
    share = 0.5_wp*norm2(at(:, 2) - at(:, 1))
    if (model%is_round) share = share*(at(1, :) + sum(at(1, :)))/3.0_wp
  end function face_share

end module shared_faces_m
