# SPDX-License-Identifier: MIT
"""The model of a deck as the program understood it (`slideline check --json`): mesh, parts, sets,
interfaces, conditions and loads.

    model = check_deck("collision.k", "build/release/slideline")
    model.points, model.cells, model.interfaces[0].slave

Lengths, times and forces are in the units of the deck.
"""
from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import typing

import numpy as np

from slideline_tools import UserError
from slideline_tools.draw.surface import Surface
from slideline_tools.names import counted
from slideline_tools.program import find_program, not_run

DIRECTIONS = {1: "x", 2: "y", 3: "turn about z"}
QUANTITIES = {0: "velocity", 1: "acceleration", 2: "displacement"}
#: what a picture does not show, by its name in the JSON
NOT_DRAWN = {"lumped_masses": "lumped masses", "skew_supports": "skewed supports",
             "common_motions": "nodes that move alike"}
LONGEST = 120.0   # seconds that the program may take


class ModelError(UserError):
    """A deck that the program refuses, or a program that cannot be run."""


def labelled(kind: str, one) -> str:
    """What a thing is called: its kind, its number and its title."""
    return f"{kind} {one.id}" + (f' "{one.title}"' if one.title else "")


@dataclasses.dataclass
class Part:
    """A part with the name of its material law; `held` and `turn_held` of a rigid body alone."""

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
    held: tuple[bool, bool] = (False, False)
    turn_held: bool = False

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
    """The model that `slideline check --json` tells; all indices count from 0 in the order of the deck."""

    def __init__(self, told: dict[str, typing.Any], warnings: typing.Iterable[str] = ()) -> None:
        """`told`: the member `model` of the JSON; `warnings`: what the program said of the deck."""
        self.title = told["title"]
        self.is_round = told["axisymmetric"]
        self.warnings = list(warnings)
        self.node_ids = np.array(told["node_ids"], dtype=int)
        self.points = np.stack([np.array(told[axis], dtype=float) for axis in ("x", "y")], axis=1)
        self._order = np.argsort(self.node_ids, kind="stable")
        self.cells = self.indices(told["element_nodes"]).reshape(-1, 4)
        self.cell_parts = np.array(told["element_parts"], dtype=int)
        self.curves = {one["id"]: np.array([one["x"], one["y"]], dtype=float).T for one in told["curves"]}
        self.parts = self._parts(told)
        self.node_sets = {one["id"]: NodeSet(one["id"], one["title"], self.indices(one["nodes"]))
                          for one in told["node_sets"]}
        self.interfaces = [Interface(one["id"], one["title"], one["type"], one["formulation"],
                                     one["friction"], one["sliding_friction"],
                                     *(Surface(self.indices(one[side]).reshape(-1, 2)) for side in ("slave", "master")))
                           for one in told["interfaces"]]
        self.walls = [Wall(one["id"], np.array(one["point"]), np.array(one["normal"]), one["friction"])
                      for one in told.get("walls", ())]
        self.history_nodes = self.indices(told["history_nodes"]).tolist()
        self.fixed = np.zeros((len(self.points), 2), dtype=bool)
        self.fixed[self.indices(told["fixed"]["node"]), np.array(told["fixed"]["direction"], dtype=int) - 1] = True
        self.velocity = self._velocity(told)
        self.arrows = self._arrows(told)
        self.not_drawn = [words for name, words in NOT_DRAWN.items() if told.get(name)]

    def indices(self, nodes: typing.Sequence[int]) -> np.ndarray:
        """Indices of nodes by their numbers."""
        found = np.asarray(nodes, dtype=int)
        return self._order[np.searchsorted(self.node_ids, found, sorter=self._order)] if found.size else found

    def index(self, node: int) -> int:
        """Index of one node by its number."""
        return int(self.indices([node])[0])

    def part_nodes(self, parts: typing.Iterable[int]) -> np.ndarray:
        """Indices of the nodes of some parts."""
        return np.unique(self.cells[np.isin(self.cell_parts, list(parts))])

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

    def _parts(self, told: dict) -> dict[int, Part]:
        """Parts, and how those that are rigid are held."""
        bodies = {one["part"]: one for one in told["rigid_bodies"]}
        return {one["id"]: Part(one["id"], one["title"], one["section"], one["material"], one["law"],
                                one["density"], one["young"], one["poisson"], int(np.sum(self.cell_parts == one["id"])), bool(body),
                                (body.get("held_x", False), body.get("held_y", False)),
                                body.get("held_turn", False))
                for one in told["parts"] for body in [bodies.get(one["id"], {})]}

    def _velocity(self, told: dict) -> np.ndarray:
        """(n_node, 2) at the start: that of its nodes, and of bodies that have one of their own, as far as they are
        free."""
        velocity = np.zeros_like(self.points)
        if "velocity_x" in told:
            velocity = np.stack([told["velocity_x"], told["velocity_y"]], axis=1).astype(float)
        for one in told["rigid_bodies"]:
            if "velocity" in one:
                nodes, part = self.part_nodes([one["part"]]), self.parts[one["part"]]
                spin = 0.0 if part.turn_held else one["velocity"][2]
                arm = self.points[nodes] - self.centre(part.id)
                velocity[nodes] = (np.where(part.held, 0.0, one["velocity"][:2])
                                   + spin * np.stack([-arm[:, 1], arm[:, 0]], axis=1))
        return velocity

    def _arrows(self, told: dict) -> list[Arrows]:
        """Prescribed motions and loads; those with one curve, factor and direction together."""
        found = []
        for name, kind, column in (("motions", "motion", "node"), ("body_motions", "motion", "part"),
                                   ("nodal_loads", "load", "node"), ("rigid_loads", "load", "part")):
            for (direction, *quantity, curve, scale), members in groups(told.get(name, {}), column):
                size = self.peak(curve, scale)
                what = f"{QUANTITIES[quantity[0]]} of" if quantity else "load on"
                on = (f"part {', '.join(map(str, members))}" if column == "part" else
                      f"{len(members)} nodes" if len(members) > 1 else f"node {members[0]}")
                label = (f"{what} {on} in {DIRECTIONS[direction]}, curve {curve}, peak {size:.4g}"
                         + (" on each" if kind == "load" and len(members) > 1 else ""))
                places = (self.points[self.indices(members)] if column == "node"
                          else np.array([self.centre(part) for part in members]))
                found.append(Arrows(kind, label, places, along(direction, size, len(places))))
        pressures = told["pressures"]
        edges = {**{name: pressures[name] for name in ("curve", "scale")},
                 "edge": list(zip(pressures["first"], pressures["second"]))}
        for (curve, scale), pairs in groups(edges, "edge"):
            size = self.peak(curve, scale)
            segments = self.indices(np.ravel(pairs)).reshape(-1, 2)
            label = f"pressure on {counted(len(pairs), 'segment')}, curve {curve}, peak {size:.4g}"
            found.append(Arrows("pressure", label, self.points[segments].mean(axis=1),
                                -size * Surface(segments).normals(self.points)))
        for (direction, curve, scale), _ in groups(told["body_loads"]):
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


