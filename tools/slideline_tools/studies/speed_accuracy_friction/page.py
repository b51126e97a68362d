# SPDX-License-Identifier: MIT
"""The page and the chart of speed against accuracy with friction; types are named by framework/rules.py alone."""
from __future__ import annotations

import numpy as np

from slideline_tools.plots import PAGE_WIDTH, plt
from slideline_tools.studies.common import colour, label, marker, markdown_table, save_small, write_page
from slideline_tools.studies.framework.charts import styled
from slideline_tools.studies.framework.rules import COST_FACTOR, ERROR_FACTOR, RUN_FACTOR, between, least, names
from slideline_tools.studies.framework.table import finished
from slideline_tools.studies.framework.times import Times
from slideline_tools.studies.speed_accuracy.charts import plain_ticks
from slideline_tools.studies.speed_accuracy_friction.texts import PAGE

PANELS = (("partial_slip", "traction_error", "partial slip: traction, L2 error"),
          ("partial_slip", "edge_error", "partial slip: edge of the stick zone over a"),
          ("ironing", "roughness", "ironing: roughness of the horizontal force"),
          ("ironing", "largest", "ironing: its largest deviation"))
#: Mean vertical force over that of the reference below which a die has lost its slab.
LOST = 0.9
#: Times are told over those of this type: types 1 and 2 may not come through.
BASE = 5


def cases(rows, scene):
    """{(type, level): one of its runs}, in order; swept runs alone."""
    found = {}
    for row in finished(rows):
        if row["scene"] == scene and row["role"] == "sweep":
            found.setdefault((row["type"], row["level"]), row)
    return dict(sorted(found.items()))


def held(rows):
    """Types of ironing that come through on every mesh: whose mean vertical force is that of the reference."""
    there = cases(rows, "ironing")
    usual = reference_force(rows)
    return [ctype for ctype in sorted({one for one, _ in there})
            if all(row["vertical"] > LOST * usual for (one, _), row in there.items() if one == ctype)]


def reference_force(rows):
    """Mean vertical force of the reference, else of the median run, N/m."""
    fine = [row["vertical"] for row in finished(rows) if row["scene"] == "ironing" and row["role"] == "reference"]
    return fine[0] if fine else float(np.median([row["vertical"] for row in cases(rows, "ironing").values()]))


def swept_times(rows, scene):
    """Corrected medians of the times of a scene."""
    return Times([row for row in rows if row.get("role") == "sweep"], scene)


