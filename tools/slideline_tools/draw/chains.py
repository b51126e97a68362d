# SPDX-License-Identifier: MIT
"""Surfaces as chains of segments, walked counter-clockwise round their body.

The rules are those of the program: an exterior edge belongs to exactly one element; the body
lies on the left of a segment, so that the outward normal of the unit tangent t is (t_y, -t_x). A
list of nodes may be walked backwards, or be out of order as long as its exterior edges form one
chain.
"""
from __future__ import annotations

import dataclasses

import numpy as np


@dataclasses.dataclass
class Surface:
    """Chains of node indices; a closed one repeats its first node at the end.

    `how` says what was done to a list of nodes: "" as given, "turned", "put in order", or "broken"
    (no chain can be made: drawn as given).
    """

    label: str
    chains: list[np.ndarray]
    how: str = ""

    @property
    def nodes(self) -> np.ndarray:
        """All nodes in walking order, each once."""
        return np.concatenate([chain[:-1] if len(chain) > 1 and chain[0] == chain[-1] else chain
                               for chain in self.chains] or [np.zeros(0, int)])

    @property
    def segments(self) -> np.ndarray:
        """(n, 2) both ends of every segment in walking order."""
        return np.concatenate([np.stack([chain[:-1], chain[1:]], axis=1) for chain in self.chains]
                              or [np.zeros((0, 2), int)])


def normals(points: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """(n, 2) outward unit normals of segments."""
    tangent = points[segments[:, 1]] - points[segments[:, 0]]
    tangent = tangent / np.maximum(np.linalg.norm(tangent, axis=1), 1.0e-300)[:, None]
    return np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)


def exterior_edges(cells: np.ndarray) -> np.ndarray:
    """(n, 2) edges of exactly one element, walked counter-clockwise round it; cells (n, 4)."""
    edges = np.vstack([cells[:, [k, (k + 1) % 4]] for k in range(4)])
    edges = edges[edges[:, 0] != edges[:, 1]]
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True,
                                return_counts=True)
    return edges[np.sort(first[count == 1])]


def parts_surface(cells: np.ndarray, label: str) -> Surface:
    """The whole boundary of some elements: closed chains, each from its first node in the deck.

    Where the boundary touches itself in a node the program makes no chain; here it stays broken.
    """
    edges = exterior_edges(cells)
    follower = {int(a): int(b) for a, b in edges}
    if len(follower) < len(edges):
        return Surface(label, [edge for edge in edges], "broken")
    return Surface(label, walk_chains(follower, sorted(follower)))


def walk_chains(follower: dict, starts: list) -> list:
    """The chains from node to following node, begun at these nodes where no chain has been."""
    chains, used = [], set()
    for start in starts:
        if start in used:
            continue
        chain = [start]
        while chain[-1] not in used and chain[-1] in follower:
            used.add(chain[-1])
            chain.append(follower[chain[-1]])
        chains.append(np.array(chain))
    return chains


def edges_surface(cells: np.ndarray, ends: np.ndarray, label: str) -> Surface:
    """The chains of edges given by pairs of nodes, either way, among the exterior edges of all elements."""
    wanted = {frozenset((int(a), int(b))) for a, b in np.reshape(ends, (-1, 2))}
    near = cells[np.isin(cells, ends).sum(axis=1) >= 2]
    edges = [(int(a), int(b)) for a, b in exterior_edges(near) if frozenset((int(a), int(b))) in wanted]
    follower, reached = dict(edges), {b for _, b in edges}
    if len(edges) < len(wanted) or len(follower) < len(edges) or len(reached) < len(edges):
        return Surface(label, [np.array(edge) for edge in edges], "broken")
    return Surface(label, walk_chains(follower, [node for node in follower if node not in reached] + sorted(follower)))


def list_surface(cells: np.ndarray, nodes: np.ndarray, label: str) -> Surface:
    """The chain that a list of nodes describes, among the exterior edges of all elements."""
    given = [int(node) for node in nodes if node >= 0]
    closed = len(given) > 2 and given[0] == given[-1]
    ring = given[:-1] if closed else given
    near = cells[np.isin(cells, ring).sum(axis=1) >= 2]
    members = set(ring)
    edges = {(int(a), int(b)) for a, b in exterior_edges(near) if a in members and b in members}
    pairs = list(zip(given[:-1], given[1:]))
    if pairs and all(pair in edges for pair in pairs):
        return Surface(label, [np.array(given)])
    if pairs and all((b, a) in edges for a, b in pairs):
        return Surface(label, [np.array(given[::-1])], "turned")
    ordered = only_chain(ring, edges)
    if ordered is None:
        return Surface(label, [np.array(given)], "broken")
    return Surface(label, [np.array(ordered)], "put in order")


def only_chain(nodes: list[int], edges: set[tuple[int, int]]) -> list[int] | None:
    """The one chain that edges make of all nodes; None if there is no such chain."""
    follower = dict(edges)
    reached = {b for _, b in edges}
    starts = [node for node in nodes if node not in reached]
    if len(follower) < len(edges) or len(reached) < len(edges) or len(starts) > 1:
        return None
    chain = [starts[0] if starts else nodes[0]]
    while chain[-1] in follower and len(chain) <= len(nodes):
        chain.append(follower[chain[-1]])
        if chain[-1] == chain[0]:
            break
    return chain if len(set(chain)) == len(set(nodes)) else None
