#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Run one verification case: `run_case.py CASE --program EXE --work DIR`.

The case is the folder CASE beside this file; its check.py holds `check(run)`, its
case.toml what is run and what each check is judged against (Run.entry):

    title = "bar at a wall"             # row and section (topic) of doc/verification.md
    against = "waves; momentum"
    topic = "Contact"
    decks = ["bar_deck: what it is"]    # functions that make decks, or files
    [quantity]                          # tolerance 0, kind "rel" where left out; full: of full runs alone
    "order of the *" = {tolerance = 0.1, kind = "abs", source = "second order"}
    "half width" = {tolerance = "words, where the case computes it", full = true}
    "force" = {tolerance = 0.5, scale = "words for what it is times"}

With `--full` (or SLIDELINE_FULL=1) it runs every combination and the longest
runs; without, as in CI, a covering design of them
(`run.cover`) and what else `run.is_full` leaves. Tolerances are the same.
With `--seed N --count M` a case of random scenes goes through M new ones
instead, `sweep(run, seed, count)` of its check.py.
Each check is printed as one line and kept in DIR/<case>.json, from which
make_table.py takes the figures of doc/verification.md. The exit status is 0
only if at least one check ran and all passed.
"""
import argparse
import csv
import collections
import fnmatch
import importlib.util
import itertools
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import traceback

import h5py
import numpy as np

try:
    import tomllib
except ModuleNotFoundError:  # Python before 3.11
    import tomli as tomllib

HERE = pathlib.Path(__file__).resolve().parent
TEXT_COLUMNS = ("side", "phase")


class Table(dict):
    """Columns of one CSV table as arrays."""

    def where(self, **wanted):
        """Rows in which each named column has the given value."""
        keep = np.ones(len(next(iter(self.values()))), dtype=bool)
        for name, value in wanted.items():
            keep &= self[name] == value
        return Table({name: column[keep] for name, column in self.items()})


class Result:
    """What one run of the program left behind."""

    def __init__(self, folder, job, finished):
        self.folder = folder
        self.job = job
        self.status = finished.returncode
        self.stdout = finished.stdout
        self.stderr = finished.stderr
        self._tables = {}
        self._arrays = {}

    @property
    def vtkhdf(self):
        return self.folder / f"{self.job}.vtkhdf"

    def csv_path(self, name):
        return self.folder / f"{self.job}.{name}.csv"

    def table(self, name):
        """The CSV table `name` (glstat, rcforc, nodout, contact, matsum)."""
        if name not in self._tables:
            with open(self.csv_path(name), newline="") as stream:
                rows = list(csv.reader(stream))
            columns = list(zip(*rows[1:])) if len(rows) > 1 else [()] * len(rows[0])
            self._tables[name] = Table(
                (head, np.array(column) if head in TEXT_COLUMNS else np.array(column, dtype=float))
                for head, column in zip(rows[0], columns))
        return self._tables[name]

    def node(self, user_id):
        """The nodout rows of one node."""
        return self.table("nodout").where(node=user_id)

    def _read(self, path):
        if path not in self._arrays:
            with h5py.File(self.vtkhdf, "r") as stream:
                self._arrays[path] = stream[path][()]
        return self._arrays[path]

    @property
    def times(self):
        """Times of the stored states."""
        return self._read("VTKHDF/Steps/Values")

    def _stacked(self, group, name):
        """Rows of each state, found through the offsets of the field."""
        values = self._read(f"VTKHDF/{group}/{name}")
        first = self._read(f"VTKHDF/Steps/{group}Offsets/{name}").ravel()
        size = int(self._read("VTKHDF/NumberOfPoints" if group == "PointData"
                              else "VTKHDF/NumberOfCells")[0])
        return np.stack([values[k:k + size] for k in first])

    def points(self, name):
        """Point field as (state, node[, component]); `Points` = current coordinates."""
        if name == "Points":
            values = self._read("VTKHDF/Points")
            return values.reshape((len(self.times), -1, 3))
        return self._stacked("PointData", name)

    def newton(self):
        """Iterations of each implicit step, from the log, as rows (energy ratio, |R| over its round-off)."""
        log = (self.folder / f"{self.job}.log").read_text()
        rows = re.findall(r"iteration (\d+): energy ratio (\S+), \|R\| (\S+) \(round-off (\S+)\)", log)
        values = np.array([(float(ratio), float(size) / float(floor)) for _, ratio, size, floor in rows])
        return np.split(values, [k for k, row in enumerate(rows) if row[0] == "1"][1:])

    def cells(self, name):
        """Cell field as (state, element[, component])."""
        return self._stacked("CellData", name)


def covering(sizes, strength):
    """Rows of indices below `sizes`, few of all: any values of any `strength` columns stand together in
    one of them. Greedily the row that brings the most, of several the one whose values are rarest."""
    rows = list(itertools.product(*map(range, sizes)))
    met = {row: set(itertools.combinations(enumerate(row), min(strength, len(sizes)))) for row in rows}
    left, used, kept = set().union(*met.values()), collections.Counter(), []
    while left:
        best = max(rows, key=lambda row: (len(met[row] & left), -sum(used[one] for one in enumerate(row))))
        kept.append(best)
        left -= met[best]
        used.update(enumerate(best))
    return sorted(kept)


class Run:
    """Handed to check(run): runs the program and keeps the verdicts."""

    def __init__(self, case, program, work, is_full=False):
        self.case = case
        self.is_full = is_full
        self.folder = HERE / case
        self.root = HERE.parents[1]
        self.program_path = program
        self.work = work / case
        self.records = []
        self.reported = []
        self.quantities = tomllib.loads((self.folder / "case.toml").read_text(encoding="utf-8"))["quantity"]
        self.used = set()
        self.is_partial = False
        self._n_run = 0
        shutil.rmtree(self.work, ignore_errors=True)
        self.work.mkdir(parents=True)

    def program(self, deck, *args, name=None, expect_status=0):
        """Run a deck (a path, a text or an object with text()) and return its Result.

        expect_status: None takes any."""
        self._n_run += 1
        name = name or f"run{self._n_run:02d}"
        folder = self.work / name
        folder.mkdir()
        if isinstance(deck, pathlib.Path):
            path = deck
        else:
            path = folder / f"{name}.k"
            path.write_text(deck if isinstance(deck, str) else deck.text())
        command = [str(self.program_path), f"i={path}", f"d={folder}", f"jobid={name}", *args]
        finished = subprocess.run(command, capture_output=True, text=True, timeout=600)
        (folder / "stdout.txt").write_text(finished.stdout)
        (folder / "stderr.txt").write_text(finished.stderr)
        if expect_status is not None and finished.returncode != expect_status:
            raise RuntimeError(f"{name}: exit status {finished.returncode}, expected "
                               f"{expect_status}\n{finished.stderr}{finished.stdout[-2000:]}")
        return Result(folder, name, finished)

    def cover(self, *values, strength=2):
        """Combinations of one of each of `values`: all, or a covering design where not `is_full`, in
        which any values of any `strength` of them meet (1: each value comes)."""
        values = [list(choice) for choice in values]
        if self.is_full:
            return list(itertools.product(*values))
        return [tuple(choice[k] for choice, k in zip(values, row))
                for row in covering([len(choice) for choice in values], strength)]

    def entry(self, quantity):
        """Entry of a check in `[quantity]` of case.toml: the first whose name, * for any text, fits what stands behind the
        last ": " of the check's name, or all of it where the entry has a ": "."""
        part = quantity.rsplit(": ", 1)[-1]
        for name, entry in self.quantities.items():
            if fnmatch.fnmatchcase(quantity if ": " in name else part, name.replace("[", "[[]")):
                self.used.add(name)
                return entry
        raise LookupError(f"{quantity}: no entry in {self.case}/case.toml")

    def leave_out(self, reason):
        """Part of the case cannot run here, so that entries of case.toml may stay unused."""
        self.is_partial = True
        self.report("left out", 0.0, reason)

    def unused(self):
        """Entries of case.toml that no check has asked for, but for those of full runs where this is none."""
        if self.is_partial:
            return []
        return [name for name, entry in self.quantities.items()
                if name not in self.used and (self.is_full or not entry.get("full"))]

    def goes_on(self, deck, cycle, whole, *tables):
        """Check that a run of the deck from its restart file of a cycle ends as the whole run: the same bits in tables."""
        text = deck if isinstance(deck, str) else deck.text()
        dumped = self.program(text.replace("*END", f"*DATABASE_BINARY_D3DUMP\n{cycle}\n*END"), name=f"{whole.folder.name}_dumped")
        folder = self.work / f"{whole.folder.name}_goes_on"
        folder.mkdir(exist_ok=True)
        done = subprocess.run([str(self.program_path), f"r={next(dumped.folder.glob('*.dump01.h5'))}", f"d={folder}"],
                              capture_output=True, text=True, timeout=600)
        self.true("the run goes on", done.returncode == 0)
        for table in tables:
            self.true(f"{table} is the same to the bit",
                      next(folder.glob(f"*.{table}.csv")).read_bytes() == whole.csv_path(table).read_bytes())

    def check(self, quantity, found, expected, scale=None, tol=None):
        """Compare and record. Arrays: largest difference, relative to the largest expected.

        The tolerance is that of case.toml, times `scale`, or `tol`, where case.toml has words for them.
        kind of case.toml: rel, abs, or one of the bounds min (found >= expected - tolerance) and max.
        """
        entry = self.entry(quantity)
        tolerance = entry.get("tolerance", 0.0)
        if isinstance(tolerance, str) == (tol is None) or ("scale" in entry) == (scale is None):
            raise ValueError(f"{quantity}: tol and scale in check.py only where case.toml has words for them")
        tol = float((1.0 if scale is None else scale) * tolerance if tol is None else tol)
        return self._compare(quantity, found, expected, tol, entry.get("kind", "rel"), entry.get("source", ""))

    def _compare(self, quantity, found, expected, tol, kind, source):
        found, expected = np.asarray(found, dtype=float), np.asarray(expected, dtype=float)
        try:
            difference = found - expected
        except ValueError as problem:
            return self._keep(quantity, math.nan, math.nan, math.nan, tol, kind, str(problem))
        if kind == "min":
            error = float(np.max(-difference)) if difference.size else math.nan
        elif kind == "max":
            error = float(np.max(difference)) if difference.size else math.nan
        else:
            error = float(np.max(np.abs(difference))) if difference.size else math.nan
            if kind == "rel":
                scale = float(np.max(np.abs(expected)))
                error = error / scale if scale > 0.0 else math.inf
        if difference.size > 1:
            found, expected = (np.broadcast_to(x, difference.shape).ravel()
                               for x in (found, expected))
            gap = np.abs(difference).ravel()
            worst = np.argmax(gap) if np.any(gap > 0.0) else np.argmax(np.abs(expected))
            found, expected = found[worst], expected[worst]
        elif difference.size == 1:
            found, expected = found.reshape(()), expected.reshape(())
        else:
            found = expected = math.nan
        return self._keep(quantity, float(found), float(expected), error, tol, kind, source)

    def _keep(self, quantity, found, expected, error, tol, kind, source):
        passed = bool(error <= tol)
        self.records.append({"quantity": quantity, "found": found, "expected": expected,
                             "error": error, "tolerance": tol, "kind": kind,
                             "source": source, "passed": passed})
        print(f"{'pass' if passed else 'FAIL'}  {self.case}: {quantity}: found {found:.9g}, "
              f"expected {expected:.9g}, error {error:.3g} ({kind}, tolerance {tol:.3g})",
              flush=True)
        return passed

    def true(self, quantity, condition):
        """A yes-or-no check."""
        return self._compare(quantity, 1.0 if condition else 0.0, 1.0, 0.0, "abs", self.entry(quantity).get("source", ""))

    def report(self, quantity, value, note=""):
        """A figure for the table that is not judged."""
        self.reported.append({"quantity": quantity, "found": float(value), "note": note})
        print(f"note  {self.case}: {quantity}: {float(value):.6g} {note}", flush=True)

    @staticmethod
    def order(sizes, errors):
        """Slope of log(error) over log(size) between the last two entries."""
        return float(np.log(errors[-2] / errors[-1]) / np.log(sizes[-2] / sizes[-1]))


