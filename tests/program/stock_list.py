# SPDX-License-Identifier: MIT
"""The stock decks by name, and what the one that is refused asks for."""

#: Decks that run.
RUN = ("impact", "impact_long", "impact_clockwise", "pressure", "contacts", "includes", "rigid", "implicit")

#: What the deck `unsupported` asks for and the program does not have: keyword, and field where the
#: keyword itself is known.
UNSUPPORTED = (
    ("MAT_POWER_LAW_PLASTICITY", ""), ("MAT_JOHNSON_COOK", ""), ("MAT_VISCOELASTIC", ""),
    ("EOS_GRUNEISEN", ""), ("SECTION_SOLID", ""), ("SECTION_BEAM", ""), ("ELEMENT_BEAM", ""),
    ("ELEMENT_MASS", ""), ("ELEMENT_SOLID", ""), ("CONSTRAINED_NODAL_RIGID_BODY", ""),
    ("CONSTRAINED_EXTRA_NODES_SET", ""), ("BOUNDARY_NON_REFLECTING_2D", ""), ("BOUNDARY_TEMPERATURE_SET", ""),
    ("INITIAL_STRESS_SHELL", ""), ("LOAD_BODY_RZ", ""), ("LOAD_BLAST", ""), ("LOAD_THERMAL_CONSTANT", ""),
    ("DAMPING_PART_MASS", ""), ("DAMPING_PART_STIFFNESS", ""), ("RIGIDWALL_GEOMETRIC_SPHERE", ""),
    ("CONTACT_AUTOMATIC_SINGLE_SURFACE", ""), ("CONTACT_2D_AUTOMATIC_SINGLE_SURFACE", ""),
    ("CONTACT_2D_AUTOMATIC_TIED", ""), ("DEFINE_BOX", ""), ("DEFINE_COORDINATE_SYSTEM", ""),
    ("AIRBAG_SIMPLE_PRESSURE_VOLUME", ""), ("SENSOR_DEFINE_NODE", ""), ("CONTROL_IMPLICIT_EIGENVALUE", ""),
    ("CONTROL_TIMESTEP", "DT2MS"), ("CONTROL_TIMESTEP", "ERODE"), ("PART", "EOSID"),
    ("MAT_PLASTIC_KINEMATIC", "FS"), ("MAT_RIGID", "COUPLE"), ("BOUNDARY_SPC_SET", "CID"),
    ("INITIAL_VELOCITY", "BOXID"), ("SECTION_SHELL", "ELFORM"),
    ("CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE", "FS"), ("CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE", "FD"),
    ("CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE", "SLDSOA"))
