# SPDX-License-Identifier: MIT
"""Restart of implicit runs: to the same bits, whatever the step control, the contact type and the solver do."""
import re

import h5py
import pytest
from conftest import drop, numbers
from meshes import Deck, grid
from test_implicit import implicit, pulled
from test_restart import arrays, assert_same, histories, part_of, with_files

GROUPS = ("state", "outputs", "steps")


def blocks(deck, kind):
    """A block of 4 x 2 quads 0.002 above one of 6 x 2 that is held at its bottom; the lower one yields."""
    deck.part(1, points=4).elastic(1000.0, 1.0e6, 0.3, 1).part(2).plastic(1000.0, 1.0e6, 0.3, 2.0e4, 1.0e5, 0.5, 2)
    upper = deck.mesh(*grid(4, 2, 0.6, 0.4, (0.2, 0.002)), part=1)
    lower = deck.mesh(*grid(6, 2, 1.0, 0.4, (0.0, -0.4)), part=2)
    deck.fix(lower[:7], x=1, y=1).node_set(1, upper).node_set(2, upper[:5]).node_set(3, lower[-7:][::-1])
    deck.contact(2, 3, kind, 2.0e6)
    return upper, lower


def tables(deck, interval, nodes):
    """All outputs there are, with ASCII twins."""
    deck.output(plot=4 * interval, glstat=interval, matsum=interval, rcforc=interval, nodout=interval, nodes=nodes)
    return deck.add("*DATABASE_SLEOUT", (interval,)).add("*DATABASE_SPCFORC", (interval,))


def pressed(kind):
    """Static: pressed down by a curve with corners, then moved aside; steps grow, are cut and end at corners and plots."""
    deck = implicit(1.0, 0.04, automatic=(1.0e-4, 0.3), most_iterations=5)
    upper, lower = blocks(deck, kind)
    deck.curve(1, [(0.0, 0.0), (0.31, -0.03), (1.0, -0.05)]).curve(2, [(0.0, 0.0), (0.45, 0.0), (1.0, 0.2)])
    for node in upper[-5:]:
        deck.prescribe(int(node), 2, 2, 1).prescribe(int(node), 1, 2, 2)
    return tables(deck, 0.05, [1, int(upper[-1])])


def struck(kind):
    """Dynamic: falls on under gravity, a load and a motion that comes and goes; constant steps."""
    deck = implicit(0.03, 5.0e-4, dynamic=True)
    upper, lower = blocks(deck, kind)
    deck.add("*INITIAL_VELOCITY", (1,), (0.3, -2.0)).curve(1, [(0.0, 9.81), (10.0, 9.81)]).add("*LOAD_BODY_Y", (1, 1.0))
    deck.curve(2, [(0.0, 0.0), (0.01, 1.0), (0.02, 0.0)]).add("*LOAD_NODE_POINT", (int(upper[-1]), 2, 2, -200.0))
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_NODE", (int(lower[-1]), 1, 0, 2, 0.05, 0, 0.0223, 0.0042),
             (int(upper[-5]), 2, 2, 2, -0.01, 0, 0.018, 0.0))
    return tables(deck, 1.0e-3, [1, int(upper[-1])])


def grown(kind):
    """Dynamic, with steps that grow and are cut, of Newmark's method with damping."""
    deck = implicit(0.03, 5.0e-4, dynamic=True, automatic=(1.0e-6, 4.0e-3), most_iterations=3)
    deck.lines[deck.lines.index("*CONTROL_IMPLICIT_DYNAMICS") + 1] = "1,0.6,0.3025"
    upper, lower = blocks(deck, kind)
    deck.add("*INITIAL_VELOCITY", (1,), (0.3, -2.0))
    return tables(deck, 1.5e-3, [1, int(upper[-1])])


#: scene -> (deck of a contact type, steps between two restart files, what its log must show)
SCENES = {"pressed": (pressed, 5, "no equilibrium"), "struck": (struck, 23, ""),
          "grown": (grown, 6, "no equilibrium")}
