#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Retired instructions of contact, per slave node and step, of bench_contact.

    contact_counts.py PROGRAM FOLDER

PROGRAM is bench_contact of the counted build (contact_counts.sh builds it). By callgrind, and each the difference of
two runs of which one takes more steps: they are the same on a busy machine. FOLDER takes the table contact_counts.csv
and the page contact_cost.md. What contact cost before its layer was laid anew stands in contact_before.csv.
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
from slideline_tools.studies.common import label, markdown_table

HERE = pathlib.Path(__file__).resolve().parent
NODES = 1000
STEPS, ROUNDS = (20, 60), 5  # of a round, and rounds of a run of bench_contact
TABLE, BEFORE = "contact_counts.csv", "c8ead89"
SCENES = ("shift", "match", "exact", "flat", "slide", "stick")
MATCHING_GOAL, ANEW_GOAL, FRICTION_GOAL = 1.2, 1.15, 1.35

PAGE = """# What contact costs

This page is written by `tests/bench/contact_counts.sh`: do not edit it. Retired instructions of contact alone, by callgrind on a
program built for x86-64-v3, per slave node and step: a flat chain of {nodes} slave nodes that all touch, the whole of contact from the
gathering of places to the energy account. The figures do not depend on the machine or its load.

- **shifted**: two meshes of the same size, nodes opposite places between nodes; **matching**: nodes opposite nodes, up to 1e-7 of a segment
  off; **exact**: opposite to round-off. Matching over shifted is to be at most {matching:g}.
- **before**: the shifted meshes by the program of commit `{commit}`, before the layer was laid anew and before the energy law of contact, which no
  type can do without. Shifted over before is to be at most {anew:g}.

{costs}

A slave node has as many contact points as the columns *points* say: per point type 7 costs more on matching meshes, since a slave segment
then has one piece instead of two and what is done once per node is shared by half of the points.

## Friction

All places stick (shifted meshes), or all slide (meshes of unlike size, 1e-4 of a segment a step); mu is 0.3. With over without is to be at
most {friction:g}.

{rubbing}
"""


def count_scene(program, folder, scene, ctype):
    """A row of the table: instructions per slave node and step, contact points per slave node."""
    commands = [[program, str(NODES), str(ctype), str(steps), scene] for steps in STEPS]
    few, many = (count_instructions(command, folder / f"{scene}_{ctype}", CALLGRIND).parts["contact"]
                 for command in commands)
    told = subprocess.run(commands[0], check=True, capture_output=True, text=True).stdout
    points = int(next(csv.DictReader(told.splitlines()))["points"])
    return {"scene": scene, "type": str(ctype), "points": f"{points / NODES:.2f}",
            "instructions": f"{(many - few) / (ROUNDS * (STEPS[1] - STEPS[0]) * NODES):.1f}"}


def count_all(program, folder, scenes):
    """Rows of the table, of all scenes and types."""
    work = [(scene, ctype) for scene in scenes for ctype in ALL_TYPES]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(lambda pair: count_scene(program, folder, *pair), work))


def read_rows(path):
    with open(path, encoding="ascii") as stream:
        return list(csv.DictReader(line for line in stream if not line.startswith("#")))


def by_scene(rows, column="instructions"):
    """{(scene, type): value}."""
    return {(row["scene"], int(row["type"])): float(row[column]) for row in rows}


def ratio(value, base, goal):
    """Text of a ratio; bold where it is beyond the goal."""
    text = f"{value / base:.2f}"
    return text if value / base < goal + 0.005 else f"**{text}**"


def cost_table(rows, before):
    cost, points, before = by_scene(rows), by_scene(rows, "points"), by_scene(before)
    lines = []
    for ctype in ALL_TYPES:
        shifted, old = cost["shift", ctype], before["shift", ctype]
        lines.append([label(ctype), f"{old:.0f}", f"{shifted:.0f}", ratio(shifted, old, ANEW_GOAL),
                      *(cell for scene in ("match", "exact")
                        for cell in (f"{cost[scene, ctype]:.0f}", ratio(cost[scene, ctype], shifted, MATCHING_GOAL))),
                      f"{points['shift', ctype]:.2f}", f"{points['match', ctype]:.2f}"])
    return markdown_table(["type", "before", "shifted", "over before", "matching", "over shifted", "exact", "over shifted",
                           "points, shifted", "points, matching"], lines)


def friction_table(rows):
    cost, lines = by_scene(rows), []
    for ctype in ALL_TYPES:
        cells = [label(ctype)]
        for bare, scene in (("shift", "stick"), ("flat", "slide")):
            cells += [f"{cost[bare, ctype]:.0f}", f"{cost[scene, ctype]:.0f}",
                      ratio(cost[scene, ctype], cost[bare, ctype], FRICTION_GOAL)]
        lines.append(cells)
    return markdown_table(["type", "shifted, without", "sticking", "over without", "sliding, without", "with", "over without"],
                          lines)


def write(folder):
    """The page from the table."""
    rows, before = read_rows(folder / TABLE), read_rows(HERE / "contact_before.csv")
    (folder / "contact_cost.md").write_text(PAGE.format(
        nodes=NODES, matching=MATCHING_GOAL, anew=ANEW_GOAL, friction=FRICTION_GOAL, commit=BEFORE,
        costs=cost_table(rows, before), rubbing=friction_table(rows)), encoding="ascii")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path, help="bench_contact of the counted build")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--scenes", nargs="+", default=SCENES, choices=SCENES, help="only count these, no page")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    try:
        rows = count_all(options.program.resolve(), options.folder, options.scenes)
    except UserError as problem:
        print(problem, file=sys.stderr)
        return 1
    with open(options.folder / TABLE, "w", encoding="ascii", newline="") as stream:
        table = csv.DictWriter(stream, rows[0], lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    if set(options.scenes) == set(SCENES):
        write(options.folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
