# SPDX-License-Identifier: MIT
"""Surfaces that come and go: outlines slide on and off a plate and fall on it; a block rattles (rattle.py)."""
import itertools

import numpy as np

import rattle
from contact_types import TYPES
from meshes import Deck, grid, lumped_mass, rotate, trapezoid

MM = 1.0e-3
SPEED, DEPTH = 20.0, 2.0 * MM
#: Penalty of the built-in estimate for the coarse mesh, N/m^2: the same with part sets and with node sets.
PENALTY = 6.7e12
BLOCK, PLATE = (7850.0, 210.0e9, 0.3), (2700.0, 69.0e9, 0.33)
STOCK = ("NODE_TO_SURFACE", "ONE_WAY_SURFACE_TO_SURFACE", "SURFACE_TO_SURFACE", "SURFACE_TO_SURFACE_MORTAR")
#: Element length and overlap, mm.
SCENES = ((1.0, 0.02), (1.0, 0.2), (0.25, 0.2))
#: Its master nodes come and go at corners: what it makes is reported, not judged.
NTS_MAR = 5
#: Types on the last of them, where not in full.
FINE = (1, 4, 5, 7)
SIDES = {"block": (1, 2), "plate": (2, 1)}


def sled(size, overlap, ramp, rise, start):
    """Block of 8 x 2 mm with its nose, on the right, ramped up; under side at -overlap."""
    n_x, n_y = round(8 / size), max(2, round(2 / size))
    x, quads = grid(n_x, n_y, 8 * MM, DEPTH, (start - 8 * MM, -overlap))
    along = np.clip((x[:, 0] - (start - ramp)) / ramp, 0.0, 1.0)
    x[:, 1] += rise * along * (1.0 - (x[:, 1] + overlap) / DEPTH)
    return x, quads, n_x + 1


def sliding(title, size, overlap, start, end, card, whole, sides):
    """The upper side of the block is led along the plate (12 mm long, its lower side held) at a fixed height."""
    deck = Deck(title).control(end, scale=0.5).hourglass(4, 0.1)
    for part, material in enumerate((BLOCK, PLATE), start=1):
        deck.part(part).elastic(*material, part)
    x, quads, n = sled(size, overlap * MM, 4 * MM, (1.5 * overlap + 0.02) * MM, start * MM)
    block = deck.mesh(x, quads, part=1)
    m = round(12 / size) + 2
    plate = deck.mesh(*grid(m - 1, max(2, round(3 / size)), 12 * MM, 3 * MM, (0.0, -3 * MM)), part=2)
    deck.fix(plate[:m], x=1, y=1).fix(block[-n:], y=1).curve(1, [(0.0, 1.0), (1.0, 1.0)])
    for node in block[-n:]:
        deck.prescribe(node, 1, 0, 1, SPEED)
    deck.node_set(1, block).add("*INITIAL_VELOCITY", (1,), (SPEED, 0.0))
    if whole:
        deck.add("*SET_PART_LIST", (11,), (1,)).add("*SET_PART_LIST", (12,), (2,))
    else:
        deck.node_set(11, block[:n]).node_set(12, plate[-m:][::-1])
    sign = 1 if whole else -1
    pair = [sign * (10 + side) for side in sides]
    if isinstance(card, str):
        deck.add(f"*CONTACT_2D_AUTOMATIC_{card}", pair)
    else:
        deck.add("*CONTACT_2D_SLIDELINE", (*pair, card, 3, PENALTY), (0.0, 1.0e20, 1))
    return deck.output(rcforc=2.0e-6, glstat=2.0e-6)


def mean_forces(result, sides, first):
    """Drag on the block against its way and force that lifts it, means from a time on."""
    rows = result.table("rcforc").where(side="slave")
    late = rows["time"] >= first
    sign = 1.0 if sides == SIDES["block"] else -1.0
    drag, lift = (sign * trapezoid(rows[axis][late], rows["time"][late]) / np.ptp(rows["time"][late])
                  for axis in ("fx", "fy"))
    return -drag, lift


def check_sliding(run, name, size, overlap, start, end, first, card, sides):
    """Part sets against open node sets."""
    found = {}
    for whole in (True, False):
        result = run.program(sliding(name, size, overlap, start, end, card, whole, sides))
        found[whole] = mean_forces(result, sides, first)
    (drag, lift), (open_drag, open_lift) = found[True], found[False]
    run.check(f"{name}: lift / that of open node sets", lift / open_lift, 1.0)
    run.check(f"{name}: drag / lift, at most", drag / open_lift, open_drag / open_lift)
    return lift


