# SPDX-License-Identifier: MIT
"""A shear wave meets an interface under pressure; a band is dragged round a drum; flutter of steady sliding (flutter.py)."""
import numpy as np

import flutter
from contact_types import PASS_PATCH, TYPES
from meshes import Deck, grid, grid_quads

RHO, YOUNG, POISSON = 1000.0, 1.0e8, 0.3
SHEAR_SPEED = np.sqrt(YOUNG / (2.0 * (1.0 + POISSON)) / RHO)
IMPEDANCE = RHO * SHEAR_SPEED
#: Pressure at the interface, Pa, by an overlap at the start, and penalty, N/m^2.
PRESSURE, PENALTY = 1.0e3, 4.0e9
#: Cells along a column, its height, and the time of the pulse, which is half of it long.
CELLS, HEIGHT = 100, 2.0
PULSE = 0.5 * HEIGHT / SHEAR_SPEED


def columns(kind, peak, friction, across):
    """Two columns, one on the other, all u_y held: plane shear waves. A pulse `peak sin^2` comes from below."""
    deck = Deck("shear pulse").control(1.9 * HEIGHT / SHEAR_SPEED, scale=0.5)
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, POISSON, part)
    deck.hourglass(4, 0.1)
    width = 0.1
    # Type 1 has springs of nodes, type 3 two passes.
    overlap = PRESSURE / PENALTY / {1: 1.0 + 1.0 / across[0], 3: 2.0}.get(kind, 1.0)
    upper_points, upper_quads = grid(across[0], CELLS, width, HEIGHT, (0.0, -overlap))
    upper = deck.mesh(upper_points, upper_quads, part=1)
    lower = deck.mesh(*grid(across[1], CELLS, width, HEIGHT, (0.0, -HEIGHT)), part=2)
    deck.fix(np.concatenate([upper, lower]), y=1)
    deck.node_set(1, upper[:across[0] + 1]).node_set(2, lower[-across[1] - 1:][::-1])
    steps = np.linspace(0.0, 1.0, 401)
    deck.curve(1, [*zip(PULSE * steps, np.sin(np.pi * steps) ** 2), (1.0e6, 0.0)])
    shares = np.full(across[1] + 1, width / across[1])
    shares[[0, -1]] *= 0.5
    deck.add("*LOAD_NODE_POINT", *[(int(node), 1, 1, peak * share) for node, share in zip(lower, shares)])
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 3, PENALTY, friction), (0.0, 1.0e20, 1))
    every = PULSE / 200
    watched = [int(upper[across[0] // 2]), int(lower[-1 - across[1] // 2])]
    deck.output(glstat=every, rcforc=every, nodout=every, nodes=watched)
    return deck, watched, width


#: Drum and band: radius, thickness of the band, its pull, and the friction.
DRUM, THICK, PULL, MU = 1.0, 0.02, 1.0e3, 0.3


def capstan(kind, exchanged, cells=60, sink=1.0e-3, transits=20.0, n_drum=157):
    """A band over the upper half of a rigid drum that turns clockwise: held at its left end, pulled down at its right."""
    young, rho = PULL / (1.0e-3 * THICK), 1000.0
    transit = np.pi * DRUM / np.sqrt(young / rho)
    end = transits * transit
    deck = Deck(f"capstan, type {kind}").control(end, scale=0.6).hourglass(4, 0.05)
    deck.part(1).elastic(rho, young, 0.0, 1)
    deck.part(2).add("*MAT_RIGID", (2, rho, young, 0.0), (1, 7, 0), (0.0,))
    # Straight tails of five cells hang down on both sides.
    half, tails, rows = np.linspace(np.pi, 0.0, cells + 1), np.arange(1, 6) * np.pi * DRUM / cells, []
    for radius in (DRUM, DRUM + THICK):
        rows += [(-radius, -y) for y in tails[::-1]]
        rows += [(radius * np.cos(a), radius * np.sin(a)) for a in half] + [(radius, -y) for y in tails]
    n = cells + 10
    band = deck.mesh(np.array(rows), grid_quads(n, 1), part=1)
    angles = 2.0 * np.pi * np.arange(n_drum)[::-1] / n_drum
    points = np.array([(r * np.cos(a), r * np.sin(a)) for r in (DRUM - 0.1, DRUM) for a in angles])
    closed = [(i, (i + 1) % n_drum, n_drum + (i + 1) % n_drum, n_drum + i) for i in range(n_drum)]
    deck.mesh(points, closed, part=2)
    deck.fix(band[[0, n + 1]], y=1).curve(1, [(0.0, 0.0), (0.25 * end, 1.0), (2.0 * end, 1.0)])
    deck.add("*LOAD_NODE_POINT", *[(int(node), 2, 1, -0.5 * PULL) for node in band[[n, 2 * n + 1]]])
    # On its way the rim slides along the whole band.
    deck.curve(2, [(0.0, 1.0), (2.0 * end, 1.0)])
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_RIGID", (2, 7, 0, 2, -0.05 / end))
    deck.add("*DAMPING_GLOBAL", (0, 1.0 / transit))
    deck.node_set(1, band[:n + 1]).add("*SET_PART_LIST", (3,), (2,))
    deck.add("*CONTACT_2D_SLIDELINE", (*((3, -1) if exchanged else (-1, 3)), kind, 3, PULL / DRUM / (sink * DRUM), MU),
             (0.0, 1.0e20, 1))
    return deck.output(glstat=end / 100).add("*DATABASE_SPCFORC", (end / 100,))


def check_pulse(run, kind, across=(2, 2)):
    """min(tau, mu p) goes through; the rest slips at 2 (tau - mu p)/(rho c_s)."""
    peak, friction = 1.0e3, 0.3
    name = f"shear pulse, {across[0]} on {across[1]} columns: {TYPES[kind]}"
    deck, watched, width = columns(kind, peak, friction, across)
    result = run.program(deck)
    force, energies = result.table("rcforc").where(side="slave"), result.table("glstat")
    time = force["time"]
    since = np.clip((time - HEIGHT / SHEAR_SPEED) / PULSE, 0.0, 1.0)
    stress = peak * np.sin(np.pi * since) ** 2
    limit = friction * PRESSURE
    run.check(f"{name}: pressure", force["fy"] / width, PRESSURE)
    run.check(f"{name}: largest stress that goes through", force["fx"].max() / width, limit)
    through = np.minimum(stress, limit)
    run.check(f"{name}: stress that goes through, root of mean squares",
              np.sqrt(np.mean((force["fx"] / width - through) ** 2)), 0.0, scale=limit)
    upper, lower = (result.node(node) for node in watched)
    rate = 2.0 * np.maximum(stress - limit, 0.0) / IMPEDANCE
    error = np.max(np.abs(lower["vx"] - upper["vx"] - rate)) / rate.max()
    # Type 1 gives half segments at the ends whole springs: more friction there, less beside it.
    if kind == 1:
        run.report(f"{name}: slip rate, largest error / largest rate", error)
    else:
        run.check(f"{name}: slip rate, largest error / largest rate", error, 0.0)
    slip = np.trapezoid(rate, time)
    run.check(f"{name}: slip", (lower["ux"] - upper["ux"])[-1], slip)
    run.check(f"{name}: dissipated", energies["friction"][-1], limit * slip * width)
    check_balance(run, name, energies, 0.01 * energies["kinetic"].max())


def check_balance(run, name, energies, scale):
    run.check(f"{name}: total - external work", np.ptp(energies["total"] - energies["external_work"]), 0.0, scale=scale)


def check_capstan(run, kind, exchanged=False):
    """T2/T1 = exp(mu pi), the friction acting half a thickness inside the pull."""
    name = f"capstan{', exchanged' if exchanged else ''}: {TYPES[kind]}"
    result = run.program(capstan(kind, exchanged))
    table = result.table("spcforc")
    late = table["time"] > 0.9 * table["time"].max()
    pulls = -np.sum(table["fy"][late]) / len(np.unique(table["time"][late])) / PULL
    run.check(f"{name}: T2/T1", pulls, np.exp(MU * np.pi * DRUM / (DRUM + 0.5 * THICK)))
    energies = result.table("glstat")
    check_balance(run, name, energies, energies["external_work"].max())


def check(run):
    for kind in TYPES:
        check_pulse(run, kind)
        check_capstan(run, kind)
    for kind in sorted(PASS_PATCH):
        check_pulse(run, kind, (5, 4))
    for kind in (2, 5, 7):
        check_capstan(run, kind, exchanged=True)
    flutter.check(run)
