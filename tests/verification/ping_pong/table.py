#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The whole table of the README: `table.py PROGRAM [PROGRAM]`, all types and steps, one column of
figures for each program (before -> after). It takes a minute."""
import pathlib
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

from check import ALL_STEPS, made, scene  # noqa: E402
from contact_types import TYPES  # noqa: E402
from run_case import Run  # noqa: E402


def energy(program, work, kind, step, follows, held):
    """Made by contact over E0, as text; `ends` where the run breaks off."""
    try:
        result = Run("ping_pong", program, work).program(scene(kind, follows, held),
                                                         f"tssfac={step}")
    except RuntimeError:
        return "ends"
    return f"{made(result.table('glstat')):.2g}"


def main():
    programs = [pathlib.Path(name).resolve() for name in sys.argv[1:]]
    if not programs:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as work:
        for held in (False, True):
            for follows in (False, True):
                print(f"\n{'No sideways motion, ' if held else ''}{'ECDT 2' if follows else 'PUNIT 3'}\n")
                print("| type | " + " | ".join(f"TSSFAC {step}" for step in ALL_STEPS) + " |")
                print("|---" * (1 + len(ALL_STEPS)) + "|")
                for kind, name in TYPES.items():
                    cells = [" -> ".join(energy(program, pathlib.Path(work), kind, step, follows, held)
                                         for program in programs) for step in ALL_STEPS]
                    print(f"| {kind} {name} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
