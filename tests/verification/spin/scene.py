# SPDX-License-Identifier: MIT
"""A free elastic block that spins and vibrates, and its energy from the motion alone."""
import numpy as np

from meshes import Deck, angular_momentum, grid, lumped_mass, moduli

RHO, YOUNG, POISSON = 1000.0, 1.0e7, 0.3
BULK, SHEAR, WAVE_MODULUS = moduli(YOUNG, POISSON)
SOUND = float(np.sqrt(WAVE_MODULUS / RHO))
WIDTH, HEIGHT, N_X, N_Y = 1.0, 0.4, 10, 4
OMEGA = 0.05 * SOUND / (0.5 * WIDTH)      # rim speed 0.05 c at x = 0.5
TURN = 2.0 * np.pi / OMEGA
BENDING = 0.15 * OMEGA                    # amplitude of v_y = BENDING cos(2 pi x)
VISCOUS_FORMS, STIFFNESS_FORMS, FULL = (1, 2, 3), (4, 5), "NIP 4"


def block_mesh(distorted):
    """The regular mesh, or that with its nodes moved by up to 0.3 of a cell, the outer ones along their side."""
    coordinates, quads = grid(N_X, N_Y, WIDTH, HEIGHT, (-0.5 * WIDTH, -0.5 * HEIGHT))
    if distorted:
        cell = np.array([WIDTH / N_X, HEIGHT / N_Y])
        shift = 0.3 * cell * np.random.default_rng(1).uniform(-1.0, 1.0, coordinates.shape)
        shift[np.isclose(np.abs(coordinates), (0.5 * WIDTH, 0.5 * HEIGHT))] = 0.0
        coordinates = coordinates + shift
    return coordinates, quads


def spin_deck(form, coefficient=0.1, scale=0.9, turns=10.0, distorted=False, constant=None, states=None,
              plastic=None, bulk_viscosity=None):
    """form: IHQ, or FULL for full integration; constant: a constant step, else TSSFAC `scale` rules; plastic:
    yield stress, tangent modulus and beta; bulk_viscosity: Q1 and Q2; states: turns between two of them."""
    coordinates, quads = block_mesh(distorted)
    deck = Deck("free spin")
    deck.control(turns * TURN, dt=constant, scale=scale)
    if form == FULL:
        deck.part(points=4)
    else:
        deck.hourglass(form, coefficient).part()
    if bulk_viscosity:
        deck.add("*CONTROL_BULK_VISCOSITY", bulk_viscosity)
    if plastic:
        deck.plastic(RHO, YOUNG, POISSON, *plastic)
    else:
        deck.elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(coordinates, quads)
    spin(deck, nodes, coordinates, 0.0, BENDING * np.cos(2.0 * np.pi * coordinates[:, 0]))
    return deck.output(plot=states * TURN if states else None, glstat=0.02 * TURN)


def spin(deck, nodes, coordinates, more_x, more_y):
    """Initial velocity: the spin about the origin, and more."""
    x, y = coordinates.T
    deck.add("*INITIAL_VELOCITY_NODE",
             *zip(nodes.tolist(), -OMEGA * y + more_x, OMEGA * x + more_y))


class Motion:
    """What the states of a run say, without the energies that the program books."""

    def __init__(self, result, distorted):
        self.start, quads = block_mesh(distorted)
        self.quads = np.asarray(quads)
        self.mass = lumped_mass(self.start, quads, RHO)
        self.position = self.start + result.points("displacement")[..., :2]
        self.velocity = result.points("velocity")[..., :2]
        self.stress = result.cells("stress")

    def diagonals(self, position):
        """d31, d42 and h.x of the quads."""
        x = position[..., self.quads, :]
        return (x[..., 2, :] - x[..., 0, :], x[..., 3, :] - x[..., 1, :],
                x[..., 0, :] - x[..., 1, :] + x[..., 2, :] - x[..., 3, :])

    def kinetic(self):
        return 0.5 * np.sum(self.mass[:, None] * self.velocity ** 2, axis=(1, 2))

    def angular_momentum(self):
        return angular_momentum(self.mass, self.position, self.velocity)

    def inertia(self):
        centre = np.average(self.position, axis=1, weights=self.mass)[:, None]
        return np.sum(self.mass[:, None] * (self.position - centre) ** 2, axis=(1, 2))

    def areas(self, position):
        a, b, _ = self.diagonals(position)
        return 0.5 * (a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])

    def strain_energy(self):
        """K (J ln J - J + 1) of the volume and s:s/(4G) of the stress, of one-point quads."""
        start, area = self.areas(self.start), self.areas(self.position)
        ratio = area / start
        volume = BULK * (ratio * np.log(ratio) - ratio + 1.0) * start
        xx, yy, zz, xy = np.moveaxis(self.stress[..., :4], -1, 0)
        mean = (xx + yy + zz) / 3.0
        square = (xx - mean) ** 2 + (yy - mean) ** 2 + (zz - mean) ** 2 + 2.0 * xy ** 2
        return np.sum(volume + square / (4.0 * SHEAR) * area, axis=-1)

    def pattern_energy(self, coefficient):
        """k e.e/2 of the stiffness form, with e = h.x - F (h.X), the pattern that the element's own mean
        deformation gradient F does not explain."""
        a, b, h = self.diagonals(self.position)
        a0, b0, h0 = self.diagonals(self.start)
        gradient = np.stack([a, b], -1) @ np.linalg.inv(np.stack([a0, b0], -1))
        strain = h - (gradient @ h0[..., None])[..., 0]
        stiffness = 0.125 * coefficient * WAVE_MODULUS * np.sum(a ** 2 + b ** 2, -1) \
            / self.areas(self.position)
        return np.sum(0.5 * stiffness * np.sum(strain ** 2, -1), axis=-1)
