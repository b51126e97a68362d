#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""One-dimensional chain of masses and springs for the block-to-block scene (numpy only).

Where the contact pressure is uniform, every column of the two blocks moves alike: 2 + 2 layers,
each a spring, between masses per unit width, and one penalty spring at the interface, which pushes
by the gap at the start of a step or (`ahead`, PUNIT 4) at its end. As a script it prints the pressure of each step: `chain.py PENALTY...`, with PENALTY in N/m^2.
"""
import dataclasses
import sys

import numpy as np


@dataclasses.dataclass(frozen=True)
class Blocks:
    """The scene per unit width and depth, SI units."""

    young: float = 1.0e6
    density: float = 1000.0
    layers: int = 2                    # of each block
    height: float = 0.5                # of each block
    velocity: float = -0.05            # of the upper face
    step: float = 1.0e-3
    steps: int = 200
    penalty: float = 1.0e6 / (10.0 / 51.0)  # PEN over the mean slave segment, N/m^2
    ahead: bool = False                # by the gap of the end of the step; `penalty` may be infinite


@dataclasses.dataclass
class Chain:
    """Histories at the whole steps: time (n), and per body (lower, upper) from below."""

    time: np.ndarray
    pressure: np.ndarray        # (n)
    displacement: np.ndarray    # (n, 2, layers + 1)
    stress: np.ndarray          # (n, 2, layers), tension positive


def solve(blocks=Blocks()):
    """Central differences: v at half steps, the first of them half a step long."""
    thickness = blocks.height / blocks.layers
    mass = np.full((2, blocks.layers + 1), blocks.density * thickness)
    mass[:, [0, -1]] *= 0.5
    displacement = np.zeros_like(mass)
    deviatoric_strain = np.zeros((2, blocks.layers))
    velocity = np.zeros_like(mass)
    history = []
    for n in range(blocks.steps + 1):
        stress = uniaxial_stress(blocks.young, np.diff(displacement) / thickness,
                                 deviatoric_strain)
        share = 0.5 if n == 0 else 1.0
        velocity[:, :-1] += share * blocks.step * stress / mass[:, :-1]
        velocity[:, 1:] -= share * blocks.step * stress / mass[:, 1:]
        overlap = displacement[0, -1] - displacement[1, 0]
        if blocks.ahead:
            moved = overlap + blocks.step * (velocity[0, -1] - velocity[1, 0])
            closes = share * blocks.step ** 2 * (1.0 / mass[0, -1] + 1.0 / mass[1, 0])
            pressure = max(0.0, moved) / (1.0 / blocks.penalty + closes)
        else:
            pressure = blocks.penalty * max(0.0, overlap)
        history.append((n * blocks.step, pressure, displacement.copy(), stress))
        velocity[1, 0] += share * blocks.step * pressure / mass[1, 0]
        velocity[0, -1] -= share * blocks.step * pressure / mass[0, -1]
        velocity[0, 0] = 0.0
        velocity[1, -1] = blocks.velocity
        before = np.diff(displacement)
        displacement = displacement + blocks.step * velocity
        after = np.diff(displacement)
        # dt D_yy of the velocity over the layer half a step ago.
        deviatoric_strain = deviatoric_strain \
            + (after - before) / (thickness + 0.5 * (after + before))
    return Chain(*(np.array(column) for column in zip(*history)))


def uniaxial_stress(young, stretch, deviatoric_strain):
    """Stress along the chain at nu = 0, where K = E/3 and G = E/2.

    sigma_yy = K ln J + 2 G (D_yy - D_yy/3 summed over the steps), J = 1 + stretch.
    """
    return young / 3.0 * np.log1p(stretch) + 2.0 / 3.0 * young * deviatoric_strain


def main(penalties):
    print("penalty,time,pressure")
    for penalty in map(float, penalties):
        chain = solve(Blocks(penalty=penalty))
        for time, pressure in zip(chain.time, chain.pressure):
            print(f"{penalty:.17g},{time:.17g},{pressure:.17g}")


if __name__ == "__main__":
    main(sys.argv[1:])