def check_slide_on(run):
    chosen = [one for one in run.cover(SCENES, SIDES, TYPES) if run.is_full or one[0] != SCENES[-1] or one[2] in FINE]
    for (size, overlap), side in itertools.product(SCENES, SIDES):
        name = f"on, {size:g} mm, {overlap:g} mm deep, {side} is the slave"
        lifts = [check_sliding(run, f"{name}: {TYPES[kind]}", size, overlap, -0.5, 3.5e-4, 1.5e-4, kind, SIDES[side])
                 for scene, other, kind in chosen if scene == (size, overlap) and other == side]
        run.check(f"{name}: least lift of all types / largest", min(lifts) / max(lifts), 0.1)
    for keyword, side in run.cover(STOCK, SIDES, strength=1):
        check_sliding(run, f"on, stock {keyword}, {side} is the slave", 1.0, 0.2, -0.5, 3.5e-4, 1.5e-4, keyword, SIDES[side])


def check_slide_off(run):
    """From the middle of the plate over its far end, until a quarter of the block is left on it."""
    for side, kind in run.cover(SIDES, TYPES, strength=1):
        check_sliding(run, f"off, {side} is the slave: {TYPES[kind]}", 1.0, 0.02, 11.2, 4.5e-4, 0.0, kind, SIDES[side])


def falling(kind, angle, sides, shape, quads):
    """A body over a held plate of 4 x 0.6 m, turned by `angle`, lowest node 1 cm above it, falling at 5 m/s."""
    deck = Deck(f"falling, type {kind}").control(0.15, scale=0.5).hourglass(4, 0.1)
    for part in (1, 2):
        deck.part(part).elastic(1000.0, 1.0e7, 0.3, part)
    x = rotate(shape, angle)
    x[:, 1] += 0.01 - np.min(x[:, 1])
    ids = deck.mesh(x, quads, part=1)
    plate = deck.mesh(*grid(47, 7, 4.0, 0.6, (-2.0, -0.6)), part=2)
    deck.fix(plate[:48], x=1, y=1).node_set(1, ids).add("*INITIAL_VELOCITY", (1,), (0.0, -5.0))
    deck.add("*SET_PART_LIST", (11,), (1,)).add("*SET_PART_LIST", (12,), (2,))
    deck.add("*CONTACT_2D_SLIDELINE", (*(10 + side for side in sides), kind, 4, 0.2), (0.0, 1.0e20, 2))
    return deck.output(plot=0.15, glstat=1.0e-4), x


def wedge(half_angle):
    """A wedge of quads, 1 m high, whose sides are at that angle from the vertical; 0.04 m wide at its lower end."""
    x, quads = grid(4, 6, 1.0, 1.0, (-0.5, 0.0))
    narrow = np.maximum(x[:, 1], 0.0) * np.tan(half_angle)
    x[:, 0] = 2.0 * x[:, 0] * (0.02 + narrow)
    return x, quads


def check_falls(run):
    block = grid(6, 4, 0.9, 0.6)
    shapes = {"on its corner at 45 degrees": (block, np.pi / 4), "at 20 degrees, tilts on to its corner": (block, np.radians(20)),
              "at 31 degrees": (block, np.radians(31)), "flat": (block, 0.0),
              "on a corner of 50 degrees": (wedge(np.radians(25)), 0.3)}
    for words, side, kind in run.cover(shapes, SIDES, TYPES):
        (shape, quads), angle = shapes[words]
        name = f"{words}, {'body' if side == 'block' else 'plate'} is the slave: {TYPES[kind]}"
        deck, start = falling(kind, angle, SIDES[side], shape, quads)
        result = run.program(deck)
        mass = lumped_mass(start, quads, 1000.0)
        velocity = result.points("velocity")[:, :len(mass), 1]
        momentum = velocity @ mass / np.sum(mass)
        energy = result.table("glstat")
        run.check(f"{name}: turned back, v / v0", momentum[-1] / 5.0, 0.0)
        made = -np.min(energy["contact"]) / energy["total"][0]
        if kind == NTS_MAR:
            run.report(f"{name}: contact made / E0", made)
        else:
            run.check(f"{name}: contact made / E0", made, 0.02)
        run.report(f"{name}: contact left / E0", energy["contact"][-1] / energy["total"][0])


def check(run):
    check_slide_on(run)
    check_slide_off(run)
    check_falls(run)
    rattle.check(run)
