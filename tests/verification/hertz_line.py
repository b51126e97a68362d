# SPDX-License-Identifier: MIT
"""Hertz line contact: closed form, its change by a penalty, and what nodal pressures amount to."""
import dataclasses
import math

import numpy as np

INSIDE = 0.8
LAYER_CELLS, LAYER_REACH = 240, 1.6


def effective_modulus(*bodies):
    """E* in Pa of two bodies with `young` and `poisson`: 1/E* = sum of (1 - nu^2)/E."""
    return 1.0 / sum((1.0 - body["poisson"] ** 2) / body["young"] for body in bodies)


def hertz(force, radius, modulus):
    """(half width a, largest pressure p0) for a force F per depth (Hertz 1881).

    a^2 = 4 F R/(pi E*), p0 = 2 F/(pi a).
    """
    half_width = math.sqrt(4.0 * force * radius / (math.pi * modulus))
    return half_width, 2.0 * force / (math.pi * half_width)


def ellipse(x, half_width, peak):
    """Pressure p0 sqrt(1 - x^2/a^2), zero outside."""
    return peak * np.sqrt(np.clip(1.0 - (x / half_width) ** 2, 0.0, None))


@dataclasses.dataclass
class Profile:
    """A pressure distribution on the axis x.

    `force`      sum of pressure times length
    `half_width` a of the ellipse of the same second moment m2: 2 sqrt(m2/force)
    `peak`       p0 of the line p^2 = p0^2 - B x^2 through the points inside 0.8 a (least squares)
    `scatter`    standard error of that p0, by the distances of the points from the line
    """

    force: float
    half_width: float
    peak: float
    scatter: float = 0.0


def measure(x, length, pressure):
    """Profile of pressures at points that stand for a length each; middle of contact at x = 0."""
    share = pressure * length
    force = float(share.sum())
    half_width = 2.0 * math.sqrt(float(np.sum(share * x ** 2)) / force)
    inside = np.abs(x) <= INSIDE * half_width
    columns = np.stack([np.ones(inside.sum()), -x[inside] ** 2], axis=1)
    squares = pressure[inside] ** 2
    line = np.linalg.lstsq(columns, squares, rcond=None)[0]
    variance = np.sum((squares - columns @ line) ** 2) / max(inside.sum() - 2, 1)
    error = math.sqrt(variance * np.linalg.inv(columns.T @ columns)[0, 0])
    peak = math.sqrt(line[0])
    return Profile(force, half_width, peak, 0.5 * error / peak)


def deviation(x, pressure, half_width, peak):
    """Largest distance of the pressures from the ellipse inside 0.8 a, and anywhere, over p0."""
    away = np.abs(pressure - ellipse(x, half_width, peak)) / peak
    return float(away[np.abs(x) <= INSIDE * half_width].max()), float(away.max())


def layer_profile(softness):
    """Profile of Hertz contact through a layer of springs k [N/m^2], the penalty.

    `softness` = E*/(k a) with a of Hertz; the result is over a and p0 of Hertz. Solves
    p/k + (2/(pi E*)) int ln(1/|x - s|) p ds = const - x^2/(2R), p >= 0, with even cells and the
    force of Hertz, in units of a, E* and R.
    """
    reach = LAYER_REACH * (1.0 + softness) ** (1.0 / 3.0)  # springs alone: (3 pi softness/8)^(1/3)
    edges = np.linspace(-reach, reach, LAYER_CELLS + 1)
    x, cell = 0.5 * (edges[1:] + edges[:-1]), edges[1] - edges[0]
    away = x[:, None] - edges[None, :]
    primitive = away * np.log(np.abs(away)) - away
    matrix = (2.0 / np.pi) * (primitive[:, 1:] - primitive[:, :-1])
    matrix += softness * np.eye(LAYER_CELLS)
    closed = np.abs(x) < 1.0
    for _ in range(100):
        pressure, rise = pressed(matrix, x, cell, closed)
        gap = matrix @ pressure - rise + 0.5 * x ** 2
        renewed = np.where(closed, pressure > 0.0, gap < 0.0)
        if np.all(renewed == closed):
            break
        closed = renewed
    else:
        raise ArithmeticError("the contact on springs finds no edge")
    profile = measure(x, cell, pressure)
    return Profile(profile.force / (0.25 * np.pi), profile.half_width, profile.peak / 0.5)


def pressed(matrix, x, cell, closed):
    """Pressures (zero where not closed) and rigid approach for the force pi/4."""
    index = np.flatnonzero(closed)
    system = np.zeros((len(index) + 1, len(index) + 1))
    system[:-1, :-1] = matrix[np.ix_(index, index)]
    system[:-1, -1], system[-1, :-1] = -1.0, cell
    solution = np.linalg.solve(system, np.append(-0.5 * x[index] ** 2, 0.25 * np.pi))
    pressure = np.zeros(len(x))
    pressure[index] = solution[:-1]
    return pressure, solution[-1]


def layer_stiffness(ctype, penalty, slave_cell, master_cell):
    """Springs per area [N/m^2] of a penalty [N/m] per contact node.

    Both passes of type 3 add up.
    """
    return penalty / slave_cell + (penalty / master_cell if ctype == 3 else 0.0)
