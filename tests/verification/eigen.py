# SPDX-License-Identifier: MIT
"""The largest stable step of a mesh at rest: 2/omega of M^-1 (elements + contact springs).

Written from the equations (doc/theory/elements.md), not from the program: one-point quads in plane
strain with stiffness hourglass control or assumed strain, lumped mass, all dense.
"""
import numpy as np

SIGNS = np.array([1.0, -1.0, 1.0, -1.0])


def quad_stiffness(x, young, poisson, hourglass, assumed=False):
    """Stiffness (8, 8) of one quad (x: 4 corners, counter-clockwise), order x1 y1 x2 y2 ...
    hourglass: its coefficient; assumed: by assumed strain (IHQ 6)."""
    diagonals = x[2] - x[0], x[3] - x[1]
    area = 0.5 * (diagonals[0][0] * diagonals[1][1] - diagonals[0][1] * diagonals[1][0])
    bx = 0.5 * np.array([x[1, 1] - x[3, 1], x[2, 1] - x[0, 1], x[3, 1] - x[1, 1], x[0, 1] - x[2, 1]])
    by = 0.5 * np.array([x[3, 0] - x[1, 0], x[0, 0] - x[2, 0], x[1, 0] - x[3, 0], x[2, 0] - x[0, 0]])
    lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    shear = 0.5 * young / (1.0 + poisson)
    law = np.array([[lame + 2.0 * shear, lame, 0.0], [lame, lame + 2.0 * shear, 0.0],
                    [0.0, 0.0, shear]])
    strain = np.zeros((3, 8))
    strain[0, 0::2], strain[1, 1::2] = bx, by
    strain[2, 0::2], strain[2, 1::2] = by, bx
    gamma = SIGNS - (bx * (SIGNS @ x[:, 0]) + by * (SIGNS @ x[:, 1])) / area
    amplitude = 0.25 * hourglass * (lame + 2.0 * shear) * (bx @ bx + by @ by) / area * np.eye(2)
    if assumed:
        amplitude = hourglass * assumed_amplitude(x, young, poisson)
    stiffness = strain.T @ law @ strain / area + np.kron(np.outer(gamma, gamma), amplitude)
    return stiffness, area


def assumed_amplitude(x, young, poisson):
    """Hourglass force over gamma.u (2, 2) of the optimal bending field: the energy of the strains
    (a_x q_x - n a_y q_y, a_y q_y - n a_x q_x), n = nu/(1 - nu), a the gradient of xi eta in the frame of the
    polar decomposition, q = gamma.u/4, over the parallelogram of the mean Jacobian."""
    jacobian = 0.25 * np.array([[-1, 1, 1, -1], [-1, -1, 1, 1]]) @ x
    left, _, right = np.linalg.svd(jacobian.T)
    frame = left @ right
    lateral = poisson / (1.0 - poisson)
    law = young / ((1.0 + poisson) * (1.0 - 2.0 * poisson)) * np.array(
        [[1.0 - poisson, poisson], [poisson, 1.0 - poisson]])
    amplitude = np.zeros((2, 2))
    for xi in (-np.sqrt(1 / 3), np.sqrt(1 / 3)):
        for eta in (-np.sqrt(1 / 3), np.sqrt(1 / 3)):
            slope = frame.T @ np.linalg.solve(jacobian, (eta, xi))
            strain = np.array([[slope[0], -lateral * slope[1]], [-lateral * slope[0], slope[1]]])
            amplitude += np.linalg.det(jacobian) * strain.T @ law @ strain
    return frame @ amplitude @ frame.T / 16.0


class Model:
    """Grids (`decks.Grid`) of elastic quads; materials one for all, or one per grid."""

    def __init__(self, grids, young, poisson, rho, hourglass):
        count = len(grids)
        materials = [np.broadcast_to(value, count) for value in (young, poisson, rho)]
        self.row = {}
        places = []
        for grid in grids:
            for node, place in zip(grid.node.ravel(), grid.points.reshape(-1, 2)):
                self.row[int(node)] = len(places)
                places.append(place)
        self.x = np.array(places)
        n = len(places)
        self.stiffness, self.mass = np.zeros((2 * n, 2 * n)), np.zeros(n)
        self.free = np.ones(2 * n, dtype=bool)
        for k, grid in enumerate(grids):
            for corners in grid.quads.reshape(-1, 4):
                rows = self.rows(corners)
                stiffness, area = quad_stiffness(self.x[rows], materials[0][k], materials[1][k],
                                                 hourglass)
                both = np.stack([2 * rows, 2 * rows + 1], axis=1).ravel()
                self.stiffness[np.ix_(both, both)] += stiffness
                self.mass[rows] += 0.25 * materials[2][k] * area

    def rows(self, nodes):
        """Rows of deck nodes."""
        return np.array([self.row[int(node)] for node in np.ravel(nodes)])

    def fix(self, nodes, direction):
        """u = 0, or prescribed, in x (0) or y (1)."""
        self.free[2 * self.rows(nodes) + direction] = False

    def limit(self, springs, with_elements=True):
        """2/omega_max with springs (n, n) between displacements in y; of the springs alone if asked."""
        stiffness = self.stiffness * float(with_elements)
        stiffness[1::2, 1::2] += springs
        root = 1.0 / np.sqrt(np.repeat(self.mass, 2)[self.free])
        scaled = root[:, None] * stiffness[np.ix_(self.free, self.free)] * root
        if np.allclose(scaled, scaled.T, rtol=0.0, atol=1e-12 * np.abs(scaled).max()):
            largest = np.linalg.eigvalsh(scaled)[-1]
        else:  # VTS-PPT takes gaps at one place and gives forces to others
            largest = np.linalg.eigvals(scaled).real.max()
        return 2.0 / np.sqrt(largest)
