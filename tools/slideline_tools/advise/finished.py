# SPDX-License-Identifier: MIT
"""A finished run: which files there are, when they were read, and what stands in them."""
from __future__ import annotations

import dataclasses
import functools
import os
import pathlib

from slideline_tools import UserError
from slideline_tools.draw.model import Model, check_deck
from slideline_tools.files import ENDINGS, TABLES, find_run, source
from slideline_tools.histories import History, read_csv
from slideline_tools.program import find_program
from slideline_tools.results import Results, ResultsError, read
from slideline_tools.run_log import RunLog, read_log

# File systems that keep access times the way POSIX says, unless mounted noatime.
TRUSTED = ("ext2", "ext3", "ext4", "xfs", "btrfs", "tmpfs", "f2fs", "zfs")


@dataclasses.dataclass
class Finished:
    """One finished run.

    `seconds`    wall clock by phase, with `total`
    `results`    the states, None without a readable file or with a single state
    `tables`     histories by name
    `stamps`     os.stat_result of every result file, taken before it was opened
    """

    folder: pathlib.Path
    job: str
    log: RunLog
    seconds: dict[str, float]
    tables: dict[str, History]
    results: Results | None
    stamps: dict[str, os.stat_result]
    keeps_access_time: bool

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
        return sum(part.n_element for part in self.log.parts.values())

    @property
    def deck(self) -> str:
        """The deck as run; empty where it is not there."""
        return read_text(f"{self.folder / self.job}.effective.k")

    @functools.cached_property
    def model(self) -> Model | None:
        """The deck as run as the program reads it; None where it can not."""
        try:
            return check_deck(f"{self.folder / self.job}.effective.k", find_program())
        except UserError:
            return None

    @property
    def options(self) -> str:
        """The command line."""
        return self.results.run.get("options", "") if self.results else ""


def read_run(path) -> Finished:
    """The run whose folder, or any file, is `path`; the access times of its files stay."""
    prefix = find_run(path, ".log")
    folder, job = prefix.parent, prefix.name
    stamps = {ending: os.stat(f"{prefix}{ending}") for ending in ENDINGS
              if os.path.exists(f"{prefix}{ending}")}
    for needed in (".log", ".timing.csv"):
        if needed not in stamps:
            raise UserError(f"{prefix}{needed} is missing: not a finished run")
    try:
        return Finished(
            folder, job, read_log(read_text(f"{prefix}.log")), read_timing(prefix),
            {name: read_csv(f"{prefix}.{name}.csv") for name in TABLES
             if f".{name}.csv" in stamps},
            read_states(prefix), stamps, keeps_access_time(folder))
    finally:
        put_back(prefix, stamps)


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


def put_back(prefix, stamps: dict[str, os.stat_result]) -> None:
    """Restore access times, so that advice does not count as reading; silent where refused."""
    for ending, stamp in stamps.items():
        path = f"{prefix}{ending}"
        try:
            if os.stat(path).st_mtime_ns == stamp.st_mtime_ns:
                os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
        except OSError:
            continue


def keeps_access_time(folder: pathlib.Path, table: str = "/proc/self/mountinfo") -> bool:
    """Whether reading a file in `folder` is known to leave a trace in its access time."""
    place, best, kept = str(folder.resolve()), "", False
    for line in read_text(table).splitlines():
        words = line.split()
        if "-" not in words[6:] or len(words) < 10:
            continue
        mark = words.index("-", 6)
        point = words[4].replace("\\040", " ")
        inside = place == point or place.startswith(point.rstrip("/") + "/")
        if inside and len(point) >= len(best):
            best = point
            options = (words[5] + "," + words[mark + 3]).split(",")
            kept = words[mark + 1] in TRUSTED and "noatime" not in options
    return kept
