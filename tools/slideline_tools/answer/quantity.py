# SPDX-License-Identifier: MIT
"""Quantities of a run by their words: HISTORY:COLUMN[@KEY=VALUE,...][:MEASURE] and field:NAME[@x=X,y=Y]:MEASURE."""
import dataclasses

import numpy as np

from slideline_tools import UserError
from slideline_tools.fields import scalar_field
from slideline_tools.histories import TEXT_COLUMNS, trapezoid
from slideline_tools.names import missing, number
from slideline_tools.program import Outcome

MEASURES = ("largest", "smallest", "mean", "impulse", "end")
OF_SURFACES = ("contact_", "gap")  # nodal fields that mean nothing inside
FORM = "HISTORY:COLUMN[@KEY=VALUE,...][:largest|smallest|mean|impulse|end|at=T]"


@dataclasses.dataclass(frozen=True)
class Quantity:
    """One quantity.

    `text`      as asked for
    `table`     name of the history, or `field`
    `column`    its column, or the field such as `mises` or `stress:xy`
    `where`     the rows that are meant, by column; of a field x and y, where it is wanted at a point
    `measure`   one of MEASURES, or `at`
    `time`      of `at`
    """

    text: str
    table: str
    column: str
    where: tuple[tuple[str, str], ...] = ()
    measure: str = "largest"
    time: float = 0.0

    def of(self, outcome: Outcome) -> float:
        """Its value in a run; UserError, with the nearest name, where the run has no such thing."""
        times, values = self.field_series(outcome) if self.table == "field" else self.series(outcome)
        value = self.measured(times, values)
        if not np.isfinite(value):
            raise UserError(f"{self.text}: no finite number in {outcome.folder / outcome.job}")
        return value

    def series(self, outcome: Outcome) -> tuple[np.ndarray, np.ndarray]:
        """Times and values of one series of a history."""
        table = outcome.history(self.table)
        for name, text in self.where:
            if name not in table.entity_columns:
                raise UserError(f"{self.text}: {self.table} has no series by '{name}'{missing(name, table.entity_columns)}")
            there = sorted(set(table[name].tolist()))
            table = table.where(**{name: text if name in TEXT_COLUMNS else number(self.text, text)})
            if not len(table):
                raise UserError(f"{self.text}: {self.table} has no {name} {text}; there are {', '.join(map(str, there))}")
        values = table[self.column]
        if values.dtype.kind not in "iuf":
            raise UserError(f"{self.text}: {self.column} is no number")
        if not len(table):
            raise UserError(f"{self.text}: {self.table} has no rows")
        if len(series := table.series()) > 1:
            raise UserError(f"{self.text}: {self.table} has {len(series)} series: {'; '.join(map(table.entity_label, (key for key, _ in series[:8])))}"
                            f"; choose one by {self.table}:{self.column}@{','.join(f'{name}=...' for name in table.entity_columns)}")
        return table["time"], values

    def field_series(self, outcome: Outcome) -> tuple[np.ndarray, np.ndarray]:
        """Times and values of a field: at a point of the initial mesh, else its extremes over all nodes or elements."""
        if not (outcome.folder / f"{outcome.job}.vtkhdf").exists():
            raise UserError(f"{self.text}: the deck asks for no states (*DATABASE_BINARY_D3PLOT)")
        results = outcome.results
        field = scalar_field(results, self.column)
        if not self.where:
            return results.times, (field.values.min if self.measure == "smallest" else field.values.max)(axis=1)
        point = np.array([number(self.text, dict(self.where)[axis]) for axis in "xy"])
        start = results.points[0][:, :2] - results.point_field("displacement")[0][:, :2]
        cells = edges_at(start, results.cells, point) if self.column.startswith(OF_SURFACES) else results.cells
        weights = weights_at(start, cells, results.cell_field("part_id")[0], point, field.at_nodes)
        return results.times, field.values @ weights

    def measured(self, times: np.ndarray, values: np.ndarray) -> float:
        """The one number of a series."""
        if self.measure == "at":
            if not times[0] <= self.time <= times[-1]:
                raise UserError(f"{self.text}: the run has times from {times[0]:.6g} to {times[-1]:.6g}")
            return float(np.interp(self.time, times, values))
        if self.measure in ("impulse", "mean"):
            impulse = float(trapezoid(values, times))
            return impulse if self.measure == "impulse" else impulse / (times[-1] - times[0]) if len(times) > 1 else float(values[0])
        return float({"largest": np.max, "smallest": np.min, "end": lambda some: some[-1]}[self.measure](values))


