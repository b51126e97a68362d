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


def consistent_forces(x, pressure):
    """Half of each neighbouring segment of a chain (body on the left), normal to it inwards."""
    half = 0.5 * pressure * np.diff(x, axis=0)[:, ::-1] * [-1.0, 1.0]
    total = np.zeros_like(x)
    total[:-1] += half
    total[1:] += half
    return total
