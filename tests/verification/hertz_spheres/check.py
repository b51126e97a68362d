# SPDX-License-Identifier: MIT
"""Two spheres pressed on each other: Hertz, all contact types."""
import numpy as np

import spheres
from contact_types import PASS_PATCH, TYPES
from meshes import Deck, grid_quads
from slideline_tools.scenes.hertz import graded

# Pressed: R 50 and 50, contact radius 1; the bodies are cut at SIZE. Waves run 1 length in 1 time.
YOUNG, POISSON, RHO, RADIUS, SIZE = 2.0e4, 0.3, 2.0e4, 50.0, 10.0
MODULUS = YOUNG / (2.0 * (1.0 - POISSON ** 2))
WAY, PENALTY = 0.0385, 25.0 * MODULUS
CELL, RATIO = 0.2, 1.2    # of the lower body; those of the upper one over them
FINER = (3, 5, 7)


def line(cell, fine, size, level, grown=10):
    """From 0: `fine` even cells, then growing ones up to `size`."""
    start = np.arange(fine * level + 1) * cell / level
    return np.concatenate([start, graded(start[-1], size, cell, grown, level)[1:]])


def sphere_cut(cell, level, up):
    """The part of a sphere near its pole, of the height SIZE: coordinates row by row away from the contact."""
    r, depth = line(cell, 7, SIZE, level), line(cell, 4, SIZE, level)
    arc = r ** 2 / (RADIUS + np.sqrt(RADIUS ** 2 - r ** 2))
    sign = 1.0 if up else -1.0
    return np.array([(x, sign * (rise + z * (1.0 - rise / SIZE))) for z in depth for x, rise in zip(r, arc)]), len(r), len(depth)


def rows_up(points, columns, rows):
    """Rows from below: quads then turn to the left."""
    return points.reshape(rows, columns, 2)[::-1].reshape(-1, 2)


def pressed(kind, level, exchanged):
    deck = Deck(f"spheres pressed, type {kind}, level {level}")
    step = 0.022 / level
    deck.control(180.0, dt=step).hourglass(4, 0.05)
    deck.add("*SECTION_SHELL", (1, 15), (1.0,))
    for part in (1, 2):
        deck.part(part, section=1).elastic(RHO, YOUNG, POISSON, part)
    points, columns, rows = sphere_cut(CELL, level, up=False)
    low = deck.mesh(rows_up(points, columns, rows), grid_quads(columns - 1, rows - 1), part=1).reshape(rows, columns)
    points, columns, rows = sphere_cut(RATIO * CELL, level, up=True)
    high = deck.mesh(points, grid_quads(columns - 1, rows - 1), part=2).reshape(rows, columns)
    deck.node_set(1, high[0, :7 * level + 1]).node_set(2, low[-1, 7 * level::-1]).node_set(3, high[-1])
    deck.fix(low[0], y=1)
    share = np.linspace(0.0, 1.0, 41)
    deck.curve(1, [*((40.0 * s, -WAY * (s - np.sin(2.0 * np.pi * s) / (2.0 * np.pi))) for s in share), (1.0e6, -WAY)])
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", (3, 2, 2, 1, 1.0))
    deck.add("*DAMPING_GLOBAL", (0, 0.3))
    deck.contact(*((2, 1) if exchanged else (1, 2)), kind, PENALTY, unit=1, gauss=4)
    return deck.output(plot=180.0, glstat=18.0, rcforc=18.0)


def check_pressed(run, kind, level, exchanged=False):
    result = run.program(pressed(kind, level, exchanged))
    name = f"{TYPES[kind]}, N_r = {level}" + (", exchanged" if exchanged else "")
    energy = result.table("glstat")
    run.check(f"{name}: kinetic / internal energy", energy["kinetic"][-1] / energy["internal"][-1],
              0.0)
    table = result.table("contact")
    table = table.where(time=table["time"][-1])
    found = spheres.measure(table["x"], table["length"], table["pressure"])
    force = result.table("rcforc").where(side="slave")["fy"][-1]
    a, peak = spheres.hertz(2.0 * np.pi * abs(force), 0.5 * RADIUS, MODULUS)
    cell = CELL * (1.0 if exchanged else RATIO) / level / a
    soft = spheres.layer(MODULUS / (a * PENALTY * (2.0 if kind == 3 else 1.0)))
    # The edge, lumping, strains, and the cut at SIZE: README.md.
    mesh = (1.25 * cell ** 2.5 + 0.21 * cell ** 2 + (1.0 + POISSON) * (1.0 - 2.0 * POISSON) * peak / YOUNG
            + (a / SIZE) ** 3)
    scatter = 2.0 * found.scatter
    run.check(f"{name}: pressures add up to the force per radian", found.force, abs(force),
              scale=(2.0 * a / RADIUS) ** 2)
    for source, radius, top in (("Hertz (1881)", 1.0, 1.0), ("Hertz with a layer of springs", *soft[:2])):
        run.check(f"{name}: contact radius / {source}", found.radius / a / radius, 1.0,
                  tol=mesh + (soft[0] - 1.0 if radius == 1.0 else 0.0))
        run.check(f"{name}: peak pressure / {source}", found.peak / peak / top, 1.0,
                  tol=mesh + scatter + (1.0 - soft[1] if radius == 1.0 else 0.0))
    inside = table["x"] <= spheres.INSIDE * a
    ellipse = peak * np.sqrt(1.0 - (table["x"][inside] / a) ** 2)
    away = np.max(np.abs(table["pressure"][inside] - ellipse)) / peak
    if kind in PASS_PATCH:
        run.check(f"{name}: profile inside 0.8 a / p0", away, 0.0, tol=(mesh + soft[0] - 1.0) / 0.6)
    else:
        run.report(f"{name}: largest deviation of the profile inside 0.8 a / p0", away)


def check(run):
    for kind in TYPES:
        for level in (1, 2) if kind in (FINER if run.is_full else FINER[-1:]) else (1,):
            check_pressed(run, kind, level)
        check_pressed(run, kind, 1, exchanged=True)