def draw_points(rows):
    """Error over computing time: a panel for each measure."""
    panels_there = [one for one in PANELS if any(one[1] in row for row in cases(rows, one[0]).values())]
    figure, panels = plt.subplots((len(panels_there) + 1) // 2, 2, squeeze=False, layout="constrained",
                                  figsize=(PAGE_WIDTH + 0.5, 0.6 + 2.5 * ((len(panels_there) + 1) // 2)))
    for axes in panels.flat[len(panels_there):]:
        axes.set_axis_off()
    for axes, (scene, key, title) in zip(panels.flat, panels_there):
        times, there = swept_times(rows, scene), cases(rows, scene)
        for ctype in sorted({one for one, _ in there}):
            points = [(times.seconds[level][ctype]["computing"], row[key]) for (one, level), row in there.items()
                      if one == ctype and key in row]
            lost = scene == "ironing" and ctype not in held(rows)
            axes.plot(*zip(*points), color=colour(ctype), marker=marker(ctype), markersize=4.5, linewidth=0.8,
                      linestyle=":" if lost else "-", markerfacecolor="white" if lost else colour(ctype), label=label(ctype))
        axes.set(xscale="log", yscale="log")
        axes.set_title(title, loc="left", fontsize=8)
        axes.grid(True, which="major", linewidth=0.3, color="#bbbbbb")
        axes.margins(0.12, 0.15)
        for axis in (axes.xaxis, axes.yaxis):
            plain_ticks(axis)
        if scene == panels_there[-1][0]:
            axes.set_xlabel("computing time, s")
    handles = {}
    for axes in panels.flat:
        for line, text in zip(*axes.get_legend_handles_labels()):
            handles.setdefault(text, line)
    figure.legend(handles.values(), handles, loc="outside lower center", ncols=4, fontsize=7)
    return figure


def slip_table(rows, level):
    """Partial slip of all types on one mesh."""
    lines = [[label(ctype), f"{row['segments']:.1f}", f"{row['shear']:.3f}", f"{row['traction_error']:.3f}",
              f"{row['pressed']:.3f}", f"{row['edge_error']:.3f}", row["iterations"]]
             for (ctype, own), row in cases(rows, "partial_slip").items() if own == level]
    return markdown_table(["type", "a over segment", "Q/(mu P)", "traction, L2 error", "left by pressing",
                           "stick edge, error over a", "Newton iterations"], lines)


def iron_table(rows, level):
    """Ironing of all types on one mesh."""
    times, through = swept_times(rows, "ironing"), held(rows)
    usual = reference_force(rows)
    lines = []
    for (ctype, own), row in cases(rows, "ironing").items():
        if own == level:
            seconds, first = times.seconds[level][ctype], times.seconds[level].get(BASE)
            lines.append([label(ctype), "yes" if ctype in through else "no", f"{row['vertical'] / usual:.3f}",
                          f"{row['horizontal'] / usual:.4f}", f"{100 * row['roughness']:.2f}", f"{100 * row['largest']:.1f}",
                          f"{100 * row['vertical_roughness']:.2f}",
                          f"{100 * row['force_error']:.1f}" if "force_error" in row else "",
                          f"{seconds['contact'] / first['contact']:.2f}" if first else "",
                          f"{seconds['computing'] / first['computing']:.2f}" if first else "",
                          f"{100 * seconds['contact'] / seconds['computing']:.0f}"])
    return markdown_table(["type", "comes through", "vertical force over the reference's", "horizontal force over it",
                           "roughness, %", "largest, %", "vertical roughness, %", "difference to the reference, %",
                           f"contact time over type {BASE}", f"computing time over type {BASE}",
                           "share of contact, %"], lines)


def mean_of(rows, scene, key, types):
    """{type: geometric mean of a column over the meshes}."""
    there = cases(rows, scene)
    return {ctype: float(np.exp(np.mean([np.log(row[key]) for (one, _), row in there.items() if one == ctype and key in row])))
            for ctype in types if any(one == ctype and key in row for (one, _), row in there.items())}


def mean_cost(rows, scene, cost, types):
    """{type: geometric mean over the meshes of its time over that of type `BASE`}."""
    times = swept_times(rows, scene)
    return {ctype: float(np.exp(np.mean([np.log(times.seconds[level][ctype][cost] / times.seconds[level][BASE][cost])
                                         for level in times.levels if {ctype, BASE} <= set(times.seconds[level])])))
            for ctype in types}


def advice(rows):
    """The recommendation, sentence by sentence, from the figures by the rules."""
    types = sorted({ctype for ctype, _ in cases(rows, "partial_slip")})
    through = held(rows)
    lost = [ctype for ctype in types if ctype not in through]
    errors, pressed, steps = (mean_of(rows, "partial_slip", key, types) for key in ("traction_error", "pressed", "iterations"))
    rough, costs = mean_of(rows, "ironing", "roughness", through), mean_cost(rows, "ironing", "contact", through)
    words = []
    if lost:
        words.append(f"**Not {names(lost)} where a foot is drawn along a slab of finer or like segments**: nodes of the slab that no node "
                     "of the slave looks after come in between; the foot ploughs, or sinks in as a whole.")
    smooth, cheap = least(rough, ERROR_FACTOR), least(costs, COST_FACTOR)
    words.append(f"**The smoothest force of ironing: {names(smooth)}** (roughness of the horizontal force, geometric mean of the meshes: "
                 + listed({ctype: 100.0 * value for ctype, value in rough.items()}, "{:.2f} %") + f"; less than a factor of {ERROR_FACTOR:g} counts as alike).")
    words.append(f"**The cheapest of those that come through: {names(cheap)}** (contact time over that of type {BASE}: "
                 + listed(costs, "{:.2f}") + f"; less than a factor of {COST_FACTOR:g} counts as alike).")
    both = [ctype for ctype in smooth if ctype in cheap]
    if both:
        words.append(f"**So {names(both)}** {'is' if len(both) == 1 else 'are'} among the smoothest and among the cheapest.")
    best, quick = least(errors, ERROR_FACTOR), least(steps, RUN_FACTOR)
    words.append(f"**Partial slip: {'no type is better than another' if len(best) == len(types) else names(best)}** (error of the traction, geometric "
                 "mean of the meshes: " + listed(errors, "{:.3f}") + "). From one mesh to the next finer one the error changes by factors of "
                 + ", ".join(f"{ratio:.2f}" for ratio in halvings(rows)) + " (mean of the types), not to nothing: pressing alone has left tractions of "
                 f"{between(pressed.values(), '{:.3f}')} of the same norm, since the two bodies are no half planes and spread unlike, and the closed form "
                 f"knows nothing of them. Fewest iterations: {names(quick)} ({listed(steps, '{:.0f}')}).")
    return "\n".join(f"- {one}" for one in words)


def listed(values, form):
    """'type 4 0.07, type 5 0.06'."""
    return ", ".join(f"type {ctype} {form.format(value)}" for ctype, value in values.items())


def halvings(rows):
    """Error of each mesh over that of the next coarser one, mean over the types."""
    there = cases(rows, "partial_slip")
    levels = sorted({level for _, level in there})
    types = sorted({ctype for ctype, _ in there})
    return [float(np.mean([there[ctype, fine]["traction_error"] / there[ctype, coarse]["traction_error"] for ctype in types
                           if (ctype, fine) in there and (ctype, coarse) in there])) for coarse, fine in zip(levels[:-1], levels[1:])]


def write_friction_page(rows, doc):
    """doc/studies/speed_accuracy_friction.md and its picture."""
    with styled():
        save_small(draw_points(rows), doc / "pictures" / "speed_accuracy_friction.png", lines=True)
    levels = {scene: sorted({level for _, level in cases(rows, scene)}) for scene in ("partial_slip", "ironing")}
    floors = [row["force_error_floor"] for row in cases(rows, "ironing").values() if "force_error_floor" in row]
    iron = swept_times(rows, "ironing")
    write_page(doc, "speed_accuracy_friction", PAGE.format(
        advice=advice(rows), floor=f"{100 * floors[0]:.1f} %" if floors else "unknown", lost=LOST,
        rounds=iron.rounds, spread=100 * iron.spread, load=iron.load,
        slip="\n\n".join(f"N_r = {level}:\n\n{slip_table(rows, level)}" for level in levels["partial_slip"]),
        iron="\n\n".join(f"N_r = {level}:\n\n{iron_table(rows, level)}" for level in levels["ironing"])))
