# SPDX-License-Identifier: MIT
"""Hertz line contact: an elastic steel cylinder is pressed on an elastic aluminium block."""
import numpy as np

from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import (ALUMINIUM, CONTACT_TYPES, STEEL, elastic, energies_on,
                                           implicit_static, meshes, part, plane_strain, contact_surfaces)
from slideline_tools.scenes.sliding import stroke

RADIUS = 0.020
CYLINDER_CELL, BLOCK_CELL = 0.12e-3, 0.144e-3
FINE_CELLS, FINE_ROWS, GRADED_CELLS = 6, 4, 10
CYLINDER_HALF_WIDTH = 0.6 * RADIUS
BLOCK_HALF_WIDTH = BLOCK_HEIGHT = RADIUS
PENALTY = 300.0e9
APPROACH, RISE, END = 30.0e-6, 20.0e-6, 50.0e-6
STATIC_STEPS = 4


def graded(start, end, cell, cells, level):
    """Lines from `start` to `end` whose spacing grows by one factor; `cell` comes before `start`.

    `cells` at level 1; each level divides the cells of level 1 into as many.
    """
    low, high = 1.0 + 1e-9, 4.0
    length = end - start
    for _ in range(80):
        ratio = 0.5 * (low + high)
        reached = cell * ratio * (ratio ** cells - 1.0) / (ratio - 1.0)
        low, high = (ratio, high) if reached < length else (low, ratio)
    step = ratio ** (np.arange(cells * level + 1) / level)
    return start + length * (step - 1.0) / (step[-1] - 1.0)


def columns(cell, half_width, level):
    """Grid lines in x: even with `cell` near the contact, growing to both sides; zero is one."""
    fine = FINE_CELLS * cell
    side = np.concatenate([spaced((0.0, fine, FINE_CELLS * level)),
                           graded(fine, half_width, cell, GRADED_CELLS, level)[1:]])
    return np.concatenate([-side[:0:-1], side])


def rows(cell, height, level):
    """Distances from the surface: even near it, growing away from it."""
    fine = FINE_ROWS * cell
    return np.concatenate([spaced((0.0, fine, FINE_ROWS * level)),
                           graded(fine, height, cell, GRADED_CELLS, level)[1:]])


def hertz_grids(level):
    """Block and cylinder at refinement level N_r, and their contact surfaces as node numbers.

    The surfaces are the evenly divided parts of the two faces, in walking order.
    """
    n = level
    block = Grid(columns(BLOCK_CELL, BLOCK_HALF_WIDTH, n),
                 -rows(BLOCK_CELL, BLOCK_HEIGHT, n)[::-1])
    cylinder = Grid(columns(CYLINDER_CELL, CYLINDER_HALF_WIDTH, n), rows(CYLINDER_CELL, RADIUS, n),
                    first_node=100001, first_element=100001)
    x, share = cylinder.points[:, :, 0], cylinder.points[:, :, 1] / RADIUS
    arc = x ** 2 / (RADIUS + np.sqrt(RADIUS ** 2 - x ** 2))
    cylinder.points[:, :, 1] = arc + share * (RADIUS - arc)
    outside = GRADED_CELLS * n
    return block, cylinder, cylinder.lower[outside:-outside], block.upper[outside:-outside]


def hertz(level=1, ctype=2, ngauss=4, exchanged=False, static=False):
    """The Hertz scene; `level` = N_r >= 1 divides every cell.

    `exchanged`: the block is the slave, not the cylinder; `static`: static steps of the implicit
    method with fully integrated quads, instead of damping to rest.
    """
    if level < 1 or level > 8:
        raise ValueError("level of the hertz scene: 1 to 8")
    block, cylinder, round_face, flat_face = hertz_grids(level)
    deck = Deck(f"Hertz line contact N_r = {level}" + (" static" if static else "")
                + (" exchanged" if exchanged else ""), [
        "The lower part of a steel cylinder of radius 20 mm (cut at mid-height and at 0.6 R to "
        "both sides) is pressed upon an aluminium block; both are elastic. "
        + ("The cut moves down in static steps. SI units " if static else
           "The cut moves down smoothly, then mass damping brings the bodies to rest. SI units ")
        + "(m, kg, s, N, Pa), plane strain, per metre of depth.",
        "",
        f"Refinement level N_r = {level}: the cells of level 1 are divided into N_r x N_r.",
        "",
        "Hertz (1881) for the contact force F, with 1/E* = sum (1 - nu^2)/E: half width "
        "a = sqrt(4 F R/(pi E*)), largest pressure p0 = 2 F/(pi a).",
    ])
    write_run(deck, level, ctype, ngauss, static)
    deck.block(f"Two elastic bodies of {'fully integrated' if static else 'one-point'} plane-strain "
               "quads (ELFORM 13).")
    part(deck, 1, "block", 1, 1)
    part(deck, 2, "cylinder", 1, 2)
    plane_strain(deck, 1, 4 if static else 1)
    deck.comment("aluminium, then steel")
    elastic(deck, 1, *(ALUMINIUM[key] for key in ("rho", "young", "poisson")))
    elastic(deck, 2, **STEEL)
    write_support_and_motion(deck, block, cylinder, static)
    contact_surfaces(deck, ("lower face of the cylinder", round_face),
                     ("upper face of the block", flat_face), exchanged, True,
                     "The two surfaces, their evenly divided parts, as node sets in walking order: the body lies on the left hand.")
    return meshes(deck, ("block", block), ("cylinder", cylinder))


