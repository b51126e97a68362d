# SPDX-License-Identifier: MIT
"""The model of a deck as the program understood it, from the state at time zero (`slideline check d=DIR`): mesh, parts,
sets, interfaces, conditions and loads.

    model = check_deck("collision.k", "build/release/slideline")
    model.points, model.cells, model.interfaces[0].slave

Lengths, times and forces are in the units of the deck.
"""
import dataclasses
import json
import os
import pathlib
import subprocess
import tempfile
import typing

import h5py
import numpy as np

from slideline_tools import UserError
from slideline_tools.names import counted
from slideline_tools.program import find_program, not_run
from slideline_tools.results import Results, read

DIRECTIONS = {1: "x", 2: "y", 3: "turn about z"}
QUANTITIES = {0: "velocity", 1: "acceleration", 2: "displacement"}
#: what a picture does not show, by its table
NOT_DRAWN = {"lumped_masses": "lumped masses", "skew_supports": "skewed supports",
             "common_motions": "nodes that move alike"}
LONGEST = 120.0   # seconds that the program may take


class ModelError(UserError):
    """A deck that the program refuses, or a program that cannot be run."""
    has_lines = True  # the lines of the program's messages


def labelled(kind: str, one) -> str:
    """What a thing is called: its kind, its number and its title."""
    return f"{kind} {one.id}" + (f' "{one.title}"' if one.title else "")


@dataclasses.dataclass
class Part:
    """A part with the name of its material law; `held`, of a rigid body alone: which of x, y and turn."""

    id: int
    title: str
    section: int
    material: int
    law: str = ""
    density: float = 0.0
    young: float = 0.0
    poisson: float = 0.0
    n_element: int = 0
    is_rigid: bool = False
    held: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """Words for a reader."""
        return labelled("part", self)


@dataclasses.dataclass
class NodeSet:
    """A set of nodes; `nodes` are indices in the order of the deck."""

    id: int
    title: str
    nodes: np.ndarray

    @property
    def label(self) -> str:
        """Words for a reader."""
        return labelled("set", self)


@dataclasses.dataclass
class Surface:
    """`segments` (n, 2): indices of both ends, in walking order, chain after chain: counter-clockwise round the body, so that it
    lies on the left and the outward normal of the unit tangent t is (t_y, -t_x)."""

    segments: np.ndarray

    @property
    def nodes(self) -> np.ndarray:
        """All nodes in walking order, each once."""
        flat = self.segments.ravel()
        _, first = np.unique(flat, return_index=True)
        return flat[np.sort(first)]

    def lengths(self, points: np.ndarray) -> np.ndarray:
        """(n,) length of each segment."""
        return np.linalg.norm(points[self.segments[:, 1]] - points[self.segments[:, 0]], axis=1)

    def normals(self, points: np.ndarray) -> np.ndarray:
        """(n, 2) outward unit normals."""
        tangent = points[self.segments[:, 1]] - points[self.segments[:, 0]]
        tangent = tangent / np.maximum(self.lengths(points), 1.0e-300)[:, None]
        return np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)


@dataclasses.dataclass
class Interface:
    """One interface with its surfaces in the walking direction of the program."""

    id: int
    title: str
    ctype: int
    formulation: str
    friction: float
    sliding_friction: float
    slave: Surface
    master: Surface

    @property
    def label(self) -> str:
        """Words for a reader."""
        return f"{labelled('interface', self)} (type {self.ctype})"

    @property
    def described(self) -> str:
        """Words with its formulation."""
        return f"interface {self.id} ({self.formulation.replace(' (', ', ')}"


@dataclasses.dataclass
class Wall:
    """A rigid wall: a point of it and its unit normal, towards the bodies."""

    id: int
    point: np.ndarray
    normal: np.ndarray
    friction: float


@dataclasses.dataclass
class Arrows:
    """Equal or different vectors at nodes or points, one legend line together.

    `kind` is `velocity`, `motion`, `load`, `pressure` or `body`; a pressure acts at the middles
    of edges. `vectors` have the direction in which things move or are pushed.
    """

    kind: str
    label: str
    places: np.ndarray   # (n, 2)
    vectors: np.ndarray  # (n, 2)


