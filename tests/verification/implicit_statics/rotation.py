# SPDX-License-Identifier: MIT
"""Large rotations in statics: pressed blocks turned once round, and the elastica."""
import numpy as np

from contact_types import TYPES
from meshes import Deck, grid, rotate

RHO, YOUNG = 1000.0, 1.0e6
TURNS = 12                       # steps of 30 degrees
LENGTH, DEPTH, FACTOR = 10.0, 0.25, 10.0


def pressed_blocks(kind):
    """Two blocks pressed in the first step by their outer edges, which then turn rigidly in steps of 30 degrees."""
    centre = np.array([3.0, 2.0])
    deck = Deck(f"turned blocks, type {kind}")
    deck.add("*CONTROL_TERMINATION", (1.0 + TURNS,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
    for part in (1, 2):
        deck.part(part, points=4).elastic(RHO, YOUNG, 0.3, part)
    low, quads_low = grid(4, 2, 1.0, 1.0, (0.0, -1.0))
    up, quads_up = grid(3, 2, 0.8, 1.0, (0.1, 0.0))
    low_ids, up_ids = deck.mesh(low, quads_low, 1), deck.mesh(up, quads_up, 2)
    number = 0
    for ids, places, squeeze in ((low_ids[:5], low[:5], 0.0), (up_ids[-4:], up[-4:], -0.02)):
        for node, place in zip(ids, places):
            way = [place, *(rotate(place + [0.0, squeeze], 2.0 * np.pi * k / TURNS, centre)
                            for k in range(TURNS + 1))]
            for dof in (0, 1):
                number += 1
                deck.curve(number, [(float(k), point[dof] - place[dof]) for k, point in enumerate(way)])
                deck.prescribe(node, dof + 1, 2, number)
    deck.node_set(1, up_ids[:4]).node_set(2, low_ids[-5:][::-1]).contact(1, 2, kind, 10.0 * YOUNG, 1)
    return deck.output(plot=1.0, rcforc=1.0, glstat=1.0)


def check_turned(run, kind):
    """Everything must turn with the edges."""
    name = TYPES[kind]
    result = run.program(pressed_blocks(kind))
    angle = 2.0 * np.pi * np.arange(TURNS + 1) / TURNS
    stress = result.cells("stress")[1:, :, :4]
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    xx, yy, zz, xy = np.moveaxis(stress[0], -1, 0)
    expected = np.stack([c * c * xx + s * s * yy - 2.0 * c * s * xy,
                         s * s * xx + c * c * yy + 2.0 * c * s * xy,
                         zz + 0.0 * c, c * s * (xx - yy) + (c * c - s * s) * xy], axis=-1)
    run.check(f"{name}: stress in steps of 30 degrees", stress, expected)
    force = result.table("rcforc").where(side="slave")
    force = np.stack([force["fx"], force["fy"]], axis=1)[1:]
    run.check(f"{name}: contact force in steps of 30 degrees", force, np.stack([rotate(force[0], a) for a in angle]))
    run.check(f"{name}: contact force at the start", np.hypot(*force[0]), 0.5 * 0.01 * YOUNG * 0.8)
    pressure, energy = result.points("contact_pressure")[1:], result.table("glstat")["internal"][1:]
    run.check(f"{name}: contact pressure", pressure, np.broadcast_to(pressure[0], pressure.shape))
    run.check(f"{name}: internal energy", energy, energy[0])


def cantilever(n_x, steps):
    """Clamped at the left (free to widen), a dead transverse force at the right."""
    deck = Deck("elastica")
    deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0 / steps))
    deck.part(points=4).elastic(RHO, YOUNG, 0.0)
    nodes = deck.mesh(*grid(n_x, 2, LENGTH, DEPTH, (0.0, -0.5 * DEPTH)))
    deck.fix(nodes[::n_x + 1], x=1).fix([nodes[n_x + 1]], y=1)
    deck.curve(1, [(0.0, 0.0), (1.0, FACTOR * YOUNG * DEPTH ** 3 / 12.0 / LENGTH ** 2)])
    tip = nodes[n_x::n_x + 1]
    deck.add("*LOAD_NODE_POINT", *[(int(node), 2, 1, share) for node, share in zip(tip, (0.25, 0.5, 0.25))])
    return deck.output(nodout=1.0 / steps, glstat=1.0 / steps, nodes=[int(tip[1])])


def elastica(stiffer):
    """Tip of Reissner's beam (1972) under a dead force F = FACTOR EI/L^2, by shooting; unit length.

    theta' = m, m' = -k r_x', r' = (1 + e)(cos, sin) + g (-sin, cos); e = F sin(theta)/EA, g = F cos(theta)/GA_s,
    k = FACTOR/stiffer. `stiffer` is the bending stiffness of the mesh over EI.
    """
    ratio = DEPTH ** 2 / 12.0 / LENGTH ** 2              # I/(A L^2)
    stretch, slide = FACTOR * ratio, FACTOR * ratio * 2.0 * 1.2

    def rate(state):
        c, s = np.cos(state[0]), np.sin(state[0])
        along, across = 1.0 + stretch * s, slide * c
        x, y = along * c - across * s, along * s + across * c
        return np.array([state[1], -FACTOR / stiffer * x, x, y])

    def shoot(moment, count):
        state, h = np.array([0.0, moment, 0.0, 0.0]), 1.0 / count
        for _ in range(count):
            a = rate(state)
            b = rate(state + 0.5 * h * a)
            c = rate(state + 0.5 * h * b)
            state = state + h / 6.0 * (a + 2.0 * b + 2.0 * c + rate(state + h * c))
        return state

    low, high = 0.0, FACTOR
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if shoot(middle, 200)[1] > 0.0 else (middle, high)
    return shoot(low, 200)[2:]


def check_elastica(run):
    """Deflection of 0.8 of the length, tip turned by more than 70 degrees."""
    ends = []
    for n_x in (80, 160):
        result = run.program(cantilever(n_x, 20))
        moved = result.table("nodout")
        found = np.array([1.0 + moved["ux"][-1] / LENGTH, moved["uy"][-1] / LENGTH])
        # Inside an element of length a, bending has the shear energy G a^2/12 (nu = 0: G = E/2).
        expected = elastica(1.0 + 0.5 * (LENGTH / n_x / DEPTH) ** 2)
        name = f"elastica, {n_x} x 2 quads"
        run.check(f"{name}: tip", found, expected)
        run.check(f"{name}: energy ratio at the end", result.table("glstat")["energy_ratio"][-1], 1.0)
        ends.append(found)
    run.check("elastica, extrapolated mesh: tip", (4.0 * ends[1] - ends[0]) / 3.0, elastica(1.0))
    few = run.program(cantilever(80, 1)).table("nodout")
    run.report("elastica, whole load in one step: tip against 20 steps",
               np.hypot(1.0 + few["ux"][-1] / LENGTH - ends[0][0], few["uy"][-1] / LENGTH - ends[0][1]))


def check(run):
    for kind in TYPES:
        check_turned(run, kind)
    check_elastica(run)
