# SPDX-License-Identifier: MIT
"""Meshes of the contact patch tests: pairs of blocks with a flat or an inclined interface."""
import numpy as np

import static_patch

SLOPE = np.tan(np.radians(20.0))


def lines(n, skew=0.0):
    """n cells over 0 to 1; skew moves the inner lines alternately, the ends stay."""
    x = np.arange(n + 1) / n
    inner = np.arange(1, n)
    x[1:-1] += skew / n * np.where(inner % 2 == 1, 1.0, -0.6)
    return x


MESHES = {  # lines of slave and master, rows
    "3/2": (lines(3), lines(2), None),
    "5/4": (lines(5), lines(4), None),
    "7/5 non-uniform": (lines(7, 0.35), lines(5, -0.3), None),
    "slave segments over three and four master segments, 2/7": (lines(2), lines(7), None),
    "master finer, 4/7 non-uniform": (lines(4, 0.25), lines(7, 0.3), None),
    "51/50": (lines(51), lines(50), 2),
}


def inclined_block(x, bottom, top):
    """Columns at x between two lines y(x), with as many rows as columns."""
    n = len(x) - 1
    share = np.arange(n + 1) / n
    points = np.array([(a, (1.0 - t) * bottom(a) + t * top(a)) for t in share for a in x])
    return points, static_patch.block_grid(x, 0.0)[1]


def inclined_blocks(matching):
    """Columns, and upper and lower block, of an interface inclined by 20 degrees."""
    x_upper = lines(5, 0.2)
    x_lower = x_upper if matching else lines(4, -0.2)
    upper = inclined_block(x_upper, lambda x: SLOPE * x, lambda x: 1.0 + 0.0 * x)
    lower = inclined_block(x_lower, lambda x: -1.0 + 0.0 * x, lambda x: SLOPE * x)
    return x_upper, x_lower, upper, lower


def outer_chains(ids, n):
    """Bottom, right, top and left chain of a structured block, counter-clockwise."""
    rows = np.asarray(ids).reshape(n + 1, n + 1)
    return rows[0], rows[:, -1], rows[-1, ::-1], rows[::-1, 0]


def load_edges(deck, ids):
    """The load of curve 1 on the edges of a chain of nodes."""
    deck.add("*LOAD_SEGMENT", *[(1, 1.0, 0.0, a, b, b, b)
                                for a, b in zip(ids[:-1].tolist(), ids[1:].tolist())])


def inclined_patch(deck, ids, kind, penalty, load):
    """The inclined blocks under the load of curve 1 (its end value `load`) on every outer face: a hydrostatic state.
    `ids` of upper and lower block; returns slave and master."""
    upper, lower = ids
    n_lower = round(np.sqrt(len(lower))) - 1
    slave, *upper_faces = outer_chains(upper, 5)
    *lower_faces, left = outer_chains(lower, n_lower)
    master = lower_faces.pop()
    for chain in (*upper_faces, *lower_faces, left):
        load_edges(deck, chain)
    deck.node_set(1, slave).node_set(2, master).fix([lower[0]], x=1, y=1).fix([lower[n_lower]], y=1)
    # p / eps_hat, eps_hat = eps / mean segment; half of it in two passes (exact if meshes match).
    gap = load / (penalty * 5.0 * np.cos(np.arctan(SLOPE))) / (2.0 if kind == 3 else 1.0)
    # The top left corner's u_x in the hydrostatic state, so that the pin holds nothing.
    deck.prescribe(upper_faces[1][-1], 1, 2, 1, gap * np.sin(np.arctan(SLOPE)) / load)
    deck.contact(1, 2, kind, penalty, gauss=4)
    return slave, master


def edge_forces(x, stress):
    """Nodal forces of a uniform stress on the edges of a chain, the body on its left."""
    edge = np.diff(x, axis=0)
    half = 0.5 * np.stack([edge[:, 1], -edge[:, 0]], axis=1) @ stress
    total = np.zeros_like(x)
    total[:-1] += half
    total[1:] += half
    return total


def consistent_forces(x, pressure):
    """Half of each neighbouring segment of a chain (body on the left), normal to it inwards."""
    return edge_forces(x, -pressure * np.eye(2))


def block_forces(x, columns, stress, keep):
    """Nodal forces of a stress on the outer edges in `keep` of a structured block (0 bottom, 1 right, 2 top, 3 left)."""
    rows, total = np.arange(len(x)).reshape(-1, columns), np.zeros_like(x)
    chains = rows[0], rows[:, -1], rows[-1, ::-1], rows[::-1, 0]
    for k in keep:
        total[chains[k]] += edge_forces(x[chains[k]], stress)
    return total


def hat_loads(place, value):
    """Integrals of the hat functions of nodes at `place` with a function that is linear between its nodal values."""
    length, total = np.diff(place), np.zeros(len(place))
    total[:-1] += length * (2.0 * value[:-1] + value[1:]) / 6.0
    total[1:] += length * (value[:-1] + 2.0 * value[1:]) / 6.0
    return total


def ring_areas(x):
    """Integrals of r by the hat functions of the nodes of a chain."""
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(x, axis=0), axis=1))])
    return hat_loads(arc, x[:, 0])
