# SPDX-License-Identifier: MIT
"""Simple shear of one elastic element with the Jaumann rate."""
import numpy as np

from meshes import Deck, grid, moduli

RHO, YOUNG, POISSON = 1.0e4, 1.0e6, 0.3
BULK, SHEAR, _ = moduli(YOUNG, POISSON)


def sheared_element(shear, n_step, points=None):
    """Unit square, upper side moved along x by `shear` in one second."""
    deck = Deck(f"simple shear to {shear}")
    deck.control(1.0, dt=1.0 / n_step).part(points=points).elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(*grid(1, 1))
    deck.curve(1, [(0.0, 0.0), (1.0, shear)])
    deck.fix(nodes[:2], x=1, y=1).fix(nodes[2:], y=1)
    for node in nodes[2:]:
        deck.prescribe(node, 1, 2, 1)
    return deck.output(plot=0.05, glstat=0.05)


def jaumann_stress(shear):
    """G sin(gamma) in shear, +-G (1 - cos(gamma)) in xx and yy."""
    zero = 0.0 * shear
    normal = SHEAR * (1.0 - np.cos(shear))
    return np.stack([normal, -normal, zero, SHEAR * np.sin(shear), zero, zero], -1)


def check(run):
    result = run.program(sheared_element(1.0e-3, 50))
    gamma = 1.0e-3 * result.times
    found = result.cells("stress")[:, 0, :]
    run.check("shear stress at 0.001", found[:, 3], SHEAR * gamma)
    run.check("mean stress at 0.001 / G", found[:, :3].mean(axis=1) / SHEAR, 0.0)
    run.check("energy at 0.001", result.table("glstat")["internal"][-1], 0.5 * SHEAR * 1.0e-6)

    n_steps, errors, finals = (100, 200, 400, 800), [], []
    for n_step in n_steps:
        result = run.program(sheared_element(3.0, n_step))
        found = result.cells("stress")[:, 0, :]
        expected = jaumann_stress(3.0 * result.times)
        errors.append(np.max(np.abs(found - expected)) / SHEAR)
        finals.append(found)
        run.report(f"largest stress error / G, {n_step} steps to shear 3", errors[-1])
    order = run.order(1.0 / np.array(n_steps), errors)
    run.report("order in the step", order)
    run.check("order in the step", order, 2.0)
    run.check("stress to shear 3, 800 steps", found, expected)
    limit = (2.0 ** round(order) * finals[-1] - finals[-2]) / (2.0 ** round(order) - 1.0)
    run.check("stress to shear 3, step to zero", limit, expected)
    run.check("mean stress at shear 3 / G", found[:, :3].mean(axis=1) / SHEAR, 0.0)
    check_full(run, found)


def check_full(run, expected):
    """With full integration all four points shear alike: the stress is that of one point."""
    result = run.program(sheared_element(3.0, 800, 4))
    run.check("full integration: stress to shear 3", result.cells("stress")[:, 0, :], expected)
