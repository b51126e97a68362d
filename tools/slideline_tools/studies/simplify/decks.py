# SPDX-License-Identifier: MIT
"""Decks of the study simplify: scenes with more than they need."""
import numpy as np

from slideline_tools.decks import Deck, field
from slideline_tools.scenes import collision, collision_grids
from slideline_tools.scenes.common import ALUMINIUM, STEEL, elastic, perfectly_plastic

NODE_WIDTH = 16  # of a coordinate of *NODE
WIDER = 1.0065
UNREACHABLE = 1.0e12  # yield stress, Pa
ELASTIC_ALUMINIUM = {name: value for name, value in ALUMINIUM.items() if name != "yield_stress"}
MIRRORED = 50000  # added to the number of a node or an element


def exchanged(deck, old, new):
    """The deck with `new` in place of the text `old`, which it must have once."""
    if deck.count(old) != 1:
        raise ValueError(f"the deck has this text {deck.count(old)} times, not once:\n{old[:200]}")
    return deck.replace(old, new)


def written(write):
    """Text of the cards that a function writes into a Deck."""
    deck = Deck("")
    start = len(deck.lines)
    write(deck)
    return "\n".join(deck.lines[start:]) + "\n"


def full_collision(level):
    """The collision with both halves: the deck of the half model, mirrored in x = 0."""
    plate, projectile = collision_grids(level)
    deck = collision(level)
    held = np.concatenate([plate.left, projectile.left])
    deck = exchanged(deck, written(lambda cards: cards.node_set(1, "symmetry plane", held).spc_set(1, True, False)), "")
    for number, heading, nodes, whole in (
            (2, "clamped end of the plate", plate.right,
             np.concatenate([plate.right, MIRRORED + plate.right])),
            # In walking order: the lower face from left to right, the upper one from right to left.
            (3, "slave: lower face of the projectile", projectile.lower,
             np.concatenate([MIRRORED + projectile.lower[:0:-1], projectile.lower])),
            (4, "master: upper face of the plate (0 to 25 mm)", plate.upper[-(20 * level + 1):],
             np.concatenate([plate.upper[-(20 * level + 1):],
                             MIRRORED + plate.upper[-2:-(20 * level + 2):-1]]))):
        deck = exchanged(deck, written(lambda cards: cards.node_set(number, heading, nodes)),
                         written(lambda cards: cards.node_set(number, heading, whole)))
    return exchanged(deck, "*END\n", mirror(plate, 1) + mirror(projectile, 2) + "*END\n")


def mirror(grid, part):
    """Nodes and elements of the other side; those on the plane of symmetry are shared."""
    of_left = grid.node.copy()
    of_left[1:] += MIRRORED
    quads = np.stack([of_left[1:, :-1], of_left[:-1, :-1], of_left[:-1, 1:], of_left[1:, 1:]],
                     axis=-1)
    # As written for the half model and in comma form: a minus sign would cost a digit.
    places = [[float(field(x, NODE_WIDTH)) for x in point]
              for point in grid.points[1:].reshape(-1, 2)]
    lines = [f"{number},{-x!r},{y!r}" for number, (x, y) in zip(of_left[1:].ravel(), places)]
    return "\n".join(["*NODE", *lines]) + "\n" + written(
        lambda cards: cards.quads(MIRRORED + grid.element.ravel(), part, quads.reshape(-1, 4)))


def plastic_instead(deck, number, material):
    """The deck with an elastic-plastic law that never yields in place of an elastic one."""
    return exchanged(deck, written(lambda cards: elastic(cards, number, **material)),
                     written(lambda cards: perfectly_plastic(cards, number, yield_stress=UNREACHABLE, **material)))


def awake(deck):
    """The deck with a global search of all contact nodes in each cycle (FREQ = 1)."""
    lines = deck.splitlines()
    card = [k for k, line in enumerate(lines) if line == "*CONTACT_2D_SLIDELINE"]
    if len(card) != 1:
        raise ValueError("a deck with one *CONTACT_2D_SLIDELINE is expected")
    second = written(lambda cards: cards.card("tbirth tdeath punit pent vdc ipf freq srch",
                                              0.0, 0.0, 0, 0.0, 0.0, 0, 1, 0.0)).splitlines()
    return "\n".join(lines[:card[0] + 3] + second + lines[card[0] + 3:]) + "\n"


def plastic_projectile(deck):
    """The collision whose steel projectile has a plastic law that never yields."""
    return plastic_instead(deck, 2, STEEL)


def plastic_hertz(deck):
    """The Hertz scene both of whose bodies have a plastic law that never yields."""
    return plastic_instead(plastic_instead(deck, 2, STEEL), 1, ELASTIC_ALUMINIUM)


def wider_collision(level):
    """The collision with a projectile a little wider, so that no two nodes face each other."""
    projectile = collision_grids(level)[1]
    points = projectile.points.reshape(-1, 2)
    return exchanged(collision(level), written(lambda cards: cards.nodes(projectile.node.ravel(), points)),
                     written(lambda cards: cards.nodes(projectile.node.ravel(), points * (WIDER, 1.0))))
