# SPDX-License-Identifier: MIT
"""A block that slides on another one at a steady speed: its deck, and how fast its flutter should grow.

The upper block is pressed down and led along by its top. Mass damping brings it to steady sliding and
fades out; what grows from then on is flutter, as long as it is small: nothing lifts off, nothing sticks.
"""
from __future__ import annotations

import dataclasses
import functools

import numpy as np

from slideline_tools.decks import Deck, Grid, spaced
from slideline_tools.scenes.common import elastic, energies_on, part, plane_strain
from slideline_tools.studies.stability.eigen import Model
from slideline_tools.studies.stability.springs import springs

YOUNG, POISSON, RHO = 1.0e9, 0.3, 1000.0
SIDE, HEIGHT = 0.1, 0.3  # m: elements of the upper block, squares; height of both blocks
PRESSURE = 1.0e-5 * YOUNG
SPEED = 2.0e-3        # m/s: 2e-6 of the wave speed
HOURGLASS = 0.1       # stiffness form, unless a cure asks for another
#: Damping of the first part: over the wave speed and the height of a block, and at least over the rate that is to come.
STRONG, HELD = 1.2, 8.0
CALM, FADE = 0.05, 0.012  # s: damped across the interface, and until the damping has gone
KICK = 1.0e-5             # of the sliding speed: given to one slave node then, for something to grow from
KICKED = 3                # which of them
ROW = 3                   # steps between rows of the speeds
#: E-folds that the run should last for by the prediction, within these numbers of steps.
FOLDS, STEPS = 15.0, (3000, 15000)
#: Share of the shortest stable steps of elements and of contact springs, by eigenvalue.
ELEMENT_SHARE, SPRING_SHARE = 0.6, 0.4


@dataclasses.dataclass(frozen=True)
class Cure:
    """What may damp the flutter: VDC in per cent of critical; D of mass damping, 1/s, that stays; Q2 of bulk viscosity;
    form and coefficient of hourglass control."""

    vdc: float = 0.0
    mass: float = 0.0
    viscosity: float = 0.0
    form: int = 4
    coefficient: float = HOURGLASS


def grids():
    """Lower and upper block, m; their columns do not fit, and no node comes to another within a run."""
    lower = Grid(spaced((-0.147, 1.253, 11)), spaced((-HEIGHT, 0.0, 3)))
    upper = Grid(spaced((0.0, 1.0, 10)), spaced((0.0, HEIGHT, 3)), first_node=1001, first_element=1001)
    return lower, upper


def penalty(ratio):
    """Penalty in N/m^2 for its ratio to K L/A of the elements."""
    return ratio * YOUNG / (3.0 * (1.0 - 2.0 * POISSON)) / SIDE


def way_down(stiffness):
    """Way of the top that makes about `PRESSURE`, m: both blocks between plates, and the springs. (A load instead of a way
    would let the block tilt: from mu 0.5 on its rear end would lift off.)"""
    wave = YOUNG * (1.0 - POISSON) / (1.0 + POISSON) / (1.0 - 2.0 * POISSON)
    return PRESSURE * (2.0 * HEIGHT / wave + 1.0 / stiffness)


class Flutter:
    """The linear model: all of the surface in contact and in slip, so that T = mu p."""

    def __init__(self, ctype):
        lower, upper = grids()
        self.model = Model([lower, upper], YOUNG, POISSON, RHO, HOURGLASS)
        for direction in (0, 1):
            self.model.fix(lower.lower, direction)
            self.model.fix(upper.upper, direction)
        slave, master = (self.model.rows(nodes) for nodes in (upper.lower, lower.upper[::-1]))
        both = np.concatenate([slave, master])
        self.springs = np.zeros((len(self.model.x),) * 2)
        self.springs[np.ix_(both, both)] = springs(ctype, self.model.x[slave, 0], self.model.x[master, 0])

    @functools.lru_cache(maxsize=None)
    def step(self, stiffness):
        """The step of the runs, s."""
        return min(ELEMENT_SHARE * self.model.limit(0.0 * self.springs),
                   SPRING_SHARE * self.model.limit(stiffness * self.springs, with_elements=False))

    @functools.lru_cache(maxsize=None)
    def squares(self, friction, stiffness):
        """Squares of the frequencies (complex) of the free motions, (rad/s)^2.

        The normal forces are -S u_y, those of friction mu S u_y along the motion's axis: on the slave against it.
        """
        model, pressed = self.model, stiffness * self.springs
        matrix = model.stiffness.copy()
        matrix[1::2, 1::2] += pressed
        matrix[0::2, 1::2] -= friction * pressed
        return np.linalg.eigvals((matrix / np.repeat(model.mass, 2)[:, None])[np.ix_(model.free, model.free)])

    def rates(self, friction, stiffness, step, mass=0.0):
        """Growth of each motion by leap-frog with mass damping, 1/s, and its frequency, rad/s."""
        square = self.squares(friction, stiffness)
        damp = 0.5 * mass * step
        half = 0.5 * (2.0 - square * step ** 2) / (1.0 + damp)
        root = np.sqrt(half.astype(complex) ** 2 - (1.0 - damp) / (1.0 + damp))
        return np.log(np.maximum(np.abs(half + root), np.abs(half - root))) / step, np.sqrt(square.astype(complex)).real

    def growth(self, friction, stiffness, step, mass=0.0):
        """Fastest growth, 1/s, and its frequency, rad/s."""
        rates, omega = self.rates(friction, stiffness, step, mass)
        fastest = int(np.argmax(rates))
        return float(rates[fastest]), float(omega[fastest])

    def motions(self, friction, ratio, count=4):
        """(rate, 1/s, frequency, rad/s) of the motions that grow fastest; of a pair that grows and fades the one."""
        stiffness = penalty(ratio)
        rates, omega = self.rates(friction, stiffness, self.step(stiffness))
        found = []
        for k in np.argsort(-rates):
            if not any(abs(omega[k] - other) < 1.0e-6 * other for _, other in found):
                found.append((float(rates[k]), float(omega[k])))
        return found[:count]


