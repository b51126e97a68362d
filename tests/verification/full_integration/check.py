# SPDX-License-Identifier: MIT
"""Fully integrated quads: bending with and without incompressibility, and the stable step."""
import numpy as np

from meshes import Deck, grid, moduli

RHO, YOUNG = 1000.0, 1.0e6
LENGTH, DEPTH, SPEED = 10.0, 1.0, 1.0e-3
N_X, N_Y = 40, 4


def cantilever(poisson, n_period):
    """Clamped at x = 0, started with the first bending mode's velocity; n_period of its periods."""
    deck = Deck(f"cantilever, nu = {poisson}")
    end = n_period / frequency(poisson)
    deck.control(end).part(points=4).elastic(RHO, YOUNG, poisson)
    coordinates, quads = grid(N_X, N_Y, LENGTH, DEPTH, (0.0, -0.5 * DEPTH))
    nodes = deck.mesh(coordinates, quads)
    k = 1.8751040687 / LENGTH
    s = (np.cosh(1.8751040687) + np.cos(1.8751040687)) / (np.sinh(1.8751040687) + np.sin(1.8751040687))
    kx = k * coordinates[:, 0]
    shape = 0.5 * (np.cosh(kx) - np.cos(kx) - s * (np.sinh(kx) - np.sin(kx)))
    slope = 0.5 * k * (np.sinh(kx) + np.sin(kx) - s * (np.cosh(kx) - np.cos(kx)))
    deck.add("*INITIAL_VELOCITY_NODE",
             *[(int(node), -SPEED * y * turn, SPEED * deflection) for node, y, turn, deflection
               in zip(nodes, coordinates[:, 1], slope, shape) if deflection > 0.0])
    # Free to widen at the root, where the beam of the theory is too.
    root = coordinates[:, 0] == 0.0
    deck.fix(nodes[root & (coordinates[:, 1] == 0.0)], x=1, y=1)
    deck.fix(nodes[root & (coordinates[:, 1] != 0.0)], x=1)
    tip = nodes[(coordinates[:, 0] == LENGTH) & (np.abs(coordinates[:, 1]) < 1e-9)]
    return deck.output(glstat=end / 200, nodout=end / 2000, nodes=tip), int(tip[0])


def frequency(poisson):
    """First natural frequency of a slender cantilever in plane strain, with the first-order
    correction for shear (5/6) and rotary inertia, and with the stiffness of the mesh: inside an
    element a by b bending has the shear energy G a^2/12, and b^2/12 times a modulus without
    lateral relief (lambda + 2 G, or 4 G/3 with mean dilatation)."""
    modulus = YOUNG / (1.0 - poisson ** 2)
    shear = YOUNG / (2.0 * (1.0 + poisson))
    inertia = DEPTH ** 2 / 12.0
    plain = 1.8751040687 ** 2 / LENGTH ** 2 * np.sqrt(modulus * inertia / RHO) / (2.0 * np.pi)
    # Mean of (w')^2 and of w w'' over the mode, from Rayleigh's quotient: 4.648/L^2.
    rotary = inertia / LENGTH ** 2 * 4.648
    bulk, _, confined = moduli(YOUNG, poisson)
    inner = 4.0 * shear / 3.0 if poisson > 0.4 else confined
    mesh = (shear * (LENGTH / N_X) ** 2 + (inner - modulus) * (DEPTH / N_Y) ** 2) \
        / (modulus * DEPTH ** 2)
    return plain * np.sqrt((1.0 + mesh) / (1.0 + rotary * (1.0 + modulus / (5.0 / 6.0 * shear))))


def check_bending(run, poisson):
    deck, tip = cantilever(poisson, 2.25)
    result = run.program(deck, name=f"cantilever_{poisson}")
    history = result.node(tip)
    time, moved = history["time"], history["uy"]
    rising = np.flatnonzero((moved[:-1] < 0.0) & (moved[1:] >= 0.0))
    crossing = time[rising] - moved[rising] * (time[rising + 1] - time[rising]) \
        / (moved[rising + 1] - moved[rising])
    run.check(f"nu = {poisson}: frequency of the first bending mode",
              1.0 / np.diff(crossing).mean(), frequency(poisson))
    energy = result.table("glstat")
    run.check(f"nu = {poisson}: energy ratio", energy["energy_ratio"], 1.0)
    run.check(f"nu = {poisson}: hourglass energy", energy["hourglass"], 0.0)
    return result


def check_step(run):
    """A free distorted mesh with scattered velocities at the limit itself (TSSFAC 1)."""
    rng = np.random.default_rng(4)
    coordinates, quads = grid(6, 5)
    coordinates = coordinates + 0.05 * rng.uniform(-1.0, 1.0, coordinates.shape)
    quads = quads[:-1] + [(*quads[-1][:3], quads[-1][2])]
    deck = Deck("stable step of full integration")
    deck.control(40.0, scale=1.0).part(points=4).elastic(RHO, YOUNG, 0.3)
    nodes = deck.mesh(coordinates, quads)
    velocity = 1e-6 * rng.uniform(-1.0, 1.0, coordinates.shape)
    deck.add("*INITIAL_VELOCITY_NODE",
             *[(int(node), *speed) for node, speed in zip(nodes, velocity)])
    result = run.program(deck.output(glstat=0.4), name="stable_step")
    ratio = result.table("glstat")["energy_ratio"]
    quarter = len(ratio) // 4
    run.check("TSSFAC 1: energy at the end / at the start, means of a quarter of the run",
              ratio[-quarter:].mean(), ratio[:quarter].mean())


def check(run):
    for poisson in (0.3, 0.499):
        check_bending(run, poisson)
    check_step(run)
