! SPDX-License-Identifier: MIT
!> What the cards say, before user ids are resolved: the model with ids, and for each entry the
!> deck line it came from, so that a mistake found later can still be shown where it stands. Lists
!> are as long as the cards may make them before these are read, and of their true length behind.
module deck_raw_m
  use kinds_m, only : wp
  use parts_m, only : hourglass_t
  use contacts_m, only : contact_t, friction_rule_t
  use controls_m, only : controls_t
  use history_tables_m, only : n_table
  use deck_lines_m, only : place_t, deck_t
  use end_conditions_m, only : end_condition_t
  use deck_raw_sets_m, only : raw_set_t, lengthen
  implicit none
  private
  public :: raw_t, start_raw, raw_contact_t, raw_end_t, history_t, reserve_nodes, &
    reserve_elements, raw_section_t, output_plot, reserve_lists, trim_lists

  !> Files of the output plan: states, and histories by their `table_` constants.
  integer, parameter :: output_plot = 0

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
    integer :: n_contact = 0, n_transducer = 0, n_end = 0, n_cut = 0
    logical :: erodes_by_step = .false.        !! ERODE of *CONTROL_TIMESTEP
    type(hourglass_t) :: hourglass_default
    type(raw_set_t), allocatable :: node_sets(:), part_sets(:), segment_sets(:), shell_sets(:)
    integer :: n_node_set = 0, n_part_set = 0, n_segment_set = 0, n_shell_set = 0
    type(place_t), allocatable :: pressure_places(:)
    type(raw_contact_t), allocatable :: contacts(:)
    type(raw_contact_t), allocatable :: transducers(:) !! with one side
    type(raw_end_t), allocatable :: ends(:)
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

    raw%contacts = raw%contacts(:raw%n_contact)
    raw%transducers = raw%transducers(:raw%n_transducer)
    raw%ends = raw%ends(:raw%n_end)
    raw%cuts = raw%cuts(:raw%n_cut)
  end subroutine trim_lists

end module deck_raw_m
