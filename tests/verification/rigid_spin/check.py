# SPDX-License-Identifier: MIT
"""A stretched element turned rigidly through one full turn."""
import numpy as np

from meshes import Deck, grid, moduli, rotate

RHO, YOUNG, POISSON, STRETCH = 1000.0, 1.0e6, 0.3, 1.1
BULK, SHEAR, _ = moduli(YOUNG, POISSON)
N_LOAD = 20


def spun_element(n_turn, points=None):
    """Uniaxial strain in N_LOAD steps, then one turn in n_turn steps of 1 ms."""
    dt = 1.0e-3
    start, quads = grid(1, 1)
    deck = Deck(f"one turn in {n_turn} steps")
    deck.control((N_LOAD + n_turn) * dt, dt=dt).part(points=points).elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(start, quads)
    places = [start * (1.0 + (STRETCH - 1.0) * k / N_LOAD, 1.0) for k in range(N_LOAD + 1)]
    places += [rotate(places[-1], 2.0 * np.pi * k / n_turn) for k in range(1, n_turn + 1)]
    moved = np.array(places) - start
    times = dt * np.arange(len(moved))
    for k, node in enumerate(nodes):
        for dof in (0, 1):
            number = 10 + 2 * k + dof
            deck.curve(number, list(zip(times.tolist(), moved[:, k, dof].tolist())))
            deck.prescribe(node, dof + 1, 2, number)
    return deck.output(plot=dt, glstat=dt)


def turned(stress, angle):
    """Stress (xx yy zz xy) of a body turned by the angles, (state, 4)."""
    c, s = np.cos(angle), np.sin(angle)
    xx, yy, zz, xy = stress
    return np.stack([c * c * xx + s * s * yy - 2.0 * s * c * xy,
                     s * s * xx + c * c * yy + 2.0 * s * c * xy, zz + 0.0 * c,
                     s * c * (xx - yy) + (c * c - s * s) * xy], -1)


def check(run):
    errors, n_turns = [], (90, 180, 360, 720)
    for n_turn in n_turns:
        result = run.program(spun_element(n_turn))
        stress = result.cells("stress")[:, 0, :4]
        first = stress[N_LOAD]
        angle = 2.0 * np.pi * np.arange(n_turn + 1) / n_turn
        expected = turned(first, angle)
        size = np.sqrt(1.5) * np.linalg.norm(first[:3] - first[:3].mean())
        errors.append(np.max(np.abs(stress[N_LOAD:] - expected)) / size)
        run.report(f"stress error over the turn / mises, {n_turn} steps", errors[-1],
                   f"{360.0 / n_turn:g} degrees a step")
        run.check(f"number of states, {n_turn} steps", len(stress), N_LOAD + n_turn + 1)
    run.check("stress before the turn, xx - yy", first[0] - first[1], 2.0 * SHEAR * np.log(STRETCH))
    run.check("stress over the turn, 1 degree a step", errors[2], 0.0)
    run.check("stress over the turn, 4 degrees a step", errors[0], 0.0)
    quarter = 3 * n_turns[-1] // 4
    run.check("quarter turn swaps xx and yy", stress[N_LOAD + quarter, 0], first[1])
    energy = result.table("glstat")["internal"]
    run.check("internal energy does not change in the turn", energy[-1], energy[N_LOAD])
    check_full(run)


def check_full(run, n_turn=90):
    """Full integration turns as exactly as one point does."""
    result = run.program(spun_element(n_turn, 4))
    stress = result.cells("stress")[N_LOAD:, 0, :4]
    expected = turned(stress[0], 2.0 * np.pi * np.arange(n_turn + 1) / n_turn)
    run.check("full integration: stress before the turn, xx - yy", stress[0, 0] - stress[0, 1],
              2.0 * SHEAR * np.log(STRETCH))
    run.check("full integration: stress over the turn", stress, expected)
    energy = result.table("glstat")["internal"]
    run.check("full integration: internal energy does not change in the turn", energy[-1],
              energy[N_LOAD])
