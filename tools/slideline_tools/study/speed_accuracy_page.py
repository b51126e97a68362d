# SPDX-License-Identifier: MIT
"""The page doc/studies/speed_accuracy.md and its pictures: what to choose, scene by scene, and why
the ratios differ from the paper's."""
import numpy as np

from slideline_tools import UserError
from slideline_tools.plots import plt
from slideline_tools.studies.common import TYPES, label, markdown_table, save_small, write_page
from slideline_tools.study import paper_tables
from slideline_tools.study.charts import styled
from slideline_tools.study.counted import instruction_section
from slideline_tools.study.speed_accuracy_advice import (Overview, advice, overall_table,
                                                         target_table)
from slideline_tools.study.speed_accuracy_charts import scene_figure
from slideline_tools.study.speed_accuracy_front import (COSTS, GAIN, TIE, front, points_of,
                                                        swept_rows, times_of)
from slideline_tools.study.speed_accuracy_scenes import SCENES
from slideline_tools.study.table import finished

PAPER_SCENES = ("sliding", "collision")

PAGE = """# Speed against accuracy: which contact type to choose

This page and its pictures are written by `tools/study.sh speed-accuracy --publish`: do not edit it. The
recommendation and its figures are computed from the runs.

## What to choose

{advice}

By type, over type 1 on the same mesh (geometric means over meshes; the times over all scenes, in brackets from
scene to scene). Below 1 is cheaper, or more accurate; errors that can not be told from that of the reference or
of the closed form count as that. The last column counts the fronts of computing time, below, that the type has a point on.

{overall}

The cheapest type and mesh (type/N_r) by computing time that keeps an error at or below a target:

{targets}

## How it is measured

- One thread on {processor}. {build}.
- Every run is timed and judged. All variants run in turn, then again in the next round: medians of at least {rounds}
  runs, corrected by the pace of the element loop of the same run (as in [paper_tables](paper_tables.md)). Quartiles of
  the contact times lie at most {spread:.0f} % of the median apart, {short}{load}.
- Contact time is search, pairing and force; computing time is the whole run without input and output.
- The interface is as stiff for all types: in type 3 the springs of both passes add up, so each has half the penalty.
  The penalty, N_r and what it divides are those of the decks.
- On the Pareto front are the types and meshes that nothing beats in cost and error at once. Errors within {gain:.0f} % of
  each other count as equal, and so do times within {tie:.0f} %.
- Where there is no closed form, type 7 on a finer mesh is the reference. Its own error is extrapolated (Richardson) from
  the distances of its finest levels, with the order they show (0.5 to 2). A smaller error is drawn hollow, stands in
  brackets in the tables and counts as that error: the run is then as good as the reference, and not known better.

{references}

{scenes}

{counts}

{paper}
"""

TEXTS = {
    "patch": """Two blocks under a uniform pressure of 1 Pa, explicit and damped to rest in about 4 s; the non-uniform
7 / 5 meshes of [the patch test](patch_test.md), each quad divided into N_r x N_r. Exact: 1 Pa at every node of both sides
(round-off: below 1e-9). Refinement does not help a type that fails: the error is that of single nodes.""",
    "block": """[Block-to-block](block_to_block.md), 51 N_r over 50 N_r quads, 0.2 s in 2000 steps (a tenth of that page's
steps, so that there is a time to measure). Exact: the pressure of a separate one-dimensional solution (a chain of masses
and springs) with the springs that the type has. What is left of the types that pass is the elements' own lateral stress.""",
    "hertz": """[Hertz](hertz.md), cylinder on block, 50 microseconds. Errors against the closed form: largest distance of a
nodal pressure from the ellipse inside 0.8 a, over p0; and the half width. The closed form leaves out finite strain, about 0.1 %
here. The penalty is a layer of springs, which widens the contact in the same way for all types.""",
    "sliding": """[Sliding](sliding.md), 6 ms. The error is the difference of the vertical force to the reference at the same
time, root mean square over the mean force in the judged time: above all that of the mesh, whose segments the die
passes one by one. The roughness (force less its trend, as defined there) is that of the contact, and needs no reference.""",
    "collision": """[Collision](collision.md), 1 ms. Plastic work: yield stress times plastic strain times area at the end, summed
over each of the 36 columns of the level 1 plate (the error is the sum of the differences over the sum) and in total. (The
largest plastic strain itself sits at the clamp and does not converge.) Rebound: difference of the mean final velocity over
the 80 m/s of the impact; it is a small difference of large impulses. The energy error is that of the balance. N_r = 6 is the
finest mesh that serves as a reference: with N_r = 8 the elements below the edge of the projectile collapse into hourglass
modes (viscous form), and plastic work and rebound change again.""",
}


