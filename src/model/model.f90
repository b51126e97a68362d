! SPDX-License-Identifier: MIT
!> The model: what the deck described, constant once the run starts.
!>
!> Filled in three moves. The deck layer reads every card (user ids), then resolves ids to indices
!> and sets to nodes (all mistakes found are reported together). `renumber_model` last puts the
!> nodes into the order of the step and the elements into chunks (`layout`). From then on nobody
!> writes to it. All index arrays refer to the arrays of this type; user ids appear in components
!> named `id` and `..._id` only, and are used for messages and output.
module model_m
  use curves_m, only : curve_t
  use parts_m, only : part_t, section_t, material_t
  use mesh_m, only : mesh_t
  use layout_m, only : layout_t
  use sets_m, only : node_set_t, segment_set_t, part_set_t, shell_set_t
  use conditions_m, only : conditions_t
  use contacts_m, only : contact_t, transducer_t
  use rigids_m, only : rigid_t
  use walls_m, only : wall_t
  use controls_m, only : controls_t
  implicit none
  private
  public :: model_t

  !> A whole problem.
  type :: model_t
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
    type(transducer_t), allocatable :: transducers(:) !! only where the deck has any
    type(rigid_t), allocatable :: rigids(:)
    type(wall_t), allocatable :: walls(:)       !! only where the deck has any
    type(controls_t) :: controls
    logical :: erodes = .false.   !! elements may leave the mesh
    logical :: is_round = .false. !! axisymmetric: x is the radius, y the axis; forces, masses and
                                  !! energies per radian
  end type model_t

end module model_m
