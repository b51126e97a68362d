# SPDX-License-Identifier: MIT
"""A rubber ring in the round between rigid plates, and rubber that has settled before time zero."""
import numpy as np
from meshes import Deck, grid


def seal(kind, points=4, n=24, speed=4.0, end=4.0e-3):
    """An O-ring of rubber and two plates as one surface with itself, with friction: the upper plate comes down on it."""
    deck = Deck("seal")
    deck.control(end, scale=0.8)
    deck.add("*SECTION_SHELL", (1, 15, None, points), (1.0,))
    deck.add("*MAT_MOONEY-RIVLIN_RUBBER", (1, 1000.0, 0.49, 3.0e5, 1.0e5))
    deck.add("*MAT_RIGID", (2, 7800.0, 2.0e11, 0.3)).add("*MAT_RIGID", (3, 7800.0, 2.0e11, 0.3), (1.0, 7, 7))
    for part, title in ((1, "ring"), (2, "upper plate"), (3, "lower plate")):
        deck.add("*PART", title, (part, 1, part))
    angles = 2.0 * np.pi * np.arange(n) / n
    points = np.array([(0.07 + r * np.cos(a), 0.01 + r * np.sin(a)) for r in (0.006, 0.008, 0.01) for a in angles])
    quads = [(i * n + j, (i + 1) * n + j, (i + 1) * n + (j + 1) % n, i * n + (j + 1) % n) for i in range(2) for j in range(n)]
    deck.mesh(points, quads, part=1)
    deck.mesh(*grid(6, 2, 0.05, 0.01, (0.045, 0.0201)), part=2)
    deck.mesh(*grid(7, 2, 0.05, 0.01, (0.045, -0.0101)), part=3)
    deck.add("*INITIAL_VELOCITY_RIGID_BODY", (2, 0.0, -speed))
    deck.add("*SET_PART_LIST", (4,), (1, 2, 3))
    deck.add("*CONTACT_2D_SLIDELINE", (4, 0, kind, 2, 0.5, 0.3), (0.0, 1.0e20, 3))
    return deck.output(plot=end / 4, glstat=end / 50, matsum=end / 50, rcforc=end / 50).text()


def settled(kind=0, end=0.02):
    """A round pad of rubber that has settled under its weight before time zero and then swings."""
    deck = Deck("settled")
    deck.control(end, scale=0.8)
    deck.add("*CONTROL_DYNAMIC_RELAXATION", (50, 1.0e-8, 0.9))
    deck.add("*SECTION_SHELL", (1, 15), (1.0,)).hourglass(4, 0.1)
    deck.add("*PART", "pad", (1, 1, 1)).add("*MAT_BLATZ-KO_RUBBER", (1, 1000.0, 1.0e5))
    nodes = deck.mesh(*grid(8, 4, 0.1, 0.05))
    deck.fix(nodes[:9], x=1, y=1)
    deck.add("*DEFINE_CURVE", (1, 1), (0.0, 9.81), (1.0, 9.81)).add("*LOAD_BODY_Y", (1, 1.0))
    return deck.output(plot=end / 4, glstat=end / 50, matsum=end / 50, nodout=end / 50, nodes=nodes[-1:]).text()
