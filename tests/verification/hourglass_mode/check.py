# SPDX-License-Identifier: MIT
"""Hourglass forces: decay rate, frequency, stable step, and no force on linear motion."""
import re

import numpy as np

from eigen import quad_stiffness
from meshes import Deck, distorted_patch, grid, lumped_mass, moduli

RHO, YOUNG, POISSON = 1000.0, 1.0e6, 0.3
_, _, WAVE_MODULUS = moduli(YOUNG, POISSON)
SOUND = np.sqrt(WAVE_MODULUS / RHO)
WIDTH, HEIGHT = 2.0, 1.0
AREA = WIDTH * HEIGHT


def mode_deck(form, coefficient, speed, dt, end_time, n_x=1, n_y=1, dof=1, scale=None, poisson=POISSON):
    """n_x by n_y rectangles, each in the hourglass pattern, node (0, 0) with +speed; `scale` (TSSFAC): `dt` is
    the interval of the output alone."""
    coordinates, quads = grid(n_x, n_y, WIDTH * n_x, HEIGHT * n_y)
    deck = Deck("hourglass mode")
    deck.control(end_time, dt=None if scale else dt, scale=scale).hourglass(form, coefficient)
    deck.part().elastic(RHO, YOUNG, poisson)
    nodes = deck.mesh(coordinates, quads)
    signs = [(-1) ** (k % (n_x + 1) + k // (n_x + 1)) for k in range(len(nodes))]
    deck.add("*INITIAL_VELOCITY_NODE",
             *[(node, *((sign * speed, 0.0) if dof == 1 else (0.0, sign * speed)))
               for node, sign in zip(nodes, signs)])
    return deck.output(glstat=dt, nodout=dt, nodes=nodes[:1])


def decay_rate(run, coefficient, dt, **layout):
    """Rate of the free decay from a straight line through log(velocity)."""
    rate = 4.0 * coefficient * SOUND / np.sqrt(AREA)
    deck = mode_deck(1, coefficient, 1.0e-7, dt, 2.0 / rate, **layout)
    result = run.program(deck)
    history = result.node(1)
    velocity = history["vy" if layout.get("dof") == 2 else "vx"]
    inside = slice(1, len(velocity) - 1)
    slope = np.polyfit(history["time"][inside], np.log(velocity[inside]), 1)[0]
    return -slope, result


def check_viscous(run):
    coefficient = 0.08
    rate = 4.0 * coefficient * SOUND / np.sqrt(AREA)
    steps = 1.0e-2 / rate, 5.0e-3 / rate
    found = [decay_rate(run, coefficient, dt)[0] for dt in steps]
    for dt, value in zip(steps, found):
        run.report("viscous decay rate / closed form", value / rate, f"rate x step {rate * dt:g}")
    run.check("viscous decay rate, step to zero", 2.0 * found[1] - found[0], rate)
    slope, result = decay_rate(run, coefficient, steps[1], n_x=3, n_y=2)
    run.check("viscous decay rate in a 3 x 2 mesh", slope, rate)
    slope, result = decay_rate(run, coefficient, steps[1], dof=2)
    run.check("viscous decay rate in y", slope, rate)
    energy = result.table("glstat")
    start = energy["kinetic"][0]
    run.check("initial kinetic energy", start, 0.5 * RHO * AREA * 1.0e-14)
    run.check("hourglass energy at the end / initial energy", energy["hourglass"][-1] / start,
              1.0 - np.exp(-4.0))
    run.check("energy ratio, viscous", energy["energy_ratio"], 1.0)
    run.check("internal energy stays zero", energy["internal"][-1] / start, 0.0)


def check_stiffness(run):
    coefficient = 0.05
    # B_x.B_x + B_y.B_y = (w^2 + h^2) for a rectangle; q = 4 displacement; m = rho A/4
    omega = np.sqrt(4.0 * coefficient * WAVE_MODULUS * (WIDTH ** 2 + HEIGHT ** 2)
                    / (AREA * RHO * AREA))
    dt = 0.05 / omega
    speed = 1.0e-7
    theta = 2.0 * np.arcsin(0.5 * omega * dt)
    for form in (4, 5):
        result = run.program(mode_deck(form, coefficient, speed, dt, 20.0 / omega))
        history = result.node(1)
        cycle = np.rint(history["time"] / dt)
        expected = speed * dt * np.sin(cycle * theta) / np.sin(theta)
        run.check(f"stiffness form {form}: displacement", history["ux"], expected)
    energy = result.table("glstat")
    run.check("stiffness form: energy ratio", energy["energy_ratio"], 1.0)
    crossings = history["time"][1:][np.diff(np.sign(history["ux"])) != 0]
    run.report("stiffness frequency from the zero crossings / closed form",
               np.pi / (np.mean(np.diff(crossings)) * omega))


def check_assumed(run):
    """QM 1.0: the frequencies of the elastic bending modes of one rectangle."""
    for name, dof, side, coefficient in (("x", 1, WIDTH, 1.0), ("y", 2, HEIGHT, 0.1)):
        omega = np.sqrt(coefficient * 4.0 * YOUNG / (1.0 - POISSON ** 2) / (3.0 * RHO * side ** 2))
        dt = 0.05 / omega
        theta = 2.0 * np.arcsin(0.5 * omega * dt)
        result = run.program(mode_deck(6, coefficient, 1.0e-7, dt, 20.0 / omega, dof=dof))
        history = result.node(1)
        cycle = np.rint(history["time"] / dt)
        run.check(f"assumed strain in {name}, QM {coefficient:g}: displacement",
                  history["u" + name], 1.0e-7 * dt * np.sin(cycle * theta) / np.sin(theta))
        run.check(f"assumed strain in {name}: energy ratio", result.table("glstat")["energy_ratio"],
                  1.0)


def first_step(result):
    text = (result.folder / f"{result.job}.log").read_text()
    return float(re.search(r"first time step ([^,]+),", text).group(1))


def eigen_limit(coordinates, quads, coefficient, assumed=False):
    """2/omega of the largest eigenvalue of M^-1 K of a free mesh."""
    stiffness = np.zeros((2 * len(coordinates),) * 2)
    for quad in np.asarray(quads):
        dofs = np.stack([2 * quad, 2 * quad + 1], axis=1).ravel()
        stiffness[np.ix_(dofs, dofs)] += quad_stiffness(coordinates[quad], YOUNG, POISSON,
                                                        coefficient, assumed)[0]
    root = 1.0 / np.sqrt(np.repeat(lumped_mass(coordinates, quads, RHO), 2))
    return 2.0 / np.sqrt(np.linalg.eigvalsh(root[:, None] * stiffness * root)[-1])


def check_step(run):
    """Large coefficients rule the stable step: just inside the pattern stays, just outside it grows."""
    side = min(WIDTH, HEIGHT) / SOUND
    layout = {"n_x": 6, "n_y": 4}
    coordinates, quads = grid(6, 4, 6 * WIDTH, 4 * HEIGHT)
    for form, name, coefficient, steps in ((1, "viscous", 1.0, 300.0), (4, "stiffness", 1.0, 30.0),
                                           (4, "stiffness", 0.5, 30.0)):
        limit = np.sqrt(AREA) / (2.0 * coefficient * SOUND) if form == 1 else \
            1.0 / (SOUND * np.sqrt(coefficient * (WIDTH ** -2 + HEIGHT ** -2)))
        label = f"{name} form, Q = {coefficient:g}"
        grown = []
        for scale in (0.97, 1.03):
            result = run.program(mode_deck(form, coefficient, 1.0e-9, 1.0e-6, steps * limit,
                                           scale=scale, **layout))
            run.check(f"{label}: first step / (TSSFAC x limit), TSSFAC {scale:g}",
                      first_step(result) / (scale * min(limit, side)), 1.0)
            grown.append(np.max(np.abs(result.node(1)["vx"])) / 1.0e-9)
        if coefficient > 0.5:
            run.check(f"{label}: velocity just inside / at the start", grown[0], 10.0)
            run.check(f"{label}: velocity just outside / at the start", grown[1], 1.0e3)
    run.check("stiffness form, Q = 1: limit by eigenvalue / step",
              eigen_limit(coordinates, quads, 1.0) * SOUND * np.sqrt(WIDTH ** -2 + HEIGHT ** -2),
              1.0)
    coordinates, quads = distorted_patch()
    for coefficient in (0.1, 0.6, 1.0, 2.0):
        deck = Deck("distorted patch").control(1.0e-6, scale=1.0).hourglass(4, coefficient)
        deck.part().elastic(RHO, YOUNG, POISSON).mesh(coordinates, quads)
        step = first_step(run.program(deck.output(glstat=1.0)))
        run.check(f"distorted patch, Q = {coefficient:g}: limit by eigenvalue / step",
                  eigen_limit(coordinates, quads, coefficient) / step, 1.0)


def check_assumed_step(run):
    """QM 6 rules the step of rectangles; at nu = 0 the limit is sharp. QM 1 rules none."""
    sound = np.sqrt(YOUNG / RHO)
    limit = HEIGHT / sound * np.sqrt(3.0 / 6.0)
    grown = []
    for scale in (0.97, 1.03):
        result = run.program(mode_deck(6, 6.0, 1.0e-9, 1.0e-6, 30.0 * limit, scale=scale, n_x=6, n_y=4,
                                       dof=2, poisson=0.0))
        run.check(f"assumed strain, QM 6: first step / (TSSFAC x limit), TSSFAC {scale:g}",
                  first_step(result) / (scale * limit), 1.0)
        grown.append(np.max(np.abs(result.node(1)["vy"])) / 1.0e-9)
    run.check("assumed strain, QM 6: velocity just inside / at the start", grown[0], 10.0)
    run.check("assumed strain, QM 6: velocity just outside / at the start", grown[1], 1.0e3)
    coordinates, quads = distorted_patch()
    steps = []
    for coefficient in (0.1, 1.0, 8.0):
        deck = Deck("distorted patch").control(1.0e-6, scale=1.0).hourglass(6, coefficient)
        deck.part().elastic(RHO, YOUNG, POISSON).mesh(coordinates, quads)
        steps.append(first_step(run.program(deck.output(glstat=1.0))))
        run.check(f"assumed strain, distorted patch, QM {coefficient:g}: limit by eigenvalue / step",
                  eigen_limit(coordinates, quads, coefficient, True) / steps[-1], 1.0)
    run.check("assumed strain, distorted patch: step of QM 1 / of QM 0.1", steps[1] / steps[0], 1.0)


def check_linear_motion(run):
    """Rigid motion + uniform strain of a distorted patch: no hourglass work at all."""
    coordinates, quads = distorted_patch()
    rate = np.array([[0.1, 0.35], [-0.2, -0.15]])
    for form in (1, 4, 6):
        deck = Deck("linear velocity field")
        deck.control(1.0, dt=0.002).hourglass(form, 0.1).part().elastic(RHO, YOUNG, POISSON)
        nodes = deck.mesh(coordinates, quads)
        deck.curve(1, [(0.0, 1.0), (2.0, 1.0)])
        velocity = coordinates @ rate.T + (0.3, -0.2)
        for k, node in enumerate(nodes):
            deck.prescribe(node, 1, 0, 1, velocity[k, 0]).prescribe(node, 2, 0, 1, velocity[k, 1])
        deck.output(glstat=0.1)
        energy = run.program(deck).table("glstat")
        run.check(f"form {form}: hourglass / internal energy, linear motion",
                  energy["hourglass"][-1] / energy["internal"][-1], 0.0)
        run.check(f"form {form}: internal energy is there", energy["internal"][-1], 1.0)


def check(run):
    check_viscous(run)
    check_stiffness(run)
    check_step(run)
    check_assumed(run)
    check_assumed_step(run)
    check_linear_motion(run)
