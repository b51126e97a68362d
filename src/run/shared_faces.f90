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
  public :: others_t, shares_nodes, present_contact, find_others, face_share

  !> Pressure of other interfaces on the faces at the nodes of one side of an interface, Pa.
  type :: others_t
    real(wp), allocatable :: pressure(:)
    real(wp), allocatable :: area(:) !! of them, half of each face, m or m^2 per radian
  end type others_t

  !> A face of a side; sides are the slave and the master of each interface.
  type :: face_t
    integer :: side = 0
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
  function present_contact(state, i) result(contact)
    type(state_t), intent(in) :: state
    integer, intent(in) :: i
    type(contact_t) :: contact

    contact = state%outlines(i)
    if (state%contacts(i)%facing%is_used) contact = state%contacts(i)%facing%present
  end function present_contact

  !> What other interfaces put on the faces of each side. The pressure of a node acts on all of its
  !> faces in an interface alike.
  subroutine find_others(model, state, slaves, others)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(slave_result_t), intent(in) :: slaves(:) !! (n_interface)
    type(others_t), intent(inout) :: others(:) !! (2, interfaces that are told), empty before
    type(surface_t) :: surfaces(size(others))
    type(face_t), allocatable :: faces(:)
    type(contact_t) :: contact
    integer, allocatable :: first(:), next(:) !! faces by the node that they start at
    real(wp) :: pressure(2)
    integer :: i, k, m, s

    do i = 1, size(others)/2
      contact = present_contact(state, i)
      surfaces(2*i - 1) = contact%slave
      surfaces(2*i) = contact%master
      ! Of a surface with itself all is on the slave.
      if (contact%is_self) surfaces(2*i)%n_segment = 0
    end do
    allocate (faces(sum(surfaces%n_segment)), next(sum(surfaces%n_segment)))
    allocate (first(model%mesh%n_node), source=0)
    k = 0
    do i = 1, size(others)
      allocate (others(i)%pressure(surfaces(i)%n_node), others(i)%area(surfaces(i)%n_node), &
        source=0.0_wp)
      do s = 1, surfaces(i)%n_segment
        k = k + 1
        associate (ends => surfaces(i)%segments(:, s))
          faces(k) = face_t(i, surfaces(i)%segment_element(s), ends, surfaces(i)%nodes(ends))
          others(i)%area(ends) = others(i)%area(ends) + face_share(model, state, faces(k)%nodes)
        end associate
        next(k) = first(faces(k)%nodes(1))
        first(faces(k)%nodes(1)) = k
      end do
    end do
    do k = 1, size(faces)
      m = first(faces(k)%nodes(1))
      do while (m > 0)
        if (faces(m)%element == faces(k)%element .and. &
          (faces(m)%side + 1)/2 /= (faces(k)%side + 1)/2) then
          associate (result => slaves((faces(m)%side + 1)/2), &
            mine => others(faces(k)%side)%pressure)
            if (mod(faces(m)%side, 2) == 1) pressure = result%pressure(faces(m)%ends)
            if (mod(faces(m)%side, 2) == 0) pressure = result%master_pressure(faces(m)%ends)
            mine(faces(k)%ends) = mine(faces(k)%ends) + face_share(model, state, faces(k)%nodes) &
              *pressure
          end associate
        end if
        m = next(m)
      end do
    end do
    do i = 1, size(others)
      where (others(i)%area > 0.0_wp) others(i)%pressure = others(i)%pressure/others(i)%area
    end do
  end subroutine find_others

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
