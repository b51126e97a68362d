# SPDX-License-Identifier: MIT
"""Regression cases: run a deck, compare its histories with stored references, renew these.

A reference keeps ROWS rows of a table, the first and the last among them, and the digits that matter for the tolerance;
they are compared with the run at the same times. A case is a folder with `case.toml`:

    deck = "input/collision/collision.k"    # below the root of the repository
    arguments = ["ctype=1"]                 # for the program, may be left out
    [[table]]
    name = "glstat"                         # reference: glstat.csv in the folder
    columns = ["kinetic", "internal"]
    where = { part = 2 }                    # rows to keep, may be left out
    rtol = 1e-3                             # also floor, atol, time, measures
    tolerance.kinetic.rtol = 1e-4           # for one column
    [[blessed]]                             # written by `run_case.py CASE --bless REASON`, newest last
    date = "2026-01-31"
    reason = "first reference"
"""
import datetime
import json
import math
import pathlib
import subprocess

import numpy as np

try:
    import tomllib
except ModuleNotFoundError:  # Python before 3.11
    import tomli as tomllib

from slideline_tools import UserError
from slideline_tools.compare import (MEASURES, Tolerance, compare, judged_columns,
                                     require_usable, unique_times)
from slideline_tools.histories import History, read_csv

ROWS = 20
TIME_DIGITS = 10


class CaseError(UserError):
    """A case that cannot be read or whose program run failed."""


class Case:
    """One regression case; `folder` holds its case.toml."""

    def __init__(self, folder, root):
        self.folder = pathlib.Path(folder)
        self.root = pathlib.Path(root)
        self.file = self.folder / "case.toml"
        try:
            self.content = tomllib.loads(self.file.read_text(encoding="utf-8"))
        except (OSError, tomllib.TOMLDecodeError) as problem:
            raise CaseError(f"cannot read {self.file}: {problem}") from problem
        if "deck" not in self.content or not self.content.get("table"):
            raise CaseError(f"{self.file}: a case needs a deck and at least one [[table]]")

    def run(self, program, work):
        """Run the program in `work`; returns the folder of the results."""
        work = pathlib.Path(work)
        work.mkdir(parents=True, exist_ok=True)
        for old in work.glob("case.*"):
            old.unlink()
        command = [str(pathlib.Path(program).resolve()), f"i={self.root / self.content['deck']}",
                   f"d={work}", "jobid=case", *self.content.get("arguments", ())]
        try:
            finished = subprocess.run(command, capture_output=True, text=True, check=False)
        except OSError as problem:
            raise CaseError(f"cannot start {program}: {problem.strerror}") from problem
        if finished.returncode != 0:
            raise CaseError(f"the program ended with status {finished.returncode}:\n"
                            f"{finished.stdout[-2000:]}{finished.stderr[-2000:]}")
        return work

    def table(self, entry, work):
        """The rows of one table of the run that the case looks at."""
        table = read_csv(pathlib.Path(work) / f"case.{entry['name']}.csv")
        return table.where(**entry.get("where", {}))

    def reports(self, work):
        """Compare every table of a finished run with its reference."""
        for entry in self.content["table"]:
            reference = read_csv(self.reference_file(entry))
            reference.name = f"{self.folder.name}: {entry['name']}"
            default = tolerance(entry)
            special = {name: tolerance({**entry, **changes})
                       for name, changes in entry.get("tolerance", {}).items()}
            judged_columns(reference, entry["columns"])
            yield compare(at_times_of(reference, self.table(entry, work)), reference, entry["columns"], special, default)

    def reference_file(self, entry):
        return self.folder / entry.get("reference", f"{entry['name']}.csv")

    def bless(self, work, reason, version=""):
        """Make the histories of a finished run the reference and note the reason."""
        # Several entries may look at columns of one file, each with its own tolerance.
        names, tables, digits = {}, {}, {}
        for entry in self.content["table"]:
            file, table = self.reference_file(entry), self.table(entry, work)
            columns = ["time", *table.entity_columns, *judged_columns(table, entry["columns"])]
            tables[file], names[file] = table, names.get(file, {}) | dict.fromkeys(columns)
            digits[file] = max(digits.get(file, 0), digits_that_matter(entry))
        for file, table in tables.items():
            rows = table.rows(kept_rows(table, list(names[file])))
            write_reference(file, rows, list(names[file]), digits[file])
        note = ["", "[[blessed]]", f'date = "{datetime.date.today().isoformat()}"',
                f"reason = {json.dumps(reason)}"]
        note += [f"version = {json.dumps(version)}"] if version else []
        with open(self.file, "a", encoding="utf-8") as stream:
            stream.write("\n".join(note) + "\n")


