# SPDX-License-Identifier: MIT
"""Implicit dynamics of free bodies: two blocks that meet in free fall, and a spinning block."""
import numpy as np

from contact_types import MOMENT_FREE, TYPES
from meshes import Deck, grid

RHO, YOUNG, POISSON, GRAVITY = 1000.0, 1.0e6, 0.3, 9.81
END, SPEED = 0.2, (0.2, -1.0)
UPPER = RHO * 0.8 * 0.7          # mass of the upper block
SPIN = 4.0


def meshes_of(finer):
    """Lower and upper block; `finer` divides the sides of their elements."""
    return (grid(6 * finer, 4 * finer, 1.5, 1.0, (0.0, -1.0)),
            grid(4 * finer, 3 * finer, 0.8, 0.7, (0.13, 0.01)))


def start_deck(title, dt, end, radius):
    """Generalised-alpha deck; a spectral radius of None: the explicit program."""
    deck = Deck(title)
    if radius is None:
        return deck.control(end, scale=0.5)
    deck.add("*CONTROL_TERMINATION", (end,)).add("*CONTROL_IMPLICIT_GENERAL", (1, dt))
    return deck.add("*CONTROL_IMPLICIT_DYNAMICS", (1,)).add("*CONTROL_IMPLICIT_SPECTRAL_RADIUS", (radius,))


def falling(kind, radius, steps, finer=1):
    """Two free blocks under gravity; the upper one comes down on the lower one, off its middle."""
    dt = END / steps
    deck = start_deck(f"falling blocks, type {kind}", dt, END, radius)
    for part in (1, 2):
        deck.part(part, points=4).elastic(RHO, YOUNG, POISSON, part)
    low, up = (deck.mesh(*block, part=k + 1) for k, block in enumerate(meshes_of(finer)))
    deck.curve(1, [(0.0, GRAVITY), (1.0, GRAVITY)]).add("*LOAD_BODY_Y", (1, 1.0))
    deck.node_set(3, up).add("*INITIAL_VELOCITY", (3,), SPEED)
    deck.node_set(1, up[:4 * finer + 1]).node_set(2, low[-6 * finer - 1:][::-1]).contact(1, 2, kind, 5.0 * YOUNG, 1)
    return deck.output(glstat=dt, matsum=dt, rcforc=dt, plot=dt)


def mass_matrix(coordinates, quads):
    """Consistent mass, 2 x 2 Gauss points."""
    mass = np.zeros((len(coordinates), len(coordinates)))
    sign = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    for quad in quads:
        corner = coordinates[list(quad)]
        for xi, eta in sign / np.sqrt(3.0):
            shape = 0.25 * (1.0 + sign[:, 0] * xi) * (1.0 + sign[:, 1] * eta)
            slope = 0.25 * np.array([sign[:, 0] * (1.0 + sign[:, 1] * eta),
                                     sign[:, 1] * (1.0 + sign[:, 0] * xi)])
            mass[np.ix_(quad, quad)] += RHO * np.outer(shape, shape) * np.linalg.det(slope @ corner)
    return mass


def motion(result):
    """Places and velocities (state, node, 2) in the order of the deck."""
    order = np.argsort(result.points("node_id")[0].ravel())
    return (result.points(name)[:, order, :2] for name in ("Points", "velocity"))


def spin_of(mass, places, velocities):
    """Angular momentum about the origin of each state."""
    momentum = np.einsum("ij,tjk->tik", mass, velocities)
    return np.sum(places[..., 0] * momentum[..., 1] - places[..., 1] * momentum[..., 0], axis=1)


def check_momenta(run, name, kind, result):
    """Momentum as gravity alone has it, in every step; angular momentum up to the error of the scheme."""
    (low, quads_low), (up, quads_up) = meshes_of(1)
    mass = mass_matrix(np.vstack([low, up]),
                       [*quads_low, *(tuple(np.array(quad) + len(low)) for quad in quads_up)])
    parts = [result.table("matsum").where(part=part) for part in (1, 2)]
    time = parts[0]["time"]
    x, y = (parts[0][f"momentum_{axis}"] + parts[1][f"momentum_{axis}"] for axis in "xy")
    run.check(f"{name}: momentum along x", x, UPPER * SPEED[0], 1e-9, source="constant")
    run.check(f"{name}: momentum along y", y, UPPER * SPEED[1] - mass.sum() * GRAVITY * time, 1e-9,
              source="-M g t")
    places, velocities = motion(result)
    spin = spin_of(mass, places, velocities)
    moment = mass.sum(axis=0) @ places[0, :, 0]
    run.check(f"{name}: angular momentum", spin,
              spin[0] - GRAVITY * (moment * result.times + 0.5 * x[0] * result.times ** 2),
              1e-5 if kind in MOMENT_FREE else 1e-4, source="moment of gravity")


