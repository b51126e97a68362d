# SPDX-License-Identifier: MIT
"""History tables: columns over time, as in the CSV files and in `/history` of a results file."""
from __future__ import annotations

import csv
import os
import pathlib
import typing

import numpy as np

from slideline_tools import UserError
from slideline_tools.files import TABLES, source  # noqa: F401
from slideline_tools.names import missing, one_line

if typing.TYPE_CHECKING:
    import pandas

TEXT_COLUMNS = ("side", "phase")
INTEGER_COLUMNS = ("cycle", "interface", "wall", "group", "section", "node", "element", "part", "condition", "id", "n_active",
                   "calls")
ENTITY_COLUMNS = ("interface", "side", "wall", "group", "section", "node", "element", "part", "condition", "id")
SIDES = {1: "slave", 2: "master"}
#: integral over samples; before NumPy 2, as on Debian 12, it has another name
trapezoid = getattr(np, "trapezoid", None) or getattr(np, "trapz")


class History:
    """One table: equally long columns by name.

    Columns that name an entity (ENTITY_COLUMNS) split the rows into one series per entity. Values are in the units of the deck; `time` is in its unit of time.
    """

    def __init__(self, name: str, columns: dict[str, np.ndarray]) -> None:
        """`name`: table name such as 'glstat'; `columns`: dict of equally long arrays."""
        self.name = name
        self.columns = dict(columns)
        if len({len(column) for column in self.columns.values()}) > 1:
            raise UserError(f"{name}: columns of different length")

    def __repr__(self) -> str:
        span = f", time {self['time'][0]:.4g} to {self['time'][-1]:.4g}" if "time" in self and len(self) else ""
        return one_line(f"History {self.name}: {len(self)} rows{span}; {', '.join(self.columns)}")

    def __getitem__(self, column: str) -> np.ndarray:
        try:
            return self.columns[column]
        except KeyError:
            raise UserError(f"{self.name} has no column '{column}'{missing(column, self.columns)}") from None

    def __contains__(self, column: str) -> bool:
        return column in self.columns

    def __len__(self) -> int:
        """Number of rows."""
        return len(next(iter(self.columns.values()), ()))

    @property
    def entity_columns(self) -> list[str]:
        """Names of the columns that tell the series of this table apart."""
        return [name for name in ENTITY_COLUMNS if name in self.columns]

    @property
    def value_columns(self) -> list[str]:
        """Names of the columns that are neither time, entity nor text."""
        return [name for name in self.columns
                if name != "time" and name not in ENTITY_COLUMNS + TEXT_COLUMNS]

    def frame(self) -> pandas.DataFrame:
        """The table as a pandas DataFrame; `attrs["table"]` is its name."""
        import pandas
        frame = pandas.DataFrame(self.columns)
        frame.attrs["table"] = self.name
        return frame

    def where(self, **wanted) -> History:
        """The rows in which each named column has the given value."""
        keep = np.ones(len(self), dtype=bool)
        for name, value in wanted.items():
            if name == "side" and value not in SIDES.values():
                raise UserError(f"{self.name} has no side '{value}'{missing(value, SIDES.values())}")
            keep &= self[name] == value
        return self.rows(keep)

    def rows(self, chosen) -> History:
        """Some of the rows: a slice, a mask or a list of numbers."""
        return History(self.name, {name: column[chosen] for name, column in self.columns.items()})

    def series(self) -> list[tuple[tuple, History]]:
        """One (entity, History) per entity in order of appearance; entity = tuple of values."""
        names = self.entity_columns
        if not names:
            return [((), self)]
        rows_of: dict[tuple, list[int]] = {}
        for row, key in enumerate(zip(*(self[name].tolist() for name in names))):
            rows_of.setdefault(key, []).append(row)
        return [(key, self.rows(rows)) for key, rows in rows_of.items()]

    def entity_label(self, entity: tuple) -> str:
        """Text for one entity, for example 'interface 1, slave'."""
        return ", ".join(str(value) if name == "side" else f"{name} {value}"
                         for name, value in zip(self.entity_columns, entity))


