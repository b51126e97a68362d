# SPDX-License-Identifier: MIT
"""Both halves of a model whose left edge is the axis or the plane of symmetry x = 0, for pictures."""
import numpy as np

#: Components that turn round in the mirror: x of vectors, xy and xz of stresses.
TURNED = {3: (0,), 6: (3, 5)}


class Mirrored:
    """A Results with its image in x = 0 behind it: nodes and cells twice, the rest as it is.

    Points of the image have numbers n_node and up; its cells are walked the other way round, so that they
    stay counter-clockwise.
    """

    def __init__(self, results) -> None:
        self._results = results
        self.n_node, self.n_cell = 2 * results.n_node, 2 * results.n_cell

    def __getattr__(self, name: str):
        return getattr(self._results, name)

    @property
    def points(self) -> np.ndarray:
        """(n_state, 2 n_node, 3) current coordinates."""
        return both(self._results.points)

    @property
    def cells(self) -> np.ndarray:
        """(2 n_cell, 4) indices of nodes; a triangle repeats its last node."""
        cells = self._results.cells
        return np.concatenate([cells, cells[:, [1, 0, 3, 2]] + self._results.n_node])

    def point_field(self, name: str) -> np.ndarray:
        """(n_state, 2 n_node[, 3])."""
        return both(self._results.point_field(name))

    def cell_field(self, name: str) -> np.ndarray:
        """(n_state, 2 n_cell[, 6])."""
        return both(self._results.cell_field(name))


def both(values: np.ndarray) -> np.ndarray:
    """Values (n_state, n[, components]) and their image in x = 0 behind them."""
    image = values
    if values.ndim == 3:
        signs = np.ones(values.shape[2])
        signs[list(TURNED.get(values.shape[2], ()))] = -1.0
        image = values * signs
    return np.concatenate([values, image], axis=1)
