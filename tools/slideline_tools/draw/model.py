# SPDX-License-Identifier: MIT
"""The model of an effective deck: mesh, parts, sets, interfaces, conditions and loads.

    model = read_model(pathlib.Path("collision.effective.k").read_text())
    model.points, model.cells, model.interfaces[0].slave

Only what a picture or a table needs is read. The deck has been accepted by the program, and its
includes and parameters are resolved; keywords that are not known here are listed in
`model.unread`. Lengths, times and forces are in the units of the deck.
"""
from __future__ import annotations

import dataclasses

import numpy as np

from slideline_tools import UserError
from slideline_tools.draw.cards import Card, read_cards, whole_number
from slideline_tools.draw.chains import Surface, edges_surface, list_surface, parts_surface

# Keywords that put nothing into a picture of the model.
SILENT = ("KEYWORD", "END", "TITLE", "COMMENT", "PARAMETER", "CONTROL_", "DATABASE_", "SECTION_",
          "HOURGLASS", "DAMPING_", "INCLUDE", "DEFINE_TABLE")
DIRECTIONS = {1: "x", 2: "y", 7: "turn about z"}
QUANTITIES = {0: "velocity", 1: "acceleration", 2: "displacement"}
TWO_DIRECTIONS = {1: (True, False), 2: (False, True), 4: (True, True), 5: (False, True),
                  6: (True, False), 7: (True, True)}


class ModelError(UserError):
    """A deck without a mesh, or with a reference that leads nowhere."""


@dataclasses.dataclass
class Part:
    """A part with the keyword of its material; `held` and `turn_held` of a rigid body alone."""

    id: int
    title: str
    section: int
    material: int
    law: str = ""
    n_element: int = 0
    held: tuple[bool, bool] = (False, False)
    turn_held: bool = False

    @property
    def is_rigid(self) -> bool:
        """Whether its elements form a rigid body."""
        return self.law == "MAT_RIGID"

    @property
    def label(self) -> str:
        """Words for a reader."""
        return f'part {self.id}' + (f' "{self.title}"' if self.title else "")


@dataclasses.dataclass
class NodeSet:
    """A set of nodes; `nodes` are indices in the order of the deck, -1 where the mesh has none."""

    id: int
    title: str
    nodes: np.ndarray

    @property
    def label(self) -> str:
        """Words for a reader."""
        return f"set {self.id}" + (f' "{self.title}"' if self.title else "")


@dataclasses.dataclass
class Interface:
    """One interface with its surfaces in the walking direction of the program."""

    id: int
    keyword: str
    title: str
    slave: Surface
    master: Surface
    ctype: int | None = None

    @property
    def label(self) -> str:
        """Words for a reader."""
        kind = f" (type {self.ctype})" if self.ctype else ""
        return f"interface {self.id}" + (f' "{self.title}"' if self.title else "") + kind


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