class Model:
    """The model that `slideline check d=DIR` writes; all indices count from 0 in the order of the deck."""

    def __init__(self, start: Results, warnings: typing.Iterable[str] = ()) -> None:
        """`start`: the file of the state at time zero; `warnings`: what the program said of the deck."""
        with start.reading("the model") as stream:
            tables = {name: {column: values(array) for column, array in table.items()} for name, table in stream["model"].items()}
        self.title = tables["deck"]["title"][0]
        self.is_axisymmetric = bool(tables["deck"]["axisymmetric"][0])
        self.warnings = list(warnings)
        self.node_ids = start.point_field("node_id")[0].astype(int)
        self.points = start.points[0][:, :2]
        self.velocity = start.point_field("velocity")[0][:, :2]
        self._order = np.argsort(self.node_ids, kind="stable")
        self.cells = start.cells
        self.cell_parts = start.cell_field("part_id")[0].astype(int)
        curves = tables.get("curves", {"curve": np.zeros(0), "x": np.zeros(0), "y": np.zeros(0)})
        self.curves = {number: np.stack([curves["x"], curves["y"]], axis=1)[curves["curve"] == number]
                       for number in np.unique(curves["curve"]).tolist()}
        held = {row["part"]: row for row in rows(tables, "rigid_bodies")}
        self.parts = {row["id"]: self._part(row, held.get(row["id"])) for row in rows(tables, "parts")}
        self.node_sets = {row["id"]: NodeSet(row["id"], row["title"], self.indices(nodes)) for row, nodes in zip(
            rows(tables, "node_sets", "node"), pieces(tables, "node_sets", "n_node"))}
        self.interfaces = [Interface(row["id"], row["title"], row["type"], row["formulation"], row["friction"], row["sliding_friction"],
                                     *(Surface(segments) for segments in np.split(
                                         self.indices(nodes).reshape(-1, 2), [row["n_slave"]])))
                           for row, nodes in zip(rows(tables, "interfaces", "node"), pieces(tables, "interfaces", "n_slave", "n_master"))]
        self.walls = [Wall(row["id"], np.array([row["x"], row["y"]]), np.array([row["normal_x"], row["normal_y"]]), row["friction"])
                      for row in rows(tables, "walls")]
        self.history_nodes = self.indices(tables.get("history_nodes", {}).get("node", ())).tolist()
        self.fixed = np.zeros((len(self.points), 2), dtype=bool)
        if fixed := tables.get("fixed"):
            self.fixed[self.indices(fixed["node"]), fixed["direction"] - 1] = True
        self.arrows = self._arrows(tables)
        self.not_drawn = [words for name, words in NOT_DRAWN.items() if name in tables]

    def indices(self, nodes: typing.Sequence[int]) -> np.ndarray:
        """Indices of nodes by their numbers."""
        found = np.asarray(nodes, dtype=int)
        return self._order[np.searchsorted(self.node_ids, found, sorter=self._order)] if found.size else found

    def centre(self, part: int) -> np.ndarray:
        """Middle of the area of a part (its centre of mass, with one density)."""
        corner = self.points[self.cells[self.cell_parts == part]]
        first, second = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
        area = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
        return (corner.mean(axis=1) * area[:, None]).sum(axis=0) / area.sum()

    def peak(self, curve: int, scale: float) -> float:
        """The ordinate of largest size of a curve times a factor."""
        ordinates = self.curves[curve][:, 1]
        return scale * float(ordinates[np.argmax(np.abs(ordinates))])

    def _part(self, row: dict, body: dict | None) -> Part:
        """One part, and how it is held where it is rigid."""
        return Part(**row, n_element=int(np.sum(self.cell_parts == row["id"])), is_rigid=body is not None,
                    held=tuple(name for name in ("x", "y", "turn") if body and body[f"held_{name}"]))

    def _arrows(self, tables: dict) -> list[Arrows]:
        """Prescribed motions and loads; those with one curve, factor and direction together."""
        found = []
        for name, kind, column in (("motions", "motion", "node"), ("body_motions", "motion", "part"),
                                   ("nodal_loads", "load", "node"), ("rigid_loads", "load", "part")):
            for (direction, *quantity, curve, scale), members in groups(tables, name, column):
                size, numbers = self.peak(curve, scale), [number for number, in members]
                what = f"{QUANTITIES[quantity[0]]} of" if quantity else "load on"
                on = (f"part {', '.join(map(str, numbers))}" if column == "part" else
                      f"{len(numbers)} nodes" if len(numbers) > 1 else f"node {numbers[0]}")
                label = (f"{what} {on} in {DIRECTIONS[direction]}, curve {curve}, peak {size:.4g}"
                         + (" on each" if kind == "load" and len(numbers) > 1 else ""))
                places = (self.points[self.indices(numbers)] if column == "node"
                          else np.array([self.centre(part) for part in numbers]))
                found.append(Arrows(kind, label, places, along(direction, size, len(places))))
        for (curve, scale), pairs in groups(tables, "pressures", "first", "second"):
            size = self.peak(curve, scale)
            segments = self.indices(np.ravel(pairs)).reshape(-1, 2)
            label = f"pressure on {counted(len(pairs), 'segment')}, curve {curve}, peak {size:.4g}"
            found.append(Arrows("pressure", label, self.points[segments].mean(axis=1),
                                -size * Surface(segments).normals(self.points)))
        for (direction, curve, scale), _ in groups(tables, "body_loads"):
            size = -self.peak(curve, scale)  # bodies feel minus the base acceleration
            label = f"body load in {DIRECTIONS[direction]}, curve {curve}, acceleration {size:.4g}"
            middle = 0.5 * (self.points.min(axis=0) + self.points.max(axis=0))
            found.append(Arrows("body", label, middle[None], along(direction, size, 1)))
        speed = np.linalg.norm(self.velocity, axis=1)
        if np.any(moving := speed > 0.0):
            label = (f"initial velocity, largest {speed.max():.4g} "
                     f"({counted(int(moving.sum()), 'node')})")
            found.append(Arrows("velocity", label, self.points[moving], self.velocity[moving]))
        return found


