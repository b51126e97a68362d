# SPDX-License-Identifier: MIT
"""Tables 1 and 2 and Figs. 23, 24, 29 and 32 of Kang, Lee & Shin (2023): what contact costs.

Contact time of each type and level, split into steps A, M and B, its ratio to the classical NTS
and its share of the computation; medians over rounds in which all variants run in turn.
"""
from __future__ import annotations

import dataclasses
from typing import Callable, Mapping, Sequence

import numpy as np

from slideline_tools import UserError, scenes
from slideline_tools.histories import read_csv
from slideline_tools.plots import COLOURS, PAGE_WIDTH, plt
from slideline_tools.studies.common import TYPES, label, markdown_table, save_small, write_page
from slideline_tools.studies.framework.charts import save, styled
from slideline_tools.studies.framework.counted import counted_job, instruction_section
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.framework.rules import between
from slideline_tools.studies.framework.table import finished
from slideline_tools.studies.framework.times import LETTERS, STEPS, Times, phases

NO_OUTPUT = ("p:dtplot=1", "p:dthist=1")


@dataclasses.dataclass(frozen=True)
class Scene:
    """A scene of the paper.

    `figure`, `table`  where the paper shows its times
    `deck`             text of the deck by level
    `turns`, `cost`    as in Job, at level 1; finer runs are longer and take fewer turns
    `options`, `quick` of the program; `quick` shortens the run, `short` that whose instructions are counted
    `slave_nodes`      at level 1
    `paper`            its ratios to type 1 by type and level
    `told`             what its text says of a chart whose numbers it does not give
    """

    title: str
    figure: str
    deck: Callable[[int], str]
    levels: Sequence[int] = (1,)
    turns: int = 1
    cost: float = 1.0
    options: Sequence[str] = ()
    quick: Sequence[str] = ()
    short: Sequence[str] = ()
    table: str = ""
    slave_nodes: int = 52
    paper: Mapping = dataclasses.field(default_factory=dict)
    told: str = ""


def by_level(*types_and_ratios):
    """{type: {level: ratio}} of (type, ratio at level 1, at level 2, ...)."""
    return {ctype: dict(enumerate(ratios, start=1)) for ctype, *ratios in types_and_ratios}


SCENES = {
    "block_implicit": Scene(
        "Block-to-block, implicit", "Fig. 23", lambda _: scenes.block(implicit=True), cost=6.0,
        short=("endtim=0.02",),
        paper=by_level((3, 2.0), (4, 3.0)),
        told="its text: type 3 about twice, type 4 three times type 1, close to type 6"),
    "block": Scene(
        "Block-to-block, explicit", "Fig. 24", lambda _: scenes.block(), turns=12, cost=0.3,
        paper=by_level((4, 2.4)),
        told="its text: type 4 2.4 times type 1, type 5 the cheapest after type 1"),
    "sliding": Scene(
        "Sliding", "Fig. 29", scenes.sliding, levels=(1, 2, 3), cost=15.0,
        options=(*NO_OUTPUT, "p:dtforc=2.0e-4"), quick=("endtim=2.0e-3",), short=("endtim=2.0e-3",), table="Table 1", slave_nodes=19,
        paper=by_level((3, 2.25, 2.26, 2.26), (4, 2.09, 2.09, 2.20), (5, 1.22, 1.09, 1.12),
                       (6, 4.98, 5.49, 5.85))),
    "collision": Scene(
        "Collision", "Fig. 32", scenes.collision, levels=(1, 2, 3, 4), turns=12, options=NO_OUTPUT,
        table="Table 2", slave_nodes=25,
        paper=by_level((3, 1.92, 1.97, 1.95, 1.93), (4, 2.06, 2.05, 2.04, 2.05),
                       (5, 1.20, 1.09, 1.06, 1.06), (6, 3.41, 3.76, 3.82, 3.78))),
}


