# SPDX-License-Identifier: MIT
"""A blunt rod through a plate of Weldox 460 E: residual velocity beside the curve fitted to published tests."""
import re

import numpy as np

from meshes import Deck, grid_quads

THICK, RADIUS, LENGTH, SPAN = 12.0e-3, 10.0e-3, 80.0e-3, 250.0e-3
MASS = 0.197                                   # kg, of the rod
LIMIT, FACTOR, POWER = 184.5, 0.76, 2.36       # of the published curve
DENSITY, YOUNG, POISSON = 7850.0, 200.0e9, 0.33
HEAT, SHARE = 452.0, 0.9                       # J/(kg K), and how much of the plastic work heats: the law heats by all of it
#: Element in m, whether the rod is rigid, impact velocities in m/s.
RUNS = ((1.0e-3, True, (300.0, 400.0)), (0.75e-3, False, (300.0, 400.0)))
#: By hand, in full: minutes each.
FINER = ((0.5e-3, True, (200.0, 225.0, 250.0, 300.0, 400.0)), (0.5e-3, False, (200.0, 250.0, 300.0, 400.0)))


def published(speed):
    """Recht & Ipson's form with the constants fitted to the tests."""
    return FACTOR * max(speed ** POWER - LIMIT ** POWER, 0.0) ** (1.0 / POWER)


def radial(size, left):
    """Columns of the plate: even where it shears, growing inwards and outwards by a fifth a column."""
    edges, step = [RADIUS - 6 * size], size
    for _ in range(12):
        edges.append(edges[-1] + size)
    while edges[-1] < SPAN:
        step = min(1.2 * step, 12.0e-3)
        edges.append(edges[-1] + step)
    edges[-1] = SPAN
    inner, step = [edges[0]], size
    while inner[-1] > 2.0 * step:
        step *= 1.2
        inner.append(inner[-1] - step)
    edges = np.array([0.0, *inner[:0:-1], *edges]) if inner[-1] > 0.0 else np.array(inner[::-1] + edges[1:])
    return edges if left == 0.0 else np.array([*(-edges[:0:-1]), *edges])


def tensor(x, y):
    return [(a, b) for b in y for a in x], grid_quads(len(x) - 1, len(y) - 1)


def plate_and_rod(speed, size, is_axisymmetric=True, is_rigid=True):
    """`size`: elements of the plate where it shears. The rod: rigid, or of the steel of the tests as a bilinear law."""
    deck = Deck("blunt rod on a plate of Weldox 460 E")
    end = 22.0e-3 / speed
    deck.add("*CONTROL_TERMINATION", (end, 0, 0.01))
    deck.add("*CONTROL_TIMESTEP", (0.0, 0.8, 0, 0.0, 0.0, 0, 1))
    deck.add("*CONTROL_HOURGLASS", (1, 0.05))
    deck.add("*SECTION_SHELL", (1, 15 if is_axisymmetric else 13), (1.0,))
    deck.add("*PART", "plate", (1, 1, 1)).add("*PART", "rod", (2, 1, 2))
    deck.add("*MAT_JOHNSON_COOK", (1, DENSITY, YOUNG / (2.0 * (1.0 + POISSON)), YOUNG, POISSON, 0.0, 1.0),
             (490.0e6, 383.0e6, 0.45, 0.0114, 0.94, 1800.0, 293.0, 5.0e-4),
             (HEAT / SHARE, 0.0, 0.0, 0.0, 0.0705, 1.732, -0.54, -0.015), (0.0,))
    left = 0.0 if is_axisymmetric else -1.0
    rod_density = MASS / (np.pi * RADIUS ** 2 * LENGTH)
    if is_rigid:
        deck.add("*MAT_RIGID", (2, rod_density, 204.0e9, POISSON))
    else:
        deck.add("*MAT_PLASTIC_KINEMATIC", (2, rod_density, 204.0e9, POISSON, 1.9e9, 15.0e9, 1.0), (0.0,))
    x = radial(size, left)
    plate = deck.mesh(*tensor(x, np.linspace(0.0, THICK, round(THICK / size) + 1)), part=1)
    across = np.linspace(left * RADIUS, RADIUS, round((1.0 - left) * RADIUS / (2.0 * size)) + 1)
    rod = deck.mesh(*tensor(across, THICK + np.linspace(0.0, LENGTH, round(LENGTH / (4.0 * size)) + 1)), part=2)
    edge = plate.reshape(-1, len(x))[:, [-1] if is_axisymmetric else [0, -1]].ravel()
    deck.fix(edge, x=1, y=1)
    deck.add("*SET_PART_LIST", (1,), (1, None)).add("*SET_PART_LIST", (2,), (2, None))
    deck.add("*CONTACT_2D_SLIDELINE", (1, 2, 5, 2, 1.0), (0.0, 1.0e20, 2))
    if is_rigid:
        deck.add("*INITIAL_VELOCITY_RIGID_BODY", (2, 0.0, -speed))
    else:
        deck.node_set(8, rod)
        deck.add("*INITIAL_VELOCITY", (8,), (0.0, -speed))
    return deck.output(glstat=end / 100, matsum=end / 100)


def check(run):
    for size, is_rigid, speeds in RUNS + (FINER if run.is_full else ()):
        for speed in speeds:
            name = f"{'rigid' if is_rigid else 'deformable'}, {1e3 * size:g} mm, {speed:g} m/s"
            result = run.program(plate_and_rod(speed, size, True, is_rigid), name=re.sub(r"\W+", "_", name))
            table, rod = result.table("glstat"), result.table("matsum").where(part=2)
            run.check(f"{name}: balance with what has gone", table["total"], table["total"][0])
            run.true(f"{name}: elements have gone", table["eroded"][-1] > 0.0)
            found = -rod["momentum_y"][-1] / rod["mass"][-1]
            if size > 0.6e-3:
                run.check(f"{name}: residual velocity", found, published(speed))
            else:
                run.report(f"{name}: residual velocity", found, f"curve {published(speed):.1f} m/s")
