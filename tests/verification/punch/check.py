# SPDX-License-Identifier: MIT
"""A punch with a rounded edge on a foundation (NAFEMS), without and with friction, all contact types."""
import numpy as np

from contact_types import TYPES
from meshes import Deck, grid_quads
from slideline_tools.scenes.hertz import graded

# mm, MPa; the density makes a wave run 100 mm in 1 in the punch.
STEEL, SOFT, POISSON, PRESSURE = 210.0e3, 70.0e3, 0.3, 100.0
DENSITY = STEEL / 1.0e4
EDGE, FILLET, HEIGHT, DEPTH, WIDTH = 50.0, 10.0, 100.0, 200.0, 100.0
PENALTY, FRICTION = 1.0e6, 0.1   # N/mm^3
RISE, END = 20.0, 46.0
FEW = (7,)   # types without friction too, where not in full
RUBBED = (1, 3, 5, 7)   # types with friction, where not in full; hertz_impact has the others
#: Sink of the axis in mm and axial stress there in MPa: `independent.py`, and what is published of the benchmark.
INDEPENDENT = {0.0: (-0.1333, -87.5), FRICTION: (-0.1311, -88.9)}
REPORTED = {0.0: ((-0.1329, -0.1307), (-94.0, -91.0)), FRICTION: ((-0.1286, -0.1286), (-88.7, -88.7))}


def down(cell, size, cells):
    """Distances from the contact: three even cells, then growing ones."""
    return np.concatenate([cell * np.arange(3), graded(2.0 * cell, size, cell, cells, 1)[1:]])


def punch(kind, friction):
    deck = Deck(f"punch, type {kind}, friction {friction}")
    deck.control(END, dt=0.0012).hourglass(4, 0.05)
    deck.add("*SECTION_SHELL", (1, 15), (1.0,))
    for part, young in ((1, STEEL), (2, SOFT)):
        deck.part(part, section=1).elastic(DENSITY, young, POISSON, part)
    # The foot: flat to 40, then the fillet by its angle; fine where the contact ends.
    flat = (EDGE - FILLET) - graded(1.2, EDGE - FILLET, 1.0, 12, 1)[::-1]
    arc = np.concatenate([np.radians(4.0) * np.arange(4), graded(np.radians(12.0), np.pi / 2, np.radians(4.0), 7, 1)[1:]])
    r = np.concatenate([flat - flat[0], EDGE - FILLET + FILLET * np.sin(arc)])
    foot = np.concatenate([np.zeros(len(flat)), FILLET * (1.0 - np.cos(arc))])
    z = down(1.2, HEIGHT, 14)
    upper = np.array([(x, rise + depth * (1.0 - rise / HEIGHT)) for depth in z for x, rise in zip(r, foot)])
    high = deck.mesh(upper, grid_quads(len(r) - 1, len(z) - 1), part=1).reshape(len(z), len(r))
    inner = np.concatenate([(41.0 - graded(1.5, 41.0, 1.1, 11, 1)[::-1]), 41.0 + 1.1 * np.arange(4)])
    x = np.concatenate([inner - inner[0], graded(inner[-1], WIDTH, 1.1, 12, 1)[1:]])
    z = down(1.1, DEPTH, 16)
    lower = np.array([(a, -b) for b in z[::-1] for a in x])
    low = deck.mesh(lower, grid_quads(len(x) - 1, len(z) - 1), part=2).reshape(len(z), len(x))
    reach = len(flat) + 6
    deck.node_set(1, high[0, :reach]).node_set(2, low[-1, :int(np.searchsorted(x, 48.0)) + 1][::-1])
    deck.fix(low[0], x=1, y=1)
    share = np.linspace(0.0, 1.0, 31)
    deck.curve(1, [*((RISE * s, s - np.sin(2.0 * np.pi * s) / (2.0 * np.pi)) for s in share), (1.0e3, 1.0)])
    deck.add("*LOAD_SEGMENT", *[(1, PRESSURE, 0.0, int(b), int(a), int(a), int(a))
                                for a, b in zip(high[-1], high[-1, 1:])])
    deck.add("*DAMPING_GLOBAL", (0, 0.6))
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, PENALTY, friction), (0.0, 1.0e20, 1))
    return deck.output(plot=END, glstat=END / 20, rcforc=END / 20), high, low, r


def check_punch(run, kind, friction):
    deck, high, low, r = punch(kind, friction)
    result = run.program(deck)
    name = f"{TYPES[kind]}, mu {friction}"
    energy = result.table("glstat")
    move, stress = result.points("displacement")[-1], result.cells("stress")[-1]
    force = result.table("rcforc").where(side="slave")["fy"][-1]
    run.check(f"{name}: kinetic / internal energy", energy["kinetic"][-1] / energy["internal"][-1],
              0.0)
    run.check(f"{name}: contact force per radian", force, 0.5 * PRESSURE * EDGE ** 2)
    below = (high.shape[0] - 1) * (high.shape[1] - 1) + (low.shape[0] - 2) * (low.shape[1] - 1)
    sink, axial = move[low[-1, 0] - 1, 1], 0.5 * (stress[0, 1] + stress[below, 1])
    run.check(f"{name}: sink of the axis, mm", sink, INDEPENDENT[friction][0])
    run.check(f"{name}: axial stress on the axis, mean of both sides, MPa", axial,
              INDEPENDENT[friction][1])
    for what, value, (low_end, high_end) in zip(("sink", "axial stress"), (sink, axial), REPORTED[friction]):
        nearest = min(max(value, low_end), high_end)
        run.report(f"{name}: {what} over the nearest reported", value / nearest, f"{low_end:g} to {high_end:g}")
    return sink


def check(run):
    for kind in TYPES if run.is_full else RUBBED:
        rubbed = check_punch(run, kind, FRICTION)
        if not run.is_full and kind not in FEW:
            continue
        free = check_punch(run, kind, 0.0)
        run.check(f"{TYPES[kind]}: what friction takes off the sink, mm", rubbed - free,
                  INDEPENDENT[FRICTION][0] - INDEPENDENT[0.0][0])
