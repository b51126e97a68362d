# SPDX-License-Identifier: MIT
"""Everything that a run has left, as far as it is there: also of one killed or still running."""
from __future__ import annotations

import dataclasses
import os
import pathlib
import re
import tempfile

import numpy as np

from slideline_tools import UserError
from slideline_tools.advise.finished import read_text
from slideline_tools.draw.model import Model, check_deck
from slideline_tools.files import ENDINGS, TABLES, find_run
from slideline_tools.histories import History, read_csv
from slideline_tools.program import find_program
from slideline_tools.results import Results, read

GOES_ON = "goes on from the restart file"
#: what the log tells where there are no results
IN_LOG = {"title": r"^title: (.*)", "deck": r"^deck: (.*)", "version": r"^slideline (\S+)",
          "options": r"^command line: (.*)", "source": r"^slideline .*, source (\S+)\)",
          "build": r"^slideline \S+ \((.*?)(?:, source .*)?\)"}


@dataclasses.dataclass
class Ending:
    """How a run ended; numbers are None where nothing tells them.

    `kind` is `normal`, `error` or `unfinished` (killed, or it still runs).
    """

    kind: str
    reason: str
    time: float | None = None
    cycle: int | None = None
    seconds: float | None = None


@dataclasses.dataclass
class Gathered:
    """A run; `results`, `model` and `timing` are None where their files are missing."""

    folder: pathlib.Path
    job: str
    log_text: str
    deck_text: str
    ending: Ending
    tables: dict[str, History]
    results: Results | None
    timing: History | None
    model: Model | None
    files: list[tuple[str, int]]
    notes: list[str]

    @property
    def title(self) -> str:
        """Title of the deck, or the name of the job."""
        return self.told("title") or (self.model.title if self.model else "") or self.job

    def told(self, name: str) -> str:
        """What the results file or the log says of `title`, `deck`, `version`, `options`, `build`,
        `source` and (the results file alone) `machine`; '' where nothing does."""
        if self.results is not None and self.results.run.get(name):
            return self.results.run[name]
        found = re.search(IN_LOG[name], self.log_text, re.M) if name in IN_LOG else None
        return found[1].strip() if found else ""

    @property
    def warnings(self) -> list[str]:
        """The warnings of the log in their order."""
        return re.findall(r"^warning: (.*)", self.log_text, re.M)

    def rows(self, table: str) -> History | None:
        """A table that is there and has rows."""
        return self.tables.get(table) or None

    @property
    def interfaces(self) -> list[int]:
        """Numbers of the interfaces that anything tells of."""
        numbers = {interface.id for interface in self.model.interfaces} if self.model else set()
        for name in ("rcforc", "contact"):
            if rows := self.rows(name):
                numbers |= set(rows["interface"].tolist())
        return sorted(numbers)


def gather(path, program=None) -> Gathered:
    """The run whose folder, or any file, is `path`."""
    if not os.path.exists(path):
        raise UserError(f"{path}: no such folder or file")
    prefix = find_run(path, ".log", ".vtkhdf")
    sizes = {ending: os.path.getsize(f"{prefix}{ending}") for ending in [*ENDINGS, ".vtkhdf.part"]
             if os.path.exists(f"{prefix}{ending}")}
    if not sizes:
        raise UserError(f"{prefix}: no file of a run")
    return read_all(prefix, sizes, program)


def read_all(prefix: pathlib.Path, sizes: dict, program) -> Gathered:
    """Read what there is, and note what there is not."""
    notes: list[str] = []
    log_text = read_text(f"{prefix}.log")
    results = read_results(prefix, sizes, notes)
    tables = {name: table for name in (*TABLES, "timing")
              if (table := read_table(prefix, name, results, notes)) is not None}
    timing = tables.pop("timing", None)
    if not log_text:
        notes.append("The log is empty or missing: parts, interfaces and warnings are known as far "
                     "as the deck and the tables tell.")
    deck_text = read_text(f"{prefix}.effective.k") or (
        results.run.get("effective_deck", "") if results else "")
    return Gathered(prefix.parent, prefix.name, log_text, deck_text,
                    read_ending(log_text, tables, results, timing), tables, results, timing,
                    read_model(deck_text, f"{prefix}.effective.k", program, notes),
                    [(f"{prefix.name}{ending}", size) for ending, size in sizes.items()], notes)


def attempt(notes: list[str], words: str, make):
    """What `make` gives; None, and a note with the reason in `words`, where it can not."""
    try:
        return make()
    except UserError as problem:
        notes.append(words.format(problem))
        return None


def read_results(prefix, sizes: dict, notes: list[str]) -> Results | None:
    """The states; a note where they cannot be read or are none."""
    if ".vtkhdf" not in sizes:
        notes.append("No states: the run ended before it had written the first one."
                     if ".vtkhdf.part" in sizes else "No results file (.vtkhdf).")
        return None
    results = attempt(notes, "No states: {}.", lambda: read(f"{prefix}.vtkhdf"))
    if results is not None and not results.n_state:
        notes.append("The results file holds no state.")
    return results


def read_table(prefix, name: str, results: Results | None, notes: list[str]) -> History | None:
    """A table from its CSV file, else from the results file."""
    path = f"{prefix}.{name}.csv"
    if os.path.exists(path):
        return attempt(notes, "{}.", lambda: read_csv(path))
    if results is not None and name in results.histories:
        return attempt(notes, "{}.", lambda: results.history(name))
    return None


def read_model(text: str, name: str, program, notes: list[str]) -> Model | None:
    """The model of the deck as run, as the program understands it."""
    if not text:
        return None
    with tempfile.TemporaryDirectory() as folder:
        deck = pathlib.Path(folder) / "model.k"
        deck.write_text(text, encoding="utf-8")
        model = attempt(notes, "The deck as run could not be read: {}.",
                        lambda: check_deck(deck, find_program(program)))
        if model is None:
            notes[-1] = notes[-1].replace(str(deck), name)
        return model


def read_ending(log_text: str, tables: dict[str, History], results: Results | None,
                timing: History | None) -> Ending:
    """How the run ended, by the last part of its log."""
    tail = log_text[log_text.rfind(GOES_ON) + 1:]
    if "N o r m a l" in tail or "E r r o r" in tail:
        reasons = re.findall(r"^ \*\*\* (.*) \*\*\*$", tail, re.M)
        cycle = number(r"Problem cycle\s+=\s+(\S+)", tail)
        return Ending("normal" if "N o r m a l" in tail else "error", (reasons or [""])[-1],
                      number(r"Problem time\s+=\s+(\S+)", tail),
                      None if cycle is None else int(cycle),
                      number(r"Elapsed time\s+=\s+(\S+)", tail))
    time, cycle, seconds = None, None, None
    if glstat := tables.get("glstat"):
        time, last = float(glstat["time"][-1]), glstat["cycle"][-1]
        cycle = int(last) if np.isfinite(last) else None
    elif results is not None and results.n_state:
        time = float(results.times[-1])
    if timing is not None and "total" in timing["phase"]:
        seconds = float(timing["seconds"][timing["phase"] == "total"][0])
    told = "no end in the log" if log_text else "the log is empty or missing"
    return Ending("unfinished", f"{told}: the run was killed, or it still runs", time, cycle,
                  seconds)


def number(pattern: str, text: str) -> float | None:
    """The last number that a pattern finds."""
    found = re.findall(pattern, text)
    try:
        return float(found[-1]) if found else None
    except ValueError:
        return None
