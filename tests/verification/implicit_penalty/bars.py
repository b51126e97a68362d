# SPDX-License-Identifier: MIT
"""Plane waves: a bar meets a bar, an element that is held or led, and a rigid body."""
import numpy as np

from meshes import Deck, grid, trapezoid

RHO, YOUNG, LENGTH, SPEED = 1000.0, 1.0e6, 1.0, 0.1
SOUND = np.sqrt(YOUNG / RHO)
DURATION = 2.0 * LENGTH / SOUND   # of the contact of two equal bars
STOCK, IMPLICIT = 2, 4            # PUNIT
RIGID, DEFAULT = -1.0, 0.0        # PEN with PUNIT 4: no compliance, ten times K L/A
N = 50                            # elements of a bar
HEIGHT = LENGTH / N
STEP = 1.0e-9                     # every cycle


def start(title, end, scale=0.9, young=(YOUNG, YOUNG), poisson=0.0, dt=None, rigid=None):
    """`rigid`: constraints (CON1, CON2) of part 2 where it is a rigid body."""
    deck = Deck(title).control(end, dt=dt, scale=scale).hourglass(4, 0.1)
    deck.part(1).elastic(RHO, young[0], poisson, 1).part(2)
    if rigid is None:
        return deck.elastic(RHO, young[1], poisson, 2)
    return deck.add("*MAT_RIGID", (2, RHO, young[1], poisson), (1.0, *rigid), (0.0,))


def bars(scale, penalty, gap=0.0, other=(N, 1), young=YOUNG, outlines=False):
    """A bar of N x 1 elements runs into one of the same height, which rests."""
    deck = start("two bars", 1.6 * DURATION, scale, (YOUNG, young))
    left = deck.mesh(*grid(N, 1, LENGTH, HEIGHT, (-LENGTH - gap, 0.0)), part=1)
    right = deck.mesh(*grid(*other, LENGTH, HEIGHT), part=2)
    deck.node_set(1, left).add("*INITIAL_VELOCITY", (1,), (SPEED, 0.0))
    if outlines:
        deck.add("*SET_PART_LIST", (1,), (1,)).add("*SET_PART_LIST", (2,), (2,))
        deck.add("*CONTACT_2D_SLIDELINE", (1, 2, 7, 2, penalty), (0.0, 1.0e20, IMPLICIT))
    else:
        deck.node_set(2, left[N::N + 1]).node_set(3, right[::other[0] + 1][::-1])
        deck.contact(2, 3, 7, penalty, IMPLICIT)
    return deck.output(glstat=STEP, rcforc=STEP, matsum=STEP)


def bar_at_wall(scale, penalty, led):
    """The bar against one element that is held, or is led into it."""
    deck = start("a bar and what is held", 1.3 * DURATION, scale)
    bar = deck.mesh(*grid(N, 1, LENGTH, HEIGHT, (-LENGTH, 0.0)), part=1)
    wall = deck.mesh(*grid(1, 1, HEIGHT, HEIGHT), part=2)
    deck.node_set(1, bar).node_set(2, bar[N::N + 1]).node_set(3, wall[::2][::-1]).fix(wall, y=1)
    if led:
        deck.curve(1, [(0.0, 1.0), (1.0e3, 1.0)])
        for node in wall:
            deck.prescribe(node, 1, 0, 1, -SPEED)
    else:
        deck.fix(wall, x=1).add("*INITIAL_VELOCITY", (1,), (SPEED, 0.0))
    return deck.contact(2, 3, 7, penalty, IMPLICIT).output(glstat=STEP, rcforc=STEP)


def rigid_body(penalty, rows, held, exchanged):
    """A rigid block of the height of the bar runs into it, or the bar into the block where that is held."""
    deck = start("rigid body and bar", 1.5 * LENGTH / SOUND, rigid=(7, 7) if held else (0, 0))
    bar = deck.mesh(*grid(N, rows[0], LENGTH, HEIGHT), part=1)
    body = deck.mesh(*grid(10, rows[1], 0.2, HEIGHT, (-0.2, 0.0)), part=2)
    deck.node_set(3, bar if held else body).add("*INITIAL_VELOCITY", (3,), (-SPEED if held else SPEED, 0.0))
    deck.node_set(1, bar[::N + 1][::-1]).node_set(2, body[10::11])
    return deck.contact(*((2, 1) if exchanged else (1, 2)), 7, penalty, IMPLICIT).output(glstat=STEP, rcforc=STEP, matsum=STEP)


def plateau(table, share=1.0):
    """Mean and relative deviation of the force between the passages of the waves."""
    force = np.abs(table["fx"])
    inside = force[np.abs(table["time"] - 0.575 * DURATION) < 0.275 * DURATION]
    return inside.mean() / (share * RHO * SOUND * SPEED * HEIGHT), np.sqrt(np.mean((inside / inside.mean() - 1.0)**2))


