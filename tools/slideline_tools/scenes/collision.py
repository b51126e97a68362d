# SPDX-License-Identifier: MIT
"""Collision: a steel projectile hits a clamped aluminium plate."""
import numpy as np

from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import (ALUMINIUM, CONTACT_TYPES, STEEL, elastic, energies_on,
                                           meshes, part, perfectly_plastic, plane_strain, contact_surfaces)


def collision_grids(level):
    """Plate and projectile of the collision scene at refinement level N_r."""
    n = level
    rows = 4 * n
    plate = Grid(spaced((0.0, 0.025, 20 * n), (0.025, 0.065, 16 * n)),
                 spaced((-0.005, 0.0, rows)))
    beyond = 10001 if level <= 8 else 1000001
    projectile = Grid(spaced((0.0, 0.020, 24 * n)), spaced((0.0005, 0.0055, rows)),
                      first_node=beyond, first_element=beyond)
    return plate, projectile


def collision(level=1, ctype=2, ngauss=4, exchanged=False):
    """A steel projectile hits an aluminium plate; half model.

    `level` = N_r >= 1 (1 to 4 in the paper): cells and steps times N_r, step and penalty over N_r.
    `exchanged`: the plate is the slave.
    """
    if level < 1 or level > 64:
        raise ValueError("level of the collision scene: 1 to 64")
    plate, projectile = collision_grids(level)
    steps = 10000 * level
    step = 100.0e-9 / level
    deck = Deck(f"collision of a projectile with a plate N_r = {level}"
                + (" exchanged" if exchanged else ""), [
        "A steel block 40 mm wide and 5 mm high hits the middle of a clamped aluminium "
        "plate at 80 m/s. Half model: x = 0 is the plane of symmetry. SI units (m, kg, "
        "s, N, Pa), plane strain, per metre of depth.",
        "",
        f"Refinement level N_r = {level}: all cell and step counts times N_r, time step and "
        "penalty divided by it.",
        "",
        "Dimensions not given by the text of Kang, Lee & Shin (2023), so ours: plate 65 mm x 5 mm in the half "
        "model, projectile 20 mm x 5 mm in the half model, first gap 0.5 mm, 80 m/s.",
        "",
        "Parameters can be set from the command line, for example",
        "  slideline i=collision.k p:ctype=3 p:v0=-60",
    ])
    deck.block("The numbers to play with.")
    deck.parameters(
        ("ctype", ctype, "contact type: " + CONTACT_TYPES),
        ("ngauss", ngauss, "Gauss points of a slave segment: type 6 only"),
        ("pen", 1.0e9 / level, "penalty of a contact node in N/m: 1 GN/m over N_r"),
        ("v0", -80.0, "velocity of the projectile in y in m/s"),
        ("dt", step, "time step in s: 100 ns over N_r"),
        ("endtim", 1.0e-3, f"end time in s: {steps} steps"),
        ("ihq", 1, "hourglass control: 1 viscous form, 4 stiffness form"),
        ("qh", 0.1, "hourglass coefficient"),
        ("dtplot", 1.0e-5, "time between the states for pictures in s"),
        ("dthist", 5.0e-6, "time between the rows of the histories in s"),
        ("dtforc", 1.0e-6, "time between the rows of the contact force history in s"))
    deck.block("When to stop, and a constant time step: the curve LCTM caps the step and lies "
               "below the stable step of the mesh (about 0.14 microseconds over N_r).")
    deck.keyword("CONTROL_TERMINATION").card("endtim", "&endtim")
    deck.constant_step(1, "&dt", 1.0)
    deck.block("One-point elements need hourglass control; every energy is in the balance.")
    deck.keyword("CONTROL_HOURGLASS").card("ihq qh", "&ihq", "&qh")
    energies_on(deck)
    deck.block("Output: energies, contact force, parts, four nodes, and states for pictures.",
               "The four nodes lie on the plane of symmetry: lower and upper face of the "
               "projectile, upper and lower face of the plate.")
    deck.database(glstat="&dthist", matsum="&dthist", nodout="&dthist", rcforc="&dtforc",
                  binary_d3plot="&dtplot")
    deck.history_nodes([projectile.node[0, 0], projectile.node[0, -1],
                        plate.node[0, -1], plate.node[0, 0]])
    deck.block("Two bodies of one-point plane-strain quads (ELFORM 13).")
    part(deck, 1, "plate", 1, 1)
    part(deck, 2, "projectile", 1, 2)
    plane_strain(deck, 1)
    deck.comment("aluminium, elastic and perfectly plastic")
    perfectly_plastic(deck, 1, **ALUMINIUM)
    deck.comment("steel, elastic")
    elastic(deck, 2, **STEEL)
    deck.block("The projectile starts with its velocity.")
    deck.keyword("INITIAL_VELOCITY_GENERATION")
    deck.card("id styp omega vx vy vz", 2, 2, 0.0, 0.0, "&v0", 0.0)
    deck.card("xc yc zc nx ny nz", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    deck.block("Symmetry at x = 0 (u_x = 0); the plate is clamped at x = 65 mm (u = 0).")
    deck.node_set(1, "symmetry plane", np.concatenate([plate.left, projectile.left])).spc_set(1, True, False)
    deck.node_set(2, "clamped end of the plate", plate.right).spc_set(2, True, True)
    contact_surfaces(deck, ("lower face of the projectile", projectile.lower),
                     ("upper face of the plate (0 to 25 mm)", plate.upper[-(20 * level + 1):]),
                     exchanged, True)
    return meshes(deck, (f"plate: {36 * level} x {4 * level} quads", plate),
                  (f"projectile: {24 * level} x {4 * level} quads", projectile))
