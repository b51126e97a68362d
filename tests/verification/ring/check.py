# SPDX-License-Identifier: MIT
"""Thick ring under internal pressure (quarter), damped to rest, against Lame."""
import numpy as np

from meshes import Deck, grid_quads

RHO, YOUNG, POISSON, INNER, OUTER, PRESSURE = 1.0, 1.0, 0.3, 1.0, 2.0, 1.0e-6
DAMPING, END_TIME = 0.8, 60.0


def lame_displacement(r):
    """Radial displacement in plane strain."""
    factor = PRESSURE * INNER ** 2 / (OUTER ** 2 - INNER ** 2) * (1.0 + POISSON) / YOUNG
    return factor * ((1.0 - 2.0 * POISSON) * r + OUTER ** 2 / r)


def lame_stress(r):
    """Radial and hoop stress."""
    factor = PRESSURE * INNER ** 2 / (OUTER ** 2 - INNER ** 2)
    return factor * (1.0 - OUTER ** 2 / r ** 2), factor * (1.0 + OUTER ** 2 / r ** 2)


def ring_deck(n_r, n_t):
    """Quarter ring: node (i, j) = radius i, angle j; i runs fastest."""
    radius = np.linspace(INNER, OUTER, n_r + 1)
    angle = np.linspace(0.0, 0.5 * np.pi, n_t + 1)
    coordinates = np.array([(r * np.cos(a), r * np.sin(a)) for a in angle for r in radius])
    deck = Deck(f"ring of {n_r} x {n_t} quads")
    deck.control(END_TIME, scale=0.9).hourglass(4, 0.05).part().elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(coordinates, grid_quads(n_r, n_t))
    row = n_r + 1
    deck.fix(nodes[:row], y=1).fix(nodes[-row:], x=1)
    deck.curve(1, [(0.0, 0.0), (10.0, PRESSURE), (1.0e3, PRESSURE)])
    inner = nodes[::row][::-1]  # the body lies left of the way from y axis to x axis
    for a, b in zip(inner[:-1], inner[1:]):
        deck.add("*LOAD_SEGMENT", (1, 1.0, 0.0, a, b, b, b))
    deck.add("*DAMPING_GLOBAL", (0, DAMPING))
    return deck.output(plot=END_TIME, glstat=END_TIME / 20), coordinates


def check(run):
    meshes, errors, stress_errors = ((4, 6), (8, 12), (16, 24)), [], []
    for n_r, n_t in meshes:
        deck, coordinates = ring_deck(n_r, n_t)
        result = run.program(deck, name=f"ring{n_r}")
        radius = np.hypot(*coordinates.T)
        moved = result.points("displacement")[-1, :, :2]
        radial = np.sum(moved * coordinates, axis=1) / radius
        exact = lame_displacement(radius)
        errors.append(np.sqrt(np.mean((radial - exact) ** 2) / np.mean(exact ** 2)))
        run.report(f"{n_r} x {n_t}: displacement error, root mean square", errors[-1])
        corner = coordinates[np.array(grid_quads(n_r, n_t))]
        centre = corner.mean(axis=1)
        r = np.hypot(*centre.T)
        c, s = (centre / r[:, None]).T
        xx, yy, _, xy = result.cells("stress")[-1, :, :4].T
        hoop = s * s * xx + c * c * yy - 2.0 * s * c * xy
        wanted = lame_stress(r)[1]
        stress_errors.append(np.sqrt(np.mean((hoop - wanted) ** 2) / np.mean(wanted ** 2)))
        run.report(f"{n_r} x {n_t}: hoop stress error, root mean square", stress_errors[-1])
    sizes = [1.0 / n_r for n_r, _ in meshes]
    run.check("order of the displacement", run.order(sizes, errors), 2.0)
    run.check("order of the hoop stress at the centres", run.order(sizes, stress_errors), 2.0)
    run.check("displacement of the inner face, finest mesh", radial[::n_r + 1], exact[::n_r + 1])
    run.check("hoop stress, finest mesh", hoop, wanted)
    energy = result.table("glstat")
    run.check("kinetic / internal energy at the end",
              energy["kinetic"][-1] / energy["internal"][-1], 0.0)
    run.check("internal energy", energy["internal"][-1] + energy["hourglass"][-1],
              0.5 * PRESSURE * lame_displacement(INNER) * INNER * 0.5 * np.pi)
