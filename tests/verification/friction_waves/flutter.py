# SPDX-License-Identifier: MIT
"""Steady sliding flutters: growth rate and frequency against complex eigenvalues, on a thin plate and a thick one."""
import numpy as np

from contact_types import TYPES
from eigen import Model
from meshes import Deck
from slideline_tools.decks import Grid, spaced
from springs import springs

YOUNG, POISSON, RHO, HOURGLASS = 1.0e9, 0.3, 1000.0, 0.1
CELL, BLOCK_ROWS = 0.1, 3
BULK = YOUNG / (3.0 * (1.0 - 2.0 * POISSON))
PRESSURE, SPEED = 1.0e-5 * YOUNG, 1.0e-3
#: Time until the bodies rest on each other, s; the damping of that, 1/s; in how many times 1/rate it goes.
CALM, STRONG, FADE = 0.04, 4.0e3, 2.0
#: The kick, in the shape of the motion that grows, and where the fit ends: speeds over that of sliding.
KICK, LARGEST, FOLDS = 2.0e-4, 2.0e-2, 5.0
#: Of the shortest stable steps of elements and of contact springs.
SHARE = 0.5


class Scene:
    """A block of 10 x 3 squares led over a plate of `rows` rows of squares, whose bottom is held, at a steady speed.

    The linear model: all of the slave surface slips, T = mu p, so that springs S across make the forces -S u_y across
    and mu S u_y along the surface."""

    def __init__(self, kind, rows, ratio):
        """`ratio`: penalty over K L/A."""
        self.kind, self.penalty = kind, ratio * BULK / CELL
        self.lower = Grid(spaced((-0.147, 1.253, 14)), spaced((-CELL * rows, 0.0, rows)))
        self.upper = Grid(spaced((0.0, 1.0, 10)), spaced((0.0, CELL * BLOCK_ROWS, BLOCK_ROWS)), first_node=1001,
                          first_element=1001)
        self.model = Model([self.lower, self.upper], YOUNG, POISSON, RHO, HOURGLASS)
        for direction in (0, 1):
            self.model.fix(self.lower.lower, direction)
        self.model.fix(self.upper.upper, 0)
        slave, master = (self.model.rows(nodes) for nodes in (self.upper.lower, self.lower.upper[::-1]))
        both = np.concatenate([slave, master])
        self.springs = np.zeros((len(self.model.x),) * 2)
        self.springs[np.ix_(both, both)] = self.penalty * springs(kind, self.model.x[slave, 0], self.model.x[master, 0])
        none = np.zeros_like(self.springs)
        self.step = SHARE * min(self.model.limit(none), self.model.limit(self.springs, with_elements=False))
        self.mass = np.repeat(self.model.mass, 2)[self.model.free]

    def matrix(self, friction):
        """M^-1 (K + contact), (rad/s)^2."""
        stiffness = self.model.stiffness.copy()
        stiffness[1::2, 1::2] += self.springs
        stiffness[0::2, 1::2] -= friction * self.springs
        return stiffness[np.ix_(self.model.free, self.model.free)] / self.mass[:, None]

    def motion(self, friction):
        """Rate, 1/s, frequency, rad/s, of the motion that grows fastest in leap-frog, and its shape (node, 2)."""
        squares, shapes = np.linalg.eig(self.matrix(friction))
        half = 1.0 - 0.5 * squares.astype(complex) * self.step ** 2
        factor = np.array([half + root * np.sqrt(half ** 2 - 1.0) for root in (1.0, -1.0)])
        rates = np.log(np.abs(factor).max(axis=0)) / self.step
        fastest = int(np.argmax(rates))
        turn = np.abs(np.angle(factor[np.abs(factor[:, fastest]).argmax(), fastest])) / self.step
        shape = np.zeros(2 * len(self.model.x))
        found = shapes[:, fastest]
        shape[self.model.free] = np.real(found / found[np.abs(found).argmax()])
        return float(rates[fastest]), float(turn), shape.reshape(-1, 2)


