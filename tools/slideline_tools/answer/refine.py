# SPDX-License-Identifier: MIT
"""A deck on a mesh that is finer where it pays: some elements in four, hanging nodes between them and their neighbours.

Neighbours differ by one division at most, and the elements along a contact surface are divided all or none, so that
surfaces have no hanging nodes. What refers to the mesh is carried along as by `divide`.
"""
import itertools
import typing

import numpy as np

from slideline_tools import UserError
from slideline_tools.answer.divide import Division, Mesh, check_known, deck_of, node_sets, whole
from slideline_tools.draw.model import Model, check_deck
from slideline_tools.effective_deck import Block, read_blocks
from slideline_tools.finished_run import Run
from slideline_tools.results import Results

#: keywords whose sets may not have hanging nodes
WITHOUT_HANGING = ("BOUNDARY_PRESCRIBED_MOTION_SET", "CONSTRAINED_NODE_SET")


def chosen(results: Results, fraction: float, field: str = "error") -> set[int]:
    """Ids of the elements with the largest values of a field that together have this fraction of its sum, over all states."""
    if field not in results.cell_fields:
        raise UserError(f"{results.path} has no cell field {field}"
                        + ("; ask for it with *DATABASE_ERROR_INDICATOR" if field == "error" else ""))
    values = np.abs(results.cell_field(field)).sum(axis=0)
    order = np.argsort(-values, kind="stable")
    reached = np.cumsum(values[order])
    if not reached[-1] > 0.0:
        raise UserError(f"the field {field} is 0 in all elements of {results.path}")
    count = int(np.searchsorted(reached, fraction * reached[-1] * (1.0 - 1e-12))) + 1
    return set(results.cell_field("element_id")[0].astype(int)[order[:count]].tolist())


def refine_run(run: Run, program: str, fraction: float, field: str = "error", surfaces: bool = False) -> tuple[str, int, int]:
    """The deck of a run with the elements divided that `chosen` finds and, with `surfaces`, those along all contact surfaces;
    and the numbers of elements divided and of all. UserError where that cannot be."""
    if run.results is None or not run.deck:
        raise UserError(f"{run.prefix} has no results or no deck as run (.effective.k)")
    model = check_deck(run.path(".effective.k"), program)
    return refined(run.deck, model, chosen(run.results, fraction, field), surfaces)


class RefinedMesh(Mesh):
    """The mesh of a deck of which some elements are divided in four.

    `hanging`  of the old mesh: edge of a large element -> the node in its middle
    """

    def __init__(self, blocks: list[Block], surfaces: typing.Iterable[typing.Iterable[tuple[int, int]]]) -> None:
        """`surfaces`: segments (pairs of nodes) of each surface."""
        super().__init__(blocks)
        self.hanging: dict[frozenset, int] = {}
        for block in blocks:
            if block.keyword == "CONSTRAINED_ADAPTIVITY":
                for node, *ends in (map(whole, card[:3]) for card in block.cards()):
                    self.hanging[frozenset(ends)] = node
        # An edge with a hanging node and its halves have elements on both sides.
        for edge, node in self.hanging.items():
            large, halves = self.sides[edge], [frozenset((node, end)) for end in edge]
            small = [place for half in halves for place in self.sides[half]]
            for half in halves:
                self.sides[half] = self.sides[half] + large
            self.sides[edge] = large + small
        self.outside = {node for edge, on in self.sides.items() if len(on) == 1 for node in edge}
        self.larger = {frozenset((node, end)): self.sides[edge][0] for edge, node in self.hanging.items() for end in edge}
        self.surfaces = [{place for pair in segments for place in self.sides.get(frozenset(pair), ())} for segments in surfaces]

    def closed(self, places: set[int]) -> set[int]:
        """The elements that must be divided with these: all along a surface, and larger neighbours."""
        found, new = set(), set(places)
        while new:
            found |= new
            more = {self.larger[edge] for place in new for pair in itertools.pairwise([*self.elements[place][2], self.elements[place][2][0]])
                    if (edge := frozenset(pair)) in self.larger}
            for surface in self.surfaces:
                if surface & new:
                    more |= surface
            new = more - found
        return found

    def refine(self, places: set[int]) -> None:
        """Divide these elements in four."""
        number = itertools.count(max(self.points) + 1)
        bulge = self.bulges()
        edges = dict.fromkeys(frozenset(pair) for place in sorted(places)
                              for pair in itertools.pairwise([*self.elements[place][2], self.elements[place][2][0]]))
        for edge in edges:
            a, b = sorted(edge)
            if edge not in self.hanging:
                node = self.add(next(number), {a: 0.5, b: 0.5})
                self.points[node] = self.points[node] + bulge(a, b, 0.5)
                self.between[edge] = a, [node]
            else:
                self.between[edge] = a, [self.hanging[edge]]
        fresh = itertools.count(max(one[0] for one in self.elements) + 1)
        for place, (eid, _, nodes) in enumerate(self.elements):
            grid, cells = [], [nodes]
            if place in places:
                grid, cells = (self.quad if len(nodes) == 4 else self.triangle)(nodes, 2, number)
            self.inside.append([node for node in grid if len(self.weights.get(node, ())) > 2])
            self.children.append([(eid if k == 0 else next(fresh), cell) for k, cell in enumerate(cells)])
        left = {frozenset(pair) for some in self.children for _, cell in some for pair in itertools.pairwise([*cell, cell[0]])}
        middles = {**self.hanging, **{edge: new[0] for edge, (_, new) in self.between.items()}}
        self.hanging = {edge: node for edge, node in middles.items() if edge in left}

    def new_between(self, edge: frozenset) -> list[int]:
        """The new nodes of an edge."""
        return [node for node in self.between.get(edge, (0, []))[1] if node in self.weights]

    def along(self, a: int, b: int) -> list[int]:
        """The nodes from a to b of an edge, both ends too."""
        return super().along(a, b) if frozenset((a, b)) in self.between else [a, b]