def percent(point, key):
    """An error in per cent; in brackets if it is not resolved."""
    if point.floor[key] and not point.resolved(key) and point.floor[key] < 1e-6:
        return f"< {100.0 * point.floor[key]:.0e}".replace("e-0", "e-")
    text = f"{100.0 * point.error[key]:.2g}"
    return text if point.resolved(key) else f"({text})"


def scene_table(scene, points):
    """Rows: types; for each mesh the times and the errors."""
    keys = [measure.key for measure in scene.measures
            if any(measure.key in point.error for point in points)]
    levels, rows = sorted({point.level for point in points}), []
    for ctype in TYPES:
        mine = {point.level: point for point in points if point.type == ctype}
        if mine:
            rows.append([label(ctype), *(table_cell(mine.get(level), keys) for level in levels)])
    return markdown_table(["type", *(f"N_r = {level}" for level in levels)], rows)


def table_cell(point, keys):
    if point is None:
        return ""
    errors = ", ".join(percent(point, key) for key in keys if key in point.error)
    return f"{point.cost['contact']:.2g} / {point.cost['computing']:.2g} s; {errors} %"


def front_error(point, key):
    """An error in words."""
    if point.resolved(key) or point.floor[key] < 1e-6:
        return f"{percent(point, key)} %"
    return f"not above {100.0 * point.floor[key]:.2g} %"


def front_lines(scene, points):
    """The fronts in words."""
    lines = []
    for measure in scene.measures:
        if not any(measure.key in point.error for point in points):
            continue
        parts = []
        for cost, title in COSTS.items():
            on_it = ", ".join(f"{point.name} ({front_error(point, measure.key)})"
                              for point in front(points, cost, measure.key))
            parts.append(f"{title} {on_it}")
        lines.append(f"- {measure.title}: {'; '.join(parts)}")
    return "\n".join(lines)


def scene_section(name, points):
    """Text, picture, table and fronts of a scene."""
    scene = SCENES[name]
    errors = "; ".join(measure.title for measure in scene.measures
                       if any(measure.key in point.error for point in points))
    return "\n\n".join([
        f"## {scene.title}", TEXTS[name],
        f"![{scene.title}: error over cost](../pictures/speed_accuracy_{name}.png)",
        f"Contact / computing time, and errors in per cent ({errors}):",
        scene_table(scene, points), "Type/N_r on the fronts, with the error:",
        front_lines(scene, points)])


def reference_table(rows):
    """What the references are and how far they are known."""
    lines = []
    for name, scene in SCENES.items():
        mine = [row for row in finished(rows) if row["scene"] == name]
        for measure in scene.measures:
            known = [row for row in mine if f"{measure.key}_floor" in row]
            if measure.referenced and known:
                row = known[0]
                lines.append([f"{scene.title}: {measure.title}", f"N_r = {row['reference_levels']}",
                              f"{row[f'{measure.key}_order']:.2f}",
                              f"{100.0 * row[f'{measure.key}_floor']:.2g} %"])
    if not lines:
        return ""
    return markdown_table(["reference", "meshes of type 7, the last is the reference", "order",
                           "own error"], lines)


# ---- beside the paper --------------------------------------------------------------------------

