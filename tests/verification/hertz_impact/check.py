# SPDX-License-Identifier: MIT
"""Two steel spheres collide, and one hits a half space: Hertz's contact time, approach and largest force."""
import pathlib
import sys

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "hertz_spheres"))

import spheres  # noqa: E402
from contact_types import TYPES  # noqa: E402
from meshes import Deck, grid_quads  # noqa: E402
from slideline_tools.scenes.hertz import graded  # noqa: E402

DENSITY, YOUNG, POISSON = 7850.0, 210.0e9, 0.3
BALL, SPEED = 0.01, 1.0
EDGE, RATIO = 0.07e-3, 1.2    # cell at the contact; those of the other sphere are as much smaller
PENALTY = 2.0e15              # N/m^3
MODULUS = YOUNG / (2.0 * (1.0 - POISSON ** 2))
MASS = 4.0 / 3.0 * np.pi * BALL ** 3 * DENSITY
#: Types that collide where not in full; 7 hits the half space, 1 and 5 are in the punch.
FEW = (2, 3, 4, 6)
#: Half space: cell of the sphere, depth and radius of the block, growth of its cells.
COARSE, EXTENT, GROWTH = 0.1e-3, 0.22, 1.2


def line(cell, fine, size, grown):
    """From 0: `fine` even cells, then growing ones up to `size`."""
    start = np.arange(fine + 1) * cell
    return np.concatenate([start, graded(start[-1], size, cell, grown, 1)[1:]])


def ball(cell, grown=(12, 16)):
    """A whole sphere with its lowest point at 0: a rectangle u in 0..1, v in -1..1 mapped on half of the disc, r = u
    sqrt(1 - v^2/2), y = v sqrt(1 - u^2/2), with fine cells where v = -1 and u = 0, then `grown` ones; columns, rows too."""
    fine = cell * np.sqrt(2.0) / BALL
    u, v = line(fine, 9, 1.0, grown[0]), line(fine, 4, 2.0, grown[1]) - 1.0
    points = np.array([(BALL * a * np.sqrt(1.0 - 0.5 * b * b), BALL * (1.0 + b * np.sqrt(1.0 - 0.5 * a * a)))
                       for b in v for a in u])
    points[np.abs(points) < 1e-15] = 0.0
    return points, len(u), len(v)


def growing(cell, fine, size):
    """From 0 to `size`: `fine` even cells, then each longer by `GROWTH` than the one before."""
    steps = [cell] * fine
    while sum(steps) < size:
        steps.append(steps[-1] * GROWTH)
    lines = np.concatenate([[0.0], np.cumsum(steps)])
    start = lines[fine]
    return np.concatenate([lines[:fine], start + (lines[fine:] - start) * (size - start) / (lines[-1] - start)])


def half_space(kind):
    """A sphere on a block so large that no wave comes back from its sides while the contact lasts."""
    deck = Deck(f"steel sphere on a half space, type {kind}")
    deck.control(77.0e-6, scale=0.6)
    deck.add("*SECTION_SHELL", (1, 15), (1.0,)).hourglass(4, 0.05)
    for part in (1, 2):
        deck.part(part, section=1).elastic(DENSITY, YOUNG, POISSON, part)
    points, columns, rows = ball(COARSE)
    sphere = deck.mesh(points + [0.0, 1.0e-9], grid_quads(columns - 1, rows - 1)).reshape(rows, columns)
    r, depth = (growing(COARSE / RATIO, fine, EXTENT) for fine in (9, 4))
    block = deck.mesh([(x, -y) for y in depth[::-1] for x in r], grid_quads(len(r) - 1, len(depth) - 1), part=2)
    top = block.reshape(len(depth), len(r))[-1, :np.searchsorted(r, 1.2e-3) + 1]
    deck.node_set(1, sphere[0, :16]).node_set(2, top[::-1]).node_set(3, sphere.ravel())
    deck.add("*INITIAL_VELOCITY", (3,), (0.0, -SPEED))
    deck.contact(1, 2, kind, PENALTY, unit=1, gauss=4)
    return deck.output(plot=40.0e-6, glstat=0.2e-6, rcforc=0.1e-6, matsum=0.1e-6)


def collision(kind, edge=EDGE, grown=(12, 16)):
    deck = Deck(f"two steel spheres collide, type {kind}")
    deck.control(70.0e-6, scale=0.6)
    deck.add("*SECTION_SHELL", (1, 15), (1.0,)).hourglass(4, 0.05)
    ids, gap = [], 1.0e-9
    for part, cell in ((1, edge), (2, edge / RATIO)):
        deck.part(part, section=1).elastic(DENSITY, YOUNG, POISSON, part)
        points, columns, rows = ball(cell, grown)
        quads = np.array(grid_quads(columns - 1, rows - 1))
        if part == 2:
            points, quads = points * [1.0, -1.0] - [0.0, gap], quads[:, ::-1]
        ids.append(deck.mesh(points, quads, part=part).reshape(rows, columns))
    deck.node_set(1, ids[0][0, :16]).node_set(2, ids[1][0, 15::-1])
    deck.node_set(3, ids[0].ravel()).node_set(4, ids[1].ravel())
    for nodes, sign in ((3, -1.0), (4, 1.0)):
        deck.add("*INITIAL_VELOCITY", (nodes,), (0.0, sign * 0.5 * SPEED))
    deck.contact(1, 2, kind, PENALTY, unit=1, gauss=4)
    return deck.output(plot=35.0e-6, glstat=0.2e-6, rcforc=0.1e-6, matsum=20.0e-6)


