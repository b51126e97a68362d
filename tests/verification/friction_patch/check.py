# SPDX-License-Identifier: MIT
"""Patch test in full slip: unlike bodies under p and mu p, one dragged over the other; static ones (static.py)."""
import numpy as np

import static
from contact_types import PASS_PATCH, TYPES
from meshes import Deck
from patch_layouts import block_forces
from static_patch import Blocks

RHO, POISSON, FRICTION = 1000.0, 0.3, 0.3
#: Young's modulus of the upper and the lower block, Pa; loads are small against it, since strains change the faces.
YOUNG = (1.0e6, 3.0e6)
PRESSURE = 1.0e-3
#: Penalty, N/m per node, and the way of the drag, m: many times the springs' mu p/eps_T, little of a segment.
PENALTY, WAY = 1.0e6, 4.0e-9
MESHES = {"5 on 4": (np.linspace(0, 1, 6), np.linspace(0, 1, 5)),
          "7 on 5, graded": (np.array([0.0, 0.11, 0.26, 0.4, 0.58, 0.7, 0.87, 1.0]),
                             np.array([0.0, 0.23, 0.4, 0.62, 0.83, 1.0]))}
#: Times, s: loads rise, the drag slows down, the end. The slowest mode of the blocks has about 6 rad/s.
RISE, SLOWS, END = 2.0, 0.8, 20.0


def patch(kind, mesh, share, exchanged=False, damping=0.0):
    """Pressure on top and bottom and a shear of mu p on all outer faces; the middle node of the top is dragged along and
    then kept where it is. Each block hangs on one node against u_x, the lower one on rollers."""
    blocks = Blocks(*MESHES[mesh], 1.0)
    deck = Deck(f"patch test in full slip, type {kind}").control(END, scale=0.6).hourglass(4, 0.1)
    ids = blocks.put(deck, RHO, *((young, POISSON) for young in YOUNG))
    deck.fix(ids[blocks.bottom], y=1).fix([ids[blocks.bottom[len(blocks.bottom) // 2]]], x=1)
    ramp = np.linspace(0.0, 1.0, 41)
    deck.curve(1, [*zip(RISE * ramp, ramp - np.sin(2.0 * np.pi * ramp) / (2.0 * np.pi)), (2.0 * END, 1.0)])
    # It slows down for ever, so that no place ever slides back.
    since = np.linspace(0.0, END - RISE, 801)
    deck.curve(2, [(0.0, 0.0), *zip(RISE + since, WAY * (1.0 - (1.0 + since / SLOWS) * np.exp(-since / SLOWS)))])
    stress = PRESSURE * np.array([[0.0, FRICTION], [FRICTION, -1.0]])
    force = np.vstack([block_forces(blocks.upper, len(blocks.slave), stress, (1, 2, 3)),
                       block_forces(blocks.lower, len(blocks.master), stress, (0, 1, 3))])
    force[blocks.bottom, 1] = 0.0
    deck.add("*LOAD_NODE_POINT", *[(node, dof + 1, 1, row[dof]) for node, row in zip(ids.tolist(), force) for dof in (0, 1)
                                   if row[dof]])
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_NODE", (int(ids[blocks.top[len(blocks.top) // 2]]), 1, 2, 2, 1.0))
    deck.add("*DAMPING_GLOBAL", (0, 12.0))
    sides = (-2, -1) if exchanged else (-1, -2)
    deck.add("*CONTACT_2D_SLIDELINE", (*sides, kind, 4, PENALTY, FRICTION), (0.0, 1.0e20, 0, 0.0, damping), (0.0, share))
    return deck.output(plot=END, glstat=END / 20), ids, blocks


def check_patch(run, kind, mesh, share, exchanged=False, damping=0.0):
    name = f"{mesh}, eps_T {share:g} eps_N{', exchanged' if exchanged else ''}{', VDC' if damping else ''}: {TYPES[kind]}"
    deck, ids, blocks = patch(kind, mesh, share, exchanged, damping)
    result = run.program(deck)
    energies = result.table("glstat")
    run.check(f"{name}: kinetic / internal energy at the end", energies["kinetic"][-1] / energies["internal"][-1], 0.0)
    force = result.points("contact_force")[-1]
    for side, sign, nodes, length in (("upper", 1.0, blocks.slave, blocks.lengths(0)), ("lower", -1.0, blocks.master, blocks.lengths(1))):
        pressure, traction = sign * force[nodes, 1] / length / PRESSURE, -sign * force[nodes, 0] / length / PRESSURE
        # Pressures that differ bend the faces: up and along are normal and tangent to some p/E = 1e-9.
        run.check(f"{name}: traction is mu p, {side} side", traction, FRICTION * pressure,
                  scale=1.0 if kind in PASS_PATCH else 500.0)
        if kind in PASS_PATCH:
            run.check(f"{name}: pressure, {side} side", pressure, 1.0)
        else:
            run.report(f"{name}: pressure, {side} side, largest error", np.max(np.abs(pressure - 1.0)))


def check(run):
    for kind in TYPES:
        for mesh in MESHES:
            check_patch(run, kind, mesh, 0.1)
    for kind in sorted(PASS_PATCH):
        check_patch(run, kind, "5 on 4", 1.0)
        check_patch(run, kind, "7 on 5, graded", 0.1, exchanged=True)
        check_patch(run, kind, "5 on 4", 0.1, damping=20.0)
    static.check(run)
