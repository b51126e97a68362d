# SPDX-License-Identifier: MIT
"""Figures: a field on the deformed mesh, histories, contact pressure along the surface."""
import contextlib
import os
import sys
import textwrap

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.ticker import MaxNLocator, ScalarFormatter

from slideline_tools import UserError
from slideline_tools.fields import default_field, largest, scalar_field, without_round_off
from slideline_tools.names import number
from slideline_tools.walls import draw_walls, walls_of

# Pictures go to files, without a window; except in a notebook, and where $MPLBACKEND says otherwise.
# A notebook sets up its backend with the first figure: within STYLE what that sets would be lost.
if "IPython" in sys.modules:
    plt.close(plt.figure())
elif not os.environ.get("MPLBACKEND"):
    matplotlib.use("Agg")

STYLE = {
    "figure.dpi": 150, "savefig.dpi": 150, "font.size": 9, "axes.titlesize": 9,
    "axes.grid": False, "grid.linewidth": 0.3, "grid.color": "#bbbbbb", "legend.framealpha": 0.85, "legend.edgecolor": "none",
    "lines.linewidth": 1.2, "axes.spines.top": False, "axes.spines.right": False,
    "axes.formatter.limits": (-3, 4), "axes.formatter.use_mathtext": True, "legend.fontsize": 8,
}
PAGE_WIDTH = 7.0
COLOURS = ("#0b559f", "#c23b22", "#2e7d32", "#7b3f99", "#b8860b", "#00838f", "#5d4037", "#555555")
MARKERS = ("s", ">", "o", "v", "^", "D", "P", "X")
LINES = ("-", "--", "-.", ":")
#: columns that are compared with each other: what is round-off beside the largest of them is drawn as zero
ALIKE = (("kinetic", "internal", "hourglass", "viscous", "damping", "contact", "external_work", "total", "leapfrog",
          "friction", "energy"), ("fx", "fy"), ("ux", "uy"), ("vx", "vy"), ("ax", "ay"),
         ("momentum_x", "momentum_y"), ("pressure", "traction"))


# ---- a field on the deformed mesh --------------------------------------------------------------

def beside(place):
    """Where a legend of a figure stands, beside its axes; Matplotlib before 3.7 (Debian 12) knows no such place."""
    return place if matplotlib.__version__.startswith("3.6.") else f"outside {place}"


def deformed(results, state, scale=1.0):
    """(n_node, 2) coordinates of a state with its displacement drawn `scale` times."""
    points = results.points[state][:, :2]
    if scale == 1.0:
        return points
    moved = results.point_field("displacement")[state][:, :2]
    return points + (scale - 1.0) * moved


def draw_field(axes, results, field, state, scale=1.0, limits=None):
    """Draw one state of a ScalarField; returns the artist that carries the colours."""
    points = deformed(results, state, scale)
    cells = results.cells
    low, high = field.limits() if limits is None else limits
    values = field.values[state]
    if "eroded" in results.cell_fields:
        left = results.cell_field("eroded")[state] < 0.5
        cells = cells[left]
        values = values if field.at_nodes else values[left]
    if field.at_nodes:
        artist = draw_nodal(axes, points, cells, values, colours(low, high), low, high)
    else:
        # Neighbouring polygons without an edge leave hairlines between them.
        artist = PolyCollection(points[cells], array=values, cmap=colours(low, high),
                                edgecolors="face", linewidths=0.2)
        artist.set_clim(low, high)
        axes.add_collection(artist)
    axes.add_collection(PolyCollection(points[cells], facecolors="none", edgecolors="#00000090",
                                       linewidths=edge_width(len(cells))))
    axes.set_aspect("equal")
    return artist


def colours(low, high):
    """Colour map that is light at zero; two colours if the values have both signs."""
    if low < 0.0 < high:
        return "RdBu_r"
    return "YlOrRd" if low >= 0.0 else "YlGnBu_r"


def draw_nodal(axes, points, cells, values, colours, low, high):
    """Smooth colours of a nodal field: each quad as four triangles about its centre."""
    n_node = len(points)
    centre = n_node + np.arange(len(cells))
    every_point = np.vstack([points, points[cells].mean(axis=1)])
    every_value = np.concatenate([values, values[cells].mean(axis=1)])
    triangles = np.concatenate([
        np.stack([cells[:, k], cells[:, (k + 1) % 4], centre], axis=1) for k in range(4)])
    triangles = triangles[triangles[:, 0] != triangles[:, 1]]
    return axes.tripcolor(every_point[:, 0], every_point[:, 1], triangles, every_value,
                          shading="gouraud", cmap=colours, vmin=low, vmax=high)


def edge_width(n_cell):
    """Thin element edges, thinner for finer meshes."""
    return float(np.clip(6.0 / np.sqrt(max(n_cell, 1)), 0.08, 0.4))


def window(results, states, scale=1.0, zoom=None):
    """One window (x0, x1, y0, y1) for all states: zoom, or the box of all their points."""
    if zoom is not None:
        return zoom
    boxes = np.concatenate([deformed(results, state, scale) for state in states])
    low, high = boxes.min(axis=0), boxes.max(axis=0)
    margin = 0.02 * max(high - low)
    return (low[0] - margin, high[0] + margin, low[1] - margin, high[1] + margin)


