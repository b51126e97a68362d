# SPDX-License-Identifier: MIT
"""The bodies of doc/meshes.md as coarse rectangles, with the groups of its mesh: coarse_hertz.py OUT.msh.

gmsh, which makes the mesh of the page, is not among the packages of the tests.
"""
import sys

import meshio
import numpy as np

R, N = 0.02, 4   # m; elements along an edge


def grid(x, y, first):
    """Points of N + 1 by N + 1, quads, lower and upper edges; points count from `first`."""
    points = np.array([(u, v, 0.0) for v in np.linspace(*y, N + 1) for u in np.linspace(*x, N + 1)])
    at = first + np.arange((N + 1) ** 2).reshape(N + 1, N + 1)
    quads = np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]], axis=-1).reshape(-1, 4)
    return points, quads, *(np.stack([row[:-1], row[1:]], axis=1) for row in (at[0], at[-1]))


block, lower, base, flat = grid((-2 * R, 2 * R), (-2 * R, 0.0), 0)
cylinder, upper, around, top = grid((-R, R), (0.0, R), len(block))
kinds = [(upper, 1), (lower, 2), (around, 11), (top, 12), (flat, 13), (base, 14)]
names = {"cylinder": (1, 2), "block": (2, 2), "round": (11, 1), "top": (12, 1), "flat": (13, 1), "base": (14, 1)}
numbers = [np.full(len(cells), number) for cells, number in kinds]
mesh = meshio.Mesh(np.vstack([block, cylinder]), [("quad" if cells.shape[1] == 4 else "line", cells) for cells, _ in kinds],
                   cell_data={"gmsh:physical": numbers, "gmsh:geometrical": numbers},
                   field_data={name: np.array(number) for name, number in names.items()})
meshio.write(sys.argv[1], mesh, "gmsh22", binary=False)
