# SPDX-License-Identifier: MIT
"""Decks of bodies of revolution."""
import numpy as np
from meshes import Deck, grid

SLOPE = 0.36  # of the cones: some 20 degrees


def rings(kind, n=61, friction=0.3, end=0.012):
    """A ring flies obliquely upon a cone of another mesh that begins at the axis, with friction and damping of the contact."""
    deck = Deck("rings with conical faces")
    deck.control(end, scale=0.6).hourglass(2, 0.1)
    deck.add("*SECTION_SHELL", (1, 15), (1.0,))
    deck.part(1, section=1).elastic(1000.0, 1.0e6, 0.3, 1).part(2, section=1).elastic(1000.0, 1.0e6, 0.3, 2)
    tall = max(2, n // 3)
    meshes = grid(n, tall, 0.6, 0.2, (0.2, 0.002)), grid(n + n // 4, tall, 1.0, 0.3, (0.0, -0.3))
    ids = []
    for part, (points, quads) in enumerate(meshes, 1):
        ids.append(deck.mesh(points + np.outer(points[:, 0], [0.0, SLOPE]), quads, part=part))
    upper, lower = ids
    row = n + n // 4 + 1
    deck.node_set(1, upper).node_set(2, upper[:n + 1]).node_set(3, lower[-row:][::-1])
    deck.add("*CONTACT_2D_SLIDELINE", (-2, -3, kind, 3, 0.5, friction), (0.0, 1.0e20, 3, 0.0, 0.02))
    deck.add("*INITIAL_VELOCITY", (1,), (0.3, -1.0)).fix(lower[:row], y=1)
    return deck.output(plot=0.01, glstat=1.0e-4, matsum=1.0e-4, rcforc=1.0e-4).text()
