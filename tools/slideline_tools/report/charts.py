# SPDX-License-Identifier: MIT
"""The charts of a report: histories, contact pressure, timing."""
import matplotlib.pyplot as plt
import numpy as np

from slideline_tools import plots
from slideline_tools.fields import largest, without_round_off
from slideline_tools.histories import History

SIZE = (5.2, 2.7)
MOST_LINES = 8
STYLE = plots.STYLE | {"svg.hashsalt": "slideline"}
ENERGIES = ("kinetic", "internal", "hourglass", "viscous", "damping", "contact", "friction",
            "leapfrog", "external_work", "total")


def lines(series: list[tuple[str, np.ndarray, np.ndarray]], ylabel: str, xlabel: str = "time",
          marker: str = ""):
    """A figure with one line per (label, x, y); what is round-off beside the largest y is zero."""
    scale = max((largest(y) for _, _, y in series), default=0.0)
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=SIZE, layout="constrained")
        for count, (label, x, y) in enumerate(series):
            axes.plot(x, without_round_off(y, scale), label=label, marker=marker, markersize=2.5,
                      **plots.line_style(count))
        axes.set_xlabel(xlabel)
        axes.set_ylabel(ylabel)
        axes.margins(x=0.0)
        axes.locator_params(axis="x", nbins=6)
        axes.grid(True)
        if len(series) > 1:
            figure.legend(loc=plots.beside("upper center"), ncols=min(4, len(series)), frameon=False,
                          handlelength=1.6, columnspacing=1.2)
        return figure


def columns(table: History, names: tuple[str, ...], ylabel: str):
    """Columns of a table over time."""
    return lines([(name.replace("_", " "), table["time"], table[name]) for name in names
                  if name in table], ylabel)


def energies(glstat: History):
    """All energies that are anywhere other than zero."""
    always = ("kinetic", "internal", "total")
    return columns(glstat, tuple(name for name in ENERGIES if name in glstat
                                 and (name in always or np.any(glstat[name]))), "energy")


def step(glstat: History):
    """The time step; on a logarithmic axis where it changes a lot."""
    figure = columns(glstat, ("dt",), "time step")
    positive = glstat["dt"][glstat["dt"] > 0.0]
    if len(positive) and positive.max() > 30.0 * positive.min():
        figure.axes[0].set_yscale("log")
    else:
        figure.axes[0].set_ylim(bottom=0.0)
    return figure


def pressures(contact: History, times: list[float]):
    """Contact pressure over the arc length of the slave surface at some times."""
    chains = [contact.where(time=time) for time in times]
    figure = lines([(f"t = {time:.4g}", rows["s"], rows["pressure"])
                    for time, rows in zip(times, chains)],
                   "contact pressure", "arc length along the slave surface", "o")
    figure.axes[0].set_ylim(bottom=0.0)
    return figure


def estimates(sleout: History):
    """How far pressure and the stress behind it differ, and springs over the elements beside them,
    of one interface."""
    loaded = sleout["row_energy"] > 0.0
    ratio = np.divide(sleout["stored"], sleout["row_energy"], out=np.zeros(len(loaded)),
                      where=loaded)
    return lines([("pressure against stress", sleout["time"], sleout["estimate"]),
                  ("energy of springs over elements", sleout["time"], ratio)], "estimate")


def timing(table: History):
    """Seconds of each phase that took any, the longest on top."""
    frame = table.frame()
    frame = frame[(frame.phase != "total") & ~frame.phase.str.contains(".", regex=False)
                  & (frame.seconds > 0.0)].sort_values("seconds")
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(SIZE[0], 0.6 + 0.28 * len(frame)),
                                    layout="constrained")
        bars = axes.barh(frame.phase.str.replace("_", " "), frame.seconds, color=plots.COLOURS[0])
        axes.bar_label(bars, fmt="%.3g", padding=3, fontsize=8)
        axes.margins(x=0.12)
        axes.set_xlabel("seconds")
        return figure
