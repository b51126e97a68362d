# SPDX-License-Identifier: MIT
"""A disc begins to roll, and rolls down a slope, by every type."""
import numpy as np

from contact_types import TYPES
from meshes import Deck, grid, lumped_mass, polygon_quads

RHO, GRAVITY, RADIUS = 1000.0, 9.81, 1.0
#: Corners and elements of half a side: 144 segments round the disc.
CORNERS, HALF = 12, 6
#: Penalty, N/m^2: the disc sinks in by 5e-3 of its radius, on five segments.
PENALTY = 4.6e7
SINK = 5.0e-3
STEP = 5.0e-4


def disc(cells=HALF):
    """Points and quads of a disc about the origin: a regular polygon, `cells` elements on half a side, stretched to the circle."""
    angles = 2.0 * np.pi * np.arange(CORNERS) / CORNERS
    points, quads = polygon_quads(RADIUS * np.column_stack([np.cos(angles), np.sin(angles)]), cells)
    distance = np.hypot(*points.T)
    half = np.pi / CORNERS
    off = (np.arctan2(points[:, 1], points[:, 0]) + 4.0 * np.pi) % (2.0 * half) - half
    outline = RADIUS * np.cos(half) / np.cos(off)
    # Moved along the circle too, so that its segments are of one length.
    even = half * np.tan(off) / np.tan(half)
    angle = np.arctan2(points[:, 1], points[:, 0]) + np.where(distance > 0.0, even - off, 0.0)
    reach = RADIUS * distance / outline
    return reach[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]), quads


def rolling(kind, friction, slope, speed, end, way, exchanged=False, small=False, vdc=0.0, cells=HALF):
    """Rigid disc on a rigid plate, gravity turned by `slope`. `small`: mm, ms and kg instead of SI units."""
    length, time = (1.0e3, 1.0e3) if small else (1.0, 1.0)
    deck = Deck(f"rigid disc on a plate, type {kind}")
    deck.control(end * time, dt=STEP * time)
    points, quads = disc(cells)
    # The disc starts about where its weight is carried, so that it does not bounce.
    points = points + (0.0, RADIUS - 0.9 * SINK)
    mass = lumped_mass(points, quads, RHO)
    for part, hold in ((1, (0, 0)), (2, (7, 7))):
        deck.part(part)
        deck.add("*MAT_RIGID", (part, RHO / length ** 3, 1.0e9 / (length * time ** 2), 0.3), (1, *hold), (0.0,))
    nodes = deck.mesh(points * length, quads, part=1)
    plate, plate_quads = grid(round(way / 0.05), 1, way, 0.2, (-0.5, -0.2))
    deck.mesh(plate * length, plate_quads, part=2)
    deck.add("*SET_PART_LIST", (11,), (1,)).add("*SET_PART_LIST", (12,), (2,))
    sides = (12, 11) if exchanged else (11, 12)
    deck.curve(1, [(0.0, 1.0), (1.0e6 * time, 1.0)])
    share = 0.5 if kind == 3 else 1.0  # of two passes
    g = GRAVITY * length / time ** 2
    deck.add("*LOAD_BODY_Y", (1, g * np.cos(slope)))
    if slope:
        deck.add("*LOAD_BODY_X", (1, -g * np.sin(slope)))
    if speed:
        deck.add("*INITIAL_VELOCITY_RIGID_BODY", (1, speed * length / time))
    deck.add("*CONTACT_2D_SLIDELINE", (*sides, kind, 3, share * PENALTY / (length * time) ** 2, friction),
             (0.0, 1.0e20, 1, 0.0, vdc))
    every = 2.0 * STEP * time
    deck.output(glstat=every, matsum=every, rcforc=every, nodout=every, nodes=nodes[:2])
    inertia = mass @ ((points - mass @ points / mass.sum()) ** 2).sum(axis=1)
    return deck, mass.sum(), inertia


def brush(force, normal, friction):
    """Creep (1 - rim speed/speed) of a disc that rolls steadily on springs: shear grows with the way s from the leading edge, eps
    times the integral of creep + (s - a)^2/(2 R^2), since the rim moves on a circle, until it meets mu p; then it slides."""
    half_width = (1.5 * RADIUS * normal / PENALTY) ** (1.0 / 3.0)
    way = np.linspace(0.0, 2.0 * half_width, 2001)
    limit = friction * PENALTY * way * (2.0 * half_width - way) / (2.0 * RADIUS)
    turned = PENALTY * ((way - half_width) ** 3 + half_width ** 3) / (6.0 * RADIUS ** 2)
    low, high = 0.0, friction * half_width / RADIUS
    for _ in range(60):
        creep = 0.5 * (low + high)
        total = 2.0 * half_width * np.mean(np.minimum(creep * PENALTY * way + turned, limit))
        low, high = (creep, high) if total < force else (low, creep)
    return creep


