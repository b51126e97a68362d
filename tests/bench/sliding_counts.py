#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Retired instructions of a whole step of the sliding deck, with friction over without, of all contact types.

    sliding_counts.py PROGRAM FOLDER

PROGRAM is slideline of the counted build. By callgrind, from a restart while the die slides: the difference of two runs
of which one takes more steps. FOLDER takes the table sliding_counts.csv. With friction the plate flows elsewhere, which
changes the cost of its elements by some per cent either way: `run_added` has the difference of contact alone.
"""
import argparse
import concurrent.futures
import csv
import os
import pathlib
import subprocess
import sys

from slideline_tools import UserError
from slideline_tools.contact_types import ALL_TYPES
from slideline_tools.counting import CALLGRIND, count_instructions

DECK = pathlib.Path(__file__).resolve().parents[2] / "input" / "sliding" / "sliding.k"
DUMPED, STEPS, STEP = 60000, (300, 800), 4.0e-8  # cycles, cycles after these, s; the die slides from cycle 37500 on
COEFFICIENTS = (0.0, 0.2)
TABLE = "sliding_counts.csv"


def end_after(steps):
    return f"endtim={(DUMPED + steps) * STEP:.10g}"


def count_run(program, folder, ctype, coefficient):
    """Instructions a step, of all and of contact."""
    folder = folder / f"sliding_{ctype}_{coefficient:g}"
    folder.mkdir(parents=True, exist_ok=True)
    deck = folder / "sliding.k"
    deck.write_text(DECK.read_text(encoding="ascii").replace(
        "*DATABASE_GLSTAT\n", f"*DATABASE_BINARY_D3DUMP\n{DUMPED:10d}\n*DATABASE_GLSTAT\n"), encoding="ascii")
    subprocess.run([program, f"i={deck}", f"d={folder}", "ncpu=1", f"ctype={ctype}", f"fs={coefficient}", end_after(1)],
                   check=True, stdout=subprocess.DEVNULL)
    few, many = (count_instructions([program, f"r={folder}/sliding.dump01.h5", f"d={folder}", "ncpu=1", end_after(steps)],
                                    folder, CALLGRIND) for steps in STEPS)
    work = STEPS[1] - STEPS[0]
    return (many.total - few.total) / work, (many.parts["contact"] - few.parts["contact"]) / work


def count_type(program, folder, ctype):
    """A row of the table."""
    (bare, bare_contact), (rubbed, rubbed_contact) = (count_run(program, folder, ctype, coefficient)
                                                      for coefficient in COEFFICIENTS)
    return {"type": ctype, "run": f"{bare:.0f}", "run_with": f"{rubbed:.0f}", "run_ratio": f"{rubbed / bare:.3f}",
            "run_added": f"{1.0 + (rubbed_contact - bare_contact) / bare:.3f}",
            "contact": f"{bare_contact:.0f}", "contact_with": f"{rubbed_contact:.0f}",
            "contact_ratio": f"{rubbed_contact / bare_contact:.2f}"}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path, help="slideline of the counted build")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--types", nargs="+", type=int, default=ALL_TYPES, choices=ALL_TYPES)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    try:
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            rows = list(pool.map(lambda ctype: count_type(options.program.resolve(), options.folder, ctype),
                                 options.types))
    except UserError as problem:
        print(problem, file=sys.stderr)
        return 1
    with open(options.folder / TABLE, "w", encoding="ascii", newline="") as stream:
        table = csv.DictWriter(stream, rows[0], lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
