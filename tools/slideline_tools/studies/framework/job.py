# SPDX-License-Identifier: MIT
"""What a study consists of: its jobs, and what is made of their results."""
import dataclasses
import hashlib
import json
import os
import pathlib
from typing import Callable, Mapping, Optional, Sequence

import pandas as pd

from slideline_tools.contact_types import ALL_TYPES


@dataclasses.dataclass(frozen=True)
class Options:
    """What the user asked for; `program`: the one that runs, for decks that it has to make."""

    levels: tuple = (1,)
    types: tuple = ALL_TYPES
    quick: bool = False
    repeats: int = 1
    program: str = ""


@dataclasses.dataclass(frozen=True)
class Job:
    """One run of the program.

    `name`      unique in the study; names the folder of the run
    `deck`      text of the deck, without *INCLUDE
    `jobid`     stem of the result files
    `options`   further arguments of the program, for example ("ctype=5", "p:dtplot=1")
    `labels`    columns of its row that say what it is, for example scene, level, type
    `launcher`  words before the program, for example ("mpirun", "-n", "4")
    `environment` variables set for it
    `group`     jobs of a group run on one machine, since they are compared in time
    `alone`     a timing job: nothing else runs beside it, whatever -j says
    `turns`     how often it runs in each round of repeats
    `once`      it runs in the first round alone: a result that is not timed
    `cost`      expected seconds up to a common factor, for the guess of the time to go
    `counted`   its instructions are counted, by another program where callgrind counts (`counting`); its seconds
                mean nothing, and whatever runs beside it does not matter
    `limit`     seconds after which it is stopped and counts as failed
    `repeat`    its number among the runs of this name; set by `interleave`
    """

    name: str
    deck: str
    jobid: str = "run"
    options: Sequence[str] = ()
    labels: Mapping[str, object] = dataclasses.field(default_factory=dict)
    launcher: Sequence[str] = ()
    environment: Mapping[str, str] = dataclasses.field(default_factory=dict)
    group: str = ""
    alone: bool = False
    turns: int = 1
    once: bool = False
    cost: float = 1.0
    limit: Optional[float] = None
    counted: bool = False
    repeat: int = 1

    @property
    def folder_name(self):
        """Folder of the run below `runs`; the same whatever number of repeats is asked for."""
        return self.name if self.repeat == 1 else f"{self.name}.{self.repeat}"

    def fingerprint(self, program):
        """Changes with the deck, the options, the environment and the program (its `file_digest`)."""
        parts = [self.deck, self.jobid, list(self.options), sorted(self.environment.items()),
                 self.limit, program, *self.launcher] + ["counted"] * self.counted
        return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


@dataclasses.dataclass(frozen=True)
class Study:
    """A sweep and what is made of it.

    `jobs(options)`         the list of jobs of one round, without repeats
    `measure(job, folder)`   columns read from one finished run; {} if there is nothing to read
    `chart(table, folder)`   draws the pictures into `folder`
    `derive(table, folder)`  optional: the table (see table.py) with columns that need several runs, whose
                             results are in folder/runs/RUN, RUN the name in column `run`
    `page(table)`            optional: text of DOC/studies/<name>.md, '' for none; pictures that it shows as
                             ../pictures/NAME.png are those that `chart` has drawn
    `levels`, `types`, `repeats` and `quick_...`: used where the user names none.
    `build`                  whose program it takes, of build/<build>
    """

    name: str
    jobs: Callable[[Options], Sequence[Job]]
    measure: Callable[[Job, pathlib.Path], Mapping]
    chart: Callable[[pd.DataFrame, pathlib.Path], None]
    derive: Optional[Callable[[pd.DataFrame, pathlib.Path], pd.DataFrame]] = None
    page: Optional[Callable[[pd.DataFrame], str]] = None
    levels: Sequence[int] = (1,)
    types: Sequence = ALL_TYPES
    repeats: int = 1
    quick_levels: Sequence[int] = (1,)
    quick_repeats: int = 1
    build: str = "release"


def counted_job(job, options=()):
    """The job again, counted once; `options` shorten it."""
    return dataclasses.replace(job, name=f"{job.name}_counted", options=(*job.options, *options),
                               labels={**job.labels, "shortened": " ".join(options)}, alone=False, turns=1,
                               once=True, counted=True, limit=None, cost=50.0 * job.cost)


def interleave(jobs, rounds):
    """All jobs in turn, then the next round, so that a slow spell of the machine hits all alike."""
    runs, count = [], {job.name: 0 for job in jobs}
    if len(count) < len(jobs):
        raise ValueError("two jobs of one name")
    for number in range(rounds):
        for turn in range(max((job.turns for job in jobs), default=0)):
            for job in jobs:
                if turn < job.turns and not (job.once and number + turn):
                    count[job.name] += 1
                    runs.append(dataclasses.replace(job, repeat=count[job.name]))
    return runs


def part_of(jobs, index, count):
    """Part `index` (from 0) of `count` parts of the list; a group stays together."""
    groups = list(dict.fromkeys(job.group or job.name for job in jobs))
    chosen = set(groups[index::count])
    return [job for job in jobs if (job.group or job.name) in chosen]


def file_digest(path):
    """Digest of a file, for `Job.fingerprint`."""
    return hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()


def write_whole(path, text):
    """Write a file so that it is there whole or not at all."""
    part = path.with_name(path.name + ".part")
    part.write_text(text, encoding="utf-8")
    os.replace(part, path)
