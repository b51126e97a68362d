# SPDX-License-Identifier: MIT
"""A block flies to and fro between two plates: what contacts that open and close make of its energy."""
import numpy as np

from contact_types import TYPES
from meshes import Deck, grid

YOUNG, RHO, SPEED_SHARE = 1.0e9, 1000.0, 0.005
SPEED = SPEED_SHARE * np.sqrt(YOUNG / RHO)     # m/s
BLOCK, PLATE, GAP = (4, 4, 0.4, 0.4), (6, 2, 0.6, 0.19), 0.01
BOUNCES = 40
BULK = YOUNG / 3.0                              # nu 0
ESTIMATE = 0.1 * BULK * 0.1 / (0.1 * 0.095)     # K L/A of the plates, the harder side; SLSFAC 0.1
STIFF = 300.0                                   # over the built-in penalty


def scene(kind, rules=False, shift=0.0):
    """The deck; `rules`: a penalty of 300 times the built-in one, and the step follows (ECDT 2)."""
    deck = Deck(f"ping-pong, type {kind}")
    deck.control(0.3)
    deck.hourglass(4, 0.05)
    if rules:
        deck.add("*CONTROL_CONTACT", "", (0, 0, 0, 0, 0, 0, 2))
    bodies = []
    for part, (n_x, n_y, width, height), low in ((1, BLOCK, 0.0), (2, PLATE, -GAP - PLATE[3]),
                                                 (3, PLATE, BLOCK[3] + GAP)):
        deck.part(part).elastic(RHO, YOUNG, 0.0, part)
        coordinates, quads = grid(n_x, n_y, width, height, (-0.5 * width + shift * (part == 1), low))
        rows = deck.mesh(coordinates, quads, part=part).reshape(n_y + 1, n_x + 1)
        bodies.append(rows)
    block, below, above = bodies
    deck.node_set(1, block.ravel()).add("*INITIAL_VELOCITY", (1,), (0.0, -SPEED))
    deck.fix(np.concatenate([below[0], above[-1]]), x=1, y=1)
    deck.node_set(2, block[0]).node_set(3, below[-1][::-1])
    deck.node_set(4, block[-1][::-1]).node_set(5, above[0])
    for slave, master in ((2, 3), (4, 5)):
        deck.contact(slave, master, kind, STIFF if rules else 1.0, 2 if rules else 3)
    return deck.output(glstat=1.0e-4, matsum=1.0e-4)
