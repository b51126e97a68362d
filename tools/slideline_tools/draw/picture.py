# SPDX-License-Identifier: MIT
"""The picture of a model: parts, sets, surfaces, conditions, velocities and loads, with a legend.

Symbols and arrows have their size on paper, whatever the size of the model. Long rows of
symbols are thinned out to what can be distinguished.
"""
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from slideline_tools.draw.model import Arrows, Model, Surface
from slideline_tools.names import counted
from slideline_tools.plots import STYLE, edge_width

WHAT = ("mesh", "sets", "surfaces", "boundary", "motion", "velocity", "loads", "walls", "history")
PART_COLOURS = ("#dbe7f3", "#f6e6cf", "#dff0dc", "#ecdff1", "#f7dcd8", "#d9eeee", "#eee9c9",
                "#e3e3e3")
SET_COLOURS = ("#7b3f99", "#00838f", "#b8860b", "#5d4037", "#2e7d32", "#ad1457", "#3949ab",
               "#6b8e23")
SLAVE, MASTER = "#d1301f", "#0b559f"
ARROW_COLOURS = {"velocity": "#1b7f3b", "motion": "#e07b00", "load": "#8e24aa",
                 "pressure": "#8e24aa", "body": "#444444"}
WIDTH, LONGEST_ARROW, NORMAL_LENGTH = 9.0, 0.42, 0.16   # inches
WALL_FRICTION = {0.0: "", 1.0: ", nodes stick"}         # others: the coefficient
LEFT, RIGHT = 0.09, 0.965                               # of the width, ends of the axes
MOST_ARROWS, MOST_SYMBOLS, MOST_NORMALS, MOST_TIPS = 26, 60, 30, 8


def model_figure(model: Model, show=None, zoom=None):
    """The figure. `show`: names of WHAT (default: all); `zoom`: (x0, x1, y0, y1)."""
    show = set(show or WHAT)
    low, high = window(model, zoom)
    with plt.rc_context(STYLE):
        ratio = (high[1] - low[1]) / (high[0] - low[0])
        figure, axes = plt.subplots(
            figsize=(WIDTH, float(np.clip((RIGHT - LEFT) * WIDTH * ratio, 1.2, 9.0))), dpi=150)
        axes.set_aspect("equal")
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        canvas = Canvas(axes, low, high, show)
        draw_mesh(canvas, model, "mesh" in show)
        for name, drawer in DRAWERS:
            if name in show:
                drawer(canvas, model)
        axes.set_xlabel("x")
        axes.set_ylabel("y")
        axes.set_title(model.title, loc="left")
        fit(figure, canvas)
        return figure


class Canvas:
    """Axes with their window in deck units, and the legend so far."""

    def __init__(self, axes, low: np.ndarray, high: np.ndarray, show: set[str]) -> None:
        self.axes, self.low, self.high, self.show = axes, low, high, show
        # Deck units of an inch of paper, about.
        self.inch = float(max(high[0] - low[0], high[1] - low[1])) / WIDTH
        self.handles: list = []

    def visible(self, places: np.ndarray) -> np.ndarray:
        """Which points are in the window."""
        spare = 1.0e-6 * (self.high - self.low)
        return np.all((places >= self.low - spare) & (places <= self.high + spare), axis=1)

    def mark(self, places: np.ndarray, label: str, seen=None, **style) -> None:
        """Symbols at places (of these those in `seen`), with their line of the legend."""
        style |= {"linestyle": "none"}
        self.axes.plot(*places[slice(None) if seen is None else seen].T, **style)
        self.handles.append(Line2D([], [], label=label, **style))


