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

from slideline_tools import UserError, scenes
from slideline_tools.contact_types import ALL_TYPES, TYPES
from slideline_tools.histories import read_csv
from slideline_tools.plots import COLOURS, PAGE_WIDTH, STYLE, plt
from slideline_tools.studies.common import label, markdown_table, page_of, save_small
from slideline_tools.studies.framework.job import Job, Study, counted_job
from slideline_tools.studies.framework.runner import RECORD
from slideline_tools.studies.framework.table import counted, finished, who_counted
from slideline_tools.studies.framework.times import phases, quartile_distance
from slideline_tools.studies.simplify import decks
from slideline_tools.studies.simplify.compare import comparison

USUAL, TIMED_TYPES = 2, (2, 5)
NO_STATES, NO_HISTORIES, NO_FORCE = "p:dtplot=1", "p:dthist=1", "p:dtforc=1"
PHASES = ["elements", "nodes", "contact", "output", "input"]
# What is left out: (title, variant with more, variant with less, variant whose row compares both).
STEPS = (
    ("half model", "collision_full", "collision", "collision"),
    ("rigid die", "sliding", "sliding_rigid", "sliding_rigid"),
    ("search asleep: collision", "collision_awake_type_2", "collision", "collision_awake_type_2"),
    ("search asleep: sliding", "sliding_awake", "sliding", "sliding_awake"),
    ("elastic law: projectile", "collision_plastic_projectile", "collision",
     "collision_plastic_projectile"),
    ("elastic law: both Hertz bodies", "hertz_plastic", "hertz", "hertz_plastic"),
    ("no states for pictures", "collision", "collision_no_states", "collision_no_states"),
    ("force history alone", "collision", "collision_force_alone", "collision_force_alone"),
    ("all but the die: collision", "collision_too_much", "collision_force_alone",
     "collision_too_much"),
)
OUTPUTS = {"collision": "as the deck asks",
           "collision_no_states": "no states but the first and the last",
           "collision_force_alone": "and no histories but the force",
           "collision_no_output": "and no force"}
DISTANCES = {"force_error": "force", "displacement_error": "displacement",
             "strain_shift": "plastic strain"}


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


# ---- medians -----------------------------------------------------------------------------------

def medians_of(table):
    """A row for each (variant, level): the columns of its first run, `seconds` of the processor
    (median) and their parts by `PHASES`, `instructions` where they were counted.

    A part is the share that the phase has of the clock over all runs; contact no more than the
    clock has ever shown, which is better for a short phase.
    """
    runs = finished(table).copy()
    runs["output"] = runs["total"] - runs["computing"] - runs["input"]
    groups = runs.groupby(["variant", "level"])
    found = runs.drop_duplicates(["variant", "level"]).set_index(["variant", "level"])
    found["seconds"] = groups["processor_seconds"].median()
    parts = groups[PHASES].sum().mul(found["seconds"] / groups["total"].sum(), axis=0)
    parts["contact"] = pd.concat([parts["contact"], groups["contact"].min()], axis=1).min(axis=1)
    found[PHASES] = parts
    found["spread"] = groups["processor_seconds"].agg(quartile_distance).where(groups.size() > 1)
    counts = counted(table)
    if len(counts):
        counts = counts.set_index(["variant", "level"])["instructions"]
        found["instructions"] = counts.reindex(found.index)
    return found


def steps_of(runs, level):
    """The steps both of whose variants have run."""
    return [step for step in STEPS if all((name, level) in runs.index for name in step[1:3])]


# ---- chart -------------------------------------------------------------------------------------

def draw(runs, level):
    """Processor time with and without, by phase, over that with."""
    found = steps_of(runs, level)
    figure, axes = plt.subplots(figsize=(PAGE_WIDTH, 0.52 * len(found) + 1.0),
                                layout="constrained")
    for row, (_, more, less, _) in enumerate(found):
        whole = runs.loc[(more, level), "seconds"]
        for name, shift in ((more, -0.2), (less, 0.2)):
            start = 0.0
            for phase, colour in zip(PHASES, COLOURS):
                width = runs.loc[(name, level), phase] / whole
                axes.barh(row + shift, width, 0.36, start, color=colour,
                          label=phase if row == 0 and name == more else None)
                start += width
        saved = percent(1.0 - runs.loc[(less, level), "seconds"] / whole)
        axes.annotate(f"saves {saved}", (1.01, row), va="center", fontsize=7)
    axes.set_yticks(range(len(found)), [step[0] for step in found])
    axes.invert_yaxis()
    axes.set(xlim=(0.0, 1.17), xlabel="processor time over that of the run with more",
             title=f"N_r = {level}: above with, below without")
    axes.legend(ncols=len(PHASES), loc="upper center", bbox_to_anchor=(0.45, -0.16), fontsize=7)
    return figure


