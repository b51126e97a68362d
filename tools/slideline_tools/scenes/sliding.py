# SPDX-License-Identifier: MIT
"""Sliding contact: a steel die with a crowned face is pressed into a plate and drawn along it."""
import numpy as np

from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import (ALUMINIUM, CONTACT_TYPES, STEEL, elastic, energies_on,
                                           meshes, part, perfectly_plastic, plane_strain, rigid,
                                           contact_surfaces)

CENTRE, CROWN_RADIUS, TOP = 0.010, 0.020, 0.002
PRESS = (0.0, 1.5e-3, -0.15e-3)
DRAW = (1.5e-3, 6.0e-3, 8.0e-3)
CURVE_INTERVALS = 200


def sliding_grids(level):
    """Plate and die of the sliding scene at refinement level N_r."""
    plate = Grid(spaced((0.0, 0.036, 36 * level)), spaced((-0.004, 0.0, 4 * level)))
    half = 9 * level
    die = Grid(spaced((CENTRE - 0.0045, CENTRE, half), (CENTRE, CENTRE + 0.0045, half)),
               spaced((0.0, TOP, 3 * level)), first_node=10001, first_element=10001)
    x, share = die.points[:, :, 0], die.points[:, :, 1] / TOP
    crown = (x - CENTRE) ** 2 / (2.0 * CROWN_RADIUS)
    die.points[:, :, 1] = crown + share * (TOP - crown)
    return plate, die


def stroke(start, end, distance):
    """(time, velocity) points of a smooth stroke, zero before `start` and after `end`.

    The velocity is distance (1 - cos(2 pi (t - t0) / (t1 - t0))) / (t1 - t0). Between
    evenly spaced points it is linear, which keeps the distance exact.
    """
    share = np.arange(CURVE_INTERVALS + 1) / CURVE_INTERVALS
    velocity = distance * (1.0 - np.cos(2.0 * np.pi * share)) / (end - start)
    velocity[[0, -1]] = 0.0
    points = [(start + (end - start) * s, v) for s, v in zip(share, velocity)]
    return ([(0.0, 0.0)] if start > 0.0 else []) + points + [(1.0, 0.0)]


def sliding(level=1, ctype=2, ngauss=6, exchanged=False, rigid_die=False):
    """The sliding scene ("ironing"); `level` = N_r >= 1 (1 to 3 in the paper).

    `exchanged`: the plate is the slave. `rigid_die`: the die is a rigid body, moved as a whole.
    """
    if level < 1 or level > 8:
        raise ValueError("level of the sliding scene: 1 to 8")
    plate, die = sliding_grids(level)
    steps = 150000 * level
    deck = Deck(f"sliding contact N_r = {level}" + (" exchanged" if exchanged else "")
                + (" rigid die" if rigid_die else ""), [
        ("A rigid die" if rigid_die else "A steel die") + " with a crowned lower face is pressed 0.15 mm into an aluminium plate and "
        "drawn 8 mm along it. SI units (m, kg, s, N, Pa), plane strain, per metre of depth.",
        "",
        f"Refinement level N_r = {level}: all cell and step counts times N_r, time step and "
        "penalty divided by it.",
        "",
        "Dimensions and motion not given by the text of Kang, Lee & Shin (2023), so ours: plate 36 mm x 4 mm, die "
        "9 mm wide and 2 mm high with a crown of radius 20 mm, 0.15 mm down in 1.5 ms, "
        "then 8 mm along in 4.5 ms.",
    ])
    deck.block("The numbers to play with.")
    deck.parameters(
        ("ctype", ctype, "contact type: " + CONTACT_TYPES),
        ("ngauss", ngauss, "Gauss points of a slave segment: type 6 only"),
        ("pen", 10.0e9 / level, "penalty of a contact node in N/m: 10 GN/m over N_r"),
        ("dt", 40.0e-9 / level, "time step in s: 40 ns over N_r"),
        ("endtim", 6.0e-3, f"end time in s: {steps} steps"),
        ("ihq", 1, "hourglass control: 1 viscous form, 4 stiffness form"),
        ("qh", 0.1, "hourglass coefficient"),
        ("dtplot", 1.0e-4, "time between the states for pictures in s"),
        ("dthist", 2.0e-5, "time between the rows of the histories in s"),
        ("dtforc", 2.0e-6, "time between the rows of the contact force history in s"))
    deck.block("When to stop, and a constant time step (the curve LCTM caps the step).")
    deck.keyword("CONTROL_TERMINATION").card("endtim", "&endtim")
    deck.constant_step(1, "&dt", 1.0)
    deck.keyword("CONTROL_HOURGLASS").card("ihq qh", "&ihq", "&qh")
    energies_on(deck)
    deck.block("Output: energies, contact force, parts, middle of the die's upper face, states.")
    deck.database(glstat="&dthist", matsum="&dthist", nodout="&dthist", rcforc="&dtforc",
                  binary_d3plot="&dtplot")
    deck.history_nodes([die.node[9 * level, -1]])
    deck.block("Two bodies of one-point plane-strain quads (ELFORM 13).")
    part(deck, 1, "plate", 1, 1)
    part(deck, 2, "die", 1, 2)
    plane_strain(deck, 1)
    deck.comment("aluminium, elastic and perfectly plastic")
    perfectly_plastic(deck, 1, **ALUMINIUM)
    if rigid_die:
        deck.comment("rigid, as heavy as steel; CON2 = 7 holds its turn")
        rigid(deck, 2, **STEEL)
    else:
        deck.comment("steel, elastic")
        elastic(deck, 2, **STEEL)
    deck.block("The lower face of the plate is fixed (u = 0).")
    deck.node_set(1, "lower face of the plate", plate.lower).spc_set(1, True, True)
    write_motion(deck, die, rigid_die)
    contact_surfaces(deck, ("lower face of the die", die.lower),
                     ("upper face of the plate", plate.upper), exchanged, True)
    return meshes(deck, (f"plate: {36 * level} x {4 * level} quads", plate), (f"die: {18 * level} x {3 * level} quads", die))


def write_motion(deck, die, rigid_die=False):
    """The velocity of the die's upper face, or of the rigid die, in x and y."""
    what = "die" if rigid_die else "upper face of the die"
    deck.block(f"The {what} moves down, then along, each with a velocity "
               "d (1 - cos(2 pi (t - t0) / (t1 - t0))) / (t1 - t0).")
    if not rigid_die:
        deck.node_set(2, "upper face of the die", die.upper)
    option, number = ("RIGID", "pid") if rigid_die else ("SET", "nsid")
    for direction, curve in ((2, 2), (1, 3)):
        deck.keyword(f"BOUNDARY_PRESCRIBED_MOTION_{option}")
        deck.table(f"{number} dof vad lcid sf", [10] * 5, [(2, direction, 0, curve, 1.0)])
    deck.curve(2, "velocity of the die in y", stroke(*PRESS))
    deck.curve(3, "velocity of the die in x", stroke(*DRAW))
