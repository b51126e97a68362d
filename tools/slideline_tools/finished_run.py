# SPDX-License-Identifier: MIT
"""The files of a run, found from what a user names: its folder, its results file or one of its tables."""
import functools
import os
import pathlib

import numpy as np

from slideline_tools.files import ENDINGS, TABLES, find_run, source
from slideline_tools.histories import History, read_csv
from slideline_tools.results import Results, read

NOT_WRITTEN = ("contact",)  # tables without a branch in the binout
GOES_ON = "restart from the restart file"


class Run:
    """Files of one run, each read when it is asked for; '' or None stand for what is not there.

    `prefix`    folder and job name: `prefix`.vtkhdf and so on
    """

    def __init__(self, named, *marks) -> None:
        """`named`: the folder of a run, a file of it, or the path up to the job name; `marks`: endings that tell the job in a folder."""
        self.prefix = find_run(named, *(marks or (".glstat.csv",)))
        self.folder, self.job = self.prefix.parent, self.prefix.name

    def path(self, ending: str) -> pathlib.Path:
        """The file with that ending."""
        return pathlib.Path(f"{self.prefix}{ending}")

    def text(self, ending: str) -> str:
        """A text file."""
        try:
            return source(self.path(ending)).read_text(encoding="utf-8", errors="replace")
        except FileNotFoundError:
            return ""

    @functools.cached_property
    def results(self) -> Results | None:
        """The results file, open; UserError where it is damaged."""
        return read(self.path(".vtkhdf")) if self.path(".vtkhdf").exists() else None

    @functools.cached_property
    def log(self) -> str:
        """The log."""
        return self.text(".log")

    @functools.cached_property
    def deck(self) -> str:
        """The deck as run."""
        return self.text(".effective.k") or (self.results.run.get("effective_deck", "") if self.results else "")

    def table(self, name: str) -> History | None:
        """A table from its CSV file, else from the results file."""
        if self.path(f".{name}.csv").exists():
            return read_csv(self.path(f".{name}.csv"))
        return self.results.history(name) if self.results and name in self.results.histories else None

    def tables_for_dyna(self):
        """name -> History of all tables that go into a binout."""
        found = {name: with_further(self.results, self.results.history(name)) if self.results and name in self.results.histories
                 else self.table(name) for name in TABLES if name not in NOT_WRITTEN}
        return {name: whole_instants(table) for name, table in found.items() if table}

    @property
    def sizes(self) -> dict[str, int]:
        """ending -> bytes of the files that are there, also that of states which are being written."""
        return {ending: os.path.getsize(self.path(ending)) for ending in [*ENDINGS, ".vtkhdf.part"] if self.path(ending).exists()}

    def files(self) -> list[pathlib.Path]:
        """Paths of all files of the run."""
        return [self.path(ending) for ending in ENDINGS]

    @property
    def title(self) -> str:
        """Title of the deck, '' where it is not known."""
        return self.results.run.get("title", "") if self.results else ""


def last_part(log: str) -> str:
    """The log since the last restart."""
    return log[log.rfind(GOES_ON) + 1:]


def whole_instants(table):
    """A table without the rows of a last instant that lacks some: the run was killed while they waited in memory."""
    size = int(np.count_nonzero(table["time"] == table["time"][0]))
    return table.rows(slice(len(table) // size * size))


def with_further(results, table):
    """A table with the columns of /dyna behind its own."""
    with results.reading(f"dyna/{table.name}") as stream:
        group = stream.get(f"dyna/{table.name}", {})
        further = {name: group[name][()] for name in group}
        if any(getattr(values, "ndim", 0) != 1 or len(values) < len(table) for values in further.values()):
            raise ValueError("a column is no list of values as long as its table")
    return History(table.name, table.columns | {name: values[:len(table)] for name, values in further.items()})