def place_of(x: np.ndarray, cells: np.ndarray, point: np.ndarray) -> tuple[int, np.ndarray]:
    """The first element at a point, or the nearest one, and the shape functions of its four nodes there."""
    signs = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    corners, local = x[cells], np.zeros((len(cells), 2))
    for _ in range(13):  # Newton, in all elements at once
        factors = 1.0 + signs * local[:, None]
        shapes = np.prod(factors, axis=2) / 4.0
        off = point - np.einsum("ek,eki->ei", shapes, corners)
        matrix = np.einsum("ekj,eki->eij", signs * factors[..., ::-1] / 4.0, corners)
        local = np.clip(local + np.einsum("eij,ej->ei", np.linalg.pinv(matrix), off), -1.0, 1.0)
    away = np.linalg.norm(off, axis=1)
    found = int(np.flatnonzero(away <= away.min() + 1e-9 * np.ptp(x))[0])
    return found, shapes[found]


def edges_at(x: np.ndarray, cells: np.ndarray, point: np.ndarray) -> np.ndarray:
    """The exterior edges at the node nearest to a point, as elements without height."""
    pairs = np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    edges, counts = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0, return_counts=True)
    edges = edges[counts == 1]
    nearest = edges.flat[np.argmin(np.linalg.norm(x[edges.ravel()] - point, axis=1))]
    return edges[(edges == nearest).any(axis=1)][:, [0, 1, 1, 0]]


def weights_at(x, cells, parts, point, at_nodes: bool) -> np.ndarray:
    """Weights of all nodes at a point, shape functions; or of all elements: a plane by least squares through the centres of the
    element there and of those of its part that share a node with it."""
    cell, shapes = place_of(x, cells, point)
    weights = np.zeros(len(x if at_nodes else cells))
    if at_nodes:
        np.add.at(weights, cells[cell], shapes)
        return weights
    near = np.flatnonzero(np.isin(cells, cells[cell]).any(axis=1) & (parts == parts[cell]))
    away = (x[cells[near]].mean(axis=1) - point) / np.ptp(x[cells[cell]])
    centre = away.mean(axis=0)
    weights[near] = np.array([1.0, *-centre]) @ np.linalg.pinv(np.column_stack([np.ones(len(near)), away - centre]))
    return weights


def parse(text: str) -> Quantity:
    """A quantity from its words."""
    table, _, rest = text.partition(":")
    column, at, rest = rest.partition("@") if "@" in rest else (rest, "", "")
    selected, _, measure = (rest if at else column).rpartition(":") if ":" in (rest if at else column) else (rest if at else column, "", "")
    if measure and measure not in MEASURES and not measure.startswith("at="):
        if at or table != "field":
            raise UserError(f"{text}: no measure '{measure}'{missing(measure, (*MEASURES, 'at=T'))}")
        selected, measure = column, ""  # field:stress:xy
    column, where = (column, selected) if at else (selected, "")
    if not table or not column:
        raise UserError(f"'{text}': expected {FORM}, or field:NAME:largest")
    pairs = []
    for pair in where.split(",") if at else ():
        name, equals, value = pair.partition("=")
        if not name or not equals or not value:
            raise UserError(f"{text}: '{pair}': expected KEY=VALUE")
        pairs.append((name, value))
    if table == "field" and pairs and sorted(name for name, _ in pairs) != ["x", "y"]:
        raise UserError(f"{text}: a field is taken at @x=X,y=Y")
    time = number(text, measure[3:]) if measure.startswith("at=") else 0.0
    return Quantity(text, table, column, tuple(pairs), measure.partition("=")[0] or "largest", time)