@functools.lru_cache(maxsize=None)
def flutter(ctype):
    """The linear model of a type."""
    return Flutter(ctype)


def deck(ctype, friction, ratio, cure=Cure()):
    """The deck of one run."""
    stiffness = penalty(ratio)
    step = flutter(ctype).step(stiffness)
    fastest = flutter(ctype).growth(friction, stiffness, step)[0]
    begin = CALM + FADE
    end = begin + step * np.clip(FOLDS / (step * max(fastest, 1.0e-9)), *STEPS)
    lower, upper = grids()
    text = Deck(f"steady sliding, type {ctype}, mu {friction:g}, penalty {ratio:g} K L/A")
    text.keyword("CONTROL_TERMINATION").card("endtim", end)
    text.constant_step(1, step, 1.0e3)
    text.keyword("CONTROL_HOURGLASS").card("ihq qh", cure.form, cure.coefficient)
    if cure.viscosity:
        text.keyword("CONTROL_BULK_VISCOSITY").card("q1 q2", 0.0, cure.viscosity)
    energies_on(text)
    for number, grid in ((1, lower), (2, upper)):
        part(text, number, "lower block" if number == 1 else "upper block", 1, 1)
        grid.write(text, number)
    plane_strain(text, 1)
    elastic(text, 1, RHO, YOUNG, POISSON)
    text.node_set(1, "bottom", lower.lower).spc_set(1, True, True)
    text.node_set(2, "upper block", upper.node.ravel())
    text.node_set(3, "slave", upper.lower).node_set(4, "master", lower.upper).node_set(5, "top", upper.upper)
    text.keyword("INITIAL_VELOCITY").card("nsid", 2).card("vx vy", SPEED, 0.0)
    text.curve(2, "steady", [(0.0, 1.0), (1.0e3, 1.0)])
    text.keyword("BOUNDARY_PRESCRIBED_MOTION_SET").card("nsid dof vad lcid sf", 5, 1, 0, 2, SPEED)
    rise = np.linspace(0.0, 1.0, 201)
    soft = rise - np.sin(2.0 * np.pi * rise) / (2.0 * np.pi)
    text.curve(3, "way down", [*zip(0.5 * CALM * rise, -way_down(stiffness) * soft), (1.0e3, -way_down(stiffness))])
    text.keyword("BOUNDARY_PRESCRIBED_MOTION_SET").card("nsid dof vad lcid sf", 5, 2, 2, 3, 1.0)
    strong = max(STRONG * np.sqrt(YOUNG / RHO) / HEIGHT, HELD * fastest)
    text.curve(4, "mass damping, 1/s", [(0.0, strong), *zip(CALM + FADE * rise, cure.mass + (strong - cure.mass)
                                        * (1.0 - soft)), (1.0e3, cure.mass)])
    text.keyword("DAMPING_GLOBAL").card("lcid valdmp", 4, 0.0)
    text.curve(5, "kick", [(begin, 0.0), (begin + 2.0 * step, 1.0), (begin + 4.0 * step, 0.0)])
    kicked = upper.lower[KICKED]
    impulse = KICK * SPEED * 0.5 * RHO * SIDE ** 2
    text.keyword("LOAD_NODE_POINT").card("nid dof lcid sf", int(kicked), 2, 5, impulse / (2.0 * step))
    mass = flutter(ctype).model.mass[flutter(ctype).model.rows(upper.node)]
    text.comment("What damping takes from steady sliding is given back: its end shakes nothing.")
    text.keyword("LOAD_NODE_POINT")
    text.table("nid dof lcid sf", [10] * 4, [(int(node), 1, 4, SPEED * one) for node, one in zip(upper.node.ravel(), mass)])
    text.keyword("CONTACT_2D_SLIDELINE").card("surfa surfb ctype ngauss pen fs", -3, -4, ctype, 4, stiffness, friction)
    text.card("tbirth tdeath punit pent vdc", 0.0, 1.0e20, 1, None, cure.vdc)
    text.database(glstat=end / 200.0, rcforc=end / 200.0, nodout=ROW * step,
                  binary_d3plot=begin)
    text.keyword("DATABASE_HISTORY_NODE").row([int(node) for node in upper.lower[:8]], [10] * 8)
    text.row([int(node) for node in upper.lower[8:]], [10] * 8)
    return text.text()


def calm_after():
    """Time from which nothing is damped but by the cure, s."""
    return CALM + FADE
