# SPDX-License-Identifier: MIT
"""Reader of the results file `<job>.vtkhdf`.

The names and shapes of the file are known here and nowhere else in the tools. States come as
arrays with the state as first index, points and cells in the order of the deck.
"""
from __future__ import annotations

import contextlib
import os
import pathlib
import typing

import h5py
import numpy as np

from slideline_tools import UserError
from slideline_tools.files import ENDINGS, find_run, source
from slideline_tools.histories import TABLES, History, from_hdf5, read_csv
from slideline_tools.names import missing, one_line

if typing.TYPE_CHECKING:
    import pandas

TRIANGLE, QUAD = 5, 9
STRESS_COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "xz")
VECTOR_COMPONENTS = ("x", "y", "z")
#: components of the fields that are no scalars
COMPONENTS = {"Points": 3, "displacement": 3, "velocity": 3, "contact_force": 3, "stress": 6}
#: what h5py and numpy raise where a file is not what it should be
DAMAGE = (OSError, KeyError, ValueError, TypeError, AttributeError, IndexError, OverflowError, RuntimeError,
          MemoryError)


NO_RESULTS = "it is no results file (<job>.vtkhdf)"


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
    `results.frame(name)`        the same as a pandas DataFrame

    Nothing is read before it is asked for. Raises UserError where there are no results.
    """
    path = pathlib.Path(path)
    if path.is_dir() or path.name.endswith(ENDINGS):
        path = pathlib.Path(f"{find_run(path, '.vtkhdf')}.vtkhdf")
    return Results(path)


class Results:
    """States, histories and run information of one results file (all read on demand).

    `path`          the file
    `times`         (n_state,) time of each state, in the unit of time of the deck (s in SI decks)
    `n_node`, `n_cell`, `n_state`
    `point_fields`, `cell_fields`   names for point_field and cell_field
    `histories`     names for history and frame
    `run`           dict of texts: deck, title, version, build, options, effective_deck
    `version`       of the VTKHDF format
    """

    path: pathlib.Path
    times: np.ndarray
    n_node: int
    n_cell: int
    point_fields: list[str]
    cell_fields: list[str]
    histories: list[str]
    run: dict[str, str]
    version: tuple[int, ...]

    def __init__(self, path: str | os.PathLike) -> None:
        self.path = pathlib.Path(path)
        self._arrays: dict = {}
        with self.reading("") as stream:
            self._read_structure(stream)

    def __repr__(self) -> str:
        span = f" to t = {self.times[-1]:.4g}" if self.n_state else ""
        return one_line(f"Results {self.path.stem}: {self.n_state} states{span}, {self.n_node} nodes, "
                        f"{self.n_cell} elements, {len(self.histories)} histories")

    @contextlib.contextmanager
    def reading(self, what: str) -> typing.Iterator[h5py.File]:
        """The file, open; UserError where it, or what is read of it, is damaged."""
        try:
            with h5py.File(source(self.path), "r") as stream:
                yield stream
        except UserError:
            raise
        except DAMAGE as problem:
            raise UserError(f"cannot read {what + ' of ' if what else ''}{self.path}: "
                               f"{self._reason(problem)}") from problem

    def _reason(self, problem: Exception) -> str:
        """What stopped h5py or numpy, in words of files where it is the file as a whole."""
        if not self.path.exists():
            return "no such file"
        if not isinstance(problem, PermissionError) and not h5py.is_hdf5(self.path):
            return NO_RESULTS
        return " ".join(str(problem).split()) or type(problem).__name__

    def _read_structure(self, stream: h5py.File) -> None:
        if "VTKHDF" not in stream:
            raise ValueError(NO_RESULTS)
        root = stream["VTKHDF"]
        kind = root.attrs["Type"]
        kind = kind.decode() if isinstance(kind, bytes) else str(kind)
        if kind.strip() != "UnstructuredGrid":
            raise ValueError(f"VTKHDF type {kind}, not UnstructuredGrid")
        steps = root["Steps"]
        self.version = tuple(int(number) for number in root.attrs["Version"])
        self.n_node = int(root["NumberOfPoints"][0])
        self.n_cell = int(root["NumberOfCells"][0])
        if min(self.n_node, self.n_cell) < 0:
            raise ValueError("a negative number of points or cells")
        self.times = steps["Values"][:int(steps.attrs["NSteps"])].astype(float)
        if self.times.ndim != 1:
            raise ValueError("the times of the states are no list of numbers")
        self.point_fields = list(root.get("PointData", ()))
        self.cell_fields = list(root.get("CellData", ()))
        self._in_file = list(stream.get("history", ()))
        self.histories = self._in_file + [name for name in TABLES if name not in self._in_file
                                          and self._table_path(name).exists()]
        self.run = self._run_texts(stream.get("run"))

    @staticmethod
    def _run_texts(group: h5py.Group | None) -> dict[str, str]:
        if group is None:
            return {}
        texts = dict(group.attrs)
        texts.update((name, group[name][()]) for name in group)
        return {name: plain_text(value) for name, value in texts.items()}

    @property
    def n_state(self) -> int:
        """Number of stored states."""
        return len(self.times)

    def _stacked(self, path: str, offsets: str, rows: int) -> np.ndarray:
        """All states of a stacked array: (n_state, rows[, components])."""
        if path not in self._arrays:
            with self.reading(path) as stream:
                root = stream["VTKHDF"]
                values = root[path][()]
                starts = root[offsets][()].ravel()[:self.n_state].astype(int)
                width = COMPONENTS.get(path.rsplit("/", 1)[-1])
                if values.dtype.kind not in "iuf" or values.shape[1:] != ((width,) if width else ()):
                    raise ValueError(f"it should have {width or 1} numbers in a row")
            picked = [values[start:start + rows] for start in starts if start >= 0]
            if len(picked) != self.n_state or any(len(state) != rows for state in picked):
                raise UserError(f"{self.path}: {path} is shorter than its states need")
            self._arrays[path] = np.array(picked).reshape((self.n_state, rows) + values.shape[1:])
        return self._arrays[path]

    @property
    def points(self) -> np.ndarray:
        """(n_state, n_node, 3): current coordinates in the unit of length of the deck."""
        return self._stacked("Points", "Steps/PointOffsets", self.n_node)

    def point_field(self, name: str) -> np.ndarray:
        """(n_state, n_node) or (n_state, n_node, 3) of a field at the nodes.

        displacement (length), velocity (length/time), contact_force (force per unit depth),
        contact_pressure (stress), gap (length, negative in penetration), node_id; of runs with
        friction contact_traction (stress), contact_slip (length) and contact_state.
        """
        self._require(name, self.point_fields, "point")
        return self._stacked(f"PointData/{name}", f"Steps/PointDataOffsets/{name}", self.n_node)

    def cell_field(self, name: str) -> np.ndarray:
        """(n_state, n_cell) or (n_state, n_cell, 6) of a field in the elements.

        stress (xx yy zz xy yz xz, tension positive), pressure (= -trace/3) and mises in the unit of
        stress of the deck, plastic_strain (dimensionless), part_id, element_id.
        """
        self._require(name, self.cell_fields, "cell")
        return self._stacked(f"CellData/{name}", f"Steps/CellDataOffsets/{name}", self.n_cell)

    def _require(self, name: str, present: list[str], kind: str) -> None:
        if name not in present:
            raise UserError(f"{self.path}: no {kind} field '{name}'{missing(name, present)}")

    @property
    def cells(self) -> np.ndarray:
        """(n_cell, 4) indices of the nodes (from 0); a triangle repeats its last node."""
        if "cells" not in self._arrays:
            with self.reading("the cells") as stream:
                root = stream["VTKHDF"]
                connectivity = root["Connectivity"][()]
                types = root["Types"][:self.n_cell]
                starts = root["Offsets"][:self.n_cell].astype(int)
                if len(types) != self.n_cell or len(starts) != self.n_cell:
                    raise ValueError("fewer of them than their number says")
                if not np.all(np.isin(types, (TRIANGLE, QUAD))):
                    raise ValueError("one is neither a triangle nor a quad")
                corner = np.where(types == TRIANGLE, 2, 3)
                cells = np.stack([connectivity[starts + np.minimum(k, corner)] for k in range(4)],
                                 axis=1).astype(int)
                if cells.ndim != 2 or np.any(cells < 0) or np.any(cells >= self.n_node):
                    raise ValueError("one has a node that is not there")
            self._arrays["cells"] = cells
        return self._arrays["cells"]

    def _table_path(self, name: str) -> pathlib.Path:
        """The CSV file of a table beside the results file."""
        return self.path.with_name(f"{self.path.stem}.{name}.csv")

    def history(self, name: str) -> History:
        """A history table (see histories.History): one of histories.TABLES.

        The program puts the tables into the results file at the end of the run; before, and of a
        killed run, they are read from the CSV files beside it. Columns and units: doc/results.md.
        """
        if name not in self.histories:
            raise UserError(f"{self.path}: no history '{name}'{missing(name, self.histories)}")
        if name not in self._arrays:
            if name in self._in_file:
                with self.reading(f"the history {name}") as stream:
                    self._arrays[name] = from_hdf5(name, stream["history"][name])
            else:
                self._arrays[name] = read_csv(self._table_path(name))
        return self._arrays[name]

    def frame(self, name: str) -> pandas.DataFrame:
        """A history table as a pandas DataFrame: columns and rows of the CSV file, time and
        entities (interface, side, wall, node, part) first.

        `attrs` has the table (`table`) and the title of the run (`title`).
        """
        frame = self.history(name).frame()
        frame.attrs["title"] = self.run.get("title", "")
        return frame

    def state_index(self, wanted: int | float | str) -> int:
        """Index of a state: an integer text counts states (-1 = last), a real is a time."""
        if not self.n_state:
            raise UserError(f"{self.path}: no states")
        text = str(wanted)
        try:
            index = int(text)
        except ValueError:
            return self._nearest_state(text)
        if not -self.n_state <= index < self.n_state:
            raise UserError(f"no state {index}: there are {self.n_state}, from 0 on")
        return index % self.n_state

    def _nearest_state(self, text: str) -> int:
        try:
            time = float(text)
        except ValueError:
            raise UserError(f"'{text}' is neither a state number nor a time") from None
        spare = 1.0e-9 * abs(self.times[-1])
        if not self.times[0] - spare <= time <= self.times[-1] + spare:
            raise UserError(f"time {time:g} is outside the states "
                               f"({self.times[0]:g} to {self.times[-1]:g})")
        return int(np.argmin(np.abs(self.times - time)))


def plain_text(value) -> str:
    """Text of an HDF5 string attribute or dataset, in whichever form h5py hands it over."""
    if isinstance(value, np.ndarray):
        value = value.ravel()
        parts = [plain_text(part) for part in value]
        return parts[0] if len(parts) == 1 else "\n".join(parts)
    if isinstance(value, bytes):
        value = value.decode("utf-8", errors="replace")
    return str(value).rstrip(" \x00")
