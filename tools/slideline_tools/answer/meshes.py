# SPDX-License-Identifier: MIT
"""Runs of a deck on finer and finer meshes, kept in a folder and taken up again."""
import contextlib
import dataclasses
import hashlib
import json
import pathlib
import re
import subprocess
import threading
import time
import typing

from slideline_tools import UserError
from slideline_tools.answer.divide import divided, node_sets
from slideline_tools.draw.model import check_deck
from slideline_tools.effective_deck import read_blocks
from slideline_tools.files import folder as made
from slideline_tools.finished_run import Run
from slideline_tools.program import Outcome, not_run, run

RECORD = "answer_run.json"
SHARE = 0.3  # of the whole error, in the elements that are divided
EVERY = 5.0  # seconds between two lines of progress


@dataclasses.dataclass(frozen=True)
class MeshRun:
    """A finished run: the factor of its mesh, its elements, element updates (elements times cycles) and seconds."""

    mesh: float
    elements: int
    updates: int
    seconds: float
    outcome: Outcome
    kept: bool = False


@dataclasses.dataclass
class Meshes:
    """The meshes of a deck.

    `deck`        the deck; with `parameter` and {parameter} in its name, the decks of a generator
    `folder`      of the runs, one below it for each mesh
    `parameter`   of the deck, or in its name, that makes the mesh; '' where the mesh is divided
    `parameters`  of all runs, as for `program.run`
    `tell`        gets the progress of long runs
    """

    deck: pathlib.Path
    folder: pathlib.Path
    program: str
    threads: int = 1
    parameter: str = ""
    parameters: dict[str, typing.Any] = dataclasses.field(default_factory=dict)
    tell: typing.Callable[[str], None] = lambda line: None
    _sets: dict[int, list[int]] | None = None

    @property
    def name(self) -> str:
        """The stem of the deck, without its parameter."""
        return self.deck.stem.replace(f"{{{self.parameter}}}", "").rstrip("_-.") if self.parameter else self.deck.stem

    def run(self, factor: int, limit: float | None = None) -> MeshRun:
        """The run on the mesh divided by `factor`: as it is kept, else anew. RunError where it fails, or takes longer than `limit`."""
        deck, parameters = self.deck_of(factor)
        folder = self.folder / f"mesh_{factor}"
        mark = self.mark(deck, parameters)
        made(folder)
        if (kept := self.record(folder, deck, parameters, mark)) is not None:
            return kept
        with followed(folder / "status.out", self.tell):
            outcome = run(deck, folder, program=self.program, threads=self.threads, limit=limit, **parameters)
        cycles = int(outcome.history("glstat")["cycle"][-1])
        elements = count_elements(folder / f"{outcome.job}.effective.k")
        timing = outcome.history("timing")
        seconds = float(timing["seconds"][timing["phase"] == "total"][0])
        facts = {"mark": mark, "elements": elements, "updates": elements * cycles, "seconds": seconds}
        (folder / RECORD).write_text(json.dumps(facts) + "\n", encoding="ascii")
        return MeshRun(factor, elements, elements * cycles, seconds, outcome)

    def deck_of(self, factor: int) -> tuple[pathlib.Path, dict[str, typing.Any]]:
        """The deck of a mesh and its parameters."""
        if f"{{{self.parameter}}}" in self.deck.name:
            return self.deck.with_name(self.deck.name.replace(f"{{{self.parameter}}}", str(factor))), self.parameters
        if self.parameter:
            return self.deck, {**self.parameters, f"p:{self.parameter}": factor}
        if factor == 1:
            return self.deck, self.parameters
        path = self.folder / f"mesh_{factor}" / f"{self.deck.stem}.k"
        text = self.folder / "mesh_1" / f"{self.deck.stem}.effective.k"
        if self._sets is None:
            self._sets = node_sets(check_deck(text, self.program))
        whole = divided(text.read_text(encoding="utf-8"), self._sets, factor)
        made(path.parent)
        path.write_text(whole, encoding="utf-8")
        return path, {}

    def mark(self, deck: pathlib.Path, parameters) -> str:
        """A digest of what a run depends on."""
        if not deck.is_file():
            raise UserError(f"{deck}: no such file")
        parts = [*(file.read_bytes() for file in files_of(deck)), json.dumps(parameters, sort_keys=True, default=str).encode(), version(self.program)]
        return hashlib.sha256(b"\0".join(parts)).hexdigest()

    def record(self, folder, deck, parameters, mark) -> MeshRun | None:
        """The kept run of a folder where it is of the same deck, parameters and program."""
        try:
            facts = json.loads((folder / RECORD).read_text(encoding="ascii"))
        except (OSError, ValueError):
            return None
        if facts.get("mark") != mark:
            return None
        factor = int(folder.name.rpartition("_")[2])
        return MeshRun(factor, facts["elements"], facts["updates"], facts["seconds"],
                       Outcome(folder, deck.stem, dict(parameters), 0, ""), True)