def panel_height(zoom, width):
    """Height in inches that an equal-aspect panel of this window needs."""
    height = width * (zoom[3] - zoom[2]) / (zoom[1] - zoom[0])
    return float(np.clip(height, 0.9, 7.0))


def field_panel(axes, results, field, state, scale, limits, zoom):
    """One state with title and axes; returns the artist that carries the colours."""
    artist = draw_field(axes, results, field, state, scale, limits)
    draw_walls(axes, walls_of(results.run.get("effective_deck", "")), zoom)
    axes.set_xlim(zoom[0], zoom[1])
    axes.set_ylim(zoom[2], zoom[3])
    axes.set_title(state_title(results, state, scale), loc="left")
    axes.set_xlabel("x")
    axes.set_ylabel("y")
    axes.locator_params(axis="y", nbins=5)
    return artist


def state_title(results, state, scale):
    """Time of a state, and the scale of its displacements if it is not one."""
    magnified = "" if scale == 1.0 else f", displacement x {scale:g}"
    return f"t = {results.times[state]:.4g}{magnified}"


def colour_bar(artist, panels, label):
    """A colour bar beside the panels, with round ticks in one notation; pointed where values lie beyond its ends."""
    bar = panels[0].figure.colorbar(artist, ax=panels, aspect=12 * len(panels), pad=0.02,
                                    extend=beyond(panels, artist.get_clim()), extendfrac=0.03)
    bar.outline.set_linewidth(0.4)
    bar.locator = MaxNLocator(5, steps=[1, 2, 2.5, 5, 10])
    bar.formatter = ScalarFormatter()
    bar.update_ticks()
    head, unit, _ = label.partition("(deck units)")
    lines = textwrap.wrap(head, 24) + ([unit] if unit else [])
    bar.set_label("\n".join(lines), fontsize=8)
    return bar


def beyond(panels, limits):
    """Which ends of a colour scale the values in the panels pass: for `extend` of a colour bar."""
    shown = [artist.get_array() for axes in panels for artist in axes.collections
             if artist.get_array() is not None]
    spare = 1.0e-9 * (limits[1] - limits[0])
    low = any(np.min(values) < limits[0] - spare for values in shown)
    high = any(np.max(values) > limits[1] + spare for values in shown)
    return ("both" if high else "min") if low else ("max" if high else "neither")


def mark_cut(axes, x, y, colour):
    """Arrow heads at the edge of a panel where points lie above or below its scale; to be called once that is set."""
    low, high = axes.get_ylim()
    inside = (np.asarray(x) >= axes.get_xlim()[0]) & (np.asarray(x) <= axes.get_xlim()[1])
    for cut, height, marker in ((y > high, 0.985, "^"), (y < low, 0.015, "v")):
        places = np.asarray(x)[cut & inside]
        axes.plot(places, np.full(len(places), height), linestyle="none", marker=marker, markersize=5, color=colour,
                  markeredgecolor="white", markeredgewidth=0.4, transform=axes.get_xaxis_transform(),
                  zorder=5)


