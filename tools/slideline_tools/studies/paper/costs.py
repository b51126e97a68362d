# SPDX-License-Identifier: MIT
"""Tables 1 and 2 and Figs. 23, 24, 29 and 32 of the paper: what contact costs, beside what it costs there."""
import dataclasses
from typing import Callable, Mapping, Sequence

import pandas as pd

from slideline_tools import scenes
from slideline_tools.contact_types import TYPES
from slideline_tools.plots import COLOURS, PAGE_WIDTH, STYLE, plt
from slideline_tools.studies.common import label, markdown_table
from slideline_tools.studies.framework.rules import between
from slideline_tools.studies.framework.times import LETTERS, contact_times, over_type_1

NO_OUTPUT = ("p:dtplot=1", "p:dthist=1")


@dataclasses.dataclass(frozen=True)
class Scene:
    """A scene of the paper that is timed.

    `figure`        where the paper shows its times
    `deck`          text of the deck by level
    `turns`, `cost` as in Job, at level 1; finer runs are longer and take fewer turns
    `options`       of the program in timed runs; `quick` shortens these
    `paper`         the paper's ratios to type 1 by type and level
    `slave_nodes`   at level 1, where the paper gives `seconds` and `steps` of type 1
    """

    title: str
    figure: str
    deck: Callable[[int], str]
    paper: Mapping
    levels: Sequence[int] = (1,)
    turns: int = 1
    cost: float = 1.0
    options: Sequence[str] = ()
    quick: Sequence[str] = ()
    slave_nodes: int = 0
    seconds: float = 0.0
    steps: int = 1


def by_level(*types_and_ratios):
    """{type: {level: ratio}} of (type, ratio at level 1, at level 2, ...)."""
    return {ctype: dict(enumerate(ratios, start=1)) for ctype, *ratios in types_and_ratios}


SCENES = {
    "block_implicit": Scene(
        "Blocks, implicit", "Fig. 23", lambda _: scenes.block(implicit=True), by_level((3, 2.0), (4, 3.0)), cost=6.0),
    "block": Scene(
        "Blocks, explicit", "Fig. 24", lambda _: scenes.block(), by_level((4, 2.4)), turns=12, cost=0.3),
    "sliding": Scene(
        "Sliding", "Table 1, Fig. 29", scenes.sliding,
        by_level((3, 2.25, 2.26, 2.26), (4, 2.09, 2.09, 2.20), (5, 1.22, 1.09, 1.12), (6, 4.98, 5.49, 5.85)),
        levels=(1, 2, 3), cost=15.0, options=(*NO_OUTPUT, "p:dtforc=2.0e-4"), quick=("endtim=2.0e-3",),
        slave_nodes=19, seconds=62.0, steps=150_000),
    "collision": Scene(
        "Collision", "Table 2, Fig. 32", scenes.collision,
        by_level((3, 1.92, 1.97, 1.95, 1.93), (4, 2.06, 2.05, 2.04, 2.05), (5, 1.20, 1.09, 1.06, 1.06),
                 (6, 3.41, 3.76, 3.82, 3.78)),
        levels=(1, 2, 3, 4), turns=12, options=NO_OUTPUT, slave_nodes=25, seconds=3.0, steps=10_000),
}


def times_of(table):
    """`contact_times` of the timed runs, with `ratio` and the steps over the contact time of type 1, and `share`.

    Only of scenes and meshes where type 1 has run.
    """
    times = contact_times(table[table["role"] == "time"])
    for step in LETTERS:
        times[f"{step}_ratio"] = over_type_1(times, step)
    times["ratio"] = over_type_1(times)
    times["whole_ratio"] = over_type_1(times, "computing", "computing")
    times["share"] = times["contact"] / times["computing"]
    return times[times["ratio"].notna()]