@dataclasses.dataclass
class Model:
    """Everything that `read_model` understands."""

    title: str = ""
    node_ids: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(0, int))
    points: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros((0, 2)))
    cells: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros((0, 4), int))
    cell_parts: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(0, int))
    parts: dict[int, Part] = dataclasses.field(default_factory=dict)
    node_sets: dict[int, NodeSet] = dataclasses.field(default_factory=dict)
    part_sets: dict[int, list[int]] = dataclasses.field(default_factory=dict)
    segment_sets: dict[int, list[tuple[int, int]]] = dataclasses.field(default_factory=dict)
    boundary_sets: dict[int, tuple[bool, list[int]]] = dataclasses.field(default_factory=dict)
    curves: dict[int, np.ndarray] = dataclasses.field(default_factory=dict)
    interfaces: list[Interface] = dataclasses.field(default_factory=list)
    fixed: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros((0, 2), bool))
    velocity: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros((0, 2)))
    arrows: list[Arrows] = dataclasses.field(default_factory=list)
    laws: dict[int, Card] = dataclasses.field(default_factory=dict)
    history_nodes: list[int] = dataclasses.field(default_factory=list)
    walls: list[tuple[np.ndarray, np.ndarray]] = dataclasses.field(default_factory=list)
    unread: list[str] = dataclasses.field(default_factory=list)
    warnings: list[str] = dataclasses.field(default_factory=list)  # what the program said of it

    def __post_init__(self) -> None:
        self.sort_nodes()

    def index(self, node: int) -> int:
        """Index of a node by its number, -1 without one."""
        place = int(np.searchsorted(self._sorted, node))
        found = place < len(self._sorted) and self._sorted[place] == node
        return int(self._order[place]) if found else -1

    def indices(self, nodes) -> np.ndarray:
        """Indices of many nodes, -1 for those that do not exist."""
        nodes = np.asarray(list(nodes), dtype=int)
        if not len(nodes):
            return nodes
        places = np.minimum(np.searchsorted(self._sorted, nodes), len(self._sorted) - 1)
        return np.where(self._sorted[places] == nodes, self._order[places], -1)

    def known(self, nodes) -> np.ndarray:
        """Indices of those nodes that exist."""
        found = self.indices(nodes)
        return found[found >= 0]

    def sort_nodes(self) -> None:
        """Make nodes findable by number; to be called once the mesh is there."""
        self._order = np.argsort(self.node_ids, kind="stable")
        self._sorted = self.node_ids[self._order]

    def part_nodes(self, parts) -> np.ndarray:
        """Indices of the nodes of some parts."""
        return np.unique(self.cells[np.isin(self.cell_parts, list(parts))])

    def centre(self, part: int) -> np.ndarray:
        """Middle of the area of a part (its centre of mass, with one density)."""
        corner = self.points[self.cells[self.cell_parts == part]]
        first, second = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
        area = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
        return (corner.mean(axis=1) * area[:, None]).sum(axis=0) / area.sum()

    def peak(self, curve: int, scale: float) -> float:
        """The ordinate of largest size of a curve times a factor; the factor without the curve."""
        points = self.curves.get(curve)
        if points is None or not len(points):
            return scale
        return scale * float(points[np.argmax(np.abs(points[:, 1])), 1])


def read_model(text: str) -> Model:
    """The model of an effective deck. Raises ModelError without nodes or elements."""
    cards = read_cards(text)
    model = Model()
    read_mesh(model, [card for card in cards if card.name in ("NODE", "ELEMENT_SHELL")])
    later = []
    for card in cards:
        if not read_definition(model, card):
            later.append(card)
    finish_parts(model)
    left = [card for card in later if not read_condition(model, card)]
    read_initial_velocities(model, left)
    for card in left:
        known = card.name in VELOCITIES or card.name.startswith(SILENT)
        if not known and card.name not in model.unread:
            model.unread.append(card.name)
    return model


def read_mesh(model: Model, cards: list[Card]) -> None:
    """Nodes and elements; corners are put counter-clockwise, as the program does."""
    rows = [card.row(k, (8, 16, 16, 16, 8, 8)) for card in cards if card.name == "NODE"
            for k in range(len(card.lines)) if card.lines[k].strip()]
    elements = [card.row(k, (8,) * 8) for card in cards if card.name == "ELEMENT_SHELL"
                for k in range(len(card.lines)) if card.lines[k].strip()]
    if not rows or not elements:
        raise ModelError("the deck has no mesh")
    model.node_ids = np.array([row.integer(0) for row in rows])
    model.points = np.array([[row.real(1), row.real(2)] for row in rows])
    model.fixed = np.array([TWO_DIRECTIONS.get(row.integer(4), (False, False)) for row in rows])
    model.sort_nodes()
    model.cell_parts = np.array([row.integer(1) for row in elements])
    corners = np.array([[row.integer(k) for k in range(2, 6)] for row in elements])
    corners[:, 3] = np.where(corners[:, 3] == 0, corners[:, 2], corners[:, 3])
    cells = model.indices(corners.ravel()).reshape(-1, 4)
    if np.any(cells < 0):
        raise ModelError("an element has a node that the deck does not define")
    corner = model.points[cells]
    first, second = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
    turned = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0] < 0.0
    triangle = cells[:, 2] == cells[:, 3]
    cells[turned & ~triangle] = cells[turned & ~triangle][:, [0, 3, 2, 1]]
    cells[turned & triangle] = cells[turned & triangle][:, [0, 2, 1, 1]]
    model.cells = cells