def values(array: h5py.Dataset) -> typing.Any:
    """A column: numbers, or texts, of which it has a line each."""
    if array.dtype.kind == "S":
        return array[()].decode("utf-8", "replace").split("\n")[:-1]
    return array[()]


def rows(tables: dict, table: str, *others: str) -> list[dict]:
    """The rows of a table, by its columns but for some that have other lengths; none where there is no table."""
    columns = {name: column if isinstance(column, list) else column.tolist() for name, column in tables.get(table, {}).items()
               if name not in others}
    return [dict(zip(columns, row)) for row in zip(*columns.values())]


def pieces(tables: dict, table: str, *counts: str) -> list[np.ndarray]:
    """The column `node` of a table, cut into the pieces of its rows: as many nodes as the column n_node says, or two for
    each segment."""
    if table not in tables:
        return []
    each = sum(tables[table][name] for name in counts) * (1 if counts == ("n_node",) else 2)
    return np.split(tables[table].get("node", np.zeros(0, dtype=int)), np.cumsum(each)[:-1])


def groups(tables: dict, table: str, *members: str) -> list[tuple[tuple, list]]:
    """(values, members) of the rows of a table: direction, kind, curve and scale, as far as it has them, and what those rows have in
    the columns `members` that are alike in these."""
    found: dict[tuple, list] = {}
    for row in rows(tables, table):
        values = tuple(row[name] for name in ("direction", "kind", "curve", "scale") if name in row)
        found.setdefault(values, []).append([row[name] for name in members])
    return list(found.items())


def along(direction: int, size: float, count: int) -> np.ndarray:
    """`count` vectors of a size in direction 1 (x) or 2 (y); zero for a turn."""
    axis = {1: (1.0, 0.0), 2: (0.0, 1.0)}.get(direction, (0.0, 0.0))
    return np.tile(size * np.array(axis), (count, 1))


def check_deck(deck: str | os.PathLike, program: str | os.PathLike, overrides: typing.Sequence[str] = ()) -> Model:
    """The model of a deck. ModelError with the program's own messages where the deck is refused."""
    with tempfile.TemporaryDirectory() as folder:
        command = [os.fspath(program), "check", f"i={os.fspath(deck)}", "--json", f"d={folder}", "jobid=model", *overrides]
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=LONGEST)
            answer = json.loads(done.stdout)
        except subprocess.TimeoutExpired:
            raise ModelError(f"{deck}: the program took more than {LONGEST:.0f} s") from None
        except OSError as problem:
            raise ModelError(not_run(program, problem)) from problem
        except ValueError:
            raise ModelError(f"{program} tells no model of {deck}: {done.stderr.strip() or 'is it an older one?'}") from None
        path = pathlib.Path(folder, "model.start.vtkhdf")
        if not path.exists():
            raise ModelError(f"{deck} was refused by {program}:\n{done.stderr.strip()}")
        # What can be read may still not start: that is reported with the warnings.
        return Model(read(path), [("" if one["severity"] == "warning" else "it would not run: ") + one["message"]
                                  for one in answer["findings"]])


def model_of(prefix: str | os.PathLike) -> Model | None:
    """The model of the deck as run of a run, `prefix` its folder and job; None where no program can read it."""
    try:
        return check_deck(f"{os.fspath(prefix)}.effective.k", find_program())
    except UserError:
        return None
