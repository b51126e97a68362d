# SPDX-License-Identifier: MIT
"""Symmetric plate: the solid element without contact, under a step load."""
import numpy as np

from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import (elastic, energies_on, part, perfectly_plastic,
                                           plane_strain)


def symmetric_plate_grid(n_x, n_y):
    """Half plate of 8 m x 1 m."""
    return Grid(spaced((0.0, 8.0, n_x)), spaced((0.0, 1.0, n_y)))


def symmetric_plate(n_x=8, n_y=4, elastoplastic=False):
    """A plate on two pins under a sudden upward load (after Flanagan and Belytschko 1981).

    `n_x` must be a multiple of 8 and `n_y` even, so that x = 7 m is a grid line and there is a
    node at mid-height.
    """
    if n_x < 8 or n_x % 8 or n_y < 2 or n_y % 2:
        raise ValueError("symmetric_plate: nx must be a multiple of 8 and ny even")
    grid = symmetric_plate_grid(n_x, n_y)
    law = "elastic-plastic" if elastoplastic else "elastic"
    deck = Deck(f"symmetric plate {n_x} x {n_y} {law}", [
        "A plate rests on two pins and is loaded at time zero by a constant upward load "
        "of 80 kN/m on its whole upper edge (after Flanagan and Belytschko 1981). It tests "
        "the solid element without contact. Half model: x = 0 is the plane of symmetry. "
        "SI units (m, kg, s, N, Pa), plane strain, per metre of depth.",
        "",
        "Dimensions and load not given by the text of Kang, Lee & Shin (2023), so ours: half "
        "plate 8 m x 1 m, load 80 kN/m" + ("; the end x > 7 m stays elastic, since a plastic pin punches through."
                          if elastoplastic else "."),
        "",
        "Result: deflection in y of the mid-span node (x = 0, mid-height) for 0.6 s.",
        "The pin excites hourglass modes, which the viscous form does not hold on coarse meshes:",
        "  slideline i=DECK p:ihq=1 p:qh=0.1      viscous form",
        "  slideline i=DECK p:ihq=4 p:qh=0.05     stiffness form",
    ])
    deck.block("The numbers to play with.")
    deck.parameters(
        ("load", 80.0e3, "load on the upper edge in N/m, upward"),
        ("ihq", 4, "hourglass control: 1 viscous form, 4 stiffness form"),
        ("qh", 0.05, "hourglass coefficient"),
        ("endtim", 0.6, "end time in s"),
        ("dthist", 1.0e-3, "time between the rows of the histories in s"),
        ("dtplot", 2.0e-2, "time between the states for pictures in s"))
    deck.block("The program chooses the time step: 0.9 of the stable step of the smallest element.")
    deck.keyword("CONTROL_TERMINATION").card("endtim", "&endtim")
    deck.keyword("CONTROL_TIMESTEP").card("dtinit tssfac", 0.0, 0.9)
    deck.keyword("CONTROL_HOURGLASS").card("ihq qh", "&ihq", "&qh")
    energies_on(deck)
    deck.block("Output: energies, parts, the mid-span node and the mid-span upper node, states.")
    deck.database(glstat="&dthist", nodout="&dthist", matsum="&dthist", binary_d3plot="&dtplot")
    deck.history_nodes([grid.node[0, n_y // 2], grid.node[0, -1]])
    material = dict(rho=1000.0, young=1.0e9, poisson=0.3)
    of_element = np.ones(grid.element.shape, dtype=int)
    deck.block("One-point plane-strain quads (ELFORM 13).")
    if elastoplastic:
        of_element[7 * n_x // 8:, :] = 2
        part(deck, 1, "plate from the middle to x = 7 m", 1, 1)
        part(deck, 2, "elastic end of the plate", 1, 2)
        plane_strain(deck, 1)
        deck.comment("elastic and perfectly plastic")
        perfectly_plastic(deck, 1, yield_stress=10.0e6, **material)
        elastic(deck, 2, **material)
    else:
        part(deck, 1, "plate", 1, 1)
        plane_strain(deck, 1)
        elastic(deck, 1, **material)
    deck.block("Symmetry at x = 0 (u_x = 0); the mid-height node at x = 8 m is pinned (u = 0).")
    deck.node_set(1, "symmetry plane", grid.left).spc_set(1, True, False)
    deck.keyword("BOUNDARY_SPC_NODE").card("nid cid dofx dofy", grid.node[-1, n_y // 2], 0, 1, 1)
    _plate_load(deck, grid, 8.0 / n_x)
    deck.block(f"Mesh: {n_x} x {n_y} quads.")
    grid.write(deck, of_element)
    return deck.text()


def _plate_load(deck, grid, length):
    deck.block("The step load: the curve is the load in N/m, the factor SF the length of edge that "
               "belongs to a node in m (half a segment at the two ends).")
    deck.curve(1, "load", [(0.0, "&load"), (10.0, "&load")])
    deck.node_set(2, "upper edge without its ends", grid.upper[1:-1])
    deck.keyword("LOAD_NODE_SET").card("nsid dof lcid sf cid", 2, 2, 1, length, 0)
    deck.keyword("LOAD_NODE_POINT")
    deck.table("nid dof lcid sf cid", [10] * 5,
               [(grid.upper[0], 2, 1, 0.5 * length, 0), (grid.upper[-1], 2, 1, 0.5 * length, 0)])
