# SPDX-License-Identifier: MIT
"""Free bodies: scattered velocities, a fast spin, two bars, two blocks in free fall; one element (element.py)."""
import numpy as np

import element
from contact_types import TYPES
from element import LENGTH, RHO, YOUNG, implicit
from meshes import grid, trapezoid

SOUND, GRAVITY = np.sqrt(YOUNG / RHO), 9.81
END, FALL = 0.2, (0.2, -1.0)
UPPER = RHO * 0.8 * 0.7          # mass of the upper block
LOW, UP = grid(6, 4, 1.5, 1.0, (0.0, -1.0)), grid(4, 3, 0.8, 0.7, (0.13, 0.01))
SPIN = 4.0
#: The second spectral radius of each type where not in full.
FEW = {4: 0.8, 5: 0.0, 7: 0.8}


def mass_matrix(coordinates, quads):
    """Consistent mass, 2 x 2 Gauss points."""
    mass = np.zeros((len(coordinates), len(coordinates)))
    sign = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    for quad in quads:
        corner = coordinates[list(quad)]
        for xi, eta in sign / np.sqrt(3.0):
            shape = 0.25 * (1.0 + sign[:, 0] * xi) * (1.0 + sign[:, 1] * eta)
            slope = 0.25 * np.array([sign[:, 0] * (1.0 + sign[:, 1] * eta), sign[:, 1] * (1.0 + sign[:, 0] * xi)])
            mass[np.ix_(quad, quad)] += RHO * np.outer(shape, shape) * np.linalg.det(slope @ corner)
    return mass


def momentum_of(part):
    return np.stack([part["momentum_x"], part["momentum_y"]], axis=1)


def spin_of(mass, result):
    """Angular momentum about the origin of each state."""
    places, momentum = result.points("Points"), np.einsum("ij,tjk->tik", mass, result.points("velocity"))
    return np.sum(places[..., 0] * momentum[..., 1] - places[..., 1] * momentum[..., 0], axis=1)


def flying(title, end, steps, radius, body, poisson, speeds):
    """A free body of nodes with given speeds."""
    deck = implicit(title, end / steps, end, radius=radius)
    deck.part(points=4).elastic(RHO, YOUNG, poisson)
    nodes = deck.mesh(*body)
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), *speed) for node, speed in zip(nodes, speeds)])
    return deck.output(glstat=end / steps, matsum=end / steps, plot=end / steps)


def check_energy(run):
    """A free block with scattered velocities: energy and momentum."""
    rng = np.random.default_rng(7)
    coordinates, quads = grid(4, 3)
    coordinates = coordinates + 0.05 * rng.uniform(-1.0, 1.0, coordinates.shape)
    speeds = 1e-6 * rng.uniform(-1.0, 1.0, coordinates.shape)
    masses, ratios = mass_matrix(coordinates, quads).sum(axis=0), {}
    for radius in (1.0, 0.5):
        name = f"free block, radius {radius}"
        result = run.program(flying(name, 1.0, 100, radius, (coordinates, quads), 0.3, speeds))
        energy, part = result.table("glstat"), result.table("matsum")
        ratios[radius] = energy["energy_ratio"]
        momentum = np.einsum("i,tik->tk", masses, result.points("velocity")[..., :2])
        run.check(f"{name}: momentum with consistent mass", momentum, np.broadcast_to(momentum[0], momentum.shape))
        run.check(f"{name}: momentum of the part", momentum_of(part), momentum)
        run.check(f"{name}: kinetic energy of the part", part["kinetic"], energy["kinetic"])
    run.check("free block, radius 1: energy", ratios[1.0], 1.0)
    run.check("free block, radius 0.5: energy left", ratios[0.5][-1], 0.9)


def check_spin(run, radius):
    """A block in fast rigid rotation, two turns: angular momentum converges with the square of the step."""
    body, end = grid(4, 2, 1.0, 0.5, (-0.5, -0.25)), 4.0 * np.pi / SPIN
    mass, errors, name = mass_matrix(*body), [], f"spin, spectral radius {radius}"
    for steps in (200, 400):
        result = run.program(flying(name, end, steps, radius, body, 0.3, SPIN * body[0][:, ::-1] * [-1.0, 1.0]))
        spin = spin_of(mass, result)
        errors.append(np.max(np.abs(spin / spin[0] - 1.0)))
    run.check(f"{name}: angular momentum, 200 steps a turn", errors[-1], 3e-3)
    run.check(f"{name}: order in the step", np.log2(errors[0] / errors[1]), 2.0)
    run.check(f"{name}: energy ratio", result.table("glstat")["energy_ratio"], 1.0)


