# SPDX-License-Identifier: MIT
"""The two surfaces of each interface as the program walks them, and whether they met."""
import numpy as np

from slideline_tools.draw.surface import Surface

def read_surfaces(run) -> dict[int, tuple[Surface, Surface]]:
    """Slave and master of each interface by its number, with the indices of the results; those that
    touch themselves are left out."""
    if run.results is None or run.model is None or not np.array_equal(
            run.results.point_field("node_id")[0], run.model.node_ids):
        return {}
    return {one.id: (one.slave, one.master) for one in run.model.interfaces
            if len(one.slave.segments) and len(one.master.segments)
            and not np.isin(one.slave.segments, one.master.segments).any()}


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
