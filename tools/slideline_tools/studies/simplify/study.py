# SPDX-License-Identifier: MIT
"""No more than a scene needs: what each simplification saves, and what it costs in accuracy.

Pairs of runs, one with more than it needs and one without: full and half model, elastic and rigid
die, contact search in each cycle and asleep, plastic and elastic law, much and little output.
decks.py makes the decks, compare.py compares results.
"""
import dataclasses
import functools
import json
from typing import Callable, Sequence

import pandas as pd

from slideline_tools import scenes
from slideline_tools.histories import read_csv
from slideline_tools.studies.framework.job import ALL_TYPES, Job, Study, counted_job
from slideline_tools.studies.framework.runner import RECORD
from slideline_tools.studies.framework.table import finished
from slideline_tools.studies.framework.times import phases
from slideline_tools.studies.simplify import decks
from slideline_tools.studies.simplify.compare import comparison
from slideline_tools.studies.simplify.page import STEPS, chart, page

USUAL, TIMED_TYPES = 2, (2, 5)
NO_STATES, NO_HISTORIES, NO_FORCE = "p:dtplot=1", "p:dthist=1", "p:dtforc=1"


@dataclasses.dataclass(frozen=True)
class Variant:
    """A deck by level and options of the program.

    `turns` as in Job; `once`: not timed; `scene`: where `deck` comes from; `against`: the variant it is compared with, and
    the factor on the forces of that.
    """

    scene: str
    deck: Callable[[int], str]
    options: Sequence[str] = ()
    turns: int = 3
    once: bool = False
    cost: float = 0.15
    against: tuple[str, float] = ("", 1.0)


def made(scene, *changes):
    """The deck of a scene by level, with changes of its text."""
    return lambda level: functools.reduce(lambda deck, change: change(deck), changes, scene(level))


def variants():
    """All variants by name."""
    lean, full, awake = scenes.collision, decks.full_collision, made(scenes.collision, decks.awake)
    wider, rigid_die = decks.wider_collision, functools.partial(scenes.sliding, rigid_die=True)
    like_lean = ("collision", 1.0)
    listed = {
        "collision": Variant("collision", lean, against=("collision_full", 0.5)),
        "collision_full": Variant("collision", full, cost=0.25),
        "collision_plastic_projectile": Variant("collision", made(lean, decks.plastic_projectile), against=like_lean),
        "collision_no_states": Variant("collision", lean, (NO_STATES,), against=like_lean),
        "collision_force_alone": Variant("collision", lean, (NO_STATES, NO_HISTORIES), against=like_lean),
        "collision_no_output": Variant("collision", lean, (NO_STATES, NO_HISTORIES, NO_FORCE), against=like_lean),
        "collision_too_much": Variant(
            "collision", made(full, decks.plastic_projectile, decks.awake), cost=0.3, against=("collision", 2.0)),
        "collision_wider_type_3": Variant("collision", wider, ("ctype=3",), once=True),
        "collision_wider_awake_type_3": Variant("collision", made(wider, decks.awake), ("ctype=3",), once=True,
                                                against=("collision_wider_type_3", 1.0)),
        "hertz": Variant("hertz", scenes.hertz),
        "hertz_plastic": Variant("hertz", made(scenes.hertz, decks.plastic_hertz), against=("hertz", 1.0)),
        "sliding": Variant("sliding", scenes.sliding, turns=1, cost=1.2),
        "sliding_rigid": Variant("sliding", rigid_die, turns=1, against=("sliding", 1.0)),
        "sliding_awake": Variant("sliding", made(scenes.sliding, decks.awake), turns=1, cost=1.6, against=("sliding", 1.0)),
    }
    for ctype in ALL_TYPES:
        words, once = (f"ctype={ctype}",), ctype not in TIMED_TYPES
        half = "collision" if ctype == USUAL else f"collision_type_{ctype}"
        listed[f"collision_awake_type_{ctype}"] = Variant("collision", awake, words, once=once, against=(half, 1.0))
        if ctype != USUAL:
            whole = f"collision_full_type_{ctype}"
            listed[half] = Variant("collision", lean, words, once=once, against=(whole, 0.5))
            listed[whole] = Variant("collision", full, words, once=True)
    return listed


def jobs(options):
    """Every variant on every level; type 2 unless its options say another. Level 1 is counted."""
    wanted = tuple(f"_type_{ctype}" for ctype in options.types)
    chosen = {name: variant for name, variant in variants().items()
              if "_type_" not in name or name.endswith(wanted)}
    listed = [Job(f"{name}_{level}", variant.deck(level), variant.scene,
                  ("ncpu=1", *variant.options), {"variant": name, "level": level},
                  group="all", alone=True, turns=variant.turns, once=variant.once,
                  cost=variant.cost * level ** 2.0)
              for level in options.levels for name, variant in chosen.items()]
    compared = {name for step in STEPS for name in step[1:3]}
    return listed + [counted_job(job) for job in listed if job.labels["variant"] in compared
                     and job.labels["level"] == 1 and not options.quick]


def measure(job, folder):
    """Seconds by phase on the clock, processor time of the run, bytes of its results."""
    record = json.loads((folder / RECORD).read_text(encoding="utf-8"))
    timing = read_csv(folder / f"{job.jobid}.timing.csv")
    return {**phases(folder / f"{job.jobid}.timing.csv"),
            "input": float(timing["seconds"][timing["phase"] == "input"][0]),
            "processor_seconds": record["processor_seconds"],
            "bytes": sum(path.stat().st_size for path in folder.iterdir()
                         if path.name.endswith((".vtkhdf", ".csv")))}


def derive(table, folder):
    """With columns that compare the first run of a variant with that of another."""
    first = finished(table)
    first = first[first["repeat"] == 1].set_index(["variant", "level"])["run"]
    rows, known = [], variants()
    for (name, level), run in first.items():
        other, factor = known[name].against
        if (other, level) in first:
            rows.append({"run": run, **comparison(folder / "runs" / run, folder / "runs" / first[other, level],
                                                  known[name].scene, factor)})
    return table.merge(pd.DataFrame(rows), how="left", on="run") if rows else table


STUDY = Study("simplify", jobs, measure, chart, derive=derive, page=page, levels=(1, 2),
              repeats=3, quick_repeats=2)