def write_run(deck, level, ctype, ngauss, static):
    """The numbers that can be set from the command line; end, steps and output. In static runs the time counts the way."""
    numbers = [("ctype", ctype, "contact type: " + CONTACT_TYPES),
               ("ngauss", ngauss, "Gauss points of a slave segment, for type 6 alone"),
               ("pen", PENALTY, "penalty of a contact node in N/m"),
               ("down", APPROACH, "way of the cylinder's cut in m")]
    deck.block("The numbers to play with.")
    if static:
        deck.parameters(*numbers, ("step", 1.0 / STATIC_STEPS, "part of the way in a step"))
        deck.block("Static steps; at time 1 the cut has gone all the way.")
        deck.keyword("CONTROL_TERMINATION").card("endtim", 1.0)
        implicit_static(deck, "&step")
    else:
        deck.parameters(
            *numbers,
            ("damp", 7.0e5, "mass damping in 1/s"),
            ("dt", 6.25e-9 / level, "time step in s"),
            ("endtim", END, "end time in s"),
            ("ihq", 4, "hourglass control: 1 viscous form, 4 stiffness form"),
            ("qh", 0.05, "hourglass coefficient"),
            ("dtplot", 10.0e-6, "time between the states for pictures in s"),
            ("dthist", 1.0e-6, "time between the rows of the histories in s"))
        deck.block("When to stop, and a constant time step (the curve LCTM caps the step).")
        deck.keyword("CONTROL_TERMINATION").card("endtim", "&endtim")
        deck.constant_step(1, "&dt", 1.0)
        deck.keyword("CONTROL_HOURGLASS").card("ihq qh", "&ihq", "&qh")
        deck.comment("about critical for the lowest mode: the cylinder on the contact")
        deck.keyword("DAMPING_GLOBAL").card("lcid valdmp", 0, "&damp")
    energies_on(deck)
    deck.block("Output: energies, contact force, states.")
    often, states = ("&step", 1.0) if static else ("&dthist", "&dtplot")
    deck.database(glstat=often, rcforc=often, binary_d3plot=states)


def write_support_and_motion(deck, block, cylinder, static):
    """Rollers below and on the axis of symmetry; the cut of the cylinder moves down."""
    deck.block("The block rests on rollers (u_y = 0); the axis stays straight (u_x = 0).")
    deck.node_set(1, "lower face of the block", block.lower).spc_set(1, False, True)
    middle = [grid.node[grid.node.shape[0] // 2] for grid in (block, cylinder)]
    deck.node_set(2, "axis of symmetry", np.concatenate(middle)).spc_set(2, True, False)
    deck.block("The cut of the cylinder moves down." if static else
               "The cut of the cylinder moves down and stays there; velocity "
               "d (1 - cos(2 pi t/t1))/t1.")
    deck.node_set(5, "cut of the cylinder", cylinder.upper)
    deck.keyword("BOUNDARY_PRESCRIBED_MOTION_SET")
    deck.card("nsid dof vad lcid sf", 5, 2, 2 if static else 0, 2, "&down")
    if static:
        deck.curve(2, "displacement of the cut for a way of 1 m", [(0.0, 0.0), (1.0, -1.0)])
        return
    deck.curve(2, "velocity of the cut for a way of 1 m", stroke(0.0, RISE, -1.0))
