#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""All spins of doc/theory/elements.md: every form, coefficient, TSSFAC and mesh, each with the program's own steps
and then with its first step held. Writes DIR/all_spins.csv; takes minutes.
"""
import argparse
import csv
import itertools
import pathlib
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))

from run_case import Result  # noqa: E402
from scene import FULL, STIFFNESS_FORMS, TURN, VISCOUS_FORMS, Motion, spin_deck  # noqa: E402

FORMS = (*VISCOUS_FORMS, *STIFFNESS_FORMS, FULL)
COEFFICIENTS = (0.05, 0.1, 0.2, 0.3)
SCALES = (0.2, 0.5, 0.7, 0.9)
COLUMNS = ("form", "coefficient", "scale", "mesh", "step", "status", "turns", "ratio_min", "ratio_max", "ratio_end",
           "motion_min", "motion_max", "motion_end", "pattern_early", "pattern_late", "hourglass_end",
           "inertia_end")


def run_spin(program, work, case, turns, constant):
    """One run. Its row: energies over the initial one, `motion` that of the states alone (not of NIP 4, whose
    points the states do not hold), `pattern` the mean energy in the hourglass pattern in the second and in the
    last tenth of the run. And its first step."""
    form, coefficient, scale, mesh = case
    distorted = mesh == "distorted"
    folder = work / "run"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    deck = folder / "spin.k"
    deck.write_text(spin_deck(form, coefficient, scale, turns, distorted, constant, states=0.25).text())
    finished = subprocess.run([program, f"i={deck}", f"d={folder}", "jobid=spin"], capture_output=True,
                              text=True, timeout=600)
    result = Result(folder, "spin", finished)
    table, motion = result.table("glstat"), Motion(result, distorted)
    stored = motion.pattern_energy(coefficient) if form in STIFFNESS_FORMS else 0.0 * motion.kinetic()
    total = (motion.kinetic() + motion.strain_energy() + stored) / table["total"][0]
    if form == FULL:
        total = 0.0 * total
    tenth, ratio = len(stored) // 10, table["energy_ratio"]
    early, late = stored[tenth:2 * tenth].mean(), stored[-tenth:].mean()
    return dict(zip(COLUMNS, (
        form, coefficient, scale, mesh, "held" if constant else "own", finished.returncode,
        round(table["time"][-1] / TURN, 2), ratio.min(), ratio.max(), ratio[-1], total.min(), total.max(),
        total[-1], early / table["total"][0], late / table["total"][0],
        table["hourglass"][-1] / table["total"][0], motion.inertia()[-1] / motion.inertia()[0]))), table["dt"][0]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--work", required=True, type=pathlib.Path)
    parser.add_argument("--turns", type=float, default=50.0)
    options = parser.parse_args()
    program = options.program.resolve()
    options.work.mkdir(parents=True, exist_ok=True)
    with open(options.work / "all_spins.csv", "w", newline="") as stream:
        rows = csv.DictWriter(stream, COLUMNS)
        rows.writeheader()
        for case in itertools.product(FORMS, COEFFICIENTS, SCALES, ("regular", "distorted")):
            if case[0] == FULL and case[1] != COEFFICIENTS[0]:
                continue
            constant = None
            for _ in ("own", "held"):
                row, constant = run_spin(program, options.work, case, options.turns, constant)
                rows.writerow({name: f"{value:.6g}" if isinstance(value, float) else value
                               for name, value in row.items()})
            stream.flush()


if __name__ == "__main__":
    main()
