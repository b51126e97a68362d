! SPDX-License-Identifier: MIT
!> The only file that knows the contact types: their names, needs, contact points and tangents.
!> Adding one is a number in `contacts_m`, a row of `formulations`, and a `use` and a `case` for
!> either (doc/add_a_formulation.md).
module contact_dispatch_m
  use arc_points_m, only : curve_points
  use assembly_m, only : add_point_tangents, add_nodal_tangents
  use contact_law_m, only : law_penalty
  use contact_state_m, only : contact_state_t, contact_points_t, allocate_points, make_room
  use contacts_m, only : type_nts, type_nts_ar, type_two_pass_ar, type_vts_ppt, &
    type_nts_mar, type_mortar, type_segmented_mortar, contact_t, contact_kind_t
  use kinds_m, only : wp
  use linearisation_m, only : linearised_list_t
  use points_mortar_m, only : points_mortar, finish_mortar, points_segmented_mortar, &
    finish_segmented_mortar
  use points_nts_m, only : points_nts, points_nts_ar, points_at_slave_nodes, points_nts_mar, &
    finish_nts_mar
  use points_vts_ppt_m, only : points_vts_ppt
  use point_list_m, only : copy_list
  use ranges_m, only : n_ranges, first_of, last_of
  use sparse_m, only : sparse_t
  use positions_m, only : points_at_nodes, points_at_quarters, points_at_gauss_points
  use tangent_nodes_m, only : linearise_nodes, add_vts_ppt_tangent
  use tangent_segments_m, only : linearise_overlap_ends, linearise_gauss_points
  use tangent_ties_m, only : add_tie_tangent
  implicit none
  private
  public :: contact_kinds, formulation_t, formulation_of, is_strict, generate_points, &
    add_contact_stiffness

  !> Needs of a formulation before its points are generated.
  type :: formulation_t
    type(contact_kind_t) :: kind          !! number and name
    integer :: segment_points = points_at_nodes !! what the search follows over the master surface
    logical :: has_two_passes = .false.   !! master nodes are tracked over the slave surface too
    logical :: has_unit_area = .false.    !! the penalty is N/m per node
    logical :: covers_segments = .false.  !! goes along both surfaces, slave segment by slave
                                          !! segment
    logical :: has_nodal_pressure = .false. !! it is formed at slave nodes, not at points
    integer :: contact_law = law_penalty  !! from the gap there to the pressure
    integer :: points_per_slave = 1       !! usual most of points for each point, for the allocation
    integer :: points_per_master = 0      !! and for each master node
    real(wp) :: self_share = 0.5_wp       !! part of the penalty that either pass of a surface with
                                          !! itself has
  end type formulation_t

  !> Fewer slave segments are not worth a thread.
  integer, parameter :: least_segments = 512

  !> All formulations.
  type(formulation_t), parameter :: formulations(*) = [ &
    formulation_t(contact_kind_t(type_nts, 'classical NTS'), has_unit_area=.true.), &
    formulation_t(contact_kind_t(type_nts_ar, 'NTS-AR')), &
    formulation_t(contact_kind_t(type_two_pass_ar, 'NTS-AR two-pass'), has_two_passes=.true., &
      points_per_master=1, self_share=1.0_wp), &
    formulation_t(contact_kind_t(type_vts_ppt, 'VTS-PPT'), segment_points=points_at_quarters, &
      points_per_master=1), &
    formulation_t(contact_kind_t(type_nts_mar, 'NTS-mAR', has_strict_rule=.true.), &
      covers_segments=.true., points_per_master=1), &
    formulation_t(contact_kind_t(type_mortar, 'mortar', uses_gauss_points=.true.), &
      segment_points=points_at_gauss_points, has_nodal_pressure=.true.), &
    formulation_t(contact_kind_t(type_segmented_mortar, 'segmented mortar', &
      has_implicit_springs=.true.), &
      covers_segments=.true., has_nodal_pressure=.true., points_per_slave=2, &
      points_per_master=2)]

  !> Numbers, names and features of all types, for the deck reader.
  type(contact_kind_t), parameter :: contact_kinds(*) = formulations%kind

