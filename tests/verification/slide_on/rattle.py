# SPDX-License-Identifier: MIT
"""A light, soft block rattles between two rigid dies for many bounces: contact makes none of its energy."""
import numpy as np

from contact_types import TYPES
from meshes import Deck, grid

YOUNG, RHO, POISSON, SPEED = 1.0e6, 100.0, 0.3, 1.0
BLOCK, GAP = (4, 9, 0.4, 0.9), 0.01             # quads and size: fine slaves
DIE = (3, 1, 0.8, 0.2)                          # on coarse masters
KINDS, STEPS = (1, 2, 5), (0.5, 0.67)           # TSSFAC
BOUND = 0.02                                    # the slack of both interfaces (theory/contact.md, 6.1)


def scene(kind):
    """The deck: the dies are held in all directions; PUNIT 3 and PEN 1."""
    deck, bodies = Deck(f"rattling block, type {kind}").control(20.0), []
    for part, (n_x, n_y, width, height), low in ((1, BLOCK, 0.0), (2, DIE, -GAP - DIE[3]), (3, DIE, BLOCK[3] + GAP)):
        deck.part(part, points=4 if part == 1 else None)
        if part == 1:
            deck.elastic(RHO, YOUNG, POISSON, part)
        else:
            deck.add("*MAT_RIGID", (part, RHO, YOUNG, POISSON), (1, 7, 7), (0.0,))
        bodies.append(deck.mesh(*grid(n_x, n_y, width, height, (-0.5 * width, low)), part=part).reshape(n_y + 1, n_x + 1))
    block, below, above = bodies
    deck.node_set(1, block.ravel()).add("*INITIAL_VELOCITY", (1,), (0.0, -SPEED))
    deck.node_set(2, block[0]).node_set(3, below[-1][::-1])
    deck.node_set(4, block[-1][::-1]).node_set(5, above[0])
    for slave, master in ((2, 3), (4, 5)):
        deck.contact(slave, master, kind, 1.0, 3)
    return deck.output(glstat=0.02)


def check(run):
    for kind in KINDS:
        for step in STEPS:
            glstat = run.program(scene(kind), f"tssfac={step}").table("glstat")
            name = f"{TYPES[kind]}, TSSFAC {step}"
            contact, total, start = glstat["contact"], glstat["total"], glstat["total"][0]
            run.check(f"{name}: energy made by contact / E0", max(0.0, -np.min(contact)) / start, BOUND)
            run.check(f"{name}: largest energy that the block has / E0", np.max(total - contact) / start, 1.0 + BOUND)
