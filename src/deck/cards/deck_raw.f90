! SPDX-License-Identifier: MIT
!> What the cards say, before user ids are resolved: the model with ids, and for each entry the
!> deck line it came from, so that a mistake found later can still be shown where it stands. Lists
!> are as long as the cards may make them before these are read, and of their true length behind.
module deck_raw_m
  use kinds_m, only : wp
  use curves_m, only : curve_t
  use eos_m, only : eos_t
  use erosion_m, only : erosion_t
  use parts_m, only : section_t, material_t, hourglass_t
  use contacts_m, only : contact_t, friction_rule_t
  use controls_m, only : controls_t
  use history_tables_m, only : n_table
  use deck_lines_m, only : place_t, deck_t
  use end_conditions_m, only : end_condition_t
  use deck_raw_sets_m, only : raw_set_t, lengthen
  implicit none
  private
  public :: raw_t, start_raw, raw_hardening_t, raw_table_t, raw_part_t, raw_contact_t, &
    raw_erosion_t, raw_foam_t, raw_end_t, history_t, reserve_nodes, reserve_elements, &
    raw_system_t, raw_section_t, output_plot, reserve_lists, trim_lists

  !> Files of the output plan: states, and histories by their `table_` constants.
  integer, parameter :: output_plot = 0

  !> Hardening of a *MAT_PIECEWISE_LINEAR_PLASTICITY, until its curves are known.
  type :: raw_hardening_t
    integer :: material = 0              !! index
    type(curve_t) :: points              !! of the card, where LCSS is 0: EPS and ES, or SIGY alone
    real(wp) :: modulus = 0.0_wp         !! plastic modulus behind a single point
    integer :: curve = 0, rate_curve = 0 !! LCSS, LCSR, user ids
    type(place_t) :: curve_place, rate_curve_place, rate_place, form_place
    real(wp) :: rate_constant = 0.0_wp, rate_power = 0.0_wp !! C, P
    logical :: is_viscoplastic = .false. !! VP = 1
  end type raw_hardening_t

  !> Curve of a *MAT_CRUSHABLE_FOAM, until it is known.
  type :: raw_foam_t
    integer :: material = 0   !! index
    integer :: curve = 0      !! LCID, user id
    type(place_t) :: place
  end type raw_foam_t

  !> One *MAT_ADD_EROSION.
  type :: raw_erosion_t
    integer :: material = 0 !! user id
    type(place_t) :: place  !! MID
    type(erosion_t) :: erosion
  end type raw_erosion_t

  !> One *DEFINE_TABLE: its values; its curves are those of the blocks that come next.
  type :: raw_table_t
    integer :: id = 0
    integer :: line = 0
    integer :: block = 0
    real(wp), allocatable :: values(:)
  end type raw_table_t

  !> One *PART.
  type :: raw_part_t
    integer :: id = 0, section = 0, material = 0, eos = 0, hourglass = 0
    integer :: line = 0
    character(:), allocatable :: title
  end type raw_part_t

  !> One interface.
  type :: raw_contact_t
    type(contact_t) :: contact
    integer :: block = 0                !! keyword block in the deck
    real(wp) :: per_cent = 0.0_wp       !! VDC as given
    integer :: sides(2) = 0             !! SURFA, SURFB as in the deck: > 0 part set, < 0 node set
    type(place_t) :: places(2)
    integer :: interference = 0         !! LCINT, user id of the curve
    type(place_t) :: interference_place
    type(place_t) :: search_place       !! FREQ, where it is given
    type(place_t) :: unit_place         !! PUNIT
    type(place_t) :: friction_place     !! FS, or what stands for it
  end type raw_contact_t

  !> One row of *TERMINATION_.
  type :: raw_end_t
    type(end_condition_t) :: condition
    type(place_t) :: id_place           !! NID, PID, CID
  end type raw_end_t

  !> One *DATABASE_CROSS_SECTION_SET.
  type :: raw_section_t
    integer :: id = 0
    character(:), allocatable :: title
    integer :: line = 0                 !! of its card
    integer :: nodes = 0, shells = 0    !! NSID, SSID
  end type raw_section_t

  !> One *DEFINE_COORDINATE_SYSTEM.
  type :: raw_system_t
    integer :: id = 0
    integer :: line = 0
    real(wp) :: axes(2, 2) = 0.0_wp     !! its x axis, its y axis
  end type raw_system_t

  !> Output of one file: its interval is completed when curves and ENDTIM are known.
  type :: history_t
    real(wp) :: dt = 0.0_wp
    integer :: curve = 0                !! user id
    integer :: n_state = 0              !! NPLTC
    logical :: is_text = .false., is_binout = .false. !! what BINARY asks for
    type(place_t) :: place              !! of the curve's field
  end type history_t

  !> Everything.
  type :: raw_t
    integer :: n_node = 0, n_element = 0
    integer, allocatable :: node_id(:), node_line(:), node_code(:)
    real(wp), allocatable :: coordinates(:, :) !! (2, n)
    real(wp) :: z_first = 0.0_wp
    integer :: z_line = 0                      !! first node whose z differs from the first node's
    integer, allocatable :: element_id(:), element_part(:), element_nodes(:, :), element_line(:)
    ! Lists with a number of entries beside them: while the cards are read they may be longer.
    integer :: n_part = 0, n_section = 0, n_material = 0, n_equation = 0, n_erosion = 0
    integer :: n_hardening = 0, n_foam = 0, n_table = 0, n_hourglass = 0, n_curve = 0
    integer :: n_contact = 0, n_transducer = 0, n_end = 0, n_system = 0, n_cut = 0
    type(raw_part_t), allocatable :: parts(:)
    type(section_t), allocatable :: sections(:)
    integer, allocatable :: section_line(:)
    type(material_t), allocatable :: materials(:)
    integer, allocatable :: material_line(:)
    type(eos_t), allocatable :: equations(:)   !! of state
    integer, allocatable :: equation_line(:)
    type(raw_erosion_t), allocatable :: erosions(:)
    logical :: erodes_by_step = .false.        !! ERODE of *CONTROL_TIMESTEP
    type(raw_hardening_t), allocatable :: hardenings(:)
    type(raw_foam_t), allocatable :: foams(:)
    type(raw_table_t), allocatable :: tables(:)
    type(hourglass_t), allocatable :: hourglasses(:)
    integer, allocatable :: hourglass_line(:)
    logical, allocatable :: bulk_given(:, :)   !! (2, n) Q1 and Q2 of *HOURGLASS are not blank
    type(hourglass_t) :: hourglass_default
    type(curve_t), allocatable :: curves(:)
    integer, allocatable :: curve_line(:)
    type(raw_set_t), allocatable :: node_sets(:), part_sets(:), segment_sets(:), shell_sets(:)
    integer :: n_node_set = 0, n_part_set = 0, n_segment_set = 0, n_shell_set = 0
    type(place_t), allocatable :: pressure_places(:)
    type(raw_contact_t), allocatable :: contacts(:)
    type(raw_contact_t), allocatable :: transducers(:) !! with one side
    type(raw_end_t), allocatable :: ends(:)
    type(raw_system_t), allocatable :: systems(:)
    type(raw_section_t), allocatable :: cuts(:)
    type(controls_t) :: controls
    type(friction_rule_t) :: friction          !! of *CONTROL_CONTACT
    type(place_t) :: friction_place            !! SFRIC, line 0 without the keyword
    logical :: friction_acts = .false.         !! some interface takes it
    logical :: terminated = .false.            !! the deck has *CONTROL_TERMINATION, be it misspelt
    real(wp) :: newmark(2) = 0.0_wp            !! GAMMA and BETA of the implicit method, 0 = blank
    real(wp) :: hht = 0.0_wp                   !! minus ALPHA of the implicit method
    real(wp) :: spectral_radius = -1.0_wp      !! of the implicit method, negative = not given
    logical :: never_relaxes = .false.         !! IDRFLG -999
    integer :: relaxation_line = 0             !! card of *CONTROL_DYNAMIC_RELAXATION, 0 = none
    integer :: step_line = 0                   !! card of *CONTROL_TIMESTEP, 0 = none
    integer :: newmark_line = 0                !! card of *CONTROL_IMPLICIT_DYNAMICS, 0 = none
    integer :: dt_curve = 0                    !! LCTM, user id
    type(place_t) :: dt_curve_place, scale_place !! LCTM, TSSFAC
    type(place_t), allocatable :: explicit_only(:) !! fields given that the implicit method leaves
    type(history_t) :: outputs(output_plot:n_table)
    type(raw_set_t) :: history_nodes, history_node_sets, history_shells, history_shell_sets, &
      force_groups
  end type raw_t

