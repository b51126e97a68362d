# SPDX-License-Identifier: MIT
"""NAFEMS: a cylinder on a block, with friction and without."""
import numpy as np

from contact_types import TYPES
from meshes import Deck
import hertz_line
from slideline_tools.scenes.hertz import graded

#: mm, N, MPa, t; of the half model.
RADIUS, WIDTH, HEIGHT, LOAD = 50.0, 100.0, 200.0, 35.0e3 / 2.0
STEEL, ALUMINIUM = {"young": 210.0e3, "poisson": 0.3}, {"young": 70.0e3, "poisson": 0.3}
FRICTION = 0.1
#: N/mm^3, and how deep the two overlap at the start, so that slave nodes beside the middle touch too.
PENALTY, OVERLAP = 1.0e6, 5.0e-3
#: Widths of cells near the contact, which is 6.2 mm wide; there are even ones up to EVEN.
BLOCK_CELL, CYLINDER_CELL, EVEN = 1.0, 1.0 / 1.2, 8.0
#: Types that go without friction too.
SMOOTH = (7,)
#: Of the two programs, with friction.
REPORTED = (-1.3011, -1.3026)


def lines(cell, even, end, cells):
    """From 0 to `end`: even cells up to `even`, then growing ones."""
    n = round(even / cell)
    return np.concatenate([cell * np.arange(n + 1), graded(n * cell, end, cell, cells, 1)[1:]])


def add_body(deck, x, y, part, shape):
    """A grid; its node numbers, x by y."""
    points = shape(*np.meshgrid(x, y, indexing="ij"))
    n, m = len(x), len(y)
    quads = [(i * m + j, (i + 1) * m + j, (i + 1) * m + j + 1, i * m + j + 1) for i in range(n - 1) for j in range(m - 1)]
    return deck.mesh(np.stack(points, axis=-1).reshape(-1, 2), quads, part=part).reshape(n, m)


def round_foot(x, height):
    """The lower part of the cylinder, cut at its middle."""
    arc = x ** 2 / (RADIUS + np.sqrt(RADIUS ** 2 - x ** 2))
    return x, arc + height / RADIUS * (RADIUS - arc) - OVERLAP


def cylinder_on_block(kind, friction):
    """(deck, slave nodes, the node of the block in the middle of its top)."""
    deck = Deck("cylinder on a block")
    deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 0.5))
    deck.add("*CONTROL_IMPLICIT_AUTO", (1, 11, 5, 0.0, 0.5))
    deck.part(1, points=4).elastic(2.7e-9, *ALUMINIUM.values(), 1).part(2).elastic(7.85e-9, *STEEL.values(), 2)
    block = add_body(deck, lines(BLOCK_CELL, EVEN, WIDTH, 24), -lines(BLOCK_CELL, 4.0, HEIGHT, 24)[::-1], 1, lambda x, y: (x, y))
    x = lines(CYLINDER_CELL, EVEN, 0.6 * RADIUS, 6)
    cylinder = add_body(deck, x, lines(CYLINDER_CELL, 4.0, RADIUS, 8), 2, round_foot)
    foot = cylinder[:round(EVEN / CYLINDER_CELL) + 2, 0]
    deck.node_set(1, foot).node_set(2, block[:round(EVEN / BLOCK_CELL) + 2, -1][::-1])
    deck.fix(block[:, 0], y=1).fix(block[0], x=1).fix(cylinder[0], x=1)
    deck.curve(1, [(0.0, 0.0), (1.0, 1.0)])
    shares = np.gradient(np.pad(x, 1, mode="edge"))[1:-1] / x[-1]
    deck.add("*LOAD_NODE_POINT", *[(int(node), 2, 1, -LOAD * share) for node, share in zip(cylinder[:, -1], shares)])
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, PENALTY / (2.0 if kind == 3 else 1.0), friction), (0.0, 1.0e20, 1))
    return deck.output(plot=1.0, glstat=1.0, rcforc=1.0, nodout=1.0, nodes=[int(block[0, -1])]), foot, int(block[0, -1])


def answer(run, kind, friction):
    """(sink of the block's top, profile of the pressures of both halves, result)."""
    deck, foot, middle = cylinder_on_block(kind, friction)
    result = run.program(deck)
    rows = result.table("contact")
    rows = rows.where(time=rows["time"].max())
    x, length, pressure = (rows[key][np.isin(rows["node"], foot)] for key in ("x", "length", "pressure"))
    profile = hertz_line.measure(np.concatenate([-x, x]), np.tile(length, 2), np.tile(pressure, 2))
    return result.node(middle)["uy"][-1], profile, result


def check(run):
    half_width, peak = hertz_line.hertz(2.0 * LOAD, RADIUS, hertz_line.effective_modulus(STEEL, ALUMINIUM))
    for kind, name in TYPES.items():
        sink, _, result = answer(run, kind, FRICTION)
        run.check(f"{name}, mu {FRICTION:g}: sink of the block's top", sink, np.mean(REPORTED))
        if kind in SMOOTH:
            smooth, profile, _ = answer(run, kind, 0.0)
            run.check(f"{name}, mu 0: half width", profile.half_width, half_width)
            run.check(f"{name}, mu 0: largest pressure", profile.peak, peak)
            run.report(f"{name}: what friction takes off the sink, of it", 1.0 - sink / smooth)
        run.check(f"{name}: load", result.table("rcforc").where(side="slave")["fy"][-1], LOAD)
        energies = result.table("glstat")
        run.check(f"{name}: total / external work", energies["total"][-1] / energies["external_work"][-1], 1.0)
        run.check(f"{name}: friction dissipates", energies["friction"][-1], 0.0, scale=energies["external_work"][-1])
