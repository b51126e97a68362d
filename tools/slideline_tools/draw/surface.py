# SPDX-License-Identifier: MIT
"""Surfaces: segments walked counter-clockwise round their body, so that it lies on the left and the outward normal of
the unit tangent t is (t_y, -t_x)."""
import dataclasses

import numpy as np


@dataclasses.dataclass
class Surface:
    """`segments` (n, 2): indices of both ends, in walking order, chain after chain."""

    segments: np.ndarray

    @property
    def nodes(self) -> np.ndarray:
        """All nodes in walking order, each once."""
        flat = self.segments.ravel()
        _, first = np.unique(flat, return_index=True)
        return flat[np.sort(first)]

    def lengths(self, points: np.ndarray) -> np.ndarray:
        """(n,) length of each segment."""
        return np.linalg.norm(points[self.segments[:, 1]] - points[self.segments[:, 0]], axis=1)

    def normals(self, points: np.ndarray) -> np.ndarray:
        """(n, 2) outward unit normals."""
        tangent = points[self.segments[:, 1]] - points[self.segments[:, 0]]
        tangent = tangent / np.maximum(self.lengths(points), 1.0e-300)[:, None]
        return np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
