# SPDX-License-Identifier: MIT
"""Slave chains sliding over the master, all motion prescribed, and jumps of the total force."""
import numpy as np

from reference import Chain, contact_forces
from scenes import Pair, Scene

END, STEPS, STATES = 0.2, 2000, 50
TIME_STEP = END / STEPS
CURVE = np.linspace(0.0, END, 401)  # points of the curves of motion
DEPTH = 0.003
LENGTH = 0.45  # of the slave chain; the master reaches from 0 to 1
BEGIN, BEYOND, BACK = 0.12, 1.07, -0.2  # travel of the left end of the slave chain


def masters():
    """Lines of the master: name, nodes from left to right."""
    x = np.array([0.0, 0.13, 0.23, 0.36, 0.45, 0.57, 0.7, 0.78, 0.91, 1.0])
    lines = {"flat": 0.1 * x, "re-entrant corners": 0.25 * np.abs(x - 0.45) - 0.2 * x,
             "ridges": -0.2 * np.abs(x - 0.45) - 0.3 * np.maximum(0.0, x - 0.7),
             "waves": 0.02 * np.sin(12.0 * x)}
    return {name: np.stack([x, y], axis=1) for name, y in lines.items()}


def surface(master, x):
    """Height of the master's polygon, continued by its first and last segment."""
    slopes = np.diff(master[:, 1]) / np.diff(master[:, 0])
    inside = np.interp(x, master[:, 0], master[:, 1])
    return inside + np.minimum(0.0, x) * slopes[0] + np.maximum(0.0, x - 1.0) * slopes[-1]


def slave_line(master, n, left):
    """Slave nodes with their left end at `left`: unevenly deep, some above the surface."""
    share = np.linspace(0.0, 1.0, n + 1) ** 1.2
    x = left + LENGTH * share
    depth = DEPTH * (0.8 + np.sin(5.0 * share + 17.0 * left))
    return np.stack([x, surface(master, x) - depth], axis=1)


def travel(times):
    """Left end of the slave chain: beyond the right end of the master, back and out on the left."""
    return np.interp(times, [0.0, 0.45 * END, END], [BEGIN, BEYOND, BACK])


def curve_path(master, n):
    """Slave lines at the points of the curves."""
    return np.stack([slave_line(master, n, left) for left in travel(CURVE)])


def paths(pair):
    """Slave nodes in each step (step, node, 2) and master nodes in walking order."""
    path = curve_path(pair.master, len(pair.slave) - 1)
    times = np.arange(STEPS + 1) * TIME_STEP
    moved = np.stack([[np.interp(times, CURVE, path[:, i, axis]) for axis in (0, 1)]
                      for i in range(path.shape[1])])
    return np.moveaxis(moved, 2, 0), pair.master[::-1]


def sliding_scene(rules):
    """All rules on all masters, slave finer and coarser."""
    scene = Scene("sliding", END, TIME_STEP)
    scene.deck.lines.remove("*DATABASE_BINARY_D3PLOT")
    scene.deck.output(plot=END / STATES)
    curve = 0
    for name, master in masters().items():
        for n in (3, 9):
            start = slave_line(master, n, BEGIN)
            path = curve_path(master, n) - start
            curves = curve + 1 + np.arange(2 * (n + 1)).reshape(n + 1, 2)
            curve += 2 * (n + 1)
            for i in range(n + 1):
                for axis in (0, 1):
                    scene.deck.curve(int(curves[i, axis]), zip(CURVE, path[:, i, axis]))
            pair = Pair(f"{name}, {n} slave segments", start, master)
            for rule in rules:
                add_moving(scene, pair, rule, curves)
    return scene


def add_moving(scene, pair, rule, curves):
    (slave, master), _ = scene.add(pair, rule)
    n = len(curves)
    cards = [(int(slave[0] + i + row * n + 1), axis + 1, 2, int(curves[i, axis]), 1.0)
             for i in range(n) for row in (0, 1) for axis in (0, 1)]
    scene.deck.add("*BOUNDARY_PRESCRIBED_MOTION_NODE", *cards)
    first = int(master.min() - len(master)) + 1
    scene.deck.fix(range(first, first + 2 * len(master)), x=1, y=1)


def total_force(rule, master, left, n):
    """Total reference force on the slave, its line rigidly shifted along the master."""
    line = rigid_line(master, n, left)
    chains = Chain(line), Chain(master[::-1])
    return contact_forces(rule, *chains, chains)[0].sum(axis=0)


def rigid_line(master, n, left):
    """A slave chain of fixed shape under the middle of the master."""
    shape = slave_line(master, n, 0.5 * (1.0 - LENGTH))
    shape[:, 1] = np.minimum(shape[:, 1], surface(master, shape[:, 0]) - 0.5 * DEPTH)
    return shape + np.array([left - shape[0, 0], 0.0])


#: Stretches of travel of the left end: in the first no end of the slave chain passes a master node.
STRETCHES = {"nodes pass nodes": (0.262, 0.318), "ends of the slave chain pass": (0.215, 0.335)}


def largest_jump(rule, master, n, stretch, samples=31, tries=3, width=1.0e-10):
    """Place of the largest jump of the total force over a stretch of travel; mean force.

    Intervals of a sweep in which the force deviates most from its neighbours are halved, keeping
    the half with the larger difference.
    """
    lefts = np.linspace(*stretch, samples)
    forces = np.array([total_force(rule, master, left, n) for left in lefts])
    mean = np.mean(np.hypot(forces[:, 0], forces[:, 1]))
    change = np.diff(forces, axis=0)
    odd = np.hypot(*(change - 0.5 * (np.roll(change, 1, axis=0) + np.roll(change, -1, axis=0))).T)
    odd[[0, -1]] = 0.0
    best = lefts[0], 0.0
    for k in np.argsort(odd)[-tries:]:
        low, high, below, above = lefts[k], lefts[k + 1], forces[k], forces[k + 1]
        while high - low > width:
            left = 0.5 * (low + high)
            force = total_force(rule, master, left, n)
            if np.hypot(*(force - below)) > np.hypot(*(above - force)):
                high, above = left, force
            else:
                low, below = left, force
        size = np.hypot(*(above - below))
        if size > best[1]:
            best = 0.5 * (low + high), size
    return best[0], mean