def check_momentum(run, name, result):
    total = sum(result.table("matsum").where(part=part)["momentum_x"] for part in (1, 2))
    run.check(f"{name}: momentum / initial", np.ptp(total) / total[0], 0.0)


def check_bars(run):
    energy, forces = 0.5 * RHO * LENGTH * HEIGHT * SPEED**2, {}
    for name, scale, penalty, gap in (("0.9 L/c, no compliance", 0.9, RIGID, 0.0), ("0.9 L/c, default", 0.9, DEFAULT, 1.0e-4),
                                      ("0.5 L/c, no compliance", 0.5, RIGID, 1.0e-4),
                                      ("0.995 L/c, no compliance", 0.995, RIGID, 1.0e-3),
                                      ("0.995 L/c, default", 0.995, DEFAULT, 1.0e-3)):
        result = run.program(bars(scale, penalty, gap))
        table, slave = result.table("glstat"), result.table("rcforc").where(side="slave")
        forces[name] = slave["fx"]
        kept = (table["kinetic"] + table["internal"] + table["hourglass"])[-1] / energy
        run.check(f"bars, {name}: energy kept", kept, 1.0 - 0.25 / N)
        check_plateau(run, f"bars, {name}", result, 0.5)
        run.check(f"bars, {name}: impulse", trapezoid(np.abs(slave["fx"]), slave["time"]),
                  result.table("matsum").where(part=2)["momentum_x"][-1])
    other = run.program(bars(0.9, RIGID, 0.0, outlines=True)).table("rcforc").where(side="slave")["fx"]
    run.check("bars: whole outlines against open chains, force",
              np.abs(other - forces["0.9 L/c, no compliance"]).max() / np.abs(other).max(), 0.0)
    result = run.program(bars(0.995, RIGID, 1.0e-3, (40, 1), 3.0 * YOUNG))
    check_momentum(run, "unlike bars", result)
    slave, master = (result.table("rcforc").where(side=side)["fx"] for side in ("slave", "master"))
    run.check("unlike bars: force of both sides / largest", np.abs(slave + master).max() / np.abs(slave).max(), 0.0)


def check_plateau(run, name, result, share):
    mean, deviation = plateau(result.table("rcforc").where(side="slave"), share)
    run.check(f"{name}: force / plateau", mean, 1.0)
    run.check(f"{name}: rms of the force about it", deviation, 0.0)
    run.check(f"{name}: energy ratio", result.table("glstat")["energy_ratio"][-1], 1.0)


def check_held(run):
    for name, scale, penalty, led in (("held", 0.9, RIGID, False), ("held", 0.995, DEFAULT, False), ("led", 0.9, DEFAULT, True),
                                      ("led", 0.995, RIGID, True)):
        result = run.program(bar_at_wall(scale, penalty, led))
        check_plateau(run, f"bar and {name} element, {scale} L/c, PEN {penalty:g}", result, 1.0)


def check_rigid(run):
    impedance = RHO * SOUND * HEIGHT
    for penalty, rows, held, exchanged in ((RIGID, (1, 1), True, False), (DEFAULT, (2, 5), True, True), (RIGID, (1, 3), True, True),
                                           (RIGID, (1, 1), False, False), (DEFAULT, (2, 5), False, True),
                                           (RIGID, (3, 1), False, False), (RIGID, (1, 3), False, True)):
        result = run.program(rigid_body(penalty, rows, held, exchanged))
        force = result.table("rcforc").where(side="slave")
        name = (f"{'held' if held else 'free'} body, elements {rows[0]}/{rows[1]}, "
                f"{'slave' if exchanged else 'master'}, PEN {penalty:g}")
        decay = 0.0 if held else impedance / (RHO * 0.2 * HEIGHT)
        expected = impedance * SPEED * np.exp(-decay * force["time"])
        inside = (force["time"] > 0.1 * LENGTH / SOUND) & (force["time"] < 1.4 * LENGTH / SOUND)
        off = np.sqrt(np.mean((np.abs(force["fx"]) - expected)[inside]**2)) / impedance / SPEED
        run.check(f"{name}: force / (rho c v), rms of the difference", off, 0.0)
        run.check(f"{name}: energy ratio", result.table("glstat")["energy_ratio"][-1], 1.0)
        if not held:
            check_momentum(run, name, result)
    # No row moves a bar that is held: the body alone does, and the end of the bar stops it.
    deck = rigid_body(RIGID, (1, 1), False, False).fix(range(1, 2 * (N + 1) + 1), x=1, y=1)
    kinetic = run.program(deck).table("glstat")["kinetic"]
    run.check("free body, bar held, PEN -1: kinetic energy / initial", kinetic[-1] / kinetic[0], 0.0)


def check(run):
    check_bars(run)
    check_held(run)
    check_rigid(run)
