#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Which lines of src/ a build with --coverage has run: tables for each folder and file, and the lines that were not.

unreached.txt holds the reasons: a file of src/ (or a pattern of files), a part of the line's text, and why no test
reaches it. Ends with status 1 if less than the least share was run, or if a line that was not run has no reason.
"""
from __future__ import annotations

import argparse
import fnmatch
import gzip
import json
import re
import subprocess
import sys
import tempfile
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
REASONS = Path(__file__).resolve().parent / "unreached.txt"
#: where gfortran puts what it makes by itself to copy and to clear the types of a module
END = re.compile(r"\s*end module\b")

Counts = dict[str, dict[int, int]]
Reason = tuple[str, str, str]


def read_notes(notes: Path) -> dict:
    """What gcov knows of one object file."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["gcov", "--json-format", str(notes)], cwd=folder, capture_output=True, check=True)
        with gzip.open(next(Path(folder).glob("*.gcov.json.gz"))) as stream:
            return json.load(stream)


def collect(build: Path, tree: Path, jobs: int) -> Counts:
    """How often each line of src/ ran, over all object files of its file: {file: {line: count}}."""
    counts: Counts = defaultdict(lambda: defaultdict(int))
    notes = [path for path in build.rglob("*.gcno") if "/src/" in str(path) and "/tests/" not in str(path)]
    with ThreadPoolExecutor(jobs) as pool:
        for known in pool.map(read_notes, sorted(notes)):
            for entry in known["files"]:
                path = Path(known["current_working_directory"], entry["file"]).resolve()
                if ROOT / "src" not in path.parents:
                    continue
                name = str(path.relative_to(ROOT))
                for line in entry["lines"]:
                    counts[name][line["line_number"]] += line["count"]
    for name, lines in counts.items():
        source = (tree / name).read_text().splitlines()
        for number in [number for number in lines if END.match(source[number - 1])]:
            del lines[number]
    return counts


def table(counts: Counts, key) -> list[str]:
    """Rows `share run lines name`, least first, of the files grouped by `key`.

    A process whose files may not grow tears the counters that it adds to, so that a line which ran may have a negative sum.
    """
    sums: dict[str, list[int]] = defaultdict(lambda: [0, 0])
    for name, lines in counts.items():
        sums[key(name)][0] += sum(count != 0 for count in lines.values())
        sums[key(name)][1] += len(lines)
    rows = sorted(sums.items(), key=lambda row: (row[1][0] / max(1, row[1][1]), row[0]))
    return [f"{100 * run / max(1, all_):7.2f} % {run:6d} of {all_:6d}  {name}" for name, (run, all_) in rows]


def read_reasons(path: Path) -> list[Reason]:
    """The lines `file | part of the line | reason` of unreached.txt."""
    rows = [line.split(" | ") for line in path.read_text().splitlines() if line.strip() and not line.startswith("#")]
    wrong = [row for row in rows if len(row) != 3 or not all(part.strip() for part in row)]
    if wrong:
        raise SystemExit(f"{path.name}: not `file | part of the line | reason`: {wrong[0]}")
    return [(row[0].strip(), row[1].strip(), row[2].strip()) for row in rows]


def reason_of(name: str, text: str, reasons: list[Reason]) -> int | None:
    """The number of the first reason that fits a line of a file."""
    for number, (files, part, _) in enumerate(reasons):
        if fnmatch.fnmatch(name, files) and (part == "*" or re.search(part, text)):
            return number
    return None


def unreached(counts: Counts, tree: Path, reasons: list[Reason]) -> tuple[list[str], int, set[int]]:
    """Listing of the lines that never ran, how many of them have no reason, the reasons used."""
    listing, bare, used = [], 0, set()
    for name in sorted(counts):
        source = (tree / name).read_text().splitlines()
        missed = sorted(number for number, count in counts[name].items() if count == 0)
        if missed:
            listing.append(name)
        for number in missed:
            found = reason_of(name, source[number - 1], reasons)
            bare += found is None
            used |= set() if found is None else {found}
            why = "?" if found is None else reasons[found][2]
            listing.append(f"{number:6d} {source[number - 1].rstrip():100s}  # {why}")
    return listing, bare, used


def main() -> int:
    """Write the page, say the sums."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path, help="folder of the build")
    parser.add_argument("--least", type=float, default=90.0, help="least share of lines in percent (90)")
    parser.add_argument("--output", type=Path, help="page to write (coverage.txt in the build)")
    parser.add_argument("--tree", type=Path, default=ROOT, help="the sources as they were built, if they have changed")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    counts = collect(options.build, options.tree, options.jobs)
    if not counts:
        raise SystemExit(f"no counts below {options.build}")
    reasons = read_reasons(REASONS)
    listing, bare, used = unreached(counts, options.tree, reasons)
    folders = table(counts, lambda name: str(Path(name).parent))
    (total,) = table(counts, lambda name: "all")
    page = options.output or options.build / "coverage.txt"
    page.write_text("\n".join(["by folder", *folders, total, "", "by file", *table(counts, str), "",
                               "lines that never ran, with the reason from unreached.txt", *listing]) + "\n")
    print("\n".join([*folders, total]))
    for number, (files, part, _) in enumerate(reasons):
        if number not in used:
            print(f"unreached.txt: nothing to explain by: {files} | {part}")
    print(f"{bare} lines without a reason; all lines are in {page}")
    return int(float(total.split("%")[0]) < options.least or bare > 0)


if __name__ == "__main__":
    sys.exit(main())
