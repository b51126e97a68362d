! SPDX-License-Identifier: MIT
!> Parts and what they refer to: section, material, hourglass control and bulk viscosity.
module parts_m
  use hardenings_m, only : hardening_t
  use kinds_m, only : wp
  implicit none
  private
  public :: part_t, section_t, material_t, hourglass_t, &
    form_one_point, form_full, form_round_one_point, form_round_full, law_elastic, law_plastic, &
    law_piecewise, &
    hourglass_viscous, hourglass_stiffness

  !> Element forms. Only the element dispatcher asks for them.
  integer, parameter :: form_one_point = 1, form_full = 2, form_round_one_point = 3, &
    form_round_full = 4
  !> Material laws. Only the material dispatcher asks for them.
  integer, parameter :: law_elastic = 1, law_plastic = 2, law_piecewise = 3
  !> Hourglass control: viscous (IHQ 1 to 3 and blank) or stiffness (IHQ 4 and 5).
  integer, parameter :: hourglass_viscous = 1, hourglass_stiffness = 2

  !> One *SECTION_SHELL.
  type :: section_t
    integer :: id = 0                          !! user id
    integer :: element_form = form_one_point   !! one of the `form_` constants
    logical :: is_full = .false.               !! full integration, which the implicit method needs
    logical :: is_round = .false.              !! axisymmetric
  end type section_t

  !> One material. Moduli follow from E and nu once, in the deck layer.
  type :: material_t
    integer :: id = 0              !! user id
    integer :: law = law_elastic   !! one of the `law_` constants
    real(wp) :: density = 0.0_wp   !! kg/m^3
    real(wp) :: young = 0.0_wp     !! E
    real(wp) :: poisson = 0.0_wp   !! nu
    real(wp) :: bulk = 0.0_wp      !! K = E/(3(1 - 2 nu))
    real(wp) :: shear = 0.0_wp     !! G = E/(2(1 + nu))
    real(wp) :: sound_speed = 0.0_wp !! c = sqrt((K + 4G/3)/rho)
    real(wp) :: yield = 0.0_wp     !! initial yield stress sigma_Y
    real(wp) :: hardening = 0.0_wp !! plastic modulus E_p = E Et/(E - Et)
    real(wp) :: beta = 1.0_wp      !! 1 isotropic, 0 kinematic, between mixed
    type(hardening_t), allocatable :: curve !! yield stress by points, of a piecewise linear law
    logical :: is_rigid = .false.  !! no stress: parts of it are rigid bodies; E and nu serve
                                   !! contact
    logical :: is_fixed(3) = .false. !! of a rigid body: x, y and the turn about z do not move
  end type material_t

  !> Hourglass control and bulk viscosity of a part (*HOURGLASS, or the *CONTROL defaults).
  type :: hourglass_t
    integer :: id = 0                     !! user id, 0 for the default
    integer :: form = hourglass_viscous   !! one of the `hourglass_` constants
    real(wp) :: coefficient = 0.1_wp      !! Q_h
    real(wp) :: quadratic = 0.0_wp        !! Q1 of the bulk viscosity, 0 = off
    real(wp) :: linear = 0.0_wp           !! Q2 of the bulk viscosity, 0 = off
  end type hourglass_t

  !> One *PART; `section` and `material` are indices, never user ids.
  type :: part_t
    integer :: id = 0                 !! user id
    character(:), allocatable :: title !! heading
    integer :: section = 0            !! index into model%sections
    integer :: material = 0           !! index into model%materials
    type(hourglass_t) :: hourglass    !! what holds for this part
  end type part_t

end module parts_m
