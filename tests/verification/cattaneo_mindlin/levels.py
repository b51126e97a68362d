#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`levels.py PROGRAM WORK [LEVEL ...]`: the scene on three meshes, all types; prints the table of the README."""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent)]

from check import looks, rolled  # noqa: E402
from contact_types import TYPES  # noqa: E402
from run_case import Run  # noqa: E402


def main():
    program, work, *levels = sys.argv[1:]
    run = Run("cattaneo_mindlin", pathlib.Path(program).resolve(), pathlib.Path(work).resolve())
    head = None
    for level in map(int, levels or (1, 2, 4)):
        for kind in TYPES:
            deck, slave = rolled(kind, level)
            found = looks(run.program(deck), slave)
            if head is None:
                head = ["h", "type", *(name for name, _ in found)]
                print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
            cells = [f"{max(look.edges(), key=abs):+.1f}, {look.error():.3f}" for _, look in found]
            print("| " + " | ".join([f"a/{found[0][1].a / found[0][1].cell:.1f}", TYPES[kind], *cells]) + " |", flush=True)


if __name__ == "__main__":
    main()
