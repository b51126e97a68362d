# SPDX-License-Identifier: MIT
"""Seal: the edge of a door presses a hollow rubber seal until it closes on itself."""
import numpy as np

from slideline_tools.decks import Deck
from slideline_tools.scenes.common import CONTACT_TYPES, energies_on, move_rigid, part, part_contact, part_set, plane_strain

OUTER, WALL, EDGE = 8.0e-3, 1.6e-3, 4.0e-3
AROUND, THROUGH = 128, 4


def ring(first=1):
    """Node numbers (circle, angle), points and quads of the seal; angle 0 points down."""
    radii = np.linspace(OUTER - WALL, OUTER, THROUGH + 1)
    angles = 2.0 * np.pi * np.arange(AROUND) / AROUND - 0.5 * np.pi
    points = np.stack([np.outer(radii, np.cos(angles)), np.outer(radii, np.sin(angles))], axis=-1)
    node = first + np.arange(points[..., 0].size).reshape(points.shape[:2])
    after = np.roll(node, -1, axis=1)
    return node, points, np.stack([node[:-1], node[1:], after[1:], after[:-1]], axis=-1).reshape(-1, 4)


def door(first):
    """Node numbers, points and quads of the rounded edge of the door, one row of rigid quads; it touches the seal."""
    angles = np.radians(np.linspace(180.0, 360.0, 25))
    rim = np.column_stack((np.cos(angles), np.sin(angles)))
    centre = np.array([0.0, OUTER + EDGE + 0.05e-3])
    points = np.vstack((centre + EDGE * rim, centre + 0.6 * EDGE * rim))
    n, k = len(rim), first + np.arange(len(rim) - 1)
    return first + np.arange(2 * n), points, np.stack([k, k + 1, n + k + 1, n + k], axis=-1)


def seal(ctype=5):
    """A hollow rubber seal, 16 mm thick with a wall of 1.6 mm, and a rigid edge of radius 4 mm."""
    node, points, quads = ring()
    ids, door_points, door_quads = door(10001)
    deck = Deck("rubber seal that closes on itself", [
        "Seal: the rounded edge of a door, radius 4 mm, presses a hollow rubber seal, outer radius 8 mm, wall 1.6 mm, that "
        "is glued to its frame along the lowest 45 degrees. After 12.8 mm the upper wall reaches the lower one: the seal is in "
        "contact with the door and with itself. One part set with itself (SURFB 0) holds all that may touch. SI units (m, "
        "kg, s, N, Pa), plane strain, per metre of depth.",
        "",
        "Closed form: a thin ring between two point loads shortens by 0.149 F R^3/(E I), E that of plane strain: 19 kN/m "
        "per metre of depth with R = 7.2 mm; here 18 kN/m at 4 mm, and softer beyond.",
        "",
        "Parameters can be set from the command line, for example",
        "  slideline i=seal.k p:mu=0.6 ctype=7"])
    deck.block("The numbers to play with.")
    deck.parameters(
        ("ctype", ctype, "contact type: " + CONTACT_TYPES),
        ("speed", -0.5, "velocity of the door in m/s: the inertia of the rubber hardly matters"),
        ("mu", 0.3, "coefficient of friction, with the door and with itself"),
        ("damp", 100.0, "damping by mass in 1/s: 4 % of critical of the slowest bending of a free ring, 203 Hz"),
        ("endtim", 0.029, "end time in s: the door goes 13.5 mm"),
        ("dtplot", 0.5e-3, "time between the states for pictures in s"),
        ("dthist", 0.1e-3, "time between the rows of the histories in s"))
    deck.block()
    deck.keyword("CONTROL_TERMINATION").card("endtim", "&endtim")
    deck.comment("the first step is computed; each is eight tenths of the stable one")
    deck.keyword("CONTROL_TIMESTEP").card("dtinit tssfac", 0.0, 0.8)
    energies_on(deck)
    deck.keyword("DAMPING_GLOBAL").card("lcid valdmp", 0, "&damp")
    deck.block("Output: energies, contact forces, the door, states, and the innermost node of the upper wall.")
    deck.database(glstat="&dthist", rcforc="&dthist", rbdout="&dthist", nodout="&dthist", spcforc="&dthist",
                  binary_d3plot="&dtplot")
    deck.history_nodes([node[0, AROUND // 2], node[0, 0]])
    deck.block("Rubber of four-point quads (NIP 4: mean dilatation, no locking), and the rigid door.")
    part(deck, 1, "seal", 1, 1)
    part(deck, 2, "door", 1, 2)
    plane_strain(deck, 1, 4)
    deck.comment("Mooney-Rivlin: shear modulus 2 (A + B) = 0.8 MPa, Poisson's ratio 0.49")
    deck.keyword("MAT_MOONEY-RIVLIN_RUBBER").card("mid ro pr a b ref", 1, 1100.0, 0.49, 0.3e6, 0.1e6, 0.0)
    deck.card("sgl sw st lcid", 0.0, 0.0, 0.0, 0)
    deck.comment("E and PR of the door serve the penalty of its contact; it moves along y alone")
    deck.keyword("MAT_RIGID").card("mid ro e pr", 2, 1100.0, 2.4e6, 0.49)
    deck.card("cmo con1 con2", 1, 1, 7)
    deck.curve(1, "velocity of the door over speed", [(0.0, 0.0), (4.0e-3, 1.0), (1.0, 1.0)])
    move_rigid(deck, 2, 2, 1, "&speed")
    deck.block("The seal is glued to its frame from 22.5 degrees left to 22.5 degrees right of its lowest point.")
    deck.node_set(1, "glued", [node[-1, k] for k in range(-AROUND // 16, AROUND // 16 + 1)])
    deck.spc_set(1, True, True)
    deck.block("Contact of everything with everything: SURFB 0. PUNIT 2: PEN is a factor on the stiffness of the elements.")
    part_set(deck, 1, "seal and door", [1, 2])
    part_contact(deck, 1, 0, "&mu", 2.0)
    deck.block(f"Mesh of the seal: {THROUGH} x {AROUND} quads.")
    deck.nodes(node.ravel(), points.reshape(-1, 2))
    deck.quads(1 + np.arange(len(quads)), 1, quads)
    deck.block("The edge of the door.")
    deck.nodes(ids, door_points)
    deck.quads(10001 + np.arange(len(door_quads)), 2, door_quads)
    return deck.text()
