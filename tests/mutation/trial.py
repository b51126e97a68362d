# SPDX-License-Identifier: MIT
"""Compiles one mutant, links it into the tests that may notice it, and runs them until one does.

Everything else comes from a finished Ninja build, which is only read: the object of the mutant stands
before the libraries on the link line, so that the linker never looks for the original. Limits are on
processor time, so that a machine under load, or a pause, takes no mutant for a hang.
"""
from __future__ import annotations

import os
import re
import resource
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mutants import Mutant
from replay import does_the_same, finish_recording, start_recording

ROOT = Path(__file__).resolve().parents[2]
#: layer -> unit tests that run it
UNIT_TESTS = {"contact": ("contact/test_*", "solve/test_implicit_forces"),
              "material": ("material/test_*", "element/test_*", "solve/test_implicit_forces")}
#: layer -> cases of tests/verification and tests/regression that run it
CASES = {"contact": ("contact_forces", "collision_*", "closed_chains", "deep_first_contact", "chain_end",
                     "block_to_block", "contact_patch_static", "momentum_and_third_law", "stable_step"),
         "material": ("element_*", "rigid_spin", "symmetric_plate_*")}
MOST_MEMORY = 4 << 30
PATIENCE, LEAST_SECONDS = 10.0, 5.0  # processor time allowed: this many times that of the original


@dataclass
class Check:
    """One test program or case."""
    name: str
    target: str                 # what is linked
    command: tuple[str, ...]    # {program} and {work} stand for the program and a folder

    seconds: float = 0.0        # processor time of the original
    n_run: int = 0
    n_noticed: int = 0

    @property
    def is_unit(self) -> bool:
        """Whether it is a unit test."""
        return self.target != "slideline"

    @property
    def promise(self) -> float:
        """Share of mutants noticed so far per second."""
        return (self.n_noticed + 1.0)/(self.n_run + 2.0)/(self.seconds + 0.3)


