! SPDX-License-Identifier: MIT
!> Contact interfaces as the deck describes them.
module contacts_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use curves_m, only : curve_t
  use kinds_m, only : wp
  use log_m, only : to_text
  use surfaces_m, only : surface_t
  use visitor_m, only : visited_t, visitor_t, absent
  implicit none
  private
  public :: contact_t, contact_kind_t, transducer_t, friction_rule_t, has_friction, is_tied, &
    breaks, has_shear, kind_text, most_gauss, penalty_per_node, &
    penalty_distributed, penalty_factor, penalty_share, &
    penalty_implicit, implicit_factor, tie_none, tie_always, tie_breaks, tie_factor

  !> Numbers of the contact types (CTYPE). The deck layer maps stock keywords to them; the contact
  !> dispatcher has a row for each.
  integer, parameter, public :: type_nts = 1, type_nts_ar = 2, type_two_pass_ar = 3, &
    type_vts_ppt = 4, type_nts_mar = 5, type_mortar = 6, type_segmented_mortar = 7
  !> Other values of CTYPE: the program chooses; blank.
  integer, parameter, public :: type_chosen = 0, type_missing = -1

  !> Unit of the penalty (PUNIT): N/m per contact node, N/m^2, factor on the built-in estimate,
  !> share of the largest stable penalty, factor on K L/A of implicit springs (forces of the end of
  !> the step).
  integer, parameter :: penalty_per_node = 0, penalty_distributed = 1, penalty_factor = 2, &
    penalty_share = 3, penalty_implicit = 4
  !> Default PEN of implicit springs.
  real(wp), parameter :: implicit_factor = 10.0_wp

  !> TIE: contact, tied, or tiebreak.
  integer, parameter :: tie_none = 0, tie_always = 1, tie_breaks = 2
  !> Default PEN of ties, as a factor on the built-in estimate: K L/A with the default of SLSFAC.
  real(wp), parameter :: tie_factor = 10.0_wp

  !> Maximum number of Gauss points of a slave segment.
  integer, parameter :: most_gauss = 10

  !> Properties of a contact type; the contact dispatcher passes a list of all types to the deck
  !> layer.
  type :: contact_kind_t
    integer :: number = 0             !! CTYPE
    character(40) :: name = ''        !! name in messages
    logical :: uses_gauss_points = .false. !! NGAUSS applies
    logical :: has_strict_rule = .false.   !! IPF applies
    logical :: has_implicit_springs = .false. !! PUNIT may be 4
  end type contact_kind_t

  !> Regularised Coulomb friction: mu = FD + (FS - FD) exp(-DC speed).
  type :: friction_rule_t
    real(wp) :: at_rest = 0.0_wp  !! FS
    real(wp) :: sliding = 0.0_wp  !! FD
    real(wp) :: decay = 0.0_wp    !! DC, s/m
    real(wp) :: most = 0.0_wp     !! VC: largest traction, N/m^2; 0 = none
    real(wp) :: stiffness = 1.0_wp !! TFAC: tangential over normal penalty
  end type friction_rule_t

  !> One interface.
  type, extends(visited_t) :: contact_t
    integer :: id = 0                      !! user id, or its position in the deck
    character(:), allocatable :: title     !! heading of the _TITLE option
    integer :: contact_type = 0            !! CTYPE
    logical :: chosen_by_keyword = .false. !! a stock keyword chose the type
    character(:), allocatable :: reason    !! of the program's choice (CTYPE 0)
    real(wp) :: target = 0.0_wp            !! TARGET: bound of the error estimate; 0: none
    integer :: scene = 0                   !! with a target: kind of scene (type_charts_m)
    type(surface_t) :: slave, master       !! SURFA, SURFB
    integer :: n_gauss = 2                 !! NGAUSS
    integer :: penalty_unit = penalty_per_node !! one of the `penalty_` constants
    real(wp) :: penalty = 0.0_wp           !! PEN, in its unit
    real(wp) :: master_penalty = 0.0_wp    !! PENT, penalty of the master pass, in the same unit
    real(wp) :: damping = 0.0_wp           !! VDC as a fraction of critical
    real(wp) :: birth = 0.0_wp             !! TBIRTH
    real(wp) :: death = 1.0e20_wp          !! TDEATH
    real(wp) :: largest_turn = 0.0_wp      !! SMOOTH: segments that turn by less stand for arcs,
                                           !! rad; 0: none do
    logical :: strict = .false.            !! IPF = 1: strict rule, of kinds that have one
    integer :: search_interval = 0         !! FREQ, cycles between global searches; 0 = the
                                           !! program's choice
    real(wp) :: search_depth = 0.0_wp      !! SRCH: largest penetration at first contact; 0 =
                                           !! automatic
    type(friction_rule_t) :: friction
    integer :: tie = tie_none              !! TIE, one of the `tie_` constants
    real(wp) :: tie_distance = 0.0_wp      !! largest gap that is tied, m; below 0 per cent of the
                                           !! mean master segment; 0 = 1 per cent
    real(wp) :: strength(2) = 0.0_wp       !! NFLS, SFLS of tiebreak, N/m^2
    type(curve_t), allocatable :: interference !! LCINT: active share of the initial overlap, 0 to 1
    logical :: is_axisymmetric = .false.   !! axisymmetric: lengths weigh with their radius
    logical :: is_self = .false.           !! SURFB 0: one surface with itself; both sides are it
    logical :: is_sheet = .false.          !! plane stress
    real(wp) :: thickness = 1.0_wp         !! of plane stress: forces per length over pressures, m
  contains
    procedure :: visit => visit_contact
  end type contact_t

  !> A surface on which the contact forces of all interfaces are summed.
  type, extends(visited_t) :: transducer_t
    integer :: id = 0
    character(:), allocatable :: title
    integer, allocatable :: nodes(:) !! nodes of its surface that belong to interfaces
  contains
    procedure :: visit => visit_transducer
  end type transducer_t

