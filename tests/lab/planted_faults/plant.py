#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Plant the faults of faults.toml, one at a time, and note which test notices each.

    plant.py [--build DIR] [--out FILE.csv] [--broader] [ID...]   these faults, or all that the table lacks
    plant.py --sound [ID...]                                      their nearest tests without a fault
    plant.py --random N [--seed S] [--folder contact/law]         N faults by rule (random_faults.py) against the broader tests

A fault is an edit of one place of src/. The edited file is compiled apart and its object stands before the
libraries on the link line of the program and of the unit tests, as the build has them: neither the sources
nor the build are touched. The nearest tests run in their order, with --broader then those of the folder,
until one fails. See README.md.
"""
from __future__ import annotations

import argparse
import csv
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path

import random_faults

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
COLUMNS = ("id", "noticed_by", "seconds")
NOT_NOTICED, BY_COMPILER = "not noticed", "the compiler"
LONGEST = 600.0  #: seconds that a test may take


class DoesNotCompile(SystemExit):
    """The compiler refuses the edited file."""


@dataclass(frozen=True)
class Fault:
    """One edit of a source file."""
    id: str
    file: str                   #: below src/
    find: str                   #: text that stands there once
    replace: str
    kind: str                   #: sign, factor, index, off by one, missing reset, ...
    capability: str
    tests: tuple[str, ...]      #: nearest first

    def text(self) -> str:
        """The file with the fault in it."""
        text = (ROOT / "src" / self.file).read_text(encoding="utf-8")
        if text.count(self.find) != 1 or self.find == self.replace:
            raise SystemExit(f"{self.id}: the text to find stands {text.count(self.find)} times in src/{self.file}; "
                             "bring faults.toml up to date")
        return text.replace(self.find, self.replace)


def read_faults(ids: list[str]) -> tuple[list[Fault], dict[str, list[str]]]:
    """The faults of these ids, or all, and the broader tests of each folder of src/."""
    content = tomllib.loads((HERE / "faults.toml").read_text(encoding="utf-8"))
    faults = [Fault(**{**entry, "tests": tuple(entry["tests"])}) for entry in content["fault"]]
    names = [fault.id for fault in faults]
    wrong = set(ids) - set(names) | {name for name in names if names.count(name) > 1}
    if wrong:
        raise SystemExit(f"no fault, or several, with the id {', '.join(sorted(wrong))}")
    return [fault for fault in faults if not ids or fault.id in ids], content["broader"]


def all_tests() -> list[str]:
    """Names of unit tests and cases, and files of the tests of the program."""
    tests = ROOT / "tests"
    return [*(f"unit.{path.parent.name}.{path.stem}" for path in sorted(tests.glob("unit/*/test_*.pf"))),
            *(f"verification.{path.parent.name}" for path in sorted(tests.glob("verification/*/check.py"))),
            *(f"program/{path.name}" for path in sorted(tests.glob("program/test_*.py"))), "rejected"]


class Planted:
    """A fault in the program and in the unit tests of a finished Ninja build; none: all as it is."""

    def __init__(self, build: Path, scratch: Path, fault: Fault | None) -> None:
        self.build, self.scratch, self.fault = build, scratch, fault
        self.made: dict[str, Path] = {}
        self.stands_for = ""   #: object of the build whose place the one with the fault takes
        self.object = scratch / "planted.o"
        if fault:
            (scratch / Path(fault.file).name).write_text(fault.text(), encoding="utf-8")
            self.compile(fault.file)

    def commands(self, target: str) -> list[str]:
        """What the build does for a target."""
        return self.run(["ninja", "-C", str(self.build), "-t", "commands", target]).stdout.splitlines()

    def compile(self, file: str) -> None:
        """Compile the edited file as the build does it, with its modules put aside."""
        words = next(shlex.split(line) for target in ("slideline", "slideline_mpi") for line in self.commands(target)
                     if f" -c {ROOT}/src/{file} -o " in line)
        self.stands_for = words[-1]
        modules = next(word for word in words if word.startswith("-J"))
        words = [word for word in words[:-4] if word != modules and not word.startswith("-W")]
        done = self.run([*words, "-w", f"-J{self.scratch}", f"-I{modules[2:]}", "-nocpp", "-c",
                         str(self.scratch / Path(file).name), "-o", str(self.object)], self.build)
        if done.returncode != 0:
            raise DoesNotCompile(f"{self.fault.id} does not compile:\n{done.stderr}")

    def link(self, target: str) -> Path:
        """The program or a unit test with the fault in it."""
        is_mpi = self.fault is not None and self.fault.file.startswith("parallel/mpi/")
        if target not in self.made:
            words = shlex.split(self.commands(target)[-1].removeprefix(": && ").removesuffix(" && :"))
            k = words.index("-o")
            self.made[target] = self.build / words[k + 1]
            if self.fault and (not is_mpi or target == "slideline_mpi"):
                self.made[target] = self.scratch / target
                objects = [word for word in words[:k] if word != self.stands_for]
                done = self.run([*objects, str(self.object), "-o", str(self.made[target]), *words[k + 2:]], self.build)
                if done.returncode != 0:
                    raise SystemExit(f"{self.fault.id}: {target} can not be linked:\n{done.stderr}")
        return self.made[target]

    def plant_tree(self) -> Path:
        """The tree with the fault in its sources, for tests that read them; what is not src or tests/house is linked."""
        tree = self.scratch / "tree"
        if not tree.exists():
            (tree / "tests").mkdir(parents=True)
            for path in (*ROOT.iterdir(), *(ROOT / "tests").iterdir()):
                copy = tree / path.relative_to(ROOT)
                if path.name in ("src", "house"):
                    shutil.copytree(path, copy)
                elif path.name != "tests":
                    copy.symlink_to(path)
            if self.fault:
                (tree / "src" / self.fault.file).write_text(self.fault.text(), encoding="utf-8")
        return tree

    def fails(self, test: str) -> bool:
        """Whether a test fails, or takes too long."""
        python, tests = sys.executable, ROOT / "tests"
        kind, name = re.split("[./]", test, maxsplit=1) if test != "rejected" else (test, "")
        if kind == "unit":
            command = [str(self.link(test))]
        elif kind == "program":
            command = [python, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", f"{tests}/{test}"]
        elif kind == "house":
            command = [python, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", str(self.plant_tree()/f"tests/{test}")]
        elif kind == "rejected":
            command = [python, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", f"{tests}/rejected"]
        else:
            command = [python, f"{tests}/{kind}/run_case.py", name, "--program", str(self.link("slideline")),
                       "--work", str(self.scratch / "work")]
        words = {"SLIDELINE_BUILD": "Release", "OPENBLAS_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive"}
        if kind != "unit":
            words["SLIDELINE"] = str(self.link("slideline"))
        if name.startswith("test_ranks"):
            words["SLIDELINE_MPI"] = str(self.link("slideline_mpi"))
        done = self.run(["timeout", str(LONGEST), *command], self.scratch if kind == "unit" else ROOT, words)
        (self.scratch / "last_test.txt").write_text(done.stdout + done.stderr)
        if "pytest" in command and done.returncode not in (0, 1, 124):
            raise RuntimeError(f"{test} does not run:\n{done.stdout[-1000:]}{done.stderr[-1000:]}")
        return done.returncode != 0

    @staticmethod
    def run(command: list[str], folder: Path = ROOT, words: dict[str, str] | None = None) -> subprocess.CompletedProcess[str]:
        """Run a command in a folder."""
        return subprocess.run(command, cwd=folder, env={**os.environ, **(words or {})}, text=True, capture_output=True)


def who_notices(planted: Planted, further: list[str]) -> str:
    """The first test that fails, of the nearest ones and of further ones."""
    for test in (*planted.fault.tests, *(test for test in further if test not in planted.fault.tests)):
        if planted.fails(test):
            return test
    return NOT_NOTICED


def read_table(path: Path) -> dict[str, dict[str, str]]:
    """The rows noted so far, by fault."""
    if not path.exists():
        return {}
    with open(path, newline="", encoding="utf-8") as stream:
        return {row["id"]: row for row in csv.DictReader(stream)}


def note(path: Path, row: dict[str, str]) -> None:
    """Put a row into the table, in place of an older one of the same fault."""
    rows = read_table(path) | {row["id"]: row}
    with open(path, "w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows.values())


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("ids", nargs="*", metavar="ID")
    parser.add_argument("--build", type=Path, default=ROOT / "build/release", help="a finished Ninja build with unit tests")
    parser.add_argument("--out", type=Path, default=ROOT / "build/noticed.csv", help="table, made or gone on with")
    parser.add_argument("--broader", action="store_true", help="go on with all tests of the folder")
    parser.add_argument("--sound", action="store_true", help="run the nearest tests without any fault")
    parser.add_argument("--random", type=int, metavar="N", help="this many faults by rule instead of the list")
    parser.add_argument("--seed", type=int, default=1, help="which of them")
    parser.add_argument("--folder", default="", help="folder of src/ to break, all unless given")
    options = parser.parse_args()
    faults, broader = read_faults(options.ids)
    if options.random:
        faults = [Fault(**drawn, capability="", tests=())
                  for drawn in random_faults.draw(ROOT / "src", options.folder, options.random, options.seed)]
    build = options.build.resolve()
    if options.sound:
        with tempfile.TemporaryDirectory() as scratch:
            sound = Planted(build, Path(scratch), None)
            for test in dict.fromkeys(test for fault in faults for test in fault.tests):
                print(f"{test} {'FAILS' if sound.fails(test) else 'passes'}", flush=True)
        return
    done = read_table(options.out)
    for fault in faults:
        if fault.id in done and not options.ids:
            continue
        start = time.monotonic()
        folder = fault.file.split("/")[0] if "/" in fault.file else "."
        further = [test for prefix in broader[folder] for test in all_tests() if test.startswith(prefix)] \
            if options.broader or options.random else []
        with tempfile.TemporaryDirectory() as scratch:
            try:
                noticed_by = who_notices(Planted(build, Path(scratch), fault), further)
            except DoesNotCompile:
                if not options.random:
                    raise
                noticed_by = BY_COMPILER
        seconds = f"{time.monotonic() - start:.0f}"
        note(options.out, {"id": fault.id, "noticed_by": noticed_by, "seconds": seconds})
        print(f"{fault.id}: {noticed_by}, {seconds} s", flush=True)
    rows = read_table(options.out).values()
    print(f"{sum(row['noticed_by'] != NOT_NOTICED for row in rows)} of {len(rows)} noticed")


if __name__ == "__main__":
    main()
