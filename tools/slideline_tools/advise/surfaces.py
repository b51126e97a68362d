# SPDX-License-Identifier: MIT
"""The two surfaces of each interface as the program walks them, and what their springs allow."""
from __future__ import annotations

import numpy as np

from slideline_tools.draw.surface import Surface

# Types that leave out what hangs over a chain's end; points of the others stand for half a segment
# beyond it.
COVERING = (5, 7)


def read_surfaces(run) -> dict[int, tuple[Surface, Surface]]:
    """Slave and master of each interface by its number, with the indices of the results; those that
    touch themselves are left out."""
    if run.results is None or run.model is None or not np.array_equal(
            run.results.point_field("node_id")[0], run.model.node_ids):
        return {}
    return {one.id: (one.slave, one.master) for one in run.model.interfaces
            if len(one.slave.segments) and len(one.master.segments)
            and not np.isin(one.slave.segments, one.master.segments).any()}


def spring_limit(run, interface, pair: tuple[Surface, Surface], mass: np.ndarray) -> float:
    """The time step that the springs of an interface alone allow, s.

    2/omega with omega^2 <= max K/m of the slave + max K/m of the master nodes, all nodes in
    contact at time zero: the bound that the program itself warns by (doc/theory/contact.md, 7).
    """
    points = run.results.points[0][:, :2]
    slave, master = (local(side, points, mass) for side in pair)
    overhang = 0.0 if interface.ctype in COVERING else 0.5
    slave_ratio = interface.slave_penalty * competence(slave)
    master_ratio = interface.slave_penalty * most_on_nodes(master, slave[0].max(), overhang)
    if interface.ctype == 1:
        shortest = slave[0].min()
        slave_ratio = np.full(len(slave[2]), interface.node_penalty)
        master_ratio = (interface.node_penalty / shortest
                        * most_on_nodes(master, shortest, overhang, True))
    if interface.ctype == 3:
        master_ratio = master_ratio + interface.master_penalty * competence(master)
        slave_ratio = slave_ratio + interface.master_penalty * most_on_nodes(
            slave, master[0].max(), overhang)
    stiffest = (slave_ratio / slave[2]).max() + (master_ratio / master[2]).max()
    damping = np.sqrt(1.0 + interface.damping ** 2) - interface.damping
    return float(2.0 / np.sqrt(max(stiffest, 1.0e-300)) * damping)


def local(side: Surface, points: np.ndarray, mass: np.ndarray) -> tuple[np.ndarray, ...]:
    """Lengths of the segments, their ends by place among the nodes, and masses of the nodes."""
    nodes, ends = np.unique(side.segments, return_inverse=True)
    return side.lengths(points), ends.reshape(-1, 2), mass[nodes]


def competence(side) -> np.ndarray:
    """Half of the segments beside each node, m; `side` = lengths, local ends, masses."""
    lengths, ends, mass = side
    return 0.5 * np.bincount(ends.ravel(), np.repeat(lengths, 2), len(mass))


def most_on_nodes(side, s: float, overhang: float, at_equal_distances: bool = False):
    """Most length that points of the other side, up to `s` apart, can put on each node."""
    h, ends, mass = side
    if at_equal_distances:
        n = np.floor(h / s)
        share = s * (0.5 + n * (1.0 - 0.5 * (n + 1.0) * s / h))
    else:
        share = 0.5 * h + np.where(s <= 2.0 * h, s ** 2 / (8.0 * h), 0.5 * (s - h))
    beside = np.bincount(ends.ravel(), minlength=len(mass))
    return (overhang * s * (2 - beside)
            + np.bincount(ends.ravel(), np.repeat(share, 2), len(mass)))


def never_near(run, pair: tuple[Surface, Surface], largest: float = 2.0e8) -> float | None:
    """Smallest distance of the two surfaces over all states if it proves that they never met.

    Between two states no node goes farther than the largest nodal speed seen at any state, and
    a half, times half the time between them. None when that does not exclude a meeting, or when
    the comparison would be too large.
    """
    results = run.results
    slave, master = pair
    speed = np.linalg.norm(results.point_field("velocity"), axis=2).max()
    reach = 2.0 * 1.5 * speed * 0.5 * np.diff(results.times).max()
    if len(slave.nodes) * len(master.nodes) * len(results.times) > largest:
        return None
    nearest = np.inf
    for points in results.points[:, :, :2]:
        apart = np.linalg.norm(points[slave.nodes][:, None] - points[master.nodes][None], axis=2)
        half = 0.5 * max(slave.lengths(points).max(), master.lengths(points).max())
        nearest = min(nearest, float(apart.min() - half))
    return nearest if nearest > reach else None
