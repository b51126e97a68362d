# SPDX-License-Identifier: MIT
"""Blocks of a deck that several scenes need, and their materials (SI units)."""
from slideline_tools.contact_types import PROGRAM_NAMES

STEEL = dict(rho=7850.0, young=210.0e9, poisson=0.3)
ALUMINIUM = dict(rho=2700.0, young=69.0e9, poisson=0.33, yield_stress=276.0e6)

CONTACT_TYPES = ", ".join(f"{number} {name}" for number, name in PROGRAM_NAMES.items())
WALKED = ("The two surfaces as node sets in walking order: the body lies on the left hand, so a lower face runs from left to right, "
          "an upper face from right to left.")


def part(deck, number, heading, section, material):
    deck.keyword("PART", heading)
    return deck.card("pid secid mid eosid hgid", number, section, material, 0, 0)


def plane_strain(deck, section, points=1):
    """Plane-strain section of 1 or 4 points; the thickness is not used (unit depth)."""
    deck.keyword("SECTION_SHELL").card("secid elform shrf nip", section, 13, 1.0, points)
    return deck.card("t1 t2 t3 t4", 1.0, 1.0, 1.0, 1.0)


def elastic(deck, number, rho, young, poisson):
    return deck.keyword("MAT_ELASTIC").card("mid ro e pr", number, rho, young, poisson)


def rigid(deck, number, rho, young, poisson, turn_held=True):
    """A rigid body whose centre is free; its turn about z is held unless asked otherwise."""
    deck.keyword("MAT_RIGID").card("mid ro e pr", number, rho, young, poisson)
    deck.card("cmo con1 con2", 1, 0, 7 if turn_held else 0)
    return deck.card("lco a2 a3 v1 v2 v3", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def perfectly_plastic(deck, number, rho, young, poisson, yield_stress):
    deck.keyword("MAT_PLASTIC_KINEMATIC")
    deck.card("mid ro e pr sigy etan beta", number, rho, young, poisson, yield_stress, 0.0, 1.0)
    return deck.card("src srp fs vp", 0.0, 0.0, 0.0, 0.0)


def implicit_static(deck, step):
    """Static equilibrium by the implicit method, in constant steps (a number or a parameter)."""
    return deck.keyword("CONTROL_IMPLICIT_GENERAL").card("imflag dt0", 1, step)


def implicit_dynamic(deck, step):
    """Dynamics by the implicit method (generalised-alpha), in constant steps."""
    implicit_static(deck, step)
    return deck.keyword("CONTROL_IMPLICIT_DYNAMICS").card("imass", 1)


def energies_on(deck):
    """All energies are computed and enter the balance of glstat."""
    return deck.keyword("CONTROL_ENERGY").card("hgen rwen slnten rylen", 2, 2, 2, 2)


def meshes(deck, *bodies):
    """The mesh of each body, (words, grid), as parts 1, 2 ...; the text of the deck, which ends with them."""
    for number, (words, grid) in enumerate(bodies, start=1):
        deck.block(f"Mesh of the {words}.")
        grid.write(deck, number)
    return deck.text()


def slideline(deck, slave, master):
    """*CONTACT_2D_SLIDELINE between two node sets; type, points and penalty are parameters."""
    deck.keyword("CONTACT_2D_SLIDELINE")
    return deck.card("surfa surfb ctype ngauss pen fs fd dc",
                     -slave, -master, "&ctype", "&ngauss", "&pen", 0.0, 0.0, 0.0)


def contact_surfaces(deck, slave, master, exchanged=False, note=False, about=WALKED):
    """Both surfaces, (words, nodes), as node sets 3 and 4, and the contact between them, below a line `about` them;
    `exchanged`: the roles change, not the sets."""
    deck.block(about)
    roles = ("master", "slave") if exchanged else ("slave", "master")
    for number, role, (words, nodes) in zip((3, 4), roles, (slave, master)):
        deck.node_set(number, f"{role}: {words}", nodes)
    if note:
        deck.comment("A negative SURFA or SURFB is a node set. PEN is in N/m per contact node.")
    return slideline(deck, *((4, 3) if exchanged else (3, 4)))
