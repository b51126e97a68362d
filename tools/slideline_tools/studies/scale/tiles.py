# SPDX-License-Identifier: MIT
"""Tiles of a mesh as the program cuts them, and what processes that share them send in a step.

The same as src/model/layout_building.f90 and src/solve/explicit/rank_partition.f90 for one part and no
contact; the bytes that this gives are held against those that the program counts.
"""
import numpy as np

from slideline_tools.decks import Grid, spaced

TILE = 512        # elements at most
CURVE_BITS = 16   # the Hilbert curve has 2^16 cells along each axis
SLOT_BYTES = 16   # two forces


def ring_mesh(around, across):
    """Nodes and quads of a ring of radii 0.8 to 1."""
    angle = 2.0 * np.pi * np.arange(around) / around
    radius = np.linspace(0.8, 1.0, across + 1)
    points = np.stack([np.outer(np.cos(angle), radius), np.outer(np.sin(angle), radius)], axis=-1)
    node = np.arange(around * (across + 1)).reshape(around, across + 1)
    after = np.roll(node, -1, axis=0)
    quads = np.stack([node[:, :-1], node[:, 1:], after[:, 1:], after[:, :-1]], axis=-1)
    return points.reshape(-1, 2), quads.reshape(-1, 4)


def grid_mesh(columns, rows, width, height):
    """Nodes and quads of a rectangle."""
    grid = Grid(spaced((0.0, width, columns)), spaced((0.0, height, rows)), first_node=0)
    return grid.points.reshape(-1, 2), grid.quads.reshape(-1, 4)


MESHES = {  # one body without contact each
    "square": lambda: grid_mesh(200, 200, 1.0, 1.0),
    "bar": lambda: grid_mesh(1600, 25, 64.0, 1.0),
    "ring": lambda: ring_mesh(1000, 40),
}


def hilbert_distance(x, y):
    """Places of the cells (x, y) along the curve."""
    p, q = np.array(x, dtype=np.int64), np.array(y, dtype=np.int64)
    found = np.zeros_like(p)
    whole = 2 ** CURVE_BITS - 1
    side = 2 ** (CURVE_BITS - 1)
    while side:
        right, upper = (p & side) > 0, (q & side) > 0
        found += side * side * ((3 * right) ^ upper)
        turned = ~upper & right
        p, q = np.where(turned, whole - p, p), np.where(turned, whole - q, q)
        p, q = np.where(upper, p, q), np.where(upper, q, p)
        side //= 2
    return found


def tiles_of(points, quads):
    """The tile of each element, from 0 on."""
    low = points.min(axis=0)
    cells = 2 ** CURVE_BITS
    cell = (points.max(axis=0) - low).max() / cells
    places = np.minimum(((points[quads].mean(axis=1) - low) / cell).astype(np.int64), cells - 1)
    order = np.argsort(hilbert_distance(places[:, 0], places[:, 1]), kind="stable")
    n = max(1, -(-len(quads) // TILE))
    tiles = np.empty(len(quads), dtype=np.int64)
    for k in range(n):
        tiles[order[len(quads) * k // n:len(quads) * (k + 1) // n]] = k
    return tiles


def slots_of(quads, tiles):
    """(node, tile) of the force slots on nodes that several tiles touch, by node."""
    pairs = np.unique(quads.ravel() * (tiles.max() + 1) + np.repeat(tiles, 4))
    nodes, touching = np.divmod(pairs, tiles.max() + 1)
    shared = np.bincount(nodes)[nodes] > 1
    return nodes[shared], touching[shared]


def ranges(sizes, n):
    """The process of each tile where each has a range of the curve, as even as tiles allow."""
    middle = np.cumsum(sizes) - 0.5 * sizes
    return np.minimum(n - 1, (n * (middle / sizes.sum())).astype(int))


def traffic(slots, owner, n):
    """(messages, bytes) that each of n processes sends in a step; `owner`: process of each tile."""
    nodes, touching = slots
    ranks = owner[touching]
    messages, sent = np.zeros(n, dtype=int), np.zeros(n, dtype=int)
    # Pairs of slots of one node stand side by side; it has at most as many as elements meet in it.
    found = []
    for shift in range(1, np.bincount(nodes).max()):
        same = nodes[shift:] == nodes[:-shift]
        a, b = np.flatnonzero(same), np.flatnonzero(same) + shift
        found += [(a, ranks[b]), (b, ranks[a])]
    slot, other = (np.concatenate(parts) for parts in zip(*found))
    apart = ranks[slot] != other
    needs = np.unique(slot[apart] * n + other[apart])  # a slot goes to a process once
    sender = ranks[needs // n]
    np.add.at(sent, sender, SLOT_BYTES)
    pairs = np.unique(sender * n + needs % n)
    np.add.at(messages, pairs // n, 1)
    return messages, sent
