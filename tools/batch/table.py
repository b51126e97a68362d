#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Table of a batch of scene runs, compared with the reference table of the scene.

    table.py SCENE FOLDER REFERENCE.csv RUN... [--renew]

FOLDER holds one folder per RUN, named after it, with the results of the job `SCENE`. The rows
go to FOLDER/table.csv too. --renew writes the reference instead of comparing with it.
Exit status: 0 agreed, 1 a number deviates, 2 something is missing.
"""
import argparse
import csv
import pathlib
import re
import sys

from slideline_tools import UserError, scenes, summaries

# Allowed relative deviation from the reference, and absolute one for numbers near zero.
TOLERANCES = {
    "plastic_strain": (0.02, 1e-3), "rebound": (0.05, 0.3), "peak_force": (0.10, 0.0),
    "impulse": (0.02, 0.0), "episodes": (0.25, 2), "energy_low": (0.0, 5e-3),
    "energy_high": (0.0, 5e-3), "peak": (2e-3, 0.0), "time_of_peak": (0.0, 2e-3),
    "mean": (2e-3, 0.0), "final": (0.0, 1e-3), "hourglass_share": (0.02, 1e-4),
}


def row_of(scene, folder):
    if scene == "collision":
        return summaries.collision_row(folder, scene)
    n_x, n_y = map(int, re.match(r"(\d+)x(\d+)", folder.name).groups())
    node = scenes.symmetric_plate_grid(n_x, n_y).node[0, n_y // 2]
    return summaries.plate_row(folder, scene, node)


def read_reference(path):
    with open(path, newline="", encoding="ascii") as stream:
        return {row["run"]: row for row in csv.DictReader(stream)}


def write_rows(path, rows):
    with open(path, "w", newline="", encoding="ascii") as stream:
        names = ["run", *next(iter(rows.values()))]
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(names)
        for run, row in rows.items():
            writer.writerow([run, *(f"{value:.6g}" for value in row.values())])


def deviations(row, reference):
    """Names of the numbers that are further from the reference than allowed."""
    for name, value in row.items():
        relative, absolute = TOLERANCES[name]
        expected = float(reference[name])
        # Written this way round so that a NaN deviates.
        if not abs(value - expected) <= absolute + relative * abs(expected):
            yield f"{name} {value:.6g} instead of {expected:.6g}"


def print_rows(rows, times):
    width = max(len(run) for run in rows) + 2
    names = [*next(iter(rows.values())), "seconds", "contact_share"]
    print("run".ljust(width) + "".join(name.rjust(16) for name in names))
    for run, row in rows.items():
        values = [*row.values(), *times[run].values()]
        print(run.ljust(width) + "".join(f"{value:.5g}".rjust(16) for value in values))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", choices=("collision", "symmetric_plate"))
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("reference", type=pathlib.Path)
    parser.add_argument("runs", nargs="+", metavar="RUN")
    parser.add_argument("--renew", action="store_true")
    options = parser.parse_args()
    folders = [options.folder / run for run in options.runs]
    try:
        rows = {folder.name: row_of(options.scene, folder) for folder in folders}
        times = {folder.name: summaries.timing(folder, options.scene) for folder in folders}
    except UserError as problem:
        print(problem, file=sys.stderr)
        return 2
    print_rows(rows, times)
    write_rows(options.folder / "table.csv", rows)
    if options.renew:
        write_rows(options.reference, rows)
        print(f"renewed {options.reference}")
        return 0
    return judge(rows, options.reference)


def judge(rows, path):
    if not path.exists():
        print(f"{path}: no such reference", file=sys.stderr)
        return 2
    reference = read_reference(path)
    failed = 0
    for run, row in rows.items():
        if run not in reference:
            print(f"{run}: not in the reference")
            failed += 1
            continue
        for deviation in deviations(row, reference[run]):
            print(f"{run}: {deviation}")
            failed += 1
    print(f"{len(rows)} runs, {failed} deviations from {path.name}")
    return 0 if failed == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
