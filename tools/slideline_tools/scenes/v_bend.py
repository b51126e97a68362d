# SPDX-License-Identifier: MIT
"""V bend: a rigid punch bends a steel sheet into a rigid die and is lifted again."""
import numpy as np

from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import CONTACT_TYPES, energies_on, move_rigid, part, part_contact, part_set, plane_strain

THICK, LENGTH, OPENING, RADIUS = 2.0e-3, 25.0e-3, 16.0e-3, 2.0e-3
DEPTH = 1.5e-3   # of the one row of rigid quads of punch and die


def strip(outline, normals):
    """Nodes and quads of one row behind an outline; the body is on the left hand of its walk."""
    points = np.vstack((outline, outline + DEPTH * normals))
    n = len(outline)
    k = np.arange(n - 1)
    return points, np.stack([k, k + 1, n + k + 1, n + k], axis=-1)


def punch():
    """Round tip and flank at 45 degrees, from the plane of symmetry outwards."""
    angles = np.radians(np.linspace(-90.0, -45.0, 7))
    normals = -np.column_stack((np.cos(angles), np.sin(angles)))
    tip = np.array([0.0, THICK + RADIUS]) - RADIUS * normals
    along = np.sqrt(0.5) * np.array([1.0, 1.0])
    flank = tip[-1] + np.outer(np.linspace(0.0, 12.0e-3, 9)[1:], along)
    return strip(np.vstack((tip, flank)), np.vstack((normals, np.tile(normals[-1], (8, 1)))))


def die():
    """Face, round shoulder and flank at 45 degrees, from outside to the plane of symmetry."""
    angles = np.radians(np.linspace(90.0, 135.0, 7))
    normals = -np.column_stack((np.cos(angles), np.sin(angles)))
    shoulder = np.array([0.5 * OPENING + RADIUS, -RADIUS]) - RADIUS * normals
    face = shoulder[0] + np.outer(np.linspace(LENGTH - shoulder[0, 0], 0.0, 9)[:-1], [1.0, 0.0])
    along = -np.sqrt(0.5) * np.array([1.0, 1.0])
    flank = shoulder[-1] + np.outer(np.linspace(0.0, 10.0e-3, 8)[1:], along)
    return strip(np.vstack((face, shoulder, flank)),
                 np.vstack((np.tile(normals[0], (8, 1)), normals, np.tile(normals[-1], (7, 1)))))


def v_bend(ctype=5):
    """A sheet of 2 mm over an opening of 16 mm, half model."""
    sheet = Grid(spaced((0.0, LENGTH, 60)), spaced((0.0, THICK, 5)))
    deck = Deck("V bend", [
        "V bend: a punch with a tip of radius 2 mm bends a steel sheet, 2 mm thick and 50 mm wide, into a die with an "
        "opening of 16 mm and shoulders of radius 2 mm, and is lifted again: the sheet springs back. Half model: x = 0 is "
        "the plane of symmetry. Punch and die are rigid. SI units (m, kg, s, N, Pa), plane strain, per metre of depth.",
        "",
        "Closed form: with the plastic moment M = 2/sqrt(3) SIGY t^2/4 = 289 N the half model needs 2 M/w = 29 kN/m where the sheet "
        "first touches, w = 20 mm apart, and more as the points of contact draw together. Here 30 to 35 kN/m without "
        "hardening and friction, 37 to 49 with them. The sheet springs back by 0.7 degrees a side.",
        "",
        "Parameters can be set from the command line, for example",
        "  slideline i=v_bend.k p:stroke=-3.5 p:mu=0.2"])
    deck.block("The numbers to play with.")
    deck.parameters(
        ("ctype", ctype, "contact type: " + CONTACT_TYPES),
        ("speed", -3.5, "largest velocity of the punch in m/s: goes down 7 mm"),
        ("mu", 0.1, "coefficient of friction"),
        ("endtim", 4.0e-3, "end time in s"),
        ("dtplot", 1.0e-4, "time between the states for pictures in s"),
        ("dthist", 1.0e-5, "time between the rows of the histories in s"))
    deck.block()
    deck.keyword("CONTROL_TERMINATION").card("endtim", "&endtim")
    deck.comment("the first step is computed; each is nine tenths of the stable one")
    deck.keyword("CONTROL_TIMESTEP").card("dtinit tssfac", 0.0, 0.9)
    energies_on(deck)
    deck.block("Output: energies, contact forces, the punch, states, and the lower middle and the end of the sheet.")
    deck.database(glstat="&dthist", rcforc="&dthist", rbdout="&dthist", nodout="&dthist", binary_d3plot="&dtplot")
    deck.history_nodes([sheet.node[0, 0], sheet.node[40, 0], sheet.node[-1, 0]])
    deck.block("A sheet of four-point quads (NIP 4), whose bending needs no hourglass control; rigid tools.")
    for number, heading in enumerate(("sheet", "punch", "die"), 1):
        part(deck, number, heading, 1, number)
    plane_strain(deck, 1, 4)
    deck.comment("steel: yield stress 250 MPa, tangent modulus 1 GPa, isotropic hardening")
    deck.keyword("MAT_PLASTIC_KINEMATIC")
    deck.card("mid ro e pr sigy etan beta", 1, 7850.0, 210.0e9, 0.3, 250.0e6, 1.0e9, 1.0)
    deck.card("src srp fs vp", 0.0, 0.0, 0.0, 0.0)
    deck.comment("the punch moves along y alone (CON1 1: x held, CON2 7: no turn), the die not at all; E and PR of rigid parts serve "
                 "the penalty")
    for number, held in ((2, 1), (3, 7)):
        deck.keyword("MAT_RIGID").card("mid ro e pr", number, 7850.0, 210.0e9, 0.3)
        deck.card("cmo con1 con2", 1, held, 7)
    deck.block("The punch goes down for 2.2 ms, waits, and is lifted from 2.5 ms on.")
    deck.curve(1, "velocity of the punch over speed", [(0.0, 0.0), (0.2e-3, 1.0), (2.0e-3, 1.0), (2.2e-3, 0.0),
                                                       (2.5e-3, 0.0), (2.6e-3, -0.5), (3.0e-3, -0.5), (1.0, -0.5)])
    move_rigid(deck, 2, 2, 1, "&speed")
    deck.comment("once the punch is lifted, damping brings the wings of the sheet to rest (1/s)")
    deck.curve(2, "damping of the sheet", [(0.0, 0.0), (2.5e-3, 0.0), (2.6e-3, 2.0e4), (1.0, 2.0e4)])
    deck.keyword("DAMPING_PART_MASS").card("pid lcid sf", 1, 2, 1.0)
    deck.block("Symmetry at x = 0.")
    deck.node_set(1, "plane of symmetry", sheet.left)
    deck.spc_set(1, True, False)
    deck.block("The sheet is the slave: its mesh is finer than those of the tools. PUNIT 2: PEN is a factor on the stiffness of "
               "the elements.")
    for number, heading in enumerate(("sheet", "punch", "die"), 1):
        part_set(deck, number, heading, [number])
    for master in (2, 3):
        part_contact(deck, 1, master, "&mu")
    deck.block("Mesh of the sheet: 60 x 5 quads.")
    sheet.write(deck, 1)
    for number, (points, quads) in ((2, punch()), (3, die())):
        deck.block()
        deck.nodes(10000 * number + np.arange(len(points)), points)
        deck.quads(10000 * number + np.arange(len(quads)), number, 10000 * number + quads)
    return deck.text()
