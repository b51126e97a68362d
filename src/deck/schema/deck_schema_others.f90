! SPDX-License-Identifier: MIT
!> Keywords of LS-DYNA that this program ignores or refuses.
module deck_schema_others_m
  implicit none
  private
  public :: table_others

  !> Names separated by commas, then `ignored` or the beginning of `... not available in slideline`;
  !> the first match counts. An asterisk matches any ending. `unknown` excludes misspelt names of a
  !> family with honoured keywords from the lines below it.
  character(88), parameter :: table_others(*) = [character(88) :: &
    'MAT_* this material is', &
    'EOS_* this equation of state is', &
    'ELEMENT_MASS_PART* masses of whole parts are', &
    'ELEMENT_MASS_MATRIX* matrices of mass are', &
    'ELEMENT_SHELL_* shells with thickness or offset are', &
    'ELEMENT_* this element is', &
    'SECTION_* this kind of section is', &
    'SET_* this kind of set is', &
    'BOUNDARY_PRESCRIBED_MOTION_RIGID* axes of bodies are', &
    'BOUNDARY_* this condition is', &
    'INITIAL_AXIAL_FORCE_BEAM* beams with initial forces are', &
    'INITIAL_STRESS_*,INITIAL_STRAIN_* stresses of such elements or of sets are', &
    'INITIAL_* this initial condition is', &
    'LOAD_BODY_Z loads out of the plane are', &
    'LOAD_BODY_R* spinning frames are', &
    'LOAD_* this load is', &
    'DAMPING_* this damping is', &
    'RIGIDWALL_PLANAR_* this option of a planar rigid wall is', &
    'RIGIDWALL_* this kind of rigid wall is', &
    'CONSTRAINED_* this constraint is', &
    'CONTACT_2D_AUTOMATIC_SINGLE_SURFACE_THERMAL* heat through contact is', &
    'CONTACT_2D_AUTOMATIC_ONE_WAY_SURFACE_TO_SURFACE_THERMAL* heat through contact is', &
    'CONTACT_2D_AUTOMATIC_SINGLE_SURFACE_MORTAR_THERMAL* heat through contact is', &
    'CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE_MORTAR_THERMAL* heat through contact is', &
    'CONTACT_2D_AUTOMATIC_TIED_ONE_WAY_THERMAL* heat through contact is', &
    'CONTACT_2D_AUTOMATIC_TIED_THERMAL* heat through contact is', &
    'CONTACT_2D_AUTOMATIC_SURFACE_IN_CONTINUUM* this kind of contact is', &
    'CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE_THERMAL* heat through contact is', &
    'CONTACT_2D_AUTOMATIC_NODE_TO_SURFACE_THERMAL* heat through contact is', &
    'CONTACT_2D_NODE_TO_SOLID* this kind of contact is', &
    'CONTACT_2D_SLIDING_ONLY* sliding without separation is', &
    'CONTACT_2D_* unknown', &
    'CONTACT_* three-dimensional contact is', &
    'DEFINE_* this definition is', &
    'PART_* this option of *PART is', &
    'INCLUDE_* this kind of include is', &
    'NODE_* this kind of node is', &
    'CONTROL_IMPLICIT_AUTO_DYN switching phases of an implicit run is', &
    'CONTROL_IMPLICIT_AUTO_SPR,CONTROL_IMPLICIT_DYNAMICS_SPR springback phases are', &
    'CONTROL_IMPLICIT_BUCKLE a buckling analysis is', &
    'CONTROL_IMPLICIT_CONSISTENT_MASS a consistent mass matrix is', &
    'CONTROL_IMPLICIT_DYNAMICS_DYN switching phases of an implicit run is', &
    'CONTROL_IMPLICIT_EIGENVALUE* an eigenvalue analysis is', &
    'CONTROL_IMPLICIT_EXPLICIT_HYBRID an implicit analysis of chosen parts is', &
    'CONTROL_IMPLICIT_FORMING*,CONTROL_IMPLICIT_INERTIA_RELIEF this implicit option is', &
    'CONTROL_IMPLICIT_GENERAL_DYN switching phases of an implicit run is', &
    'CONTROL_IMPLICIT_GENERAL_SPR,CONTROL_IMPLICIT_SOLUTION_SPR springback phases are', &
    'CONTROL_IMPLICIT_MODAL_DYNAMIC*,CONTROL_IMPLICIT_MODES* a modal analysis is', &
    'CONTROL_IMPLICIT_RESIDUAL_VECTOR a modal analysis is', &
    'CONTROL_IMPLICIT_ROTATIONAL_DYNAMICS rotating parts are', &
    'CONTROL_IMPLICIT_SOLUTION_DYN switching phases of an implicit run is', &
    'CONTROL_IMPLICIT_SSD* a steady state analysis is', &
    'CONTROL_IMPLICIT_STABILIZATION* artificial stabilisation is', &
    'CONTROL_IMPLICIT_STATIC_CONDENSATION* static condensation is', &
    'CONTROL_IMPLICIT_TERMINATION an end by displacement or energy is', &
    'CONTROL_2D_REMESHING*,CONTROL_REMESHING* remeshing during the run is', &
    'CONTROL_ACOUSTIC*,CONTROL_VIBRO_ACOUSTIC acoustics is', &
    'CONTROL_ADAP* adaptive meshing is', &
    'CONTROL_AIRBAG,CONTROL_CPM,AIRBAG_* airbags are', &
    'CONTROL_COARSEN mesh coarsening is', &
    'CONTROL_COUPLING,COSIM_* coupling to another program is', &
    'CONTROL_DISCRETE_ELEMENT* discrete elements are', &
    'CONTROL_EFG meshless parts are', &
    'CONTROL_EXPLICIT_THERMAL_*,CONTROL_THERMAL_* a thermal analysis is', &
    'CONTROL_EXPLOSIVE_SHADOW* explosives are', &
    'CONTROL_FORMING_* set-up of metal forming is', &
    'CONTROL_FREQUENCY_*,FREQUENCY_* a frequency domain analysis is', &
    'CONTROL_HOURGLASS_936 this variant of hourglass control is', &
    'CONTROL_NONLOCAL nonlocal failure is', &
    'CONTROL_PORE_* pore pressure is', &
    'CONTROL_PZELECTRIC a piezoelectric analysis is', &
    'CONTROL_REFERENCE_* a search for the unloaded shape is', &
    'CONTROL_REFINE_* refinement of the mesh during the run is', &
    'CONTROL_SEGMENTS_IN_ALE*,ALE_* ALE is', &
    'CONTROL_STAGED_CONSTRUCTION staged construction is', &
    'CONTROL_START a start time other than 0 is', &
    'CONTROL_STEADY_STATE_ROLLING rolling in the steady state is', &
    'CONTROL_SUBCYCLE_* mass scaling of chosen parts is', &
    'CONTROL_SOLID,CONTROL_CPU,CONTROL_PARALLEL,CONTROL_MPP_* ignored', &
    'CONTROL_ACCURACY,CONTROL_IMPLICIT_JOINTS,CONTROL_IMPLICIT_ORDERING ignored', &
    'CONTROL_IMPLICIT_SOLVER*,CONTROL_STRUCTURED*,CONTROL_DEBUG,CONTROL_SPOTWELD_BEAM ignored', &
    'CONTROL_REQUIRE_REVISION,CONTROL_SPH*,CONTROL_ALE,CONTROL_CHECK*,CONTROL_LSDA ignored', &
    'CONTROL_SUBCYCLE,CONTROL_RIGID,DATABASE_FORMAT,DATABASE_BINARY_D3THDT ignored', &
    'DATABASE_BINARY_INTFOR*,DATABASE_BINARY_D3DRLF,DATABASE_BINARY_D3PROP ignored', &
    'DATABASE_BINARY_D3PART a plot file of some parts is', &
    'DATABASE_BINARY_BLSTFOR,DATABASE_ABSTAT*,DATABASE_JNTFORC,DATABASE_DEFORC ignored', &
    'DATABASE_NCFORC*,DATABASE_EXTENT_*,DATABASE_GCEOUT,DATABASE_SPHOUT ignored', &
    'DATABASE_TPRINT,DATABASE_SBTOUT,DATABASE_SWFORC,DATABASE_DISBOUT,DATABASE_ATDOUT ignored', &
    'DATABASE_AVSFLT,DATABASE_MOVIE,DATABASE_MPGS,DATABASE_TRHIST,DATABASE_CURVOUT ignored', &
    'DATABASE_PLLYOUT,DATABASE_FREQUENCY_*,COMPONENT_* ignored', &
    'DATABASE_HISTORY_ACOUSTIC*,DATABASE_HISTORY_BEAM* a history of such elements is', &
    'DATABASE_HISTORY_DISCRETE*,DATABASE_HISTORY_SEATBELT* a history of such elements is', &
    'DATABASE_HISTORY_NODE_LOCAL*,DATABASE_HISTORY_NODE_SET_LOCAL* a history in local axes is', &
    'DATABASE_HISTORY_SHELL_ID* a heading of a shell (give *DATABASE_HISTORY_SHELL) is', &
    'DATABASE_HISTORY_SOLID*,DATABASE_HISTORY_SPH* a history of such elements is', &
    'DATABASE_HISTORY_TSHELL* a history of such elements is', &
    'DATABASE_ACEOUT,DATABASE_PBSTAT,DATABASE_SSSTAT* this output is', &
    'DATABASE_CROSS_SECTION_PLANE* sections cut by a plane (give sets by _SET) are', &
    'INTERFACE_SPRINGBACK_* this form of the file of a next stage is', &
    'INTERFACE_* a file for another run is', &
    'CASE,CASE_* several runs of one deck are', &
    'DATABASE_* this output is', &
    'TERMINATION_* this end of a run is', &
    'PERTURBATION_* perturbations are', &
    'DEFORMABLE_TO_RIGID* switching parts to rigid bodies is', &
    'EF_* this keyword family is', &
    'BATTERY_* electrochemistry is', &
    'CESE_*,DUALCESE_*,ICFD_* flow of fluids is', &
    'CHANGE_*,DELETE_* a change at a restart (besides outputs and the end) is', &
    'CHEMISTRY_* chemistry is', &
    'CONTROLLER_* a controller is', &
    'EM_* electromagnetism is', &
    'FATIGUE* a fatigue analysis is', &
    'IGA_* isogeometric analysis is', &
    'INTEGRATION_* an integration rule of shells or beams is', &
    'LSO_* output of other solvers is', &
    'MESH_* meshing by the program is', &
    'MODULE_* code of users is', &
    'PARTICLE_* blast by particles is', &
    'RAIL_* trains are', &
    'RIGID_DEFORMABLE_* a change at a restart (besides outputs and the end) is', &
    'RVE_* a representative volume is', &
    'STRESS_INITIALIZATION* a change at a restart (besides outputs and the end) is', &
    'SENSOR_* sensors are', &
    'USER_* user interfaces are', &
    'PARAMETER_TYPE* this kind of parameter is']

end module deck_schema_others_m
