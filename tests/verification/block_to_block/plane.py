# SPDX-License-Identifier: MIT
"""The block-to-block scene linearised about its initial shape (numpy, dense matrices).

Small displacements, so answers are good to the strain, about 1 %. It says how the pressure of
the types 1, 2, 3 and 6 departs from uniform, given where and how strongly they press.
"""
import numpy as np

H = np.array([1.0, -1.0, 1.0, -1.0])
CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


class Body:
    """n x layers rectangles over [0, width]; nodes row by row from below, (x, y) of each."""

    def __init__(self, n, width, blocks):
        self.n, self.layers = n, blocks.layers
        self.x = np.linspace(0.0, width, n + 1)
        nodes = (n + 1) * (blocks.layers + 1)
        a, b = width / n, blocks.height / blocks.layers
        stiffness, damping = rectangle(a, b, blocks)
        self.mass = np.zeros(2 * nodes)
        self.stiffness = np.zeros((2 * nodes, 2 * nodes))
        self.damping = np.zeros_like(self.stiffness)
        for j in range(blocks.layers):
            for i in range(n):
                first = j * (n + 1) + i
                corners = np.array([first, first + 1, first + n + 2, first + n + 1])
                dofs = np.stack([2 * corners, 2 * corners + 1], axis=1).ravel()
                self.mass[dofs] += blocks.density * a * b / 4.0
                self.stiffness[np.ix_(dofs, dofs)] += stiffness
                self.damping[np.ix_(dofs, dofs)] += damping
        self.u, self.v = np.zeros(2 * nodes), np.zeros(2 * nodes)

    def row(self, j):
        """y freedoms of a row of nodes, from left to right."""
        return 2 * (j * (self.n + 1) + np.arange(self.n + 1)) + 1

    def move(self, force, fraction, step, row, speed):
        """One leap under these external forces; the nodes of `row` keep their speed in y."""
        force = force - self.stiffness @ self.u - self.damping @ self.v
        self.v += fraction * step * force / self.mass
        self.v[self.row(row)] = speed
        self.u += step * self.v


def rectangle(a, b, blocks, hourglass=0.1):
    """Stiffness and viscous hourglass damping of an a x b rectangle with one point, nu = 0.

    gamma = h on a rectangle; f = (Q rho c sqrt(A)/4) gamma (gamma . v), c = sqrt(E/rho).
    """
    shape = CORNERS / (2.0 * np.array([a, b]))
    strain = np.zeros((3, 8))
    strain[0, 0::2] = strain[2, 1::2] = shape[:, 0]
    strain[1, 1::2] = strain[2, 0::2] = shape[:, 1]
    law = blocks.young * np.diag([1.0, 1.0, 0.5])
    viscosity = 0.25 * hourglass * np.sqrt(blocks.density * blocks.young * a * b)
    return a * b * strain.T @ law @ strain, viscosity * np.kron(np.outer(H, H), np.eye(2))


def hats(nodes, x):
    """Values of the piecewise linear functions of a chain at abscissae x: (x, node)."""
    return np.stack([np.interp(x, nodes, row) for row in np.eye(len(nodes))], axis=1)


def lumped(nodes):
    """Half of the neighbouring segments."""
    length = np.diff(nodes)
    return 0.5 * (np.append(length, 0.0) + np.append(0.0, length))


def node_springs(kind, slave, master, penalty):
    """Points of types 1 to 3: slave weights, master weights, springs in N/m."""
    per_length = penalty / np.diff(slave).mean()
    points = [np.eye(len(slave)), hats(master, slave),
              np.full(len(slave), penalty) if kind == 1 else per_length * lumped(slave)]
    if kind == 3:
        back = [hats(slave, master), np.eye(len(master)),
                penalty / np.diff(master).mean() * lumped(master)]
        points = [np.concatenate(pair) for pair in zip(points, back)]
    return points


def node_forces(kind, slave, master, penalty):
    """Types 1 to 3: u_slave, u_master -> forces on both, f = -k g n at each point."""
    of_slave, of_master, spring = node_springs(kind, slave, master, penalty)

    def forces(u_slave, u_master):
        push = spring * np.maximum(0.0, of_master @ u_master - of_slave @ u_slave)
        return of_slave.T @ push, -of_master.T @ push
    return forces


def mortar_forces(n_gauss, slave, master, penalty):
    """Type 6: averaged gap of each slave node, its pressure spread by the slave functions."""
    per_length = penalty / np.diff(slave).mean()
    place, weight = np.polynomial.legendre.leggauss(n_gauss)
    middle, half = 0.5 * (slave[1:] + slave[:-1]), 0.5 * np.diff(slave)
    x = (middle[:, None] + half[:, None] * place).ravel()
    weight = (half[:, None] * weight).ravel()
    of_slave, of_master = hats(slave, x), hats(master, x)
    area = of_slave.T @ weight

    def forces(u_slave, u_master):
        depth = of_slave.T @ (weight * (of_master @ u_master - of_slave @ u_slave)) / area
        push = weight * (of_slave @ (per_length * np.maximum(0.0, depth)))
        return of_slave.T @ push, -of_master.T @ push
    return forces


def solve(kind, n_slave, n_master, width, penalty, blocks, n_gauss=4):
    """Pressure of slave and master nodes (left to right) at the end of the run."""
    upper, lower = Body(n_slave, width, blocks), Body(n_master, width, blocks)
    make = mortar_forces if kind == 6 else node_forces
    contact = make(n_gauss if kind == 6 else kind, upper.x, lower.x, penalty)
    face, top = upper.row(0), lower.row(blocks.layers)
    for n in range(blocks.steps + 1):
        on_upper, on_lower = np.zeros_like(upper.u), np.zeros_like(lower.u)
        on_upper[face], on_lower[top] = contact(upper.u[face], lower.u[top])
        fraction = 0.5 if n == 0 else 1.0
        upper.move(on_upper, fraction, blocks.step, blocks.layers, blocks.velocity)
        lower.move(on_lower, fraction, blocks.step, 0, 0.0)
    return on_upper[face] / lumped(upper.x), -on_lower[top] / lumped(lower.x)