class Build:
    """A finished Ninja build of the tree."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        self._commands: dict[str, list[str]] = {}

    def _of(self, target: str) -> list[str]:
        if target not in self._commands:
            done = subprocess.run(["ninja", "-C", str(self.folder), "-t", "commands", target],
                                  capture_output=True, text=True, check=True)
            self._commands[target] = done.stdout.splitlines()
        return self._commands[target]

    def compile_command(self, layer: str, name: str, source: Path, scratch: Path) -> list[str]:
        """How the build compiles src/<layer>/<name>, applied to `source`."""
        ending = f"-o CMakeFiles/{layer}.dir/src/{layer}/{name}.o"
        line = next(line for line in self._of(layer) if line.endswith(ending))
        words = [word for word in shlex.split(line[:line.index(" -fpreprocessed -c ")])
                 if not word.startswith(("-J", "-W"))]
        return [*words, "-w", f"-J{scratch}", f"-Imodules/{layer}", "-c", str(source), "-o",
                str(scratch / f"{self.folder.name}.o")]

    def link_command(self, target: str, scratch: Path) -> list[str]:
        """How the build links a program, with the mutant before its libraries."""
        line = re.sub(r"^: && | && :$", "", self._of(target)[-1])
        words = shlex.split(line)
        k = words.index("-o")
        return [*words[:k], str(scratch / f"{self.folder.name}.o"), "-o", str(scratch / target), *words[k + 2:]]


def list_checks(layer: str) -> list[Check]:
    """All checks that may notice a mutant of a layer."""
    tests, python = ROOT / "tests", sys.executable
    checks = []
    for pattern in UNIT_TESTS[layer]:
        for path in sorted((tests / "unit").glob(f"{pattern}.pf")):
            name = f"unit.{path.parent.name}.{path.stem}"
            checks.append(Check(name, name, ("{program}",)))
    for label, marker in (("verification", "check.py"), ("regression", "case.toml")):
        for pattern in CASES[layer]:
            for path in sorted((tests / label).glob(f"{pattern}/{marker}")):
                checks.append(Check(f"{label}.{path.parent.name}", "slideline",
                                    (python, f"{tests}/{label}/run_case.py", path.parent.name,
                                     "--program", "{program}", "--work", "{work}")))
    return checks


def run_limited(command: list[str], seconds: float, scratch: Path, folder: Path) -> tuple[int, float]:
    """Exit status and processor time of a command held to `seconds` of the latter."""
    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (int(seconds) + 1, int(seconds) + 2))
        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    paths = f"{ROOT}/tools:{os.environ.get('PYTHONPATH', '')}"
    environment = {**os.environ, "SLIDELINE": str(scratch / "slideline"), "PYTHONPATH": paths,
                   "OMP_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1", "TMPDIR": str(scratch)}
    with open(scratch / "output.txt", "w") as stream:
        child = subprocess.Popen(command, cwd=folder, stdout=stream, stderr=stream,
                                 stdin=subprocess.DEVNULL, preexec_fn=limit, env=environment,
                                 start_new_session=True)
        _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, usage.ru_utime + usage.ru_stime


class Trial:
    """A folder in which mutants are compiled, linked and run one after the other."""

    def __init__(self, units: Build, program: Build, scratch: Path) -> None:
        self.units = units       # the build of the unit tests
        self.program = program   # the build of the program
        self.scratch = scratch.resolve()
        self.records = units.folder / "mutation" / "records"
        self.source = ("", "")   # layer and file of the mutant
        self.made: set[str] = set()

    def start(self, layer: str, name: str, text: str) -> bool:
        """Compile a source text in the place of src/<layer>/<name>; False if it does not compile."""
        shutil.rmtree(self.scratch, ignore_errors=True)
        self.scratch.mkdir(parents=True)
        self.source, self.made = (layer, name), set()
        (self.scratch / name).write_text(text)
        return self.compile(self.units)

    def compile(self, build: Build) -> bool:
        """Compile the mutant as a build does it."""
        layer, name = self.source
        command = build.compile_command(layer, name, self.scratch / name, self.scratch)
        done = subprocess.run(command, cwd=build.folder, capture_output=True, text=True)
        (self.scratch / "compiler.txt").write_text(done.stderr)
        self.made.add(build.folder.name)
        return done.returncode == 0

    def link(self, check: Check) -> Path:
        """The program that a check runs, with the mutant in it."""
        build = self.units if check.is_unit else self.program
        if build.folder.name not in self.made and not self.compile(build):
            raise RuntimeError(f"{self.source[1]} does not compile in {build.folder}")
        if check.target not in self.made:
            subprocess.run(build.link_command(check.target, self.scratch), cwd=build.folder,
                           check=True, capture_output=True)
            self.made.add(check.target)
        return self.scratch / check.target

    def run(self, check: Check, seconds: float, program: Path | None = None,
            work: Path | None = None) -> tuple[str, float]:
        """How a check ends ("" if all is well) and the processor time it took."""
        program = program or self.link(check)
        names = {"program": str(program), "work": str(work or self.scratch / "work")}
        command = [word.format(**names) for word in check.command]
        status, used = run_limited(command, seconds, self.scratch,
                                   self.scratch if check.is_unit else ROOT)
        shutil.rmtree(self.scratch / "work", ignore_errors=True)
        return verdict(status, used, seconds), used

    def record(self, check: Check) -> tuple[str, float]:
        """Run a case with the original, and write down what its runs leave behind."""
        folder = self.records / check.name
        how, used = self.run(check, 600.0, start_recording(folder, self.link(check)), folder / "work")
        if not how:
            finish_recording(folder)
        return how, used

    def try_out(self, check: Check) -> str:
        """How a check of the mutant ends; "" also where all its runs do what those of the original did."""
        seconds = max(LEAST_SECONDS, PATIENCE*check.seconds)
        if not check.is_unit and does_the_same(
                self.records / check.name, self.link(check), self.scratch,
                lambda command, where: run_limited(command, seconds, self.scratch, where)):
            return ""
        return self.run(check, seconds)[0]


def verdict(status: int, used: float, seconds: float) -> str:
    """In a word how a check ended; empty if it passed."""
    if status == 0:
        return ""
    if status in (-9, -24) or used > seconds:
        return "hang"
    return "crash" if status < 0 else "failed"


def measure(trial: Trial, checks: list[Check], layer: str) -> Iterator[Check]:
    """Run checks with an original in the place of the mutant: costs; -1 for a check that fails."""
    path = sorted((ROOT / "src" / layer).glob("*.f90"))[0]
    if not trial.start(layer, path.name, path.read_text()):
        raise SystemExit(f"{path} does not compile: is {trial.units.folder} up to date?")
    for check in checks:
        how, used = trial.run(check, 600.0) if check.is_unit else trial.record(check)
        check.seconds = -1.0 if how else used
        print(f"{check.name}: {how or 'passed'}, {used:.2f} s", flush=True)
        yield check


def try_mutant(trial: Trial, checks: list[Check], mutant: Mutant) -> tuple[str, str]:
    """(verdict, name of the check that noticed it) of a mutant."""
    layer, name = mutant.file.split("/")
    text = mutant.apply((ROOT / "src" / mutant.file).read_text(encoding="utf-8"))
    if not trial.start(layer, name, text):
        return "not compiled", ""
    own = f"unit.{layer}.test_{Path(name).stem}"
    for stage in ([check for check in checks if check.name == own],
                  [check for check in checks if check.is_unit and check.name != own],
                  [check for check in checks if not check.is_unit]):
        for check in sorted(stage, key=lambda check: -check.promise):
            how = trial.try_out(check)
            check.n_run += 1
            if how:
                check.n_noticed += 1
                return how, check.name
    return "survived", ""
