# SPDX-License-Identifier: MIT
"""The page doc/studies/speed_accuracy.md and its pictures: what to choose, and scene by scene."""
import numpy as np

from slideline_tools import UserError
from slideline_tools.contact_types import HARD, SERIES
from slideline_tools.plots import plt
from slideline_tools.studies.common import label, markdown_table, save_small, write_page
from slideline_tools.studies.framework.charts import styled
from slideline_tools.studies.framework.counted import instruction_section
from slideline_tools.studies.framework.rules import COST_FACTOR, ERROR_FACTOR, RUN_FACTOR
from slideline_tools.studies.framework.table import finished, records
from slideline_tools.studies.speed_accuracy.advice import (Overview, advice, overall_table,
                                                          target_table)
from slideline_tools.studies.speed_accuracy.charts import scene_figure
from slideline_tools.studies.speed_accuracy.front import (COSTS, GAIN, TIE, front, points_of,
                                                         swept_rows, times_of)
from slideline_tools.studies.speed_accuracy.reference import REFERENCE_TYPE, reference_series
from slideline_tools.studies.speed_accuracy.scenes import SCENES, TWO_PASS, node_penalty

PAGE = """# Speed against accuracy: which contact type to choose

This page and its pictures are written by `tools/study.sh speed-accuracy --publish`: do not edit it. The
recommendation and its figures are computed from the runs.

## What to choose

7i and 7h stand for type 7 with implicit penalty (PUNIT 4): with its default PEN of 10, and with PEN below 0, without compliance.

{advice}

By type, over type 1 on the same mesh (geometric means over meshes; the times over all scenes, in brackets from
scene to scene). Below 1 is cheaper, or more accurate; errors that can not be told from that of the reference or
of the closed form count as that. The last column is the largest net moment of the contact forces at the end of a run, over
their sum on one side times a slave segment.

{overall}

The cheapest types and mesh (types/N_r) by computing time that keep an error at or below a target: all that take less than
{run_factor:g} times the shortest time, which stands behind them.

{targets}

## How it is measured

- One thread on {processor}. {build}.
- Every run is timed and judged. All variants run in turn, then again in the next round: medians of at least {rounds}
  runs, corrected by the pace of the element loop of the same run (as in [paper_tables](paper_tables.md)). Quartiles of
  the contact times lie at most {spread:.0f} % of the median apart, {short}{load}.
- Contact time is search, pairing and force; computing time is the whole run without input and output.
- The interface is as stiff for all types: in type 3 the springs of both passes lie side by side, e/l_sl + e/l_ms, so that
  its penalty e is that of the others times l_ms/(l_sl + l_ms), l_sl and l_ms the mean segments of slave and master: {two_pass}. (The other
  pages have the penalty of the paper's rule, the same e for all types.) The penalty, N_r and what it divides are those of the decks.
  PUNIT 4 has stiffnesses of its own: 7i 10 times `K L/A` of the softer side, which grows with N_r, and 7h none. Each is judged by what it
  models: the blocks by a chain with its springs, at the end of the step; sliding and collision by a finer mesh without compliance. So the
  errors of 7i and 7h do not hold that their interface is another one. The last column of the table below says how far the two references are
  apart: what the springs of the decks add to the answer of rigid contact. Charts are shaded up to the larger of the errors of both references.
- Which types are named above: means of contact times within a factor of {cost_factor:g} count as alike, and errors within a factor of
  {error_factor:g}; several types can be named (`tools/slideline_tools/studies/framework/rules.py`; its test repeats the comparison with the scatter of the times).
- On the Pareto front are the types and meshes that nothing beats in cost and error at once. Errors within {gain:.0f} % of
  each other count as equal, and so do times within {tie:.0f} %. Single points of it may change when the runs are repeated.
- Where there is no closed form, type 7 on a finer mesh is the reference, 7h for 7i and 7h. Its own error is extrapolated (Richardson) from
  the distances of its finest levels, with the order they show (0.5 to 2). A smaller error is drawn hollow, stands in
  brackets in the tables and counts as that error: the run is then as good as the reference, and not known better.

{references}

{scenes}

{counts}

What each step of the contact costs, and how that compares with the paper: [paper_tables](paper_tables.md).
"""

TEXTS = {
    "patch": """Two blocks under a uniform pressure of 1 Pa, explicit and damped to rest in about 4 s; the non-uniform
7 / 5 meshes of [the patch test](patch_test.md), each quad divided into N_r x N_r. Exact: 1 Pa at every node of both sides
(round-off: below 1e-9). Refinement does not help a type that fails: the error is that of single nodes.""",
    "block": """[Block-to-block](block_to_block.md), 51 N_r over 50 N_r quads, 0.2 s in 2000 steps (a tenth of that page's
steps, so that there is a time to measure). Exact: the pressure of a separate one-dimensional solution (a chain of masses
and springs) with the springs that the type has; with PUNIT 4 they act by the end of the step. What is left of the types that pass is the elements' own lateral stress.""",
    "hertz": """Hertz, cylinder on block, 50 microseconds. Errors against the closed form: largest distance of a
nodal pressure from the ellipse inside 0.8 a, over p0; and the half width. The closed form leaves out finite strain, about 0.1 %
here. The penalty is a layer of springs, which widens the contact in the same way for all types; 7i and 7h have less of it or none.""",
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
    for ctype in SERIES:
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
        mine = [row for row in records(finished(rows)) if row["scene"] == name]
        for measure in scene.measures:
            for reference in (REFERENCE_TYPE, HARD):
                known = [row for row in mine if f"{measure.key}_floor" in row
                         and reference_series(row["type"]) == reference]
                if measure.referenced and known:
                    lines.append(reference_cells(f"{scene.title}: {measure.title}", known[0], measure.key, reference))
    if not lines:
        return ""
    return markdown_table(["reference", "type", "meshes, the last is the reference", "order", "own error",
                           "the two references apart"], lines)


def reference_cells(title, row, key, reference):
    """One row of that table."""
    apart = row.get(f"{key}_springs")
    return [title, str(reference), f"N_r = {row['reference_levels']}", f"{row[f'{key}_order']:.2f}",
            f"{100.0 * row[f'{key}_floor']:.2g} %", "" if apart is None else f"{100.0 * apart:.2g} %"]


# ---- the page ----------------------------------------------------------------------------------

def short_text(times):
    """Which scene scatters most."""
    worst = max(times, key=lambda name: times[name].spread)
    return f"most in the scene {SCENES[worst].title}"


def load_text(rows):
    """How busy the machine was, where the runs say so."""
    loads = rows["load"].dropna().tolist()
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
        processor="; ".join(sorted(set(swept["processor"]))),
        build="; ".join(sorted(set(swept["build"]))),
        rounds=min(found.rounds for found in times.values()),
        spread=100.0 * np.max([found.spread for found in times.values()]),
        short=short_text(times), load=load_text(swept), gain=100.0 * GAIN, tie=100.0 * TIE,
        references=reference_table(rows),
        counts=instruction_section(rows, {name: scene.title for name, scene in SCENES.items()}),
        run_factor=RUN_FACTOR, cost_factor=COST_FACTOR, error_factor=ERROR_FACTOR,
        two_pass=", ".join(f"{node_penalty(scene, 1, TWO_PASS) / scene.penalty(1):.2f} in {scene.title}"
                           for scene in SCENES.values()),
        scenes="\n\n".join(scene_section(name, found) for name, found in points.items())))
