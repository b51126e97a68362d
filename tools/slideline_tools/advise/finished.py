# SPDX-License-Identifier: MIT
"""A finished run: its model, the seconds of its phases, its states and tables."""
import functools
import re

from slideline_tools import UserError
from slideline_tools.draw.model import Interface, Model, Part, model_of
from slideline_tools.files import TABLES
from slideline_tools.finished_run import Run, last_part
from slideline_tools.histories import History, read_csv
from slideline_tools.results import Results, read


class Finished(Run):
    """One finished run.

    `ended`      whether it ended normally: the words that scripts look for at the end of a log
    `seconds`    wall clock by phase; `total` of the whole run
    `tables`     histories by name
    """

    def __init__(self, path) -> None:
        """The run whose folder, or any file, is `path`."""
        super().__init__(path, ".log")
        for needed in (".log", ".timing.csv"):
            if not self.path(needed).exists():
                raise UserError(f"{self.path(needed)} is missing: not a finished run")
        self.tables: dict[str, History] = {name: read_csv(self.path(f".{name}.csv")) for name in TABLES
                                           if self.path(f".{name}.csv").exists()}
        self.ended = "N o r m a l" in last_part(self.log)
        timing = read_csv(self.path(".timing.csv"))
        self.seconds: dict[str, float] = dict(zip(timing["phase"].tolist(), timing["seconds"].tolist()))
        self.total = self.seconds.get("total", 0.0)
        if self.total <= 0.0:
            raise UserError(f"{self.path('.timing.csv')}: no total")

    @functools.cached_property
    def results(self) -> Results | None:
        """The states; None without a readable file or with a single state."""
        try:
            results = read(self.path(".vtkhdf"))
        except UserError:
            return None
        return results if len(results.times) > 1 else None

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
    def element_limit(self) -> float:
        """Smallest L/c of the elements at the start, as the log has it, s; 0 where it has none."""
        found = re.search(r"smallest L/c of the elements (\S+)", self.log)
        return float(found[1]) if found else 0.0

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

    @functools.cached_property
    def model(self) -> Model | None:
        """The deck as run as the program reads it; None where it can not."""
        return model_of(self.prefix)

    @property
    def options(self) -> str:
        """The command line."""
        return self.results.run.get("options", "") if self.results else ""