contains

  !> Whether an interface has friction.
  elemental function has_friction(contact) result(has)
    type(contact_t), intent(in) :: contact
    logical :: has

    has = max(contact%friction%at_rest, contact%friction%sliding) > 0.0_wp
  end function has_friction

  !> Whether the surfaces of an interface are tied.
  elemental function is_tied(contact) result(tied)
    type(contact_t), intent(in) :: contact
    logical :: tied

    tied = contact%tie /= tie_none
  end function is_tied

  !> Whether an interface has tiebreak.
  elemental function breaks(contact)
    type(contact_t), intent(in) :: contact
    logical :: breaks

    breaks = contact%tie == tie_breaks
  end function breaks

  !> Whether an interface has tangential tractions.
  elemental function has_shear(contact) result(has)
    type(contact_t), intent(in) :: contact
    logical :: has

    has = has_friction(contact) .or. is_tied(contact)
  end function has_shear

  !> `name (type n)`.
  pure function kind_text(kind) result(text)
    type(contact_kind_t), intent(in) :: kind
    character(:), allocatable :: text

    text = trim(kind%name)//' (type '//to_text(kind%number)//')'
  end function kind_text

  !> Visit the components of an interface.
  subroutine visit_contact(self, visitor)
    class(contact_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('id', self%id)
    call visitor%visit('title', self%title)
    call visitor%visit('contact_type', self%contact_type)
    call visitor%visit('chosen_by_keyword', self%chosen_by_keyword)
    call visitor%visit('reason', self%reason)
    call visitor%visit('target', self%target)
    call visitor%visit('scene', self%scene)
    call visitor%part('slave', self%slave)
    call visitor%part('master', self%master)
    call visitor%visit('n_gauss', self%n_gauss)
    call visitor%visit('penalty_unit', self%penalty_unit)
    call visitor%visit('penalty', self%penalty)
    call visitor%visit('master_penalty', self%master_penalty)
    call visitor%visit('damping', self%damping)
    call visitor%visit('birth', self%birth)
    call visitor%visit('death', self%death)
    call visitor%visit('largest_turn', self%largest_turn)
    call visitor%visit('strict', self%strict)
    call visitor%visit('search_interval', self%search_interval)
    call visitor%visit('search_depth', self%search_depth)
    call visitor%plain(c_loc(self%friction), storage_size(self%friction), 1)
    call visitor%visit('tie', self%tie)
    call visitor%visit('tie_distance', self%tie_distance)
    call visitor%fixed('strength', self%strength)
    if (visitor%makes(merge(1, absent, allocated(self%interference)))) allocate (self%interference)
    if (allocated(self%interference)) call visitor%part('interference', self%interference)
    call visitor%visit('is_axisymmetric', self%is_axisymmetric)
    call visitor%visit('is_self', self%is_self)
    call visitor%visit('is_sheet', self%is_sheet)
    call visitor%visit('thickness', self%thickness)
  end subroutine visit_contact

  !> Visit the components of a transducer.
  subroutine visit_transducer(self, visitor)
    class(transducer_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('id', self%id)
    call visitor%visit('title', self%title)
    call visitor%visit('nodes', self%nodes)
  end subroutine visit_transducer

end module contacts_m
