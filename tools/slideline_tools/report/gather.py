# SPDX-License-Identifier: MIT
"""Everything that a run has left, as far as it is there: also of one killed or still running."""
import dataclasses
import functools
import os
import pathlib
import re
import tempfile

import numpy as np

from slideline_tools import UserError
from slideline_tools.draw.model import Model, check_deck
from slideline_tools.files import TABLES
from slideline_tools.finished_run import Run, last_part
from slideline_tools.histories import History
from slideline_tools.program import find_program
from slideline_tools.results import Results, read

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


class Gathered(Run):
    """A run; `results`, `model` and `timing` are None where their files are missing, and `notes` say why."""

    def __init__(self, path, program=None) -> None:
        """The run whose folder, or any file, is `path`; `program` reads the deck as run."""
        if not os.path.exists(path):
            raise UserError(f"{path}: no such folder or file")
        super().__init__(path, ".log", ".vtkhdf")
        if not self.sizes:
            raise UserError(f"{self.prefix}: no file of a run")
        self.notes: list[str] = []
        _ = self.results  # its notes come first
        self.tables: dict[str, History] = {}
        for name in (*TABLES, "timing"):
            if (table := self.attempt("{}.", lambda name=name: self.table(name))) is not None:
                self.tables[name] = table
        self.timing = self.tables.pop("timing", None)
        if not self.log:
            self.notes.append("The log is empty or missing: parts, interfaces and warnings are known as far "
                              "as the deck and the tables tell.")
        self.model = self.read_model(program)
        self.ending = read_ending(self.log, self.tables, self.results, self.timing)

    def attempt(self, words: str, make):
        """What `make` gives; None, and a note with the reason in `words`, where it can not."""
        try:
            return make()
        except UserError as problem:
            self.notes.append(words.format(problem))
            return None

    @functools.cached_property
    def results(self) -> Results | None:
        """The states; a note where they cannot be read or are none."""
        if ".vtkhdf" not in self.sizes:
            self.notes.append("No states: the run ended before it had written the first one."
                              if ".vtkhdf.part" in self.sizes else "No results file (.vtkhdf).")
            return None
        results = self.attempt("No states: {}.", lambda: read(self.path(".vtkhdf")))
        if results is not None and not results.n_state:
            self.notes.append("The results file holds no state.")
        return results

    def read_model(self, program) -> Model | None:
        """The model of the deck as run, as the program understands it."""
        if not self.deck:
            return None
        with tempfile.TemporaryDirectory() as folder:
            deck = pathlib.Path(folder) / "model.k"
            deck.write_text(self.deck, encoding="utf-8")
            model = self.attempt("The deck as run could not be read: {}.", lambda: check_deck(deck, find_program(program)))
            if model is None:
                self.notes[-1] = self.notes[-1].replace(str(deck), str(self.path(".effective.k")))
            return model

    @property
    def title(self) -> str:
        """Title of the deck, or the name of the job."""
        return self.attribute("title") or (self.model.title if self.model else "") or self.job

    def attribute(self, name: str) -> str:
        """What the results file or the log says of `title`, `deck`, `version`, `options`, `build`,
        `source` and (the results file alone) `machine`; '' where nothing does."""
        if self.results is not None and self.results.run.get(name):
            return self.results.run[name]
        found = re.search(IN_LOG[name], self.log, re.M) if name in IN_LOG else None
        return found[1].strip() if found else ""

    @property
    def warnings(self) -> list[str]:
        """The warnings of the log in their order."""
        return re.findall(r"^warning: (.*)", self.log, re.M)

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


def read_ending(log_text: str, tables: dict[str, History], results: Results | None,
                timing: History | None) -> Ending:
    """How the run ended, by the last part of its log."""
    tail = last_part(log_text)
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
    reported = "no end in the log" if log_text else "the log is empty or missing"
    return Ending("unfinished", f"{reported}: the run was killed, or it still runs", time, cycle,
                  seconds)


def number(pattern: str, text: str) -> float | None:
    """The last number that a pattern finds."""
    found = re.findall(pattern, text)
    try:
        return float(found[-1]) if found else None
    except ValueError:
        return None