# ---- parts, sets and curves ---------------------------------------------------------------------

def read_definition(model: Model, card: Card) -> bool:
    """Whether the card defines something that others refer to, which is then in the model."""
    name = card.name
    if name in ("NODE", "ELEMENT_SHELL"):
        return True
    if name == "TITLE":
        model.title = card.lines[0].strip() if card.lines else ""
    elif name == "PART":
        read_part(model, card)
    elif name.startswith("MAT_"):
        model.laws[card.row(0).integer(0)] = card
    elif name.startswith("SET_NODE_GENERAL"):
        number, members = read_general_set(model, card)
        model.node_sets[number] = NodeSet(number, card.title, members)
    elif name.startswith("SET_NODE"):
        number, members = read_set(card, model.node_ids)
        model.node_sets[number] = NodeSet(number, card.title, model.indices(members))
    elif name.startswith("SET_PART"):
        number, members = read_set(card, np.array(sorted(set(model.cell_parts.tolist()))))
        model.part_sets[number] = members
    elif name.startswith("SET_SEGMENT"):
        rows = [card.row(k) for k in range(1, len(card.lines)) if card.lines[k].strip()]
        model.segment_sets[card.row(0).integer(0)] = [(row.integer(0), row.integer(1))
                                                      for row in rows]
    elif name.startswith("SET_2D_SEGMENT"):
        model.boundary_sets[card.row(0).integer(0)] = (name.startswith("SET_2D_SEGMENT_SET"), read_set(
            card, model.node_ids)[1])
    elif name == "DEFINE_CURVE":
        read_curve(model, card)
    else:
        return False
    return True


def read_general_set(model: Model, card: Card) -> tuple[int, np.ndarray]:
    """Number and node indices of a set whose rows add nodes and take them out."""
    members: dict[int, None] = {}
    for row in (card.row(k) for k in range(1, len(card.lines))):
        option = row.text(0).upper()
        numbers = [row.integer(k) for k in range(1, 8) if row.integer(k)]
        if option == "ALL":
            chosen = range(len(model.points))
        elif option in ("PART", "DPART"):
            chosen = model.cells[np.isin(model.cell_parts, numbers)].ravel().tolist()
        else:
            chosen = [int(node) for node in model.known(numbers)]
        for node in chosen:
            if option.startswith("D"):
                members.pop(int(node), None)
            else:
                members.setdefault(int(node))
    return card.row(0).integer(0), np.array(list(members), dtype=int)


def read_part(model: Model, card: Card) -> None:
    """Pairs of a heading and a card."""
    for k in range(0, len(card.lines) - 1, 2):
        row = card.row(k + 1)
        part = Part(row.integer(0), card.lines[k].strip(), row.integer(1), row.integer(2))
        model.parts[part.id] = part


def finish_parts(model: Model) -> None:
    """Give every part its elements, its material and, to a rigid one, how it is held."""
    for part in model.parts.values():
        part.n_element = int(np.sum(model.cell_parts == part.id))
        if part.material in model.laws:
            card = model.laws[part.material]
            part.law = card.name
            hold = card.row(1)
            if part.is_rigid and hold.integer(0) == 1:
                part.held = TWO_DIRECTIONS.get(hold.integer(1), (False, False))
                part.turn_held = hold.integer(2) in (3, 5, 6, 7)


def read_set(card: Card, existing: np.ndarray) -> tuple[int, list[int]]:
    """Number and members of a set of nodes or parts."""
    number = card.row(0).integer(0)
    values = [value for k in range(1, len(card.lines)) for value in card.row(k).integers()]
    if "GENERATE" not in card.name:
        return number, [value for value in values if value]
    members = []
    for low, high in zip(values[::2], values[1::2]):
        if low:
            members += existing[(existing >= low) & (existing <= high)].tolist()
    return number, members


def read_curve(model: Model, card: Card) -> None:
    """Points of a curve, scaled and shifted as the card says."""
    head = card.row(0)
    scale = [head.real(2) or 1.0, head.real(3) or 1.0]
    offset = [head.real(4), head.real(5)]
    points = [[row.real(0), row.real(1)]
              for row in (card.row(k, (20, 20)) for k in range(1, len(card.lines))
                          if card.lines[k].strip())]
    model.curves[head.integer(0)] = np.array(scale) * (np.array(points).reshape(-1, 2)
                                                       + np.array(offset))


