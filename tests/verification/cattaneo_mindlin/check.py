# SPDX-License-Identifier: MIT
"""Cattaneo (1938) and Mindlin (1949): a cylinder that is pressed on a block of the same material, then drawn aside and back."""
import pathlib
import sys

import numpy as np

from contact_types import TYPES
from meshes import Deck

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "tools"))

from slideline_tools.scenes.hertz import GRADED_CELLS, PENALTY, RADIUS, hertz_grids  # noqa: E402

YOUNG, POISSON, RHO = 2.1e11, 0.3, 7850.0
FRICTION, DOWN = 0.3, 3.0e-5
LEVEL = 2
#: Ways of the cut aside, m, at the times 1, 2, ...; each is held for half a unit of time, so that a state shows it.
ASIDE = (0.0, 4.0e-6, 8.0e-6, 1.2e-5, 4.0e-6)
#: Types where not in full: 1 and 2, and 6 and 7, differ in the third digit; friction_calculix has the cylinder for 2 and 5.
FEW = (7,)
HOLD = 0.25
#: A node slips where its traction is more than this of mu p: while the way is held nothing slips, but tractions stay.
SLIPS = 0.999
MODULUS = YOUNG / (1.0 - POISSON ** 2) / 2.0


def way_aside():
    """The curve of the way aside: points (time, m)."""
    return [(0.0, 0.0)] + [(1.0 + k + late, way) for k, way in enumerate(ASIDE) for late in (0.0, HOLD)]


def rolled(kind, level=LEVEL):
    """Static: down within 1 s, then aside and back; (deck, slave nodes)."""
    deck = Deck(f"Cattaneo and Mindlin, type {kind}")
    end = way_aside()[-1][0]
    deck.add("*CONTROL_TERMINATION", (end,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 0.25))
    deck.add("*CONTROL_IMPLICIT_AUTO", (1, 11, 5, 0.0, 0.25))
    deck.part(1, points=4).elastic(RHO, YOUNG, POISSON, 1)
    ids = []
    for body in hertz_grids(level)[:2]:
        n, m = body.points.shape[:2]
        quads = [(i * m + j, (i + 1) * m + j, (i + 1) * m + j + 1, i * m + j + 1) for i in range(n - 1) for j in range(m - 1)]
        ids.append(deck.mesh(body.points.reshape(-1, 2), quads).reshape(n, m))
    block, cylinder = ids
    outside = GRADED_CELLS * level
    deck.node_set(1, cylinder[outside:-outside, 0]).node_set(2, block[outside:-outside, -1][::-1])
    deck.fix(block[:, 0], x=1, y=1)
    deck.curve(1, [(0.0, 0.0), (1.0, -DOWN), (9.0, -DOWN)]).curve(2, way_aside())
    for node in cylinder[:, -1]:
        deck.prescribe(node, 2, 2, 1).prescribe(node, 1, 2, 2)
    passes = 2.0 if kind == 3 else 1.0
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, PENALTY / passes, FRICTION))
    return deck.output(plot=HOLD, glstat=HOLD, rcforc=HOLD), cylinder[outside:-outside, 0]


def ellipse(x):
    return np.sqrt(np.maximum(0.0, 1.0 - x ** 2))


class Look:
    """Tractions of the slave nodes at one time, and the answer for the forces that they make."""

    def __init__(self, rows, slave, time, most):
        """`most`: the Look at the farthest way where the motion goes back, else None."""
        times = np.unique(rows["time"])
        now = rows.where(time=times[np.argmin(np.abs(times - time))])
        chosen = np.isin(now["node"], slave)
        x, pressure, traction, self.length = (now[key][chosen] for key in ("x", "pressure", "traction", "length"))
        self.traction = traction
        load, shear = np.sum(pressure * self.length), np.sum(traction * self.length)
        self.x = x - np.sum(x * pressure * self.length) / load
        self.share = shear / (FRICTION * load)
        self.a, self.cell = np.sqrt(4.0 * load * RADIUS / (np.pi * MODULUS)), np.median(self.length)
        self.stuck = self.x[np.abs(traction) < SLIPS * FRICTION * pressure]
        self.limit = FRICTION * 2.0 * load / (np.pi * self.a)
        self.exact, self.c = self.answer(most)

    def slip(self, share):
        """Traction and half width of the stick zone after `share` of mu P has come."""
        c = self.a * np.sqrt(1.0 - share)
        return self.limit * (ellipse(self.x / self.a) - c / self.a * ellipse(self.x / c)), c

    def answer(self, most):
        way = np.sign(self.share if most is None else most.share)
        if most is None:
            traction, c = self.slip(way * self.share)
            return way * traction, c
        first = self.slip(way * most.share)[0]
        back, c = self.slip(0.5 * way * (most.share - self.share))
        return way * (first - 2.0 * back), c

    def edges(self):
        """How far outside of c the outermost sticking nodes stand, in slave segments."""
        return np.array([self.stuck.max() - self.c, -self.stuck.min() - self.c]) / self.cell

    def error(self):
        """L2 of the traction."""
        return np.sqrt(np.sum((self.traction - self.exact) ** 2 * self.length) / np.sum(self.exact ** 2 * self.length))


def looks(result, slave):
    """(name, Look) on the way aside and on the way back."""
    rows = result.table("contact")
    farthest = int(np.argmax(ASIDE))
    found, most = [], None
    for k in range(1, len(ASIDE)):
        look = Look(rows, slave, 1.0 + k + HOLD, most)
        found.append((("" if most is None else "back to ") + f"Q/(mu P) = {abs(look.share):.2f}", look))
        if k == farthest:
            most = look
    return found


def check_answer(run, kind):
    deck, slave = rolled(kind)
    result = run.program(deck)
    for name, look in looks(result, slave):
        name = f"{TYPES[kind]}, {name}, h = a/{look.a / look.cell:.1f}"
        run.check(f"{name}: edges of the stick zone, slave segments", look.edges(), 0.0, 1.5, "abs",
                  "a sqrt(1 - Q/(mu P)), Cattaneo (1938), Mindlin and Deresiewicz (1953)")
        run.check(f"{name}: traction, L2", look.error(), 0.0, 0.2, "abs", "Cattaneo (1938), Mindlin and Deresiewicz (1953)")
    energies = result.table("glstat")
    run.check(f"{TYPES[kind]}: total / external work", energies["total"][-1] / energies["external_work"][-1], 1.0, 1e-3)


def check(run):
    for kind in TYPES if run.is_full else FEW:
        check_answer(run, kind)
