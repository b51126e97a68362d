# SPDX-License-Identifier: MIT
"""Charts and page of the study simplify."""
from slideline_tools import UserError
from slideline_tools.plots import COLOURS, PAGE_WIDTH, plt
from slideline_tools.studies.common import TYPES, label, markdown_table, save_small, write_page
from slideline_tools.studies.framework.charts import save, styled
from slideline_tools.studies.framework.counted import who_counted
from slideline_tools.studies.framework.table import finished, records
from slideline_tools.studies.simplify import texts
from slideline_tools.studies.simplify.figures import Runs, duration, megabytes, percent, \
    small_share

PHASES = ("elements", "nodes", "contact", "output", "input")
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
    ("all but the die: collision", "collision_too_much", "collision_force_alone", "collision_too_much"),
)
OUTPUTS = (("as the deck asks", "collision"),
           ("no states but the first and the last", "collision_no_states"),
           ("and no histories but the force", "collision_force_alone"),
           ("and no force", "collision_no_output"))


# ---- chart -------------------------------------------------------------------------------------

def draw(runs, level):
    """Processor time with and without, by phase, over that with."""
    found = [step for step in STEPS if all(runs.has(name, level) for name in step[1:3])]
    figure, axes = plt.subplots(figsize=(PAGE_WIDTH, 0.52 * len(found) + 1.0),
                                layout="constrained")
    for row, (title, more, less, _) in enumerate(found):
        whole = runs.seconds(more, level)
        for name, shift in ((more, -0.2), (less, 0.2)):
            foot = 0.0
            for phase, colour in zip(PHASES, COLOURS):
                width = runs.seconds(name, level, phase) / whole
                axes.barh(row + shift, width, 0.36, foot, color=colour,
                          label=phase if row == 0 and name == more else None)
                foot += width
        axes.annotate(f"saves {percent(1.0 - runs.seconds(less, level) / whole)}", (1.01, row),
                      va="center", fontsize=7)
    axes.set_yticks(range(len(found)), [step[0] for step in found])
    axes.invert_yaxis()
    axes.set(xlim=(0.0, 1.17), xlabel="processor time over that of the run with more",
             title=f"N_r = {level}: above with, below without")
    axes.legend(ncols=len(PHASES), loc="upper center", bbox_to_anchor=(0.45, -0.16), fontsize=7)
    return figure


def chart(rows, folder):
    """The savings of each level."""
    runs = Runs(rows)
    for level in runs.levels:
        with styled():
            save(draw(runs, level), folder, f"savings_{level}")


# ---- tables ------------------------------------------------------------------------------------

def overview(runs, level):
    """One row for each step: what it saves and what it costs."""
    table = []
    for title, more, less, compared in STEPS:
        if not (runs.has(more, level) and runs.has(less, level)):
            continue
        times = [runs.seconds(name, level) for name in (more, less)]
        row = runs.first(compared, level)
        table.append([
            title, arrow(times, duration), percent(1.0 - times[1] / times[0]),
            runs.instructions_saved(more, less, level),
            arrow([runs.seconds(name, level, "contact") for name in (more, less)], duration),
            arrow([runs.first(name, level).get("memory") for name in (more, less)], megabytes),
            arrow([runs.first(name, level)["bytes"] for name in (more, less)], megabytes),
            "same bits" if row.get("same_bits") else small_share(row.get("force_error")),
            "same bits" if row.get("same_bits") else small_share(row.get("displacement_error")),
            "same bits" if row.get("same_bits") else small_share(row.get("strain_shift"))])
    return markdown_table(["left out", "processor time", "saved", "instructions saved", "contact time", "memory, MB",
                           "results, MB", "force", "displacement", "plastic strain"], table)


def arrow(pair, text):
    """'with to without'."""
    return "" if None in pair else f"{text(pair[0])} to {text(pair[1])}"


def sleep_table(runs, level):
    """For each type: the same bits?, contact time in each cycle searched and asleep."""
    table = []
    for ctype in TYPES:
        asleep = "collision" if ctype == 2 else f"collision_type_{ctype}"
        awake = f"collision_awake_type_{ctype}"
        if not (runs.has(asleep, level) and runs.has(awake, level)):
            continue
        row = runs.first(awake, level)
        times = [runs.seconds(name, level, "contact") for name in (awake, asleep)]
        table.append([label(ctype), duration(times[0]), duration(times[1]),
                      "yes" if row["same_bits"] else
                      f"to {small_share(row['displacement_error'])} of the displacement"])
    return markdown_table(["type", "searched in each cycle", "asleep", "same bits"], table)


def symmetry_table(runs, level):
    """How far half and full model lie apart, by type."""
    table = []
    for ctype in TYPES:
        row = runs.first("collision" if ctype == 2 else f"collision_type_{ctype}", level)
        if "displacement_error" in row:
            table.append([label(ctype), *(small_share(row[key]) for key in (
                "force_error", "displacement_error", "strain_shift"))])
    return markdown_table(["type", "force", "displacement", "plastic strain"], table)


def span_table(runs, level):
    """Contact time a cycle while the bodies meet and afterwards."""
    count, table = runs.first("collision_every_row", level), []
    steps = count["rows"] - 1
    early = runs.first("collision_early", level)["element_calls"] - 1
    for title, whole, part in (("searched in each cycle", "collision_awake_type_2",
                                "collision_early_awake"), ("asleep", "collision",
                                                           "collision_early")):
        first, all_of = (runs.seconds(name, level, "contact") for name in (part, whole))
        last = max(all_of - first, 0.0)
        table.append([title, f"{1e9 * first / early:.0f} ns", f"{1e9 * last / (steps - early):.0f} ns",
                      percent(last / all_of)])
    return markdown_table(["contact", f"a cycle, the first {early}", "a cycle, the others",
                           "part of the contact time spent in the others"], table)


def output_table(runs, level):
    """Time and bytes by what is written."""
    return markdown_table(["written", "processor time", "of it output", "results, MB"], [
        [title, duration(runs.seconds(name, level)), percent(
            runs.seconds(name, level, "output") / runs.seconds(name, level)),
         megabytes(runs.first(name, level)["bytes"])]
        for title, name in OUTPUTS if runs.has(name, level)])


# ---- page --------------------------------------------------------------------------------------

def page(rows, doc):
    """doc/studies/simplify.md and its picture."""
    runs = Runs(rows)
    levels = [level for level in runs.levels if runs.has("collision", level)]
    if not levels:
        raise UserError("no finished runs of the collision")
    with styled():
        save_small(draw(runs, levels[-1]), doc / "pictures" / "simplify.png", lines=True)
    done, last = records(finished(rows)), levels[-1]
    write_page(doc, "simplify", texts.PAGE.format(
        quick=texts.QUICK if rows["quick"].any() else "",
        processor="; ".join(sorted({row["processor"] for row in done})),
        counted=who_counted(rows), rounds=runs.rounds, spread=percent(runs.spread), load=f"{runs.load:.1f}",
        overviews="\n\n".join(f"N_r = {level}:\n\n{overview(runs, level)}" for level in levels),
        level=last, symmetry=texts.symmetry(runs, last),
        halves=symmetry_table(runs, last), rigid=texts.rigid(runs, levels),
        sleep=sleep_table(runs, last), exception=texts.exception(runs, last),
        spans=span_table(runs, last), share=texts.share(runs, last), law=texts.law(runs, last),
        outputs=output_table(runs, last), output=texts.output(runs, last),
        together=texts.together(runs, last)).rstrip() + "\n")
