# SPDX-License-Identifier: MIT
"""What can be computed from the mesh of a run: areas, the step limit of its elements, mirror images."""
from __future__ import annotations

import numpy as np


def corner_difference(points: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Areas (m^2) and lengths A/longest side (m) of all elements; `points` (n, 2)."""
    corner = points[cells]
    first, second = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
    area = 0.5 * (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    sides = np.linalg.norm(corner - np.roll(corner, -1, axis=1), axis=2)
    return area, area / sides.max(axis=1)


def element_limit(run) -> float:
    """Smallest A/(longest side c) of the elements at the first state, s, with c by the elastic constants; 0 where a
    deformable part has none."""
    if run.results is None or not run.parts:
        return 0.0
    length = corner_difference(run.results.points[0][:, :2], run.results.cells)[1]
    parts, limit = run.results.cell_field("part_id")[0], np.inf
    for part in run.parts:
        if part.is_rigid or not np.any(parts == part.id):
            continue
        if not part.young > 0.0 or not part.density > 0.0 or part.poisson >= 0.5:
            return 0.0
        nu = part.poisson
        speed = np.sqrt(part.young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu) * part.density))
        limit = min(limit, float(length[parts == part.id].min()) / speed)
    return limit if np.isfinite(limit) else 0.0


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
