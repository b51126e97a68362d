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
  use deck_lines_m, only : place_t
  implicit none
  private
  public :: raw_t, raw_contact_t, history_t, output_plot

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
    ! Lists with a number of entries beside them: while the cards are read they may be longer.
    integer :: n_contact = 0, n_transducer = 0
    logical :: erodes_by_step = .false.        !! ERODE of *CONTROL_TIMESTEP
    type(hourglass_t) :: hourglass_default
    logical, allocatable :: is_whole(:)       !! of each node set: all its nodes exist
    type(place_t), allocatable :: pressure_places(:)
    type(raw_contact_t), allocatable :: contacts(:)
    type(raw_contact_t), allocatable :: transducers(:) !! with one side
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
  end type raw_t

end module deck_raw_m