def chart(table, folder):
    """The savings on the finest mesh."""
    runs = medians_of(table)
    if len(runs):
        with plt.rc_context(STYLE):
            finest = runs.index.unique("level").max()
            save_small(draw(runs, finest), folder / "simplify.png", lines=True)


# ---- tables ------------------------------------------------------------------------------------

def percent(share, digits=0):
    """A share in per cent."""
    return "" if share != share else f"{100.0 * share:.{digits}f} %"


def small_share(share):
    """A difference: 0, per cent, or a power of ten; nothing for none."""
    if share is None or share != share:
        return ""
    if share == 0.0:
        return "the same"
    return f"{100.0 * share:.2g} %" if share >= 1.0e-4 else f"{share:.0e}"


def distances(row):
    """How far two runs lie apart, by title."""
    return {title: "same bits" if row.get("same_bits") == 1 else small_share(row.get(key))
            for key, title in DISTANCES.items()}


def step_table(runs, level):
    """What each step saves and what it costs."""
    lines = []
    for title, more, less, compared in steps_of(runs, level):
        one, other = runs.loc[(more, level)], runs.loc[(less, level)]
        counts = [row.get("instructions", float("nan")) for row in (other, one)]
        lines.append({
            "left out": title, "processor time, s": f"{one.seconds:.3g} to {other.seconds:.3g}",
            "saved": percent(1.0 - other.seconds / one.seconds),
            "instructions saved": percent(1.0 - counts[0] / counts[1], 1),
            "results, MB": f"{1e-6 * one.bytes:.3g} to {1e-6 * other.bytes:.3g}",
            **distances(runs.loc[(compared, level)])})
    return f"N_r = {level}:\n\n" + markdown_table(pd.DataFrame(lines))


def type_table(runs, level):
    """For each type: distances of half from full model; contact time searched and asleep."""
    lines = []
    for ctype in TYPES:
        half = ("collision" if ctype == 2 else f"collision_type_{ctype}", level)
        awake = (f"collision_awake_type_{ctype}", level)
        if half in runs.index and awake in runs.index:
            row = runs.loc[awake]
            lines.append({
                "type": label(ctype), **distances(runs.loc[half]),
                "searched, ms": f"{1e3 * row.contact:.3g}",
                "share of the run": percent(row.contact / row.seconds),
                "asleep, ms": f"{1e3 * runs.loc[half, 'contact']:.3g}",
                "share": percent(runs.loc[half, "contact"] / runs.loc[half, "seconds"]),
                "same bits": "yes" if row.same_bits == 1 else small_share(row.displacement_error)})
    return markdown_table(pd.DataFrame(lines))


def output_table(runs, level):
    """Time and bytes by what is written."""
    rows = runs.xs(level, level="level").reindex(OUTPUTS).dropna(subset="seconds")
    return markdown_table(pd.DataFrame({
        "written": [OUTPUTS[name] for name in rows.index], "processor time, s": rows["seconds"],
        "of it output": (rows["output"] / rows["seconds"]).map(percent),
        "results, MB": (1e-6 * rows["bytes"]).map("{:.3g}".format)}))


def page(table):
    """Text of DOC/studies/simplify.md."""
    runs = medians_of(table)
    if "collision" not in runs.index:
        raise UserError("no finished runs of the collision")
    levels = sorted(runs.loc["collision"].index)
    return page_of(
        "# No more than a scene needs",
        "Processor time of the whole run, one thread, medians; quartiles "
        f"{percent(runs['spread'].median())} of it apart (median of the variants). {who_counted(table)}",
        "![Processor time with and without](../pictures/simplify.png)", *(step_table(runs, level) for level in levels),
        "## Half model and search asleep, by type",
        f"The half model from the full one; contact searched in each cycle and asleep. N_r = {levels[-1]}:", type_table(runs, levels[-1]),
        "## Output", f"Collision, N_r = {levels[-1]}:", output_table(runs, levels[-1]))


STUDY = Study("simplify", jobs, measure, chart, derive=derive, page=page, levels=(1, 2),
              repeats=3, quick_repeats=2)