def measured(result, mass, exchanged=False):
    """Time, force on the disc along and across the plate, its speed, and the speed of its rim from the spin."""
    force = result.table("rcforc").where(side="master" if exchanged else "slave")
    part = result.table("matsum").where(part=1)
    one, other = result.node(1), result.node(2)
    x, y = other["x"] - one["x"], other["y"] - one["y"]
    spin = ((other["vy"] - one["vy"]) * x - (other["vx"] - one["vx"]) * y) / (x * x + y * y)
    return force["time"], force["fx"], force["fy"], part["momentum_x"] / mass, -spin * RADIUS


def check_energy(run, name, result):
    energies = result.table("glstat")
    balance = energies["total"] - energies["external_work"]
    run.check(f"{name}: total - external work", balance - balance[0], 0.0, scale=energies["kinetic"].max())


def check_slope(run, kind, exchanged=False, slope=np.radians(30.0), friction=0.5):
    """Rolls down: a = g sin/(1 + I/m R^2), F = m g sin (I/m R^2)/(1 + I/m R^2); the creep is that of springs."""
    name = f"slope{', exchanged' if exchanged else ''}: {TYPES[kind]}"
    deck, mass, inertia = rolling(kind, friction, slope, 0.0, 1.2, 4.0, exchanged)
    result = run.program(deck)
    time, along, across, speed, rim = measured(result, mass, exchanged)
    late = time > 0.3
    share = inertia / (mass * RADIUS ** 2)
    weight = mass * GRAVITY * np.sin(slope)
    run.check(f"{name}: acceleration", np.polyfit(time[late], speed[late], 1)[0], weight / mass / (1.0 + share))
    expected = weight * share / (1.0 + share)
    run.check(f"{name}: friction", -np.mean(along[late]), expected)
    run.check(f"{name}: normal force", np.mean(across[late]), mass * GRAVITY * np.cos(slope))
    late = time > 0.6
    run.check(f"{name}: creep", 1.0 - np.mean(rim[late] / speed[late]), brush(expected, mass * GRAVITY * np.cos(slope), friction))
    check_energy(run, name, result)


def check_begins(run, kind, friction=0.2, speed=1.0):
    """Set on the level with a speed and no spin: slides, then rolls with v0/(1 + I/m R^2)."""
    name = f"level: {TYPES[kind]}"
    deck, mass, inertia = rolling(kind, friction, 0.0, speed, 0.5, 2.0)
    result = run.program(deck)
    time, along, across, moved, rim = measured(result, mass)
    share = inertia / (mass * RADIUS ** 2)
    begins = speed / (friction * GRAVITY * (1.0 + 1.0 / share))
    rolls, slides = time > 1.2 * begins, time < 0.9 * begins
    run.check(f"{name}: speed when it rolls", np.mean(moved[rolls]), speed / (1.0 + share))
    run.check(f"{name}: speed of the rim", np.mean(rim[rolls]), speed / (1.0 + share))
    line = np.polyfit(time[slides], (moved - rim)[slides], 1)
    run.check(f"{name}: begins to roll", -line[1] / line[0], begins)
    run.check(f"{name}: friction while it slides", -np.sum(along[slides]), friction * np.sum(across[slides]))
    run.check(f"{name}: dissipated", result.table("glstat")["friction"][-1],
              0.5 * mass * speed ** 2 * share / (1.0 + share))
    check_energy(run, name, result)


def check_units(run, kind):
    """The same in mm, ms and kg."""
    found = []
    for small in (False, True):
        deck, mass, _ = rolling(kind, 0.5, np.radians(30.0), 0.0, 0.6, 2.0, small=small, vdc=10.0)
        # kg per mm of depth
        found.append(measured(run.program(deck), 1.0e-3 * mass if small else mass))
    for what, index, factor in (("force along the plate", 1, 1.0e-6), ("normal force", 2, 1.0e-6), ("speed", 3, 1.0)):
        run.check(f"mm, ms, kg: {what}: {TYPES[kind]}", found[1][index], factor * found[0][index])


def check(run):
    for kind in TYPES:
        check_slope(run, kind)
        check_begins(run, kind)
    for kind in (2, 4, 5, 7):
        check_slope(run, kind, exchanged=True)
    for kind in (3, 5, 7):
        check_units(run, kind)
