# SPDX-License-Identifier: MIT
"""Patch test in full slip: unlike bodies under p and mu p, one dragged over the other."""
import numpy as np

from contact_types import PASS_PATCH, TYPES
from meshes import Deck
from static_patch import Blocks, hat_areas

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


def edges(nodes, columns):
    """Left, right, lower and upper nodes of a block."""
    grid = np.asarray(nodes).reshape(-1, columns)
    return grid[:, 0], grid[:, -1], grid[0], grid[-1]


def patch(kind, mesh, share, exchanged=False, damping=0.0):
    """Pressure on top and bottom and a shear of mu p on all outer faces; the middle node of the top is dragged along and
    then kept where it is. Each block hangs on one node against u_x, the lower one on rollers."""
    blocks = Blocks(*MESHES[mesh], 1.0)
    deck = Deck(f"patch test in full slip, type {kind}").control(END, scale=0.6).hourglass(4, 0.1)
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG[part - 1], POISSON, part)
    upper = deck.mesh(blocks.upper, blocks.upper_quads, part=1)
    lower = deck.mesh(blocks.lower, blocks.lower_quads, part=2)
    ids = np.concatenate([upper, lower])
    deck.node_set(1, ids[blocks.slave]).node_set(2, ids[blocks.master][::-1])
    deck.fix(ids[blocks.bottom], y=1).fix([ids[blocks.bottom[len(blocks.bottom) // 2]]], x=1)
    ramp = np.linspace(0.0, 1.0, 41)
    deck.curve(1, [*zip(RISE * ramp, ramp - np.sin(2.0 * np.pi * ramp) / (2.0 * np.pi)), (2.0 * END, 1.0)])
    # It slows down for ever, so that no place ever slides back.
    since = np.linspace(0.0, END - RISE, 801)
    deck.curve(2, [(0.0, 0.0), *zip(RISE + since, WAY * (1.0 - (1.0 + since / SLOWS) * np.exp(-since / SLOWS)))])
    forces = {}
    for nodes, lines, columns in ((upper, blocks.lines[0], len(blocks.lines[0])), (lower, blocks.lines[1], len(blocks.lines[1]))):
        left, right, foot, head = edges(nodes, columns)
        rows = hat_areas(np.linspace(0.0, 1.0, len(left)))
        for side, dof, factor, weights in ((left, 2, -FRICTION, rows), (right, 2, FRICTION, rows)):
            for node, weight in zip(side, weights):
                forces[int(node), dof] = forces.get((int(node), dof), 0.0) + factor * weight * PRESSURE
        outer, sign = (head, 1.0) if nodes is upper else (foot, -1.0)
        for node, weight in zip(outer, hat_areas(lines)):
            forces[int(node), 1] = sign * FRICTION * weight * PRESSURE
            if nodes is upper:
                forces[int(node), 2] = forces.get((int(node), 2), 0.0) - weight * PRESSURE
    deck.add("*LOAD_NODE_POINT", *[(node, dof, 1, f) for (node, dof), f in forces.items()])
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
    run.check(f"{name}: kinetic / internal energy at the end", energies["kinetic"][-1] / energies["internal"][-1], 0.0, 1e-12,
              "max", "at rest")
    force = result.points("contact_force")[-1]
    for side, sign, nodes, length in (("upper", 1.0, blocks.slave, blocks.lengths(0)), ("lower", -1.0, blocks.master, blocks.lengths(1))):
        pressure, traction = sign * force[nodes, 1] / length / PRESSURE, -sign * force[nodes, 0] / length / PRESSURE
        # Pressures that differ bend the faces: up and along are normal and tangent to some p/E = 1e-9.
        run.check(f"{name}: traction is mu p, {side} side", traction, FRICTION * pressure, 1e-11 if kind in PASS_PATCH else
                  5.0 * PRESSURE / min(YOUNG), source="full slip")
        if kind in PASS_PATCH:
            run.check(f"{name}: pressure, {side} side", pressure, 1.0, 1e-7, source="uniform")
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
