# SPDX-License-Identifier: MIT
"""Tools around the program `slideline`: read results, draw, compare, write decks.

    import slideline_tools
    results = slideline_tools.read("results/collision")     # a results folder, or a file of it
    results.times, results.cell_field("mises")[-1], results.history("glstat")["kinetic"]
    results.frame("rcforc")                                 # a pandas DataFrame
"""
from __future__ import annotations

import typing

if typing.TYPE_CHECKING:
    import os

    from slideline_tools.results import Results

__version__ = "0.1.0"


class UserError(Exception):
    """A request that cannot be met; the text is for the user."""


def read(path: str | os.PathLike) -> Results:
    """The results of a run: `path` is its folder, `<job>.vtkhdf` or another file of the run.

    All values are in the units of the deck (SI in the decks of this project); forces, energies,
    masses and momenta are per unit of depth. Arrays are numpy arrays with the state as first index:

    `results.times`              (n_state,) unit of time
    `results.points`             (n_state, n_node, 3) current coordinates, unit of length
    `results.cells`              (n_cell, 4) indices of nodes from 0; triangles repeat the last
    `results.point_field(name)`  (n_state, n_node[, 3]) see Results.point_field
    `results.cell_field(name)`   (n_state, n_cell[, 6]) see Results.cell_field
    `results.history(name)`      columns by name; of a killed run from its CSV files
    `results.frame(name)`        the same as a pandas DataFrame (build/venv/bin/pip install './tools[frames]')

    Nothing is read before it is asked for. Raises UserError where there are no results.
    """
    from slideline_tools.results import open_run
    return open_run(path)
