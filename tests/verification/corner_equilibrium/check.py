# SPDX-License-Identifier: MIT
"""Equilibrium where nodes stand on corners: matching rings of few segments, a valley and a roof."""
import numpy as np

from contact_types import TYPES
from meshes import Deck

RINGS, FRICTION, SLOPES = (8, 12, 24), (0.0, 0.05), {"valley": 0.2027, "roof": -0.2027}
OFF = 1.0e-5  # m that the upper body stands beside the ridge; the penetration is ten times that
MOST_ITERATIONS = 8


def start(meshes, fixes):
    """Two elastic bodies, static in ten steps; their nodes row by row."""
    deck = Deck("equilibrium on corners")
    for part in (1, 2):
        deck.part(part, points=4).elastic(1000.0, 1.0e9, 0.3, part)
    rows = []
    for part, ((nodes, quads), fixed) in enumerate(zip(meshes, fixes), 1):
        rows.append(deck.mesh(nodes.reshape(-1, 2), quads, part).reshape(nodes.shape[:2]))
        deck.fix(rows[-1][fixed[0]], *fixed[1:])
    deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 0.1)).add("*CONTROL_IMPLICIT_DYNAMICS", (0,))
    return deck.output(plot=1.0), rows


def quads_of(n_row, n, closed):
    """Quads between rows of n nodes, counter-clockwise where rows go outwards, or up, and nodes on."""
    return [(i * n + (k + 1) % n, i * n + k, (i + 1) * n + k, (i + 1) * n + (k + 1) % n)[::1 if closed else -1]
            for i in range(n_row - 1) for k in range(n - 1 + closed)]


def contact(deck, slave, master, kind, friction, ramp=None):
    deck.node_set(1, slave).node_set(2, master).add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, 10.0, friction),
                                                    (0.0, 1.0e20, 2), (None, 1.0, None, None, None, ramp))


def ring(inner, outer, n):
    angles = 2.0 * np.pi * np.arange(n) / n
    return np.array([[(r * np.cos(a), r * np.sin(a)) for a in angles] for r in np.linspace(inner, outer, 3)])


def fit(kind, n, friction):
    """A hub of n segments, the slave, on a shaft of n."""
    meshes = [(nodes, quads_of(3, n, True)) for nodes in (ring(0.5, 1.001, n), ring(0.999, 1.5, n))]
    deck, (shaft, hub) = start(meshes, [(0, 1, 1), (-1, 1, 1)])
    contact(deck, [hub[0, 0], *hub[0, ::-1]], [*shaft[-1], shaft[-1, 0]], kind, friction, 101)
    return deck.curve(101, [(0.0, 0.0), (1.0, 1.0)]), hub[0] - 1


def wedge(kind, slope, friction, off=0.0):
    """A body pressed into a valley, or on a roof, of the same slope, or beside its middle."""
    bodies = []
    for middle, width, low, high in ((0.0, 1.0, lambda x: -1.0, lambda x: slope * abs(x)), (off, 0.8, lambda x: slope * abs(x), lambda x: 1.0)):
        bodies.append(np.array([[(middle + x, z(x)) for x in np.linspace(-width, width, 5)] for z in (low, high)]))
    deck, (below, above) = start([(body, quads_of(2, 5, False)) for body in bodies], [(0, 1, 1), (-1, 1, 0)])
    contact(deck, above[0], below[-1, ::-1], kind, friction)
    deck.curve(101, [(0.0, 0.0), (1.0, -0.001)])
    for node in above[-1]:
        deck.prescribe(node, 2, 2, 101)
    return deck, above[0] - 1


def check(run):
    for kind, name in TYPES.items():
        for friction in FRICTION:
            label = f"{name}, friction {friction}"
            for n in RINGS:
                deck, nodes = fit(kind, n, friction)
                result = run.program(deck, "smooth=-1")
                force, place = result.points("contact_force")[-1][nodes, :2], result.points("Points")[-1][nodes, :2]
                radial, around = np.sum(force * place, 1), force[:, 1] * place[:, 0] - force[:, 0] * place[:, 1]
                run.check(f"{label}, rings of {n}: radial force over its mean", radial / radial.mean(), 1.0)
                run.check(f"{label}, rings of {n}: force around over the radial one", around / radial.mean(), 0.0)
                judge(run, f"{label}, rings of {n}", result)
            for scene, slope in SLOPES.items():
                deck, nodes = wedge(kind, slope, friction)
                result = run.program(deck)
                force = result.points("contact_force")[-1][nodes, :2]
                run.check(f"{label}, {scene}: force less its mirror image, over the largest",
                          (force - force[::-1] * [-1.0, 1.0]) / np.max(np.abs(force)), 0.0)
                judge(run, f"{label}, {scene}", result)
        # Nodes alone are driven off a ridge (types 1 to 3).
        for slope in (SLOPES["roof"], -0.6) if kind > 3 else ():
            label, across = f"{name}, beside a ridge of slope {-slope}", []
            for off in (OFF, 10.0 * OFF):
                deck, nodes = wedge(kind, slope, 0.0, off)
                result = run.program(deck)
                across.append(np.sum(result.points("contact_force")[-1][nodes, 0]))
                judge(run, f"{label}, off by {off}", result)
            run.check(f"{label}: force across over that nearer to the ridge", across[1] / across[0], 10.0)


def judge(run, label, result):
    run.check(f"{label}: largest number of iterations", max(map(len, result.newton())), MOST_ITERATIONS)
