# SPDX-License-Identifier: MIT
"""What can be computed from the mesh of a run: areas, lumped masses, step limits, mirror images."""
from __future__ import annotations

import numpy as np


def corner_difference(points: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Areas (m^2) and lengths A/longest side (m) of all elements; `points` (n, 2)."""
    corner = points[cells]
    first, second = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
    area = 0.5 * (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    sides = np.linalg.norm(corner - np.roll(corner, -1, axis=1), axis=2)
    return area, area / sides.max(axis=1)


def cell_values(run, name: str) -> np.ndarray:
    """A value of its material for each element, NaN where the log has none."""
    parts = run.results.cell_field("part_id")[0]
    values = np.full(len(parts), np.nan)
    for part in run.log.parts.values():
        values[parts == part.id] = run.log.materials.get(part.material, {}).get(name, np.nan)
    return values


def lumped_mass(run) -> np.ndarray:
    """(n_node) kg/m; the mass of an element in equal parts on its corners."""
    cells = run.results.cells
    area, _ = corner_difference(run.results.points[0][:, :2], cells)
    mass = np.zeros(run.results.n_node)
    triangle = cells[:, 2] == cells[:, 3]
    share = cell_values(run, "density") * area / np.where(triangle, 3.0, 4.0)
    for k in range(4):
        rows = ~triangle if k == 3 else slice(None)
        np.add.at(mass, cells[rows, k], share[rows])
    return mass


def smallest_limit_ratio(run) -> float:
    """Smallest step limit of the elements over all states, over that at time zero; NaN unknown."""
    speed = cell_values(run, "c")
    limits = [(corner_difference(points[:, :2], run.results.cells)[1] / speed).min()
              for points in run.results.points]
    return float(min(limits) / limits[0])


def mirror_pairs(points: np.ndarray, axis: int) -> np.ndarray | None:
    """Node that each node falls upon when the mesh is mirrored about its middle; None if any
    falls beside. `axis` 0 mirrors x, 1 mirrors y."""
    size = float(np.ptp(points, axis=0).max())
    if size == 0.0:
        return None
    middle = 0.5 * (points[:, axis].min() + points[:, axis].max())
    mirrored = points.copy()
    mirrored[:, axis] = 2.0 * middle - points[:, axis]
    grain = 1.0e-7 * size
    order, image = (np.lexsort(np.floor(where / grain + 0.318).T[[1, 0]])
                    for where in (points, mirrored))
    if np.abs(points[order] - mirrored[image]).max() > 2.0 * grain:
        return None
    pairs = np.empty(len(points), dtype=int)
    pairs[image] = order
    return pairs


def mirrored_cells(cells: np.ndarray, pairs: np.ndarray) -> np.ndarray | None:
    """Element that each element falls upon; None if any falls beside."""
    own, image = np.sort(cells, axis=1), np.sort(pairs[cells], axis=1)
    first, second = np.lexsort(own.T), np.lexsort(image.T)
    if not np.array_equal(own[first], image[second]):
        return None
    match = np.empty(len(cells), dtype=int)
    match[second] = first
    return match
