# SPDX-License-Identifier: MIT
"""Folding tube: a steel tube between two rigid plates folds like a concertina, axisymmetric."""
import numpy as np

from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import CONTACT_TYPES, energies_on, move_rigid, part, part_contact, part_set

RADIUS, THICK, LENGTH = 20.0e-3, 2.0e-3, 80.0e-3


def tube_grids():
    """Tube, moving plate, standing plate. The tube has a dent where the first fold shall begin."""
    tube = Grid(spaced((RADIUS - 0.5 * THICK, RADIUS + 0.5 * THICK, 4)), spaced((0.0, LENGTH, 128)))
    from_top = LENGTH - tube.points[..., 1]
    wave = 8.5e-3   # half a fold, 0.95 sqrt(D t)
    tube.points[..., 0] += np.where(from_top < 2.0 * wave, 0.1e-3 * np.sin(np.pi * from_top / wave) ** 2, 0.0)
    plates = [Grid(spaced((8.0e-3, 34.0e-3, 13)), spaced((low, low + 3.0e-3, 1)), first, first)
              for low, first in ((LENGTH, 10001), (-3.0e-3, 20001))]
    return [tube, *plates]


def tube(ctype=5):
    """A tube of 42 mm outside, 2 mm thick and 80 mm long, crushed by 50 mm."""
    grids = tube_grids()
    deck = Deck("folding tube", [
        "Folding tube: a rigid plate crushes a steel tube, 40 mm in mean diameter D, t = 2 mm thick and 80 mm long, by 50 mm. It "
        "buckles into rings one after the other and is in contact with itself. Axisymmetric (ELFORM 15): x is the radius, y "
        "the axis; forces, masses and energies are per radian (times 2 pi for the whole tube). SI units (m, kg, s, N, Pa).",
        "",
        "Alexander (1960): mean force 6 Y sqrt(D) t^1.5 = 107 mm^2 Y; with Y = 2/sqrt(3) times 358 MPa, the mean flow stress "
        "over all plastic strain of this run, 44 kN. Here 50 kN up to 48 mm, at 5 m/s 46 kN, with friction. His folds are 1.9 sqrt(D t) = "
        "17 mm long without hardening, here 24 mm.",
        "",
        "Parameters can be set from the command line, for example",
        "  slideline i=tube.k p:speed=-10 p:endtim=5e-3"])
    deck.block("The numbers to play with.")
    deck.parameters(
        ("ctype", ctype, "contact type: " + CONTACT_TYPES),
        ("speed", -20.0, "velocity of the plate in m/s"),
        ("mu", 0.2, "coefficient of friction"),
        ("endtim", 2.5e-3, "end time in s: 50 mm"),
        ("dtplot", 5.0e-5, "time between the states for pictures in s"),
        ("dthist", 5.0e-6, "time between the rows of the histories in s"))
    deck.block()
    deck.keyword("CONTROL_TERMINATION").card("endtim", "&endtim")
    deck.comment("the first step is computed; each is eight tenths of the stable one")
    deck.keyword("CONTROL_TIMESTEP").card("dtinit tssfac", 0.0, 0.8)
    energies_on(deck)
    deck.block("Output: energies, contact forces, parts, the plates, and states.")
    deck.database(glstat="&dthist", rcforc="&dthist", matsum="&dthist", rbdout="&dthist", binary_d3plot="&dtplot")
    deck.block("A tube of four-point quads (NIP 4), four through its wall, and rigid plates.")
    for number, heading in enumerate(("tube", "moving plate", "standing plate"), 1):
        part(deck, number, heading, 1, number)
    deck.keyword("SECTION_SHELL").card("secid elform shrf nip", 1, 15, 1.0, 4)
    deck.card("t1 t2 t3 t4", 0.0, 0.0, 0.0, 0.0)
    deck.comment("mild steel: yield stress 250 MPa, tangent modulus 500 MPa, isotropic hardening")
    deck.keyword("MAT_PLASTIC_KINEMATIC")
    deck.card("mid ro e pr sigy etan beta", 1, 7850.0, 210.0e9, 0.3, 250.0e6, 500.0e6, 1.0)
    deck.card("src srp fs vp", 0.0, 0.0, 0.0, 0.0)
    deck.comment("one plate moves along y alone (CON1 1: x held, CON2 7: no turn), the other not at all; E and PR serve the penalty")
    for number, held in ((2, 1), (3, 7)):
        deck.keyword("MAT_RIGID").card("mid ro e pr", number, 7850.0, 210.0e9, 0.3)
        deck.card("cmo con1 con2", 1, held, 7)
    deck.curve(1, "velocity of the plate over speed", [(0.0, 0.0), (1.0e-4, 1.0), (1.0, 1.0)])
    move_rigid(deck, 2, 2, 1, "&speed")
    deck.block("Contact of everything with everything: SURFB 0. PUNIT 2: PEN is a factor on the stiffness of the elements.")
    part_set(deck, 1, "tube and plates", [1, 2, 3])
    part_contact(deck, 1, 0, "&mu")
    for number, grid in enumerate(grids, 1):
        deck.block()
        grid.write(deck, number)
    return deck.text()