PAPER = """## Where the ratios differ from the paper's

Contact time over that of type 1, smallest to largest of the meshes; in the sliding also how many points carry pressure
at a time (mean of the judged time, N_r = {level}), and contact time for each of them and each step.

{table}

The paper ranks its types by these ratios (its Tables 1 and 2): NTS-mAR next to the classical NTS, VTS-PPT and two passes
about twice it, mortar farthest. What differs here is above all the type 1 that all are divided by: a slave node that
touches keeps its segment from step to step, the nodes that touch are projected in blocks with vector instructions, and
nodes that can not touch sleep. A point costs type 1 some {nanoseconds:.0f} ns a step. The paper's 62 s for 150 000 steps of 19
slave nodes are 22 microseconds a node; beside that, whatever a type adds is small.

Here the search does not prevail, and what the paper's ratios hide comes out: how many points a type places (the
column *points*), and that types 4, 5 and 7 divide the surface anew in each step (pairing), which types 1 and 2 never do.
[paper_tables](paper_tables.md) has the steps one by one. A ratio of contact times is no ratio of computations: see the
shares above.
"""


def ratio_range(times, ctype):
    """'1.20 to 1.30' of the meshes."""
    found = [times.ratio(level, ctype) for level in times.levels if times.has(level, ctype)]
    return f"{min(found):.2f} to {max(found):.2f}" if found else ""


def paper_range(scene, ctype):
    found = paper_tables.SCENES[scene].paper.get(ctype, {}).values()
    return f"{min(found):.2f} to {max(found):.2f}" if found else "1" if ctype == 1 else ""


def paper_section(rows, times):
    """The comparison; '' without type 1 in both scenes."""
    if not all(name in times and times[name].has(times[name].levels[0], 1)
               for name in PAPER_SCENES):
        return ""
    slide, lines = times["sliding"], []
    level = slide.levels[0]
    points = {row["type"]: row["points"] for row in swept_rows(rows)
              if row["scene"] == "sliding" and row["level"] == level}
    cost = {ctype: 1e9 * seconds["contact"] / slide.steps[level] / points[ctype]
            for ctype, seconds in slide.seconds[level].items()}
    for ctype in sorted(cost):
        lines.append([label(ctype), *(text for name in PAPER_SCENES for text in
                                      (ratio_range(times[name], ctype), paper_range(name, ctype))),
                      f"{points[ctype]:.0f}", f"{cost[ctype]:.0f} ns"])
    table = markdown_table(["type", "sliding", "paper, Table 1", "collision", "paper, Table 2",
                            "points", "contact time of a point and step"], lines)
    return PAPER.format(level=level, table=table, nanoseconds=cost[1])


# ---- the page ----------------------------------------------------------------------------------

def short_text(times):
    """Which scene scatters most."""
    worst = max(times, key=lambda name: times[name].spread)
    return f"most in the scene {SCENES[worst].title}"


def load_text(rows):
    """How busy the machine was, where the runs say so."""
    loads = [row["load"] for row in rows if "load" in row]
    return f"; load of the machine before a run {np.median(loads):.1f} (median)" if loads else ""


def page(rows, doc):
    """doc/studies/speed_accuracy.md and a picture for each scene."""
    times = times_of(rows)
    points = {name: found for name, found in points_of(rows, times).items()
              if any(point.error for point in found)}
    if not points:
        raise UserError("no finished runs")
    over = Overview(points)
    for name, found in points.items():
        with styled(), plt.rc_context({"savefig.dpi": 110}):
            save_small(scene_figure(name, found),
                       doc / "pictures" / f"speed_accuracy_{name}.png", lines=True)
    swept = swept_rows(rows)
    write_page(doc, "speed_accuracy", PAGE.format(
        advice=advice(over), overall=overall_table(over), targets=target_table(over),
        processor="; ".join(sorted({row["processor"] for row in swept})),
        build="; ".join(sorted({row["build"] for row in swept})),
        rounds=min(found.rounds for found in times.values()),
        spread=100.0 * np.max([found.spread for found in times.values()]),
        short=short_text(times), load=load_text(swept), gain=100.0 * GAIN, tie=100.0 * TIE,
        references=reference_table(rows),
        counts=instruction_section(rows, {name: scene.title for name, scene in SCENES.items()}),
        scenes="\n\n".join(scene_section(name, found) for name, found in points.items()),
        paper=paper_section(rows, times)).rstrip() + "\n")
