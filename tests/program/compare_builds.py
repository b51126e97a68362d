#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Run the same decks with several builds of the program and say where their results have the same bits.

Run by hand: builds differ by compiler options (`tools/build.sh`, `tools/build.sh package`), so no one answer is right. Example, from
the top of the tree:

    python tests/program/compare_builds.py build/release/slideline build/debug/slideline
"""
import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import load_runs  # noqa: E402
from slideline_tools.histories import read_csv  # noqa: E402

#: group -> what of a result belongs to it
GROUPS = {"motion": ("displacement", "velocity", "Points"), "contact": ("contact_force", "contact_pressure", "gap", "rcforc", "contact.csv"),
          "stress": ("CellData",), "energies": ("glstat", "matsum", "sleout")}
#: columns of a table that are measured together, since one of them may be nothing but round-off
TOGETHER = (("fx", "fy"), ("ux", "uy"), ("vx", "vy"), ("ax", "ay"), ("momentum_x", "momentum_y"),
            ("kinetic", "internal", "hourglass", "viscous", "damping", "contact", "external_work", "total"))


def run(program, deck, folder):
    """Exit status and what the deck leaves in `folder`, as numbers: name -> array."""
    done = subprocess.run([program, f"i={deck}", f"d={folder}", "jobid=job"], capture_output=True, text=True, check=False)
    found = {}
    if done.returncode == 0:
        with load_runs.h5py.File(folder / "job.vtkhdf") as stream:
            for kind in ("PointData", "CellData"):
                found.update({f"{kind}/{name}": item[()] for name, item in stream[f"VTKHDF/{kind}"].items()})
        for path in folder.glob("*.csv"):
            if "timing" not in path.name:
                table = read_csv(path)
                found.update({f"{path.name}/{name}": np.asarray(table[name]) for name in table.value_columns})
    return done.returncode, {name: value for name, value in found.items() if value.dtype.kind == "f"}


def group_of(name):
    """The group of an array or a column."""
    return next((group for group, parts in GROUPS.items() if any(part in name for part in parts)), "other")


def size_of(name, arrays):
    """What differences of an array are measured by: its largest value, or that of all columns of its kind."""
    place, _, column = name.rpartition("/")
    kind = next((columns for columns in TOGETHER if column in columns), (column,))
    values = [np.abs(arrays[f"{place}/{one}"]).max(initial=0.0) for one in kind if f"{place}/{one}" in arrays]
    return max(*values, np.finfo(float).tiny) if values else np.finfo(float).tiny


def difference(mine, other):
    """Largest relative difference by group; 0 where all bits are the same."""
    found = dict.fromkeys([*GROUPS, "other"], 0.0)
    for name in other:
        if mine[name].shape != other[name].shape:
            found[group_of(name)] = np.inf  # other steps
        elif mine[name].tobytes() != other[name].tobytes():
            # Different bits are distinguished from the same ones: the two zeros have no difference.
            value = max(np.abs(mine[name] - other[name]).max() / size_of(name, other), np.finfo(float).tiny)
            found[group_of(name)] = max(found[group_of(name)], value)
    return found


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", nargs="+", type=Path, help="the first is what the others are compared with")
    parser.add_argument("--decks", type=int, default=70, help="decks; 70 are all types in all scenes (default)")
    parser.add_argument("--scenes", action="store_true", help="a row for each scene")
    options = parser.parse_args()
    programs = [path.resolve() for path in options.programs]
    rows = {}
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        decks = load_runs.write_decks(place / "decks", options.decks, 1)
        for deck in decks:
            status, reference = run(programs[0], place / "decks" / f"{deck}.k", place / "0" / deck)
            assert status == 0, deck
            for k, program in enumerate(programs[1:], 1):
                status, mine = run(program, place / "decks" / f"{deck}.k", place / str(k) / deck)
                found = difference(mine, reference) if status == 0 else dict.fromkeys([*GROUPS, "other"], np.inf)
                scene = deck[5:-2] if options.scenes else "all"
                rows.setdefault((options.programs[k], scene), []).append(found)
    print(f"compared with {options.programs[0]}; runs with the same bits, and the largest relative difference")
    print("| build | scene | runs | " + " | ".join(f"{group}: same | largest" for group in GROUPS) + " |")
    print("|---|---|---|" + "---|---|" * len(GROUPS))
    for (program, scene), found in rows.items():
        cells = [f"{sum(row[group] == 0.0 for row in found)} | {max(row[group] for row in found):.1e}" for group in GROUPS]
        print(f"| {program} | {scene} | {len(found)} | " + " | ".join(cells) + " |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
