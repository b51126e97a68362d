# SPDX-License-Identifier: MIT
"""Taylor bar: series of meshes, and friction on a rigid wall and on a rigid body by every contact type."""
import pathlib

import numpy as np

from contact_types import TYPES
from meshes import Deck, grid

LENGTH, RADIUS, SPEED, END = 32.4e-3, 3.2e-3, 227.0, 80.0e-6
DENSITY, YOUNG, POISSON, YIELD, HARDENING = 8930.0, 117.0e9, 0.35, 400.0e6, 100.0e6
FRICTION, PENALTY = 0.25, 4.0e14   # N/m^3 with PUNIT 1
#: Radius and length in mm, plastic strain: `independent.py 5 50 MU free`.
INDEPENDENT = {0.0: (7.2182, 21.5266, 3.2531), FRICTION: (6.0999, 21.8424, 1.9350)}
#: Radius of the impact end and length over time by tetrahedra of another program (README.md).
PUBLISHED = np.genfromtxt(pathlib.Path(__file__).with_name("published.csv"), delimiter=",", names=True)


def bar(columns, rows):
    """The deck without what is below, ids and quads."""
    deck = Deck("Taylor bar")
    deck.control(END).hourglass(1, 0.1)
    deck.add("*PART", "rod", (1, 1, 1)).add("*SECTION_SHELL", (1, 15), (1.0,))
    deck.plastic(DENSITY, YOUNG, POISSON, YIELD, YOUNG * HARDENING / (YOUNG + HARDENING))
    coordinates, quads = grid(columns, rows, RADIUS, LENGTH)
    ids = deck.mesh(coordinates, quads)
    deck.node_set(1, ids).add("*INITIAL_VELOCITY", (1,), (0.0, -SPEED))
    deck.output(plot=END / 4, glstat=END / 100, nodout=END / 200, nodes=[ids[columns], ids[-1]])
    return deck, ids, coordinates, np.array(quads)


def held(columns, rows):
    """The impact end stays on the wall, without friction."""
    deck, ids, *rest = bar(columns, rows)
    return deck.fix(ids[:columns + 1], y=1), ids, *rest


def on_wall(columns, rows, friction):
    """A rigid wall that only pushes."""
    deck, *rest = bar(columns, rows)
    deck.add("*RIGIDWALL_PLANAR", (0,), (0.0, 0.0, 0.0, 0.0, 1.0, 0.0, friction)).add("*DATABASE_RWFORC", (END / 100,))
    return deck, *rest


