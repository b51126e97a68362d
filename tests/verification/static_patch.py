# SPDX-License-Identifier: MIT
"""Small-strain static solution of two pressed blocks with a flat interface, written independently.

One-point quads with the stiffness form of hourglass control, or full integration (nu = 0), penalty
contact as a sum of linear springs between means of nodal displacements; springs that would pull are
left out.
"""
import functools

import numpy as np

from contact_types import TYPES
from meshes import grid_quads, lumped_mass


class Blocks:
    """Two blocks, upper (slave) and lower (master), given by the x lines of their meshes."""

    def __init__(self, upper_lines, lower_lines, young, rows=None):
        """`rows`: rows of each block; as many as columns if None."""
        self.young = young
        self.lines = [np.asarray(upper_lines, float), np.asarray(lower_lines, float)]
        self.upper, self.upper_quads = block_grid(self.lines[0], 0.0, rows)
        self.lower, self.lower_quads = block_grid(self.lines[1], -1.0, rows)
        n = len(self.upper)
        self.x = np.vstack([self.upper, self.lower])
        self.quads = np.vstack([self.upper_quads, self.lower_quads + n])
        columns = [len(lines) for lines in self.lines]
        self.slave = np.arange(columns[0])
        self.master = len(self.x) - columns[1] + np.arange(columns[1])
        self.top = n - columns[0] + np.arange(columns[0])
        self.bottom = n + np.arange(columns[1])

    def lengths(self, side):
        """Competence lengths of the interface nodes of the slave (0) or master (1) side."""
        return hat_areas(self.lines[side])

    def fixed(self):
        """Degrees of freedom held: u_y at the bottom, u_x at one bottom and one top node."""
        middle = [self.bottom[len(self.bottom) // 2], self.top[len(self.top) // 2]]
        return np.unique(np.concatenate([2 * self.bottom + 1, 2 * np.array(middle)]))

    def put(self, deck, rho, *materials, points=None, shift=(0.0, 0.0)):
        """Both meshes as parts 1 (moved by `shift`) and 2, their (young, poisson) and the node sets 1 and 2 of the
        interface; returns the ids of all nodes, those of the upper block first."""
        for part, material in enumerate(materials, 1):
            deck.part(part, points=points).elastic(rho, *material, part)
        ids = np.concatenate([deck.mesh(self.upper + shift, self.upper_quads, part=1),
                              deck.mesh(self.lower, self.lower_quads, part=2)])
        deck.node_set(1, ids[self.slave]).node_set(2, ids[self.master][::-1])
        return ids

    def hang(self, deck, ids):
        """Hold what `fixed` names."""
        held = self.fixed()
        return deck.fix(ids[held[held % 2 == 0] // 2], x=1).fix(ids[held[held % 2 == 1] // 2], y=1)


def block_grid(lines, bottom, rows=None):
    """Unit block with columns at the lines."""
    n, m = len(lines) - 1, rows or len(lines) - 1
    y = bottom + np.arange(m + 1) / m
    points = np.array([(a, b) for b in y for a in lines])
    return points, np.array(grid_quads(n, m))


def hat_areas(x):
    """Integrals of the hat functions of the nodes x of a chain."""
    half = 0.5 * np.diff(x)
    return np.concatenate([half, [0.0]]) + np.concatenate([[0.0], half])


def hats(x, spots):
    """Values of the hat functions of nodes x at the spots, (spot, node)."""
    return np.stack([np.interp(spots, x, np.eye(len(x))[k]) for k in range(len(x))], axis=1)


def element_stiffness(x, young, hourglass):
    """Stiffness of one quad (8, 8), nu = 0."""
    b = 0.5 * np.array([[x[1, 1] - x[3, 1], x[2, 1] - x[0, 1], x[3, 1] - x[1, 1], x[0, 1] - x[2, 1]],
                        [x[3, 0] - x[1, 0], x[0, 0] - x[2, 0], x[1, 0] - x[3, 0], x[2, 0] - x[0, 0]]])
    area = b[0] @ x[:, 0]
    strain = np.zeros((3, 8))
    strain[0, 0::2] = strain[2, 1::2] = b[0] / area
    strain[1, 1::2] = strain[2, 0::2] = b[1] / area
    stiffness = area * strain.T @ np.diag([young, young, 0.5 * young]) @ strain
    h = np.array([1.0, -1.0, 1.0, -1.0])
    gamma = h - (b[0] * (h @ x[:, 0]) + b[1] * (h @ x[:, 1])) / area
    # K + 4G/3 = E at nu = 0
    factor = hourglass / 4.0 * young * np.sum(b ** 2) / area
    for axis in (0, 1):
        stiffness[axis::2, axis::2] += factor * np.outer(gamma, gamma)
    return stiffness


def full_stiffness(x, young):
    """Stiffness of one quad (8, 8) with 2 x 2 Gauss points, nu = 0."""
    total = np.zeros((8, 8))
    corner = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    for xi, eta in corner / np.sqrt(3.0):
        slope = 0.25 * np.stack([corner[:, 0] * (1.0 + corner[:, 1] * eta),
                                 corner[:, 1] * (1.0 + corner[:, 0] * xi)])
        jacobian = slope @ x
        b = np.linalg.solve(jacobian, slope)
        strain = np.zeros((3, 8))
        strain[0, 0::2] = strain[2, 1::2] = b[0]
        strain[1, 1::2] = strain[2, 0::2] = b[1]
        total += np.linalg.det(jacobian) * strain.T @ np.diag([young, young, 0.5 * young]) @ strain
    return total


@functools.lru_cache(maxsize=4)
def body_stiffness(blocks, hourglass):
    """`hourglass`: coefficient of the one-point quad; None for full integration."""
    total = np.zeros((2 * len(blocks.x), 2 * len(blocks.x)))
    for quad in blocks.quads:
        dofs = np.stack([2 * quad, 2 * quad + 1], axis=1).ravel()
        x = blocks.x[quad]
        total[np.ix_(dofs, dofs)] += (full_stiffness(x, blocks.young) if hourglass is None else
                                      element_stiffness(x, blocks.young, hourglass))
    return total


def springs(blocks, kind, penalty):
    """Rows (point, interface node) that give the gap, and stiffnesses, of types 1 to 3."""
    slave, master = blocks.lines
    ns, nm = len(slave), len(master)
    rows = np.hstack([np.eye(ns), -hats(master, slave)])
    if kind == 1:
        return rows, np.full(ns, penalty)
    stiffness = penalty * (ns - 1) * hat_areas(slave)  # eps / mean length, blocks 1 m wide
    if kind == 2:
        return rows, stiffness
    second = np.hstack([hats(slave, master), -np.eye(nm)])
    return (np.vstack([rows, second]),
            np.concatenate([stiffness, penalty * (nm - 1) * hat_areas(master)]))


def mortar_matrices(blocks, n_gauss):
    """Integrals N_I N_J and N_I N_master with Gauss points on whole slave segments."""
    slave, master = blocks.lines
    xi, weight = np.polynomial.legendre.leggauss(n_gauss)
    middle, half = 0.5 * (slave[1:] + slave[:-1]), 0.5 * np.diff(slave)
    spots = (middle[:, None] + half[:, None] * xi).ravel()
    weights = (half[:, None] * weight).ravel()
    own = hats(slave, spots)
    return (own.T * weights) @ own, (own.T * weights) @ hats(master, spots)


def contact_stiffness(blocks, kind, penalty, n_gauss, gaps):
    """Matrix that gives minus the forces on the interface nodes (slave, master) from their u_y."""
    if kind == 6:
        own, other = mortar_matrices(blocks, n_gauss)
        pressure = penalty * (len(blocks.slave) - 1) * np.hstack([own, -other])
        pressure /= own.sum(axis=1)[:, None]
        return np.vstack([own, -other.T]) @ pressure
    rows, stiffness = springs(blocks, kind, penalty)
    closed = np.ones(len(rows)) if gaps is None else rows @ gaps < 0.0
    return rows.T @ np.diag(stiffness * closed) @ rows


def solve(blocks, kind, penalty, load, n_gauss=4, hourglass=0.1):
    """Contact forces on slave and master nodes (upwards) under the pressure `load` on the top."""
    if kind not in (1, 2, 3, 6):
        raise ValueError(f"{TYPES[kind]} has no reference here")
    base = body_stiffness(blocks, hourglass)
    force = np.zeros(len(base))
    force[2 * blocks.top + 1] = -load * blocks.lengths(0)
    free = np.setdiff1d(np.arange(len(base)), blocks.fixed())
    interface = 2 * np.concatenate([blocks.slave, blocks.master]) + 1
    gaps = None
    for _ in range(20):
        contact = contact_stiffness(blocks, kind, penalty, n_gauss, gaps)
        total = base.copy()
        total[np.ix_(interface, interface)] += contact
        u = np.zeros(len(base))
        u[free] = np.linalg.solve(total[np.ix_(free, free)], force[free])
        if kind == 6 or (gaps is not None and np.array_equal(
                contact, contact_stiffness(blocks, kind, penalty, n_gauss, u[interface]))):
            break
        gaps = u[interface]
    nodal = -contact @ u[interface]
    return nodal[:len(blocks.slave)], nodal[len(blocks.slave):]


def frequencies(blocks, rho, penalty, hourglass=0.1):
    """Lowest and highest angular frequency with the springs of type 3 (the stiffest), and the highest
    of these springs alone."""
    total = body_stiffness(blocks, hourglass)
    interface = 2 * np.concatenate([blocks.slave, blocks.master]) + 1
    low, high, alone = total.copy(), total.copy(), np.zeros_like(total)
    for matrix, kind in ((low, 2), (high, 3), (alone, 3)):
        matrix[np.ix_(interface, interface)] += contact_stiffness(blocks, kind, penalty, 0, None)
    mass = lumped_mass(blocks.x, blocks.quads, rho)
    root = np.repeat(np.sqrt(mass), 2)
    free = np.setdiff1d(np.arange(len(total)), blocks.fixed())
    scaled = [np.linalg.eigvalsh((matrix / np.outer(root, root))[np.ix_(free, free)])
              for matrix in (low, high, alone)]
    return np.sqrt(scaled[0][0]), np.sqrt(scaled[1][-1]), np.sqrt(scaled[2][-1])
