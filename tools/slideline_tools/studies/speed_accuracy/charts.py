# SPDX-License-Identifier: MIT
"""Charts of the study speed-accuracy: error over cost, one figure for each scene."""
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from slideline_tools.plots import PAGE_WIDTH, STYLE, plt
from slideline_tools.studies.common import colour, label, marker
from slideline_tools.studies.framework.charts import save, styled
from slideline_tools.studies.speed_accuracy.front import COSTS, front, points_of, times_of
from slideline_tools.studies.speed_accuracy.scenes import SCENES

LOWEST = 1.0e-12  # errors are drawn here at least
POINT = STYLE["figure.dpi"] / 72.0    # pixels of a point of print
NAME_WIDTH, NAME_HEIGHT = 15.0, 8.0   # of "7/4" in points
#: what the marks mean that all types have
MARKS = {"Pareto front": Line2D([], [], color="black", linewidth=1.6, alpha=0.35),
         "hollow: below what the reference resolves": Line2D([], [], linestyle="none", marker="o", color="#555555",
                                                             markerfacecolor="white", markersize=4.5),
         "shaded: error of the reference": Patch(facecolor="#00000010")}


def draw_type(axes, points, cost, key):
    """Points of one type, joined from mesh to mesh; hollow where the reference does not resolve the error."""
    ctype = points[0].type
    x = [point.cost[cost] for point in points]
    y = [max(point.error[key], LOWEST) for point in points]
    axes.plot(x, y, color=colour(ctype), linewidth=0.7, alpha=0.8)
    for flag, face in ((True, colour(ctype)), (False, "white")):
        chosen = [k for k, point in enumerate(points) if point.resolved(key) is flag]
        axes.plot([x[k] for k in chosen], [y[k] for k in chosen], linestyle="none",
                  marker=marker(ctype), color=colour(ctype), markersize=4.5,
                  markerfacecolor=face, label=label(ctype) if flag else None)


def draw_panel(axes, scene, points, cost, measure):
    """One measure over one cost, with the Pareto front."""
    key = measure.key
    points = [point for point in points if key in point.error]
    for ctype in sorted({point.type for point in points}):
        draw_type(axes, sorted((point for point in points if point.type == ctype),
                               key=lambda point: point.level), cost, key)
    best = front(points, cost, key)
    axes.step([point.cost[cost] for point in best],
              [max(point.judged(key), LOWEST) for point in best], where="post", color="black",
              linewidth=1.6, alpha=0.35, zorder=0)
    axes.set(xscale="log", yscale="log")
    axes.margins(0.12, 0.15)
    name_points(axes, [(point.cost[cost], max(point.error[key], LOWEST), point.name) for point in best])
    low, high = axes.get_ylim()
    floor = max((point.floor[key] for point in points), default=0.0)
    if floor > low:
        axes.axhspan(low, min(floor, high), color="#00000010", linewidth=0)
        axes.set_ylim(low, high)
    axes.grid(True, which="major", linewidth=0.3, color="#bbbbbb")
    for axis in (axes.xaxis, axes.yaxis):
        plain_ticks(axis)


def name_points(axes, named):
    """Names below and to the left of points (x, y, name); one that would lie on an earlier one goes farther down, and
    has no room where three are taken."""
    taken = []
    for x, y, name in named:
        place = axes.transData.transform((x, y))
        for down in range(3):
            spot = place + POINT * np.array([-3.0, -3.0 - NAME_HEIGHT * down])
            if all(abs(spot[0] - one[0]) > POINT * NAME_WIDTH or abs(spot[1] - one[1]) > POINT * NAME_HEIGHT for one in taken):
                axes.annotate(name, (x, y), fontsize=7, xytext=(-3.0, -3.0 - NAME_HEIGHT * down),
                              textcoords="offset points", ha="right", va="top")
                taken.append(spot)
                break


def plain_ticks(axis):
    """Ticks at 1, 2 and 5 on a short logarithmic axis, at decades on a long one."""
    low, high = axis.get_view_interval()
    if high < 300.0 * low:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def scene_figure(name, points):
    """A row of panels for each measure, a column for each cost; call it within `styled()`."""
    scene = SCENES[name]
    measures = [measure for measure in scene.measures
                if any(measure.key in point.error for point in points)]
    figure, panels = plt.subplots(len(measures), len(COSTS), squeeze=False, layout="constrained",
                                  figsize=(PAGE_WIDTH + 0.5, 0.7 + 2.5 * len(measures)))
    for row, measure in zip(panels, measures):
        for axes, cost in zip(row, COSTS):
            draw_panel(axes, scene, points, cost, measure)
        row[1].sharey(row[0])
        row[0].set_title(measure.title, loc="left")
    for axes, text in zip(panels[-1], COSTS.values()):
        axes.set_xlabel(f"{text} of the run, s")
    handles = {text: handle for text, handle in MARKS.items()}
    for line, text in zip(*panels[0][0].get_legend_handles_labels()):
        handles.setdefault(text, line)
    figure.legend(handles.values(), handles, loc="outside lower center", ncols=4)
    figure.suptitle(f"{scene.title}: type/N_r named on the Pareto front", fontsize=9)
    return figure


def chart(rows, folder):
    """One figure for each scene."""
    for name, points in points_of(rows, times_of(rows)).items():
        if any(point.error for point in points):
            with styled():
                save(scene_figure(name, points), folder, f"{name}_speed_accuracy")
