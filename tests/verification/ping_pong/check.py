# SPDX-License-Identifier: MIT
"""A block flies to and fro between two plates: what contacts that open and close make of its energy."""
import numpy as np

from contact_types import TYPES
from meshes import Deck, grid

YOUNG, RHO = 1.0e9, 1000.0
SPEED = 0.005 * np.sqrt(YOUNG / RHO)            # m/s
BLOCK, PLATE, GAP = (4, 4, 0.4, 0.4), (6, 2, 0.6, 0.19), 0.01
END = 0.3                                       # s: some 40 bounces
STIFF = 300.0                                   # over the built-in penalty
ALL_STEPS = (0.5, 0.6, 0.7, 0.8, 0.9)           # TSSFAC
# Two interfaces, each with a slack of 0.01 (theory/contact.md, 6.1).
BOUND = 0.02


def scene(kind, follows=False, held=False):
    """The deck. `follows`: penalty 300 times the built-in one, and the step follows (ECDT 2), else
    PUNIT 3 and PEN 1. `held`: no sideways motion, so that nothing moves over the ends of surfaces."""
    deck = Deck(f"ping-pong, type {kind}")
    deck.control(END)
    deck.hourglass(4, 0.05)
    if follows:
        deck.add("*CONTROL_CONTACT", "", (0, 0, 0, 0, 0, 0, 2))
    bodies = []
    for part, (n_x, n_y, width, height), low in ((1, BLOCK, 0.0), (2, PLATE, -GAP - PLATE[3]),
                                                 (3, PLATE, BLOCK[3] + GAP)):
        deck.part(part).elastic(RHO, YOUNG, 0.0, part)
        coordinates, quads = grid(n_x, n_y, width, height, (-0.5 * width, low))
        bodies.append(deck.mesh(coordinates, quads, part=part).reshape(n_y + 1, n_x + 1))
    block, below, above = bodies
    deck.node_set(1, block.ravel()).add("*INITIAL_VELOCITY", (1,), (0.0, -SPEED))
    deck.fix(np.concatenate([below[0], above[-1]]), x=1, y=1)
    if held:
        deck.fix(np.concatenate([part.ravel() for part in (block, below[1:], above[:-1])]), x=1)
    deck.node_set(2, block[0]).node_set(3, below[-1][::-1])
    deck.node_set(4, block[-1][::-1]).node_set(5, above[0])
    for slave, master in ((2, 3), (4, 5)):
        deck.contact(slave, master, kind, STIFF if follows else 1.0, 2 if follows else 3)
    return deck.output(glstat=5.0e-4, matsum=5.0e-4)


def made(glstat):
    """Largest energy that the contact forces have made, over the energy at the start."""
    return max(0.0, -np.min(glstat["contact"])) / glstat["total"][0]


def bounces(matsum):
    """How often the block has turned round."""
    momentum = matsum.where(part=1)["momentum_y"]
    way = np.sign(momentum[np.abs(momentum) > 0.2 * np.abs(momentum[0])])
    return int(np.sum(np.diff(way) != 0.0))


def fly(run, kind, step, follows=False, held=False):
    """One run; what contact made is judged."""
    what = "ECDT 2, 300 times the built-in penalty" if follows else "PUNIT 3"
    place = "no sideways motion, " if held else ""
    name = f"{TYPES[kind]}, {place}{what}, TSSFAC {step}"
    result = run.program(scene(kind, follows, held), f"tssfac={step}",
                         name=f"type{kind}_{step}{'_follows' * follows}{'_held' * held}")
    glstat, turns = result.table("glstat"), bounces(result.table("matsum"))
    run.check(f"{name}: energy made by contact / E0, {turns} bounces", made(glstat), BOUND)


def check(run):
    for kind in TYPES:
        # Where not in full: the longest step and another one, in turn.
        for step in ALL_STEPS if run.is_full else (ALL_STEPS[kind % 4], ALL_STEPS[-1]):
            fly(run, kind, step)
        ends = (0.5, 0.9)
        for k in range(2) if run.is_full else (kind % 2,):
            fly(run, kind, ends[k], follows=True)
            fly(run, kind, ends[1 - k], held=True)
        fly(run, kind, 0.9, follows=True, held=True)
