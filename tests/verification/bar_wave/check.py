# SPDX-License-Identifier: MIT
"""Plane-strain bar (nu = 0) hit at one end: the elastic wave."""
import numpy as np

from meshes import Deck, grid

RHO, YOUNG, LENGTH, SPEED = 1000.0, 1.0e6, 10.0, 0.01
SOUND = np.sqrt(YOUNG / RHO)
STRESS = RHO * SOUND * SPEED
END_TIME = 0.8 * LENGTH / SOUND


def bar_deck(n, load, viscosity=None):
    """n square elements along the bar; the left end gets a velocity or a pressure step."""
    height = LENGTH / n
    deck = Deck(f"bar of {n} elements, {load}")
    deck.control(END_TIME, dt=0.8 * height / SOUND).part().elastic(RHO, YOUNG, 0.0)
    if viscosity:
        deck.add("*CONTROL_BULK_VISCOSITY", viscosity)
    nodes = deck.mesh(*grid(n, 1, LENGTH, height))
    left = nodes[[0, n + 1]]
    if load == "velocity":
        deck.curve(1, [(0.0, SPEED), (1.0, SPEED)])
        for node in left:
            deck.prescribe(node, 1, 0, 1)
    else:
        deck.curve(1, [(0.0, STRESS), (1.0, STRESS)])
        # walked counter-clockwise round the body: down the left end
        deck.add("*LOAD_SEGMENT", (1, 1.0, 0.0, left[1], left[0], left[0], left[0]))
    return deck.output(plot=END_TIME / 200.0, glstat=END_TIME / 200.0, matsum=END_TIME / 200.0), height


def arrival(time, stress):
    """First time at which |stress| passes half of rho c v, between two states."""
    k = int(np.argmax(np.abs(stress) > 0.5 * STRESS))
    a, b = abs(stress[k - 1]), abs(stress[k])
    return time[k - 1] + (0.5 * STRESS - a) / (b - a) * (time[k] - time[k - 1])


def check_load(run, load):
    n_elements, errors = (50, 100, 200), []
    for n in n_elements:
        deck, height = bar_deck(n, load)
        result = run.program(deck, name=f"{load}_{n}")
        time, stress = result.times, result.cells("stress")[..., 0]
        centre = (np.arange(n) + 0.5) * LENGTH / n
        exact = np.where(centre < SOUND * time[-1], -STRESS, 0.0)
        errors.append(np.mean(np.abs(stress[-1] - exact)) / STRESS)
        run.report(f"{load}: mean stress error / rho c v, {n} elements", errors[-1])
    run.check(f"{load}: order of the mean error", run.order(1.0 / np.array(n_elements), errors),
              0.5)
    for place in (0.25, 0.5, 0.7):
        k = int(place * n)
        run.check(f"{load}: arrival at {centre[k]:.3f} m", arrival(time, stress[:, k]),
                  centre[k] / SOUND)
    # the two arrivals' difference is free of the start
    run.check(f"{load}: wave speed", (centre[140] - centre[40])
              / (arrival(time, stress[:, 140]) - arrival(time, stress[:, 40])), SOUND)
    behind = centre < 0.6 * LENGTH
    run.check(f"{load}: stress behind the front", stress[-1, behind].mean(), -STRESS)
    velocity = result.points("velocity")[-1, :n + 1, 0]
    run.check(f"{load}: velocity behind the front", velocity[:int(0.6 * n)].mean(), SPEED)
    area = LENGTH / n
    energy = result.table("glstat")
    run.check(f"{load}: external work", energy["external_work"][-1],
              RHO * SOUND * SPEED ** 2 * area * END_TIME)
    run.check(f"{load}: energy ratio", energy["energy_ratio"][40:], 1.0)
    momentum = result.table("matsum")
    run.check(f"{load}: momentum", momentum["momentum_x"][-1], STRESS * area * END_TIME)
    if load == "pressure":
        run.check("pressure: momentum is the impulse at all times", momentum["momentum_x"],
                  STRESS * area * momentum["time"])


def check_viscosity(run):
    """Bulk viscosity takes the ringing out, keeps front and plateau, and is in the balance."""
    n = 100
    plain = run.program(bar_deck(n, "velocity")[0], name="plain")
    viscous = run.program(bar_deck(n, "velocity", (1.5, 0.3))[0], name="viscous")
    peaks = [np.max(-result.cells("stress")[..., 0]) / STRESS for result in (plain, viscous)]
    run.report("bulk viscosity off: largest stress / rho c v", peaks[0])
    run.report("bulk viscosity Q2 0.3: largest stress / rho c v", peaks[1])
    run.check("bulk viscosity: overshoot left / overshoot without",
              (peaks[1] - 1.0) / (peaks[0] - 1.0), 0.5)
    behind = (np.arange(n) + 0.5) * LENGTH / n < 0.6 * LENGTH
    run.check("bulk viscosity: stress behind the front",
              viscous.cells("stress")[-1, behind, 0].mean(), -STRESS)
    energy = viscous.table("glstat")
    run.check("bulk viscosity: energy ratio", energy["energy_ratio"][40:], 1.0)
    run.check("bulk viscosity: dissipated energy never falls", np.diff(energy["viscous"]), 0.0)
    run.check("bulk viscosity: dissipated / total energy",
              energy["viscous"][-1] / energy["total"][-1], 1e-3)


def check(run):
    check_load(run, "velocity")
    check_load(run, "pressure")
    check_viscosity(run)
