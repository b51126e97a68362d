# SPDX-License-Identifier: MIT
"""GRECO's plate: a square on a rigid plane, mu 1, pressed from above and pushed from the side. NAFEMS' cylinder: cylinder.py."""
import numpy as np

import cylinder
from contact_types import TYPES
from meshes import Deck, grid_quads

YOUNG, POISSON, RHO, FRICTION = 1.3e11, 0.2, 7800.0, 1.0
SIDE, CELLS = 0.04, 32
ABOVE, ASIDE = 5.0e7, 15.0e7
STIFF_KINDS = (4, 6, 7)
#: N/m per contact node: a strip of SIDE/100 of the plate's own material.
PENALTY = 1.0e2 * YOUNG / CELLS
#: Places on the contact side, m, and u_x there, m: mean of codes as GRECO gives it, and code_aster's own values.
PLACES = np.array([0.0, 1.25, 5.0, 7.5, 11.25]) * 1e-3
CODES = np.array([28.6, 27.2, 22.8, 19.8, 15.0]) * 1e-6
ONE_CODE = np.array([28.459, 27.079, 22.740, 19.727, 15.364]) * 1e-6


def edge_forces(pressure):
    """Nodal forces of an edge."""
    force = np.full(CELLS + 1, pressure * SIDE / CELLS)
    force[[0, -1]] *= 0.5
    return force


def plate(kind, steps=20, stiffer=1.0):
    """(deck, contact nodes from left to right): the plane is a row of quads all of whose nodes are held."""
    deck = Deck(f"GRECO's plate, type {kind}")
    deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0 / steps))
    deck.add("*CONTROL_IMPLICIT_AUTO", (1, 11, 5, 0.0, 1.0 / steps))
    deck.part(1, points=4).elastic(RHO, YOUNG, POISSON, 1)
    x = np.linspace(0.0, SIDE, CELLS + 1)
    ids = np.asarray(deck.mesh(np.array([(a, b) for b in x for a in x]), grid_quads(CELLS, CELLS))).reshape(CELLS + 1, -1)
    below = np.linspace(-0.25 * SIDE, SIDE, CELLS + 4)
    plane = np.asarray(deck.mesh(np.array([(a, b) for b in (-0.05 * SIDE, 0.0) for a in below]), grid_quads(CELLS + 3, 1)))
    deck.node_set(1, ids[0]).node_set(2, plane[len(below):][::-1]).fix(plane, x=1, y=1).fix(ids[:, -1], x=1)
    deck.curve(1, [(0.0, 0.0), (1.0, 1.0)])
    deck.add("*LOAD_NODE_POINT", *[(node, 2, 1, -force) for node, force in zip(ids[-1].tolist(), edge_forces(ABOVE))],
             *[(node, 1, 1, force) for node, force in zip(ids[:, 0].tolist(), edge_forces(ASIDE))])
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, stiffer * PENALTY, FRICTION))
    return deck.output(plot=1.0, glstat=1.0, rcforc=1.0), ids[0]


def check(run):
    stiff = STIFF_KINDS if run.is_full else STIFF_KINDS[-1:]
    for kind, stiffer in [*((kind, 1.0) for kind in TYPES), *((kind, 10.0) for kind in stiff)]:
        deck, row = plate(kind, stiffer=stiffer)
        result = run.program(deck)
        points = result.points("Points")
        moved = np.interp(PLACES, points[0, row - 1, 0], (points[-1] - points[0])[row - 1, 0])
        name = TYPES[kind] + (", stiff springs" if stiffer > 1.0 else "")
        run.check(f"{name}: u_x of the contact side", moved, CODES)
        run.check(f"{name}: u_x of the contact side, one code", moved, ONE_CODE)
        force = result.table("rcforc").where(side="slave")
        run.check(f"{name}: normal force", force["fy"][-1], ABOVE * SIDE)
    cylinder.check(run)
