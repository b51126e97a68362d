# SPDX-License-Identifier: MIT
"""OpenRadioss on the problem of collision.py. usage: openradioss_collision.py FOLDER COLUMNS

The time is what a run takes more of the processor than its first step: all of a cycle, nothing of start and end.
"""
import pathlib
import sys

import numpy as np

import collision
import openradioss
import wave

CONTACT = "node to segment, penalty"
# Springs of INTER/TYPE5 are its factor times the bulk modulus of the quad behind a segment (square ones).
FACTOR = collision.PENALTY / (collision.YOUNG / 3.0)
MOMENTUM, MASS = 5, 6  # of a part, along our y


def prepare(folder, columns, steps):
    """Write the deck and let the starter read it: its name."""
    deck = openradioss.Deck(f"COLLISION{columns}_{steps}")
    deck.elastic(1, collision.RHO, collision.YOUNG, 0.0)
    deck.solid(1, openradioss.FOUR_POINTS, openradioss.LARGE)
    first_node = first_quad = 1
    for part, (n, low, speed) in enumerate(((columns, 0.0, -0.5 * collision.V),
                                            (collision.below(columns), -1.0, 0.5 * collision.V)), 1):
        at, quads = wave.grid(n)
        deck.block(part, at + [0.0, low], quads, first_node, first_quad)
        numbers = first_node + np.arange(len(at)).reshape(n + 1, n + 1)
        deck.nodes(part, numbers.ravel())
        deck.velocity(part, part, 0.0, speed)
        if part == 1:
            deck.nodes(3, numbers[:, 0])
        else:
            face = numbers[:, -1]
            deck.surface(1, np.stack([face[1:], face[:-1]], axis=1))
        first_node, first_quad = first_node + len(at), first_quad + len(quads)
    deck.one_pass(1, 3, 1, FACTOR)
    deck.history(1, "PART", (1, 2), ["DEF"])
    deck.write(folder, collision.step(columns), steps)
    openradioss.start(deck.name, folder)
    return deck.name


def command(folder, columns, steps):
    """The engine on a deck that the starter has read."""
    return openradioss.command(prepare(folder, columns, steps))


def main():
    folder, columns = pathlib.Path(sys.argv[1]), int(sys.argv[2])
    steps = collision.steps(columns)
    first, _ = openradioss.run(prepare(folder, columns, 1), folder)
    seconds, found = openradioss.run(prepare(folder, columns, steps), folder)
    speeds = [np.full((n + 1, n + 1), found["PART", part, MOMENTUM][-1] / found["PART", part, MASS][-1])
              for part, n in enumerate((columns, collision.below(columns)), 1)]
    collision.report("OpenRadioss", CONTACT, columns, steps, (seconds - first) * steps / (steps - 1), speeds)


if __name__ == "__main__":
    main()
