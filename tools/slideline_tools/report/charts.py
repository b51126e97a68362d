# SPDX-License-Identifier: MIT
"""The charts of a report: histories, contact pressure, timing."""
from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np

from slideline_tools import plots
from slideline_tools import zones as zone_pictures
from slideline_tools.fields import ScalarField, largest, without_round_off
from slideline_tools.histories import History
from slideline_tools.results import Results

SIZE = (5.2, 2.7)
MOST_LINES = 8
STYLE = plots.STYLE | {"svg.hashsalt": "slideline"}
ENERGIES = ("kinetic", "internal", "hourglass", "viscous", "damping", "contact", "friction", "leapfrog",
            "external_work", "total")


def lines(series: list[tuple[str, np.ndarray, np.ndarray]], ylabel: str, xlabel: str = "time",
          marker: str = ""):
    """A figure with one line per (label, x, y); what is round-off beside the largest y is zero."""
    scale = max((largest(y) for _, _, y in series), default=0.0)
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=SIZE, layout="constrained")
        for count, (label, x, y) in enumerate(series):
            axes.plot(x, without_round_off(y, scale), label=label, marker=marker, markersize=2.5,
                      color=plots.COLOURS[count % len(plots.COLOURS)],
                      linestyle=plots.LINES[count // len(plots.COLOURS) % len(plots.LINES)])
        axes.set_xlabel(xlabel)
        axes.set_ylabel(ylabel)
        axes.margins(x=0.0)
        axes.locator_params(axis="x", nbins=6)
        axes.grid(True, linewidth=0.3, color="#bbbbbb")
        if len(series) > 1:
            figure.legend(loc="outside upper center", ncols=min(4, len(series)), frameon=False,
                          handlelength=1.6, columnspacing=1.2)
        return figure


def energies(glstat: History):
    """All energies that are anywhere other than zero."""
    shown = [name for name in ENERGIES if name in glstat
             and (name in ("kinetic", "internal", "total") or np.any(glstat[name] != 0.0))]
    return lines([(name.replace("_", " "), glstat["time"], glstat[name]) for name in shown],
                 "energy")


def balance(glstat: History):
    """How far the energy ratio is from one."""
    return lines([("", glstat["time"], glstat["energy_ratio"] - 1.0)], "energy ratio - 1")


def step(glstat: History):
    """The time step; on a logarithmic axis where it changes a lot."""
    figure = lines([("", glstat["time"], glstat["dt"])], "time step")
    positive = glstat["dt"][glstat["dt"] > 0.0]
    if len(positive) and positive.max() > 30.0 * positive.min():
        figure.axes[0].set_yscale("log")
    else:
        figure.axes[0].set_ylim(bottom=0.0)
    return figure


def forces(rcforc: History):
    """Both components of the force on the slave side."""
    return lines([(name, rcforc["time"], rcforc[name]) for name in ("fx", "fy") if name in rcforc],
                 "contact force on the slave")


def wall_forces(rwforc: History):
    """Both components of the force of a rigid wall on the nodes."""
    return lines([(name, rwforc["time"], rwforc[name]) for name in ("fx", "fy") if name in rwforc],
                 "force of the wall on the nodes")


def pressures(contact: History, times: list[float]):
    """Contact pressure over the arc length of the slave surface at some times."""
    series = []
    for time in times:
        rows = contact.where(time=time)
        series.append((f"t = {time:.4g}", rows["s"], rows["pressure"]))
    figure = lines(series, "contact pressure", "arc length along the slave surface", "o")
    figure.axes[0].set_ylim(bottom=0.0)
    return figure


def estimates(sleout: History):
    """How far pressure and the stress behind it differ, and springs over the elements beside them, of one interface."""
    loaded = sleout["row_energy"] > 0.0
    ratio = np.divide(sleout["stored"], sleout["row_energy"], out=np.zeros(len(loaded)), where=loaded)
    return lines([("pressure against stress", sleout["time"], sleout["estimate"]),
                  ("energy of springs over elements", sleout["time"], ratio)], "estimate")


def made(sleout: History):
    """What the springs of one interface have lost (above 0) or made (below 0) so far."""
    return lines([("", sleout["time"], sleout["energy"] - sleout["stored"])], "energy lost by contact")


def zones(contact: History):
    """Stick and slip along the slave surface over time, of one interface."""
    chains = zone_pictures.chains_of(contact)
    with plt.rc_context(STYLE):
        figure, panels = plt.subplots(len(chains), 1, squeeze=False, layout="constrained",
                                      figsize=(SIZE[0], SIZE[1] * min(3, len(chains))))
        for axes, chain in zip(panels[:, 0], chains):
            zone_pictures.draw_zones(axes, chain)
        zone_pictures.add_legend(figure, contact)
        return figure


def tractions(results: Results, contact: History, number: int, states: list[int]):
    """|traction| along each chain of one interface at some states, and what friction allows."""
    chains = zone_pictures.chains_of(contact)
    with plt.rc_context(STYLE):
        figure, panels = plt.subplots(len(chains), 1, squeeze=False, layout="constrained",
                                      figsize=(SIZE[0], SIZE[1] * min(3, len(chains))))
        for axes, chain in zip(panels[:, 0], chains):
            zone_pictures.draw_tractions(axes, results, chain, number, states)
        return figure


def nodes(nodout: History, column: str):
    """A column of the first few nodes."""
    series = [(f"node {entity[0]}", rows["time"], rows[column])
              for entity, rows in nodout.series()[:MOST_LINES]]
    return lines(series, {"ux": "displacement in x", "uy": "displacement in y"}[column])


def field_window(results: Results, states: list[int], scale: float) -> tuple[float, ...]:
    """One window (x0, x1, y0, y1) for all states."""
    scratch = plt.figure()
    zoom = plots.frame(scratch.add_subplot(), results, states, scale)
    plt.close(scratch)
    return zoom


def field(results: Results, shown: ScalarField, state: int, states: list[int], scale: float):
    """A field at one state, with colours and window common to all `states`."""
    zoom = field_window(results, states, scale)
    with plt.rc_context(STYLE):
        height = plots.panel_height(zoom, SIZE[0] - 1.7)
        figure, axes = plt.subplots(figsize=(SIZE[0], height + 0.8), layout="constrained")
        artist = plots.field_panel(axes, results, shown, state, scale, shown.limits(states), zoom)
        axes.locator_params(axis="x", nbins=6)
        plots.colour_bar(artist, [axes], "").ax.yaxis.get_offset_text().set_fontsize(7)
        return figure


def timing(table: History):
    """Seconds of each phase that took any, the longest on top."""
    pairs = [(str(phase), float(seconds)) for phase, seconds
             in zip(table["phase"], table["seconds"])
             if phase != "total" and "." not in phase and seconds > 0.0]
    pairs.sort(key=lambda pair: pair[1])
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(SIZE[0], 0.6 + 0.28 * len(pairs)),
                                    layout="constrained")
        bars = axes.barh([name.replace("_", " ") for name, _ in pairs],
                         [seconds for _, seconds in pairs], color=plots.COLOURS[0], height=0.65)
        axes.bar_label(bars, [f"{seconds:.3g}" for _, seconds in pairs], padding=3, fontsize=8)
        axes.margins(x=0.12)
        axes.set_xlabel("seconds")
        return figure
