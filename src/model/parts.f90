! SPDX-License-Identifier: MIT
!> Parts, sections, materials, hourglass control and bulk viscosity.
module parts_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use curves_m, only : curve_t
  use eos_m, only : eos_t, eos_by_law
  use hardenings_m, only : hardening_t
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t, absent
  implicit none
  private
  public :: part_t, section_t, material_t, hourglass_t, has_memory_of_heat, &
    may_fail, gives_pressure, law_mooney_rivlin, law_blatz_ko, law_crushable_foam, &
    form_one_point, form_full, form_axisym_one_point, form_axisym_full, law_elastic, law_plastic, &
    law_piecewise, law_johnson_cook, law_hot_johnson_cook, law_null, law_viscoelastic, law_ogden, &
    hourglass_viscous, hourglass_stiffness, hourglass_assumed, spall_pressure, spall_stress, &
    spall_tension, johnson_cook_t, rubber_t, mooney_rivlin, blatz_ko, blatz_ko_poisson, &
    erosion_t, asks_for_strain, asks_for_stress, condensed_bulk

  !> Element forms, known to the element dispatcher only.
  integer, parameter :: form_one_point = 1, form_full = 2, form_axisym_one_point = 3, &
    form_axisym_full = 4
  !> Material laws, known to the material dispatcher only.
  integer, parameter :: law_elastic = 1, law_plastic = 2, law_piecewise = 3, &
    law_johnson_cook = 4, law_crushable_foam = 5, law_hot_johnson_cook = 6, law_null = 7, &
    law_mooney_rivlin = 8, law_blatz_ko = 9, law_viscoelastic = 10, law_ogden = 11
  !> Meaning of the pressure cut-off (SPALL): bound of the tension; tensile stress at failure;
  !> tension at failure.
  integer, parameter :: spall_pressure = 1, spall_stress = 2, spall_tension = 3
  !> Hourglass control: viscous (IHQ 1 to 3 and blank), stiffness (4 and 5) or assumed strain (6).
  integer, parameter :: hourglass_viscous = 1, hourglass_stiffness = 2, hourglass_assumed = 3

  !> One *SECTION_SHELL.
  type :: section_t
    integer :: id = 0                          !! user id
    integer :: element_form = form_one_point   !! one of the `form_` constants
    logical :: is_full = .false.               !! full integration
    logical :: is_axisymmetric = .false.       !! axisymmetric
    logical :: is_plane_stress = .false.       !! plane stress
    real(wp) :: thickness = 1.0_wp             !! T1 of plane stress, m; else 1
  end type section_t

  !> Constants of Johnson and Cook (1983, 1985), flow stress, heat and damage:
  !> sigma = (A + B p^n)(1 + C ln(rate/rate0))(1 - T*^m), the rate not below rate0.
  type :: johnson_cook_t
    real(wp) :: a = 0.0_wp, b = 0.0_wp, n = 1.0_wp, c = 0.0_wp
    real(wp) :: rate = 1.0_wp            !! rate0, 1/s
    real(wp) :: most_static = huge(1.0_wp) !! SIGMAX, bound on A + B p^n
    real(wp) :: most = huge(1.0_wp)      !! SIGSAT, bound on the flow stress
    real(wp) :: m = 1.0_wp               !! thermal exponent
    real(wp) :: span = 1.0_wp            !! melting temperature less room temperature, K
    real(wp) :: room = 0.0_wp            !! room temperature, at which everything starts
    real(wp) :: heat = 0.0_wp            !! 1/(rho0 c_p), K m^3/J; 0 = no heating
    real(wp) :: d(5) = 0.0_wp            !! D1 to D5
    real(wp) :: least = 0.0_wp           !! EFMIN, bound on the strain at fracture
    logical :: is_viscoplastic = .false. !! the rate is that of the plastic strain
    logical :: keeps_broken = .false.    !! failed elements are not deleted (EROD)
    logical :: has_damage = .false.
    logical :: has_memory = .false.      !! points have temperature and damage
  end type johnson_cook_t

  !> Poisson's ratio of the law of Blatz and Ko.
  real(wp), parameter :: blatz_ko_poisson = 0.463_wp

  !> Constants of rubbers: W = A (I - 3) + B (II - 3) + U(J), I and II the invariants of C = F^T F.
  type :: rubber_t
    real(wp) :: a = 0.0_wp, b = 0.0_wp !! A and B
    real(wp) :: c = 0.0_wp, d = 0.0_wp !! Mooney & Rivlin: U = C (J^-4 - 1) + D (J^2 - 1)^2
    real(wp) :: exponent = 0.0_wp      !! Blatz & Ko: U = 2A (J^-exponent - 1)/exponent
    ! Ogden: W = sum mu/alpha (sum l^alpha - 3) + bulk (J - 1 - ln J), l stretches over J^(1/3).
    integer :: n_term = 0
    real(wp) :: mu(8) = 0.0_wp, alpha(8) = 0.0_wp, bulk = 0.0_wp
  end type rubber_t

  !> Erosion criteria of a material: of its law, of *CONTROL_TIMESTEP, and of *MAT_ADD_EROSION;
  !> criteria that the deck does not give are infinite.
  type :: erosion_t
    logical :: by_law = .false.         !! when all integration points have failed
    logical :: by_step = .false.        !! ERODE: when its time step or volume vanishes
    real(wp) :: least_step = 0.0_wp     !! DTMIN, s
    real(wp) :: most_pressure = huge(1.0_wp)       !! MXPRES
    real(wp) :: least_pressure = -huge(1.0_wp)     !! MNPRES
    real(wp) :: principal_stress = huge(1.0_wp)    !! SIGP1
    real(wp) :: mises = huge(1.0_wp)               !! SIGVM
    real(wp) :: most_strain = huge(1.0_wp)         !! MXEPS, logarithmic as all strains
    real(wp) :: least_strain = -huge(1.0_wp)       !! MNEPS
    real(wp) :: effective_strain = huge(1.0_wp)    !! EFFEPS
    real(wp) :: shear_strain = huge(1.0_wp)        !! EPSSH, half of max - min principal strain
    real(wp) :: most_volume = huge(1.0_wp)         !! VOLEPS above 0: ln(V/V0)
    real(wp) :: least_volume = -huge(1.0_wp)       !! VOLEPS below 0
    real(wp) :: threshold = 0.0_wp                 !! SIGTH
    real(wp) :: impulse = huge(1.0_wp)             !! IMPULSE
    real(wp) :: time = huge(1.0_wp)                !! FAILTM
    integer :: n_given = 0                         !! number of criteria on the card
    integer :: n_criteria = 1                      !! NCS: number of criteria that must hold
    integer :: n_point = 1                         !! NUMFIP: number of points where they must hold
  end type erosion_t

  !> One material. Moduli follow from E and nu once, in the deck layer.
  type, extends(visited_t) :: material_t
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
    real(wp) :: viscosity = 0.0_wp !! dynamic viscosity of a fluid, Pa s
    real(wp) :: long_shear = 0.0_wp !! viscoelastic: shear modulus after a long time
    real(wp) :: decay = -1.0_wp    !! viscoelastic: decay constant, 1/s; below 0: it is not
    type(hardening_t), allocatable :: curve !! piecewise linear yield stress
    type(johnson_cook_t), allocatable :: flow !! constants of Johnson and Cook
    type(rubber_t), allocatable :: rubber !! hyperelastic constants
    type(curve_t), allocatable :: crush !! crushable foam: yield stress against 1 - V/V0
    real(wp) :: tension = 0.0_wp   !! crushable foam: tensile cut-off stress
    type(eos_t), allocatable :: eos !! pressure with history: equation of state, or K ln(J) where
                                    !! points may fail
    real(wp) :: failure_strain = huge(1.0_wp) !! plastic strain at failure
    real(wp) :: cutoff = -huge(1.0_wp) !! pressure cut-off, 0 or below
    integer :: spall = spall_pressure  !! meaning of the cut-off
    type(erosion_t), allocatable :: erosion !! allocated where its elements may erode
    logical :: takes_eos = .false.   !! its parts may have an equation of state
    logical :: needs_eos = .false.   !! its parts must have an equation of state
    logical :: is_rigid = .false.  !! rigid bodies; E and nu for contact only
    logical :: is_fixed(3) = .false. !! rigid body: fixed x, y and rotation about z
    logical :: is_plane_stress = .false. !! its law holds with sigma_zz = 0 (`plane_stress`); `eos`
                                         !! is allocated, by law
    logical :: follows_strain = .false. !! plane stress: forces follow the thickness (ISTUPD)
  contains
    procedure :: visit => visit_material
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
  type, extends(visited_t) :: part_t
    integer :: id = 0                 !! user id
    character(:), allocatable :: title !! heading
    integer :: section = 0            !! index into model%sections
    integer :: material = 0           !! index into model%materials
    type(hourglass_t) :: hourglass
    real(wp) :: stiffness_damping = 0.0_wp !! COEF of *DAMPING_PART_STIFFNESS: fraction of critical
                                           !! damping of the highest mode, below 0 a time in s
  contains
    procedure :: visit => visit_part
  end type part_t

