# SPDX-License-Identifier: MIT
"""No more than a scene needs: what each simplification saves, and what it costs in accuracy.

Pairs of runs, one with more than it needs and one without: full and half model, elastic and rigid
die, contact search in each cycle and asleep, plastic and elastic law, much and little output.
decks.py makes the decks, compare.py compares results.
"""
from __future__ import annotations

import dataclasses
import json
import pathlib
import re
from typing import Callable, Sequence

import pandas as pd

from slideline_tools import UserError, scenes
from slideline_tools.histories import read_csv
from slideline_tools.scenes.common import STEEL
from slideline_tools.studies.framework.counted import counted_job
from slideline_tools.studies.framework.job import ALL_TYPES, Job, Study
from slideline_tools.studies.framework.runner import RECORD
from slideline_tools.studies.framework.table import FINISHED, records
from slideline_tools.studies.framework.times import phases
from slideline_tools.studies.simplify import decks
from slideline_tools.studies.simplify.compare import comparison, cycle_counts, memory
from slideline_tools.studies.simplify.page import STEPS, chart, page

USUAL, TIMED_TYPES = 2, (2, 5)
BOTH_TOUCH = 0.35e-3  # s; the collision is apart from then on
NO_STATES, NO_HISTORIES, NO_FORCE = "p:dtplot=1", "p:dthist=1", "p:dtforc=1"


@dataclasses.dataclass(frozen=True)
class Variant:
    """A deck by level and options of the program.

    `turns` as in Job; `once`: not timed; `scene`: where `deck` comes from.
    """

    scene: str
    deck: Callable[[int], str]
    options: Sequence[str] = ()
    turns: int = 3
    once: bool = False
    cost: float = 0.15


def collision_awake(level):
    return decks.awake(scenes.collision(level))


def collision_too_much(level):
    return decks.awake(decks.plastic_projectile(decks.full_collision(level)))


def sliding_rigid(level):
    return scenes.sliding(level, rigid_die=True)


def plastic_hertz(level):
    """Both bodies of the Hertz scene with a plastic law that never yields."""
    deck = decks.plastic_instead(scenes.hertz(level), 2, STEEL)
    return decks.plastic_instead(deck, 1, decks.ELASTIC_ALUMINIUM)


def variants():
    """All variants by name."""
    listed = {
        "collision": Variant("collision", scenes.collision),
        "collision_full": Variant("collision", decks.full_collision, cost=0.25),
        "collision_plastic_projectile": Variant(
            "collision", lambda level: decks.plastic_projectile(scenes.collision(level))),
        "collision_early": Variant("collision", scenes.collision, (f"endtim={BOTH_TOUCH}",)),
        "collision_early_awake": Variant("collision", collision_awake, (f"endtim={BOTH_TOUCH}",)),
        "collision_every_row": Variant("collision", scenes.collision, once=True),
        "collision_no_states": Variant("collision", scenes.collision, (NO_STATES,)),
        "collision_force_alone": Variant("collision", scenes.collision, (NO_STATES, NO_HISTORIES)),
        "collision_no_output": Variant("collision", scenes.collision,
                                       (NO_STATES, NO_HISTORIES, NO_FORCE)),
        "collision_too_much": Variant("collision", collision_too_much, cost=0.3),
        "collision_wider_type_3": Variant("collision", decks.wider_collision, ("ctype=3",),
                                          once=True),
        "collision_wider_awake_type_3": Variant(
            "collision", lambda level: decks.awake(decks.wider_collision(level)), ("ctype=3",),
            once=True),
        "hertz": Variant("hertz", scenes.hertz),
        "hertz_plastic": Variant("hertz", plastic_hertz),
        "sliding": Variant("sliding", scenes.sliding, turns=1, cost=1.2),
        "sliding_rigid": Variant("sliding", sliding_rigid, turns=1, cost=1.0),
        "sliding_awake": Variant("sliding", lambda level: decks.awake(scenes.sliding(level)),
                                 turns=1, cost=1.6),
    }
    for ctype in ALL_TYPES:
        once = ctype not in TIMED_TYPES
        if ctype != USUAL:
            listed[f"collision_type_{ctype}"] = Variant(
                "collision", scenes.collision, (f"ctype={ctype}",), once=once)
            listed[f"collision_full_type_{ctype}"] = Variant(
                "collision", decks.full_collision, (f"ctype={ctype}",), once=True)
        listed[f"collision_awake_type_{ctype}"] = Variant(
            "collision", collision_awake, (f"ctype={ctype}",), once=once)
    return listed