# ---- conditions, loads, interfaces --------------------------------------------------------------

def read_condition(model: Model, card: Card) -> bool:
    """Whether the card is a condition, load or interface, which is then in the model."""
    for start, reader in READERS:
        if card.name.startswith(start):
            reader(model, card)
            return True
    return False


def nodes_of(model: Model, card: Card, number: int) -> np.ndarray:
    """Indices of the nodes of a ..._NODE or ..._SET card by its first field."""
    if "_SET" not in card.name:
        return model.known([number])
    found = model.node_sets.get(number)
    return np.zeros(0, int) if found is None else np.unique(found.nodes[found.nodes >= 0])


def read_fixed(model: Model, card: Card) -> None:
    """*BOUNDARY_SPC_NODE and _SET: one row each."""
    for k in range(len(card.lines)):
        row = card.row(k)
        nodes = nodes_of(model, card, row.integer(0))
        model.fixed[nodes] |= [row.integer(2) != 0, row.integer(3) != 0]


def read_motion(model: Model, card: Card) -> None:
    """*BOUNDARY_PRESCRIBED_MOTION_NODE, _SET and _RIGID: one row each."""
    for k in range(len(card.lines)):
        row = card.row(k)
        number, direction, kind, curve = (row.integer(n) for n in range(4))
        size = model.peak(curve, row.real(4) or 1.0)
        if card.name.endswith("RIGID"):
            places, whom = model.centre(number)[None], f"part {number}"
        else:
            places = model.points[nodes_of(model, card, number)]
            whom = f"set {number}" if "_SET" in card.name else f"node {number}"
        what = (f"{QUANTITIES.get(kind, 'motion')} of {whom} in {DIRECTIONS.get(abs(direction), '?')}"
                f", curve {curve}, peak {size:.4g}")
        model.arrows.append(Arrows("motion", what, places, along(direction, size, len(places))))


def along(direction: int, size: float, count: int) -> np.ndarray:
    """`count` vectors of a size in direction 1 (x) or 2 (y); zero for others."""
    axis = {1: (1.0, 0.0), 2: (0.0, 1.0)}.get(abs(direction), (0.0, 0.0))
    return np.tile(size * np.array(axis), (count, 1))


def read_nodal_load(model: Model, card: Card) -> None:
    """*LOAD_NODE_POINT and _SET."""
    for k in range(len(card.lines)):
        row = card.row(k)
        size = model.peak(row.integer(2), row.real(3) or 1.0)
        places = model.points[nodes_of(model, card, row.integer(0))]
        whom = ("set" if "_SET" in card.name else "node") + f" {row.integer(0)}"
        label = (f"load on {whom} in {DIRECTIONS.get(row.integer(1), '?')}, curve {row.integer(2)}, "
                 f"peak {size:.4g}" + (" on each node" if "_SET" in card.name else ""))
        model.arrows.append(Arrows("load", label, places,
                                   along(row.integer(1), size, len(places))))


def read_segment_load(model: Model, card: Card) -> None:
    """*LOAD_SEGMENT and _SET: positive pressure pushes against the outward normal."""
    by_set = card.name.startswith("LOAD_SEGMENT_SET")
    groups: dict[tuple[str, float], list] = {}
    for k in range(len(card.lines)):
        row = card.row(k)
        number, curve = (row.integer(0), row.integer(1)) if by_set else (0, row.integer(0))
        scale = (row.real(2) if by_set else row.real(1)) or 1.0
        edges = model.segment_sets.get(number, []) if by_set else [(row.integer(3), row.integer(4))]
        size = model.peak(curve, scale)
        where = f" on segment set {number}" if by_set else ""
        groups.setdefault((f"pressure{where}, curve {curve}, peak {size:.4g}", size), []).extend(edges)
    for (label, size), edges in groups.items():
        places, normals = edge_normals(model, edges)
        model.arrows.append(Arrows("pressure", label, places, -size * normals))