def cost_table(times):
    """Contact time over that of type 1, in brackets the paper's ratio."""
    columns = {"type": [label(ctype) for ctype in TYPES]}
    for (scene, level), ratios in times["ratio"].groupby(level=["scene", "level"], sort=False):
        ratios, paper = ratios.droplevel(["scene", "level"]), SCENES[scene].paper
        columns[f"{SCENES[scene].title}, N_r {level}"] = [
            (f"{ratios[ctype]:.2f}" if ctype in ratios else "")
            + (f" ({paper[ctype][level]:.2f})" if level in paper.get(ctype, {}) else "") for ctype in TYPES]
    return markdown_table(pd.DataFrame(columns))


def basis_table(times):
    """What the ratios stand on, a row for each scene and mesh; ranges are those of the types."""
    rows = []
    for (scene, level), found in times.groupby(level=["scene", "level"], sort=False):
        found = found.droplevel(["scene", "level"])
        one = SCENES[scene]
        nodes = one.slave_nodes if level == 1 else 0
        rows.append({
            "scene": f"{one.title}, N_r {level}", "contact time of type 1, ms": 1e3 * found["contact"][1],
            "a slave node and step of type 1, ns": 1e9 * found["contact"][1] / (nodes * found["steps"][1]) if nodes else None,
            "the paper's, microseconds": 1e6 * one.seconds / (nodes * one.steps) if nodes else None,
            "share of contact": between(100.0 * found["share"], "{:.1f}") + " %",
            "whole run with type 7 over type 1": found["whole_ratio"].get(7),
            "M of type 5 over contact of type 1": f"{found['pairing_ratio'][5]:.2f}" if 5 in found.index else "",
            "rounds": found["rounds"].min(), "quartiles apart": f"{100.0 * found['spread'].max():.0f} %"})
    return markdown_table(pd.DataFrame(rows))


def draw_bars(axes, times, scene, level):
    """Steps A, M, B of each type over the contact time of type 1; above them the sum and the share; the paper's ratios."""
    found = times.loc[scene, level]
    names = [str(ctype) for ctype in found.index]
    start = 0.0 * found["ratio"]
    for (step, title), colour in zip(LETTERS.items(), COLOURS):
        axes.bar(names, found[f"{step}_ratio"], bottom=start, color=colour, label=title, width=0.65)
        start = start + found[f"{step}_ratio"]
    theirs = {ctype: ratios[level] for ctype, ratios in SCENES[scene].paper.items() if ctype in found.index}
    for place, (ctype, ratio) in enumerate(found["ratio"].items()):
        # Above the bar, and above a diamond that would hide it.
        axes.annotate(f"{ratio:.2f}\n({100.0 * found['share'][ctype]:.0f} %)", (place, max(ratio, theirs.get(ctype, 0.0))),
                      ha="center", va="bottom", fontsize=6.5, xytext=(0, 4), textcoords="offset points")
    axes.plot([str(ctype) for ctype in theirs], list(theirs.values()), linestyle="none", marker="D", markersize=4.5,
              markerfacecolor="white", color="black", label="paper")
    axes.set_ylim(0.0, 1.25 * max([*found["ratio"], *theirs.values()]))
    axes.set_title(f"{SCENES[scene].title}, N_r = {level} ({SCENES[scene].figure.split(', ')[-1]})", loc="left")
    axes.set_xlabel("contact type")


def cost_figure(times):
    """Bars of each scene on its coarsest mesh."""
    first = {scene: level for scene, level, _ in reversed(times.index)}
    with plt.rc_context(STYLE):
        figure, panels = plt.subplots(2, 2, figsize=(PAGE_WIDTH + 1.0, 6.0), layout="constrained")
        for axes in panels.flat[len(first):]:
            axes.set_axis_off()
        for axes, scene in zip(panels.flat, (scene for scene in SCENES if scene in first)):
            draw_bars(axes, times, scene, first[scene])
        for axes in panels[:, 0]:
            axes.set_ylabel("contact time over that of type 1")
        panels.flat[0].legend()
        return figure