def groups(columns: dict[str, list], member: str = "") -> list[tuple[tuple, list]]:
    """(values, members) of the rows of a table: those that differ in the column `member` alone together."""
    found: dict[tuple, list] = {}
    others = [name for name in columns if name != member]
    for row in zip(*(columns[name] for name in columns)):
        values = dict(zip(columns, row))
        found.setdefault(tuple(values[name] for name in others), []).append(values.get(member))
    return list(found.items())


def along(direction: int, size: float, count: int) -> np.ndarray:
    """`count` vectors of a size in direction 1 (x) or 2 (y); zero for a turn."""
    axis = {1: (1.0, 0.0), 2: (0.0, 1.0)}.get(direction, (0.0, 0.0))
    return np.tile(size * np.array(axis), (count, 1))


def check_deck(deck: str | os.PathLike, program: str | os.PathLike, overrides: typing.Sequence[str] = ()) -> Model:
    """The model of a deck. ModelError with the program's own messages where the deck is refused."""
    command = [os.fspath(program), "check", f"i={os.fspath(deck)}", "--json", *overrides]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=LONGEST)
        answer = json.loads(done.stdout)
    except subprocess.TimeoutExpired:
        raise ModelError(f"{deck}: the program took more than {LONGEST:.0f} s") from None
    except OSError as problem:
        raise ModelError(not_run(program, problem)) from problem
    except ValueError:
        raise ModelError(f"{program} tells no model of {deck}: {done.stderr.strip() or 'is it an older one?'}") from None
    if "cases" in answer:
        raise ModelError(f"{deck}: a picture is of one case (case=ID)")
    if "model" not in answer:
        raise ModelError(f"{deck} was refused by {program}:\n{done.stderr.strip()}")
    # What can be read may still not start: that is told with the warnings.
    return Model(answer["model"], [("" if one["severity"] == "warning" else "it would not run: ") + one["message"]
                                   for one in answer["findings"]])


def model_of(prefix: str | os.PathLike) -> Model | None:
    """The model of the deck as run of a run, `prefix` its folder and job; None where no program can read it."""
    try:
        return check_deck(f"{os.fspath(prefix)}.effective.k", find_program())
    except UserError:
        return None
