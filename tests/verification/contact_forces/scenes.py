# SPDX-License-Identifier: MIT
"""Pairs of touching bodies for the comparison with the reference, and decks made of them."""
from dataclasses import dataclass

import numpy as np

from meshes import Deck
from reference import Chain, Rule, contact_forces

YOUNG, POISSON, RHO = 2.0e6, 0.3, 1000.0
DEPTH = 0.4  # of a body's row of quads
BUILT_IN = 0.1  # factor of the built-in penalty estimate
END = 1.0e-6


@dataclass
class Pair:
    """Nodes of the lower face of the upper body and of the upper face of the lower one, both from
    left to right, then the shift and turn of both together."""
    name: str
    slave: np.ndarray
    master: np.ndarray
    angle: float = 0.0
    shift: tuple = (0.0, 0.0)
    closed: bool = False  # the whole boundary of each body, through part sets

    def placed(self, line):
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.asarray(line) @ np.array([[c, s], [-s, c]]) + self.shift

    def bodies(self):
        """Two rows of nodes of each body, the lower one first."""
        up = np.array([0.0, DEPTH])
        return ([self.placed(self.slave), self.placed(self.slave + up)],
                [self.placed(self.master - up), self.placed(self.master)])


@dataclass
class Interface:
    """What is needed to evaluate one interface, and where its nodes are in the deck."""
    pair: Pair
    rule: Rule
    slave: np.ndarray   # rows of the deck's node list, in walking order
    master: np.ndarray
    estimate: float
    is_axisymmetric: bool = False

    def chains(self, initial, displacement=None):
        """Slave and master chain at time zero and now."""
        near = initial[self.slave[0]] * [0.0 if self.is_axisymmetric else 1.0, 1.0]
        start = [Chain(initial[side] - near, self.pair.closed, is_axisymmetric=self.is_axisymmetric)
                 for side in (self.slave, self.master)]
        moved = displacement if displacement is not None else np.zeros_like(initial)
        now = [Chain(chain.x + moved[side], self.pair.closed, thickness(chain) if self.pair.closed else None,
                     self.is_axisymmetric) for chain, side in zip(start, (self.slave, self.master))]
        return start, now

    def compare(self, initial, found, displacement=None, offsets=None):
        """Difference to the reference over the largest nodal force, that force, and the reference
        forces of slave and master nodes; found: forces of all nodes of the deck."""
        start, now = self.chains(initial, displacement)
        forces = contact_forces(self.rule, *now, start, self.estimate, offsets)
        size = max(np.max(np.abs(force)) for force in forces)
        error = max(np.max(np.abs(force - found[side]))
                    for force, side in zip(forces, (self.slave, self.master)))
        return error / size if size > 0.0 else error, size, forces