def line_style(count):
    """Colour and dashes of the line of that number."""
    return {"color": COLOURS[count % len(COLOURS)],
            "linestyle": LINES[count // len(COLOURS) % len(LINES)]}


def run_title(results):
    """Title of the deck, or the name of the file."""
    return results.run.get("title") or results.path.name


@contextlib.contextmanager
def page(results, count, height, **more):
    """A figure with so many panels below each other, under the title of the run."""
    with plt.rc_context(STYLE):
        figure, panels = plt.subplots(count, 1, squeeze=False, layout="constrained",
                                      figsize=(PAGE_WIDTH, height), **more)
        yield figure, list(panels[:, 0])
        for axes in panels[:-1, 0]:
            axes.set_xlabel("")
        figure.suptitle(run_title(results), fontsize=9)


def field_figure(results, name=None, states=("-1",), scale=1.0, zoom=None):
    """A figure with one panel per state, below each other, on one colour scale."""
    field = scalar_field(results, name or default_field(results))
    states = [results.state_index(state) for state in states]
    zoom = window(results, states, scale, zoom)
    height = panel_height(zoom, PAGE_WIDTH - 1.9) + 0.95
    with page(results, len(states), height * len(states) + 0.2) as (figure, panels):
        for axes, state in zip(panels, states):
            artist = field_panel(axes, results, field, state, scale, field.limits(states), zoom)
        colour_bar(artist, panels, field.label)
    return figure


# ---- histories ---------------------------------------------------------------------------------

def parse_history(request):
    """'rcforc:fx,fy@side=slave' -> (table, [columns], {column: value})."""
    table, _, rest = request.partition(":")
    columns, *filters = rest.split("@")
    wanted = {}
    for entry in filters:
        name, equals, value = entry.partition("=")
        if not equals:
            raise UserError(f"'{entry}': expected COLUMN=VALUE after @")
        wanted[name] = value if name == "side" else number(request, value)
    names = [column for column in columns.split(",") if column]
    if not table or not names:
        raise UserError(f"'{request}': expected TABLE:COLUMN,COLUMN[@ENTITY=VALUE]")
    return table, names, wanted


def draw_history(axes, results, request):
    """Lines of one request such as 'glstat:kinetic,internal'."""
    if request in results.histories:
        raise UserError(f"'{request}': expected TABLE:COLUMN,COLUMN[@ENTITY=VALUE] with columns of "
                           + ", ".join(results.history(request).value_columns))
    table, columns, wanted = parse_history(request)
    history = results.history(table).where(**wanted)
    if not len(history):
        raise UserError(f"'{request}': no rows")
    count = 0
    for entity, rows in history.series():
        for column in columns:
            name = column.replace("_", " ")
            label = f"{history.entity_label(entity)}: {name}" if entity else name
            axes.plot(rows["time"], drawn(rows, column, history), label=label, **line_style(count))
            count += 1
    axes.set_xlabel("time")
    axes.margins(x=0.0)
    axes.grid(True)
    if count > 3:
        axes.legend(ncols=3, loc="lower right", bbox_to_anchor=(1.02, 0.99), columnspacing=1.0,
                    handlelength=1.5, borderaxespad=0.0)
    elif count > 1:
        axes.legend(loc="best")
    else:
        axes.set_ylabel(label)


def drawn(rows, column, history):
    """A column to draw: round-off, beside the largest value of all columns of its kind, is zero."""
    kind = next((kind for kind in ALIKE if column in kind), (column,))
    values = rows[column]
    if values.dtype.kind != "f":
        return values
    return without_round_off(values, max(largest(history[name]) for name in kind if name in history))


def history_figure(results, requests):
    """A figure with one panel per request, below each other."""
    with page(results, len(requests), 2.6 * len(requests), sharex=True) as (figure, panels):
        for axes, request in zip(panels, requests):
            draw_history(axes, results, request)
            axes.set_title(request.partition(":")[0], loc="left")
    return figure


def contact_figure(results, states=("-1",)):
    """Contact pressure over the arc length of each slave surface at the given states."""
    contact = results.history("contact")
    interfaces = np.unique(contact["interface"]).tolist()
    if not interfaces:
        raise UserError(f"{results.path}: the contact table is empty")
    with page(results, len(interfaces), 2.8 * len(interfaces)) as (figure, panels):
        for axes, interface in zip(panels, interfaces):
            rows = contact.where(interface=interface)
            known = np.unique(rows["time"])
            for count, state in enumerate(states):
                time = known[np.argmin(np.abs(known - results.times[results.state_index(state)]))]
                chain = rows.where(time=time)
                axes.plot(chain["s"], chain["pressure"], marker="o", markersize=2.5,
                          color=COLOURS[count % len(COLOURS)], label=f"t = {time:.4g}")
            axes.set_title(f"interface {interface}", loc="left")
            axes.set_xlabel("arc length s along the slave surface")
            axes.set_ylabel("contact pressure")
            axes.set_ylim(0.0, 1.08 * axes.dataLim.ymax or 1.0)
            axes.grid(True)
            axes.legend()
    return figure


# ---- the report picture ------------------------------------------------------------------------

def report_figure(results, state="-1", scale=1.0):
    """A field on the deformed mesh above the energies and, with contact, the contact force."""
    field = scalar_field(results, default_field(results))
    state = results.state_index(state)
    panels = report_requests(results)
    zoom = window(results, [state], scale)
    with plt.rc_context(STYLE):
        heights = [panel_height(zoom, PAGE_WIDTH - 1.9) + 0.9, 2.6][:1 + bool(panels)]
        figure = plt.figure(figsize=(PAGE_WIDTH, sum(heights)), layout="constrained")
        parts = figure.subfigures(len(heights), 1, squeeze=False, height_ratios=heights)[:, 0]
        axes = parts[0].add_subplot()
        artist = field_panel(axes, results, field, state, scale, field.limits([state]), zoom)
        colour_bar(artist, [axes], field.label)
        figure.suptitle(run_title(results), fontsize=9)
        for column, (request, title) in enumerate(panels):
            axes = parts[1].add_subplot(1, len(panels), column + 1)
            draw_history(axes, results, request)
            axes.set_ylabel(title)
            axes.axvline(results.times[state], color="#888888", linewidth=0.6)
        return figure


def report_requests(results):
    """What the lower panels of the report picture show."""
    panels = []
    if "glstat" in results.histories:
        glstat = results.history("glstat")
        wanted = [name for name in ("kinetic", "internal", "hourglass", "contact", "total")
                  if name in glstat and (name in ("kinetic", "internal", "total")
                                         or np.any(glstat[name] != 0.0))]
        panels.append(("glstat:" + ",".join(wanted), "energy"))
    if "rcforc" in results.histories and len(results.history("rcforc")):
        panels.append(("rcforc:fy@side=slave", "contact force in y"))
    elif "nodout" in results.histories and len(results.history("nodout")):
        panels.append(("nodout:uy", "displacement in y"))
    return panels
