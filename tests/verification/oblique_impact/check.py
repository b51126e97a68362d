# SPDX-License-Identifier: MIT
"""Oblique impact of a turned block on a larger free block: what every contact type must conserve."""
import numpy as np

from contact_types import MOMENT_FREE, TYPES
from meshes import Deck, angular_momentum, grid, lumped_mass, rotate

RHO, YOUNG, POISSON = (2000.0, 1000.0), (2.0e6, 1.0e6), 0.3
MIDDLE, STIFF = 5.0e5, 8.0e6
SCENES = ((10.0, MIDDLE, 0.4), (10.0, STIFF, 0.1), (30.0, MIDDLE, 0.4))  # angle, penalty, TSSFAC
CELLS, SIZE = (7, 5), (0.7, 0.5)
VELOCITY = np.array([0.4, -1.0])
INTERVAL = 2.0e-3
END = 0.3


def blocks(angle):
    """Coordinates and quads of the turned block and of the large one below it, at rest."""
    below = grid(16, 6, 2.4, 0.9, (-1.2, -0.9))
    above, quads = grid(*CELLS, *SIZE, (-0.35, 0.0))
    above = rotate(above, np.radians(angle))
    above[:, 1] += 0.01 - above[:, 1].min()
    return (above, quads), below


def lower_and_sides(ids):
    """Left side downwards, lower face, right side upwards: the body lies on the left."""
    rows = np.asarray(ids).reshape(CELLS[1] + 1, CELLS[0] + 1)
    return [*rows[:0:-1, 0], *rows[0], *rows[1:, -1]]


def oblique_impact(kind, angle, penalty=MIDDLE, scale=0.4, exchanged=False):
    upper, lower = blocks(angle)
    deck = Deck(f"oblique impact at {angle:g} degrees, type {kind}")
    deck.control(END, scale=scale)
    for part in (1, 2):
        deck.part(part).elastic(RHO[part - 1], YOUNG[part - 1], POISSON, part)
    top = deck.mesh(*upper, part=1)
    bottom = deck.mesh(*lower, part=2)
    deck.node_set(1, top).node_set(2, lower_and_sides(top)).node_set(3, bottom[-17:][::-1])
    deck.add("*INITIAL_VELOCITY", (1,), VELOCITY.tolist())
    deck.contact(*((3, 2) if exchanged else (2, 3)), kind, penalty)
    return deck.output(plot=INTERVAL, glstat=INTERVAL, matsum=INTERVAL, rcforc=INTERVAL)


def spin(mass, position, velocity):
    """Angular momentum about the own centre of mass over the moment of inertia, rad/s."""
    centre = mass @ position / mass.sum()
    drift = mass @ velocity / mass.sum()
    away = position - centre
    return angular_momentum(mass, away, velocity - drift) / (mass @ np.sum(away ** 2, axis=1))


def check_conservation(run, name, kind, result, mass, n_above):
    position = result.points("Points")[..., :2]
    velocity = result.points("velocity")[..., :2]
    contact = result.points("contact_force")[..., :2]
    moving = mass[:n_above].sum()
    size = moving * np.linalg.norm(VELOCITY)
    momentum = np.einsum("n,tnk->tk", mass, velocity)
    run.check(f"{name}: total momentum, drift / |p|", (momentum - moving * VELOCITY) / size, 0.0)
    forces = result.table("rcforc")
    slave, master = forces.where(side="slave"), forces.where(side="master")
    peak = np.max(np.hypot(slave["fx"], slave["fy"]))
    # The block stops within about a quarter of its slowest period: a force of that order.
    run.check(f"{name}: the blocks touched: peak force", peak, 1000.0)
    run.check(f"{name}: contact has ended", slave["n_active"][-1], 0.0)
    for axis in ("fx", "fy"):
        run.check(f"{name}: (slave + master {axis}) / peak force",
                  (slave[axis] + master[axis]) / peak, 0.0)
    run.check(f"{name}: sum of nodal contact forces / peak force", contact.sum(axis=1) / peak, 0.0)
    found = angular_momentum(mass, position, velocity)
    moment = np.sum(position[..., 0] * contact[..., 1] - position[..., 1] * contact[..., 0], axis=1)
    drift, moment = (found - found[0]) / abs(found[0]), moment / (peak * SIZE[0])
    if kind in MOMENT_FREE:
        run.check(f"{name}: angular momentum, drift / initial", drift, 0.0)
        run.check(f"{name}: moment of the contact forces / (peak force x width)", moment, 0.0)
    else:
        run.report(f"{name}: angular momentum, largest drift / initial", np.max(np.abs(drift)),
                   "portion centres on a bent master: no moment balance")
        run.report(f"{name}: moment of the contact forces / (peak force x width)",
                   np.max(np.abs(moment)))


