# SPDX-License-Identifier: MIT
"""Linear viscoelasticity: a bar that is stretched and held relaxes."""

import numpy as np

from meshes import Deck, grid

RHO, BULK, FIRST, LAST, DECAY = 1.0e3, 2.0e6, 1.0e6, 2.0e5, 20.0
RISE, END = 0.02, 0.2


def modulus(time):
    """Stress over 2 de: the history of G for a strain that grows over RISE at a constant rate and is held."""
    def viscous(t, t1):
        t1 = np.minimum(t, t1)
        return (np.exp(-DECAY * (t - t1)) - np.exp(-DECAY * t)) / (DECAY * RISE)
    return LAST * np.minimum(time / RISE, 1.0) + (FIRST - LAST) * viscous(time, RISE)


def element(points, motion, n_step=400, title="held"):
    deck = Deck(title).control(END, dt=END / n_step)
    deck.part(points=points).add("*MAT_VISCOELASTIC", (1, RHO, BULK, FIRST, LAST, DECAY))
    nodes = deck.mesh(*grid(1, 1))
    deck.curve(1, [(0.0, 0.0), (RISE, motion[1]), (1.0, motion[1])])
    deck.fix(nodes, x=int(motion[0] != "shear"), y=0).fix(nodes[:2], x=1, y=1)
    for node in nodes[2:]:
        deck.prescribe(node, 1 if motion[0] == "shear" else 2, 2, 1)
    if motion[0] == "shear":
        deck.fix(nodes[2:], y=1)
    return deck.output(plot=END / 20, glstat=END / 20)


def check(run):
    for points in (None, 4):
        strain, name = 1.0e-6, f"{'four points' if points else 'one point'}: "
        result = run.program(element(points, ("stretch", strain)))
        found = result.cells("stress")[:, 0, :]
        run.check(name + "stress along a held bar", found[1:, 1],
                  BULK * strain * np.minimum(result.times[1:] / RISE, 1.0) + 4.0 / 3.0 * strain * modulus(result.times[1:]))
        run.check(name + "stress across it", found[1:, 0],
                  BULK * strain * np.minimum(result.times[1:] / RISE, 1.0) - 2.0 / 3.0 * strain * modulus(result.times[1:]))
        result = run.program(element(points, ("shear", strain)))
        run.check(name + "shear stress", result.cells("stress")[1:, 0, 3], strain * modulus(result.times[1:]))
    check_limits(run)
    check_restart(run)


def check_limits(run):
    """Without decay, and with GI = G0, the law is elastic."""
    strain = ("stretch", 0.2)
    elastic = element(None, strain)
    young, poisson = 9 * BULK * FIRST / (3 * BULK + FIRST), (3 * BULK - 2 * FIRST) / (2 * (3 * BULK + FIRST))
    card = f"*MAT_VISCOELASTIC\n1,{RHO!r},{BULK!r},{FIRST!r},{LAST!r},{DECAY!r}\n"
    assert card in elastic.text()
    expected = run.program(elastic.text().replace(card, f"*MAT_ELASTIC\n1,{RHO!r},{young!r},{poisson!r}\n")).cells("stress")
    for name, last, decay in (("no decay", LAST, 0.0), ("GI = G0", FIRST, DECAY)):
        found = run.program(elastic.text().replace(card, f"*MAT_VISCOELASTIC\n1,{RHO!r},{BULK!r},{FIRST!r},{last!r},{decay!r}\n"))
        run.check(f"{name}: stress of the elastic law", found.cells("stress"), expected)


def check_restart(run):
    deck = element(4, ("shear", 0.1))
    whole = run.program(deck, name="whole")
    run.goes_on(deck, 200, whole, "glstat")
