# SPDX-License-Identifier: MIT
"""The two surfaces of each interface, from the effective deck and the mesh."""
from __future__ import annotations

import dataclasses

import numpy as np

from slideline_tools.advise import geometry
from slideline_tools.advise.run_deck import contact_blocks, sets, whole_number


@dataclasses.dataclass
class Surface:
    """Indices of nodes, and of the two ends of each segment (n, 2)."""

    nodes: np.ndarray
    segments: np.ndarray

    def lengths(self, points: np.ndarray) -> np.ndarray:
        """Length of each segment, m."""
        ends = points[self.segments]
        return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)


def read_surfaces(run) -> dict[int, tuple[Surface, Surface]]:
    """Slave and master of each interface by its number; those not understood are left out."""
    blocks = contact_blocks(run.blocks)
    if run.results is None or len(blocks) != len(run.log.interfaces):
        return {}
    found = {}
    for interface, block in zip(run.log.interfaces.values(), blocks):
        fields = block.fields(0)
        try:
            pair = [read_surface(run, whole_number(field)) for field in fields[:2]]
        except (KeyError, ValueError):
            continue
        if len(pair) == 2 and [len(side.nodes) for side in pair] == [interface.n_slave,
                                                                     interface.n_master]:
            found[interface.id] = (pair[0], pair[1])
    return found


def read_surface(run, number: int) -> Surface:
    """A node set in walking order (negative number) or the boundary of a part set."""
    results = run.results
    if number < 0:
        index = {int(node): k for k, node in enumerate(results.point_field("node_id")[0])}
        nodes = np.array([index[node] for node in sets(run.blocks, "NODE")[-number]])
        return Surface(np.unique(nodes), np.stack([nodes[:-1], nodes[1:]], axis=1))
    parts = sets(run.blocks, "PART")[number]
    edges = geometry.boundary_edges(
        results.cells[np.isin(results.cell_field("part_id")[0], parts)])
    return Surface(np.unique(edges), edges)


def spring_limit(run, interface, pair: tuple[Surface, Surface], mass: np.ndarray) -> float:
    """A time step that the springs of an interface allow for certain, s.

    2/omega with omega^2 <= max K/m of the slave + max K/m of the master nodes (doc/theory). A
    node carries at most the springs of its competence length; the length here is the longest
    segment of either side and a half, so that the limit is rather too small than too large.
    """
    points = run.results.points[0][:, :2]
    slave, master = pair
    length = 1.5 * max(slave.lengths(points).max(), master.lengths(points).max())
    stiffness = (interface.slave_penalty
                 + (interface.master_penalty if interface.ctype == 3 else 0.0)) * length
    if interface.ctype == 1:
        per_slave = slave.lengths(points).min()
        stiffness = interface.node_penalty * max(1.0, 1.0 + length / per_slave)
    lightest = 1.0 / mass[slave.nodes].min() + 1.0 / mass[master.nodes].min()
    damping = np.sqrt(1.0 + interface.damping ** 2) - interface.damping
    return float(2.0 / np.sqrt(max(stiffness * lightest, 1.0e-300)) * damping)


def never_near(run, pair: tuple[Surface, Surface], largest: float = 2.0e8) -> float | None:
    """Smallest distance of the two surfaces over all states if it proves that they never met.

    Between two states no node goes farther than the largest nodal speed seen at any state, and
    a half, times half the time between them. None when that does not exclude a meeting, or when
    the comparison would be too large.
    """
    results = run.results
    slave, master = pair
    spans = np.diff(results.times).max()
    speed = np.linalg.norm(results.point_field("velocity"), axis=2).max()
    reach = 2.0 * 1.5 * speed * 0.5 * spans
    if len(slave.nodes) * len(master.nodes) * len(results.times) > largest:
        return None
    nearest = np.inf
    for points in results.points[:, :, :2]:
        apart = np.linalg.norm(points[slave.nodes][:, None] - points[master.nodes][None], axis=2)
        half = 0.5 * max(slave.lengths(points).max(), master.lengths(points).max())
        nearest = min(nearest, float(apart.min() - half))
    return nearest if nearest > reach else None
