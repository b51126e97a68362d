# SPDX-License-Identifier: MIT
"""Find the files of a run from what a user names: its folder, its results file or one of its tables."""
import pathlib

import numpy as np

from slideline_tools.effective_deck import interface_titles, part_titles
from slideline_tools.files import TABLES, find_run, source
from slideline_tools.histories import History, read_csv
from slideline_tools.results import read

NOT_WRITTEN = ("contact",)  # tables without a branch in the binout


class Run:
    """Files of one run.

    `prefix`    folder and job name: `prefix`.vtkhdf and so on
    `results`   the results file, open (results.Results), or None where the run wrote no states
    """

    def __init__(self, named):
        """`named`: the folder of a run, its results file, or the path up to the job name."""
        self.prefix = find_run(named, ".glstat.csv")
        states = pathlib.Path(f"{self.prefix}.vtkhdf")
        self.results = read(states) if states.exists() else None

    def tables(self):
        """name -> History of all tables that go into a binout, from the results file or the CSV files."""
        found = {}
        for name in TABLES:
            if name in NOT_WRITTEN:
                continue
            path = pathlib.Path(f"{self.prefix}.{name}.csv")
            if self.results and name in self.results.histories:
                found[name] = with_further(self.results, self.results.history(name))
            elif path.exists():
                found[name] = read_csv(path)
        return {name: whole_instants(table) for name, table in found.items() if len(table)}

    def files(self):
        """Paths of all that may be read of the run."""
        return [f"{self.prefix}{ending}" for ending in (".vtkhdf", ".effective.k", *(f".{name}.csv" for name in TABLES))]

    @property
    def title(self):
        """Title of the deck, '' where it is not known."""
        return self.results.run.get("title", "") if self.results else ""

    def part_titles(self):
        """part id -> heading of *PART, from the deck as run."""
        return part_titles(self.deck_as_run())

    def interface_titles(self):
        """interface id -> title of *CONTACT_..._TITLE, from the deck as run."""
        return interface_titles(self.deck_as_run())

    def deck_as_run(self):
        """Text of the deck as run, as far as the run has left it."""
        text = self.results.run.get("effective_deck", "") if self.results else ""
        path = pathlib.Path(f"{self.prefix}.effective.k")
        if not text and path.exists():
            text = source(path).read_text(encoding="latin-1")
        return text


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