def tolerance(entry):
    """Tolerance with the keys that a [[table]] may give."""
    given = {key: float(entry[key]) for key in ("rtol", "floor", "atol", "time") if key in entry}
    return Tolerance(**given, measures=tuple(entry.get("measures", MEASURES)))


def kept_rows(table, names):
    """Numbers of the rows that a reference keeps: ROWS at most, spread evenly over those with values other than zero."""
    values = [name for name in names if name in table.value_columns]
    active = np.flatnonzero(np.any([table[name] != 0 for name in values], axis=0))
    rows = np.unique([0, *active, len(table) - 1])
    return rows[np.unique(np.linspace(0, len(rows) - 1, ROWS).round().astype(int))]


def at_times_of(reference, table):
    """The values of a run at the times of the rows of its reference, entity by entity, interpolated between its rows."""
    names = reference.value_columns
    require_usable(table, "result", names)
    numbered = History(reference.name, {**reference.columns, "row": np.arange(len(reference))})
    ours, theirs = dict(table.series()), dict(numbered.series())
    if set(ours) != set(theirs):
        odd = ", ".join(sorted(map(str, set(ours) ^ set(theirs))))
        raise UserError(f"{reference.name}: only one of the tables has {reference.entity_columns} {odd}")
    end, wanted = table["time"][-1], reference["time"][-1]
    if abs(end - wanted) > np.max(np.diff(table["time"]), initial=0.0):
        raise UserError(f"{reference.name}: the run ends at {end:g}, the reference at {wanted:g}")
    columns = {**reference.columns, **{name: np.zeros(len(reference)) for name in names}}
    for entity, rows in theirs.items():
        for name in names:
            time, values = unique_times(ours[entity]["time"], ours[entity][name])
            columns[name][rows["row"]] = np.interp(rows["time"], time, values)
    return History(table.name, columns)


def digits_that_matter(entry):
    """Significant digits of a reference: two more than its tightest tolerance."""
    rtol = min(tolerance({**entry, **changes}).rtol for changes in [{}, *entry.get("tolerance", {}).values()])
    return 2 + math.ceil(-math.log10(rtol) - 1.0e-9)


def write_reference(path, table, names, digits):
    """A CSV file of the given columns, reals with so many significant digits."""
    columns = [[f"{value:.{TIME_DIGITS if name == 'time' else digits}g}"
                if isinstance(value, float) else str(value) for value in table[name].tolist()]
               for name in names]
    path.write_text("\n".join(map(",".join, [names, *zip(*columns)])) + "\n", encoding="ascii")


def run_case(case, program, work, out):
    """Run and compare a case; reports go to `out`. Returns 0 passed, 1 failed, 2 unusable."""
    try:
        reports = list(case.reports(case.run(program, work)))
        for report in reports:
            print(report.text(), file=out)
        return 0 if all(report.passed for report in reports) else 1
    except (UserError, OSError) as problem:
        print(f"{case.folder.name}: {problem}", file=out)
        return 2


def renew(case, program, work, reason):
    """Run a case and make its histories the reference, for a reason that case.toml keeps."""
    if not reason.strip():
        raise CaseError("the reason must say something")
    case.bless(case.run(program, work), reason.strip(), program_version(program))


def program_version(program):
    """First line of `--version`, without anything that looks like a path."""
    finished = subprocess.run([str(program), "--version"], capture_output=True, text=True,
                              check=False)
    line = (finished.stdout.splitlines() or [""])[0]
    return "" if "/" in line else line.strip()
