# SPDX-License-Identifier: MIT
"""Oblique impact: a turned block flies onto a larger free block."""
import numpy as np

from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import (CONTACT_TYPES, elastic, energies_on, meshes, part,
                                           plane_strain, contact_surfaces)

ANGLE, FIRST_GAP = 30.0, 0.01


def oblique_grids():
    """Large block and turned block, both free."""
    large = Grid(spaced((-1.2, 1.2, 16)), spaced((-0.9, 0.0, 6)))
    turned = Grid(spaced((-0.35, 0.35, 7)), spaced((0.0, 0.5, 5)),
                  first_node=10001, first_element=10001)
    angle = np.radians(ANGLE)
    x, y = turned.points[..., 0].copy(), turned.points[..., 1].copy()
    turned.points[..., 0] = np.cos(angle) * x - np.sin(angle) * y
    turned.points[..., 1] = np.sin(angle) * x + np.cos(angle) * y
    turned.points[..., 1] += FIRST_GAP - turned.points[..., 1].min()
    return large, turned


def oblique(ctype=2, ngauss=4, exchanged=False):
    """Oblique impact of a block turned by 30 degrees; `exchanged`: the large block is the slave."""
    large, turned = oblique_grids()
    deck = Deck("oblique impact of a turned block" + (" exchanged" if exchanged else ""), [
        "A block turned by 30 degrees flies obliquely onto a larger block; both are free. SI units "
        "(m, kg, s, N, Pa), plane strain, per metre of depth.",
        "",
        "Momentum and angular momentum are conserved; the block is set spinning by the blow at its "
        "corner.",
    ])
    deck.block("The numbers to play with.")
    deck.parameters(
        ("ctype", ctype, "contact type: " + CONTACT_TYPES),
        ("ngauss", ngauss, "Gauss points of a slave segment of type 6"),
        ("pen", 5.0e5, "penalty of a contact node in N/m"),
        ("vx", 0.4, "velocity of the turned block in x in m/s"),
        ("vy", -1.0, "velocity of the turned block in y in m/s"),
        ("endtim", 0.3, "end time in s"))
    deck.block("When to stop, and the time step.")
    deck.keyword("CONTROL_TERMINATION").card("endtim", "&endtim")
    deck.keyword("CONTROL_TIMESTEP").card("dtinit tssfac", 0.0, 0.4)
    energies_on(deck)
    deck.block("Output.")
    deck.database(glstat=1.0e-3, rcforc=1.0e-3, matsum=1.0e-3, binary_d3plot=1.0e-2)
    deck.block("Two bodies of one-point plane-strain quads (ELFORM 13).")
    part(deck, 1, "large block", 1, 1)
    part(deck, 2, "turned block", 1, 2)
    plane_strain(deck, 1)
    elastic(deck, 1, rho=1000.0, young=1.0e6, poisson=0.3)
    elastic(deck, 2, rho=2000.0, young=2.0e6, poisson=0.3)
    deck.block("The turned block starts with its velocity.")
    deck.keyword("INITIAL_VELOCITY_GENERATION")
    deck.card("id styp omega vx vy vz", 2, 2, 0.0, "&vx", "&vy", 0.0)
    deck.card("xc yc zc nx ny nz", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    contact_surfaces(deck, ("sides and lower face of the turned block",
                            np.concatenate([turned.left, turned.lower[1:], turned.right[1:]])),
                     ("upper face of the large block", large.upper), exchanged, about=(
                         "The two surfaces as node sets in walking order; that of the turned block is its left side, its lower face "
                         "and its right side."))
    return meshes(deck, ("large block: 16 x 6 quads", large), ("turned block: 7 x 5 quads", turned))