def contact_time(side, force, least):
    """From the first touch to the last: where the force passes a thousandth."""
    touched = np.flatnonzero(force > least)
    return side["time"][touched[-1]] - side["time"][touched[0]]


def check_collision(run, kind):
    result = run.program(collision(kind), name=f"collision_{kind}")
    name = f"{TYPES[kind]}, collision"
    duration, approach, largest = spheres.impact(0.5 * MASS, 0.5 * BALL, MODULUS, SPEED)
    side = result.table("rcforc").where(side="slave")
    force = 2.0 * np.pi * side["fy"]
    touched = np.flatnonzero(force > 1e-3 * largest)
    found = contact_time(side, force, 1e-3 * largest)
    soft = spheres.impact_on_springs(0.5 * MASS, 0.5 * BALL, MODULUS, SPEED, PENALTY * (2.0 if kind == 3 else 1.0))
    # The largest body is a sphere, not a half space: 0.73 a/R less approach at the same force (README.md).
    a = np.sqrt(0.5 * BALL * approach)
    sphere = 0.6 * 0.73 * a / BALL
    mesh = (EDGE / a) ** 2 / 3.0
    first_cell = 2.0 * (0.5 * EDGE) ** 2 / (0.5 * BALL) / SPEED / duration
    for what, value, plain, sprung, start in (("contact time", found, duration, soft[0], first_cell),
                                              ("largest force", force.max(), largest, soft[2], 0.0)):
        run.check(f"{name}: {what} / Hertz", value / plain, 1.0,
                  tol=sphere + mesh + start + abs(sprung / plain - 1.0))
        run.check(f"{name}: {what} / Hertz with a layer of springs", value / sprung, 1.0,
                  tol=sphere + mesh + start)
    energy = result.table("glstat")
    run.check(f"{name}: energy ratio", energy["energy_ratio"], np.ones_like(energy["time"]))
    run.check(f"{name}: hourglass / initial kinetic energy",
              energy["hourglass"].max() / energy["kinetic"][0], 0.0)
    run.check(f"{name}: kinetic energy after over before",
              energy["kinetic"][-1] / energy["kinetic"][0], 1.0)
    run.check(f"{name}: force on both / largest", force[touched]
              + 2.0 * np.pi * result.table("rcforc").where(side="master")["fy"][touched], 0.0, scale=largest)


def check_half_space(run, kind):
    result = run.program(half_space(kind), name=f"half_space_{kind}")
    name = f"{TYPES[kind]}, half space"
    plain = spheres.impact(MASS, BALL, MODULUS, SPEED)
    sprung = spheres.impact_on_springs(MASS, BALL, MODULUS, SPEED, PENALTY * (2.0 if kind == 3 else 1.0))
    side = result.table("rcforc").where(side="slave")
    force = 2.0 * np.pi * side["fy"]
    sphere = result.table("matsum").where(part=1)
    time, velocity = sphere["time"], sphere["momentum_y"] / sphere["mass"]
    way = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time))])
    a = np.sqrt(BALL * plain[1])
    # Half of what two spheres lack of half spaces (README.md), and the mesh.
    off = 0.6 * 0.36 * a / BALL + (COARSE / a) ** 2 / 3.0
    first_cell = 2.0 * (0.5 * COARSE) ** 2 / BALL / SPEED / plain[0]
    for k, (what, value, start) in enumerate((
            ("contact time", contact_time(side, force, 1e-3 * plain[2]), first_cell),
            ("largest approach", -way.min(), 0.0), ("largest force", force.max(), 0.0))):
        run.check(f"{name}: {what} / Hertz", value / plain[k], 1.0,
                  tol=off + start + abs(sprung[k] / plain[k] - 1.0))
        run.check(f"{name}: {what} / Hertz with a layer of springs", value / sprung[k], 1.0,
                  tol=off + start)
    lost = 1.04 * (SPEED / np.sqrt(YOUNG / DENSITY)) ** 0.6
    run.check(f"{name}: kinetic energy that the waves take", 1.0 - (velocity[-1] / SPEED) ** 2,
              lost)
    energy = result.table("glstat")
    run.check(f"{name}: energy ratio", energy["energy_ratio"], np.ones_like(energy["time"]))


def check(run):
    for kind in TYPES if run.is_full else FEW:
        check_collision(run, kind)
    for kind in TYPES if run.is_full else (7,):
        check_half_space(run, kind)
