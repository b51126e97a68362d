# SPDX-License-Identifier: MIT
"""Tools around the program `slideline`: run it, read results, draw, compare, write decks.

    import slideline_tools
    outcome = slideline_tools.run("input/collision/collision.k", ctype=5)   # a run of the program
    results = slideline_tools.read("results/collision")     # a results folder, or a file of it
    results.times, results.cell_field("mises")[-1], results.history("glstat")["kinetic"]
    results.frame("rcforc")                                 # a pandas DataFrame
    slideline_tools.plot(results, "mises", "0.0007")        # a matplotlib figure
    slideline_tools.sweep("input/collision/collision.k", ctype=[1, 5], v0=[-40.0, -80.0])
"""
from __future__ import annotations

import importlib
import typing

if typing.TYPE_CHECKING:
    import os

    from matplotlib.figure import Figure

    from slideline_tools.program import Outcome, Sweep, run, sweep
    from slideline_tools.results import Results, read

__version__ = "0.4.0"
__all__ = ["Outcome", "Sweep", "UserError", "plot", "read", "run", "sweep"]

#: public names whose modules are read when they are asked for: numpy and h5py are slow to import
LATE = {"Outcome": "program", "Sweep": "program", "run": "program", "sweep": "program", "Results": "results", "read": "results"}


class UserError(Exception):
    """A request that cannot be met; the text is for the user."""


if not typing.TYPE_CHECKING:  # checkers would take any name for one of the module
    def __getattr__(name):
        if name in LATE:
            return getattr(importlib.import_module(f"slideline_tools.{LATE[name]}"), name)
        raise AttributeError(f"module 'slideline_tools' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted({*globals(), *LATE})


def plot(results: Results | Outcome | str | os.PathLike, field: str | None = None, *states: str | float,
         scale: float = 1.0, zoom: typing.Sequence[float] | None = None,
         history: str | typing.Sequence[str] = (), contact: bool = False, zones: bool = False,
         mirror: bool = False, output: str | os.PathLike | None = None) -> Figure:
    """A matplotlib figure of a run, as `slideline-tools plot` draws it; written to `output` where it is given.

    `field` such as "mises" or "stress:xy" at `states` (numbers, -1 the last, or times as reals);
    `history` such as "glstat:kinetic,internal" or a list of these; `contact` the pressure along the
    slave surface; `zones` where it sticks and slips; `mirror` with the image in x = 0. Without any
    of these a field above the energies and the contact force.
    """
    from slideline_tools import files, plots
    from slideline_tools.mirrored import Mirrored
    from slideline_tools.program import Outcome
    from slideline_tools.results import Results, read
    if sum(map(bool, (history, contact, zones))) > 1:
        raise UserError("choose one of history, contact and zones")
    if isinstance(results, Outcome):
        results = results.results
    elif not isinstance(results, Results):
        results = read(results)
    run = Mirrored(results) if mirror else results
    shown = list(states) or ["-1"]
    if history:
        figure = plots.history_figure(run, [history] if isinstance(history, str) else list(history))
    elif contact:
        figure = plots.contact_figure(run, shown)
    elif zones:
        from slideline_tools.zones import zones_of
        figure = zones_of(run, shown)
    elif field or states or zoom:
        figure = plots.field_figure(run, field, shown, scale, zoom)
    else:
        figure = plots.report_figure(run, scale=scale)
    if output is not None:
        figure.savefig(files.output(output, [results.path]))
    plots.plt.close(figure)  # a notebook shows what a cell gives; of pyplot's own figures it would show it again
    return figure