contains

  !> Whether integration points of a material have temperature and damage.
  pure elemental function has_memory_of_heat(material) result(yes)
    type(material_t), intent(in) :: material
    logical :: yes

    yes = .false.
    if (allocated(material%flow)) yes = material%flow%has_memory
  end function has_memory_of_heat

  !> Whether the law of a material gives the pressure too.
  pure function gives_pressure(material) result(yes)
    type(material_t), intent(in) :: material
    logical :: yes

    yes = .false.
    if (allocated(material%eos)) yes = material%eos%kind == eos_by_law
  end function gives_pressure

  !> Whether integration points of a material may fail.
  pure elemental function may_fail(material) result(yes)
    type(material_t), intent(in) :: material
    logical :: yes

    yes = material%failure_strain < huge(1.0_wp) .or. material%spall /= spall_pressure
    if (allocated(material%flow)) yes = yes .or. material%flow%has_damage
  end function may_fail

  !> Constants of Mooney and Rivlin: C for zero initial stress, D for Poisson's ratio.
  pure function mooney_rivlin(a, b, poisson) result(rubber)
    real(wp), intent(in) :: a, b, poisson
    type(rubber_t) :: rubber

    rubber%a = a
    rubber%b = b
    rubber%c = 0.5_wp*a + b
    rubber%d = (a*(5.0_wp*poisson - 2.0_wp) + b*(11.0_wp*poisson - 5.0_wp)) &
      /(2.0_wp*(1.0_wp - 2.0_wp*poisson))
  end function mooney_rivlin

  !> Constants of Blatz and Ko; B = 0.
  pure function blatz_ko(shear) result(rubber)
    real(wp), intent(in) :: shear
    type(rubber_t) :: rubber

    rubber%a = 0.5_wp*shear
    rubber%exponent = 2.0_wp*blatz_ko_poisson/(1.0_wp - 2.0_wp*blatz_ko_poisson)
  end function blatz_ko

  !> Whether an erosion criterion depends on strains.
  pure function asks_for_strain(erosion) result(asks)
    type(erosion_t), intent(in) :: erosion
    logical :: asks

    asks = min(erosion%most_strain, erosion%effective_strain, erosion%shear_strain, &
      -erosion%least_strain) < huge(1.0_wp)
  end function asks_for_strain

  !> Whether an erosion criterion depends on stresses of integration points.
  pure function asks_for_stress(erosion) result(asks)
    type(erosion_t), intent(in) :: erosion
    logical :: asks

    asks = min(erosion%principal_stress, erosion%mises, erosion%impulse) < huge(1.0_wp)
  end function asks_for_stress

  !> K' that gives with G in plane strain what K gives in plane stress: K' + 4G/3 = E/(1 - nu^2).
  pure elemental function condensed_bulk(bulk, shear) result(condensed)
    real(wp), intent(in) :: bulk, shear
    real(wp) :: condensed

    condensed = 4.0_wp*shear*(6.0_wp*bulk - shear)/(3.0_wp*(3.0_wp*bulk + 4.0_wp*shear))
  end function condensed_bulk

  !> Visit the components of a material.
  subroutine visit_material(self, visitor)
    class(material_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('id', self%id)
    call visitor%visit('law', self%law)
    call visitor%visit('density', self%density)
    call visitor%visit('young', self%young)
    call visitor%visit('poisson', self%poisson)
    call visitor%visit('bulk', self%bulk)
    call visitor%visit('shear', self%shear)
    call visitor%visit('sound_speed', self%sound_speed)
    call visitor%visit('yield', self%yield)
    call visitor%visit('hardening', self%hardening)
    call visitor%visit('beta', self%beta)
    call visitor%visit('viscosity', self%viscosity)
    call visitor%visit('long_shear', self%long_shear)
    call visitor%visit('decay', self%decay)
    if (visitor%makes(merge(1, absent, allocated(self%curve)))) allocate (self%curve)
    if (allocated(self%curve)) call visitor%part('curve', self%curve)
    if (visitor%makes(merge(1, absent, allocated(self%flow)))) allocate (self%flow)
    if (allocated(self%flow)) call visitor%plain(c_loc(self%flow), storage_size(self%flow), 1)
    if (visitor%makes(merge(1, absent, allocated(self%rubber)))) allocate (self%rubber)
    if (allocated(self%rubber)) call visitor%plain(c_loc(self%rubber), storage_size(self%rubber), 1)
    if (visitor%makes(merge(1, absent, allocated(self%crush)))) allocate (self%crush)
    if (allocated(self%crush)) call visitor%part('crush', self%crush)
    call visitor%visit('tension', self%tension)
    if (visitor%makes(merge(1, absent, allocated(self%eos)))) allocate (self%eos)
    if (allocated(self%eos)) call visitor%plain(c_loc(self%eos), storage_size(self%eos), 1)
    call visitor%visit('failure_strain', self%failure_strain)
    call visitor%visit('cutoff', self%cutoff)
    call visitor%visit('spall', self%spall)
    if (visitor%makes(merge(1, absent, allocated(self%erosion)))) allocate (self%erosion)
    if (allocated(self%erosion)) &
      call visitor%plain(c_loc(self%erosion), storage_size(self%erosion), 1)
    call visitor%visit('takes_eos', self%takes_eos)
    call visitor%visit('needs_eos', self%needs_eos)
    call visitor%visit('is_rigid', self%is_rigid)
    call visitor%plain(c_loc(self%is_fixed), storage_size(self%is_fixed), size(self%is_fixed))
    call visitor%visit('is_plane_stress', self%is_plane_stress)
    call visitor%visit('follows_strain', self%follows_strain)
  end subroutine visit_material

  !> Visit the components of a part.
  subroutine visit_part(self, visitor)
    class(part_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('id', self%id)
    call visitor%visit('title', self%title)
    call visitor%visit('section', self%section)
    call visitor%visit('material', self%material)
    call visitor%plain(c_loc(self%hourglass), storage_size(self%hourglass), 1)
    call visitor%visit('stiffness_damping', self%stiffness_damping)
  end subroutine visit_part

end module parts_m
