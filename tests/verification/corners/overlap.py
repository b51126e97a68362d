# SPDX-License-Identifier: MIT
"""Area that bodies share: the sum over their triangles, clipped against each other."""
import numpy as np


def triangles_of(places, quads):
    """Corners (triangle, 3, 2) of the quads, cut along the diagonal that leaves the larger smaller half."""
    corner = places[np.asarray(quads)]
    ways = [corner[:, [[0, 1, 2], [0, 2, 3]]], corner[:, [[0, 1, 3], [1, 2, 3]]]]
    least = [signed_area(way).min(axis=1) for way in ways]
    cut = np.where((least[0] >= least[1])[:, None, None, None], *ways).reshape(-1, 3, 2)
    return cut[signed_area(cut) > 0.0]


def signed_area(triangle):
    a, b = triangle[..., 1, :] - triangle[..., 0, :], triangle[..., 2, :] - triangle[..., 0, :]
    return 0.5 * (a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def clipped_sum(edged, other):
    """Half the sum of p x q over the parts, from p to q, of the sides of `edged` that lie in `other`."""
    total = 0.0
    for k in range(3):
        p, way = edged[:, k], edged[:, (k + 1) % 3] - edged[:, k]
        enter, leave = np.zeros(len(p)), np.ones(len(p))
        for j in range(3):
            a, side = other[:, j], other[:, (j + 1) % 3] - other[:, j]
            inside = side[:, 0] * (p - a)[:, 1] - side[:, 1] * (p - a)[:, 0]
            rate = side[:, 0] * way[:, 1] - side[:, 1] * way[:, 0]
            crossing = -inside / np.where(rate == 0.0, 1.0, rate)
            enter = np.where(rate > 0.0, np.maximum(enter, crossing), enter)
            leave = np.where(rate < 0.0, np.minimum(leave, crossing), leave)
            leave = np.where((rate == 0.0) & (inside < 0.0), -1.0, leave)
        from_p, to_p = p + enter[:, None] * way, p + leave[:, None] * way
        cross = from_p[:, 0] * to_p[:, 1] - from_p[:, 1] * to_p[:, 0]
        total += 0.5 * np.sum(cross[leave > enter])
    return total


def shared_area(one, two):
    """Area in common of two sets of triangles, those of a set not lying on each other: by Green's formula along
    the sides of either that lie in the other."""
    origin = one.mean(axis=(0, 1))
    one, two = one - origin, two - origin
    low, high = one.min(axis=1)[:, None], one.max(axis=1)[:, None]
    near = np.all((low < two.max(axis=1)) & (high > two.min(axis=1)), axis=2)
    i, j = np.nonzero(near)
    return clipped_sum(one[i], two[j]) + clipped_sum(two[j], one[i])


def overlap_area(places, bodies):
    """Largest area that two of the bodies share, over the area of the smaller one. `places`: (node, 2) of all bodies
    one after the other; `bodies`: (coordinates, quads, ...) of each."""
    sets, first = [], 0
    for coordinates, quads, *_ in bodies:
        sets.append(triangles_of(places[first:first + len(coordinates)], quads))
        first += len(coordinates)
    area = [signed_area(body).sum() for body in sets]
    return max(shared_area(sets[a], sets[b]) / min(area[a], area[b])
               for a in range(len(sets)) for b in range(a + 1, len(sets)))