contains

  !> The formulation of a contact.
  pure function formulation_of(contact) result(formulation)
    type(contact_t), intent(in) :: contact
    type(formulation_t) :: formulation
    integer :: i

    do i = 1, size(formulations)
      if (formulations(i)%kind%number == contact%contact_type) formulation = formulations(i)
    end do
    ! A surface with itself is slave and master in one pass.
    if (contact%is_self) formulation%has_two_passes = .false.
  end function formulation_of

  !> Whether a contact follows the strict rule at the ends of the master, which not all kinds have.
  pure function is_strict(contact) result(strict)
    type(contact_t), intent(in) :: contact
    logical :: strict
    type(formulation_t) :: formulation

    formulation = formulation_of(contact)
    strict = formulation%kind%has_strict_rule .and. contact%strict
  end function is_strict

  !> Generate the contact points of one interface for the positions and pairs in its memory.
  subroutine generate_points(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(contact_points_t), allocatable :: points

    ! The list stands beside what the rules read.
    call move_alloc(memory%points, points)
    points%n = 0
    select case (contact%contact_type)
    case (type_nts); call points_nts(contact, memory, points)
    case (type_nts_ar, type_two_pass_ar); call points_nts_ar(contact, memory, points)
    case (type_vts_ppt)
      call points_in_ranges(contact, memory%slave_status%n_active, memory, points)
    case (type_nts_mar)
      call points_at_slave_nodes(contact, memory, points)
      call points_in_ranges(contact, contact%slave%n_segment, memory, points)
      call finish_nts_mar(contact, memory, points)
    case (type_mortar)
      call points_in_ranges(contact, contact%slave%n_segment, memory, points)
      call finish_mortar(contact, memory, points)
    case (type_segmented_mortar)
      call points_in_ranges(contact, contact%slave%n_segment, memory, points)
      call finish_segmented_mortar(contact, memory, points)
    case default; error stop 'internal error: no rule of points for the contact type'
    end select
    if (memory%has%arcs) call curve_points(contact, memory, points)
    call move_alloc(points, memory%points)
  end subroutine generate_points

  !> The points of virtual nodes or slave segments, in order. Threads share those of a long
  !> interface: the first range fills the list, each other one a list of its own, which is copied
  !> behind.
  subroutine points_in_ranges(contact, n, memory, points)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: n !! virtual nodes or slave segments
    type(contact_state_t), intent(inout) :: memory
    type(contact_points_t), intent(inout) :: points
    type(contact_points_t), allocatable :: parts(:)
    integer :: i, n_range, range(2)

    n_range = n_ranges(n, least_segments)
    if (n_range == 1) then
      call points_of_range(contact, memory, [1, n], points)
    else
      call move_alloc(memory%scratch%parts, parts)
      if (allocated(parts)) then
        if (size(parts) < n_range) deallocate (parts)
      end if
      if (.not. allocated(parts)) allocate (parts(n_range))
      parts%n = 0
      !$omp taskloop default(shared) private(range) grainsize(1)
      do i = 1, n_range
        if (.not. allocated(parts(i)%gap)) call allocate_points(parts(i), 0)
        range = [first_of(i, n_range, n), last_of(i, n_range, n)]
        if (i == 1) then
          call points_of_range(contact, memory, range, points)
        else
          call points_of_range(contact, memory, range, parts(i))
        end if
      end do
      !$omp end taskloop
      call make_room(points, sum(parts%n))
      !$omp taskloop default(shared) grainsize(1)
      do i = 1, n_range
        call copy_list(parts(i), points%n + sum(parts(:i - 1)%n), points)
      end do
      !$omp end taskloop
      points%n = points%n + sum(parts%n)
      call move_alloc(parts, memory%scratch%parts)
    end if
  end subroutine points_in_ranges

  !> The points of one range.
  subroutine points_of_range(contact, memory, range, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: range(2) !! first and last
    type(contact_points_t), intent(inout) :: points
    integer :: n_released !! first contacts deeper than the limit

    n_released = 0
    select case (contact%contact_type)
    case (type_vts_ppt); call points_vts_ppt(contact, memory, range(1), range(2), points)
    case (type_nts_mar)
      call points_nts_mar(contact, memory, range(1), range(2), points, n_released)
    case (type_mortar); call points_mortar(contact, memory, range(1), range(2), points)
    case (type_segmented_mortar)
      call points_segmented_mortar(contact, memory, range(1), range(2), points, n_released)
    case default; error stop 'internal error: no rule of points for a range of the contact type'
    end select
    if (n_released == 0) return
    !$omp atomic
    memory%slave_status%n_released = memory%slave_status%n_released + n_released
  end subroutine points_of_range

  !> Add the derivative of minus the contact forces, as evaluate_contact has left them in the
  !> memory, with respect to u (doc/theory/contact.md, section 9): exact while the points stay on
  !> their segments and the same nodes cut the same segments.
  pure subroutine add_contact_stiffness(contact, memory, equation, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: equation(:, :)   !! (2, n_node) of the mesh, 0 = not an unknown
    type(sparse_t), intent(inout) :: matrix !! started, not yet compressed
    integer, allocatable :: equations(:, :) !! by local number

    if (memory%points%n + memory%tie_points%n == 0) return
    equations = equation(:, memory%nodes)
    if (memory%tie_points%n > 0) call add_tie_tangent(memory, equations, matrix)
    if (memory%points%n > 0) call add_tangent(contact, memory, equations, matrix)
  end subroutine add_contact_stiffness

  !> Derivative of minus the forces of the points of contact.
  pure subroutine add_tangent(contact, memory, equations, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(linearised_list_t) :: list

    select case (contact%contact_type)
    case (type_nts); call linearise_nodes(contact, .true., memory, list)
    case (type_nts_ar, type_two_pass_ar); call linearise_nodes(contact, .false., memory, list)
    case (type_vts_ppt); call add_vts_ppt_tangent(contact, memory, equations, matrix)
    case (type_nts_mar); call linearise_overlap_ends(contact, memory, list)
    case (type_mortar, type_segmented_mortar); call linearise_gauss_points(contact, memory, list)
    end select
    if (list%n == 0) return
    if (memory%has%nodal_pressure) then
      call add_nodal_tangents(contact, memory, list, equations, matrix)
    else
      call add_point_tangents(contact, memory, list, equations, matrix)
    end if
  end subroutine add_tangent

end module contact_dispatch_m
