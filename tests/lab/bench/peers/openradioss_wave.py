# SPDX-License-Identifier: MIT
"""OpenRadioss on the problem of wave.py. usage: openradioss_wave.py FOLDER POINTS COLUMNS STEPS

The time is what MORE times as many steps take more of the processor: all of a cycle, nothing of start and end.
"""
import pathlib
import sys

import numpy as np

import openradioss
import wave

MORE = 20
DISPLACEMENT = 2  # DY, our u_x


def prepare(folder, points, columns, steps):
    """Write the deck and let the starter read it: its name, and the nodes of the free side."""
    at, quads = wave.grid(columns)
    numbers = np.arange(1, len(at) + 1).reshape(columns + 1, columns + 1)
    deck = openradioss.Deck(f"WAVE{points}_{columns}_{steps}")
    deck.elastic(1, wave.RHO, wave.YOUNG, 0.0)
    deck.solid(1, openradioss.FOUR_POINTS if points == 4 else openradioss.ONE_POINT, openradioss.LARGE)
    deck.block(1, at, quads, 1, 1)
    deck.nodes(1, numbers[0])
    deck.held(1, 1, "011000")
    for column in range(1, columns + 1):
        deck.nodes(column + 1, numbers[column])
        deck.velocity(column, column + 1, float(wave.first_velocity(at)[numbers[column, 0] - 1]), 0.0)
    free = numbers[-1].tolist()
    deck.history(1, "NODE", free, ["DY"])
    deck.write(folder, wave.step(columns), steps)
    openradioss.start(deck.name, folder)
    return deck.name, free


def command(folder, points, columns, steps):
    """The engine on a deck that the starter has read."""
    return openradioss.command(prepare(folder, points, columns, steps)[0])


def main():
    folder, points, columns, steps = pathlib.Path(sys.argv[1]), *map(int, sys.argv[2:5])
    longer, _ = openradioss.run(prepare(folder, points, columns, MORE * steps)[0], folder)
    name, free = prepare(folder, points, columns, steps)
    seconds, found = openradioss.run(name, folder)
    wave.report("OpenRadioss", "2x2 points, large strain" if points == 4 else "one point, large strain", columns, steps,
                (longer - seconds) / (MORE - 1), [found["NODE", node, DISPLACEMENT][-1] for node in free])


if __name__ == "__main__":
    main()