def jobs(options):
    """Each scene, level and type once; type 1 always, since the others are compared with it. Level 1 is counted too."""
    listed = []
    for name, scene in SCENES.items():
        for level in (level for level in scene.levels if level in options.levels):
            deck = scene.deck(level)
            for ctype in sorted({1, *options.types}):
                listed.append(Job(
                    f"{name}_{level}_type_{ctype}", deck, name,
                    (f"ctype={ctype}", "ncpu=1", *scene.options, *(scene.quick * options.quick)),
                    {"scene": name, "level": level, "type": ctype, "quick": int(options.quick)},
                    group=f"{name}_{level}",
                    alone=True, turns=max(1, scene.turns // level), cost=scene.cost * level ** 3))
    return listed + [counted_job(job, SCENES[job.labels["scene"]].short) for job in listed
                     if job.labels["level"] == 1 and not options.quick]


def measure(job, folder):
    """Seconds by phase, and how many points carried pressure at most."""
    forces = read_csv(folder / f"{job.jobid}.rcforc.csv")
    return {**phases(folder / f"{job.jobid}.timing.csv"), "points": int(max(forces["n_active"]))}


def times_of(rows):
    """{scene: Times} of the scenes that have finished runs."""
    done = set(finished(rows)["scene"])
    return {name: Times(rows, name) for name in SCENES if name in done}


# ---- charts ------------------------------------------------------------------------------------

def draw_bars(axes, times):
    """Steps A, M, B of each type at level 1 over the contact time of type 1; the paper's ratios."""
    scene, level = SCENES[times.scene], times.levels[0]
    types = [ctype for ctype in times.seconds[level] if times.has(level, ctype)]
    foot = {ctype: 0.0 for ctype in types}
    for step, colour in zip(STEPS, COLOURS):
        heights = [times.ratio(level, ctype, step) for ctype in types]
        axes.bar([str(k) for k in types], heights, bottom=list(foot.values()), color=colour,
                 label=LETTERS[step], width=0.65)
        foot = {ctype: foot[ctype] + height for ctype, height in zip(types, heights)}
    theirs = {ctype: scene.paper[ctype][level] for ctype in types
              if level in scene.paper.get(ctype, {})}
    for place, ctype in enumerate(types):
        # Above the bar, and above a diamond that would hide it.
        axes.annotate(f"{foot[ctype]:.2f}\n({100.0 * times.share(level, ctype):.0f} %)",
                      (place, max(foot[ctype], theirs.get(ctype, 0.0))), ha="center", va="bottom",
                      fontsize=6.5, xytext=(0, 4), textcoords="offset points")
    axes.plot([str(k) for k in theirs], list(theirs.values()), linestyle="none", marker="D",
              markersize=4.5, markerfacecolor="white", color="black", label="paper")
    axes.set_ylim(0.0, 1.25 * max([*foot.values(), *theirs.values()]))
    axes.set_title(f"{scene.title}, N_r = {level} ({scene.figure})", loc="left")
    axes.set_xlabel("contact type")


def chart(rows, folder):
    """One bar chart for each scene, and the ratios by level."""
    for name, times in times_of(rows).items():
        if not times.has(times.levels[0], 1):
            continue
        with styled():
            figure, axes = plt.subplots(figsize=(0.6 * PAGE_WIDTH, 3.2), layout="constrained")
            draw_bars(axes, times)
            axes.set_ylabel("contact time over that of type 1")
            axes.legend()
            save(figure, folder, f"{name}_contact_time")
        if len(times.levels) > 1:
            with styled():
                save(level_figure(times), folder, f"{name}_ratio_by_level")


def level_figure(times):
    """Ratio of each type to type 1 by level; the paper's as open marks."""
    figure, axes = plt.subplots(figsize=(0.6 * PAGE_WIDTH, 3.2), layout="constrained")
    for ctype in times.seconds[times.levels[0]]:
        levels = [level for level in times.levels if times.has(level, ctype)]
        axes.plot(levels, [times.ratio(level, ctype) for level in levels], marker="o",
                  color=COLOURS[ctype - 1], label=label(ctype))
        theirs = SCENES[times.scene].paper.get(ctype, {})
        shown = [level for level in levels if level in theirs]
        axes.plot(shown, [theirs[level] for level in shown], linestyle=":", marker="D",
                  markerfacecolor="white", color=COLOURS[ctype - 1])
    axes.set(xlabel="N_r", ylabel="contact time over that of type 1", xticks=times.levels,
             title=f"{SCENES[times.scene].title}: this program (lines), paper (dotted)")
    axes.legend(fontsize=6.5)
    return figure


def page_figure(all_times):
    """All bar charts on one picture."""
    with styled():
        figure, panels = plt.subplots(2, 2, figsize=(PAGE_WIDTH + 1.0, 6.0), layout="constrained")
        for axes in panels.flat[len(all_times):]:
            axes.set_axis_off()
        for axes, times in zip(panels.flat, all_times.values()):
            draw_bars(axes, times)
        for axes in panels[:, 0]:
            axes.set_ylabel("contact time over that of type 1")
        panels.flat[0].legend()
        return figure


# ---- tables and page ---------------------------------------------------------------------------

def duration(seconds):
    """A time in s or ms with three digits."""
    return f"{seconds:.3g} s" if seconds >= 1.0 else f"{1e3 * seconds:.3g} ms"


def ratio_table(times):
    """Contact time and ratio to type 1 by level, the paper's ratio behind it."""
    theirs, rows = SCENES[times.scene].paper, []
    for ctype in TYPES:
        row = [label(ctype)]
        for level in times.levels:
            if not times.has(level, ctype):
                row.append("")
                continue
            ratio = theirs.get(ctype, {}).get(level)
            row.append(f"{duration(times.seconds[level][ctype]['contact'])}, "
                       f"{times.ratio(level, ctype):.2f}" + (f" ({ratio:.2f})" if ratio else ""))
        if any(row[1:]):
            rows.append(row)
    return markdown_table(["type", *(f"N_r = {level}" for level in times.levels)], rows)


def step_table(times, level):
    """Time of each step over the contact time of type 1, and the share of contact."""
    rows = []
    for ctype in times.seconds[level]:
        if times.has(level, ctype):
            steps = [f"{times.ratio(level, ctype, step):.2f}" for step in STEPS]
            rows.append([label(ctype), *steps, f"{times.ratio(level, ctype):.2f}",
                         f"{100.0 * times.share(level, ctype):.1f} %",
                         f"{times.computing_ratio(level, ctype):.2f}", times.points[level][ctype]])
    return markdown_table(["type", *LETTERS.values(), "sum", "share of the computation",
                           "computation over that with type 1", "points under pressure"], rows)


def section(times):
    """One scene of the page."""
    scene = SCENES[times.scene]
    title = f"{scene.title} ({', '.join(name for name in (scene.table, scene.figure) if name)})"
    parts = [f"## {title}", ratio_table(times)]
    if scene.told:
        parts.append(f"The paper gives no numbers of {scene.figure}; {scene.told}.")
    parts += [f"Steps over the contact time of type 1, N_r = {level}:\n\n{step_table(times, level)}"
              for level in times.levels]
    parts.append(f"Medians of {times.rounds} runs; the quartiles of a contact time lie at most "
                 f"{100.0 * times.spread:.0f} % of its median apart."
                 + ("" if np.isnan(times.load) else f" Load of the machine: {times.load:.1f}."))
    return "\n\n".join(parts)


PAGE = """# What contact costs: the tables of the paper

This page and its picture are written by `tools/study.sh paper-tables --publish`: do not edit it.

Contact time of each type in the scenes of Kang, Lee & Shin (2023), beside its ratio to the contact
time of type 1, the classical one-pass NTS; the paper's ratios in brackets. Its Tables 1 and 2 cover
types 1, 3, 4, 5 and 6; types 2 and 7 are ours. Its program and machine are others, and dimensions
that it does not give are ours: compare ratios, not seconds.

How it is measured: one thread ({processor}); all variants run in turn, then again in the next
round, and each figure is the median over the rounds. Step A is the search, M the pairing, that is the
placing of points (counted as B in types 1, 2, 3 and 6), B the force. Seconds are corrected by the
pace of the element loop of the same run, which is the same work for all types: what slows the
machine for a while slows both. The share is that of the computation, without input and output; the whole computation
is set beside that with type 1 too. Points are those under pressure, the largest number in the history of the contact force
(a row for each 0.2 ms of the sliding, for each microsecond of the collision). In the implicit run the contact tangent counts as B. The load of a machine is the mean number of processes that want to
run, this one included: above the number of its cores, times of short phases are not to be trusted. What taking
the times costs at so few slave nodes: [results.md](../results.md#what-the-timing-costs).

![Contact time of all types](../pictures/paper_tables.png)

Bars: steps A, M and B over the contact time of type 1; above them the sum and, in brackets, the share
of the computation. Diamonds: the paper.

{quick}{sections}

{counts}

{reading}
"""
QUICK = """This was a quick run: level 1 alone, and the sliding ends after 2 ms of 6, in which the die is
pressed in and drawn along for 0.5 ms.

"""
READING = """## Where the ratios differ from the paper's, and why

Type 1 takes {slide_ns:.0f} ns for each slave node and step of the sliding at N_r = 1 and {crash_ns:.0f} ns in the
collision; the paper's 62 s and 3 s make {slide_paper:.0f} and {crash_paper:.0f} microseconds. A ratio to type 1 is a ratio to that:
what a type adds, and hardly shows beside microseconds, shows here.

- Step A, which all types share, is {low_a:.2f} to {high_a:.2f} of the contact time of type 1. A slave node keeps its segment from step
  to step until it leaves it, and nodes that cannot touch sleep: step A of type 1 takes {slide_a:.0f} ns a node and step in the sliding
  and {crash_a:.0f} ns in the collision.
- **Type 5** costs {low_5:.2f} to {high_5:.2f} times type 1 (paper 1.06 to 1.22). What it adds is step M, to find the feet of the slave
  nodes and the master nodes between them in each step: {low_m5:.2f} to {high_m5:.2f} of the whole contact time of type 1, at N_r = 1
  {low_m5_ns:.0f} to {high_m5_ns:.0f} ns a slave node and step.
- **Type 4**: {low_4:.2f} to {high_4:.2f} (paper 2.05 to 2.20). It follows two places on each slave segment (step A) and
  divides each among the master segments that it faces (step M).
- **Type 3**: {low_3:.2f} to {high_3:.2f} (paper 1.92 to 2.26), both surfaces are searched and
  pressed.
- **Type 6**: {low_6:.2f} to {high_6:.2f} (paper 3.41 to 5.85). Gauss points are followed and pressed one by
  one, six on a segment of the sliding and four in the collision.
- The cheapest that passes the patch test is type 5 in the paper. Here type 4 takes {over_slide} times as long as type 5 in the sliding
  and {over_crash} times in the collision. Which to choose over all scenes: [speed_accuracy](speed_accuracy.md).
"""


def slave_node_time(times, seconds, steps=None):
    """Nanoseconds for each slave node and step at N_r = 1."""
    return 1e9 * seconds / (SCENES[times.scene].slave_nodes * (steps or times.steps[1]))


def reading(slide, crash):
    """The texts of the comparison with the paper; '' unless the types of the paper have been timed."""
    cases = [(times, level) for times in (slide, crash) if times for level in times.levels]
    if not (slide and crash) or not all(times.has(level, k) for times, level in cases
                                        for k in (3, 4, 5, 6)):
        return ""
    values = {}
    for ctype in (3, 4, 5, 6):
        ratios = [times.ratio(level, ctype) for times, level in cases]
        values[f"low_{ctype}"], values[f"high_{ctype}"] = min(ratios), max(ratios)
    for name, ctype, step in (("m5", 5, "pairing"), ("a", 1, "search")):
        ratios = [times.ratio(level, ctype, step) for times, level in cases]
        values[f"low_{name}"], values[f"high_{name}"] = min(ratios), max(ratios)
    both = [slave_node_time(times, times.seconds[1][5]["pairing"]) for times in (slide, crash)]
    values["low_m5_ns"], values["high_m5_ns"] = min(both), max(both)
    over = {f"over_{name}": between([times.ratio(level, 4) / times.ratio(level, 5) for level in times.levels])
            for name, times in (("slide", slide), ("crash", crash))}
    return READING.format(
        slide_ns=slave_node_time(slide, slide.seconds[1][1]["contact"]),
        crash_ns=slave_node_time(crash, crash.seconds[1][1]["contact"]),
        slide_paper=1e-3 * slave_node_time(slide, 62.0, 150_000),
        crash_paper=1e-3 * slave_node_time(crash, 3.0, 10_000),
        slide_a=slave_node_time(slide, slide.seconds[1][1]["search"]),
        crash_a=slave_node_time(crash, crash.seconds[1][1]["search"]), **over, **values)


def page(rows, doc):
    """doc/studies/paper_tables.md and its picture."""
    all_times = {name: times for name, times in times_of(rows).items()
                 if times.has(times.levels[0], 1)}
    if not all_times:
        raise UserError("no finished runs of type 1")
    save_small(page_figure(all_times), doc / "pictures" / "paper_tables.png", lines=True)
    processors = sorted(set(finished(rows)["processor"]))
    quick = rows["quick"].any()
    write_page(doc, "paper_tables", PAGE.format(
        counts=instruction_section(rows, {name: scene.title for name, scene in SCENES.items()}),
        quick=QUICK if quick else "", processor="; ".join(processors),
        reading=reading(all_times.get("sliding"), all_times.get("collision")),
        sections="\n\n".join(section(times) for times in all_times.values())).rstrip() + "\n")


STUDY = Study("paper-tables", jobs, measure, chart, page=page, levels=(1, 2, 3, 4), repeats=3,
              quick_repeats=3)
