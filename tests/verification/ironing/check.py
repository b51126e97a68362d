# SPDX-License-Identifier: MIT
"""Ironing after Fischer and Wriggers: a die with a round foot goes into an elastic slab, then along it, with friction."""
import numpy as np

from contact_types import TYPES
from meshes import Deck, grid, grid_quads

YOUNG, POISSON, FRICTION = (68.96e8, 6.896e8), 0.32, 0.3
#: Of the slab; the die is ten times as heavy, so that waves run as fast in both. Lengths, wave speed: see UNIT.
RHO = 1000.0
#: Time in which a wave goes a unit of length.
UNIT = 1.0 / np.sqrt(YOUNG[1] / RHO)
PENALTY = 4.0e10
#: Types that come through on the way along the slab.
THROUGH = (3, 4, 5, 6, 7)
#: Forces per depth at parts of the way down (Fischer & Wriggers' example, by another program with another contact).
TIMES = np.array([0.5, 0.6, 0.7, 0.8, 0.9, 1.0])
DOWN = np.array([9.454e7, 1.3456e8, 1.7840e8, 2.2557e8, 2.7555e8, 3.2990e8])
ASIDE = np.array([1.836e7, 2.668e7, 3.599e7, 4.608e7, 5.689e7, 6.902e7])


def die_mesh(columns, rows):
    """Straight columns between the arc of radius 0.75 about (0.8, 0.95) and y = 1.4."""
    x = np.linspace(0.2, 1.4, columns + 1)
    foot = 0.95 - np.sqrt(0.75 ** 2 - (x - 0.8) ** 2)
    share = np.linspace(0.0, 1.0, rows + 1)
    return np.array([(a, b + s * (1.4 - b)) for s in share for a, b in zip(x, foot)]), grid_quads(columns, rows)


def ironing(kind, press=150.0, slide=0.0, exchanged=False, friction=FRICTION, penalty=PENALTY, scale=0.3, level=2, reach=10.0):
    """Down by 1 in `press`, then along by `reach` in `slide` UNITs; level 2 has the example's mesh."""
    # Along the slab the step would follow elements that fold at the leading corner, and leap-frog keeps its account at equal steps alone.
    deck = Deck(f"ironing, type {kind}").control((press + slide) * UNIT, UNIT / 60.0 if slide else None, scale).hourglass(4, 0.05)
    for part, rho in ((1, 10.0 * RHO), (2, RHO)):
        deck.part(part).elastic(rho, YOUNG[part - 1], POISSON, part)
    across = 60 * level + 1
    die = deck.mesh(*die_mesh(6 * level, 3 * level), part=1)
    slab = deck.mesh(*grid(across - 1, 15 * level, 12.0, 4.0, (0.0, -4.0)), part=2)
    deck.fix(slab[:across], x=1, y=1)
    rows = die.reshape(-1, 6 * level + 1)
    # The foot and, since the die goes in deeper than the foot is high, both sides.
    deck.node_set(1, [*rows[-2:0:-1, 0], *rows[0], *rows[1:-1, -1]]).node_set(2, slab[-across:][::-1]).node_set(3, rows[-1])
    # A steady speed, but for the first hundredths of each way.
    soft = 0.04

    def ramp(first, length, way):
        rise = np.linspace(0.0, 1.0, 21)
        start = 0.5 * soft * (rise - np.sin(np.pi * rise) / np.pi) * length
        speed = way / length / (1.0 - 0.5 * soft)
        return [(UNIT * (first + length * soft * r), speed * s) for r, s in zip(rise, start)] + [(UNIT * (first + length), way)]

    deck.curve(1, [*ramp(0.0, press, -1.0), (2.0 * (press + slide) * UNIT, -1.0)])
    motions = [(3, 2, 2, 1, 1.0)]
    if slide:
        deck.curve(2, [(0.0, 0.0), *ramp(press, slide, reach), (2.0 * (press + slide) * UNIT, reach)])
        motions.append((3, 1, 2, 2, 1.0))
    else:
        deck.fix(rows[-1], x=1)
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", *motions)
    deck.add("*DAMPING_GLOBAL", (0, 0.3 / UNIT))
    passes = 2.0 if kind == 3 else 1.0
    deck.add("*CONTACT_2D_SLIDELINE", (*((-2, -1) if exchanged else (-1, -2)), kind, 3, penalty / passes, friction),
             (0.0, 1.0e20, 1))
    every = (press / 100.0 if not slide else slide / 1000.0) * UNIT
    return deck.output(glstat=every, rcforc=every, plot=0.25 * (press + slide) * UNIT)


def check_down(run, kind, press=120.0):
    """Forces on the way down."""
    result = run.program(ironing(kind, press))
    force = result.table("rcforc").where(side="slave")
    time = force["time"] / (press * UNIT)
    for what, column, expected in (("vertical", "fy", DOWN), ("horizontal", "fx", -ASIDE)):
        ratio = np.interp(TIMES, time, force[column]) / expected
        run.check(f"{TYPES[kind]}: {what} force on the way down, mean of six depths",
                  np.mean(ratio), 1.0)
    energies = result.table("glstat")
    run.check(f"{TYPES[kind]}: kinetic / internal energy at the end",
              energies["kinetic"][-1] / energies["internal"][-1], 0.0)
    balance = energies["total"] - energies["external_work"]
    run.check(f"{TYPES[kind]}: total - external work", np.ptp(balance), 0.0,
              scale=energies["internal"].max())


def along(result, press, slide):
    """Forces on the slab, down and against the motion, over 2 to 9 of the way along it; rows of equal times."""
    force = result.table("rcforc").where(side="slave")
    way = 10.0 * (force["time"] / UNIT - press) / slide
    keep = (way >= 2.0) & (way <= 9.0)
    return way[keep], force["fy"][keep], -force["fx"][keep]


def roughness(way, force, cell=0.1):
    """Standard deviation from the running mean over one element of the slab, over the mean."""
    rows = round(cell / np.mean(np.diff(way)))
    running = np.convolve(force, np.full(rows, 1.0 / rows), "valid")
    inner = force[rows // 2:rows // 2 + len(running)]
    return np.std(inner - running) / np.mean(force)


def check_along(run, kind, press=150.0, slide=600.0):
    """Forces along the slab: figures of each type, and what holds for all."""
    name = f"{TYPES[kind]}, along"
    result = run.program(ironing(kind, press, slide, penalty=2.0e10))
    way, down, aside = along(result, press, slide)
    for what, force in (("vertical", down), ("horizontal", aside)):
        run.report(f"{name}: mean {what} force, 1e8", np.mean(force) / 1e8)
        run.report(f"{name}: roughness of the {what} force", roughness(way, force))
    energies = result.table("glstat")
    scale = energies["internal"].max()
    balance = energies["total"] - energies["external_work"]
    run.check(f"{name}: total - external work", np.ptp(balance), 0.0, scale=scale)
    run.check(f"{name}: largest fall of the dissipated energy", -np.diff(energies["friction"]).min(), 0.0, scale=scale)
    return np.mean(down), np.mean(aside), roughness(way, aside)


def check(run):
    for kind in TYPES:
        check_down(run, kind)
    if not run.is_full:
        return
    found = np.array([check_along(run, kind) for kind in THROUGH])
    for what, values in zip(("vertical", "horizontal"), found.T):
        run.check(f"types 3 to 7, along: mean {what} force over that of all", values / np.mean(values), 1.0)
    run.true("the horizontal force is smoothest with type 7", np.argmin(found[:, 2]) == len(found) - 1)
