# SPDX-License-Identifier: MIT
"""What the scripts of this folder share: builds of the program with other options, decks, runs side by side."""
from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path[:0] = [str(ROOT / "tools"), *(str(ROOT / "tests" / name) for name in ("program", "verification", "rejected"))]


def run_or_stop(words: list[str], log: Path) -> None:
    """Run a command of the build; its output goes behind what the log has."""
    with open(log, "a") as stream:
        done = subprocess.run(words, stdout=stream, stderr=subprocess.STDOUT, check=False)
    if done.returncode:
        print(log.read_text()[-4000:], file=sys.stderr)
        raise SystemExit(f"{' '.join(words[:4])} ... failed; its output is in {log}")


def build(tree: Path, folder: Path, kind: str, flags: str, *options: str, jobs: int = 2) -> Path:
    """Build `tree` in `folder` as build type `kind` with these compiler flags; returns the program."""
    folder.mkdir(parents=True, exist_ok=True)
    log = folder / "build.log"
    log.write_text("")
    run_or_stop(["cmake", "-S", str(tree), "-B", str(folder), f"-DCMAKE_BUILD_TYPE={kind}",
                 f"-DCMAKE_Fortran_FLAGS_{kind.upper()}={flags}", f"-DPython3_EXECUTABLE={sys.executable}",
                 *options], log)
    run_or_stop(["cmake", "--build", str(folder), "--parallel", str(jobs)], log)
    return folder / "slideline"


def side_by_side(work: Callable, cases: Iterable, jobs: int) -> list:
    """`work` of each case, some at a time, in the order of the cases."""
    with ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(work, cases))


def jobs_of_machine() -> int:
    """Cores to use unless reported otherwise."""
    return os.cpu_count() or 1


@dataclass
class Plant:
    """A mistake to make on purpose."""

    name: str
    file: str         #: of src/
    old: str          #: text that is there, once
    new: str          #: text in its place
    where: str = ""   #: file that a report must name


def copy_tree(copy: Path) -> None:
    """The sources as they are, files that have not changed left alone, so that little is built anew."""
    for path in [ROOT / "CMakeLists.txt", *(ROOT / "src").rglob("*")]:
        if path.is_file():
            target = copy / path.relative_to(ROOT)
            target.parent.mkdir(parents=True, exist_ok=True)
            if not target.exists() or target.read_bytes() != path.read_bytes():
                target.write_bytes(path.read_bytes())


def build_with(plant: Plant, tree: Path, build_tree: Callable[[], Path]) -> Path | None:
    """The program with one mistake made in a copy of the tree, which is left as it was; None if the text is not there."""
    path = tree / "src" / plant.file
    whole = path.read_text()
    if whole.count(plant.old) != 1:
        return None
    path.write_text(whole.replace(plant.old, plant.new))
    try:
        return build_tree()
    finally:
        path.write_text(whole)