def edge_normals(model: Model, edges: list[tuple[int, int]]) -> tuple[np.ndarray, np.ndarray]:
    """Middles and outward unit normals of edges given by node numbers in either order."""
    ends = model.indices(np.array(edges, dtype=int).ravel()).reshape(-1, 2)
    ends = ends[np.all(ends >= 0, axis=1)]
    forward = {(int(a), int(b)) for k in range(4)
               for a, b in model.cells[:, [k, (k + 1) % 4]]}
    ends = np.array([(a, b) if (int(a), int(b)) in forward else (b, a) for a, b in ends],
                    dtype=int).reshape(-1, 2)
    start, end = model.points[ends[:, 0]], model.points[ends[:, 1]]
    tangent = (end - start) / np.linalg.norm(end - start, axis=1)[:, None]
    return 0.5 * (start + end), np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)


def read_body_load(model: Model, card: Card) -> None:
    """*LOAD_BODY_X and _Y: bodies feel minus the base acceleration of the curve."""
    direction = {"X": 1, "Y": 2}.get(card.name[-1], 0)
    for k in range(len(card.lines)):
        row = card.row(k)
        size = -model.peak(row.integer(0), row.real(1) or 1.0)
        label = (f"body load in {DIRECTIONS.get(direction, '?')}, curve {row.integer(0)}, "
                 f"acceleration {size:.4g}")
        middle = 0.5 * (model.points.min(axis=0) + model.points.max(axis=0))
        model.arrows.append(Arrows("body", label, middle[None], along(direction, size, 1)))


def read_wall(model: Model, card: Card) -> None:
    """*RIGIDWALL_PLANAR: a point of the wall and its unit normal."""
    if not card.name.startswith("RIGIDWALL_PLANAR") or len(card.lines) < 2:
        model.unread.append(card.name)
        return
    row = card.row(1)
    tail, head = (np.array([row.real(n), row.real(n + 1)]) for n in (0, 3))
    if np.linalg.norm(head - tail) > 0.0:
        model.walls.append((tail, (head - tail) / np.linalg.norm(head - tail)))


def read_interface(model: Model, card: Card) -> None:
    """*CONTACT_2D_...: both surfaces as the program walks them."""
    if card.name.startswith("CONTACT_2D_FORCE_TRANSDUCER"):
        return  # it measures
    row = card.row(0)
    sides = [row.integer(0), row.integer(1)]
    if card.name.startswith(("CONTACT_2D_PENALTY", "CONTACT_2D_SLIDING", "CONTACT_2D_TIED_SLIDING")):
        sides = [-abs(side) for side in sides]
    elif sides[1] == 0 or "SINGLE_SURFACE" in card.name:
        sides[1] = sides[0]
    ctype = row.integer(2) if card.name.startswith("CONTACT_2D_SLIDELINE") else None
    slave, master = (find_surface(model, side) for side in sides)
    model.interfaces.append(Interface(len(model.interfaces) + 1, card.name, card.title, slave,
                                      master, ctype))


def find_surface(model: Model, number: int) -> Surface:
    """The boundary of a part set (above 0) or the chain of a node set (below 0), or the segment set of that number."""
    if number not in model.part_sets and -number not in model.node_sets:
        label = f"segment set {abs(number)}"
        if abs(number) in model.boundary_sets:
            by_set, numbers = model.boundary_sets[abs(number)]
            parts = [part for k in numbers for part in model.part_sets[k]] if by_set else numbers
            return parts_surface(model.cells[np.isin(model.cell_parts, parts)], label)
        if abs(number) in model.segment_sets:
            return edges_surface(model.cells, model.indices(np.ravel(model.segment_sets[abs(number)])), label)
    if number > 0:
        if number not in model.part_sets:
            raise ModelError(f"no part set {number}")
        chosen = np.isin(model.cell_parts, model.part_sets[number])
        return parts_surface(model.cells[chosen], f"part set {number}")
    if -number not in model.node_sets:
        raise ModelError(f"no node set {-number}")
    found = model.node_sets[-number]
    return list_surface(model.cells, found.nodes, found.label)


