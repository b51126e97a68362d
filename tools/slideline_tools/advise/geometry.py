# SPDX-License-Identifier: MIT
"""Mirror images of the mesh of a run."""
import numpy as np


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