def read_csv(path: str | os.PathLike) -> History:
    """The table in a CSV file of the program or in one of the same form.

    Raises UserError if the file is missing, empty, ragged or holds text in a number column.
    """
    path = pathlib.Path(path)
    try:
        with open(source(path), newline="", encoding="utf-8") as stream:
            rows = [row for row in csv.reader(stream) if row]
    except (OSError, UnicodeDecodeError) as problem:
        why = ("it is no text; wanted is a CSV table of the program"
               if isinstance(problem, UnicodeDecodeError) else
               "it is a folder; wanted is a CSV table (all tables of two folders: "
               "tools/batch/compare_folder.sh)" if path.is_dir() else problem.strerror or problem)
        raise UserError(f"cannot read {path}: {why}") from problem
    if not rows:
        raise UserError(f"{path}: the file is empty")
    names, rows = rows[0], rows[1:]
    if len(set(names)) < len(names):
        raise UserError(f"{path}: a column name occurs twice")
    for number, row in enumerate(rows, start=2):
        if len(row) != len(names):
            raise UserError(f"{path}: line {number} has {len(row)} fields, "
                               f"the header has {len(names)}")
    columns = zip(*rows) if rows else [()] * len(names)
    return History(table_name(path), {name: as_column(path, name, texts)
                                      for name, texts in zip(names, columns)})


def energy_made(sleout: History) -> np.ndarray:
    """What contact springs have made until each time of sleout, J per unit of depth: by interface, what
    they hold and gave beyond what they took, where that is above 0, added up. Work of damping (VDC) is
    no part of it, and energy that the springs still hold does not hide what they made.

    One value per time in order of appearance; UserError if there are no rows.
    """
    if not len(sleout):
        raise UserError("sleout has no rows")
    _, place = np.unique(sleout["time"], return_inverse=True)
    return np.bincount(place, np.maximum(0.0, sleout["stored"] - sleout["energy"]))


def table_name(path: str | os.PathLike) -> str:
    """'glstat' for `job.glstat.csv`; the stem of any other CSV file."""
    return pathlib.Path(path).stem.rsplit(".", 1)[-1]


def as_column(path, name, texts):
    """An array of text, integers or reals, as the column's name says."""
    if name in TEXT_COLUMNS:
        return np.array(texts, dtype=str)
    try:
        values = np.array([float(text) for text in texts])
    except ValueError as problem:
        raise UserError(f"{path}: column {name}: {problem}") from None
    if name in INTEGER_COLUMNS and np.all(np.isfinite(values)) and np.all(values % 1 == 0):
        return values.astype(int)
    return values


def from_hdf5(name: str, group) -> History:
    """The table in one group of `/history` (one 1-D dataset per column)."""
    columns = {}
    for column in column_order(group):
        values = group[column][()]
        if getattr(values, "ndim", 0) != 1:
            raise UserError(f"{name}: the column {column} is no list of values")
        if column == "side" and values.dtype.kind in "iu":
            values = np.array([SIDES.get(int(value), str(value)) for value in values], dtype=str)
        elif values.dtype.kind in "SO":
            values = np.array([v.decode(errors="replace") if isinstance(v, bytes) else str(v) for v in values])
        elif values.dtype.kind not in "iuf":
            raise UserError(f"{name}: the column {column} holds no numbers")
        if values.dtype.kind == "U" and column not in TEXT_COLUMNS:
            raise UserError(f"{name}: the column {column} holds no numbers")
        columns[column] = values
    shortest = min((len(values) for values in columns.values()), default=0)
    # A killed run may have grown some columns by a row that others lack.
    return History(name, {column: values[:shortest] for column, values in columns.items()})


def column_order(group):
    """Column names as the CSV file has them: time, entities, then the others."""
    first = [name for name in ("time", "cycle") + ENTITY_COLUMNS if name in group]
    return first + [name for name in group if name not in first]