def check_motion(run, name, angle, result, mass, n_above):
    """The corner hits first, the block is turned by the blow, and leaves."""
    forces = result.table("rcforc").where(side="slave")
    first = int(np.argmax(forces["n_active"] > 0))
    contact = np.hypot(*np.moveaxis(result.points("contact_force")[..., :2], -1, 0))
    share = contact[first, 0] / contact[first, :n_above].sum()
    run.check(f"{name}: share of the lowest corner in the first force", share, 0.5)
    position = result.points("Points")[..., :2]
    velocity = result.points("velocity")[..., :2]
    turning = np.array([spin(mass[:n_above], x[:n_above], v[:n_above])
                        for x, v in zip(position, velocity)])
    run.check(f"{name}: spin before the impact", turning[:first], 0.0)
    # A frictionless blow -J n at the corner: omega = x J / I, x of the corner from the centre.
    corner = position[first, 0] - mass[:n_above] @ position[first, :n_above] / mass[:n_above].sum()
    strongest = turning[np.argmax(np.abs(turning))]
    run.check(f"{name}: strongest spin, in the sense of a blow at the corner",
              strongest * np.sign(corner[0]), 1.0)
    if angle >= 20.0:  # at small angles the other corner follows and takes the spin away again
        run.check(f"{name}: spin left after the impact", turning[-1] * np.sign(corner[0]), 1.0)
    run.report(f"{name}: spin left after the impact", turning[-1], "rad/s")


def check_energy(run, name, result):
    energy = result.table("glstat")
    run.check(f"{name}: energy ratio", energy["energy_ratio"], 1.0)
    run.check(f"{name}: contact energy left / initial energy",
              energy["contact"][-1] / energy["total"][0], 0.0)
    run.report(f"{name}: energy ratio furthest from 1",
               1.0 + max(energy["energy_ratio"] - 1.0, key=abs))
    run.report(f"{name}: contact energy left / initial energy",
               energy["contact"][-1] / energy["total"][0])


def check_symmetry(run):
    """Two passes treat both sides alike: with slave and master exchanged nothing changes."""
    angle = 30.0
    plain, other = (run.program(oblique_impact(3, angle, exchanged=exchanged))
                    for exchanged in (False, True))
    found, expected = (result.table("rcforc").where(side=side)
                       for result, side in ((other, "master"), (plain, "slave")))
    for axis in ("fx", "fy"):
        run.check(f"{TYPES[3]}, {angle:g} degrees, slave and master exchanged: {axis}", found[axis],
                  expected[axis])


def check(run):
    check_symmetry(run)
    for angle, penalty, scale in SCENES:
        (above, above_quads), (below, below_quads) = blocks(angle)
        mass = np.concatenate([lumped_mass(above, above_quads, RHO[0]),
                               lumped_mass(below, below_quads, RHO[1])])
        for kind, title in TYPES.items():
            name = f"{title}, {angle:g} degrees, eps {penalty:.0e}"
            result = run.program(oblique_impact(kind, angle, penalty, scale))
            check_conservation(run, name, kind, result, mass, len(above))
            check_motion(run, name, angle, result, mass, len(above))
            check_energy(run, name, result)
