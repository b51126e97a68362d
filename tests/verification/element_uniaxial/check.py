# SPDX-License-Identifier: MIT
"""Uniaxial strain of one element and of a distorted patch, small and finite."""
import numpy as np

from meshes import Deck, distorted_patch, grid, moduli

RHO, YOUNG, POISSON = 1.0e4, 1.0e6, 0.3
BULK, SHEAR, _ = moduli(YOUNG, POISSON)
FORMS = {None: "", 4: ", full integration"}


def stretched_element(stretch, n_step, points):
    """Unit square pulled to `stretch` along x in one second, y held."""
    deck = Deck(f"uniaxial strain to {stretch}")
    deck.control(1.0, dt=1.0 / n_step).part(points=points).elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(*grid(1, 1))
    deck.curve(1, [(0.0, 0.0), (1.0, stretch - 1.0)])
    deck.fix(nodes, y=1).fix(nodes[[0, 2]], x=1)
    for node in nodes[[1, 3]]:
        deck.prescribe(node, 1, 2, 1)
    return deck.output(plot=0.1, glstat=0.1)


def log_strain_stress(stretch):
    """sigma = K ln J + 2 G dev(ln lambda), components xx yy zz xy yz xz."""
    strain = np.log(np.asarray(stretch))
    mean, zero = BULK * strain, 0.0 * strain
    lateral = mean - 2.0 * SHEAR * strain / 3.0
    return np.stack([mean + 4.0 * SHEAR * strain / 3.0, lateral, lateral, zero, zero, zero], -1)


def midstep_sum(stretch, n_step):
    """What a mid-step velocity gradient adds up to in place of ln(lambda)."""
    lam = 1.0 + (stretch - 1.0) * np.arange(n_step + 1) / n_step
    return np.sum(2.0 * (lam[1:] - lam[:-1]) / (lam[1:] + lam[:-1]))


def check_stretch(run, stretch, points=None):
    n_steps, errors = (50, 100), []
    case = f"stretch to {stretch}" + FORMS[points]
    for n_step in n_steps:
        result = run.program(stretched_element(stretch, n_step, points))
        now = 1.0 + (stretch - 1.0) * result.times
        expected = log_strain_stress(now)
        found = result.cells("stress")[:, 0, :]
        errors.append(abs(found[-1, 0] - found[-1, 1] - 2.0 * SHEAR * np.log(stretch)))
    run.check(f"stress, {case}", found, expected)
    run.check(f"xx - yy, {case}, mid-step sum", found[-1, 0] - found[-1, 1],
              2.0 * SHEAR * midstep_sum(stretch, n_steps[-1]))
    run.check(f"mean stress, {case}", found[:, :3].mean(axis=1), BULK * np.log(now))
    run.check(f"plot pressure, {case}", result.cells("pressure")[:, 0].ravel(), -BULK * np.log(now))
    run.check(f"plot mises, {case}", result.cells("mises")[:, 0].ravel(),
              2.0 * SHEAR * np.abs(np.log(now)))
    if abs(stretch - 1.0) > 0.1:
        run.check(f"order in the step, {case}", run.order(1.0 / np.array(n_steps), errors), 2.0)
        internal = stretch * np.log(stretch) - stretch + 1.0
        run.check(f"internal energy, {case}", result.table("glstat")["internal"][-1],
                  (BULK + 4.0 * SHEAR / 3.0) * internal)


def check_patch(run, name, quads, points=None):
    """Affine motion of the boundary, the middle node free: F = I + t A."""
    name += FORMS[points]
    rate = np.array([[0.2, 0.0], [0.0, 0.0]])
    coordinates, _ = distorted_patch()
    deck = Deck(f"distorted patch of {name}, uniaxial strain")
    deck.control(1.0, dt=0.002).part(points=points).elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(coordinates, quads)
    deck.curve(1, [(0.0, 1.0), (2.0, 1.0)])
    velocity = coordinates @ rate.T
    deck.add("*INITIAL_VELOCITY_NODE", *[(node, *speed) for node, speed in zip(nodes, velocity)])
    for k, node in enumerate(nodes):
        if k == 4:
            continue
        deck.prescribe(node, 1, 0, 1, velocity[k, 0]).prescribe(node, 2, 0, 1, velocity[k, 1])
    deck.output(plot=0.1, glstat=0.1, matsum=0.1)
    result = run.program(deck, name=name.replace(",", "").replace(" ", "_"))
    expected = log_strain_stress(1.0 + rate[0, 0] * result.times)
    found = result.cells("stress")
    run.check(f"patch of {name}: stress of all elements", found, expected[:, None, :] + 0.0 * found)
    spread = np.max(np.abs(found - found.mean(axis=1, keepdims=True)))
    run.check(f"patch of {name}: spread between elements / stress",
              spread / np.max(np.abs(expected)), 0.0)
    moved = result.points("displacement")[-1, 4, :2]
    run.check(f"patch of {name}: displacement of the free node", moved, velocity[4])
    run.check(f"patch of {name}: mass", result.table("matsum")["mass"], RHO)


def check(run):
    quads = distorted_patch()[1]
    halves = [half for a, b, c, d in quads for half in ((a, b, c, c), (a, c, d, d))]
    for points in FORMS:
        check_stretch(run, 1.001, points)
        check_stretch(run, 1.5, points)
        check_stretch(run, 0.6, points)
        check_patch(run, "quads", quads, points)
        check_patch(run, "triangles", halves, points)
        check_patch(run, "quads and triangles", quads[:2] + halves[4:], points)