def check_bars(run, kind):
    """Two equal bars meet end to end, steps of one element passage."""
    name, n, speed = TYPES[kind], 100, 0.1
    size, duration = LENGTH / n, 2.0 * LENGTH / SOUND
    dt = size / SOUND
    deck = implicit(f"two bars, type {kind}", dt, 2.0 * duration)
    for part in (1, 2):
        deck.part(part, points=4).elastic(RHO, YOUNG, 0.0, part)
    left, right = (deck.mesh(*grid(n, 1, LENGTH, size, (x, 0.0)), part=part) for part, x in ((1, -LENGTH), (2, 0.0)))
    deck.node_set(1, left).node_set(2, left[n::n + 1]).node_set(3, right[::n + 1][::-1])
    deck.add("*INITIAL_VELOCITY", (1,), (speed, 0.0))
    result = run.program(deck.contact(2, 3, kind, 0.25 * YOUNG).output(glstat=dt, matsum=dt, rcforc=dt))
    slave = result.table("rcforc").where(side="slave")
    time, force = slave["time"], np.abs(slave["fx"])
    plateau, momentum = 0.5 * RHO * SOUND * speed * size, RHO * LENGTH * size * speed
    run.check(f"{name}: contact force", force[np.abs(time - 0.5 * duration) < 0.3 * duration].mean(), plateau)
    pressed = time[force > 0.5 * plateau]
    run.check(f"{name}: contact time", pressed[-1] - pressed[0] + dt, duration)
    run.check(f"{name}: impulse", trapezoid(force, time), momentum)
    parts = [result.table("matsum").where(part=part)["momentum_x"] for part in (1, 2)]
    run.check(f"{name}: momentum of the second bar", parts[1][-1], momentum)
    run.check(f"{name}: total momentum", parts[0] + parts[1], momentum)
    run.check(f"{name}: no force at the end", force[-1] / plateau, 0.0)
    run.check(f"{name}: energy ratio at the end", result.table("glstat")["energy_ratio"][-1], 1.0)


def falling(kind, radius, steps):
    """Two free blocks under gravity; the upper one comes down on the lower one, off its middle."""
    dt = END / steps
    deck = implicit(f"falling blocks, type {kind}", dt, END, radius=radius)
    for part in (1, 2):
        deck.part(part, points=4).elastic(RHO, YOUNG, 0.3, part)
    low, up = (deck.mesh(*block, part=k) for k, block in ((1, LOW), (2, UP)))
    deck.curve(1, [(0.0, GRAVITY), (1.0, GRAVITY)]).add("*LOAD_BODY_Y", (1, 1.0))
    deck.node_set(3, up).add("*INITIAL_VELOCITY", (3,), FALL)
    deck.node_set(1, up[:5]).node_set(2, low[-7:][::-1]).contact(1, 2, kind, 5.0 * YOUNG, 1)
    return deck.output(glstat=dt, matsum=dt, rcforc=dt, plot=dt)


def check_fall(run, kind):
    """Momenta, energy and the order of its loss for each spectral radius."""
    both = np.vstack([LOW[0], UP[0]]), [*LOW[1], *(tuple(np.array(quad) + len(LOW[0])) for quad in UP[1])]
    mass = mass_matrix(*both)
    for radius in (1.0, 0.8, 0.0) if run.is_full else (1.0, FEW[kind]):
        name = f"{TYPES[kind]}, spectral radius {radius}"
        result = run.program(falling(kind, radius, 200))
        x, y = sum(momentum_of(result.table("matsum").where(part=part)) for part in (1, 2)).T
        run.check(f"{name}: momentum along x", x, UPPER * FALL[0])
        run.check(f"{name}: momentum along y", y, UPPER * FALL[1] - mass.sum() * GRAVITY * result.table("glstat")["time"])
        spin, time = spin_of(mass, result), result.times
        moment = mass.sum(axis=0) @ both[0][:, 0]
        run.check(f"{name}: angular momentum", spin, spin[0] - GRAVITY * (moment * time + 0.5 * x[0] * time ** 2))
        force = result.table("rcforc").where(side="slave")["fy"]
        run.true(f"{name}: the blocks have met and parted", force.max() > 0.0 and force[-1] == 0.0)
        ratio = result.table("glstat")["energy_ratio"]
        run.check(f"{name}: energy ratio, largest", ratio, 1.0)
        run.check(f"{name}: energy ratio, least", ratio, 0.99)
        if radius == 1.0:
            fine = run.program(falling(kind, radius, 400)).table("glstat")
            run.check(f"{name}: order of the loss in the step",
                      np.log2((1.0 - ratio[-1]) / (1.0 - fine["energy_ratio"][-1])), 2.0)


def check(run):
    check_energy(run)
    for radius in (1.0, 0.8, 0.0):
        check_spin(run, radius)
    for kind in (5, 7):
        check_bars(run, kind)
    for kind in (4, 5, 7):
        check_fall(run, kind)
    element.check(run)
