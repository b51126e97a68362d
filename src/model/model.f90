! SPDX-License-Identifier: MIT
!> The model of a deck, constant after the start of the run.
!>
!> The deck layer reads all cards (user ids) and resolves ids to indices and sets to nodes; it
!> reports all errors together. `renumber_model` then sorts the nodes and arranges the elements in
!> chunks (`layout`). Index arrays refer to the arrays of this type; user ids appear only in
!> components named `id` and `..._id`, for messages and output.
module model_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use curves_m, only : curve_t
  use parts_m, only : part_t, section_t, material_t
  use mesh_m, only : mesh_t
  use layout_m, only : layout_t
  use conditions_m, only : conditions_t
  use contacts_m, only : contact_t, transducer_t
  use rigids_m, only : rigid_t
  use stages_m, only : stage_t, springback_t
  use visitor_m, only : visited_t, visitor_t, length
  use walls_m, only : wall_t
  use controls_m, only : controls_t
  implicit none
  private
  public :: model_t, mark_meshed_nodes, mark_supports, is_sheet, node_set_t, segment_set_t, &
    part_set_t, shell_set_t

  !> *SET_NODE: members in the order of the deck (for surfaces the walking order).
  type :: node_set_t
    integer :: id = 0
    character(:), allocatable :: title !! allocated where the deck has one
    integer, allocatable :: nodes(:) !! node indices
  end type node_set_t

  !> *SET_SEGMENT, *SET_2D_SEGMENT: edges by their two nodes.
  type :: segment_set_t
    integer :: id = 0
    integer, allocatable :: nodes(:, :) !! (2, n) node indices
    integer, allocatable :: parts(:)    !! *SET_2D_SEGMENT: indices of the parts of the boundary
  end type segment_set_t

  !> *SET_PART.
  type :: part_set_t
    integer :: id = 0
    integer, allocatable :: parts(:) !! indices into model%parts
  end type part_set_t

  !> *SET_SHELL.
  type :: shell_set_t
    integer :: id = 0
    integer, allocatable :: elements(:) !! element indices
  end type shell_set_t

  !> The whole model.
  type, extends(visited_t) :: model_t
    type(mesh_t) :: mesh
    type(layout_t) :: layout
    type(part_t), allocatable :: parts(:)
    type(section_t), allocatable :: sections(:)
    type(material_t), allocatable :: materials(:)
    type(curve_t), allocatable :: curves(:)
    type(node_set_t), allocatable :: node_sets(:)
    type(segment_set_t), allocatable :: segment_sets(:)
    type(part_set_t), allocatable :: part_sets(:)
    type(shell_set_t), allocatable :: shell_sets(:)
    type(conditions_t) :: conditions
    type(contact_t), allocatable :: contacts(:)
    type(transducer_t), allocatable :: transducers(:)
    type(rigid_t), allocatable :: rigids(:)
    type(wall_t), allocatable :: walls(:)
    type(stage_t) :: stage           !! state of the stage before, until the run has started
    type(springback_t) :: springback !! the file for the next stage, of the first process
    type(controls_t) :: controls
    logical :: erodes = .false.   !! elements may erode
    logical :: is_axisymmetric = .false. !! axisymmetric: x is the radius, y the axis; forces,
                                  !! masses and energies per radian
  contains
    procedure :: visit => visit_model
  end type model_t

contains

  !> Whether the model has plane stress: forces, masses and energies of the whole thickness.
  pure function is_sheet(model)
    type(model_t), intent(in) :: model
    logical :: is_sheet
    integer :: i

    is_sheet = .false.
    do i = 1, size(model%parts)
      if (model%parts(i)%section > 0) &
        is_sheet = is_sheet .or. model%sections(model%parts(i)%section)%is_plane_stress
    end do
  end function is_sheet

  !> Visit the components of the model, without sets, which are resolved in conditions and surfaces.
  subroutine visit_model(self, visitor)
    class(model_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%part('mesh', self%mesh)
    call visitor%part('layout', self%layout)
    if (visitor%makes(length(self%parts))) allocate (self%parts(visitor%n_item))
    call visitor%each('parts', self%parts)
    if (visitor%makes(length(self%sections))) allocate (self%sections(visitor%n_item))
    if (visitor%n_item > 0) &
      call visitor%plain(c_loc(self%sections(1)), storage_size(self%sections), visitor%n_item)
    if (visitor%makes(length(self%materials))) allocate (self%materials(visitor%n_item))
    call visitor%each('materials', self%materials)
    if (visitor%makes(length(self%curves))) allocate (self%curves(visitor%n_item))
    call visitor%each('curves', self%curves)
    call visitor%part('conditions', self%conditions)
    if (visitor%makes(length(self%contacts))) allocate (self%contacts(visitor%n_item))
    call visitor%each('contacts', self%contacts)
    if (visitor%makes(length(self%transducers))) allocate (self%transducers(visitor%n_item))
    call visitor%each('transducers', self%transducers)
    if (visitor%makes(length(self%rigids))) allocate (self%rigids(visitor%n_item))
    call visitor%each('rigids', self%rigids)
    if (visitor%makes(length(self%walls))) allocate (self%walls(visitor%n_item))
    call visitor%each('walls', self%walls)
    call visitor%part('stage', self%stage)
    call visitor%part('controls', self%controls)
    call visitor%visit('erodes', self%erodes)
    call visitor%visit('is_axisymmetric', self%is_axisymmetric)
  end subroutine visit_model

  !> (n_node) Whether a node belongs to an element, so that it has mass.
  pure function mark_meshed_nodes(model) result(is_meshed)
    type(model_t), intent(in) :: model
    logical :: is_meshed(model%mesh%n_node)

    is_meshed = .false.
    is_meshed(pack(model%mesh%element_nodes, model%mesh%element_nodes > 0)) = .true.
  end function mark_meshed_nodes

  !> (n_node) Whether a node has mass and a fixed degree of freedom or a skew support.
  pure function mark_supports(model) result(is_support)
    type(model_t), intent(in) :: model
    logical :: is_support(model%mesh%n_node)

    is_support = .false.
    associate (conditions => model%conditions)
      if (allocated(conditions%fixed_nodes)) is_support(conditions%fixed_nodes) = .true.
      if (allocated(conditions%skew_supports)) &
        is_support(conditions%skew_supports%node) = .true.
    end associate
    if (any(is_support)) is_support = is_support .and. mark_meshed_nodes(model)
  end function mark_supports

end module model_m