def read_history_nodes(model: Model, card: Card) -> None:
    """*DATABASE_HISTORY_NODE and _SET."""
    numbers = [value for k in range(len(card.lines)) for value in card.row(k).integers() if value]
    if card.name.startswith("DATABASE_HISTORY_NODE_SET"):
        found = [model.node_sets[number].nodes for number in numbers if number in model.node_sets]
        model.history_nodes += [int(node) for nodes in found for node in nodes if node >= 0]
    else:
        model.history_nodes += [int(node) for node in model.known(numbers)]


READERS = (
    ("BOUNDARY_SPC", read_fixed), ("BOUNDARY_PRESCRIBED_MOTION", read_motion),
    ("LOAD_NODE", read_nodal_load), ("LOAD_SEGMENT", read_segment_load),
    ("LOAD_BODY", read_body_load), ("CONTACT_2D", read_interface), ("RIGIDWALL", read_wall),
    ("DATABASE_HISTORY_NODE", read_history_nodes),
)


# ---- initial velocities -------------------------------------------------------------------------

VELOCITIES = ("INITIAL_VELOCITY", "INITIAL_VELOCITY_NODE", "INITIAL_VELOCITY_GENERATION",
              "INITIAL_VELOCITY_RIGID_BODY")


def read_initial_velocities(model: Model, cards: list[Card]) -> None:
    """Later keywords win; *INITIAL_VELOCITY_GENERATION comes after all others for nodes, and
    *INITIAL_VELOCITY_RIGID_BODY after it for the nodes of its bodies."""
    model.velocity = np.zeros_like(model.points)
    for card in cards:
        if card.name == "INITIAL_VELOCITY":
            read_velocity(model, card)
        elif card.name == "INITIAL_VELOCITY_NODE":
            for k in range(len(card.lines)):
                row = card.row(k)
                model.velocity[model.known([row.integer(0)])] = [row.real(1), row.real(2)]
    for card in cards:
        if card.name == "INITIAL_VELOCITY_GENERATION":
            for k in range(0, len(card.lines), 2):
                generate_velocity(model, card.row(k), card.row(k + 1))
    for card in cards:
        if card.name == "INITIAL_VELOCITY_RIGID_BODY":
            for k in range(len(card.lines)):
                move_body(model, card.row(k))


def move_body(model: Model, row) -> None:
    """A part of *MAT_RIGID: velocity of its centre of mass and spin about it, as far as it is free."""
    part = row.integer(0)
    nodes = model.part_nodes([part])
    if not len(nodes):
        return
    speed, spin = np.array([row.real(1), row.real(2)]), row.real(6)
    if part in model.parts:
        speed = np.where(model.parts[part].held, 0.0, speed)
        spin = 0.0 if model.parts[part].turn_held else spin
    arm = model.points[nodes] - model.centre(part)
    model.velocity[nodes] = speed + spin * np.stack([-arm[:, 1], arm[:, 0]], axis=1)


def read_velocity(model: Model, card: Card) -> None:
    """*INITIAL_VELOCITY: a set or all nodes, but for those of another set."""
    head, first = card.row(0), card.row(1)
    members = model.node_sets.get(head.integer(0))
    nodes = np.arange(len(model.points)) if members is None else members.nodes[members.nodes >= 0]
    model.velocity[nodes] = [first.real(0), first.real(1)]
    spared = model.node_sets.get(head.integer(1))
    if spared is not None:
        other = card.row(2)
        model.velocity[spared.nodes[spared.nodes >= 0]] = [other.real(0), other.real(1)]


def generate_velocity(model: Model, head, axis) -> None:
    """One pair of cards: a translation and a spin about a point."""
    number, kind = head.integer(0), head.integer(1) or 1
    if number == 0:
        nodes = np.arange(len(model.points))
    elif kind == 3:
        nodes = model.node_sets[number].nodes if number in model.node_sets else np.zeros(0, int)
    else:
        nodes = model.part_nodes([number] if kind == 2 else model.part_sets.get(number, []))
    nodes = nodes[nodes >= 0]
    spin = head.real(2) * (-1.0 if axis.real(5) < 0.0 else 1.0)
    arm = model.points[nodes] - [axis.real(0), axis.real(1)]
    model.velocity[nodes] = (np.array([head.real(3), head.real(4)])
                             + spin * np.stack([-arm[:, 1], arm[:, 0]], axis=1))
