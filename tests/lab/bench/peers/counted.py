# SPDX-License-Identifier: MIT
"""Retired instructions of the programs of run.py, once: counts.csv.

A step is the difference of two runs of which one has more steps, so that start and end drop out, per element; contact
is the whole process, as its seconds are. Where callgrind counts, slideline is the program built for x86-64-v3.
"""
import sys

import slideline_wave
from slideline_tools import UserError
from slideline_tools.counting import count_instructions

MORE = 2  # times as many steps


def count(command, folder, **options):
    """(instructions, who counted); None where the command can not be counted, which is said."""
    try:
        found = count_instructions(command, folder / "counted", **options)
    except UserError as problem:
        print(f"not counted: {problem}", file=sys.stderr, flush=True)
        return None
    return found.total, found.by


def row(scene, elements, program, what, found, divisor=1):
    """A row of counts.csv in a list; [] where nothing was counted. `what`: the element or the contact."""
    if not found:
        return []
    return [{"scene": scene, "elements": elements, "program": program, "what": what,
             "instructions": found[0] / divisor, "counted_by": found[1]}]


def difference_row(scene, labels, what, commands, steps, folder, **options):
    """A row of what so many more steps take in the second command than in the first; `labels`: elements and program."""
    few, many = (count(command, folder, **options) for command in commands)
    difference = (many[0] - few[0], few[1]) if few and many else None
    return row(scene, labels["elements"], labels["program"], what, difference, labels["elements"] * steps)


def step_row(labels, commands, folder, **options):
    """A row of an element step; `labels`: its row of elements.csv; `commands`: with its steps, and with MORE times."""
    return difference_row("step", labels, labels["element"], commands, labels["steps"] * (MORE - 1), folder, **options)


def slideline_step(program, folder, points, columns, steps):
    """The command of so many steps."""
    deck = folder / f"counted_{points}_{columns}_{steps}.k"
    slideline_wave.write_deck(deck, points, columns, steps)
    return [program, f"i={deck}", f"d={folder}", "jobid=counted", "ncpu=1"]
