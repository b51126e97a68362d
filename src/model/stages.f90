! SPDX-License-Identifier: MIT
!> Stages of a process: the state of the stage before, from *INITIAL_STRESS_SHELL and
!> *INITIAL_STRAIN_SHELL, and the file for the next one (*INTERFACE_SPRINGBACK_LSDYNA).
module stages_m
  use kinds_m, only : wp
  use parts_m, only : material_t, has_memory_of_heat
  use visitor_m, only : visited_t, visitor_t, of_slots
  implicit none
  private
  public :: stage_t, springback_t, arrange_stage, n_stage_value, n_stage_strain, most_points, &
    stage_stress, stage_plastic, stage_law, stage_thickness, stage_hourglass, n_law_history, &
    stage_fault

  !> Values of a point: stress xx yy zz xy, plastic strain, history of the law (back stress xx yy
  !> xy, or temperature rise and damage), t/t0 - 1 in plane stress, and of one-point quads the
  !> hourglass force per depth in x and y. Where each begins; strains xx yy zz xy.
  integer, parameter :: n_stage_value = 11, stage_stress = 1, stage_plastic = 5, stage_law = 6, &
    stage_thickness = 9, stage_hourglass = 10, n_stage_strain = 4, most_points = 4

  !> State of the stage before, zero for other elements; tables allocated where the deck has them.
  type, extends(visited_t) :: stage_t
    integer :: n_element = 0               !! elements with stresses in the deck
    real(wp), allocatable :: stresses(:, :) !! (n_stage_value*most_points, n_element), by slots
                                            !! after renumbering
    real(wp), allocatable :: strains(:, :)  !! (n_stage_strain*most_points, n_element), likewise
  contains
    procedure :: visit => visit_stage
  end type stage_t

  !> What <job>.dynain has.
  type :: springback_t
    logical :: is_on = .false.
    integer :: n_history = 0               !! NSHV: history values of a point at least
    logical :: all_nodes = .false.         !! NDFLAG: nodes without elements too
    logical, allocatable :: is_part(:)     !! (n_part) parts of PSID
    integer, allocatable :: nodes(:)       !! user numbers of nodes with a boundary code ...
    integer, allocatable :: codes(:)       !! ... and the codes (TC)
    character(:), allocatable :: excluded  !! keywords left out, each between blanks
  end type springback_t

contains

  !> Arrange the tables of a stage by the slots of the layout; padding has none.
  subroutine arrange_stage(slot_element, stage)
    integer, intent(in) :: slot_element(:) !! (n_slot) element index, 0 for padding
    type(stage_t), intent(inout) :: stage

    call arrange(stage%stresses)
    call arrange(stage%strains)

  contains

    !> Arrange one table.
    subroutine arrange(table)
      real(wp), allocatable, intent(inout) :: table(:, :)
      real(wp), allocatable :: by_slot(:, :)
      integer :: slot

      if (.not. allocated(table)) return
      allocate (by_slot(size(table, 1), size(slot_element)), source=0.0_wp)
      do slot = 1, size(slot_element)
        if (slot_element(slot) > 0) by_slot(:, slot) = table(:, slot_element(slot))
      end do
      call move_alloc(by_slot, table)
    end subroutine arrange

  end subroutine arrange_stage

  !> History values of a law behind its plastic strain: 3 of a back stress, 2 of heat and damage.
  pure function n_law_history(material) result(n)
    type(material_t), intent(in) :: material
    integer :: n

    n = merge(3, 0, material%beta < 1.0_wp .and. material%hardening > 0.0_wp)
    if (has_memory_of_heat(material)) n = 2
  end function n_law_history

  !> Why points of a material do not go from stage to stage; empty where they do: elastic and J2
  !> laws whose pressure is K ln(J).
  pure function stage_fault(material) result(reason)
    type(material_t), intent(in) :: material
    character(:), allocatable :: reason

    reason = ''
    if (allocated(material%rubber)) then
      reason = 'rubber, whose stress follows from the deformation gradient since its first stage'
    else if (allocated(material%crush)) then
      reason = 'crushable foam, whose yield stress follows from the volume at time zero'
    else if (material%decay >= 0.0_wp) then
      reason = 'viscoelasticity, whose overstress decays with time'
    else if (allocated(material%eos)) then
      if (material%eos%id > 0) reason = 'an equation of state, whose pressure follows from ' &
        //'volume and energy since the first stage'
    end if
  end function stage_fault

  !> Visit the components.
  subroutine visit_stage(self, visitor)
    class(stage_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('n_element', self%n_element)
    call visitor%visit('stresses', self%stresses, of_slots)
    call visitor%visit('strains', self%strains, of_slots)
  end subroutine visit_stage

end module stages_m
