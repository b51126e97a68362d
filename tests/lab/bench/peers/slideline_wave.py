# SPDX-License-Identifier: MIT
"""slideline on the problem of wave.py. usage: slideline_wave.py PROGRAM FOLDER POINTS COLUMNS STEPS

The time is what MORE times as many steps take more of the processor: all of a cycle, nothing of start and end.
"""
import csv
import pathlib
import resource
import subprocess
import sys

import wave
from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import elastic, energies_on, part, plane_strain

MORE = 20


def write_deck(path, points, columns, steps):
    """The block; the displacement of three nodes of the free side is written at the end."""
    line = spaced((0.0, wave.LENGTH, columns))
    grid = Grid(line, line)
    step = wave.step(columns)
    deck = Deck("longitudinal mode of a block")
    deck.parameters(("dt", step, "time step in s"), ("endtim", steps * step, "end time in s"))
    deck.keyword("CONTROL_TERMINATION").card("endtim", "&endtim")
    deck.constant_step(1, "&dt", 1.0e3)
    energies_on(deck)
    deck.database(glstat="&endtim", nodout="&endtim")
    deck.history_nodes([grid.right[0], grid.right[columns // 2], grid.right[-1]])
    part(deck, 1, "block", 1, 1)
    plane_strain(deck, 1, points)
    elastic(deck, 1, wave.RHO, wave.YOUNG, 0.0)
    deck.node_set(1, "held side", grid.left)
    deck.spc_set(1, True, True)
    grid.write(deck, 1)
    deck.keyword("INITIAL_VELOCITY_NODE")
    at = grid.points.reshape(-1, 2)
    deck.lines += [f"{number},{v_x!r},0.0" for number, v_x
                   in zip(grid.node.ravel().tolist(), wave.first_velocity(at).tolist())]
    path.write_text(deck.text(), encoding="ascii")


def read_rows(path):
    with path.open(newline="", encoding="ascii") as stream:
        return list(csv.DictReader(stream))


def processor_seconds():
    """Of all programs run so far."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(program, folder, points, columns, steps):
    """Processor seconds of one run; its histories are in the folder."""
    deck = folder / f"wave_{points}_{columns}_{steps}.k"
    if not deck.exists():
        write_deck(deck, points, columns, steps)
    before = processor_seconds()
    subprocess.run([program, f"i={deck}", f"d={folder}", "jobid=wave", "ncpu=1"], check=True,
                   stdout=subprocess.DEVNULL)
    return processor_seconds() - before


def main():
    program, folder, points, columns, steps = sys.argv[1], pathlib.Path(sys.argv[2]), *map(
        int, sys.argv[3:6])
    folder.mkdir(parents=True, exist_ok=True)
    longer = run(program, folder, points, columns, MORE * steps)
    seconds = (longer - run(program, folder, points, columns, steps)) / (MORE - 1)
    rows = read_rows(folder / "wave.nodout.csv")
    last = rows[-1]["time"]
    wave.report("slideline", "2x2 points, large strain" if points == 4 else
                "one point, large strain", columns, steps, seconds,
                [float(row["ux"]) for row in rows if row["time"] == last])


if __name__ == "__main__":
    main()