#: The second spectral radius of each type where not in full.
FEW = {4: 0.8, 5: 0.0, 7: 0.8}


def check_fall(run, kind):
    """Momenta, energy and the order of its loss for each spectral radius."""
    for radius in (1.0, 0.8, 0.0) if run.is_full else (1.0, FEW[kind]):
        name = f"{TYPES[kind]}, spectral radius {radius}"
        result = run.program(falling(kind, radius, 200), name=f"fall_{kind}_{radius}")
        check_momenta(run, name, kind, result)
        force = result.table("rcforc").where(side="slave")["fy"]
        run.true(f"{name}: the blocks have met and parted", force.max() > 0.0 and force[-1] == 0.0)
        ratio = result.table("glstat")["energy_ratio"]
        run.check(f"{name}: energy ratio, largest", ratio, 1.0, 1e-6, "max", "no energy is created")
        run.check(f"{name}: energy ratio, least", ratio, 0.99, 0.0, "min", "little is lost")
        run.report(f"{name}: energy lost", 1.0 - ratio[-1])
        if radius == 1.0:
            fine = run.program(falling(kind, radius, 400), name=f"fall_{kind}_fine").table("glstat")
            run.check(f"{name}: order of the loss in the step",
                      np.log2((1.0 - ratio[-1]) / (1.0 - fine["energy_ratio"][-1])), 2.0, 0.3, "abs",
                      "nothing is damped; the rest is the work over steps by the trapezoidal rule")


def check_impulse(run, kind):
    """Impulse of the contact against the explicit program: lumped mass on one side, consistent on the
    other, so that the difference must fall with the mesh."""
    free, differences = UPPER * (SPEED[1] - GRAVITY * END), []
    for finer in (1, 2):
        implicit, explicit = (
            run.program(falling(kind, radius, 200, finer), name=f"impulse_{kind}_{finer}_{radius}")
            .table("matsum").where(part=2)["momentum_y"][-1] - free for radius in (0.8, None))
        differences.append(abs(implicit - explicit) / explicit)
    run.check(f"{TYPES[kind]}: impulse on the finer mesh, difference of both drivers", differences[1], 0.01,
              0.0, "max", "mass matrices differ by the square of the element size")
    run.check(f"{TYPES[kind]}: the same over that on the coarser mesh", differences[1] / differences[0], 0.75, 0.0,
              "max", "falls with the mesh")


def check_spin(run, radius):
    """A block in fast rigid rotation, two turns: angular momentum converges with the square of the step."""
    places, quads = grid(4, 2, 1.0, 0.5, (-0.5, -0.25))
    mass, errors = mass_matrix(places, quads), []
    end = 4.0 * np.pi / SPIN
    for steps in (200, 400):
        deck = start_deck(f"spin, radius {radius}", end / steps, end, radius)
        deck.part(points=4).elastic(RHO, YOUNG, POISSON)
        nodes = deck.mesh(places, quads)
        deck.add("*INITIAL_VELOCITY_NODE",
                 *[(int(node), -SPIN * y, SPIN * x) for node, (x, y) in zip(nodes, places)])
        result = run.program(deck.output(glstat=end / steps, plot=end / steps),
                             name=f"spin_{radius}_{steps}")
        spin = spin_of(mass, *motion(result))
        errors.append(np.max(np.abs(spin / spin[0] - 1.0)))
    name = f"spin, spectral radius {radius}"
    run.check(f"{name}: angular momentum, 200 steps a turn", errors[-1], 3e-3, 0.0, "max", "constant")
    run.check(f"{name}: order in the step", np.log2(errors[0] / errors[1]), 2.0, 0.3, "abs", "theory")
    run.check(f"{name}: energy ratio", result.table("glstat")["energy_ratio"], 1.0, 1e-6, "max",
              "no energy is created")


def check(run):
    for kind in (4, 5, 7):
        check_fall(run, kind)
    check_impulse(run, 7)
    for radius in (1.0, 0.8, 0.0):
        check_spin(run, radius)
