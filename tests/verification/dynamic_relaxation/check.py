# SPDX-License-Identifier: MIT
"""Dynamic relaxation: a column under its weight comes to its static solution before time zero."""
import numpy as np

from meshes import Deck, grid

RHO, YOUNG, POISSON = 1000.0, 1.0e6, 0.25
MODULUS = 1.2 * YOUNG
LENGTH, N = 2.0, 8
WEIGHT = 0.01  # small, so that the strain is small


def column(title, phase, card=None, points=None):
    """A column that is held sideways, its weight by a curve of a phase."""
    deck = Deck(title)
    deck.add("*CONTROL_TERMINATION", (0.5,)).add("*CONTROL_TIMESTEP", (0.0, 0.9)).hourglass(4, 0.1)
    deck.part(points=points).elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(*grid(1, N, LENGTH / N, LENGTH))
    deck.fix(nodes, x=1).fix(nodes[:2], y=1)
    deck.add("*DEFINE_CURVE", (1, phase), (0.0, WEIGHT), (1.0e3, WEIGHT)).add("*LOAD_BODY_Y", (1, 1.0))
    if card is not None:
        deck.add("*CONTROL_DYNAMIC_RELAXATION", card)
    deck.output(plot=0.5, glstat=0.01, nodout=0.01, nodes=nodes)
    return deck, nodes


def settled(nodes):
    """Static displacement of the nodes, exact for linear elements with lumped masses."""
    y = np.repeat(LENGTH * np.arange(N + 1) / N, 2)
    return -RHO * WEIGHT / MODULUS * (LENGTH * y - 0.5 * y ** 2)


def first(result, nodes, name):
    return np.array([result.node(int(node))[name][0] for node in nodes])


def check_bent(run):
    """Bent by its weight under viscous hourglass control, whose work before time zero is not of the run."""
    deck = Deck("bent")
    deck.add("*CONTROL_TERMINATION", (0.05,)).add("*CONTROL_TIMESTEP", (0.0, 0.9)).hourglass(1, 0.1)
    deck.part().elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(*grid(4, 8, 1.0, LENGTH))
    deck.fix(nodes[:5], x=1, y=1)
    deck.add("*DEFINE_CURVE", (1, 2), (0.0, WEIGHT), (1.0e3, WEIGHT)).add("*LOAD_BODY_X", (1, 1.0))
    deck.add("*CONTROL_DYNAMIC_RELAXATION", (50, 1e-6))
    table = run.program(deck.output(glstat=0.01)).table("glstat")
    run.check("bent: hourglass energy at time zero, viscous form", table["hourglass"][0], 0.0)
    run.check("bent: internal energy is there", table["internal"][0], 1e-5)


def check(run):
    for name, points in (("one point", None), ("four points", 4)):
        deck, nodes = column(f"weight in both phases, {name}", 2, (50, 1e-9), points)
        result = run.program(deck)
        table = result.table("glstat")
        run.check(f"{name}: displacement at time zero", first(result, nodes, "uy"), settled(nodes))
        run.check(f"{name}: velocity at time zero", first(result, nodes, "vy"), 0.0)
        stress = result.cells("stress")[0][:, 1]
        middle = LENGTH * (np.arange(N) + 0.5) / N
        run.check(f"{name}: stress at time zero", stress, -RHO * WEIGHT * (LENGTH - middle))
        energy = 0.5 * (RHO * WEIGHT) ** 2 * LENGTH ** 3 / 3.0 / MODULUS * LENGTH / N * (1.0 - 1.0 / (4.0 * N ** 2))
        run.check(f"{name}: internal energy at time zero", table["internal"][0], energy)
        run.check(f"{name}: it stays at rest", np.max(table["kinetic"]), 1e-3 * energy)
        log = (result.folder / f"{result.job}.log").read_text()
        run.true(f"{name}: the log tells of it", "dynamic relaxation: " in log)
    # a weight of relaxation alone: the column springs up, its energy is that of time zero
    deck, nodes = column("weight that is taken away", 1, (50, 1e-9))
    result = run.program(deck)
    table, top = result.table("glstat"), result.node(int(nodes[-1]))
    run.check("released: first acceleration of the top", top["ay"][0], WEIGHT)
    run.check("released: balance", table["energy_ratio"], 1.0)
    run.check("released: it swings to the other side", np.max(top["uy"]) / -settled(nodes)[-1], 0.9)
    check_bent(run)
    # a weight of the run alone, and IDRFLG -999, change nothing
    plain, _ = column("plain", 0)
    never, _ = column("plain", 2, (50, 1e-9, None, None, None, None, None, -999))
    texts = [run.program(deck).csv_path("nodout").read_text() for deck in (plain, never)]
    run.true("without the phase the bits are the same", texts[0] == texts[1])
    deck, nodes = column("asked for without a curve", 0, (50, 1e-9, None, 0.02, None, None, None, 1))
    result = run.program(deck)
    run.check("weight of the run alone: nothing at time zero", first(result, nodes, "uy"), 0.0)
