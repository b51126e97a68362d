# SPDX-License-Identifier: MIT
"""Random smooth motions of the four corners of a quad."""
import numpy as np


def wave(rng, time, size):
    """A smooth function that starts at 0, of about the given size."""
    phase = rng.uniform(0.5, 1.5, 2) * np.pi * time[:, None] * [1.0, 2.5]
    return (np.sin(phase) * rng.uniform(0.4, 1.0, 2) * rng.choice([-1.0, 1.0], 2) * [0.7, 0.3]).sum(axis=1) * size


def exponential(half_difference, shear):
    """exp of the symmetric tensors (h q; q -h)."""
    size = np.hypot(half_difference, shear)
    share = np.where(size > 0.0, np.sinh(size) / np.where(size > 0.0, size, 1.0), 1.0)
    c = np.cosh(size)
    return np.stack([np.stack([c + share * half_difference, share * shear], -1),
                     np.stack([share * shear, c - share * half_difference], -1)], -2)


def first_shape(rng, is_axisymmetric):
    corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]) + rng.uniform(-0.12, 0.12, (4, 2))
    return corners + [3.0 if is_axisymmetric else 0.0, 0.0]


def general(seed, n_step, is_axisymmetric, stretch=0.25, volume=0.1, turn=1.0, pattern=0.03):
    """Stretch, shear, change of volume, rotation and a little of the hourglass pattern."""
    rng = np.random.default_rng(seed)
    first = first_shape(rng, is_axisymmetric)
    centre = first.mean(axis=0)
    time = np.linspace(0.0, 1.0, n_step + 1)
    motion = exponential(wave(rng, time, stretch), wave(rng, time, stretch))
    motion = motion * np.exp(0.5 * wave(rng, time, volume))[:, None, None]
    angle = wave(rng, time, turn)
    spin = np.stack([np.stack([np.cos(angle), -np.sin(angle)], -1),
                     np.stack([np.sin(angle), np.cos(angle)], -1)], -2)
    place = np.einsum("tij,tjk,ak->tai", spin, motion, first - centre) + centre
    drift = np.stack([wave(rng, time, 0.2), wave(rng, time, 0.2)], -1)
    hourglass = np.stack([wave(rng, time, pattern), wave(rng, time, pattern)], -1)
    sign = np.array([1.0, -1.0, 1.0, -1.0])
    history = place + drift[:, None, :] + sign[None, :, None] * hourglass[:, None, :]
    return history + first - history[0]


def homogeneous(seed, n_step, is_axisymmetric, stretch=0.25, volume=0.1):
    """The same F everywhere: in the plane any F, of an axisymmetric body r = a R, z = b Z + c R."""
    rng = np.random.default_rng(seed)
    if not is_axisymmetric:
        return general(seed, n_step, False, stretch, volume, pattern=0.0)
    first = first_shape(rng, True)
    time = np.linspace(0.0, 1.0, n_step + 1)
    hoop, axial, shear = wave(rng, time, 0.5 * stretch), wave(rng, time, stretch), wave(rng, time, stretch)
    axial = wave(rng, time, volume) - 2.0 * hoop + 0.3 * axial
    return np.stack([np.exp(hoop)[:, None] * first[:, 0],
                     np.exp(axial)[:, None] * first[:, 1] + shear[:, None] * first[:, 0]], -1)