class Refinement(Division):
    """The blocks of a deck for a refined mesh."""

    def __init__(self, blocks, mesh: RefinedMesh, sets: dict[int, list[int]], finer: list[bool]) -> None:
        """`finer`: whether the surfaces of each interface are divided, in the order of the deck."""
        super().__init__(blocks, mesh, sets, 2)
        self.hanging = set(mesh.hanging.values())
        self.finer = iter(finer)
        moved = {whole(card[0]) for block in blocks if block.keyword.startswith(WITHOUT_HANGING) for card in block.cards()}
        for sid in moved & self.whole_sets.keys():
            self.whole_sets[sid] = [node for node in self.whole_sets[sid] if node not in self.hanging]

    def block(self, block: Block) -> list[str]:
        """The lines of a block."""
        if block.keyword == "CONSTRAINED_ADAPTIVITY":
            return []
        is_interface = block.keyword.startswith("CONTACT_2D_") and "FORCE_TRANSDUCER" not in block.keyword
        if is_interface and not next(self.finer, True):
            return [block.head, *block.lines]
        lines = super().block(block)
        if block.keyword == "BOUNDARY_PRESCRIBED_MOTION_NODE":  # hanging nodes follow their parents
            lines = [line for line in lines if line == block.head or whole(line.split(",")[0][:block.width].strip()) not in self.hanging]
        return lines

    def further(self) -> list[str]:
        """What stands behind all blocks: the hanging nodes too."""
        rows = [f"{node},{','.join(map(str, sorted(edge)))}" for edge, node in self.mesh.hanging.items()]
        return [*super().further(), *(["*CONSTRAINED_ADAPTIVITY", *rows] if rows else [])]


def refined(text: str, model: Model, elements: typing.Iterable[int], surfaces: bool = False) -> tuple[str, int, int]:
    """The effective deck `text`, of which the program has the model `model`, with these elements (ids) divided in four, with
    `surfaces` those along all contact surfaces too, and all that must go with them; and the numbers of elements that were
    divided and that there are. UserError where something in the deck cannot be carried along."""
    blocks = read_blocks(text)
    check_known(blocks, "CONSTRAINED_ADAPTIVITY")
    sides = [side for one in model.interfaces for side in (one.slave, one.master)]
    mesh = RefinedMesh(blocks, [model.node_ids[side.segments].tolist() for side in sides])
    place_of = {eid: place for place, (eid, _, _) in enumerate(mesh.elements)}
    if missing := next((eid for eid in elements if eid not in place_of), None):
        raise UserError(f"the deck has no element {missing}")
    along = set().union(*mesh.surfaces) if surfaces else set()
    places = mesh.closed({place_of[eid] for eid in elements} | along)
    mesh.refine(places)
    finer = [any(surface & places for surface in mesh.surfaces[2 * k:2 * k + 2]) for k in range(len(model.interfaces))]
    return deck_of(blocks, Refinement(blocks, mesh, node_sets(model), finer)), len(places), sum(map(len, mesh.children))