def on_body(columns, rows, kind, friction):
    """A rigid body that stands still, of coarser segments, in contact."""
    deck, ids, *rest = bar(columns, rows)
    deck.add("*PART", "anvil", (2, 1, 2)).add("*MAT_RIGID", (2, DENSITY, YOUNG, POISSON), (1, 7, 7))
    coordinates, quads = grid(int(1.3 * columns) * 3, 2, 3.0 * RADIUS, 2.0e-3, (0.0, -2.0e-3))
    anvil = deck.mesh(coordinates, quads, part=2).reshape(3, -1)
    side = ids.reshape(rows + 1, columns + 1)[:rows // 4 + 1, -1]
    deck.node_set(2, [*ids[:columns + 1], *side[1:]]).node_set(3, anvil[-1, ::-1])
    # Springs of both passes of type 3 act together: half each, else the step is more than the stable one.
    penalty = PENALTY / 2.0 if kind == 3 else PENALTY
    deck.add("*CONTACT_2D_SLIDELINE", (-2, -3, kind, 4, penalty, friction), (0.0, 1.0e20, 1))
    return deck.add("*DATABASE_RCFORC", (END / 100,)), ids, *rest


def volumes(places, quads):
    """Volume per radian of each quad by Green's theorem."""
    sides = [(places[quads[:, k]], places[quads[:, (k + 1) % 4]]) for k in range(4)]
    return sum((b[:, 1] - a[:, 1]) * (a[:, 0] ** 2 + a[:, 0] * b[:, 0] + b[:, 0] ** 2) / 6.0 for a, b in sides)


class Outcome:
    """Radius of the impact end, length, plastic strain, histories and energies of one run; mm."""

    def __init__(self, run, name, made):
        deck, ids, coordinates, quads = made
        self.name, self.nodes, n = name, ids, len(ids)
        self.result = result = run.program(deck, name="".join(c if c.isalnum() else "_" for c in name))
        places = result.points("Points")[:, :n, :2]
        self.radius, self.length = 1e3 * places[-1, :, 0].max(), 1e3 * (places[-1, -1, 1] - places[-1, :, 1].min())
        self.strain = result.cells("plastic_strain")[-1][:len(quads)].max()
        self.volume = np.abs(volumes(places[-1], quads) / volumes(coordinates, quads) - 1.0).max()
        self.energy = result.table("glstat")
        self.edge = 1e3 * (places[-1, :, 1][np.argmax(places[-1, :, 0])])

    def check(self, run):
        """What every run must keep."""
        run.check(f"{self.name}: volume of every element", self.volume, 0.0)
        run.check(f"{self.name}: energy ratio", self.energy["energy_ratio"],
                  np.ones_like(self.energy["time"]))
        return self

    def figures(self):
        return (("radius, mm", self.radius), ("length, mm", self.length), ("largest plastic strain", self.strain))

    def report(self, run):
        for what, value in self.figures():
            run.report(f"{self.name}: {what}", value)
        return self


def off_history(outcome, columns):
    """Largest differences of radius and length to the published history, mm."""
    edge, end = (outcome.result.node(outcome.nodes[k]) for k in (columns, -1))
    time = np.minimum(1e-6 * PUBLISHED["time_us"], END)
    return (np.abs(1e3 * np.interp(time, edge["time"], edge["x"]) - PUBLISHED["radius_mm"]).max(),
            np.abs(1e3 * np.interp(time, end["time"], end["y"]) - PUBLISHED["length_mm"]).max())


def check_series(run):
    """Twice as fine, half as far from converged codes at least, at the end and over time."""
    coarse, usual = (Outcome(run, f"{n} x {10 * n} quads", held(n, 10 * n)).check(run).report(run) for n in (5, 10))
    for what, value, before, low, high in (("radius", usual.radius, coarse.radius, 7.22, 7.24),
                                           ("length", usual.length, coarse.length, 21.42, 21.43)):
        near = min(max(value, low), high)
        run.check(f"{what}: difference to converged codes, 10 x 100 over 5 x 50 quads",
                  abs(value - near) / abs(before - min(max(before, low), high)), 0.5)
    for what, before, value in zip(("radius", "length"), off_history(coarse, 5), off_history(usual, 10)):
        run.check(f"{what} over time: largest difference to tetrahedra, mm, 10 x 100 quads", value,
                  0.0)
        run.check(f"{what} over time: difference to tetrahedra, 10 x 100 over 5 x 50 quads",
                  value / before, 0.5)


def check_friction(run):
    """On a rigid wall against another program, then in contact with a rigid body by every type."""
    slips = {}
    for friction, known in INDEPENDENT.items():
        wall = Outcome(run, f"wall, mu {friction}", on_wall(5, 50, friction)).check(run)
        slips[friction] = wall
        for (what, value), expected in zip(wall.figures(), known):
            run.check(f"{wall.name}: {what}", value, expected)
    force = slips[FRICTION].result.table("rwforc")
    run.true(f"wall, mu {FRICTION}: friction at most mu times the normal force",
             np.all(np.abs(force["tangential_force"]) <= FRICTION * force["normal_force"] * (1.0 + 1e-12) + 1e-9))
    for kind in TYPES:
        for friction, wall in slips.items():
            body = Outcome(run, f"{TYPES[kind]}, mu {friction}", on_body(5, 50, kind, friction)).check(run)
            for (what, value), (_, expected) in zip(body.figures(), wall.figures()):
                run.check(f"{body.name}: {what}", value, expected)


def check(run):
    check_series(run)
    check_friction(run)