def deck(scene, friction, shape, rate):
    """Mass damping brings steady sliding, fades out, then comes the kick. Returns the deck and the time of the kick."""
    fade = FADE / rate
    begin, end = CALM + fade, CALM + fade + FOLDS / rate
    text = Deck(f"sliding flutter, type {scene.kind}, mu {friction:g}").control(end, dt=scene.step).hourglass(4, HOURGLASS)
    for number, grid in ((1, scene.lower), (2, scene.upper)):
        text.part(number).elastic(RHO, YOUNG, POISSON, number)
        text.add("*NODE", *[(int(node), *place) for node, place in zip(grid.node.ravel(), grid.points.reshape(-1, 2))])
        text.add("*ELEMENT_SHELL", *[(int(element), number, *map(int, quad)) for element, quad
                                     in zip(grid.element.ravel(), grid.quads.reshape(-1, 4))])
    lower, upper = scene.lower, scene.upper
    text.fix(lower.lower, x=1, y=1)
    text.node_set(2, upper.node.ravel()).node_set(3, upper.lower).node_set(4, lower.upper).node_set(5, upper.upper)
    text.add("*INITIAL_VELOCITY", (2,), (SPEED, 0.0))
    text.curve(2, [(0.0, 1.0), (1.0e3, 1.0)]).add("*BOUNDARY_PRESCRIBED_MOTION_SET", (5, 1, 0, 2, SPEED))
    rise = np.linspace(0.0, 1.0, 201)
    soft = rise - np.sin(2.0 * np.pi * rise) / (2.0 * np.pi)
    text.curve(3, [*zip(0.5 * CALM * rise, soft), (1.0e3, 1.0)])
    text.curve(4, [(0.0, STRONG), *zip(CALM + fade * rise, STRONG * (1.0 - soft)), (1.0e3, 0.0)])
    text.curve(5, [(begin, 0.0), (begin + 2.0 * scene.step, 1.0), (begin + 4.0 * scene.step, 0.0)])
    pressed = PRESSURE * CELL * np.r_[0.5, np.ones(len(upper.upper) - 2), 0.5]
    mass = scene.model.mass
    loads = [(int(node), 2, 3, -force) for node, force in zip(upper.upper, pressed)]
    # What damping takes from steady sliding is given back.
    loads += [(int(node), 1, 4, SPEED * mass[scene.model.row[int(node)]]) for node in upper.node.ravel()]
    push = KICK * SPEED / (2.0 * scene.step)
    loads += [(node, k + 1, 5, push * mass[row] * shape[row, k]) for node, row in scene.model.row.items() for k in (0, 1)
              if shape[row, k] != 0.0]
    text.add("*LOAD_NODE_POINT", *loads).add("*DAMPING_GLOBAL", (4, 0.0))
    text.add("*CONTACT_2D_SLIDELINE", (-3, -4, scene.kind, 4, scene.penalty, friction),
             (0.0, 1.0e20, 1))
    return text.output(glstat=end / 50, nodout=2.0 * scene.step, nodes=[int(node) for node in upper.lower]), begin


def speeds(result, begin):
    """Times after the kick, s, and speeds of the slave nodes across the surface (time, node), m/s."""
    table = result.table("nodout")
    times = np.unique(table["time"])
    across = table["vy"].reshape(len(times), -1)
    late = times > begin
    return times[late], across[late]


def growth(times, across, omega):
    """Rate, 1/s, and frequency, rad/s, of the speeds: from one e-fold after the kick up to `LARGEST` of that of sliding."""
    period = max(3, int(round(2.0 * np.pi / omega / (times[1] - times[0]))))
    kernel = np.full(period, 1.0 / period)
    squares = np.convolve(np.mean(across ** 2, axis=1), kernel, mode="valid")
    middle = times[:len(squares)] + 0.5 * (period - 1) * (times[1] - times[0])
    end = np.flatnonzero(squares > (LARGEST * SPEED) ** 2)
    end = end[0] if len(end) else len(squares)
    first = np.flatnonzero(squares[:end] > np.e ** 2 * squares[0])
    first = first[0] if len(first) else 0
    rate = 0.5 * np.polyfit(middle[first:end], np.log(squares[first:end]), 1)[0]
    # Turns of the strongest node's speed, from sign to sign.
    rows = slice(first, end + period - 1)
    speed = across[rows, np.argmax(np.mean(across[rows] ** 2, axis=0))]
    cross = np.flatnonzero(speed[1:] * speed[:-1] < 0.0)
    place = cross + speed[cross] / (speed[cross] - speed[cross + 1])
    return rate, np.pi * (len(place) - 1) / ((place[-1] - place[0]) * (times[1] - times[0]))


def check_growth(run, kind, rows, ratio, friction):
    """Growth rate and frequency."""
    scene = Scene(kind, rows, ratio)
    rate, omega, shape = scene.motion(friction)
    plate = "thin plate" if rows == 1 else f"plate of {rows} rows"
    name = f"{plate}, penalty {ratio:g} K L/A, mu {friction:g}: {TYPES[kind]}"
    text, begin = deck(scene, friction, shape, rate)
    found, turns = growth(*speeds(run.program(text), begin), omega)
    run.check(f"{name}: growth rate, 1/s", found, rate)
    run.check(f"{name}: frequency, rad/s", turns, omega)


def check_without_friction(run, kind):
    """The same kick, mu 0: nothing grows."""
    scene = Scene(kind, 1, 1.0)
    rate, omega, shape = scene.motion(0.3)
    text, begin = deck(scene, 0.0, shape, rate)
    _, across = speeds(run.program(text), begin)
    quarter = len(across) // 4
    early, late = (np.mean(rows ** 2) for rows in (across[:quarter], across[-quarter:]))
    run.check(f"mu 0: {TYPES[kind]}: speeds at the end over those after the kick", np.sqrt(late / early), 1.1)


def check(run):
    for kind in TYPES:
        check_growth(run, kind, 1, 1.0, 0.3)
    check_growth(run, 7, 1, 1.0, 0.1)
    for ratio in (0.1, 10.0):
        check_growth(run, 7, 1, ratio, 0.3)
    for friction in (0.3, 0.5):
        check_growth(run, 7, 6, 1.0, friction)
    check_without_friction(run, 7)
