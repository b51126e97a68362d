# SPDX-License-Identifier: MIT
"""Partial slip of a line contact: Cattaneo (1938) and Mindlin (1949), on the way back Mindlin and Deresiewicz (1953)."""
import numpy as np

FRICTION = 0.3
#: A node slips where its traction comes to this share of mu p.
SLIPS = 0.9


def ellipse(x):
    return np.sqrt(np.maximum(0.0, 1.0 - x ** 2))


class Look:
    """Tractions of the slave nodes at one time, from left to right, and the answer for the forces that they make."""

    def __init__(self, result, slave, time, radius, modulus, most=None):
        """`modulus`: E*; `most`: the Look at the farthest way where the motion goes back."""
        rows = result.table("contact")
        times = np.unique(rows["time"])
        now = rows.where(time=times[np.argmin(np.abs(times - time))])
        chosen = np.flatnonzero(np.isin(now["node"], slave))
        chosen = chosen[np.argsort(now["x"][chosen])]
        x, self.pressure, traction, self.length = (now[key][chosen] for key in ("x", "pressure", "traction", "length"))
        load, shear = np.sum(self.pressure * self.length), np.sum(traction * self.length)
        self.sign = np.sign(shear) if most is None else most.sign
        self.x, self.traction = x - np.sum(x * self.pressure * self.length) / load, self.sign * traction
        self.share = self.sign * shear / (FRICTION * load)
        self.a = np.sqrt(4.0 * load * radius / (np.pi * modulus))
        self.limit = FRICTION * 2.0 * load / (np.pi * self.a)
        self.way = 1.0 if most is None else -1.0
        self.exact, self.c = self.slip(self.share) if most is None else self.slip(0.5 * (most.share - self.share))
        if most is not None:
            self.exact = self.slip(most.share)[0] - 2.0 * self.exact

    def slip(self, share):
        """Traction and half width of the stick zone after `share` of mu P has come."""
        c = self.a * np.sqrt(1.0 - share)
        return self.limit * (ellipse(self.x / self.a) - c / self.a * ellipse(self.x / c)), c

    def cell(self):
        return np.median(self.length)

    def edges(self):
        """How far outside of c, going out from the middle, the traction comes to SLIPS mu p, in slave segments."""
        ratio = self.way * self.traction / np.maximum(FRICTION * self.pressure, 1e-30)
        found, middle = [], np.argmin(np.abs(self.x))
        for way in (-1, 1):
            node = middle
            while ratio[node] < SLIPS:
                node += way
            before = node - way
            share = (SLIPS - ratio[before]) / (ratio[node] - ratio[before])
            found.append(abs(self.x[before] + share * (self.x[node] - self.x[before])))
        return (np.array(found) - self.c) / self.cell()

    def error(self):
        """L2 of the traction."""
        return np.sqrt(np.sum((self.traction - self.exact) ** 2 * self.length) / np.sum(self.exact ** 2 * self.length))


def looks(result, slave, times, radius, modulus):
    """A Look at each time; the motion goes back to the last one."""
    found = [Look(result, slave, time, radius, modulus) for time in times[:-1]]
    return [*found, Look(result, slave, times[-1], radius, modulus, found[-1])]
