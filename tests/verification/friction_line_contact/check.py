# SPDX-License-Identifier: MIT
"""Cattaneo and Mindlin: a line contact is pressed, then sheared: stick zone and tractions, every type."""
import numpy as np

from contact_types import TYPES
from meshes import Deck, grid_quads

RHO, YOUNG, POISSON = 1.0e-6, 1.0, 0.3
#: Half width of the contact is about 1; a fine cell is a tenth of it.
RADIUS, APPROACH, FRICTION = 60.0, 0.0225, 0.3
CELL, REACH, SIZE = 0.1, 1.4, 8.0
PENALTY = 10.0 * YOUNG
UPPER = 1.13
MODULUS = YOUNG / (2.0 * (1.0 - POISSON ** 2))
#: A wave runs through a body; the ways down and sideways in it, and when to look.
UNIT = SIZE / np.sqrt(YOUNG / RHO)
DOWN = [(0.0, 0.0), (20.0, -APPROACH), (40.0, -APPROACH)]
SIDEWAYS = [(0.0, 0.0), (24.0, 0.0), (36.0, 0.0027), (44.0, 0.0027), (56.0, 0.0054), (64.0, 0.0054), (76.0, 0.0081),
            (84.0, 0.0081), (108.0, 0.0027), (116.0, 0.0027)]
LOOKS = (44.0, 64.0, 84.0, 116.0)
SLIPS = 0.9


def lines(cell, fine, size, growth=1.45):
    """From 0 to `size`: even cells up to `fine`, growing ones beyond."""
    places = list(np.arange(round(fine / cell) + 1) * cell)
    step = cell
    while places[-1] < size:
        step *= growth
        places.append(places[-1] + step)
    places = np.array(places)
    beyond = places > fine
    places[beyond] = fine + (places[beyond] - fine) * (size - fine) / (places[-1] - fine)
    return places


def mirrored(cell):
    """Grid lines in x, even near zero, and distances from the surface."""
    side = lines(cell, REACH, SIZE)
    return np.concatenate([-side[:0:-1], side]), lines(cell, 4 * cell, SIZE)


def smooth(points):
    """A curve through the points that starts and ends each piece at rest."""
    share = np.linspace(0.0, 1.0, 41)[:-1]
    rise = share - np.sin(2.0 * np.pi * share) / (2.0 * np.pi)
    pieces = [(UNIT * (t0 + share * (t1 - t0)), d0 + rise * (d1 - d0)) for (t0, d0), (t1, d1) in zip(points, points[1:])]
    return [*((t, d) for piece in pieces for t, d in zip(*piece)), (UNIT * points[-1][0], points[-1][1]),
            (1.0e6 * UNIT, points[-1][1])]


def line_contact(kind, share=1.0, refine=1, exchanged=False):
    """Two bodies of one material; the upper, round below, is pressed down and held, then moved sideways and back.
    `share`: TFAC; `refine` divides the cells."""
    deck = Deck(f"Cattaneo and Mindlin, type {kind}")
    deck.control(SIDEWAYS[-1][0] * UNIT, scale=0.55).hourglass(4, 0.05)
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, POISSON, part)
    x, depth = mirrored(CELL / refine)
    low = deck.mesh(np.array([(a, -b) for b in depth[::-1] for a in x]), grid_quads(len(x) - 1, len(depth) - 1), part=1)
    face = low[-len(x):][np.abs(x) < REACH + 1e-9]
    deck.fix(low[:len(x)], x=1, y=1)
    # The cells of the upper body are larger, so that few nodes meet.
    x, depth = mirrored(UPPER * CELL / refine)
    arc = x ** 2 / (2.0 * RADIUS)
    up = deck.mesh(np.array([(a, rise + b * (1.0 - rise / SIZE)) for b in depth for a, rise in zip(x, arc)]),
                   grid_quads(len(x) - 1, len(depth) - 1), part=2)
    foot = up[:len(x)][np.abs(x) < REACH + 1e-9]
    deck.node_set(1, foot).node_set(2, face[::-1]).node_set(3, up[-len(x):])
    deck.curve(1, smooth(DOWN)).curve(2, smooth(SIDEWAYS))
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", (3, 2, 2, 1, 1.0), (3, 1, 2, 2, 1.0))
    # About critical for the lowest mode: at rest when it is looked at.
    deck.add("*DAMPING_GLOBAL", (0, 1.2 / UNIT))
    passes = 2.0 if kind == 3 else 1.0
    deck.add("*CONTACT_2D_SLIDELINE", (*((-2, -1) if exchanged else (-1, -2)), kind, 3, PENALTY / passes, FRICTION),
             (0.0, 1.0e20, 1), (0.0, share))
    return deck.output(glstat=4.0 * UNIT, rcforc=4.0 * UNIT, plot=4.0 * UNIT)