contains

  !> Empty lists, so that nothing is left unallocated by a deck that lacks a keyword.
  subroutine start_raw(raw)
    type(raw_t), intent(out) :: raw

    allocate (raw%node_sets(16), raw%part_sets(16), &
      raw%segment_sets(16), raw%shell_sets(4), raw%explicit_only(0))
    call reserve_nodes(raw, 0)
    call reserve_elements(raw, 0)
  end subroutine start_raw

  !> Room for `n_more` nodes.
  subroutine reserve_nodes(raw, n_more)
    type(raw_t), intent(inout) :: raw
    integer, intent(in) :: n_more
    real(wp), allocatable :: longer(:, :)
    integer :: n

    if (.not. allocated(raw%node_id)) then
      allocate (raw%node_id(n_more), raw%node_line(n_more), raw%node_code(n_more), &
        raw%coordinates(2, n_more))
      return
    end if
    n = raw%n_node + n_more
    if (n <= size(raw%node_id)) return
    n = max(n, 2*raw%n_node)
    call lengthen(raw%node_id, n)
    call lengthen(raw%node_line, n)
    call lengthen(raw%node_code, n)
    allocate (longer(2, n))
    longer(:, :raw%n_node) = raw%coordinates(:, :raw%n_node)
    call move_alloc(longer, raw%coordinates)
  end subroutine reserve_nodes

  !> Room for `n_more` elements.
  subroutine reserve_elements(raw, n_more)
    type(raw_t), intent(inout) :: raw
    integer, intent(in) :: n_more
    integer, allocatable :: longer(:, :)
    integer :: n

    if (.not. allocated(raw%element_id)) then
      allocate (raw%element_id(n_more), raw%element_part(n_more), raw%element_line(n_more), &
        raw%element_nodes(4, n_more))
      return
    end if
    n = raw%n_element + n_more
    if (n <= size(raw%element_id)) return
    n = max(n, 2*raw%n_element)
    call lengthen(raw%element_id, n)
    call lengthen(raw%element_part, n)
    call lengthen(raw%element_line, n)
    allocate (longer(4, n))
    longer(:, :raw%n_element) = raw%element_nodes(:, :raw%n_element)
    call move_alloc(longer, raw%element_nodes)
  end subroutine reserve_elements

  !> Room for all definitions of the deck: one for each keyword, or for each line where rows repeat.
  subroutine reserve_lists(deck, raw)
    type(deck_t), intent(in) :: deck
    type(raw_t), intent(inout) :: raw
    integer :: n

    allocate (raw%parts(n_line('PART')))
    n = n_line('SECTION_')
    allocate (raw%sections(n), raw%section_line(n))
    n = n_block('MAT_')
    allocate (raw%materials(n), raw%material_line(n), raw%hardenings(n), raw%foams(n), &
      raw%erosions(n))
    n = n_block('EOS_')
    allocate (raw%equations(n), raw%equation_line(n))
    n = n_line('HOURGLASS')
    allocate (raw%hourglasses(n), raw%hourglass_line(n), raw%bulk_given(2, n))
    n = n_block('DEFINE_CURVE')
    allocate (raw%curves(n), raw%curve_line(n))
    allocate (raw%tables(n_block('DEFINE_TABLE')), raw%systems(n_block('DEFINE_COORDINATE')))
    n = n_block('CONTACT_')
    allocate (raw%contacts(n), raw%transducers(n))
    allocate (raw%ends(n_line('TERMINATION_')), raw%cuts(n_line('DATABASE_CROSS_SECTION')))

  contains

    !> Keywords whose names begin so.
    pure function n_block(head) result(n)
      character(*), intent(in) :: head
      integer :: n
      integer :: i

      n = 0
      do i = 1, deck%n_block
        if (index(deck%blocks(i)%name, head) == 1) n = n + 1
      end do
    end function n_block

    !> Data lines of keywords whose names begin so.
    pure function n_line(head) result(n)
      character(*), intent(in) :: head
      integer :: n
      integer :: i

      n = 0
      do i = 1, deck%n_block
        if (index(deck%blocks(i)%name, head) /= 1) cycle
        n = n + max(deck%blocks(i)%last - deck%blocks(i)%first, 0) + 1
      end do
    end function n_line

  end subroutine reserve_lists

  !> Shorten the lists to what they hold.
  subroutine trim_lists(raw)
    type(raw_t), intent(inout) :: raw

    raw%parts = raw%parts(:raw%n_part)
    raw%sections = raw%sections(:raw%n_section)
    raw%section_line = raw%section_line(:raw%n_section)
    raw%materials = raw%materials(:raw%n_material)
    raw%material_line = raw%material_line(:raw%n_material)
    raw%equations = raw%equations(:raw%n_equation)
    raw%equation_line = raw%equation_line(:raw%n_equation)
    raw%erosions = raw%erosions(:raw%n_erosion)
    raw%hardenings = raw%hardenings(:raw%n_hardening)
    raw%foams = raw%foams(:raw%n_foam)
    raw%tables = raw%tables(:raw%n_table)
    raw%hourglasses = raw%hourglasses(:raw%n_hourglass)
    raw%hourglass_line = raw%hourglass_line(:raw%n_hourglass)
    raw%bulk_given = raw%bulk_given(:, :raw%n_hourglass)
    raw%curves = raw%curves(:raw%n_curve)
    raw%curve_line = raw%curve_line(:raw%n_curve)
    raw%contacts = raw%contacts(:raw%n_contact)
    raw%transducers = raw%transducers(:raw%n_transducer)
    raw%ends = raw%ends(:raw%n_end)
    raw%systems = raw%systems(:raw%n_system)
    raw%cuts = raw%cuts(:raw%n_cut)
  end subroutine trim_lists

end module deck_raw_m