@contextlib.contextmanager
def followed(status: pathlib.Path, tell):
    """Tell every five seconds what the status file of a run says of the time to go."""
    ended, start = threading.Event(), time.time()

    def follow():
        while not ended.wait(EVERY):
            if status.exists() and status.stat().st_mtime >= start:
                if found := re.search(r"time to complete\s+(\S+)", status.read_text(encoding="utf-8", errors="replace")):
                    tell(f"  {found[1]} to go")
    watch = threading.Thread(target=follow, daemon=True)
    watch.start()
    try:
        yield
    finally:
        ended.set()
        watch.join()


class AdaptedMeshes(Meshes):
    """Meshes each of which is the one before, finer where its error is large and along contact surfaces; their factor is that
    of the divided mesh with as many elements."""

    def run(self, factor: int, limit: float | None = None) -> MeshRun:
        """Run number `factor` of the deck."""
        found = super().run(factor, limit)
        if factor == 1:
            self.first = found.elements
        return dataclasses.replace(found, mesh=round((found.elements / self.first) ** 0.5, 3))

    def deck_of(self, factor: int) -> tuple[pathlib.Path, dict[str, typing.Any]]:
        """The deck with its error as a field, or that of the run before refined."""
        from slideline_tools.answer.refine import refine_run
        path = self.folder / f"mesh_{factor}" / f"{self.deck.stem}.k"
        if factor == 1:
            if not self.deck.is_file():
                raise UserError(f"{self.deck}: no such file")
            folders = [self.deck.parent / line.strip() for file in files_of(self.deck) for block in read_blocks(
                file.read_text(encoding="utf-8", errors="replace"), "INCLUDE_PATH") for line in block.lines]
            paths = "".join(f"*INCLUDE_PATH\n{folder.resolve()}\n" for folder in folders)
            text = f"*KEYWORD\n{paths}*INCLUDE\n{self.deck.resolve()}\n*DATABASE_ERROR_INDICATOR\n*END\n"
        else:
            before = Run(self.folder / f"mesh_{factor - 1}" / f"{self.deck.stem}.effective.k")
            text = refine_run(before, self.program, SHARE, surfaces=True)[0]
        made(path.parent)
        path.write_text(text, encoding="utf-8")
        return path, self.parameters if factor == 1 else {}


def files_of(deck: pathlib.Path, main: pathlib.Path | None = None, folders: list[pathlib.Path] | None = None) -> list[pathlib.Path]:
    """A deck and the files that it includes, found in `folders` too: those of *INCLUDE_PATH so far, as written or from that of the
    `main` deck."""
    files, main = [deck], main or deck
    folders = [] if folders is None else folders
    for block in read_blocks(deck.read_text(encoding="utf-8", errors="replace"), "INCLUDE"):
        for name in map(str.strip, block.lines):
            if block.keyword.startswith("INCLUDE_PATH"):
                folders += [pathlib.Path(name), main.parent / name]
            elif found := next((file for folder in (pathlib.Path(), *folders, deck.parent) if (file := folder / name).is_file()), None):
                files += files_of(found, main, folders)
    return files


def version(program: str) -> bytes:
    """What the program says of itself."""
    try:
        return subprocess.run([program, "--version"], capture_output=True, check=False).stdout
    except OSError as problem:
        raise UserError(not_run(program, problem)) from problem


def count_elements(deck: pathlib.Path) -> int:
    """Elements of an effective deck."""
    return sum(len(block.lines) for block in read_blocks(deck.read_text(encoding="utf-8"), "ELEMENT_SHELL"))
