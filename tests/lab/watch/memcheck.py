#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Run short decks of every kind under valgrind's memcheck: no invalid access, nothing uninitialised used, no leak.

The program is built without AVX-512, which valgrind does not know. After the true program come mistakes made on
purpose in a copy of the tree: each must be found. libraries.supp says what of the libraries is left out. Some
minutes in all.
"""
from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from watching import HERE, ROOT, Plant, build, build_with, copy_tree, jobs_of_machine, side_by_side

from kill_runs import with_end  # noqa: E402  (watching sets the path)
from refused_decks import refused_decks  # noqa: E402
from slideline_tools import scenes  # noqa: E402
from slideline_tools.scenes.patch import even_lines  # noqa: E402
from stock_list import RUN  # noqa: E402
from test_same_bits import TYPES, everything  # noqa: E402

FLAGS = "-O1 -g -march=x86-64-v2"
FOUND = 99
VALGRIND = ("valgrind", "--quiet", "--leak-check=full", "--errors-for-leak-kinds=definite", "--show-leak-kinds=definite",
            f"--error-exitcode={FOUND}", "--track-origins=yes", "--num-callers=20",
            f"--suppressions={HERE / 'libraries.supp'}")

PLANTS = (
    Plant("forces that are not set", "element/element_dispatch.f90",
          "    force = 0.0_wp\n    do i_chunk", "    do i_chunk", "uninitialised"),
    Plant("a write behind the force slots", "element/element_dispatch.f90",
          "do i = tile%first_special, tile%last_special\n", "do i = tile%first_special, tile%last_special + 1\n",
          "Invalid write"),
    Plant("a read behind the list of chunks", "element/quad.f90",
          "model%parts(model%layout%chunk_part(i_chunk))",
          "model%parts(min(1, model%layout%chunk_part(i_chunk + 1)))", "Invalid read"),
    Plant("factors of UMFPACK that are not given back", "linear/with_umfpack/umfpack.f90",
          "    call umfpack_di_free_numeric(factor%numeric)\n", "", "definitely lost"),
)


@dataclass
class Case:
    """Runs that follow each other in one folder; a path to a deck, or its text."""

    name: str
    deck: Path | str
    words: tuple[str, ...] = ()
    status: int = 0
    then: tuple[tuple[str, ...], ...] = ()


def with_restarts(text: str, cycles: int) -> str:
    """The deck with restart files every so many cycles."""
    return text.rsplit("*END", 1)[0] + (f"*DATABASE_BINARY_D3DUMP\n{cycles},\n*DATABASE_BINARY_RUNRSF\n{cycles},\n"
                                        "*END\n")


def sparse_patch() -> str:
    """A static patch whose band is wide enough for the sparse solver."""
    return scenes.patch(5, grids=scenes.patch_grids(even_lines(24), even_lines(22)), static=True)


def all_cases() -> list[Case]:
    """Every kind of run."""
    cases = []
    for kind in TYPES:
        cases.append(Case(f"block_{kind}", with_restarts(with_end(scenes.block(kind, n_slave=11, n_master=10), 40), 20),
                          then=(("r=out/job.dump01.h5", "d=out"),)))
        cases.append(Case(f"oblique_{kind}", with_end(scenes.oblique(kind), 60)))
        cases.append(Case(f"static_{kind}", scenes.patch(kind, static=True)))
        cases.append(Case(f"implicit_{kind}", with_end(scenes.block(kind, implicit=True, n_slave=11, n_master=10), 4)))
    cases.append(Case("threads", everything(5), ("ncpu=2", "perthread=1", "endtim=1e-3")))
    cases.append(Case("sparse", sparse_patch()))
    cases.append(Case("collision", with_restarts(with_end(scenes.collision(1, 3), 60), 50),
                      then=(("r=out/job.runrsf.h5", "d=out", "endtim=7e-6"),)))
    cases.append(Case("die", with_end(scenes.sliding(1, 7, rigid_die=True), 60)))
    cases.append(Case("check", with_end(scenes.collision(1, 6), 60), ("check", "--json")))
    cases += [Case(f"example_{path.stem}", path) for path in sorted((ROOT / "doc/examples").glob("*.k"))]
    stock = ROOT / "tests/program/stock"
    cases += [Case(f"stock_{name}", stock / f"stock_{name}.k") for name in RUN]
    cases += [Case(f"refused_{deck.name}", deck.folder / f"{deck.name}.k" if deck.family == "examples" else deck.text, status=1)
              for deck in refused_decks()]
    return cases


def run(program: Path, work: Path, case: Case, seconds: float) -> list[str]:
    """What is wrong with the runs of a case."""
    folder = work / "runs" / case.name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    deck = case.deck
    if isinstance(deck, str):
        (folder / "job.k").write_text(deck)
        deck = Path("job.k")
    first = (case.words[0], str(deck), *case.words[1:]) if "check" in case.words else (f"i={deck}", "d=out", *case.words)
    wrong = []
    for words in (first, *case.then):
        try:
            done = subprocess.run([*VALGRIND, str(program), *words], cwd=folder, stdin=subprocess.DEVNULL,
                                  capture_output=True, text=True, errors="replace", timeout=seconds, check=False)
        except subprocess.TimeoutExpired:
            return [*wrong, f"{case.name}: still running after {seconds} s"]
        if done.returncode != case.status:
            (folder / "said.txt").write_text(done.stderr)
            first_line = next((line for line in done.stderr.splitlines() if line.startswith("==")), done.stderr[:200])
            wrong.append(f"{case.name} {' '.join(words)}: status {done.returncode}, not {case.status}: {first_line}")
    return wrong


def plant_all(work: Path, build_tree, seconds: float) -> int:
    """Make one mistake after the other; the number of those that were not found."""
    missed = 0
    for number, plant in enumerate(PLANTS):
        program = build_with(plant, work / "tree", build_tree)
        if program is None:
            print(f"{plant.name}: not to be planted in {plant.file} as it is")
            missed += 1
            continue
        deck = sparse_patch() if "umfpack" in plant.file else with_end(scenes.block(2, n_slave=11, n_master=10), 10)
        case = Case(f"plant_{number}", deck)
        said = "\n".join(run(program, work, case, seconds))
        path = work / "runs" / case.name / "said.txt"
        found = f"status {FOUND}" in said and path.exists() and plant.where in path.read_text()
        missed += not found
        print(f"{plant.name}: {'found' if found else 'MISSED'} {said}", flush=True)
    return missed


def main() -> int:
    """The true program, then the planted mistakes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "memcheck", help="folder to work in")
    parser.add_argument("--only", default="", help="cases whose name fits this pattern")
    parser.add_argument("--seconds", type=float, default=1800.0, help="longest time of one run")
    parser.add_argument("--jobs", type=int, default=jobs_of_machine())
    options = parser.parse_args()
    if not shutil.which("valgrind"):
        raise SystemExit("valgrind is not installed (apt-get install valgrind)")
    cases = [case for case in all_cases() if re.search(options.only, case.name)]
    if not cases:
        raise SystemExit("no case is named so; there are: " + " ".join(case.name for case in all_cases()))
    work = options.work.resolve()
    copy_tree(work / "tree")

    def build_tree() -> Path:
        return build(work / "tree", work / "build", "Memcheck", FLAGS, "-DSLIDELINE_TESTS=OFF", jobs=options.jobs)

    program = build_tree()

    def one(case: Case) -> list[str]:
        wrong = run(program, work, case, options.seconds)
        print(case.name, "wrong" if wrong else "sound", flush=True)
        return wrong

    results = side_by_side(one, cases, options.jobs)
    wrong = [line for lines in results for line in lines]
    print("\n".join([*wrong, f"{len(cases)} cases, {len(wrong)} wrong"]), flush=True)
    return int(plant_all(work, build_tree, options.seconds) + len(wrong) > 0)


if __name__ == "__main__":
    sys.exit(main())
