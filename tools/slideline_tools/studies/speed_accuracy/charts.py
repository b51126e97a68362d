# SPDX-License-Identifier: MIT
"""Charts of the study speed-accuracy: error over cost, one figure for each scene."""
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from slideline_tools.plots import PAGE_WIDTH, STYLE, plt
from slideline_tools.studies.common import colour, label, marker, save_small
from slideline_tools.studies.speed_accuracy.points import COSTS, errors_of, front, named, points_of
from slideline_tools.studies.speed_accuracy.scenes import SCENES

LOWEST = 1.0e-12  # errors are drawn here at least
MARKS = [
    Line2D([], [], color="black", linewidth=1.6, alpha=0.35, label="Pareto front"),
    Line2D([], [], linestyle="none", marker="o", color="#555555", markerfacecolor="white",
           markersize=4.5, label="hollow: below what the reference resolves"),
    Patch(facecolor="#00000010", label="shaded: error of the reference (the larger)")]


def draw_type(axes, rows, cost, ctype):
    """Points of one series from mesh to mesh; hollow where the reference does not resolve them."""
    error = rows["error"].clip(lower=LOWEST)
    axes.plot(rows[cost], error, color=colour(ctype), linewidth=0.7, alpha=0.8)
    for reported, face in ((True, colour(ctype)), (False, "white")):
        chosen = rows["resolved"] == reported
        axes.plot(rows[cost][chosen], error[chosen], linestyle="none", marker=marker(ctype),
                  color=colour(ctype), markersize=4.5, markerfacecolor=face)


def draw_panel(axes, errors, cost):
    """One measure over one cost, with the Pareto front, whose points are named."""
    for ctype, rows in errors.groupby("type", observed=True):
        draw_type(axes, rows.sort_values("level"), cost, ctype)
    best = front(errors, cost)
    axes.step(best[cost], best["judged"].clip(lower=LOWEST), where="post", color="black",
              linewidth=1.6, alpha=0.35, zorder=0)
    axes.set(xscale="log", yscale="log")
    axes.margins(0.12, 0.15)
    for x, y, name in zip(best[cost], best["error"].clip(lower=LOWEST), named(best)):
        axes.annotate(name, (x, y), fontsize=7, xytext=(-3.0, -3.0), textcoords="offset points",
                      ha="right", va="top")
    low, high = axes.get_ylim()
    if errors["floor"].max() > low:
        axes.axhspan(low, min(errors["floor"].max(), high), color="#00000010", linewidth=0)
        axes.set_ylim(low, high)
    axes.grid(True, which="major")
    for axis in (axes.xaxis, axes.yaxis):
        plain_ticks(axis)


def plain_ticks(axis):
    """Ticks at 1, 2 and 5 on a short logarithmic axis, at decades on a long one."""
    low, high = axis.get_view_interval()
    if high < 300.0 * low:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def scene_figure(name, errors):
    """A row of panels for each measure, a column for each cost."""
    titles = {measure.key: measure.title for measure in SCENES[name].measures}
    groups = errors.groupby("measure", sort=False)
    figure, panels = plt.subplots(len(groups), len(COSTS), squeeze=False, sharey="row",
                                  layout="constrained",
                                  figsize=(PAGE_WIDTH + 0.5, 0.7 + 2.5 * len(groups)))
    for row, (key, rows) in zip(panels, groups):
        for axes, cost in zip(row, COSTS):
            draw_panel(axes, rows, cost)
        row[0].set_title(titles[key], loc="left")
    for axes, text in zip(panels[-1], COSTS.values()):
        axes.set_xlabel(f"{text} of the run, s")
    types = [Line2D([], [], linestyle="none", marker=marker(ctype), color=colour(ctype),
                    markersize=4.5, label=label(ctype)) for ctype in sorted_types(errors)]
    figure.legend(handles=MARKS + types, loc="outside lower center", ncols=4)
    figure.suptitle(f"{SCENES[name].title}: type/N_r named on the Pareto front", fontsize=9)
    return figure


def sorted_types(rows):
    """The series of some rows, in order."""
    return rows["type"].cat.remove_unused_categories().cat.categories


def chart(table, folder):
    """One figure for each scene."""
    for name, errors in errors_of(points_of(table)).groupby("scene", sort=False):
        with plt.rc_context({**STYLE, "savefig.dpi": 110}):
            save_small(scene_figure(name, errors), folder / f"speed_accuracy_{name}.png",
                       lines=True)
