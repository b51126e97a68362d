# SPDX-License-Identifier: MIT
"""Two equal elastic bars (nu = 0) meet end to end: contact types 1, 2, 3."""
import numpy as np

from meshes import Deck, grid, trapezoid

RHO, YOUNG, LENGTH, SPEED = 1000.0, 1.0e6, 1.0, 0.1
SOUND = np.sqrt(YOUNG / RHO)
DURATION = 2.0 * LENGTH / SOUND
TYPES = {1: "NTS", 2: "NTS-AR", 3: "two-pass NTS-AR"}


def bars(n, kind):
    """Left bar moving right with SPEED, right bar at rest, ends touching."""
    height = LENGTH / n
    interval = DURATION / 400.0
    deck = Deck(f"two bars of {n} elements, type {kind}")
    deck.control(2.0 * DURATION, scale=0.6)
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, 0.0, part)
    left = deck.mesh(*grid(n, 1, LENGTH, height, (-LENGTH, 0.0)), part=1)
    right = deck.mesh(*grid(n, 1, LENGTH, height, (0.0, 0.0)), part=2)
    deck.node_set(1, left).node_set(2, left[[n, 2 * n + 1]]).node_set(3, right[[n + 1, 0]])
    deck.add("*INITIAL_VELOCITY", (1,), (SPEED, 0.0))
    # half the stiffness of an element in front of each surface node
    deck.contact(2, 3, kind, 0.25 * YOUNG)
    return deck.output(plot=interval, glstat=interval, matsum=interval, rcforc=interval)


def half_height_duration(time, force, plateau):
    """Time between the passages of half the plateau, up and down."""
    inside = np.flatnonzero(force > 0.5 * plateau)
    first, last = inside[0], inside[-1]

    def crossing(a, b):
        return time[a] + (0.5 * plateau - force[a]) / (force[b] - force[a]) * (time[b] - time[a])

    return crossing(last, last + 1) - (crossing(first - 1, first) if first else time[0])


def check_type(run, kind):
    name, n = TYPES[kind], 100
    result = run.program(bars(n, kind), name=f"type{kind}")
    height = LENGTH / n
    slave = result.table("rcforc").where(side="slave")
    plateau = 0.5 * RHO * SOUND * SPEED * height
    momentum = RHO * LENGTH * height * SPEED
    force = np.abs(slave["fx"])
    run.check(f"{name}: contact duration at half height",
              half_height_duration(slave["time"], force, plateau), DURATION, 0.02, source="2 L/c")
    middle = np.abs(slave["time"] - 0.5 * DURATION) < 0.3 * DURATION
    run.check(f"{name}: contact force", force[middle].mean(), plateau, 5e-3,
              source="rho c v/2 x height")
    run.check(f"{name}: contact impulse", trapezoid(force, slave["time"]), momentum, 0.01,
              source="rho L v x height")
    run.check(f"{name}: duration from impulse over plateau",
              trapezoid(force, slave["time"]) / force[middle].mean(), DURATION, 0.01,
              source="2 L/c")
    stress = result.cells("stress")[:, n // 2, 0]
    passing = np.abs(result.times - 0.5 * DURATION) < 0.15 * DURATION
    run.check(f"{name}: stress in the middle of the left bar", stress[passing].mean(),
              -0.5 * RHO * SOUND * SPEED, 5e-3, source="rho c v/2")
    left = result.table("matsum").where(part=1)
    right = result.table("matsum").where(part=2)
    run.check(f"{name}: momentum left in the first bar / initial", left["momentum_x"][-1] / momentum,
              0.0, 0.01, "abs", "full exchange")
    run.check(f"{name}: momentum of the second bar", right["momentum_x"][-1], momentum, 0.01,
              source="full exchange")
    run.check(f"{name}: total momentum", left["momentum_x"] + right["momentum_x"],
              momentum, 1e-12, source="constant")
    run.check(f"{name}: no force at the end", force[-1] / plateau, 0.0, 1e-12, "abs", "separated")
    energy = result.table("glstat")
    run.check(f"{name}: energy ratio", energy["energy_ratio"], 1.0, 0.01, "abs", "balance")
    run.check(f"{name}: contact energy at the end / initial", energy["contact"][-1]
              / energy["total"][0], 0.0, 1e-3, "abs", "penalty gives back what it took")
    run.report(f"{name}: internal energy left / initial", energy["internal"][-1]
               / energy["total"][0], "ringing after the release")


def check(run):
    for kind in TYPES:
        check_type(run, kind)
