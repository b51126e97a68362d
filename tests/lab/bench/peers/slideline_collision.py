# SPDX-License-Identifier: MIT
"""slideline on the problem of collision.py. usage: slideline_collision.py PROGRAM FOLDER TYPE COLUMNS

The time is what a run takes more of the processor than its first step: all of a cycle, nothing of start and end.
"""
import pathlib
import subprocess
import sys

import collision
import numpy as np
from slideline_tools.decks import Deck
from slideline_tools.results import read
from slideline_tools.scenes.common import elastic, energies_on, part, plane_strain
from slideline_tools.scenes.patch import even_lines, patch_grids
from slideline_wave import processor_seconds


def write_deck(path, ctype, columns, steps):
    """Two blocks of fully integrated quads; all that is written is the state at the end."""
    lower, upper = patch_grids(even_lines(columns), even_lines(collision.below(columns)))
    dt = collision.step(columns)
    deck = Deck("two blocks that strike each other")
    deck.parameters(("dt", dt, "time step in s"), ("endtim", steps * dt, "end time in s"))
    deck.keyword("CONTROL_TERMINATION").card("endtim", "&endtim")
    deck.constant_step(1, "&dt", 1.0e3)
    energies_on(deck)
    deck.database(glstat="&endtim", binary_d3plot="&endtim")
    for number in (1, 2):
        part(deck, number, "block", 1, 1)
    plane_strain(deck, 1, 4)
    elastic(deck, 1, collision.RHO, collision.YOUNG, 0.0)
    deck.node_set(3, "slave: lower face of the upper block", upper.lower)
    deck.node_set(4, "master: upper face of the lower block", lower.upper)
    deck.keyword("CONTACT_2D_SLIDELINE")
    deck.card("surfa surfb ctype ngauss pen fs fd dc", -3, -4, ctype, 4, collision.PENALTY, 0.0, 0.0, 0.0)
    lower.write(deck, 1)
    upper.write(deck, 2)
    deck.keyword("INITIAL_VELOCITY_NODE")
    for grid, speed in ((lower, 0.5 * collision.V), (upper, -0.5 * collision.V)):
        deck.lines += [f"{node},0.0,{speed!r}" for node in grid.node.ravel().tolist()]
    path.write_text(deck.text(), encoding="ascii")
    return lower, upper


def command(program, folder, ctype, columns, steps):
    """The command of so many steps, and both blocks."""
    deck = folder / f"collision_{ctype}_{columns}_{steps}.k"
    blocks = write_deck(deck, ctype, columns, steps)
    return [program, f"i={deck}", f"d={folder}", "jobid=collision", "ncpu=1"], blocks


def run(*arguments):
    """Processor seconds of one run, and both blocks."""
    words, blocks = command(*arguments)
    before = processor_seconds()
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    return processor_seconds() - before, blocks


def main():
    program, folder, ctype, columns = sys.argv[1], pathlib.Path(sys.argv[2]), *map(int, sys.argv[3:5])
    folder.mkdir(parents=True, exist_ok=True)
    steps = collision.steps(columns)
    first, _ = run(program, folder, ctype, columns, 1)
    seconds, (lower, upper) = run(program, folder, ctype, columns, steps)
    results = read(folder / "collision.vtkhdf")
    speed = dict(zip(np.asarray(results.point_field("node_id")[-1]).tolist(),
                     np.asarray(results.point_field("velocity")[-1])[:, 1].tolist()))
    collision.report("slideline", f"type {ctype}", columns, steps, (seconds - first) * steps / (steps - 1),
                     [[speed[node] for node in grid.node.ravel().tolist()] for grid in (upper, lower)])


if __name__ == "__main__":
    main()
