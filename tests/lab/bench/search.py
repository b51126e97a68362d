# SPDX-License-Identifier: MIT
"""Decks that try the contact search, of any size, and their runs.

Strips of one row of 1 mm steel quads, an upper (slave) on a lower one:
still        the upper strip is pressed on, no more
sliding      it also slides at 400 m/s, some 2.7 % of a segment a step
folding      both strips, very soft, are thrown into waves of 20 segments at up to 300 m/s and fold
interfaces   50 pairs of strips that slide as above, each with a fiftieth of the slave nodes, each its own interface
"""
import numpy as np

from measuring import Variant, is_fresh, phase_calls, run_program, without_others
from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import part, perfectly_plastic, plane_strain, slideline

H = 1.0e-3                 # side of an element, m
STEP, STEPS = 0.4 * H / 6000.0, 300
SLIDING, PRESSING, FOLDING = 400.0, 1.0, 300.0  # m/s
WAVE = 20.0 * H
CASES = ("still", "sliding", "folding", "interfaces")
TYPES = (1, 5, 7)


def velocity(case, upper, points):
    """(n, 2) initial velocity of the nodes of an upper or lower strip, m/s."""
    value = np.zeros((len(points), 2))
    value[:, 1] = -PRESSING if upper else 0.0
    if case in ("sliding", "interfaces") and upper:
        value[:, 0] = SLIDING
    if case == "folding":
        value[:, 1] += FOLDING * np.sin(2.0 * np.pi * points[:, 0] / WAVE)
    return value


def write_strip(deck, case, upper, base, nodes, first):
    """One strip, its velocities and its contact face as a node set; returns its grid."""
    start, cells = (0.0, nodes - 1) if upper else (-2.5 * H, nodes + 40)
    side = H if upper else 1.02 * H
    x = spaced((start, start + cells * side, cells))
    y = spaced((0.0, H, 1)) if upper else spaced((-H, 0.0, 1))
    grid = Grid(x, base + y, first_node=first, first_element=first)
    points = grid.points.reshape(-1, 2)
    numbers = grid.node.ravel().tolist()
    deck.keyword("NODE")
    deck.lines += [f"{number:8d}{x:16.9g}{y:16.9g}"
                   for number, (x, y) in zip(numbers, points.tolist())]
    deck.keyword("ELEMENT_SHELL")
    deck.lines += [f"{number:8d}       1" + "".join(f"{node:8d}" for node in quad) for number, quad
                   in zip(grid.element.ravel().tolist(), grid.quads.reshape(-1, 4).tolist())]
    deck.keyword("INITIAL_VELOCITY_NODE")
    deck.lines += [f"{number:10d}{v_x:10.2e}{v_y:10.2e}" for number, (v_x, v_y)
                   in zip(numbers, velocity(case, upper, points).tolist())]
    return grid


def slave_nodes(case, size):
    """Slave nodes of a deck of about this size: all of them, and those of a pair."""
    pairs = 50 if case == "interfaces" else 1
    nodes = max(3, size // pairs)
    return pairs * nodes, nodes


def search_deck(case, size):
    """Text of a deck of about so many slave nodes."""
    total, nodes = slave_nodes(case, size)
    pairs = total // nodes
    deck = Deck(f"contact search: {case}")
    deck.parameters(("ctype", 1, "contact type"), ("ngauss", 4, "Gauss points of type 6"),
                    ("pen", 1.0e9, "penalty of a contact node in N/m"))
    deck.keyword("CONTROL_TERMINATION").card("endtim", STEPS * STEP)
    deck.constant_step(1, STEP, 1.0e3)
    deck.database(glstat=STEPS * STEP)
    part(deck, 1, "strips", 1, 1)
    plane_strain(deck, 1)
    perfectly_plastic(deck, 1, 7850.0, 210.0e9, 0.3, 1.0e6 if case == "folding" else 1.0e9)
    first = 1
    for k in range(pairs):
        lower = write_strip(deck, case, False, 4.0 * H * k, nodes, first)
        first += lower.node.size
        upper = write_strip(deck, case, True, 4.0 * H * k, nodes, first)
        first += upper.node.size
        deck.node_set(2 * k + 1, "slave", upper.lower)
        deck.node_set(2 * k + 2, "master", lower.upper)
        slideline(deck, 2 * k + 1, 2 * k + 2)
    return deck.text()


def write_decks(folder, sizes, cases=CASES):
    """{(case, size): (deck, slave nodes)}."""
    decks = {}
    for case in cases:
        for size in sizes:
            deck = folder / f"search_{case}_{size}.k"
            if not is_fresh(deck, __file__):
                deck.write_text(search_deck(case, size), encoding="ascii")
            decks[case, size] = deck, slave_nodes(case, size)[0]
    return decks


def time_search(options, case, deck, nodes, ctype):
    """[(variant, ns per slave node and step, share)]: search and pairing, and contact whole."""
    seconds, share = run_program(options.program, deck, options.out, 1, (f"ctype={ctype}",))
    calls = phase_calls(options.out / "bench.timing.csv", "elements")
    scale = 1.0e9 / nodes / max(1, calls)
    found = seconds["contact_search"] + seconds["contact_pairing"]
    whole = found + seconds["contact_force"]
    return [(Variant("search", f"{case} type {ctype} {what}", nodes, 1, "ns/slave node"),
             without_others(scale * value, share, 1, whole), share) for what, value in (("search", found), ("whole", whole))]