def load_case(case):
    sys.path[:0] = [str(HERE / case), str(HERE), str(HERE.parents[1] / "tools")]
    spec = importlib.util.spec_from_file_location(f"check_{case}", HERE / case / "check.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("case")
    parser.add_argument("--program", type=pathlib.Path,
                        default=HERE.parents[1] / "build" / "release" / "slideline")
    parser.add_argument("--work", type=pathlib.Path,
                        default=HERE.parents[1] / "build" / "verification")
    parser.add_argument("--full", action="store_true", default=os.environ.get("SLIDELINE_FULL") == "1",
                        help="every combination, not a covering design (or SLIDELINE_FULL=1)")
    parser.add_argument("--seed", type=int, help="go through new random scenes")
    parser.add_argument("--count", type=int, default=60, help="so many of each family")
    options = parser.parse_args()
    work = options.work.resolve()
    work.mkdir(parents=True, exist_ok=True)
    run = Run(options.case, options.program.resolve(), work, options.full)
    problem = None
    try:
        case = load_case(options.case)
        if options.seed is None:
            case.check(run)
            if run.unused():
                raise LookupError(f"{options.case}/case.toml: no check asks for " + ", ".join(run.unused()))
        else:
            case.sweep(run, options.seed, options.count)
    except Exception:  # the case fails, with the reason on record
        problem = traceback.format_exc()
        print(problem, flush=True)
    n_failed = sum(not record["passed"] for record in run.records) + (problem is not None)
    n_passed = sum(record["passed"] for record in run.records)
    report = {"case": options.case, "full": options.full, "checks": run.records, "reported": run.reported,
              "problem": problem}
    part = work / f"{options.case}.json.part"  # a site that is built meanwhile reads whole files
    part.write_text(json.dumps(report, indent=1) + "\n")
    part.replace(part.with_suffix(""))
    if not run.records:
        print("no check ran")
    print(f"{n_passed} passed, {n_failed} failed")
    return 0 if n_failed == 0 and n_passed > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