def window(model: Model, zoom) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper corner of what is shown: zoom, or the mesh with a margin for arrows."""
    if zoom is not None:
        return np.array([zoom[0], zoom[2]]), np.array([zoom[1], zoom[3]])
    low, high = model.points.min(axis=0), model.points.max(axis=0)
    margin = 0.07 * max(high - low)
    return low - margin, high + margin


def fit(figure, canvas: Canvas) -> None:
    """Put the legend below the axes and make the figure as high as both need."""
    lines = canvas.handles
    columns = 2 if max((len(handle.get_label()) for handle in lines), default=0) < 68 else 1
    legend_height = 0.19 * -(-len(lines) // columns) + 0.15 if lines else 0.0
    width, height = figure.get_size_inches()
    total = height + legend_height + 0.97
    figure.set_size_inches(width, total)
    figure.subplots_adjust(left=LEFT, right=RIGHT, top=1.0 - 0.42 / total,
                           bottom=(legend_height + 0.5) / total)
    if lines:
        figure.legend(handles=lines, loc="lower left", ncols=columns, frameon=False, fontsize=8,
                      bbox_to_anchor=(0.01, 0.0), borderaxespad=0.3, handlelength=2.4)


def thinned(count: int, most: int) -> np.ndarray:
    """At most `most` indices of `count` at equal distances."""
    step = max(-(-count // most), 1)
    return np.arange((count - 1) % step // 2, count, step)


# ---- mesh and sets ------------------------------------------------------------------------------

def draw_mesh(canvas: Canvas, model: Model, edges: bool) -> None:
    """The elements by part; rigid parts hatched. Without `edges` only the colours."""
    for count, part in enumerate(model.parts.values()):
        corners = model.points[model.cells[model.cell_parts == part.id]]
        if not len(corners):
            continue
        colour = PART_COLOURS[count % len(PART_COLOURS)]
        hatch = "////" if part.is_rigid else None
        canvas.axes.add_collection(PolyCollection(
            corners, facecolors=colour, edgecolors="#00000070" if edges else colour,
            linewidths=edge_width(len(model.cells)) if edges else 0.2))
        if part.is_rigid:
            canvas.axes.add_collection(PolyCollection(
                corners, facecolors="none", edgecolors="#00000040", hatch=hatch, linewidths=0.0))
        canvas.handles.append(Patch(facecolor=colour, edgecolor="#00000070", hatch=hatch,
                                    linewidth=0.5, label=part_words(part)))


def part_words(part) -> str:
    """A part for the legend: elements, law, and how a rigid body is held."""
    words = f"{part.label}: {counted(part.n_element, 'element')}, {part.law}"
    if part.is_rigid:
        words += ", held: " + ", ".join(part.held) if part.held else ", free"
    return words


def draw_sets(canvas: Canvas, model: Model) -> None:
    """Node sets as rings, each set a little larger than the one before."""
    for count, one in enumerate(model.node_sets.values()):
        canvas.mark(model.points[one.nodes], f"node {one.label}: {counted(len(one.nodes), 'node')}",
                    marker="o", markersize=3.0 + 1.3 * (count % 4), markerfacecolor="none",
                    markeredgecolor=SET_COLOURS[count % len(SET_COLOURS)], markeredgewidth=0.7,
                    alpha=0.8, zorder=3)


# ---- surfaces -----------------------------------------------------------------------------------

def draw_surfaces(canvas: Canvas, model: Model) -> None:
    """Slave red, master blue: the line, arrow heads in walking direction, outward normals."""
    for interface in model.interfaces:
        for name, colour, surface in (("slave", SLAVE, interface.slave),
                                      ("master", MASTER, interface.master)):
            draw_surface(canvas, model, surface, colour)
            canvas.handles.append(Line2D([], [], color=colour, linewidth=1.8, marker=">", markersize=5,
                              label=f"{interface.label}: {name}, {counted(len(surface.segments), 'segment')}"
                                    + friction_words(interface.friction, interface.sliding_friction)))


def friction_words(at_rest: float, sliding: float) -> str:
    """The coefficients of friction of an interface for the legend; nothing without friction."""
    if max(at_rest, sliding) <= 0.0:
        return ""
    return f", friction {at_rest:g}" + (f" to {sliding:g}" if sliding != at_rest else "")


def draw_surface(canvas: Canvas, model: Model, surface: Surface, colour: str) -> None:
    """One surface."""
    segments = surface.segments
    ends = model.points[segments]
    canvas.axes.add_collection(LineCollection(
        ends, colors=colour, linewidths=1.8, zorder=4, capstyle="round"))
    middles, outward = ends.mean(axis=1), surface.normals(model.points)
    seen = np.flatnonzero(canvas.visible(middles))
    picked = seen[thinned(len(seen), MOST_NORMALS)]
    heads = middles[picked] + NORMAL_LENGTH * canvas.inch * outward[picked]
    canvas.axes.add_collection(LineCollection(
        np.stack([middles[picked], heads], axis=1), colors=colour, linewidths=0.8, zorder=4))
    for k in seen[thinned(len(seen), MOST_TIPS)]:
        along = ends[k, 1] - ends[k, 0]
        along = along / max(np.linalg.norm(along), 1.0e-300) * 0.02 * canvas.inch
        canvas.axes.annotate("", xy=middles[k] + along, xytext=middles[k] - along, zorder=5,
                             arrowprops={"arrowstyle": "-|>", "color": colour, "shrinkA": 0,
                                         "shrinkB": 0, "mutation_scale": 16, "linewidth": 0})


# ---- conditions ---------------------------------------------------------------------------------

def draw_boundary(canvas: Canvas, model: Model) -> None:
    """Held nodes: triangles that point along the held direction, squares where both are held."""
    x, y = model.fixed.T
    for label, chosen, marker in (("held in x", x & ~y, ">"), ("held in y", y & ~x, "^"),
                                  ("held in x and y", x & y, "s")):
        nodes = np.flatnonzero(chosen)
        if not len(nodes):
            continue
        places = model.points[nodes]
        seen = np.flatnonzero(canvas.visible(places))
        seen = seen[np.lexsort(places[seen].T)]
        canvas.mark(places, f"{label}: {counted(len(nodes), 'node')}",
                    seen[thinned(len(seen), MOST_SYMBOLS)], marker=marker, markersize=5.0,
                    markerfacecolor="#222222", markeredgecolor="white", markeredgewidth=0.4,
                    zorder=6, clip_on=False)


def draw_walls(canvas: Canvas, model: Model) -> None:
    """Rigid walls as long lines with their normal."""
    length = 2.0 * float(np.linalg.norm(canvas.high - canvas.low))
    for wall in model.walls:
        point, normal = wall.point, wall.normal
        along = np.array([normal[1], -normal[0]]) * length
        canvas.axes.plot(*np.stack([point - along, point + along]).T, color="#333333", linewidth=2.5,
                         zorder=4)
        canvas.axes.annotate("", xy=point + LONGEST_ARROW * canvas.inch * normal, xytext=point,
                             arrowprops={"arrowstyle": "->", "color": "#333333"})
        canvas.handles.append(Line2D([], [], color="#333333", linewidth=2.5,
                          label=f"rigid wall {wall.id} at ({point[0]:g}, {point[1]:g}), bodies on the side of "
                                f"its arrow{WALL_FRICTION.get(wall.friction, f', friction {wall.friction:g}')}"))


def draw_history(canvas: Canvas, model: Model) -> None:
    """Nodes whose history is written."""
    if model.history_nodes:
        canvas.mark(model.points[model.history_nodes],
                    f"history of nodes: {len(model.history_nodes)}", marker="x", markersize=6.0,
                    markeredgecolor="black", markeredgewidth=1.2, zorder=7)


# ---- arrows -------------------------------------------------------------------------------------

def spread(places: np.ndarray, most: int, canvas: Canvas) -> np.ndarray:
    """Indices of visible points, one in each cell of a grid of about `most` cells."""
    seen = np.flatnonzero(canvas.visible(places))
    if len(seen) <= most:
        return seen
    box = places[seen].max(axis=0) - places[seen].min(axis=0)
    side = max(np.sqrt(max(box[0] * box[1], 0.0) / most), max(box) / most)
    cell = np.floor((places[seen] - places[seen].min(axis=0)) / side + 1.0e-9).astype(int)
    _, first = np.unique(cell, axis=0, return_index=True)
    return seen[first]


def draw_of_kind(*kinds: str):
    """A drawer of the arrows of some kinds, all of one kind on one scale."""
    def drawer(canvas: Canvas, model: Model) -> None:
        for kind in kinds:
            groups = [one for one in model.arrows if one.kind == kind]
            largest = max((np.linalg.norm(one.vectors, axis=1).max() for one in groups
                           if len(one.vectors)), default=0.0)
            for one in groups:
                picked = spread(one.places, MOST_ARROWS, canvas)
                draw_arrows(canvas, Arrows(kind, one.label, one.places[picked],
                                           one.vectors[picked]), float(largest))
    return drawer


def draw_arrows(canvas: Canvas, arrows: Arrows, largest: float) -> None:
    """Arrows whose longest is as long as the paper allows; a pressure ends on its edge."""
    colour = ARROW_COLOURS[arrows.kind]
    size = np.linalg.norm(arrows.vectors, axis=1)
    real = size > 0.0
    if np.any(real) and largest > 0.0:
        # None shorter than a third of the longest, so that its direction can be seen.
        length = LONGEST_ARROW * np.clip(size[real] / largest, 0.33, 1.0)
        vectors = arrows.vectors[real] / size[real][:, None] * length[:, None]
        canvas.axes.quiver(*arrows.places[real].T, *vectors.T, color=colour, angles="uv",
                           scale_units="inches", scale=1.0, units="inches", width=0.018,
                           zorder=3.5 if arrows.kind in ("velocity", "motion") else 8,
                           headwidth=4.5, headlength=5.5, headaxislength=5.0,
                           pivot="tip" if arrows.kind == "pressure" else "tail")
    canvas.handles.append(Line2D([], [], color=colour, linewidth=1.5, marker=">", markersize=5,
                      markevery=[1], label=arrows.label))


DRAWERS = (
    ("sets", draw_sets), ("surfaces", draw_surfaces), ("walls", draw_walls),
    ("boundary", draw_boundary), ("motion", draw_of_kind("motion")),
    ("velocity", draw_of_kind("velocity")), ("loads", draw_of_kind("load", "pressure", "body")),
    ("history", draw_history),
)
