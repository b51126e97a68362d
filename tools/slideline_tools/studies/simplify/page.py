# SPDX-License-Identifier: MIT
"""Chart of the study simplify, and the figures that doc/studies/simplify.md quotes."""
import pandas as pd

from slideline_tools import UserError
from slideline_tools.contact_types import TYPES
from slideline_tools.plots import COLOURS, PAGE_WIDTH, STYLE, plt
from slideline_tools.studies.common import label, markdown_table, save_small, write_page
from slideline_tools.studies.framework.table import counted, finished, who_counted
from slideline_tools.studies.framework.times import quartile_distance

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


def page(table, doc):
    """DOC/studies/simplify.md."""
    runs = medians_of(table)
    if "collision" not in runs.index:
        raise UserError("no finished runs of the collision")
    levels = sorted(runs.loc["collision"].index)
    write_page(
        doc, "simplify", "# No more than a scene needs",
        "Processor time of the whole run, one thread, medians; quartiles "
        f"{percent(runs['spread'].median())} of it apart (median of the variants). {who_counted(table)}",
        "![Processor time with and without](../pictures/simplify.png)", *(step_table(runs, level) for level in levels),
        "## Half model and search asleep, by type",
        f"The half model from the full one; contact searched in each cycle and asleep. N_r = {levels[-1]}:", type_table(runs, levels[-1]),
        "## Output", f"Collision, N_r = {levels[-1]}:", output_table(runs, levels[-1]))
