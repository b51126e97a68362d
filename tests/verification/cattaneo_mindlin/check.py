# SPDX-License-Identifier: MIT
"""Cattaneo (1938) and Mindlin (1949): a cylinder that is pressed on a block of the same material and then drawn aside."""
import pathlib
import sys

import numpy as np

from contact_types import TYPES
from meshes import Deck

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "tools"))

from slideline_tools.scenes.hertz import GRADED_CELLS, PENALTY, RADIUS, hertz_grids  # noqa: E402

YOUNG, POISSON, RHO = 2.1e11, 0.3, 7850.0
FRICTION, DOWN, STICKS = 0.3, 3.0e-5, 1
LEVEL = 2
#: Ways of the cut aside, m.
ASIDE = (4.0e-6, 8.0e-6, 1.2e-5)
MODULUS = YOUNG / (1.0 - POISSON ** 2) / 2.0


def rolled(kind, aside):
    """Static: down within 1 s, then aside within 2 s."""
    deck = Deck(f"Cattaneo and Mindlin, type {kind}")
    deck.add("*CONTROL_TERMINATION", (3.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 0.25)).add("*CONTROL_IMPLICIT_AUTO", (1,))
    deck.part(1, points=4).elastic(RHO, YOUNG, POISSON, 1)
    ids = []
    for body in hertz_grids(LEVEL)[:2]:
        n, m = body.points.shape[:2]
        quads = [(i * m + j, (i + 1) * m + j, (i + 1) * m + j + 1, i * m + j + 1) for i in range(n - 1) for j in range(m - 1)]
        ids.append(deck.mesh(body.points.reshape(-1, 2), quads).reshape(n, m))
    block, cylinder = ids
    outside = GRADED_CELLS * LEVEL
    deck.node_set(1, cylinder[outside:-outside, 0]).node_set(2, block[outside:-outside, -1][::-1])
    deck.fix(block[:, 0], x=1, y=1)
    deck.curve(1, [(0.0, 0.0), (1.0, -DOWN), (9.0, -DOWN)]).curve(2, [(0.0, 0.0), (1.0, 0.0), (3.0, aside)])
    for node in cylinder[:, -1]:
        deck.prescribe(node, 2, 2, 1).prescribe(node, 1, 2, 2)
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 2, PENALTY, FRICTION))
    return deck.output(plot=3.0, glstat=0.25, rcforc=0.25), cylinder[outside:-outside, 0]


def ellipse(x):
    return np.sqrt(np.maximum(0.0, 1.0 - x ** 2))


def check_answer(run, kind, aside):
    deck, slave = rolled(kind, aside)
    result = run.program(deck)
    rows = result.table("contact")
    rows = rows.where(time=rows["time"].max())
    chosen = np.isin(rows["node"], slave)
    x, pressure, traction, length, state = (rows[key][chosen] for key in ("x", "pressure", "traction", "length", "state"))
    load, shear = np.sum(pressure * length), np.sum(np.abs(traction) * length)
    x = x - np.sum(x * pressure * length) / load
    a = np.sqrt(4.0 * load * RADIUS / (np.pi * MODULUS))
    c = a * np.sqrt(1.0 - shear / (FRICTION * load))
    exact = FRICTION * 2.0 * load / (np.pi * a) * (ellipse(x / a) - c / a * ellipse(x / c))
    cell = np.median(length)
    name = f"{TYPES[kind]}, Q/(mu P) = {shear / (FRICTION * load):.2f}, h = a/{a / cell:.1f}"
    stuck = x[state == STICKS]
    run.check(f"{name}: edges of the stick zone / slave segment", np.array([stuck.max(), -stuck.min()]) / cell, c / cell, 1.5,
              "abs", "a sqrt(1 - Q/(mu P)), Cattaneo (1938)")
    run.check(f"{name}: traction, L2", np.sqrt(np.sum((np.abs(traction) - exact) ** 2 * length)
                                               / np.sum(exact ** 2 * length)), 0.0, 0.2, "abs", "Cattaneo (1938)")
    energies = result.table("glstat")
    run.check(f"{name}: total / external work", energies["total"][-1] / energies["external_work"][-1], 1.0, 1e-3)


def check(run):
    for kind in (2, 5, 7):
        for aside in ASIDE:
            check_answer(run, kind, aside)
