# SPDX-License-Identifier: MIT
"""A finished run: which files there are, and what stands in them."""
from __future__ import annotations

import dataclasses
import functools
import os
import pathlib

from slideline_tools import UserError
from slideline_tools.draw.model import Interface, Model, Part, model_of
from slideline_tools.files import TABLES, find_run, source
from slideline_tools.histories import History, read_csv
from slideline_tools.results import Results, ResultsError, read


@dataclasses.dataclass
class Finished:
    """One finished run.

    `ended`      whether it ended normally: the words that scripts look for at the end of a log
    `seconds`    wall clock by phase, with `total`
    `results`    the states, None without a readable file or with a single state
    `tables`     histories by name
    """

    folder: pathlib.Path
    job: str
    ended: bool
    seconds: dict[str, float]
    tables: dict[str, History]
    results: Results | None

    @property
    def total(self) -> float:
        """Seconds of the whole run."""
        return self.seconds["total"]

    def seconds_of(self, phase: str) -> float:
        """Seconds of a phase; `contact` sums its three, `loop` is all that is paid per cycle."""
        if phase == "contact":
            return sum(self.seconds.get(f"contact_{step}", 0.0)
                       for step in ("search", "pairing", "force"))
        if phase == "loop":
            return sum(self.seconds_of(name) for name in ("elements", "contact", "nodes"))
        return self.seconds.get(phase, 0.0)

    @property
    def is_implicit(self) -> bool:
        """Whether equations were solved."""
        return self.seconds_of("solver") > 0.0

    @property
    def n_element(self) -> int:
        """Elements of all parts."""
        return len(self.model.cells) if self.model else self.results.n_cell if self.results else 0

    @property
    def parts(self) -> list[Part]:
        """The parts; none without a model."""
        return list(self.model.parts.values()) if self.model else []

    @property
    def interfaces(self) -> list[Interface]:
        """The interfaces; none without a model."""
        return self.model.interfaces if self.model else []

    @property
    def deck(self) -> str:
        """The deck as run; empty where it is not there."""
        return read_text(f"{self.folder / self.job}.effective.k")

    @functools.cached_property
    def model(self) -> Model | None:
        """The deck as run as the program reads it; None where it can not."""
        return model_of(self.folder / self.job)

    @property
    def options(self) -> str:
        """The command line."""
        return self.results.run.get("options", "") if self.results else ""


def read_run(path) -> Finished:
    """The run whose folder, or any file, is `path`."""
    prefix = find_run(path, ".log")
    for needed in (".log", ".timing.csv"):
        if not os.path.exists(f"{prefix}{needed}"):
            raise UserError(f"{prefix}{needed} is missing: not a finished run")
    tables = {name: read_csv(f"{prefix}.{name}.csv") for name in TABLES
              if os.path.exists(f"{prefix}.{name}.csv")}
    return Finished(prefix.parent, prefix.name, "N o r m a l" in read_text(f"{prefix}.log"),
                    read_timing(prefix), tables, read_states(prefix))


def read_text(path: str) -> str:
    """A text file; empty if there is none."""
    try:
        return source(path).read_text(encoding="utf-8", errors="replace")
    except FileNotFoundError:
        return ""


def read_timing(prefix) -> dict[str, float]:
    """Seconds by phase."""
    table = read_csv(f"{prefix}.timing.csv")
    seconds = dict(zip(table["phase"].tolist(), table["seconds"].tolist()))
    if seconds.get("total", 0.0) <= 0.0:
        raise UserError(f"{prefix}.timing.csv: no total")
    return seconds


def read_states(prefix) -> Results | None:
    """The states, all of whose arrays are read now; None without at least two."""
    try:
        results = read(f"{prefix}.vtkhdf")
    except ResultsError:
        return None
    if len(results.times) < 2:
        return None
    _ = results.points, results.cells
    for name in ("displacement", "velocity", "contact_force", "node_id"):
        if name in results.point_fields:
            results.point_field(name)
    for name in ("plastic_strain", "mises", "part_id"):
        if name in results.cell_fields:
            results.cell_field(name)
    return results
