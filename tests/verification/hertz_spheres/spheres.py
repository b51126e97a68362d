# SPDX-License-Identifier: MIT
"""Hertz contact of spheres: closed forms, contact through a layer of springs, nodal pressures measured."""
import dataclasses

import numpy as np

CELLS, REACH, INSIDE = 120, 1.3, 0.8


def hertz(force, radius, modulus):
    """(contact radius, largest pressure) for a whole force (Hertz 1881): a^3 = 3 F R/(4 E*), p0 = 3 F/(2 pi a^2)."""
    a = (0.75 * force * radius / modulus) ** (1.0 / 3.0)
    return a, 1.5 * force / (np.pi * a ** 2)


def impact(mass, radius, modulus, speed):
    """(contact time, largest approach, largest force) of two bodies with 1/m = sum 1/m_i, 1/R = sum 1/R_i."""
    approach = (15.0 * mass * speed ** 2 / (16.0 * np.sqrt(radius) * modulus)) ** 0.4
    # Time: 2 d/v times the integral of 1/sqrt(1 - x^2.5) over 0..1, with x = 1 - t^2.
    t = (np.arange(20000) + 0.5) / 20000
    integral = np.mean(2.0 * t / np.sqrt(1.0 - (1.0 - t * t) ** 2.5))
    return (2.0 * approach / speed * integral, approach,
            4.0 / 3.0 * modulus * np.sqrt(radius) * approach ** 1.5)


@dataclasses.dataclass
class Profile:
    """Force per radian, contact radius by the second moment of the nodal forces, the peak of the line
    p^2 = p0^2 - B r^2 through the nodes inside 0.8 a, and its standard error over it."""

    force: float
    radius: float
    peak: float
    scatter: float


def measure(r, share, pressure):
    """Profile of nodal pressures; `share` is the integral of r by the hat function of the node."""
    force = float(np.sum(share * pressure))
    a = float(np.sqrt(2.5 * np.sum(share * pressure * r ** 2) / force))
    inside = r <= INSIDE * a
    columns = np.stack([np.ones(inside.sum()), -r[inside] ** 2], axis=1)
    squares = pressure[inside] ** 2
    line = np.linalg.lstsq(columns, squares, rcond=None)[0]
    rest = np.sum((squares - columns @ line) ** 2) / max(inside.sum() - 2, 1)
    error = np.sqrt(rest * np.linalg.inv(columns.T @ columns)[0, 0])
    peak = float(np.sqrt(line[0]))
    return Profile(force, a, peak, float(0.5 * error / peak ** 2))


def ring(r, s):
    """Sink of a half space with E* = 1 at radius r under a unit pressure on the ring at s, per width:
    4 s K(m)/(pi (r + s)), m = 4 r s/(r + s)^2; K by the arithmetic-geometric mean."""
    a, b = np.ones_like(s), np.abs(r - s) / (r + s)
    for _ in range(12):
        a, b = 0.5 * (a + b), np.sqrt(a * b)
    return 2.0 * s / (a * (r + s))


def influence(edges):
    """Sink at the middles of cells under unit pressure on each cell; the logarithm is met by s = r + t^3."""
    t, weight = np.polynomial.legendre.leggauss(12)
    t, weight = 0.5 * (t + 1.0), 0.5 * weight
    low, high = edges[:-1], edges[1:]
    middle = 0.5 * (low + high)
    s = low[:, None] + (high - low)[:, None] * t
    matrix = np.sum(ring(middle[:, None, None], s) * weight, axis=2) * (high - low)
    for end in (low, high):
        s = middle[:, None] + (end - middle)[:, None] * t ** 3
        half = np.sum(ring(middle[:, None], s) * weight * 3.0 * t ** 2, axis=1) * np.abs(end - middle)
        if end is low:
            np.fill_diagonal(matrix, half)
        else:
            matrix[np.diag_indices(len(middle))] += half
    return matrix


def layer(softness):
    """(contact radius, peak, approach) over Hertz's for the same force, where a layer of springs k lies between:
    softness = E*/(k a). Solves sink + p/k = approach - r^2/2 in units of a, E* and R, p >= 0."""
    edges = np.linspace(0.0, REACH * (1.0 + 2.0 * softness) ** 0.25, CELLS + 1)
    middle = 0.5 * (edges[1:] + edges[:-1])
    area = 0.5 * (edges[1:] ** 2 - edges[:-1] ** 2)
    matrix = influence(edges) + softness * np.eye(CELLS)
    closed, wanted = middle < 1.0, 4.0 / 3.0 / (2.0 * np.pi)   # force per radian for a = 1
    for _ in range(100):
        index = np.flatnonzero(closed)
        system = np.zeros((len(index) + 1, len(index) + 1))
        system[:-1, :-1] = matrix[np.ix_(index, index)]
        system[:-1, -1], system[-1, :-1] = -1.0, area[index]
        solution = np.linalg.solve(system, np.append(-0.5 * middle[index] ** 2, wanted))
        pressure = np.zeros(CELLS)
        pressure[index] = solution[:-1]
        gap = matrix @ pressure - solution[-1] + 0.5 * middle ** 2
        renewed = np.where(closed, pressure > 0.0, gap < 0.0)
        if np.all(renewed == closed):
            break
        closed = renewed
    else:
        raise ArithmeticError("the contact on springs finds no edge")
    found = measure(middle, area, pressure)
    return found.radius, found.peak / (2.0 / np.pi), solution[-1]


def impact_on_springs(mass, radius, modulus, speed, stiffness):
    """(contact time, largest approach, largest force) of `impact` with a layer of springs N/m^3 between the bodies."""
    usual = impact(mass, radius, modulus, speed)
    force = usual[2] * np.linspace(0.0, 1.1, 111)[1:] ** 1.5
    a = hertz(force, radius, modulus)[0]
    softness = modulus / (stiffness * a)
    known = np.geomspace(softness[-1], softness[0], 14)
    ratio = np.exp(np.interp(np.log(softness), np.log(known), np.log([layer(one)[2] for one in known])))
    approach = np.concatenate([[0.0], a ** 2 / radius * ratio])
    force = np.concatenate([[0.0], force])
    step, x, v, deepest, n = usual[0] / 20000, 0.0, speed, 0.0, 0
    while x >= 0.0:
        deepest = max(deepest, x)
        v -= step * np.interp(x, approach, force) / mass
        x, n = x + step * v, n + 1
    return n * step, deepest, float(np.interp(deepest, approach, force))