def half_ellipse(x, half_width, slope):
    """slope sqrt(half_width^2 - x^2), zero outside: a pressure of Hertz has the slope p0/a."""
    return slope * np.sqrt(np.clip(half_width ** 2 - x ** 2, 0.0, None))


class Moment:
    """Forces and the rows of the slave nodes, from left to right, at one time."""

    def __init__(self, result, time):
        force = result.table("rcforc").where(side="slave")
        at = np.argmin(np.abs(force["time"] / UNIT - time))
        self.pressed, self.sheared = abs(force["fy"][at]), abs(force["fx"][at])
        rows = result.table("contact")
        times = np.unique(rows["time"])
        rows = rows.where(time=times[np.argmin(np.abs(times / UNIT - time))])
        order = np.argsort(rows["x"])
        self.x, self.length, self.pressure, traction = (rows[key][order] for key in ("x", "length", "pressure", "traction"))
        self.x = self.x - np.sum(self.x * self.pressure) / np.sum(self.pressure)
        self.traction = traction * np.sign(np.sum(traction))
        self.half_width = np.sqrt(4.0 * self.pressed * RADIUS / (np.pi * MODULUS))
        self.slope = 2.0 * self.pressed / (np.pi * self.half_width ** 2)

    def stick(self, lost):
        """Half width of the stick zone after the shear has changed by `lost` of its limit."""
        return self.half_width * np.sqrt(1.0 - lost)

    def slipped(self, stick):
        """Tractions of a half slip: mu (p of the contact - p of the stick zone)."""
        return FRICTION * (half_ellipse(self.x, self.half_width, self.slope) - half_ellipse(self.x, stick, self.slope))

    def edges(self, sign):
        """Where, going out from the middle, the traction comes to 0.9 mu p."""
        ratio = sign * self.traction / np.maximum(FRICTION * self.pressure, 1e-30)
        found, middle = [], np.argmin(np.abs(self.x))
        for way in (-1, 1):
            node = middle
            while ratio[node] < SLIPS:
                node += way
            before = node - way
            share = (SLIPS - ratio[before]) / (ratio[node] - ratio[before])
            found.append(abs(self.x[before] + share * (self.x[node] - self.x[before])))
        return np.array(found)


def judge(run, name, moment, stick, expected, sign):
    """Edge of the stick zone in slave elements, and the tractions in L2."""
    run.check(f"{name}: edge of the stick zone, slave elements", (moment.edges(sign) - stick) / moment.length.max(), 0.0, 1.5,
              "abs", "Cattaneo, Mindlin")
    error = np.sum(moment.length * (moment.traction - expected) ** 2) / np.sum(moment.length * expected ** 2)
    run.check(f"{name}: tractions, L2", np.sqrt(error), 0.0, 0.2, "max", "Cattaneo, Mindlin")


def check_type(run, kind, exchanged=False, share=1.0):
    name = TYPES[kind] + (", exchanged" if exchanged else "") + (f", eps_T {share:g} eps_N" if share != 1.0 else "")
    result = run.program(line_contact(kind, share=share, exchanged=exchanged))
    energies = result.table("glstat")
    for time in LOOKS:
        at = np.argmin(np.abs(energies["time"] / UNIT - time))
        run.check(f"{name}: kinetic / internal energy at {time:g}", energies["kinetic"][at] / energies["internal"][at],
                  0.0, 1e-7, "max", "at rest")
    for time in LOOKS[:-1]:
        moment = Moment(result, time)
        force = moment.sheared / (FRICTION * moment.pressed)
        stick = moment.stick(force)
        judge(run, f"{name}: Q = {force:.2f} mu P", moment, stick, moment.slipped(stick), 1.0)
    first, most = stick, force
    moment = Moment(result, LOOKS[-1])
    force = moment.sheared / (FRICTION * moment.pressed)
    stick = moment.stick(0.5 * (most - force))
    judge(run, f"{name}: back to Q = {force:.2f} mu P", moment, stick, moment.slipped(first) - 2.0 * moment.slipped(stick), -1.0)
    balance = energies["total"] - energies["external_work"]
    run.check(f"{name}: total - external work", balance, 0.0, 1e-6 * energies["internal"].max(), "abs", "leap-frog keeps it")


def check(run):
    for kind in TYPES:
        check_type(run, kind)
    for kind in (2, 5, 7) if run.is_full else (7,):
        check_type(run, kind, exchanged=True)
    check_type(run, 5, share=0.5)
