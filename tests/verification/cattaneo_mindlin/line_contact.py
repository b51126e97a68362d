# SPDX-License-Identifier: MIT
"""By the explicit program: a line contact is pressed, then sheared and held, every type."""
import numpy as np

from contact_types import TYPES
from meshes import Deck, grid_quads
from slip import FRICTION, looks

RHO, YOUNG, POISSON = 1.0e-6, 1.0, 0.3
#: Half width of the contact is about 1; a fine cell is a tenth of it.
RADIUS, APPROACH = 60.0, 0.0225
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


def line_contact(kind, share, exchanged):
    """Two bodies of one material; the upper, round below, is pressed down and held, then moved sideways and back: deck and
    slave nodes. `share`: TFAC."""
    deck = Deck(f"Cattaneo and Mindlin, type {kind}")
    deck.control(SIDEWAYS[-1][0] * UNIT, scale=0.55).hourglass(4, 0.05)
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, POISSON, part)
    x, depth = mirrored(CELL)
    low = deck.mesh(np.array([(a, -b) for b in depth[::-1] for a in x]), grid_quads(len(x) - 1, len(depth) - 1), part=1)
    face = low[-len(x):][np.abs(x) < REACH + 1e-9]
    deck.fix(low[:len(x)], x=1, y=1)
    # The cells of the upper body are larger, so that few nodes meet.
    x, depth = mirrored(UPPER * CELL)
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
    return deck.output(glstat=4.0 * UNIT, rcforc=4.0 * UNIT, plot=4.0 * UNIT), face if exchanged else foot


def check_type(run, kind, exchanged=False, share=1.0):
    name = TYPES[kind] + (", exchanged" if exchanged else "") + (f", eps_T {share:g} eps_N" if share != 1.0 else "")
    deck, slave = line_contact(kind, share, exchanged)
    result = run.program(deck)
    energies = result.table("glstat")
    for time in LOOKS:
        at = np.argmin(np.abs(energies["time"] / UNIT - time))
        run.check(f"{name}: kinetic / internal energy at {time:g}", energies["kinetic"][at] / energies["internal"][at], 0.0)
    for look in looks(result, slave, UNIT * np.array(LOOKS), RADIUS, MODULUS):
        text = f"{name}: {'' if look.way > 0.0 else 'back to '}Q = {look.share:.2f} mu P"
        run.check(f"{text}: edge of the stick zone, slave elements", look.edges(), 0.0)
        run.check(f"{text}: tractions, L2", look.error(), 0.0)
    balance = energies["total"] - energies["external_work"]
    run.check(f"{name}: total - external work", balance, 0.0, scale=energies["internal"].max())


def check(run):
    for kind in TYPES:
        check_type(run, kind)
    for kind in (2, 5, 7) if run.is_full else (7,):
        check_type(run, kind, exchanged=True)
    check_type(run, 5, share=0.5)
