# SPDX-License-Identifier: MIT
"""The chain of block_to_block/chain.py integrated by the generalised-alpha method (numpy only).

Consistent masses `rho h/6 [[2, 1], [1, 2]]` of each layer, the same springs and the same penalty
spring; each step solved to round-off by Newton's method with a stiffness of its own.
"""
import dataclasses

import numpy as np

from chain import Blocks, Chain, uniaxial_stress


@dataclasses.dataclass(frozen=True)
class Scheme:
    """Chung & Hulbert (1993), eqs. 17, 20 and 25."""

    radius: float = 0.8

    @property
    def alpha_m(self):
        return (2.0 * self.radius - 1.0) / (self.radius + 1.0)

    @property
    def alpha_f(self):
        return self.radius / (self.radius + 1.0)

    @property
    def gamma(self):
        return 0.5 - self.alpha_m + self.alpha_f

    @property
    def beta(self):
        return 0.25 * (1.0 - self.alpha_m + self.alpha_f) ** 2


class Column:
    """Both bodies of the chain; nodes numbered from below: 0 .. layers, layers + 1 .. 2 layers + 1."""

    def __init__(self, blocks):
        self.blocks = blocks
        self.thickness = blocks.height / blocks.layers
        first = blocks.layers + 1
        self.springs = [(body * first + k, body * first + k + 1)
                        for body in range(2) for k in range(blocks.layers)]
        self.below, self.above = np.array(self.springs).T
        self.size = 2 * first
        self.top, self.face = first - 1, first      # of the lower body, of the upper one
        self.mass = np.zeros((self.size, self.size))
        for pair in self.springs:
            self.mass[np.ix_(pair, pair)] += blocks.density * self.thickness / 6.0 \
                * np.array([[2.0, 1.0], [1.0, 2.0]])

    def respond(self, u, u_old, strain_old):
        """Force on the body (internal minus contact), stiffness, stress, strain, pressure."""
        before, after = (x[self.above] - x[self.below] for x in (u_old, u))
        middle = self.thickness + 0.5 * (before + after)
        strain = strain_old + (after - before) / middle
        stress = uniaxial_stress(self.blocks.young, after / self.thickness, strain)
        slope = self.blocks.young * (1.0 / 3.0 / (self.thickness + after)
                                     + 2.0 / 3.0 * (self.thickness + before) / middle ** 2)
        pressure = self.blocks.penalty * max(0.0, u[self.top] - u[self.face])
        force, stiffness = np.zeros(self.size), np.zeros((self.size, self.size))
        for (a, b), s, k in zip(self.springs, stress, slope):
            force[[a, b]] += (-s, s)
            stiffness[np.ix_((a, b), (a, b))] += k * np.array([[1.0, -1.0], [-1.0, 1.0]])
        force[[self.top, self.face]] += (pressure, -pressure)
        if u[self.top] >= u[self.face]:
            both = (self.top, self.face)
            stiffness[np.ix_(both, both)] += self.blocks.penalty * np.array([[1.0, -1.0],
                                                                            [-1.0, 1.0]])
        return force, stiffness, stress, strain, pressure


def solve(blocks=Blocks(), scheme=Scheme()):
    """Histories of the chain; the face moves from the start, everything else rests."""
    column = Column(blocks)
    free = np.arange(1, column.size - 1)
    dt, beta, gamma = blocks.step, scheme.beta, scheme.gamma
    u, v, a = (np.zeros(column.size) for _ in range(3))
    v[-1] = blocks.velocity
    strain = np.zeros(2 * blocks.layers)
    old_force, _, stress, _, pressure = column.respond(u, u, strain)
    history = []
    for n in range(blocks.steps + 1):
        history.append((n * dt, pressure, u.reshape(2, -1).copy(), stress.reshape(2, -1)))
        new = u.copy()
        new[-1] = blocks.velocity * dt * (n + 1)
        for iteration in range(50):
            force, stiffness, stress, new_strain, pressure = column.respond(new, u, strain)
            new_a = (new - u - dt * v) / (beta * dt ** 2) - (0.5 / beta - 1.0) * a
            residual = column.mass @ ((1.0 - scheme.alpha_m) * new_a + scheme.alpha_m * a) \
                + (1.0 - scheme.alpha_f) * force + scheme.alpha_f * old_force
            tangent = (1.0 - scheme.alpha_m) / (beta * dt ** 2) * column.mass \
                + (1.0 - scheme.alpha_f) * stiffness
            change = np.linalg.solve(tangent[np.ix_(free, free)], -residual[free])
            new[free] += change
            if iteration > 2 and np.max(np.abs(change)) <= 1e-15 * np.max(np.abs(new)):
                break
        else:
            raise RuntimeError(f"step {n + 1} of the chain does not converge")
        force, _, stress, new_strain, pressure = column.respond(new, u, strain)
        new_a = (new - u - dt * v) / (beta * dt ** 2) - (0.5 / beta - 1.0) * a
        v = v + dt * ((1.0 - gamma) * a + gamma * new_a)
        u, a, strain, old_force = new, new_a, new_strain, force
    return Chain(*(np.array(entry) for entry in zip(*history)))