def thickness(chain):
    """Area over length of the quad behind each segment of a body of one row; both rows of nodes one
    after the other round the body."""
    x, n = chain.x, len(chain.x)
    diagonals = [x[[n - 2 - k, n - 1 - k]] - x[[k, k + 1]] for k in range(n // 2 - 1)]
    areas = np.array([0.5 * abs(a[0] * b[1] - a[1] * b[0]) for a, b in diagonals])
    return np.concatenate([areas, areas[-1:], areas[::-1], areas[:1]]) / chain.length


class Scene:
    """A deck with many pairs, each with its own bodies and interface."""

    def __init__(self, title, end=END, dt=None, is_axisymmetric=False):
        self.deck = Deck(title)
        self.deck.control(end, dt)
        self.is_axisymmetric = is_axisymmetric
        self.deck.add("*SECTION_SHELL", (1, 15 if is_axisymmetric else 13), (1.0,))
        self.deck.elastic(RHO, YOUNG, POISSON, 1)
        self.deck.output(plot=end)
        self.nodes = np.zeros((0, 2))
        self.interfaces = []
        self.n_part = 0
        self.n_set = 0

    def body(self, rows):
        """One row of quads between two lines of nodes; rows of the node list."""
        n = len(rows[0])
        self.n_part += 1
        quads = [(i, i + 1, n + i + 1, n + i) for i in range(n - 1)]
        self.deck.add("*PART", f"part {self.n_part}", (self.n_part, 1, 1))
        ids = self.deck.mesh(np.concatenate(rows), quads, self.n_part)
        self.nodes = np.concatenate([self.nodes, *rows])
        return (ids - 1).reshape(2, n)

    def bodies(self, pair):
        """Both bodies of a pair and their surfaces in walking order."""
        upper, lower = pair.bodies()
        above = self.body(upper)
        part_above = self.n_part
        below = self.body(lower)
        if pair.closed:
            chains = [np.concatenate([rows[0], rows[1][::-1]]) for rows in (above, below)]
            sets = part_above, self.n_part
        else:
            chains = above[0], below[1][::-1]
            sets = None
        return chains, sets

    def add(self, pair, rule, made=None):
        """An interface between new bodies, or between those already made."""
        chains, parts = made or self.bodies(pair)
        sets = []
        for side in (0, 1):
            self.n_set += 1
            if parts:
                self.deck.add("*SET_PART_LIST", (self.n_set,), (parts[side],))
            else:
                self.deck.node_set(self.n_set, chains[side] + 1)
            sets.append(self.n_set if parts else -self.n_set)
        self.deck.add("*CONTACT_2D_SLIDELINE", (*sets, rule.kind, rule.gauss, rule.penalty),
                      (0.0, 1.0e20, rule.unit, rule.back or None, 0.0, int(rule.strict)))
        self.interfaces.append(Interface(pair, rule, *chains, estimate(), self.is_axisymmetric))
        return chains, parts


def estimate():
    """0.1 K L / A; L / A = 1 / DEPTH for elements whose columns have one height."""
    return BUILT_IN * YOUNG / (3.0 * (1.0 - 2.0 * POISSON)) / DEPTH


SHAPES = ("flat", "kinked", "arc", "wavy", "rough")


def shape(name, rng):
    """A surface line y(x) over about 0 to 1 as a function; slopes below about 1.2."""
    a, b = rng.uniform(-1.0, 1.0, 2)
    if name == "flat":
        return lambda x: 0.3 * a * x
    if name == "kinked":
        corner = rng.uniform(0.3, 0.7)
        return lambda x: 0.6 * a * x + 0.5 * b * np.abs(x - corner)
    if name == "arc":
        centre = rng.uniform(0.3, 0.7)
        return lambda x: 0.5 * a * (x - centre) ** 2
    if name == "wavy":
        return lambda x: 0.08 * a * np.sin(7.0 * x + 3.0 * b)
    knots = np.linspace(-0.6, 1.6, 12)
    heights = 0.06 * rng.uniform(-1.0, 1.0, 12)
    return lambda x: np.interp(x, knots, heights)


def spaced(n, left, right, uneven, rng):
    """n segments over left to right, their lengths scattered by up to a factor of 1 + 2 uneven."""
    steps = 1.0 + uneven * rng.uniform(0.0, 2.0, n)
    return left + (right - left) * np.concatenate([[0.0], np.cumsum(steps) / steps.sum()])


def random_pair(rng, number, name=None, closed=False, far=0.0):
    """A slave line a little under (or over) the master's: facing it in full or in part.

    Closed chains are kept flat enough for the edges of the bodies to be sharp, and shallow.
    """
    name = name or SHAPES[rng.integers(len(SHAPES))]
    surface_line = shape(name, rng)
    flatten = 0.3 if closed else 1.0
    line = lambda x: flatten * surface_line(x)  # noqa: E731
    n_slave, n_master = rng.integers(1, 11, 2)
    uneven = rng.choice([0.0, 0.7])
    left, right = rng.uniform(-0.25, 0.25, 2) * rng.integers(0, 2, 2)
    x_master = spaced(n_master, 0.0, 1.0, uneven, rng)
    x_slave = spaced(n_slave, left, 1.0 + right, uneven, rng)
    y_master = line(x_master)
    surface = line(x_slave)
    if rng.integers(2) or closed:  # under the master's polygon rather than the line through it
        inside = np.clip(x_slave, 0.0, 1.0)
        surface = np.interp(inside, x_master, y_master) + line(x_slave) - line(inside)
    depth = 0.02 * flatten / max(n_slave, n_master) * rng.uniform(-0.5, 1.0, len(x_slave))
    if rng.integers(2):
        depth = np.full(len(x_slave), abs(depth[0]) + 1.0e-3 / max(n_slave, n_master))
    sides = (x_slave, surface - depth), (x_master, y_master)
    lines = (np.stack(side, axis=1) for side in sides)
    return Pair(f"{number} {name} {n_slave}/{n_master}", *lines, rng.uniform(-np.pi, np.pi),
                tuple(far * rng.uniform(-1.0, 1.0, 2)), closed)


def random_wedge(rng, number):
    """Closed outlines: a body with a corner of 40 to 150 degrees, sunk 0.002 into a flat or hollow one;
    either is the slave."""
    left, right = np.exp(rng.uniform(np.log(0.3), np.log(3.0), 2))
    apex = rng.uniform(0.35, 0.65)
    n, m = rng.integers(1, 5, 2)
    x = np.concatenate([spaced(n, 0.2, apex, 0.7, rng), spaced(m, apex, 0.8, 0.7, rng)[1:]])
    wide = spaced(rng.integers(2, 9), 0.0, 1.0, 0.7, rng)
    face = rng.uniform(-0.3, 0.3) * (wide - 0.5)
    if rng.integers(3) == 0:
        face = rng.uniform(0.2, 0.25) * np.abs(wide - 0.5)
    tip = np.interp(apex, wide, face) - 0.002
    y = tip + np.where(x < apex, left * (apex - x), right * (x - apex))
    wedge, plate = np.stack([x, y], axis=1), np.stack([wide, face], axis=1)
    is_slave = bool(rng.integers(2))
    sides = (wedge, plate) if is_slave else (plate * [1.0, -1.0], wedge * [1.0, -1.0])
    return Pair(f"{number} wedge, {'slave' if is_slave else 'master'}", *sides,
                rng.uniform(-np.pi, np.pi), closed=True)
