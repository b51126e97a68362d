# SPDX-License-Identifier: MIT
"""The common problem of the element step: a block that swings in its slowest longitudinal mode.

A square block, L = 1 m, of elastic quads without lateral contraction (nu = 0), held on its left side, free elsewhere,
starts with v_x = V sin(pi x / 2 L). For small motions u_x = V / w sin(w t) sin(pi x / 2 L), w = pi c / 2 L, c^2 = E / rho.
All programs take the same constant step, a fraction COURANT of the element's side over c.
Each run prints one line of JSON: what it is, ns per element and step, and the displacement at the free side, in V / w.
"""
import json
import math
import time

import numpy as np

LENGTH, RHO, YOUNG, V = 1.0, 7850.0, 210.0e9, 1.0e-3
C = math.sqrt(YOUNG / RHO)
OMEGA = 0.5 * math.pi * C / LENGTH
COURANT = 0.5


def step(columns):
    """Time step, s."""
    return COURANT * LENGTH / columns / C


def exact(columns, steps):
    """Displacement of the free side after so many steps, in V / w."""
    return math.sin(OMEGA * steps * step(columns))


def grid(columns):
    """Points (n, 2), column by column, and quads (m, 4) from 0, counter-clockwise."""
    line = np.linspace(0.0, LENGTH, columns + 1)
    points = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1).reshape(-1, 2)
    node = np.arange((columns + 1) ** 2).reshape(columns + 1, columns + 1)
    quads = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1)
    return points, quads.reshape(-1, 4)


def first_velocity(points):
    """v_x at the start."""
    return V * np.sin(0.5 * math.pi * points[:, 0] / LENGTH)


def timed(advance, steps):
    """Processor seconds of `steps` calls: the machine may be shared."""
    start = time.process_time()
    for _ in range(steps):
        advance()
    return time.process_time() - start


def report(program, element, columns, steps, seconds, free_side):
    """Print the line; `free_side` is the displacement there, m."""
    print(json.dumps({
        "program": program, "element": element, "elements": columns ** 2, "steps": steps,
        "ns": 1.0e9 * seconds / columns ** 2 / steps,
        "free_side": float(np.mean(free_side)) * OMEGA / V,
        "exact": exact(columns, steps)}), flush=True)
