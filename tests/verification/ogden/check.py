# SPDX-License-Identifier: MIT
"""Ogden rubber: principal stresses of stretched, turned elements, small strain, energy of a free vibration."""

import numpy as np

from meshes import Deck, grid, rotate

RHO, POISSON = 1.0e3, 0.49
MU, ALPHA = (6.3e5, 1.2e3, -1.0e4), (1.3, 5.0, -2.0)
SHEAR = 0.5 * np.dot(MU, ALPHA)
BULK = 2.0 * SHEAR * (1.0 + POISSON) / (3.0 * (1.0 - 2.0 * POISSON))
END = 0.1


def rubber(deck, points=None):
    return deck.part(points=points).add("*MAT_OGDEN_RUBBER", (1, RHO, POISSON), (*MU,), (*ALPHA,))


def stresses(stretch):
    """Principal Cauchy stresses."""
    volume = np.prod(stretch)
    terms = [mu * (stretch / volume ** (1 / 3)) ** alpha for mu, alpha in zip(MU, ALPHA)]
    return (sum(term - term.mean() for term in terms) + BULK * (volume - 1.0)) / volume


def energy(stretch):
    volume = np.prod(stretch)
    terms = [mu / alpha * (np.sum((stretch / volume ** (1 / 3)) ** alpha) - 3.0) for mu, alpha in zip(MU, ALPHA)]
    return sum(terms) + BULK * (volume - 1.0 - np.log(volume))


def stretched(stretch, angle, points, end=END):
    """A square, turned by `angle`, whose nodes are moved to the stretches along its sides."""
    deck = rubber(Deck("stretched rubber").control(end, dt=end / 400), points)
    coordinates, quads = grid(1, 1)
    nodes = deck.mesh(rotate(coordinates, angle), quads)
    way = rotate(coordinates * np.asarray(stretch[:2]), angle) - rotate(coordinates, angle)
    deck.curve(1, [(0.0, 0.0), (end, 1.0)])
    for node, (x, y) in zip(nodes, way):
        for dof, size in ((1, x), (2, y)):
            if abs(size) > 0.0:
                deck.prescribe(node, dof, 2, 1, size)
            else:
                deck.fix([node], x=int(dof == 1), y=int(dof == 2))
    return deck.output(plot=end, glstat=end / 10)


def check(run):
    for points in (None, 4):
        for stretch in ((2.0, 0.5, 1.0), (1.6, 1.3, 1.0), (0.6, 0.9, 1.0), (1.0 + 1e-6, 1.0, 1.0)):
            for angle in (0.0, 0.7):
                name = f"{points or 1} point(s), stretches {stretch[0]:g} {stretch[1]:g}, turned by {angle:g}"
                result = run.program(stretched(stretch, angle, points))
                found = result.cells("stress")[-1, 0]
                tensor = np.array([[found[0], found[3]], [found[3], found[1]]])
                turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
                expected = stresses(np.array(stretch))
                tensor = turn.T @ tensor @ turn
                run.check(f"{name}: stress", np.array([tensor[0, 0], tensor[1, 1], found[2]]), expected)
                run.check(f"{name}: energy", result.table("glstat")["internal"][-1], energy(np.array(stretch)))
    check_vibration(run)
    check_restart(run)


def vibration(end=0.2):
    """A block that is let go with a large velocity; the step follows its stiffness."""
    deck = rubber(Deck("vibration").control(end).hourglass(4, 0.05), 4)
    coordinates, quads = grid(4, 4)
    nodes = deck.mesh(coordinates, quads)
    for node, (x, y) in zip(nodes, coordinates):
        deck.add("*INITIAL_VELOCITY_NODE", (int(node), 20.0 * (x - 0.5), -20.0 * (y - 0.5)))
    return deck.output(glstat=end / 100)


def check_vibration(run):
    table = run.program(vibration()).table("glstat")
    run.check("vibration: energy ratio", table["energy_ratio"], np.ones_like(table["time"]))
    run.true("vibration: much of the energy is elastic at a time", table["internal"].max() > 0.5 * table["total"][0])


def check_restart(run):
    deck = vibration(0.05)
    whole = run.program(deck, name="whole")
    run.goes_on(deck, 50, whole, "glstat")
