# SPDX-License-Identifier: MIT
"""Contact springs of the seven types between two flat chains that touch everywhere.

Written from the description of the formulations (doc/theory/contact.md, section 5) for the largest
eigenvalue of a mesh: displacements along the common normal, slave nodes first, then master nodes.
"""
import numpy as np

QUARTERS = (0.25, 0.75)


class Pair:
    """Increasing coordinates of both chains along the interface."""

    def __init__(self, slave, master):
        self.slave, self.master = np.asarray(slave, dtype=float), np.asarray(master, dtype=float)
        self.n = len(self.slave) + len(self.master)

    def weights(self, x, side):
        """Row of shape functions of one side (0 slave, 1 master) at x; None beyond its ends."""
        chain = (self.slave, self.master)[side]
        slack = 1.0e-9 * (chain[-1] - chain[0])
        if not chain[0] - slack <= x <= chain[-1] + slack:
            return None
        k = min(max(int(np.searchsorted(chain, x)) - 1, 0), len(chain) - 2)
        share = (x - chain[k]) / (chain[k + 1] - chain[k])
        row = np.zeros(self.n)
        first = k + side * len(self.slave)
        row[first:first + 2] = 1.0 - share, share
        return row

    def gap(self, x):
        """Row that gives slave minus master at x; None where one side is missing."""
        slave, master = self.weights(x, 0), self.weights(x, 1)
        return None if slave is None or master is None else slave - master

    def pieces(self, left, right):
        """The stretch left to right cut at the master nodes, without what has no master."""
        left, right = max(left, self.master[0]), min(right, self.master[-1])
        inner = self.master[(self.master > left) & (self.master < right)]
        cuts = np.concatenate([[left], inner, [right]])
        return [(a, b) for a, b in zip(cuts[:-1], cuts[1:]) if b - a > 1.0e-12]


def competence(chain):
    """Half of the segments on either side of each node."""
    length = np.diff(chain)
    return 0.5 * (np.append(length, 0.0) + np.append(0.0, length))


def at_points(pair, places, weights):
    """Springs of these weights at these places."""
    stiffness = np.zeros((pair.n, pair.n))
    for x, weight in zip(places, weights):
        row = pair.gap(x)
        if row is not None:
            stiffness += weight * np.outer(row, row)
    return stiffness


def averaged(pair, points):
    """Pressure of slave nodes from averaged gaps; `points` = (x, weight)."""
    gaps = [(weight, pair.weights(x, 0), pair.gap(x)) for x, weight in points]
    gaps = [entry for entry in gaps if entry[2] is not None]
    stiffness = np.zeros((pair.n, pair.n))
    for node in range(len(pair.slave)):
        content = sum(weight * shape[node] for weight, shape, _ in gaps)
        if content > 1.0e-12:
            row = sum(weight * shape[node] * gap for weight, shape, gap in gaps)
            stiffness += np.outer(row, row) / content
    return stiffness


def gauss_points(stretches, count):
    """(x, weight) of Gauss points on each stretch."""
    at, weight = np.polynomial.legendre.leggauss(count)
    return [(0.5 * (a + b) + 0.5 * (b - a) * s, 0.5 * (b - a) * w)
            for a, b in stretches for s, w in zip(at, weight)]


def shared_out(pair):
    """Type 4: gaps at quarter points, their force shared out over the portions of the master."""
    stiffness = np.zeros((pair.n, pair.n))
    for left, right in zip(pair.slave[:-1], pair.slave[1:]):
        for quarter in QUARTERS:
            x, half = left + quarter * (right - left), 0.5 * (right - left)
            gap = pair.gap(x)
            if gap is None:
                continue
            portions = pair.pieces(x - 0.5 * half, x + 0.5 * half)
            total = sum(b - a for a, b in portions)
            force = pair.weights(x, 0) - sum((b - a) / total * pair.weights(0.5 * (a + b), 1)
                                             for a, b in portions)
            stiffness += half * np.outer(force, gap)
    return stiffness


def springs(ctype, slave, master, gauss=4):
    """Stiffness for a penalty of 1 N/m^2 (type 1: of the mean slave segment per node)."""
    pair = Pair(slave, master)
    segments = list(zip(pair.slave[:-1], pair.slave[1:]))
    if ctype == 1:
        return at_points(pair, pair.slave, np.full(len(slave), np.mean(np.diff(pair.slave))))
    if ctype == 4:
        return shared_out(pair)
    if ctype == 5:
        ends = [(x, 0.5 * (b - a)) for segment in segments for a, b in pair.pieces(*segment)
                for x in (a, b)]
        return at_points(pair, *zip(*ends))
    if ctype == 6:
        return averaged(pair, gauss_points(segments, gauss))
    if ctype == 7:
        return averaged(pair, gauss_points([piece for segment in segments
                                            for piece in pair.pieces(*segment)], 2))
    stiffness = at_points(pair, pair.slave, competence(pair.slave))
    if ctype == 3:
        stiffness += at_points(pair, pair.master, competence(pair.master))
    return stiffness
