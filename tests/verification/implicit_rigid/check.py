# SPDX-License-Identifier: MIT
"""Rigid bodies in contact whose springs push by the gaps of the end of the step (PUNIT 4)."""
import numpy as np

from meshes import Deck, grid

RHO, YOUNG, LENGTH, SPEED, N = 1000.0, 1.0e6, 1.0, 0.1, 50
SOUND = np.sqrt(YOUNG / RHO)
RIGID, DEFAULT = -1.0, 0.0        # PEN with PUNIT 4: no compliance, ten times K L/A
STEP = 1.0e-9                     # every cycle


def scene(penalty, sizes, held, exchanged, scale=0.9):
    """A rigid block of the size of an element column runs into a bar, or a bar into it where it is held."""
    height = LENGTH / N
    deck = Deck("rigid body and bar").control(1.5 * LENGTH / SOUND, scale=scale).hourglass(4, 0.1)
    deck.part(1).part(2).elastic(RHO, YOUNG, 0.0, 1)
    deck.add("*MAT_RIGID", (2, RHO, YOUNG, 0.0), (1.0, 7, 7) if held else (1.0, 0, 0))
    bar = deck.mesh(*grid(N, sizes[0], LENGTH, height), part=1)
    body = deck.mesh(*grid(10, sizes[1], 0.2, height, (-0.2, 0.0)), part=2)
    if held:
        deck.node_set(3, bar).add("*INITIAL_VELOCITY", (3,), (-SPEED, 0.0))
    else:
        deck.node_set(3, body).add("*INITIAL_VELOCITY", (3,), (SPEED, 0.0))
    deck.node_set(1, bar[::N + 1][::-1]).node_set(2, body[10::11])
    return deck.contact(*((2, 1) if exchanged else (1, 2)), 7, penalty, 4).output(glstat=STEP, rcforc=STEP, matsum=STEP)


def born(rigid, exchanged, step, birth):
    """A block that lies 8 mm deep in a body when contact is born: rigid and free, or like the body below."""
    depth = 8.0e-3
    deck = Deck("born in an overlap").control(birth + 50 * step, dt=step).hourglass(4, 0.1)
    deck.part(1).elastic(RHO, YOUNG, 0.3, 1).part(2)
    if rigid:
        deck.add("*MAT_RIGID", (2, RHO, YOUNG, 0.0), (1.0, 0, 0))
    else:
        deck.elastic(RHO, YOUNG, 0.3, 2)
    body = deck.mesh(*grid(20, 20), part=1)
    block = deck.mesh(*grid(10, 5, 0.4, 0.2, (0.3, 1.0 - depth + birth)), part=2)
    deck.fix(body[:21], x=1, y=1).node_set(3, block).add("*INITIAL_VELOCITY", (3,), (0.0, -1.0))
    deck.node_set(1, block[:11]).node_set(2, body[-21:][::-1])
    slave, master = (2, 1) if exchanged else (1, 2)
    deck.add("*CONTACT_2D_SLIDELINE", (-slave, -master, 7, 2, RIGID), (birth - 0.5 * step, 1.0e20, 4))
    return deck.output(glstat=step, plot=step)


def check_born(run):
    """Without compliance a tenth of an overlap is taken back in a step, whoever is rigid: all at once is a blow, which made 13
    times as much energy and a ratio of 1.18."""
    step, birth = 5.0e-4, 2.0e-2
    for rigid, exchanged in ((True, False), (True, True), (False, False)):
        result = run.program(born(rigid, exchanged, step, birth))
        name = f"born in an overlap, {('rigid ' if rigid else 'like ') + ('master' if exchanged else 'slave')}"
        table = result.table("contact")
        depth = np.array([-table["gap"][np.isclose(table["time"], birth + k * step)].min() for k in range(9)])
        run.check(f"{name}: what a step leaves of it", depth[1:] / depth[:-1], 0.9, 1.0e-2, source="a tenth is taken back")
        run.check(f"{name}: energy ratio", result.table("glstat")["energy_ratio"], 1.0, 3.0e-3)


def check(run):
    check_born(run)
    height = LENGTH / N
    for penalty, sizes, held, exchanged in ((RIGID, (1, 1), True, False), (DEFAULT, (2, 5), True, True), (RIGID, (1, 3), True, True),
                                            (RIGID, (1, 1), False, False), (DEFAULT, (2, 5), False, True), (RIGID, (3, 1), False, False), (RIGID, (1, 3), False, True)):
        result = run.program(scene(penalty, sizes, held, exchanged))
        force, table, parts = result.table("rcforc").where(side="slave"), result.table("glstat"), result.table("matsum")
        name = f"{'held' if held else 'free'} body, elements {sizes[0]}/{sizes[1]}, {'slave' if exchanged else 'master'}, PEN {penalty:g}"
        impedance = RHO * SOUND * height
        decay = 0.0 if held else impedance / (RHO * 0.2 * height)
        expected = impedance * SPEED * np.exp(-decay * force["time"])
        inside = (force["time"] > 0.1 * LENGTH / SOUND) & (force["time"] < 1.4 * LENGTH / SOUND)
        run.check(f"{name}: force / (rho c v), rms of the difference", np.sqrt(np.mean((np.abs(force["fx"]) - expected)[inside]**2)) / impedance / SPEED,
                  0.0, 4.0e-3 if penalty == RIGID else 1.0e-2, "abs", "Z v exp(-Z t/M)")
        run.check(f"{name}: energy ratio", table["energy_ratio"][-1], 1.0, 1.0e-4)
        if not held:
            total = sum(parts.where(part=part)["momentum_x"] for part in (1, 2))
            run.check(f"{name}: momentum / initial", np.ptp(total) / total[0], 0.0, 1.0e-12, "abs")

    # No row moves a bar that is held: the body alone does, and the end of the bar stops it.
    kinetic = run.program(scene(RIGID, (1, 1), False, False).fix(range(1, 2 * (N + 1) + 1), x=1, y=1)).table("glstat")["kinetic"]
    run.check("free body, bar held, PEN -1: kinetic energy / initial", kinetic[-1] / kinetic[0], 0.0, 1.0e-2, "abs", "stopped")