def jobs(options):
    """Every variant on every level; type 2 unless its options say another. Level 1 is counted too."""
    wanted = {f"_type_{ctype}" for ctype in options.types}
    listed = []
    for level in options.levels:
        for name, variant in variants().items():
            if "_type_" in name and not any(name.endswith(one) for one in wanted):
                continue
            more = variant.options
            if name == "collision_every_row":
                more = (f"p:dtforc={100.0e-9 / level:.17g}",)
            listed.append(Job(
                f"{name}_{level}", variant.deck(level), variant.scene, ("ncpu=1", *more),
                {"variant": name, "level": level, "quick": int(options.quick)},
                group="all", alone=True, turns=variant.turns, once=variant.once,
                cost=variant.cost * level ** 2.0))
    compared = {name for step in STEPS for name in step[1:3]}
    return listed + [counted_job(job) for job in listed if job.labels["variant"] in compared
                     and job.labels["level"] == 1 and not options.quick]


def measure(job, folder):
    """Seconds by phase on the clock, processor time of the run, bytes of its results."""
    record = json.loads((folder / RECORD).read_text(encoding="utf-8"))
    return {**phases(folder / f"{job.jobid}.timing.csv"),
            "input": seconds_of(folder / f"{job.jobid}.timing.csv", "input"),
            "element_limit": element_limit(folder / f"{job.jobid}.log"),
            "processor_seconds": record["processor_seconds"], "bytes": result_bytes(folder)}


def seconds_of(path, phase):
    """Seconds of one phase on the clock."""
    table = read_csv(path)
    return float(table["seconds"][table["phase"] == phase][0])


def element_limit(path):
    """Smallest L/c of the elements at the start, as the log has it, s."""
    found = re.search(r"smallest L/c of the elements (\S+)", path.read_text(encoding="utf-8"))
    if not found:
        raise UserError(f"{path}: no limit of the elements")
    return float(found[1])


def result_bytes(folder):
    """Bytes of the results file and the histories."""
    return sum(path.stat().st_size for path in pathlib.Path(folder).iterdir()
               if path.suffix == ".vtkhdf" or path.name.endswith(".csv"))


PAIRS = {  # variant: (the variant it is compared with, factor on the forces of the latter)
    "collision": ("collision_full", 0.5),
    "sliding_rigid": ("sliding", 1.0),
    "sliding_awake": ("sliding", 1.0),
    "collision_plastic_projectile": ("collision", 1.0),
    "hertz_plastic": ("hertz", 1.0),
    "collision_no_states": ("collision", 1.0),
    "collision_force_alone": ("collision", 1.0),
    "collision_no_output": ("collision", 1.0),
    "collision_too_much": ("collision", 2.0),
    "collision_awake_type_2": ("collision", 1.0),
    "collision_wider_awake_type_3": ("collision_wider_type_3", 1.0),
    **{f"collision_awake_type_{ctype}": (f"collision_type_{ctype}", 1.0)
       for ctype in ALL_TYPES if ctype != USUAL},
    **{f"collision_type_{ctype}": (f"collision_full_type_{ctype}", 0.5)
       for ctype in ALL_TYPES if ctype != USUAL},
}


def derive(rows, folder):
    """Columns that compare the first run of a variant with that of another, see PAIRS; memory."""
    rows = records(rows)
    first = {(row["variant"], row["level"]): row for row in rows if row["state"] == FINISHED and row["repeat"] == 1}
    runs = folder / "runs"
    for (name, level), row in first.items():
        row.update(memory(runs / row["run"]))
        other, factor = PAIRS.get(name, ("", 1.0))
        if (other, level) in first:
            row["compared_with"] = other
            row.update(comparison(runs / row["run"], runs / first[other, level]["run"], factor))
        if name == "sliding" and ("sliding", level - 1) in first:
            row.update(comparison(runs / row["run"], runs / first["sliding", level - 1]["run"],
                                  1.0, same_mesh=False))
        if name == "collision_every_row":
            row.update(cycle_counts(runs / row["run"]))
    return pd.DataFrame(rows)


STUDY = Study("simplify", jobs, measure, chart, derive=derive, page=page, levels=(1, 2),
              repeats=3, quick_repeats=2)
